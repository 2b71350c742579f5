//! Conditions as data: what images show, now and before.

use std::cmp::Ordering;
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::signal::SignalName;
use crate::time::VirtualTime;

/// Something that images show or do not show.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Condition {
    /// A signal compared with a value.
    Compare {
        signal: SignalName,
        relation: Relation,
        /// The value, in the text of the signal's type.
        value: String,
    },
    All(Vec<Condition>),
    /// At least one of these.
    Any(Vec<Condition>),
    Not(Box<Condition>),
    /// Different from the image before, in this way; false on the first image.
    Edge(Edge, Box<Condition>),
    /// At some time in the window back from now.
    Once(Back, Box<Condition>),
    /// At every time in the window back from now.
    Historically(Back, Box<Condition>),
    /// The second at some time in the window back from now, the first at all times since.
    Since(Back, Box<[Condition; 2]>),
}

/// How a condition differs from what it was on the image before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Edge {
    Rose,
    Fell,
    Changed,
}

/// A span of time back from now, in nanoseconds. The value that holds where it begins is in it; before the start there
/// is nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Back {
    pub from_ns: u64,
    /// Its far end; the start if absent.
    pub to_ns: Option<u64>,
}

impl Condition {
    /// True if one image does not decide it.
    pub fn has_past(&self) -> bool {
        match self {
            Self::Compare { .. } => false,
            Self::All(all) | Self::Any(all) => all.iter().any(Self::has_past),
            Self::Not(inner) => inner.has_past(),
            Self::Edge(..) | Self::Once(..) | Self::Historically(..) | Self::Since(..) => true,
        }
    }
}

/// How a signal compares with a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Relation {
    Equal,
    Unequal,
    Less,
    AtMost,
    Greater,
    AtLeast,
}

impl Relation {
    /// Nothing compares with NaN, so every relation but `<>` is false then.
    pub(super) fn holds(self, ordering: Option<Ordering>) -> bool {
        match self {
            Self::Equal => ordering == Some(Ordering::Equal),
            Self::Unequal => ordering != Some(Ordering::Equal),
            Self::Less => ordering == Some(Ordering::Less),
            Self::AtMost => matches!(ordering, Some(Ordering::Less | Ordering::Equal)),
            Self::Greater => ordering == Some(Ordering::Greater),
            Self::AtLeast => matches!(ordering, Some(Ordering::Greater | Ordering::Equal)),
        }
    }

    fn sign(self) -> &'static str {
        match self {
            Self::Equal => "=",
            Self::Unequal => "<>",
            Self::Less => "<",
            Self::AtMost => "<=",
            Self::Greater => ">",
            Self::AtLeast => ">=",
        }
    }
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list = |f: &mut fmt::Formatter<'_>, all: &[Self], word: &str| {
            for (index, one) in all.iter().enumerate() {
                if index > 0 {
                    write!(f, " {word} ")?;
                }
                match one {
                    Self::Compare { .. } | Self::Not(_) | Self::Edge(..) => write!(f, "{one}")?,
                    _ => write!(f, "({one})")?,
                }
            }
            Ok(())
        };
        match self {
            Self::Compare { signal, relation, value } => write!(f, "{signal} {} {value}", relation.sign()),
            Self::All(all) if all.is_empty() => f.write_str("always"),
            Self::All(all) => list(f, all, "and"),
            Self::Any(all) if all.is_empty() => f.write_str("never"),
            Self::Any(all) => list(f, all, "or"),
            Self::Not(inner) => write!(f, "not ({inner})"),
            Self::Edge(Edge::Rose, inner) => write!(f, "rose({inner})"),
            Self::Edge(Edge::Fell, inner) => write!(f, "fell({inner})"),
            Self::Edge(Edge::Changed, inner) => write!(f, "changed({inner})"),
            Self::Once(window, inner) => write!(f, "once{window} ({inner})"),
            Self::Historically(window, inner) => write!(f, "historically{window} ({inner})"),
            Self::Since(window, both) => write!(f, "({}) since{window} ({})", both[0], both[1]),
        }
    }
}

impl fmt::Display for Back {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let at = VirtualTime::from_nanos;
        match self {
            Self { from_ns: 0, to_ns: None } => Ok(()),
            Self { from_ns, to_ns: None } => write!(f, "[{},]", at(*from_ns)),
            Self { from_ns, to_ns: Some(to_ns) } => write!(f, "[{}, {}]", at(*from_ns), at(*to_ns)),
        }
    }
}
