//! The tags of test programs, which stand before them: `{attribute 'tags' := 'slow, boundary'}`.

use onescan_plc_shim::Dialect;
use onescan_plc_shim::syntax::token::{Keyword, TokenKind};
use onescan_plc_shim::syntax::tokenize_in;

/// The tags of the unit whose name begins at byte `name_start` of `text`. They stand between the
/// unit before and its first keyword, or between that and its name.
pub(super) fn tags(dialect: Dialect, text: &str, name_start: u32) -> Vec<String> {
    let tokens = tokenize_in(dialect, text);
    let before = tokens.iter().take_while(|token| token.start < name_start).collect::<Vec<_>>();
    let is_head = |kind: TokenKind| {
        kind.is_trivia()
            || kind == TokenKind::Identifier
            || matches!(kind, TokenKind::Keyword(Keyword::Program | Keyword::FunctionBlock))
    };
    let head = before.iter().rev().take_while(|token| is_head(token.kind));
    let pragmas = head.filter(|token| token.kind == TokenKind::Pragma);
    let mut all: Vec<Vec<String>> =
        pragmas.filter_map(|token| listed(text.get(token.start as usize..token.end as usize)?)).collect();
    all.reverse();
    all.concat()
}

/// The tags that a pragma lists; nothing if it is about something else.
fn listed(pragma: &str) -> Option<Vec<String>> {
    let inside = pragma.strip_prefix('{')?.strip_suffix('}')?.trim();
    let (attribute, value) = inside.split_once(":=")?;
    let (word, name) = attribute.trim().split_once(char::is_whitespace)?;
    if !word.eq_ignore_ascii_case("attribute") || name.trim() != "'tags'" {
        return None;
    }
    let value = value.trim().strip_prefix('\'')?.strip_suffix('\'')?;
    Some(value.split(',').map(|tag| tag.trim().to_owned()).filter(|tag| !tag.is_empty()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_stand_before_their_test() {
        let text = "{attribute 'tags' := 'first'}\nPROGRAM TEST_A x := 1; END_PROGRAM\n\
                    {attribute 'hide'} (* slow *)\n{attribute 'tags' := 'slow, boundary'} {attribute 'tags' := 'm 1,'}\n\
                    PROGRAM PUBLIC {attribute 'tags' := 'within'} TEST_B END_PROGRAM PROGRAM TEST_C END_PROGRAM";
        let of = |name: &str| tags(Dialect::default(), text, text.find(name).unwrap() as u32);
        assert_eq!(of("TEST_A"), ["first"]);
        assert_eq!(of("TEST_B"), ["slow", "boundary", "m 1", "within"]);
        assert_eq!(of("TEST_C"), [""; 0]);
    }

    #[test]
    fn other_pragmas_have_none() {
        for pragma in
            ["{attribute 'tags'}", "{tags := 'a'}", "{attribute 'tag' := 'a'}", "{attribute 'tags' := a}", "{}"]
        {
            assert_eq!(listed(pragma), None, "{pragma}");
        }
        assert_eq!(listed("{ATTRIBUTE  'tags':=''}"), Some(Vec::new()));
    }
}
