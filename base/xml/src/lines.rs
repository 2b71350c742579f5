//! The line of a place.

/// Where the lines of a text begin, found once: counting from the start for every element would take as long as the
/// text is, each time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lines(Vec<u32>);

impl Lines {
    /// Those of a text.
    pub fn of(text: &str) -> Self {
        Self(std::iter::once(0).chain(text.match_indices('\n').map(|(end, _)| end as u32 + 1)).collect())
    }

    /// The line of a place, from 1.
    pub fn line(&self, at: u32) -> u32 {
        self.0.partition_point(|start| *start <= at) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::Lines;

    #[test]
    fn a_line_ends_with_its_break() {
        let lines = Lines::of("a\n\nb");
        assert_eq!([0, 1, 2, 3, 9].map(|at| lines.line(at)), [1, 1, 2, 3, 3]);
        assert_eq!(Lines::of("").line(0), 1);
    }
}
