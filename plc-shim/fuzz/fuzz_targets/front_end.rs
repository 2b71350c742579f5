//! Any bytes as program text: parser, printer and checker neither panic nor hang.
//!
//! ```sh
//! cargo +nightly fuzz run front_end -- -max_len=65536 -timeout=10
//! ```
//!
//! The ST programs of the project make a good corpus: `cargo +nightly fuzz run front_end iec`.

#![no_main]

use libfuzzer_sys::fuzz_target;
use onescan_plc_shim::Input;
use onescan_plc_shim::application::inspect;
use onescan_plc_shim::input::kind::SourceKind;
use onescan_plc_shim::syntax::printer::print_unit;
use onescan_plc_shim::syntax::{FileId, parse};

fuzz_target!(|bytes: &[u8]| {
    let text = String::from_utf8_lossy(bytes);
    let parsed = parse(FileId(0), &text);
    if parsed.diagnostics.is_empty() {
        let printed = print_unit(&parsed.unit);
        let again = parse(FileId(0), &printed);
        assert!(again.diagnostics.is_empty(), "what is printed parses");
        assert_eq!(print_unit(&again.unit), printed, "what is printed is stable");
    }
    let _ = inspect([Input::from_text("fuzz.st", SourceKind::Text, &*text)], None);
    // Whatever stands in a file of another kind, it is read or refused.
    for kind in [SourceKind::TwinCat, SourceKind::PlcOpen] {
        let _ = inspect([Input::read("fuzz.xml", kind, bytes)], None);
    }
});
