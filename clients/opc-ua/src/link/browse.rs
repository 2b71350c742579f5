//! The variables that a server has.

use opcua::client::Session;
use opcua::types::{
    AttributeId, BrowseDescription, BrowseDirection, BrowseResult, NodeClass, NodeClassMask, NodeId, ObjectId,
    ReadValueId, ReferenceDescription, ReferenceTypeId, TimestampsToReturn, Variant,
};

use super::connection::lost;
use super::value;
use onescan_links::gateway::fault::LinkFault;
use onescan_links::gateway::link::Found;

/// Nodes that are looked at before it is enough.
const NODES_MAX: usize = 50_000;
/// How deep objects may lie in objects.
const DEPTH_MAX: u32 = 16;
/// Nodes of one request.
const AT_ONCE: usize = 100;

/// All variables below Objects but those of the server itself, in the order in which the server names them.
///
/// # Errors
/// The connection is gone.
pub async fn variables(session: &Session) -> Result<Vec<Found>, LinkFault> {
    let mut seen = std::collections::BTreeSet::new();
    let mut level: Vec<NodeId> = vec![ObjectId::ObjectsFolder.into()];
    let mut found = Vec::new();
    for _ in 0..DEPTH_MAX {
        let mut next = Vec::new();
        for reference in references(session, &level).await? {
            let id = reference.node_id.node_id.clone();
            if id.namespace == 0 || seen.len() >= NODES_MAX || !seen.insert(id.to_string()) {
                continue;
            }
            if reference.node_class == NodeClass::Variable {
                found.push((id.clone(), reference.browse_name.name.to_string()));
            }
            next.push(id);
        }
        if next.is_empty() {
            break;
        }
        level = next;
    }
    described(session, found).await
}

async fn references(session: &Session, nodes: &[NodeId]) -> Result<Vec<ReferenceDescription>, LinkFault> {
    let describe = |node_id: &NodeId| BrowseDescription {
        node_id: node_id.clone(),
        browse_direction: BrowseDirection::Forward,
        reference_type_id: ReferenceTypeId::HierarchicalReferences.into(),
        include_subtypes: true,
        node_class_mask: (NodeClassMask::OBJECT | NodeClassMask::VARIABLE).bits(),
        result_mask: 0x3f,
    };
    let mut all = Vec::new();
    for nodes in nodes.chunks(AT_ONCE) {
        let asked: Vec<_> = nodes.iter().map(describe).collect();
        let mut results = session.browse(&asked, 0, None).await.map_err(|error| lost(&error))?;
        while !results.is_empty() {
            let rest: Vec<_> = results.iter().map(|result| result.continuation_point.clone()).collect();
            let rest: Vec<_> = rest.into_iter().filter(|point| !point.is_null_or_empty()).collect();
            let taken = |result: BrowseResult| result.references.unwrap_or_default();
            all.extend(results.into_iter().flat_map(taken));
            if rest.is_empty() || all.len() > NODES_MAX {
                break;
            }
            results = session.browse_next(false, &rest).await.map_err(|error| lost(&error))?;
        }
    }
    Ok(all)
}

/// Types and access of what was found; what is not a scalar of IEC 61131-3 has no type.
async fn described(session: &Session, found: Vec<(NodeId, String)>) -> Result<Vec<Found>, LinkFault> {
    let mut all = Vec::new();
    for found in found.chunks(AT_ONCE) {
        let asked = found.iter().flat_map(|(id, _)| {
            [AttributeId::Value, AttributeId::UserAccessLevel].map(|attribute| ReadValueId::new(id.clone(), attribute))
        });
        let asked: Vec<_> = asked.collect();
        let values = session.read(&asked, TimestampsToReturn::Neither, 0.0).await.map_err(|error| lost(&error))?;
        for ((id, name), values) in found.iter().zip(values.chunks(2)) {
            let ty = values[0].value.as_ref().and_then(value::elementary);
            let is_writable =
                matches!(values.get(1).and_then(|v| v.value.as_ref()), Some(Variant::Byte(level)) if level & 2 != 0);
            all.push(Found { name: name.clone(), address: id.to_string(), ty, is_writable });
        }
    }
    Ok(all)
}
