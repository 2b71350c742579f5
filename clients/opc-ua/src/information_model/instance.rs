//! The objects of one session: its signals, its clients.
//!
//! Node ids are paths, the same in every run: `Session/State`, `Session/Signals/Strokes`, `Clients/plant/Grant`,
//! `Clients/plant/Inputs/Actuator_1_Up`.

use onescan_server::signal::SignalType;

use super::board::Board;
use super::item::Item;
use super::node::core::{BASE_DATA_VARIABLE_TYPE, OBJECTS};
use super::node::{Id, Kind, Node, Relation, Space, Value};
use super::types::{CLIENT, SESSION, members};
use crate::link::value;

/// A node, and what it stands for if its value lives.
pub struct Instance {
    pub node: Node,
    /// What it stands for.
    pub item: Option<Item>,
}

/// All objects of the session on `board`, parents before children.
pub fn nodes(board: &Board) -> Vec<Instance> {
    let mut all = Vec::new();
    let root = Id::Instance("Session".to_owned());
    all.push(object(&root, "Session", &Id::Core(OBJECTS), SESSION.number, SESSION.about));
    let inner = |path: &str| match path {
        // Clients have short names: they are what others look for.
        "Clients" => "Clients".to_owned(),
        path => format!("Session/{path}"),
    };
    for node in members(&SESSION, &root, None, &|_, path| Id::Instance(inner(path))) {
        let item = numbered(&SESSION, &node).map(Item::Session);
        all.push(Instance { node, item });
    }
    for (index, signal) in board.plan().signals().iter().enumerate() {
        let (path, folder) = (format!("Session/Signals/{}", signal.name), "Session/Signals");
        let node = variable(&path, signal.name.as_str(), folder, signal.ty, false);
        all.push(Instance { node, item: Some(Item::Signal(index)) });
    }
    let seats = board.lock().seats.len();
    for seat in 0..seats {
        add_seat(&mut all, board, seat);
    }
    all
}

fn add_seat(all: &mut Vec<Instance>, board: &Board, seat: usize) {
    let shared = board.lock();
    let place = &shared.seats[seat];
    let path = format!("Clients/{}", place.name);
    let root = Id::Instance(path.clone());
    let clients = Id::Instance("Clients".to_owned());
    let mut own = object(&root, place.name.as_str(), &clients, CLIENT.number, CLIENT.about);
    own.node.relation = Relation::Organizes;
    all.push(own);
    for node in members(&CLIENT, &root, None, &|_, name| Id::Instance(format!("{path}/{name}"))) {
        let item = numbered(&CLIENT, &node).map(|number| Item::Seat(seat, number));
        all.push(Instance { node, item });
    }
    let item: [fn(usize, usize) -> Item; 2] = [Item::Input, Item::Output];
    for ((name, layout), item) in [("Inputs", &place.inputs), ("Outputs", &place.outputs)].into_iter().zip(item) {
        let folder = format!("{path}/{name}");
        for (index, port) in layout.ports().iter().enumerate() {
            let path = format!("{folder}/{}", port.name);
            let node = variable(&path, port.name.as_str(), &folder, port.ty, name == "Outputs");
            all.push(Instance { node, item: Some(item(seat, index)) });
        }
    }
}

/// The number of the member that `node` is an instance of, if it is a variable or a method.
fn numbered(of: &super::types::ObjectType, node: &Node) -> Option<u32> {
    let variables = of.variables.iter().map(|variable| (variable.name, variable.number));
    let methods = of.methods.iter().map(|method| (method.name, method.number));
    let is_own = node.relation == Relation::HasComponent;
    variables.chain(methods).find(|(name, _)| is_own && *name == node.name).map(|(_, number)| number)
}

fn object(id: &Id, name: &str, parent: &Id, of: u32, about: &str) -> Instance {
    let (id, parent, relation) = (id.clone(), parent.clone(), Relation::Organizes);
    let (space, name, about, kind) =
        (Space::Session, name.to_owned(), about.to_owned(), Kind::Object { of: Id::Type(of) });
    Instance { node: Node { id, space, name, about, parent, relation, kind, rule: None }, item: None }
}

fn variable(path: &str, name: &str, folder: &str, ty: SignalType, is_writable: bool) -> Node {
    let data_type = Id::Core(value::data_type(ty) as u32);
    Node {
        id: Id::Instance(path.to_owned()),
        space: Space::Session,
        name: name.to_owned(),
        about: ty.to_string(),
        parent: Id::Instance(folder.to_owned()),
        relation: Relation::Organizes,
        kind: Kind::Variable {
            of: BASE_DATA_VARIABLE_TYPE,
            data_type,
            is_array: false,
            is_writable,
            value: Value::Live,
        },
        rule: None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::item::number;
    use super::*;
    use crate::information_model::types;

    /// Names in the table of numbers are those of the tables of types.
    #[test]
    fn numbers_are_those_of_the_types() {
        let named = |number: u32| types::nodes().into_iter().find(|node| node.id == Id::Type(number)).unwrap().name;
        let numbers = [number::DIGEST, number::RELEASE, number::GRANT_TIME, number::DONE, number::FAULT, number::TURN];
        assert_eq!(numbers.map(named), ["Digest", "Release", "GrantTime", "Done", "Fault", "Turn"]);
        let numbers = [number::SESSION_STATE, number::CLIENT_STATE, number::CLIENT_START, number::START, number::WAKE];
        assert_eq!(numbers.map(named), ["State", "State", "Start", "Start", "Wake"]);
    }
}
