//! What differs between the files of two recorded scenarios.

use std::path::Path;

use onescan_base::regular;
use onescan_recording::Recording;
use serde::Serialize;

/// Lines of one file that are shown at most.
const LINES_MAX: usize = 12;

/// A file that is not the same in both.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FileDifference {
    /// Its path in the scenario.
    pub path: String,
    /// `changed`, or `only in A`, `only in B`.
    pub how: &'static str,
    /// Lines that only the first has, and those that only the second has, with their numbers.
    pub lines: Vec<(char, usize, String)>,
}

/// All files that differ, by path.
pub(super) fn differing(recordings: &[Recording; 2]) -> Vec<FileDifference> {
    let [a, b] = recordings.each_ref().map(|recording| &recording.header().provenance.files);
    let mut found = Vec::new();
    for file in a {
        let same_path = b.iter().find(|other| other.path == file.path);
        match same_path {
            None => found.push(FileDifference { path: file.path.clone(), how: "only in A", lines: Vec::new() }),
            Some(other) if other.blake3 != file.blake3 => {
                let lines = changed_lines(recordings, &file.path);
                found.push(FileDifference { path: file.path.clone(), how: "changed", lines });
            }
            Some(_) => {}
        }
    }
    for file in b.iter().filter(|file| a.iter().all(|other| other.path != file.path)) {
        found.push(FileDifference { path: file.path.clone(), how: "only in B", lines: Vec::new() });
    }
    found
}

fn changed_lines(recordings: &[Recording; 2], path: &str) -> Vec<(char, usize, String)> {
    let texts = recordings
        .each_ref()
        .map(|recording| regular::read_text(&recording.folder().join("scenario").join(Path::new(path))).ok());
    let [Some(a), Some(b)] = &texts else { return Vec::new() };
    between_common_ends(&a.lines().collect::<Vec<_>>(), &b.lines().collect::<Vec<_>>())
}

/// The lines between the common beginning and the common end.
fn between_common_ends(a: &[&str], b: &[&str]) -> Vec<(char, usize, String)> {
    let before = a.iter().zip(b).take_while(|(x, y)| x == y).count();
    let after = a[before..].iter().rev().zip(b[before..].iter().rev()).take_while(|(x, y)| x == y).count();
    let numbered = |mark: char, lines: &[&str]| -> Vec<(char, usize, String)> {
        let changed = lines[before..lines.len() - after].iter().enumerate();
        changed.take(LINES_MAX).map(|(index, line)| (mark, before + index + 1, (*line).to_owned())).collect()
    };
    [numbered('-', a), numbered('+', b)].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changed_lines_are_between_what_is_common() {
        let lines = between_common_ends(&["a", "x", "b", "b"], &["a", "y", "b", "b"]);
        assert_eq!(lines, [('-', 2, "x".to_owned()), ('+', 2, "y".to_owned())]);
        assert_eq!(between_common_ends(&["b", "b"], &["b"]), [('-', 2, "b".to_owned())]);
        assert_eq!(between_common_ends(&[], &[]), []);
    }
}
