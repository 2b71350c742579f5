//! A node of an address space as data (OPC 10000-3): served and published by different rooms, described once.

/// The namespace of the types: the same in every server.
pub const TYPES_URI: &str = "urn:onescan:lockstep";
/// The namespace of one session's objects.
pub const SESSION_URI: &str = "urn:onescan:session";

/// Nodes of OPC UA itself that are referred to (OPC 10000-6 annex A).
pub mod core {
    pub const BOOLEAN: u32 = 1;
    pub const UINT32: u32 = 7;
    pub const INT64: u32 = 8;
    pub const UINT64: u32 = 9;
    pub const STRING: u32 = 12;
    pub const LOCALIZED_TEXT: u32 = 21;
    pub const BASE_DATA_TYPE: u32 = 24;
    pub const ENUMERATION: u32 = 29;
    pub const BASE_OBJECT_TYPE: u32 = 58;
    pub const FOLDER_TYPE: u32 = 61;
    pub const BASE_DATA_VARIABLE_TYPE: u32 = 63;
    pub const PROPERTY_TYPE: u32 = 68;
    pub const OBJECTS: u32 = 85;
    pub const ARGUMENT: u32 = 296;
}

/// The name of a node in its server.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Id {
    /// Of OPC UA itself.
    Core(u32),
    Type(u32),
    /// Of [`SESSION_URI`]: a path, as in `Clients/plant/Grant`.
    Instance(String),
}

/// The namespace of a browse name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    Core,
    Types,
    Session,
}

/// How a node hangs on its parent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// It is a subtype.
    HasSubtype,
    /// It is a part.
    HasComponent,
    /// It describes its parent.
    HasProperty,
    /// It lies in a folder.
    Organizes,
}

/// What a member of a type says of its instances (OPC 10000-3 6.4.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    Mandatory,
    /// Each has any number of such.
    OptionalPlaceholder,
}

/// One argument of a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Argument {
    pub name: &'static str,
    /// Its data type, of OPC UA itself.
    pub data_type: u32,
    /// True for a list.
    pub is_array: bool,
    pub about: &'static str,
}

/// What a variable holds from the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Value {
    /// What the session says.
    Live,
    /// A list of texts.
    Texts(&'static [&'static str]),
    /// Arguments of a method.
    Arguments(&'static [Argument]),
}

/// What a node is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A type of objects.
    ObjectType,
    /// An enumeration from 0.
    Enumeration(&'static [&'static str]),
    Object {
        of: Id,
    },
    Variable {
        /// Its type: a data variable or a property.
        of: u32,
        /// The type of its value.
        data_type: Id,
        /// True for a list.
        is_array: bool,
        /// True if a client may write it.
        is_writable: bool,
        value: Value,
    },
    Method,
}

/// A node and its reference to its parent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Node {
    /// Its name in the server.
    pub id: Id,
    /// The namespace of its browse name.
    pub space: Space,
    /// Its browse name, which is its display name too.
    pub name: String,
    /// What it means, for people.
    pub about: String,
    /// On which node it hangs.
    pub parent: Id,
    pub relation: Relation,
    pub kind: Kind,
    /// What it says of instances, for a member of a type.
    pub rule: Option<Rule>,
}
