//! Any bytes as a source file: the first says of which kind.
//!
//! ```sh
//! cargo +nightly fuzz run front_end -- -max_len=65536 -timeout=10
//! ```
//!
//! The ST programs of the project make a good corpus: `cargo +nightly fuzz run front_end iec`.

#![no_main]

use libfuzzer_sys::fuzz_target;
use onescan_plc_shim::input::kind::SourceKind;

#[path = "../../tests/mutations/property.rs"]
mod property;

fuzz_target!(|bytes: &[u8]| {
    // `<` begins any XML: what XML it is, the byte before says.
    let kind = match bytes {
        [b'T', b'<', ..] => SourceKind::TwinCat,
        [b'P', b'<', ..] => SourceKind::PlcOpen,
        _ => SourceKind::Text,
    };
    let from = usize::from(kind != SourceKind::Text);
    property::examine(kind, &bytes[from..]);
});
