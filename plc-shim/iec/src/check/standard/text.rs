//! Functions of character strings (2nd ed. Table 29, 3rd ed. Table 34): names and parameters.

use crate::ir::text::Edit;

/// A function of strings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::check) enum TextForm {
    Length,
    Find,
    Edit(Edit),
}

/// Names in the standard.
pub(in crate::check) const FUNCTIONS: [(&str, TextForm); 9] = [
    ("LEN", TextForm::Length),
    ("LEFT", TextForm::Edit(Edit::Left)),
    ("RIGHT", TextForm::Edit(Edit::Right)),
    ("MID", TextForm::Edit(Edit::Middle)),
    ("CONCAT", TextForm::Edit(Edit::Concat)),
    ("INSERT", TextForm::Edit(Edit::Insert)),
    ("DELETE", TextForm::Edit(Edit::Delete)),
    ("REPLACE", TextForm::Edit(Edit::Replace)),
    ("FIND", TextForm::Find),
];

/// The standard's name of a parameter that CODESYS and TwinCAT name their own way; else the name.
pub(super) fn of_vendors(name: &str) -> &str {
    match name {
        "STR" => "IN",
        "STR1" => "IN1",
        "STR2" => "IN2",
        "SIZE" | "LEN" => "L",
        "POS" => "P",
        _ => name,
    }
}

impl TextForm {
    /// Formal parameters in their order; those of CONCAT go on.
    pub(in crate::check) fn parameters(self) -> &'static [&'static str] {
        match self {
            Self::Length => &["IN"],
            Self::Edit(Edit::Left | Edit::Right) => &["IN", "L"],
            Self::Edit(Edit::Middle | Edit::Delete) => &["IN", "L", "P"],
            Self::Edit(Edit::Insert) => &["IN1", "IN2", "P"],
            Self::Edit(Edit::Replace) => &["IN1", "IN2", "L", "P"],
            Self::Find | Self::Edit(Edit::Concat | Edit::Fit) => &["IN1", "IN2"],
        }
    }
}
