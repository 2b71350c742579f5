//! Requests of OPC UA clients: values read, outputs and answers written, methods called.
//!
//! The status of each value or call reports what was done, see [`status`].

use std::collections::HashMap;
use std::sync::{Arc, Weak};

use async_trait::async_trait;
use opcua::server::address_space::{AddressSpace, add_namespaces};
use opcua::server::diagnostics::NamespaceMetadata;
use opcua::server::node_manager::memory::InMemoryNodeManagerImpl;
use opcua::server::node_manager::{MethodCall, ParsedReadValueId, RequestContext, ServerContext, WriteNode};
use opcua::server::{CreateMonitoredItem, SubscriptionCache};
use opcua::sync::RwLock;
use opcua::types::{AttributeId, DataValue, NodeId, StatusCode, TimestampsToReturn, Variant};

use super::address_space::Namespaces;
use super::board::{Board, IsGone};
use super::call;
use super::instance;
use super::item::{Item, number};
use super::node::{SESSION_URI, TYPES_URI};
use super::seat::{Holder, Refusal};
use super::status::{packed, status};
use super::types;
use super::value::of_item;
use crate::server::Channels;

/// The nodes of a session and what is asked of them.
pub struct SessionNodes {
    board: Arc<Board>,
    namespaces: Vec<NamespaceMetadata>,
    items: HashMap<NodeId, Item>,
    /// The connections that are there.
    channels: Channels,
}

impl SessionNodes {
    /// Adds all nodes of the session on `board`.
    pub(super) fn new(
        board: Arc<Board>,
        channels: Channels,
        context: &ServerContext,
        space: &mut AddressSpace,
    ) -> Self {
        let indexes = add_namespaces(context, space, &[TYPES_URI, SESSION_URI]);
        let own = Namespaces { types: indexes[0], session: indexes[1] };
        for node in types::nodes() {
            own.insert(space, &node);
        }
        let mut items = HashMap::new();
        for instance in instance::nodes(&board) {
            own.insert(space, &instance.node);
            if let Some(item) = instance.item {
                items.insert(own.node_id(&instance.node.id), item);
            }
        }
        let namespace = |(uri, index): (&str, &u16)| NamespaceMetadata {
            namespace_uri: uri.to_owned(),
            namespace_index: *index,
            ..Default::default()
        };
        let namespaces = [TYPES_URI, SESSION_URI].into_iter().zip(&indexes).map(namespace).collect();
        let nodes: Vec<(Item, NodeId)> = items.iter().map(|(id, item)| (*item, id.clone())).collect();
        notify_subscribers(&board, nodes, Arc::clone(&context.subscriptions));
        Self { board, namespaces, items, channels }
    }

    /// Whether the client has gone: its session is in the server's hands alone, and ends when they let go; without a
    /// connection it takes part in nothing.
    fn is_gone(&self, context: &RequestContext) -> IsGone {
        let session: Weak<_> = Arc::downgrade(&context.session);
        let channels = self.channels.clone();
        Arc::new(move || session.upgrade().is_none_or(|session| channels.is_closed(session.read().secure_channel_id())))
    }

    fn write_value(&self, context: &RequestContext, write: &WriteNode, item: Item) -> StatusCode {
        let who = Holder(context.session_id);
        let given = write.value().value.value.as_ref().unwrap_or(&Variant::Empty);
        if write.value().attribute_id != AttributeId::Value || write.value().index_range.has_range() {
            return StatusCode::BadWriteNotSupported;
        }
        let done = match item {
            Item::Output(seat, index) => self.write_output(who, seat, index, given),
            Item::Seat(seat, number) => self.write_variable(context, who, seat, number, given),
            Item::Session(_) | Item::Signal(_) | Item::Input(..) => return StatusCode::BadNotWritable,
        };
        done.map_or_else(|status| status, |()| StatusCode::Good)
    }

    fn write_output(&self, who: Holder, seat: usize, index: usize, given: &Variant) -> Result<(), StatusCode> {
        let refused = |refusal: Refusal| status(refusal);
        let ty = self.board.lock().seats[seat].outputs.ports().get(index).map(|port| port.ty);
        let ty = ty.ok_or(StatusCode::BadNodeIdUnknown)?;
        match packed(ty, given) {
            Ok(bytes) => self.board.attempt(seat, |seat| seat.write(who, index, &bytes)).map_err(refused),
            Err(status) => {
                self.board.attempt(seat, |seat| seat.spoil(who, index)).map_err(refused)?;
                Err(status)
            }
        }
    }

    fn write_variable(
        &self,
        context: &RequestContext,
        who: Holder,
        seat: usize,
        of: u32,
        given: &Variant,
    ) -> Result<(), StatusCode> {
        let board = &self.board;
        let done = match (of, given) {
            (number::CLIENT_START, Variant::Boolean(true)) => board.start(seat, who, self.is_gone(context)),
            (number::CLIENT_START, Variant::Boolean(false)) => board.attempt(seat, |seat| seat.withdraw(who)),
            (number::DONE, Variant::UInt64(grant)) => board.attempt(seat, |seat| seat.done(who, *grant)),
            (number::WAKE, Variant::Int64(wake_ns)) => board.attempt(seat, |seat| seat.wake(who, *wake_ns)),
            (number::FAULT, Variant::String(why)) => board.attempt(seat, |seat| seat.fail(who, why.as_ref())),
            (number::CLIENT_START | number::DONE | number::WAKE | number::FAULT, _) => {
                return Err(StatusCode::BadTypeMismatch);
            }
            _ => return Err(StatusCode::BadNotWritable),
        };
        done.map_err(status)
    }
}

/// Values that change are sampled for those who subscribe to them.
fn notify_subscribers(board: &Arc<Board>, nodes: Vec<(Item, NodeId)>, subscriptions: Arc<SubscriptionCache>) {
    let ids: std::collections::BTreeMap<Item, NodeId> = nodes.into_iter().collect();
    let from = Arc::downgrade(board);
    board.set_notifier(Box::new(move |items| {
        let Some(board) = from.upgrade() else { return };
        let changed: Vec<(DataValue, &NodeId, AttributeId)> = {
            let (shared, view) = (board.lock(), board.view());
            let value = |item: &Item| {
                let id = ids.get(item)?;
                Some((DataValue::new_now(of_item(&board, &view, &shared, *item)?), id, AttributeId::Value))
            };
            items.iter().filter_map(value).collect()
        };
        subscriptions.notify_data_change(changed.into_iter());
    }));
}

#[async_trait]
#[expect(clippy::mut_mut, reason = "the trait's own")]
impl InMemoryNodeManagerImpl for SessionNodes {
    async fn init(&self, _space: &mut AddressSpace, _context: ServerContext) {}

    fn name(&self) -> &'static str {
        "session"
    }

    fn namespaces(&self) -> Vec<NamespaceMetadata> {
        self.namespaces.clone()
    }

    async fn read_values(
        &self,
        context: &RequestContext,
        space: &RwLock<AddressSpace>,
        nodes: &[&ParsedReadValueId],
        max_age: f64,
        timestamps: TimestampsToReturn,
    ) -> Vec<DataValue> {
        let space = space.read();
        let (shared, view) = (self.board.lock(), self.board.view());
        let read = |node: &&ParsedReadValueId| match self.items.get(&node.node_id) {
            Some(item) => {
                match (space.validate_node_read(context, node), of_item(&self.board, &view, &shared, *item)) {
                    (Err(status), _) => DataValue { status: Some(status), ..DataValue::default() },
                    (Ok(_), Some(value)) if !node.index_range.has_range() => DataValue::new_now(value),
                    (Ok(_), _) => DataValue { status: Some(StatusCode::BadIndexRangeNoData), ..DataValue::default() },
                }
            }
            None => space.read(context, node, max_age, timestamps),
        };
        nodes.iter().map(read).collect()
    }

    async fn create_value_monitored_items(
        &self,
        context: &RequestContext,
        space: &RwLock<AddressSpace>,
        items: &mut [&mut &mut CreateMonitoredItem],
    ) {
        // Watched before the first value is read: no change falls between.
        for item in items.iter().filter_map(|item| self.items.get(&item.item_to_monitor().node_id)) {
            self.board.watch(*item);
        }
        let asked: Vec<_> = items.iter().map(|item| item.item_to_monitor()).collect();
        let values = self.read_values(context, space, &asked, 0.0, TimestampsToReturn::Both).await;
        for (value, item) in values.into_iter().zip(items.iter_mut()) {
            match value.status {
                Some(status) if status.is_bad() => item.set_status(status),
                _ => {
                    item.set_initial_value(value);
                    item.revise_sampling_interval(EVERY_CHANGE_MS);
                    item.set_status(StatusCode::Good);
                }
            }
        }
    }

    async fn write(
        &self,
        context: &RequestContext,
        space: &RwLock<AddressSpace>,
        nodes: &mut [&mut WriteNode],
    ) -> Result<(), StatusCode> {
        for write in nodes {
            let item = self.items.get(&write.value().node_id).copied();
            let valid = {
                let mut space = space.write();
                let type_tree = context.type_tree.read();
                space.validate_node_write(context, write.value(), &*type_tree).map(|_| ())
            };
            let status = match (valid, item) {
                // A value of another type must not be left out in silence: see `Seat::spoil`.
                (Ok(()) | Err(StatusCode::BadTypeMismatch), Some(item)) => self.write_value(context, write, item),
                (Err(status), _) => status,
                (Ok(()), None) => StatusCode::BadNotWritable,
            };
            write.set_status(status);
        }
        Ok(())
    }

    async fn call(
        &self,
        context: &RequestContext,
        _space: &RwLock<AddressSpace>,
        calls: &mut [&mut &mut MethodCall],
    ) -> Result<(), StatusCode> {
        for call in calls {
            let status = match self.items.get(call.method_id()).copied() {
                Some(Item::Session(method)) => {
                    self.board.operated_by(Holder(context.session_id), self.is_gone(context));
                    call::operate(&self.board, method, call.arguments()).await
                }
                Some(Item::Seat(seat, number::TURN)) => {
                    let who = (Holder(context.session_id), self.is_gone(context));
                    match call::turn(&self.board, seat, who, call.arguments()).await {
                        Ok(given) => {
                            call.set_outputs(given);
                            StatusCode::Good
                        }
                        Err(status) => status,
                    }
                }
                _ => StatusCode::BadMethodInvalid,
            };
            call.set_status(status);
        }
        Ok(())
    }
}

/// Items are reported when they change, not sampled: a grant that is reported late holds all clients up.
const EVERY_CHANGE_MS: f64 = 0.001;
