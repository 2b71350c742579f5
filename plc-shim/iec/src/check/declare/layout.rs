//! Offsets in the PLC's memory.
//!
//! | offset | what |
//! |---|---|
//! | 0 | nothing; a reference of 0 refers to nothing |
//! | 8 | virtual time in nanoseconds, `ONESCAN_TV`, written before every task |
//! | 16 | how deep calls are nested that come back to a unit that still runs |
//! | 24 | BOOL, `ONESCAN_INIT_RETAINS`, written before a start: RETAIN variables get their initial values |
//! | 64 | global variables, programs, frames |
//! | behind them | the areas of direct addresses, `%I`, `%Q`, `%M`, as far as they are used |

use std::collections::BTreeMap;
use std::sync::Arc;

use super::Declarations;
use crate::ir::{Place, Storage, TypeId};
use crate::syntax::Span;

/// Offset of virtual time.
pub const VIRTUAL_TIME_OFFSET: u32 = 8;

/// Offset of the depth of circular calls; 0 between scans.
pub const CALL_DEPTH_OFFSET: u32 = 16;

/// Offset of what `FB_init` has as `bInitRetains`.
pub const INIT_RETAINS_OFFSET: u32 = 24;

/// Name of the global variable that lies there.
pub(crate) const INIT_RETAINS_NAME: &str = "ONESCAN_INIT_RETAINS";

/// Name of the global variable that holds virtual time.
pub const VIRTUAL_TIME_NAME: &str = "ONESCAN_TV";

/// The initial bytes of all types together may be so many times as large as all variables: types cost memory while
/// compiling even if no variable is made of them.
const IMAGES_FOR_VARIABLES: u64 = 4;

const FIRST_OFFSET: u32 = 64;

/// What has been handed out of the memory, each block aligned to what lies there, and what it begins with.
#[derive(Debug)]
pub(super) struct Memory {
    /// The first offset that is free.
    next: u32,
    /// Bytes of initial images made so far.
    images: u64,
    /// Offsets of string literals by type and bytes.
    literals: BTreeMap<(TypeId, Arc<[u8]>), u32>,
    /// Initial bytes of what has been placed: what comes later covers what came before.
    placed: Vec<(u32, Arc<[u8]>)>,
}

impl Default for Memory {
    fn default() -> Self {
        Self { next: FIRST_OFFSET, images: 0, literals: BTreeMap::new(), placed: Vec::new() }
    }
}

/// `offset` rounded up to a multiple of `align`, a power of two.
pub(in crate::check) fn align_up(offset: u32, align: u32) -> u32 {
    offset.next_multiple_of(align.max(1))
}

impl Declarations<'_> {
    /// Puts the areas of direct addresses behind all else: their sizes are known last.
    pub(in crate::check) fn place_areas(&mut self) {
        self.memory.next = self.areas.place(self.memory.next);
    }

    /// Gives a block its initial bytes.
    pub(in crate::check) fn place(&mut self, offset: u32, bytes: Arc<[u8]>) {
        self.memory.placed.push((offset, bytes));
    }

    /// Offset of a new block of memory; reports at `span` if there is no more.
    pub(in crate::check) fn allocate(&mut self, size: u32, align: u32, span: Span) -> Option<u32> {
        let offset = align_up(self.memory.next, align);
        if let Some(end) = offset.checked_add(size).filter(|end| u64::from(*end) <= self.memory_limit()) {
            self.memory.next = end;
            Some(offset)
        } else {
            self.report_too_large(span, Some(size.into()));
            None
        }
    }

    /// Accounts for an image before it is made; reports at `span` if it is one too many.
    pub(in crate::check) fn charge_image(&mut self, size: u64, span: Span) -> Option<()> {
        self.memory.images = self.memory.images.saturating_add(size);
        if self.memory.images > IMAGES_FOR_VARIABLES * self.memory_limit() {
            self.report_too_large(span, Some(size));
            return None;
        }
        Some(())
    }
}

impl Declarations<'_> {
    /// Where bytes lie that never change; equal ones lie there once.
    pub(in crate::check) fn constant_bytes(&mut self, ty: TypeId, bytes: Arc<[u8]>, span: Span) -> Option<Place> {
        let key = (ty, bytes.clone());
        if let Some(offset) = self.memory.literals.get(&key) {
            return Some(Place::whole(Storage::Absolute(*offset), ty, span));
        }
        let (size, align) = (self.types.size(ty), self.types.align(ty));
        let offset = self.allocate(size, align, span)?;
        self.place(offset, bytes);
        self.memory.literals.insert(key, offset);
        Some(Place::whole(Storage::Absolute(offset), ty, span))
    }
}

impl Declarations<'_> {
    /// Initial bytes as far as they have been placed.
    pub(in crate::check) fn image_at(&self, offset: u32, size: u32) -> Vec<u8> {
        let mut image = vec![0; size as usize];
        for (start, bytes) in &self.memory.placed {
            let low = offset.max(*start);
            let high = (offset + size).min(start + bytes.len() as u32);
            if low < high {
                let source = (low - start) as usize..(high - start) as usize;
                let target = (low - offset) as usize..(high - offset) as usize;
                image[target].copy_from_slice(&bytes[source]);
            }
        }
        image
    }
}

impl Declarations<'_> {
    pub(in crate::check) fn memory_image(&self) -> Vec<u8> {
        let mut image = vec![0; self.memory.next as usize];
        for (offset, bytes) in &self.memory.placed {
            let start = *offset as usize;
            // Only what `allocate` has handed out is placed, so it lies inside of the image.
            debug_assert!(start + bytes.len() <= image.len(), "bytes placed at {start} lie outside of the memory");
            if let Some(target) = image.get_mut(start..start + bytes.len()) {
                target.copy_from_slice(bytes);
            }
        }
        self.initialise_located(&mut image);
        image
    }
}
