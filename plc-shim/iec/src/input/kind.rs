//! What kind of file it is, by its name.

use std::path::Path;

/// The kinds of file that hold program text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SourceKind {
    /// Text alone: `.st`, `.iec`, `.exp`, `.scl`.
    Text,
    /// One object of a TwinCAT 3 project: `.TcPOU`, `.TcDUT`, `.TcGVL`, `.TcIO`, `.TcTLEO`, `.TcTTO`.
    TwinCat,
    /// PLCopen XML (IEC 61131-10, TC6 2.01): `.xml`.
    PlcOpen,
}

/// The kinds of file that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    /// It holds program text.
    Source(SourceKind),
    /// It names such files: `.plcproj`.
    Project,
}

/// Every extension that is read.
pub const EXTENSIONS: [(&str, FileKind); 12] = [
    ("st", FileKind::Source(SourceKind::Text)),
    ("iec", FileKind::Source(SourceKind::Text)),
    ("exp", FileKind::Source(SourceKind::Text)),
    ("scl", FileKind::Source(SourceKind::Text)),
    ("TcPOU", FileKind::Source(SourceKind::TwinCat)),
    ("TcDUT", FileKind::Source(SourceKind::TwinCat)),
    ("TcGVL", FileKind::Source(SourceKind::TwinCat)),
    ("TcIO", FileKind::Source(SourceKind::TwinCat)),
    ("TcTLEO", FileKind::Source(SourceKind::TwinCat)),
    ("TcTTO", FileKind::Source(SourceKind::TwinCat)),
    ("plcproj", FileKind::Project),
    ("xml", FileKind::Source(SourceKind::PlcOpen)),
];

/// Extensions of files that hold PLC programs in a form that is not read: STL of SIMATIC, projects of Logix, CODESYS,
/// Omron, Schneider and 4diac, documents of SIMATIC SD.
const OTHER_PROGRAMS: [&str; 11] =
    ["awl", "stl", "l5x", "l5k", "project", "export", "smc2", "xef", "stu", "fbt", "s7dcl"];

/// True if the name says that the file holds a PLC program in a form that is not read.
pub fn is_other_program(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    extension.is_some_and(|extension| OTHER_PROGRAMS.iter().any(|known| known.eq_ignore_ascii_case(extension)))
}

impl FileKind {
    /// The kind of a file, by its extension in any case.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?;
        EXTENSIONS.iter().find(|(known, _)| known.eq_ignore_ascii_case(extension)).map(|(_, kind)| *kind)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_are_known_in_any_case() {
        assert_eq!(FileKind::of(Path::new("a/Main.TCPOU")), Some(FileKind::Source(SourceKind::TwinCat)));
        assert_eq!(FileKind::of(Path::new("x.plcproj")), Some(FileKind::Project));
        assert_eq!(FileKind::of(Path::new("x.txt")), None);
        assert_eq!(FileKind::of(Path::new("st")), None);
        assert!(is_other_program(Path::new("a/Pump.AWL")) && !is_other_program(Path::new("awl")));
    }
}
