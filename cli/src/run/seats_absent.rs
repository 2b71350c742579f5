//! Clients over OPC UA in a program without OPC UA: nobody can join over it, and whoever asks for it gets an error that says so.

use std::convert::Infallible;
use std::iter::Empty;
use std::path::Path;
use std::time::Duration;

use onescan_clients::opcua_server::ABSENT;
use onescan_server::client::{Client, JoinRequest};
use onescan_server::observer::Observer;
use onescan_server::plan::SessionPlan;
use onescan_server::published::Published;

use super::config::Doors;
use super::error::RunError;
use super::processes::Processes;
use crate::error::Usage;
use crate::interrupt::Interrupt;

/// Whether somebody is to come over OPC UA.
#[derive(Default)]
pub(super) struct Seats {
    is_wanted: bool,
}

/// The session over OPC UA; there is none.
pub(super) struct Desk {
    never: Infallible,
}

impl Seats {
    /// A place for one more.
    pub(super) fn add(&mut self, _request: JoinRequest, _command: Vec<String>) {
        self.is_wanted = true;
    }

    /// Refuses, if anybody is to come or `--opcua` asks for it.
    pub(super) fn open(
        self,
        doors: &Doors,
        _plan: &SessionPlan,
        _interrupt: &Interrupt,
    ) -> Result<Option<Desk>, RunError> {
        if self.is_wanted || doors.opcua.is_some() {
            return Err(Usage::new(ABSENT, None).into());
        }
        Ok(None)
    }
}

impl Desk {
    pub(super) fn clients(&self, _patience: Duration) -> Empty<Box<dyn Client>> {
        match self.never {}
    }

    pub(super) fn published(&self) -> Published {
        match self.never {}
    }

    pub(super) fn observer(&self) -> Box<dyn Observer> {
        match self.never {}
    }

    pub(super) fn start(&self, _folder: &Path, _named: &[String], _processes: &mut Processes) -> Result<(), RunError> {
        match self.never {}
    }

    pub(super) fn wait(
        &self,
        _patience: Duration,
        _interrupt: &Interrupt,
        _processes: &mut Processes,
    ) -> Result<(), RunError> {
        match self.never {}
    }
}
