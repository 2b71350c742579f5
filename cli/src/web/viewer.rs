//! One viewer: what it asks and what it is shown. It looks at the session as often as it can take; views in between
//! are dropped, so a slow viewer slows nobody.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

use axum::body::Bytes;
use axum::extract::ws::{Message, WebSocket};
use onescan_server::mailbox::{Request, Wish};
use onescan_server::operation::{Operation, OperationError};
use onescan_server::published::SessionView;
use onescan_server::wire::message::Status as Taken;
use serde::Serialize;
use tokio::sync::{mpsc, oneshot};
use tokio::time::{MissedTickBehavior, interval, timeout};

use super::alarms::{Change, Rung};
use super::ask::{self, Ask, Refused};
use super::picture::Shown;
use super::seats::Viewer;
use super::{SeatView, Session};

/// How often a picture is looked for.
const PICTURE: Duration = Duration::from_millis(16);
/// How long one message may take to a viewer that does not read before it is left.
const PATIENCE: Duration = Duration::from_secs(20);

/// What a viewer is told.
#[derive(Debug, Serialize)]
#[serde(tag = "type", rename_all = "lowercase")]
enum Told {
    Status {
        state: &'static str,
        digest: Option<String>,
        pace: String,
        seat: SeatView,
        #[serde(skip_serializing_if = "BTreeSet::is_empty")]
        failed: BTreeSet<String>,
    },
    Looks {
        active: Vec<usize>,
    },
    States {
        drawing: usize,
        instance: usize,
        values: Vec<Option<f64>>,
    },
    View {
        view: String,
    },
    Event {
        t_ns: u64,
        kind: &'static str,
        text: String,
    },
    Error {
        message: String,
    },
}

/// What came of a wish: nothing to say, or why it was not done.
type Outcome = Result<(), String>;

/// Speaks with a viewer until one of the two leaves.
pub(super) async fn attend(mut socket: WebSocket, session: Arc<Session>) {
    let viewer = session.seats.enter();
    // what ends it is that the viewer is gone
    let _ = converse(&mut socket, &session, viewer).await;
    session.seats.leave(viewer);
}

/// The viewer is gone, or does not read.
struct Gone;

async fn converse(socket: &mut WebSocket, session: &Session, viewer: Viewer) -> Result<(), Gone> {
    let (outcomes, mut done) = mpsc::unbounded_channel::<Outcome>();
    let mut look = interval(PICTURE);
    look.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let (mut shown, mut seen, mut status) = (Shown::default(), None, String::new());
    let (mut looks, mut called) = (None, session.called.follow());
    let (mut drawn, mut states, mut rung) = (None, None, Rung::default());
    loop {
        tokio::select! {
            message = socket.recv() => match message {
                Some(Ok(Message::Text(text))) => {
                    match heed(&text, session, viewer, (&mut shown, &mut drawn), &outcomes) {
                        Ok(true) => seen = None,
                        Ok(false) => {}
                        Err(refused) => say(socket, &Told::Error { message: refused.to_string() }).await?,
                    }
                }
                Some(Ok(Message::Binary(_))) => {
                    let message = Refused::Garbage("bytes, where a text is expected".to_owned()).to_string();
                    say(socket, &Told::Error { message }).await?;
                }
                Some(Ok(Message::Ping(_) | Message::Pong(_))) => {}
                Some(Ok(Message::Close(_)) | Err(_)) | None => return Ok(()),
            },
            Ok(()) = called.changed() => {
                let (_, view) = called.borrow_and_update().clone();
                say(socket, &Told::View { view }).await?;
            }
            Some(outcome) = done.recv() => {
                if let Err(message) = outcome {
                    say(socket, &Told::Error { message }).await?;
                }
            }
            _ = look.tick() => {
                let view = session.published.latest();
                session.published.ask();
                let told = told(&view, session, viewer);
                if told != status {
                    send(socket, Message::Text(told.clone().into())).await?;
                    status = told;
                }
                // a view of a restarted session has a smaller time, and a revision of its own all the same
                if seen != Some(view.revision) {
                    seen = Some(view.revision);
                    let picture = shown.picture(&view, &session.layout, &session.known.stage);
                    send(socket, Message::Binary(Bytes::from(picture))).await?;
                    let active = session.known.looks.active(&view, &session.layout);
                    if looks.as_ref() != Some(&active) {
                        looks = Some(active.clone());
                        say(socket, &Told::Looks { active }).await?;
                    }
                    let t_ns = view.t_v.as_nanos();
                    for Change { kind, name } in session.known.bell.changes(&mut rung, &view, &session.layout) {
                        say(socket, &Told::Event { t_ns, kind, text: name.to_owned() }).await?;
                    }
                    let now = drawn.map(|drawn| (drawn, session.known.states.values(drawn, &view)));
                    if let Some(((drawing, instance), values)) = now.clone().filter(|_| now != states) {
                        say(socket, &Told::States { drawing, instance, values }).await?;
                    }
                    states = now;
                }
                if let (Some(end), true) = (&view.end, session.ended()) {
                    let text = end.to_string();
                    let t_ns = view.t_v.as_nanos();
                    say(socket, &Told::Event { t_ns, kind: "end", text }).await?;
                    return Ok(());
                }
            }
        }
    }
}

/// How the session is, in words that change only when it does.
fn told(view: &SessionView, session: &Session, viewer: Viewer) -> String {
    let state = match (&view.end, view.is_held) {
        (Some(_), _) => "end",
        (None, true) => "hold",
        (None, false) => "run",
    };
    let digest = view.end.as_ref().and(view.digest).map(|digest| digest.to_string());
    let is_secret = ask::trainer_only(session.training.as_ref()).is_err();
    let failed = if is_secret { BTreeSet::new() } else { session.failing.now() };
    let told = Told::Status { state, digest, pace: session.pace.clone(), seat: session.seats.seen_by(viewer), failed };
    serde_json::to_string(&told).unwrap_or_else(|error| error.to_string())
}

async fn say(socket: &mut WebSocket, told: &Told) -> Result<(), Gone> {
    let text = serde_json::to_string(told).map_err(|_| Gone)?;
    send(socket, Message::Text(text.into())).await
}

async fn send(socket: &mut WebSocket, message: Message) -> Result<(), Gone> {
    match timeout(PATIENCE, socket.send(message)).await {
        Ok(Ok(())) => Ok(()),
        Ok(Err(_)) | Err(_) => Err(Gone),
    }
}

/// Does what is asked; true if the next picture is due at once.
fn heed(
    text: &str,
    session: &Session,
    viewer: Viewer,
    (shown, drawn): (&mut Shown, &mut Option<(usize, usize)>),
    outcomes: &mpsc::UnboundedSender<Outcome>,
) -> Result<bool, Refused> {
    let operation = match Ask::read(text)? {
        Ask::Subscribe { signals } => {
            shown.want(ask::signals(&signals, &session.layout)?);
            return Ok(true);
        }
        Ask::Seat { panel, .. } if session.known.hidden.contains(&panel) => return Err(Refused::NoPanel(panel)),
        Ask::Seat { panel, take } => {
            session.seats.claim(&panel, viewer, take)?;
            return Ok(false);
        }
        Ask::Write { signal, value } => {
            let declared = session.plan.signals().get(signal).ok_or(Refused::NoSignal(signal))?;
            session.seats.may_write(viewer, declared.name.as_str())?;
            ask::write(declared, value, &session.known)?
        }
        Ask::Operate { operation } => {
            ask::trainer_only(session.training.as_ref())?;
            operation.into()
        }
        Ask::Fail { component, failure, active } => {
            ask::trainer_only(session.training.as_ref())?;
            ask::fail(component, failure, active, &session.known)?
        }
        Ask::Train(asked) => {
            let turn = ask::turn(asked, session.training.as_ref())?;
            if let Some(training) = &session.training {
                training.desk.ask(turn);
            }
            return Ok(false);
        }
        Ask::Show { .. } | Ask::Fork { .. } => return Err(Refused::Past),
        Ask::View { view } => {
            session.called.call(view, viewer, &session.seats)?;
            return Ok(false);
        }
        Ask::Draw { drawing, instance } => {
            *drawn = drawing.map(|drawing| session.known.states.check(drawing, instance)).transpose()?;
            return Ok(true);
        }
        Ask::Live => return Ok(false),
    };
    wish(operation, session, outcomes);
    Ok(false)
}

/// Leaves a wish in the session's mailbox; what comes of it is told when the session has taken it.
fn wish(operation: Operation, session: &Session, outcomes: &mpsc::UnboundedSender<Outcome>) {
    let (reply, answer) = oneshot::channel::<Result<Taken, OperationError>>();
    session.mailbox.post(Request { wish: Wish::Do(operation), reply: Some(reply) });
    let outcomes = outcomes.clone();
    tokio::spawn(async move {
        let outcome = match answer.await {
            Ok(Ok(_)) => Ok(()),
            Ok(Err(error)) => Err(error.to_string()),
            Err(_) => Err("the session is over".to_owned()),
        };
        // a viewer that has left hears nothing
        outcomes.send(outcome).ok();
    });
}
