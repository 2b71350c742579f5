//! The standard function blocks (2nd ed. 2.5.2.3), some functions, and PLCopen's motion blocks, as program text
//! like any other.

pub use super::motion_library::{GROUPS, MOTION, Motion};
use super::twincat_motion;
use super::vendor_library::{self, Part};
use crate::dialect::Dialect;
use crate::ir::ElementaryType;
use crate::syntax::token::{Keyword, Punctuation, TokenKind};
use crate::syntax::{SourceFile, tokenize};

/// What every program has: file names and texts.
pub const FILES: [(&str, &str); 11] = [
    ("iec/bcd.st", include_str!("../../library/bcd.st")),
    ("iec/bistable.st", include_str!("../../library/bistable.st")),
    ("iec/clock_and_semaphore.st", include_str!("../../library/clock_and_semaphore.st")),
    ("iec/counters.st", include_str!("../../library/counters.st")),
    ("iec/counters_by_type.st", include_str!("../../library/counters_by_type.st")),
    ("iec/date_and_time.st", include_str!("../../library/date_and_time.st")),
    ("iec/edge_detection.st", include_str!("../../library/edge_detection.st")),
    ("iec/long_date_and_time.st", include_str!("../../library/long_date_and_time.st")),
    ("iec/sequential_function_chart.st", include_str!("../../library/sequential_function_chart.st")),
    ("iec/timers.st", include_str!("../../library/timers.st")),
    ("iec/timers_by_type.st", include_str!("../../library/timers_by_type.st")),
];

/// Asserts of test programs. They have memory of their own and so are there only for those that use them.
const ASSERTS: (&str, &str) = ("iec/test/assert.st", include_str!("../../library/test/assert.st"));

/// Whether a source may mean an assert; one that does not has no use for [`ASSERTS`].
fn mentions_assert(text: &str) -> bool {
    text.as_bytes().windows(6).any(|word| word.eq_ignore_ascii_case(b"ASSERT"))
}

/// True for the name, in capitals, of a function that checks something in a test.
pub fn is_assert(key: &str) -> bool {
    let of_type = |ty: &str| ty == "STRING" || ElementaryType::find(ty).is_some();
    matches!(key, "ASSERT" | "ASSERT_TRUE" | "ASSERT_FALSE") || key.strip_prefix("ASSERT_EQUAL_").is_some_and(of_type)
}

/// The library for a program of these files: nobody pays for motion control or asserts but who uses them.
pub fn for_program<'s>(files: impl Iterator<Item = &'s SourceFile>) -> Vec<SourceFile> {
    let texts: Vec<(&str, Dialect)> = files.map(|file| (&**file.text(), file.dialect())).collect();
    let motion = motion_for(&texts);
    let vendors = vendor_library::for_texts(&texts, motion);
    let core: &[_] = match motion {
        Motion::Plcopen => &MOTION,
        Motion::TwinCat if vendors.iter().any(Part::stands_on_an_axis) => twincat_motion::core(),
        Motion::TwinCat | Motion::None => &[],
    };
    let groups: &[_] = if motion == Motion::Plcopen && names_groups(&texts) { &GROUPS } else { &[] };
    let asserts = texts.iter().any(|(text, _)| mentions_assert(text)).then_some(&ASSERTS);
    let own =
        FILES.iter().chain(core).chain(groups).chain(asserts).map(|(name, text)| (*name, *text, Dialect::default()));
    let vendors = vendors.into_iter().map(|Part { name, text, dialect, .. }| (name, text, dialect));
    own.chain(vendors).map(|(name, text, dialect)| SourceFile::new(name, text).in_dialect(dialect)).collect()
}

/// What says that `Tc2_MC2` is meant where no axis does: other libraries of TwinCAT have names of it, too.
fn mentions_twincat_motion(text: &str) -> bool {
    let mut words = text.split(|character: char| !character.is_ascii_alphanumeric() && character != '_');
    words.any(|word| {
        ["Tc2_MC2", "NCTOPLC_AXIS_REF", "PLCTONC_AXIS_REF"].iter().any(|mark| word.eq_ignore_ascii_case(mark))
    })
}

fn motion_for(texts: &[(&str, Dialect)]) -> Motion {
    let is_twincat = texts.iter().any(|(_, dialect)| *dialect == Dialect::TwinCat);
    match texts.iter().filter_map(|(text, _)| named_in(text, "AXIS_REF")).max() {
        Some(Named::Used) if is_twincat => Motion::TwinCat,
        Some(Named::Used) => Motion::Plcopen,
        None if is_twincat && texts.iter().any(|(text, _)| mentions_twincat_motion(text)) => Motion::TwinCat,
        // A project with an axis of its own has its own blocks for it.
        Some(Named::Declared) | None => Motion::None,
    }
}

/// What a file has to do with the type of an axis, or of a group of axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Named {
    Used,
    /// The project brings its own, and the blocks for it.
    Declared,
}

/// Whether a program has groups of axes that it does not declare itself.
fn names_groups(texts: &[(&str, Dialect)]) -> bool {
    texts.iter().filter_map(|(text, _)| named_in(text, "AXES_GROUP_REF")).max() == Some(Named::Used)
}

/// `name` begins with four letters and a `_`.
fn named_in(text: &str, name: &str) -> Option<Named> {
    let is_it = |written: Option<&str>| written.is_some_and(|written| written.eq_ignore_ascii_case(name));
    let mut somewhere = text.match_indices('_').filter_map(|(at, _)| at.checked_sub(4));
    if !somewhere.any(|at| is_it(text.get(at..at + name.len()))) {
        return None;
    }
    let tokens: Vec<_> = tokenize(text).into_iter().filter(|token| !token.kind.is_trivia()).collect();
    let names = tokens.iter().enumerate().filter(|(_, token)| {
        token.kind == TokenKind::Identifier && is_it(text.get(token.start as usize..token.end as usize))
    });
    let declares = |at: usize| {
        let kind = |at: usize| tokens.get(at).map(|token| token.kind);
        kind(at + 1) == Some(TokenKind::Punctuation(Punctuation::Colon))
            || at.checked_sub(1).and_then(kind) == Some(TokenKind::Keyword(Keyword::FunctionBlock))
    };
    names.map(|(at, _)| if declares(at) { Named::Declared } else { Named::Used }).max()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn asserts_are_known_by_name() {
        let names: Vec<_> =
            ASSERTS.1.split("FUNCTION ").skip(1).filter_map(|rest| rest.split_whitespace().next()).collect();
        let asserts: Vec<_> = names.iter().filter(|name| name.starts_with("ASSERT")).collect();
        assert!(asserts.len() > 15 && asserts.iter().all(|name| is_assert(name)), "{asserts:?}");
        assert!(!is_assert("ASSERTTRUE") && !is_assert("ASSERT_EQUAL") && !is_assert("ASSERT_EQUAL_X"));
    }

    #[test]
    fn motion_control_is_for_who_names_an_axis() {
        for (text, found) in [
            ("PROGRAM P VAR a : TON; END_VAR END_PROGRAM", None),
            ("PROGRAM P (* AXIS_REF *) VAR my_AXIS_REFs, _ : INT; END_VAR END_PROGRAM", None),
            ("PROGRAM P VAR a : Axis_Ref; END_VAR END_PROGRAM", Some(Named::Used)),
            ("PROGRAM P VAR a : AXIS_REF := (Linked := TRUE); END_VAR END_PROGRAM", Some(Named::Used)),
            ("TYPE AXIS_REF : STRUCT a : INT; END_STRUCT END_TYPE", Some(Named::Declared)),
            ("VAR_GLOBAL x : AXIS_REF; END_VAR FUNCTION_BLOCK AXIS_REF END_FUNCTION_BLOCK", Some(Named::Declared)),
        ] {
            assert_eq!(named_in(text, "AXIS_REF"), found, "{text}");
            let file = SourceFile::new("a.st", text);
            let count = for_program([&file].into_iter()).len();
            let motion = if found == Some(Named::Used) { MOTION.len() } else { 0 };
            assert_eq!(count, FILES.len() + motion, "{text}");
        }
    }

    #[test]
    fn coordinated_motion_is_for_who_names_a_group() {
        for (text, expected) in [
            ("VAR a : AXIS_REF; g : Axes_Group_Ref; END_VAR", GROUPS.len()),
            ("VAR a : AXIS_REF; g : AXES_GROUP_REFS; END_VAR", 0),
            ("VAR a : AXIS_REF; END_VAR TYPE AXES_GROUP_REF : STRUCT n : INT; END_STRUCT END_TYPE", 0),
        ] {
            let file = SourceFile::new("a.st", text);
            let count = for_program([&file].into_iter()).len();
            assert_eq!(count, FILES.len() + MOTION.len() + expected, "{text}");
        }
    }

    #[test]
    fn twincat_has_motion_control_of_its_own() {
        let count = |text: &str| {
            let file = SourceFile::new("a.st", text).in_dialect(Dialect::TwinCat);
            let names: Vec<_> = for_program([&file].into_iter()).iter().map(|file| file.name().to_owned()).collect();
            let of = |start: &str| names.iter().filter(|name| name.starts_with(start)).count();
            (of("iec/motion/"), of("iec/vendor/tc2_mc2"))
        };
        assert_eq!(count("PROGRAM P VAR a : TON; END_VAR END_PROGRAM"), (0, 0));
        assert_eq!(count("VAR d : MC_Direction; s : NCTOPLC_AXIS_REF; END_VAR"), (0, 1), "types need no axis");
        assert_eq!(count("VAR a : AXIS_REF; END_VAR"), (MOTION.len() - 1, 2));
        assert_eq!(count("VAR d : MC_Direction; j : MC_Jog; END_VAR"), (0, 0), "of another library");
        assert_eq!(count("VAR j : Tc2_MC2.MC_Jog; END_VAR"), (MOTION.len() - 1, 3));
        assert_eq!(count("TYPE AXIS_REF : STRUCT a : INT; END_STRUCT END_TYPE VAR j : MC_Jog; END_VAR"), (0, 0));
    }

    #[test]
    fn every_source_of_motion_control_says_what_it_follows() {
        for (name, text) in MOTION.iter().chain(&GROUPS) {
            assert!(text.starts_with("(* ") && text.contains("Function blocks for motion control"), "{name}");
        }
    }
}
