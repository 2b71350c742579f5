//! Blocks of documentation: consecutive lines of `///` or `//!`.

use super::token::{Kind, Token};

/// Consecutive lines of documentation, joined by line ends.
pub(crate) fn blocks(tokens: &[Token]) -> Vec<String> {
    joined(tokens, |kind| match kind {
        Kind::Doc(text) => Some(text),
        _ => None,
    })
}

/// Consecutive lines of plain comments, joined by line ends: a sentence goes on from one to the next.
pub(crate) fn comments(tokens: &[Token]) -> Vec<String> {
    joined(tokens, |kind| match kind {
        Kind::Comment(text) => Some(text),
        _ => None,
    })
}

fn joined(tokens: &[Token], text: impl Fn(&Kind) -> Option<&String>) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut last: Option<usize> = None;
    for (at, token) in tokens.iter().enumerate() {
        let Some(text) = text(&token.kind) else { continue };
        // The next token and on the next line.
        let follows = last.is_some_and(|last| last + 1 == at && tokens[last].end + 1 == token.line);
        match found.last_mut().filter(|_| follows) {
            Some(block) => {
                block.push('\n');
                block.push_str(text);
            }
            None => found.push(text.clone()),
        }
        last = Some(at);
    }
    found
}

/// How many examples of a block `cargo test` runs.
pub(crate) fn runnable_examples(block: &str) -> usize {
    let mut open = false;
    let mut count = 0;
    for line in block.lines() {
        let Some(info) = line.trim().strip_prefix("```") else { continue };
        if !open && is_run(info) {
            count += 1;
        }
        open = !open;
    }
    count
}

/// Without a language it is Rust, and it is run unless it says otherwise.
fn is_run(info: &str) -> bool {
    let mut words = info.split([',', ' ']).filter(|word| !word.is_empty());
    words.all(|word| word == "rust" || word == "should_panic" || word.starts_with("edition"))
}

#[cfg(test)]
mod tests {
    use super::super::token::tokens;
    use super::*;

    #[test]
    fn blocks_end_with_the_code_between_them() {
        let found = tokens("/// a\n/// b\nstruct S {\n /// c\n\n /// d\n e: u8, // f\n}\n// g\n// h\n");
        assert_eq!(blocks(&found), ["a\nb", "c", "d"]);
        assert_eq!(comments(&found), ["f", "g\nh"]);
    }

    #[test]
    fn only_examples_that_are_run_count() {
        let block = "```\na\n```\n```text\nb\n```\n```no_run\nc\n```\n```rust,should_panic\nd\n```";
        assert_eq!(runnable_examples(block), 2);
    }
}
