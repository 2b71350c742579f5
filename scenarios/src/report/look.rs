//! Which signals histories and histograms look at, and in which unit they report them.

use std::ops::Range;

use onescan_server::signal::{SignalType, did_you_mean};
use toml::Spanned;

use super::held::Seen;
use super::history::Past;
use super::spread::Spread;
use crate::arrays::names;
use crate::error::Wrong;
use crate::expect::{Carrying, KnownSignal};
use crate::report_file::{HistogramFile, HistoryFile};

/// So many bins at most: more than a picture has room for.
const BINS_MAX: u32 = 1000;

/// Finds the signals, and gives each that is looked at a column.
pub(super) struct Looker<'a> {
    known: &'a [KnownSignal],
    columns: &'a mut Vec<String>,
}

impl<'a> Looker<'a> {
    pub(super) fn new(known: &'a [KnownSignal], columns: &'a mut Vec<String>) -> Self {
        Self { known, columns }
    }

    /// # Errors
    /// No signal, one that is not there or not a number, a unit that it cannot be carried to.
    pub(super) fn history(&mut self, entry: &HistoryFile) -> Result<Past, Wrong> {
        let HistoryFile { name, signals, unit, every } = entry;
        let seen = self.seen("history", name, signals, unit.as_ref())?;
        Ok(Past { name: name.get_ref().clone(), every: *every, seen })
    }

    /// # Errors
    /// As for a history; bins that are none.
    pub(super) fn histogram(&mut self, entry: &HistogramFile) -> Result<Spread, Wrong> {
        let HistogramFile { name, signals, unit, from, to, bins } = entry;
        let wrong = |message: String, place: Range<usize>| Wrong { message, place, help: None };
        for (key, edge) in [("from", from), ("to", to)] {
            if !edge.get_ref().is_finite() {
                return Err(wrong(format!("`{key}` is {}; an edge is a finite number", edge.get_ref()), edge.span()));
            }
        }
        let (low, high) = (*from.get_ref(), *to.get_ref());
        // the width, too, is a number
        if low >= high || !(high - low).is_finite() {
            let message = format!("`to` is {high:?}; it is more than `from`, {low:?}, by a finite number");
            return Err(wrong(message, to.span()));
        }
        let count = *bins.get_ref();
        if !(1..=BINS_MAX).contains(&count) {
            return Err(wrong(format!("`bins` is {count}; a histogram has 1 to {BINS_MAX} bins"), bins.span()));
        }
        let seen = self.seen("histogram", name, signals, unit.as_ref())?;
        Ok(Spread { name: name.get_ref().clone(), from: low, to: high, bins: count as usize, seen })
    }

    fn seen(
        &mut self,
        kind: &str,
        name: &Spanned<String>,
        signals: &[Spanned<String>],
        unit: Option<&Spanned<String>>,
    ) -> Result<Vec<Seen>, Wrong> {
        let mut all: Vec<Seen> = Vec::new();
        for written in signals {
            let places = |error: crate::arrays::Wrong| Wrong {
                message: error.message,
                place: error.place.unwrap_or_else(|| written.span()),
                help: error.help,
            };
            for signal in names(written.get_ref(), written.span()).map_err(places)? {
                let seen = self.signal(signal.as_str(), &written.span(), unit)?;
                if all.iter().any(|other| other.signal == seen.signal) {
                    let message = format!("the {kind} `{}` has `{signal}` twice", name.get_ref());
                    return Err(Wrong { message, place: written.span(), help: None });
                }
                all.push(seen);
            }
        }
        if all.is_empty() {
            let message = format!("the {kind} `{}` has no signal", name.get_ref());
            return Err(Wrong { message, place: name.span(), help: Some("name some in `signals`".to_owned()) });
        }
        Ok(all)
    }

    fn signal(&mut self, name: &str, place: &Range<usize>, unit: Option<&Spanned<String>>) -> Result<Seen, Wrong> {
        let Some(known) = self.known.iter().find(|known| known.name == name) else {
            let help = did_you_mean(name, self.known.iter().map(|known| known.name.as_str()));
            let message = format!("the scenario has no signal `{name}`");
            return Err(Wrong { message, place: place.clone(), help });
        };
        if !matches!(known.ty, SignalType::Elementary(_)) {
            let message = format!("`{name}` has the type {}; histories and histograms are of numbers", known.ty);
            return Err(Wrong { message, place: place.clone(), help: None });
        }
        let own = known.unit_of_value();
        let (factor, reported) = match unit {
            None => ((1.0, 1.0), own.map(str::to_owned)),
            Some(unit) => (carried(name, own, unit)?, Some(unit.get_ref().clone())),
        };
        let column = self.columns.iter().position(|column| column == name).unwrap_or_else(|| {
            self.columns.push(name.to_owned());
            self.columns.len() - 1
        });
        Ok(Seen { signal: name.to_owned(), unit: reported, column, factor })
    }
}

/// What a value of this signal is times and by in `unit`.
fn carried(name: &str, own: Option<&str>, unit: &Spanned<String>) -> Result<(f64, f64), Wrong> {
    let wanted = unit.get_ref();
    let wrong = |message: String, help| Wrong { message, place: unit.span(), help };
    let Some(own) = own else {
        let help = format!("give `{name}` the `unit` of its values in `[signals]`");
        return Err(wrong(format!("`{name}` has no unit that could be carried to `{wanted}`"), Some(help)));
    };
    match Carrying::between(own, wanted) {
        Carrying::By(factor) => Ok(factor),
        Carrying::Never => Err(wrong(format!("`{name}` is in {own}, which cannot be carried to `{wanted}`"), None)),
        Carrying::Unknown(help) => Err(wrong(format!("`{wanted}` is not a unit that is known here"), help)),
    }
}
