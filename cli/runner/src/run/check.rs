//! Options that contradict each other or the scenario are refused before anything has begun.

use onescan_base::notice::NOTICE;
use onescan_links::opcua::Access;
use onescan_report::plot::Part;
use onescan_scenario::file::ClientFile;
use onescan_scenario::{Mode, Scenario};
use onescan_server::pacing::Pace;
use onescan_server::signal::pattern::choose;
use onescan_server::signal::{ClientName, SignalName, did_you_mean};
use onescan_server::time::VirtualTime;

use super::config::{RunConfig, Transport};
use super::error::RunError;
use crate::error::Usage;

impl RunConfig {
    /// Refuses options that contradict each other or the scenario, before anything has begun.
    pub(crate) fn check(&self, scenario: &Scenario) -> Result<(), RunError> {
        for signal in self.picture.plane.iter().flatten() {
            if !scenario.file().signals.contains_key(signal) {
                let known = scenario.file().signals.keys().map(SignalName::as_str);
                let help = did_you_mean(signal.as_str(), known);
                return Err(Usage::new(format!("the scenario has no signal `{signal}`"), help).into());
            }
        }
        choose(&self.picture.signals, scenario.file().signals.keys())
            .map_err(|unmatched| Usage::new(format!("--signals: {unmatched}"), None))?;
        self.check_enlarged(scenario)?;
        if let Some(record) = &self.reports.record {
            choose(&record.choice.signals, scenario.file().signals.keys())
                .map_err(|unmatched| Usage::new(format!("--record-signals: {unmatched}"), None))?;
        }
        let step = scenario.file().step;
        if let Some(save) = self.course.save.as_ref().filter(|save| save.at >= self.subject.end(scenario)) {
            let message =
                format!("--save-at {} is not before the end of the run at {}", save.at, self.subject.end(scenario));
            return Err(Usage::new(message, Some(format!("the step is {step}"))).into());
        }
        let inside = [
            ("--coverage", self.reports.coverage.is_some()),
            ("--watch", !self.watch.variables.is_empty()),
            ("--accept-code", self.course.accept_code),
            ("--maps", self.reports.maps.is_some()),
        ];
        if let Some((option, _)) = inside.iter().find(|(_, given)| *given && self.reach.transport == Transport::Tcp) {
            let help = "what a client in another process does is not seen here".to_owned();
            return Err(Usage::new(format!("{option} means nothing with --transport tcp"), Some(help)).into());
        }
        if self.reports.maps.is_some() && (scenario.file().map.is_empty() || self.mode != Mode::Lockstep) {
            let help = "a scenario says with [[map]] what is drawn; it is drawn of runs in lockstep".to_owned();
            return Err(Usage::new("--maps: there is nothing to be drawn", Some(help)).into());
        }
        self.check_opcua(scenario)?;
        match self.mode {
            Mode::Lockstep if self.seed.is_some() => {
                let help = "in lockstep nothing is drawn but what the scenario's `seed` says; see `--mode`".to_owned();
                Err(Usage::new("--seed means nothing with --mode lockstep", Some(help)).into())
            }
            Mode::Lockstep => Ok(()),
            Mode::Freewheel | Mode::Halt | Mode::Follow => self.check_freewheel(scenario),
        }
    }

    /// What is to be enlarged must be of what is drawn: instants of time, or places of a plane.
    fn check_enlarged(&self, scenario: &Scenario) -> Result<(), RunError> {
        let (wrong, help) = match (self.picture.enlarged, &self.picture.plane) {
            (None, _) | (Some(Part::Plane { .. }), Some(_)) => return Ok(()),
            (Some(Part::Times { from_ns, .. }), None) => {
                let (from, end) = (VirtualTime::from_nanos(from_ns), self.subject.end(scenario));
                if from < end {
                    return Ok(());
                }
                (format!("--enlarge: {from} is not before the end of the run at {end}"), None)
            }
            (Some(Part::Times { .. }), Some([x, y])) => (
                "--enlarge: a range of time is not part of a plane".to_owned(),
                Some(format!("write a range of {x} and one of {y}, as in `0.9..1.2,0.3..0.5`")),
            ),
            (Some(Part::Plane { .. }), None) => (
                "--enlarge: a picture over time has no ranges of values".to_owned(),
                Some("write a range of time, as in `2s..2.5s`, or draw two signals with --xy".to_owned()),
            ),
        };
        Err(Usage::new(wrong, help).into())
    }

    /// Who is to come over OPC UA must be somebody of the scenario, and come as he is.
    fn check_opcua(&self, scenario: &Scenario) -> Result<(), RunError> {
        for name in &self.reach.opcua_clients {
            match scenario.file().clients.get(name).map(toml::Spanned::get_ref) {
                None => {
                    let help = did_you_mean(name.as_str(), scenario.file().clients.keys().map(ClientName::as_str));
                    return Err(Usage::new(format!("the scenario has no client `{name}`"), help).into());
                }
                Some(ClientFile::External { .. } | ClientFile::OpcUa { .. }) => {
                    let message = format!("--opcua-client {name}: it is a program of its own anyway");
                    return Err(Usage::new(message, None).into());
                }
                Some(_) => {}
            }
            if self.reach.gateways.iter().any(|(gateway, _)| gateway == name) {
                let message =
                    format!("`{name}` cannot be a real PLC (--gateway) and come over OPC UA (--opcua-client)");
                return Err(Usage::new(message, None).into());
            }
        }
        if self.subject.case.is_some() && !self.reach.opcua_clients.is_empty() {
            let help = "what a case changes in a client does not reach a program that stands in for it".to_owned();
            return Err(Usage::new("--opcua-client means nothing with --case", Some(help)).into());
        }
        self.warn_of_open_opcua();
        Ok(())
    }

    /// Beyond this machine anybody may read and write who is not asked for a user, a token or a certificate.
    fn warn_of_open_opcua(&self) {
        let Access { user, register, pki, trust_clients, .. } = &self.doors.access;
        let asks = user.is_some() || register.is_some() || pki.is_some() && !trust_clients;
        if let Some(address) = self.doors.opcua.filter(|address| !address.ip().is_loopback() && !asks) {
            tracing::warn!(
                target: NOTICE,
                "OPC UA at {address} is open to anybody who reaches this machine: ask for a user (--opcua-user) or tokens \
                 (--access)"
            );
        }
    }

    /// Free-wheeling has no server: what only a server can do is refused, not ignored.
    fn check_freewheel(&self, scenario: &Scenario) -> Result<(), RunError> {
        let options = [
            ("--transport tcp", self.reach.transport == Transport::Tcp),
            ("--pace", self.course.pace != Pace::Max),
            ("--listen", self.doors.listen.is_some()),
            ("--web", self.doors.web.is_some()),
            ("--ads", self.doors.ads.is_some()),
            ("--opcua", self.doors.opcua.is_some()),
            ("--opcua-client", !self.reach.opcua_clients.is_empty()),
            ("--save-at", self.course.save.is_some()),
            ("--resume", self.course.resume.is_some()),
            ("--replay-operator", self.course.replay_operator.is_some()),
        ];
        if let Some((option, _)) = options.iter().find(|(_, given)| *given) {
            let help = "free-wheeling clients run in real time in this process, each on its own clock".to_owned();
            let mode = self.mode.name();
            return Err(Usage::new(format!("{option} means nothing with --mode {mode}"), Some(help)).into());
        }
        if let (Some(_), Some((gateway, _))) = (self.seed, self.reach.gateways.first()) {
            let help = "a real PLC keeps its own clock; leave out --seed, or the gateway".to_owned();
            let message = format!("--seed means nothing with --gateway {gateway}");
            return Err(Usage::new(message, Some(help)).into());
        }
        let external = |client: &toml::Spanned<ClientFile>| {
            matches!(client.get_ref(), ClientFile::External { .. } | ClientFile::OpcUa { .. })
        };
        match scenario.file().clients.iter().find(|(_, client)| external(client)) {
            Some((name, _)) => {
                Err(Usage::new(format!("the external client `{name}` can only take part in lockstep"), None).into())
            }
            None => Ok(()),
        }
    }
}
