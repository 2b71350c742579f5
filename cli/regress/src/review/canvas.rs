//! Curves in braille dots: two dots wide and four high in each character.

/// Dots across a character.
const ACROSS: usize = 2;
/// Dots down a character.
const DOWN: usize = 4;
/// The bit of each dot in U+2800..U+28FF, by column and row.
const BITS: [[u8; DOWN]; ACROSS] = [[0x01, 0x02, 0x04, 0x40], [0x08, 0x10, 0x20, 0x80]];

/// A picture of characters.
#[derive(Clone, Debug)]
pub struct Canvas {
    columns: usize,
    rows: usize,
    cells: Vec<u8>,
}

impl Canvas {
    /// An empty picture of so many characters.
    pub fn new(columns: usize, rows: usize) -> Self {
        Self { columns, rows, cells: vec![0; columns * rows] }
    }

    /// How many dots it is wide.
    pub fn width(&self) -> usize {
        self.columns * ACROSS
    }

    /// How many dots it is high.
    pub fn height(&self) -> usize {
        self.rows * DOWN
    }

    /// Sets the dots of a column from `from` to `to`, both counted from below; those outside are left out.
    pub fn bar(&mut self, x: usize, from: usize, to: usize) {
        for y in from.min(to)..=from.max(to) {
            let Some(row) = self.height().checked_sub(y + 1) else { break };
            if let Some(cell) =
                self.cells.get_mut(row / DOWN * self.columns + x / ACROSS).filter(|_| x < self.columns * ACROSS)
            {
                *cell |= BITS[x % ACROSS][row % DOWN];
            }
        }
    }

    /// The rows from top to bottom.
    pub fn lines(&self) -> Vec<String> {
        let letter = |cell: &u8| char::from_u32(0x2800 + u32::from(*cell)).unwrap_or(' ');
        self.cells.chunks(self.columns.max(1)).take(self.rows).map(|row| row.iter().map(letter).collect()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dots_are_counted_from_below() {
        let mut canvas = Canvas::new(2, 1);
        canvas.bar(0, 0, 3);
        canvas.bar(3, 3, 3);
        canvas.bar(9, 0, 9);
        assert_eq!(canvas.lines(), ["\u{2847}\u{2808}"]);
    }
}
