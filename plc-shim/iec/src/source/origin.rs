//! Program text that was taken out of another file: where each part of it stands there.

use std::ops::Range;
use std::sync::Arc;

/// A file that program text was taken out of, and the way back into it.
#[derive(Debug, Clone)]
pub struct Origin {
    text: Arc<str>,
    pieces: Vec<Piece>,
}

/// A part of the program text.
#[derive(Debug, Clone)]
struct Piece {
    /// Where it stands in the program text.
    start: u32,
    end: u32,
    /// What it came from in the file.
    from: Range<u32>,
    /// True if it is the file's text unchanged.
    verbatim: bool,
}

/// Puts program text together from parts of a file.
#[derive(Debug, Default)]
pub struct Extract {
    text: String,
    pieces: Vec<Piece>,
}

impl Extract {
    /// Appends the part `from` of `file` unchanged.
    pub fn verbatim(&mut self, file: &str, from: Range<u32>) {
        let text = file.get(from.start as usize..from.end as usize).unwrap_or("");
        self.push(text, from, true);
    }

    /// Appends text that is written otherwise in the file, or stands for what is there.
    pub fn instead(&mut self, text: &str, from: Range<u32>) {
        self.push(text, from, false);
    }

    fn push(&mut self, text: &str, from: Range<u32>, verbatim: bool) {
        let start = self.text.len() as u32;
        self.text.push_str(text);
        let end = self.text.len() as u32;
        if end > start {
            self.pieces.push(Piece { start, end, from, verbatim });
        }
    }

    /// The program text so far.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The program text, and the way back into `file`.
    pub fn finish(self, file: Arc<str>) -> (String, Origin) {
        (self.text, Origin { text: file, pieces: self.pieces })
    }
}

impl Origin {
    /// The whole file.
    pub fn text(&self) -> &Arc<str> {
        &self.text
    }

    /// The place in the file of a range of the program text.
    pub fn place(&self, range: Range<u32>) -> Range<u32> {
        let start = self.start(range.start);
        let end = if range.is_empty() { start } else { self.end(range.end) };
        start..end.max(start)
    }

    /// The piece that holds the byte at `offset`; the last one at the text's end.
    fn piece(&self, offset: u32) -> Option<&Piece> {
        let after = self.pieces.partition_point(|piece| piece.end <= offset);
        self.pieces.get(after).or(self.pieces.last())
    }

    /// True if the byte at `offset` stands in the file as it is.
    pub fn is_verbatim(&self, offset: u32) -> bool {
        self.piece(offset).is_some_and(|piece| piece.verbatim)
    }

    /// Where in the file the last part taken over unchanged ends, of those that begin before `offset`.
    pub fn verbatim_end(&self, offset: u32) -> Option<u32> {
        let before = self.pieces.partition_point(|piece| piece.start < offset);
        let before = self.pieces.get(..before)?;
        before.iter().rev().find(|piece| piece.verbatim).map(|piece| piece.from.end)
    }

    fn start(&self, offset: u32) -> u32 {
        self.piece(offset).map_or(0, |piece| {
            let inside = offset.saturating_sub(piece.start);
            if piece.verbatim { (piece.from.start + inside).min(piece.from.end) } else { piece.from.start }
        })
    }

    fn end(&self, offset: u32) -> u32 {
        self.piece(offset.saturating_sub(1)).map_or(0, |piece| {
            let inside = offset.saturating_sub(piece.start);
            if piece.verbatim { (piece.from.start + inside).min(piece.from.end) } else { piece.from.end }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_lead_back_into_the_file() {
        let file = "<a>x &lt; y</a>";
        let mut extract = Extract::default();
        extract.verbatim(file, 3..5);
        extract.instead("<", 5..9);
        extract.verbatim(file, 9..11);
        extract.instead(";", 11..15);
        let (text, origin) = extract.finish(file.into());
        assert_eq!(text, "x < y;");
        assert_eq!(origin.place(0..1), 3..4);
        assert_eq!(origin.place(2..3), 5..9);
        assert_eq!(origin.place(4..5), 10..11);
        assert_eq!(origin.place(0..5), 3..11);
        assert_eq!(origin.place(5..6), 11..15);
        assert_eq!(origin.place(6..6), 11..11);
        assert_eq!(Origin { text: file.into(), pieces: Vec::new() }.place(2..9), 0..0);
    }
}
