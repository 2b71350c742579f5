//! Elements, paths, escapes: SVG as text.

use std::fmt::{self, Display, Write as _};

use super::lettering::{FONT_FAMILY, TICK_PX};
use super::palette::{FAINT_INK, GROUND, INK, Stroke, dark_style};
use super::reduce::{PIXEL_CPX, Point};

/// An attribute of an element.
pub type Attribute<'a> = (&'a str, &'a dyn Display);

/// An SVG document while it is written, one element to a line.
#[derive(Debug, Default)]
pub struct Document {
    text: String,
    open: Vec<&'static str>,
}

impl Document {
    /// A picture of this size, in pixels, with its ground. The title and the description are for readers who do not see
    /// it.
    pub fn picture(width_px: i64, height_px: i64, title: &str, description: &str) -> Self {
        let mut document = Self::default();
        document.open(
            "svg",
            &[
                ("xmlns", &"http://www.w3.org/2000/svg"),
                ("width", &width_px),
                ("height", &height_px),
                ("viewBox", &format!("0 0 {width_px} {height_px}")),
                ("role", &"img"),
                ("font-family", &FONT_FAMILY),
                ("fill", &INK),
            ],
        );
        document.text("title", &[], title);
        if !description.is_empty() {
            document.text("desc", &[], description);
        }
        document.text("style", &[], &dark_style());
        document.empty("rect", &[("width", &width_px), ("height", &height_px), ("fill", &GROUND)]);
        document
    }

    /// Opens an element; what follows is inside of it until [`Self::close`].
    pub fn open(&mut self, name: &'static str, attributes: &[Attribute<'_>]) {
        self.tag(name, attributes);
        self.text.push_str(">\n");
        self.open.push(name);
    }

    /// Closes the element that was opened last.
    pub fn close(&mut self) {
        if let Some(name) = self.open.pop() {
            self.end(name);
        }
    }

    /// An element without content.
    pub fn empty(&mut self, name: &str, attributes: &[Attribute<'_>]) {
        self.tag(name, attributes);
        self.text.push_str("/>\n");
    }

    /// An element that contains text.
    pub fn text(&mut self, name: &str, attributes: &[Attribute<'_>], content: &str) {
        self.tag(name, attributes);
        self.text.push('>');
        self.escape(content);
        self.end(name);
    }

    /// The document, with all elements closed.
    pub fn finish(mut self) -> String {
        while !self.open.is_empty() {
            self.close();
        }
        self.text
    }

    fn tag(&mut self, name: &str, attributes: &[Attribute<'_>]) {
        self.text.push('<');
        self.text.push_str(name);
        for (name, value) in attributes {
            self.text.push(' ');
            self.text.push_str(name);
            self.text.push_str("=\"");
            self.escape(&value.to_string());
            self.text.push('"');
        }
    }

    fn end(&mut self, name: &str) {
        self.text.push_str("</");
        self.text.push_str(name);
        self.text.push_str(">\n");
    }

    fn escape(&mut self, content: &str) {
        for letter in content.chars() {
            match letter {
                '&' => self.text.push_str("&amp;"),
                '<' => self.text.push_str("&lt;"),
                '>' => self.text.push_str("&gt;"),
                '"' => self.text.push_str("&quot;"),
                '\t' | '\n' | '\r' => self.text.push(' '),
                // No escape makes these legal in XML 1.0.
                '\0'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => self.text.push('\u{fffd}'),
                _ => self.text.push(letter),
            }
        }
    }
}

/// A length in hundredths of a pixel, written in pixels without idle zeros.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pixels(pub(super) i64);

impl Display for Pixels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = if self.0 < 0 { "-" } else { "" };
        let (whole, part) = (self.0.abs() / PIXEL_CPX, self.0.abs() % PIXEL_CPX);
        match (whole, part) {
            (whole, 0) => write!(f, "{sign}{whole}"),
            (0, part) if part % 10 == 0 => write!(f, "{sign}.{}", part / 10),
            (0, part) => write!(f, "{sign}.{part:02}"),
            (whole, part) if part % 10 == 0 => write!(f, "{sign}{whole}.{}", part / 10),
            (whole, part) => write!(f, "{sign}{whole}.{part:02}"),
        }
    }
}

/// The data of a path through lists of points; a lone point is a dot.
///
/// All but the first point of a list are relative to their predecessor, which is shorter and, on a
/// grid, exact.
pub(super) fn path_data(pieces: &[&[Point]]) -> String {
    let mut data = String::new();
    for piece in pieces {
        let Some(&(mut at)) = piece.first() else { continue };
        let _ = write!(data, "M{} {}", Pixels(at.x_cpx), Pixels(at.y_cpx));
        let mut command = 'M';
        for &to in piece.get(1..).unwrap_or_default() {
            let (right, down) = (Pixels(to.x_cpx - at.x_cpx), Pixels(to.y_cpx - at.y_cpx));
            let (next, lengths) = match (right.0, down.0) {
                (_, 0) => ('h', right.to_string()),
                (0, _) => ('v', down.to_string()),
                _ if down.0 < 0 => ('l', format!("{right}{down}")),
                _ => ('l', format!("{right} {down}")),
            };
            if next != command {
                data.push(next);
            } else if !lengths.starts_with('-') {
                data.push(' ');
            }
            command = next;
            data.push_str(&lengths);
            at = to;
        }
        if piece.len() == 1 {
            data.push_str("h0");
        }
    }
    data
}

/// A line in the stroke of a run.
pub(super) fn draw_line(document: &mut Document, data: &str, stroke: Stroke) {
    let width = Pixels(stroke.width_cpx);
    let mut attributes: Vec<Attribute<'_>> = vec![("d", &data), ("stroke", &stroke.colour), ("stroke-width", &width)];
    if let Some(dashes) = &stroke.dashes {
        attributes.push(("stroke-dasharray", dashes));
    }
    document.empty("path", &attributes);
}

/// A faint word in place of what is missing.
pub(super) fn draw_note(document: &mut Document, middle_px: i64, baseline_px: i64, note: &str) {
    document.open("g", &[("font-size", &TICK_PX), ("fill", &FAINT_INK), ("text-anchor", &"middle")]);
    document.text("text", &[("x", &middle_px), ("y", &baseline_px)], note);
    document.close();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped_and_stays_legal() {
        let mut document = Document::default();
        document.open("g", &[("id", &"\"a\" & 'b'")]);
        document.text("text", &[], "<x>\u{1}\n\u{ffff}\u{b5}");
        let expected = "<g id=\"&quot;a&quot; &amp; 'b'\">\n<text>&lt;x&gt;\u{fffd} \u{fffd}\u{b5}</text>\n</g>\n";
        assert_eq!(document.finish(), expected);
    }

    #[test]
    fn lengths_have_at_most_two_decimals() {
        let written = [0, 5, -50, 100, 110, -1234].map(|length| Pixels(length).to_string());
        assert_eq!(written, ["0", ".05", "-.5", "1", "1.1", "-12.34"]);
    }

    #[test]
    fn paths_are_relative() {
        let at = |x_cpx, y_cpx| Point { x_cpx, y_cpx };
        let line = [at(0, 0), at(100, -50), at(250, 0), at(300, 0), at(300, 200), at(300, 100)];
        assert_eq!(path_data(&[&line, &[], &[at(1, 2)]]), "M0 0l1-.5 1.5 .5h.5v2-1M.01 .02h0");
    }
}
