//! This crate as the program reaches it.

use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use onescan_links::gateway::exchange::{Exchange, Words};
use onescan_links::gateway::fault::LinkFault;
use onescan_links::gateway::link::{Found, Link};
use onescan_links::gateway::opcua::OpcUaLinks;
use onescan_links::opcua::{Options, ServedSession};
use onescan_links::station::opcua::ServedPlc;
use onescan_server::client::{Client, JoinRequest};
use onescan_server::observer::Observer;
use onescan_server::published::Published;

use crate::information_model::{Board, BoardObserver, SeatedClient, Service, serve};
use crate::link::OpcUaLink;
use crate::plc_server;
use crate::server::Running;

/// Links as this crate has them.
struct Links;

impl OpcUaLinks for Links {
    fn link(
        &self,
        url: &str,
        options: &Options,
        exchange: &Exchange,
        timeout: Duration,
    ) -> Result<Box<dyn Link>, LinkFault> {
        Ok(Box::new(OpcUaLink::new(url, options.clone(), exchange, timeout)?))
    }

    fn browse(&self, url: &str, options: &Options, timeout: Duration) -> Result<Vec<Found>, LinkFault> {
        let nothing = Exchange::new(&[], &[], Words::Handshake, &BTreeMap::new());
        OpcUaLink::new(url, options.clone(), &nothing, timeout)?.browse()
    }
}

/// Gives the program OPC UA: links, served PLCs, served sessions.
pub fn install() {
    onescan_links::gateway::opcua::install(&Links);
    onescan_links::station::opcua::install(|address, controller, access| {
        Ok(Box::new(plc_server::serve(address, controller, access)?))
    });
    onescan_links::opcua::install(|address, plan, clients, mailbox, access| {
        let board = Arc::new(Board::new(plan.clone(), clients, mailbox));
        let service = serve(address, &board, access)?;
        Ok(Box::new(Served { board, service }))
    });
}

impl ServedPlc for Running {
    fn address(&self) -> SocketAddr {
        Running::address(self)
    }
}

/// A session on its board, and the server of the board.
struct Served {
    board: Arc<Board>,
    service: Service,
}

impl ServedSession for Served {
    fn url(&self) -> String {
        self.service.url()
    }

    fn refused(&self) -> Option<String> {
        self.service.refused()
    }

    fn client(&self, seat: usize, request: JoinRequest, patience: Duration) -> Box<dyn Client> {
        Box::new(SeatedClient::new(Arc::clone(&self.board), seat, request, patience))
    }

    fn published(&self) -> Published {
        self.board.published()
    }

    fn observer(&self) -> Box<dyn Observer> {
        Box::new(BoardObserver::new(Arc::clone(&self.board)))
    }

    fn missing(&self) -> Vec<String> {
        self.board.missing()
    }

    fn wait_for_start(&self, moment: Duration) {
        self.board.wait_for_start(moment);
    }
}
