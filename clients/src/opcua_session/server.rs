//! The address space, and the server.

use std::net::SocketAddr;
use std::sync::Arc;

use onescan_server::mailbox::Mailbox;
use onescan_server::session::Control;
use onescan_server::signal::{ElementaryType, PortLayout};
use opcua::server::ServerHandle;
use opcua::server::address_space::{AddressSpace, MethodBuilder, ObjectBuilder, ObjectTypeBuilder, VariableBuilder};
use opcua::server::node_manager::memory::SimpleNodeManager;
use opcua::types::{DataTypeId, DataValue, NodeId, ObjectId, ObjectTypeId, ReferenceTypeId, StatusCode, Variant};

use super::model::{CLIENT, NAMESPACE, ObjectType, SESSION, TYPES};
use super::seat::Seat;
use super::view::Watcher;
use crate::gateway::opcua::value;
use crate::station::opcua::{Access, Running, ServeError, start};

/// All that is served of a session.
pub struct Desk {
    /// What there is to see.
    pub watcher: Watcher,
    /// Where wishes go.
    pub mailbox: Mailbox,
    /// The clients' places.
    pub seats: Vec<Arc<Seat>>,
}

/// Serves a session at `address`, until what is returned is dropped.
///
/// # Errors
/// The address cannot be listened on, or the server cannot be set up.
pub fn serve(address: SocketAddr, desk: Desk, access: &Access) -> Result<Running, ServeError> {
    start(address, "onescan", NAMESPACE, access, |handle, manager, namespace| {
        Space { handle, manager, namespace }.build(desk);
    })
}

/// Where nodes are put.
struct Space<'s> {
    handle: &'s ServerHandle,
    manager: &'s SimpleNodeManager,
    namespace: u16,
}

impl Space<'_> {
    fn id(&self, path: &str) -> NodeId {
        NodeId::new(self.namespace, path.to_owned())
    }

    fn add(&self, insert: impl FnOnce(&mut AddressSpace) -> bool) {
        if !insert(&mut self.manager.address_space().write()) {
            tracing::warn!("a node of the OPC UA model is there twice");
        }
    }

    fn build(&self, desk: Desk) {
        for object in TYPES {
            self.object_type(&object);
        }
        let Desk { watcher, mailbox, seats } = desk;
        let session = self.object("Session", "Session", &ObjectId::ObjectsFolder.into(), &SESSION);
        let seen = |name: &str, read: fn(&super::view::SessionView) -> Variant| {
            let watcher = watcher.clone();
            self.variable(&session, "Session", name, &read(&watcher.view()), move || read(&watcher.view()));
        };
        seen("State", |view| Variant::from(view.state));
        seen("VirtualTime", |view| Variant::Int64(view.t_v.as_nanos() as i64));
        seen("StepTime", |view| Variant::Int64(view.step.as_nanos() as i64));
        seen("Steps", |view| Variant::UInt64(view.steps));
        seen("Held", |view| Variant::Boolean(view.state == "held"));
        let wishes = [
            ("Start", Control::Resume),
            ("Stop", Control::Stop),
            ("Pause", Control::Pause),
            ("Step", Control::Step),
            ("Reset", Control::Reset),
        ];
        for (name, control) in wishes {
            self.method(&session, name, control, mailbox.clone());
        }
        let clients = self.folder(&session, "Session", "Clients");
        for seat in seats {
            self.client(&clients, &seat);
        }
    }

    fn object_type(&self, object: &ObjectType) {
        let id = NodeId::new(self.namespace, object.id);
        let builder = ObjectTypeBuilder::new(&id, self.name(object.name), object.name)
            .description(object.about)
            .subtype_of(ObjectTypeId::BaseObjectType);
        self.add(|space| builder.insert(space));
        for (number, variable) in object.variables.iter().enumerate() {
            let part = NodeId::new(self.namespace, object.id + 1 + number as u32);
            let builder = VariableBuilder::new(&part, self.name(variable.name), variable.name)
                .description(variable.about)
                .data_type(NodeId::new(0, variable.data_type.id))
                .has_type_definition(opcua::types::VariableTypeId::BaseDataVariableType)
                .has_modelling_rule(ObjectId::ModellingRule_Mandatory)
                .component_of(&id);
            self.add(|space| builder.insert(space));
        }
    }

    fn name(&self, name: &str) -> opcua::types::QualifiedName {
        opcua::types::QualifiedName::new(self.namespace, name)
    }

    fn object(&self, path: &str, name: &str, parent: &NodeId, definition: &ObjectType) -> NodeId {
        let id = self.id(path);
        let builder = ObjectBuilder::new(&id, self.name(name), name)
            .has_type_definition(NodeId::new(self.namespace, definition.id))
            .reference(parent, ReferenceTypeId::Organizes, opcua::nodes::ReferenceDirection::Inverse);
        self.add(|space| builder.insert(space));
        id
    }

    fn folder(&self, parent: &NodeId, path: &str, name: &str) -> NodeId {
        let id = self.id(&format!("{path}.{name}"));
        let builder = ObjectBuilder::new(&id, self.name(name), name).is_folder().component_of(parent);
        self.add(|space| builder.insert(space));
        id
    }

    /// A variable that the server writes.
    fn variable(
        &self,
        parent: &NodeId,
        path: &str,
        name: &str,
        first: &Variant,
        read: impl Fn() -> Variant + Send + Sync + 'static,
    ) -> NodeId {
        let id = self.id(&format!("{path}.{name}"));
        let kind = first.scalar_type_id().map_or(DataTypeId::BaseDataType.into(), |kind| NodeId::new(0, kind as u32));
        let builder = VariableBuilder::new(&id, self.name(name), name)
            .data_type(kind)
            .value(first.clone())
            .has_type_definition(opcua::types::VariableTypeId::BaseDataVariableType)
            .component_of(parent);
        self.add(|space| builder.insert(space));
        self.manager.inner().add_read_callback(id.clone(), move |_, _, _| Ok(DataValue::new_now(read())));
        id
    }

    /// Lets the client write a variable.
    fn writable(&self, id: &NodeId, write: impl Fn(&Variant) -> StatusCode + Send + Sync + 'static) {
        if let Some(opcua::nodes::NodeType::Variable(variable)) = self.manager.address_space().write().find_mut(id) {
            variable.set_writable(true);
        }
        self.manager.inner().add_write_callback(id.clone(), move |value, _| {
            write(&value.value.unwrap_or(Variant::Empty))
        });
    }

    fn method(&self, parent: &NodeId, name: &str, control: Control, mailbox: Mailbox) {
        let id = self.id(&format!("Session.{name}"));
        let builder = MethodBuilder::new(&id, self.name(name), name).component_of(parent).executable(true).user_executable(true);
        self.add(|space| builder.insert(space));
        self.manager.inner().add_method_callback(id, move |_| {
            mailbox.control(control);
            Ok(Vec::new())
        });
    }

    fn client(&self, clients: &NodeId, seat: &Arc<Seat>) {
        let name = seat.request().name.to_string();
        let client = self.object(&name, &name, clients, &CLIENT);
        let shared = || Arc::clone(seat);
        let one = shared();
        self.variable(&client, &name, "Grant", &Variant::UInt32(0), move || Variant::UInt32(one.grant().0));
        let one = shared();
        let time = move || Variant::Int64(one.grant().1.as_nanos() as i64);
        self.variable(&client, &name, "GrantTime", &Variant::Int64(0), time);
        let one = shared();
        let done = self.variable(&client, &name, "Done", &Variant::UInt32(0), move || Variant::UInt32(one.done()));
        let one = shared();
        self.writable(&done, move |value| match value {
            Variant::UInt32(number) if one.set_done(*number) => StatusCode::Good,
            Variant::UInt32(_) => StatusCode::BadInvalidState,
            _ => StatusCode::BadTypeMismatch,
        });
        self.signals(seat, &client, &name, "Inputs");
        self.signals(seat, &client, &name, "Outputs");
        let _ = self.handle;
    }

    fn signals(&self, seat: &Arc<Seat>, client: &NodeId, name: &str, which: &str) {
        let folder = self.folder(client, name, which);
        let is_input = which == "Inputs";
        let ports = if is_input { &seat.request().reads } else { &seat.request().writes };
        for (port, at) in PortLayout::new(ports.clone()).iter() {
            let (ty, zero) = (port.ty, vec![0; port.ty.size()]);
            let one = Arc::clone(seat);
            let read = move || {
                let mut bytes = vec![0; ty.size()];
                if is_input { one.input(at, &mut bytes) } else { one.output(at, &mut bytes) }
                value::to_variant(ty, &bytes)
            };
            let path = format!("{name}.{which}");
            let id = self.variable(&folder, &path, port.name.as_str(), &value::to_variant(ty, &zero), read);
            if !is_input {
                let one = Arc::clone(seat);
                self.writable(&id, move |value| written(&one, at, ty, value));
            }
        }
    }
}

fn written(seat: &Seat, at: usize, ty: ElementaryType, value: &Variant) -> StatusCode {
    let mut bytes = vec![0; ty.size()];
    if !value::from_variant(ty, value, &mut bytes) {
        StatusCode::BadTypeMismatch
    } else if seat.set_output(at, &bytes) {
        StatusCode::Good
    } else {
        StatusCode::BadInvalidState
    }
}
