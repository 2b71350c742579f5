//! All that `[timing]` allows, also of tasks, which are known of PLCs that are made.

use onescan_server::time::TimeSpan;

use crate::error::ScenarioError;
use crate::load::Scenario;
use crate::timing::{LATE_STEPS_MAX, TaskTolerance, TimedTask, TimingTolerance};

impl Scenario {
    /// All that `[timing]` allows. PLCs are compiled if it names tasks.
    ///
    /// # Errors
    /// A task is not there or cannot be late, or a PLC does not compile.
    pub fn timing_tolerances(&self) -> Result<Vec<TimingTolerance>, ScenarioError> {
        let mut all = self.timing().signals.clone();
        for tolerance in &self.timing().tasks {
            self.task_tolerances(tolerance, &mut all)?;
        }
        for (client, steps, place) in &self.timing().starts {
            let plc = self.plc(client)?;
            let late = plc.plc().check_late(None);
            late.map_err(|error| self.wrong_timing(format!("`{client}`: {error}"), place, None))?;
            all.push(TimingTolerance::Start { client: client.clone(), steps: *steps });
        }
        Ok(all)
    }

    fn task_tolerances(&self, tolerance: &TaskTolerance, all: &mut Vec<TimingTolerance>) -> Result<(), ScenarioError> {
        let TaskTolerance { client, written, place } = tolerance;
        let plc = self.plc(client)?;
        let tasks = &plc.plc().plan().tasks;
        let named = match (&written.task, &tasks[..]) {
            (Some(named), _) => named.get_ref().clone(),
            (None, [only]) => only.name.clone(),
            (None, all) => {
                let help = all.first().map(|one| format!("say which, as in `task = \"{}\"`", one.name));
                return Err(self.wrong_timing(format!("`{client}` has {} tasks", all.len()), place, help));
            }
        };
        let late = plc.plc().check_late(Some(&named));
        late.map_err(|error| self.wrong_timing(format!("`{client}`: {error}"), place, None))?;
        let Some((name, interval)) = tasks
            .iter()
            .find(|task| task.name.eq_ignore_ascii_case(&named))
            .and_then(|task| Some((task.name.clone(), task.interval?)))
        else {
            return Ok(());
        };
        let task = TimedTask { client: client.clone(), name, interval };
        let steps = |span: TimeSpan| -> Result<u64, ScenarioError> {
            let steps = span.as_nanos() / self.file().step.as_nanos().max(1);
            if steps == 0 || span >= interval {
                let message = format!(
                    "task `{}` can be late by whole steps of {} that are less than its interval, {interval}; not by {span}",
                    task.name,
                    self.file().step
                );
                let help = "a scan that is late by a whole interval is left out: `two_cycles = true`".to_owned();
                return Err(self.wrong_timing(message, place, Some(help)));
            }
            if steps > LATE_STEPS_MAX {
                let message = format!("task `{}`: {span} is more than {LATE_STEPS_MAX} steps", task.name);
                let help = "`explore` tries each number of steps: allow less".to_owned();
                return Err(self.wrong_timing(message, place, Some(help)));
            }
            Ok(steps)
        };
        if written.late.is_none() && written.phase.is_none() && !written.two_cycles {
            let help = "write `late`, `phase` or `two_cycles = true`".to_owned();
            let message = format!("what task `{}` may do is not said", task.name);
            return Err(self.wrong_timing(message, place, Some(help)));
        }
        let jitter = written.late.map(&steps).transpose()?;
        let phase = written.phase.map(&steps).transpose()?;
        all.extend(jitter.map(|steps| TimingTolerance::Jitter { task: task.clone(), steps }));
        all.extend(phase.map(|steps| TimingTolerance::Phase { task: task.clone(), steps }));
        all.extend(written.two_cycles.then(|| TimingTolerance::TwoCycles { task: task.clone() }));
        Ok(())
    }
}
