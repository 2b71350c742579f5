//! What the names of a project stand for, and how each is written in SCL.

use std::collections::{BTreeMap, BTreeSet};

use onescan_iec::ir::ElementaryType;
use onescan_iec::syntax::ast::{
    CompilationUnit, Declaration, EnumValue, Expr, Field, Ident, Pou, PouKind, Qualifier, Section, TypeDeclaration,
    TypeSpec, TypeSpecKind, Variable,
};
use onescan_iec::syntax::constant::{self, Constant, Constants};
use onescan_iec::syntax::{FileId, SourceMap};

/// The data block of global variables that have no block of their own.
pub(in crate::output) const GLOBALS: &str = "Globals";
/// The same of those that survive a restart.
pub(in crate::output) const RETAINED_GLOBALS: &str = "RetainedGlobals";

/// Function blocks that TIA Portal has, and its name where it is another.
const NATIVE: [(&str, &str); 21] = [
    ("TON", "TON_TIME"),
    ("TOF", "TOF_TIME"),
    ("TP", "TP_TIME"),
    ("TON_TIME", "TON_TIME"),
    ("TOF_TIME", "TOF_TIME"),
    ("TP_TIME", "TP_TIME"),
    ("TON_LTIME", "TON_LTIME"),
    ("TOF_LTIME", "TOF_LTIME"),
    ("TP_LTIME", "TP_LTIME"),
    ("LTON", "TON_LTIME"),
    ("LTOF", "TOF_LTIME"),
    ("LTP", "TP_LTIME"),
    ("R_TRIG", "R_TRIG"),
    ("F_TRIG", "F_TRIG"),
    ("CTU", "CTU_INT"),
    ("CTD", "CTD_INT"),
    ("CTUD", "CTUD_INT"),
    ("CTU_INT", "CTU_INT"),
    ("CTD_INT", "CTD_INT"),
    ("CTUD_INT", "CTUD_INT"),
    ("CTU_DINT", "CTU_DINT"),
];

/// TIA Portal's name of a standard function block.
pub(in crate::output) fn native(key: &str) -> Option<&'static str> {
    NATIVE.iter().find(|(name, _)| *name == key).map(|(_, new)| *new)
}

/// What a type comes to, behind aliases and subranges.
#[derive(Clone, Copy)]
pub(in crate::output) enum Shape<'a> {
    Elementary(ElementaryType),
    Text { wide: bool },
    Enumeration(ElementaryType),
    Structure(&'a [Field]),
    Array(&'a TypeSpec),
    Block(&'a Pou),
}

impl Shape<'_> {
    /// The type that holds a value of it.
    pub(in crate::output) fn elementary(self) -> Option<ElementaryType> {
        match self {
            Self::Elementary(ty) | Self::Enumeration(ty) => Some(ty),
            _ => None,
        }
    }
}

#[derive(Clone, Copy)]
pub(in crate::output) struct Global<'a> {
    pub(in crate::output) name: &'a Ident,
    pub(in crate::output) variable: &'a Variable,
    pub(in crate::output) is_constant: bool,
    pub(in crate::output) is_retained: bool,
}

/// A value of an enumeration.
#[derive(Clone, Copy)]
pub(in crate::output) struct EnumeratedValue<'a> {
    pub(in crate::output) of: &'a TypeDeclaration,
    pub(in crate::output) name: &'a Ident,
    pub(in crate::output) number: i128,
    pub(in crate::output) base: ElementaryType,
}

/// Whose blocks and types are written.
pub(in crate::output) type Rename<'r> = &'r dyn Fn(&str) -> Option<String>;

/// All names of a project.
pub(in crate::output) struct Names<'a> {
    pub(in crate::output) sources: &'a SourceMap,
    pub(in crate::output) units: BTreeMap<String, &'a Pou>,
    pub(in crate::output) types: BTreeMap<String, &'a TypeDeclaration>,
    pub(in crate::output) globals: BTreeMap<String, Global<'a>>,
    values: BTreeMap<String, Vec<EnumeratedValue<'a>>>,
    constants: Constants<'a>,
    /// Names that the shim gives to blocks, types and variables.
    rename: Rename<'a>,
    /// The files of the standard's and the shim's own blocks.
    library: &'a BTreeSet<FileId>,
}

impl<'a> Names<'a> {
    pub(in crate::output) fn new(
        sources: &'a SourceMap,
        units: &'a [(FileId, CompilationUnit)],
        library: &'a BTreeSet<FileId>,
        rename: Rename<'a>,
    ) -> Self {
        let mut names = Self {
            sources,
            units: BTreeMap::new(),
            types: BTreeMap::new(),
            globals: BTreeMap::new(),
            values: BTreeMap::new(),
            constants: Constants::new(),
            rename,
            library,
        };
        // What a project declares goes before what everybody has.
        let (own, of_library): (Vec<_>, Vec<_>) = units.iter().partition(|(file, _)| !library.contains(file));
        for (_, unit) in of_library.into_iter().chain(own) {
            unit.declarations.iter().for_each(|declaration| names.add(declaration));
        }
        names
    }

    fn add(&mut self, declaration: &'a Declaration) {
        match declaration {
            Declaration::Pou(pou) => {
                self.units.insert(pou.name.key(), pou);
            }
            Declaration::Type(named) => self.add_type(named),
            Declaration::Globals(section) => self.add_globals(section),
            Declaration::Configuration(configuration) => {
                configuration.all_sections().for_each(|section| self.add_globals(section));
            }
            Declaration::Namespace(_) | Declaration::Using(_) => {}
        }
    }

    fn add_type(&mut self, named: &'a TypeDeclaration) {
        self.types.insert(named.name.key(), named);
        let TypeSpecKind::Enumeration(values, base) = &named.spec.kind else { return };
        let base = base_of(base.as_ref());
        let mut next = 0;
        for value in values {
            let number = self.number(value).unwrap_or(next);
            next = number + 1;
            let value = EnumeratedValue { of: named, name: &value.name, number, base };
            self.values.entry(value.name.key()).or_default().push(value);
        }
    }

    fn number(&self, value: &EnumValue) -> Option<i128> {
        self.integer(value.value.as_ref()?)
    }

    fn add_globals(&mut self, section: &'a Section) {
        constant::note(section, &mut self.constants);
        let is_constant = section.qualifiers.contains(&Qualifier::Constant);
        let retains = |each: &Qualifier| matches!(each, Qualifier::Retain | Qualifier::Persistent);
        let is_retained = section.qualifiers.iter().any(retains);
        for variable in &section.variables {
            for name in &variable.names {
                self.globals.insert(name.key(), Global { name, variable, is_constant, is_retained });
            }
        }
    }

    /// True for what the project itself declares.
    pub(in crate::output) fn is_own(&self, file: FileId) -> bool {
        !self.library.contains(&file)
    }

    /// A constant expression's value, if the text determines it.
    pub(in crate::output) fn integer(&self, expr: &Expr) -> Option<i128> {
        integer(constant::value(expr, &self.constants)?)
    }

    /// The same in a unit that declares constants of its own.
    pub(in crate::output) fn integer_with(&self, expr: &Expr, own: &Constants<'_>) -> Option<i128> {
        if own.is_empty() {
            return self.integer(expr);
        }
        let mut all: Constants<'_> = self.constants.clone();
        all.extend(own.iter().map(|(key, value)| (key.clone(), *value)));
        integer(constant::value(expr, &all)?)
    }

    /// The value of an enumeration by its name; `of` is the enumeration, if it is named.
    pub(in crate::output) fn value(&self, key: &str, of: Option<&str>) -> Option<EnumeratedValue<'a>> {
        let mut all = self.values.get(key)?.iter();
        all.find(|value| of.is_none_or(|of| value.of.name.key() == of)).copied()
    }

    /// The program of this name.
    pub(in crate::output) fn program(&self, key: &str) -> Option<&'a Pou> {
        self.units.get(key).copied().filter(|pou| pou.kind == PouKind::Program)
    }

    /// What a type comes to; nothing if it is not known.
    pub(in crate::output) fn shape(&self, spec: &'a TypeSpec) -> Option<Shape<'a>> {
        match &spec.kind {
            TypeSpecKind::String(name, _) => Some(Shape::Text { wide: name.key() == "WSTRING" }),
            TypeSpecKind::Name(name) | TypeSpecKind::Subrange(name, _) => self.named_shape(name),
            TypeSpecKind::Array(_, element) | TypeSpecKind::OpenArray(_, element) => Some(Shape::Array(element)),
            _ => None,
        }
    }

    fn named_shape(&self, name: &Ident) -> Option<Shape<'a>> {
        let key = name.key();
        if let Some(named) = self.types.get(&key) {
            return match &named.spec.kind {
                TypeSpecKind::Struct(fields) => Some(Shape::Structure(fields)),
                TypeSpecKind::Enumeration(_, base) => Some(Shape::Enumeration(base_of(base.as_ref()))),
                // A checked project has no circles of aliases.
                _ => self.shape(&named.spec),
            };
        }
        match key.as_str() {
            "STRING" | "WSTRING" => Some(Shape::Text { wide: key == "WSTRING" }),
            _ => match ElementaryType::find(&key) {
                Some(ty) => Some(Shape::Elementary(ty)),
                None => self.units.get(&key).map(|pou| Shape::Block(pou)),
            },
        }
    }

    /// A block's or type's name as it stands in SCL.
    pub(in crate::output) fn block(&self, name: &str) -> String {
        let key = name.to_ascii_uppercase();
        if let Some(new) = (self.rename)(name) {
            return quoted(&new);
        }
        let declared = self.units.get(&key).map(|pou| &pou.name).or(self.types.get(&key).map(|named| &named.name));
        match declared {
            Some(declared) if !self.is_own(declared.span.file) => match native(&key) {
                Some(native) => native.to_owned(),
                None if is_left(&key) => declared.text.clone(),
                // The standard's own names are not names of blocks.
                None => quoted(&format!("IEC_{}", declared.text)),
            },
            Some(declared) => quoted(&declared.text),
            None => name.to_owned(),
        }
    }

    /// A global variable as it stands in SCL; constants are local ones there.
    pub(in crate::output) fn global(&self, key: &str) -> Option<String> {
        if let Some(new) = (self.rename)(key) {
            return Some(new);
        }
        let global = self.globals.get(key)?;
        let home = self.home(global);
        Some(match home {
            Some(home) => format!("{}.{}", quoted(home), member(&global.name.text)),
            None => quoted(&global.name.text),
        })
    }

    /// The data block that a global variable is a member of; nothing if it is one itself.
    pub(in crate::output) fn home(&self, global: &Global<'a>) -> Option<&'static str> {
        match self.shape(&global.variable.spec) {
            Some(Shape::Block(_)) => None,
            _ if global.is_retained => Some(RETAINED_GLOBALS),
            _ => Some(GLOBALS),
        }
    }
}

fn integer(value: Constant) -> Option<i128> {
    match value {
        Constant::Integer(value) => Some(value),
        Constant::Duration(_) => None,
    }
}

/// What holds a value of an enumeration with this base, or without one.
fn base_of(base: Option<&Ident>) -> ElementaryType {
    base.and_then(|base| ElementaryType::find(&base.text)).unwrap_or(ElementaryType::Int)
}

/// Blocks and types that instrumenting puts others in the place of.
pub(in crate::output) fn is_left(key: &str) -> bool {
    key.starts_with("MC_") || key == "AXIS_REF"
}

pub(in crate::output) fn quoted(name: &str) -> String {
    format!("\"{name}\"")
}

/// Words that are names in the standard and none in SCL.
const RESERVED: [&str; 24] = [
    "BEGIN",
    "BLOCK_DB",
    "BLOCK_FB",
    "BLOCK_FC",
    "COUNTER",
    "DATA_BLOCK",
    "DIV",
    "DTL",
    "GOTO",
    "LABEL",
    "NAME",
    "NIL",
    "ORGANIZATION_BLOCK",
    "POINTER",
    "REF_TO",
    "REGION",
    "END_REGION",
    "TIMER",
    "TITLE",
    "VARIANT",
    "VERSION",
    "VOID",
    "ANY",
    "S5TIME",
];

/// A member's or variable's name as it is declared, and behind a point.
pub(in crate::output) fn member(name: &str) -> String {
    if RESERVED.contains(&name.to_ascii_uppercase().as_str()) { quoted(name) } else { name.to_owned() }
}
