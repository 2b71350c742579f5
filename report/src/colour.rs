//! Words in colour, where a person reads them on a terminal.

use std::ffi::OsStr;
use std::fmt;
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};

/// Nobody sees colours unless the program says that somebody does.
static IS_SHOWN: AtomicBool = AtomicBool::new(false);

/// What a word means, beside what it says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colour {
    /// As it should be.
    Good,
    /// Somebody must look at it, now or later.
    Notable,
    /// As it should not be.
    Bad,
}

/// A word in its colour; padding is part of it.
#[derive(Clone, Copy, Debug)]
pub struct Coloured<'t> {
    text: &'t str,
    colour: Colour,
}

/// Shows colours from now on, or none: a program says so once, as it begins, of its standard output.
pub fn show(is_shown: bool) {
    IS_SHOWN.store(is_shown, Ordering::Relaxed);
}

/// True if `stream` is a terminal that shows colours, and nobody asked for none (<https://no-color.org>).
pub fn suits(stream: &impl IsTerminal) -> bool {
    is_wanted(stream.is_terminal(), std::env::var_os("NO_COLOR").as_deref(), std::env::var_os("TERM").as_deref())
}

/// An empty `NO_COLOR` asks for nothing; a dumb terminal shows what makes a colour as letters.
fn is_wanted(is_terminal: bool, no_color: Option<&OsStr>, terminal: Option<&OsStr>) -> bool {
    is_terminal && no_color.is_none_or(OsStr::is_empty) && terminal.is_none_or(|terminal| terminal != "dumb")
}

impl Colour {
    /// `text` in this colour.
    pub fn of(self, text: &str) -> Coloured<'_> {
        Coloured { text, colour: self }
    }

    /// As ECMA-48 has it.
    fn code(self) -> u8 {
        match self {
            Self::Good => 32,
            Self::Notable => 33,
            Self::Bad => 31,
        }
    }
}

impl fmt::Display for Coloured<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !IS_SHOWN.load(Ordering::Relaxed) {
            return f.pad(self.text);
        }
        write!(f, "\x1b[{}m", self.colour.code())?;
        f.pad(self.text)?;
        f.write_str("\x1b[0m")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_terminal_shows_colours_unless_it_cannot_or_must_not() {
        let wanted = |no_color: Option<&str>, terminal: Option<&str>| {
            is_wanted(true, no_color.map(OsStr::new), terminal.map(OsStr::new))
        };
        assert!(wanted(None, Some("xterm-256color")) && wanted(None, None));
        assert!(wanted(Some(""), Some("xterm")), "it is set and empty");
        assert!(!wanted(Some("1"), Some("xterm")) && !wanted(Some("0"), None));
        assert!(!wanted(None, Some("dumb")));
        assert!(!is_wanted(false, None, Some(OsStr::new("xterm"))), "nobody sees it");
    }

    #[test]
    fn a_word_is_coloured_where_somebody_sees_it() {
        let word = || format!("{:<8}|", Colour::Bad.of("FAILED"));
        assert_eq!(word(), "FAILED  |");
        show(true);
        let coloured = word();
        show(false);
        assert_eq!(coloured, "\x1b[31mFAILED  \x1b[0m|");
    }
}
