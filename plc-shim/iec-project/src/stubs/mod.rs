//! Stubs of libraries whose source is not there: `{external}` declarations, made from how a project uses them.
//!
//! | module | subject |
//! |---|---|
//! | [`world`] | what the project declares |
//! | [`ty`], [`slots`] | types, slots for those that are not known, and what was wanted of them |
//! | [`hint`] | what a name says where its use does not |
//! | [`foreign`] | what is named and not declared, and how it is used |
//! | [`names`], [`namesake`] | what a name stands for |
//! | [`class`] | members of classes and structures |
//! | [`heirs`] | what classes of the project show of their bases and interfaces |
//! | [`instances`] | where instances go |
//! | [`collect`], [`initial`], [`statement`], [`expression`], [`call`], [`argument`] | one pass over the project |
//! | [`alike`] | structures that go into one another |
//! | [`shape`] | what a type that nobody declares is |
//! | [`print`], [`signature`] | all of it as program text |
//!
//! A pass collects evidence for each slot, and what it decides makes more of the next pass known, until nothing
//! changes. What has been written is then read as part of the project, and what is still missing is added, so that a
//! second run adds to a file and never takes away. Invariant: what is declared already is never declared again.

mod alike;
mod argument;
mod call;
mod class;
mod collect;
mod expression;
mod foreign;
mod heirs;
mod hint;
mod initial;
mod instances;
mod names;
mod namesake;
mod print;
mod shape;
mod signature;
mod slots;
mod statement;
#[cfg(test)]
mod tests;
mod ty;
mod world;

use self::collect::Collector;
use self::foreign::{Foreign, Needs};
use self::slots::Slots;
use self::ty::Ty;
use self::world::World;
use onescan_iec::dialect::{Dialect, Feature};
use onescan_iec::front::{Parsed, with_room};
use onescan_iec::input::Input;
use onescan_iec::input::kind::SourceKind;

/// The first line of a file of stubs: who finds it may add to the file.
pub const MARK: &str = "(* Library stubs, written by `onescan check --write-stubs` from how the project uses them. *)";

const HEAD: &str = "\
(* Each declaration stands for one whose source is not here: it counts, and a call of it does nothing. Types and
   parameters are guesses. Change what is wrong, and give a block a body (without `{external}`) where its behaviour
   matters: what stands here is kept when stubs are written again, and only what is missing is added. *)
";

/// So many times what was written is read again.
const MAX_ROUNDS: usize = 6;
/// So many passes decide types; each decides at least one more.
const MAX_PASSES: usize = 60;

/// The text of a file of stubs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stubs {
    /// All of it, what was there before in front.
    pub text: String,
    /// How many declarations are new.
    pub added: usize,
}

/// The stubs that `inputs` need, beside those of the text that is there already.
pub fn write(inputs: &[Input], present: Option<&str>) -> Stubs {
    let first = present.map_or_else(|| format!("{MARK}\n{HEAD}{}", pragma(inputs)), str::to_owned);
    let mut stubs = Stubs { text: first, added: 0 };
    with_room(|| {
        for _ in 0..MAX_ROUNDS {
            let next = completed(inputs, &stubs.text);
            stubs.added += next.added;
            if next.text == stubs.text {
                break;
            }
            stubs.text = next.text;
        }
    });
    stubs
}

/// Stubs are read in the dialect of the project, which says what a STRING is.
fn pragma(inputs: &[Input]) -> String {
    match dialect_of(inputs) {
        dialect if dialect == Dialect::default() => String::new(),
        dialect => format!("{{dialect '{dialect}'}}\n"),
    }
}

/// What most files have is the dialect of the project.
fn dialect_of(inputs: &[Input]) -> Dialect {
    let count = |dialect: Dialect| inputs.iter().filter(|input| input.file().dialect() == dialect).count();
    let most = Dialect::ALL.into_iter().max_by_key(|dialect| (count(*dialect), *dialect == Dialect::default()));
    most.unwrap_or_default()
}

/// The text with what is still missing.
fn completed(inputs: &[Input], text: &str) -> Stubs {
    // Read first: what a project has twice is its own.
    let own = Input::from_text(print::FILE, SourceKind::Text, text);
    let parsed = Parsed::new(inputs.iter().cloned().chain([own]));
    let file = parsed.sources.iter().map(|(id, _)| id).nth(inputs.len());
    let world = World::new(&parsed.units, &parsed.library, &parsed.sources);
    let mut collector = Collector {
        world: &world,
        slots: Slots::default(),
        needs: Needs::default(),
        known: None,
        nameless: std::collections::BTreeMap::new(),
        has_overloads: dialect_of(inputs).has(Feature::Overloads),
    };
    infer(&mut collector);
    print::completed(&mut collector, text, file)
}

fn infer(collector: &mut Collector<'_>) {
    for _ in 0..MAX_PASSES {
        collector.needs = fresh(std::mem::take(&mut collector.needs));
        collector.pass();
        collector.type_constants();
        let is_settled = collector.settle_instances();
        let heads = collector.needs.heads.clone();
        let related = foreign::Relations::of(&collector.needs.types);
        let is_new = collector.known.as_ref() != Some(&heads) || related != collector.needs.relations;
        collector.known = Some(heads);
        if !collector.slots.decide() && !is_new && !is_settled && !collector.unite() && !name_anonymous(collector) {
            return;
        }
    }
}

/// What outlives a pass: heads, and types that have got their names here.
fn fresh(needs: Needs) -> Needs {
    let relations = foreign::Relations::of(&needs.types);
    let types = needs.types.into_iter().filter(|(_, each)| each.is_anonymous).map(|(key, each)| {
        let kept = Foreign {
            name: each.name,
            value: each.value,
            is_value: each.is_value,
            implemented: each.implemented,
            is_anonymous: true,
            ..Foreign::default()
        };
        (key, kept)
    });
    Needs {
        types: types.collect(),
        relations,
        heads: needs.heads,
        libraries: needs.libraries,
        shadowed: needs.shadowed,
        aliases: needs.aliases,
        ..Needs::default()
    }
}

/// Gives types to slots whose members are used, where nothing else does; true if there was one.
fn name_anonymous(collector: &mut Collector<'_>) -> bool {
    let groups = collector.slots.anonymous();
    for group in &groups {
        let Some((_, path, _)) = group.iter().min_by_key(|(slot, ..)| *slot) else { continue };
        let name = anonymous_name(path);
        let key = name.to_ascii_uppercase();
        let is_value = group.iter().any(|(.., is_value)| *is_value);
        let found = collector.foreign(&key);
        found.name = name;
        found.is_anonymous = true;
        found.is_value = is_value;
        for (slot, ..) in group {
            collector.slots.set(*slot, Ty::Foreign(key.clone()));
        }
    }
    !groups.is_empty()
}

/// The name of a type that has none, by the path of what is of it.
pub(super) fn anonymous_name(path: &str) -> String {
    let path = path.strip_prefix("global:").unwrap_or(path);
    let path = path.replace('^', "_target").replace("[]", "_element").replace("()", "_result");
    let plain = |one: char| if one.is_ascii_alphanumeric() { one } else { '_' };
    let words: String = path.chars().map(plain).collect();
    let parts: Vec<&str> = words.split('_').filter(|part| !part.is_empty()).collect();
    let parts = parts.strip_prefix(&["T"]).unwrap_or(&parts);
    format!("T_{}", parts.join("_"))
}

/// True for generic types of vendors.
fn is_generic(key: &str) -> bool {
    matches!(key, "ANY" | "ANY_BIT" | "ANY_DATE" | "ANY_NUM" | "ANY_REAL" | "ANY_INT" | "ANY_STRING")
}
