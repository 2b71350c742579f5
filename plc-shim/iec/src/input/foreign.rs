//! Text that is something else than a program, by how it begins: one finding says so, not one for each of its words.

/// What a file holds that is not program text, and what may help.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Foreign {
    pub(super) what: &'static str,
    pub(super) help: Option<&'static str>,
}

/// What `text` is, if no program begins so. Programs begin with a word, a comment or a pragma.
pub(super) fn recognise(text: &str) -> Option<Foreign> {
    let text = text.trim_start();
    let found = |what, help| Some(Foreign { what, help });
    if text.starts_with('<') {
        let head: String = text.chars().take(4096).collect();
        let has = |name: &str| head.contains(name);
        if has("<TcPlcObject") {
            return found("XML of TwinCAT", Some("name it .TcPOU, .TcDUT, .TcGVL or .TcIO"));
        }
        if has("plcopen.org") {
            return found("PLCopen XML", Some("name it .xml"));
        }
        let is_page = head.to_ascii_lowercase().starts_with("<!doctype html") || has("<html");
        return found(if is_page { "a web page" } else { "XML" }, None);
    }
    let archive = ["PK\u{3}\u{4}", "%PDF-", "\u{7f}ELF", "Rar!", "7z\u{bc}\u{af}", "\u{1f}\u{8b}"];
    if archive.iter().any(|magic| text.starts_with(magic)) {
        return found("an archive or a document", None);
    }
    // `{attribute 'x'}` is a pragma; in JSON a string or another bracket comes first.
    let inner = text.strip_prefix(['{', '[']).map(str::trim_start);
    if inner.is_some_and(|inner| text.starts_with('[') || inner.starts_with('"')) {
        return found("JSON or settings", None);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::recognise;

    #[test]
    fn what_is_no_program_is_recognised_by_its_beginning() {
        let what = |text| recognise(text).map(|found| found.what);
        assert_eq!(what("\n<?xml version=\"1.0\"?><TcPlcObject>"), Some("XML of TwinCAT"));
        assert_eq!(what("<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\">"), Some("PLCopen XML"));
        assert_eq!(what("<!DOCTYPE html><html>"), Some("a web page"));
        assert_eq!(what("<a/>"), Some("XML"));
        assert_eq!(what("{ \"a\": 1 }"), Some("JSON or settings"));
        assert_eq!(what("[section]\nkey=1"), Some("JSON or settings"));
        assert_eq!(what("PK\u{3}\u{4}.."), Some("an archive or a document"));
    }

    #[test]
    fn programs_are_programs() {
        for text in ["", " ", "PROGRAM p", "(* < *)", "// [", "{attribute 'a'}\nPROGRAM p", "{IF x}", "\u{feff}TYPE a"]
        {
            assert_eq!(recognise(text), None, "{text:?}");
        }
    }
}
