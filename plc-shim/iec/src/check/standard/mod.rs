//! The standard functions and those of vendors that come with the language: their names, and what each name says.
//!
//! | module | subject |
//! |---|---|
//! | [`form`] | functions on values, their parameters, their typed forms |
//! | [`timed`], [`text`] | those on times, those on strings |
//! | [`conversion`], [`text_conversion`] | conversions, by what their names say |
//! | [`memory`], [`place`], [`query`] | functions on addresses, places and instances |
//! | [`vendor`] | functions of vendors' controllers that have no equal here |

pub(super) mod conversion;
pub(super) mod form;
pub(super) mod memory;
pub(super) mod place;
pub(super) mod query;
pub(super) mod text;
pub(super) mod text_conversion;
pub(super) mod timed;
pub(super) mod vendor;

/// True if there is a function of this name, in capitals.
pub fn exists(key: &str) -> bool {
    form::find(key).is_some() || conversion::find(key).is_some() || text_conversion::find(key).is_some()
}

/// True if no unit or type may have the name.
pub(in crate::check) fn is_reserved(key: &str) -> bool {
    let conversion = || conversion::find(key).is_some() || text_conversion::find(key).is_some();
    form::is_reserved(key) || !conversion::is_of_vendors(key) && conversion()
}

/// True for every function that is not a unit: those of the standard, those on memory, places and instances, and what of
/// a vendor's runtime is known by its name.
pub fn is_known(key: &str) -> bool {
    exists(key)
        || memory::exists(key)
        || place::PlaceFunction::find(key).is_some()
        || query::Query::find(key).is_some()
        || matches!(key, "TIME" | "LTIME")
        || vendor::VENDOR_FUNCTIONS.iter().any(|(begin, ..)| key.starts_with(begin))
}
