//! Lines that differ in an index only, as one line with a range.

use std::collections::{BTreeMap, BTreeSet};

/// One line: texts of which some may have an index in common, as in `arm[3].on`.
pub(super) type Line = Vec<String>;

/// The lines with their runs of indices folded, in the order of their first ones.
pub(super) fn fold(lines: &[Line]) -> Vec<Line> {
    let mut groups: Vec<(Line, Option<(usize, usize)>)> = Vec::new();
    // Which groups a line would make longer, by its form and its index; the first of several comes first.
    let mut growing: BTreeMap<(Line, usize), BTreeSet<usize>> = BTreeMap::new();
    for line in lines {
        let Some(index) = line.iter().find_map(|text| first_index(text)) else {
            groups.push((line.clone(), None));
            continue;
        };
        let form: Line = line.iter().map(|text| text.replace(&format!("[{index}]"), "[#]")).collect();
        let longer = growing.get_mut(&(form.clone(), index)).and_then(BTreeSet::pop_first);
        let group = longer.unwrap_or(groups.len());
        match groups.get_mut(group) {
            Some((_, Some((_, last)))) => *last = index,
            _ => groups.push((form.clone(), Some((index, index)))),
        }
        if let Some(next) = index.checked_add(1) {
            growing.entry((form, next)).or_default().insert(group);
        }
    }
    groups.into_iter().map(|(form, range)| with_range(form, range)).collect()
}

fn with_range(form: Line, range: Option<(usize, usize)>) -> Line {
    let Some((first, last)) = range else { return form };
    let written = if first == last { format!("[{first}]") } else { format!("[{first}..{last}]") };
    form.into_iter().map(|text| text.replace("[#]", &written)).collect()
}

/// The first index in brackets.
fn first_index(text: &str) -> Option<usize> {
    text.split('[').skip(1).find_map(|rest| rest.split_once(']')?.0.parse().ok())
}

/// Names with their runs of indices folded, in the order of their first ones.
pub(super) fn fold_names(names: &[String]) -> Vec<String> {
    let lines: Vec<Line> = names.iter().map(|name| vec![name.clone()]).collect();
    fold(&lines).into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folded(names: &[&str]) -> Vec<String> {
        fold_names(&names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>())
    }

    #[test]
    fn runs_become_ranges() {
        assert_eq!(folded(&["a[0].x", "b", "a[1].x", "a[2].x", "a[4].x"]), ["a[0..2].x", "b", "a[4].x"]);
        assert_eq!(folded(&["a[9]", "a[10]", "c[x]"]), ["a[9..10]", "c[x]"]);
    }

    #[test]
    fn all_texts_of_a_line_go_along() {
        let line = |a: &str, b: &str| vec![a.to_owned(), b.to_owned()];
        let lines = [line("a[0].x", "P.b[0]"), line("a[1].x", "P.b[1]"), line("a[2].x", "Q")];
        assert_eq!(fold(&lines), [line("a[0..1].x", "P.b[0..1]"), line("a[2].x", "Q")]);
    }
}
