//! Statements while they are made: each word knows the element that it stands for, and each value that
//! one element hands on to another is a wire until it is known whether it needs a name.

use std::ops::Range;

use crate::source::origin::Extract;

/// A part of a statement.
#[derive(Debug, Clone)]
pub(in crate::input) enum Piece {
    /// A word that stands for what is at this place of the file.
    Word(String, Range<u32>),
    /// The file's own text.
    Verbatim(Range<u32>),
    /// The value of a wire; `true` where it is an operand.
    Wire(usize, Range<u32>, bool),
}

/// A part of a statement, or all of it.
#[derive(Debug, Clone, Default)]
pub(in crate::input) struct Text {
    pub(in crate::input) pieces: Vec<Piece>,
    /// True if it needs no parentheses as an operand.
    atomic: bool,
    /// How deep wires have been put in the place of their names.
    depth: u32,
}

/// Deepest expression that is made of wires.
const MAX_DEPTH: u32 = 16;

impl Text {
    /// What the file has.
    pub(in crate::input) fn of(pieces: Vec<Piece>) -> Self {
        Self { pieces, ..Self::default() }
    }

    pub(in crate::input) fn word(word: impl Into<String>, place: &Range<u32>) -> Self {
        Self { pieces: vec![Piece::Word(word.into(), place.clone())], atomic: true, depth: 0 }
    }

    pub(in crate::input) fn wire(wire: usize, place: &Range<u32>) -> Self {
        Self { pieces: vec![Piece::Wire(wire, place.clone(), false)], atomic: true, depth: 0 }
    }

    /// `callee(argument, argument)`
    pub(in crate::input) fn call(callee: &str, arguments: Vec<Self>, place: &Range<u32>) -> Self {
        let mut call = Self::word(format!("{callee}("), place);
        for (index, argument) in arguments.into_iter().enumerate() {
            if index > 0 {
                call.push(", ", place);
            }
            call.append(argument);
        }
        call.push(")", place);
        call
    }

    /// The same, `true` if it needs no parentheses as an operand.
    pub(in crate::input) fn that_is_atomic(self, atomic: bool) -> Self {
        Self { atomic, ..self }
    }

    /// The same, never put in the place of its wire: it gives other wires their values as well.
    pub(in crate::input) fn that_stays(self) -> Self {
        Self { depth: MAX_DEPTH, ..self }
    }

    pub(in crate::input) fn push(&mut self, word: &str, place: &Range<u32>) {
        self.pieces.push(Piece::Word(word.to_owned(), place.clone()));
    }

    pub(in crate::input) fn append(&mut self, other: Self) {
        self.depth = self.depth.max(other.depth);
        self.pieces.extend(other.pieces);
    }

    /// Appends what is an operand there.
    pub(in crate::input) fn operand(&mut self, other: Self, place: &Range<u32>) {
        if let [Piece::Wire(wire, at, _)] = other.pieces.as_slice() {
            return self.pieces.push(Piece::Wire(*wire, at.clone(), true));
        }
        if other.atomic {
            return self.append(other);
        }
        self.push("(", place);
        self.append(other);
        self.push(")", place);
    }

    pub(in crate::input) fn negated(self, place: &Range<u32>) -> Self {
        let mut text = Self::word("NOT ", place).that_is_atomic(false);
        text.operand(self, place);
        text
    }

    /// `self operator other`; one that is missing is TRUE of AND.
    pub(crate) fn joined(self, operator: &str, other: Self, place: &Range<u32>) -> Self {
        let mut text = Self::default();
        text.operand(self, place);
        text.push(&format!(" {operator} "), place);
        text.operand(other, place);
        text
    }

    fn uses(&self, wire: usize) -> usize {
        self.pieces.iter().filter(|piece| matches!(piece, Piece::Wire(used, ..) if *used == wire)).count()
    }

    /// The text with `value` in the place of `wire`.
    fn with(self, wire: usize, value: &Self) -> Self {
        let mut text = Self { pieces: Vec::new(), ..self };
        let alone = self.pieces.len() == 1;
        for piece in self.pieces {
            match piece {
                Piece::Wire(used, ..) if used == wire && alone => return value.clone(),
                Piece::Wire(used, place, true) if used == wire => text.operand(value.clone(), &place),
                Piece::Wire(used, ..) if used == wire => text.append(value.clone()),
                other => text.pieces.push(other),
            }
        }
        text.depth = text.depth.max(value.depth + 1);
        text
    }
}

#[derive(Debug)]
pub(in crate::input) enum Line {
    /// Gives a wire its value.
    Define(usize, Text),
    /// Anything else, its end included.
    Other(Text),
}

impl Line {
    fn text(&self) -> &Text {
        match self {
            Self::Define(_, text) | Self::Other(text) => text,
        }
    }

    fn map(self, change: impl FnOnce(Text) -> Text) -> Self {
        match self {
            Self::Define(wire, text) => Self::Define(wire, change(text)),
            Self::Other(text) => Self::Other(change(text)),
        }
    }
}

/// How often each wire is used by a line.
fn count(uses: &mut [usize], line: &Line) {
    for piece in &line.text().pieces {
        if let Piece::Wire(wire, ..) = piece
            && let Some(count) = uses.get_mut(*wire)
        {
            *count += 1;
        }
    }
}

/// Leaves out wires that nobody uses, and puts values in the place of those that are used once, directly
/// behind the statement that gives them.
pub(in crate::input) fn folded(lines: Vec<Line>, wires: usize) -> Vec<Line> {
    let mut uses = vec![0_usize; wires];
    let mut needed = Vec::new();
    // A use stands behind the value.
    for line in lines.into_iter().rev() {
        if !matches!(&line, Line::Define(wire, _) if uses.get(*wire) == Some(&0)) {
            count(&mut uses, &line);
            needed.push(line);
        }
    }
    let mut done: Vec<Line> = Vec::new();
    for mut line in needed.into_iter().rev() {
        while let Some(Line::Define(wire, value)) = done.last() {
            let wire = *wire;
            let once = uses.get(wire) == Some(&1) && line.text().uses(wire) == 1;
            if !once || value.depth >= MAX_DEPTH {
                break;
            }
            let Some(Line::Define(_, value)) = done.pop() else { break };
            line = line.map(|text| text.with(wire, &value));
        }
        done.push(line);
    }
    done
}

/// Appends the statements to program text; `names` are those of the wires in them.
pub(in crate::input) fn write(lines: Vec<Line>, names: &[String], file: &str, extract: &mut Extract) {
    let name = |wire: usize| names.get(wire).map_or("`none`", String::as_str);
    for line in lines {
        let text = match line {
            Line::Other(text) => text,
            Line::Define(wire, value) => {
                let place = match value.pieces.first() {
                    Some(Piece::Word(_, place) | Piece::Verbatim(place) | Piece::Wire(_, place, _)) => place.clone(),
                    None => continue,
                };
                let mut text = Text::wire(wire, &place);
                text.push(" := ", &place);
                text.append(value);
                text.push(";\n", &place);
                text
            }
        };
        for piece in text.pieces {
            match piece {
                Piece::Word(word, place) => extract.instead(&word, place),
                Piece::Verbatim(place) => extract.verbatim(file, place),
                Piece::Wire(wire, place, _) => extract.instead(name(wire), place),
            }
        }
    }
}
