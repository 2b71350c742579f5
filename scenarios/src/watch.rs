//! Variables of the scenario's soft PLCs that a run looks at.

use std::str::FromStr;

use onescan_clients::soft_plc::watch::{SightingSink, Sightings, Watch};
use onescan_plc_shim::Radix;
use onescan_server::signal::ClientName;

use super::error::ScenarioError;
use super::file::ClientFile;
use super::load::Scenario;

/// A variable to look at: `Main.x`, `plc2:Main.x`, `Main.status=bin`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WatchRequest {
    /// The PLC; it must be named if the scenario has several.
    pub client: Option<String>,
    /// The variable, and how it is shown.
    pub watch: Watch,
}

/// Why a text is no [`WatchRequest`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WatchSyntax {
    /// There is no path in it.
    #[error("a variable's path is wanted, as `Main.axis[2].x`")]
    NoPath,
    /// What stands behind `=` is no format.
    #[error("`{0}` is no format: hex, dec or bin")]
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

impl Watched {
    /// What client `name` looks at, each with its number.
    pub(crate) fn of(&self, name: &ClientName) -> (Vec<(usize, Watch)>, bool, SightingSink) {
        let own = self.list.iter().enumerate().filter(|(_, (client, _))| client == name);
        (own.map(|(number, (_, watch))| (number, watch.clone())).collect(), self.changes, self.sink.clone())
    }
}

impl Scenario {
    /// Lets soft PLCs look at variables, at all their changes if `changes`, else at what they are last.
    ///
    /// # Errors
    /// A PLC is not named, or is none of the scenario's. Paths are looked at when the PLCs are made.
    pub fn watch(&mut self, requests: &[WatchRequest], changes: bool) -> Result<(), ScenarioError> {
        let is_plc = |client: &ClientFile| matches!(client, ClientFile::SoftPlc { .. });
        let plcs: Vec<ClientName> = self
            .file()
            .clients
            .iter()
            .filter(|(_, each)| is_plc(each.get_ref()))
            .map(|(name, _)| name.clone())
            .collect();
        let mut list = Vec::new();
        for request in requests {
            let path = &request.watch.path;
            let found = match (&request.client, plcs.as_slice()) {
                (None, [only]) => Some(only),
                (None, _) => None,
                (Some(wanted), _) => plcs.iter().find(|name| name.as_str() == wanted),
            };
            let Some(client) = found else {
                let names: Vec<&str> = plcs.iter().map(ClientName::as_str).collect();
                let help = match names.as_slice() {
                    [] => "the scenario has no soft PLC".to_owned(),
                    [first, ..] => format!("its soft PLCs are {}: write `{first}:{path}`", names.join(", ")),
                };
                let message = match &request.client {
                    Some(wanted) => format!("the scenario has no soft PLC `{wanted}` to watch"),
                    None => format!("whose `{path}` is to be watched is not said"),
                };
                return Err(self.wrong_option(message, Some(help)));
            };
            list.push((client.clone(), request.watch.clone()));
        }
        self.watched = Some(Watched { list, changes, sink: SightingSink::default() });
        Ok(())
    }

    /// What the PLCs of a run have seen; the next run begins with nothing.
    pub fn take_sightings(&self) -> Sightings {
        let Some(watched) = &self.watched else { return Sightings::default() };
        // A client that panicked has seen what it has seen.
        std::mem::take(&mut watched.sink.lock().unwrap_or_else(std::sync::PoisonError::into_inner))
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
