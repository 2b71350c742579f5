//! The motion control of `iec/motion` behind TwinCAT's names: what `iec/vendor/tc2_mc2_*.st` stand on.
//!
//! Its axis and its blocks get names of our own, so that those of TwinCAT's library are free for what TwinCAT's programs
//! expect of them. Its buffer modes and directions become those of TwinCAT, and so need no conversion; their values are
//! written with their types, because projects have values of the same names.

use std::sync::OnceLock;

use super::motion_library::MOTION;
use crate::syntax::token::TokenKind;
use crate::syntax::tokenize;

/// TwinCAT declares these itself.
const LEFT_OUT: &str = "iec/motion/enumerations.st";

const RENAMED: [(&str, &str); 13] = [
    ("AXIS_REF", "ONESCAN_AXIS"),
    ("MC_BUFFER_MODE", "MC_BufferMode"),
    ("MC_DIRECTION", "MC_Direction"),
    ("mcAborting", "MC_BufferMode#MC_Aborting"),
    ("mcBuffered", "MC_BufferMode#MC_Buffered"),
    ("mcBlendingLow", "MC_BufferMode#MC_BlendingLow"),
    ("mcBlendingPrevious", "MC_BufferMode#MC_BlendingPrevious"),
    ("mcBlendingNext", "MC_BufferMode#MC_BlendingNext"),
    ("mcBlendingHigh", "MC_BufferMode#MC_BlendingHigh"),
    ("mcPositiveDirection", "MC_Direction#MC_Positive_Direction"),
    ("mcShortestWay", "MC_Direction#MC_Shortest_Way"),
    ("mcNegativeDirection", "MC_Direction#MC_Negative_Direction"),
    ("mcCurrentDirection", "MC_Direction#MC_Current_Direction"),
];

/// The files of motion control with those names.
pub(super) fn core() -> &'static [(&'static str, &'static str)] {
    static CORE: OnceLock<Vec<(&str, &str)>> = OnceLock::new();
    CORE.get_or_init(|| {
        let files = MOTION.iter().filter(|(name, _)| *name != LEFT_OUT);
        // Made once for the whole process, like the texts that it is made of.
        files.map(|(name, text)| (*name, &*renamed(text).leak())).collect()
    })
}

/// In the library's own namespace, where a project's names do not get in the way.
fn renamed(text: &str) -> String {
    let mut renamed = "NAMESPACE OPEN Tc2_MC2\n".to_owned();
    for token in tokenize(text) {
        let word = text.get(token.start as usize..token.end as usize).unwrap_or_default();
        match RENAMED.iter().find(|(name, _)| token.kind == TokenKind::Identifier && *name == word) {
            Some((_, new)) => renamed.push_str(new),
            None if token.kind == TokenKind::Identifier && word.starts_with("MC_") => {
                renamed.push_str("ONESCAN_");
                renamed.push_str(word);
            }
            None => renamed.push_str(word),
        }
    }
    renamed.push_str("\nEND_NAMESPACE\n");
    renamed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_of_it_has_a_name_of_twincats_blocks() {
        let text: String = core().iter().map(|(_, text)| *text).collect();
        assert!(text.contains("FUNCTION_BLOCK ONESCAN_MC_Power") && text.contains("ONESCAN_AXIS : STRUCT"));
        assert!(!text.contains("FUNCTION_BLOCK MC_") && !text.contains("= mcAborting"));
        assert!(text.contains("Command.BufferMode = MC_BufferMode#MC_Aborting"));
    }
}
