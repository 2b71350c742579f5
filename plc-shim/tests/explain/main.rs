//! The page of each code: what its examples yield.

use onescan_iec::explain::{page, pages};
use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Code, Input};

/// The block marked `mark`: its language and its text.
fn block<'a>(page: &'a str, mark: &str) -> (&'a str, &'a str) {
    let (before, rest) = page.split_once(&format!(" {mark}\n")).expect(mark);
    let language = before.rsplit("```").next().expect("a language");
    (language, rest.split_once("\n```\n").expect("an end").0)
}

/// The codes that an example yields.
fn codes_of((language, text): (&str, &str)) -> Vec<&'static str> {
    if let Some(language) = language.strip_suffix(" alone") {
        // As a scenario without signals would have it.
        let input = Input::from_text(&format!("example.{language}"), SourceKind::Text, text);
        let application = onescan_iec_run::Application::from_inputs([input]).expect("a program");
        return application.open_inputs().iter().map(|_| Code::UndrivenInput.text()).collect();
    }
    let (language, instrumented) = language.strip_suffix(" instrument").map_or((language, false), |st| (st, true));
    let input = match language {
        "st" | "exp" | "scl" => Input::from_text(&format!("example.{language}"), SourceKind::Text, text),
        "plcopen" => Input::from_text("example.xml", SourceKind::PlcOpen, text),
        "xml" => Input::from_text("example.TcPOU", SourceKind::TwinCat, text),
        "plcproj" => {
            // Only the main program is there.
            let listing = onescan_iec::input::project::listing(text.as_bytes()).expect("a project");
            let missing = listing.files.iter().filter(|file| !file.path.ends_with("MAIN.TcPOU")).collect::<Vec<_>>();
            Input::with_missing_files("example.plcproj", &listing, &missing)
        }
        "hex" => {
            let bytes = text.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).expect("a byte"));
            Input::read("example.st", SourceKind::Text, &bytes.collect::<Vec<_>>())
        }
        other => panic!("{other:?} is not a language of examples"),
    };
    let findings = if instrumented {
        match onescan_iec_project::instrument::instrument(
            &[input],
            &onescan_iec_project::instrument::Options::default(),
        ) {
            Ok(project) => project.warnings,
            Err(onescan_iec_project::instrument::InstrumentError::Text(findings)) => findings,
            Err(error) => panic!("{error}"),
        }
    } else {
        onescan_iec::inspect([input], None)
    };
    let mut codes: Vec<_> = findings.iter().map(|found| found.code.text()).collect();
    codes.dedup();
    codes
}

#[test]
fn every_code_has_a_page_whose_examples_are_what_they_say() {
    for code in Code::ALL {
        let page = page(*code).unwrap_or_else(|| panic!("{code} has no page in docs/codes"));
        let title = format!("# {code}: {}\n", code.about());
        assert!(page.starts_with(&title), "{code}: the page begins with {title:?}");
        assert_eq!(codes_of(block(page, "wrong")), [code.text()], "the wrong example of {code}");
        assert_eq!(codes_of(block(page, "right")), [""; 0], "the right example of {code}");
    }
    assert_eq!(pages(), Code::ALL.len(), "a page is left over");
}
