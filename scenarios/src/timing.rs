//! `[timing]` bound to the signals of its scenario.

use onescan_server::signal::{SignalName, SignalType, did_you_mean};

use crate::arrays;
use crate::error::Wrong;
use crate::file::ScenarioFile;

/// A signal whose edges may arrive late.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Late {
    /// The signal, of type BOOL.
    pub signal: SignalName,
    /// By so many steps at most.
    pub steps: u64,
}

/// The signals of `[timing]`, in the order of the file.
pub(crate) fn bind(file: &ScenarioFile) -> Result<Vec<Late>, Wrong> {
    let mut all: Vec<Late> = Vec::new();
    for late in &file.timing.late {
        let steps = late.by.as_nanos() / file.step.as_nanos().max(1);
        for written in &late.signals {
            let wrong = |message: String, help: Option<String>| Wrong { message, place: written.span(), help };
            if steps == 0 {
                let message = format!("`{}` is late by less than a step, {}", written.get_ref(), file.step);
                return Err(wrong(message, Some("time goes on in whole steps".to_owned())));
            }
            let names = arrays::names(written.get_ref().as_str(), written.span());
            for signal in names.map_err(|found| wrong(found.message, found.help))? {
                let Some(declared) = file.signals.get(&signal) else {
                    let help = did_you_mean(signal.as_str(), file.signals.keys().map(SignalName::as_str));
                    return Err(wrong(format!("the scenario has no signal `{signal}`"), help));
                };
                if declared.get_ref().ty != SignalType::BOOL {
                    let message = format!("`{signal}` is {}; edges are of a BOOL", declared.get_ref().ty);
                    return Err(wrong(message, None));
                }
                if all.iter().any(|other| other.signal == signal) {
                    return Err(wrong(format!("`{signal}` is late twice"), Some("name it once".to_owned())));
                }
                all.push(Late { signal, steps });
            }
        }
    }
    Ok(all)
}
