//! PLC sources: variables with an address in %I and %Q, and the inputs and outputs of programs.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use onescan_iec::Input;
use onescan_iec::input::kind::FileKind;
use onescan_iec::syntax::remark::Remarks;
use onescan_iec_run::{Application, BuildError, Variable, VariableAccess};
use onescan_server::time::TimeSpan;

use super::collect::{Collected, Entry};
use super::error::ListError;
use super::flatten::Nothing;
use super::point::Direction;
use super::{IoList, ListKind};
use onescan_regress::check::collect::{Reading, programs};

/// The sources that a list was read from: they run in the scenario.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sources {
    pub files: Vec<PathBuf>,
    /// The programs, if nothing in the files says when they run.
    pub programs: Vec<String>,
    /// The variable of each point that is called otherwise, by the point's name.
    pub variables: BTreeMap<String, String>,
}

/// Reads the sources in a file or folder.
///
/// # Errors
/// They do not compile.
pub fn read(path: &Path) -> Result<IoList, ListError> {
    let other = |what: String, help: String| {
        let file = path.display().to_string();
        ListError::Other { file, what, help: Some(help) }
    };
    let mut found = programs(&[path.to_owned()], Reading::default())?;
    let (Some(program), true) = (found.pop(), found.is_empty()) else {
        return Err(other(
            "there are several PLCs here".to_owned(),
            "name the folder with the sources of one".to_owned(),
        ));
    };
    let files = program.inputs.iter().map(|input| PathBuf::from(input.file().name()));
    let files: Vec<_> = files.filter(|file| matches!(FileKind::of(file), Some(FileKind::Source(_)))).collect();
    let remarks = Remarks::of(program.inputs.iter().map(Input::file));
    let built = Application::builder().memory_limit(program.memory_limit).inputs(program.inputs).build();
    let application = built.map_err(|error| {
        let first = match &error {
            BuildError::Sources(found) => found.iter().map(|found| found.message.clone()).next(),
            BuildError::Constant(_) => None,
        };
        let what = format!("the sources do not compile: {}", first.unwrap_or_else(|| error.to_string()));
        other(what, format!("`onescan check {}` shows what is wrong", path.display()))
    })?;
    let mut taken =
        Taken { collected: Collected::of(path), remarks, variables: BTreeMap::new(), names: BTreeSet::new() };
    taken.located(&application)?;
    taken.of_programs(&application)?;
    let plan = program.plan.or_else(|| application.configured_tasks());
    // A step that every task's interval is a multiple of.
    let intervals = plan.iter().flat_map(|plan| &plan.tasks).filter_map(|task| task.interval);
    let cycle = intervals.map(TimeSpan::as_nanos).reduce(common_divisor).and_then(TimeSpan::from_nanos);
    let entries = application.programs().filter(|program| !program.is_called).map(|program| program.name);
    let programs: Vec<_> = if plan.is_none() { entries.collect() } else { Vec::new() };
    // Variables alone do not run.
    let runs = plan.is_some() || !programs.is_empty();
    let sources = runs.then_some(Sources { files, programs, variables: taken.variables });
    Ok(IoList { cycle, sources, ..taken.collected.list(ListKind::Sources) })
}

struct Taken {
    collected: Collected,
    remarks: Remarks,
    variables: BTreeMap<String, String>,
    /// Names in capitals, and paths of variables.
    names: BTreeSet<String>,
}

impl Taken {
    /// Everything that has an address in the I/O image.
    fn located(&mut self, application: &Application) -> Result<(), ListError> {
        let mut places = BTreeSet::new();
        for leaf in application.leaves() {
            let Some((root, address)) = home(application, &leaf) else { continue };
            let Some(direction) = direction(&address) else { continue };
            // A variable that a program declares as external is the global one once more.
            if !places.insert((leaf.offset, leaf.bit)) {
                continue;
            }
            let of_whole = (root == leaf.path).then_some(address.as_str());
            self.take(&leaf.path, &leaf, direction, of_whole)?;
        }
        Ok(())
    }

    /// What programs take in and give out. An input that another program of the PLC feeds is not an input of the PLC.
    fn of_programs(&mut self, application: &Application) -> Result<(), ListError> {
        let programs: Vec<_> = application.programs().filter(|program| !program.is_called).collect();
        let short = |variable: &Variable| variable.path.rsplit('.').next().unwrap_or_default().to_ascii_uppercase();
        let given: BTreeSet<_> = programs.iter().flat_map(|program| &program.outputs).map(short).collect();
        for program in &programs {
            let inputs = program.inputs.iter().map(|variable| (variable, Direction::Input));
            for (variable, direction) in inputs.chain(program.outputs.iter().map(|each| (each, Direction::Output))) {
                if direction == Direction::Input && given.contains(&short(variable)) {
                    let line = self.remarks.line(&variable.path);
                    self.collected.leave_out(&variable.path, "another program of the PLC writes it", line);
                    continue;
                }
                self.parts(application, &program.name, variable, direction)?;
            }
        }
        Ok(())
    }

    fn parts(
        &mut self,
        application: &Application,
        program: &str,
        variable: &Variable,
        direction: Direction,
    ) -> Result<(), ListError> {
        if variable.signal_type.is_some() {
            let name = variable.path.get(program.len() + 1..).unwrap_or(&variable.path).to_owned();
            return self.take(&name, variable, direction, None);
        }
        let is_part =
            |leaf: &Variable| leaf.path.strip_prefix(&variable.path).is_some_and(|rest| rest.starts_with(['.', '[']));
        for leaf in application.leaves().filter(is_part) {
            self.take(&leaf.path.clone(), &leaf, direction, None)?;
        }
        Ok(())
    }

    fn take(
        &mut self,
        name: &str,
        leaf: &Variable,
        direction: Direction,
        address: Option<&str>,
    ) -> Result<(), ListError> {
        // The same input of several programs is one; an output of the same name is not.
        let known = self.names.contains(&name.to_ascii_uppercase());
        if self.names.contains(&format!(" {}", leaf.path)) || (known && direction == Direction::Input) {
            return Ok(());
        }
        let name = if known { leaf.path.as_str() } else { name };
        let (line, comment) = (self.remarks.line(&leaf.path), self.remarks.comment(&leaf.path));
        if leaf.access != VariableAccess::ReadWrite {
            self.collected.leave_out(&leaf.path, "it is constant", line);
            return Ok(());
        }
        let ty = leaf.signal_type.map_or_else(|| leaf.type_name.clone(), |ty| ty.to_string());
        let comment = comment.as_deref();
        self.collected.take(&Entry { name, ty: &ty, direction, address, comment, line }, &Nothing)?;
        self.names.extend([name.to_ascii_uppercase(), format!(" {}", leaf.path)]);
        self.variables.insert(name.to_owned(), leaf.path.clone());
        Ok(())
    }
}

/// The variable with an address that a leaf is, or is a part of.
fn home(application: &Application, leaf: &Variable) -> Option<(String, String)> {
    if let Some(address) = &leaf.address {
        return Some((leaf.path.clone(), address.clone()));
    }
    let ends = leaf.path.match_indices(['.', '[']).map(|(end, _)| end);
    ends.filter_map(|end| {
        let root = leaf.path.get(..end)?;
        Some((root.to_owned(), application.variable(root).ok()?.address?))
    })
    .next_back()
}

fn common_divisor(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { common_divisor(b, a % b) }
}

fn direction(address: &str) -> Option<Direction> {
    match address.get(1..2)? {
        "I" | "i" => Some(Direction::Input),
        "Q" | "q" => Some(Direction::Output),
        _ => None,
    }
}
