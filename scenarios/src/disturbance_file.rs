//! Faults on the way of signals, as cases, lessons and panels write them.

use onescan_server::signal::SignalName;
use onescan_server::time::TimeSpan;
use schemars::JsonSchema;
use serde::Deserialize;
use toml::Spanned;

use crate::form::{Amount, Deviation, Name, Rate, Time, from_optional_text, from_text};
use crate::timed::timed;

timed! {
    /// A fault on the way of signals from their writer to their readers.
    pub struct DisturbanceFile {
        /// The signal's name; or `signals`, or `client`.
        #[schemars(with = "Option<Name>")]
        pub signal: Option<Spanned<SignalName>>,
        /// Several signals, which are one frame; ranges are allowed.
        #[serde(default)]
        #[schemars(with = "Vec<Name>")]
        pub signals: Vec<Spanned<SignalName>>,
        /// A client: all signals that it writes are one frame.
        #[schemars(with = "Option<Name>")]
        pub client: Option<Spanned<String>>,
        /// What is wrong with the signal.
        pub kind: DisturbanceKind,
        /// By how much: a number of the signal's type for `offset`, a time as in `"20ms"` for `late`.
        #[schemars(with = "Option<Amount>")]
        pub by: Option<Spanned<toml::Value>>,
        /// How often, from 0 to 1: of the changes for `lost` (of the steps, if it is a frame), of the steps for `flipped`; of the
        /// bytes of a line for both.
        #[schemars(with = "Option<Rate>")]
        pub rate: Option<Spanned<f64>>,
        /// Standard deviation of `noisy`, in the signal's unit.
        #[schemars(with = "Option<Deviation>")]
        pub sigma: Option<Spanned<f64>>,
        /// From push to push of `pushed`.
        #[schemars(with = "Option<IntervalFile>")]
        pub interval: Option<Spanned<IntervalFile>>,
    }
}

/// How long it is from one push of a frame to the next: normally distributed, held within bounds.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IntervalFile {
    /// Its mean.
    #[serde(deserialize_with = "from_text")]
    #[schemars(with = "Time")]
    pub mean: TimeSpan,
    /// Its standard deviation; all intervals are equal if absent.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub sigma: Option<TimeSpan>,
    /// Its least.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub least: Option<TimeSpan>,
    /// Its greatest.
    #[serde(default, deserialize_with = "from_optional_text")]
    #[schemars(with = "Option<Time>")]
    pub most: Option<TimeSpan>,
}

/// What can be wrong with a signal on its way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum DisturbanceKind {
    /// It keeps the value that it has: it is frozen.
    Stuck,
    /// A BOOL arrives negated.
    Inverted,
    /// A number arrives shifted.
    Offset,
    /// Values arrive late.
    Late,
    /// Changes do not arrive; of a frame, the values of whole steps; of a line of bytes, single bytes.
    Lost,
    /// Values travel in frames that are pushed by a clock of their own: between two pushes the last one holds.
    Pushed,
    /// A bit of the value is inverted for a step; of a line of bytes, a bit of a byte.
    Flipped,
    /// A normal deviate is added in each step.
    Noisy,
    /// No byte of a line comes through.
    Silent,
    /// No byte of a line comes through, and its connection is no more.
    Cut,
}
