//! Functions and methods of one name that differ in their parameters, as SIMATIC AX has them.
//!
//! A method's list of parameters is a part of its key where its name has several, so that what overrides it, and what
//! implements a prototype, is found by name and parameters. Which of them a call means its arguments say.

use std::collections::{BTreeMap, BTreeSet};

use super::Declarations;
use super::class::Role;
use super::hook::is_hook;
use crate::dialect::Feature;
use crate::ir::PouId;
use crate::syntax::FileId;
use crate::syntax::ast::{self, CompilationUnit, Declaration, Ident, MemberKind, Modifier, PouKind, SectionKind};
use crate::syntax::printer::print_type;

/// The names that several lists of parameters have.
#[derive(Debug, Default)]
pub(super) struct Overloads {
    /// All functions of a name by its full key, in the order of the text; a function that is alone has no entry.
    functions: BTreeMap<String, Vec<PouId>>,
    methods: BTreeSet<String>,
}

impl Overloads {
    /// Which methods' names have several lists of parameters, in one unit or in one and its base.
    pub(super) fn of(units: &[(FileId, &CompilationUnit)]) -> Self {
        let mut classes = Vec::new();
        for (_, unit) in units.iter().filter(|(_, unit)| unit.dialect.has(Feature::Overloads)) {
            collect_classes(&unit.declarations, &mut classes);
        }
        let extended: BTreeSet<String> = classes
            .iter()
            .flat_map(|class| &class.object.extends)
            .map(|base| last_part(&base.key()).to_owned())
            .collect();
        // Of each name: the lists of what is extended, and those of what is derived and overrides nothing.
        let mut of_bases: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        let mut beside: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        let mut methods = BTreeSet::new();
        for class in classes {
            let mut own: BTreeMap<String, String> = BTreeMap::new();
            for method in class.object.members.iter().filter(|member| member.kind == MemberKind::Method) {
                let (name, list) = (method.pou.name.key(), parameter_list(&method.pou));
                if is_hook(&name) {
                    continue;
                }
                if own.insert(name.clone(), list.clone()).is_some_and(|before| before != list) {
                    methods.insert(name.clone());
                }
                if extended.contains(&class.name.key()) {
                    of_bases.entry(name.clone()).or_default().insert(list.clone());
                }
                if !class.object.extends.is_empty() && !method.pou.object.modifiers.contains(&Modifier::Override) {
                    beside.entry(name).or_default().insert(list);
                }
            }
        }
        let differ = |(name, lists): &(String, BTreeSet<String>)| {
            of_bases.get(name).is_some_and(|known| !lists.is_subset(known))
        };
        methods.extend(beside.into_iter().filter(differ).map(|(name, _)| name));
        Self { functions: BTreeMap::new(), methods }
    }

    /// The key of a member: its name, behind it the list of its parameters if the name has several.
    pub(super) fn member_key(&self, member: &ast::Pou, role: Role) -> String {
        let key = member.name.key();
        if role == Role::Method && self.methods.contains(&key) {
            return format!("{key}({})", parameter_list(member));
        }
        key
    }
}

impl<'a> Declarations<'a> {
    /// True if a function of the name and of other parameters is declared, beside which this one may stand.
    pub(super) fn stands_beside(&self, function: &ast::Pou) -> bool {
        let Some(first) = self.pou_names.get(&self.home.key(&function.name)).copied() else { return false };
        let has = |pou: &ast::Pou| pou.kind == PouKind::Function && self.dialect(pou.name.span).has(Feature::Overloads);
        let list = parameter_list(function);
        has(function)
            && has(self.pou(first).ast)
            && self.functions_beside(first).iter().all(|known| parameter_list(self.pou(*known).ast) != list)
    }

    /// Adds a function beside those of its name.
    pub(super) fn add_overload(&mut self, function: &'a ast::Pou) {
        let key = self.home.key(&function.name);
        let Some(first) = self.pou_names.get(&key).copied() else { return };
        let id = self.add_pou(function, None);
        self.overloads.functions.entry(key).or_insert_with(|| vec![first]).push(id);
    }

    /// All functions of the name that this one has, itself among them.
    pub(in crate::check) fn functions_beside(&self, function: PouId) -> Vec<PouId> {
        let known = self.overloads.functions.get(&self.key_of(function));
        known.cloned().unwrap_or_else(|| vec![function])
    }

    /// The methods of a name that an instance of a unit has, of equal parameters the nearest: its own, those of its
    /// bases, those of what it implements.
    pub(in crate::check) fn methods_named(&self, id: PouId, name: &str) -> Vec<PouId> {
        let name = name.to_ascii_uppercase();
        if !self.overloads.methods.contains(&name) {
            return self.find_member(id, Role::Method, &name).into_iter().collect();
        }
        let begin = format!("{name}(");
        let mut found: BTreeMap<&str, PouId> = BTreeMap::new();
        for class in self.with_bases(id).chain(self.ancestors(id)).filter_map(|each| self.class(each)) {
            let behind = class.members.range((Role::Method, begin.clone())..);
            let named = behind.take_while(|((role, key), _)| *role == Role::Method && key.starts_with(&begin));
            named.for_each(|((_, key), method)| {
                found.entry(key.as_str()).or_insert(*method);
            });
        }
        found.into_values().collect()
    }

    /// By which key a member is found.
    pub(in crate::check) fn member_key(&self, member: PouId) -> String {
        let entry = self.pou(member);
        let role = entry.membership.map_or(Role::Body, |membership| membership.role);
        self.overloads.member_key(entry.ast, role)
    }

    /// What distinguishes a unit from others of its name, to be written behind it: `(INT, STRING)`; empty if there are
    /// none.
    pub(in crate::check) fn shown_parameters(&self, id: PouId) -> String {
        let entry = self.pou(id);
        let several = match entry.membership {
            Some(membership) => {
                membership.role == Role::Method && self.overloads.methods.contains(&entry.ast.name.key())
            }
            None => self.overloads.functions.contains_key(&self.key_of(id)),
        };
        if several { format!("({})", parameter_list(entry.ast)) } else { String::new() }
    }
}

fn collect_classes<'a>(list: &'a [Declaration], found: &mut Vec<&'a ast::Pou>) {
    for declaration in list {
        match declaration {
            Declaration::Pou(pou) if pou.kind != PouKind::Function => found.push(pou),
            Declaration::Namespace(namespace) => collect_classes(&namespace.declarations, found),
            Declaration::Pou(_)
            | Declaration::Type(_)
            | Declaration::Globals(_)
            | Declaration::Using(_)
            | Declaration::Configuration(_) => {}
        }
    }
}

/// The types of the parameters, in capitals and without their namespaces: `INT, REF_TO AXIS`, behind `=>` those of outputs.
fn parameter_list(pou: &ast::Pou) -> String {
    let types = |accept: fn(SectionKind) -> bool| {
        let sections = pou.sections.iter().filter(|section| accept(section.kind));
        let types = sections.flat_map(|section| &section.variables).flat_map(|variable| {
            let text = print_type(&variable.spec).to_ascii_uppercase();
            let text = text.split(' ').map(last_part).collect::<Vec<_>>().join(" ");
            variable.names.iter().map(move |_: &Ident| text.clone())
        });
        types.collect::<Vec<_>>().join(", ")
    };
    let given = types(|kind| matches!(kind, SectionKind::Input | SectionKind::InOut));
    let taken = types(|kind| kind == SectionKind::Output);
    if taken.is_empty() { given } else { format!("{given} => {taken}").trim_start().to_owned() }
}

/// A name without the namespaces before it; a range, `0..5`, stays whole.
fn last_part(word: &str) -> &str {
    if word.contains("..") { word } else { word.rsplit('.').next().unwrap_or(word) }
}
