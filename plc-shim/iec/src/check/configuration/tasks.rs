//! Tasks and their inputs (2nd ed. 2.7.2, Table 50; 3rd ed. Table 63).

use onescan_base::TimeSpan;

use super::Configurer;
use crate::check::body::Body;
use crate::diagnostic::{Code, Diagnostic, did_you_mean};
use crate::dialect::{Dialect, Feature};
use crate::ir::{ElementaryType, Task, Value};
use crate::syntax::ast::{self, Expr, ExprKind, Ident, Literal, TaskDeclaration};

/// The inputs of a task.
const INPUTS: [&str; 3] = ["SINGLE", "INTERVAL", "PRIORITY"];

impl<'a> Configurer<'_, 'a> {
    /// The tasks of a resource, each in its place, wrong or not.
    pub(super) fn tasks(&mut self, resource: &'a ast::Resource, index: usize) -> Vec<Task> {
        let names: Vec<&Ident> = resource.tasks.iter().map(|task| &task.name).collect();
        self.declarations.report_twins(&names);
        resource.tasks.iter().map(|task| self.task(task, index)).collect()
    }

    fn task(&mut self, ast: &'a TaskDeclaration, resource: usize) -> Task {
        let home = self.resource_name(resource).map(|home| format!("{}.", home.text));
        let mut task = Task {
            name: format!("{}{}", home.unwrap_or_default(), ast.name.text),
            single: None,
            interval: None,
            priority: 0,
            entries: Vec::new(),
        };
        let known = self.declarations.mark();
        for (at, (name, value)) in ast.inputs.iter().enumerate() {
            if ast.inputs.iter().take(at).any(|(other, _)| other.key() == name.key()) {
                let message = format!("`{}` is given twice", name.text);
                self.declarations.report(Diagnostic::error(Code::TaskInput, name.span, message));
                continue;
            }
            match name.key().as_str() {
                "INTERVAL" => task.interval = self.interval(value),
                "PRIORITY" => task.priority = self.priority(value).unwrap_or(0),
                // Its variable may be one of a program that is not there yet.
                "SINGLE" => {}
                _ => {
                    let message = format!("a task has no input `{}`", name.text);
                    let help = did_you_mean(&name.text, INPUTS);
                    let found = Diagnostic::error(Code::TaskInput, name.span, message);
                    self.declarations.report(found.with_optional_help(help));
                }
            }
        }
        let is_triggered = ast.inputs.iter().any(|(name, _)| name.key() == "SINGLE");
        if task.interval.is_none() && !is_triggered && self.declarations.mark() == known {
            self.report_never_due(ast);
        }
        task
    }

    /// The standard never runs such a task; tools that run it all the time have their own word for it.
    fn report_never_due(&mut self, ast: &TaskDeclaration) {
        let (name, dialect) = (&ast.name, self.declarations.dialect(ast.name.span));
        if !is_free(ast, dialect) {
            let message = format!("task `{}` has neither SINGLE nor an INTERVAL, so it never runs", name.text);
            self.declarations.report(Diagnostic::error(Code::TaskNeverRuns, name.span, message));
        } else if dialect == Dialect::Iec3 {
            let message = format!("task `{}` has neither SINGLE nor an INTERVAL, so it runs in each scan", name.text);
            let help = "this is SIMATIC AX's program cycle; by the standard it never runs";
            self.declarations.report(Diagnostic::warning(Code::TaskNeverRuns, name.span, message).with_help(help));
        }
    }

    /// What a task without an interval runs, where tools run that all the time, is run as what has no task: behind the
    /// tasks, in the order of the priorities.
    pub(super) fn free_tasks(&mut self, ast: &ast::Configuration) {
        for (resource, made) in ast.resources.iter().zip(&mut self.configured.resources) {
            let is_free = |task: &TaskDeclaration| is_free(task, self.declarations.dialect(task.name.span));
            let tasks = resource.tasks.iter().zip(std::mem::take(&mut made.tasks));
            let (mut free, rest): (Vec<_>, Vec<_>) = tasks.partition(|(task, _)| is_free(task));
            free.sort_by_key(|(_, task)| task.priority);
            made.background.extend(free.into_iter().flat_map(|(_, task)| task.entries));
            made.tasks = rest.into_iter().map(|(_, task)| task).collect();
        }
    }

    /// Nothing for an interval of 0, which is as good as none.
    fn interval(&mut self, value: &Expr) -> Option<TimeSpan> {
        // A cycle is not a TIME of the program: it may be shorter than what a TIME counts.
        let ns = if let ExprKind::Literal(Literal::Duration { ns, .. }) = &value.kind {
            i128::from(*ns)
        } else {
            let time = Body::outside(self.declarations).constant_of_type(value, ElementaryType::Time.into());
            time.and_then(Value::as_int)?
        };
        if let Ok(ns) = u64::try_from(ns) {
            return TimeSpan::from_nanos(ns);
        }
        self.unsuitable(value, "an interval is not negative")
    }

    fn priority(&mut self, value: &Expr) -> Option<u32> {
        let priority = Body::outside(self.declarations).constant_integer(value)?;
        match u16::try_from(priority) {
            Ok(priority) => Some(u32::from(priority)),
            Err(_) => self.unsuitable(value, "a priority is a UINT; 0 comes first"),
        }
    }

    fn unsuitable<T>(&mut self, value: &Expr, message: &str) -> Option<T> {
        self.declarations.report(Diagnostic::error(Code::TaskInput, value.span, message));
        None
    }

    /// The variables that trigger tasks, when all programs have been placed.
    pub(super) fn resolve_single_inputs(&mut self, ast: &'a ast::Configuration) {
        for (index, resource) in ast.resources.iter().enumerate() {
            for (at, task) in resource.tasks.iter().enumerate() {
                let single = task.inputs.iter().find(|(name, _)| name.key() == "SINGLE");
                let path = single.and_then(|(_, value)| self.single(value, index));
                let made = self.configured.resources.get_mut(index).and_then(|made| made.tasks.get_mut(at));
                if let Some(made) = made {
                    made.single = path;
                }
            }
        }
    }

    fn single(&mut self, value: &Expr, resource: usize) -> Option<String> {
        let target = self.target(value, Some(resource))?;
        if target.ty != ElementaryType::Bool.into() {
            let message = format!("SINGLE is a BOOL, this is {}", self.declarations.types().name(target.ty));
            return self.unsuitable(value, &message);
        }
        Some(target.path)
    }

    /// Position of the task of this name in its resource.
    pub(super) fn task_named(&mut self, resource: &'a ast::Resource, name: &Ident) -> Option<usize> {
        let found = resource.tasks.iter().position(|task| task.name.text.eq_ignore_ascii_case(&name.text));
        if found.is_none() {
            let help = did_you_mean(&name.text, resource.tasks.iter().map(|task| task.name.text.as_str()));
            let message = format!("there is no task `{}` in this resource", name.text);
            self.declarations.report(Diagnostic::error(Code::UnknownTask, name.span, message).with_optional_help(help));
        }
        found
    }
}

/// True for a task that says neither when it is due nor what triggers it, where that means all the time.
fn is_free(task: &TaskDeclaration, dialect: Dialect) -> bool {
    let says_when = |(name, _): &(Ident, Expr)| matches!(name.key().as_str(), "INTERVAL" | "SINGLE");
    dialect.has(Feature::FreeTasks) && !task.inputs.iter().any(says_when)
}
