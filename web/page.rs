//! The page of onescan: the files that `npm run build` made, or none where nobody built them.

/// A file of the page: its name, its media type, what it is.
pub type File = (&'static str, &'static str, &'static [u8]);

include!(concat!(env!("OUT_DIR"), "/page.rs"));

/// All files of the page, by name; empty in a program that was built without it.
pub const fn files() -> &'static [File] {
    PAGE
}
