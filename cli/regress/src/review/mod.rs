//! `onescan review`: snapshots that are new or have changed, looked at, accepted or rejected.
//!
//! | module | subject |
//! |---|---|
//! | [`canvas`] | curves in braille dots |
//! | [`chart`] | a signal on a terminal: old, new, difference |
//! | `queue` | the review itself: what is shown, what was decided |
//! | [`view`] | a pending snapshot on a terminal |
//! | [`page`] | all of them as a page |

pub mod canvas;
pub mod chart;
mod error;
pub mod page;
mod queue;
pub mod view;

use std::io::{IsTerminal, Write};
use std::path::PathBuf;

use console::Term;
use onescan_report::{OutputError, colour, file};
use onescan_scenario::Scenario;
use onescan_scenario::case::Catalogue;

pub use error::ReviewError;

use crate::regress::discover::Found;
use crate::regress::plan::suite_of;
use crate::snapshot::store::{Place, Reviewed, pending};
use crate::snapshot::take;
use crate::snapshot::{Difference, Snapshot, compare};

use onescan_runner::error::ExitCode;
use queue::{Go, ReviewQueue};

/// Columns of a terminal that does not say how wide it is.
const WIDTH: usize = 80;

/// What becomes of the snapshots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Choice {
    /// The user says so, one by one.
    #[default]
    Ask,
    AcceptAll,
    RejectAll,
    /// None is; they are named.
    List,
}

/// All options of a review.
#[derive(Clone, Debug)]
pub struct ReviewConfig {
    /// Scenarios and folders with scenarios.
    pub paths: Vec<PathBuf>,
    /// What becomes of the snapshots.
    pub choice: Choice,
    /// A page to write.
    pub html: Option<PathBuf>,
}

/// A snapshot that waits for a review.
#[derive(Clone, Debug)]
pub struct Waiting {
    pub place: Place,
    /// The reviewed one, if there is one.
    pub old: Option<Snapshot>,
    pub new: Snapshot,
    /// What there is to say of the reviewed one, as where it holds both sides of a merge.
    pub note: Option<String>,
    /// Where the two differ.
    pub differences: Vec<Difference>,
}

impl Waiting {
    /// Its name, as tests are named.
    pub fn name(&self) -> String {
        format!("{}: {}", suite_of(&self.place.scenario), self.place.case)
    }

    /// `new` or `changed`.
    pub fn status(&self) -> &'static str {
        if self.old.is_some() { "changed" } else { "new" }
    }
}

/// Shows all pending snapshots and does with them what is wanted.
///
/// # Errors
/// A snapshot cannot be read or written.
pub fn review(config: &ReviewConfig, out: &mut dyn Write) -> Result<ExitCode, ReviewError> {
    let waiting = waiting(config)?;
    if let Some(path) = &config.html {
        file::write_output(path, page::of(&waiting).as_bytes())?;
    }
    if waiting.is_empty() {
        writeln!(out, "no snapshot waits for a review").map_err(OutputError)?;
        return Ok(ExitCode::Ok);
    }
    let on_terminal = std::io::stdout().is_terminal();
    let colours = colour::suits(&std::io::stdout());
    let asks = config.choice == Choice::Ask && on_terminal && std::io::stdin().is_terminal();
    let decisions = match config.choice {
        Choice::AcceptAll => vec![Decision::Accept; waiting.len()],
        Choice::RejectAll => vec![Decision::Reject; waiting.len()],
        Choice::Ask if asks => {
            let Some(decisions) = ask(&waiting, colours).map_err(OutputError)? else {
                writeln!(out, "nothing is changed").map_err(OutputError)?;
                return Ok(ExitCode::Ok);
            };
            decisions
        }
        // Who has a page looks at that.
        Choice::Ask | Choice::List => vec![Decision::Skip; waiting.len()],
    };
    for (one, what) in waiting.iter().zip(decisions) {
        if config.choice == Choice::Ask && !asks {
            let width = if on_terminal { usize::from(Term::stdout().size().1) } else { WIDTH };
            out.write_all(view::text(one, width, colours).as_bytes()).map_err(OutputError)?;
        }
        match what {
            Decision::Accept => one.place.accept(&one.new)?,
            Decision::Reject => one.place.reject()?,
            Decision::Skip => {}
        }
        print_decision(config, one, what, out).map_err(OutputError)?;
    }
    if config.choice == Choice::Ask && !asks {
        let how = "on a terminal, or with --accept-all or --reject-all";
        writeln!(out, "{} waiting: decide {how}", waiting.len()).map_err(OutputError)?;
    }
    Ok(ExitCode::Ok)
}

/// What the user says to one snapshot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Decision {
    Accept,
    Reject,
    Skip,
}

fn print_decision(config: &ReviewConfig, one: &Waiting, what: Decision, out: &mut dyn Write) -> std::io::Result<()> {
    match (config.choice, what) {
        (Choice::List, _) => writeln!(out, "{} {}", one.status(), one.name()),
        (_, Decision::Accept) => writeln!(out, "accepted {}", one.name()),
        (_, Decision::Reject) => writeln!(out, "rejected {}", one.name()),
        (_, Decision::Skip) => Ok(()),
    }
}

/// Lets the user look at all of them, and gives what was decided; nothing if the review was given up.
fn ask(waiting: &[Waiting], colours: bool) -> std::io::Result<Option<Vec<Decision>>> {
    let term = Term::stdout();
    let mut queue = ReviewQueue::new(waiting);
    loop {
        let (rows, width) = term.size();
        let screen = queue.screen(usize::from(width), usize::from(rows), colours);
        term.clear_screen()?;
        term.write_str(&screen.join("\n"))?;
        match queue.press(&term.read_key()?) {
            Go::On => {}
            Go::Over => {
                term.clear_screen()?;
                return Ok(Some(queue.decisions().to_vec()));
            }
            Go::Away => {
                term.clear_screen()?;
                return Ok(None);
            }
        }
    }
}

/// Everything that waits, in the order of scenarios and cases.
fn waiting(config: &ReviewConfig) -> Result<Vec<Waiting>, ReviewError> {
    let mut all = Vec::new();
    for folder in &Found::behind(&config.paths)?.scenarios {
        for place in pending(folder)? {
            let Some(new) = place.read_pending()? else { continue };
            let tolerances = tolerances(&place);
            let (old, note) = match place.read_merged()? {
                Reviewed::Nothing => (None, None),
                Reviewed::One(old) => (Some(old), None),
                Reviewed::Undecided(merge) => {
                    (merge.nearest(&new, &tolerances).cloned(), Some(merge.note(&new, &tolerances)))
                }
            };
            let differences = old.as_ref().map(|old| compare(old, &new, &tolerances)).unwrap_or_default();
            all.push(Waiting { place, old, new, note, differences });
        }
    }
    Ok(all)
}

/// The tolerances of a case. A scenario that is wrong by now has none: its snapshots can be looked at all the same.
fn tolerances(place: &Place) -> std::collections::BTreeMap<String, f64> {
    let choice = || {
        let scenario = Scenario::load(&place.scenario).ok()?;
        let catalogue = Catalogue::load(&place.scenario).ok()?;
        take::Choice::of(&scenario, &catalogue).ok()
    };
    choice().map(|choice| choice.tolerances).unwrap_or_default()
}
