//! Every relative link leads to a file of the repository and to a heading in it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

use crate::markdown::{anchors, links};
use crate::{markdown_files, repository};

/// The path with `..` and `.` resolved by name, so that one that climbs out of the repository shows.
fn normal(path: &Path) -> PathBuf {
    let mut normal = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                normal.pop();
            }
            part => normal.push(part),
        }
    }
    normal
}

/// What is wrong with a link of `file`, if anything.
fn wrong(file: &Path, target: &str, anchors_of: &BTreeMap<PathBuf, BTreeSet<String>>) -> Option<String> {
    let (path, anchor) = target.split_once('#').map_or((target, None), |(path, anchor)| (path, Some(anchor)));
    let folder = file.parent()?;
    let path = if path.is_empty() { file.to_owned() } else { normal(&folder.join(path)) };
    if !path.starts_with(repository()) {
        return Some("leads out of the repository".to_owned());
    }
    if !path.exists() {
        return Some("no such file".to_owned());
    }
    let anchor = anchor?;
    match anchors_of.get(&path) {
        None => Some("an anchor in a file that is not Markdown".to_owned()),
        Some(known) if known.contains(anchor) => None,
        Some(known) => Some(format!("no such heading; there are {known:?}")),
    }
}

#[test]
fn every_relative_link_leads_somewhere() {
    let root = repository();
    let texts: BTreeMap<PathBuf, String> = markdown_files(&root)
        .into_iter()
        .map(|file| {
            let text = std::fs::read_to_string(&file).expect("a readable file");
            (file, text)
        })
        .collect();
    assert!(texts.len() > 100, "only {} files: this is not the repository", texts.len());
    let anchors_of: BTreeMap<PathBuf, BTreeSet<String>> =
        texts.iter().map(|(file, text)| (file.clone(), anchors(text))).collect();
    let mut broken = Vec::new();
    for (file, text) in &texts {
        let relative = links(text).into_iter().filter(|link| !link.target.contains(':'));
        for link in relative {
            if let Some(reason) = wrong(file, &link.target, &anchors_of) {
                let file = file.strip_prefix(&root).unwrap_or(file).display().to_string();
                broken.push(format!("{file}:{}: {}: {reason}", link.line, link.target));
            }
        }
    }
    assert!(broken.is_empty(), "broken links:\n{}", broken.join("\n"));
}

/// A document that no index names is found by nobody.
#[test]
fn the_index_lists_every_document() {
    let docs = repository().join("docs");
    let index = std::fs::read_to_string(docs.join("README.md")).expect("docs/README.md");
    let linked: BTreeSet<PathBuf> =
        links(&index).into_iter().filter_map(|link| Some(normal(&docs.join(link.target.split('#').next()?)))).collect();
    let missing: Vec<_> = markdown_files(&docs)
        .into_iter()
        .filter(|file| file.parent() == Some(&docs) && !file.ends_with("README.md") && !linked.contains(file))
        .collect();
    assert!(missing.is_empty(), "docs/README.md does not list {missing:?}");
}
