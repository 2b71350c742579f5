//! Stubs as program text.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::Stubs;
use super::collect::Collector;
use super::foreign::{Foreign, Global, Member};
use super::shape::Shape;
use super::slots::{ANY_BOUNDS, OPEN_BOUNDS};
use super::ty::{Slot, Ty};
use super::world::INIT;
use super::world::{Part, Unit};
use onescan_iec::ElementaryType;
use onescan_iec::syntax::FileId;
use onescan_iec::syntax::ast::{PouKind, TypeSpecKind};

/// What the file is called.
pub(super) const FILE: &str = "stubs.st";
/// The first number of a constant that bounds something: nobody knows the right one.
const FIRST_CONSTANT: usize = 100;

/// The text with everything that is missing: members put into stubs that are there, all else behind them.
pub(super) fn completed(collector: &mut Collector<'_>, text: &str, file: Option<FileId>) -> Stubs {
    collector.name_values();
    let printer = Printer { collector, heirs: BTreeMap::new() };
    printer.completed(text, file)
}

impl Collector<'_> {
    /// Constants that go to an enumeration which nobody declares are its values.
    fn name_values(&mut self) {
        let globals: Vec<(String, Global)> =
            self.needs.globals.iter().map(|(key, global)| (key.clone(), global.clone())).collect();
        for (key, global) in globals {
            let ty = match self.slots.last_choice(global.slot) {
                Ty::Foreign(ty) => ty,
                Ty::Declared(ty) => {
                    self.add_to_enumeration(&ty, &key, &global);
                    continue;
                }
                _ => continue,
            };
            let Some(found) = self.needs.types.get(&ty) else { continue };
            let is_value = found.members.is_empty() && !global.written && !global.name.contains('.');
            if is_value && matches!(self.shape(found), Shape::Enumeration | Shape::Structure | Shape::Alias(_)) {
                self.foreign(&ty).add_value(&global.name);
                self.needs.globals.remove(&key);
            }
        }
    }

    /// Makes a constant a value of an enumeration that is a stub already.
    fn add_to_enumeration(&mut self, ty: &str, key: &str, global: &Global) {
        let Some(named) = self.world.types.get(ty).filter(|named| named.ast.external) else { return };
        let is_enumeration = matches!(named.ast.spec.kind, TypeSpecKind::Enumeration(..));
        if !is_enumeration || global.written || global.name.contains('.') {
            return;
        }
        let name = named.ast.name.text.clone();
        let found = self.foreign(ty);
        found.name = name;
        found.extends_stub = true;
        found.member(&global.name);
        self.needs.globals.remove(key);
    }
}

pub(super) struct Printer<'c, 'a> {
    pub(super) collector: &'c Collector<'a>,
    /// The units that are derived from a foreign type, whose methods show those of the base.
    pub(super) heirs: BTreeMap<String, Vec<&'c Unit<'a>>>,
}

impl Printer<'_, '_> {
    fn completed(mut self, text: &str, file: Option<FileId>) -> Stubs {
        self.find_heirs();
        let mut added = 0;
        let mut edits: Vec<(usize, String)> = Vec::new();
        let mut groups: [String; 6] = Default::default();
        let [libraries, types, interfaces, blocks, functions, globals] = &mut groups;
        let mut lists: BTreeMap<String, String> = BTreeMap::new();
        let needs = &self.collector.needs;
        for (key, name) in &needs.libraries {
            if !self.collector.world.is_library(key) {
                let _ = writeln!(libraries, "{{external}}\nNAMESPACE {name} END_NAMESPACE");
                added += 1;
            }
        }
        for name in self.collector.world.missing_namespaces() {
            let _ = writeln!(libraries, "{{external}}\nNAMESPACE {name} END_NAMESPACE");
            added += 1;
        }
        for (key, found) in &needs.types {
            if found.extends_stub {
                let edit = self.addition(key, found, text, file);
                added += usize::from(edit.is_some());
                edits.extend(edit);
                continue;
            }
            if found.is_anonymous && !found.implemented && !is_used(found) {
                continue;
            }
            let shape = self.collector.shape(found);
            let group = match shape {
                Shape::Block => &mut *blocks,
                Shape::Interface => &mut *interfaces,
                _ => &mut *types,
            };
            added += 1;
            let Some((list, name)) = found.name.rsplit_once('.') else {
                group.push('\n');
                group.push_str(&self.foreign(key, &found.name, found, &shape));
                continue;
            };
            let inner = lists.entry(list.to_owned()).or_default();
            inner.push('\n');
            inner.push_str(&self.foreign(key, name, found, &shape));
        }
        for (name, kept) in needs.aliases.values() {
            let kept = needs.types.get(kept).map_or(kept, |found| &found.name);
            let _ = write!(types, "\n{{external}}\nTYPE {name} : {kept}; END_TYPE\n");
            added += 1;
        }
        for function in needs.functions.values() {
            let (list, text) = self.function(function);
            let target = if list.is_empty() { &mut *functions } else { lists.entry(list).or_default() };
            target.push('\n');
            target.push_str(&text);
            added += 1;
        }
        self.globals(&mut lists, globals, &mut added);
        for (list, inner) in &lists {
            let _ = write!(globals, "\nNAMESPACE {list}\n{}\nEND_NAMESPACE\n", inner.trim_matches('\n'));
        }
        edits.sort_by_key(|(at, _)| std::cmp::Reverse(*at));
        let mut whole = text.to_owned();
        for (at, inserted) in edits {
            whole.insert_str(at, &inserted);
        }
        for group in groups.iter().filter(|group| !group.is_empty()) {
            if !group.starts_with('\n') {
                whole.push('\n');
            }
            whole.push_str(group);
        }
        Stubs { text: whole, added }
    }

    fn find_heirs(&mut self) {
        let world = self.collector.world;
        for unit in world.units.values().filter(|unit| !unit.pou.external && !unit.library) {
            for base in unit.pou.object.extends.iter().chain(&unit.pou.object.implements) {
                let key = base.key();
                let key = key.rsplit('.').next().unwrap_or(&key).to_owned();
                self.heirs.entry(key).or_default().push(unit);
            }
        }
    }

    fn foreign(&self, key: &str, name: &str, found: &Foreign, shape: &Shape) -> String {
        match shape {
            Shape::Alias(ty) => format!("{{external}}\nTYPE {name} : {}; END_TYPE\n", self.type_text(ty, name)),
            Shape::Enumeration => {
                let mut values = if found.values.is_empty() { format!("{name}_0") } else { found.values.join(", ") };
                if found.first_index > 0 {
                    let first = found.values.first().map_or(values.len(), String::len);
                    values.insert_str(first, &format!(" := {}", found.first_index));
                }
                let base = self.collector.base_of(found).map(|base| format!(" {}", base.name())).unwrap_or_default();
                format!("{{external}}\nTYPE {name} : ({values}){base}; END_TYPE\n")
            }
            Shape::Structure => {
                let fields = self.fields(found);
                let fields = if fields.is_empty() { "    unknown : BYTE;\n".to_owned() } else { fields };
                format!("{{external}}\nTYPE {name} :\nSTRUCT\n{fields}END_STRUCT\nEND_TYPE\n")
            }
            Shape::Interface => {
                let (above, members) = (self.above(key, found, " EXTENDS "), self.interface_members(key, found));
                format!("{{external}}\nINTERFACE {name}{above}\n{members}END_INTERFACE\n")
            }
            Shape::Block => {
                let (above, members) = (self.above(key, found, " IMPLEMENTS "), self.block_members(key, found));
                let constants = generic_constants(found.constants);
                let kind = if found.base_of_class { "CLASS" } else { "FUNCTION_BLOCK" };
                format!("{{external}}\n{kind} {name}{constants}{above}\n{members}END_{kind}\n")
            }
        }
    }

    /// The interfaces that a type stands for, behind a word.
    fn above(&self, key: &str, found: &Foreign, word: &str) -> String {
        let names = found.stands_for.iter().filter(|each| self.is_interface(each) && !self.reaches(each, key));
        let names: Vec<String> = names.map(|each| self.type_text(&self.collector.ty_of(each), each)).collect();
        if names.is_empty() { String::new() } else { format!("{word}{}", names.join(", ")) }
    }

    fn is_interface(&self, key: &str) -> bool {
        let needs = &self.collector.needs;
        let foreign = needs.types.get(key).filter(|found| !found.extends_stub);
        match self.collector.world.units.get(key) {
            Some(unit) => unit.pou.kind == PouKind::Interface,
            None => foreign.is_some_and(|found| self.collector.shape(found) == Shape::Interface),
        }
    }

    /// True if an interface stands for another: two that stand for each other would extend themselves.
    fn reaches(&self, from: &str, to: &str) -> bool {
        let mut open = vec![from];
        let mut seen = std::collections::BTreeSet::new();
        while let Some(next) = open.pop() {
            if next == to {
                return true;
            }
            if seen.insert(next)
                && let Some(found) = self.collector.needs.types.get(next)
            {
                open.extend(found.stands_for.iter().map(String::as_str));
            }
        }
        false
    }

    /// What a stub that is there lacks, and where it goes.
    fn addition(&self, key: &str, found: &Foreign, text: &str, file: Option<FileId>) -> Option<(usize, String)> {
        if found.members.is_empty() && found.init.is_none() {
            return None;
        }
        let world = self.collector.world;
        if let Some(unit) = world.units.get(key) {
            let (span, end) = (
                unit.pou.span,
                match unit.pou.kind {
                    PouKind::Interface => "END_INTERFACE",
                    PouKind::Class => "END_CLASS",
                    PouKind::Program => "END_PROGRAM",
                    _ => "END_FUNCTION_BLOCK",
                },
            );
            let inner = if unit.pou.kind == PouKind::Interface {
                self.interface_members(key, found)
            } else {
                self.block_members(key, found)
            };
            let at = text.get(..span.end as usize)?.rfind(end)?;
            return (Some(span.file) == file && !inner.is_empty()).then_some((at, inner));
        }
        let named = world.types.get(key)?;
        let span = named.ast.spec.span;
        let before = text.get(..span.end as usize)?;
        if Some(span.file) != file {
            return None;
        }
        match &named.ast.spec.kind {
            TypeSpecKind::Struct(_) => Some((before.rfind("END_STRUCT")?, self.fields(found))),
            TypeSpecKind::Enumeration(..) => {
                let names = found.order.iter().filter_map(|key| found.members.get(key)).map(|member| &member.name);
                let names: String = names.map(|name| format!(", {name}")).collect();
                Some((before.rfind(')')?, names))
            }
            _ => None,
        }
    }

    fn fields(&self, found: &Foreign) -> String {
        let members = members(found)
            .map(|member| format!("    {} : {};\n", member.name, self.slot_text(member.field, &member.name)));
        members.collect()
    }

    /// True for what is called and is not an instance.
    fn is_method(&self, member: &Member) -> bool {
        let is_instance = member
            .field
            .is_some_and(|slot| matches!(self.collector.slots.decided(slot), Some(Ty::Foreign(_) | Ty::Declared(_))));
        member.called.is_some() && !is_instance
    }

    fn block_members(&self, key: &str, found: &Foreign) -> String {
        let (mut inputs, mut outputs, mut others) = (String::new(), String::new(), String::new());
        let mut constants = String::new();
        others.push_str(&self.init(key, found));
        for member in members(found).filter(|member| !member.name.eq_ignore_ascii_case(INIT)) {
            let name = &member.name;
            if let Some(method) = self.heir(key, Part::Method, name) {
                others.push_str(&self.copied_method(method));
            } else if let Some(property) = self.heir(key, Part::Property, name) {
                let mut ty = property.result.as_ref().map_or("DINT".to_owned(), |spec| self.copied(spec));
                let is_copy = member.written_below && !ty.to_ascii_uppercase().starts_with("REFERENCE");
                if is_copy && !member.written_inside && !member.written_outside {
                    ty = format!("REFERENCE TO {ty}");
                }
                others.push_str(&property_text(name, &ty, true, true));
            } else if let Some((signature, result)) = member.called.as_ref().filter(|_| self.is_method(member)) {
                others.push_str(&self.method(name, signature, *result));
            } else if member.is_constant && !member.written_inside && !member.written_outside {
                let number = FIRST_CONSTANT + constants.lines().count();
                let _ = writeln!(constants, "    {name} : INT := {number};");
            } else {
                let ty = self.slot_text(member.field, name);
                if member.via_super && member.written_below {
                    others.push_str(&property_text(name, &format!("REFERENCE TO {ty}"), true, false));
                } else if member.via_super || member.written_inside && member.written_outside {
                    others.push_str(&property_text(name, &ty, true, true));
                } else if member.written_below && member.written_inside {
                    others.push_str(&property_text(name, &format!("REFERENCE TO {ty}"), true, false));
                } else if member.input || member.written_outside || member.written_below {
                    let _ = writeln!(inputs, "    {name} : {ty};");
                } else {
                    let _ = writeln!(outputs, "    {name} : {ty};");
                }
            }
        }
        for index in inputs.lines().count()..found.inputs {
            let _ = writeln!(inputs, "    p{} : DINT;", index + 1);
        }
        let section = |word: &str, lines: String| {
            if lines.is_empty() { lines } else { format!("{word}\n{lines}END_VAR\n") }
        };
        let constants = section("VAR CONSTANT", constants);
        // A class has neither inputs nor outputs.
        let (input, output) =
            if found.base_of_class { ("VAR PUBLIC", "VAR PUBLIC") } else { ("VAR_INPUT", "VAR_OUTPUT") };
        [section(input, inputs), section(output, outputs), constants, others].concat()
    }

    fn interface_members(&self, key: &str, found: &Foreign) -> String {
        let mut text = String::new();
        for member in members(found) {
            let name = &member.name;
            if let Some(method) = self.heir(key, Part::Method, name) {
                text.push_str(&self.copied_method(method));
            } else if let Some(property) = self.heir(key, Part::Property, name) {
                let ty = property.result.as_ref().map_or("DINT".to_owned(), |spec| self.copied(spec));
                let is_written = member.written_inside || member.written_outside;
                text.push_str(&property_text(name, &ty, member.read || !is_written, is_written));
            } else if let Some((signature, result)) = member.called.as_ref().filter(|_| self.is_method(member)) {
                text.push_str(&self.method(name, signature, *result));
            } else {
                let mut ty = self.slot_text(member.field, name);
                let is_written = member.written_inside || member.written_outside;
                if member.written_below && !is_written {
                    // What a property gives is a copy, unless it gives the thing itself.
                    ty = format!("REFERENCE TO {ty}");
                }
                text.push_str(&property_text(name, &ty, member.read || !is_written, is_written));
            }
        }
        text
    }

    fn globals(&self, lists: &mut BTreeMap<String, String>, globals: &mut String, added: &mut usize) {
        let mut sections: BTreeMap<(String, bool), String> = BTreeMap::new();
        // A wire of a network is not a variable, even where its value is wrong.
        let named = self.collector.needs.globals.values().filter(|global| !global.name.starts_with('`'));
        let mut constants = 0;
        for global in named {
            let (list, name) = global.name.rsplit_once('.').unwrap_or(("", &global.name));
            let ty = self.collector.slots.last_choice(global.slot);
            let is_number = matches!(&ty, Ty::Elementary(found) if found.is_number() || found.is_bits() && *found != ElementaryType::Bool);
            // A label that the project's own enumeration does not have stands for a number.
            let is_label = global.is_constant && self.is_own_enumeration(&ty);
            if let Some(empty) = self.collector.empty_text(&ty).filter(|_| global.is_constant && !global.written) {
                let lines = sections.entry((list.to_owned(), true)).or_default();
                let _ = writeln!(lines, "    {name} : {} := {empty};", self.type_text(&ty, name));
                *added += 1;
                continue;
            }
            let is_constant = global.is_constant && (is_number || is_label) && !global.written;
            let narrow = if is_label { ElementaryType::Int } else { self.collector.slots.narrowest(global.slot) };
            let value = if is_constant { format!(" := {}", value_of(narrow, constants)) } else { String::new() };
            constants += usize::from(is_constant);
            let ty = if is_constant { narrow.name().to_owned() } else { self.type_text(&ty, name) };
            let lines = sections.entry((list.to_owned(), is_constant)).or_default();
            let _ = writeln!(lines, "    {name} : {ty}{value};");
            *added += 1;
        }
        for (key, (name, spec)) in self.collector.world.missing_globals() {
            if !self.collector.needs.globals.contains_key(&key) {
                let lines = sections.entry((String::new(), false)).or_default();
                let _ = writeln!(lines, "    {} : {};", name.text, self.copied(spec));
                *added += 1;
            }
        }
        for ((list, is_constant), lines) in sections {
            let word = if is_constant { " CONSTANT" } else { "" };
            let text = format!("VAR_GLOBAL{word}\n{lines}END_VAR\n");
            if list.is_empty() {
                globals.push('\n');
                globals.push_str(&text);
            } else {
                let inner = lists.entry(list).or_default();
                inner.push('\n');
                inner.push_str(&text);
            }
        }
    }

    fn is_own_enumeration(&self, ty: &Ty) -> bool {
        let Ty::Declared(key) = ty else { return false };
        let named = self.collector.world.types.get(key).filter(|named| !named.ast.external);
        named.is_some_and(|named| matches!(named.ast.spec.kind, TypeSpecKind::Enumeration(..)))
    }

    pub(super) fn slot_text(&self, slot: Option<Slot>, name: &str) -> String {
        let ty = slot.map_or(Ty::Unknown, |slot| self.collector.slots.last_choice(slot));
        self.type_text(&closed(ty), name)
    }

    pub(super) fn type_text(&self, ty: &Ty, name: &str) -> String {
        match ty {
            Ty::Unknown => self.type_text(&super::hint::of_name(name), name),
            Ty::Integer => "DINT".to_owned(),
            Ty::Any | Ty::Nameless(..) => "ANY".to_owned(),
            rows @ Ty::Array(..) if rows.is_nameless() => "ANY".to_owned(),
            Ty::Real => "LREAL".to_owned(),
            Ty::Elementary(found) | Ty::Wide(found) => found.name().to_owned(),
            Ty::Text(wide) => if *wide { "WSTRING(255)" } else { "STRING(255)" }.to_owned(),
            Ty::Declared(key) => self.declared_name(key),
            Ty::Foreign(key) => {
                self.collector.needs.types.get(key).map_or_else(|| key.clone(), |found| found.name.clone())
            }
            Ty::Array(bounds, element) => {
                format!("ARRAY [{}] OF {}", bounds.join(", "), self.type_text(element, name))
            }
            Ty::Pointer(kind, inner) => {
                let inner = match &**inner {
                    Ty::Unknown => "BYTE".to_owned(),
                    Ty::Slot(slot) => match self.collector.slots.decided(*slot) {
                        Some(known) => self.type_text(known, name),
                        None => "BYTE".to_owned(),
                    },
                    other => self.type_text(other, name),
                };
                format!("{} {inner}", kind.text())
            }
            Ty::Slot(slot) => self.type_text(&self.collector.slots.last_choice(*slot), name),
        }
    }

    fn declared_name(&self, key: &str) -> String {
        let world = self.collector.world;
        let name = world.units.get(key).map(|unit| &unit.pou.name.text);
        let name = name.or_else(|| world.types.get(key).map(|named| &named.ast.name.text));
        let name = name.cloned().unwrap_or_else(|| key.to_owned());
        match key.rsplit_once('.') {
            Some((namespace, _)) => format!("{namespace}.{name}"),
            None => name,
        }
    }
}

/// The value of a constant; those of one file differ as far as there is room.
fn value_of(ty: ElementaryType, index: usize) -> usize {
    if ty.size() == 1 { FIRST_CONSTANT - index % FIRST_CONSTANT } else { FIRST_CONSTANT + index }
}

fn property_text(name: &str, ty: &str, is_read: bool, is_written: bool) -> String {
    let get = if is_read { "    GET END_GET\n" } else { "" };
    let set = if is_written { "    SET END_SET\n" } else { "" };
    format!("PROPERTY {name} : {ty}\n{get}{set}END_PROPERTY\n")
}

/// True if anything is of the type: an anonymous one may have been made for what turned out to be known.
fn is_used(found: &Foreign) -> bool {
    !found.members.is_empty() || found.called
}

fn members(found: &Foreign) -> impl Iterator<Item = &Member> {
    // What a drawing knows by its number has no name that could be declared.
    let named = |member: &&Member| !member.name.starts_with('`');
    found.order.iter().filter_map(|key| found.members.get(key)).filter(named)
}

/// The section of a generic block, whose constants have no names that anybody would know.
fn generic_constants(count: usize) -> String {
    if count == 0 {
        return String::new();
    }
    let lines: String = (1..=count).map(|index| format!("    generic{index} : DINT := 1;\n")).collect();
    format!("\nVAR_GENERIC CONSTANT\n{lines}END_VAR")
}

/// A type as a variable has it, which gets its bounds from nobody.
fn closed(ty: Ty) -> Ty {
    match ty {
        Ty::Array(bounds, element) => {
            let close = |bound: String| if bound == OPEN_BOUNDS { ANY_BOUNDS.to_owned() } else { bound };
            Ty::Array(bounds.into_iter().map(close).collect(), Box::new(closed(*element)))
        }
        Ty::Pointer(kind, inner) => Ty::Pointer(kind, Box::new(closed(*inner))),
        other => other,
    }
}
