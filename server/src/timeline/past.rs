//! Conditions judged image by image, with what they remember of earlier ones.
//!
//! What a condition remembers is bounded by its windows: a number for each change of its operand within them.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use super::condition::{Back, Condition, Edge, Relation};
use crate::signal::SignalName;

/// Finds what a comparison is with.
pub type Bind<'b, L, E> = dyn FnMut(&SignalName, Relation, &str) -> Result<L, E> + 'b;

/// A condition with what it compares bound to something that an image can be asked for.
#[derive(Clone, Debug)]
pub struct Judged<L> {
    part: Part<L>,
    memories: usize,
}

/// What a condition remembers: one of each of its operators on the past, in the order in which they are written.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Memories(Vec<Memory>);

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Memory {
    /// What the operand was on the image before.
    Before(Option<bool>),
    Runs(Runs),
}

#[derive(Clone, Debug)]
enum Part<L> {
    Leaf(L),
    All(Vec<Self>),
    Any(Vec<Self>),
    Not(Box<Self>),
    /// The last number is that of its memory.
    Edge(Edge, Box<Self>, usize),
    Once(Back, Box<Self>, usize),
    Historically(Back, Box<Self>, usize),
    Since(Back, Box<[Self; 2]>, usize),
}

impl<L> Judged<L> {
    /// Binds the comparisons of a condition.
    ///
    /// # Errors
    /// What `bind` says of one of them.
    pub fn new<E>(condition: &Condition, bind: &mut Bind<'_, L, E>) -> Result<Self, E> {
        let mut memories = 0;
        let part = Part::new(condition, bind, &mut memories)?;
        Ok(Self { part, memories })
    }

    /// What is remembered before the first image.
    pub fn nothing_seen(&self) -> Memories {
        let mut memories = vec![Memory::Before(None); self.memories];
        self.part.begin(&mut memories);
        Memories(memories)
    }

    /// True if these can be the memories of this condition: what a checkpoint says is not believed.
    pub fn fits(&self, memories: &Memories) -> bool {
        let alike = |(own, other): (&Memory, &Memory)| std::mem::discriminant(own) == std::mem::discriminant(other);
        let own = self.nothing_seen();
        own.0.len() == memories.0.len() && own.0.iter().zip(&memories.0).all(alike)
    }

    /// Whether it holds on the image of `t_ns`, which is later than all images before; `holds` judges a comparison.
    /// Every image must be shown, or its past is not what it was.
    pub fn judge(&self, memories: &mut Memories, t_ns: u64, holds: &mut dyn FnMut(&L) -> bool) -> bool {
        debug_assert_eq!(memories.0.len(), self.memories, "a condition has one memory per operator on the past");
        self.part.judge(&mut memories.0, t_ns, holds)
    }
}

impl<L> Part<L> {
    fn new<E>(condition: &Condition, bind: &mut Bind<'_, L, E>, memories: &mut usize) -> Result<Self, E> {
        let mut list = |all: &[Condition], memories: &mut usize| {
            all.iter().map(|one| Self::new(one, bind, memories)).collect::<Result<Vec<_>, E>>()
        };
        Ok(match condition {
            Condition::Compare { signal, relation, value } => Self::Leaf(bind(signal, *relation, value)?),
            Condition::All(all) => Self::All(list(all, memories)?),
            Condition::Any(all) => Self::Any(list(all, memories)?),
            Condition::Not(inner) => Self::Not(Box::new(Self::new(inner, bind, memories)?)),
            Condition::Edge(edge, inner) => {
                let own = next(memories);
                Self::Edge(*edge, Box::new(Self::new(inner, bind, memories)?), own)
            }
            Condition::Once(window, inner) => {
                let own = next(memories);
                Self::Once(*window, Box::new(Self::new(inner, bind, memories)?), own)
            }
            Condition::Historically(window, inner) => {
                let own = next(memories);
                Self::Historically(*window, Box::new(Self::new(inner, bind, memories)?), own)
            }
            Condition::Since(window, both) => {
                let own = next(memories);
                let [left, right] = &**both;
                let left = Self::new(left, bind, memories)?;
                Self::Since(*window, Box::new([left, Self::new(right, bind, memories)?]), own)
            }
        })
    }

    fn begin(&self, memories: &mut [Memory]) {
        match self {
            Self::Leaf(_) => {}
            Self::All(all) | Self::Any(all) => all.iter().for_each(|one| one.begin(memories)),
            Self::Not(inner) | Self::Edge(_, inner, _) => inner.begin(memories),
            Self::Once(_, inner, own) | Self::Historically(_, inner, own) => {
                memories[*own] = Memory::Runs(Runs::default());
                inner.begin(memories);
            }
            Self::Since(_, both, own) => {
                memories[*own] = Memory::Runs(Runs::default());
                both.iter().for_each(|one| one.begin(memories));
            }
        }
    }

    /// All operands are judged each time, since each may remember.
    fn judge(&self, memories: &mut [Memory], t_ns: u64, holds: &mut dyn FnMut(&L) -> bool) -> bool {
        match self {
            Self::Leaf(leaf) => holds(leaf),
            Self::All(all) => all.iter().fold(true, |so_far, one| one.judge(memories, t_ns, holds) & so_far),
            Self::Any(all) => all.iter().fold(false, |so_far, one| one.judge(memories, t_ns, holds) | so_far),
            Self::Not(inner) => !inner.judge(memories, t_ns, holds),
            Self::Edge(edge, inner, own) => {
                let now = inner.judge(memories, t_ns, holds);
                let Memory::Before(before) = &mut memories[*own] else { return false };
                before.replace(now).is_some_and(|before| match edge {
                    Edge::Rose => !before && now,
                    Edge::Fell => before && !now,
                    Edge::Changed => before != now,
                })
            }
            Self::Once(window, inner, own) => {
                let now = inner.judge(memories, t_ns, holds);
                runs(memories, *own).is_some_and(|runs| runs.take(*window, t_ns, now))
            }
            Self::Historically(window, inner, own) => {
                let now = inner.judge(memories, t_ns, holds);
                !runs(memories, *own).is_some_and(|runs| runs.take(*window, t_ns, !now))
            }
            Self::Since(window, both, own) => {
                let left = both[0].judge(memories, t_ns, holds);
                let right = both[1].judge(memories, t_ns, holds);
                runs(memories, *own).is_some_and(|runs| {
                    if !left {
                        runs.forget();
                    }
                    runs.take(*window, t_ns, right)
                })
            }
        }
    }
}

fn next(memories: &mut usize) -> usize {
    *memories += 1;
    *memories - 1
}

fn runs(memories: &mut [Memory], own: usize) -> Option<&mut Runs> {
    match memories.get_mut(own) {
        Some(Memory::Runs(runs)) => Some(runs),
        Some(Memory::Before(_)) | None => {
            debug_assert!(false, "memory {own} is of another operator, and `fits` refuses it");
            None
        }
    }
}

/// When an operand changed, and to what, the oldest first; each run lasts until the next one begins.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Runs(VecDeque<(u64, bool)>);

impl Runs {
    fn forget(&mut self) {
        self.0.clear();
    }

    /// Takes the next value, and says whether one within the window was true.
    fn take(&mut self, window: Back, t_ns: u64, now: bool) -> bool {
        let Back { from_ns, to_ns } = window;
        let near = t_ns.checked_sub(from_ns);
        // Without a far end, one true run that has come into the window stays there for good.
        let latched = to_ns.is_none()
            && self.0.front().is_some_and(|(start, value)| *value && near.is_some_and(|near| *start <= near));
        if latched {
            self.0.truncate(1);
            return true;
        }
        if self.0.back().is_none_or(|(_, last)| *last != now) {
            self.0.push_back((t_ns, now));
        }
        let passed = |second: u64| match to_ns {
            Some(to_ns) => t_ns.checked_sub(to_ns).is_some_and(|far| second <= far),
            None => near.is_some_and(|near| second <= near),
        };
        // A run without a far end is let go when it is false and the next one is in the window.
        while let (Some((_, first)), Some((second, _))) = (self.0.front(), self.0.get(1))
            && passed(*second)
            && (to_ns.is_some() || !*first)
        {
            self.0.pop_front();
        }
        near.is_some_and(|near| self.0.iter().any(|(start, value)| *value && *start <= near))
    }
}
