//! What the files declare, by name, as far as an inference needs it.

use std::collections::{BTreeMap, BTreeSet};

use super::ty::Ty;
use onescan_iec::check::{find_key, is_library_name, is_list, joined, knows_function, short_inside};
use onescan_iec::syntax::ast::{
    CompilationUnit, Declaration, EnumValue, Ident, MemberKind, Namespace, NamespaceKind, Pou, PouKind, Section,
    SectionKind, TypeDeclaration, TypeSpec, TypeSpecKind,
};
use onescan_iec::syntax::{FileId, SourceFile, SourceMap, Span};
use onescan_iec::{Dialect, ElementaryType, WordSize};

/// From where names are seen.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Home {
    pub(super) namespace: String,
    pub(super) using: Vec<String>,
    /// The namespace without the open ones that it begins with, as the check has it.
    short: Option<String>,
}

/// Full keys of what is known without its namespace, by the keys that it is known by.
#[derive(Debug, Default)]
struct OpenNames {
    units: BTreeMap<String, String>,
    types: BTreeMap<String, String>,
    globals: BTreeMap<String, String>,
}

impl OpenNames {
    fn note(map: &mut BTreeMap<String, String>, home: &Home, name: &Ident, key: &str) {
        if let Some(short) = &home.short {
            map.entry(joined(short, &name.key())).or_insert_with(|| key.to_owned());
        }
    }
}

/// A unit, and its parts by name.
#[derive(Debug)]
pub(super) struct Unit<'a> {
    pub(super) pou: &'a Pou,
    pub(super) home: Home,
    pub(super) variables: BTreeMap<String, (&'a TypeSpec, SectionKind)>,
    pub(super) members: BTreeMap<(Part, String), &'a Pou>,
    pub(super) library: bool,
}

/// What a member is to a caller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Part {
    Method,
    Property,
}

/// A type of a `TYPE` block.
#[derive(Debug)]
pub(super) struct Named<'a> {
    pub(super) ast: &'a TypeDeclaration,
    pub(super) home: Home,
}

/// Everything that is declared.
#[derive(Debug)]
pub(super) struct World<'a> {
    pub(super) units: BTreeMap<String, Unit<'a>>,
    pub(super) types: BTreeMap<String, Named<'a>>,
    pub(super) globals: BTreeMap<String, (&'a TypeSpec, Home)>,
    open: OpenNames,
    namespaces: BTreeSet<String>,
    libraries: BTreeSet<String>,
    /// The namespaces that `USING` names, by their keys.
    using: BTreeMap<String, String>,
    /// The types of values of enumerations, by the value's name.
    pub(super) enumerators: BTreeMap<String, String>,
    /// Values of enumerations without names, in lists of globals.
    pub(super) loose_values: BTreeSet<String>,
    /// What stands outside of units and has values: types and lists of globals.
    pub(super) loose: Vec<(&'a Section, Home)>,
    pub(super) sources: &'a SourceMap,
}

impl<'a> World<'a> {
    pub(super) fn new(
        trees: &'a [(FileId, CompilationUnit)],
        library: &BTreeSet<FileId>,
        sources: &'a SourceMap,
    ) -> Self {
        let mut world = Self {
            units: BTreeMap::new(),
            types: BTreeMap::new(),
            globals: BTreeMap::new(),
            open: OpenNames::default(),
            namespaces: BTreeSet::new(),
            libraries: BTreeSet::new(),
            using: BTreeMap::new(),
            enumerators: BTreeMap::new(),
            loose_values: BTreeSet::new(),
            loose: Vec::new(),
            sources,
        };
        for (file, unit) in trees {
            let mut home = Home::default();
            for declaration in &unit.declarations {
                if let Declaration::Using(names) = declaration {
                    home.using.extend(names.iter().map(Ident::key));
                    world.note_using(names);
                }
            }
            world.add_all(&unit.declarations, &home, library.contains(file));
        }
        world
    }

    /// The dialect of the text at `span`.
    pub(super) fn dialect(&self, span: Span) -> Dialect {
        self.sources.get(span.file).map_or_else(Dialect::default, SourceFile::dialect)
    }

    /// Bits of the registers of the target that runs the text at `span`.
    pub(super) fn word_size(&self, span: Span) -> WordSize {
        self.sources.get(span.file).map_or_else(WordSize::default, SourceFile::word_size)
    }

    fn note_using(&mut self, names: &[Ident]) {
        self.using.extend(names.iter().map(|name| (name.key(), name.text.clone())));
    }

    /// The namespaces that `USING` names and nobody declares.
    pub(super) fn missing_namespaces(&self) -> impl Iterator<Item = &str> {
        let is_known = |key: &str| {
            let below = format!("{key}.");
            self.namespaces.iter().any(|known| known == key || known.starts_with(&below))
        };
        self.using.iter().filter(move |(key, _)| !is_known(key)).map(|(_, name)| name.as_str())
    }

    /// The globals that `VAR_EXTERNAL` names and nobody declares, with their types as written there.
    pub(super) fn missing_globals(&self) -> BTreeMap<String, (&Ident, &TypeSpec)> {
        let mut found = BTreeMap::new();
        for unit in self.units.values().filter(|unit| !unit.library) {
            let inner = unit.pou.object.members.iter().flat_map(|member| &member.pou.sections);
            let sections = unit.pou.sections.iter().chain(inner);
            let external = sections.filter(|section| section.kind == SectionKind::External);
            for variable in external.flat_map(|section| &section.variables) {
                for name in &variable.names {
                    if self.global_key(&unit.home, &name.key()).is_none() {
                        found.entry(name.key()).or_insert((name, &variable.spec));
                    }
                }
            }
        }
        found
    }

    fn add_all(&mut self, list: &'a [Declaration], home: &Home, library: bool) {
        for declaration in list {
            match declaration {
                Declaration::Pou(pou) => self.add_unit(pou, home, library),
                Declaration::Type(ast) => self.add_type(ast, home),
                Declaration::Globals(section) => self.add_globals(section, home),
                Declaration::Namespace(namespace) => self.add_namespace(namespace, home, library),
                Declaration::Using(_) => {}
                Declaration::Configuration(configuration) => {
                    for section in configuration.all_sections() {
                        self.add_globals(section, home);
                    }
                }
            }
        }
    }

    fn add_namespace(&mut self, namespace: &'a Namespace, home: &Home, library: bool) {
        let mut inner = home.clone();
        inner.namespace = joined(&home.namespace, &namespace.name.key());
        inner.using.extend(namespace.using.iter().map(Ident::key));
        self.note_using(&namespace.using);
        if namespace.external || home.namespace.is_empty() && is_library(namespace) {
            self.libraries.insert(inner.namespace.clone());
        }
        inner.short = short_inside(home.short.as_deref(), namespace);
        self.namespaces.insert(inner.namespace.clone());
        self.namespaces.extend(inner.short.clone().filter(|short| !short.is_empty()));
        self.add_all(&namespace.declarations, &inner, library);
        if namespace.kind == NamespaceKind::Open && library {
            // What a vendor's library declares is known without its name, unless the project has something of the name.
            self.libraries.insert(inner.namespace);
            self.add_all(&namespace.declarations, home, library);
        }
    }

    fn add_unit(&mut self, pou: &'a Pou, home: &Home, library: bool) {
        let key = joined(&home.namespace, &pou.name.key());
        if self.units.contains_key(&key) || self.types.contains_key(&key) {
            return;
        }
        OpenNames::note(&mut self.open.units, home, &pou.name, &key);
        let mut home = home.clone();
        home.using.extend(pou.object.using.iter().map(Ident::key));
        self.note_using(&pou.object.using);
        let mut members = BTreeMap::new();
        for member in &pou.object.members {
            let part = match member.kind {
                MemberKind::Method | MemberKind::Action => Part::Method,
                MemberKind::Getter | MemberKind::Setter => Part::Property,
            };
            members.entry((part, member.pou.name.key())).or_insert(&member.pou);
        }
        self.units.insert(key, Unit { pou, home, variables: variables(pou), members, library });
    }

    fn add_type(&mut self, ast: &'a TypeDeclaration, home: &Home) {
        let key = joined(&home.namespace, &ast.name.key());
        if self.types.contains_key(&key) || self.units.contains_key(&key) {
            return;
        }
        OpenNames::note(&mut self.open.types, home, &ast.name, &key);
        if let TypeSpecKind::Enumeration(values, _) = &ast.spec.kind {
            for value in values {
                self.enumerators.entry(value.name.key()).or_insert_with(|| key.clone());
            }
        }
        if let TypeSpecKind::Struct(fields) = &ast.spec.kind {
            let found = fields.iter().flat_map(|field| values(&field.spec));
            self.loose_values.extend(found.map(|value| value.name.key()));
        }
        self.types.insert(key, Named { ast, home: home.clone() });
    }

    fn add_globals(&mut self, section: &'a Section, home: &Home) {
        for variable in &section.variables {
            self.loose_values.extend(values(&variable.spec).map(|value| value.name.key()));
            for name in &variable.names {
                let key = joined(&home.namespace, &name.key());
                OpenNames::note(&mut self.open.globals, home, name, &key);
                self.globals.entry(key).or_insert_with(|| (&variable.spec, home.clone()));
            }
        }
        self.loose.push((section, home.clone()));
    }

    fn full_key<T>(
        &self,
        map: &BTreeMap<String, T>,
        open: &BTreeMap<String, String>,
        home: &Home,
        key: &str,
    ) -> Option<String> {
        if let Some(found) = find_key(map, &home.namespace, &home.using, key).or_else(|| open.get(key).cloned()) {
            return Some(found);
        }
        let (first, rest) = key.split_once('.')?;
        if self.libraries.contains(first) || is_standard_library(first) || is_library_name(first) || is_list(first) {
            return self.full_key(map, open, home, rest);
        }
        None
    }

    pub(super) fn unit_key(&self, home: &Home, key: &str) -> Option<String> {
        self.full_key(&self.units, &self.open.units, home, key)
    }

    pub(super) fn type_key(&self, home: &Home, key: &str) -> Option<String> {
        self.full_key(&self.types, &self.open.types, home, key)
    }

    pub(super) fn global_key(&self, home: &Home, key: &str) -> Option<String> {
        self.full_key(&self.globals, &self.open.globals, home, key)
    }

    /// True for a name that stands for something in front of a dot: a namespace that is declared.
    pub(super) fn is_namespace(&self, home: &Home, key: &str) -> bool {
        is_standard_library(key)
            || self.namespaces.contains(key)
            || self.namespaces.contains(&joined(&home.namespace, key))
    }

    /// True for a library's name that is declared.
    pub(super) fn is_library(&self, key: &str) -> bool {
        is_standard_library(key) || self.libraries.contains(key)
    }

    /// A namespace that `USING` names, as it is written there.
    pub(super) fn shown_namespace(&self, key: &str) -> Option<&str> {
        self.using.get(key).map(String::as_str)
    }

    pub(super) fn function(&self, home: &Home, key: &str) -> Option<&Unit<'a>> {
        let unit = self.units.get(&self.unit_key(home, key)?)?;
        (unit.pou.kind == PouKind::Function).then_some(unit)
    }

    /// True for functions that the language has.
    pub(super) fn has_function(key: &str) -> bool {
        knows_function(key)
    }
}

/// True for what a file of a library is in, and not for an open list of global variables.
fn is_library(namespace: &Namespace) -> bool {
    let is_list = namespace.declarations.iter().all(|each| matches!(each, Declaration::Globals(_)));
    namespace.kind == NamespaceKind::Open && !is_list
}

/// What runs with the arguments of a declaration, and what it is always given.
pub(super) const INIT: &str = "FB_init";
pub(super) const INIT_INPUTS: [&str; 2] = ["bInitRetains", "bInCopyCode"];

/// The type of a value of an enumeration that has no name.
pub(super) const VALUE: Ty = Ty::Elementary(ElementaryType::Int);

/// The values of an enumeration that a variable is declared with.
fn values(spec: &TypeSpec) -> impl Iterator<Item = &EnumValue> {
    let mut inner = spec;
    while let TypeSpecKind::Array(_, element) = &inner.kind {
        inner = element;
    }
    let list = if let TypeSpecKind::Enumeration(values, _) = &inner.kind { values.as_slice() } else { &[] };
    list.iter()
}

/// True if a variable is declared with an enumeration that has the value.
pub(super) fn has_value(spec: &TypeSpec, key: &str) -> bool {
    values(spec).any(|value| value.name.key() == key)
}

fn variables(pou: &Pou) -> BTreeMap<String, (&TypeSpec, SectionKind)> {
    let mut found = BTreeMap::new();
    for section in &pou.sections {
        for variable in &section.variables {
            for name in &variable.names {
                found.entry(name.key()).or_insert((&variable.spec, section.kind));
            }
        }
    }
    found
}

/// Libraries whose content the language has.
pub(super) fn is_standard_library(key: &str) -> bool {
    matches!(key, "STANDARD" | "TC2_STANDARD" | "STANDARD64" | "IEC61131_STANDARD")
}
