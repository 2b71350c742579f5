//! One file of Rust: its tokens, and which of its lines only tests compile.

use std::collections::BTreeSet;

use super::token::{Kind, Token, tokens};

/// The words of which one is in front of every item.
const ITEMS: [&str; 14] = [
    "const",
    "enum",
    "extern",
    "fn",
    "impl",
    "let",
    "macro_rules",
    "mod",
    "static",
    "struct",
    "trait",
    "type",
    "union",
    "use",
];

/// A file's tokens without those of tests.
#[derive(Debug)]
pub(crate) struct Source {
    /// All lines of the file.
    pub(crate) lines: usize,
    /// Lines of `#[cfg(test)]` and `#[test]` items, their attributes included.
    pub(crate) test_lines: usize,
    /// The tokens outside those items, comments included.
    pub(crate) tokens: Vec<Token>,
    /// All tokens.
    pub(crate) whole: Vec<Token>,
    /// Modules in files of their own that only tests compile.
    pub(crate) test_modules: BTreeSet<String>,
}

impl Source {
    pub(crate) fn new(text: &str) -> Self {
        let whole = tokens(text);
        let mut this = Self {
            lines: text.lines().count(),
            test_lines: 0,
            tokens: Vec::new(),
            whole: Vec::new(),
            test_modules: BTreeSet::new(),
        };
        let mut at = 0;
        while at < whole.len() {
            if !begins_test(&whole[at..]) {
                this.tokens.push(whole[at].clone());
                at += 1;
                continue;
            }
            let after = item_end(&whole, at);
            let item = &whole[at..after];
            if let (Some(first), Some(last)) = (item.first(), item.last()) {
                this.test_lines += last.end - first.line + 1;
            }
            this.test_modules.extend(declared_module(item));
            at = after;
        }
        this.whole = whole;
        this
    }
}

/// True for `#[test]` and for `#[cfg(test)]`, also with more conditions that must hold.
fn begins_test(tokens: &[Token]) -> bool {
    let is_word = |at: usize, word: &str| tokens.get(at).is_some_and(|token| token.is_word(word));
    let is_mark = |at: usize, mark: char| tokens.get(at).is_some_and(|token| token.is_mark(mark));
    if !is_mark(0, '#') || !is_mark(1, '[') {
        return false;
    }
    let plain = is_word(2, "test") && is_mark(3, ']');
    let cfg = is_word(2, "cfg") && (is_word(4, "test") || is_word(4, "all") && is_word(6, "test"));
    plain || cfg
}

/// Where the item that begins at `at` ends: after its `;` or its closing brace, or before the `,` or bracket that
/// ends an element of a list.
fn item_end(tokens: &[Token], mut at: usize) -> usize {
    let mut depth = 0_usize;
    // An item may have commas of its own, as between type parameters; an element ends with one.
    let mut is_element = true;
    while let Some(token) = tokens.get(at) {
        match &token.kind {
            Kind::Word(word) if depth == 0 => is_element &= !ITEMS.contains(&word.as_str()),
            Kind::Mark('{' | '[' | '(') => depth += 1,
            Kind::Mark('}' | ']' | ')') if depth == 0 => return at,
            Kind::Mark(close @ ('}' | ']' | ')')) => {
                depth -= 1;
                if depth == 0 && *close == '}' {
                    return at + 1;
                }
            }
            Kind::Mark(';') if depth == 0 => return at + 1,
            Kind::Mark(',') if depth == 0 && is_element => return at + 1,
            _ => {}
        }
        at += 1;
    }
    at
}

/// The name of a module that is declared here and stands in another file.
fn declared_module(item: &[Token]) -> Option<String> {
    let [.., keyword, name, end] = item else { return None };
    match &name.kind {
        Kind::Word(name) if keyword.is_word("mod") && end.is_mark(';') => Some(name.clone()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_of_tests_are_left_out() {
        let source = Source::new(
            "fn a() {}\n#[cfg(test)]\n#[expect(x)]\nmod tests {\n  fn b() {}\n}\n#[test]\nfn c() {}\nfn d() {}\n\
             #[cfg(test)]\nmod rig;\n",
        );
        assert_eq!((source.lines, source.test_lines), (11, 9));
        let words: Vec<_> =
            source.tokens.iter().filter(|token| token.is_word("a") || token.is_word("d")).map(|t| t.line).collect();
        assert_eq!(words, [1, 9]);
        assert!(!source.tokens.iter().any(|token| token.is_word("b") || token.is_word("c")));
        assert_eq!(source.test_modules, BTreeSet::from(["rig".to_owned()]));
    }

    #[test]
    fn an_element_of_a_list_that_only_tests_have_ends_with_the_list() {
        let source =
            Source::new("list! { a, #[cfg(test)] b, c, #[cfg(test)] d }\n#[test]\nfn e<F, G>() {}\nfn h() {}\n");
        let words = source.tokens.into_iter().filter_map(|token| match token.kind {
            Kind::Word(word) => Some(word),
            _ => None,
        });
        assert_eq!(words.collect::<Vec<_>>(), ["list", "a", "c", "fn", "h"]);
    }

    #[test]
    fn other_conditions_are_not_tests() {
        let source = Source::new("#[cfg(unix)]\nfn a() {}\n#[cfg(any(test, unix))]\nfn b() {}\n");
        assert_eq!(source.test_lines, 0);
        assert_eq!(Source::new("#[cfg(all(test, unix))]\nfn a() {}\n").test_lines, 2);
    }
}
