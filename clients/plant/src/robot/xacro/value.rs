//! Values of xacro's properties: those of Python that a robot's file uses.

use std::fmt;

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    None,
    Bool(bool),
    Whole(i64),
    Number(f64),
    Text(String),
    List(Vec<Self>),
    Map(Vec<(String, Self)>),
}

impl Value {
    /// What a text without an expression is: a quoted text, a number, a truth value or itself.
    pub(super) fn literal(text: &str) -> Self {
        if let Some(inner) = text.strip_prefix('\'').and_then(|rest| rest.strip_suffix('\'')) {
            return Self::Text(inner.to_owned());
        }
        let trimmed = text.trim();
        if let Ok(whole) = trimmed.parse::<i64>() {
            return Self::Whole(whole);
        }
        match (trimmed, number(trimmed)) {
            (_, Some(number)) => Self::Number(number),
            ("true" | "True", None) => Self::Bool(true),
            ("false" | "False", None) => Self::Bool(false),
            _ => Self::Text(text.to_owned()),
        }
    }

    pub(super) fn number(&self) -> Option<f64> {
        match self {
            Self::Bool(flag) => Some(f64::from(u8::from(*flag))),
            Self::Whole(whole) => Some(*whole as f64),
            Self::Number(number) => Some(*number),
            Self::None | Self::Text(_) | Self::List(_) | Self::Map(_) => None,
        }
    }

    /// Whether Python takes it for true.
    pub(super) fn is_true(&self) -> bool {
        match self {
            Self::None => false,
            Self::Bool(flag) => *flag,
            Self::Whole(whole) => *whole != 0,
            Self::Number(number) => *number != 0.0,
            Self::Text(text) => !text.is_empty(),
            Self::List(list) => !list.is_empty(),
            Self::Map(map) => !map.is_empty(),
        }
    }

    /// Whether a condition of xacro holds; none for what is not a condition.
    pub(super) fn condition(&self) -> Option<bool> {
        match self {
            Self::Text(text) => match Self::literal(text) {
                Self::Text(_) => None,
                inner => inner.condition(),
            },
            // ROS takes any other value as Python does
            Self::None | Self::Bool(_) | Self::Whole(_) | Self::Number(_) | Self::List(_) | Self::Map(_) => {
                Some(self.is_true())
            }
        }
    }

    /// How many values and bytes it is made of.
    pub(super) fn size(&self) -> usize {
        match self {
            Self::None | Self::Bool(_) | Self::Whole(_) | Self::Number(_) => 1,
            Self::Text(text) => 1 + text.len(),
            Self::List(list) => 1 + list.iter().map(Self::size).sum::<usize>(),
            Self::Map(map) => 1 + map.iter().map(|(key, value)| key.len() + value.size()).sum::<usize>(),
        }
    }

    /// What it is, for people.
    pub(super) const fn sort(&self) -> &'static str {
        match self {
            Self::None => "None",
            Self::Bool(_) => "a truth value",
            Self::Whole(_) | Self::Number(_) => "a number",
            Self::Text(_) => "a text",
            Self::List(_) => "a list",
            Self::Map(_) => "a dictionary",
        }
    }

    /// Whether two values are equal, numbers by their size.
    pub(super) fn equals(&self, other: &Self) -> bool {
        match (self.number(), other.number()) {
            (Some(one), Some(other)) => one == other,
            _ => self == other,
        }
    }
}

/// A number as Python writes it; words such as `inf` and numbers with underscores are texts.
fn number(text: &str) -> Option<f64> {
    let first = text.trim_start_matches(['+', '-']).chars().next()?;
    let plain = (first.is_ascii_digit() || first == '.') && !text.contains('_');
    if plain { text.parse().ok() } else { None }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let inner = |value: &Self| match value {
            Self::Text(text) => format!("'{text}'"),
            other => other.to_string(),
        };
        match self {
            Self::None => f.write_str("None"),
            Self::Bool(flag) => f.write_str(if *flag { "True" } else { "False" }),
            Self::Whole(whole) => write!(f, "{whole}"),
            Self::Number(number) => write!(f, "{number:?}"),
            Self::Text(text) => f.write_str(text),
            Self::List(list) => write!(f, "[{}]", list.iter().map(inner).collect::<Vec<_>>().join(", ")),
            Self::Map(map) => {
                let entries: Vec<_> = map.iter().map(|(key, value)| format!("'{key}': {}", inner(value))).collect();
                write!(f, "{{{}}}", entries.join(", "))
            }
        }
    }
}

/// A value as a message names it.
pub(super) fn quoted(value: &Value) -> String {
    match value {
        Value::Text(text) => format!("the text '{text}'"),
        other => other.sort().to_owned(),
    }
}
