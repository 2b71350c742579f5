//! What is generated, held against the files of `web/`: they are the newest where a test passes. `UPDATE_DOCS=1` writes them
//! first.

use std::path::Path;
use std::{env, fs};

/// Compares a file, named from `web/`, with what is generated.
///
/// # Panics
/// They differ, or the file cannot be read or written.
pub fn is_published(file: &str, made: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file);
    if env::var_os("UPDATE_DOCS").is_some() {
        fs::write(&path, made).expect("the file can be written");
    }
    let published = fs::read_to_string(&path).unwrap_or_else(|error| panic!("web/{file}: {error}"));
    assert!(published == made, "run with UPDATE_DOCS=1 and read the difference in web/{file}");
}

/// Compares the part of a document, named from `web/`, between `<!-- generated: NAME -->` and `<!-- end -->` with what is
/// generated.
///
/// # Panics
/// They differ, the document has no such part, or it cannot be read or written.
pub fn is_published_in(file: &str, name: &str, made: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file);
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("web/{file}: {error}"));
    let begin = format!("<!-- generated: {name} -->\n\n");
    let (before, rest) = text.split_once(&begin).unwrap_or_else(|| panic!("web/{file} lacks {begin}"));
    let (_, after) = rest.split_once("\n<!-- end -->").unwrap_or_else(|| panic!("{name} has no end in web/{file}"));
    is_published(file, &format!("{before}{begin}{made}\n<!-- end -->{after}"));
}
