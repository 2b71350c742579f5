//! Names in namespaces (3rd ed. 6.9): the key of what is declared in `a.b` is `A.B.NAME`.
//!
//! A name is looked for in the namespace of the unit, then in those around it, then in those that
//! `USING` names, in their order.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::Declarations;
use super::overload::Overloads;
use crate::diagnostic::{Code, Diagnostic, did_you_mean};
use crate::dialect::AddressUnit;
use crate::ir::PouId;
use crate::syntax::Span;
use crate::syntax::ast::{CompilationUnit, Declaration, Ident, Modifier, Namespace, NamespaceKind};

/// Libraries of vendors; their names may stand before what they hold, which is known without that.
const LIBRARIES: [&str; 22] = [
    "STANDARD",
    "STANDARD64",
    "IEC61131_STANDARD",
    "UTIL",
    "CAA",
    "CMPERRORS",
    "SYSTYPES",
    "SYSTIME",
    "SYSTIMECORE",
    "SYSTIMERTC",
    "SYSMEM",
    "SYSFILE",
    "SYSDIR",
    "GLOBAL",
    "TC2_STANDARD",
    "TC2_SYSTEM",
    "TC2_UTILITIES",
    "TC2_MC2",
    "TC2_ETHERCAT",
    "IBASELIBRARY",
    "TC3_MODULE",
    "TC3_EVENTLOGGER",
];

/// True for the name of a vendor's library, in capitals.
pub fn is_library_name(key: &str) -> bool {
    LIBRARIES.contains(&key)
}

/// True for a list of global variables in TwinCAT's libraries, which may stand between a library and a name.
pub fn is_list(name: &str) -> bool {
    ["GLOBAL_VARIABLES", "GLOBAL_CONSTANTS"].iter().any(|list| list.eq_ignore_ascii_case(name))
}

/// Full keys of what is known without its namespace, by names.
#[derive(Default)]
pub(super) struct OpenNames {
    pub(super) units: BTreeMap<String, String>,
    pub(super) types: BTreeMap<String, String>,
    pub(super) globals: BTreeMap<String, String>,
}

/// Where something is declared, and so what it sees.
#[derive(Debug, Default, PartialEq, Eq)]
pub(in crate::check) struct Home {
    /// The key of the namespace; empty outside of any.
    pub(in crate::check) namespace: String,
    /// Its name as written.
    pub(in crate::check) shown: String,
    /// Keys of the namespaces whose names are seen as well.
    pub(super) using: Vec<String>,
    /// True inside of `NAMESPACE INTERNAL`.
    pub(in crate::check) internal: bool,
    /// The namespace without the open ones that it begins with: names are known behind this, too. Nothing where none
    /// around is open.
    pub(in crate::check) short: Option<String>,
}

impl Home {
    /// The key of what is declared here.
    pub(in crate::check) fn key(&self, name: &Ident) -> String {
        joined(&self.namespace, &name.key())
    }

    /// The full name of what is declared here.
    pub(in crate::check) fn full_name(&self, name: &Ident) -> String {
        joined(&self.shown, &name.text)
    }

    /// True inside of a namespace.
    pub(super) fn is_named(&self) -> bool {
        !self.namespace.is_empty()
    }

    fn inside(&self, namespace: &Namespace) -> Self {
        let mut using = self.using.clone();
        using.extend(namespace.using.iter().map(Ident::key));
        Self {
            namespace: joined(&self.namespace, &namespace.name.key()),
            shown: joined(&self.shown, &namespace.name.text),
            using,
            internal: self.internal || namespace.kind == NamespaceKind::Internal,
            short: short_inside(self.short.as_deref(), namespace),
        }
    }

    /// How what is declared here is known besides its key.
    pub(super) fn short_key(&self, name: &Ident) -> Option<String> {
        self.short.as_ref().map(|short| joined(short, &name.key()))
    }

    /// With what a unit uses by itself.
    pub(in crate::check) fn with(self: &Arc<Self>, using: &[Ident]) -> Arc<Self> {
        if using.is_empty() {
            return self.clone();
        }
        let mut all = self.using.clone();
        all.extend(using.iter().map(Ident::key));
        let (namespace, shown, short) = (self.namespace.clone(), self.shown.clone(), self.short.clone());
        Arc::new(Self { namespace, shown, using: all, short, ..**self })
    }
}

/// By what the names in a namespace are known besides their keys. The names of a library are known without it, those
/// of a list in it behind the list's name, and those of an open list by themselves.
pub fn short_inside(short: Option<&str>, namespace: &Namespace) -> Option<String> {
    match short {
        _ if namespace.kind == NamespaceKind::Open => Some(String::new()),
        Some(short) => Some(joined(short, &namespace.name.key())),
        None => None,
    }
}

/// The full key of what is declared in a namespace.
pub fn joined(namespace: &str, key: &str) -> String {
    if namespace.is_empty() { key.to_owned() } else { format!("{namespace}.{key}") }
}

/// The full key that `map` has for what `key` means in `namespace`: there, in those around it, then in those of
/// `using`, in their order.
pub fn find_key<T>(map: &BTreeMap<String, T>, namespace: &str, using: &[String], key: &str) -> Option<String> {
    let mut around = namespace;
    loop {
        let full = joined(around, key);
        if map.contains_key(&full) {
            return Some(full);
        }
        if around.is_empty() {
            break;
        }
        around = around.rsplit_once('.').map_or("", |(outer, _)| outer);
    }
    using.iter().map(|used| joined(used, key)).find(|full| map.contains_key(full))
}

impl<'a> Declarations<'a> {
    pub(in crate::check) fn collect(&mut self, units: &[(crate::syntax::FileId, &'a CompilationUnit)]) {
        // Who looks from outside sees the addresses as the first file has them.
        self.address_unit = units.first().map_or_else(AddressUnit::default, |(_, unit)| unit.dialect.address_unit());
        self.dialects = units.iter().map(|(file, unit)| (*file, (unit.dialect, unit.word_size))).collect();
        self.overloads = Overloads::of(units);
        let mut used = Vec::new();
        for (_, unit) in units {
            let mut home = Home::default();
            for declaration in &unit.declarations {
                if let Declaration::Using(names) = declaration {
                    used.extend(names);
                    home.using.extend(names.iter().map(Ident::key));
                }
            }
            self.collect_all(&unit.declarations, &Arc::new(home), &mut used);
        }
        for name in used {
            self.check_using(name);
        }
        self.home = Arc::default();
        self.collect_resource_globals();
    }

    fn collect_all(&mut self, list: &'a [Declaration], home: &Arc<Home>, used: &mut Vec<&'a Ident>) {
        self.home = home.clone();
        for declaration in list {
            match declaration {
                Declaration::Pou(pou) => {
                    used.extend(&pou.object.using);
                    self.collect_pou(pou);
                }
                Declaration::Type(declaration) => self.collect_type(declaration),
                Declaration::Globals(section) => self.collect_globals(section),
                Declaration::Using(_) => {}
                Declaration::Configuration(configuration) => self.collect_configuration(configuration),
                Declaration::Namespace(namespace) => {
                    used.extend(&namespace.using);
                    let inner = Arc::new(home.inside(namespace));
                    self.namespaces.insert(inner.namespace.clone(), inner.shown.clone());
                    if let Some(short) = inner.short.as_ref().filter(|short| !short.is_empty()) {
                        let shown = || namespace.name.text.clone();
                        self.namespaces.entry(short.clone()).or_insert_with(shown);
                    }
                    if namespace.external {
                        self.libraries.insert(inner.namespace.clone());
                    }
                    self.collect_all(&namespace.declarations, &inner, used);
                    self.home = home.clone();
                }
            }
        }
    }

    fn check_using(&mut self, name: &Ident) {
        let key = name.key();
        // A vendor's library is named where it is used, and is known without that.
        if self.namespaces.contains_key(&key) || LIBRARIES.contains(&key.as_str()) {
            return;
        }
        // `NAMESPACE a.b` declares `a` as well.
        let below = format!("{key}.");
        if self.namespaces.range(below.clone()..).next().is_some_and(|(known, _)| known.starts_with(&below)) {
            return;
        }
        let help = did_you_mean(&name.text, self.namespaces.values().map(String::as_str));
        let message = format!("there is no namespace `{}`", name.text);
        let found = Diagnostic::error(Code::UnknownNamespace, name.span, message);
        self.report(found.with_optional_help(help));
    }

    /// Runs `action` with the names that are seen from `home`.
    pub(in crate::check) fn at_home<T>(&mut self, home: Arc<Home>, action: impl FnOnce(&mut Self) -> T) -> T {
        let outer = std::mem::replace(&mut self.home, home);
        let result = action(self);
        self.home = outer;
        result
    }

    /// The full key of what `key` means here, if `map` has it.
    fn full_key<T>(&self, map: &BTreeMap<String, T>, key: &str) -> Option<String> {
        find_key(map, &self.home.namespace, &self.home.using, key)
    }

    pub(in crate::check) fn type_key(&self, key: &str) -> Option<String> {
        let of_library = |key: &String| self.is_library_type(key);
        self.known_key(&self.type_names, &self.open.types, of_library, key)
    }

    pub(in crate::check) fn global_key(&self, key: &str) -> Option<String> {
        let span = |key: &String| self.globals.get(key).map(|entry| entry.span);
        let of_library = |key: &String| span(key).is_some_and(|span| self.library.contains(&span.file));
        self.known_key(&self.globals, &self.open.globals, of_library, key)
    }

    pub(in crate::check) fn pou_named(&self, key: &str) -> Option<PouId> {
        let of_library = |key: &String| self.pou_names.get(key).is_some_and(|id| self.is_library(*id));
        let full = self.known_key(&self.pou_names, &self.open.units, of_library, key)?;
        self.pou_names.get(&full).copied()
    }

    /// The full key of what a name means here: in its namespaces, then in those that are open, then, with the name of
    /// a vendor's library before it, what there is of libraries.
    fn known_key<T>(
        &self,
        map: &BTreeMap<String, T>,
        open: &BTreeMap<String, String>,
        of_library: impl Fn(&String) -> bool,
        key: &str,
    ) -> Option<String> {
        let taken = self.pou_names.contains_key(key) || self.type_names.contains_key(key);
        let opened = || open.get(key).filter(|full| !taken || !of_library(full)).cloned();
        let found = self.full_key(map, key).or_else(opened);
        if found.is_some() || !key.contains('.') {
            return found;
        }
        let name = self.without_libraries(key)?.to_owned();
        let open = open.get(&name).cloned();
        // What the library here lacks a stub may stand for, which is among the user's files.
        let known = open.into_iter().chain([name]).filter(|full| map.contains_key(full));
        known.min_by_key(|full| !of_library(full))
    }

    /// What stands behind the names of vendors' libraries; nothing if none stands before it.
    pub(in crate::check) fn without_libraries<'k>(&self, key: &'k str) -> Option<&'k str> {
        let mut name = key;
        while let Some((first, rest)) = name.split_once('.')
            && (self.is_vendor_library(first) || name.len() < key.len() && is_list(first))
        {
            name = rest;
        }
        (name.len() < key.len()).then_some(name)
    }

    /// A name without those of vendors' libraries before it.
    pub(in crate::check) fn behind_libraries(&self, name: &Ident) -> Ident {
        match self.without_libraries(&name.text) {
            Some(rest) => Ident { text: rest.to_owned(), ..name.clone() },
            None => name.clone(),
        }
    }

    /// True for the name of a vendor's library, in any case, unless the program has something of the name.
    fn is_vendor_library(&self, name: &str) -> bool {
        let key = name.to_ascii_uppercase();
        let known = LIBRARIES.contains(&key.as_str()) || self.libraries.contains(&key);
        known && !self.globals.contains_key(&key) && !self.pou_names.contains_key(&key)
    }

    /// How to name what is declared in a namespace that is not seen from here.
    pub(in crate::check) fn elsewhere(&self, name: &Ident) -> Option<String> {
        let key = name.key();
        let is_it = |home: &Home, other: &Ident| !home.namespace.is_empty() && other.key() == key;
        let units = self.pous.iter().filter(|entry| entry.membership.is_none() && is_it(&entry.home, &entry.ast.name));
        let types = self.type_names.values().filter(|entry| is_it(&entry.home, &entry.ast.name));
        let globals =
            self.globals.iter().filter(|(full, _)| full.rsplit_once('.').is_some_and(|(_, last)| last == key));
        let units = units.map(|entry| entry.home.full_name(&entry.ast.name));
        let types = types.map(|entry| entry.home.full_name(&entry.ast.name));
        let globals = globals.map(|(_, entry)| format!("{}.{}", entry.seen_from.shown, entry.name));
        let found = units.chain(types).chain(globals).next()?;
        Some(format!("write `{found}`"))
    }

    /// True if `home` is the namespace of what runs now, or inside of it (3rd ed. 6.9.3).
    pub(super) fn is_inside(&self, home: &Home) -> bool {
        let (here, there) = (&self.home.namespace, &home.namespace);
        here == there || here.strip_prefix(there.as_str()).is_some_and(|rest| there.is_empty() || rest.starts_with('.'))
    }

    /// Reports a unit that only its own namespace may use (3rd ed. 6.9.3).
    pub(in crate::check) fn check_internal(&mut self, id: PouId, used: Span) {
        let entry = self.pou(id);
        let is_internal = entry.home.internal || entry.ast.object.modifiers.contains(&Modifier::Internal);
        if is_internal && !self.is_inside(&entry.home.clone()) {
            let message = format!("`{}` is INTERNAL to its namespace", self.pou(id).ast.name.text);
            self.report(Diagnostic::error(Code::AccessDenied, used, message));
        }
    }

    /// True if `key` names a namespace, or something in one.
    pub(in crate::check) fn is_in_namespace(&self, key: &str) -> bool {
        let known = |key: &str| self.full_key(&self.namespaces, key).is_some();
        let library = self.is_vendor_library(key.split_once('.').map_or(key, |(first, _)| first));
        library || key.match_indices('.').any(|(at, _)| known(&key[..at])) || known(key)
    }
}
