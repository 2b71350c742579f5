//! What a name says of a type, where its use says nothing. The rule is described in `docs/library-stubs.md`.

use super::ty::Ty;
use onescan_iec::ElementaryType as E;

/// Beginnings of names in the Hungarian way, which a capital or an underscore follows.
const PREFIXES: [(&str, E); 22] = [
    ("b", E::Bool),
    ("x", E::Bool),
    ("is", E::Bool),
    ("has", E::Bool),
    ("by", E::Byte),
    ("w", E::Word),
    ("dw", E::Dword),
    ("lw", E::Lword),
    ("si", E::Sint),
    ("i", E::Int),
    ("di", E::Dint),
    ("li", E::Lint),
    ("usi", E::Usint),
    ("ui", E::Uint),
    ("udi", E::Udint),
    ("uli", E::Ulint),
    ("n", E::Dint),
    ("r", E::Real),
    ("f", E::Lreal),
    ("lr", E::Lreal),
    ("t", E::Time),
    ("tim", E::Time),
];

/// Names of what is usually a flag.
const FLAGS: [&str; 10] =
    ["EXECUTE", "ENABLE", "DONE", "BUSY", "ERROR", "ACTIVE", "VALID", "RESET", "READY", "ABORTED"];

/// The type that a name hints at; DINT if it does not.
pub(super) fn of_name(name: &str) -> Ty {
    shown_type(name).unwrap_or(Ty::Elementary(E::Dint))
}

/// True for a name that hints at a type.
pub(super) fn shows_type(name: &str) -> bool {
    shown_type(name).is_some()
}

/// Beginnings that show whether something is given or taken, in front of the one that shows the type.
const DIRECTIONS: [&str; 4] = ["i_", "q_", "iq_", "io_"];

fn shown_type(name: &str) -> Option<Ty> {
    let name = name.trim_start_matches('_');
    let behind = DIRECTIONS.iter().find_map(|direction| name.strip_prefix(direction));
    if let Some(found) = behind.filter(|rest| rest.starts_with(char::is_lowercase)).and_then(shown_type) {
        return Some(found);
    }
    for (prefix, wide) in [("s", false), ("str", false), ("ws", true)] {
        if begins(name, prefix) {
            return Some(Ty::Text(wide));
        }
    }
    if FLAGS.iter().any(|flag| name.eq_ignore_ascii_case(flag))
        || capitals_after(name, "Is")
        || capitals_after(name, "Has")
    {
        return Some(Ty::Elementary(E::Bool));
    }
    let found = PREFIXES.iter().find(|(prefix, _)| begins(name, prefix));
    found.map(|(_, ty)| Ty::Elementary(*ty))
}

/// The type of what is compared with an integer or is given one: that of the name, if it is one for integers.
pub(super) fn integer(name: &str) -> Ty {
    match of_name(name) {
        Ty::Elementary(found) if found != E::Bool && !found.is_duration() => Ty::Elementary(found),
        _ => Ty::Elementary(E::Dint),
    }
}

/// The same for a real number.
pub(super) fn real(name: &str) -> E {
    if begins(name, "r") { E::Real } else { E::Lreal }
}

fn begins(name: &str, prefix: &str) -> bool {
    name.strip_prefix(prefix)
        .and_then(|rest| rest.chars().next())
        .is_some_and(|next| next.is_uppercase() || next == '_')
}

fn capitals_after(name: &str, word: &str) -> bool {
    name.strip_prefix(word).and_then(|rest| rest.chars().next()).is_some_and(char::is_uppercase)
}

/// What a type that nobody declares is, by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TypeHint {
    Block,
    Interface,
    Structure,
    Enumeration,
}

pub(super) fn of_type(name: &str) -> Option<TypeHint> {
    let name = name.rsplit('.').next().unwrap_or(name);
    let has = |prefix: &str| name.get(..prefix.len()).is_some_and(|start| start.eq_ignore_ascii_case(prefix));
    let second = name.chars().nth(1);
    if has("FB_") || begins(name, "fb") || has("MC_") {
        Some(TypeHint::Block)
    } else if has("I_")
        || has("ITF_")
        || name.starts_with('I') && second.is_some_and(char::is_uppercase) && !is_capitals(name)
    {
        Some(TypeHint::Interface)
    } else if has("ST_") || begins(name, "st") {
        Some(TypeHint::Structure)
    } else if has("E_") || begins(name, "e") {
        Some(TypeHint::Enumeration)
    } else {
        None
    }
}

fn is_capitals(name: &str) -> bool {
    !name.chars().any(char::is_lowercase)
}

/// True for names that are seldom members of a base: lists of globals, libraries, functions, constants.
pub(super) fn is_global(name: &str) -> bool {
    let has = |prefix: &str| name.get(..prefix.len()).is_some_and(|start| start.eq_ignore_ascii_case(prefix));
    name.starts_with("__")
        || has("GVL")
        || has("F_")
        || has("E_")
        || has("TC2_")
        || has("TC3_")
        || begins(name, "g")
        || begins(name, "e")
        || name.len() > 3 && is_capitals(name) && !name.starts_with('_')
}

/// True for names that TwinCAT's libraries have.
pub(super) fn is_library(name: &str) -> bool {
    let mut letters = name.chars();
    let start: String = letters.by_ref().take(2).collect();
    start.eq_ignore_ascii_case("Tc")
        && letters.next().is_some_and(|one| matches!(one, '2' | '3'))
        && letters.next() == Some('_')
}
