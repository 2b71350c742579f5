//! The scenarios of the repository that take in another one: what they come to, as a digest of the whole.

use std::path::{Path, PathBuf};

use onescan_scenario::Scenario;

/// All scenarios in `folder` that have a base, by their paths.
fn variants(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            variants(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "toml")
            && std::fs::read_to_string(&path).expect("a text").lines().any(|line| line.starts_with("base = "))
        {
            found.push(path);
        }
    }
}

/// What each of them is with its bases does not change unless somebody wants it to: a change of `scenario.toml` is one of its
/// variants, too. Files without a base that say the same have the same digests.
#[test]
fn every_variant_is_what_it_was() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    variants(folder, &mut found);
    found.sort();
    let reported = found.iter().map(|path| {
        let scenario = Scenario::load(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert!(scenario.bases().count() > 0, "{}", path.display());
        let whole = scenario.to_json().expect("it was read").to_string();
        let name = path.strip_prefix(folder).expect("below it").iter().map(|part| part.to_string_lossy());
        format!("{} {}\n", blake3::hash(whole.as_bytes()).to_hex(), name.collect::<Vec<_>>().join("/"))
    });
    insta::assert_snapshot!(reported.collect::<String>());
}

/// Each of them, written out as one file, is the same scenario.
#[test]
fn every_variant_can_be_written_out() {
    let mut found = Vec::new();
    variants(Path::new(env!("CARGO_MANIFEST_DIR")), &mut found);
    for path in found {
        let scenario = Scenario::load(&path).expect("a scenario");
        let folder = tempfile::tempdir().expect("a folder");
        // Pictures lie beside the file that names them.
        for entry in std::fs::read_dir(path.parent().expect("in a folder")).expect("readable") {
            let picture = entry.expect("readable").path();
            if picture.extension().is_some_and(|extension| extension == "svg") {
                std::fs::copy(&picture, folder.path().join(picture.file_name().expect("a name"))).expect("copied");
            }
        }
        let file = folder.path().join("whole.toml");
        std::fs::write(&file, scenario.to_toml().expect("it was read")).expect("written");
        let whole = Scenario::load(&file).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert_eq!(
            whole.to_json().expect("it was read"),
            scenario.to_json().expect("it was read"),
            "{}",
            path.display()
        );
        assert_eq!(format!("{:?}", whole.plan()), format!("{:?}", scenario.plan()));
    }
}
