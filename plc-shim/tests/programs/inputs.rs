//! Files as they are found: whatever is in them, they are read, and places lead back into them.

use onescan_iec::input::encoding::{decode, encode};
use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, inspect};
use onescan_iec_run::Application;
use proptest::prelude::*;

const PROJECT: &str = include_str!("../inputs/ramp.xml");

const KINDS: [SourceKind; 3] = [SourceKind::Text, SourceKind::TwinCat, SourceKind::PlcOpen];

#[test]
fn a_project_in_xml_compiles() {
    let text = PROJECT.replace("<LD/>", "<ST>Start := TRUE;</ST>");
    let input = Input::from_text("ramp.xml", SourceKind::PlcOpen, text);
    let application = Application::from_inputs([input]).expect("it compiles");
    assert_eq!(application.programs().map(|program| program.name).collect::<Vec<_>>(), ["Main"]);
}

#[test]
fn places_in_xml_are_those_of_the_file() {
    let text = PROJECT.replace("<LD/>", "<ST/>").replace("Limit.High", "Limit.Hihg");
    let input = Input::from_text("ramp.xml", SourceKind::PlcOpen, text.replace("\"Limits\"/>", "\"Limit\"/>"));
    insta::assert_snapshot!(inspect([input], None), @"ramp.xml:26:57: error[N0103]: type `Limit` is not declared (did you mean `Limits`?)");
    let input = Input::from_text("ramp.xml", SourceKind::PlcOpen, text);
    insta::assert_snapshot!(inspect([input], None), @"ramp.xml:40:92: error[N0104]: Limits has no member `Hihg` (did you mean `High`?)");
}

#[test]
fn equal_text_in_any_encoding_has_equal_findings() {
    let text = "(* Förderband, 5 € *)\r\nPROGRAM P\r\n  größe := 1;\r\n  x := 1;\r\nEND_PROGRAM\r\n";
    let mut wide = vec![0xff, 0xfe];
    wide.extend(text.encode_utf16().flat_map(u16::to_le_bytes));
    let narrow = text.chars().map(|one| if one == '€' { 0x80 } else { one as u8 });
    let found = |bytes: &[u8]| inspect([Input::read("p.st", SourceKind::Text, bytes)], None).to_string();
    let expected = found(text.as_bytes());
    assert!(expected.contains("p.st:4:3: error[N0101]"), "{expected}");
    for bytes in [wide, narrow.collect(), format!("\u{feff}{text}").into_bytes()] {
        assert_eq!(found(&bytes), expected);
        let (read, encoding) = decode(&bytes).expect("text");
        assert_eq!((read.as_str(), encode(&read, encoding).as_deref()), (text, Ok(bytes.as_slice())));
    }
}

proptest! {
    /// Any bytes, and a good file with some of its bytes changed.
    #[test]
    fn no_file_makes_it_fail(
        bytes in proptest::collection::vec(any::<u8>(), 0..300),
        changes in proptest::collection::vec((0..PROJECT.len(), any::<u8>()), 1..6),
    ) {
        let mut changed = PROJECT.as_bytes().to_vec();
        for (at, byte) in changes {
            changed[at] = byte;
        }
        for kind in KINDS {
            for bytes in [&bytes, &changed] {
                let findings = inspect([Input::read("any", kind, bytes)], None);
                for finding in findings.findings() {
                    let span = finding.diagnostic().span;
                    prop_assert!(finding.text().get(span.start as usize..span.end as usize).is_some());
                }
            }
        }
    }
}
