//! Submissions that are equal in what they do and in what they are like.

use std::collections::BTreeMap;

use super::marks::Graded;

/// Notes in each submission the names of those that are equal to it: in the digests of all cases, and in the structure of the
/// program. One that was handed in as it was handed out is equal to nothing.
pub(super) fn note(all: &mut [Graded]) {
    let names: Vec<String> = all.iter().map(|graded| graded.submission.name.clone()).collect();
    for group in groups(all) {
        for member in &group {
            let others = group.iter().filter(|other| *other != member);
            all[*member].alike = others.map(|other| names[*other].clone()).collect();
        }
    }
}

/// The numbers of those that are equal, two and more together, in the order of the first of each.
pub(super) fn groups(all: &[Graded]) -> Vec<Vec<usize>> {
    let mut found: BTreeMap<(String, Vec<String>), Vec<usize>> = BTreeMap::new();
    for (number, graded) in all.iter().enumerate() {
        let Some(read) = graded.read.as_ref().filter(|read| !read.is_as_handed_out) else { continue };
        let Some(digests) = graded.digests() else { continue };
        let key = (read.structure.clone(), digests.into_iter().map(str::to_owned).collect());
        found.entry(key).or_default().push(number);
    }
    let mut groups: Vec<Vec<usize>> = found.into_values().filter(|group| group.len() > 1).collect();
    groups.sort();
    groups
}
