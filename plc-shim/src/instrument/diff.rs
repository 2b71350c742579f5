//! A changed file as a unified diff.

use std::fmt::Write;

use super::File;
use crate::source::edits::LineMap;

/// Lines shown before and behind a change.
const CONTEXT: usize = 3;

/// The changes of a file, as `diff -u` writes them; nothing if it has none.
pub fn unified(file: &File) -> String {
    let (before, after): (&str, &str) = (file.before.as_deref().unwrap_or(""), file.text.as_deref().unwrap_or(""));
    if !file.is_changed() {
        return String::new();
    }
    let name = |exists: bool, side: &str| if exists { format!("{side}/{}", file.name) } else { "/dev/null".to_owned() };
    let mut text = format!("--- {}\n+++ {}\n", name(file.before.is_some(), "a"), name(file.text.is_some(), "b"));
    let (old, new): (Vec<&str>, Vec<&str>) =
        (before.split_inclusive('\n').collect(), after.split_inclusive('\n').collect());
    let script = script(&old, &new, &file.from);
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

/// Follows where the new lines come from; they keep their order.
fn script(old: &[&str], new: &[&str], from: &LineMap) -> Vec<Step> {
    let mut script = Vec::with_capacity(new.len());
    let mut i = 0;
    for (j, is) in new.iter().enumerate() {
        let origin = from.original(j as u32 + 1).map(|line| line as usize - 1);
        let Some(origin) = origin.filter(|origin| *origin >= i && *origin < old.len()) else {
            script.push(Step::Insert(i, j));
            continue;
        };
        script.extend((i..origin).map(|i| Step::Delete(i, j)));
        if old.get(origin) == Some(is) {
            script.push(Step::Keep(origin, j));
        } else {
            script.extend([Step::Delete(origin, j), Step::Insert(origin + 1, j)]);
        }
        i = origin + 1;
    }
    script.extend((i..old.len()).map(|i| Step::Delete(i, new.len())));
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

    fn file(before: Option<&str>, text: Option<&str>, from: &[Option<u32>]) -> File {
        File {
            name: "p.st".to_owned(),
            before: before.map(Into::into),
            text: text.map(Into::into),
            encoding: None,
            lines: LineMap::default(),
            from: LineMap::of(from.to_vec()),
        }
    }

    #[test]
    fn changes_read_as_diff_writes_them() {
        let before = "1\n2\n3\n4\n5\n6\n7\n8\n9\n10\n11\n12\n13";
        let after = "1\n2\nx\n3\n4\n5\n6\n7\n8\n9\n10\n11\ny\n13";
        let from = [1, 2, 0, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13].map(|line| (line > 0).then_some(line));
        insta::assert_snapshot!(unified(&file(Some(before), Some(after), &from)), @r"
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
        assert_eq!(unified(&file(Some("a"), Some("a"), &[])), "");
        assert_eq!(unified(&file(None, Some("a\n"), &[])), "--- /dev/null\n+++ b/p.st\n@@ -0,0 +1,1 @@\n+a\n");
        assert_eq!(unified(&file(Some("a\n"), None, &[])), "--- a/p.st\n+++ /dev/null\n@@ -1,1 +0,0 @@\n-a\n");
    }
}
