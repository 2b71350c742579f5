//! What a function block declares, as a kind of component.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use onescan_base::did_you_mean;
use onescan_iec::Input;
use onescan_iec::syntax::ast::{Declaration, Pou, PouKind, Qualifier, Section, SectionKind};
use onescan_iec::syntax::remark::Remarks;
use onescan_iec::syntax::{FileId, Span, parse_source};
use onescan_iec_run::SoftPlc;

use super::socket::Socket;
use super::{ProgramError, ProgramFault};
use crate::component::declare::Value;
use crate::component::kind::{Failure, Form, Frames, Kind, Parameter, Setting, Signal, Values};
use crate::coupling::{Coupling, Nothing};
use crate::file_place::{Place, Source};

/// The beginning of an input that is a failure mode.
const FAIL: &str = "fail_";
/// The input that has the period of the plant.
const PERIOD: &str = "dt_s";
/// As many as there are bits for them.
const FAILURES_MAX: usize = 32;
/// Keys that every component has.
const RESERVED: [&str; 3] = ["name", "kind", "signal_type"];

#[derive(Clone)]
pub(super) struct Interface {
    /// The block as it is declared.
    pub(super) block: String,
    pub(super) kind: Kind,
    /// The inputs that are failure modes, in the order of the kind's.
    pub(super) failing: Vec<String>,
    /// The input that has the period, as it is declared.
    pub(super) period: Option<String>,
    source: Arc<Source>,
    /// Where each variable is declared, in the file as its author sees it.
    places: BTreeMap<String, Range<usize>>,
}

impl Interface {
    /// That of the function block `name` in a file. Types and presets are not known yet.
    ///
    /// # Errors
    /// The file does not define it.
    pub(super) fn of(name: &str, input: &Input) -> Result<Self, ProgramError> {
        let file = input.file();
        let source = Arc::new(Source { file: file.name().to_owned(), text: Arc::clone(file.shown_text()) });
        let parsed = parse_source(FileId(0), file);
        let blocks: Vec<&Pou> = blocks(&parsed.unit.declarations).collect();
        let Some(block) = blocks.iter().find(|block| block.name.text.eq_ignore_ascii_case(name)) else {
            let place = Place { source, span: 0..0 };
            let hint = did_you_mean(name, blocks.iter().map(|block| block.name.text.as_str()));
            let cause = format!("there is no FUNCTION_BLOCK `{name}`");
            return Err(ProgramError::Source(vec![ProgramFault { place, cause, hint }]));
        };
        let remarks = Remarks::of(std::iter::once(file));
        let summary = remarks.comment_on_unit(&block.name.text);
        let kind = Kind {
            name: name.to_owned().into(),
            summary: summary.map_or_else(|| format!("function block {}", block.name.text), str::to_owned).into(),
            formula: &[],
            source: file.name().to_owned().into(),
            coupling: Coupling::of::<Nothing>(),
            parameters: Vec::new(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            dependences: &[],
            frames: Frames::NONE,
            failures: Vec::new(),
        };
        let block_name = block.name.text.clone();
        let mut interface =
            Self { block: block_name, kind, failing: Vec::new(), period: None, source, places: BTreeMap::new() };
        let shown = |span: Span| {
            let range = file.shown_range(span.start, span.end);
            range.start as usize..range.end as usize
        };
        for section in &block.sections {
            for name in section.variables.iter().flat_map(|variable| &variable.names) {
                interface.places.insert(name.text.clone(), shown(name.span));
                let about = remarks.comment(&format!("{}.{}", block.name.text, name.text));
                interface.take(section, &name.text, about)?;
            }
        }
        Ok(interface)
    }

    /// Takes a variable of the block. What is not seen from outside is its own.
    fn take(&mut self, section: &Section, name: &str, about: Option<String>) -> Result<(), ProgramError> {
        let constant = section.qualifiers.contains(&Qualifier::Constant);
        match (section.kind, about) {
            (SectionKind::InOut, _) => {
                let cause = format!("`{name}` is VAR_IN_OUT, and a component has no variable for it");
                return Err(self.wrong(name, cause, Some("make it VAR_INPUT or VAR_OUTPUT".to_owned())));
            }
            (SectionKind::Input, _) if name.eq_ignore_ascii_case(PERIOD) => self.period = Some(name.to_owned()),
            (SectionKind::Input, about)
                if name.get(..FAIL.len()).is_some_and(|begin| begin.eq_ignore_ascii_case(FAIL)) =>
            {
                let mode = name[FAIL.len()..].to_ascii_lowercase();
                self.kind.failures.push(Failure { mode: mode.into(), about: about.unwrap_or_default() });
                self.failing.push(name.to_owned());
                if self.failing.len() > FAILURES_MAX {
                    let cause = format!("`{name}` is one too many: a kind has at most {FAILURES_MAX} failure modes");
                    return Err(self.wrong(name, cause, None));
                }
            }
            (SectionKind::Input, about) => self.kind.inputs.push(signal(name, about)),
            (SectionKind::Output, about) => self.kind.outputs.push(signal(name, about)),
            (SectionKind::Local, Some(about)) if constant => {
                if RESERVED.contains(&name) {
                    let cause = format!("a parameter cannot be called `{name}`, which every component has");
                    return Err(self.wrong(name, cause, None));
                }
                let (form, preset) = (Form::Flag, Setting::Flag(false));
                self.kind.parameters.push(Parameter {
                    key: name.to_owned().into(),
                    about,
                    form,
                    preset,
                    initial: false,
                });
            }
            _ => {}
        }
        Ok(())
    }

    /// The interface with the types and the initial values that the compiled block has.
    ///
    /// # Errors
    /// A variable of a type that no signal or parameter has.
    pub(super) fn with_presets(mut self, plc: &SoftPlc) -> Result<Self, ProgramError> {
        let mut kind = self.kind.clone();
        for signal in kind.inputs.iter_mut().chain(&mut kind.outputs) {
            let (values, preset) = self.preset(&signal.key, plc)?;
            let is_input = self.kind.inputs.iter().any(|input| input.key == signal.key);
            (signal.values, signal.preset) = (values, is_input.then_some(preset));
        }
        for name in &self.failing {
            if self.preset(name, plc)?.0 != Values::Bool {
                return Err(self.wrong(name, format!("`{name}` is a failure mode, and these are BOOL"), None));
            }
        }
        if let Some(name) = &self.period
            && self.preset(name, plc)?.0 != Values::Number
        {
            return Err(self.wrong(name, format!("`{name}` has the period in s: it is REAL or LREAL"), None));
        }
        for parameter in &mut kind.parameters {
            let (values, preset) = self.preset(&parameter.key, plc)?;
            parameter.form = match values {
                Values::Bool => Form::Flag,
                Values::Number => Form::Number { least: f64::MIN, most: f64::MAX },
                // no variable of a block is a line
                Values::Whole | Values::Bytes => Form::Count { least: i64::from(i32::MIN), most: i64::from(i32::MAX) },
            };
            parameter.preset = preset;
        }
        self.kind = kind;
        Ok(self)
    }

    /// What values a variable takes, and its initial one.
    fn preset(&self, name: &str, plc: &SoftPlc) -> Result<(Values, Setting), ProgramError> {
        let socket = Socket::find(plc.application(), name, |cause, hint| self.wrong(name, cause, hint))?;
        let setting = socket.get(plc.memory()).and_then(Value::setting);
        let (values, setting) = socket.values().zip(setting).ok_or_else(|| {
            let cause = format!("`{name}` is {}, which no signal or parameter of a component is", socket.type_name());
            let hint = "it may be BOOL, SINT, USINT, INT, UINT, DINT, REAL or LREAL; times are numbers in s";
            self.wrong(name, cause, Some(hint.to_owned()))
        })?;
        Ok((values, setting))
    }

    /// The constants that are not as they are declared: path and literal.
    pub(super) fn constants(&self, settings: &[Setting]) -> Vec<(String, String)> {
        let settled = self.kind.parameters.iter().zip(settings);
        let others = settled.filter(|(parameter, setting)| parameter.preset != **setting);
        others.map(|(parameter, setting)| (format!("{}.{}", self.block, parameter.key), literal(*setting))).collect()
    }

    /// A fault at a variable.
    pub(super) fn wrong(&self, name: &str, cause: String, hint: Option<String>) -> ProgramError {
        let span = self.places.get(name).cloned().unwrap_or(0..0);
        let place = Place { source: Arc::clone(&self.source), span };
        ProgramError::Source(vec![ProgramFault { place, cause, hint }])
    }
}

fn signal(name: &str, about: Option<String>) -> Signal {
    Signal { key: name.to_owned().into(), about: about.unwrap_or_default(), values: Values::Bool, preset: None }
}

/// The function blocks of a file, those in namespaces too.
fn blocks(declarations: &[Declaration]) -> Box<dyn Iterator<Item = &Pou> + '_> {
    Box::new(declarations.iter().flat_map(|declaration| -> Box<dyn Iterator<Item = &Pou>> {
        match declaration {
            Declaration::Pou(pou) if pou.kind == PouKind::FunctionBlock => Box::new(std::iter::once(pou)),
            Declaration::Namespace(namespace) => blocks(&namespace.declarations),
            _ => Box::new(std::iter::empty()),
        }
    }))
}

/// A setting as program text.
fn literal(setting: Setting) -> String {
    match setting {
        Setting::Flag(flag) => if flag { "TRUE" } else { "FALSE" }.to_owned(),
        Setting::Count(whole) => whole.to_string(),
        Setting::Number(number) => {
            // a real literal has a point, before an exponent too (2nd ed. 2.2.1)
            let text = format!("{number:?}");
            match text.split_once('e') {
                Some((mantissa, exponent)) if !mantissa.contains('.') => format!("{mantissa}.0e{exponent}"),
                _ => text,
            }
        }
        // no parameter of a block is a word
        Setting::Choice(word) => word.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_literals_of_the_standard() {
        let numbers = [0.1, 1e-300, 5e22, -2.5e-9, 3.0, f64::MAX];
        let texts: Vec<_> = numbers.iter().map(|number| literal(Setting::Number(*number))).collect();
        assert!(texts.iter().all(|text| text.contains('.')), "{texts:?}");
        let back: Vec<f64> = texts.iter().map(|text| text.parse().unwrap()).collect();
        assert_eq!(back, numbers);
    }
}
