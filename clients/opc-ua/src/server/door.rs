//! Where connections come in: each is handed on to the server, which listens on the loopback alone. So it is known at
//! once when one is closed, also by a reset, and what does not speak the protocol never reaches the server. A client
//! that opens a secure channel stays; whoever does not gives way to one who comes.
//!
//! The first eight bytes of a chunk are its kind and size; the number of the secure channel follows in plain text, also
//! where the rest is encrypted (OPC 10000-6 6.7.2.2, 7.1.2.2).

use std::collections::BTreeSet;
use std::io;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use onescan_server::transport::accept::{self, Admitted};
use onescan_server::transport::connection_limit::{ConnectionLimit, Place};
use onescan_server::transport::listeners::OPC_UA;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::tcp::{OwnedReadHalf, OwnedWriteHalf};
use tokio::net::{TcpListener, TcpStream};

/// The longest HELLO: 32 bytes and a URL of 4096 (OPC 10000-6 7.1.2.3).
const LONGEST_HELLO: u32 = 8192;
/// So much is handed on at a time.
const PIECE: usize = 64 * 1024;

/// The secure channels whose connections are there.
#[derive(Clone, Debug, Default)]
pub(crate) struct Channels(Arc<Mutex<BTreeSet<u32>>>);

impl Channels {
    fn lock(&self) -> MutexGuard<'_, BTreeSet<u32>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// True if the connection of `channel` has been closed, or never came in here.
    pub(crate) fn is_closed(&self, channel: u32) -> bool {
        !self.lock().contains(&channel)
    }
}

/// Lets connections in until the server ends.
pub(super) async fn let_in(outside: TcpListener, server: SocketAddr, channels: Channels) {
    let limit = ConnectionLimit::new(OPC_UA.limits);
    loop {
        let Admitted { stream, from, place, leaving } = accept::admitted(&outside, &limit, OPC_UA.what).await;
        let channels = channels.clone();
        tokio::spawn(async move {
            let ended = tokio::select! {
                _ = leaving => Err(io::Error::new(io::ErrorKind::ConnectionAborted, "it has left for one who came later")),
                ended = hand_on(stream, server, &channels, &place) => ended,
            };
            if let Err(error) = ended {
                tracing::debug!(%from, %error, "a connection of an OPC UA client has ended");
            }
        });
    }
}

/// One connection, until one of its sides closes it.
async fn hand_on(mut stream: TcpStream, server: SocketAddr, channels: &Channels, place: &Place) -> io::Result<()> {
    stream.set_nodelay(true)?;
    let late = |_| io::Error::new(io::ErrorKind::TimedOut, "no HELLO of OPC UA came");
    let hello = tokio::time::timeout(OPC_UA.proof, hello(&mut stream)).await.map_err(late)??;
    let mut inside = TcpStream::connect(server).await?;
    inside.set_nodelay(true)?;
    inside.write_all(&hello).await?;
    let (from_client, to_client) = stream.into_split();
    let (from_server, to_server) = inside.into_split();
    let mut seen = Seen { channels, place, channel: None };
    // Whoever closes first ends both ways.
    tokio::select! {
        ended = pump(from_client, to_server, OPC_UA.idle) => ended,
        ended = answers(from_server, to_client, &mut seen) => ended,
    }
}

/// The head of the first chunk, which is a HELLO.
async fn hello(stream: &mut TcpStream) -> io::Result<[u8; 8]> {
    let mut head = [0; 8];
    stream.read_exact(&mut head).await?;
    let [a, b, c, _, size @ ..] = head;
    if [a, b, c] != *b"HEL" || u32::from_le_bytes(size) > LONGEST_HELLO {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "no HELLO of OPC UA"));
    }
    Ok(head)
}

/// Hands on what comes until one side ends, or nothing has come for `idle`.
async fn pump(mut from: OwnedReadHalf, mut to: OwnedWriteHalf, idle: Option<Duration>) -> io::Result<()> {
    let mut piece = vec![0; PIECE];
    loop {
        let late = |_| io::Error::new(io::ErrorKind::TimedOut, "no request came for too long");
        let count = match idle {
            Some(idle) => tokio::time::timeout(idle, from.read(&mut piece)).await.map_err(late)??,
            None => from.read(&mut piece).await?,
        };
        if count == 0 {
            return Ok(());
        }
        to.write_all(&piece[..count]).await?;
    }
}

async fn answers(mut from: OwnedReadHalf, mut to: OwnedWriteHalf, seen: &mut Seen<'_>) -> io::Result<()> {
    // Acknowledge and then the channel: what comes first is read chunk by chunk.
    while seen.channel.is_none() {
        let mut head = [0; 12];
        from.read_exact(&mut head).await?;
        let [a, b, c, _, s0, s1, s2, s3, channel @ ..] = head;
        let rest = u32::from_le_bytes([s0, s1, s2, s3]).saturating_sub(12);
        if [a, b, c] == *b"OPN" {
            seen.opened(u32::from_le_bytes(channel))?;
        }
        to.write_all(&head).await?;
        let copied = tokio::io::copy(&mut (&mut from).take(rest.into()), &mut to).await?;
        if copied < u64::from(rest) {
            return Ok(());
        }
    }
    pump(from, to, None).await
}

/// The channel of a connection, which is closed with it.
struct Seen<'c> {
    channels: &'c Channels,
    place: &'c Place,
    channel: Option<u32>,
}

impl Seen<'_> {
    /// Noted before the client hears of it, so that a channel that is used is known.
    fn opened(&mut self, channel: u32) -> io::Result<()> {
        if !self.place.stay() {
            return Err(io::Error::other("there are too many clients"));
        }
        self.channels.lock().insert(channel);
        self.channel = Some(channel);
        Ok(())
    }
}

impl Drop for Seen<'_> {
    fn drop(&mut self) {
        if let Some(channel) = self.channel {
            self.channels.lock().remove(&channel);
        }
    }
}
