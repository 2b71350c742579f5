//! One Write and one Read for all points.

use std::time::Duration;

use onescan_base::did_you_mean;
use opcua::types::{AttributeId, DataValue, NodeId, ReadValueId, StatusCode, TimestampsToReturn, Variant, WriteValue};
use tokio::runtime::Runtime;

use super::connection::{Connection, lost};
use super::{browse, value};
use crate::server::pki::Pki;
use onescan_links::gateway::exchange::{Direction, Exchange, Point};
use onescan_links::gateway::fault::{LinkFault, MappingFault};
use onescan_links::gateway::link::{Found, Link};
use onescan_links::opcua::Options;

/// Variables of an OPC UA server.
pub struct OpcUaLink {
    url: String,
    options: Options,
    pki: Pki,
    exchange: Exchange,
    /// Dropped before the runtime that carries it.
    connection: Option<Connection>,
    to_plc: Vec<NodeId>,
    reads: Vec<ReadValueId>,
    runtime: Runtime,
    timeout: Duration,
}

impl OpcUaLink {
    /// A link to `url`, `opc.tcp://host:port/path`.
    ///
    /// # Errors
    /// There is no runtime, or the options are wrong.
    pub fn new(url: &str, options: Options, exchange: &Exchange, timeout: Duration) -> Result<Self, LinkFault> {
        super::identity::security(&options)?;
        let runtime = onescan_server::transport::runtime::of_this_thread();
        let runtime = runtime.map_err(|error| LinkFault::Setting(format!("no runtime: {error}")))?;
        let pki = Pki::new(options.pki.as_deref());
        let pki = pki.map_err(|error| LinkFault::Setting(format!("no folder for certificates: {error}")))?;
        let exchange = exchange.clone();
        let (to_plc, reads) = (Vec::new(), Vec::new());
        Ok(Self { url: url.to_owned(), options, pki, exchange, connection: None, to_plc, reads, runtime, timeout })
    }

    fn connected(&self) -> Result<&Connection, LinkFault> {
        self.connection.as_ref().ok_or_else(LinkFault::not_connected)
    }

    /// The node of each point; that it is there, its type and access are checked.
    fn check(&self, points: &[Point], direction: Direction) -> Result<Vec<NodeId>, LinkFault> {
        let connection = self.connected()?;
        let mut nodes = Vec::new();
        for point in points {
            let address = point.address.as_deref().unwrap_or_else(|| point.symbol());
            let node = connection.node(address, &self.options);
            nodes.push(node.ok_or_else(|| self.unknown(point, "is not a node of the server"))?);
        }
        let ask = |node: &NodeId| {
            [AttributeId::Value, AttributeId::UserAccessLevel]
                .map(|attribute| ReadValueId::new(node.clone(), attribute))
        };
        let asked: Vec<ReadValueId> = nodes.iter().flat_map(ask).collect();
        let answers = self.runtime.block_on(connection.session.read(&asked, TimestampsToReturn::Neither, 0.0));
        let answers = answers.map_err(|error| lost(&error))?;
        if answers.len() != asked.len() {
            return Err(LinkFault::Nonsense(format!("{} values came for {}", answers.len(), asked.len())));
        }
        for (point, answer) in points.iter().zip(answers.chunks(2)) {
            self.check_point(point, direction, &answer[0], &answer[1])?;
        }
        Ok(nodes)
    }

    fn check_point(
        &self,
        point: &Point,
        direction: Direction,
        value: &DataValue,
        access: &DataValue,
    ) -> Result<(), LinkFault> {
        let (name, ty) = (point.label(), point.ty);
        let address = point.address.as_deref().unwrap_or_else(|| point.symbol());
        let fault = |message: String| Err(MappingFault::new(&point.name, message).into());
        let status = value.status.unwrap_or(StatusCode::Good);
        let is_missing = [StatusCode::BadNodeIdUnknown, StatusCode::BadNodeIdInvalid];
        if is_missing.iter().any(|code| code.sub_code() == status.sub_code()) {
            return Err(self.unknown(point, "the server does not have"));
        }
        if status.is_bad() {
            return fault(format!("`{name}` is mapped to `{address}`, which cannot be read: {status}"));
        }
        let mut scratch = vec![0; ty.size()];
        let found = value.value.clone().unwrap_or_default();
        if !value::from_variant(ty, &found, &mut scratch) {
            let found = value::type_name(&found);
            return fault(format!("type mismatch: `{name}` is {ty}, but `{address}` is {found}"));
        }
        let is_read_only = matches!(access.value, Some(Variant::Byte(level)) if level & 2 == 0);
        if direction == Direction::ToPlc && is_read_only {
            return fault(format!("`{name}` is written by the gateway, but `{address}` can only be read"));
        }
        Ok(())
    }

    /// A point without a node, with the nearest that there is.
    fn unknown(&self, point: &Point, what: &str) -> LinkFault {
        let address = point.address.as_deref().unwrap_or_else(|| point.symbol());
        let message = format!("`{}` is mapped to `{address}`, which {what}", point.label());
        let found =
            self.connected().and_then(|connection| self.runtime.block_on(browse::variables(&connection.session)));
        let names: Vec<String> =
            found.unwrap_or_default().into_iter().flat_map(|found| [found.name, found.address]).collect();
        let help = did_you_mean(address, names.iter().map(String::as_str));
        MappingFault::new(&point.name, message).with_help(help).into()
    }

    /// Everything that the server has.
    ///
    /// # Errors
    /// The server cannot be reached, or does not let this client in.
    pub fn browse(&mut self) -> Result<Vec<Found>, LinkFault> {
        self.connection = Some(Connection::open(&self.runtime, &self.url, &self.options, &self.pki, self.timeout)?);
        self.runtime.block_on(browse::variables(&self.connected()?.session))
    }
}

impl Drop for OpcUaLink {
    fn drop(&mut self) {
        if let Some(connection) = self.connection.take() {
            // With a server that is gone there is nothing to close.
            let _ = self.runtime.block_on(async {
                tokio::time::timeout(Duration::from_secs(1), connection.session.disconnect()).await
            });
        }
    }
}

impl Link for OpcUaLink {
    fn connect(&mut self) -> Result<(), LinkFault> {
        self.connection = None;
        self.connection = Some(Connection::open(&self.runtime, &self.url, &self.options, &self.pki, self.timeout)?);
        self.to_plc = self.check(self.exchange.to_plc(), Direction::ToPlc)?;
        let from_plc = self.check(self.exchange.from_plc(), Direction::FromPlc)?;
        self.reads = from_plc.into_iter().map(ReadValueId::new_value).collect();
        Ok(())
    }

    fn write(&mut self, to_plc: &[u8]) -> Result<(), LinkFault> {
        let connection = self.connected()?;
        let write = |(point, node): (&Point, &NodeId)| {
            WriteValue::value_attr(node.clone(), value::to_variant(point.ty, &to_plc[point.range()]))
        };
        let writes: Vec<WriteValue> = self.exchange.to_plc().iter().zip(&self.to_plc).map(write).collect();
        let statuses = self.runtime.block_on(connection.session.write(&writes)).map_err(|error| lost(&error))?;
        if statuses.len() != writes.len() {
            return Err(LinkFault::Nonsense(format!("{} statuses came for {} writes", statuses.len(), writes.len())));
        }
        match self.exchange.to_plc().iter().zip(statuses).find(|(_, status)| status.is_bad()) {
            None => Ok(()),
            Some((point, status)) => {
                let message = format!("`{}` cannot be written: {status}", point.label());
                Err(MappingFault::new(&point.name, message).into())
            }
        }
    }

    fn read(&mut self, _patience: Duration, from_plc: &mut [u8]) -> Result<bool, LinkFault> {
        let connection = self.connected()?;
        let read = connection.session.read(&self.reads, TimestampsToReturn::Neither, 0.0);
        let values = self.runtime.block_on(read).map_err(|error| lost(&error))?;
        if values.len() != self.reads.len() {
            return Err(LinkFault::Nonsense(format!("{} values came for {}", values.len(), self.reads.len())));
        }
        for (point, value) in self.exchange.from_plc().iter().zip(values) {
            let found = value.value.unwrap_or_default();
            if !value::from_variant(point.ty, &found, &mut from_plc[point.range()]) {
                let status = value.status.unwrap_or(StatusCode::Good);
                let (name, ty, found) = (&point.name, point.ty, value::type_name(&found));
                return Err(LinkFault::Nonsense(format!("`{name}` is {ty}, and {found} came ({status})")));
            }
        }
        Ok(true)
    }
}
