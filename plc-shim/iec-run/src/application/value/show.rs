//! Bytes to literals (2nd ed. 2.2).

use std::fmt::Write;

use onescan_base::elementary::Kind;

use super::super::{Application, Variable};
use super::text::format;
use onescan_iec::ir::text::TextShape;
use onescan_iec::ir::{ElementaryType, Storage, Type, TypeId};

impl Application {
    /// The value of a variable as a literal, from the memory of a PLC: `TRUE`, `-5`, `16#00FF`,
    /// `T#1s500ms`, `'it$'s'`, `Red`, `[1, 2]`, `(a := 1, b := FALSE)`. Real numbers have the shortest
    /// digits that read back; bit strings are hexadecimal.
    pub fn value_text(&self, variable: &Variable, memory: &[u8]) -> String {
        let mut text = String::new();
        let bytes = memory.get(variable.offset as usize..).unwrap_or_default();
        if let (Some(bit), [byte, ..]) = (variable.bit, bytes) {
            show_elementary(ElementaryType::Bool, &[byte >> bit & 1], &mut text);
            return text;
        }
        self.show(variable.type_id, bytes, &mut text);
        text
    }

    /// Writes to `text`, which never fails.
    fn show(&self, ty: TypeId, bytes: &[u8], text: &mut String) {
        let types = &self.inner.checked.types;
        let bytes = bytes.get(..types.size(ty) as usize).unwrap_or_default();
        match types.get(ty) {
            Type::Elementary(elementary) | Type::Subrange { base: elementary, .. } => {
                show_elementary(*elementary, bytes, text);
            }
            Type::Enumeration { base, values, .. } => {
                let value = base.wrap(i128::from(number(bytes)));
                match values.iter().find(|(_, number)| *number == value) {
                    Some((name, _)) => text.push_str(name),
                    None => show_elementary(*base, bytes, text),
                }
            }
            Type::Interface { .. } => show_elementary(ElementaryType::Udint, bytes, text),
            Type::Text(shape) => show_text(*shape, bytes, text),
            Type::Array { element, .. } => {
                let (element, stride) = (*element, types.size(*element).max(1) as usize);
                let elements = bytes.chunks_exact(stride).map(|bytes| (None, element, bytes));
                self.show_list(('[', ']'), elements, text);
            }
            Type::Struct { fields, .. } => {
                let fields = fields.iter().filter_map(|field| {
                    let bytes = bytes.get(field.offset as usize..)?;
                    let bytes = match (field.bit, bytes) {
                        (Some(bit), [byte, ..]) => {
                            if byte >> bit & 1 == 0 {
                                &[0]
                            } else {
                                &[1]
                            }
                        }
                        _ => bytes,
                    };
                    Some((Some(field.name.as_str()), field.ty, bytes))
                });
                self.show_list(('(', ')'), fields, text);
            }
            Type::FunctionBlock { pou, .. } => {
                let variables = self.inner.checked.interfaces.get(pou).map_or(&[][..], Vec::as_slice);
                let held = variables.iter().filter_map(|variable| match variable.storage {
                    Storage::Instance(offset) => {
                        Some((Some(variable.name.as_str()), variable.ty, bytes.get(offset as usize..)?))
                    }
                    _ => None,
                });
                self.show_list(('(', ')'), held, text);
            }
            // What is referred to has a path of its own.
            Type::Reference { .. } | Type::Address { .. } | Type::OpenArray { .. } => {
                match number(bytes.get(..4).unwrap_or_default()) {
                    0 => text.push_str("NULL"),
                    _ => show_elementary(ElementaryType::Dword, bytes.get(..4).unwrap_or_default(), text),
                }
            }
            Type::Nothing | Type::Null => {}
        }
    }

    fn show_list<'b>(
        &self,
        (open, close): (char, char),
        items: impl Iterator<Item = (Option<&'b str>, TypeId, &'b [u8])>,
        text: &mut String,
    ) {
        text.push(open);
        for (index, (name, ty, bytes)) in items.enumerate() {
            text.push_str(if index > 0 { ", " } else { "" });
            if let Some(name) = name {
                text.push_str(name);
                text.push_str(" := ");
            }
            self.show(ty, bytes, text);
        }
        text.push(close);
    }
}

/// The bytes as an unsigned number.
fn number(bytes: &[u8]) -> u64 {
    bytes.iter().take(8).rev().fold(0, |number, byte| number << 8 | u64::from(*byte))
}

/// The literal of an elementary value, given by its bytes, least significant first.
pub fn literal(ty: ElementaryType, bytes: &[u8]) -> String {
    let mut text = String::new();
    show_elementary(ty, bytes, &mut text);
    text
}

fn show_elementary(ty: ElementaryType, bytes: &[u8], text: &mut String) {
    let raw = number(bytes);
    let _ = match ty.kind() {
        Kind::Bits => write!(text, "16#{raw:0width$X}", width = 2 * ty.size() as usize),
        Kind::Character => {
            let quote = if ty.size() == 1 { '\'' } else { '"' };
            text.push(quote);
            show_units([raw as u16].into_iter(), ty.size() == 2, text);
            text.push(quote);
            Ok(())
        }
        Kind::Real => write!(text, "{}", format(ty, raw.cast_signed()).text()),
        _ => write!(text, "{}", format(ty, ty.wrap(i128::from(raw)) as i64).text()),
    };
}

fn show_text(shape: TextShape, bytes: &[u8], text: &mut String) {
    let quote = if shape.wide { '"' } else { '\'' };
    text.push(quote);
    show_units(shape.decode(bytes).into_iter(), shape.wide, text);
    text.push(quote);
}

/// Characters as they stand between quotes (2nd ed. Tables 5 and 6).
fn show_units(units: impl Iterator<Item = u16>, wide: bool, text: &mut String) {
    let escape = |text: &mut String, unit: u16| {
        let width = if wide { 4 } else { 2 };
        let _ = write!(text, "${unit:0width$X}");
    };
    for character in char::decode_utf16(units) {
        match character {
            Ok('$') => text.push_str("$$"),
            Ok('\'') if !wide => text.push_str("$'"),
            Ok('"') if wide => text.push_str("$\""),
            Ok('\n') => text.push_str("$L"),
            Ok('\r') => text.push_str("$R"),
            Ok('\t') => text.push_str("$T"),
            Ok('\u{c}') => text.push_str("$P"),
            Ok(control) if control.is_control() => escape(text, control as u16),
            Ok(character) => text.push(character),
            Err(lone) => escape(text, lone.unpaired_surrogate()),
        }
    }
}
