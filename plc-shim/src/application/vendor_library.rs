//! What vendors' libraries declare and programs take for granted, as program text. A file of it is there for
//! the programs that name something of it; a user's own declaration of a name goes before.

/// A file, its text, and the names that ask for it.
struct Part {
    file: (&'static str, &'static str),
    names: &'static [&'static str],
    /// It stands on PLCopen's motion control, and is there only with that.
    is_motion: bool,
}

const PARTS: [Part; 4] = [
    Part {
        file: ("iec/vendor/generic_inputs.st", include_str!("../../iec/vendor/generic_inputs.st")),
        names: &["ANY", "ANY_BIT", "ANY_DATE", "ANY_NUM", "ANY_REAL", "ANY_INT", "ANY_STRING", "__SYSTEM"],
        is_motion: false,
    },
    Part {
        file: ("iec/vendor/dtl.st", include_str!("../../iec/vendor/dtl.st")),
        names: &["DTL", "LDT_TO_DTL", "DT_TO_DTL", "DATE_TO_DTL"],
        is_motion: false,
    },
    Part {
        file: ("iec/vendor/tc2_system.st", include_str!("../../iec/vendor/tc2_system.st")),
        names: &[
            "T_MaxString",
            "T_AmsNetId",
            "T_AmsNetIdArr",
            "T_AmsPort",
            "T_IPv4Addr",
            "T_IPv4AddrArr",
            "HRESULT",
            "OTCID",
            "GUID",
            "ST_LibVersion",
            "T_FILETIME",
            "TIMESTRUCT",
        ],
        is_motion: false,
    },
    Part {
        file: ("iec/vendor/tc2_mc2.st", include_str!("../../iec/vendor/tc2_mc2.st")),
        names: &[
            "MC_BufferMode",
            "MC_Aborting",
            "MC_Buffered",
            "MC_BlendingLow",
            "MC_BlendingPrevious",
            "MC_BlendingNext",
            "MC_BlendingHigh",
            "MC_Positive_Direction",
            "MC_Shortest_Way",
            "MC_Negative_Direction",
            "MC_Current_Direction",
        ],
        is_motion: true,
    },
];

/// The files that programs of these texts ask for; `has_motion` if motion control is there for them.
pub(super) fn for_texts<T: AsRef<str>>(
    texts: &[T],
    has_motion: bool,
) -> impl Iterator<Item = (&'static str, &'static str)> {
    let suits = move |part: &&Part| has_motion || !part.is_motion;
    let wanted = |part: &&Part| texts.iter().any(|text| mentions(text.as_ref(), part.names));
    PARTS.iter().filter(suits).filter(wanted).map(|part| part.file)
}

/// True if one of the names stands in the text by itself, in any case.
fn mentions(text: &str, names: &[&str]) -> bool {
    let word = |character: char| character.is_ascii_alphanumeric() || character == '_';
    text.split(|character| !word(character)).any(|found| names.iter().any(|name| name.eq_ignore_ascii_case(found)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files(text: &str) -> Vec<&'static str> {
        for_texts(&[text], false).map(|(name, _)| name).collect()
    }

    #[test]
    fn a_part_is_there_for_who_names_it() {
        assert_eq!(files("VAR many, ANY_TO, xDTL : INT; END_VAR"), [""; 0]);
        assert_eq!(files("VAR_INPUT v : any_num; END_VAR"), ["iec/vendor/generic_inputs.st"]);
        assert_eq!(files("VAR a : T_MAXSTRING; d : DTL; END_VAR").len(), 2);
    }

    #[test]
    fn tc2_mc2_comes_with_motion_control() {
        let count = |has_motion| for_texts(&["VAR mode : mc_buffermode; END_VAR"], has_motion).count();
        assert_eq!((count(false), count(true)), (0, 1));
    }

    #[test]
    fn each_file_says_what_it_follows() {
        for part in PARTS {
            assert!(part.file.1.starts_with("(* "), "{}", part.file.0);
        }
    }
}
