//! A changed file as a unified diff.

use similar::{Algorithm, TextDiff};

use super::File;

/// Lines shown before and behind a change.
const CONTEXT: usize = 3;

/// The changes of a file, as `diff -u` writes them; nothing if it has none.
pub fn unified(file: &File) -> String {
    if !file.is_changed() {
        return String::new();
    }
    let (before, after) = (file.before.as_deref(), file.text.as_deref());
    let name = |exists: bool, side: &str| if exists { format!("{side}/{}", file.name) } else { "/dev/null".to_owned() };
    let header = format!("--- {}\n+++ {}\n", name(before.is_some(), "a"), name(after.is_some(), "b"));
    // A line ends with a line feed alone, as for every tool that applies such a diff.
    let [old, new] = [before, after].map(|text| text.unwrap_or("").split_inclusive('\n').collect::<Vec<_>>());
    // The marks of the shim are many equal lines; the lines that occur once hold the two texts together.
    let diff = TextDiff::configure().algorithm(Algorithm::Patience).newline_terminated(true).diff_slices(&old, &new);
    header + &diff.unified_diff().context_radius(CONTEXT).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use onescan_iec::source::edits::LineMap;

    fn file(before: Option<&str>, text: Option<&str>) -> File {
        File {
            name: "p.st".to_owned(),
            before: before.map(Into::into),
            text: text.map(Into::into),
            encoding: None,
            lines: LineMap::default(),
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
        assert_eq!(unified(&file(None, Some("a\n"))), "--- /dev/null\n+++ b/p.st\n@@ -0,0 +1 @@\n+a\n");
        assert_eq!(unified(&file(Some("a\n"), None)), "--- a/p.st\n+++ /dev/null\n@@ -1 +0,0 @@\n-a\n");
    }
}
