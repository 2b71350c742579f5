//! The types of the information model: one table, from which the server's address space and the NodeSet are made.

/// The namespace of the types.
pub const NAMESPACE: &str = "urn:onescan:sdsp";
/// Version of the model.
pub const VERSION: &str = "0.1.0";
/// When this version of the model was published.
pub const PUBLICATION_DATE: &str = "2026-11-21T00:00:00Z";

/// A built-in data type, by its name and its number in namespace 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DataType {
    /// As in `UInt32`.
    pub name: &'static str,
    /// Its identifier.
    pub id: u32,
}

const BOOLEAN: DataType = DataType { name: "Boolean", id: 1 };
const UINT32: DataType = DataType { name: "UInt32", id: 7 };
const INT64: DataType = DataType { name: "Int64", id: 8 };
const UINT64: DataType = DataType { name: "UInt64", id: 9 };
const STRING: DataType = DataType { name: "String", id: 12 };

/// Who writes a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Writer {
    /// The server.
    Server,
    /// The client whose object it is.
    Client,
}

/// A variable of a type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VariableType {
    /// Its browse name.
    pub name: &'static str,
    /// Its data type.
    pub data_type: DataType,
    /// Who writes it.
    pub writer: Writer,
    /// What it means.
    pub about: &'static str,
}

/// A method without arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MethodType {
    /// Its browse name.
    pub name: &'static str,
    /// What it does.
    pub about: &'static str,
}

/// A folder for signals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FolderType {
    /// Its browse name.
    pub name: &'static str,
    /// What is in it.
    pub about: &'static str,
}

/// An object type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ObjectType {
    /// Its browse name.
    pub name: &'static str,
    /// Its identifier in the model's namespace; those of its parts follow.
    pub id: u32,
    /// What it is.
    pub about: &'static str,
    /// Its variables.
    pub variables: &'static [VariableType],
    /// Its methods.
    pub methods: &'static [MethodType],
    /// Its folders.
    pub folders: &'static [FolderType],
}

const fn variable(
    name: &'static str,
    data_type: DataType,
    writer: Writer,
    about: &'static str,
) -> VariableType {
    VariableType { name, data_type, writer, about }
}

/// The session.
pub const SESSION: ObjectType = ObjectType {
    name: "SdspSessionType",
    id: 1000,
    about: "A simulation in lockstep on one virtual time.",
    variables: &[
        variable("State", STRING, Writer::Server, "waiting, running, held or ended"),
        variable("VirtualTime", INT64, Writer::Server, "virtual time of the last step, ns"),
        variable("StepTime", INT64, Writer::Server, "smallest increment of virtual time, ns"),
        variable("Steps", UINT64, Writer::Server, "steps since the session's start"),
        variable("Held", BOOLEAN, Writer::Server, "true while virtual time is held"),
    ],
    methods: &[
        MethodType { name: "Start", about: "lets virtual time run, for all clients at once" },
        MethodType { name: "Stop", about: "ends the session at the next step boundary" },
        MethodType { name: "Pause", about: "holds virtual time at the next step boundary" },
        MethodType { name: "Step", about: "runs exactly one step, then holds" },
        MethodType { name: "Reset", about: "begins anew at virtual time 0; every client initialises" },
    ],
    folders: &[FolderType { name: "Clients", about: "the clients that take part over OPC UA" }],
};

/// A client.
pub const CLIENT: ObjectType = ObjectType {
    name: "SdspClientType",
    id: 2000,
    about: "A subsimulation that takes part in the session: reads its inputs when it is granted a turn, writes its \
            outputs, then says that it is done.",
    variables: &[
        variable("Grant", UINT32, Writer::Server, "number of the turn that is granted; 0 before the first"),
        variable("GrantTime", INT64, Writer::Server, "virtual time at the turn's end, ns; 0 asks for initial outputs"),
        variable("Done", UINT32, Writer::Client, "number of the turn that was done last; written behind the outputs"),
    ],
    methods: &[],
    folders: &[
        FolderType { name: "Inputs", about: "the signals that it reads; they stay until the turn is done" },
        FolderType { name: "Outputs", about: "the signals that it writes; they count when the turn is done" },
    ],
};

/// All object types.
pub const TYPES: [ObjectType; 2] = [SESSION, CLIENT];
