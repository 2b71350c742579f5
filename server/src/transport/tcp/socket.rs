//! A TCP socket that blocks, in plain text or under TLS.

use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::time::Duration;

use rustls::{ClientConnection, ServerConnection, StreamOwned};

/// A socket, and what lies over it.
pub(super) enum Socket {
    Plain(TcpStream),
    /// TLS, on the side of the session.
    Serving(Box<StreamOwned<ServerConnection, TcpStream>>),
    /// TLS, on the side of who takes part.
    Visiting(Box<StreamOwned<ClientConnection, TcpStream>>),
}

impl Socket {
    /// The socket itself, for its settings.
    pub(super) fn tcp(&self) -> &TcpStream {
        match self {
            Self::Plain(stream) => stream,
            Self::Serving(tls) => &tls.sock,
            Self::Visiting(tls) => &tls.sock,
        }
    }

    /// How long a read may take.
    pub(super) fn set_read_timeout(&self, patience: Option<Duration>) -> io::Result<()> {
        self.tcp().set_read_timeout(patience)
    }

    /// Says that no more is sent.
    pub(super) fn shut_down(&mut self) -> io::Result<()> {
        match self {
            Self::Plain(_) => {}
            Self::Serving(tls) => {
                tls.conn.send_close_notify();
                tls.conn.write_tls(&mut tls.sock)?;
            }
            Self::Visiting(tls) => {
                tls.conn.send_close_notify();
                tls.conn.write_tls(&mut tls.sock)?;
            }
        }
        self.tcp().shutdown(Shutdown::Write)
    }
}

impl Read for Socket {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Plain(stream) => stream.read(buffer),
            Self::Serving(tls) => tls.read(buffer),
            Self::Visiting(tls) => tls.read(buffer),
        }
    }
}

impl Write for Socket {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Plain(stream) => stream.write(bytes),
            Self::Serving(tls) => tls.write(bytes),
            Self::Visiting(tls) => tls.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Plain(stream) => stream.flush(),
            Self::Serving(tls) => tls.flush(),
            Self::Visiting(tls) => tls.flush(),
        }
    }
}
