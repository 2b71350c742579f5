//! Which signal is which variable of the PLC.
//!
//! A signal that the PLC writes is the `VAR_OUTPUT` of its name in one of the programs; any other
//! signal is every `VAR_INPUT` of its name. A line of bytes belongs to a port. Names are compared as the standard does, without case
//! (IEC 61131-3 2.1.2). A path given for a signal, or a direct address like `%QX0.1`, goes before its name.

use std::collections::BTreeMap;
use std::ops::Range;

use onescan_base::{ElementaryType, SignalType, nearest};
use onescan_iec_run::{Application, Variable, ZeroTerminated};
use onescan_server::signal::{ClientName, Port, SignalDecl, SignalName};
use thiserror::Error;

/// A signal and the places in the PLC's memory that hold it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bound {
    /// The signal as the PLC takes part in it.
    pub port: Port,
    /// Where it lies in memory; several for an input that several programs read.
    pub places: Vec<Place>,
    pub variables: Vec<String>,
}

/// Where a value lies in the PLC's memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    pub offset: usize,
    /// The bit of that byte, for a BOOL at an address like `%QX0.1`.
    pub bit: Option<u8>,
    /// Set for a string that has no count in front, as the signal's value has.
    pub text: Option<ZeroTerminated>,
}

impl Place {
    /// Where a variable lies.
    pub fn of(variable: &Variable) -> Self {
        Self { offset: variable.offset as usize, bit: variable.bit, text: variable.zero_terminated }
    }

    /// Bytes that it takes in memory; `len` are those of the signal's value.
    pub fn size(self, len: usize) -> usize {
        self.text.map_or(len, ZeroTerminated::size)
    }

    /// The bytes of memory that it takes, or that its bit is in.
    pub(crate) fn bytes(self, len: usize) -> Range<u32> {
        self.offset as u32..(self.offset + self.size(len)) as u32
    }

    /// Writes a signal's value into the PLC's memory. A place of another application, beyond its end, is left out.
    pub fn give(self, value: &[u8], memory: &mut [u8]) {
        let Some(bytes) = memory.get_mut(self.offset..self.offset + self.size(value.len())) else { return };
        match (self.bit, self.text, bytes, value) {
            (Some(bit), _, [byte, ..], [value, ..]) => *byte = *byte & !(1 << bit) | (value & 1) << bit,
            (_, Some(text), bytes, value) => text.give(value, bytes),
            (_, None, bytes, value) => bytes.copy_from_slice(value),
        }
    }

    /// Reads a signal's value out of the PLC's memory.
    pub fn take(self, memory: &[u8], value: &mut [u8]) {
        let Some(bytes) = memory.get(self.offset..self.offset + self.size(value.len())) else { return };
        match (self.bit, self.text, bytes, value) {
            (Some(bit), _, [byte, ..], [value, ..]) => *value = byte >> bit & 1,
            (_, Some(text), bytes, value) => text.take(bytes, value),
            // What is long has seldom changed, and to look takes less than to copy.
            (_, None, bytes, value) if value.len() >= LONG && *value == *bytes => {}
            (_, None, bytes, value) => value.copy_from_slice(bytes),
        }
    }
}

/// A value of so many bytes is compared before it is copied.
const LONG: usize = 4 * 1024;

/// All signals of a PLC.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Bindings {
    pub inputs: Vec<Bound>,
    pub outputs: Vec<Bound>,
}

/// Why a signal has no variable.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{message}")]
pub struct BindError {
    pub signal: SignalName,
    pub message: String,
    pub help: Option<String>,
}

/// Finds the variables of all `signals` in `application`, as seen by the PLC `plc`. `paths` names
/// variables for signals that are not found by their own name.
///
/// # Errors
/// A signal that the PLC is to write and has no variable for, a path that leads nowhere, a variable
/// of another type.
pub fn bind(
    application: &Application,
    plc: &ClientName,
    signals: &[SignalDecl],
    paths: &BTreeMap<SignalName, Vec<String>>,
) -> Result<Bindings, BindError> {
    let (bindings, errors) = bind_each(application, plc, signals, paths);
    errors.into_iter().next().map_or(Ok(bindings), Err)
}

/// The same for each signal by itself, so that one that is wrong hides no other.
pub fn bind_each(
    application: &Application,
    plc: &ClientName,
    signals: &[SignalDecl],
    paths: &BTreeMap<SignalName, Vec<String>>,
) -> (Bindings, Vec<BindError>) {
    let (mut bindings, mut errors) = (Bindings::default(), Vec::new());
    let own = Own::of(application);
    // A port has lines of bytes, and no variable.
    for signal in signals.iter().filter(|signal| !matches!(signal.ty, SignalType::Bytes(_))) {
        let written = signal.writer.as_ref() == Some(plc);
        match own.bound(application, signal, written, paths.get(&signal.name)) {
            Ok(None) => {}
            Ok(Some(bound)) if written => bindings.outputs.push(bound),
            Ok(Some(bound)) => bindings.inputs.push(bound),
            Err(error) => errors.push(error),
        }
    }
    (bindings, errors)
}

/// A signal has one value, so one variable that gives it.
fn several(signal: &SignalName, paths: &[String]) -> BindError {
    BindError {
        signal: signal.clone(),
        message: format!("signal `{signal}` is written by the PLC and bound to {} of its variables", paths.len()),
        help: Some("only a signal that the PLC reads goes to several".to_owned()),
    }
}

fn at_path(application: &Application, signal: &SignalName, path: &str) -> Result<Variable, BindError> {
    application.variable(path).map_err(|error| BindError {
        signal: signal.clone(),
        message: format!("signal `{signal}` is bound to `{path}`, which the PLC has not"),
        help: error.help,
    })
}

/// The last name of a path: `Shear.Drive_1` is `Drive_1`.
fn own_name(variable: &Variable) -> &str {
    variable.path.rsplit('.').next().unwrap_or(&variable.path)
}

/// What programs take in and give out, by name in capitals; programs of thousands of variables are looked through once.
struct Own {
    inputs: BTreeMap<String, Vec<Variable>>,
    outputs: BTreeMap<String, Vec<Variable>>,
}

impl Own {
    fn of(application: &Application) -> Self {
        let mut own = Self { inputs: BTreeMap::new(), outputs: BTreeMap::new() };
        for program in application.programs() {
            for (all, of_program) in [(&mut own.inputs, program.inputs), (&mut own.outputs, program.outputs)] {
                for variable in of_program {
                    all.entry(own_name(&variable).to_ascii_uppercase()).or_default().push(variable);
                }
            }
        }
        own
    }

    /// The variables of a signal, which the PLC writes or reads; nothing if it has none that reads it.
    fn bound(
        &self,
        application: &Application,
        signal: &SignalDecl,
        written: bool,
        paths: Option<&Vec<String>>,
    ) -> Result<Option<Bound>, BindError> {
        let variables = match paths {
            Some(paths) if written && paths.len() > 1 => return Err(several(&signal.name, paths)),
            Some(paths) => {
                paths.iter().map(|path| at_path(application, &signal.name, path)).collect::<Result<_, _>>()?
            }
            None if written => vec![self.output(&signal.name)?],
            None => self.input(&signal.name),
        };
        if variables.is_empty() {
            return Ok(None);
        }
        let places = variables.iter().map(|variable| checked_place(signal, variable)).collect::<Result<_, _>>()?;
        let variables = variables.into_iter().map(|variable| variable.path).collect();
        Ok(Some(Bound { port: Port { name: signal.name.clone(), ty: signal.ty }, places, variables }))
    }

    fn output(&self, signal: &SignalName) -> Result<Variable, BindError> {
        match self.outputs.get(&signal.as_str().to_ascii_uppercase()).map(Vec::as_slice) {
            Some([one]) => Ok(one.clone()),
            Some([first, second, ..]) => Err(BindError {
                signal: signal.clone(),
                message: format!("signal `{signal}` may be `{}` or `{}`", first.path, second.path),
                help: Some(format!("say which under `bind`: {signal} = \"{}\"", first.path)),
            }),
            _ => Err(BindError {
                signal: signal.clone(),
                message: format!("the PLC is to write signal `{signal}`, but no program has a VAR_OUTPUT of that name"),
                help: nearest(signal.as_str(), self.outputs.values().flatten().map(own_name))
                    .map(|name| format!("did you mean `{name}`? Another variable is named under `bind`")),
            }),
        }
    }

    fn input(&self, signal: &SignalName) -> Vec<Variable> {
        self.inputs.get(&signal.as_str().to_ascii_uppercase()).cloned().unwrap_or_default()
    }
}

fn checked_place(signal: &SignalDecl, variable: &Variable) -> Result<Place, BindError> {
    // An address has a width and no type of its own, unless a bit is asked for.
    let is_address =
        variable.path.starts_with('%') && variable.bit.is_none() && signal.ty != SignalType::from(ElementaryType::Bool);
    let same_width = is_address && !signal.ty.is_text() && signal.ty.size() == variable.size as usize;
    if variable.signal_type == Some(signal.ty) || same_width {
        return Ok(Place::of(variable));
    }
    Err(BindError {
        signal: signal.name.clone(),
        message: format!(
            "signal `{}` is {}, but `{}` is {}",
            signal.name, signal.ty, variable.path, variable.type_name
        ),
        help: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCE: &str = "
        PROGRAM A VAR_INPUT Start : BOOL; END_VAR VAR_OUTPUT Level : LREAL; END_VAR VAR n : INT; valve AT %QX0.3 : BOOL; END_VAR
        Level := 1.0; END_PROGRAM
        PROGRAM B VAR_INPUT start : BOOL; END_VAR VAR_OUTPUT Lamp : BOOL; Text : STRING[12]; END_VAR
        Lamp := start; END_PROGRAM";

    fn bound(signals: &[(&str, SignalType, &str)], paths: &[(&str, &str)]) -> Result<Bindings, BindError> {
        let application = Application::from_sources([("a.st", SOURCE)]).unwrap();
        let name = |text: &str| SignalName::new(text).unwrap();
        let client = |text: &str| ClientName::new(text).unwrap();
        let signals: Vec<_> = signals
            .iter()
            .map(|(n, ty, writer)| SignalDecl { name: name(n), ty: *ty, writer: Some(client(writer)), unit: None })
            .collect();
        let paths = paths.iter().map(|(n, path)| (name(n), path.split(' ').map(str::to_owned).collect())).collect();
        bind(&application, &client("plc"), &signals, &paths)
    }

    #[test]
    fn an_input_goes_to_every_program_that_reads_it() {
        let bindings = bound(&[("Start", SignalType::BOOL, "plant")], &[]).unwrap();
        assert_eq!(bindings.inputs[0].places.len(), 2);
    }

    #[test]
    fn any_variable_can_be_bound_by_its_path() {
        let bindings = bound(&[("Count", SignalType::INT, "plc")], &[("Count", "A.n")]).unwrap();
        assert_eq!(bindings.outputs.len(), 1);
        assert_eq!(bound(&[("Other", SignalType::INT, "plant")], &[]).unwrap(), Bindings::default());
    }

    #[test]
    fn a_signal_that_is_read_goes_to_several_variables() {
        let several = [("Go", "A.Start B.start")];
        assert_eq!(bound(&[("Go", SignalType::BOOL, "plant")], &several).unwrap().inputs[0].places.len(), 2);
        let error = bound(&[("Go", SignalType::BOOL, "plc")], &several).unwrap_err();
        assert_eq!(error.to_string(), "signal `Go` is written by the PLC and bound to 2 of its variables");
    }

    #[test]
    fn a_signal_can_be_bound_to_a_direct_address() {
        let bindings = bound(&[("Valve", SignalType::BOOL, "plc")], &[("Valve", "%QX0.3")]).unwrap();
        assert_eq!(bindings.outputs[0].places[0].bit, Some(3));
        let named = bound(&[("Valve", SignalType::BOOL, "plc")], &[("Valve", "A.valve")]).unwrap();
        assert_eq!(named.outputs[0].places, bindings.outputs[0].places);
        let error = bound(&[("Valve", SignalType::BOOL, "plc")], &[("Valve", "%QX7.3")]).unwrap_err();
        assert_eq!(error.to_string(), "signal `Valve` is bound to `%QX7.3`, which the PLC has not");
    }

    #[test]
    fn a_string_is_bound_with_its_length() {
        assert_eq!(bound(&[("Text", SignalType::String(12), "plc")], &[]).unwrap().outputs.len(), 1);
        let error = bound(&[("Text", SignalType::String(80), "plc")], &[]).unwrap_err();
        assert_eq!(error.to_string(), "signal `Text` is STRING[80], but `B.Text` is STRING[12]");
    }

    #[test]
    fn what_cannot_be_bound_is_reported() {
        let error = bound(&[("Lmap", SignalType::BOOL, "plc")], &[]).unwrap_err();
        assert!(error.message.ends_with("no program has a VAR_OUTPUT of that name"));
        assert!(error.help.unwrap().starts_with("did you mean `Lamp`?"));
        let error = bound(&[("Level", SignalType::REAL, "plc")], &[]).unwrap_err();
        assert_eq!(error.to_string(), "signal `Level` is REAL, but `A.Level` is LREAL");
        let error = bound(&[("Level", SignalType::LREAL, "plc")], &[("Level", "A.Levle")]).unwrap_err();
        assert_eq!(error.to_string(), "signal `Level` is bound to `A.Levle`, which the PLC has not");
    }
}
