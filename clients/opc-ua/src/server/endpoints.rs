//! An OPC UA server: endpoints, users, certificates, and the thread that it runs on. What it serves is others' business.

use std::collections::BTreeMap;
use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::JoinHandle;
use std::time::Duration;

use opcua::crypto::SecurityPolicy;
use opcua::server::node_manager::NodeManagerBuilder;
use opcua::server::{ANONYMOUS_USER_TOKEN_ID, ServerBuilder, ServerHandle, ServerUserToken};
use opcua::types::MessageSecurityMode;
use tokio::net::TcpListener;

use super::authenticator::Authenticator;
use super::door::{self, Channels};
use super::pki::Pki;
use onescan_base::threads;
use onescan_links::listener::bind;
use onescan_links::opcua::{Access, Refusals, ServeError};

/// Shortest publishing interval, and how often subscriptions are looked at.
const SUBSCRIPTIONS_MS: u64 = 1;

/// Sessions at a time. One whose connection is gone stays for [`SESSION_TIMEOUT`], as OPC UA has it, so that there must be
/// many more of them than connections.
const SESSIONS_MAX: usize = 512;

/// How long a session lasts in which nothing is asked for, so also that of a client that is dead; clients hear this value when they
/// ask for more. Most stacks ask for the server's state every 5 s, none less often than every 10 s.
const SESSION_TIMEOUT: Duration = Duration::from_secs(15);

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
            // The thread itself has reported its panic.
            let _ = thread.join();
        }
    }
}

/// A server of the nodes of `manager`, which `fill` may add to before anybody is let in.
///
/// # Errors
/// The address cannot be listened on, or the server cannot be set up.
pub(crate) fn start(
    address: SocketAddr,
    name: &str,
    access: &Access,
    refusals: &Refusals,
    channels: &Channels,
    manager: impl NodeManagerBuilder + 'static,
    fill: impl FnOnce(&ServerHandle) -> Result<(), ServeError>,
) -> Result<Running, ServeError> {
    let (listener, address) = bind(address)?;
    let pki = Pki::new(access.pki.as_deref())?;
    let runtime = onescan_server::transport::runtime::with_a_thread()?;
    let (server, handle) = {
        let _inside = runtime.enter();
        builder(address, name, access, refusals, &pki).with_node_manager(manager).build().map_err(ServeError::Setup)?
    };
    fill(&handle)?;
    let (entered, channels) = (handle.clone(), channels.clone());
    let thread = threads::start("OPC UA", move || {
        let _kept = pki;
        let ended = runtime.block_on(async {
            let outside = TcpListener::from_std(listener).map_err(|error| error.to_string())?;
            let inside = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).await.map_err(|error| error.to_string())?;
            let server_at = inside.local_addr().map_err(|error| error.to_string())?;
            tokio::spawn(async move {
                own_port(&entered, server_at.port(), address.port()).await;
                door::let_in(outside, server_at, channels).await;
            });
            server.run_with(inside).await
        });
        if let Err(error) = ended {
            tracing::warn!(%error, "the OPC UA server has ended");
        }
        // Connections of clients that stay are not a reason to.
        runtime.shutdown_background();
    })?;
    Ok(Running { address, handle, thread: Some(thread) })
}

/// Lets endpoints name the port that clients come to: the server takes that of its own listener when it starts.
async fn own_port(handle: &ServerHandle, inside: u16, outside: u16) {
    let port = &handle.info().port;
    while port.load(Ordering::Relaxed) != inside {
        tokio::task::yield_now().await;
    }
    port.store(outside, Ordering::Relaxed);
}

/// Stands for whoever has a token, where endpoints name their users. No password is good for it: the authenticator looks
/// at the token.
const HOLDER: &str = "holder";

fn builder(address: SocketAddr, name: &str, access: &Access, refusals: &Refusals, pki: &Pki) -> ServerBuilder {
    let mut builder = ServerBuilder::new()
        .application_name(format!("onescan {name}"))
        .application_uri(format!("urn:onescan:{name}:application"))
        .product_uri("urn:onescan")
        .host(address.ip().to_string())
        .port(address.port())
        .discovery_urls(vec!["/".to_owned()])
        .create_sample_keypair(access.pki.is_some() || access.user.is_some() || access.register.is_some())
        .pki_dir(pki.path())
        .trust_client_certs(access.trust_clients)
        .max_sessions(SESSIONS_MAX)
        .max_session_timeout_ms(SESSION_TIMEOUT.as_millis() as u64)
        .subscription_poll_interval_ms(SUBSCRIPTIONS_MS);
    let limits = &mut builder.limits_mut().subscriptions;
    limits.min_publishing_interval_ms = SUBSCRIPTIONS_MS as f64;
    limits.min_sampling_interval_ms = 0.0;
    let mut known = BTreeMap::new();
    let mut users = Vec::new();
    let holder = access.register.is_some().then(|| (HOLDER.to_owned(), String::new()));
    match holder.as_ref().or(access.user.as_ref()) {
        Some((user, password)) => {
            let token = ServerUserToken::user_pass(user, password);
            builder = builder.add_user_token("user", token.clone());
            known.insert("user".to_owned(), token);
            users.push("user");
        }
        None => users.push(ANONYMOUS_USER_TOKEN_ID),
    }
    builder =
        builder.with_authenticator(Arc::new(Authenticator::new(known, access.register.clone(), refusals.clone())));
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
