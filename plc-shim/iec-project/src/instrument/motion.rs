//! Motion control for lockstep: PLCopen's blocks of `iec/motion`, moved by virtual time.
//!
//! A block of the shim holds one of the PLC's own, to which it hands everything on while not simulated: the inputs
//! and outputs that the project uses, so that a vendor's block need have no others.
//!
//! Coordinated motion (`iec/motion/group`) keeps its names: vendors' groups are other types, so that there is no block to
//! hand anything on to. While not simulated a group refuses to be enabled.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

use super::target::Target;
use super::template;
use crate::output::scl;
use onescan_iec::front::library;
use onescan_iec::syntax::ast::{CompilationUnit, Declaration, Pou, PouKind, SectionKind, TypeSpecKind};
use onescan_iec::syntax::{FileId, SourceFile, SourceMap, parse};

/// What a name is to motion control.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// A function block that the shim has.
    Block,
    /// The type of an axis.
    Axis,
    /// A type that stays the PLC's own: its values are the same.
    Vocabulary,
    /// A block or type of coordinated motion, which the shim has by the same name.
    Group,
    /// A block or type that the shim does not have; why.
    Foreign(&'static str),
}

/// What a project uses of a block.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Use {
    pub(super) inputs: BTreeSet<String>,
    pub(super) outputs: BTreeSet<String>,
}

/// What a name means, in capitals; nothing if it is not of motion control.
pub(super) fn role(key: &str) -> Option<Role> {
    let library = Library::get();
    if key == "AXIS_REF" {
        return Some(Role::Axis);
    }
    if key.starts_with("MC_CAM") {
        return Some(Role::Foreign("cam tables are each vendor's own"));
    }
    if library.blocks.contains_key(key) {
        return Some(Role::Block);
    }
    if library.types.contains_key(key) || VENDORS_TYPES.contains(&key) {
        return Some(Role::Vocabulary);
    }
    if is_of_groups(key) {
        return Some(Role::Group);
    }
    if key.starts_with("AXIS_REF_") {
        return Some(Role::Foreign("an axis of a device tree is not in the text"));
    }
    let is_motion = key.starts_with("MC_") || key.starts_with("SMC_");
    is_motion.then_some(Role::Foreign("it moves its axis by the PLC's own clock"))
}

/// Coordinated motion: its types, and its units by name in capitals.
fn groups() -> &'static Library {
    static GROUPS: OnceLock<Library> = OnceLock::new();
    GROUPS.get_or_init(|| Library::of(&library::GROUPS))
}

/// True for a name, in capitals, that a project may use of coordinated motion.
fn is_of_groups(key: &str) -> bool {
    let groups = groups();
    !key.starts_with("ONESCAN_") && (groups.blocks.contains_key(key) || groups.types.contains_key(key))
}

/// Vendors' names of PLCopen's enumerations.
const VENDORS_TYPES: [&str; 1] = ["MC_BUFFERMODE"];

/// What a target's own blocks have another interface for, with what differs.
pub(super) fn differs(target: Target, key: &str) -> Option<&'static str> {
    let differing: &[(&str, &str)] = match target {
        Target::TwinCat => &[
            ("MC_GEARIN", "the ratio is of other types in Tc2_MC2"),
            ("MC_READACTUALTORQUE", "Tc2_MC2 has no such block: take `NcToPlc.ActTorque` of the axis"),
            ("MC_MOVESUPERIMPOSED", "Tc2_MC2 has another block of this name"),
            ("MC_SETPOSITION", "the mode is another in Tc2_MC2"),
        ],
        _ => &[],
    };
    differing.iter().find(|(name, _)| *name == key).map(|(_, why)| *why)
}

/// The name that stands for a block or an axis.
pub(super) fn new_name(key: &str) -> String {
    format!("SDSP_{}", Library::get().spelling(key))
}

/// If `name` is one of the inputs of the block.
pub(super) fn is_input(block: &str, name: &str) -> bool {
    variables(block, SectionKind::Input).any(|each| each.eq_ignore_ascii_case(name))
}

/// If `name` is one of the outputs of the block.
pub(super) fn is_output(block: &str, name: &str) -> bool {
    variables(block, SectionKind::Output).any(|each| each.eq_ignore_ascii_case(name))
}

/// If `name` is an axis of the block.
pub(super) fn is_axis(block: &str, name: &str) -> bool {
    variables(block, SectionKind::InOut).any(|each| each.eq_ignore_ascii_case(name))
}

fn variables(block: &str, kind: SectionKind) -> impl Iterator<Item = &'static str> {
    let part = Library::get().blocks.get(block);
    let sections = part.into_iter().flat_map(|part| &part.pou.sections);
    let wanted = sections.filter(move |section| section.kind == kind);
    wanted.flat_map(|section| &section.variables).flat_map(|each| &each.names).map(|name| name.text.as_str())
}

/// A unit or type of the shim's own.
pub(super) struct Part {
    pub(super) name: String,
    pub(super) text: String,
    pub(super) is_type: bool,
}

/// The shim's motion control for what a project uses: each block by its name in capitals, and whether it has groups of axes.
pub(super) fn parts(target: Target, used: &BTreeMap<String, Use>, has_groups: bool) -> Vec<Part> {
    if used.is_empty() && !has_groups {
        return Vec::new();
    }
    if target == Target::Scl {
        return scl_parts(used);
    }
    let library = Library::get();
    let name = |written: &str| renamed(target, written);
    // PLCopen's enumerations are the PLC's own where it has motion control.
    let is_needed = |part: &&Type| !(target.has_motion() && part.name.starts_with("MC_"));
    let types = library.types.values().filter(is_needed);
    let types = types.map(|part| {
        let has_own = part.name == "AXIS_REF" && target.has_motion();
        let text = if has_own { with_own_axis(&part.text) } else { part.text.clone() };
        let text = format!("TYPE\n    {}\nEND_TYPE\n", template::fill_with(&text, &name));
        Part { name: name(&part.name).unwrap_or_else(|| part.name.clone()), text, is_type: true }
    });
    let blocks = used.iter().filter_map(|(key, uses)| Some((library.blocks.get(key)?, Some(uses))));
    // Where the PLC has no such block there is none to hand anything on to.
    let blocks = blocks.map(|(unit, uses)| (unit, uses.filter(|_| target.has_motion())));
    let (groups, of_groups) = if has_groups { (group_parts(target), groups_texts()) } else { (Vec::new(), Vec::new()) };
    let common = library.needed_by(used, of_groups).into_iter().map(|unit| (unit, None));
    let units = common.chain(blocks).map(|(part, uses)| {
        let text = uses.map_or_else(|| part.text.to_owned(), |uses| part.handing_on(uses));
        let text = format!("{}{}\n", part.about, template::fill_with(&text, &name));
        Part { name: name(&part.pou.name.text).unwrap_or_default(), text, is_type: false }
    });
    let (group_types, group_units): (Vec<Part>, Vec<Part>) = groups.into_iter().partition(|part| part.is_type);
    types.chain(group_types).chain(units).chain(group_units).collect()
}

/// The texts of coordinated motion.
fn groups_texts() -> Vec<&'static str> {
    library::GROUPS.iter().map(|(_, text)| *text).collect()
}

/// Coordinated motion as it is, on the shim's axes.
fn group_parts(target: Target) -> Vec<Part> {
    let groups = groups();
    let name = |written: &str| renamed(target, written);
    let types = groups.types.values().map(|part| {
        let text = format!("TYPE\n    {}\nEND_TYPE\n", template::fill_with(&part.text, &name));
        Part { name: name(&part.name).unwrap_or_else(|| part.name.clone()), text, is_type: true }
    });
    let units = groups.common.iter().chain(groups.blocks.values()).map(|unit| {
        let is_gate = unit.pou.name.text == "MC_GroupEnable" && target.has_motion();
        let text = if is_gate { unit.refusing_unless_simulated() } else { unit.text.to_owned() };
        let text = format!("{}{}\n", unit.about, template::fill_with(&text, &name));
        let own = &unit.pou.name.text;
        Part { name: name(own).unwrap_or_else(|| own.clone()), text, is_type: false }
    });
    types.chain(units).collect()
}

/// The same in SCL. TIA Portal has no axis of this kind: there is none to hand anything on to while not simulated.
fn scl_parts(used: &BTreeMap<String, Use>) -> Vec<Part> {
    let mut sources = SourceMap::default();
    let mut units = Vec::new();
    for (name, text) in library::MOTION {
        let id = sources.add(SourceFile::new(name, text));
        units.push((id, parse(id, text).unit));
    }
    let source = scl::Source { sources: &sources, units: &units, library: &BTreeSet::new() };
    let rename = |written: &str| match written {
        "ONESCAN_TV" => Some("\"SDSP\".SDSP_Now".to_owned()),
        _ => renamed(Target::Scl, written),
    };
    let parts = scl::library(source, &rename, &|key| key == "AXIS_REF" || used.contains_key(key));
    // A test shows that all of it has a form in SCL.
    let texts = parts.unwrap_or_default().into_iter();
    texts.map(|text| Part { name: String::new(), text, is_type: false }).collect()
}

/// An axis of the shim holds the PLC's own.
fn with_own_axis(text: &str) -> String {
    const OPENING: &str = "STRUCT\n";
    text.replacen(OPENING, "STRUCT\n        Own : Own_Axis;             (* while not simulated *)\n", 1)
}

/// How a name of the library is written in the shim.
fn renamed(target: Target, written: &str) -> Option<String> {
    match written {
        "ONESCAN_TV" => return Some("SDSP_Now".to_owned()),
        "Own_Axis" => return Some("AXIS_REF".to_owned()),
        _ => {}
    }
    if let Some(rest) = written.strip_prefix("ONESCAN_") {
        return Some(format!("SDSP_{rest}"));
    }
    if matches!(target, Target::Codesys | Target::TwinCat)
        && let Some((_, own)) = POINTERS.iter().find(|(standard, _)| *standard == written)
    {
        return Some((*own).to_owned());
    }
    if let Some(own) = written.strip_prefix("Own_") {
        return Some(own.to_owned());
    }
    let key = written.to_ascii_uppercase();
    let is_value = Library::get().values.contains(written) || groups().values.contains(written);
    if is_value || written == "AXIS_REF" || Library::get().blocks.contains_key(&key) {
        return Some(format!("SDSP_{written}"));
    }
    let vendors: &[(&str, &str)] = if target == Target::TwinCat { &TWINCAT } else { &[] };
    vendors.iter().find(|(name, _)| *name == written).map(|(_, new)| (*new).to_owned())
}

/// References of the standard as CODESYS and TwinCAT have them.
const POINTERS: [(&str, &str); 3] = [("REF_TO", "POINTER TO"), ("REF", "ADR"), ("NULL", "0")];

/// PLCopen's names in `Tc2_MC2`.
const TWINCAT: [(&str, &str); 12] = [
    ("WORD", "UDINT"),
    ("MC_BUFFER_MODE", "MC_BufferMode"),
    ("mcAborting", "MC_Aborting"),
    ("mcBuffered", "MC_Buffered"),
    ("mcBlendingLow", "MC_BlendingLow"),
    ("mcBlendingPrevious", "MC_BlendingPrevious"),
    ("mcBlendingNext", "MC_BlendingNext"),
    ("mcBlendingHigh", "MC_BlendingHigh"),
    ("mcPositiveDirection", "MC_Positive_Direction"),
    ("mcShortestWay", "MC_Shortest_Way"),
    ("mcNegativeDirection", "MC_Negative_Direction"),
    ("mcCurrentDirection", "MC_Current_Direction"),
];

/// The library's text, part by part.
struct Library {
    blocks: BTreeMap<String, Unit>,
    /// Functions and function blocks that blocks have in common.
    common: Vec<Unit>,
    types: BTreeMap<String, Type>,
    /// Values of enumerations that are not the PLC's own.
    values: BTreeSet<String>,
}

struct Unit {
    pou: Pou,
    /// The comment above it.
    about: &'static str,
    text: &'static str,
    /// Where its first statement begins in `text`.
    body: usize,
}

struct Type {
    name: String,
    text: String,
}

impl Library {
    fn get() -> &'static Self {
        static LIBRARY: OnceLock<Library> = OnceLock::new();
        LIBRARY.get_or_init(|| Self::of(&library::MOTION))
    }

    fn of(files: &[(&str, &'static str)]) -> Self {
        let mut library =
            Self { blocks: BTreeMap::new(), common: Vec::new(), types: BTreeMap::new(), values: BTreeSet::new() };
        for (_, text) in files {
            library.add(text, parse(FileId(0), text).unit);
        }
        library
    }

    fn add(&mut self, file: &'static str, unit: CompilationUnit) {
        for declaration in unit.declarations {
            match declaration {
                Declaration::Type(named) => {
                    if let TypeSpecKind::Enumeration(values, _) = &named.spec.kind
                        && !named.name.text.starts_with("MC_")
                    {
                        self.values.extend(values.iter().map(|value| value.name.text.clone()));
                    }
                    // The semicolon behind it may not be part of it.
                    let text = file.get(named.span.start as usize..named.span.end as usize).unwrap_or("");
                    let text = if text.ends_with(';') { text.to_owned() } else { format!("{text};") };
                    self.types.insert(named.name.key(), Type { name: named.name.text, text });
                }
                Declaration::Pou(pou) => {
                    let unit = Unit::new(file, pou);
                    if unit.pou.name.text.starts_with("MC_") && unit.pou.kind == PouKind::FunctionBlock {
                        self.blocks.insert(unit.pou.name.key(), unit);
                    } else {
                        self.common.push(unit);
                    }
                }
                _ => {}
            }
        }
    }

    /// What these blocks and `texts` have in common with others, and what that needs, in the library's order.
    fn needed_by(&self, used: &BTreeMap<String, Use>, mut texts: Vec<&'static str>) -> Vec<&Unit> {
        texts.extend(used.keys().filter_map(|key| Some(self.blocks.get(key)?.text)));
        let mut needed = vec![false; self.common.len()];
        while let Some(text) = texts.pop() {
            for (unit, needed) in self.common.iter().zip(&mut needed) {
                if !*needed && text.contains(unit.pou.name.text.as_str()) {
                    *needed = true;
                    texts.push(unit.text);
                }
            }
        }
        self.common.iter().zip(needed).filter_map(|(unit, needed)| needed.then_some(unit)).collect()
    }

    /// A name as the library writes it.
    fn spelling<'n>(&'n self, key: &'n str) -> &'n str {
        self.blocks.get(key).map_or(key, |unit| &unit.pou.name.text)
    }
}

impl Unit {
    fn new(file: &'static str, pou: Pou) -> Self {
        let (start, end) = (pou.span.start as usize, pou.span.end as usize);
        let before = file.get(..start).unwrap_or("").trim_end();
        let comment = if before.ends_with("*)") { before.rfind("(*") } else { None };
        // The comment at the head of a file is about all of it.
        let about = comment.filter(|at| *at > 0).and_then(|at| file.get(at..start)).unwrap_or("");
        let first = pou.body.first().map_or(end, |statement| statement.span.start as usize);
        let line = file.get(..first).and_then(|before| before.rfind('\n')).map_or(first, |at| at + 1);
        Self { about, text: file.get(start..end).unwrap_or(""), body: line.saturating_sub(start), pou }
    }

    /// The block's text, which gives an error while not simulated: there is nothing that would move the PLC's own axes.
    fn refusing_unless_simulated(&self) -> String {
        let (declared, body) = self.text.split_at_checked(self.body).unwrap_or((self.text, ""));
        format!(
            "{declared}VAR_EXTERNAL SDSP_Simulated : BOOL; END_VAR\n    IF NOT SDSP_Simulated THEN\n        Done := FALSE;\n        \
             Error := Execute;\n        ErrorID := SEL(Execute, 16#00, 16#30);\n        RETURN;\n    END_IF;\n{body}"
        )
    }

    /// The block's text, with the part that hands all on to the PLC's own block.
    fn handing_on(&self, uses: &Use) -> String {
        let key = self.pou.name.key();
        let used = |kind, wanted: &BTreeSet<String>| {
            let names = variables(&key, kind);
            names.filter(|name| wanted.contains(&name.to_ascii_uppercase())).collect::<Vec<_>>()
        };
        let axes = variables(&key, SectionKind::InOut).map(|axis| format!("{axis} := {axis}.Own"));
        let inputs = used(SectionKind::Input, &uses.inputs).into_iter().map(|input| format!("{input} := {input}"));
        let arguments: Vec<String> = axes.chain(inputs).collect();
        let outputs = used(SectionKind::Output, &uses.outputs);
        let outputs: String = outputs.iter().map(|output| format!("        {output} := Own.{output};\n")).collect();
        let (declared, body) = self.text.split_at_checked(self.body).unwrap_or((self.text, ""));
        let name = &self.pou.name.text;
        let short = arguments.join(", ");
        let arguments = if short.len() > 100 { arguments.join(",\n            ") } else { short };
        format!(
            "{declared}VAR Own : Own_{name}; END_VAR\nVAR_EXTERNAL SDSP_Simulated : BOOL; END_VAR\n    \
             IF NOT SDSP_Simulated THEN\n        Own({arguments});\n{outputs}        RETURN;\n    END_IF;\n{body}"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_has_its_role() {
        for (key, wanted) in [
            ("MC_POWER", Some(Role::Block)),
            ("AXIS_REF", Some(Role::Axis)),
            ("MC_BUFFER_MODE", Some(Role::Vocabulary)),
            ("MC_BUFFERMODE", Some(Role::Vocabulary)),
            ("TON", None),
        ] {
            assert_eq!(role(key), wanted, "{key}");
        }
        for key in ["MC_GROUPENABLE", "MC_MOVELINEARABSOLUTE", "AXES_GROUP_REF", "MC_KIN_REF", "MC_TRANSITION_MODE"] {
            assert_eq!(role(key), Some(Role::Group), "{key}");
        }
        for key in ["MC_CAMIN", "MC_CAM_REF", "MC_TOUCHPROBE", "SMC_FOLLOWPOSITION", "AXIS_REF_SM3"] {
            assert!(matches!(role(key), Some(Role::Foreign(_))), "{key}");
        }
        assert!(is_input("MC_POWER", "enable") && is_output("MC_POWER", "Status") && is_axis("MC_GEARIN", "slave"));
        assert!(!is_input("MC_POWER", "bRegulatorOn"));
        assert_eq!(new_name("MC_MOVEABSOLUTE"), "SDSP_MC_MoveAbsolute");
    }

    /// Every block that the shim has is there in SCL, and needs nothing that is not.
    #[test]
    fn all_of_it_has_a_form_in_scl() {
        let used = Library::get().blocks.keys().map(|key| (key.clone(), Use::default())).collect();
        let text: String = parts(Target::Scl, &used, false).into_iter().map(|part| part.text).collect();
        for unit in Library::get().blocks.values() {
            assert!(
                text.contains(&format!("FUNCTION_BLOCK \"SDSP_{}\"", unit.pou.name.text)),
                "{}",
                unit.pou.name.text
            );
        }
        assert!(text.contains("TYPE \"SDSP_AXIS_REF\"") && !text.contains("ONESCAN_"), "{text}");
    }

    #[test]
    fn a_block_hands_on_what_the_project_uses() {
        let uses = Use { inputs: ["ENABLE".to_owned()].into(), outputs: ["STATUS".to_owned()].into() };
        let parts = parts(Target::Iec, &[("MC_POWER".to_owned(), uses)].into(), false);
        let power = parts.iter().find(|part| part.name == "SDSP_MC_Power").map(|part| part.text.as_str());
        insta::assert_snapshot!(power.unwrap_or("none"));
        assert!(parts.iter().all(|part| !part.text.contains("ONESCAN_") && !part.name.is_empty()));
        assert!(parts.iter().any(|part| part.name == "SDSP_AXIS_REF" && part.text.contains("Own : AXIS_REF;")));
    }
}
