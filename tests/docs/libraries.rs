//! The page of libraries lists what the workspace depends on, and nothing else.

use std::collections::BTreeSet;

use crate::repository;

#[test]
fn every_library_has_its_line() {
    let read = |path: &str| std::fs::read_to_string(repository().join(path)).expect("a readable file");
    let manifest: toml::Table = read("Cargo.toml").parse().expect("TOML");
    let dependencies = manifest["workspace"]["dependencies"].as_table().expect("dependencies of the workspace");
    // The workspace's own crates have a path.
    let used: BTreeSet<&str> =
        dependencies.iter().filter(|(_, value)| value.get("path").is_none()).map(|(name, _)| name.as_str()).collect();
    let page = read("docs/libraries.md");
    let rows = page.lines().filter_map(|line| line.strip_prefix("| `")?.split('`').next());
    let listed: BTreeSet<&str> = rows.collect();
    let missing: Vec<_> = used.difference(&listed).collect();
    let left: Vec<_> = listed.difference(&used).collect();
    assert!(missing.is_empty(), "docs/libraries.md does not list {missing:?}");
    assert!(left.is_empty(), "docs/libraries.md lists {left:?}, which the workspace does not depend on");
}
