//! Pragmas and what they stand before.

use super::token::{Token, TokenKind};

/// What `found` makes of pragmas, each with the start of the token that it stands before, with other trivia in between
/// at most; it gets what stands between the braces. Of several before one token the last one counts.
pub fn behind_pragma<T>(tokens: &[Token], text: &str, found: impl Fn(&str) -> Option<T>) -> Vec<(u32, T)> {
    let mut all = Vec::new();
    let mut open = None;
    for token in tokens {
        if token.kind == TokenKind::Pragma {
            let pragma = text.get(token.start as usize..token.end as usize).unwrap_or("");
            open = found(pragma.trim_matches(['{', '}']).trim()).or(open);
        } else if !token.kind.is_trivia() {
            all.extend(open.take().map(|found| (token.start, found)));
        }
    }
    all
}

/// True for the line `TITLE = "Complete Restart"`, which TIA Portal writes into a block of the start, whatever its name.
pub(crate) fn is_start_title(line: &str) -> bool {
    let title = line.split_once('=').filter(|(word, _)| word.trim().eq_ignore_ascii_case("TITLE"));
    title.is_some_and(|(_, title)| title.trim().trim_matches(['"', '\'']).eq_ignore_ascii_case("Complete Restart"))
}

/// Most bytes that members of a structure are aligned to, of `attribute 'pack_mode' := '1'`. 0 and 8 leave them as
/// they are.
pub(crate) fn packing(pragma: &str) -> Option<u32> {
    match pack_mode(pragma)? {
        "1" => Some(1),
        "2" => Some(2),
        "4" => Some(4),
        _ => None,
    }
}

/// True for a `pack_mode` that the tools have.
pub(crate) fn is_packing(pragma: &str) -> bool {
    pack_mode(pragma).is_some_and(|mode| ["0", "1", "2", "4", "8"].contains(&mode))
}

fn pack_mode(pragma: &str) -> Option<&str> {
    let (name, value) = attribute(pragma)?.split_once(":=")?;
    let is_it = name.trim().eq_ignore_ascii_case("'pack_mode'");
    is_it.then(|| value.trim().trim_matches('\'').trim())
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
