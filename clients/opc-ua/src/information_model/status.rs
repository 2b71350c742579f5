//! What OPC UA clients get for their values: a status, or the bytes of a signal.

use onescan_server::signal::SignalType;
use opcua::types::{StatusCode, Variant};

use super::seat::Refusal;
use crate::link::value;

/// The status that reports a refusal (OPC 10000-4 7.38).
pub fn status(refusal: Refusal) -> StatusCode {
    match refusal {
        Refusal::NotStarted | Refusal::NotGranted => StatusCode::BadInvalidState,
        Refusal::Taken => StatusCode::BadUserAccessDenied,
        Refusal::Doubled => StatusCode::BadEntryExists,
        Refusal::Old => StatusCode::BadSequenceNumberInvalid,
        Refusal::Unknown => StatusCode::BadSequenceNumberUnknown,
        Refusal::Spoilt => StatusCode::BadDataEncodingInvalid,
        Refusal::Count => StatusCode::BadInvalidArgument,
        Refusal::Over => StatusCode::BadSessionClosed,
    }
}

/// The bytes of `given` as a signal of type `ty`.
pub(super) fn packed(ty: SignalType, given: &Variant) -> Result<Vec<u8>, StatusCode> {
    let given = match given {
        Variant::Variant(inner) => inner,
        plain => plain,
    };
    let mut bytes = vec![0; ty.size()];
    if !value::from_variant(ty, given, &mut bytes) {
        let is_text =
            matches!(given, Variant::String(_)) && matches!(ty, SignalType::String(_) | SignalType::Wstring(_));
        return Err(if is_text { StatusCode::BadOutOfRange } else { StatusCode::BadTypeMismatch });
    }
    ty.canonicalise(&mut bytes).map_err(|_| StatusCode::BadOutOfRange)?;
    Ok(bytes)
}
