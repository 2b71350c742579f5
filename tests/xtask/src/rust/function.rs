//! The functions of a file, with their lines of code.

use super::token::{Kind, Token};

/// A function with a body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Function {
    pub(crate) name: String,
    pub(crate) line: usize,
    /// Lines with code, from its name to its closing brace: without blank lines and comments.
    pub(crate) code_lines: usize,
}

/// All functions in tokens, those inside others included.
pub(crate) fn functions(tokens: &[Token]) -> Vec<Function> {
    let code: Vec<&Token> = tokens.iter().filter(|token| !token.is_comment()).collect();
    let mut found = Vec::new();
    for (at, pair) in code.windows(2).enumerate() {
        // A type `fn(..)` has no name.
        let (true, Kind::Word(name)) = (pair[0].is_word("fn"), &pair[1].kind) else { continue };
        if let Some(body) = body(&code[at..]) {
            found.push(Function { name: name.clone(), line: pair[0].line, code_lines: code_lines(body) });
        }
    }
    found
}

/// The tokens from `fn` to the brace that closes its body; nothing for a declaration.
fn body<'c, 't>(code: &'c [&'t Token]) -> Option<&'c [&'t Token]> {
    let mut depth = 0_usize;
    let mut round = 0_usize;
    for (at, token) in code.iter().enumerate() {
        match token.kind {
            // Braces between parentheses or brackets belong to an argument or a constant.
            Kind::Mark('(' | '[') if depth == 0 => round += 1,
            Kind::Mark(')' | ']') if depth == 0 => round = round.checked_sub(1)?,
            Kind::Mark(';') if depth == 0 && round == 0 => return None,
            Kind::Mark('{') if round == 0 => depth += 1,
            Kind::Mark('}') if round == 0 => {
                depth = depth.checked_sub(1)?;
                if depth == 0 {
                    return Some(&code[..=at]);
                }
            }
            _ => {}
        }
    }
    None
}

fn code_lines(tokens: &[&Token]) -> usize {
    let (mut count, mut last) = (0, 0);
    for token in tokens {
        // A text of several lines has code on each of them.
        let from = token.line.max(last + 1);
        count += (token.end + 1).saturating_sub(from);
        last = last.max(token.end);
    }
    count
}

#[cfg(test)]
mod tests {
    use super::super::token::tokens;
    use super::*;

    fn found(text: &str) -> Vec<(String, usize, usize)> {
        functions(&tokens(text)).into_iter().map(|each| (each.name, each.line, each.code_lines)).collect()
    }

    #[test]
    fn blank_lines_and_comments_do_not_count() {
        let text = "fn a() {\n\n    // why\n    b(\"c\nd\");\n}\n";
        assert_eq!(found(text), [("a".to_owned(), 1, 4)]);
    }

    #[test]
    fn functions_inside_others_count_twice_and_declarations_never() {
        let text = "trait T { fn a(&self, b: [u8; 2]) -> fn(u8); }\nfn c(d: [u8; { 1 }]) {\n  fn e() {}\n}\n";
        assert_eq!(found(text), [("c".to_owned(), 2, 3), ("e".to_owned(), 3, 1)]);
    }
}
