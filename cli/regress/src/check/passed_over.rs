//! Files of a folder that are left out on purpose. They are counted, so that nobody takes them for checked.

use std::fmt;

use onescan_iec::diagnostic::counted;
use serde::Serialize;

/// How many files of folders are left out, by the reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PassedOver {
    /// XML that is not PLCopen's.
    #[serde(skip_serializing_if = "is_none")]
    pub other_xml: usize,
    /// Projects with their shim in one file, which `instrument` wrote beside the sources.
    #[serde(skip_serializing_if = "is_none")]
    pub instrumented_projects: usize,
    /// PLC programs in a form that is not read, by their names.
    #[serde(skip_serializing_if = "is_none")]
    pub other_programs: usize,
    /// Program text that Beremiz or `OpenPLC` Editor made of the project's `plc.xml`.
    #[serde(skip_serializing_if = "is_none")]
    pub generated: usize,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_none(count: &usize) -> bool {
    *count == 0
}

impl PassedOver {
    /// True if no file is left out.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

impl fmt::Display for PassedOver {
    /// `1 other XML file passed over`
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kinds = [
            (self.other_xml, "other XML file"),
            (self.instrumented_projects, "instrumented project"),
            (self.other_programs, "program file of another kind"),
            (self.generated, "generated file"),
        ];
        let kinds = kinds.into_iter().filter(|(count, _)| *count > 0).map(|(count, word)| plural(count, word));
        write!(f, "{} passed over", kinds.collect::<Vec<_>>().join(" and "))
    }
}

/// `1 program file of another kind`, `2 program files of another kind`
fn plural(count: usize, word: &str) -> String {
    match word.split_once(" of ") {
        Some((head, tail)) => format!("{} of {tail}", counted(count, head)),
        None => counted(count, word),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_reason_has_its_count() {
        let both = PassedOver { other_xml: 2, instrumented_projects: 1, ..PassedOver::default() };
        assert_eq!(both.to_string(), "2 other XML files and 1 instrumented project passed over");
        let one = PassedOver { other_xml: 1, ..PassedOver::default() };
        assert_eq!(one.to_string(), "1 other XML file passed over");
        assert_eq!(serde_json::to_string(&one).unwrap(), "{\"other_xml\":1}");
        let programs = PassedOver { other_xml: 1, other_programs: 2, ..PassedOver::default() };
        assert_eq!(programs.to_string(), "1 other XML file and 2 program files of another kind passed over");
        let generated = PassedOver { generated: 2, ..PassedOver::default() };
        assert_eq!(generated.to_string(), "2 generated files passed over");
        assert!(PassedOver::default().is_empty() && !one.is_empty());
    }
}
