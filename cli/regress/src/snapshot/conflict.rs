//! The two sides of a merge in one text, between the marks that git leaves where it cannot decide.

/// A text that was merged without a decision.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Conflict {
    /// The line of the first mark, from 1.
    pub line: usize,
    /// What git calls the two, as in `HEAD` and `feature`.
    pub names: [String; 2],
    /// The text as it would be with the one, and with the other.
    pub sides: [String; 2],
}

const OURS: &str = "<<<<<<<";
/// Between the two, with `merge.conflictStyle = diff3`: what both came from.
const BASE: &str = "|||||||";
const MIDDLE: &str = "=======";
const THEIRS: &str = ">>>>>>>";

/// Which part of a hunk a line is in.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Part {
    Both,
    Ours,
    Base,
    Theirs,
}

/// The sides of `text`; nothing if it has no mark, or its marks do not come in order.
pub fn sides(text: &str) -> Option<Conflict> {
    let mut conflict: Option<Conflict> = None;
    let mut sides = [String::new(), String::new()];
    let mut part = Part::Both;
    for (index, line) in text.lines().enumerate() {
        let mark = |mark: &str| line.strip_prefix(mark).filter(|rest| rest.is_empty() || rest.starts_with(' '));
        if let Some(name) = mark(OURS) {
            (part == Part::Both).then_some(())?;
            let names = [name.trim().to_owned(), String::new()];
            conflict.get_or_insert(Conflict { line: index + 1, names, sides: Default::default() });
            part = Part::Ours;
        } else if mark(BASE).is_some() && part == Part::Ours {
            part = Part::Base;
        } else if mark(MIDDLE).is_some() && matches!(part, Part::Ours | Part::Base) {
            part = Part::Theirs;
        } else if let Some(name) = mark(THEIRS) {
            (part == Part::Theirs).then_some(())?;
            name.trim().clone_into(&mut conflict.as_mut()?.names[1]);
            part = Part::Both;
        } else {
            let takes = [part == Part::Both || part == Part::Ours, part == Part::Both || part == Part::Theirs];
            for side in sides.iter_mut().zip(takes).filter_map(|(side, takes)| takes.then_some(side)) {
                side.push_str(line);
                side.push('\n');
            }
        }
    }
    (part == Part::Both).then_some(())?;
    Some(Conflict { sides, ..conflict? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_are_found_in_each_style() {
        let two = "a\n<<<<<<< HEAD\nb\n=======\nc\n>>>>>>> feature\nd\n";
        let three = "a\n<<<<<<< HEAD\nb\n||||||| 1234567\nx\n=======\nc\n>>>>>>> feature\nd\n";
        for text in [two, three] {
            let found = sides(text).expect("a conflict");
            assert_eq!((found.line, found.names), (2, ["HEAD".to_owned(), "feature".to_owned()]));
            assert_eq!(found.sides, ["a\nb\nd\n".to_owned(), "a\nc\nd\n".to_owned()]);
        }
    }

    #[test]
    fn a_text_without_marks_or_with_half_of_them_has_none() {
        for text in
            ["a\nb\n", "<<<<<<< HEAD\na\n", "<<<<<<< HEAD\na\n=======\nb\n", "a\n>>>>>>> feature\n", "<<<<<<<x\n"]
        {
            assert_eq!(sides(text), None, "{text}");
        }
    }
}
