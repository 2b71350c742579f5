//! Nodes that only clients with a certificate of their own, and no viewers, may write and call.

use std::sync::Arc;

use async_trait::async_trait;
use onescan_server::access::Register;
use opcua::server::CreateMonitoredItem;
use opcua::server::address_space::AddressSpace;
use opcua::server::diagnostics::NamespaceMetadata;
use opcua::server::node_manager::memory::InMemoryNodeManagerImpl;
use opcua::server::node_manager::{
    MethodCall, MonitoredItemRef, MonitoredItemUpdateRef, ParsedReadValueId, RequestContext, ServerContext, WriteNode,
};
use opcua::sync::RwLock;
use opcua::types::{DataValue, MonitoringMode, StatusCode, TimestampsToReturn};

use onescan_links::opcua::Refusals;

/// The nodes of `inner`, for clients that are who their certificate says.
pub(crate) struct Admitted<T> {
    inner: T,
    /// Where it is noted whose certificate is that of another application; nothing if such a client is let in.
    sent_away: Option<Refusals>,
    /// Tokens, where users show one.
    register: Option<Arc<Register>>,
}

impl<T> Admitted<T> {
    pub(crate) fn new(inner: T, sent_away: Option<Refusals>, register: Option<Arc<Register>>) -> Self {
        Self { inner, sent_away, register }
    }

    pub(crate) fn inner(&self) -> &T {
        &self.inner
    }

    /// Refuses a client whose certificate was made for another application (OPC 10000-4 6.1.3, `Bad_CertificateUriInvalid`).
    /// And a viewer, who changes nothing.
    fn admit(&self, context: &RequestContext) -> Result<(), StatusCode> {
        if let Some(register) = &self.register
            && !register.passes().iter().any(|pass| pass.name == context.token.0 && pass.role.operates())
        {
            return Err(StatusCode::BadUserAccessDenied);
        }
        let Some(sent_away) = &self.sent_away else { return Ok(()) };
        let session = context.session.read();
        let Some(certificate) = session.client_certificate() else { return Ok(()) };
        let uri = &session.application_description().application_uri;
        certificate.is_application_uri_valid(uri.as_ref()).map_err(|error| {
            sent_away.note(format!("the OPC UA client `{uri}`, whose certificate was made for another application"));
            error.status()
        })
    }
}

#[async_trait]
#[expect(clippy::mut_mut, reason = "the trait's own")]
impl<T: InMemoryNodeManagerImpl> InMemoryNodeManagerImpl for Admitted<T> {
    async fn init(&self, space: &mut AddressSpace, context: ServerContext) {
        self.inner.init(space, context).await;
    }

    fn name(&self) -> &str {
        self.inner.name()
    }

    fn namespaces(&self) -> Vec<NamespaceMetadata> {
        self.inner.namespaces()
    }

    async fn read_values(
        &self,
        context: &RequestContext,
        space: &RwLock<AddressSpace>,
        nodes: &[&ParsedReadValueId],
        max_age: f64,
        timestamps: TimestampsToReturn,
    ) -> Vec<DataValue> {
        self.inner.read_values(context, space, nodes, max_age, timestamps).await
    }

    async fn create_value_monitored_items(
        &self,
        context: &RequestContext,
        space: &RwLock<AddressSpace>,
        items: &mut [&mut &mut CreateMonitoredItem],
    ) {
        self.inner.create_value_monitored_items(context, space, items).await;
    }

    async fn modify_monitored_items(&self, context: &RequestContext, items: &[&MonitoredItemUpdateRef]) {
        self.inner.modify_monitored_items(context, items).await;
    }

    async fn set_monitoring_mode(&self, context: &RequestContext, mode: MonitoringMode, items: &[&MonitoredItemRef]) {
        self.inner.set_monitoring_mode(context, mode, items).await;
    }

    async fn delete_monitored_items(&self, context: &RequestContext, items: &[&MonitoredItemRef]) {
        self.inner.delete_monitored_items(context, items).await;
    }

    async fn write(
        &self,
        context: &RequestContext,
        space: &RwLock<AddressSpace>,
        nodes: &mut [&mut WriteNode],
    ) -> Result<(), StatusCode> {
        self.admit(context)?;
        self.inner.write(context, space, nodes).await
    }

    async fn call(
        &self,
        context: &RequestContext,
        space: &RwLock<AddressSpace>,
        calls: &mut [&mut &mut MethodCall],
    ) -> Result<(), StatusCode> {
        self.admit(context)?;
        self.inner.call(context, space, calls).await
    }
}
