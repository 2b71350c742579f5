//! The documents that the program has in it: the page of each code, by its code.
//!
//! They are a crate, because a crate is packed with the files of its own folder only.

include!(concat!(env!("OUT_DIR"), "/codes.rs"));

/// The page of a code, as Markdown, where there is one.
pub const fn page(code: &str) -> Option<&'static str> {
    let mut at = 0;
    while at < CODES.len() {
        if is_equal(CODES[at].0.as_bytes(), code.as_bytes()) {
            return Some(CODES[at].1);
        }
        at += 1;
    }
    None
}

/// `==` is not for constants.
const fn is_equal(one: &[u8], other: &[u8]) -> bool {
    if one.len() != other.len() {
        return false;
    }
    let mut at = 0;
    while at < one.len() {
        if one[at] != other[at] {
            return false;
        }
        at += 1;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_found_by_its_code_alone() {
        assert!(page("N0101").is_some_and(|text| text.contains("N0101")));
        assert_eq!((page("N010"), page("N0101x"), page("")), (None, None, None));
    }
}
