//! Conversions of values to text and back, by what their names say (2nd ed. Table 22, 3rd ed. Table 27).

use crate::ir::ElementaryType;

/// A conversion that a string takes part in. Nothing stands for any type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::check) struct TextConversion {
    pub(in crate::check) from: Option<Sort>,
    pub(in crate::check) to: Sort,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::check) enum Sort {
    Text { wide: bool },
    Value(ElementaryType),
}

fn sort(name: &str) -> Option<Sort> {
    match name {
        "STRING" => Some(Sort::Text { wide: false }),
        "WSTRING" => Some(Sort::Text { wide: true }),
        _ => ElementaryType::find(name).map(Sort::Value),
    }
}

/// The conversion that `key`, in capitals, names.
pub(in crate::check) fn find(key: &str) -> Option<TextConversion> {
    if let Some(to) = key.strip_prefix("TO_").or_else(|| key.strip_prefix("ANY_TO_")) {
        let to = sort(to).filter(|to| matches!(to, Sort::Text { .. }))?;
        return Some(TextConversion { from: None, to });
    }
    let (from, to) = key.split_once("_TO_")?;
    let (from, to) = (sort(from)?, sort(to)?);
    let text = |sort| matches!(sort, Sort::Text { .. });
    (from != to && (text(from) || text(to))).then_some(TextConversion { from: Some(from), to })
}

#[cfg(test)]
mod tests {
    use super::find;

    #[test]
    fn names_are_taken_apart() {
        for known in
            ["INT_TO_STRING", "ANY_TO_WSTRING", "STRING_TO_LREAL", "WSTRING_TO_STRING", "TO_STRING", "BOOL_TO_WSTRING"]
        {
            assert!(find(known).is_some(), "{known}");
        }
        for unknown in ["STRING_TO_STRING", "INT_TO_REAL", "TO_INT", "STRING", "STRING_TO_X"] {
            assert!(find(unknown).is_none(), "{unknown}");
        }
    }
}
