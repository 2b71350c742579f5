//! A page for each code: what it means, an example that is wrong, one that is right.
//!
//! The pages are Markdown in `docs/codes`, each with a block marked `wrong` and one marked `right`;
//! a test asserts that they are what they say.

use crate::diagnostic::Code;

macro_rules! pages {
    ($($code:literal),* $(,)?) => {
        &[$(($code, include_str!(concat!("../docs/codes/", $code, ".md")))),*]
    };
}

/// In the order of the codes.
#[rustfmt::skip]
const PAGES: &[(&str, &str)] = pages![
    "C0301",
    "C0302",
    "C0303",
    "C0304",
    "C0305",
    "C0306",
    "C0307",
    "C0310",
    "D0401",
    "D0402",
    "D0403",
    "D0404",
    "D0405",
    "D0406",
    "D0407",
    "D0408",
    "D0409",
    "D0410",
    "D0411",
    "D0430",
    "D0431",
    "D0432",
    "D0433",
    "D0434",
    "D0435",
    "D0436",
    "D0437",
    "D0438",
    "D0439",
    "D0440",
    "F0601",
    "F0602",
    "F0603",
    "F0604",
    "G1101",
    "G1102",
    "G1103",
    "G1104",
    "G1105",
    "G1106",
    "G1107",
    "G1108",
    "G1109",
    "G1120",
    "G1121",
    "I1001",
    "I1002",
    "I1003",
    "I1004",
    "L0501",
    "L0502",
    "L0511",
    "L0512",
    "L0513",
    "N0101",
    "N0102",
    "N0103",
    "N0104",
    "N0105",
    "N0106",
    "N0107",
    "O0801",
    "O0802",
    "O0803",
    "O0804",
    "O0805",
    "O0806",
    "O0807",
    "O0808",
    "O0809",
    "O0810",
    "O0811",
    "O0812",
    "Q1201",
    "Q1202",
    "Q1203",
    "Q1204",
    "Q1205",
    "Q1206",
    "Q1207",
    "Q1208",
    "Q1209",
    "Q1210",
    "Q1211",
    "Q1212",
    "Q1213",
    "R0901",
    "R0902",
    "R0903",
    "R0904",
    "R0905",
    "R0906",
    "R0907",
    "R0908",
    "S0101",
    "S0102",
    "S0103",
    "S0104",
    "S0105",
    "S0110",
    "S0111",
    "T0201",
    "T0202",
    "T0203",
    "T0204",
    "T0205",
    "T0206",
    "T0207",
    "T0208",
    "T0209",
    "T0210",
    "W0701",
    "W0702",
    "W0703",
    "W0704",
    "W0705",
    "W0706",
    "W0707",
    "W0708",
    "W0709",
    "W0710",
    "W0711",
];

/// The page that explains `code`, as Markdown.
pub fn page(code: Code) -> Option<&'static str> {
    PAGES.iter().find(|(text, _)| *text == code.text()).map(|(_, page)| *page)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::Input;
    use crate::input::kind::SourceKind;

    /// The block marked `mark`: its language and its text.
    fn block<'a>(page: &'a str, mark: &str) -> (&'a str, &'a str) {
        let (before, rest) = page.split_once(&format!(" {mark}\n")).expect(mark);
        let language = before.rsplit("```").next().expect("a language");
        (language, rest.split_once("\n```\n").expect("an end").0)
    }

    /// The codes that an example yields.
    fn codes_of((language, text): (&str, &str)) -> Vec<&'static str> {
        let (language, instrumented) = language.strip_suffix(" instrument").map_or((language, false), |st| (st, true));
        let input = match language {
            "st" | "exp" | "scl" => Input::from_text(&format!("example.{language}"), SourceKind::Text, text),
            "plcopen" => Input::from_text("example.xml", SourceKind::PlcOpen, text),
            "xml" => Input::from_text("example.TcPOU", SourceKind::TwinCat, text),
            "plcproj" => {
                // Only the main program is there.
                let listing = crate::input::project::listing(text.as_bytes()).expect("a project");
                let missing =
                    listing.files.iter().filter(|file| !file.path.ends_with("MAIN.TcPOU")).collect::<Vec<_>>();
                Input::with_missing_files("example.plcproj", &listing, &missing)
            }
            "hex" => {
                let bytes = text.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).expect("a byte"));
                Input::read("example.st", SourceKind::Text, &bytes.collect::<Vec<_>>())
            }
            other => panic!("{other:?} is no language of examples"),
        };
        let findings = if instrumented {
            match crate::instrument::instrument(&[input], &crate::instrument::Options::default()) {
                Ok(project) => project.warnings,
                Err(crate::instrument::InstrumentError::Text(findings)) => findings,
                Err(error) => panic!("{error}"),
            }
        } else {
            crate::inspect([input], None)
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
        assert_eq!(PAGES.len(), Code::ALL.len(), "a page is left over");
    }
}
