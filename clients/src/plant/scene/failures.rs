//! Second pass over `[[failure]]`: what fails, how and when.

use onescan_base::nearest;
use onescan_server::signal::SignalType;
use toml::Spanned;

use super::error::{SceneFaultKind, Thing};
use super::faults::Faults;
use super::format::FailureTable;
use super::model::{Between, Component, FailureSwitch, When};
use super::number::{Allowed, Entry};
use super::signals::Signals;
use super::text;
use crate::plant::component::library::entry;

pub(super) fn check(
    tables: &[Spanned<FailureTable>],
    (components, lost): (&mut [Component], &[String]),
    signals: &mut Signals,
    faults: &mut Faults<'_>,
) {
    for table in tables.iter().map(Spanned::get_ref) {
        let when = when(table, signals, faults);
        let name = &table.component;
        if lost.iter().any(|lost| lost == text(name)) {
            continue;
        }
        let Some(index) = components.iter().position(|component| component.name == text(name)) else {
            faults.unknown(Thing::Component, name, components.iter().map(|component| component.name.as_str()));
            continue;
        };
        let modes = entry(components[index].kind).map(|entry| (entry.kind)().failures).unwrap_or_default();
        let mode = modes.iter().position(|mode| mode.mode == text(&table.mode));
        if let (Some(mode), Some(when)) = (mode, when.clone()) {
            components[index].failures.push(FailureSwitch { mode, when });
        }
        if mode.is_none() {
            let listed: Vec<_> = modes.iter().map(|mode| format!("`{}`", mode.mode)).collect();
            let hint = nearest(text(&table.mode), modes.iter().map(|mode| mode.mode))
                .map_or_else(|| format!("it may be {}", listed.join(", ")), |near| format!("did you mean `{near}`?"));
            let kind = SceneFaultKind::ComponentPart {
                component: text(name).to_owned(),
                what: "failure mode",
                name: text(&table.mode).to_owned(),
            };
            faults.add_hinted(table.mode.span(), kind, Some(hint));
        }
    }
}

fn when(table: &FailureTable, signals: &mut Signals, faults: &mut Faults<'_>) -> Option<When> {
    let from = Entry::new("from_s", table.from_s.as_ref());
    let until = Entry::new("until_s", table.until_s.as_ref());
    if let Some(signal) = &table.signal {
        if let Some(time) = from.value.or(until.value) {
            faults.add(time.span(), SceneFaultKind::FailureTwice);
        }
        return signals.read(signal, SignalType::BOOL, faults).map(When::Signal);
    }
    let from_s = faults.number(from, Allowed::NotNegative).unwrap_or(0.0);
    let until_s = faults.number(until, Allowed::NotNegative);
    if let (Some(until_s), Some(value)) = (until_s, until.value)
        && until_s <= from_s
    {
        faults.add(value.span(), SceneFaultKind::Order { lower: "from_s", upper: "until_s" });
    }
    let until_ns = until_s.map_or(u64::MAX, nanoseconds);
    Some(When::Between(Between { from_ns: nanoseconds(from_s), until_ns }))
}

/// The nearest whole number of nanoseconds.
pub(super) fn nanoseconds(time_s: f64) -> u64 {
    (time_s * 1e9).round() as u64
}
