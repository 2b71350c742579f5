//! Variables of the scenario's soft PLCs that a run looks at.

use std::str::FromStr;
use std::sync::PoisonError;

use onescan_iec_run::Radix;
use onescan_server::signal::ClientName;
use onescan_soft_plc::watch::{SightingSink, Sightings, Watch};

/// A variable to look at: `Main.x`, `plc2:Main.x`, `Main.status=bin`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WatchRequest {
    /// The PLC; it must be named if the scenario has several.
    pub client: Option<String>,
    /// The variable, and how it is shown.
    pub watch: Watch,
}

/// Why a text is not a [`WatchRequest`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WatchSyntax {
    /// There is no path in it.
    #[error("a variable's path is wanted, as `Main.axis[2].x`")]
    NoPath,
    /// What stands behind `=` is not a format.
    #[error("`{0}` is not a format: hex, dec or bin")]
    Format(String),
}

impl FromStr for WatchRequest {
    type Err = WatchSyntax;

    fn from_str(text: &str) -> Result<Self, WatchSyntax> {
        let (place, radix) = match text.split_once('=') {
            None => (text, Radix::Own),
            Some((place, "hex")) => (place, Radix::Hexadecimal),
            Some((place, "dec")) => (place, Radix::Decimal),
            Some((place, "bin")) => (place, Radix::Binary),
            Some((_, format)) => return Err(WatchSyntax::Format(format.to_owned())),
        };
        let (client, path) = match place.split_once(':') {
            Some((client, path)) => (Some(client.to_owned()), path),
            None => (None, place),
        };
        if path.trim().is_empty() {
            return Err(WatchSyntax::NoPath);
        }
        Ok(Self { client, watch: Watch { path: path.trim().to_owned(), radix } })
    }
}

/// What a run looks at, and where that goes.
#[derive(Clone, Debug)]
pub(crate) struct Watched {
    /// The PLC of each variable, in the order in which they were given.
    list: Vec<(ClientName, Watch)>,
    changes: bool,
    sink: SightingSink,
}

/// Why it is not clear which PLC is to be watched.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Unclear {
    pub(crate) message: String,
    pub(crate) help: String,
}

impl Watched {
    /// What `requests` ask for, of the soft PLCs `plcs`: all changes if `changes`, else what is seen last.
    pub(crate) fn new(requests: &[WatchRequest], plcs: &[ClientName], changes: bool) -> Result<Self, Unclear> {
        let mut list = Vec::new();
        for request in requests {
            let found = match (&request.client, plcs) {
                (None, [only]) => Some(only),
                (None, _) => None,
                (Some(wanted), _) => plcs.iter().find(|name| name.as_str() == wanted),
            };
            let client = found.ok_or_else(|| Unclear::of(request, plcs))?;
            list.push((client.clone(), request.watch.clone()));
        }
        Ok(Self { list, changes, sink: SightingSink::default() })
    }

    /// What the PLCs of a run have seen; the next run begins with nothing.
    pub(crate) fn take_sightings(&self) -> Sightings {
        // A client that panicked has seen what it has seen.
        std::mem::take(&mut self.sink.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// What client `name` looks at, each with its number.
    pub(crate) fn of(&self, name: &ClientName) -> (Vec<(usize, Watch)>, bool, SightingSink) {
        let own = self.list.iter().enumerate().filter(|(_, (client, _))| client == name);
        (own.map(|(number, (_, watch))| (number, watch.clone())).collect(), self.changes, self.sink.clone())
    }
}

impl Unclear {
    fn of(request: &WatchRequest, plcs: &[ClientName]) -> Self {
        let path = &request.watch.path;
        let names: Vec<&str> = plcs.iter().map(ClientName::as_str).collect();
        let help = match names.as_slice() {
            [] => "the scenario has no soft PLC".to_owned(),
            [first, ..] => format!("its soft PLCs are {}: write `{first}:{path}`", names.join(", ")),
        };
        let message = match &request.client {
            Some(wanted) => format!("the scenario has no soft PLC `{wanted}` to watch"),
            None => format!("whose `{path}` is to be watched is not said"),
        };
        Self { message, help }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_are_read() {
        let request: WatchRequest = "plc2:Main.list[1, 2].status=bin".parse().expect("a request");
        assert_eq!(request.client.as_deref(), Some("plc2"));
        assert_eq!(request.watch, Watch { path: "Main.list[1, 2].status".to_owned(), radix: Radix::Binary });
        assert_eq!("Main.x=octal".parse::<WatchRequest>(), Err(WatchSyntax::Format("octal".to_owned())));
        assert_eq!("=hex".parse::<WatchRequest>(), Err(WatchSyntax::NoPath));
    }
}
