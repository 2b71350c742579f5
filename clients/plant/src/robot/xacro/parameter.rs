//! The parameters of a macro, as in `name prefix:='' scale:=${2*unit} limits:=^|{} *origin **rest`.

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Parameter {
    pub(super) name: String,
    /// For elements, not a value: whether only the contents of the element are taken.
    pub(super) block: Option<bool>,
    pub(super) preset: Option<Preset>,
}

/// What a parameter is if a call does not say.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Preset {
    /// What the caller's property of the same name is, if there is one: `^`.
    pub(super) forwarded: bool,
    pub(super) text: Option<String>,
}

/// # Errors
/// What is not a parameter.
pub(super) fn parse(text: &str) -> Result<Vec<Parameter>, String> {
    words(text).iter().map(|word| parameter(word)).collect()
}

fn parameter(word: &str) -> Result<Parameter, String> {
    let name_end = word.find([':', '=']).unwrap_or(word.len());
    let (name, rest) = word.split_at(name_end);
    let stars = name.len() - name.trim_start_matches('*').len();
    let name = &name[stars..];
    let is_name = !name.is_empty() && name.chars().all(|letter| letter.is_alphanumeric() || letter == '_');
    let preset = rest.strip_prefix(":=").or_else(|| rest.strip_prefix('='));
    if !is_name || stars > 2 || (preset.is_none() && !rest.is_empty()) || (stars > 0 && preset.is_some()) {
        return Err(format!("`{word}` is not a parameter"));
    }
    let preset = preset.map(|text| match text.strip_prefix('^') {
        Some(rest) => Preset { forwarded: true, text: rest.strip_prefix('|').map(unquoted) },
        None => Preset { forwarded: false, text: Some(unquoted(text)) },
    });
    Ok(Parameter { name: name.to_owned(), block: (stars > 0).then_some(stars == 2), preset })
}

fn unquoted(text: &str) -> String {
    let inner = |quote: char| text.strip_prefix(quote).and_then(|rest| rest.strip_suffix(quote));
    inner('"').map_or_else(|| text.to_owned(), str::to_owned)
}

/// Words apart by blanks outside of quotes and brackets.
fn words(text: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let (mut quote, mut depth) = (None, 0_usize);
    for letter in text.chars() {
        match (quote, letter) {
            (Some(mark), letter) if mark == letter => quote = None,
            (None, '\'' | '"') => quote = Some(letter),
            (None, '{' | '(' | '[') => depth += 1,
            (None, '}' | ')' | ']') => depth = depth.saturating_sub(1),
            (None, letter) if letter.is_whitespace() && depth == 0 => {
                words.push(String::new());
                continue;
            }
            _ => {}
        }
        if let Some(word) = words.last_mut() {
            word.push(letter);
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_distinguished() {
        let read = parse("a b:='x y' c:=${1 + 2} d:=^ e:=^|0.5 *f **g h=1").unwrap();
        let preset = |k: usize| read[k].preset.clone().map(|preset| (preset.forwarded, preset.text));
        let some = |text: &str| Some(text.to_owned());
        assert_eq!(read.iter().map(|one| one.name.as_str()).collect::<String>(), "abcdefgh");
        assert_eq!([preset(0), preset(1)], [None, Some((false, some("'x y'")))]);
        assert_eq!([preset(2), preset(3)], [Some((false, some("${1 + 2}"))), Some((true, None))]);
        assert_eq!([preset(4), preset(7)], [Some((true, some("0.5"))), Some((false, some("1")))]);
        assert_eq!([read[0].block, read[5].block, read[6].block], [None, Some(false), Some(true)]);
        assert_eq!(parse("a:b"), Err("`a:b` is not a parameter".to_owned()));
        assert_eq!(parse("*a:=1"), Err("`*a:=1` is not a parameter".to_owned()));
    }
}
