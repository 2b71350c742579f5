//! What all tests executed together.

use onescan_iec_run::Coverage;

use super::plan::{Unit, shown};
use super::ran::Worked;

/// The coverage of all units. Files are named as they are found from where the tests were started.
pub fn merged(units: &[Unit], worked: &[Worked]) -> Coverage {
    let mut all = Coverage::default();
    for (unit, worked) in units.iter().zip(worked) {
        let folder = if let Unit::Case(unit) = unit { shown(unit.place.folder()) } else { String::new() };
        worked.coverage.iter().for_each(|row| all.add(&row.row(&folder)));
    }
    all
}
