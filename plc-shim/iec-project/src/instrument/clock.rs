//! What reads the clock (`[SDSP]` sec. V-C), as a table: what replaces it, or what
//! is reported.

use super::foreign::Kind;
use super::target::Target;
use super::{foreign, motion, template};

/// What becomes of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fate {
    /// A source of the shim takes its place; see [`Form`].
    Replaced(&'static Form),
    /// It cannot be replaced.
    Reported,
    /// A block or type of PLCopen's motion control.
    Motion(motion::Role),
}

/// A source of the shim and how it is written for one name.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Form {
    /// The name that is replaced; `SDSP_` and it is the new one.
    pub(super) name: &'static str,
    kind: Kind,
    template: &'static str,
    /// The same in SCL, if SCL has it.
    scl: Option<&'static str>,
    /// The name in the template.
    stem: &'static str,
    pub(super) long: bool,
}

const fn timer(name: &'static str, stem: &'static str, templates: [&'static str; 2], long: bool) -> Form {
    let [template, scl] = templates;
    Form { name, kind: Kind::Block, template, scl: Some(scl), stem, long }
}

const ON_DELAY: [&str; 2] = [template::ON_DELAY, template::SCL_ON_DELAY];
const OFF_DELAY: [&str; 2] = [template::OFF_DELAY, template::SCL_OFF_DELAY];
const PULSE: [&str; 2] = [template::PULSE, template::SCL_PULSE];

const fn function(name: &'static str, long: bool) -> Form {
    Form { name, kind: Kind::Function, template: template::TIME_FUNCTION, scl: None, stem: "TIME", long }
}

/// All that is replaced: 2nd ed. Table 37, 3rd ed. Table 46, the L-forms and functions of CODESYS and
/// TwinCAT.
static FORMS: [Form; 15] = [
    timer("TON", "TON", ON_DELAY, false),
    timer("TON_TIME", "TON", ON_DELAY, false),
    timer("TON_LTIME", "TON", ON_DELAY, true),
    timer("LTON", "TON", ON_DELAY, true),
    timer("TOF", "TOF", OFF_DELAY, false),
    timer("TOF_TIME", "TOF", OFF_DELAY, false),
    timer("TOF_LTIME", "TOF", OFF_DELAY, true),
    timer("LTOF", "TOF", OFF_DELAY, true),
    timer("TP", "TP", PULSE, false),
    timer("TP_TIME", "TP", PULSE, false),
    timer("TP_LTIME", "TP", PULSE, true),
    timer("LTP", "TP", PULSE, true),
    Form { name: "RTC", kind: Kind::Block, template: template::REAL_TIME_CLOCK, scl: None, stem: "RTC", long: false },
    function("TIME", false),
    function("LTIME", true),
];

/// What becomes of the source of time of this name; nothing if it is none.
pub(super) fn fate(key: &str, kind: Kind) -> Option<Fate> {
    if let Some(form) = FORMS.iter().find(|form| form.kind == kind && form.name == key) {
        return Some(Fate::Replaced(form));
    }
    if foreign::find(key, kind).is_some() {
        return Some(Fate::Reported);
    }
    if kind == Kind::Block { motion::role(key).map(Fate::Motion) } else { None }
}

/// The name of the block that takes the place of one of this name.
pub(super) fn replacement(name: &str) -> Option<String> {
    let key = name.to_ascii_uppercase();
    let kinds = [Kind::Block, Kind::Function];
    kinds.into_iter().find_map(|kind| match fate(&key, kind) {
        Some(Fate::Replaced(form)) => Some(form.new_name()),
        _ => None,
    })
}

/// The form of TIME of `TON`, `TOF` or `TP`.
pub(super) fn timer_of_time(kind: &str) -> Option<&'static Form> {
    FORMS.iter().find(|form| form.name.strip_suffix("_TIME") == Some(kind))
}

/// What the shim's action control is made of.
pub(super) fn on_delay() -> &'static Form {
    let [form, ..] = &FORMS;
    form
}

impl Form {
    /// The name that takes its place.
    pub(super) fn new_name(&self) -> String {
        format!("SDSP_{}", self.name)
    }

    /// True if a target's language has what it is replaced by.
    pub(super) fn suits(&self, target: Target) -> bool {
        target != Target::Scl || self.scl.is_some()
    }

    /// The source, written for this name.
    pub(super) fn text(&self, target: Target) -> String {
        match self.scl.filter(|_| target == Target::Scl) {
            Some(template) => self.scl_text(template),
            None => self.standard_text(),
        }
    }

    fn scl_text(&self, template: &str) -> String {
        let stem = format!("\"SDSP_{}\"", self.stem);
        let mut names = vec![(self.stem, self.name.to_owned()), (&stem, format!("\"{}\"", self.new_name()))];
        if self.long {
            let long = [("Time", "LTime"), ("T#0s", "LT#0s"), ("SDSP_Now", "SDSP_NowL")];
            names.extend(long.map(|(short, long)| (short, long.to_owned())));
        }
        template::fill_scl(template, &names)
    }

    fn standard_text(&self) -> String {
        let mut names = vec![(self.stem, self.name.to_owned())];
        let stem = format!("SDSP_{}", self.stem);
        names.push((&stem, self.new_name()));
        if self.long {
            let long = [("TIME", "LTIME"), ("T#0s", "LT#0s"), ("SDSP_Now", "SDSP_NowL")];
            names.extend(long.map(|(short, long)| (short, long.to_owned())));
        }
        template::fill(self.template, &names)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_has_one_fate() {
        assert!(FORMS.iter().all(|form| foreign::find(form.name, form.kind).is_none()));
        assert_eq!(fate("MC_HOME", Kind::Block), Some(Fate::Motion(motion::Role::Block)));
        assert_eq!(fate("CTU", Kind::Block), None);
        assert_eq!(fate("TIME_TCK", Kind::Function), Some(Fate::Reported));
    }

    /// The page shows what the tables say.
    #[test]
    fn the_documented_table_is_this_table() {
        let kind = |kind: Kind| if kind == Kind::Block { "block" } else { "function" };
        let replaced = FORMS.iter().map(|form| {
            let scl = if form.scl.is_some() { "yes" } else { "reported" };
            format!("| `{}` | {} | `{}` | {scl} |", form.name, kind(form.kind), form.new_name())
        });
        let reported = foreign::REPORTED.iter().flat_map(|library| {
            let row = move |(name, of): &(&str, Kind)| format!("| `{name}` | {} | {} |", kind(*of), library.name);
            library.names.iter().map(row)
        });
        let page = include_str!("../../../docs/clocks.md");
        let shown: Vec<_> = page.lines().filter(|line| line.starts_with("| `")).collect();
        let wanted: Vec<_> = replaced.chain(reported).collect();
        assert_eq!(shown, wanted, "docs/clocks.md should say\n{}", wanted.join("\n"));
    }

    #[test]
    fn forms_are_written_in_their_own_type() {
        let Some(Fate::Replaced(form)) = fate("TON_LTIME", Kind::Block) else { panic!("a form") };
        let text = form.text(Target::Iec);
        assert!(text.contains("FUNCTION_BLOCK SDSP_TON_LTIME\nVAR_INPUT IN : BOOL; PT : LTIME; END_VAR"), "{text}");
        assert!(text.contains("Own : TON_LTIME;") && text.contains("SDSP_NowL - since") && !text.contains(" TIME;"));
    }
}
