//! The lobby: listens, greets, and hands those who want to join to the session's thread.

use std::net::SocketAddr;
use std::ops::ControlFlow;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use futures_util::{SinkExt, StreamExt};
use serde::Serialize;
use serde::de::DeserializeOwned;
use tokio::net::{TcpListener, TcpStream};
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

/// Connections that may be in the lobby at once, operators included.
const GUESTS_MAX: usize = 64;

type Connection = Framed<TcpStream, FrameCodec>;

/// How long an operator may be silent.
const OPERATOR_PATIENCE: Duration = Duration::from_hours(24);

/// A client that wants to join and waits for the answer.
struct Guest {
    request: JoinRequest,
    peer: SocketAddr,
    stream: std::net::TcpStream,
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
        let refused = ServerMessage::Refused { message: why.to_owned() };
        let sent = FrameStream::new(self.stream, FRAME_BYTES_MAX, HANDSHAKE_TIMEOUT).map(|mut connection| {
            let sent = connection.send_message(&refused);
            connection.farewell();
            sent
        });
        if !matches!(sent, Ok(Ok(()))) {
            // A client that is gone needs no reason.
            tracing::debug!(peer = %self.peer, "was gone before it heard that it is refused");
        }
    }
}

/// A listener with a thread of its own; closed when dropped.
pub struct Lobby {
    address: SocketAddr,
    applicants: Mutex<Receiver<Guest>>,
    close: Arc<Notify>,
    thread: Option<std::thread::JoinHandle<()>>,
}

/// What every greeting needs.
struct Host {
    welcome: ServerMessage,
    applicants: Sender<Guest>,
    mailbox: Mailbox,
    seats: Semaphore,
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
        let seats = Semaphore::new(GUESTS_MAX);
        let host = Host { welcome, applicants: sender, mailbox, seats, answers: TaskTracker::new() };
        let close = Arc::new(Notify::new());
        let closing = Arc::clone(&close);
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let thread = std::thread::Builder::new()
            .name("lobby".to_owned())
            .spawn(move || runtime.block_on(receive_guests(listener, Arc::new(host), closing)))?;
        Ok(Self { address, applicants: Mutex::new(receiver), close, thread: Some(thread) })
    }

    /// Where it listens; tells the port where none was asked for.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Door for Lobby {
    fn next_applicant(&self, patience: Duration) -> Option<Box<dyn Applicant>> {
        let waiting = self.applicants.lock().unwrap_or_else(PoisonError::into_inner);
        waiting.recv_timeout(patience).ok().map(|guest| Box::new(guest) as Box<dyn Applicant>)
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

async fn receive_guests(listener: std::net::TcpListener, host: Arc<Host>, closing: Arc<Notify>) {
    let listener = match TcpListener::from_std(listener) {
        Ok(listener) => listener,
        Err(error) => return tracing::error!(%error, "the lobby cannot listen"),
    };
    loop {
        let accepted = tokio::select! {
            () = closing.notified() => return part_from_operators(&host).await,
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

async fn greet(stream: TcpStream, peer: SocketAddr, host: &Host) -> Result<(), ReceiveError> {
    stream.set_nodelay(true).map_err(FrameError::from)?;
    let mut connection = Framed::new(stream, FrameCodec::new(HANDSHAKE_FRAME_BYTES_MAX));
    let Ok(_seat) = host.seats.try_acquire() else {
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
    send(&mut connection, &host.welcome).await?;
    match role {
        Role::Operator => serve_operator(connection, host).await,
        Role::Client => take_application(connection, peer, host).await,
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
    // If the session no longer takes anybody the stream is closed by this.
    let _ = host.applicants.send(Guest { request, peer, stream });
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
