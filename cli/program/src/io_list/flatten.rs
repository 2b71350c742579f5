//! Types as lists write them; arrays and structures taken apart into what a signal can be.

use onescan_base::SignalType;

/// How deep structures may lie in each other.
const DEPTH_MAX: usize = 16;

/// What a list says about a type that it declares itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Another name of this type: an alias, an enumeration, a subrange.
    Alias(String),
    /// A structure with these fields, each with its type.
    Structure(Vec<(String, String)>),
}

/// Types that a list declares.
pub trait Declared {
    /// The type of this name.
    fn shape(&self, name: &str) -> Option<&Shape>;
}

/// A list that declares no types.
pub struct Nothing;

impl Declared for Nothing {
    fn shape(&self, _: &str) -> Option<&Shape> {
        None
    }
}

/// A part of a variable: its path behind the variable's name, and its type, or why it has none that a signal can have.
pub type Part = (String, Result<SignalType, String>);

/// What is in a variable of type `ty`.
///
/// # Errors
/// It has more than `limit` parts.
pub fn flatten(ty: &str, declared: &dyn Declared, limit: usize) -> Result<Vec<Part>, String> {
    let mut parts = Vec::new();
    take_apart(String::new(), ty, declared, 0, limit, &mut parts)?;
    Ok(parts)
}

fn take_apart(
    path: String,
    ty: &str,
    declared: &dyn Declared,
    depth: usize,
    limit: usize,
    parts: &mut Vec<Part>,
) -> Result<(), String> {
    if parts.len() >= limit {
        return Err(format!("it has more than {limit} parts"));
    }
    if depth > DEPTH_MAX {
        parts.push((path, Err(format!("its type lies more than {DEPTH_MAX} levels deep"))));
        return Ok(());
    }
    if let Some((bounds, element)) = array(ty) {
        let Some(bounds) = bounds else {
            parts.push((path, Err(format!("the bounds of `{ty}` are not numbers"))));
            return Ok(());
        };
        let count = bounds.iter().try_fold(1_u64, |count, (low, high)| count.checked_mul((high - low + 1) as u64));
        if count.is_none_or(|count| count > limit as u64) {
            return Err(format!("`{ty}` has more than {limit} elements"));
        }
        for indices in Indices::new(&bounds) {
            take_apart(format!("{path}[{indices}]"), element, declared, depth + 1, limit, parts)?;
        }
        return Ok(());
    }
    if let Some(ty) = elementary(ty) {
        parts.push((path, Ok(ty)));
        return Ok(());
    }
    let unquoted = ty.trim().trim_matches('"');
    let bare = unquoted.rsplit('.').next().unwrap_or(unquoted);
    match declared.shape(unquoted).or_else(|| declared.shape(bare)) {
        Some(Shape::Alias(of)) => take_apart(path, of, declared, depth + 1, limit, parts),
        Some(Shape::Structure(fields)) => fields
            .iter()
            .try_for_each(|(name, ty)| take_apart(format!("{path}.{name}"), ty, declared, depth + 1, limit, parts)),
        None => {
            let why = format!("type `{}` is not elementary, and the list does not declare it", ty.trim());
            parts.push((path, Err(why)));
            Ok(())
        }
    }
}

/// The least and the greatest index of each dimension.
type Bounds = Vec<(i64, i64)>;

/// Bounds and elements of `ARRAY [0..3, 1..2] OF BYTE`; no bounds if they are not numbers.
fn array(ty: &str) -> Option<(Option<Bounds>, &str)> {
    let ty = ty.trim();
    let rest = ty.get(..5).filter(|head| head.eq_ignore_ascii_case("array")).and(ty.get(5..))?.trim_start();
    let (bounds, element) = rest.strip_prefix('[')?.split_once(']')?;
    let element = element.trim_start();
    let element = element.get(..2).filter(|of| of.eq_ignore_ascii_case("of")).and(element.get(2..))?.trim();
    let bound = |text: &str| -> Option<(i64, i64)> {
        let (low, high) = text.split_once("..")?;
        let (low, high) = (low.trim().parse::<i32>().ok()?, high.trim().parse::<i32>().ok()?);
        (low <= high).then_some((low.into(), high.into()))
    };
    Some((bounds.split(',').map(bound).collect(), element))
}

/// The indices of an array, the last one running fastest.
struct Indices<'a> {
    bounds: &'a [(i64, i64)],
    next: Option<Vec<i64>>,
}

impl<'a> Indices<'a> {
    fn new(bounds: &'a [(i64, i64)]) -> Self {
        Self { bounds, next: Some(bounds.iter().map(|(low, _)| *low).collect()) }
    }
}

impl Iterator for Indices<'_> {
    type Item = String;

    fn next(&mut self) -> Option<String> {
        let now = self.next.take()?;
        let mut next = now.clone();
        for (index, (low, high)) in next.iter_mut().zip(self.bounds).rev() {
            if *index < *high {
                *index += 1;
                self.next = Some(next);
                break;
            }
            *index = *low;
        }
        Some(now.iter().map(i64::to_string).collect::<Vec<_>>().join(","))
    }
}

/// The type of a signal that a tool calls `name`.
pub fn elementary(name: &str) -> Option<SignalType> {
    let upper = name.trim().to_ascii_uppercase();
    // A subrange `INT (0..10)` is a value of its base type.
    let base = match upper.split_once('(') {
        Some((text @ ("STRING" | "WSTRING"), length)) => format!("{text}[{}]", length.trim_end_matches(')').trim()),
        Some((base, range)) if range.contains("..") => base.trim().to_owned(),
        _ => upper,
    };
    match base.as_str() {
        "BIT" => Some(SignalType::BOOL),
        "BITARR8" => Some(SignalType::BYTE),
        "BITARR16" => Some(SignalType::WORD),
        "BITARR32" => Some(SignalType::DWORD),
        base => base.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    impl Declared for BTreeMap<&str, Shape> {
        fn shape(&self, name: &str) -> Option<&Shape> {
            self.get(name)
        }
    }

    fn listed(ty: &str, declared: &dyn Declared) -> Result<String, String> {
        let parts = flatten(ty, declared, 100)?;
        let parts = parts.into_iter().map(|(path, ty)| ty.map(|ty| format!("{path}:{ty}")));
        Ok(parts.collect::<Result<Vec<_>, _>>()?.join(" "))
    }

    #[test]
    fn types_are_taken_apart() {
        let axis =
            Shape::Structure(vec![("Pos".into(), "LREAL".into()), ("State".into(), "Array[0..1] of Bool".into())]);
        let types = BTreeMap::from([("Axis", axis), ("Mode", Shape::Alias("INT".into()))]);
        assert_eq!(listed("BIT", &types).unwrap(), ":BOOL");
        assert_eq!(listed("STRING(12)", &types).unwrap(), ":STRING[12]");
        assert_eq!(listed("int (0..10)", &types).unwrap(), ":INT");
        assert_eq!(listed("Mode", &types).unwrap(), ":INT");
        assert_eq!(listed("Lib.Axis", &types).unwrap(), ".Pos:LREAL .State[0]:BOOL .State[1]:BOOL");
        assert_eq!(
            listed("ARRAY [-1..0, 2..3] OF BYTE", &types).unwrap(),
            "[-1,2]:BYTE [-1,3]:BYTE [0,2]:BYTE [0,3]:BYTE"
        );
    }

    #[test]
    fn what_cannot_be_taken_apart_says_why() {
        let circle = BTreeMap::from([("A", Shape::Structure(vec![("a".into(), "A".into())]))]);
        for (ty, why) in [
            ("A", "levels deep"),
            ("POINTER TO INT", "not elementary"),
            ("ARRAY [0..N] OF INT", "not numbers"),
            ("ARRAY [1..0] OF INT", "not numbers"),
            ("ARRAY [0..2147483647, 0..2147483647, 0..2147483647] OF INT", "more than 100"),
            ("ARRAY [0..99] OF ARRAY [0..99] OF INT", "more than 100"),
            ("", "not elementary"),
        ] {
            assert!(listed(ty, &circle).unwrap_err().contains(why), "{ty}: {:?}", listed(ty, &circle));
        }
    }
}
