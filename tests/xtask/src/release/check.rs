//! What must hold before a release, read from the repository.

use std::path::{Path, PathBuf};
use std::process::Command;

use toml::{Table, Value};

use super::output;
use crate::error::TaskError;
use crate::workspace::{Member, files, members, read, toml};

/// A statement about the repository, and where it does not hold.
#[derive(Debug)]
pub(super) struct Check {
    pub(super) about: &'static str,
    pub(super) problems: Vec<String>,
}

/// The version that the workspace names, and what was checked for it.
#[derive(Debug)]
pub(super) struct Checked {
    pub(super) version: String,
    pub(super) checks: Vec<Check>,
}

/// # Errors
/// A file cannot be read, the workspace names no version, or git does not run.
pub(super) fn checked(root: &Path) -> Result<Checked, TaskError> {
    let git = |words: &[&str]| output(Command::new("git").arg("-C").arg(root).args(words));
    let manifest = root.join("Cargo.toml");
    let workspace = toml(&manifest)?;
    let version = text(&workspace, &["workspace", "package", "version"])
        .ok_or_else(|| TaskError::wrong(&manifest, "it does not name `workspace.package.version`"))?
        .to_owned();
    let uncommitted = git(&["status", "--porcelain"])?.lines().map(str::to_owned).collect();
    let tag = git(&["tag", "--list", &format!("v{version}")])?;
    let checks = vec![
        Check { about: "the working tree is clean", problems: uncommitted },
        Check { about: "all manifests have the same version", problems: other_versions(root, &workspace, &version)? },
        Check {
            about: "the changelog has a heading for the version",
            problems: without_heading(&read(&root.join("CHANGELOG.md"))?, &version),
        },
        Check {
            about: "the version has no tag yet",
            problems: tag.lines().map(|tag| format!("{tag} exists: raise the version")).collect(),
        },
    ];
    Ok(Checked { version, checks })
}

fn text<'t>(table: &'t Table, path: &[&str]) -> Option<&'t str> {
    let (first, rest) = path.split_first()?;
    rest.iter().try_fold(table.get(*first)?, |value, key| value.get(key))?.as_str()
}

/// The manifests that name another version, or none.
fn other_versions(root: &Path, workspace: &Table, version: &str) -> Result<Vec<String>, TaskError> {
    let mut named: Vec<(PathBuf, Option<String>)> = Vec::new();
    let members = members(root)?;
    for member in &members {
        let path = member.folder.join("Cargo.toml");
        let manifest = toml(&root.join(&path))?;
        named.push((path, member_version(&manifest, version)));
    }
    named.extend(of_dependencies(workspace, &members));
    for path in files(root, "toml")?.into_iter().filter(|path| path.ends_with("pyproject.toml")) {
        let found = text(&toml(&path)?, &["project", "version"]).map(str::to_owned);
        named.push((path.strip_prefix(root).unwrap_or(&path).to_owned(), found));
    }
    for path in files(root, "json")?.into_iter().filter(|path| path.ends_with("package.json")) {
        let manifest: serde_json::Value =
            serde_json::from_str(&read(&path)?).map_err(|error| TaskError::wrong(&path, error.to_string()))?;
        let found = manifest.get("version").and_then(serde_json::Value::as_str).map(str::to_owned);
        named.push((path.strip_prefix(root).unwrap_or(&path).to_owned(), found));
    }
    let other = named.into_iter().filter(|(_, found)| found.as_deref() != Some(version));
    Ok(other
        .map(|(path, found)| match found {
            Some(found) => format!("{}: {found} instead of {version}", path.display()),
            None => format!("{}: no version", path.display()),
        })
        .collect())
}

/// Its own version, or the workspace's if it takes that.
fn member_version(manifest: &Table, workspace: &str) -> Option<String> {
    let package = manifest.get("package")?;
    match package.get("version")? {
        Value::String(own) => Some(own.clone()),
        inherited => inherited.get("workspace")?.as_bool()?.then(|| workspace.to_owned()),
    }
}

/// The versions with which the workspace's crates depend on each other.
fn of_dependencies(workspace: &Table, members: &[Member]) -> Vec<(PathBuf, Option<String>)> {
    let listed = workspace.get("workspace").and_then(|table| table.get("dependencies")).and_then(Value::as_table);
    let own = listed.into_iter().flatten().filter(|(name, _)| members.iter().any(|member| member.name == **name));
    own.map(|(name, value)| {
        let found = value.get("version").and_then(Value::as_str).map(str::to_owned);
        (Path::new("Cargo.toml").join(name), found)
    })
    .collect()
}

/// `## 0.2.0` or `## 0.2.0 - 2026-01-31`, before anything that is not released.
fn without_heading(changelog: &str, version: &str) -> Vec<String> {
    let headings = changelog.lines().filter_map(|line| line.strip_prefix("## "));
    match headings.map(str::trim).find(|heading| !heading.is_empty()) {
        Some(first) if first.split_whitespace().next() == Some(version) => Vec::new(),
        Some(first) => vec![format!("CHANGELOG.md: the first heading is `{first}`, not `{version}`")],
        None => vec!["CHANGELOG.md: no heading".to_owned()],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_changelog_begins_with_the_version() {
        assert!(without_heading("# Changelog\n\n## 0.2.0 - 2026-01-31\n\n## 0.1.0\n", "0.2.0").is_empty());
        assert_eq!(without_heading("# Changelog\n\n## Unreleased\n\n## 0.2.0\n", "0.2.0").len(), 1);
        assert_eq!(without_heading("# Changelog\n\n## 0.2.0-rc.1\n", "0.2.0").len(), 1);
        assert_eq!(without_heading("", "0.2.0").len(), 1);
    }

    #[test]
    fn every_manifest_with_another_version_is_named() {
        let root = tempfile::tempdir().unwrap();
        let write = |path: &str, text: &str| {
            let path = root.path().join(path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        let workspace = "[workspace]\nmembers = [\"a\", \"b\", \"c\"]\n[workspace.package]\nversion = \"0.2.0\"\n\
                         [workspace.dependencies]\none = { path = \"a\", version = \"0.1.0\" }\nserde = \"1\"\n";
        write("Cargo.toml", workspace);
        write("a/Cargo.toml", "[package]\nname = \"one\"\nversion.workspace = true\n");
        write("b/Cargo.toml", "[package]\nname = \"two\"\nversion = \"0.2.1\"\n");
        write("c/Cargo.toml", "[package]\nname = \"three\"\n");
        write("py/pyproject.toml", "[project]\nversion = \"0.2.0\"\n");
        write("web/package.json", "{\"version\": \"0.1.0\"}");
        let found = other_versions(root.path(), &workspace.parse().unwrap(), "0.2.0").unwrap();
        let wanted = [
            "b/Cargo.toml: 0.2.1 instead of 0.2.0",
            "c/Cargo.toml: no version",
            "Cargo.toml/one: 0.1.0 instead of 0.2.0",
            "web/package.json: 0.1.0 instead of 0.2.0",
        ];
        assert_eq!(found.iter().map(|line| line.replace('\\', "/")).collect::<Vec<_>>(), wanted);
    }
}
