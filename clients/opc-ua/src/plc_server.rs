//! Variables of an OPC UA server: the PLC's side. Each point is a variable under the path that it has in the
//! program; the server takes and gives them one by one, and the PLC may run a cycle between two, as in a real one.

use std::net::SocketAddr;
use std::sync::Arc;

use opcua::server::address_space::{AddressSpace, VariableBuilder};
use opcua::server::diagnostics::NamespaceMetadata;
use opcua::server::node_manager::ServerContext;
use opcua::server::node_manager::memory::{
    InMemoryNodeManager, InMemoryNodeManagerBuilder, InMemoryNodeManagerImplBuilder, SimpleNodeManagerBuilder,
    SimpleNodeManagerImpl,
};
use opcua::types::{DataValue, NodeId, ObjectId, StatusCode, Variant};

use crate::link::value;
use crate::server::{self, Admitted, Channels, Running};
use onescan_links::gateway::exchange::{Direction, Point};
use onescan_links::opcua::NAMESPACE;
use onescan_links::opcua::{Access, Refusals, ServeError};
use onescan_links::station::Controller;

/// Serves the PLC's variables at `address`, until what is returned is dropped.
///
/// # Errors
/// The address cannot be listened on, or the server cannot be set up.
pub fn serve(address: SocketAddr, controller: &Arc<Controller>, access: &Access) -> Result<Running, ServeError> {
    let namespace = NamespaceMetadata { namespace_uri: NAMESPACE.to_owned(), ..Default::default() };
    let refusals = Refusals::default();
    let sent_away = (!access.foreign_uris).then(|| refusals.clone());
    let manager = InMemoryNodeManagerBuilder::new(move |context: ServerContext, space: &mut AddressSpace| {
        Admitted::new(SimpleNodeManagerBuilder::new(namespace, "plc").build(context, space), sent_away, None)
    });
    server::start(address, "plc", access, &refusals, &Channels::default(), manager, |handle| {
        let missing = |what: &str| ServeError::Setup(format!("{what} is missing"));
        let namespace = handle.get_namespace_index(NAMESPACE).ok_or_else(|| missing("the namespace"))?;
        let manager = handle.node_managers().get_of_type::<Nodes>();
        add_variables(&*manager.ok_or_else(|| missing("the manager"))?, namespace, controller);
        Ok(())
    })
}

type Nodes = InMemoryNodeManager<Admitted<SimpleNodeManagerImpl>>;

fn add_variables(manager: &Nodes, namespace: u16, controller: &Arc<Controller>) {
    let folder = NodeId::new(namespace, "PLC");
    manager.address_space().write().add_folder(&folder, "PLC", "PLC", &NodeId::from(ObjectId::ObjectsFolder));
    let exchange = controller.wires().exchange().clone();
    let directions = [(Direction::ToPlc, exchange.to_plc()), (Direction::FromPlc, exchange.from_plc())];
    for (direction, points) in directions {
        for (index, point) in points.iter().enumerate() {
            let id = NodeId::new(namespace, identifier(point));
            variable(&id, point, direction).organized_by(&folder).insert(&mut *manager.address_space().write());
            let (reader, ty, range) = (Arc::clone(controller), point.ty, point.range());
            manager.inner().inner().add_read_callback(id.clone(), move |_, _, _| {
                let mut value = vec![0; range.len()];
                reader.read_point(direction, index, &mut value);
                Ok(DataValue::new_now(value::to_variant(ty, &value)))
            });
            if direction == Direction::ToPlc {
                let writer = Arc::clone(controller);
                manager.inner().inner().add_write_callback(id, move |written, _| {
                    let mut value = vec![0; ty.size()];
                    if !value::from_variant(ty, &written.value.unwrap_or(Variant::Empty), &mut value) {
                        return StatusCode::BadTypeMismatch;
                    }
                    writer.write_points(std::iter::once((index, &value[..])));
                    StatusCode::Good
                });
            }
        }
    }
}

/// The name of a point's node: that of the scenario's address if it is one in this namespace or a bare name, or else the
/// variable's path.
fn identifier(point: &Point) -> String {
    let Some(address) = &point.address else { return point.symbol().to_owned() };
    let name = address.strip_prefix("s=").or_else(|| Some(address.split_once(";s=")?.1));
    name.unwrap_or(address).to_owned()
}

fn variable(id: &NodeId, point: &Point, direction: Direction) -> VariableBuilder {
    let (zero, name) = (vec![0; point.ty.size()], identifier(point));
    let builder = VariableBuilder::new(id, name.as_str(), name.as_str())
        .data_type(value::data_type(point.ty))
        .value(value::to_variant(point.ty, &zero));
    if direction == Direction::ToPlc { builder.writable() } else { builder }
}
