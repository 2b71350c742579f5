//! A client of the scenario that its session does not let in: where it says so, and what to write.

use onescan_base::regular;
use onescan_server::client::JoinRequest;
use onescan_server::join::JoinRefusal;
use onescan_server::signal::{ClientName, SignalName};

use super::error::{ScenarioError, wrong};
use super::file::ClientFile;
use super::load::Scenario;

impl Scenario {
    /// The refusal of a client that asked to join with `request`.
    pub fn refused(&self, request: &JoinRequest, refusal: &JoinRefusal) -> ScenarioError {
        let message = refusal.to_string();
        let JoinRefusal::UnknownSignal { signal, nearest, .. } = refusal else {
            return self.wrong_client(&request.name, message, None);
        };
        // Behind a name that may have been meant it is the other way out.
        let or = if nearest.is_some() { "or " } else { "" };
        let help = self.declaration(request, signal).map(|line| format!("{or}declare it under [signals]: {line}"));
        self.in_scene(&request.name, signal, &message, help.clone())
            .unwrap_or_else(|| self.wrong_client(&request.name, message, help))
    }

    /// The line that would declare a signal which the client wants.
    fn declaration(&self, request: &JoinRequest, signal: &SignalName) -> Option<String> {
        let of = |ports: &[onescan_server::signal::Port]| ports.iter().find(|port| port.name == *signal).map(|p| p.ty);
        let (ty, writer) = match (of(&request.writes), of(&request.reads)) {
            (Some(ty), _) => (ty, request.name.to_string()),
            (None, Some(ty)) => {
                let mut others = self.plan().clients().iter().filter(|name| **name != request.name);
                let only = others.next().filter(|_| others.next().is_none());
                (ty, only.map_or_else(|| "…".to_owned(), ToString::to_string))
            }
            (None, None) => return None,
        };
        let bare = |letter: char| letter.is_ascii_alphanumeric() || letter == '_' || letter == '-';
        let name = signal.as_str();
        let key = if name.chars().all(bare) { name.to_owned() } else { format!("\"{name}\"") };
        Some(format!("{key} = {{ type = \"{ty}\", writer = \"{writer}\" }}"))
    }

    /// The error at the place in a plant's scene that names the signal; nothing if there is none.
    fn in_scene(
        &self,
        name: &ClientName,
        signal: &SignalName,
        message: &str,
        help: Option<String>,
    ) -> Option<ScenarioError> {
        let ClientFile::Plant { scene, .. } = self.file().clients.get(name)?.get_ref() else { return None };
        let path = self.folder().join(scene);
        let text = regular::read_text(&path).ok()?;
        let named = format!("\"{signal}\"");
        let start = text.find(&named)?;
        Some(wrong(&path, &text, message.to_owned(), Some(start..start + named.len()), help))
    }
}
