//! A kind of component of the user's own: a function block (IEC 61131-3), which the soft PLC runs once a turn.
//!
//! | of the block | of the kind |
//! |---|---|
//! | the comment in front of it | its summary |
//! | `VAR_INPUT` | its inputs, with their initial values as presets |
//! | `VAR_OUTPUT` | its outputs |
//! | `VAR CONSTANT` with a comment beside it | its parameters |
//! | a BOOL of `VAR_INPUT` called `fail_…` | a failure mode |
//! | the input `dt_s` | no input: the period of the plant, s |
//!
//! The block runs in the first half of a turn, before the world moves, on the virtual time of the turn's end. So its
//! timers are those of a PLC whose task has the plant's period.
//!
//! | module | subject |
//! |---|---|
//! | `interface` | what a block declares, as a kind |
//! | `socket` | where a signal lies in the block's memory |
//! | `running` | a block at work |

mod interface;
mod running;
mod socket;

use std::sync::Arc;

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Finding, Input, Severity, Task, TaskPlan};
use onescan_iec_run::{Application, BuildError, RunError, SoftPlc};
use onescan_server::time::TimeSpan;
use thiserror::Error;

use super::behaviour::Running;
use super::declare::Value;
use super::kind::{Kind, Setting};
use crate::file_place::{Place, Source};
use interface::Interface;
use running::{Block, Sockets};

/// The program that holds the block, and what the block is called in it. A name that no user's program has by chance.
const HOLDER: &str = "Onescan_Component";
const INSTANCE: &str = "block";

/// A function block as a kind.
pub(crate) struct Program {
    interface: Interface,
    /// The file, and the program around the block.
    inputs: [Input; 2],
    code: String,
    /// Compiled with the settings of a component, or with the presets.
    application: Application,
}

/// Why a function block is not a kind, or no component can be made of it.
#[derive(Clone, Debug, PartialEq, Error)]
pub(crate) enum ProgramError {
    #[error("{}", first(.0))]
    Source(Vec<ProgramFault>),
    #[error("{0}")]
    Run(#[from] RunError),
}

/// One thing that is wrong with the file of a function block.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ProgramFault {
    pub(crate) place: Place,
    pub(crate) cause: String,
    pub(crate) hint: Option<String>,
}

fn first(faults: &[ProgramFault]) -> String {
    let Some(ProgramFault { place, cause, .. }) = faults.first() else { return "it does not compile".to_owned() };
    format!("{} line {}: {cause}", place.source.file, place.start().line)
}

impl Program {
    /// The kind `name` out of the file that defines the function block of that name.
    ///
    /// # Errors
    /// All that is wrong with the file.
    pub(crate) fn read(name: &str, file: &str, kind: SourceKind, bytes: &[u8]) -> Result<Self, ProgramError> {
        let input = Input::read(file, kind, bytes);
        let interface = Interface::of(name, &input)?;
        let holder =
            format!("PROGRAM {HOLDER}\nVAR\n{INSTANCE} : {};\nEND_VAR\n{INSTANCE}();\nEND_PROGRAM\n", interface.block);
        let inputs = [input, Input::from_text("the component", SourceKind::Text, holder)];
        let application = compiled(&inputs, &[])?;
        let plc = SoftPlc::new(&application, &plan(TimeSpan::millis::<1>()))?;
        let interface = interface.with_presets(&plc)?;
        let code = blake3::hash(bytes).to_hex().to_string();
        Ok(Self { interface, inputs, code, application })
    }

    pub(crate) fn kind(&self) -> &Kind {
        &self.interface.kind
    }

    /// A digest of the file.
    pub(crate) fn code(&self) -> &str {
        &self.code
    }

    /// The same with the settings of a component in the place of the presets.
    ///
    /// # Errors
    /// Settings with which the block does not compile.
    pub(crate) fn settled(&self, settings: &[Setting]) -> Result<Arc<Self>, ProgramError> {
        let constants = self.interface.constants(settings);
        let application =
            if constants.is_empty() { self.application.clone() } else { compiled(&self.inputs, &constants)? };
        let Self { interface, inputs, code, .. } = self;
        Ok(Arc::new(Self { interface: interface.clone(), inputs: inputs.clone(), code: code.clone(), application }))
    }

    /// What its inputs hold where nothing is connected.
    pub(crate) fn unconnected(&self) -> Vec<Value> {
        let inputs = self.interface.kind.inputs.iter();
        inputs.map(|input| input.preset.and_then(Value::of).unwrap_or(Value::zero(input.values))).collect()
    }

    /// A component, in its first turn.
    ///
    /// # Errors
    /// None that a checked scene could cause.
    pub(crate) fn start(&self, period: TimeSpan) -> Result<Box<dyn Running>, ProgramError> {
        let plc = SoftPlc::new(&self.application, &plan(period))?;
        let sockets = Sockets::find(&self.application, &self.interface)?;
        Ok(Box::new(Block::new(plc, sockets, self.interface.kind.clone())))
    }
}

/// One task with the plant's period.
fn plan(period: TimeSpan) -> TaskPlan {
    let (name, programs) = ("plant".to_owned(), vec![HOLDER.to_owned()]);
    TaskPlan::new(vec![Task { name, interval: Some(period), programs, ..Task::default() }])
}

fn compiled(inputs: &[Input; 2], constants: &[(String, String)]) -> Result<Application, ProgramError> {
    let builder = Application::builder().inputs(inputs.iter().cloned());
    let builder = constants.iter().fold(builder, |builder, (path, literal)| builder.constant(path, literal));
    builder.build().map_err(|error| match error {
        BuildError::Sources(found) => {
            let errors = found.findings().iter().filter(|finding| finding.diagnostic().severity == Severity::Error);
            ProgramError::Source(faults(inputs, errors))
        }
        BuildError::Constant(error) => {
            let place = Place { source: source(&inputs[0]), span: 0..0 };
            ProgramError::Source(vec![ProgramFault { place, cause: error.to_string(), hint: None }])
        }
    })
}

/// A file as its author sees it.
fn source(input: &Input) -> Arc<Source> {
    Arc::new(Source { file: input.file().name().to_owned(), text: Arc::clone(input.file().shown_text()) })
}

/// Most faults of one file that are reported: what follows from the first ones helps nobody.
const FAULTS_MAX: usize = 50;

/// What was found as faults of the files. All of a file share its text, which there may be much of.
fn faults<'f>(inputs: &[Input; 2], found: impl Iterator<Item = &'f Finding>) -> Vec<ProgramFault> {
    let sources = inputs.each_ref().map(source);
    let faults = found.take(FAULTS_MAX).map(|finding| {
        let diagnostic = finding.diagnostic();
        let of_file = sources.iter().find(|source| source.file == finding.file());
        let source = Arc::clone(of_file.unwrap_or(&sources[0]));
        let span = diagnostic.span.start as usize..diagnostic.span.end as usize;
        let place = Place { source, span };
        ProgramFault { place, cause: diagnostic.message.clone(), hint: diagnostic.help.clone() }
    });
    faults.collect()
}
