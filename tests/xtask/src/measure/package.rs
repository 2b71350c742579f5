//! Figures of one package, or of all together.

use std::collections::BTreeSet;

use serde::Serialize;

use crate::rust::doc::{blocks, runnable_examples};
use crate::rust::function::functions;
use crate::rust::package::File;
use crate::rust::token::{Kind, Token};

/// A file beyond this many lines has more than one subject, as a rule.
const FILE_LINES_MAX: usize = 500;
/// A function beyond this many lines of code does not fit on a screen.
const FUNCTION_LINES_MAX: usize = 60;
/// A block of docs with so few words says nothing that the name does not say.
const SHORT_DOC_WORDS_MAX: usize = 3;
/// What may follow `pub` of an item that others can name; re-exports name what is counted where it stands.
const ITEMS: [&str; 12] =
    ["async", "const", "enum", "extern", "fn", "macro", "mod", "static", "struct", "trait", "type", "union"];

/// Figures of a package. Lines, docs and functions of tests count as `test_lines` only.
#[derive(Debug, Serialize)]
pub(crate) struct PackageFigures {
    pub(crate) name: String,
    pub(crate) files: usize,
    pub(crate) source_lines: usize,
    pub(crate) test_lines: usize,
    pub(crate) file_lines_median: usize,
    pub(crate) file_lines_p90: usize,
    pub(crate) file_lines_max: usize,
    pub(crate) largest_file: String,
    pub(crate) files_over_500: usize,
    pub(crate) comment_percent: f64,
    pub(crate) doc_percent: f64,
    pub(crate) doc_blocks: usize,
    pub(crate) short_docs: usize,
    pub(crate) short_docs_percent: f64,
    pub(crate) unwrap_or_default: usize,
    pub(crate) let_underscore: usize,
    pub(crate) empty_arm: usize,
    pub(crate) asserts: usize,
    pub(crate) debug_asserts: usize,
    pub(crate) functions: usize,
    pub(crate) functions_over_60: usize,
    pub(crate) functions_over_60_percent: f64,
    pub(crate) public_items: usize,
    pub(crate) doc_examples: usize,
}

/// What is added up while files are read.
#[derive(Debug, Default, Clone)]
pub(crate) struct Tally {
    /// Lines and path of each file of the product.
    sizes: Vec<(usize, String)>,
    source_lines: usize,
    test_lines: usize,
    comment_lines: usize,
    doc_lines: usize,
    doc_blocks: usize,
    short_docs: usize,
    unwrap_or_default: usize,
    let_underscore: usize,
    empty_arm: usize,
    asserts: usize,
    debug_asserts: usize,
    functions: usize,
    functions_over_60: usize,
    public_items: usize,
    doc_examples: usize,
}

impl Tally {
    pub(crate) fn add(&mut self, file: &File) {
        let source = &file.source;
        if file.is_test {
            self.test_lines += source.lines;
            return;
        }
        let lines = source.lines.saturating_sub(source.test_lines);
        self.test_lines += source.test_lines;
        self.source_lines += lines;
        self.sizes.push((lines, file.path.to_string_lossy().replace('\\', "/")));
        self.explanations(&source.tokens);
        let code: Vec<&Token> = source.tokens.iter().filter(|token| !token.is_comment()).collect();
        for at in 0..code.len() {
            self.habits(&code[at..]);
        }
        let found = functions(&source.tokens);
        self.functions += found.len();
        self.functions_over_60 += found.iter().filter(|each| each.code_lines > FUNCTION_LINES_MAX).count();
    }

    fn explanations(&mut self, tokens: &[Token]) {
        let lines = |is: fn(&Kind) -> bool| {
            let found = tokens.iter().filter(|token| is(&token.kind));
            found.flat_map(|token| token.line..=token.end).collect::<BTreeSet<_>>().len()
        };
        self.comment_lines += lines(|kind| matches!(kind, Kind::Comment(_)));
        self.doc_lines += lines(|kind| matches!(kind, Kind::Doc(_)));
        for block in blocks(tokens) {
            self.doc_blocks += 1;
            self.short_docs += usize::from(block.split_whitespace().count() <= SHORT_DOC_WORDS_MAX);
            self.doc_examples += runnable_examples(&block);
        }
    }

    /// What begins with the first of these tokens.
    fn habits(&mut self, code: &[&Token]) {
        let Some(Kind::Word(word)) = code.first().map(|token| &token.kind) else { return };
        let is_mark = |at: usize, mark: char| code.get(at).is_some_and(|token| token.is_mark(mark));
        let counter = match word.as_str() {
            "unwrap_or_default" => &mut self.unwrap_or_default,
            "let" if code.get(1).is_some_and(|next| next.is_word("_")) && !is_mark(2, ',') => &mut self.let_underscore,
            "_" if is_mark(1, '=') && is_mark(2, '>') && is_mark(3, '{') && is_mark(4, '}') => &mut self.empty_arm,
            "assert" | "assert_eq" | "assert_ne" if is_mark(1, '!') => &mut self.asserts,
            "debug_assert" | "debug_assert_eq" | "debug_assert_ne" if is_mark(1, '!') => &mut self.debug_asserts,
            "pub" if code.get(1).is_some_and(|next| ITEMS.iter().any(|item| next.is_word(item))) => {
                &mut self.public_items
            }
            _ => return,
        };
        *counter += 1;
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        self.sizes.extend_from_slice(&other.sizes);
        self.source_lines += other.source_lines;
        self.test_lines += other.test_lines;
        self.comment_lines += other.comment_lines;
        self.doc_lines += other.doc_lines;
        self.doc_blocks += other.doc_blocks;
        self.short_docs += other.short_docs;
        self.unwrap_or_default += other.unwrap_or_default;
        self.let_underscore += other.let_underscore;
        self.empty_arm += other.empty_arm;
        self.asserts += other.asserts;
        self.debug_asserts += other.debug_asserts;
        self.functions += other.functions;
        self.functions_over_60 += other.functions_over_60;
        self.public_items += other.public_items;
        self.doc_examples += other.doc_examples;
    }

    pub(crate) fn figures(mut self, name: &str) -> PackageFigures {
        self.sizes.sort();
        let at = |share: usize| self.sizes.get(self.sizes.len() * share / 100).map_or(0, |(lines, _)| *lines);
        let (file_lines_max, largest_file) = self.sizes.last().cloned().unwrap_or_default();
        PackageFigures {
            name: name.to_owned(),
            files: self.sizes.len(),
            source_lines: self.source_lines,
            test_lines: self.test_lines,
            file_lines_median: at(50),
            file_lines_p90: at(90),
            file_lines_max,
            largest_file,
            files_over_500: self.sizes.iter().filter(|(lines, _)| *lines > FILE_LINES_MAX).count(),
            comment_percent: percent(self.comment_lines, self.source_lines),
            doc_percent: percent(self.doc_lines, self.source_lines),
            doc_blocks: self.doc_blocks,
            short_docs: self.short_docs,
            short_docs_percent: percent(self.short_docs, self.doc_blocks),
            unwrap_or_default: self.unwrap_or_default,
            let_underscore: self.let_underscore,
            empty_arm: self.empty_arm,
            asserts: self.asserts,
            debug_asserts: self.debug_asserts,
            functions: self.functions,
            functions_over_60: self.functions_over_60,
            functions_over_60_percent: percent(self.functions_over_60, self.functions),
            public_items: self.public_items,
            doc_examples: self.doc_examples,
        }
    }
}

/// With two decimals; 0 of nothing.
fn percent(part: usize, whole: usize) -> f64 {
    if whole == 0 { 0.0 } else { (10_000.0 * part as f64 / whole as f64).round() / 100.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rust::source::Source;

    fn figures(text: &str) -> PackageFigures {
        let mut tally = Tally::default();
        tally.add(&File { path: "a/src/lib.rs".into(), source: Source::new(text), is_test: false });
        tally.figures("a")
    }

    #[test]
    fn habits_are_counted_outside_of_tests_only() {
        let text = "pub fn a() { let _ = b(); let _x = 1; match c { _ => {} } }\n\
                    pub(crate) fn d() { e.unwrap_or_default(); assert!(f); debug_assert_eq!(g, h); }\n\
                    #[cfg(test)]\nmod tests { fn i() { let _ = j(); assert!(k); } }\n";
        let found = figures(text);
        assert_eq!((found.let_underscore, found.empty_arm, found.unwrap_or_default), (1, 1, 1));
        assert_eq!((found.asserts, found.debug_asserts, found.public_items, found.functions), (1, 1, 1, 2));
        assert_eq!((found.source_lines, found.test_lines), (2, 2));
    }

    #[test]
    fn docs_and_comments_are_shares_of_lines() {
        let found = figures("/// One two three.\n/// four\nfn a() {} // why\n/// Five.\nfn b() {}\n");
        assert_eq!((found.doc_blocks, found.short_docs, found.short_docs_percent), (2, 1, 50.0));
        assert_eq!((found.doc_percent, found.comment_percent), (60.0, 20.0));
    }

    #[test]
    fn only_functions_that_do_not_fit_on_a_screen_are_long() {
        let long = |lines: usize| format!("fn a() {{\n{}}}\n", "b();\n\n// c\n".repeat(lines - 2));
        assert_eq!(figures(&long(60)).functions_over_60, 0);
        assert_eq!(figures(&long(61)).functions_over_60, 1);
    }
}
