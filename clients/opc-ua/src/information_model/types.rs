//! The types of the model, as tables (`docs/opcua.md` says the same for people).
//!
//! The numbers are part of the model's contract: one that is in use keeps its meaning for ever.

use super::node::core::{
    ARGUMENT, BASE_DATA_TYPE, BASE_DATA_VARIABLE_TYPE, BASE_OBJECT_TYPE, BOOLEAN, ENUMERATION, FOLDER_TYPE, INT64,
    LOCALIZED_TEXT, PROPERTY_TYPE, STRING, UINT32, UINT64,
};
use super::node::{Argument, Id, Kind, Node, Relation, Rule, Space, Value};

/// A variable of an object type.
#[derive(Clone, Copy, Debug)]
pub struct VariableType {
    pub number: u32,
    pub name: &'static str,
    /// The type of its value.
    pub data: Data,
    /// True for a list.
    pub is_array: bool,
    /// True if a client may write it.
    pub is_writable: bool,
    pub about: &'static str,
}

/// The type of a variable's value.
#[derive(Clone, Copy, Debug)]
pub enum Data {
    /// One of OPC UA itself.
    Core(u32),
    /// One of this model.
    Own(u32),
}

impl Data {
    /// Its node.
    pub fn id(self) -> Id {
        match self {
            Self::Core(number) => Id::Core(number),
            Self::Own(number) => Id::Type(number),
        }
    }
}

/// A method of an object type. Its arguments have the two numbers behind its own.
#[derive(Clone, Copy, Debug)]
pub struct MethodType {
    pub number: u32,
    pub name: &'static str,
    pub inputs: &'static [Argument],
    pub outputs: &'static [Argument],
    pub about: &'static str,
}

/// A folder of an object type.
#[derive(Clone, Copy, Debug)]
pub struct FolderOf {
    pub number: u32,
    pub name: &'static str,
    /// What lies in it.
    pub about: &'static str,
}

#[derive(Clone, Copy, Debug)]
pub struct ObjectType {
    pub number: u32,
    pub name: &'static str,
    /// What its objects are.
    pub about: &'static str,
    pub variables: &'static [VariableType],
    pub methods: &'static [MethodType],
    pub folders: &'static [FolderOf],
}

const SESSION_STATE: u32 = 3001;
const CLIENT_STATE: u32 = 3003;

/// States of a session (`[SDSP]` Fig. 8), and its end.
pub const SESSION_STATES: [&str; 7] = ["Start", "InitialWrite", "PreRead", "Read", "PreWrite", "Write", "Ended"];
/// States of a client (`[SDSP]` Fig. 9), and its end.
pub const CLIENT_STATES: [&str; 7] = ["Start", "Setup", "Ready", "Read", "Run", "Write", "Ended"];

const fn variable(number: u32, name: &'static str, data: Data, about: &'static str) -> VariableType {
    VariableType { number, name, data, is_array: false, is_writable: false, about }
}

const fn writable(number: u32, name: &'static str, data: Data, about: &'static str) -> VariableType {
    VariableType { number, name, data, is_array: false, is_writable: true, about }
}

const fn names(number: u32, name: &'static str, about: &'static str) -> VariableType {
    VariableType { number, name, data: Data::Core(STRING), is_array: true, is_writable: false, about }
}

const fn command(number: u32, name: &'static str, about: &'static str) -> MethodType {
    MethodType { number, name, inputs: &[], outputs: &[], about }
}

const fn argument(name: &'static str, data_type: u32, about: &'static str) -> Argument {
    Argument { name, data_type, is_array: false, about }
}

const SIGNAL: Argument = argument("Signal", STRING, "Name of the signal");
const VALUE: Argument = argument("Value", STRING, "Its value as text, as in `TRUE` or `-1.5`");

/// A session: one virtual time, all clients.
pub const SESSION: ObjectType = ObjectType {
    number: 1001,
    name: "LockstepSessionType",
    about: "A simulation whose clients take each step of one virtual time together",
    variables: &[
        variable(2001, "State", Data::Own(SESSION_STATE), "State of the session"),
        variable(2002, "VirtualTime", Data::Core(INT64), "Virtual time t_v of the last committed step, in ns"),
        variable(2003, "TimeStep", Data::Core(INT64), "Smallest increment of virtual time t_step, in ns"),
        variable(2004, "StepCount", Data::Core(UINT64), "Steps committed since the start or the last reset"),
        variable(2005, "Held", Data::Core(BOOLEAN), "TRUE while virtual time is held"),
        variable(2006, "Digest", Data::Core(STRING), "Hash over all signals of all steps so far"),
        variable(2007, "End", Data::Core(STRING), "How the session ended, in words; empty while it goes on"),
    ],
    methods: &[
        command(4001, "Start", "Lets virtual time run, at first and after Pause"),
        command(4004, "Stop", "Ends the session for all clients"),
        command(4007, "Pause", "Holds virtual time at the next step"),
        command(4010, "Step", "Runs exactly one step, then holds"),
        command(4013, "Reset", "Restarts at t_v = 0; every client initialises again"),
        MethodType {
            number: 4016,
            name: "Write",
            inputs: &[SIGNAL, VALUE],
            outputs: &[],
            about: "Gives a signal a value until its writer writes it again",
        },
        MethodType {
            number: 4019,
            name: "Force",
            inputs: &[SIGNAL, VALUE],
            outputs: &[],
            about: "Holds a signal at a value, whatever its writer writes",
        },
        MethodType {
            number: 4022,
            name: "Release",
            inputs: &[SIGNAL],
            outputs: &[],
            about: "Lets the writer of a forced signal write it again",
        },
    ],
    folders: &[
        FolderOf { number: 5001, name: "Clients", about: "The clients that take part through this model" },
        FolderOf { number: 5002, name: "Signals", about: "All signals of the session as of the last committed step" },
    ],
};

/// A client's place in a session.
pub const CLIENT: ObjectType = ObjectType {
    number: 1002,
    name: "LockstepClientType",
    about: "The place of one client: what it reads, what it writes, its grant and its answer",
    variables: &[
        variable(2101, "State", Data::Own(CLIENT_STATE), "State of the client"),
        variable(2102, "Period", Data::Core(INT64), "Virtual time that one turn covers, in ns"),
        writable(2103, "Start", Data::Core(BOOLEAN), "The client writes TRUE when it is ready to start"),
        variable(2104, "Grant", Data::Core(UINT64), "Number of the last grant; 0 before the first, never smaller"),
        variable(
            2105,
            "GrantTime",
            Data::Core(INT64),
            "Virtual time t_v at the end of the granted turn, in ns; 0 asks for the initial state",
        ),
        writable(
            2106,
            "Wake",
            Data::Core(INT64),
            "Virtual time of the next turn wanted, in ns; 0 for one period later. Taken with Done, then 0 again",
        ),
        writable(
            2107,
            "Done",
            Data::Core(UINT64),
            "The client writes the number of the grant that it has run, after its outputs",
        ),
        writable(2108, "Fault", Data::Core(STRING), "The client writes why it cannot go on; the session ends for all"),
        names(2109, "InputOrder", "Names of the inputs in the order of the method Turn"),
        names(2110, "OutputOrder", "Names of the outputs in the order of the method Turn"),
    ],
    methods: &[MethodType {
        number: 4101,
        name: "Turn",
        inputs: &[
            argument("Done", UINT64, "Number of the grant that is answered; 0 for none"),
            argument("Wake", INT64, "As the variable Wake"),
            Argument {
                name: "Outputs",
                data_type: BASE_DATA_TYPE,
                is_array: true,
                about: "All outputs in their order; empty for none",
            },
            argument("Patience", UINT32, "How long to wait for the next grant, in ms of the wall clock"),
        ],
        outputs: &[
            argument("State", UINT32, "State of the client"),
            argument("Grant", UINT64, "Number of the grant under way, or of the last"),
            argument("GrantTime", INT64, "As the variable GrantTime"),
            Argument { name: "Inputs", data_type: BASE_DATA_TYPE, is_array: true, about: "All inputs in their order" },
        ],
        about: "Start, answer and the wait for the next grant in one call",
    }],
    folders: &[
        FolderOf { number: 5101, name: "Inputs", about: "The signals that the client reads, as of its grant" },
        FolderOf { number: 5102, name: "Outputs", about: "The signals that the client writes; they count with Done" },
    ],
};

/// All types and their members, parents before children.
pub fn nodes() -> Vec<Node> {
    let mut nodes = Vec::new();
    let states = "States as in Carlsson et al. 2012";
    enumeration(&mut nodes, SESSION_STATE, "LockstepSessionState", &format!("{states}, Fig. 8"), &SESSION_STATES);
    enumeration(&mut nodes, CLIENT_STATE, "LockstepClientState", &format!("{states}, Fig. 9"), &CLIENT_STATES);
    for of in [&SESSION, &CLIENT] {
        object_type(&mut nodes, of);
    }
    let client = Kind::Object { of: Id::Type(CLIENT.number) };
    placeholder(&mut nodes, (5003, SESSION.folders[0].number), "<Client>", client);
    for (numbers, name, is_writable) in
        [((5004, 5002), "<Signal>", false), ((5103, 5101), "<Input>", false), ((5104, 5102), "<Output>", true)]
    {
        let data_type = Id::Core(BASE_DATA_TYPE);
        let (of, is_array, value) = (BASE_DATA_VARIABLE_TYPE, false, Value::Live);
        placeholder(&mut nodes, numbers, name, Kind::Variable { of, data_type, is_array, is_writable, value });
    }
    nodes
}

fn enumeration(nodes: &mut Vec<Node>, number: u32, name: &str, about: &str, fields: &'static [&'static str]) {
    nodes.push(Node {
        id: Id::Type(number),
        space: Space::Types,
        name: name.to_owned(),
        about: about.to_owned(),
        parent: Id::Core(ENUMERATION),
        relation: Relation::HasSubtype,
        kind: Kind::Enumeration(fields),
        rule: None,
    });
    let texts = (Id::Core(LOCALIZED_TEXT), Value::Texts(fields));
    nodes.push(property(Id::Type(number + 1), "EnumStrings", Id::Type(number), texts, None));
}

fn object_type(nodes: &mut Vec<Node>, of: &ObjectType) {
    nodes.push(Node {
        id: Id::Type(of.number),
        space: Space::Types,
        name: of.name.to_owned(),
        about: of.about.to_owned(),
        parent: Id::Core(BASE_OBJECT_TYPE),
        relation: Relation::HasSubtype,
        kind: Kind::ObjectType,
        rule: None,
    });
    nodes.extend(members(of, &Id::Type(of.number), Some(Rule::Mandatory), &|number, _| Id::Type(number)));
}

/// The members of an object of type `of` that hangs on `parent`; `id` names them by number and path.
pub fn members(of: &ObjectType, parent: &Id, rule: Option<Rule>, id: &dyn Fn(u32, &str) -> Id) -> Vec<Node> {
    let mut nodes = Vec::new();
    let member = |number: u32, name: &str, about: &str, kind: Kind| Node {
        id: id(number, name),
        space: Space::Types,
        name: name.to_owned(),
        about: about.to_owned(),
        parent: parent.clone(),
        relation: Relation::HasComponent,
        kind,
        rule,
    };
    for VariableType { number, name, data, is_array, is_writable, about } in of.variables {
        let (of, data_type, is_array, value) = (BASE_DATA_VARIABLE_TYPE, data.id(), *is_array, Value::Live);
        let kind = Kind::Variable { of, data_type, is_array, is_writable: *is_writable, value };
        nodes.push(member(*number, name, about, kind));
    }
    for MethodType { number, name, inputs, outputs, about } in of.methods {
        nodes.push(member(*number, name, about, Kind::Method));
        for (step, place, arguments) in [(1, "InputArguments", inputs), (2, "OutputArguments", outputs)] {
            if !arguments.is_empty() {
                let own = id(number + step, &format!("{name}/{place}"));
                let value = (Id::Core(ARGUMENT), Value::Arguments(arguments));
                nodes.push(property(own, place, id(*number, name), value, rule));
            }
        }
    }
    for FolderOf { number, name, about } in of.folders {
        nodes.push(member(*number, name, about, Kind::Object { of: Id::Core(FOLDER_TYPE) }));
    }
    nodes
}

fn property(id: Id, name: &str, parent: Id, (data_type, value): (Id, Value), rule: Option<Rule>) -> Node {
    let (of, is_array, is_writable) = (PROPERTY_TYPE, true, false);
    let kind = Kind::Variable { of, data_type, is_array, is_writable, value };
    let (space, relation, about) = (Space::Core, Relation::HasProperty, String::new());
    Node { id, space, name: name.to_owned(), about, parent, relation, kind, rule }
}

fn placeholder(nodes: &mut Vec<Node>, (number, folder): (u32, u32), name: &str, kind: Kind) {
    nodes.push(Node {
        id: Id::Type(number),
        space: Space::Types,
        name: name.to_owned(),
        about: String::new(),
        parent: Id::Type(folder),
        relation: Relation::Organizes,
        kind,
        rule: Some(Rule::OptionalPlaceholder),
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_used_once_and_every_parent_comes_first() {
        let mut seen = Vec::new();
        for node in nodes() {
            assert!(!seen.contains(&node.id), "{:?} twice", node.id);
            assert!(
                matches!(node.parent, Id::Core(_)) || seen.contains(&node.parent),
                "{} hangs in the air",
                node.name
            );
            seen.push(node.id);
        }
    }
}
