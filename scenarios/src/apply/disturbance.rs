//! Disturbances of a case: which signals, and what is wrong with each.

use std::ops::Range;

use onescan_server::operation::{PushInterval, SignalFault};
use onescan_server::random::seed_for;
use onescan_server::signal::{SignalName, SignalType};
use onescan_server::time::TimeSpan;
use toml::{Spanned, Value};

use crate::arrays;
use crate::case::Catalogue;
use crate::case::file::{DisturbanceFile, DisturbanceKind, IntervalFile};
use crate::error::ScenarioError;
use crate::load::Scenario;

/// The signals of a disturbance.
struct Disturbed {
    signals: Vec<Spanned<SignalName>>,
    /// What its draws are named after if its signals travel together, as one frame.
    frame: Option<String>,
}

impl Scenario {
    /// What the panels' disturbances do to each signal, in the order of the elements that have one.
    ///
    /// # Errors
    /// A signal that is not there, or that cannot be disturbed so.
    pub fn panel_disturbances(&self) -> Result<Vec<Vec<(SignalName, SignalFault)>>, ScenarioError> {
        let catalogue = self.own_catalogue();
        let elements = self.file().panel.iter().flat_map(|panel| &panel.element);
        let disturbances = elements.filter_map(|element| element.get_ref().disturbance.as_ref());
        disturbances.map(|one| self.signal_faults(&catalogue, one, self.file().seed)).collect()
    }

    /// What `disturbance` does to each signal. `seed` is that of the case.
    pub(super) fn signal_faults(
        &self,
        catalogue: &Catalogue,
        disturbance: &Spanned<DisturbanceFile>,
        seed: u64,
    ) -> Result<Vec<(SignalName, SignalFault)>, ScenarioError> {
        let place = disturbance.span();
        let disturbance = disturbance.get_ref();
        check_keys(catalogue, disturbance, &place)?;
        let Disturbed { signals, frame } = self.disturbed(catalogue, disturbance, &place)?;
        let one = |signal: &Spanned<SignalName>| {
            let ty = self.type_of(catalogue, signal)?;
            let fault = Fault { catalogue, disturbance, place: place.clone(), signal: signal.get_ref(), ty };
            Ok((signal.get_ref().clone(), fault.of(frame.as_deref(), seed)?))
        };
        signals.iter().map(one).collect()
    }

    fn disturbed(
        &self,
        catalogue: &Catalogue,
        disturbance: &DisturbanceFile,
        place: &Range<usize>,
    ) -> Result<Disturbed, ScenarioError> {
        let wrong = |message: String, help: &str| catalogue.wrong(message, Some(place.clone()), Some(help.to_owned()));
        match (&disturbance.signal, &disturbance.signals[..], &disturbance.client) {
            (Some(signal), [], None) => Ok(Disturbed { signals: vec![signal.clone()], frame: None }),
            (None, [first, ..], None) => {
                let mut signals = Vec::new();
                for signal in &disturbance.signals {
                    let names = arrays::names(signal.get_ref().as_str(), signal.span())
                        .map_err(|found| catalogue.wrong(found.message, found.place, found.help))?;
                    signals.extend(names.into_iter().map(|name| Spanned::new(signal.span(), name)));
                }
                Ok(Disturbed { signals, frame: Some(first.get_ref().to_string()) })
            }
            (None, [], Some(named)) => {
                let what = ("client", "whose signals could be disturbed", place.clone());
                let client = self.chosen(catalogue, Some(named), |_| true, what)?;
                let written = self.file().signals.iter().filter(|(_, signal)| signal.get_ref().writer == client);
                let signals: Vec<_> = written.map(|(name, _)| Spanned::new(named.span(), name.clone())).collect();
                if signals.is_empty() {
                    let message = format!("client `{client}` writes no signals");
                    return Err(wrong(message, "name a client whose signals others read"));
                }
                Ok(Disturbed { signals, frame: Some(client.to_string()) })
            }
            (None, [], None) => Err(wrong(
                "which signals are disturbed is not said".to_owned(),
                "write `signal`, `signals` or `client`",
            )),
            _ => Err(wrong(
                "which signals are disturbed is said twice".to_owned(),
                "keep one of `signal`, `signals` and `client`",
            )),
        }
    }
}

/// Refuses keys that mean nothing to a kind, and kinds without the key that they need.
fn check_keys(catalogue: &Catalogue, disturbance: &DisturbanceFile, place: &Range<usize>) -> Result<(), ScenarioError> {
    let DisturbanceFile { kind, by, rate, sigma, .. } = disturbance;
    let wrong = |message: &str, place: Range<usize>, help: &str| {
        Err(catalogue.wrong(message.to_owned(), Some(place), Some(help.to_owned())))
    };
    let (offset_or_late, rated, noisy) = (
        matches!(kind, DisturbanceKind::Offset | DisturbanceKind::Late),
        matches!(kind, DisturbanceKind::Lost | DisturbanceKind::Flipped),
        *kind == DisturbanceKind::Noisy,
    );
    match (&disturbance.interval, *kind == DisturbanceKind::Pushed) {
        (Some(interval), false) => {
            return wrong("`interval` means nothing here", interval.span(), "it belongs to `pushed`");
        }
        (None, true) => {
            let help = "write `interval = { mean = \"10ms\" }`, with `sigma`, `least` and `most` where it varies";
            return wrong("how often frames are pushed is not said", place.clone(), help);
        }
        (Some(interval), true) if !interval_of(interval.get_ref()).is_in_order() => {
            return wrong("the mean is not between `least` and `most`", interval.span(), "change one of the three");
        }
        (Some(_), true) | (None, false) => {}
    }
    match (by, rate, sigma) {
        (Some(by), ..) if !offset_or_late => {
            wrong("`by` means nothing here", by.span(), "it belongs to `offset` and `late`")
        }
        (_, Some(rate), _) if !rated => {
            wrong("`rate` means nothing here", rate.span(), "it belongs to `lost` and `flipped`")
        }
        (.., Some(sigma)) if !noisy => wrong("`sigma` means nothing here", sigma.span(), "it belongs to `noisy`"),
        (_, None, _) if rated => wrong("how often is not said", place.clone(), "write `rate`, from 0 to 1"),
        (_, Some(rate), _) if !(0.0..=1.0).contains(rate.get_ref()) => {
            wrong(&format!("{} is not a rate", rate.get_ref()), rate.span(), "a rate is from 0, never, to 1, always")
        }
        (.., None) if noisy => {
            wrong("how strong the noise is is not said", place.clone(), "write `sigma`, its standard deviation")
        }
        (.., Some(sigma)) if !(sigma.get_ref().is_finite() && *sigma.get_ref() >= 0.0) => {
            let message = format!("{} is not a standard deviation", sigma.get_ref());
            wrong(&message, sigma.span(), "it is a number from 0, in the unit of the signal")
        }
        _ => Ok(()),
    }
}

/// An interval with its bounds: four standard deviations from the mean where they are not written, and above 0.
fn interval_of(written: &IntervalFile) -> PushInterval {
    let IntervalFile { mean, sigma, least, most } = *written;
    let around_ns = sigma.map_or(0, |sigma| sigma.as_nanos().saturating_mul(4));
    let span = |ns: u64| TimeSpan::from_nanos(ns.max(1)).unwrap_or(mean);
    PushInterval {
        mean,
        sigma,
        least: least.unwrap_or_else(|| span(mean.as_nanos().saturating_sub(around_ns))),
        most: most.unwrap_or_else(|| span(mean.as_nanos().saturating_add(around_ns))),
    }
}

/// One signal of a disturbance whose keys have been checked.
struct Fault<'a> {
    catalogue: &'a Catalogue,
    disturbance: &'a DisturbanceFile,
    place: Range<usize>,
    signal: &'a SignalName,
    ty: SignalType,
}

impl Fault<'_> {
    fn of(&self, frame: Option<&str>, seed: u64) -> Result<SignalFault, ScenarioError> {
        let DisturbanceFile { kind, rate, sigma, .. } = self.disturbance;
        let number =
            |written: &Option<Spanned<f64>>| written.as_ref().map_or(0.0, |number| *number.get_ref()).to_string();
        let seed_of = |thing: &str, name: &str| seed_for(seed, thing, name);
        Ok(match kind {
            DisturbanceKind::Stuck => SignalFault::Stuck,
            DisturbanceKind::Inverted if self.ty == SignalType::BOOL => SignalFault::Inverted,
            DisturbanceKind::Inverted => return Err(self.no_bool()),
            DisturbanceKind::Offset => self.offset()?,
            DisturbanceKind::Late => self.late()?,
            DisturbanceKind::Lost => match frame {
                Some(frame) => SignalFault::LostSteps { rate: number(rate), seed: seed_of("frame lost", frame) },
                None => SignalFault::Lost { rate: number(rate), seed: seed_of("signal lost", self.signal.as_str()) },
            },
            DisturbanceKind::Pushed => {
                let interval = self.disturbance.interval.as_ref().map(|interval| interval_of(interval.get_ref()));
                let thing = seed_of("frame pushed", frame.unwrap_or(self.signal.as_str()));
                match interval {
                    Some(interval) => SignalFault::Pushed { interval, seed: thing },
                    None => return Err(self.wrong("a frame is pushed at an `interval`")),
                }
            }
            DisturbanceKind::Silent if is_line(self.ty) => SignalFault::Silent,
            DisturbanceKind::Cut if is_line(self.ty) => SignalFault::Cut,
            DisturbanceKind::Flipped if self.ty == SignalType::BOOL || is_number(self.ty) || is_line(self.ty) => {
                SignalFault::Flipped { rate: number(rate), seed: seed_of("signal flipped", self.signal.as_str()) }
            }
            DisturbanceKind::Noisy if is_number(self.ty) => {
                SignalFault::Noisy { sigma: number(sigma), seed: seed_of("signal noisy", self.signal.as_str()) }
            }
            DisturbanceKind::Flipped => {
                return Err(self.wrong("only a BOOL, a number or a line of bytes has bits that can be flipped"));
            }
            DisturbanceKind::Silent | DisturbanceKind::Cut => {
                return Err(self.wrong("only a line of bytes, `type = \"BYTES[n]\"`, can be silent or cut"));
            }
            DisturbanceKind::Noisy => return Err(self.wrong("only a number can be noisy")),
        })
    }

    fn wrong(&self, help: &str) -> ScenarioError {
        let Self { signal, ty, disturbance, .. } = self;
        let kind = format!("{:?}", disturbance.kind).to_lowercase();
        let message = format!("`{signal}` is {ty}, which cannot be {kind}");
        self.catalogue.wrong(message, Some(self.place.clone()), Some(help.to_owned()))
    }

    fn no_bool(&self) -> ScenarioError {
        let message = format!("`{}` is {}, not BOOL", self.signal, self.ty);
        let help = "only a BOOL can be inverted".to_owned();
        self.catalogue.wrong(message, Some(self.place.clone()), Some(help))
    }

    fn offset(&self) -> Result<SignalFault, ScenarioError> {
        let Self { ty, signal, .. } = *self;
        match self.disturbance.by.as_ref().map(Spanned::get_ref) {
            Some(Value::Float(by)) if ty == SignalType::REAL || ty == SignalType::LREAL => {
                Ok(SignalFault::Offset { by: format!("{by:?}") })
            }
            Some(Value::Integer(by)) if is_number(ty) => Ok(SignalFault::Offset { by: by.to_string() }),
            _ => {
                let message = format!("`{signal}` is {ty}: an offset is a number of its type");
                Err(self.wrong_by(message, "as in `kind = \"offset\"`, `by = -0.05`"))
            }
        }
    }

    fn late(&self) -> Result<SignalFault, ScenarioError> {
        let help = "as in `by = \"20ms\"`";
        match self.disturbance.by.as_ref().map(Spanned::get_ref) {
            Some(Value::String(by)) => match by.parse() {
                Ok(by) => Ok(SignalFault::Late { by }),
                Err(error) => Err(self.wrong_by(format!("`by` is not a time: {error}"), help)),
            },
            _ => Err(self.wrong_by("`late` needs `by`, a time".to_owned(), help)),
        }
    }

    fn wrong_by(&self, message: String, help: &str) -> ScenarioError {
        let place = self.disturbance.by.as_ref().map_or(self.place.clone(), Spanned::span);
        self.catalogue.wrong(message, Some(place), Some(help.to_owned()))
    }
}

fn is_line(ty: SignalType) -> bool {
    matches!(ty, SignalType::Bytes(_))
}

fn is_number(ty: SignalType) -> bool {
    matches!(ty, SignalType::Elementary(ty) if ty.is_number() || (ty.is_bits() && ty.size() > 0))
        && ty != SignalType::BOOL
}
