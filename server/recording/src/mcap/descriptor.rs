//! The signals of one client as a protobuf message, and its description.
//!
//! Viewers want the description as a serialised `FileDescriptorSet` (protobuf's `descriptor.proto`).
//! It has one message with one field a signal; both are short enough to be written by hand.

use onescan_server::signal::SignalType as T;

use super::super::column::Column;

/// Wire types of protobuf.
const VARINT: u32 = 0;
const FIXED64: u32 = 1;
const BYTES: u32 = 2;
const FIXED32: u32 = 5;

/// `syntax`, `name` and the like of `descriptor.proto`, by their numbers.
mod number {
    pub(super) const FILE: u32 = 1;
    pub(super) const FILE_NAME: u32 = 1;
    pub(super) const FILE_PACKAGE: u32 = 2;
    pub(super) const FILE_MESSAGE: u32 = 4;
    pub(super) const FILE_SYNTAX: u32 = 12;
    pub(super) const MESSAGE_NAME: u32 = 1;
    pub(super) const MESSAGE_FIELD: u32 = 2;
    pub(super) const FIELD_NAME: u32 = 1;
    pub(super) const FIELD_NUMBER: u32 = 3;
    pub(super) const FIELD_LABEL: u32 = 4;
    pub(super) const FIELD_TYPE: u32 = 5;
    pub(super) const FIELD_JSON_NAME: u32 = 10;
}

const OPTIONAL: u64 = 1;

/// How a signal's value is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Double,
    Float,
    Unsigned32,
    Unsigned64,
    /// Zigzag, so that small negative numbers are short.
    Signed32,
    Signed64,
    Bool,
    Text,
}

impl Form {
    fn of(ty: T) -> Self {
        match ty {
            T::BOOL => Self::Bool,
            T::BYTE | T::WORD | T::DWORD | T::USINT | T::UINT | T::UDINT => Self::Unsigned32,
            T::LWORD | T::ULINT => Self::Unsigned64,
            T::SINT | T::INT | T::DINT => Self::Signed32,
            T::REAL => Self::Float,
            T::LREAL => Self::Double,
            T::CHAR | T::WCHAR | T::String(_) | T::Wstring(_) | T::Bytes(_) => Self::Text,
            T::Elementary(_) => Self::Signed64,
        }
    }

    /// Its number in `FieldDescriptorProto.Type`.
    fn type_number(self) -> u64 {
        match self {
            Self::Double => 1,
            Self::Float => 2,
            Self::Unsigned64 => 4,
            Self::Bool => 8,
            Self::Text => 9,
            Self::Unsigned32 => 13,
            Self::Signed32 => 17,
            Self::Signed64 => 18,
        }
    }

    fn wire(self) -> u32 {
        match self {
            Self::Double => FIXED64,
            Self::Float => FIXED32,
            Self::Text => BYTES,
            _ => VARINT,
        }
    }
}

/// The name as protobuf wants it: letters, digits and `_`.
pub(super) fn identifier(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect()
}

/// The serialised `FileDescriptorSet` of a message `onescan.NAME` with the given fields.
pub(super) fn file_descriptor_set(name: &str, columns: &[&Column]) -> Vec<u8> {
    let mut message = Vec::new();
    bytes(number::MESSAGE_NAME, name.as_bytes(), &mut message);
    let mut taken: Vec<String> = Vec::new();
    for (index, column) in (1..).zip(columns) {
        let mut plain = identifier(column.name.as_str());
        if taken.contains(&plain) {
            plain = format!("{plain}_{index}");
        }
        let mut field = Vec::new();
        bytes(number::FIELD_NAME, plain.as_bytes(), &mut field);
        varint_field(number::FIELD_NUMBER, index, &mut field);
        varint_field(number::FIELD_LABEL, OPTIONAL, &mut field);
        varint_field(number::FIELD_TYPE, Form::of(column.ty).type_number(), &mut field);
        bytes(number::FIELD_JSON_NAME, column.name.as_str().as_bytes(), &mut field);
        bytes(number::MESSAGE_FIELD, &field, &mut message);
        taken.push(plain);
    }
    let mut file = Vec::new();
    bytes(number::FILE_NAME, format!("{name}.proto").as_bytes(), &mut file);
    bytes(number::FILE_PACKAGE, b"onescan", &mut file);
    bytes(number::FILE_MESSAGE, &message, &mut file);
    bytes(number::FILE_SYNTAX, b"proto3", &mut file);
    let mut set = Vec::new();
    bytes(number::FILE, &file, &mut set);
    set
}

/// The message that holds the values of `columns` in `image`.
pub(super) fn message<'c>(columns: impl Iterator<Item = &'c Column>, image: &[u8], out: &mut Vec<u8>) {
    for (index, column) in (1..).zip(columns) {
        let form = Form::of(column.ty);
        let value = column.bytes(image);
        tag(index, form.wire(), out);
        match form {
            Form::Double | Form::Float => out.extend_from_slice(value),
            Form::Bool | Form::Unsigned32 | Form::Unsigned64 => varint(unsigned(value), out),
            Form::Signed32 | Form::Signed64 => varint(zigzag(value), out),
            Form::Text => {
                let text = column.ty.to_text(value);
                varint(text.len() as u64, out);
                out.extend_from_slice(text.as_bytes());
            }
        }
    }
}

fn unsigned(value: &[u8]) -> u64 {
    value.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte))
}

fn zigzag(value: &[u8]) -> u64 {
    let unused = 64 - 8 * value.len().min(8) as u32;
    let number = (unsigned(value) << unused) as i64 >> unused;
    ((number << 1) ^ (number >> 63)) as u64
}

fn tag(field: u32, wire: u32, out: &mut Vec<u8>) {
    varint(u64::from(field << 3 | wire), out);
}

fn varint_field(field: u32, value: u64, out: &mut Vec<u8>) {
    tag(field, VARINT, out);
    varint(value, out);
}

fn bytes(field: u32, value: &[u8], out: &mut Vec<u8>) {
    tag(field, BYTES, out);
    varint(value.len() as u64, out);
    out.extend_from_slice(value);
}

fn varint(mut value: u64, out: &mut Vec<u8>) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}
