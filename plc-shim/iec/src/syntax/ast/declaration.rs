//! Declarations of units, types and variables (2nd ed. 2.3 to 2.5).

use super::{Argument, Chart, Configuration, Expr, Ident, Modifier, Namespace, Object, Span, Statement};

/// What the input of an organization block is called that is TRUE in its first call, in capitals.
pub const INITIAL_CALL: &str = "INITIAL_CALL";

/// Something a file declares.
#[derive(Debug, Clone)]
pub enum Declaration {
    /// A program organisation unit.
    Pou(Pou),
    /// One type of a `TYPE` block.
    Type(TypeDeclaration),
    Globals(Section),
    /// A namespace and what it declares.
    Namespace(Namespace),
    /// `USING a.b;`, for the rest of the file.
    Using(Vec<Ident>),
    Configuration(Configuration),
}

/// The kinds of program organisation unit (2nd ed. 2.5).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PouKind {
    Program,
    FunctionBlock,
    Function,
    /// `CLASS` (3rd ed. 6.6.5)
    Class,
    /// `INTERFACE` (3rd ed. 6.6.6)
    Interface,
    /// `METHOD` and the two halves of a `PROPERTY`.
    Method,
    /// `ACTION`: statements that work on the variables of their unit.
    Action,
}

impl PouKind {
    /// True for what starts over in every call: functions and methods.
    pub fn keeps_nothing(self) -> bool {
        matches!(self, Self::Function | Self::Method | Self::Action)
    }

    /// True for what variables can be instances of.
    pub fn has_instances(self) -> bool {
        matches!(self, Self::FunctionBlock | Self::Class)
    }
}

/// A program organisation unit.
#[derive(Debug, Clone)]
pub struct Pou {
    pub kind: PouKind,
    pub name: Ident,
    /// The type of a function's result.
    pub result: Option<TypeSpec>,
    pub sections: Vec<Section>,
    pub body: Vec<Statement>,
    /// Its steps and transitions.
    pub chart: Chart,
    /// Its bases and methods.
    pub object: Object,
    /// True behind `{external}`: declared here, and done elsewhere.
    pub external: bool,
    pub span: Span,
}

/// The kinds of variable section (2nd ed. Table 16).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SectionKind {
    Local,
    Input,
    Output,
    InOut,
    Temp,
    /// `VAR_STAT`: one variable for all instances and calls (vendors).
    Static,
    /// `VAR_INST` of a method: kept in its instance (vendors).
    Instance,
    Global,
    External,
}

/// What may stand behind a section's keyword.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Qualifier {
    Constant,
    Retain,
    NonRetain,
    /// `PUBLIC`, `PROTECTED`, `PRIVATE` or `INTERNAL` (3rd ed. 6.6.5.10).
    Access(Modifier),
    Persistent,
    /// `VAR_GENERIC`, of vendors: whoever declares an instance gives the values.
    Generic,
}

/// `VAR .. END_VAR` of any kind.
#[derive(Debug, Clone)]
pub struct Section {
    pub kind: SectionKind,
    /// What stands behind its keyword.
    pub qualifiers: Vec<Qualifier>,
    pub variables: Vec<Variable>,
    pub span: Span,
}

impl Section {
    /// True for the constants of a generic block.
    pub fn is_generic(&self) -> bool {
        self.qualifiers.contains(&Qualifier::Generic)
    }
}

/// `a, b AT %MW1 : INT := 5;`
#[derive(Debug, Clone)]
pub struct Variable {
    /// The names, at least one.
    pub names: Vec<Ident>,
    /// The direct address, as written; or, in SCL, the name of the variable whose memory it looks at.
    pub address: Option<Ident>,
    pub spec: TypeSpec,
    /// `R_EDGE` or `F_EDGE` behind the type.
    pub edge: Option<Edge>,
    pub initial: Option<Initialiser>,
}

impl Variable {
    /// The variable whose memory this one looks at: `b AT a : DWORD` of SCL.
    pub fn viewed(&self) -> Option<&Ident> {
        self.address.as_ref().filter(|address| !address.text.starts_with('%'))
    }
}

/// What of an input its unit sees (2nd ed. 2.5.2.2, Table 33).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edge {
    Rising,
    Falling,
}

/// A type as written.
#[derive(Debug, Clone)]
pub struct TypeSpec {
    pub kind: TypeSpecKind,
    pub span: Span,
}

/// The forms of a type.
#[derive(Debug, Clone)]
pub enum TypeSpecKind {
    /// A name of an elementary, a derived or a function block type.
    Name(Ident),
    /// `STRING[80]`, of which only the name and length are kept.
    String(Ident, Option<Box<Expr>>),
    Subrange(Ident, Box<Subrange>),
    /// `ARRAY [0..9, 1..2] OF INT`
    Array(Vec<Dimension>, Box<TypeSpec>),
    /// `REF_TO INT`, `POINTER TO INT`, `REFERENCE TO INT`
    Reference(ReferenceKind, Box<TypeSpec>),
    /// `ARRAY [*, *] OF INT`: so many dimensions whose bounds come with the argument
    OpenArray(u32, Box<TypeSpec>),
    /// `UNION .. END_UNION` of vendors
    Union(Vec<Field>),
    /// `STRUCT .. END_STRUCT`, in a `TYPE` block only.
    Struct(Vec<Field>),
    /// `STRUCT OVERLAP .. END_STRUCT`: members with addresses may share bytes (3rd ed. Table 11)
    Overlapping(Vec<Field>),
    /// `FB(a := 1)`, `FB[(a := 1), (a := 2)]`: instances of vendors, and what their `FB_init` is given
    Instance(Ident, InitArguments),
    /// `(Red, Green := 5)`, `(Red, Green) USINT` or `USINT (Red, Green)`
    Enumeration(Vec<EnumValue>, Option<Ident>),
    /// Text that is not a type; a diagnostic has been given.
    Error,
}

/// What `FB_init` is given where instances are declared (CODESYS, TwinCAT).
#[derive(Debug, Clone)]
pub enum InitArguments {
    /// `(a := 1)`: each instance the same.
    Same(Vec<Argument>),
    /// `[(a := 1), (a := 2)]`: the instances of an array in their order.
    Listed(Vec<Vec<Argument>>),
}

impl InitArguments {
    /// Every value that is given.
    pub fn values(&self) -> impl Iterator<Item = &Expr> {
        let lists = match self {
            Self::Same(arguments) => std::slice::from_ref(arguments),
            Self::Listed(lists) => lists,
        };
        lists.iter().flatten().filter_map(|argument| match argument {
            Argument::Positional(value) | Argument::Input(_, value) => Some(value),
            Argument::Output { target, .. } => target.as_ref(),
        })
    }
}

/// How a type refers to another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ReferenceKind {
    /// `REF_TO` (3rd ed. 6.4.4.10)
    RefTo,
    /// `POINTER TO`, of vendors
    Pointer,
    /// `REFERENCE TO`, of vendors: its uses stand for what it refers to
    Reference,
}

impl ReferenceKind {
    /// Its spelling.
    pub fn text(self) -> &'static str {
        match self {
            Self::RefTo => "REF_TO",
            Self::Pointer => "POINTER TO",
            Self::Reference => "REFERENCE TO",
        }
    }
}

/// Bounds of a subrange type.
#[derive(Debug, Clone)]
pub struct Subrange {
    pub low: Expr,
    pub high: Expr,
}

/// Bounds of one dimension of an array.
#[derive(Debug, Clone)]
pub struct Dimension {
    pub low: Expr,
    pub high: Expr,
}

/// A member of a structure.
#[derive(Debug, Clone)]
pub struct Field {
    pub name: Ident,
    /// Where it lies in its structure, as written: `%B4`, `%X3.0`.
    pub address: Option<Ident>,
    pub spec: TypeSpec,
    pub initial: Option<Initialiser>,
}

/// A value of an enumeration.
#[derive(Debug, Clone)]
pub struct EnumValue {
    pub name: Ident,
    /// Its number (3rd ed. Table 11).
    pub value: Option<Expr>,
}

/// One type of a `TYPE` block.
#[derive(Debug, Clone)]
#[expect(clippy::struct_excessive_bools, reason = "each is a pragma of its own, and any may stand beside any other")]
pub struct TypeDeclaration {
    pub name: Ident,
    /// The structure that it adds members to, as vendors have it.
    pub extends: Option<Ident>,
    /// True behind `{external}`.
    pub external: bool,
    /// True behind `{attribute 'qualified_only'}`: the values of an enumeration are known behind its name.
    pub qualified_only: bool,
    /// True behind `{attribute 'to_string'}`: the text of an enumeration's value is its name.
    pub shows_names: bool,
    /// True behind `{attribute 'strict'}`: an enumeration takes its own values only.
    pub is_strict: bool,
    /// Behind `{attribute 'pack_mode' := '1'}`: most bytes that the members of a structure are aligned to.
    pub packing: Option<u32>,
    pub spec: TypeSpec,
    /// The initial value of its variables.
    pub initial: Option<Initialiser>,
    pub span: Span,
}

#[derive(Debug, Clone)]
pub struct Initialiser {
    pub kind: InitialiserKind,
    pub span: Span,
}

/// The forms of an initial value.
#[derive(Debug, Clone)]
pub enum InitialiserKind {
    Value(Expr),
    /// `[1, 2, 3(0)]`
    Array(Vec<Initialiser>),
    /// `3(0)` within an array
    Repeat(Box<Expr>, Option<Box<Initialiser>>),
    /// `(a := 1, b := 2)`
    Struct(Vec<StructureInit>),
    /// `a[1] := 5; a[2].b := 6;` behind BEGIN of a data block in SCL: some elements of an array
    Elements(Vec<ElementInit>),
}

/// One element of an array's start values.
#[derive(Debug, Clone)]
pub struct ElementInit {
    pub indices: Vec<Expr>,
    pub value: Initialiser,
}

/// One member of a structure's initial value.
#[derive(Debug, Clone)]
pub struct StructureInit {
    pub name: Ident,
    pub value: Initialiser,
}
