//! The session as a page in a browser: `run --web`.
//!
//! | module | subject |
//! |---|---|
//! | [`bundle`] | the page itself, a part of the program |
//! | [`guard`] | whose requests are answered |
//! | [`structure`] | what of a session does not change |
//! | [`panel`] | what operators see and write with |
//! | [`drawings`] | ladders, function blocks and charts as they are laid out, with their states |
//! | [`alarms`] | alarms as they come and go |
//! | [`looks`] | figures, views, and what bodies look like while something holds |
//! | [`picture`] | what of a step is shown |
//! | [`ask`] | what a page may ask |
//! | [`seats`] | who operates |
//! | [`desk`] | a lesson on two pages |
//! | [`viewer`] | one viewer |
//!
//! The server has a thread of its own. It reads what the session publishes and leaves wishes in its mailbox, as every other
//! operator does: nothing that is read leaves a trace, and what is written is an operator's input at a step boundary.
//! The protocol is in `web/PROTOCOL.md`.

mod alarms;
mod ask;
mod bundle;
mod desk;
mod drawings;
mod guard;
mod looks;
mod panel;
mod picture;
mod seats;
pub(crate) mod structure;
mod viewer;

use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Sender;
use std::thread::JoinHandle;
use std::time::Duration;

use axum::Router;
use axum::body::Bytes;
use axum::extract::{DefaultBodyLimit, Request, State, WebSocketUpgrade};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use miette::Diagnostic;
use onescan_scenario::{Scenario, ScenarioError};
use onescan_server::layout::ImageLayout;
use onescan_server::mailbox::Mailbox;
use onescan_server::plan::SessionPlan;
use onescan_server::published::Published;
use thiserror::Error;
use tokio::sync::Notify;

use crate::error::{Exit, ExitCode, ListenError, Usage};
pub(crate) use desk::{Desk, Failing, Role, Training, Turn};
use looks::Called;
use seats::{SeatView, Seats};
use structure::Known;

/// What a page may load and do: what comes from here, and nothing from outside.
const POLICY: &str = "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; connect-src 'self'; \
                      frame-ancestors 'none'; base-uri 'none'; form-action 'none'";
/// The longest message of a page, bytes.
const MESSAGE_MAX: usize = 64 * 1024;
/// The largest picture that a page draws, bytes.
const PICTURE_MAX: usize = 256 * 1024 * 1024;
/// How long viewers have to take the end.
const FAREWELL: Duration = Duration::from_millis(500);

/// What a session's page needs of it.
pub(crate) struct Source<'s> {
    /// The scenario.
    pub(crate) scenario: &'s Scenario,
    /// Where the session publishes its steps.
    pub(crate) published: Published,
    /// Where wishes go.
    pub(crate) mailbox: Mailbox,
    /// How fast virtual time may run, in words.
    pub(crate) pace: String,
    /// What has failed.
    pub(crate) failing: Failing,
    /// The lesson, if it is one.
    pub(crate) training: Option<Training>,
    /// Where pictures go that the page draws, if it is to draw one.
    pub(crate) pictures: Option<Sender<Drawn>>,
}

/// A picture that the page has drawn, a PNG, or why it has not.
pub(crate) type Drawn = Result<Vec<u8>, String>;

/// A session, as all viewers share it.
struct Session {
    /// The answer to `GET /api/session`.
    structure: String,
    known: Known,
    plan: SessionPlan,
    layout: ImageLayout,
    published: Published,
    mailbox: Mailbox,
    pace: String,
    failing: Failing,
    training: Option<Training>,
    seats: Arc<Seats>,
    called: Called,
    pictures: Option<Sender<Drawn>>,
    over: AtomicBool,
}

impl Session {
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
    /// The scene has changed since it was read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scenario(#[from] ScenarioError),
    /// The structure cannot be written.
    #[error("the structure of the session cannot be served: {0}")]
    Structure(#[from] serde_json::Error),
}

impl Exit for WebError {
    fn exit_code(&self) -> ExitCode {
        match self {
            Self::Listen(error) => error.exit_code(),
            Self::Open(error) => error.exit_code(),
            Self::Scenario(error) => error.exit_code(),
            Self::Structure(_) => ExitCode::Fault,
        }
    }
}

/// Everybody who reaches the page operates the session, so nobody from elsewhere may.
pub(crate) fn of_this_machine(address: SocketAddr) -> Result<(), Usage> {
    if address.ip().is_loopback() {
        return Ok(());
    }
    let port = address.port();
    let help = format!("write `--web=127.0.0.1:{port}`, and come from elsewhere through a tunnel, as that of `ssh -L`");
    Err(Usage::new(format!("--web {address}: the page is for browsers of this machine only"), Some(help)))
}

/// The server of a session's page. It ends when it is dropped.
pub(crate) struct Page {
    address: SocketAddr,
    session: Arc<Session>,
    stop: Arc<Notify>,
    thread: Option<JoinHandle<()>>,
}

impl Page {
    /// Serves a session at `address`, an address of this machine.
    ///
    /// # Errors
    /// See [`WebError`].
    pub(crate) fn serve(address: SocketAddr, source: Source<'_>) -> Result<Self, WebError> {
        Self::seated(address, source, None)
    }

    /// Serves the same session at another address, for others who share its seats.
    ///
    /// # Errors
    /// See [`WebError`].
    pub(crate) fn beside(&self, address: SocketAddr, source: Source<'_>) -> Result<Self, WebError> {
        Self::seated(address, source, Some(Arc::clone(&self.session.seats)))
    }

    fn seated(address: SocketAddr, source: Source<'_>, seats: Option<Arc<Seats>>) -> Result<Self, WebError> {
        of_this_machine(address)?;
        let listen = ListenError::on(address);
        let (structure, mut known) = structure::of(source.scenario, source.training.as_ref())?;
        let plan = source.scenario.plan().clone();
        let session = Arc::new(Session {
            structure: serde_json::to_string(&structure)?,
            seats: seats.unwrap_or_else(|| Arc::new(Seats::at(std::mem::take(&mut known.panels)))),
            called: Called::among(source.scenario),
            known,
            layout: ImageLayout::new(plan.signals()),
            plan,
            published: source.published,
            mailbox: source.mailbox,
            pace: source.pace,
            failing: source.failing,
            training: source.training,
            pictures: source.pictures,
            over: AtomicBool::new(false),
        });
        let listener = TcpListener::bind(address).map_err(&listen)?;
        listener.set_nonblocking(true).map_err(&listen)?;
        let address = listener.local_addr().map_err(&listen)?;
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(&listen)?;
        let stop = Arc::new(Notify::new());
        let (router, stopped) = (router(Arc::clone(&session)), Arc::clone(&stop));
        let thread = std::thread::Builder::new().name("web".to_owned()).spawn(move || {
            runtime.block_on(async move {
                let served = async {
                    let listener = tokio::net::TcpListener::from_std(listener)?;
                    axum::serve(listener, router).await
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
        format!("http://{}/", self.address)
    }

    /// What is missing, if the program was built without its page.
    pub(crate) fn is_absent() -> Option<&'static str> {
        (!bundle::is_there()).then_some(bundle::ABSENT)
    }
}

impl Drop for Page {
    /// Tells viewers of the end, and leaves them a moment to take it.
    fn drop(&mut self) {
        self.session.over.store(true, Ordering::Release);
        std::thread::sleep(FAREWELL);
        self.stop.notify_one();
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            tracing::error!("the thread of the page has panicked");
        }
    }
}

fn router(session: Arc<Session>) -> Router {
    Router::new()
        .route("/api/session", get(structure_of))
        .route("/api/live", get(live))
        .route("/api/picture", post(picture).layer(DefaultBodyLimit::max(PICTURE_MAX)))
        .fallback(get(|request: Request| async move { asset(request.uri().path()) }))
        .layer(middleware::from_fn(guarded))
        .with_state(session)
}

/// Every request passes here: what is foreign is refused, and each answer says what a page may do.
pub(crate) async fn guarded(request: Request, next: Next) -> Response {
    const PLAIN: [(HeaderName, HeaderValue); 4] = [
        (header::CONTENT_SECURITY_POLICY, HeaderValue::from_static(POLICY)),
        (header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff")),
        (header::REFERRER_POLICY, HeaderValue::from_static("no-referrer")),
        (header::CACHE_CONTROL, HeaderValue::from_static("no-store")),
    ];
    let mut answer = match guard::admit(request.headers()) {
        Ok(()) => next.run(request).await,
        Err(foreign) => (StatusCode::FORBIDDEN, format!("{foreign}\n")).into_response(),
    };
    answer.headers_mut().extend(PLAIN);
    answer
        .headers_mut()
        .insert(HeaderName::from_static("cross-origin-resource-policy"), HeaderValue::from_static("same-origin"));
    answer
}

async fn structure_of(State(session): State<Arc<Session>>) -> Response {
    ([(header::CONTENT_TYPE, "application/json")], session.structure.clone()).into_response()
}

async fn live(State(session): State<Arc<Session>>, upgrade: WebSocketUpgrade) -> Response {
    upgrade.max_message_size(MESSAGE_MAX).on_upgrade(|socket| viewer::attend(socket, session))
}

/// A picture that the page has drawn: a PNG, or a text that says why there is none.
async fn picture(State(session): State<Arc<Session>>, headers: HeaderMap, body: Bytes) -> Response {
    let Some(pictures) = &session.pictures else {
        return (StatusCode::NOT_FOUND, "nobody has asked for a picture\n").into_response();
    };
    let is_picture = headers.get(header::CONTENT_TYPE).is_some_and(|media| media == "image/png");
    let drawn = if is_picture { Ok(body.to_vec()) } else { Err(String::from_utf8_lossy(&body).into_owned()) };
    match pictures.send(drawn) {
        Ok(()) => StatusCode::NO_CONTENT.into_response(),
        Err(_) => (StatusCode::GONE, "nobody waits for a picture any more\n").into_response(),
    }
}

/// A file of the page.
pub(crate) fn asset(path: &str) -> Response {
    match bundle::file(path) {
        Some((_, media, bytes)) => ([(header::CONTENT_TYPE, media)], bytes).into_response(),
        None if !bundle::is_there() => (StatusCode::NOT_FOUND, format!("{}\n", bundle::ABSENT)).into_response(),
        None => (StatusCode::NOT_FOUND, "there is nothing of this name\n").into_response(),
    }
}
