//! A session with an OPC UA server, and what it says when there is none.

use std::sync::Arc;
use std::time::Duration;

use opcua::client::{Client, ClientBuilder, Session};
use opcua::types::{
    EndpointDescription, Error, NodeId, ReadValueId, StatusCode, TimestampsToReturn, UserTokenPolicy, VariableId,
    Variant,
};
use tokio::runtime::Runtime;
use tokio::task::JoinHandle;

use crate::server::pki::Pki;
use onescan_links::gateway::fault::LinkFault;
use onescan_links::opcua::Options;

/// A session, and the task that carries its messages.
pub struct Connection {
    pub session: Arc<Session>,
    /// The namespaces of the server, by index.
    pub namespaces: Vec<String>,
    task: JoinHandle<StatusCode>,
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.task.abort();
    }
}

impl Connection {
    /// Connects to `url`.
    ///
    /// # Errors
    /// Nobody is there, or who is there does not let this client in.
    pub fn open(
        runtime: &Runtime,
        url: &str,
        options: &Options,
        pki: &Pki,
        timeout: Duration,
    ) -> Result<Self, LinkFault> {
        let (policy, mode) = super::identity::security(options)?;
        let identity = super::identity::identity(options)?;
        let mut client = client(options, pki, timeout)?;
        let endpoint: EndpointDescription = (url, policy.to_uri(), mode, UserTokenPolicy::anonymous()).into();
        runtime.block_on(async {
            let matched = client.connect_to_matching_endpoint(endpoint, identity);
            let matched = tokio::time::timeout(timeout, matched).await;
            let matched = matched.map_err(|_| unreachable(url, format!("no answer within {timeout:?}")))?;
            let (session, event_loop) = matched.map_err(|error| {
                // The server has said which endpoints it has.
                if error.status().sub_code() == StatusCode::BadTcpEndpointUrlInvalid.sub_code() {
                    let reason = format!("it has no endpoint with policy {policy} and mode {mode}");
                    return LinkFault::Refused { url: url.to_owned(), reason };
                }
                of_error(url, &error)
            })?;
            let mut task = event_loop.spawn();
            let connected = tokio::select! {
                connected = tokio::time::timeout(timeout, session.wait_for_connection()) => match connected {
                    Ok(true) => Ok(()),
                    _ => Err(unreachable(url, format!("no session within {timeout:?}"))),
                },
                status = &mut task => Err(of_status(url, status.unwrap_or(StatusCode::BadConnectionClosed), "")),
            };
            let mut connection = Self { session, namespaces: Vec::new(), task };
            connected?;
            connection.namespaces = connection.read_namespaces().await?;
            Ok(connection)
        })
    }

    async fn read_namespaces(&self) -> Result<Vec<String>, LinkFault> {
        let id: NodeId = VariableId::Server_NamespaceArray.into();
        let read = self.session.read(&[ReadValueId::new_value(id)], TimestampsToReturn::Neither, 0.0).await;
        let values = read.map_err(|error| lost(&error))?;
        match values.into_iter().next().and_then(|value| value.value) {
            Some(Variant::Array(array)) => Ok(array.values.iter().map(ToString::to_string).collect()),
            _ => Err(LinkFault::Nonsense("the server has no NamespaceArray".to_owned())),
        }
    }

    /// The node of `address`, `ns=2;s=Name` or `nsu=URI;s=Name`; without a namespace a name in that of `options`.
    pub fn node(&self, address: &str, options: &Options) -> Option<NodeId> {
        let index_of = |uri: &str| self.namespaces.iter().position(|known| known == uri).map(|index| index as u16);
        if let Some(rest) = address.strip_prefix("nsu=") {
            let (uri, id) = rest.split_once(';')?;
            return format!("ns={};{id}", index_of(uri)?).parse().ok();
        }
        if address.starts_with("ns=") || ["i=", "s=", "g=", "b="].iter().any(|kind| address.starts_with(kind)) {
            return address.parse().ok();
        }
        Some(NodeId::new(index_of(&options.namespace)?, address.to_owned()))
    }
}

fn client(options: &Options, pki: &Pki, timeout: Duration) -> Result<Client, LinkFault> {
    let builder = ClientBuilder::new()
        .application_name("onescan")
        .application_uri("urn:onescan:client")
        .product_uri("urn:onescan")
        .trust_server_certs(options.trust_server)
        .verify_server_certs(!options.trust_server)
        .create_sample_keypair(options.is_secured())
        .pki_dir(pki.path())
        .request_timeout(timeout)
        // A connection that is lost is made again by the gateway, which knows what was under way.
        .session_retry_limit(0)
        .max_message_size(16 * 1024 * 1024);
    builder.client().map_err(|errors| LinkFault::Setting(errors.join("; ")))
}

fn unreachable(url: &str, reason: String) -> LinkFault {
    LinkFault::Unreachable { url: url.to_owned(), reason }
}

/// A request that failed as a whole.
pub fn lost(error: &Error) -> LinkFault {
    LinkFault::Lost(error.to_string())
}

fn of_error(url: &str, error: &Error) -> LinkFault {
    of_status(url, error.status(), &error.to_string())
}

/// What the operating system said, without the form in which a library shows it: `Os { code: 111, …, message: "…" }`.
fn for_people(text: &str) -> String {
    let message = |rest: &str| Some(rest.split_once("message: \"")?.1.split_once("\" }")?.0.to_owned());
    text.split_once("Os { code: ").and_then(|(_, rest)| message(rest)).unwrap_or_else(|| text.to_owned())
}

/// Who is let in is the server's decision; everything else may be otherwise in a moment.
fn of_status(url: &str, status: StatusCode, text: &str) -> LinkFault {
    let reason = if text.is_empty() { status.to_string() } else { for_people(text) };
    let is_refusal = [
        StatusCode::BadIdentityTokenInvalid,
        StatusCode::BadIdentityTokenRejected,
        StatusCode::BadUserAccessDenied,
        StatusCode::BadUserSignatureInvalid,
        StatusCode::BadSecurityChecksFailed,
        StatusCode::BadSecurityPolicyRejected,
        StatusCode::BadSecurityModeRejected,
        StatusCode::BadCertificateUntrusted,
        StatusCode::BadCertificateInvalid,
        StatusCode::BadCertificateTimeInvalid,
        StatusCode::BadCertificateHostNameInvalid,
        StatusCode::BadCertificateUriInvalid,
        StatusCode::BadNoMatch,
    ]
    .iter()
    .any(|code| code.sub_code() == status.sub_code());
    if is_refusal { LinkFault::Refused { url: url.to_owned(), reason } } else { unreachable(url, reason) }
}
