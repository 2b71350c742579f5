//! A project's CONFIGURATION (2nd ed. 2.7): its tasks are read, the scheduler is put into it.

use onescan_base::TimeSpan;

use super::marks;
use super::single;
use super::tasks::{self, ALWAYS, TaskTable};
use onescan_iec::diagnostic::{Code, Diagnostic};
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::SourceFile;
use onescan_iec::syntax::ast::{Configuration, Connection, Ident, Resource, TaskDeclaration};
use onescan_iec::syntax::constant::{self, Constant, Constants};
use onescan_iec::syntax::lexer::tokenize_in;
use onescan_iec::task_plan::Task;

/// The name of an instance of a program, as tasks have it.
pub(super) fn entry_name(resource: &Resource, instance: &Ident) -> String {
    match &resource.name {
        Some((name, _)) => format!("{}.{}", name.text, instance.text),
        None => instance.text.clone(),
    }
}

/// The tasks of all resources; programs without one are due at every grant, behind all others.
///
/// # Errors
/// A task that the scheduler cannot stand for.
pub(super) fn tasks(configuration: &Configuration, constants: &Constants<'_>) -> Result<Vec<Task>, Diagnostic> {
    let mut tasks = Vec::new();
    let mut background = Vec::new();
    for resource in &configuration.resources {
        let first = tasks.len();
        for declared in &resource.tasks {
            let mut task = task(declared, constants)?;
            task.single = single::number(configuration, declared).map(single::input);
            if let Some((name, _)) = &resource.name {
                task.name = format!("{}.{}", name.text, task.name);
            }
            tasks.push(task);
        }
        for program in &resource.programs {
            if let Some(Connection::Task(_, name)) =
                program.connections.iter().find(|each| matches!(each, Connection::Task(..)))
            {
                return Err(unsupported(name, "a function block with a task of its own"));
            }
            let own = program
                .task
                .as_ref()
                .and_then(|wanted| resource.tasks.iter().position(|task| task.name.key() == wanted.key()));
            let name = entry_name(resource, &program.name);
            match own.and_then(|at| tasks.get_mut(first + at)) {
                Some(task) => task.programs.push(name),
                None => background.push(name),
            }
        }
        // One that says nothing of when it is due runs all the time.
        let (mut free, rest): (Vec<_>, Vec<_>) =
            tasks.split_off(first).into_iter().partition(|task| task.interval.is_none() && task.single.is_none());
        tasks.extend(rest);
        free.sort_by_key(|task| task.priority);
        background.extend(free.into_iter().flat_map(|task| task.programs));
    }
    if !background.is_empty() {
        let priority = tasks.iter().map(|task| task.priority).max().unwrap_or(0).saturating_add(1);
        let name = "background".to_owned();
        tasks.push(Task { name, interval: Some(ALWAYS), priority, programs: background, ..Task::default() });
    }
    Ok(tasks)
}

fn task(declared: &TaskDeclaration, constants: &Constants<'_>) -> Result<Task, Diagnostic> {
    let mut task = Task { name: declared.name.text.clone(), ..Task::default() };
    for (input, given) in &declared.inputs {
        match (input.key().as_str(), constant::value(given, constants)) {
            ("INTERVAL", Some(Constant::Duration(ns))) => {
                let ns = u64::try_from(ns).map_err(|_| unsupported(input, "INTERVAL below 0"))?;
                task.interval = TimeSpan::from_nanos(ns);
            }
            ("PRIORITY", Some(Constant::Integer(rank))) => {
                task.priority = u32::try_from(rank).map_err(|_| unsupported(input, "PRIORITY below 0"))?;
            }
            ("SINGLE", _) if single::is_source(given) => {}
            ("SINGLE", _) => return Err(unsupported(input, "SINGLE other than a variable")),
            (name, _) => return Err(unsupported(input, &format!("{name} other than a constant"))),
        }
    }
    Ok(task)
}

fn unsupported(place: &Ident, what: &str) -> Diagnostic {
    let message = format!("{what} is not instrumented yet");
    Diagnostic::error(Code::UnsupportedFeature, place.span, message)
}

/// Puts the scheduler, and the shim's variables, into the configuration.
pub(super) fn attach(
    configuration: &Configuration,
    tasks: &TaskTable<'_>,
    globals: &str,
    file: &SourceFile,
    edits: &mut Edits,
) {
    let text = file.text();
    let line_break = marks::line_break(text);
    let name = configuration.name.span.end;
    let semicolon = u32::from(rest(text, name).starts_with(';'));
    edits.insert(marks::line_end(text, name + semicolon), marks::lines(globals, line_break));
    let Some(resource) = configuration.resources.iter().find(|resource| !resource.programs.is_empty()) else {
        return;
    };
    let Some(program) = resource.programs.first() else { return };
    let interval = tasks::literal(tasks.shortest);
    let cycle = format!("    TASK SDSP_Cycle (INTERVAL := {interval}, PRIORITY := 0);");
    let reported = single::connections(configuration, resource, file);
    let run = format!("    PROGRAM SDSP WITH SDSP_Cycle : SDSP_Scheduler{reported};");
    let before_program = marks::line_start(text, program.span.start);
    match resource.tasks.first() {
        Some(task) => {
            let keyword = token_before(file, task.name.span.start).unwrap_or(task.name.span.start);
            edits.insert(marks::line_start(text, keyword), marks::lines(&cycle, line_break));
            edits.insert(before_program, marks::lines(&run, line_break));
        }
        None => edits.insert(before_program, marks::lines(&format!("{cycle}\n{run}"), line_break)),
    }
    number(configuration, tasks, file, edits);
    single::attach(configuration, file, edits);
}

/// Gives each of several instances of a program its number.
fn number(configuration: &Configuration, tasks: &TaskTable<'_>, file: &SourceFile, edits: &mut Edits) {
    for resource in &configuration.resources {
        for program in &resource.programs {
            let name = entry_name(resource, &program.name);
            let Some(number) = tasks.number_of_instance(&name) else { continue };
            let behind = program.program.span.end;
            let open = token_behind(file, behind).filter(|next| file.text().get(next.clone()) == Some("("));
            let (at, reported) = match (open, program.connections.is_empty()) {
                (None, _) => (behind, format!("(SDSP_Number := {number})")),
                (Some(open), true) => (open.end as u32, format!("SDSP_Number := {number}")),
                (Some(open), false) => (open.end as u32, format!("SDSP_Number := {number},")),
            };
            edits.insert(at, marks::inline(&reported));
        }
    }
}

fn rest(text: &str, from: u32) -> &str {
    text.get(from as usize..).unwrap_or("")
}

/// The first token behind `at` that is not a blank or comment.
fn token_behind(file: &SourceFile, at: u32) -> Option<std::ops::Range<usize>> {
    let tokens = tokenize_in(file.dialect(), file.text());
    let behind = tokens.iter().find(|token| token.start >= at && !token.kind.is_trivia());
    behind.map(|token| token.start as usize..token.end as usize)
}

/// Where the last token before `at` begins that is not a blank or comment.
fn token_before(file: &SourceFile, at: u32) -> Option<u32> {
    let tokens = tokenize_in(file.dialect(), file.text());
    let before = tokens.iter().rev().find(|token| token.end <= at && !token.kind.is_trivia());
    before.map(|token| token.start)
}
