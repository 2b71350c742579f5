//! The image: all signals of a session in one flat, fixed byte layout.
//!
//! Outputs are staged as they come and become visible together, at the commit.

use std::ops::Range;
use std::sync::Arc;

use crate::layout::ImageLayout;
use crate::signal::{BadValue, PortLayout, SignalId, SignalType};
use crate::signal_overlay::SignalOverlay;

/// One run of bytes that is copied between a port and the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Run {
    image: usize,
    port: usize,
    len: usize,
}

/// An image of fewer bytes is copied whole in each step: that takes less time than looking what has changed.
const LARGE: usize = 64 * 1024;
/// Signals side by side that are looked at together, as long as they are shorter than this.
const PIECE: usize = 4 * 1024;

/// Whole signals that lie side by side in the port and in the image, and which of those that need a look are among them.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Piece {
    run: Run,
    to_canonicalise: Range<usize>,
}

/// How a port's bytes and the image's correspond.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PortMap {
    runs: Vec<Run>,
    /// The same in pieces, for large images; none for others.
    pieces: Vec<Piece>,
    /// Signals whose bytes need a look once staged: image offset, type, and who it is.
    to_canonicalise: Vec<(usize, SignalType, SignalId)>,
    size: usize,
}

impl PortMap {
    /// Maps `port`, whose signals have the ids `ids` in the same order, onto `layout`.
    pub fn new(port: &PortLayout, ids: &[SignalId], layout: &ImageLayout) -> Self {
        debug_assert_eq!(port.ports().len(), ids.len(), "every signal of a port has its id");
        let (mut runs, mut pieces): (Vec<Run>, Vec<Piece>) = (Vec::new(), Vec::new());
        let mut to_canonicalise = Vec::new();
        for ((signal, offset), id) in port.iter().zip(ids) {
            let run = Run { image: layout.offset(*id), port: offset, len: signal.ty.size() };
            debug_assert_eq!(layout.ty(*id), signal.ty, "port and image agree on the type of `{}`", signal.name);
            debug_assert!(run.image + run.len <= layout.size(), "`{}` lies within the image", signal.name);
            debug_assert!(run.port + run.len <= port.size(), "`{}` lies within its port", signal.name);
            match runs.last_mut() {
                // One long copy instead of many short ones: a step copies every port.
                Some(last) if last.image + last.len == run.image && last.port + last.len == run.port => {
                    last.len += run.len;
                }
                _ => runs.push(run),
            }
            let before = to_canonicalise.len();
            if signal.ty.needs_canonical_form() {
                to_canonicalise.push((run.image, signal.ty, *id));
            }
            if layout.size() >= LARGE {
                add_to_pieces(&mut pieces, run, before..to_canonicalise.len());
            }
        }
        Self { runs, pieces, to_canonicalise, size: port.size() }
    }

    /// Bytes of the port.
    pub fn size(&self) -> usize {
        self.size
    }
}

/// Adds a signal to the last piece, or begins another.
fn add_to_pieces(pieces: &mut Vec<Piece>, run: Run, to_canonicalise: Range<usize>) {
    match pieces.last_mut() {
        Some(Piece { run: last, to_canonicalise: among })
            if last.len < PIECE && last.image + last.len == run.image && last.port + last.len == run.port =>
        {
            last.len += run.len;
            among.end = to_canonicalise.end;
        }
        _ => pieces.push(Piece { run, to_canonicalise }),
    }
}

/// What the next commit has to copy.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Uncommitted {
    All,
    /// These bytes of a large image: all others are committed as they are staged.
    Parts(Vec<Range<usize>>),
}

/// The values of a session: those committed, and those staged for the next commit.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Image {
    layout: Arc<ImageLayout>,
    committed: Vec<u8>,
    /// What the writers last wrote, whether or not anything lies over it.
    staged: Vec<u8>,
    uncommitted: Uncommitted,
    signal_overlay: SignalOverlay,
}

/// Which commit of its step a commit is. In sequential coupling a step has one for each client.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Commit {
    /// Others follow in this step.
    Within,
    EndsStep,
}

impl Image {
    /// All zero.
    pub fn new(layout: Arc<ImageLayout>) -> Self {
        let size = layout.size();
        let (committed, staged, signal_overlay) = (vec![0; size], vec![0; size], SignalOverlay::default());
        Self { layout, committed, staged, uncommitted: Uncommitted::All, signal_overlay }
    }

    /// The values that clients see.
    pub fn committed(&self) -> &[u8] {
        &self.committed
    }

    /// What the writers last wrote: the values that the next commit makes visible, unless a write, a
    /// force or a fault lies over them.
    pub fn staged(&self) -> &[u8] {
        &self.staged
    }

    /// Copies committed values to the bytes of a port, which has the size of `map`.
    pub fn gather(&self, map: &PortMap, port: &mut [u8]) {
        debug_assert_eq!(port.len(), map.size, "inputs have the size of their port");
        for run in &map.runs {
            port[run.port..run.port + run.len].copy_from_slice(&self.committed[run.image..run.image + run.len]);
        }
    }

    /// Copies to the bytes of a port what its writer last wrote.
    pub(crate) fn gather_staged(&self, map: &PortMap, port: &mut [u8]) {
        debug_assert_eq!(port.len(), map.size, "outputs have the size of their port");
        for run in &map.runs {
            port[run.port..run.port + run.len].copy_from_slice(&self.staged[run.image..run.image + run.len]);
        }
    }

    /// Stages the bytes of a port, in canonical form, for the next commit.
    ///
    /// # Errors
    /// The first signal whose bytes are not a value of its type. What is staged must not be committed
    /// then; the session ends with it.
    pub fn stage(&mut self, map: &PortMap, port: &[u8]) -> Result<(), (SignalId, BadValue)> {
        debug_assert_eq!(port.len(), map.size, "outputs have the size of their port");
        if let Uncommitted::Parts(parts) = &mut self.uncommitted {
            return stage_changed(&mut self.staged, parts, map, port);
        }
        for run in &map.runs {
            self.staged[run.image..run.image + run.len].copy_from_slice(&port[run.port..run.port + run.len]);
        }
        for &(offset, ty, signal) in &map.to_canonicalise {
            ty.canonicalise(&mut self.staged[offset..offset + ty.size()]).map_err(|bad| (signal, bad))?;
        }
        Ok(())
    }

    /// Makes all staged values visible at once.
    pub fn commit(&mut self, commit: Commit) {
        let Self { layout, committed, staged, uncommitted, signal_overlay } = self;
        debug_assert_eq!(staged.len(), committed.len(), "staged and committed values have one layout");
        match uncommitted {
            Uncommitted::All => {
                committed.copy_from_slice(staged);
                if committed.len() >= LARGE {
                    *uncommitted = Uncommitted::Parts(Vec::new());
                }
            }
            Uncommitted::Parts(parts) => {
                parts.drain(..).for_each(|part| committed[part.clone()].copy_from_slice(&staged[part]));
            }
        }
        if !signal_overlay.is_empty() {
            signal_overlay.apply(layout, staged, committed, commit == Commit::EndsStep);
            // What lies over signals may be others, or gone, at the next commit.
            *uncommitted = Uncommitted::All;
        }
        debug_assert!(
            *uncommitted == Uncommitted::All || committed == staged,
            "what is not copied by the next commit is committed as it is staged"
        );
    }

    /// The values that a commit would make visible now.
    pub(crate) fn coming(&self) -> Vec<u8> {
        let mut coming = self.staged.clone();
        if !self.signal_overlay.is_empty() {
            let (mut staged, mut signal_overlay) = (self.staged.clone(), self.signal_overlay.clone());
            signal_overlay.apply(&self.layout, &mut staged, &mut coming, true);
        }
        coming
    }

    /// What lies over the staged values from the next commit on.
    pub(crate) fn signal_overlay(&self) -> &SignalOverlay {
        &self.signal_overlay
    }

    /// The same, to be changed.
    pub(crate) fn signal_overlay_mut(&mut self) -> &mut SignalOverlay {
        &mut self.signal_overlay
    }

    /// Back to all zero; nothing lies over it.
    pub fn clear(&mut self) {
        self.signal_overlay = SignalOverlay::default();
        self.uncommitted = Uncommitted::All;
        self.committed.fill(0);
        self.staged.fill(0);
    }

    /// Takes the values of a checkpoint, each of the image's size, and what lies over them.
    pub(crate) fn load(&mut self, committed: &[u8], staged: &[u8], signal_overlay: SignalOverlay) {
        debug_assert_eq!(committed.len(), self.layout.size(), "the image of a checkpoint has this layout");
        debug_assert_eq!(staged.len(), self.layout.size(), "the staged values of a checkpoint have this layout");
        debug_assert!(signal_overlay.fits(&self.layout), "what lies over signals has their sizes");
        self.committed.copy_from_slice(committed);
        self.staged.copy_from_slice(staged);
        self.uncommitted = Uncommitted::All;
        self.signal_overlay = signal_overlay;
    }
}

/// Stages those pieces of a large port that are not staged as they are, and notes them for the commit. What is staged is in
/// canonical form, so that a piece which is equal needs no look.
fn stage_changed(
    staged: &mut [u8],
    parts: &mut Vec<Range<usize>>,
    map: &PortMap,
    port: &[u8],
) -> Result<(), (SignalId, BadValue)> {
    for Piece { run, to_canonicalise } in &map.pieces {
        let (to, from) = (run.image..run.image + run.len, &port[run.port..run.port + run.len]);
        if staged[to.clone()] == *from {
            continue;
        }
        staged[to.clone()].copy_from_slice(from);
        for &(offset, ty, signal) in &map.to_canonicalise[to_canonicalise.clone()] {
            ty.canonicalise(&mut staged[offset..offset + ty.size()]).map_err(|bad| (signal, bad))?;
        }
        match parts.last_mut() {
            Some(last) if last.end == to.start => last.end = to.end,
            _ => parts.push(to),
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::tests::signals;
    use crate::signal::{Port, SignalDecl};
    use proptest::prelude::*;

    fn map_of(signals: &[SignalDecl], ids: &[u32], layout: &ImageLayout) -> PortMap {
        let ids: Vec<SignalId> = ids.iter().copied().map(SignalId).collect();
        let ports = ids.iter().map(|id| Port { name: signals[id.index()].name.clone(), ty: signals[id.index()].ty });
        PortMap::new(&PortLayout::new(ports.collect()), &ids, layout)
    }

    #[test]
    fn staged_values_are_seen_after_the_commit_only() {
        let signals = signals(&[SignalType::INT]);
        let layout = ImageLayout::new(&signals);
        let map = map_of(&signals, &[0], &layout);
        let mut image = Image::new(Arc::new(layout.clone()));
        image.stage(&map, &7_i16.to_le_bytes()).unwrap();
        let mut port = [0xff; 2];
        image.gather(&map, &mut port);
        assert_eq!(port, [0, 0]);
        image.commit(Commit::EndsStep);
        image.gather(&map, &mut port);
        assert_eq!(port, [7, 0]);
    }

    #[test]
    fn neighbours_are_copied_in_one_run() {
        let signals = signals(&[SignalType::DINT; 75]);
        let layout = ImageLayout::new(&signals);
        let map = map_of(&signals, &(0..75).collect::<Vec<_>>(), &layout);
        assert_eq!(map.runs, [Run { image: 0, port: 0, len: 300 }]);
    }

    #[test]
    fn a_value_that_is_none_is_refused_with_its_signal() {
        let signals = signals(&[SignalType::BOOL, SignalType::BOOL]);
        let layout = ImageLayout::new(&signals);
        let map = map_of(&signals, &[0, 1], &layout);
        assert_eq!(Image::new(Arc::new(layout.clone())).stage(&map, &[1, 9]), Err((SignalId(1), BadValue::Bool(9))));
    }

    /// Strings that make an image large, two small signals, and what has happened to them, as bytes of a port.
    fn large_image() -> (Image, PortMap) {
        let mut types = vec![SignalType::String(20_000); 4];
        types.extend([SignalType::BOOL, SignalType::LREAL]);
        let signals = signals(&types);
        let layout = ImageLayout::new(&signals);
        let map = map_of(&signals, &(0..6).collect::<Vec<_>>(), &layout);
        assert!(layout.size() >= LARGE && map.pieces.len() >= 4);
        (Image::new(Arc::new(layout)), map)
    }

    #[test]
    fn of_a_large_image_a_commit_copies_what_has_changed() {
        let (mut image, map) = large_image();
        let mut port = vec![0; map.size()];
        image.stage(&map, &port).unwrap();
        image.commit(Commit::EndsStep);
        assert_eq!(image.uncommitted, Uncommitted::Parts(Vec::new()));
        // The second string has one character, and behind it what is not its own.
        let second = 20_002;
        port[second] = 1;
        port[second + 2] = b'x';
        port[second + 19_000] = b'y';
        image.stage(&map, &port).unwrap();
        let Uncommitted::Parts(parts) = &image.uncommitted else { panic!("it is large") };
        assert_eq!(parts.iter().map(Range::len).sum::<usize>(), 20_002, "one string of four");
        image.commit(Commit::EndsStep);
        let mut back = vec![0; map.size()];
        image.gather(&map, &mut back);
        port[second + 19_000] = 0;
        assert_eq!(back, port, "its tail is cleared");
        // The BOOL lies behind the strings.
        port[4 * 20_002] = 2;
        assert_eq!(image.stage(&map, &port), Err((SignalId(4), BadValue::Bool(2))));
    }

    #[test]
    fn what_lay_over_a_large_image_is_gone_when_it_is_released() {
        let (mut image, map) = large_image();
        let port = vec![0; map.size()];
        for _ in 0..2 {
            image.stage(&map, &port).unwrap();
            image.commit(Commit::EndsStep);
        }
        let id = (0..6).map(SignalId).find(|id| image.layout.ty(*id) == SignalType::BOOL).unwrap();
        image.signal_overlay_mut().force(id, vec![1]);
        assert_eq!(image.coming()[image.layout.range(id)], [1]);
        image.commit(Commit::EndsStep);
        assert_eq!(image.committed()[image.layout.range(id)], [1]);
        assert!(image.signal_overlay_mut().release(id));
        image.stage(&map, &port).unwrap();
        image.commit(Commit::EndsStep);
        assert_eq!(image.committed()[image.layout.range(id)], [0]);
    }

    proptest! {
        #[test]
        fn what_is_committed_is_gathered(order in Just((0..20_u32).collect::<Vec<_>>()).prop_shuffle(), seed: [u8; 20]) {
            let types: Vec<_> = (0..20).map(|i| [SignalType::BYTE, SignalType::INT, SignalType::LINT][i % 3]).collect();
            let signals = signals(&types);
            let layout = ImageLayout::new(&signals);
            let map = map_of(&signals, &order, &layout);
            let bytes: Vec<u8> = (0..map.size()).map(|i| seed[i % 20].wrapping_add(i as u8)).collect();
            let mut image = Image::new(Arc::new(layout.clone()));
            image.stage(&map, &bytes).unwrap();
            image.commit(Commit::EndsStep);
            let mut back = vec![0; map.size()];
            image.gather(&map, &mut back);
            prop_assert_eq!(back, bytes);
        }
    }
}
