//! The forms in which a project takes the shim's own sources.

use super::Options;
use super::clock::Form;
use super::marks;
use super::motion::{self, Part};
use super::motion_use::Motion;
use super::real_inputs::Additions;
use super::target::{Source, Target};
use super::tasks::TaskTable;
use super::template::{self, Only};
use super::twincat;
use onescan_iec::syntax::ast::Pou;

/// The shim's sources for these tasks, and for the sources of time that are replaced.
pub(super) struct Sources {
    /// A type that the variables have.
    line: Option<String>,
    /// Variables, for a configuration or a file of their own.
    pub(super) globals: String,
    /// Data blocks of the signals, in SCL.
    exchange: Option<String>,
    scheduler: String,
    forms: Vec<Unit>,
    motion: Vec<Part>,
}

/// A function block or function.
struct Unit {
    name: String,
    text: String,
}

/// What charts need.
fn chart_units() -> impl Iterator<Item = Unit> {
    let units = [
        ("SDSP_ACTION_CONTROL", template::ACTION_CONTROL),
        ("SDSP_SFC_STEP", template::STEP),
        ("SDSP_ELAPSED", template::ELAPSED),
    ];
    units.into_iter().map(|(name, text)| Unit { name: name.to_owned(), text: text.to_owned() })
}

/// Where the shim's variables are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Globals {
    /// In the project's configuration, where the standard has them (2nd ed. 2.7.1).
    InConfiguration,
    /// In the shim's own file.
    InFile,
}

impl Sources {
    pub(super) fn new(
        options: &Options,
        tasks: &TaskTable<'_>,
        forms: &[&Form],
        motion: &Motion,
        charts: &[&Pou],
        exchange: Option<String>,
    ) -> Self {
        let Options { target, layout, .. } = *options;
        let is_long = forms.iter().any(|form| form.long).then_some(Only::LongTime);
        let wanted: Vec<Only> = is_long.into_iter().chain(exchange.is_some().then_some(Only::Exchange)).collect();
        let mut names = tasks.names();
        let sizes = [("SDSP_PROGRAMS", tasks.programs.len().to_string())];
        // A TIME has nanoseconds in the one and milliseconds in the other. Only durations of whole seconds are exact
        // in every tool of the one; a number stands behind a TIME (2nd ed. Table 30).
        let (now, now_long) = match target {
            Target::OpenPlc | Target::Beremiz => ("SDSP_Duration(Value := TV)", "LT#1ns * TV"),
            Target::Iec => ("T#1s * (TV / 1000000000) + T#1s * (TV MOD 1000000000) / 1000000000", "LT#1ns * TV"),
            Target::TwinCat | Target::Codesys => ("LINT_TO_TIME(TV / 1000000)", "LINT_TO_LTIME(TV)"),
            Target::Scl => ("DINT_TO_TIME(LINT_TO_DINT(#TV / 1000000))", "LINT_TO_LTIME(#TV)"),
        };
        names.extend([("SDSP_NOW_OF_TV", now.to_owned()), ("SDSP_NOWL_OF_TV", now_long.to_owned())]);
        names.push(("SDSP_LAYOUT_NUMBER", layout.unwrap_or(0).to_string()));
        let fill = if target == Target::Scl { template::fill_scl } else { template::fill };
        let filled = |template: &str| fill(&template::lines_for(&tasks.with_singles(template), &wanted), &names);
        let unit = |form: &&Form| Unit { name: form.new_name(), text: form.text(target) };
        let (globals, scheduler) = match target {
            Target::Scl => (template::SCL_GLOBALS, template::SCL_SCHEDULER),
            _ if tasks.has_singles() => (template::GLOBALS, template::EVENT_SCHEDULER),
            _ => (template::GLOBALS, template::SCHEDULER),
        };
        let mut units: Vec<Unit> = forms.iter().map(unit).collect();
        if !charts.is_empty() {
            units.extend(chart_units());
        }
        if matches!(target, Target::OpenPlc | Target::Beremiz) {
            units.push(Unit { name: "SDSP_Duration".to_owned(), text: template::DURATION.to_owned() });
        }
        if tasks.has_events() {
            units.push(Unit { name: "SDSP_Follow".to_owned(), text: filled(template::FOLLOW) });
        }
        Self {
            line: tasks.line_declaration().map(|text| template::fill(text, &sizes)),
            globals: filled(globals),
            exchange,
            scheduler: filled(scheduler),
            forms: units,
            motion: motion::parts(target, &motion.blocks, motion.has_groups),
        }
    }

    /// Adds what inputs need that are taken over.
    pub(super) fn add(&mut self, additions: &Additions) {
        if let Some(end) = self.globals.rfind("END_VAR") {
            self.globals.insert_str(end, &additions.globals);
        }
        let Additions { externals, statements, .. } = additions;
        for (line, more) in [("VAR_EXTERNAL\n", externals), ("    IF NOT SDSP_Simulated THEN\n", statements)] {
            self.scheduler = self.scheduler.replacen(line, &format!("{line}{more}"), 1);
        }
    }

    /// The units, for a project that has them in a file of its own.
    pub(super) fn units(&self) -> Vec<String> {
        let forms = self.forms.iter().map(|unit| &unit.text);
        let motion = self.motion.iter().filter(|part| !part.is_type).map(|part| &part.text);
        std::iter::once(&self.scheduler).chain(forms).chain(motion).cloned().collect()
    }

    /// The types beside them.
    pub(super) fn types(&self) -> Vec<String> {
        self.motion.iter().filter(|part| part.is_type).map(|part| part.text.clone()).collect()
    }

    /// The files in which they are.
    pub(super) fn files(self, target: Target, globals: Globals) -> Vec<Source> {
        let own = (globals == Globals::InFile).then_some(self.globals);
        match target {
            Target::Iec | Target::Codesys | Target::Scl | Target::OpenPlc | Target::Beremiz => {
                let forms = self.forms.into_iter().map(|unit| unit.text);
                let motion = self.motion.into_iter().map(|part| part.text);
                let parts: Vec<String> = self
                    .line
                    .into_iter()
                    .chain(own)
                    .chain(self.exchange)
                    .chain([self.scheduler])
                    .chain(forms)
                    .chain(motion)
                    .collect();
                let text = format!("{}\n{}", marks::FILE, parts.join("\n"));
                let name = if target == Target::Scl { "sdsp.scl" } else { "sdsp.st" };
                vec![Source { name: name.to_owned(), text }]
            }
            Target::TwinCat => {
                let own = own.map(|text| twincat::globals("SDSP", &text));
                let scheduler = twincat::unit("SDSP_Scheduler", &self.scheduler);
                let forms = self.forms.iter().map(|unit| twincat::unit(&unit.name, &unit.text));
                let motion = self.motion.iter().map(|part| {
                    if part.is_type {
                        twincat::data_type(&part.name, &part.text)
                    } else {
                        twincat::unit(&part.name, &part.text)
                    }
                });
                own.into_iter().chain([scheduler]).chain(forms).chain(motion).collect()
            }
        }
    }
}
