//! Pragmas and what they stand before.

use super::token::{Token, TokenKind};

/// Starts of the tokens that a pragma is before of which `is_it` is true, with other trivia in between at most; it gets
/// what stands between the braces.
pub fn behind_pragma(tokens: &[Token], text: &str, is_it: impl Fn(&str) -> bool) -> Vec<u32> {
    let mut found = Vec::new();
    let mut is_behind = false;
    for token in tokens {
        if token.kind == TokenKind::Pragma {
            let pragma = text.get(token.start as usize..token.end as usize).unwrap_or("");
            is_behind |= is_it(pragma.trim_matches(['{', '}']).trim());
        } else if !token.kind.is_trivia() && std::mem::take(&mut is_behind) {
            found.push(token.start);
        }
    }
    found
}

/// What stands behind the word in `attribute 'name' := 'value'`, the inner part of a pragma.
pub(crate) fn attribute(pragma: &str) -> Option<&str> {
    let (word, rest) = pragma.split_once(char::is_whitespace)?;
    word.eq_ignore_ascii_case("attribute").then(|| rest.trim())
}

/// True for C code that sets variables, which `MatIEC` takes between braces.
pub(crate) fn sets_by_c(pragma: &str) -> bool {
    ["__SET_VAR(", "__SET_EXTERNAL(", "__SET_LOCATED(", "SetFbVar("].iter().any(|call| pragma.contains(call))
}
