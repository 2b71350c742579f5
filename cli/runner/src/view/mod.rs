//! `onescan view`: a recording as a page. It is run again from its own files, and each step held against the digest that
//! was recorded for it.
//!
//! | module | subject |
//! |---|---|
//! | [`recorded`] | what a recording was made of, and whether it can be run again |
//! | [`check`] | the re-run, held against the recording |
//! | [`error`] | why nothing is shown |

mod check;
pub mod error;
mod recorded;

use std::io::Write;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use onescan_report::OutputError;
use onescan_server::mailbox::Mailbox;
use onescan_server::published::Published;

pub use error::ViewError;

use crate::access::admission::Admission;
use crate::error::ExitCode;
use crate::interrupt::Interrupt;
use crate::past::{Budget, Kept, Rewinder};
use crate::run::forked::{self, ForkSettings};
use crate::web::{self, AlarmLog, News, Page, VerdictBoard, WebError};
use check::Checked;
use onescan_base::notice::NOTICE;
use onescan_base::threads;
use recorded::Recorded;

/// How often it is looked whether somebody has seen enough.
const LOOK: Duration = Duration::from_millis(50);

/// What is shown, and where.
#[derive(Clone, Debug)]
pub struct ViewConfig {
    pub recording: PathBuf,
    /// Where the page is served.
    pub web: SocketAddr,
    /// Who is let in there.
    pub admission: Admission,
    /// How much memory moments of the re-run may take.
    pub past: Budget,
    /// How many sessions may go on from its moments at a time.
    pub forks: u32,
}

/// Serves the recording as a page until Ctrl-C, or a viewer ends it. Says in `out` whether the re-run is what was recorded.
///
/// # Errors
/// See [`ViewError`]. A re-run that differs is not an error but the exit code.
pub fn view(config: &ViewConfig, interrupt: &Interrupt, out: &mut dyn Write) -> Result<ExitCode, ViewError> {
    let recorded = Recorded::open(&config.recording)?;
    interrupt.watch();
    let kept = Kept::within(config.past.bytes);
    recorded.leave_inputs(&kept);
    let (verdict_board, alarm_log) = (VerdictBoard::default(), AlarmLog::default());
    let page = serve(config, &recorded, kept.clone(), (verdict_board.clone(), alarm_log.clone()))?;
    match Page::is_absent() {
        None => tracing::info!(target: NOTICE, "the recording is at {}", page.url()),
        Some(how) => tracing::warn!(target: NOTICE, "no page at {}: {how}", page.url()),
    }
    let enough = AtomicBool::new(false);
    let boards = (&verdict_board, &alarm_log);
    std::thread::scope(|scope| {
        let check = || check::check(&recorded, &kept, boards, &enough);
        let mut checking = Some(threads::start_in(scope, "check", check).map_err(WebError::Thread)?);
        let mut code = ExitCode::Ok;
        loop {
            let is_over = interrupt.is_raised() || page.is_left();
            enough.fetch_or(is_over, Ordering::AcqRel);
            if let Some(check) = checking.take_if(|check| is_over || check.is_finished()) {
                let checked = check.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
                if checked.differs() {
                    code = ExitCode::Unmet;
                }
                page.notify(News { t_v: checked.t_v(), kind: "check", text: checked.to_string() });
                writeln!(out, "{checked}").and_then(|()| out.flush()).map_err(OutputError)?;
            }
            if is_over {
                return Ok(code);
            }
            std::thread::sleep(LOOK);
        }
    })
}

fn serve(
    config: &ViewConfig,
    recorded: &Recorded,
    kept: Kept,
    (verdict_board, alarm_log): (VerdictBoard, AlarmLog),
) -> Result<Page, ViewError> {
    let scenario = &recorded.scenario;
    let rewinder = Rewinder::new(kept, forked::former(scenario)).map_err(WebError::Thread)?;
    let typed = (recorded.words(), Some(recorded.until()));
    let fork_settings = ForkSettings::at(typed, Some(config.web), &config.admission, config.forks);
    // Nothing is published: a recording has no live edge.
    let unpublished = Published::new(0);
    let source = web::Source {
        past: Ok(rewinder),
        launch: forked::launcher(fork_settings),
        verdict_board,
        alarm_log,
        recorded_to: Some(recorded.end),
        ..web::Source::new(scenario, unpublished, Mailbox::new(), String::new())
    };
    Ok(Page::serve(config.web, &config.admission, source)?)
}

impl Checked {
    fn differs(&self) -> bool {
        matches!(self, Self::Differs { .. })
    }
}
