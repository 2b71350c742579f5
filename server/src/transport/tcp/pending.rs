//! A client that has asked to join, as the session's thread sees it. Its connection stays in the lobby until it has a
//! seat.

use std::io::{Error, ErrorKind};
use std::sync::Arc;
use std::time::Duration;

use super::host::Host;
use super::order::Application;
use super::remote::Remote;
use super::stream::FrameStream;
use crate::carrier::{Carrier, PendingClient};
use crate::client::JoinRequest;
use crate::signal::PortLayout;
use crate::wire::message::placed;
use crate::wire::{FRAME_BYTES_MAX, ServerMessage};

/// A client that wants to join and waits for the answer.
pub(super) struct TcpPendingClient {
    pub(super) application: Application,
    pub(super) host: Arc<Host>,
}

impl PendingClient for TcpPendingClient {
    fn request(&self) -> &JoinRequest {
        &self.application.request
    }

    fn origin(&self) -> String {
        self.application.peer.to_string()
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
        let socket =
            self.host.hand_over(self.application.visitor).ok_or_else(|| Error::from(ErrorKind::NotConnected))?;
        let connection = FrameStream::new(socket, FRAME_BYTES_MAX, reply_timeout)?;
        let mut remote = Remote::new(connection, reply_timeout);
        // A peer that is gone already shows at the set-up.
        remote.send_message(&joined);
        Ok(Box::new(remote))
    }

    fn refuse(self: Box<Self>, why: &str) {
        self.host.act(|acceptor, now| acceptor.refused(self.application.visitor, why, now));
    }
}
