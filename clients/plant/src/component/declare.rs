//! How a component states its parameters, signals and failures: once, as structs and enums whose
//! fields and docstrings are also the data of [`super::kind`].

use super::kind::{Failure, Form, Parameter, Setting, Signal, Values};

/// The parameters of a kind of component.
pub(crate) trait ParameterSet: Default {
    /// Every parameter, in the order of the fields.
    fn table() -> Vec<Parameter>;
    /// Takes the settings, one for each entry of the table.
    fn read(settings: &[Setting]) -> Self;
}

/// The type of a parameter.
pub(crate) trait ParameterType: Copy {
    /// What may be written, `bounds` included where they mean anything.
    fn form(bounds: (f64, f64)) -> Form;
    fn write(self) -> Setting;
    fn read(setting: Setting) -> Option<Self>;
}

impl ParameterType for f64 {
    fn form((least, most): (f64, f64)) -> Form {
        Form::Number { least, most }
    }

    fn write(self) -> Setting {
        Setting::Number(self)
    }

    fn read(setting: Setting) -> Option<Self> {
        if let Setting::Number(number) = setting { Some(number) } else { None }
    }
}

impl ParameterType for u32 {
    fn form((least, most): (f64, f64)) -> Form {
        Form::Count { least: least as i64, most: most as i64 }
    }

    fn write(self) -> Setting {
        Setting::Count(i64::from(self))
    }

    fn read(setting: Setting) -> Option<Self> {
        if let Setting::Count(whole) = setting { u32::try_from(whole).ok() } else { None }
    }
}

impl ParameterType for bool {
    fn form(_: (f64, f64)) -> Form {
        Form::Flag
    }

    fn write(self) -> Setting {
        Setting::Flag(self)
    }

    fn read(setting: Setting) -> Option<Self> {
        if let Setting::Flag(flag) = setting { Some(flag) } else { None }
    }
}

/// `key: type = preset => least, most;`, the bounds only for numbers.
macro_rules! parameters {
    ($(#[$meta:meta])* $name:ident { $(
        $(#[doc = $about:literal])+ $key:ident : $ty:ty = $preset:expr $(=> $least:expr, $most:expr)?;
    )* }) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq)]
        pub(crate) struct $name { $( $(#[doc = $about])+ pub(crate) $key: $ty, )* }

        impl Default for $name {
            fn default() -> Self {
                Self { $( $key: $preset, )* }
            }
        }

        impl $crate::component::declare::ParameterSet for $name {
            fn table() -> Vec<$crate::component::kind::Parameter> {
                vec![ $( $crate::component::kind::Parameter {
                    key: stringify!($key).into(),
                    about: concat!($($about),+).trim().to_owned(),
                    form: {
                        #[allow(unused_mut, unused_assignments)]
                        let mut bounds = (0.0, 0.0);
                        $( bounds = (f64::from($least), f64::from($most)); )?
                        <$ty as $crate::component::declare::ParameterType>::form(bounds)
                    },
                    preset: <$ty as $crate::component::declare::ParameterType>::write($preset),
                    initial: false,
                }, )* ]
            }

            #[allow(unused_mut, unused_variables)]
            fn read(settings: &[$crate::component::kind::Setting]) -> Self {
                let mut settings = settings.iter().copied();
                Self { $(
                    $key: settings.next().and_then(<$ty as $crate::component::declare::ParameterType>::read).unwrap_or($preset),
                )* }
            }
        }
    };
}
pub(crate) use parameters;

/// `Variant = "word"`: a parameter that is one word of several.
macro_rules! choice {
    ($(#[$meta:meta])* $name:ident { $( $(#[doc = $about:literal])+ $variant:ident = $word:literal, )+ }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum $name { $( $(#[doc = $about])+ $variant, )+ }

        impl $crate::component::declare::ParameterType for $name {
            fn form(_: (f64, f64)) -> $crate::component::kind::Form {
                $crate::component::kind::Form::Choice(&[ $($word),+ ])
            }

            fn write(self) -> $crate::component::kind::Setting {
                $crate::component::kind::Setting::Choice(match self { $( Self::$variant => $word, )+ })
            }

            fn read(setting: $crate::component::kind::Setting) -> Option<Self> {
                match setting {
                    $( $crate::component::kind::Setting::Choice($word) => Some(Self::$variant), )+
                    _ => None,
                }
            }
        }
    };
}
pub(crate) use choice;

/// A value of a signal.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) enum Value {
    Bool(bool),
    Number(f64),
    Whole(i32),
    /// A line of bytes, which a port reads and writes.
    Bytes,
}

impl Value {
    /// What a signal holds before anybody writes it.
    pub(crate) const fn zero(values: Values) -> Self {
        match values {
            Values::Bool => Self::Bool(false),
            Values::Number => Self::Number(0.0),
            Values::Whole => Self::Whole(0),
            Values::Bytes => Self::Bytes,
        }
    }

    /// What a scene says with the same meaning; a word is not a value of a signal.
    pub(crate) const fn of(setting: Setting) -> Option<Self> {
        match setting {
            Setting::Flag(flag) => Some(Self::Bool(flag)),
            Setting::Number(number) => Some(Self::Number(number)),
            Setting::Count(whole) => Some(Self::Whole(whole as i32)),
            Setting::Choice(_) => None,
        }
    }

    /// As a scene would say it, which no scene does of a line of bytes.
    pub(crate) const fn setting(self) -> Option<Setting> {
        match self {
            Self::Bool(flag) => Some(Setting::Flag(flag)),
            Self::Number(number) => Some(Setting::Number(number)),
            Self::Whole(whole) => Some(Setting::Count(whole as i64)),
            Self::Bytes => None,
        }
    }

    /// What values a signal takes that holds this one.
    pub(crate) const fn values(&self) -> Values {
        match self {
            Self::Bool(_) => Values::Bool,
            Self::Number(_) => Values::Number,
            Self::Whole(_) => Values::Whole,
            Self::Bytes => Values::Bytes,
        }
    }
}

/// The type of a signal.
pub(crate) trait SignalType: Copy {
    const VALUES: Values;
    fn write(self) -> Value;
    fn read(value: Value) -> Option<Self>;
}

macro_rules! signal_type {
    ($ty:ty, $variant:ident) => {
        impl SignalType for $ty {
            const VALUES: Values = Values::$variant;

            fn write(self) -> Value {
                Value::$variant(self)
            }

            fn read(value: Value) -> Option<Self> {
                if let Value::$variant(inner) = value { Some(inner) } else { None }
            }
        }
    };
}
signal_type!(bool, Bool);
signal_type!(f64, Number);
signal_type!(i32, Whole);

/// The type of an input or output that is one direction of a line of bytes. It has no value of its own: the first such
/// input and the first such output are the first of the component's ports, and so on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Line;

impl SignalType for Line {
    const VALUES: Values = Values::Bytes;

    fn write(self) -> Value {
        Value::Bytes
    }

    fn read(value: Value) -> Option<Self> {
        (value == Value::Bytes).then_some(Self)
    }
}

/// The inputs or the outputs of a kind of component.
pub(crate) trait SignalSet: Default {
    /// Every signal, in the order of the fields.
    fn table() -> Vec<Signal>;
    /// What each signal holds where nothing is connected.
    fn unconnected() -> Vec<Value> {
        let mut values = Vec::new();
        Self::default().write(&mut values);
        values
    }
    /// Takes the values, one for each entry of the table.
    fn read(values: &[Value]) -> Self;
    /// Puts the values, one for each entry of the table.
    fn write(self, values: &mut Vec<Value>);
}

/// `key: type`, or `key: type = value` for an input that is not 0 where nothing is connected.
macro_rules! signals {
    (@preset) => { Default::default() };
    (@preset $preset:expr) => { $preset };
    ($(#[$meta:meta])* $name:ident { $(
        $(#[doc = $about:literal])+ $key:ident : $ty:ty $(= $preset:expr)?,
    )* }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub(crate) struct $name { $( $(#[doc = $about])+ pub(crate) $key: $ty, )* }

        impl Default for $name {
            fn default() -> Self {
                Self { $( $key: $crate::component::declare::signals!(@preset $($preset)?), )* }
            }
        }

        impl $crate::component::declare::SignalSet for $name {
            fn table() -> Vec<$crate::component::kind::Signal> {
                vec![ $( $crate::component::kind::Signal {
                    key: stringify!($key).into(),
                    about: concat!($($about),+).trim().to_owned(),
                    values: <$ty as $crate::component::declare::SignalType>::VALUES,
                    preset: None,
                }, )* ]
            }

            #[allow(unused_mut, unused_variables)]
            fn read(values: &[$crate::component::declare::Value]) -> Self {
                let mut values = values.iter().copied();
                Self { $(
                    $key: values
                        .next()
                        .and_then(<$ty as $crate::component::declare::SignalType>::read)
                        .unwrap_or_else(|| Self::default().$key),
                )* }
            }

            #[allow(unused_variables)]
            fn write(self, values: &mut Vec<$crate::component::declare::Value>) {
                values.clear();
                $( values.push($crate::component::declare::SignalType::write(self.$key)); )*
            }
        }
    };
}
pub(crate) use signals;

/// The ways in which a component of a kind may fail.
pub(crate) trait FailureSet: Copy {
    /// Every mode, in the order of the variants.
    fn table() -> Vec<Failure>;
    /// Its place in the table.
    fn index(self) -> u32;
}

/// `Variant = "mode"`
macro_rules! failures {
    ($(#[$meta:meta])* $name:ident { $( $(#[doc = $about:literal])+ $variant:ident = $mode:literal, )+ }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum $name { $( $(#[doc = $about])+ $variant, )+ }

        impl $crate::component::declare::FailureSet for $name {
            fn table() -> Vec<$crate::component::kind::Failure> {
                vec![ $( $crate::component::kind::Failure {
                    mode: $mode.into(),
                    about: concat!($($about),+).trim().to_owned(),
                }, )+ ]
            }

            fn index(self) -> u32 {
                self as u32
            }
        }
    };
}
pub(crate) use failures;

/// The types of a component, which every kind calls the same: `Parameters`, `Inputs`, `Outputs`,
/// `Failure` and `State`, those of its own file; and its tie to the world:
/// `own_types!()` for none, `own_types!(senses Ray)` for that of a sensor, whose `drive` is never called,
/// `own_types!(sees Slides)` for another that it does nothing with,
/// `own_types!(moves Slides)` for one whose effect it then states itself.
macro_rules! own_types {
    () => {
        $crate::component::declare::own_types!(sees $crate::coupling::Nothing);
    };
    (senses $tie:ty) => {
        $crate::component::declare::own_types!(sees $tie);

        const ONLY_SENSES: bool = true;
    };
    (sees $tie:ty) => {
        $crate::component::declare::own_types!(moves $tie);

        fn effect(&self, _: &State) {}
    };
    (moves $tie:ty) => {
        type Parameters = Parameters;
        type Inputs = Inputs;
        type Outputs = Outputs;
        type Failure = Failure;
        type State = State;
        type Tie = $tie;
    };
}
pub(crate) use own_types;

/// The failure modes that are on, a bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Failed(pub(crate) u32);

impl Failed {
    /// True if this mode is on.
    pub(crate) fn has(self, mode: impl FailureSet) -> bool {
        self.0 & (1 << mode.index()) != 0
    }

    /// These modes and one more, by its place in the table.
    #[must_use]
    pub(crate) const fn with(self, index: usize) -> Self {
        Self(self.0 | (1 << index))
    }

    /// These modes less one, by its place in the table.
    #[must_use]
    pub(crate) const fn without(self, index: usize) -> Self {
        Self(self.0 & !(1 << index))
    }
}
