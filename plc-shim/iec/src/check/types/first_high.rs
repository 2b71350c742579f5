//! Bytes as controllers of Siemens have them, where the highest byte of a value is its first (S7-SCL V5.3: `AT`).
//!
//! | type | there |
//! |---|---|
//! | BOOL | a bit, eight of them in a byte |
//! | BYTE, CHAR and other types of 8 bits | the next byte |
//! | types of 16, 32 and 64 bits | from the next even byte on, the highest byte first |
//! | arrays, structures | from the next even byte on, and up to one |

use crate::ir::{ElementaryType, Type, TypeId, TypeTable};

/// More bytes are seen through no view: each is copied on its own.
const BYTES_MAX: usize = 4096;

/// One byte there, and where its value lies here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::check) enum Cell {
    /// A byte at this offset.
    Byte(u32),
    /// BOOLs at these offsets, the lowest bit first.
    Bits([Option<u32>; 8]),
    Gap,
}

/// The bytes of a type; nothing for a type whose values have another form there, and for a very large one.
pub(in crate::check) fn cells(types: &TypeTable, ty: TypeId) -> Option<Vec<Cell>> {
    let mut layout = Layout { types, cells: Vec::new(), bit: 0 };
    layout.add(ty, 0)?;
    while layout.cells.last() == Some(&Cell::Gap) {
        layout.cells.pop();
    }
    Some(layout.cells)
}

struct Layout<'t> {
    types: &'t TypeTable,
    cells: Vec<Cell>,
    /// Bits taken of the last cell, if that has BOOLs; 0 if the next begins a byte.
    bit: usize,
}

impl Layout<'_> {
    fn even(&mut self) {
        self.bit = 0;
        if !self.cells.len().is_multiple_of(2) {
            self.cells.push(Cell::Gap);
        }
    }

    fn add(&mut self, ty: TypeId, offset: u32) -> Option<()> {
        match self.types.get(ty) {
            Type::Elementary(ElementaryType::Bool) => self.add_bit(offset),
            Type::Elementary(ty) => self.add_number(*ty, offset)?,
            Type::Subrange { base, .. } => self.add_number(*base, offset)?,
            Type::Array { dimensions, element } => {
                self.even();
                let count: u64 = dimensions.iter().map(|dimension| dimension.count()).product();
                let size = self.types.size(*element);
                for index in 0..count {
                    self.add(*element, offset + u32::try_from(index).ok()? * size)?;
                }
                self.even();
            }
            Type::Struct { fields, .. } => {
                self.even();
                for field in fields {
                    if field.bit.is_some() {
                        return None;
                    }
                    self.add(field.ty, offset + field.offset)?;
                }
                self.even();
            }
            _ => return None,
        }
        (self.cells.len() <= BYTES_MAX).then_some(())
    }

    fn add_bit(&mut self, offset: u32) {
        if self.bit == 0 {
            self.cells.push(Cell::Bits([None; 8]));
        }
        if let Some(Cell::Bits(bits)) = self.cells.last_mut() {
            bits[self.bit] = Some(offset);
        }
        self.bit = (self.bit + 1) % 8;
    }

    fn add_number(&mut self, ty: ElementaryType, offset: u32) -> Option<()> {
        let has_this_form = ty.is_integer() || ty.is_bits() || ty.is_real() || ty == ElementaryType::Char;
        if !has_this_form {
            return None;
        }
        self.bit = 0;
        if ty.size() > 1 {
            self.even();
        }
        self.cells.extend((0..ty.size()).rev().map(|byte| Cell::Byte(offset + byte)));
        Some(())
    }
}
