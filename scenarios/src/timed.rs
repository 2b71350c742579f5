//! The keys that say when something of a case begins and ends: once for all entries that have them.

use onescan_server::time::{TimeSpan, VirtualTime};
use toml::Spanned;

/// What the keys say, as they are written. What must hold of them together is checked where they become a period of the run.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Times {
    pub(crate) from: Option<VirtualTime>,
    pub(crate) until: Option<VirtualTime>,
    pub(crate) when: Option<Spanned<String>>,
    pub(crate) nth: Option<Spanned<u32>>,
    /// `for`.
    pub(crate) lasting: Option<TimeSpan>,
}

/// An entry that has the keys.
pub(crate) trait Timed {
    /// What it says.
    fn times(&self) -> Times;

    /// Lets it say something else.
    fn set_times(&mut self, times: Times);

    /// Whether it has one of the keys.
    fn says_when(&self) -> bool {
        self.times() != Times::default()
    }
}

/// An entry of a file with the keys behind its own.
macro_rules! timed {
    ($(#[$meta:meta])* pub struct $name:ident { $($own:tt)* }) => {
        $(#[$meta])*
        #[derive(Clone, Debug, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub struct $name {
            $($own)*
            /// From when; from the start if absent. With `when`: from when on the condition counts.
            #[serde(default, deserialize_with = "crate::form::from_optional_text")]
            #[schemars(with = "Option<crate::form::Time>")]
            pub from: Option<onescan_server::time::VirtualTime>,
            /// Until when; never ends if absent. Not together with `when` or `for`.
            #[serde(default, deserialize_with = "crate::form::from_optional_text")]
            #[schemars(with = "Option<crate::form::Time>")]
            pub until: Option<onescan_server::time::VirtualTime>,
            /// A condition on signals, now and in the past: it begins in the step after the condition has come true.
            #[schemars(with = "Option<String>")]
            pub when: Option<toml::Spanned<String>>,
            /// Which time that the condition comes true; the first if absent.
            #[schemars(with = "Option<crate::form::Ordinal>")]
            pub nth: Option<toml::Spanned<u32>>,
            /// How long it lasts.
            #[serde(default, rename = "for", deserialize_with = "crate::form::from_optional_text")]
            #[schemars(with = "Option<crate::form::Time>")]
            pub lasting: Option<onescan_server::time::TimeSpan>,
        }

        impl crate::timed::Timed for $name {
            fn times(&self) -> crate::timed::Times {
                crate::timed::Times {
                    from: self.from,
                    until: self.until,
                    when: self.when.clone(),
                    nth: self.nth.clone(),
                    lasting: self.lasting,
                }
            }

            fn set_times(&mut self, times: crate::timed::Times) {
                let crate::timed::Times { from, until, when, nth, lasting } = times;
                (self.from, self.until, self.when, self.nth, self.lasting) = (from, until, when, nth, lasting);
            }
        }
    };
}
pub(crate) use timed;
