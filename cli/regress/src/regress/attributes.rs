//! The attributes that stand before test programs: `{attribute 'tags' := 'slow, boundary'}`, and those of CODESYS'
//! Test Manager: `test`, `testcasename`, `testcategory`, `testcasetimeout`.

use std::time::Duration;

use onescan_iec::syntax::token::{Keyword, Token, TokenKind};

/// The attributes of a unit.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Attributes(Vec<(String, Option<String>)>);

impl Attributes {
    /// Those of the unit whose name begins at byte `name_start` of `text`, whose `tokens` are all that it has. They stand
    /// between the unit before and its first keyword, or between that and its name.
    pub(super) fn of(tokens: &[Token], text: &str, name_start: u32) -> Self {
        let (before, _) = tokens.split_at(tokens.partition_point(|token| token.start < name_start));
        let is_head = |kind: TokenKind| {
            kind.is_trivia()
                || kind == TokenKind::Identifier
                || matches!(kind, TokenKind::Keyword(Keyword::Program | Keyword::FunctionBlock))
        };
        let head = before.iter().rev().take_while(|token| is_head(token.kind));
        let pragmas = head.filter(|token| token.kind == TokenKind::Pragma);
        let mut all: Vec<_> =
            pragmas.filter_map(|token| attribute(text.get(token.start as usize..token.end as usize)?)).collect();
        all.reverse();
        Self(all)
    }

    /// What a test is chosen by: `tags`, and the categories of CODESYS.
    pub(super) fn tags(&self) -> Vec<String> {
        let lists = self.0.iter().filter(|(name, _)| name == "tags" || name == "testcategory");
        lists.filter_map(|(_, value)| value.as_deref()).flat_map(listed).collect()
    }

    /// True with `{attribute 'test'}`, whatever its value.
    pub(super) fn is_test(&self) -> bool {
        self.0.iter().any(|(name, _)| name == "test")
    }

    /// True for a unit with several tests.
    pub(super) fn is_multitest(&self) -> bool {
        self.value("test").is_some_and(|value| value.eq_ignore_ascii_case("multitest"))
    }

    /// What a test is called, if not as its unit.
    pub(super) fn case_name(&self) -> Option<&str> {
        self.value("testcasename")
    }

    /// When a test has taken too long.
    pub(super) fn timeout(&self) -> Option<Duration> {
        self.value("testcasetimeout")?.trim().parse().ok().map(Duration::from_millis)
    }

    fn value(&self, name: &str) -> Option<&str> {
        self.0.iter().find(|(known, _)| known == name)?.1.as_deref()
    }
}

/// The name and the value of an attribute; nothing if a pragma is about something else.
fn attribute(pragma: &str) -> Option<(String, Option<String>)> {
    let inside = pragma.strip_prefix('{')?.strip_suffix('}')?.trim();
    let (word, rest) = inside.split_once(char::is_whitespace)?;
    if !word.eq_ignore_ascii_case("attribute") {
        return None;
    }
    let quoted = |text: &str| Some(text.trim().strip_prefix('\'')?.strip_suffix('\'')?.to_owned());
    match rest.split_once(":=") {
        Some((name, value)) => Some((quoted(name)?, Some(quoted(value)?))),
        None => Some((quoted(rest)?, None)),
    }
}

fn listed(value: &str) -> Vec<String> {
    value.split(',').map(|tag| tag.trim().to_owned()).filter(|tag| !tag.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use onescan_iec::Dialect;
    use onescan_iec::syntax::tokenize_in;

    use super::*;

    #[test]
    fn tags_stand_before_their_test() {
        let text = "{attribute 'tags' := 'first'}\nPROGRAM TEST_A x := 1; END_PROGRAM\n\
                    {attribute 'hide'} (* slow *)\n{attribute 'tags' := 'slow, boundary'} {attribute 'tags' := 'm 1,'}\n\
                    PROGRAM PUBLIC {attribute 'tags' := 'within'} TEST_B END_PROGRAM PROGRAM TEST_C END_PROGRAM";
        let tokens = tokenize_in(Dialect::default(), text);
        let of = |name: &str| Attributes::of(&tokens, text, text.find(name).unwrap() as u32).tags();
        assert_eq!(of("TEST_A"), ["first"]);
        assert_eq!(of("TEST_B"), ["slow", "boundary", "m 1", "within"]);
        assert_eq!(of("TEST_C"), [""; 0]);
    }

    #[test]
    fn attributes_of_the_test_manager_are_read() {
        let text = "{attribute 'test'} {attribute 'testcasename' := 'N:1'} {attribute 'testcategory' := 'fast,unit'}\n\
                    {attribute 'testcasetimeout' := '5000'}\nFUNCTION_BLOCK A END_FUNCTION_BLOCK\n\
                    {attribute 'test' := 'multitest'} FUNCTION_BLOCK B END_FUNCTION_BLOCK FUNCTION_BLOCK C END_FUNCTION_BLOCK";
        let tokens = tokenize_in(Dialect::Codesys, text);
        let of = |name: &str| Attributes::of(&tokens, text, text.find(name).unwrap() as u32);
        let [a, b, c] = ["A END", "B END", "C END"].map(of);
        assert_eq!(
            [&a, &b, &c].map(|unit| (unit.is_test(), unit.is_multitest())),
            [(true, false), (true, true), (false, false)]
        );
        assert_eq!((a.case_name(), b.case_name()), (Some("N:1"), None));
        assert_eq!((a.tags(), a.timeout()), (vec!["fast".to_owned(), "unit".to_owned()], Some(Duration::from_secs(5))));
    }

    #[test]
    fn other_pragmas_have_none() {
        for pragma in ["{tags := 'a'}", "{attribute 'tags' := a}", "{attribute tags := 'a'}", "{attribute}", "{}"] {
            assert_eq!(attribute(pragma), None, "{pragma}");
        }
        assert_eq!(attribute("{ATTRIBUTE  'tags':=''}"), Some(("tags".to_owned(), Some(String::new()))));
        assert_eq!(listed(""), [""; 0]);
    }
}
