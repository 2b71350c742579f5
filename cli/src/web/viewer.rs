//! One viewer: what it asks and what it is shown. It looks at the session as often as it can take; views in between
//! are dropped, so a slow viewer slows nobody.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use axum::body::Bytes;
use axum::extract::ws::{Message, WebSocket};
use onescan_server::client::Parts;
use onescan_server::mailbox::{Request, Wish};
use onescan_server::operation::{Operation, OperationError};
use onescan_server::published::{SessionView, Wants};
use onescan_server::wire::message::Status as Taken;
use tokio::sync::{mpsc, oneshot};

use super::alarms::{Change, Rung};
use super::ask::{self, Ask, Verb};
use super::desk::AtWork;
use super::entry::Rank;
use super::error::Refused;
use super::gaze::{self, Gaze};
use super::maps::{Mapped, New};
use super::online::Watching;
use super::picture::{FLAGS, PAST, Shown};
use super::seats::Viewer;
use super::told::{Gone, Told, say, send};
use super::verdicts::Heard;
use super::{News, Session, rights};
use crate::past::Moment;

#[cfg(test)]
mod tests;

/// How many looks it takes until the viewer is told how far the past reaches by now.
const PAST_EACH: u32 = 30;
/// How many looks it takes until variables of PLCs are looked at again: people read ten values a second.
const VARIABLES_EACH: u32 = 6;
/// How many looks it takes until the status is sent again, if it has changed: seats, forces, how far the past reaches.
const STATUS_EACH: u32 = 3;
/// How many looks it takes until it is asked again what has become of expectations.
const VERDICTS_EACH: u32 = 15;

/// Speaks with a viewer until one of the two leaves.
pub(super) async fn attend(mut socket: WebSocket, session: Arc<Session>, rank: Rank) {
    let _present = session.attendance.enter();
    let viewer = session.seats.enter();
    // what ends it is that the viewer is gone
    let _ = converse(&mut socket, &session, (viewer, rank)).await;
    session.seats.leave(viewer);
}

/// What one viewer looks at, and what it has been shown and told of it.
struct Eye {
    gaze: Gaze,
    shown: Shown,
    watching: Watching,
    mapped: Mapped,
    /// What of clients is to be seen in views.
    wants: Wants,
    judged: Heard,
    /// The view of the live edge that was shown last.
    seen: Option<u64>,
    /// The status that was told last.
    status: String,
    /// How many of the news were told.
    heard: usize,
    past_ns: Option<[u64; 2]>,
    /// How often it was looked for something new.
    turns: u32,
    /// The looks that were on when they were told last.
    looks: Option<Vec<usize>>,
    /// The drawing that is shown, and which instance of it.
    drawn: Option<(usize, usize)>,
    /// The values of the drawing that were told last.
    states: Option<States>,
    rung: Rung,
}

/// A drawing with its instance, and the values of its states.
type States = ((usize, usize), Vec<Option<f64>>);

impl Eye {
    fn new(session: &Session) -> Self {
        Self {
            gaze: Gaze::new(session),
            shown: Shown::default(),
            watching: Watching::default(),
            mapped: Mapped::default(),
            wants: session.published.want(Parts::POSES),
            judged: Heard::default(),
            seen: None,
            status: String::new(),
            heard: 0,
            past_ns: None,
            turns: 0,
            looks: None,
            drawn: None,
            states: None,
            rung: Rung::default(),
        }
    }

    /// Wants of views what is looked at now.
    fn look_closer(&mut self, session: &Session) {
        let memories = self.watching.is_wanted() || self.drawn.is_some();
        let parts = Parts { poses: true, tables: self.mapped.is_wanted(), memories };
        if parts != self.wants.parts() {
            self.wants = session.published.want(parts);
        }
    }
}

async fn converse(socket: &mut WebSocket, session: &Session, who: (Viewer, Rank)) -> Result<(), Gone> {
    let (outcomes, mut done) = mpsc::unbounded_channel::<Told>();
    let mut eye = Eye::new(session);
    let mut look = session.beat.looks();
    let mut called = session.called.follow();
    loop {
        tokio::select! {
            message = socket.recv() => match message {
                Some(Ok(Message::Text(text))) => match heed(&text, session, who, &mut eye, &outcomes) {
                    Ok(true) => {
                        eye.seen = None;
                        if let Some(view) = eye.gaze.seen() {
                            picture(socket, &view, session, &mut eye).await?;
                        }
                    }
                    Ok(false) => {}
                    Err(refused) => say(socket, &Told::Error { message: refused.to_string() }).await?,
                },
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
            Some(told) = done.recv() => say(socket, &told).await?,
            moment = eye.gaze.next() => turn(moment, socket, session, &mut eye).await?,
            _ = look.tick() => {
                let view = session.published.latest();
                if session.beat.is_first() {
                    session.published.ask();
                }
                let is_time = eye.turns.is_multiple_of(STATUS_EACH) || view.is_held || view.end.is_some();
                tell_beside(socket, &view, session, &mut eye).await?;
                if is_time {
                    tell_status(socket, &view, session, who.0, &mut eye).await?;
                }
                // a view of a restarted session has a smaller time, and a revision of its own all the same
                if eye.seen != Some(view.revision) && !eye.gaze.is_past() {
                    eye.seen = Some(view.revision);
                    picture(socket, &view, session, &mut eye).await?;
                }
                if session.ended() && (view.end.is_some() || session.recorded_to.is_some()) {
                    return part(socket, &view, session, &mut eye).await;
                }
            }
        }
    }
}

/// A moment of the past has come that the viewer has asked for.
async fn turn(moment: Moment, socket: &mut WebSocket, session: &Session, eye: &mut Eye) -> Result<(), Gone> {
    let was_past = eye.gaze.seen().is_some();
    match eye.gaze.see(moment) {
        Ok(Some(view)) => {
            if !was_past {
                eye.shown.forget();
            }
            picture(socket, &view, session, eye).await
        }
        Ok(None) => Ok(()),
        Err(refused) => say(socket, &Told::Error { message: refused.to_string() }).await,
    }
}

/// Tells what is new beside pictures, each thing as often as people read it.
async fn tell_beside(
    socket: &mut WebSocket,
    view: &Arc<SessionView>,
    session: &Session,
    eye: &mut Eye,
) -> Result<(), Gone> {
    if eye.turns.is_multiple_of(PAST_EACH) {
        eye.past_ns = gaze::past_ns(session);
    }
    if eye.turns.is_multiple_of(VARIABLES_EACH) {
        let looked_at = if eye.gaze.is_past() { eye.gaze.seen() } else { Some(Arc::clone(view)) };
        if let Some(view) = looked_at {
            tell_inside(socket, &view, session, eye).await?;
        }
    }
    if eye.turns.is_multiple_of(VERDICTS_EACH) {
        tell_verdicts(socket, session, eye).await?;
    }
    eye.turns = eye.turns.wrapping_add(1);
    for News { t_v, kind, text } in session.news_after(eye.heard) {
        eye.heard += 1;
        say(socket, &Told::Event { t_ns: t_v.as_nanos(), kind, text }).await?;
    }
    Ok(())
}

/// Tells what clients have beside their signals: variables and tables.
async fn tell_inside(socket: &mut WebSocket, view: &SessionView, session: &Session, eye: &mut Eye) -> Result<(), Gone> {
    if let Some(seen) = eye.watching.see(view, &session.known.online) {
        say(socket, &Told::Variables { seen }).await?;
    }
    for new in eye.mapped.see(view, &session.known.maps, eye.gaze.is_past()) {
        match new {
            New::Cells(cells) => say(socket, &Told::Map { cells }).await?,
            New::Values(bytes) => send(socket, Message::Binary(bytes)).await?,
        }
    }
    Ok(())
}

async fn tell_verdicts(socket: &mut WebSocket, session: &Session, eye: &mut Eye) -> Result<(), Gone> {
    for standing in eye.judged.news(session.bench.standings(&session.expected)) {
        say(socket, &Told::Verdict { standing }).await?;
    }
    Ok(())
}

/// The session is over: tells how it ended, and what came of its expectations; what it holds is that of its last step.
async fn part(socket: &mut WebSocket, view: &SessionView, session: &Session, eye: &mut Eye) -> Result<(), Gone> {
    tell_verdicts(socket, session, eye).await?;
    if !eye.gaze.is_past() {
        tell_inside(socket, view, session, eye).await?;
    }
    let Some(end) = &view.end else { return Ok(()) };
    say(socket, &Told::Event { t_ns: view.t_v.as_nanos(), kind: "end", text: end.to_string() }).await
}

async fn tell_status(
    socket: &mut WebSocket,
    view: &SessionView,
    session: &Session,
    viewer: Viewer,
    eye: &mut Eye,
) -> Result<(), Gone> {
    let told = told(view, session, viewer, eye);
    if told != eye.status {
        send(socket, Message::Text(told.clone().into())).await?;
        eye.status = told;
    }
    Ok(())
}

/// How the session is, in words that change only when it does.
fn told(view: &SessionView, session: &Session, viewer: Viewer, eye: &Eye) -> String {
    let state = match (&view.end, view.is_held) {
        _ if session.recorded_to.is_some() => "recorded",
        (Some(_), _) => "end",
        (None, true) => "hold",
        (None, false) => "run",
    };
    let digest = view.end.as_ref().and(view.digest).map(|digest| digest.to_string());
    let is_secret = rights::is_trainee(session);
    let at_work = if is_secret { AtWork::default() } else { session.failing.now() };
    let disturbed = session.known.disturbed(&at_work);
    let failed = at_work.failed().clone();
    let forced = if is_secret { Vec::new() } else { view.forced.iter().map(|signal| signal.index()).collect() };
    let (pace, seat) = (session.pace.clone(), session.seats.seen_by(viewer));
    let (shown_ns, past_ns) = (eye.gaze.shown_ns(), eye.past_ns);
    let told = Told::Status { state, digest, pace, seat, failed, forced, disturbed, shown_ns, past_ns };
    serde_json::to_string(&told).unwrap_or_else(|error| error.to_string())
}

/// Shows a step, and whether it is of the past.
async fn picture(socket: &mut WebSocket, view: &SessionView, session: &Session, eye: &mut Eye) -> Result<(), Gone> {
    let mut picture = eye.shown.picture(view, &session.layout, &session.known.stage);
    if eye.gaze.is_past() {
        picture[FLAGS] |= PAST;
    }
    send(socket, Message::Binary(Bytes::from(picture))).await?;
    tell_drawn(socket, view, session, eye).await
}

/// Tells what a picture goes with: the looks that are on, alarms, and the values of a drawing.
async fn tell_drawn(socket: &mut WebSocket, view: &SessionView, session: &Session, eye: &mut Eye) -> Result<(), Gone> {
    let active = session.known.looks.active(view, &session.layout);
    if eye.looks.as_ref() != Some(&active) {
        eye.looks = Some(active.clone());
        say(socket, &Told::Looks { active }).await?;
    }
    // Alarms are those of the live edge: who looks at the past has been told of them.
    if !eye.gaze.is_past() {
        let t_ns = view.t_v.as_nanos();
        for Change { kind, name } in session.known.bell.changes(&mut eye.rung, view, &session.layout) {
            say(socket, &Told::Event { t_ns, kind, text: name.to_owned() }).await?;
        }
    }
    let drawn = eye.drawn.filter(|_| view.clients.parts.memories);
    let now = drawn.map(|drawn| (drawn, session.known.states.values(drawn, view)));
    if let Some(((drawing, instance), values)) = now.clone().filter(|_| now != eye.states) {
        say(socket, &Told::States { drawing, instance, values }).await?;
    }
    eye.states = now;
    Ok(())
}

/// What is left to do once a message has been handled.
enum Next {
    /// Nothing.
    Nothing,
    /// The next picture, at once.
    Picture,
    /// These operations, all at one step boundary.
    Operations(Vec<Operation>),
}

/// Does what a message asks, if its sender has the right; true if the next picture is due at once.
fn heed(
    text: &str,
    session: &Session,
    (viewer, rank): (Viewer, Rank),
    eye: &mut Eye,
    outcomes: &mpsc::UnboundedSender<Told>,
) -> Result<bool, Refused> {
    let ask = Ask::read(text)?;
    rights::check(ask.needs(), session, (viewer, rank))?;
    Ok(match perform(ask, session, viewer, eye, outcomes)? {
        Next::Nothing => false,
        Next::Picture => true,
        Next::Operations(operations) => {
            wish(operations, session, outcomes);
            false
        }
    })
}

/// Does what a message asks. Whoever calls has checked the right.
fn perform(
    ask: Ask,
    session: &Session,
    viewer: Viewer,
    eye: &mut Eye,
    outcomes: &mpsc::UnboundedSender<Told>,
) -> Result<Next, Refused> {
    let known = &session.known;
    let one = |operation: Operation| Next::Operations(vec![operation]);
    Ok(match ask {
        Ask::Subscribe { signals } => {
            eye.shown.want(ask::signals(&signals, &session.layout)?);
            Next::Picture
        }
        Ask::Draw { drawing, instance } => {
            eye.drawn = drawing.map(|drawing| known.states.check(drawing, instance)).transpose()?;
            eye.look_closer(session);
            Next::Picture
        }
        Ask::Watch { variables } => {
            known.online.check(&variables)?;
            eye.watching.want(variables);
            eye.look_closer(session);
            Next::Nothing
        }
        Ask::Maps { maps } => {
            eye.mapped.want(maps, &known.maps)?;
            eye.look_closer(session);
            Next::Nothing
        }
        Ask::Show { t_ns } => {
            eye.gaze.show(t_ns, session)?;
            Next::Nothing
        }
        Ask::Live => {
            let has_turned = eye.gaze.live(session);
            if has_turned {
                eye.shown.forget();
            }
            if has_turned { Next::Picture } else { Next::Nothing }
        }
        Ask::Fork { t_ns } => {
            fork(t_ns, session, &eye.gaze, outcomes)?;
            Next::Nothing
        }
        Ask::Operate { operation: Verb::Stop } if session.recorded_to.is_some() => {
            session.left.store(true, Ordering::Release);
            Next::Nothing
        }
        Ask::Operate { operation } => one(operation.into()),
        Ask::Seat { panel, take } => {
            session.seats.claim(&panel, viewer, take)?;
            Next::Nothing
        }
        Ask::Write { signal, value } => one(ask::write(session.declared(signal)?, value, known)?),
        Ask::Variable { variable, action, value } => {
            one(known.online.operation(variable, action, value).ok_or(Refused::NoVariable(variable))?)
        }
        Ask::Force { signal, value } => one(ask::force(session.declared(signal)?, value)),
        Ask::Fail { component, failure, active } => one(ask::fail(component, failure, active, known)?),
        Ask::Disturb { disturbance, active } => {
            Next::Operations(ask::disturb(disturbance, active, known, &session.failing.now())?)
        }
        Ask::Train(asked) => {
            let training = session.training.as_ref().ok_or(Refused::NoLesson)?;
            training.desk.ask(ask::turn(asked, training)?);
            Next::Nothing
        }
        Ask::View { view } => {
            session.called.call(view);
            Next::Nothing
        }
    })
}

/// Lets a session go on from a moment of the past, beside this one; the viewer is told where it is.
fn fork(t_ns: f64, session: &Session, gaze: &Gaze, outcomes: &mpsc::UnboundedSender<Told>) -> Result<(), Refused> {
    let t_v = gaze::moment(t_ns, session)?;
    let saved = gaze.gazer(session)?.save(t_v);
    let (outcomes, launch) = (outcomes.clone(), Arc::clone(&session.launch));
    tokio::spawn(async move {
        let saved: Result<Vec<u8>, String> = saved.await.unwrap_or_else(|_| Err("the session is over".to_owned()));
        let forked = match saved {
            // it takes as long as the other session takes to begin
            Ok(bytes) => {
                tokio::task::spawn_blocking(move || launch(&bytes)).await.unwrap_or_else(|e| Err(e.to_string()))
            }
            Err(why) => Err(why),
        };
        let told = match forked {
            Ok(url) => Told::Forked { t_ns: t_v.as_nanos(), url },
            Err(why) => Told::Error { message: format!("no session goes on from {t_v}: {why}") },
        };
        // a viewer that has left hears nothing
        outcomes.send(told).ok();
    });
    Ok(())
}

/// Leaves wishes in the session's mailbox, which are taken at one boundary; what comes of them is told when the session has.
fn wish(operations: Vec<Operation>, session: &Session, outcomes: &mpsc::UnboundedSender<Told>) {
    let posted = operations.into_iter().map(|operation| {
        let (reply, answer) = oneshot::channel::<Result<Taken, OperationError>>();
        (Request { wish: Wish::Do(operation), reply: Some(reply) }, answer)
    });
    let (requests, answers): (Vec<_>, Vec<_>) = posted.unzip();
    session.mailbox.post_all(requests);
    let outcomes = outcomes.clone();
    tokio::spawn(async move {
        for answer in answers {
            let message = match answer.await {
                Ok(Ok(_)) => continue,
                Ok(Err(error)) => error.to_string(),
                Err(_) => "the session is over".to_owned(),
            };
            // a viewer that has left hears nothing
            outcomes.send(Told::Error { message }).ok();
        }
    });
}
