//! The lobby: listens, greets, and hands those who want to join to the session's thread.

use std::collections::BTreeMap;
use std::net::{IpAddr, SocketAddr};
use std::ops::ControlFlow;
use std::sync::mpsc::{Receiver, SendError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use bytes::Bytes;
use futures_util::{SinkExt, StreamExt};
use serde::Serialize;
use serde::de::DeserializeOwned;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};
use tokio::sync::{Notify, Semaphore, oneshot};
use tokio_util::codec::Framed;
use tokio_util::task::TaskTracker;

use super::remote::Remote;
use super::stream::FrameStream;
use super::{AGENT, FAREWELL_TIMEOUT, HANDSHAKE_TIMEOUT, ReceiveError};
use crate::carrier::{Applicant, Carrier, Door};
use crate::client::JoinRequest;
use crate::mailbox::{Mailbox, Request};
use crate::operation::Operation;
use crate::plan::SessionPlan;
use crate::signal::PortLayout;
use crate::wire::message::{Role, placed};
use crate::wire::{
    ClientMessage, FRAME_BYTES_MAX, Frame, FrameCodec, FrameError, FrameRef, HANDSHAKE_FRAME_BYTES_MAX, ServerMessage,
    VERSIONS,
};

/// Connections that may be in the lobby at once before they have said who they are, or wait for a place.
const GUESTS_MAX: usize = 64;

/// Operators that may be connected at once, and of them from one address: they may stay, and must not take the places of
/// clients, or of each other.
const OPERATORS_MAX: usize = 64;
const OPERATORS_OF_ADDRESS_MAX: usize = 16;

/// The refusal of whoever comes when the session has begun.
const BEGUN: &str = "the session has begun: nobody can join any more";

type Connection = Framed<TcpStream, FrameCodec>;

/// How long an operator may be silent.
const OPERATOR_PATIENCE: Duration = Duration::from_hours(24);

/// A client that wants to join and waits for the answer.
struct Guest {
    request: JoinRequest,
    peer: SocketAddr,
    stream: std::net::TcpStream,
    turned_away: UnboundedSender<TurnedAway>,
}

/// A connection, and why it is closed. Whoever decides that has no time to wait for the farewell.
struct TurnedAway {
    stream: std::net::TcpStream,
    why: String,
}

impl Applicant for Guest {
    fn request(&self) -> &JoinRequest {
        &self.request
    }

    fn origin(&self) -> String {
        self.peer.to_string()
    }

    fn admit(
        self: Box<Self>,
        inputs: &PortLayout,
        outputs: &PortLayout,
        reply_timeout: Duration,
    ) -> std::io::Result<Box<dyn Carrier>> {
        let joined = ServerMessage::Joined {
            input_bytes: inputs.size() as u32,
            inputs: placed(inputs),
            output_bytes: outputs.size() as u32,
            outputs: placed(outputs),
        };
        let connection = FrameStream::new(self.stream, FRAME_BYTES_MAX, reply_timeout)?;
        let mut remote = Remote::new(connection, reply_timeout);
        // A peer that is gone already shows at the set-up.
        remote.send_message(&joined);
        Ok(Box::new(remote))
    }

    fn refuse(self: Box<Self>, why: &str) {
        let Self { stream, turned_away, .. } = *self;
        if turned_away.send(TurnedAway { stream, why: why.to_owned() }).is_err() {
            // The lobby is closed, and with it all that wait in it.
            tracing::debug!(peer = %self.peer, "was gone before it heard that it is refused");
        }
    }
}

/// A listener with a thread of its own; closed when dropped.
pub struct Lobby {
    address: SocketAddr,
    /// Nothing once the door is shut.
    applicants: Mutex<Option<Receiver<Guest>>>,
    close: Arc<Notify>,
    thread: Option<std::thread::JoinHandle<()>>,
}

/// What every greeting needs.
struct Host {
    /// `welcome`, as it is sent.
    welcome: Bytes,
    applicants: Sender<Guest>,
    turned_away: UnboundedSender<TurnedAway>,
    mailbox: Mailbox,
    seats: Semaphore,
    operators: Operators,
    /// Operators that wait for an answer.
    answers: TaskTracker,
}

impl Lobby {
    /// Listens on `address` for clients of the session `plan` and for operators, whose wishes go to
    /// `mailbox`.
    ///
    /// # Errors
    /// The address cannot be listened on.
    pub fn open(address: SocketAddr, plan: &SessionPlan, mailbox: Mailbox) -> std::io::Result<Self> {
        let listener = std::net::TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let (sender, receiver) = channel();
        let welcome = ServerMessage::Welcome {
            protocol: VERSIONS.max,
            agent: AGENT.to_owned(),
            step: plan.step(),
            frame_bytes_max: FRAME_BYTES_MAX as u32,
            signals: plan.signals().to_vec(),
        };
        let welcome = Bytes::from(crate::wire::frame::to_json(&welcome)?);
        let (turned_away, leaving) = unbounded_channel();
        let host = Host {
            welcome,
            applicants: sender,
            turned_away,
            mailbox,
            seats: Semaphore::new(GUESTS_MAX),
            operators: Operators::default(),
            answers: TaskTracker::new(),
        };
        let close = Arc::new(Notify::new());
        let closing = Arc::clone(&close);
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let thread = std::thread::Builder::new()
            .name("lobby".to_owned())
            .spawn(move || runtime.block_on(receive_guests(listener, Arc::new(host), leaving, closing)))?;
        Ok(Self { address, applicants: Mutex::new(Some(receiver)), close, thread: Some(thread) })
    }

    /// Where it listens; tells the port where none was asked for.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Door for Lobby {
    fn next_applicant(&self, patience: Duration) -> Option<Box<dyn Applicant>> {
        let waiting = self.applicants.lock().unwrap_or_else(PoisonError::into_inner);
        let guest = waiting.as_ref()?.recv_timeout(patience).ok()?;
        Some(Box::new(guest))
    }

    fn shut(&self) {
        let waiting = self.applicants.lock().unwrap_or_else(PoisonError::into_inner).take();
        // Who was waiting is told; who comes later finds nobody to wait for.
        waiting.iter().flat_map(Receiver::try_iter).for_each(|guest| Box::new(guest).refuse(BEGUN));
    }
}

impl Drop for Lobby {
    fn drop(&mut self) {
        self.close.notify_one();
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has nothing left to close.
            let _ = thread.join();
        }
    }
}

async fn receive_guests(
    listener: std::net::TcpListener,
    host: Arc<Host>,
    mut leaving: UnboundedReceiver<TurnedAway>,
    closing: Arc<Notify>,
) {
    let listener = match TcpListener::from_std(listener) {
        Ok(listener) => listener,
        Err(error) => return tracing::error!(%error, "the lobby cannot listen"),
    };
    loop {
        let accepted = tokio::select! {
            () = closing.notified() => {
                while let Ok(away) = leaving.try_recv() {
                    host.answers.spawn(turn_away(away));
                }
                return part_from_operators(&host).await;
            }
            Some(away) = leaving.recv() => {
                host.answers.spawn(turn_away(away));
                continue;
            }
            accepted = listener.accept() => accepted,
        };
        match accepted {
            Ok((stream, peer)) => {
                let host = Arc::clone(&host);
                tokio::spawn(async move {
                    if let Err(error) = greet(stream, peer, &host).await {
                        tracing::warn!(%peer, %error, "left the lobby");
                    }
                });
            }
            Err(error) => {
                // Out of descriptors, mostly: others may leave meanwhile.
                tracing::warn!(%error, "cannot accept a connection");
                tokio::time::sleep(Duration::from_millis(100)).await;
            }
        }
    }
}

/// One who asked for the session's end still hears that it came: what has been taken from the mailbox is answered
/// before the connections close.
async fn part_from_operators(host: &Host) {
    host.answers.close();
    // Nobody takes these any more.
    while host.mailbox.take().is_some() {}
    // An operator that does not read is left.
    let _ = tokio::time::timeout(FAREWELL_TIMEOUT, host.answers.wait()).await;
}

/// Tells a guest that it cannot join, and why.
async fn turn_away(TurnedAway { stream, why }: TurnedAway) {
    let Ok(stream) = TcpStream::from_std(stream) else { return };
    let mut connection = Framed::new(stream, FrameCodec::new(FRAME_BYTES_MAX));
    if let Err(error) = refuse(&mut connection, &why).await {
        // A client that is gone needs no reason.
        tracing::debug!(%error, "was gone before it heard that it is refused");
    }
}

async fn greet(stream: TcpStream, peer: SocketAddr, host: &Host) -> Result<(), ReceiveError> {
    stream.set_nodelay(true).map_err(FrameError::from)?;
    let mut connection = Framed::new(stream, FrameCodec::new(HANDSHAKE_FRAME_BYTES_MAX));
    let Ok(seat) = host.seats.try_acquire() else {
        return refuse(&mut connection, "too many connections are waiting in the lobby").await;
    };
    let (protocol, role, agent) = match receive(&mut connection, HANDSHAKE_TIMEOUT).await {
        Ok(ClientMessage::Hello { protocol, role, agent }) => (protocol, role, agent),
        Ok(_) => return refuse(&mut connection, "the first message must be `hello`").await,
        Err(error) => {
            refuse(&mut connection, &error.to_string()).await?;
            return Err(error);
        }
    };
    tracing::debug!(%peer, %agent, ?role, "hello");
    if VERSIONS.common(protocol).is_none() {
        let why = format!("no common protocol version: this server speaks {VERSIONS}, {agent} speaks {protocol}");
        return refuse(&mut connection, &why).await;
    }
    // A session may have more signals than a handshake has room for: a `join` that names them all twice is in order.
    connection.codec_mut().set_limit(FRAME_BYTES_MAX);
    connection.send(FrameRef::Json(&host.welcome)).await?;
    connection.codec_mut().set_limit((HANDSHAKE_FRAME_BYTES_MAX + 2 * host.welcome.len()).min(FRAME_BYTES_MAX));
    match role {
        Role::Operator => {
            drop(seat);
            let Some(_place) = host.operators.come(peer.ip()) else {
                return refuse(&mut connection, "too many operators are connected").await;
            };
            serve_operator(connection, host).await
        }
        Role::Client => take_application(connection, peer, host).await,
    }
}

/// How many operators are connected, by address.
#[derive(Default)]
struct Operators(Mutex<BTreeMap<IpAddr, usize>>);

impl Operators {
    fn lock(&self) -> MutexGuard<'_, BTreeMap<IpAddr, usize>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A place for one more, until it is dropped; none if there are too many.
    fn come(&self, address: IpAddr) -> Option<OperatorPlace<'_>> {
        let mut connected = self.lock();
        let of_address = connected.get(&address).copied().unwrap_or(0);
        if connected.values().sum::<usize>() >= OPERATORS_MAX || of_address >= OPERATORS_OF_ADDRESS_MAX {
            return None;
        }
        connected.insert(address, of_address + 1);
        Some(OperatorPlace { operators: self, address })
    }
}

/// The place of one operator.
struct OperatorPlace<'o> {
    operators: &'o Operators,
    address: IpAddr,
}

impl Drop for OperatorPlace<'_> {
    fn drop(&mut self) {
        let mut connected = self.operators.lock();
        if let Some(count) = connected.get_mut(&self.address) {
            *count -= 1;
            if *count == 0 {
                connected.remove(&self.address);
            }
        }
    }
}

async fn take_application(mut connection: Connection, peer: SocketAddr, host: &Host) -> Result<(), ReceiveError> {
    let request = match receive(&mut connection, HANDSHAKE_TIMEOUT).await {
        Ok(ClientMessage::Join(request)) => request,
        Ok(_) => return refuse(&mut connection, "the second message of a client must be `join`").await,
        Err(error) => {
            refuse(&mut connection, &error.to_string()).await?;
            return Err(error);
        }
    };
    let parts = connection.into_parts();
    if !parts.read_buf.is_empty() {
        let mut connection = Framed::from_parts(parts);
        return refuse(&mut connection, "a client must wait for the answer to `join`").await;
    }
    let stream = parts.io.into_std().map_err(FrameError::from)?;
    let guest = Guest { request, peer, stream, turned_away: host.turned_away.clone() };
    if let Err(SendError(guest)) = host.applicants.send(guest) {
        Box::new(guest).refuse(BEGUN);
    }
    Ok(())
}

async fn serve_operator(mut connection: Connection, host: &Host) -> Result<(), ReceiveError> {
    loop {
        let operation = match receive(&mut connection, OPERATOR_PATIENCE).await {
            Ok(ClientMessage::Control(control)) => Some(control.into()),
            Ok(ClientMessage::Operate(operation)) => Some(operation),
            Ok(ClientMessage::Status {}) => None,
            Ok(_) => return refuse(&mut connection, "an operator may send `control`, `operate` and `status`").await,
            Err(ReceiveError::Closed) => return Ok(()),
            Err(error) => return Err(error),
        };
        if host.answers.track_future(answer(&mut connection, operation, host)).await?.is_break() {
            return Ok(());
        }
    }
}

/// Leaves a wish and tells what came of it; breaks off after a refusal, or when the session is over.
async fn answer(
    connection: &mut Connection,
    operation: Option<Operation>,
    host: &Host,
) -> Result<ControlFlow<()>, ReceiveError> {
    let (reply, answer) = oneshot::channel();
    host.mailbox.post(Request { operation, reply: Some(reply) });
    match answer.await {
        Ok(Ok(status)) => {
            send(connection, &ServerMessage::Status(status)).await?;
            Ok(ControlFlow::Continue(()))
        }
        Ok(Err(error)) => refuse(connection, &error.to_string()).await.map(ControlFlow::Break),
        Err(_) => Ok(ControlFlow::Break(())),
    }
}

async fn refuse(connection: &mut Connection, why: &str) -> Result<(), ReceiveError> {
    send(connection, &ServerMessage::Refused { message: why.to_owned() }).await?;
    farewell(connection).await;
    Ok(())
}

async fn receive<M: DeserializeOwned>(connection: &mut Connection, patience: Duration) -> Result<M, ReceiveError> {
    match tokio::time::timeout(patience, connection.next()).await {
        Err(_) => Err(ReceiveError::TimedOut(patience)),
        Ok(None) => Err(ReceiveError::Closed),
        Ok(Some(Ok(Frame::Json(text)))) => Ok(serde_json::from_slice(&text)?),
        Ok(Some(Ok(_))) => Err(ReceiveError::NotJson),
        Ok(Some(Err(error))) => Err(error.into()),
    }
}

async fn send<M: Serialize>(connection: &mut Connection, message: &M) -> Result<(), FrameError> {
    let json = crate::wire::frame::to_json(message).map_err(std::io::Error::from)?;
    connection.send(FrameRef::Json(&json)).await
}

/// Closes after a last message: no more is sent, and what still comes is thrown away, so that the
/// operating system does not reset the connection and the last message with it.
async fn farewell(connection: &mut Connection) {
    use tokio::io::{AsyncReadExt, AsyncWriteExt};
    let stream = connection.get_mut();
    let drain = async {
        let mut waste = [0; 4096];
        stream.shutdown().await.ok()?;
        while stream.read(&mut waste).await.ok()? > 0 {}
        Some(())
    };
    // One who does not close in time is left.
    let _ = tokio::time::timeout(FAREWELL_TIMEOUT, drain).await;
}
