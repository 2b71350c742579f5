//! Where each signal lies in the image of a session.
//!
//! The layout follows from the signals alone: falling alignment, then name, no padding.

use std::ops::Range;

use crate::signal::{SignalDecl, SignalId, SignalType};

/// Where each signal lies in the image.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct ImageLayout {
    offsets: Vec<usize>,
    types: Vec<SignalType>,
    size: usize,
}

impl ImageLayout {
    /// Lays out `signals`, which are sorted by name.
    pub fn new(signals: &[SignalDecl]) -> Self {
        let mut order: Vec<usize> = (0..signals.len()).collect();
        order.sort_by_key(|index| (std::cmp::Reverse(signals[*index].ty.alignment()), *index));
        let mut offsets = vec![0; signals.len()];
        let mut size = 0;
        for index in order {
            offsets[index] = size;
            size += signals[index].ty.size();
        }
        debug_assert_eq!(
            size,
            signals.iter().map(|signal| signal.ty.size()).sum::<usize>(),
            "the image has no byte that is not a signal's"
        );
        Self { offsets, types: signals.iter().map(|signal| signal.ty).collect(), size }
    }

    /// Bytes of the image.
    pub fn size(&self) -> usize {
        self.size
    }

    /// The bytes of `signal` in `image`.
    pub fn bytes<'a>(&self, signal: SignalId, image: &'a [u8]) -> &'a [u8] {
        let offset = self.offsets[signal.index()];
        &image[offset..offset + self.types[signal.index()].size()]
    }

    /// The first byte of `signal` in an image.
    pub fn offset(&self, signal: SignalId) -> usize {
        self.offsets[signal.index()]
    }

    /// Where `signal` lies in an image.
    pub fn range(&self, signal: SignalId) -> Range<usize> {
        let offset = self.offsets[signal.index()];
        let end = offset + self.types[signal.index()].size();
        debug_assert!(end <= self.size, "every signal lies within the image");
        offset..end
    }

    /// The type of `signal`.
    pub fn ty(&self, signal: SignalId) -> SignalType {
        self.types[signal.index()]
    }

    /// All signals in the order of their names.
    pub fn signals(&self) -> impl ExactSizeIterator<Item = SignalId> + use<> {
        (0..self.types.len() as u32).map(SignalId)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::signal::SignalName;

    /// Signals of these types, `s000` first.
    pub(crate) fn signals(types: &[SignalType]) -> Vec<SignalDecl> {
        let decl = |(index, ty): (usize, &SignalType)| SignalDecl {
            name: SignalName::new(format!("s{index:03}")).unwrap(),
            ty: *ty,
            writer: None,
            unit: None,
        };
        types.iter().enumerate().map(decl).collect()
    }

    #[test]
    fn wide_signals_come_first_and_nothing_is_padded() {
        use SignalType as T;
        let layout = ImageLayout::new(&signals(&[T::BOOL, T::LREAL, T::INT, T::REAL, T::BOOL]));
        assert_eq!(layout.size(), 16);
        assert_eq!(layout.offsets, [14, 0, 12, 8, 15]);
    }
}
