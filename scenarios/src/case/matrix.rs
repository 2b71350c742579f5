//! Every combination of values: the last key of the file changes fastest.

use std::ops::Range;

use toml::Value;

use super::Setting;

/// More combinations than this are a mistake.
pub const COMBINATIONS_MAX: usize = 10_000;

/// One key of a matrix and its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The path that is set.
    pub path: String,
    pub values: Vec<Value>,
    /// Where it stands in the file.
    pub place: Range<usize>,
}

/// A combination: what it adds to its case's name, and what it sets.
pub type Combination = (String, Vec<Setting>);

/// All combinations; one that is empty where there are no axes, none where they are too many.
pub fn combinations(axes: &[Axis]) -> Option<Vec<Combination>> {
    let count = axes.iter().try_fold(1_usize, |count, axis| count.checked_mul(axis.values.len()))?;
    if count > COMBINATIONS_MAX {
        return None;
    }
    let mut all: Vec<Combination> = vec![(String::new(), Vec::new())];
    for axis in axes {
        let label = label(axis, axes);
        let mut next = Vec::with_capacity(all.len() * axis.values.len());
        for (name, settings) in &all {
            for value in &axis.values {
                let setting = Setting { path: axis.path.clone(), value: value.clone(), place: axis.place.clone() };
                next.push((format!("{name},{label}={}", word(value)), [&settings[..], &[setting]].concat()));
            }
        }
        all = next;
    }
    Some(all)
}

/// The last part of a path, or all of it where another ends in the same.
fn label(axis: &Axis, axes: &[Axis]) -> String {
    let last = |path: &str| path.rsplit('.').next().unwrap_or(path).to_owned();
    let own = last(&axis.path);
    let is_alone = axes.iter().filter(|other| last(&other.path) == own).count() == 1;
    named(if is_alone { &own } else { &axis.path })
}

/// A value in the name of a case.
fn word(value: &Value) -> String {
    named(&match value {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    })
}

/// What may stand in the name of a file on any system.
fn named(text: &str) -> String {
    let kept = |letter: char| letter.is_ascii_alphanumeric() || "-_.+".contains(letter);
    text.chars().map(|letter| if kept(letter) { letter } else { '_' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(path: &str, values: &[i64]) -> Axis {
        Axis { path: path.to_owned(), values: values.iter().map(|value| Value::Integer(*value)).collect(), place: 0..1 }
    }

    fn names(axes: &[Axis]) -> Vec<String> {
        combinations(axes).unwrap().into_iter().map(|(name, _)| name).collect()
    }

    #[test]
    fn the_last_key_changes_fastest() {
        assert_eq!(names(&[]), [""]);
        let all = names(&[axis("seed", &[1, 2]), axis("plant.a.x_m", &[3, 4])]);
        assert_eq!(all, [",seed=1,x_m=3", ",seed=1,x_m=4", ",seed=2,x_m=3", ",seed=2,x_m=4"]);
    }

    #[test]
    fn keys_that_end_alike_are_written_out() {
        assert_eq!(names(&[axis("plant.a.x", &[1]), axis("plant.b.x", &[2])]), [",plant.a.x=1,plant.b.x=2"]);
    }

    #[test]
    fn too_many_are_none() {
        let many: Vec<i64> = (0..101).collect();
        assert_eq!(combinations(&[axis("a", &many), axis("b", &many)]), None);
    }
}
