//! `docs/rooms.md`: the tables of modules at the head of crates and of folders of modules, on one page.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use onescan_published::is_published;

use crate::{PASSED_OVER, repository};

/// Files whose docs open a crate or a folder of modules.
const HEADS: [&str; 3] = ["lib.rs", "main.rs", "mod.rs"];

/// First cells of a table of modules; other tables describe a state machine or a file.
const TABLES: [&str; 3] = ["module", "room", "group"];

const INTRODUCTION: &str = "\
# Modules

Search this page for a name to find the file that has it. You find the same tables at the head of each `lib.rs` and `mod.rs`, in
the order in which data flows; [ARCHITECTURE.md](../ARCHITECTURE.md) describes the crates. The page is generated:
`UPDATE_DOCS=1 cargo test --profile tests --workspace --test docs rooms` rewrites it.
";

/// All heads below `folder`. A folder's own head comes before those of the folders in it.
fn heads(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder that can be read");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry that can be read").path()).collect();
    paths.sort();
    let name = |path: &PathBuf| path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let mut found: Vec<PathBuf> =
        paths.iter().filter(|path| path.is_file() && HEADS.contains(&name(path).as_str())).cloned().collect();
    for inner in paths.iter().filter(|path| path.is_dir()) {
        let name = name(inner);
        if !name.starts_with('.') && !PASSED_OVER.contains(&name.as_str()) {
            found.extend(heads(inner));
        }
    }
    found
}

/// The first table of modules in the inner docs of a source.
fn table(source: &str) -> Option<String> {
    let docs = source.lines().map_while(|line| line.strip_prefix("//!")).map(str::trim);
    let is_head = |line: &str| TABLES.iter().any(|cell| line.starts_with(&format!("| {cell} |")));
    let rows = docs.skip_while(|line| !is_head(line)).take_while(|line| line.starts_with('|'));
    let text: String = rows.map(|row| plain(row) + "\n").collect();
    (!text.is_empty()).then_some(text)
}

/// A row without the links of rustdoc, which lead nowhere on a page: ``[`name`](target)`` becomes `` `name` ``.
fn plain(row: &str) -> String {
    let mut text = String::new();
    let mut rest = row;
    while let Some((before, after)) = rest.split_once("[`") {
        let Some((name, after)) = after.split_once("`]") else { break };
        write!(text, "{before}`{name}`").expect("a string takes all");
        rest = match after.strip_prefix('(').and_then(|target| target.split_once(')')) {
            Some((_, after)) => after,
            None => after,
        };
    }
    text + rest
}

/// The folder of the crate that a file belongs to, from the root of the repository.
fn crate_of(file: &Path, root: &Path) -> PathBuf {
    let folder = file.ancestors().skip(1).find(|folder| folder.join("Cargo.toml").is_file());
    folder.and_then(|folder| folder.strip_prefix(root).ok()).expect("a file of the repository").to_owned()
}

/// The page, of every table in the repository.
fn page(root: &Path) -> String {
    let mut heads: Vec<(PathBuf, PathBuf)> =
        heads(root).into_iter().map(|head| (crate_of(&head, root), head)).collect();
    // Crates lie within crates; the order within each stays.
    heads.sort_by(|(one, _), (other, _)| one.cmp(other));
    let mut text = INTRODUCTION.to_owned();
    let mut current = PathBuf::new();
    for (folder, head) in heads {
        let source = std::fs::read_to_string(&head).expect("a readable source");
        let Some(table) = table(&source) else { continue };
        if folder != current {
            write!(text, "\n## {}\n", shown(&folder)).expect("a string takes all");
            current = folder;
        }
        let file = shown(head.strip_prefix(root).expect("a file of the repository"));
        write!(text, "\n[`{file}`](../{file})\n\n{table}").expect("a string takes all");
    }
    text
}

/// A path as Markdown writes it on every system.
fn shown(path: &Path) -> String {
    path.to_string_lossy().replace('\\', "/")
}

#[test]
fn the_page_of_rooms_is_up_to_date() {
    let page = page(&repository());
    assert!(page.matches("\n## ").count() > 10, "only few crates have tables: this is not the repository");
    is_published("docs/rooms.md", &page);
}

#[test]
fn tables_of_modules_are_found() {
    let source = "//! A crate.\n//!\n//! | state | call |\n//! |---|---|\n//! | a | b |\n//!\n//! | module | subject |\n\
                  //! |---|---|\n//! | [`one`](mod@one), `two` | of [`Three`] |\n//!\n//! More.\n\nmod one;\n";
    let wanted = "| module | subject |\n|---|---|\n| `one`, `two` | of `Three` |\n";
    assert_eq!(table(source).as_deref(), Some(wanted));
    assert_eq!(table("//! A crate.\n\nmod one;\n"), None);
}
