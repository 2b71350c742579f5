//! The session as a page in a browser: `run --web`.
//!
//! | module | subject |
//! |---|---|
//! | [`bundle`] | the page itself, a part of the program |
//! | `routes` | what a browser may ask for |
//! | [`guard`] | whose requests are answered |
//! | [`entry`] | who comes in where a token is asked for |
//! | `listener` | where connections come in: their number, their time, TLS |
//! | [`structure`] | what of a session does not change |
//! | [`machine`] | bodies and components |
//! | [`signals`] | signals |
//! | [`sources`] | programs as text |
//! | [`known`] | what the server knows beside it |
//! | [`online`] | variables of PLCs that are not signals |
//! | [`panel`] | what operators see and write with |
//! | [`drawings`] | ladders, function blocks and charts as they are laid out, with their states |
//! | [`alarms`] | alarms as they come and go, and what people do about them |
//! | [`looks`] | figures, views, and what bodies look like while something holds |
//! | [`maps`] | tables of values that no signal has |
//! | [`picture`] | what of a step is shown |
//! | [`ask`] | what a page may ask |
//! | `rights` | who may do what |
//! | [`error`] | why it is refused |
//! | `attendance` | who looks |
//! | `frames` | when viewers look |
//! | [`playhead`] | where a viewer looks: live, or at the past |
//! | [`seats`] | who operates |
//! | [`training`] | a lesson on two pages |
//! | `lesson` | how it goes, and what came of it |
//! | [`verdicts`] | what becomes of expectations while it runs |
//! | [`response`] | the texts that a viewer is sent |
//! | [`viewer`] | one viewer |
//!
//! The server has a thread of its own. It reads what the session publishes and leaves wishes in its mailbox, as every other
//! operator does: nothing that is read leaves a trace, and what is written is an operator's input at a step boundary.
//! The protocol is in `web/PROTOCOL.md`.

mod alarms;
mod ask;
mod attendance;
mod bundle;
mod drawings;
mod entry;
mod error;
mod frames;
mod guard;
mod known;
mod lesson;
pub mod listener;
mod looks;
pub mod machine;
mod maps;
mod online;
mod panel;
mod picture;
mod playhead;
mod response;
mod rights;
mod routes;
mod seats;
mod signals;
mod sources;
mod structure;
mod training;
mod verdicts;
mod viewer;

use std::net::{SocketAddr, TcpListener};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use miette::Diagnostic;
use onescan_base::threads;
use onescan_scenario::{Scenario, ScenarioError};
use onescan_server::layout::ImageLayout;
use onescan_server::mailbox::Mailbox;
use onescan_server::plan::SessionPlan;
use onescan_server::published::Published;
use onescan_server::signal::SignalDecl;
use onescan_server::time::VirtualTime;
use onescan_server::transport::runtime;
use onescan_server::transport::tcp::House;
use schemars::JsonSchema;
use serde::Serialize;
use thiserror::Error;
use tokio::sync::Notify;

use crate::access::AccessError;
use crate::access::admission::{Admission, GuardedListener};
use crate::error::{Exit, ExitCode, ListenError, Usage};
use crate::past::Rewinder;
pub(crate) use alarms::AlarmLog;
use attendance::Attendance;
pub use bundle::charts;
use entry::Entry;
use error::Refused;
use frames::Frames;
use known::Known;
pub(crate) use lesson::{Cost as LessonCost, Driving, Kept, LessonBoard, LessonResult, Met, Slip, Timing};
use listener::{LimitedListener, Visitor};
use looks::Called;
use routes::router;
pub use routes::{asset, guarded_here};
use seats::Seats;
pub(crate) use training::{AtWork, Failing, Forgiven, Role, Training, Turn, TurnQueue};
pub(crate) use verdicts::VerdictBoard;

/// How long viewers have to take the end, at most.
const FAREWELL: Duration = Duration::from_millis(500);

/// How often whoever keeps a page for those who look back looks whether that is over.
const LOOK: Duration = Duration::from_millis(100);

/// How long a page stays that outlasts its session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stay {
    /// Until the last viewer has left.
    ForViewers,
    /// Until Ctrl-C or the like.
    UntilInterrupted,
}

/// What a session's page needs of it.
pub(crate) struct Source<'s> {
    pub(crate) scenario: &'s Scenario,
    /// Where the session publishes its steps.
    pub(crate) published: Published,
    pub(crate) mailbox: Mailbox,
    /// How fast virtual time may run, in words.
    pub(crate) pace: String,
    pub(crate) failing: Failing,
    /// The lesson, if it is one.
    pub(crate) training: Option<Training>,
    /// Where pictures go that the page draws, if it is to draw one.
    pub(crate) pictures: Option<Sender<Drawn>>,
    /// Who shows its past; or why nobody does.
    pub(crate) past: Result<Rewinder, String>,
    /// Who lets sessions go on from there.
    pub(crate) launch: Launch,
    /// Who makes a case of it; or why nobody does.
    pub(crate) keep_case: Result<KeepCase, String>,
    /// Where it is seen what becomes of expectations.
    pub(crate) verdict_board: VerdictBoard,
    /// Where it is seen how alarms come and go.
    pub(crate) alarm_log: AlarmLog,
    /// Where a recording ends; nothing for a session that runs.
    pub(crate) recorded_to: Option<VirtualTime>,
}

impl<'s> Source<'s> {
    /// A session that is not a lesson, keeps no past, and of which no picture is to be drawn.
    pub(crate) fn new(scenario: &'s Scenario, published: Published, mailbox: Mailbox, pace: String) -> Self {
        Self {
            scenario,
            published,
            mailbox,
            pace,
            failing: Failing::default(),
            training: None,
            pictures: None,
            past: Err("it keeps none".to_owned()),
            launch: Arc::new(|_, _| Err("it keeps no past".to_owned())),
            keep_case: Err("it is not a run whose operators' inputs are kept".to_owned()),
            verdict_board: VerdictBoard::default(),
            alarm_log: AlarmLog::default(),
            recorded_to: None,
        }
    }
}

/// Begins a session that goes on from a checkpoint, given as a file's bytes, and ends as this one does or then; gives where
/// its page is, or says in words why there is none.
pub(crate) type Launch = Arc<dyn Fn(&[u8], Option<VirtualTime>) -> Result<String, String> + Send + Sync>;

/// A picture that the page has drawn, a PNG, or why it has not.
pub(crate) type Drawn = Result<Vec<u8>, String>;

/// A case that is wanted of what operators have done.
#[derive(Clone, Debug)]
pub(crate) struct CaseWanted {
    pub(crate) name: String,
    /// When its run is complete: as far as the session has come.
    pub(crate) until: VirtualTime,
    /// Whether it is to be written.
    pub(crate) save: bool,
}

/// What operators have done, as a case.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(crate) struct KeptCase {
    pub(crate) name: String,
    pub(crate) text: String,
    /// The file of cases.
    pub(crate) path: String,
    pub(crate) saved: bool,
    pub(crate) may_save: bool,
}

/// Makes a case of what operators have done, or says in words why not.
pub(crate) type KeepCase = Arc<dyn Fn(&CaseWanted) -> Result<KeptCase, String> + Send + Sync>;

/// A session, as all viewers share it.
struct Session {
    /// The answer to `GET /api/session`.
    structure: String,
    known: Known,
    plan: SessionPlan,
    layout: ImageLayout,
    published: Published,
    frames: Frames,
    mailbox: Mailbox,
    pace: String,
    failing: Failing,
    training: Option<Training>,
    seats: Arc<Seats>,
    called: Arc<Called>,
    pictures: Option<Sender<Drawn>>,
    entry: Entry,
    scheme: &'static str,
    past: Result<Rewinder, String>,
    launch: Launch,
    keep_case: Result<KeepCase, String>,
    verdict_board: VerdictBoard,
    alarm_log: AlarmLog,
    /// The names of the expectations.
    expected: Vec<String>,
    recorded_to: Option<VirtualTime>,
    over: AtomicBool,
    /// A viewer of a recording, or of what is over, has seen enough.
    left: AtomicBool,
    attendance: Attendance,
    /// What all viewers are notified of, in its order.
    news: Mutex<Vec<News>>,
}

/// Something that happened beside the steps.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct News {
    pub(crate) t_v: VirtualTime,
    /// What kind of thing.
    pub(crate) kind: &'static str,
    pub(crate) text: String,
}

impl Session {
    /// The session of `source`. A second page of it shares the seats and the views that somebody calls with the first.
    fn new(
        source: Source<'_>,
        entry: Entry,
        scheme: &'static str,
        shared: Option<(Arc<Seats>, Arc<Called>)>,
    ) -> Result<Self, WebError> {
        let (mut structure, mut known) = structure::of(source.scenario, source.training.as_ref())?;
        structure.live = source.recorded_to.is_none();
        let plan = source.scenario.plan().clone();
        let (seats, called) = shared.unwrap_or_else(|| {
            let seats = Seats::at(std::mem::take(&mut known.panels));
            (Arc::new(seats), Arc::new(Called::among(source.scenario, source.training.as_ref())))
        });
        Ok(Self {
            entry,
            scheme,
            structure: serde_json::to_string(&structure)?,
            seats,
            called,
            known,
            layout: ImageLayout::new(plan.signals()),
            plan,
            published: source.published,
            frames: Frames::begin(),
            mailbox: source.mailbox,
            pace: source.pace,
            failing: source.failing,
            training: source.training,
            pictures: source.pictures,
            past: source.past,
            launch: source.launch,
            keep_case: source.keep_case,
            verdict_board: source.verdict_board,
            alarm_log: source.alarm_log,
            expected: source.scenario.expectations().named.iter().map(|(name, _)| name.clone()).collect(),
            recorded_to: source.recorded_to,
            over: AtomicBool::new(false),
            left: AtomicBool::new(false),
            attendance: Attendance::default(),
            news: Mutex::default(),
        })
    }

    /// The news after the first `reported`. A thread that panicked under the lock has left whole values.
    fn news_after(&self, reported: usize) -> Vec<News> {
        let news = self.news.lock().unwrap_or_else(PoisonError::into_inner);
        news.get(reported..).unwrap_or_default().to_vec()
    }

    /// The signal of this number.
    fn declared(&self, signal: usize) -> Result<&SignalDecl, Refused> {
        self.plan.signals().get(signal).ok_or(Refused::NoSignal(signal))
    }

    /// The newest moment that there is.
    fn edge(&self) -> VirtualTime {
        self.recorded_to.unwrap_or_else(|| self.published.latest().t_v)
    }

    /// True for a session that has come to its end, though its page may stay. After an attempt at a lesson the next one comes.
    fn is_complete(&self) -> bool {
        self.training.is_none() && self.published.latest().end.is_some()
    }

    /// True while real PLCs are driven to where an attempt at a lesson begins.
    fn is_driven(&self) -> bool {
        self.training.as_ref().is_some_and(|training| training.board.is_driving())
    }

    /// True for what is only looked at, and closed by who has seen enough: a recording, or what has come to its end.
    fn is_looked_back_at(&self) -> bool {
        self.recorded_to.is_some() || self.is_complete()
    }

    fn ended(&self) -> bool {
        self.over.load(Ordering::Acquire)
    }
}

/// Why there is no page.
#[derive(Debug, Error, Diagnostic)]
pub enum WebError {
    /// The address cannot be listened on.
    #[error(transparent)]
    Listen(#[from] ListenError),
    /// Others could come in.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Open(#[from] Usage),
    /// Others could come in, or nobody can.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Access(#[from] AccessError),
    /// The scene has changed since it was read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scenario(#[from] ScenarioError),
    /// The past cannot be kept or shown.
    #[error("there is no thread for the past of the session: {0}")]
    Thread(std::io::Error),
    /// The structure cannot be written.
    #[error("the structure of the session cannot be served: {0}")]
    Structure(#[from] serde_json::Error),
}

impl Exit for WebError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Listen(error) => error.exit_code(),
            Self::Open(error) => error.exit_code(),
            Self::Access(error) => error.exit_code(),
            Self::Scenario(error) => error.exit_code(),
            Self::Structure(_) | Self::Thread(_) => ExitCode::Fault,
        }
    }
}

/// Without tokens, everybody who reaches the page operates the session, so nobody from elsewhere may.
///
/// # Errors
/// The address is not of this machine, and there are no tokens.
pub fn of_this_machine(address: SocketAddr, admission: &Admission) -> Result<(), Usage> {
    if address.ip().is_loopback() || matches!(admission, Admission::Holders(_)) {
        return Ok(());
    }
    let port = address.port();
    let help = format!(
        "write `--web=127.0.0.1:{port}`, and come from elsewhere through a tunnel, as that of `ssh -L`; or name a folder with \
         tokens and a certificate, with `--access DIR` (docs/security.md)"
    );
    Err(Usage::new(format!("--web {address}: the page is for browsers of this machine only"), Some(help)))
}

/// The server of a session's page. It ends when it is dropped.
pub struct Page {
    address: SocketAddr,
    session: Arc<Session>,
    stop: Arc<Notify>,
    thread: Option<JoinHandle<()>>,
}

impl Page {
    /// Serves a session at `address`, an address of this machine, unless `admission` asks for tokens.
    ///
    /// # Errors
    /// See [`WebError`].
    pub(crate) fn serve(address: SocketAddr, admission: &Admission, source: Source<'_>) -> Result<Self, WebError> {
        Self::seated(address, admission, source, None)
    }

    /// Serves the same session at another address, for others who share its seats and are shown the views that somebody calls.
    ///
    /// # Errors
    /// See [`WebError`].
    pub(crate) fn beside(
        &self,
        address: SocketAddr,
        admission: &Admission,
        source: Source<'_>,
    ) -> Result<Self, WebError> {
        let Session { seats, called, .. } = &*self.session;
        Self::seated(address, admission, source, Some((Arc::clone(seats), Arc::clone(called))))
    }

    fn seated(
        address: SocketAddr,
        admission: &Admission,
        source: Source<'_>,
        shared: Option<(Arc<Seats>, Arc<Called>)>,
    ) -> Result<Self, WebError> {
        of_this_machine(address, admission)?;
        // Pages let people in by their tokens and ask for no certificate, so that none is there to be revoked.
        let House { register, identity, revocations: _ } = match admission {
            Admission::Holders(_) => GuardedListener::open(admission, address)?.into_house(),
            Admission::ThisMachine | Admission::Anybody => House::default(),
        };
        let listen = ListenError::on(address);
        let listener = TcpListener::bind(address).map_err(&listen)?;
        listener.set_nonblocking(true).map_err(&listen)?;
        let address = listener.local_addr().map_err(&listen)?;
        let entry = Entry::new(register, address.port(), identity.is_some());
        let is_trainers = source.training.as_ref().is_some_and(|training| training.role == Role::Trainer);
        let entry = if is_trainers { entry.for_trainers() } else { entry };
        let scheme = if identity.is_some() { "https" } else { "http" };
        let session = Arc::new(Session::new(source, entry, scheme, shared)?);
        let runtime = runtime::of_this_thread().map_err(&listen)?;
        let stop = Arc::new(Notify::new());
        let (router, stopped) = (router(Arc::clone(&session)), Arc::clone(&stop));
        let thread = threads::start("web", move || {
            runtime.block_on(async move {
                let served = async {
                    let listener = tokio::net::TcpListener::from_std(listener)?;
                    let listener = LimitedListener::new(listener, identity.as_ref())?;
                    axum::serve(listener, router.into_make_service_with_connect_info::<Visitor>()).await
                };
                tokio::select! {
                    outcome = served => if let Err(error) = outcome {
                        tracing::error!(%error, "the page is not served any more; the session goes on");
                    },
                    () = stopped.notified() => {}
                }
            });
            // viewers that do not read are not waited for
            runtime.shutdown_timeout(FAREWELL);
        });
        Ok(Self { address, session, stop, thread: Some(thread.map_err(&listen)?) })
    }

    /// Where a browser finds it.
    pub(crate) fn url(&self) -> String {
        format!("{}://{}/", self.session.scheme, self.address)
    }

    /// Notifies all viewers, those who are yet to come too.
    pub(crate) fn notify(&self, news: News) {
        self.session.news.lock().unwrap_or_else(PoisonError::into_inner).push(news);
    }

    /// Waits until the first viewer looks, or until `is_over`, which is asked now and then.
    pub(crate) fn await_viewer(&self, is_over: impl Fn() -> bool) {
        self.session.attendance.await_first(is_over);
    }

    /// Keeps the page after its session, as long as `stay` says; a viewer who closes it, or `is_over`, ends that earlier.
    pub(crate) fn await_departure(&self, stay: Stay, is_over: impl Fn() -> bool) {
        let is_over = || is_over() || self.is_left();
        match stay {
            Stay::ForViewers => self.session.attendance.await_departure(is_over),
            Stay::UntilInterrupted => {
                while !is_over() {
                    std::thread::sleep(LOOK);
                }
            }
        }
    }

    /// Whether a viewer of a recording, or of what is over, has seen enough.
    pub(crate) fn is_left(&self) -> bool {
        self.session.left.load(Ordering::Acquire)
    }

    /// How many bytes the page has as this program holds it; 0 if it was built without it.
    pub(crate) fn size() -> usize {
        bundle::size()
    }

    /// What is missing, if the program was built without its page.
    pub fn is_absent() -> Option<&'static str> {
        (!bundle::is_there()).then_some(bundle::ABSENT)
    }
}

impl Drop for Page {
    /// Notifies viewers of the end, and leaves them a moment to take it.
    fn drop(&mut self) {
        self.session.over.store(true, Ordering::Release);
        self.session.attendance.await_last(FAREWELL);
        self.stop.notify_one();
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            tracing::error!("the thread of the page has panicked");
        }
    }
}
