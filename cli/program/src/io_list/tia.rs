//! What all forms of a tag table of TIA Portal share.

use super::collect::{Collected, Entry};
use super::error::ListError;
use super::flatten::Nothing;
use super::point::Direction;

/// A tag as a table has it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tag<'a> {
    pub name: &'a str,
    /// Its type in Siemens' spelling.
    pub ty: &'a str,
    /// Its address, as in `%IW64`; with or without `%`, in English or German mnemonics.
    pub address: &'a str,
    /// What is said about it.
    pub comment: &'a str,
    /// Its row or line.
    pub line: Option<u32>,
}

impl Tag<'_> {
    /// Takes it into a list; tags of other areas than inputs and outputs are left out.
    pub(super) fn into_list(self, collected: &mut Collected) -> Result<(), ListError> {
        let Self { name, ty, address, comment, line } = self;
        let Some((direction, address)) = place(address) else {
            let why = match address.trim() {
                "" => "it has no address".to_owned(),
                address => format!("{address} is neither an input nor an output"),
            };
            collected.leave_out(name, why, line);
            return Ok(());
        };
        if address.ends_with(":P") {
            collected.leave_out(name, "it is a direct access to the periphery", line);
            return Ok(());
        }
        if let Some(bit) = no_such_bit(&address) {
            collected.leave_out(name, format!("{address} has no bit {bit}: a byte has bits 0 to 7"), line);
            return Ok(());
        }
        let (ty, address, comment) = (name_of(ty), Some(address.as_str()), Some(comment));
        collected.take(&Entry { name, ty, direction, address, comment, line }, &Nothing)
    }
}

/// The area of an address and its international spelling.
fn place(address: &str) -> Option<(Direction, String)> {
    let bare: String = address.trim().trim_start_matches('%').split_whitespace().collect();
    let bare = bare.to_ascii_uppercase();
    let mut letters = bare.chars();
    let direction = match letters.next()? {
        'I' | 'E' => Direction::Input,
        'Q' | 'A' => Direction::Output,
        _ => return None,
    };
    let rest = letters.as_str();
    let number = rest.trim_start_matches(['X', 'B', 'W', 'D', 'L']);
    let is_number = number.starts_with(|c: char| c.is_ascii_digit());
    let area = if direction == Direction::Input { 'I' } else { 'Q' };
    is_number.then(|| (direction, format!("%{area}{rest}")))
}

/// The bit of an address, if no byte has it.
fn no_such_bit(address: &str) -> Option<&str> {
    let (_, bit) = address.split_once('.')?;
    (!matches!(bit, "0" | "1" | "2" | "3" | "4" | "5" | "6" | "7")).then_some(bit)
}

/// The standard's name of a type of Siemens'.
fn name_of(ty: &str) -> &str {
    match ty.trim().to_ascii_uppercase().as_str() {
        "TIME_OF_DAY" | "TOD" => "TOD",
        "LTIME_OF_DAY" | "LTOD" => "LTOD",
        "DATE_AND_TIME" => "DT",
        _ => ty.trim(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_byte_has_eight_bits() {
        assert_eq!([no_such_bit("%I0.7"), no_such_bit("%IW64")], [None, None]);
        assert_eq!([no_such_bit("%I0.8"), no_such_bit("%Q1.x")], [Some("8"), Some("x")]);
    }

    #[test]
    fn addresses_are_inputs_or_outputs() {
        for (address, expected) in [
            ("%I0.0", Some((Direction::Input, "%I0.0"))),
            ("%IW64", Some((Direction::Input, "%IW64"))),
            ("E      1.7", Some((Direction::Input, "%I1.7"))),
            ("AW 4", Some((Direction::Output, "%QW4"))),
            ("%QD100", Some((Direction::Output, "%QD100"))),
            ("%M0.0", None),
            ("%DB1.DBX0.0", None),
            ("T 5", None),
            ("Axis", None),
            ("I", None),
            ("", None),
        ] {
            let found = place(address);
            let found = found.as_ref().map(|(direction, address)| (*direction, address.as_str()));
            assert_eq!(found, expected, "{address}");
        }
    }
}
