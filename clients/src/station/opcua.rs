//! Variables of an OPC UA server: the PLC's side. Each point is a variable under its name; the server takes and
//! gives them one by one, and the PLC may run a cycle between two, as in a real one.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread::JoinHandle;

use opcua::crypto::SecurityPolicy;
use opcua::server::address_space::VariableBuilder;
use opcua::server::diagnostics::NamespaceMetadata;
use opcua::server::node_manager::memory::{SimpleNodeManager, simple_node_manager};
use opcua::server::{ANONYMOUS_USER_TOKEN_ID, ServerBuilder, ServerHandle, ServerUserToken};
use opcua::types::{DataValue, MessageSecurityMode, NodeId, ObjectId, StatusCode, Variant};
use thiserror::Error;
use tokio::net::TcpListener;

use super::controller::Controller;
use crate::gateway::exchange::{Direction, Point};
use crate::gateway::opcua::options::NAMESPACE;
use crate::gateway::opcua::pki::Pki;
use crate::gateway::opcua::value;

/// Who is let in.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Access {
    /// User and password; without them anybody is let in.
    pub user: Option<(String, String)>,
    /// The folder with the server's certificates and those of clients it trusts; with it there are no endpoints
    /// without security.
    pub pki: Option<PathBuf>,
    /// Trust any client's certificate.
    pub trust_clients: bool,
}

/// Why there is no server.
#[derive(Debug, Error)]
pub enum ServeError {
    /// The address, or the folder for certificates.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// What the server is to be does not go together.
    #[error("the OPC UA server cannot be set up: {0}")]
    Setup(String),
}

/// A server that runs until this is dropped.
pub struct Running {
    address: SocketAddr,
    handle: ServerHandle,
    thread: Option<JoinHandle<()>>,
}

impl Running {
    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.handle.cancel();
        if let Some(thread) = self.thread.take() {
            // A panic in there has been told by the thread itself.
            let _ = thread.join();
        }
    }
}

/// Serves the PLC's variables at `address`, until what is returned is dropped.
///
/// # Errors
/// The address cannot be listened on, or the server cannot be set up.
pub fn serve(address: SocketAddr, controller: &Arc<Controller>, access: &Access) -> Result<Running, ServeError> {
    start(address, "plc", NAMESPACE, access, |_, manager, namespace| add_variables(manager, namespace, controller))
}

/// A server with one namespace, whose nodes `fill` adds.
pub(crate) fn start(
    address: SocketAddr,
    name: &str,
    uri: &str,
    access: &Access,
    fill: impl FnOnce(&ServerHandle, &SimpleNodeManager, u16),
) -> Result<Running, ServeError> {
    let listener = std::net::TcpListener::bind(address)?;
    let address = listener.local_addr()?;
    listener.set_nonblocking(true)?;
    let pki = Pki::new(access.pki.as_deref())?;
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build()?;
    let (server, handle) = {
        let _inside = runtime.enter();
        builder(address, name, uri, access, &pki).build().map_err(ServeError::Setup)?
    };
    let missing = |what: &str| ServeError::Setup(format!("{what} is missing"));
    let namespace = handle.get_namespace_index(uri).ok_or_else(|| missing("the namespace"))?;
    let manager = handle.node_managers().get_of_type::<SimpleNodeManager>().ok_or_else(|| missing("the manager"))?;
    fill(&handle, &manager, namespace);
    let thread = std::thread::spawn(move || {
        let _kept = pki;
        let ended = runtime.block_on(async {
            let listener = TcpListener::from_std(listener).map_err(|error| error.to_string())?;
            server.run_with(listener).await
        });
        if let Err(error) = ended {
            tracing::warn!(%error, "the OPC UA server has ended");
        }
        // Connections of clients that stay are no reason to.
        runtime.shutdown_background();
    });
    Ok(Running { address, handle, thread: Some(thread) })
}

fn builder(address: SocketAddr, name: &str, uri: &str, access: &Access, pki: &Pki) -> ServerBuilder {
    let namespace = NamespaceMetadata { namespace_uri: uri.to_owned(), ..Default::default() };
    let mut builder = ServerBuilder::new()
        .application_name(format!("onescan {name}"))
        .application_uri(format!("urn:onescan:{name}:application"))
        .product_uri("urn:onescan")
        .host(address.ip().to_string())
        .port(address.port())
        .discovery_urls(vec!["/".to_owned()])
        .create_sample_keypair(access.pki.is_some() || access.user.is_some())
        .pki_dir(pki.path())
        .trust_client_certs(access.trust_clients)
        .with_node_manager(simple_node_manager(namespace, name));
    let mut users = Vec::new();
    match &access.user {
        Some((user, password)) => {
            builder = builder.add_user_token("user", ServerUserToken::user_pass(user, password));
            users.push("user");
        }
        None => users.push(ANONYMOUS_USER_TOKEN_ID),
    }
    if access.pki.is_none() {
        let none = ("/", SecurityPolicy::None, MessageSecurityMode::None, &users[..]);
        return builder.add_endpoint("none", none);
    }
    let policies =
        [SecurityPolicy::Basic256Sha256, SecurityPolicy::Aes128Sha256RsaOaep, SecurityPolicy::Aes256Sha256RsaPss];
    for policy in policies {
        for mode in [MessageSecurityMode::Sign, MessageSecurityMode::SignAndEncrypt] {
            builder = builder.add_endpoint(format!("{policy}-{mode}"), ("/", policy, mode, &users[..]));
        }
    }
    builder
}

fn add_variables(manager: &SimpleNodeManager, namespace: u16, controller: &Arc<Controller>) {
    let folder = NodeId::new(namespace, "PLC");
    manager.address_space().write().add_folder(&folder, "PLC", "PLC", &NodeId::from(ObjectId::ObjectsFolder));
    let exchange = controller.wires().exchange().clone();
    let directions = [(Direction::ToPlc, exchange.to_plc()), (Direction::FromPlc, exchange.from_plc())];
    for (direction, points) in directions {
        for (index, point) in points.iter().enumerate() {
            let id = NodeId::new(namespace, point.name.clone());
            variable(&id, point, direction).organized_by(&folder).insert(&mut *manager.address_space().write());
            let (reader, ty, range) = (Arc::clone(controller), point.ty, point.range());
            manager.inner().add_read_callback(id.clone(), move |_, _, _| {
                let mut value = vec![0; range.len()];
                reader.read_point(direction, index, &mut value);
                Ok(DataValue::new_now(value::to_variant(ty, &value)))
            });
            if direction == Direction::ToPlc {
                let writer = Arc::clone(controller);
                manager.inner().add_write_callback(id, move |written, _| {
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

fn variable(id: &NodeId, point: &Point, direction: Direction) -> VariableBuilder {
    let zero = vec![0; point.ty.size()];
    let builder = VariableBuilder::new(id, point.name.as_str(), point.name.as_str())
        .data_type(value::data_type(point.ty))
        .value(value::to_variant(point.ty, &zero));
    if direction == Direction::ToPlc { builder.writable() } else { builder }
}
