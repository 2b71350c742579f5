//! One viewer: what it asks and what it is shown. It looks at the session as often as it can take; views in between
//! are dropped, so a slow viewer slows nobody.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use axum::body::Bytes;
use axum::extract::ws::{Message, WebSocket};
use onescan_server::client::Parts;
use onescan_server::end::SessionEnd;
use onescan_server::mailbox::{Request, Wish};
use onescan_server::operation::{Operation, OperationError};
use onescan_server::published::{SessionView, Wants};
use onescan_server::wire::message::Status as Taken;
use tokio::sync::{mpsc, oneshot};

use super::alarms::{Fate, Read};
use super::ask::{self, Ask, Verb};
use super::entry::Rank;
use super::error::Refused;
use super::lesson::{Attempt, Drive};
use super::maps::{Mapped, New};
use super::online::Watching;
use super::picture::{FLAGS, PAST, Shown};
use super::playhead::{self, Playhead};
use super::response::{Gone, Response, SessionState, notify, send};
use super::seats::Viewer;
use super::training::AtWork;
use super::verdicts::Reported;
use super::{News, Session, rights};
use crate::past::Moment;

mod beside;
#[cfg(test)]
mod tests;

/// How many frames it takes until it is asked again how far the past reaches by now.
const PAST_EACH: u32 = 30;
/// How many frames it takes until variables of PLCs are looked at again: people read ten values a second.
const VARIABLES_EACH: u32 = 6;
/// How many frames it takes until the status is sent again, if it has changed: seats, forces, how far the past reaches.
const STATUS_EACH: u32 = 3;
/// How many frames it takes until it is asked again what has become of expectations.
const VERDICTS_EACH: u32 = 15;

/// Speaks with a viewer until one of the two leaves.
pub(super) async fn attend(mut socket: WebSocket, session: Arc<Session>, rank: Rank) {
    let _present = session.attendance.enter();
    let viewer = session.seats.enter();
    // what ends it is that the viewer is gone
    let _ = converse(&mut socket, &session, (viewer, rank)).await;
    session.seats.leave(viewer);
}

/// What one viewer looks at, and what of it has been shown and reported.
struct Subscription {
    playhead: Playhead,
    shown: Shown,
    watching: Watching,
    mapped: Mapped,
    /// What of clients is to be seen in views.
    wants: Wants,
    judged: Reported,
    /// The view of the live edge that was shown last.
    seen: Option<u64>,
    /// The status as it was reported last.
    status: String,
    /// How many of the news were reported.
    reported: usize,
    past_ns: Option<[u64; 2]>,
    /// How often it was looked for something new.
    turns: u32,
    /// The looks that were on when they were reported last.
    looks: Option<Vec<usize>>,
    /// The drawing that is shown, and which instance of it.
    drawn: Option<(usize, usize)>,
    /// The values of the drawing as they were reported last.
    states: Option<States>,
    /// How far the alarms have been reported.
    rung: Read,
    /// How the lesson went when it was reported last.
    attempt: Option<Attempt>,
    /// How far real PLCs were then.
    drive: Option<Drive>,
}

/// A drawing with its instance, and the values of its states.
type States = ((usize, usize), Vec<Option<f64>>);

impl Subscription {
    fn new(session: &Session) -> Self {
        Self {
            playhead: Playhead::new(session),
            shown: Shown::default(),
            watching: Watching::default(),
            mapped: Mapped::default(),
            wants: session.published.want(Parts::POSES),
            judged: Reported::default(),
            seen: None,
            status: String::new(),
            reported: 0,
            past_ns: None,
            turns: 0,
            looks: None,
            drawn: None,
            states: None,
            rung: Read::default(),
            attempt: None,
            drive: None,
        }
    }

    /// Wants of views what is looked at now.
    fn update_wants(&mut self, session: &Session) {
        let memories = self.watching.is_wanted() || self.drawn.is_some();
        let parts = Parts { poses: true, tables: self.mapped.is_wanted(), memories };
        if parts != self.wants.parts() {
            self.wants = session.published.want(parts);
        }
    }
}

async fn converse(socket: &mut WebSocket, session: &Session, who: (Viewer, Rank)) -> Result<(), Gone> {
    let (outcomes, mut done) = mpsc::unbounded_channel::<Response>();
    let mut subscription = Subscription::new(session);
    let mut frame = session.frames.ticks();
    let mut called = session.called.follow();
    loop {
        tokio::select! {
            message = socket.recv() => match message {
                Some(Ok(Message::Text(text))) => match handle(&text, session, who, &mut subscription, &outcomes) {
                    Ok(true) => {
                        subscription.seen = None;
                        if let Some(view) = subscription.playhead.seen() {
                            picture(socket, &view, session, &mut subscription).await?;
                        }
                    }
                    Ok(false) => {}
                    Err(refused) => notify(socket, &Response::Error { message: refused.to_string() }).await?,
                },
                Some(Ok(Message::Binary(_))) => {
                    let message = Refused::Garbage("bytes, where a text is expected".to_owned()).to_string();
                    notify(socket, &Response::Error { message }).await?;
                }
                Some(Ok(Message::Ping(_) | Message::Pong(_))) => {}
                Some(Ok(Message::Close(_)) | Err(_)) | None => return Ok(()),
            },
            Ok(()) = called.changed() => {
                let (_, view) = called.borrow_and_update().clone();
                notify(socket, &Response::View { view }).await?;
            }
            Some(response) = done.recv() => notify(socket, &response).await?,
            moment = subscription.playhead.next() => turn(moment, socket, session, &mut subscription).await?,
            _ = frame.tick() => {
                let view = session.published.latest();
                if session.frames.is_due(view.revision) {
                    session.published.ask();
                }
                let is_time = subscription.turns.is_multiple_of(STATUS_EACH) || view.is_held || view.end.is_some();
                notify_news(socket, &view, session, &mut subscription).await?;
                if is_time {
                    notify_status(socket, &view, session, who.0, &mut subscription).await?;
                }
                // a view of a restarted session has a smaller time, and a revision of its own all the same
                // Before the first attempt at a lesson there is nothing to be seen.
                let is_nothing = view.revision == 0 && session.training.is_some();
                if subscription.seen != Some(view.revision) && !subscription.playhead.is_past() && !is_nothing {
                    subscription.seen = Some(view.revision);
                    picture(socket, &view, session, &mut subscription).await?;
                }
                if session.ended() && (view.end.is_some() || session.recorded_to.is_some()) {
                    return part(socket, &view, session, &mut subscription).await;
                }
            }
        }
    }
}

/// A moment of the past has come that the viewer has asked for.
async fn turn(
    moment: Moment,
    socket: &mut WebSocket,
    session: &Session,
    subscription: &mut Subscription,
) -> Result<(), Gone> {
    let was_past = subscription.playhead.seen().is_some();
    match subscription.playhead.see(moment) {
        Ok(Some(view)) => {
            if !was_past {
                subscription.shown.forget();
            }
            picture(socket, &view, session, subscription).await
        }
        Ok(None) => Ok(()),
        Err(refused) => notify(socket, &Response::Error { message: refused.to_string() }).await,
    }
}

/// Reports what is new beside pictures, each thing as often as people read it.
async fn notify_news(
    socket: &mut WebSocket,
    view: &Arc<SessionView>,
    session: &Session,
    subscription: &mut Subscription,
) -> Result<(), Gone> {
    if subscription.turns.is_multiple_of(PAST_EACH) {
        subscription.past_ns = playhead::past_ns(session);
    }
    if subscription.turns.is_multiple_of(VARIABLES_EACH) {
        let looked_at =
            if subscription.playhead.is_past() { subscription.playhead.seen() } else { Some(Arc::clone(view)) };
        if let Some(view) = looked_at {
            notify_clients(socket, &view, session, subscription).await?;
        }
    }
    if subscription.turns.is_multiple_of(VERDICTS_EACH) {
        notify_verdicts(socket, session, subscription).await?;
    }
    subscription.turns = subscription.turns.wrapping_add(1);
    notify_alarms(socket, session, subscription).await?;
    for News { t_v, kind, text } in session.news_after(subscription.reported) {
        subscription.reported += 1;
        notify(socket, &Response::Event { t_ns: t_v.as_nanos(), kind, text }).await?;
    }
    Ok(())
}

/// Reports how alarms come and go, and how a lesson goes.
async fn notify_alarms(socket: &mut WebSocket, session: &Session, subscription: &mut Subscription) -> Result<(), Gone> {
    if let Some((all, changes)) = session.alarm_log.news(&mut subscription.rung) {
        notify(socket, &Response::Alarms { all, changes }).await?;
    }
    let board = session.training.as_ref().map(|training| &training.board);
    if let Some(attempt) = board.and_then(|board| board.news(&mut subscription.attempt)) {
        notify(socket, &Response::Lesson { attempt }).await?;
    }
    if board.is_some_and(|board| board.drive_news(&mut subscription.drive)) {
        notify(socket, &Response::Drive { now: subscription.drive.clone() }).await?;
    }
    Ok(())
}

/// Reports what clients have beside their signals: variables and tables.
async fn notify_clients(
    socket: &mut WebSocket,
    view: &SessionView,
    session: &Session,
    subscription: &mut Subscription,
) -> Result<(), Gone> {
    if let Some(seen) = subscription.watching.see(view, &session.known.online) {
        notify(socket, &Response::Variables { seen }).await?;
    }
    for new in subscription.mapped.see(view, &session.known.maps, subscription.playhead.is_past()) {
        match new {
            New::Cells(cells) => notify(socket, &Response::Map { cells }).await?,
            New::Values(bytes) => send(socket, Message::Binary(bytes)).await?,
        }
    }
    Ok(())
}

async fn notify_verdicts(
    socket: &mut WebSocket,
    session: &Session,
    subscription: &mut Subscription,
) -> Result<(), Gone> {
    for standing in subscription.judged.news(session.verdict_board.standings(&session.expected)) {
        notify(socket, &Response::Verdict { standing }).await?;
    }
    Ok(())
}

/// The session is over: reports how it ended and what came of its expectations. Its values are those of its last step.
async fn part(
    socket: &mut WebSocket,
    view: &SessionView,
    session: &Session,
    subscription: &mut Subscription,
) -> Result<(), Gone> {
    notify_verdicts(socket, session, subscription).await?;
    notify_alarms(socket, session, subscription).await?;
    if !subscription.playhead.is_past() {
        notify_clients(socket, view, session, subscription).await?;
    }
    let Some(end) = &view.end else { return Ok(()) };
    notify(socket, &Response::Event { t_ns: view.t_v.as_nanos(), kind: "end", text: ended(end) }).await
}

/// How the session ended, in words beside the time at which it did.
fn ended(end: &SessionEnd) -> String {
    match end {
        SessionEnd::Completed { .. } => "complete".to_owned(),
        SessionEnd::Stopped { .. } => "stopped".to_owned(),
        SessionEnd::Failed(failure) => format!("client `{}` failed: {}", failure.client, failure.cause),
    }
}

async fn notify_status(
    socket: &mut WebSocket,
    view: &SessionView,
    session: &Session,
    viewer: Viewer,
    subscription: &mut Subscription,
) -> Result<(), Gone> {
    let status = describe_status(view, session, viewer, subscription);
    if status != subscription.status {
        send(socket, Message::Text(status.clone().into())).await?;
        subscription.status = status;
    }
    Ok(())
}

/// How the session is, in words that change only when it does.
fn describe_status(view: &SessionView, session: &Session, viewer: Viewer, subscription: &Subscription) -> String {
    let state = match (&view.end, view.is_held) {
        _ if session.recorded_to.is_some() => SessionState::Recorded,
        _ if session.is_driven() => SessionState::Driven,
        (Some(_), _) => SessionState::End,
        (None, true) => SessionState::Hold,
        (None, false) => SessionState::Run,
    };
    let digest = view.end.as_ref().and(view.digest).map(|digest| digest.to_string());
    let is_secret = rights::is_trainee(session);
    let at_work = if is_secret { AtWork::default() } else { session.failing.now() };
    let disturbed = session.known.disturbed(&at_work);
    let (failed, changed) = (at_work.failed().clone(), at_work.changed().clone());
    let forced = if is_secret { BTreeSet::new() } else { view.forced.iter().map(|signal| signal.index()).collect() };
    let (pace, seat) = (session.pace.clone(), session.seats.seen_by(viewer));
    let (shown_ns, past_ns) = (subscription.playhead.shown_ns(), subscription.past_ns);
    let status = Response::Status { state, digest, pace, seat, failed, forced, disturbed, changed, shown_ns, past_ns };
    serde_json::to_string(&status).unwrap_or_else(|error| error.to_string())
}

/// Shows a step, and whether it is of the past.
async fn picture(
    socket: &mut WebSocket,
    view: &SessionView,
    session: &Session,
    subscription: &mut Subscription,
) -> Result<(), Gone> {
    let mut picture = subscription.shown.picture(view, &session.layout, &session.known.stage);
    if subscription.playhead.is_past() {
        picture[FLAGS] |= PAST;
    }
    send(socket, Message::Binary(Bytes::from(picture))).await?;
    notify_drawn(socket, view, session, subscription).await
}

/// Reports what a picture goes with: the looks that are on, and the values of a drawing.
async fn notify_drawn(
    socket: &mut WebSocket,
    view: &SessionView,
    session: &Session,
    subscription: &mut Subscription,
) -> Result<(), Gone> {
    let active = session.known.looks.active(view, &session.layout);
    if subscription.looks.as_ref() != Some(&active) {
        subscription.looks = Some(active.clone());
        notify(socket, &Response::Looks { active }).await?;
    }
    let drawn = subscription.drawn.filter(|_| view.clients.parts.memories);
    let now = drawn.map(|drawn| (drawn, session.known.states.values(drawn, view)));
    if let Some(((drawing, instance), values)) = now.clone().filter(|_| now != subscription.states) {
        notify(socket, &Response::States { drawing, instance, values }).await?;
    }
    subscription.states = now;
    Ok(())
}

/// What is left to do once a message has been handled.
enum Next {
    Nothing,
    /// The next picture, at once.
    Picture,
    /// These operations, all at one step boundary.
    Operations(Vec<Operation>),
}

/// Does what a message asks, if its sender has the right; true if the next picture is due at once.
fn handle(
    text: &str,
    session: &Session,
    (viewer, rank): (Viewer, Rank),
    subscription: &mut Subscription,
    outcomes: &mpsc::UnboundedSender<Response>,
) -> Result<bool, Refused> {
    let ask = Ask::read(text)?;
    rights::check(ask.needs(), session, (viewer, rank))?;
    Ok(match perform(ask, session, viewer, subscription, outcomes)? {
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
    subscription: &mut Subscription,
    outcomes: &mpsc::UnboundedSender<Response>,
) -> Result<Next, Refused> {
    let known = &session.known;
    let one = |operation: Operation| Next::Operations(vec![operation]);
    Ok(match ask {
        Ask::Subscribe { signals } => {
            subscription.shown.want(ask::signals(&signals, &session.layout)?);
            Next::Picture
        }
        Ask::Draw { drawing, instance } => {
            subscription.drawn = drawing.map(|drawing| known.states.check(drawing, instance)).transpose()?;
            subscription.update_wants(session);
            Next::Picture
        }
        Ask::Watch { variables } => {
            known.online.check(&variables)?;
            subscription.watching.want(variables);
            subscription.update_wants(session);
            Next::Nothing
        }
        Ask::Maps { maps } => {
            subscription.mapped.want(maps, &known.maps)?;
            subscription.update_wants(session);
            Next::Nothing
        }
        Ask::Show { t_ns } => {
            subscription.playhead.show(t_ns, session)?;
            Next::Nothing
        }
        Ask::Live => {
            let has_turned = subscription.playhead.live(session);
            if has_turned {
                subscription.shown.forget();
            }
            if has_turned { Next::Picture } else { Next::Nothing }
        }
        Ask::Fork { t_ns, until_ns } => {
            beside::fork((t_ns, until_ns), session, &subscription.playhead, outcomes)?;
            Next::Nothing
        }
        Ask::Trace { signals, from_ns, until_ns, parts } => {
            let span = (ask::signals(&signals, &session.layout)?, [from_ns, until_ns], parts);
            beside::trace(span, session, &subscription.playhead, outcomes)?;
            Next::Nothing
        }
        Ask::Case { name, save } => {
            beside::keep(name, save, session, outcomes)?;
            Next::Nothing
        }
        Ask::Operate { operation: Verb::Stop } if session.is_looked_back_at() => {
            session.left.store(true, Ordering::Release);
            Next::Nothing
        }
        Ask::Operate { operation } => one(operation.into()),
        Ask::Seat { panel, take } => {
            session.seats.claim(&panel, viewer, take)?;
            Next::Nothing
        }
        Ask::Write { signal, value } => one(ask::write(session.declared(signal)?, value, known)?),
        Ask::Reset { .. } => {
            if let Some(message) = ask::start_by_hand(&known.by_hand) {
                // a viewer that has left hears nothing
                outcomes.send(Response::Error { message }).ok();
            }
            one(Operation::Reset)
        }
        Ask::Variable { variable, action, value } => {
            one(known.online.operation(variable, action, value).ok_or(Refused::NoVariable(variable))?)
        }
        Ask::Force { signal, value } => one(ask::force(session.declared(signal)?, value)),
        Ask::Fail { component, failure, active } => one(ask::fail(component, failure, active, known)?),
        Ask::Parameter { component, parameter, value } => one(ask::parameter(component, parameter, value, known)?),
        Ask::Disturb { disturbance, active } => {
            Next::Operations(ask::disturb(disturbance, active, known, &session.failing.now())?)
        }
        Ask::Train(asked) => {
            let training = session.training.as_ref().ok_or(Refused::NoLesson)?;
            training.turns.push(ask::turn(asked, training)?);
            Next::Nothing
        }
        Ask::Acknowledge { alarms } => {
            let t_ns = session.edge().as_nanos();
            session.alarm_log.acknowledge(ask::alarms(alarms, known)?, t_ns);
            Next::Nothing
        }
        Ask::Shelve { alarm, for_s } => {
            let (alarms, t_ns) = (ask::alarms(vec![alarm], known)?, session.edge().as_nanos());
            let until_ns = for_s.map(ask::shelf_ns).transpose()?.map(|for_ns| t_ns.saturating_add(for_ns));
            let fate = if until_ns.is_some() { Fate::Shelved } else { Fate::Unshelved };
            session.alarm_log.note(alarms, t_ns, fate, until_ns);
            Next::Nothing
        }
        Ask::View { view } => {
            session.called.call(view);
            Next::Nothing
        }
    })
}

/// Leaves operations in the session's mailbox, which takes them at one boundary; reports those that fail once it has.
fn wish(operations: Vec<Operation>, session: &Session, outcomes: &mpsc::UnboundedSender<Response>) {
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
            outcomes.send(Response::Error { message }).ok();
        }
    });
}
