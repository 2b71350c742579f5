//! How types of IEC 61131-3 are held in Parquet.
//!
//! | type | physical | logical |
//! |---|---|---|
//! | BOOL | BOOLEAN | |
//! | SINT, INT, DINT, USINT, UINT, UDINT, BYTE, WORD, DWORD, CHAR, WCHAR | INT32 | integer of its width and sign |
//! | LINT, ULINT, LWORD | INT64 | integer of its width and sign |
//! | REAL, LREAL | FLOAT, DOUBLE | |
//! | TIME, LTIME | INT64 | ns |
//! | DATE, DT, LDATE, LDT | INT64 | timestamp, ns, without a zone |
//! | TOD, LTOD | INT64 | time of day, ns |
//! | STRING, WSTRING | BYTE_ARRAY | UTF-8 |

use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, TimeUnit, Type as Physical};
use parquet::errors::Result;
use parquet::schema::types::{PrimitiveTypeBuilder, Type, TypePtr};

use onescan_server::signal::SignalType as T;

use super::super::column::Column;

/// Columns before those of signals: their names, and how many there are.
pub(crate) const LEADING: [&str; 3] = ["step", "t_v_ns", "digest"];

/// Bytes of a digest.
pub(super) const DIGEST_BYTES: usize = 32;

/// How a type's values are held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Held {
    Bit,
    /// 32 bits; narrower values are widened with or without their sign.
    Word {
        bytes: usize,
        signed: bool,
    },
    /// The same bytes as in an image.
    Same(Physical),
    Text,
}

impl Held {
    pub(crate) fn of(ty: T) -> Self {
        match ty {
            T::BOOL => Self::Bit,
            T::SINT | T::INT => Self::Word { bytes: ty.size(), signed: true },
            T::BYTE | T::USINT | T::CHAR | T::WORD | T::UINT | T::WCHAR => {
                Self::Word { bytes: ty.size(), signed: false }
            }
            T::DINT | T::DWORD | T::UDINT => Self::Same(Physical::INT32),
            T::REAL => Self::Same(Physical::FLOAT),
            T::LREAL => Self::Same(Physical::DOUBLE),
            T::String(_) | T::Wstring(_) | T::Bytes(_) => Self::Text,
            T::Elementary(_) => Self::Same(Physical::INT64),
        }
    }

    fn physical(self) -> Physical {
        match self {
            Self::Bit => Physical::BOOLEAN,
            Self::Word { .. } => Physical::INT32,
            Self::Same(physical) => physical,
            Self::Text => Physical::BYTE_ARRAY,
        }
    }
}

fn logical(ty: T) -> Option<LogicalType> {
    let integer = |bit_width, is_signed| Some(LogicalType::integer(bit_width, is_signed));
    match ty {
        T::SINT => integer(8, true),
        T::INT => integer(16, true),
        T::DINT => integer(32, true),
        T::LINT => integer(64, true),
        T::USINT | T::BYTE | T::CHAR => integer(8, false),
        T::UINT | T::WORD | T::WCHAR => integer(16, false),
        T::UDINT | T::DWORD => integer(32, false),
        T::ULINT | T::LWORD => integer(64, false),
        T::DATE | T::LDATE | T::DT | T::LDT => Some(LogicalType::timestamp(false, TimeUnit::NANOS)),
        T::TOD | T::LTOD => Some(LogicalType::time(false, TimeUnit::NANOS)),
        T::String(_) | T::Wstring(_) | T::Bytes(_) => Some(LogicalType::String),
        T::BOOL | T::REAL | T::LREAL | T::TIME | T::LTIME => None,
    }
}

fn required(name: &str, physical: Physical) -> PrimitiveTypeBuilder<'_> {
    Type::primitive_type_builder(name, physical).with_repetition(Repetition::REQUIRED)
}

/// The schema of a trajectory: the leading columns, then the signals. A signal with the name of a
/// leading column has `.signal` behind it.
pub(super) fn schema(columns: &[Column]) -> Result<TypePtr> {
    let mut fields = vec![
        required(LEADING[0], Physical::INT64).build()?,
        required(LEADING[1], Physical::INT64).build()?,
        required(LEADING[2], Physical::FIXED_LEN_BYTE_ARRAY).with_length(DIGEST_BYTES as i32).build()?,
    ];
    for column in columns {
        let mut name = column.name.to_string();
        if LEADING.contains(&name.as_str()) {
            name.push_str(".signal");
        }
        let physical = Held::of(column.ty).physical();
        fields.push(required(&name, physical).with_logical_type(logical(column.ty)).build()?);
    }
    Ok(Arc::new(
        Type::group_type_builder("trajectory").with_fields(fields.into_iter().map(Arc::new).collect()).build()?,
    ))
}
