//! A small mistake in the program of a soft PLC, to find out whether anything would notice it.

use onescan_iec_project::mutate::Mutant;
use onescan_server::signal::ClientName;

/// A mistake, and the source in which it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistake {
    pub client: ClientName,
    /// Its source, as the scenario names it.
    pub source: String,
    /// What is changed in it.
    pub mutant: Mutant,
}
