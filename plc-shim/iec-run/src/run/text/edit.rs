//! Order, search and pieces of strings (2nd ed. 2.5.1.5.5 Table 29).

use std::cmp::Ordering;
use std::ops::Range;

use super::view::{Target, View};
use onescan_iec::ir::text::Edit;

/// How two strings are ordered, character by character; a beginning comes before its whole.
pub(super) fn compare(memory: &[u8], left: &View, right: &View) -> i32 {
    if let (Some(left), Some(right)) = (left.narrow(memory), right.narrow(memory)) {
        return left.cmp(right) as i32;
    }
    let common = left.used.min(right.used);
    let differing = (0..common).map(|index| left.get(memory, index).cmp(&right.get(memory, index)));
    let order = differing.into_iter().find(|order| order.is_ne());
    match order.unwrap_or(left.used.cmp(&right.used)) {
        Ordering::Less => -1,
        Ordering::Equal => 0,
        Ordering::Greater => 1,
    }
}

/// Position of `part` in `whole` from 1, 0 if it is not there or empty; and how many characters
/// were looked at.
pub(super) fn find(memory: &[u8], whole: &View, part: &View) -> (i32, u64) {
    let mut steps = 0;
    if part.used == 0 || part.used > whole.used {
        return (0, steps);
    }
    if let (Some(whole), Some(part)) = (whole.narrow(memory), part.narrow(memory)) {
        return find_narrow(whole, part);
    }
    for start in 0..=whole.used - part.used {
        let mut index = 0;
        while index < part.used && whole.get(memory, start + index) == part.get(memory, index) {
            index += 1;
        }
        steps += index as u64 + 1;
        if index == part.used {
            return (start as i32 + 1, steps);
        }
    }
    (0, steps)
}

/// Compares only where the first character is found.
fn find_narrow(whole: &[u8], part: &[u8]) -> (i32, u64) {
    let (Some((first, rest)), mut from, mut steps) = (part.split_first(), 0, 0) else { return (0, 0) };
    let last = whole.len().saturating_sub(part.len());
    while let Some(starts) = whole.get(from..=last) {
        let Some(found) = starts.iter().position(|byte| byte == first) else { return (0, steps + starts.len() as u64) };
        steps += (found + part.len()) as u64;
        from += found + 1;
        if whole.get(from..from + rest.len()) == Some(rest) {
            return (from as i32, steps);
        }
    }
    (0, steps)
}

/// What the result is made of: a piece of the first string, all of the second or none, another
/// piece of the first.
struct Pieces {
    head: Range<usize>,
    middle: bool,
    tail: Range<usize>,
}

fn pieces(edit: Edit, used: usize, length: i64, position: i64) -> Pieces {
    let count = |number: i64| usize::try_from(number.max(0)).unwrap_or(usize::MAX);
    let length = count(length).min(used);
    let only = |head| Pieces { head, middle: false, tail: 0..0 };
    // Positions count from 1; one outside of the string takes or changes nothing.
    let inside = usize::try_from(position).ok().filter(|position| (1..=used).contains(position));
    let taken = inside.map(|position| position - 1..(position - 1 + length).min(used));
    match (edit, taken) {
        (Edit::Left, _) => only(0..length),
        (Edit::Right, _) => only(used - length..used),
        (Edit::Middle, taken) => only(taken.unwrap_or(0..0)),
        (Edit::Concat, _) => Pieces { head: 0..used, middle: true, tail: 0..0 },
        (Edit::Insert, _) => match usize::try_from(position).ok().filter(|position| *position <= used) {
            Some(position) => Pieces { head: 0..position, middle: true, tail: position..used },
            None => only(0..used),
        },
        (Edit::Delete, Some(taken)) => Pieces { head: 0..taken.start, middle: false, tail: taken.end..used },
        (Edit::Replace, Some(taken)) => Pieces { head: 0..taken.start, middle: true, tail: taken.end..used },
        (Edit::Fit | Edit::Delete | Edit::Replace, _) => only(0..used),
    }
}

/// Makes `target` of the strings.
pub(super) fn edit(memory: &mut [u8], edit: Edit, strings: [View; 2], length: i64, position: i64, mut target: Target) {
    let [first, second] = strings;
    let Pieces { head, middle, tail } = pieces(edit, first.used, length, position);
    debug_assert!(head.start <= head.end && head.end <= first.used, "the first piece lies within the first string");
    debug_assert!(tail.start <= tail.end && tail.end <= first.used, "the last piece lies within the first string");
    target.extend(memory, &first, head);
    if middle {
        target.extend(memory, &second, 0..second.used);
    }
    target.extend(memory, &first, tail);
    target.finish(memory);
}
