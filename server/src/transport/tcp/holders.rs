//! Who has come in with a certificate, so that their connections end when it is revoked.

use std::collections::BTreeMap;
use std::net::{Shutdown, TcpStream};
use std::sync::{Mutex, MutexGuard, PoisonError};

use onescan_base::notice::NOTICE;
use onescan_base::repeated::Repeated;

use crate::access::{Fingerprint, Holder, RevocationList, Revoked};
use crate::lobby::Visitor;

/// The refusal of whoever has a certificate that was revoked.
pub(super) const REVOKED: &str = "this certificate has been revoked";

static UNREADABLE: Repeated = Repeated::new();

/// A certificate that somebody has shown, and whose it is.
#[derive(Clone, Debug)]
pub(super) struct Shown {
    fingerprint: Fingerprint,
    name: String,
}

/// Those who have shown a certificate.
#[derive(Debug, Default)]
pub(super) struct Holders {
    list: Option<RevocationList>,
    present: Mutex<Present>,
}

#[derive(Debug, Default)]
struct Present {
    /// As the list was when it could be read last.
    revoked: Revoked,
    /// In the lobby: guests and operators.
    visitors: BTreeMap<Visitor, Shown>,
    /// Clients that take part, each with its connection, to close it.
    seated: Vec<(Shown, TcpStream)>,
}

impl Holders {
    /// Nobody has come; whose certificate is on `list` is sent away.
    pub(super) fn new(list: Option<RevocationList>) -> Self {
        Self { list, present: Mutex::default() }
    }

    /// True if certificates can be revoked.
    pub(super) fn are_revocable(&self) -> bool {
        self.list.is_some()
    }

    fn lock(&self) -> MutexGuard<'_, Present> {
        self.present.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reads the list again. One that cannot be read takes nothing back: what was revoked stays so.
    fn read(&self, present: &mut Present) {
        match self.list.as_ref().map(RevocationList::read) {
            None => {}
            Some(Ok(revoked)) => present.revoked = revoked,
            Some(Err(why)) => {
                if let Some(times) = UNREADABLE.again() {
                    tracing::warn!("which certificates are revoked is not known, those before stay so: {why}{times}");
                }
            }
        }
    }

    /// Somebody comes with a certificate in DER; false if it has been revoked.
    pub(super) fn come(&self, visitor: Visitor, holder: &Holder, der: &[u8]) -> bool {
        if self.list.is_none() {
            return true;
        }
        let mut present = self.lock();
        self.read(&mut present);
        let shown = Shown { fingerprint: Fingerprint::of(der), name: holder.name.clone() };
        let is_good = !present.revoked.contains(&shown.fingerprint);
        if is_good {
            present.visitors.insert(visitor, shown);
        }
        is_good
    }

    /// A connection has left the lobby.
    pub(super) fn leave(&self, visitor: Visitor) {
        self.lock().visitors.remove(&visitor);
    }

    /// What a client has shown that is about to leave the lobby for its seat.
    pub(super) fn shown_by(&self, visitor: Visitor) -> Option<Shown> {
        self.lock().visitors.get(&visitor).cloned()
    }

    /// A client has its seat, and this connection. Without a descriptor more it could not be closed: it is, now.
    pub(super) fn seat(&self, shown: Option<Shown>, connection: &TcpStream) {
        let Some(shown) = shown else { return };
        match connection.try_clone() {
            Ok(connection) => self.lock().seated.push((shown, connection)),
            Err(error) => {
                tracing::warn!(name = shown.name, %error, "a connection that could not be ended is not kept");
                close(connection);
            }
        }
    }

    /// Ends the connections of clients whose certificate has been revoked, and gives those who are to be sent away.
    pub(super) fn end_revoked(&self) -> Vec<Visitor> {
        let mut present = self.lock();
        self.read(&mut present);
        let Present { revoked, visitors, seated } = &mut *present;
        seated.retain(|(Shown { fingerprint, name }, connection)| {
            let is_good = !revoked.contains(fingerprint);
            if !is_good {
                tracing::warn!(target: NOTICE, "the certificate of client `{name}` has been revoked: its connection is closed");
                close(connection);
            }
            is_good
        });
        let gone: Vec<Visitor> = visitors
            .iter()
            .filter(|(_, shown)| revoked.contains(&shown.fingerprint))
            .map(|(visitor, _)| *visitor)
            .collect();
        for visitor in &gone {
            visitors.remove(visitor);
        }
        gone
    }
}

fn close(connection: &TcpStream) {
    // It may be gone already.
    let _ = connection.shutdown(Shutdown::Both);
}
