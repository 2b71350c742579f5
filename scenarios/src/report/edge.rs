//! Rising edges.

/// A condition, image by image.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Edge {
    before: Option<bool>,
}

impl Edge {
    /// True if it holds now and did not in the image before; the first image has no edge.
    pub(super) fn rises(&mut self, holds: bool) -> bool {
        self.before.replace(holds) == Some(false) && holds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_image_has_no_edge() {
        let mut edge = Edge::default();
        assert_eq!([true, true, false, true, true].map(|holds| edge.rises(holds)), [false, false, false, true, false]);
        let mut edge = Edge::default();
        assert_eq!([false, true].map(|holds| edge.rises(holds)), [false, true]);
    }
}
