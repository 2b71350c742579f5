//! One connection of the lobby: its bytes go to the acceptor, and what that decides is done.

use std::net::SocketAddr;
use std::sync::Arc;

use bytes::BytesMut;
use onescan_base::repeated::Repeated;
use rustls::StreamOwned;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::sync::mpsc::UnboundedReceiver;
use tokio::sync::oneshot;
use tokio::time::{Instant, sleep_until, timeout};
use tokio_rustls::TlsAcceptor;
use tokio_rustls::server::TlsStream;
use tokio_util::codec::Encoder;
use tokio_util::either::Either;

use super::holders::REVOKED;
use super::host::Host;
use super::order::{Application, Order};
use super::socket::Socket;
use super::{CLOSE_TIMEOUT, HANDSHAKE_TIMEOUT};
use crate::access::Holder;
use crate::lobby::Visitor;
use crate::mailbox::{Request, Wish};
use crate::operation::OperationError;
use crate::transport::tls::reason;
use crate::wire::message::Status;
use crate::wire::{FRAME_BYTES_MAX, FrameCodec, FrameRef, ServerMessage};

/// Bytes taken at once.
const READ_BYTES: usize = 16 * 1024;
/// The type of the record with which TLS begins.
const TLS_HANDSHAKE: u8 = 0x16;

static NO_TLS: Repeated = Repeated::new();

/// The answer of the session to an operator.
type Answer = oneshot::Receiver<Result<Status, OperationError>>;

/// A connection, in plain text or under TLS.
pub(super) struct Connection(Either<TcpStream, Box<TlsStream<TcpStream>>>);

impl Connection {
    /// For the session's thread.
    fn into_socket(self) -> std::io::Result<Socket> {
        match self.0 {
            Either::Left(stream) => Ok(Socket::Plain(stream.into_std()?)),
            Either::Right(tls) => {
                let (stream, session) = tls.into_inner();
                Ok(Socket::Serving(Box::new(StreamOwned::new(session, stream.into_std()?))))
            }
        }
    }

    /// False if that did not go, as to one who does not read.
    async fn send_in_time(&mut self, message: &ServerMessage) -> bool {
        matches!(timeout(HANDSHAKE_TIMEOUT, self.send(message)).await, Ok(Ok(())))
    }

    /// False if the connection is of no use any more.
    async fn say_no_more(&mut self) -> bool {
        matches!(timeout(CLOSE_TIMEOUT, self.0.shutdown()).await, Ok(Ok(())))
    }

    async fn send(&mut self, message: &ServerMessage) -> std::io::Result<()> {
        let json = crate::wire::frame::to_json(message)?;
        let mut bytes = BytesMut::new();
        FrameCodec::new(FRAME_BYTES_MAX)
            .encode(FrameRef::Json(&json), &mut bytes)
            .map_err(|error| std::io::Error::other(error.to_string()))?;
        self.0.write_all(&bytes).await?;
        self.0.flush().await
    }
}

/// Attends to a connection that was just opened.
pub(super) async fn newcomer(
    stream: TcpStream,
    peer: SocketAddr,
    visitor: Visitor,
    orders: UnboundedReceiver<Order>,
    host: Arc<Host>,
) {
    let connection = match &host.tls_acceptor {
        None => Connection(Either::Left(stream)),
        Some(tls_acceptor) => match timeout(HANDSHAKE_TIMEOUT, secure(stream, tls_acceptor)).await {
            Ok(Ok(Either::Left(stream))) => {
                let why = "this session speaks TLS only: say whom you trust with `--tls-ca`";
                host.act(|acceptor, now| acceptor.refused(visitor, why, now));
                Connection(Either::Left(stream))
            }
            Ok(Ok(Either::Right(secured))) => {
                introduce(&secured, visitor, &host);
                Connection(Either::Right(secured))
            }
            Ok(Err(error)) => {
                no_tls(peer, &reason(&error));
                return go(visitor, &host);
            }
            Err(_) => {
                no_tls(peer, "it is silent");
                return go(visitor, &host);
            }
        },
    };
    attend(connection, peer, visitor, orders, host).await;
}

/// Reports, not too often, that somebody did not come as far as TLS.
fn no_tls(peer: SocketAddr, why: &str) {
    if let Some(times) = NO_TLS.again() {
        tracing::warn!(%peer, why, "no TLS came about: sent away{times}");
    }
}

/// Passes on to the acceptor whose certificate was shown, if one was.
fn introduce(secured: &TlsStream<TcpStream>, visitor: Visitor, host: &Host) {
    let Some(shown) = secured.get_ref().1.peer_certificates().and_then(<[_]>::first) else { return };
    match Holder::of_certificate(shown) {
        Ok(holder) if !host.holders.come(visitor, &holder, shown) => {
            host.act(|acceptor, now| acceptor.refused(visitor, REVOKED, now));
        }
        Ok(holder) => host.act(|acceptor, _| {
            acceptor.certified(visitor, holder);
            Vec::new()
        }),
        Err(why) => {
            host.act(|acceptor, now| {
                acceptor.refused(visitor, &format!("this certificate lets nobody in: {why}"), now)
            });
        }
    }
}

/// TLS over the connection, if that is what the other side begins with.
async fn secure(
    stream: TcpStream,
    tls_acceptor: &TlsAcceptor,
) -> std::io::Result<Either<TcpStream, Box<TlsStream<TcpStream>>>> {
    let mut first = [0; 3];
    let count = stream.peek(&mut first).await?;
    match first[..count] {
        // A frame may begin with that byte, too; then its third is not a version of TLS.
        [TLS_HANDSHAKE] | [TLS_HANDSHAKE, 3] | [TLS_HANDSHAKE, 3, 1..=4] => {
            match tls_acceptor.accept(stream).into_fallible().await {
                Ok(secured) => Ok(Either::Right(Box::new(secured))),
                Err((error, stream)) => {
                    linger(stream).await;
                    Err(error)
                }
            }
        }
        _ => Ok(Either::Left(stream)),
    }
}

/// Lets the other side read the alert that says why: closing with unread bytes would take it back.
async fn linger(mut stream: TcpStream) {
    let mut rest = [0; 1024];
    let read_out = async {
        // A connection that cannot be written to is gone.
        let _ = stream.shutdown().await;
        while matches!(stream.read(&mut rest).await, Ok(1..)) {}
    };
    // One that neither reads nor closes is left: the alert was all that it was owed.
    let _ = timeout(CLOSE_TIMEOUT, read_out).await;
}

/// The connection is gone.
fn go(visitor: Visitor, host: &Host) {
    host.act(|acceptor, _| {
        acceptor.gone(visitor);
        Vec::new()
    });
    host.leave(visitor);
}

/// Attends to a connection until it takes part or is gone.
pub(super) async fn attend(
    mut connection: Connection,
    peer: SocketAddr,
    visitor: Visitor,
    mut orders: UnboundedReceiver<Order>,
    host: Arc<Host>,
) {
    let (mut buffer, mut answer, mut is_open) = (vec![0; READ_BYTES], None, true);
    loop {
        let deadline = host.deadline_of(visitor).unwrap_or_else(|| Instant::now() + HANDSHAKE_TIMEOUT);
        tokio::select! {
            // Orders first: what is read may change them.
            biased;
            order = orders.recv() => match order {
                Some(Order::Apply(request)) => {
                    host.wait_for_seat(Application { visitor, request, peer });
                }
                Some(Order::HandOver(to)) => {
                    // Whoever waits for it has the error, if it is one.
                    let _ = to.send(connection.into_socket());
                    return host.leave(visitor);
                }
                Some(Order::Ask(wish)) => answer = Some(ask(wish, &host)),
                Some(Order::Send(message)) if connection.send_in_time(&message).await => {}
                // Where the other side has closed already, this is the end.
                Some(Order::Part) if connection.say_no_more().await && is_open => {}
                Some(Order::Send(_) | Order::Part | Order::Close) | None => return go(visitor, &host),
            },
            answered = come_in(&mut answer) => {
                answer = None;
                let answered = answered.map(|result| result.map_err(|error| error.to_string()));
                host.act(|acceptor, now| acceptor.answered(visitor, answered, now));
            }
            read = connection.0.read(&mut buffer), if is_open => match read {
                Ok(0) if host.hung_up(visitor) => is_open = false,
                Ok(count) if count > 0 => host.act(|acceptor, now| acceptor.received(visitor, &buffer[..count], now)),
                _ => return go(visitor, &host),
            },
            () = sleep_until(deadline) => host.act(crate::lobby::Acceptor::clock),
        }
    }
}

/// Leaves a wish for the next step boundary.
fn ask(wish: Wish, host: &Host) -> Answer {
    let (reply, answer) = oneshot::channel();
    host.mailbox.post(Request { wish, reply: Some(reply) });
    answer
}

/// The answer once it comes; nothing if the session is over. Never, if nothing was asked.
async fn come_in(answer: &mut Option<Answer>) -> Option<Result<Status, OperationError>> {
    match answer {
        Some(answer) => answer.await.ok(),
        None => std::future::pending().await,
    }
}
