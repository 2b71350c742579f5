//! What a program is like, whatever its author called things and however it is laid out.

use std::collections::BTreeMap;

use onescan_iec::Input;
use onescan_iec::syntax::token::{Token, TokenKind};
use onescan_iec::syntax::tokenize_in;
use similar::{Algorithm, DiffOp, capture_diff_slices};

/// Longer programs are not compared token by token, which takes the product of both.
const TOKENS_MAX: usize = 8_000;

/// A hash of the tokens of all files: comments, blanks, pragmas and the names of files aside, each name in the place of the
/// first that stands there. Two programs that differ in names alone have one hash.
pub(super) fn of(program: &[Input]) -> String {
    let mut files: Vec<[u8; 32]> = program.iter().map(of_file).collect();
    files.sort_unstable();
    blake3::hash(files.as_flattened()).to_hex().to_string()
}

fn of_file(input: &Input) -> [u8; 32] {
    let text = input.file().text();
    let mut names: BTreeMap<String, usize> = BTreeMap::new();
    let mut hasher = blake3::Hasher::new();
    for token in tokens(input) {
        let own = text.get(token.start as usize..token.end as usize).unwrap_or_default();
        match token.kind {
            TokenKind::Identifier | TokenKind::Wire => {
                let next = names.len();
                let number = *names.entry(own.to_ascii_lowercase()).or_insert(next);
                hasher.update(b"n").update(&number.to_le_bytes());
            }
            TokenKind::String | TokenKind::WideString => {
                hasher.update(b"s").update(own.as_bytes());
            }
            _ => {
                hasher.update(b"t").update(own.to_ascii_uppercase().as_bytes());
            }
        }
        hasher.update(&[0]);
    }
    *hasher.finalize().as_bytes()
}

fn tokens(input: &Input) -> impl Iterator<Item = Token> {
    let file = input.file();
    tokenize_in(file.dialect(), file.text()).into_iter().filter(|token| !token.kind.is_trivia())
}

/// How much of two programs is the same, names included, %; nothing where they are too long for it.
pub(super) fn likeness_pct(a: &[Input], b: &[Input]) -> Option<usize> {
    let [a, b] = [a, b].map(words);
    let both = a.len() + b.len();
    if both == 0 || a.len().max(b.len()) > TOKENS_MAX {
        return None;
    }
    let operations = capture_diff_slices(Algorithm::Myers, &a, &b);
    let equal = operations.iter().filter(|operation| matches!(operation, DiffOp::Equal { .. }));
    let equal: usize = equal.map(|operation| operation.old_range().len()).sum();
    Some(200 * equal / both)
}

fn words(program: &[Input]) -> Vec<String> {
    let of = |input: &Input| -> Vec<String> {
        let text = input.file().text();
        let word = |token: Token| text.get(token.start as usize..token.end as usize).map(str::to_ascii_lowercase);
        tokens(input).filter_map(word).collect()
    };
    program.iter().flat_map(of).collect()
}

#[cfg(test)]
mod tests {
    use onescan_iec::input::kind::SourceKind;

    use super::*;

    fn program(text: &str) -> Vec<Input> {
        vec![Input::from_text("main.st", SourceKind::Text, text)]
    }

    const ONE: &str = "PROGRAM Main VAR a, b : BOOL; END_VAR a := NOT b; (* here *) END_PROGRAM";

    #[test]
    fn names_comments_and_blanks_do_not_count() {
        let renamed = "program Main\nvar x, y : bool; end_var // there\n  X := not Y;\nend_program";
        assert_eq!(of(&program(ONE)), of(&program(renamed)));
        for other in
            [ONE.replace("NOT b", "b"), ONE.replace("NOT b", "NOT a"), ONE.replace(":= NOT", ":= TRUE AND NOT")]
        {
            assert_ne!(of(&program(ONE)), of(&program(&other)), "{other}");
        }
    }

    #[test]
    fn the_order_of_files_does_not_count() {
        let two = |first: &str, second: &str| {
            vec![Input::from_text("a.st", SourceKind::Text, first), Input::from_text("b.st", SourceKind::Text, second)]
        };
        let other = "FUNCTION F : INT F := 1; END_FUNCTION";
        assert_eq!(of(&two(ONE, other)), of(&two(other, ONE)));
    }

    #[test]
    fn a_small_change_leaves_programs_alike() {
        assert_eq!(likeness_pct(&program(ONE), &program(ONE)), Some(100));
        let changed = likeness_pct(&program(ONE), &program(&ONE.replace("NOT b", "b"))).unwrap();
        assert!((80..100).contains(&changed), "{changed}");
        assert_eq!(likeness_pct(&[], &[]), None);
    }
}
