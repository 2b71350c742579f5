//! What a kind of component is, as plain data: for the reader of scenes, for people, for the schema.

use std::borrow::Cow;

use serde::Serialize;

use crate::coupling::Coupling;

/// A word or a line about a kind: of the library's it is part of the program, of the user's own it was read.
pub type Text = Cow<'static, str>;

/// A kind of component.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Kind {
    /// What a scene calls it.
    pub name: Text,
    /// What it is, in one line.
    pub summary: Text,
    /// How it behaves: its equations, a line each; none of a kind of the user's own, which is its own description.
    pub formula: &'static [&'static str],
    /// Where the equations come from, or the file that has them.
    pub source: Text,
    /// What of the scene it is bound to.
    pub coupling: Coupling,
    /// What describes one of its kind.
    pub parameters: Vec<Parameter>,
    /// What it takes from the PLC, or from another component.
    pub inputs: Vec<Signal>,
    /// What it gives to the PLC, and to other components.
    pub outputs: Vec<Signal>,
    /// Which inputs mean nothing without another one.
    pub dependences: &'static [Dependence],
    /// Which of its signals travel together, as a PLC that speaks frames has them.
    pub frames: Frames,
    /// How it may fail.
    pub failures: Vec<Failure>,
}

impl Kind {
    /// The key by which a scene gives an input a constant: that of the input, or `INPUT_constant` where a
    /// parameter has the same.
    pub fn constant_key(&self, input: &str) -> String {
        let hidden = self.parameters.iter().any(|parameter| parameter.key == input);
        if hidden { format!("{input}_constant") } else { input.to_owned() }
    }
}

/// The inputs and outputs of a kind that a scene binds with one key each: a structure of signals, one a member.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Frames {
    /// Inputs, in the order of the frame, by their keys.
    pub command: &'static [&'static str],
    /// Outputs, in the order of the frame, by their keys.
    pub feedback: &'static [&'static str],
}

impl Frames {
    /// The key of a scene that binds the inputs.
    pub const COMMAND: &str = "command_signals";
    /// The key of a scene that binds the outputs.
    pub const FEEDBACK: &str = "feedback_signals";

    /// A kind whose signals are bound one by one.
    pub const NONE: Self = Self { command: &[], feedback: &[] };

    /// The keys of a scene, each with the signals that it binds.
    pub const fn by_key(self) -> [(&'static str, &'static [&'static str]); 2] {
        [(Self::COMMAND, self.command), (Self::FEEDBACK, self.feedback)]
    }

    /// The member of a structure that is a signal of a component: `TargetPosition` is `target_position`.
    pub fn member(key: &str) -> String {
        let capital = |word: &str| {
            let mut letters = word.chars();
            letters.next().map(|first| first.to_ascii_uppercase()).into_iter().chain(letters).collect::<String>()
        };
        key.split('_').map(capital).collect()
    }
}

/// Inputs that mean nothing unless one of some others, which are off where nobody drives them, is driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Dependence {
    /// Those that mean nothing, by their keys.
    pub inputs: &'static [&'static str],
    /// Those of which one must be driven, by their keys.
    pub on: &'static [&'static str],
}

/// One parameter of a kind.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// Its key in a scene, with its unit.
    pub key: Text,
    pub about: String,
    /// What it may be.
    pub form: Form,
    /// What it is if the scene does not say.
    pub preset: Setting,
    /// Whether a component only begins with it: it means nothing once the plant runs.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub initial: bool,
}

/// What a parameter may be.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Form {
    /// A number, bounds included.
    Number {
        least: f64,
        most: f64,
    },
    /// A whole number, bounds included.
    Count {
        least: i64,
        most: i64,
    },
    Flag,
    /// One word of these.
    Choice(&'static [&'static str]),
}

impl Form {
    /// What may be written, in words.
    pub fn in_words(&self) -> String {
        match self {
            Self::Number { least, most } if Self::is_any(*least, *most) => "a finite number".to_owned(),
            Self::Number { least, most } => format!("a number from {least} to {most}"),
            Self::Count { least, most } => format!("a whole number from {least} to {most}"),
            Self::Flag => "`true` or `false`".to_owned(),
            Self::Choice(words) => {
                let quoted: Vec<_> = words.iter().map(|word| format!("\"{word}\"")).collect();
                format!("one of {}", quoted.join(", "))
            }
        }
    }

    /// The setting that a text gives, if it is allowed: `0.08`, `TRUE`, a word.
    pub(crate) fn read_text(&self, text: &str) -> Option<Setting> {
        let value = match self {
            Self::Number { .. } => toml::Value::Float(text.parse().ok()?),
            Self::Count { .. } => toml::Value::Integer(text.parse().ok()?),
            Self::Flag => toml::Value::Boolean(text.to_ascii_lowercase().parse().ok()?),
            Self::Choice(_) => toml::Value::String(text.to_owned()),
        };
        self.read(&value)
    }

    /// Whether bounds leave every finite number.
    pub(crate) fn is_any(least: f64, most: f64) -> bool {
        least == f64::MIN && most == f64::MAX
    }

    /// The setting that a value of a scene gives, if it is allowed.
    pub(crate) fn read(&self, value: &toml::Value) -> Option<Setting> {
        match (self, value) {
            (Self::Number { least, most }, toml::Value::Float(number)) => {
                (*least..=*most).contains(number).then_some(Setting::Number(*number))
            }
            (Self::Number { .. }, toml::Value::Integer(whole)) => self.read(&toml::Value::Float(*whole as f64)),
            (Self::Count { least, most }, toml::Value::Integer(whole)) => {
                (*least..=*most).contains(whole).then_some(Setting::Count(*whole))
            }
            (Self::Flag, toml::Value::Boolean(flag)) => Some(Setting::Flag(*flag)),
            (Self::Choice(words), toml::Value::String(text)) => {
                words.iter().find(|word| *word == text).map(|word| Setting::Choice(word))
            }
            _ => None,
        }
    }
}

/// The value of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Setting {
    /// A number, in the unit of its key.
    Number(f64),
    Count(i64),
    Flag(bool),
    Choice(&'static str),
}

impl Setting {
    /// As [`Form::read_text`] reads it again.
    pub(crate) fn text(&self) -> String {
        match self {
            Self::Choice(word) => (*word).to_owned(),
            Self::Number(_) | Self::Count(_) | Self::Flag(_) => self.to_string(),
        }
    }
}

impl std::fmt::Display for Setting {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Count(whole) => write!(f, "{whole}"),
            Self::Flag(flag) => write!(f, "{flag}"),
            Self::Choice(word) => write!(f, "\"{word}\""),
        }
    }
}

/// One signal of a kind.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Signal {
    /// Its name among the signals of its component, with its unit if it has one.
    pub key: Text,
    pub about: String,
    /// What values it takes.
    pub values: Values,
    /// What an input is if nobody drives it; none for an output.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<Setting>,
}

impl Signal {
    /// What a value of a scene says of the signal for good, if the signal takes it.
    pub(crate) fn constant(&self, value: &toml::Value) -> Option<Setting> {
        match (self.values, value) {
            (Values::Bool, toml::Value::Boolean(flag)) => Some(Setting::Flag(*flag)),
            (Values::Number, toml::Value::Float(number)) if number.is_finite() => Some(Setting::Number(*number)),
            (Values::Number, toml::Value::Integer(whole)) => Some(Setting::Number(*whole as f64)),
            (Values::Whole, toml::Value::Integer(whole)) => i32::try_from(*whole).ok().map(|_| Setting::Count(*whole)),
            _ => None,
        }
    }
}

/// What values a signal takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Values {
    Bool,
    /// LREAL, or REAL if the component's `signal_type` says so.
    Number,
    Whole,
    /// One direction of a line of bytes.
    Bytes,
}

impl Values {
    /// What a constant of these values is, in words.
    pub(crate) const fn in_words(self) -> &'static str {
        match self {
            Self::Bool => "`true` or `false`",
            Self::Number => "a finite number",
            Self::Whole => "a whole number from -2147483648 to 2147483647",
            Self::Bytes => "no constant: a line of bytes comes from a signal",
        }
    }
}

impl std::fmt::Display for Values {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Bool => "BOOL",
            Self::Number => "LREAL",
            Self::Whole => "DINT",
            Self::Bytes => "BYTES",
        })
    }
}

/// One way in which a component of a kind may fail.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Failure {
    /// What a scene calls it.
    pub mode: Text,
    pub about: String,
}

/// Endings of keys and the units they stand for.
const UNITS: &[(&str, &str)] = &[
    ("_w_m2_k", "W/(m²·K)"),
    ("_j_m2_k", "J/(m²·K)"),
    ("_w_m_k", "W/(m·K)"),
    ("_units_s2", "units/s²"),
    ("_units_s", "units/s"),
    ("_units", "units"),
    ("_m3_kg", "m³/kg"),
    ("_kg_mwh", "kg/MWh"),
    ("_j_kg_k", "J/(kg·K)"),
    ("_j_kg", "J/kg"),
    ("_kwh", "kWh"),
    ("_var", "var"),
    ("_v_m", "V/m"),
    ("_m3_s", "m³/s"),
    ("_kg_m3", "kg/m³"),
    ("_kg_m2", "kg·m²"),
    ("_kg_s", "kg/s"),
    ("_rad_s2", "rad/s²"),
    ("_rad_s", "rad/s"),
    ("_deg_s", "°/s"),
    ("_m_s3", "m/s³"),
    ("_m_s2", "m/s²"),
    ("_m_s", "m/s"),
    ("_n_s_m", "N·s/m"),
    ("_n_m", "N/m"),
    ("_nm_s", "N·m·s"),
    ("_l_min", "l/min"),
    ("_l_s_bar", "l/(s·bar)"),
    ("_j_k", "J/K"),
    ("_w_k", "W/K"),
    ("_turns_h", "turns/h"),
    ("_1_min", "1/min"),
    ("_1_s", "1/s"),
    ("_degc", "°C"),
    ("_deg", "°"),
    ("_rad", "rad"),
    ("_bar", "bar"),
    ("_ohm", "Ω"),
    ("_kg", "kg"),
    ("_cm3", "cm³"),
    ("_m3", "m³"),
    ("_m2", "m²"),
    ("_hz", "Hz"),
    ("_nm", "N·m"),
    ("_ma", "mA"),
    ("_pct", "%"),
    ("_pa", "Pa"),
    ("_w", "W"),
    ("_v", "V"),
    ("_a", "A"),
    ("_j", "J"),
    ("_l", "l"),
    ("_n", "N"),
    ("_m", "m"),
    ("_s", "s"),
];

/// What a key means without its unit, and the unit.
pub fn unit(key: &str) -> (&str, Option<&'static str>) {
    UNITS
        .iter()
        .find_map(|(ending, unit)| key.strip_suffix(ending).map(|stem| (stem, Some(*unit))))
        .unwrap_or((key, None))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_shows_its_unit() {
        assert_eq!(unit("stroke_m"), ("stroke", Some("m")));
        assert_eq!(unit("speed_m_s"), ("speed", Some("m/s")));
        assert_eq!(unit("teeth"), ("teeth", None));
    }

    #[test]
    fn longer_endings_come_first() {
        for (index, (ending, _)) in UNITS.iter().enumerate() {
            let shadowed = UNITS[..index].iter().find(|(earlier, _)| ending.ends_with(earlier));
            assert_eq!(shadowed, None, "{ending}");
        }
    }

    #[test]
    fn a_whole_number_is_a_number_but_not_the_reverse() {
        let number = Form::Number { least: 0.0, most: 5.0 };
        assert_eq!(number.read(&toml::Value::Integer(3)), Some(Setting::Number(3.0)));
        assert_eq!(number.read(&toml::Value::Float(f64::NAN)), None);
        assert_eq!(Form::Count { least: 0, most: 5 }.read(&toml::Value::Float(3.0)), None);
    }
}
