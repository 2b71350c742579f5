//! Second pass over `[[signal]]`: what happens to a signal between the plant and the session.

use super::placed::Placed;
use onescan_base::nearest;
use onescan_server::signal::SignalType;

use super::error::{SceneFaultKind, Thing};
use super::failures::nanoseconds;
use super::faults::Faults;
use super::format::SignalTable;
use super::model::{Condition, Range};
use super::names::Names;
use super::number::{Allowed, Entry};
use super::signals::Signals;
use super::text;

/// Longest delay: what is on its way is part of the plant's state.
const TIME_S: Allowed = Allowed::Within(0.0, 60.0);

const RATE: Allowed = Allowed::Within(0.0, 1.0);

pub(super) fn check(tables: &[Placed<SignalTable>], signals: &mut Signals, faults: &mut Faults<'_>) -> Vec<Condition> {
    Names::gather(Thing::Signal, tables.iter().map(|table| &table.get_ref().name), faults);
    tables.iter().filter_map(|table| condition(table.get_ref(), signals, faults)).collect()
}

fn condition(table: &SignalTable, signals: &mut Signals, faults: &mut Faults<'_>) -> Option<Condition> {
    let name = &table.name;
    let Some(port) = signals.find(text(name)).cloned() else {
        let hint = nearest(text(name), signals.names()).map(|near| format!("did you mean `{near}`?"));
        faults.add_hinted(name.span(), SceneFaultKind::ForeignSignal(text(name).to_owned()), hint);
        return None;
    };
    if let SignalType::Bytes(_) = port.ty {
        let (name_text, ty) = (text(name).to_owned(), port.ty.to_string());
        let hint = "what goes wrong with a line of bytes is a `[[case.disturbance]]`".to_owned();
        faults.add_hinted(name.span(), SceneFaultKind::SignalKey { name: name_text, ty, key: "name" }, Some(hint));
        return None;
    }
    if port.ty == SignalType::BOOL {
        refuse_number_keys(table, faults);
    }
    let outer = ty(table, faults);
    if let Some(ty) = outer {
        signals.retype(&port.name, ty);
    }
    refuse_bits_of_fractions(table, outer.unwrap_or(port.ty), faults);
    let mut number = |key: &'static str, value: Option<&Placed<f64>>, allowed: Allowed| {
        faults.number(Entry::new(key, value), allowed).unwrap_or(0.0)
    };
    let delay_s = number("delay_s", table.delay_s.as_ref(), TIME_S);
    let jitter_s = number("jitter_s", table.jitter_s.as_ref(), TIME_S);
    let delay_sigma_s = number("delay_sigma_s", table.delay_sigma_s.as_ref(), TIME_S);
    let sample_s = number("sample_s", table.sample_s.as_ref(), TIME_S);
    let quantum = number("quantum", table.quantum.as_ref(), Allowed::NotNegative);
    let noise_mean = number("noise_mean", table.noise_mean.as_ref(), Allowed::Finite);
    let noise_sigma = number("noise_sigma", table.noise_sigma.as_ref(), Allowed::NotNegative);
    let lost_rate = number("lost_rate", table.lost_rate.as_ref(), RATE);
    let flip_rate = number("flip_rate", table.flip_rate.as_ref(), RATE);
    Some(Condition {
        signal: port.name,
        inner: port.ty,
        scale: scale(table, faults),
        delay_ns: nanoseconds(delay_s),
        jitter_ns: nanoseconds(jitter_s),
        delay_sigma_ns: nanoseconds(delay_sigma_s),
        sample_ns: nanoseconds(sample_s),
        quantum,
        noise_mean,
        noise_sigma,
        lost_rate,
        flip_rate,
    })
}

/// Keys that mean nothing for a BOOL.
fn refuse_number_keys(table: &SignalTable, faults: &mut Faults<'_>) {
    let keys = [
        ("type", table.ty.as_ref().map(Placed::span)),
        ("range", table.range.as_ref().map(Placed::span)),
        ("raw", table.raw.as_ref().map(Placed::span)),
        ("quantum", table.quantum.as_ref().map(Placed::span)),
        ("noise_mean", table.noise_mean.as_ref().map(Placed::span)),
        ("noise_sigma", table.noise_sigma.as_ref().map(Placed::span)),
    ];
    for (key, span) in keys {
        if let Some(span) = span {
            let name = text(&table.name).to_owned();
            faults.add(span, SceneFaultKind::SignalKey { name, ty: "BOOL".to_owned(), key });
        }
    }
}

/// An inverted bit of a number with a fraction may be its sign, its exponent or nothing that one could
/// see, and it may leave no number at all.
fn refuse_bits_of_fractions(table: &SignalTable, ty: SignalType, faults: &mut Faults<'_>) {
    if let (Some(written), SignalType::REAL | SignalType::LREAL) = (&table.flip_rate, ty) {
        let name = text(&table.name).to_owned();
        faults.add(written.span(), SceneFaultKind::SignalKey { name, ty: ty.to_string(), key: "flip_rate" });
    }
}

/// The type in the session, a number's.
fn ty(table: &SignalTable, faults: &mut Faults<'_>) -> Option<SignalType> {
    use SignalType as T;
    let written = table.ty.as_ref()?;
    let numbers =
        [T::SINT, T::INT, T::DINT, T::USINT, T::UINT, T::UDINT, T::BYTE, T::WORD, T::DWORD, T::REAL, T::LREAL];
    let found = written.get_ref().parse().ok().filter(|ty| numbers.contains(ty));
    if found.is_none() {
        let wanted = "SINT, INT, DINT, USINT, UINT, UDINT, BYTE, WORD, DWORD, REAL or LREAL";
        faults.add(written.span(), SceneFaultKind::Text { key: "type".to_owned(), wanted });
    }
    found
}

fn scale(table: &SignalTable, faults: &mut Faults<'_>) -> Option<Range> {
    let mut ends = |key: &'static str, written: &Placed<[f64; 2]>| {
        let [low, high] = *written.get_ref();
        let good = low.is_finite() && high.is_finite() && low < high;
        if !good {
            let wanted = "two numbers, the lower one first".to_owned();
            faults.add(
                written.span(),
                SceneFaultKind::Number { key: key.into(), wanted, value: format!("[{low}, {high}]") },
            );
        }
        good.then_some([low, high])
    };
    match (&table.range, &table.raw) {
        (Some(range), Some(raw)) => {
            let (range, raw) = (ends("range", range), ends("raw", raw));
            Some(Range { range: range?, raw: raw? })
        }
        (None, None) => None,
        (Some(one), None) | (None, Some(one)) => {
            let whose = format!("signal `{}`", text(&table.name));
            let key = if table.range.is_none() { "range" } else { "raw" };
            faults.add(one.span(), SceneFaultKind::Missing { whose, key });
            None
        }
    }
}
