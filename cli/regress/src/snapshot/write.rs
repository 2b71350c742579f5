//! A snapshot as text.

use std::fmt::Write as _;

use onescan_base::duration::plain;
use onescan_server::time::{TimeSpan, VirtualTime};

use super::value::show;
use super::{DONE, Snapshot, Track, VERSION};

impl Snapshot {
    /// The snapshot as text.
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = self.write(&mut text);
        text
    }

    fn write(&self, text: &mut String) -> std::fmt::Result {
        let decimals = decimals(self.step);
        writeln!(text, "onescan trajectory {VERSION}")?;
        writeln!(text, "scenario {}\ncase {}", self.scenario, self.case)?;
        writeln!(text, "step {}\nend {}\n", span(self.step), instant(self.end, decimals))?;
        for track in &self.signals {
            header(text, track)?;
            for (since, bytes) in &track.changes {
                writeln!(text, "  {:>8}  {}", instant(*since, decimals), show(track.ty, bytes))?;
            }
            writeln!(text)?;
        }
        writeln!(text, "{DONE}")
    }
}

fn header(text: &mut String, track: &Track) -> std::fmt::Result {
    write!(text, "signal {} : {}", track.name, track.ty)?;
    if let Some(unit) = &track.unit {
        write!(text, " ({unit})")?;
    }
    if let Some(sampled) = track.sampled {
        write!(text, " every {} of {:016x}", span(sampled.every), sampled.digest)?;
    }
    writeln!(text)
}

/// A span without white space in it.
pub(super) fn span(span: TimeSpan) -> String {
    span.to_string().replace(' ', "")
}

/// How many decimals an instant on the grid of a step has, in seconds.
pub(super) fn decimals(step: TimeSpan) -> usize {
    (0..9).find(|digits| step.as_nanos().is_multiple_of(10_u64.pow(9 - *digits))).unwrap_or(9) as usize
}

/// An instant in seconds with so many decimals, or more if it needs them.
pub(super) fn instant(t_v: VirtualTime, decimals: usize) -> String {
    plain::seconds(t_v.as_nanos(), decimals).to_string()
}
