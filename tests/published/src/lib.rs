//! Documents that are generated from the code, and checked by its tests.

/// Holds the document at `path`, from the root of the repository, against what is made of the code now; writes it first
/// where `UPDATE_DOCS` is set.
///
/// # Panics
/// The document differs, or cannot be read.
pub fn is_published(path: &str, made: &str) {
    let path = format!("{}/../../{path}", env!("CARGO_MANIFEST_DIR"));
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(&path, made).expect("written");
    }
    let published = std::fs::read_to_string(&path).expect("published");
    assert!(published == made, "run with UPDATE_DOCS=1 and read the difference in {path}");
}
