//! The variables that a gateway reaches at addresses: what carries each, and how programs take it from there.

use onescan_base::{ElementaryType, SignalType};

use super::address::{Address, Width};
use super::exchanged::{Exchanged, Way};

/// A signal or a word, and where the PLC keeps it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Located {
    /// The signal, or the word.
    pub name: String,
    /// The path of its variable in the project.
    pub variable: String,
    /// The variable of the file that has the address.
    pub carrier: String,
    pub address: Address,
    /// Which way it goes.
    pub way: Way,
}

/// The words of the handshake, each with its width and its way.
pub(super) const WORDS: [(&str, Width, Way); 8] = [
    ("SDSP_Session", Width::Double, Way::ToPlc),
    ("SDSP_Limit", Width::Double, Way::ToPlc),
    ("SDSP_Grant", Width::Double, Way::ToPlc),
    ("SDSP_TV", Width::Long, Way::ToPlc),
    ("SDSP_Joined", Width::Double, Way::FromPlc),
    ("SDSP_Done", Width::Double, Way::FromPlc),
    ("SDSP_Answer", Width::Word, Way::FromPlc),
    ("SDSP_Layout", Width::Double, Way::FromPlc),
];

/// What holds a signal's value at an address: values of one byte take a word, which is what Modbus has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Carrier {
    own: ElementaryType,
    at_address: ElementaryType,
    pub(super) width: Width,
}

impl Carrier {
    /// Nothing for a type that no register holds.
    pub(super) fn of(ty: SignalType) -> Option<Self> {
        use ElementaryType::{
            Bool, Byte, Dint, Dword, Int, Lint, Lreal, Lword, Real, Sint, Udint, Uint, Ulint, Usint, Word,
        };
        let SignalType::Elementary(own) = ty else { return None };
        let (at_address, width) = match own {
            Bool => (own, Width::Bit),
            Sint => (Int, Width::Word),
            Usint => (Uint, Width::Word),
            Byte => (Word, Width::Word),
            Int | Uint | Word => (own, Width::Word),
            Dint | Udint | Dword | Real => (own, Width::Double),
            Lint | Ulint | Lword | Lreal => (own, Width::Long),
            _ => return None,
        };
        Some(Self { own, at_address, width })
    }

    /// The type of the variable at the address.
    pub(super) fn type_name(self) -> &'static str {
        self.at_address.name()
    }

    /// True if the variable itself can lie at the address.
    pub(super) fn is_own(self) -> bool {
        self.own == self.at_address
    }

    /// The statement that takes a value over.
    pub(super) fn copy(self, variable: &str, carrier: &str, way: Way) -> String {
        let (own, there) = (self.own.name(), self.at_address.name());
        match way {
            _ if self.is_own() && way == Way::ToPlc => format!("{variable} := {carrier};"),
            _ if self.is_own() => format!("{carrier} := {variable};"),
            Way::ToPlc => format!("{variable} := {there}_TO_{own}({carrier});"),
            Way::FromPlc => format!("{carrier} := {own}_TO_{there}({variable});"),
        }
    }
}

/// Where a scenario wants an exchanged variable; an error text if that is not a place for it.
pub(super) fn wanted(exchanged: &Exchanged, carrier: Carrier) -> Result<Option<Address>, String> {
    let Some(text) = &exchanged.address else { return Ok(None) };
    let name = &exchanged.signal;
    let found = Address::parse(text).or_else(|| Address::at_modbus(text));
    let address = found.ok_or_else(|| format!("`{name}` is to lie at `{text}`, which is not an address"))?;
    if address.width() != carrier.width {
        return Err(format!("`{name}` is {}, and {address} does not hold that", exchanged.ty));
    }
    if exchanged.way == Way::ToPlc && !address.is_writable() {
        return Err(format!("`{name}` is written by the gateway, and {address} cannot be written over Modbus"));
    }
    Ok(Some(address))
}
