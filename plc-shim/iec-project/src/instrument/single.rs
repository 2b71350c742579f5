//! Tasks with SINGLE (2nd ed. 2.7.2, Table 50): the scheduler sees their edges, and starts them.
//!
//! A program runs on its turn, a task with SINGLE at an edge: if the two did not come together, neither would
//! run it. So a task of a CONFIGURATION waits for an event of the shim in SINGLE's place, `SDSP_Event_1`, ...:
//! for a grant the scheduler raises it; otherwise it is what SINGLE is, copied at the end of every task by a
//! program of the shim, since an edge may come and go within a scan.

use super::marks;
use super::target::Target;
use super::template;
use onescan_iec::diagnostic::{Code, Diagnostic};
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::SourceFile;
use onescan_iec::syntax::ast::{Configuration, Expr, ExprKind, Ident, Resource, Section, TaskDeclaration};
use onescan_iec::syntax::lexer::tokenize_in;
use onescan_iec::syntax::token::{Punctuation, TokenKind};
use onescan_iec::task_plan::Task;
use onescan_iec_run::run::RunError;

/// What the scheduler reads for a task.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Single {
    /// A global variable; whoever gave the tasks starts them.
    Global(String),
    /// Its input of this number, which the configuration connects; an event of this number starts the task.
    Input(usize),
}

/// Tasks that are given in the place of the project's own: the scheduler reads their SINGLE as a global variable.
///
/// # Errors
/// It cannot.
pub(super) fn check_given(
    tasks: &[Task],
    is_global: impl Fn(&str) -> bool,
    (target, is_xml): (Target, bool),
) -> Result<(), RunError> {
    for task in tasks {
        let Some(path) = &task.single else { continue };
        let reason = match target {
            Target::TwinCat => "tasks of TwinCAT are cyclic",
            Target::OpenPlc | Target::Beremiz => "MatIEC connects nothing to the inputs of a program",
            Target::Scl => "SCL does not say what starts an organization block",
            Target::Codesys if is_xml => "it is not instrumented in PLCopen XML yet",
            Target::Iec | Target::Codesys if !is_global(path) => "the scheduler reads a global variable",
            Target::Iec | Target::Codesys => continue,
        };
        let (task, path, reason) = (task.name.clone(), path.clone(), reason.to_owned());
        return Err(RunError::Trigger { task, path, reason });
    }
    Ok(())
}

/// The configuration's own tasks with SINGLE where others are given: the PLC would start those at their edges.
pub(super) fn refused_beside(configurations: &[&Configuration]) -> Option<Diagnostic> {
    let found = refused(configurations, "a task with SINGLE is not instrumented where other tasks are given")?;
    Some(found.with_help("leave it to the configuration which tasks there are"))
}

/// What other forms than program text of the standard's own have no place for.
pub(super) fn refused_elsewhere(configurations: &[&Configuration]) -> Option<Diagnostic> {
    let found = refused(configurations, "a task with SINGLE is instrumented in program text for the target iec only")?;
    Some(found.with_help("give the task an INTERVAL, or choose that target"))
}

fn refused(configurations: &[&Configuration], message: &str) -> Option<Diagnostic> {
    let (_, task, _) = configurations.iter().find_map(|configuration| triggered(configuration).next())?;
    Some(Diagnostic::error(Code::UnsupportedFeature, task.name.span, message))
}

/// Name of the scheduler's input for a configuration's task.
const INPUT: &str = "SDSP_Single_";

impl Single {
    /// What a task's `single` says.
    pub(super) fn of(path: &str) -> Self {
        let number = path.strip_prefix(INPUT).and_then(|number| number.parse().ok());
        number.map_or_else(|| Self::Global(path.to_owned()), Self::Input)
    }

    fn name(&self) -> String {
        match self {
            Self::Global(name) => name.clone(),
            Self::Input(number) => input(*number),
        }
    }
}

/// The scheduler's input of this number.
pub(super) fn input(number: usize) -> String {
    format!("{INPUT}{number}")
}

/// What a task waits for in SINGLE's place.
fn event(number: usize) -> String {
    format!("SDSP_Event_{number}")
}

/// A template with its lines for tasks with SINGLE: those of the rows of the task table, by the row's number.
pub(super) fn fill(template: &str, singles: &[(usize, &Single)]) -> String {
    let names = |(row, single): &(usize, &Single)| {
        let event = if let Single::Input(number) = single { event(*number) } else { String::new() };
        vec![("SDSP_ROW", row.to_string()), ("SDSP_SINGLE", single.name()), ("SDSP_EVENT", event)]
    };
    let mut inputs: Vec<_> = singles.iter().filter(|(_, single)| matches!(single, Single::Input(_))).collect();
    inputs.sort_by_key(|(_, single)| *single);
    let mut globals: Vec<_> = singles.iter().filter(|(_, single)| matches!(single, Single::Global(_))).collect();
    globals.sort_by_key(|(_, single)| single.name().to_ascii_uppercase());
    globals.dedup_by_key(|(_, single)| single.name().to_ascii_uppercase());
    let all = singles.iter().map(names).collect();
    let inputs: Vec<_> = inputs.into_iter().map(names).collect();
    let globals = globals.into_iter().map(names).collect();
    let kinds = [("each", all), ("input", inputs.clone()), ("external", globals), ("event", inputs)];
    kinds.iter().fold(template.to_owned(), |text, (kind, every)| template::repeat(&text, kind, every))
}

/// A configuration's tasks with SINGLE, in their order, with their resource.
fn triggered(configuration: &Configuration) -> impl Iterator<Item = (&Resource, &TaskDeclaration, &Expr)> {
    let tasks = configuration.resources.iter().flat_map(|each| each.tasks.iter().map(move |task| (each, task)));
    tasks.filter_map(|(resource, task)| Some((resource, task, expression(task)?)))
}

fn expression(task: &TaskDeclaration) -> Option<&Expr> {
    task.inputs.iter().find(|(input, _)| input.key() == "SINGLE").map(|(_, value)| value)
}

/// Those of them that run a program, with their numbers.
fn running(configuration: &Configuration) -> impl Iterator<Item = (usize, &Resource, &Expr)> {
    let numbered = triggered(configuration).enumerate();
    numbered
        .filter(|(_, (resource, task, _))| runs(resource, task))
        .map(|(at, (owner, _, value))| (at + 1, owner, value))
}

/// True if a task has a program.
fn runs(resource: &Resource, task: &TaskDeclaration) -> bool {
    let is_it = |wanted: &Ident| wanted.key() == task.name.key();
    resource.programs.iter().any(|program| program.task.as_ref().is_some_and(is_it))
}

/// Number of a task among those with SINGLE, from 1.
pub(super) fn number(configuration: &Configuration, task: &TaskDeclaration) -> Option<usize> {
    triggered(configuration).position(|(_, other, _)| std::ptr::eq(other, task)).map(|at| at + 1)
}

/// True for what SINGLE may be: a variable by its path, or a direct address (2nd ed. B.1.7, `data_source`).
pub(super) fn is_source(value: &Expr) -> bool {
    match &value.kind {
        ExprKind::Name(_) | ExprKind::DirectAddress(_) => true,
        ExprKind::Member(base, _) | ExprKind::Index(base, _) => is_source(base),
        _ => false,
    }
}

/// Lets the tasks wait for events, and a program at the end of each task pass on what SINGLE is.
pub(super) fn attach(configuration: &Configuration, file: &SourceFile, edits: &mut Edits) {
    for (number, _, value) in running(configuration) {
        let at = value.span.start..value.span.end;
        edits.replace(at, marks::renamed(&event(number), written(file, value)));
    }
    if running(configuration).next().is_none() {
        return;
    }
    let mut number = 0;
    for resource in &configuration.resources {
        let reported = connections(configuration, resource, file);
        let tasks = resource.tasks.iter().filter(|task| runs(resource, task));
        let mut homes: Vec<String> = tasks.map(|task| format!(" WITH {}", task.name.text)).collect();
        homes.extend(resource.programs.iter().any(|program| program.task.is_none()).then(String::new));
        let followers = homes.iter().map(|home| {
            number += 1;
            format!("    PROGRAM SDSP_Follow_{number}{home} : SDSP_Follow{reported};\n")
        });
        let followers: String = followers.collect();
        if let Some(last) = resource.programs.last().filter(|_| !followers.is_empty()) {
            let at = marks::line_end(file.text(), statement_end(file, last.program.span.end));
            edits.insert(at, marks::lines(&followers, marks::line_break(file.text())));
        }
    }
}

/// What connects a program of the shim in `viewer` to all SINGLE inputs; nothing if there are none.
pub(super) fn connections(configuration: &Configuration, viewer: &Resource, file: &SourceFile) -> String {
    let reported = running(configuration).map(|(number, owner, value)| {
        let seen = seen_from(viewer, owner, value, written(file, value));
        format!("{} := {seen}", input(number))
    });
    let reported: Vec<String> = reported.collect();
    if reported.is_empty() { String::new() } else { format!("({})", reported.join(", ")) }
}

fn written<'t>(file: &'t SourceFile, value: &Expr) -> &'t str {
    file.text().get(value.span.start as usize..value.span.end as usize).unwrap_or("")
}

/// A path of resource `owner` as `viewer` writes it: what is the owner's has its name in front.
fn seen_from(viewer: &Resource, owner: &Resource, value: &Expr, written: &str) -> String {
    let name = |resource: &Resource| resource.name.as_ref().map(|(name, _)| name.clone());
    match (name(owner), first_name(value)) {
        (Some(owner_name), Some(first)) if !std::ptr::eq(viewer, owner) && has(owner, &first) => {
            format!("{}.{written}", owner_name.text)
        }
        _ => written.to_owned(),
    }
}

/// The name with which a path begins.
fn first_name(value: &Expr) -> Option<String> {
    match &value.kind {
        ExprKind::Name(name) => Some(name.key()),
        ExprKind::Member(base, _) | ExprKind::Index(base, _) => first_name(base),
        _ => None,
    }
}

/// True if a resource has a variable or program of its own by this name.
fn has(resource: &Resource, key: &str) -> bool {
    let declares =
        |section: &Section| section.variables.iter().flat_map(|each| &each.names).any(|each| each.key() == key);
    resource.sections.iter().any(declares) || resource.programs.iter().any(|program| program.name.key() == key)
}

/// Behind the semicolon that comes next.
fn statement_end(file: &SourceFile, from: u32) -> u32 {
    let tokens = tokenize_in(file.dialect(), file.text());
    let is_end = |kind| kind == TokenKind::Punctuation(Punctuation::Semicolon);
    tokens.iter().find(|token| token.start >= from && is_end(token.kind)).map_or(from, |token| token.end)
}
