//! A changed file as a unified diff.

use std::fmt::Write;

use super::File;

/// Lines shown before and behind a change.
const CONTEXT: usize = 3;

/// The changes of a file, as `diff -u` writes them; nothing if it has none.
pub fn unified(file: &File) -> String {
    let (before, after) = (file.before.as_deref().unwrap_or(""), file.text.as_deref().unwrap_or(""));
    if !file.is_changed() {
        return String::new();
    }
    let name = |exists: bool, side: &str| if exists { format!("{side}/{}", file.name) } else { "/dev/null".to_owned() };
    let mut text = format!("--- {}\n+++ {}\n", name(file.before.is_some(), "a"), name(file.text.is_some(), "b"));
    let (old, new): (Vec<&str>, Vec<&str>) =
        (before.split_inclusive('\n').collect(), after.split_inclusive('\n').collect());
    let script = script(&old, &new);
    for hunk in hunks(&script) {
        write_hunk(&script[hunk], &old, &new, &mut text);
    }
    text
}

/// A step from the old lines to the new.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Step {
    Keep(usize, usize),
    Delete(usize, usize),
    Insert(usize, usize),
}

/// Keeps equal lines as they come: what is put in never looks like what is there. A line that is not
/// found ahead was changed.
fn script(old: &[&str], new: &[&str]) -> Vec<Step> {
    let mut script = Vec::with_capacity(new.len());
    let (mut i, mut j) = (0, 0);
    while let (Some(was), Some(is)) = (old.get(i), new.get(j)) {
        if was == is {
            script.push(Step::Keep(i, j));
            (i, j) = (i + 1, j + 1);
            continue;
        }
        let ahead = |lines: &[&str], from: usize, line: &str| {
            lines.iter().skip(from).take(200).position(|other| *other == line)
        };
        match (ahead(new, j, was), ahead(old, i, is)) {
            (Some(_), None) => {
                script.push(Step::Insert(i, j));
                j += 1;
            }
            (Some(skip), Some(drop)) if skip <= drop => {
                script.push(Step::Insert(i, j));
                j += 1;
            }
            _ => {
                script.push(Step::Delete(i, j));
                i += 1;
            }
        }
    }
    script.extend((i..old.len()).map(|i| Step::Delete(i, j)));
    script.extend((j..new.len()).map(|j| Step::Insert(old.len(), j)));
    script
}

/// Ranges of steps that are shown together.
fn hunks(script: &[Step]) -> Vec<std::ops::Range<usize>> {
    let mut hunks: Vec<std::ops::Range<usize>> = Vec::new();
    let changes = script.iter().enumerate().filter(|(_, step)| !matches!(step, Step::Keep(..)));
    for (at, _) in changes {
        let (start, end) = (at.saturating_sub(CONTEXT), (at + 1 + CONTEXT).min(script.len()));
        match hunks.last_mut() {
            Some(last) if start <= last.end => last.end = end,
            _ => hunks.push(start..end),
        }
    }
    hunks
}

fn write_hunk(steps: &[Step], old: &[&str], new: &[&str], text: &mut String) {
    let Some(Step::Keep(i, j) | Step::Delete(i, j) | Step::Insert(i, j)) = steps.first().copied() else {
        return;
    };
    let olds = steps.iter().filter(|step| !matches!(step, Step::Insert(..))).count();
    let news = steps.iter().filter(|step| !matches!(step, Step::Delete(..))).count();
    let first = |at: usize, count: usize| if count == 0 { at } else { at + 1 };
    // Writing to a string does not fail.
    let _ = writeln!(text, "@@ -{},{olds} +{},{news} @@", first(i, olds), first(j, news));
    for step in steps {
        let (sign, line) = match *step {
            Step::Keep(i, _) => (' ', old.get(i)),
            Step::Delete(i, _) => ('-', old.get(i)),
            Step::Insert(_, j) => ('+', new.get(j)),
        };
        let line = line.copied().unwrap_or("");
        text.push(sign);
        text.push_str(line);
        if !line.ends_with('\n') {
            text.push_str("\n\\ No newline at end of file\n");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(before: Option<&str>, text: Option<&str>) -> File {
        let lines = crate::instrument::edits::LineMap::default();
        File {
            name: "p.st".to_owned(),
            before: before.map(Into::into),
            text: text.map(Into::into),
            encoding: None,
            lines,
        }
    }

    #[test]
    fn changes_read_as_diff_writes_them() {
        let before = "1\n2\n3\n4\n5\n6\n7\n8\n9\n10\n11\n12\n13";
        let after = "1\n2\nx\n3\n4\n5\n6\n7\n8\n9\n10\n11\ny\n13";
        insta::assert_snapshot!(unified(&file(Some(before), Some(after))), @r"
        --- a/p.st
        +++ b/p.st
        @@ -1,5 +1,6 @@
         1
         2
        +x
         3
         4
         5
        @@ -9,5 +10,5 @@
         9
         10
         11
        -12
        +y
         13
        \ No newline at end of file
        ");
        assert_eq!(unified(&file(Some("a"), Some("a"))), "");
        assert_eq!(unified(&file(None, Some("a\n"))), "--- /dev/null\n+++ b/p.st\n@@ -0,0 +1,1 @@\n+a\n");
        assert_eq!(unified(&file(Some("a\n"), None)), "--- a/p.st\n+++ /dev/null\n@@ -1,1 +0,0 @@\n-a\n");
    }
}
