//! A port: the signals one client reads, or those it writes, packed in the order it named them.
//!
//! A client never sees the image. It gets the bytes of its inputs and gives the bytes of its outputs,
//! each port packed without padding, and finds its values by [`Slot`]s it looked up once, at joining.

use std::marker::PhantomData;

use onescan_base::value::{CANONICAL_NAN_F32, CANONICAL_NAN_F64};
use onescan_base::{SignalType, nearest};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::name::SignalName;

/// One signal of a port.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Port {
    /// The signal.
    pub name: SignalName,
    /// The type that the client takes it for.
    #[serde(rename = "type")]
    pub ty: SignalType,
}

/// Where each signal of a port lies: packed, in the port's own order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PortLayout {
    ports: Vec<Port>,
    offsets: Vec<usize>,
    size: usize,
}

impl PortLayout {
    /// Packs `ports` one behind the other.
    pub fn new(ports: Vec<Port>) -> Self {
        let mut size = 0;
        let offsets = ports
            .iter()
            .map(|port| {
                let offset = size;
                size += port.ty.size();
                offset
            })
            .collect();
        Self { ports, offsets, size }
    }

    /// Bytes of the whole port.
    pub const fn size(&self) -> usize {
        self.size
    }

    /// Signals with the byte offset of each.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (&Port, usize)> {
        self.ports.iter().zip(self.offsets.iter().copied())
    }

    /// The signals in the port's order.
    pub fn ports(&self) -> &[Port] {
        &self.ports
    }

    /// The place of signal `name`, which must have the IEC type of `V`.
    ///
    /// # Errors
    /// A name that the port has not, a signal of another type.
    pub fn slot<V: SlotType>(&self, name: &str) -> Result<Slot<V>, SlotError> {
        let (port, offset) = self.iter().find(|(port, _)| port.name.as_str() == name).ok_or_else(|| {
            let nearest = nearest(name, self.ports.iter().map(|port| port.name.as_str())).map(str::to_owned);
            SlotError::Unknown { name: name.to_owned(), nearest }
        })?;
        debug_assert!(offset + port.ty.size() <= self.size, "`{name}` lies within its port");
        if V::accepts(port.ty) {
            Ok(Slot { offset, value: PhantomData })
        } else {
            Err(SlotError::Type { name: name.to_owned(), ty: port.ty, wanted: V::IEC })
        }
    }
}

/// Why a port has no slot of that name and type.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SlotError {
    /// No such signal in the port.
    #[error("no signal `{name}` in this port{}", nearest.as_ref().map(|n| format!("; did you mean `{n}`?")).unwrap_or_default())]
    Unknown {
        /// The name asked for.
        name: String,
        /// The nearest name that there is.
        nearest: Option<String>,
    },
    /// A signal of another type.
    #[error("signal `{name}` is {ty}, not {wanted}")]
    Type {
        /// The signal.
        name: String,
        /// Its type.
        ty: SignalType,
        /// The type asked for.
        wanted: &'static str,
    },
}

/// The place of a value of Rust type `V` in a port's bytes.
#[derive(Debug, PartialEq, Eq)]
pub struct Slot<V> {
    offset: usize,
    value: PhantomData<V>,
}

impl<V> Clone for Slot<V> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<V> Copy for Slot<V> {}

impl<V: SlotType> Slot<V> {
    /// The value in `port`.
    ///
    /// # Panics
    /// If `port` is shorter than the layout that gave this slot.
    pub fn get(self, port: &[u8]) -> V {
        V::get(&port[self.offset..])
    }

    /// Puts `value` into `port`.
    ///
    /// # Panics
    /// If `port` is shorter than the layout that gave this slot.
    pub fn set(self, port: &mut [u8], value: V) {
        value.put(&mut port[self.offset..]);
    }
}

/// A Rust type that stands for IEC elementary types of its width.
pub trait SlotType: Copy {
    /// The IEC types in words, for errors.
    const IEC: &'static str;
    /// True for the IEC types this one can stand for.
    fn accepts(ty: SignalType) -> bool;
    /// Reads a value from the start of `bytes`.
    fn get(bytes: &[u8]) -> Self;
    /// Writes the value to the start of `bytes`.
    fn put(self, bytes: &mut [u8]);
}

impl SlotType for bool {
    const IEC: &'static str = "BOOL";

    fn accepts(ty: SignalType) -> bool {
        ty == SignalType::BOOL
    }

    fn get(bytes: &[u8]) -> Self {
        bytes[0] != 0
    }

    fn put(self, bytes: &mut [u8]) {
        bytes[0] = u8::from(self);
    }
}

macro_rules! number_slot {
    ($rust:ty, $iec:literal, $($ty:ident)|+, $canonical:expr) => {
        impl SlotType for $rust {
            const IEC: &'static str = $iec;

            fn accepts(ty: SignalType) -> bool {
                matches!(ty, $(SignalType::$ty)|+)
            }

            fn get(bytes: &[u8]) -> Self {
                let mut raw = [0; size_of::<$rust>()];
                raw.copy_from_slice(&bytes[..size_of::<$rust>()]);
                Self::from_le_bytes(raw)
            }

            fn put(self, bytes: &mut [u8]) {
                let canonical: fn(Self) -> Self = $canonical;
                bytes[..size_of::<$rust>()].copy_from_slice(&canonical(self).to_le_bytes());
            }
        }
    };
}

number_slot!(i8, "SINT", SINT, |v| v);
number_slot!(u8, "BYTE or USINT", BYTE | USINT | CHAR, |v| v);
number_slot!(i16, "INT", INT, |v| v);
number_slot!(u16, "WORD or UINT", WORD | UINT | WCHAR, |v| v);
number_slot!(i32, "DINT", DINT, |v| v);
number_slot!(u32, "DWORD or UDINT", DWORD | UDINT, |v| v);
number_slot!(i64, "LINT or TIME", LINT | TIME | LTIME | DATE | LDATE | TOD | LTOD | DT | LDT, |v| v);
number_slot!(u64, "LWORD or ULINT", LWORD | ULINT, |v| v);
number_slot!(f32, "REAL", REAL, |v| if v.is_nan() { CANONICAL_NAN_F32 } else { v });
number_slot!(f64, "LREAL", LREAL, |v| if v.is_nan() { CANONICAL_NAN_F64 } else { v });

#[cfg(test)]
mod tests {
    use super::*;

    fn layout() -> PortLayout {
        let port = |name: &str, ty| Port { name: SignalName::new(name).unwrap(), ty };
        PortLayout::new(vec![
            port("on", SignalType::BOOL),
            port("position", SignalType::LREAL),
            port("count", SignalType::INT),
        ])
    }

    #[test]
    fn ports_are_packed_in_their_own_order() {
        let layout = layout();
        assert_eq!(layout.size(), 11);
        assert_eq!(layout.iter().map(|(_, offset)| offset).collect::<Vec<_>>(), [0, 1, 9]);
    }

    #[test]
    fn slots_find_their_values() {
        let layout = layout();
        let mut bytes = vec![0; layout.size()];
        layout.slot::<f64>("position").unwrap().set(&mut bytes, 0.25);
        layout.slot::<i16>("count").unwrap().set(&mut bytes, -3);
        assert_eq!(layout.slot::<f64>("position").unwrap().get(&bytes), 0.25);
        assert_eq!(layout.slot::<i16>("count").unwrap().get(&bytes), -3);
        assert!(!layout.slot::<bool>("on").unwrap().get(&bytes));
    }

    #[test]
    fn a_wrong_slot_says_what_is_there() {
        let layout = layout();
        let unknown = layout.slot::<f64>("postion").unwrap_err();
        assert_eq!(unknown.to_string(), "no signal `postion` in this port; did you mean `position`?");
        let wrong = layout.slot::<f32>("position").unwrap_err();
        assert_eq!(wrong.to_string(), "signal `position` is LREAL, not REAL");
    }
}
