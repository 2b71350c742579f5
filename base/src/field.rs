//! Members of structures and fields of blocks as files have them: `Name: TYPE`.

/// The name of a field that is only room in a block, and no signal.
pub const ROOM: &str = "_";

/// How deep structures may lie in structures.
pub const DEPTH_MAX: u32 = 8;

/// A member of a structure, or a field of a block. Its type is elementary or the name of a structure.
///
/// ```
/// use onescan_base::field::Field;
///
/// assert_eq!(Field::parse("Speed: REAL"), Some(Field { name: "Speed", ty: "REAL" }));
/// assert_eq!(Field::parse("Speed"), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field<'t> {
    pub name: &'t str,
    pub ty: &'t str,
}

impl<'t> Field<'t> {
    /// What is written `Name: TYPE`.
    #[must_use]
    pub fn parse(text: &'t str) -> Option<Self> {
        let (name, ty) = text.split_once(':')?;
        Some(Self { name: name.trim(), ty: ty.trim() })
    }
}

/// True if the last part of a path is [`ROOM`].
#[must_use]
pub fn is_room(path: &str) -> bool {
    path.rsplit('.').next() == Some(ROOM)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_type_may_have_colons_and_spaces_do_not_count() {
        assert_eq!(Field::parse(" a.b :  T : U "), Some(Field { name: "a.b", ty: "T : U" }));
        assert_eq!(Field::parse(":"), Some(Field { name: "", ty: "" }));
    }

    #[test]
    fn room_is_a_name_of_its_own() {
        assert!(is_room("_") && is_room("Axis._"));
        assert!(!is_room("a_") && !is_room("_.a"));
    }
}
