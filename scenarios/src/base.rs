//! `base = "scenario.toml"`: a scenario that takes in everything of another file and states what differs.

use std::ops::Range;
use std::path::{Component, Path, PathBuf};

use schemars::JsonSchema;
use serde::Deserialize;
use toml::Spanned;
use toml::de::{DeTable, DeValue, Deserializer};

use crate::error::ScenarioError;
use crate::file::VERSION;
use crate::merge::{self, Tree};
use crate::missing;
use crate::permission;
use crate::places;
use crate::texts::Texts;

/// The keys of a scenario that say what it takes in. They are gone once that is done.
#[derive(Debug, Default, Deserialize, JsonSchema)]
pub(crate) struct BaseFile {
    /// Another scenario, of which this one takes in everything: a file of this folder or below it. What is written here
    /// comes in addition or in its place.
    #[schemars(with = "Option<String>")]
    pub base: Option<Spanned<String>>,
    /// What is not taken in, by its path in the base, as `signals.Start`; entries of lists by their names, as
    /// `expect.'no alarm'`.
    #[serde(default)]
    #[schemars(with = "Vec<String>")]
    pub without: Vec<Spanned<String>>,
}

/// Keys of a scenario that name files. `*` stands for every client and panel.
const PATHS: [&[&str]; 4] =
    [&["clients", "*", "scene"], &["clients", "*", "sources"], &["clients", "*", "files"], &["panel", "*", "picture"]];

/// The keys that a scenario has beside those of its session.
const KEYS: [&str; 2] = ["base", "without"];

/// A scenario's file and those that it takes in, the nearest first.
#[derive(Clone, Debug)]
pub(crate) struct Chain {
    texts: Texts,
    /// Where each file is, as seen from the scenario's folder.
    folders: Vec<PathBuf>,
}

/// The scenario in the file `path`.
///
/// # Errors
/// A file that cannot be read or is not TOML, bases that lead in a circle.
pub(crate) fn read(path: &Path) -> Result<Chain, ScenarioError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let text = permission::granted().read_text(folder, path)?.map_err(|source| ScenarioError::Unreadable {
        path: path.to_owned(),
        help: (source.kind() == std::io::ErrorKind::NotFound).then(|| missing::help_for_scenario(path)),
        source,
    })?;
    if let Some(help) = missing::help_for_source(path) {
        return Err(ScenarioError::Other { path: path.to_owned(), help });
    }
    let mut texts = Texts::of(path.to_owned(), text);
    let (mut folders, mut seen) = (vec![PathBuf::new()], vec![identity(path)]);
    let mut start = 0;
    while let Some(base) = base_of(&texts, start)? {
        let within = normal(&folders.last().map_or_else(PathBuf::new, |within| within.join(base.get_ref())));
        let file = folder.join(&within);
        let read = permission::granted().read_text(folder, &file)?;
        let wrong = |message: String| texts.wrong(message, Some(base.span()), None);
        let text = read.map_err(|why| wrong(format!("cannot read the base `{}`: {why}", base.get_ref())))?;
        if seen.contains(&identity(&file)) {
            return Err(wrong(format!("the base `{}` takes in this file: they lead in a circle", base.get_ref())));
        }
        seen.push(identity(&file));
        folders.push(within.parent().map(Path::to_owned).unwrap_or_default());
        start = texts.add(file, &text);
    }
    Ok(Chain { texts, folders })
}

/// The base of the last of the texts, which starts at `start`.
fn base_of(texts: &Texts, start: usize) -> Result<Option<Spanned<String>>, ScenarioError> {
    let text = texts.last();
    // Keys of the file itself stand in front of its first table. A line with a bracket within a value cuts that off, so that
    // the parser refuses it.
    let mut at = 0;
    let is_plain = |line: &&str| !line.trim_start().starts_with('[');
    text.split_inclusive('\n').take_while(is_plain).for_each(|line| at += line.len());
    let keys: Result<BaseFile, _> = toml::from_str(&text[..at]).or_else(|_| toml::from_str(text));
    let base = keys.map_err(|error| wrong_form(texts, &error, start))?.base;
    Ok(base.map(|base| Spanned::new(shifted(base.span(), start), base.into_inner())))
}

fn wrong_form(texts: &Texts, error: &toml::de::Error, start: usize) -> ScenarioError {
    let message = error.message().trim();
    let message = twice(texts, message, error.span(), start).unwrap_or_else(|| message.to_owned());
    texts.wrong(message, error.span().map(|place| shifted(place, start)), None)
}

/// What there is to say of a key that stands twice: its name, and where it stands first.
fn twice(texts: &Texts, message: &str, second: Option<Range<usize>>, start: usize) -> Option<String> {
    let second = second.filter(|_| message == "duplicate key")?;
    let text = texts.text().get(start..)?;
    let first = places::first_of(text, &second)?;
    Some(format!("`{}` is written twice; first at {}", text.get(second)?.trim(), texts.line_and_column(start + first)))
}

fn shifted(place: Range<usize>, by: usize) -> Range<usize> {
    place.start + by..place.end + by
}

impl Chain {
    /// The texts of all files, in which everything of the tree has its place.
    pub(crate) fn texts(&self) -> &Texts {
        &self.texts
    }

    /// The scenario with everything that it takes in.
    ///
    /// # Errors
    /// A file is not TOML; what a file leaves out is not there.
    pub(crate) fn tree(&self) -> Result<Spanned<Tree<'_>>, ScenarioError> {
        let mut all: Option<Spanned<Tree<'_>>> = None;
        for part in self.texts.parts().zip(&self.folders).rev() {
            let (mut root, keys) = self.part(part)?;
            if let Some(base) = all {
                let place = root.span();
                let base = self.left_out(base.into_inner(), &keys)?;
                root = Spanned::new(place, merge::merged(base, root.into_inner()));
            } else if let Some(first) = keys.without.first() {
                let help = "name the file to take in, as in `base = \"scenario.toml\"`".to_owned();
                let message = "`without` needs a `base`".to_owned();
                return Err(self.texts.wrong(message, Some(first.span()), Some(help)));
            }
            all = Some(root);
        }
        Ok(all.unwrap_or_else(|| Spanned::new(0..0, Tree::new())))
    }

    /// One file, with its places as they are in all texts.
    fn part<'t>(
        &self,
        ((start, text), within): ((usize, &'t str), &PathBuf),
    ) -> Result<(Spanned<Tree<'t>>, BaseFile), ScenarioError> {
        let root = DeTable::parse(text).map_err(|error| wrong_form(&self.texts, &error, start))?;
        let place = shifted(root.span(), start);
        let mut table = merge::moved(root.into_inner(), start);
        let own = KEYS.iter().filter_map(|key| table.remove_entry(*key)).collect();
        let keys = BaseFile::deserialize(Deserializer::from(Spanned::new(place.clone(), own)));
        let keys = keys.map_err(|error| wrong_form(&self.texts, &error, 0))?;
        let mut root = Spanned::new(place, table);
        if self.folders.len() > 1 {
            self.check_version(&root)?;
        }
        resolve(root.get_mut(), within);
        Ok((root, keys))
    }

    /// A base without what a file leaves out of it.
    fn left_out<'t>(&self, mut base: Tree<'t>, keys: &BaseFile) -> Result<Tree<'t>, ScenarioError> {
        for path in &keys.without {
            let wrong = |message: String, help| self.texts.wrong(message, Some(path.span()), help);
            let Some(steps) = path_of(path.get_ref()) else {
                let help = "as in `signals.Start` or `expect.'no alarm'`".to_owned();
                return Err(wrong(format!("`{}` is not a path of keys", path.get_ref()), Some(help)));
            };
            if !merge::remove(&mut base, &steps) {
                return Err(wrong(format!("the base has no `{}`", path.get_ref()), None));
            }
        }
        Ok(base)
    }

    /// Refuses a file that does not state the version that is read. That of another file says nothing of it.
    fn check_version(&self, root: &Spanned<Tree<'_>>) -> Result<(), ScenarioError> {
        let wrong = |message: String, place| {
            Err(self.texts.wrong(message, Some(place), Some(format!("write `version = {VERSION}`"))))
        };
        let Some(version) = root.get_ref().get("version") else {
            return wrong("missing field `version`".to_owned(), root.span());
        };
        match version.get_ref().as_integer().map(|stated| i64::from_str_radix(stated.as_str(), stated.radix())) {
            Some(Ok(stated)) if stated == i64::from(VERSION) => Ok(()),
            Some(Ok(other)) => wrong(format!("version {other} of the scenario format is not known"), version.span()),
            _ => wrong("the version is a number".to_owned(), version.span()),
        }
    }
}

/// The files that the scenario in `path` takes in, the nearest first.
///
/// # Errors
/// See [`read`].
pub(crate) fn bases(path: &Path) -> Result<Vec<PathBuf>, ScenarioError> {
    Ok(read(path)?.texts.paths().skip(1).map(Path::to_owned).collect())
}

/// The keys of a path as TOML writes it; nothing if it is not one.
fn path_of(text: &str) -> Option<Vec<String>> {
    // The parser of TOML knows how keys are written; a key with a value is the shortest file with a path.
    let file = format!("{text} = true");
    let root = DeTable::parse(&file).ok()?.into_inner();
    let (mut table, mut path) = (&root, Vec::new());
    loop {
        let mut entries = table.iter();
        let (Some((key, value)), None) = (entries.next(), entries.next()) else { return None };
        path.push(key.get_ref().to_string());
        match value.get_ref() {
            DeValue::Table(inner) => table = inner,
            DeValue::Boolean(true) => return Some(path),
            _ => return None,
        }
    }
}

/// Names the files of a base as the scenario names them: those of a base in the folder `within` are relative to that.
fn resolve(root: &mut Tree<'_>, within: &Path) {
    if within.as_os_str().is_empty() {
        return;
    }
    for path in PATHS {
        if let [first, rest @ ..] = path
            && let Some(value) = root.get_mut(*first)
        {
            resolve_value(value.get_mut(), rest, within);
        }
    }
}

fn resolve_value(value: &mut DeValue<'_>, path: &[&str], within: &Path) {
    match (value, path) {
        (DeValue::String(text), []) => {
            let named = normal(&within.join(&**text));
            let parts: Vec<_> = named.iter().map(|part| part.to_string_lossy().into_owned()).collect();
            *text = if named.is_absolute() { named.display().to_string() } else { parts.join("/") }.into();
        }
        (DeValue::Array(list), []) => list.iter_mut().for_each(|entry| resolve_value(entry.get_mut(), &[], within)),
        (DeValue::Array(list), ["*", rest @ ..]) => {
            list.iter_mut().for_each(|entry| resolve_value(entry.get_mut(), rest, within));
        }
        (DeValue::Table(table), ["*", rest @ ..]) => {
            table.iter_mut().for_each(|(_, entry)| resolve_value(entry.get_mut(), rest, within));
        }
        (DeValue::Table(table), [key, rest @ ..]) => {
            if let Some(entry) = table.get_mut(*key) {
                resolve_value(entry.get_mut(), rest, within);
            }
        }
        // Values of other types are refused when the file is read.
        _ => {}
    }
}

/// A path without `.` and without `..` that another part takes back.
fn normal(path: &Path) -> PathBuf {
    let mut parts: Vec<Component<'_>> = Vec::new();
    for part in path.components() {
        match (part, parts.last()) {
            (Component::CurDir, _) => {}
            (Component::ParentDir, Some(Component::Normal(_))) => {
                parts.pop();
            }
            _ => parts.push(part),
        }
    }
    parts.iter().collect()
}

/// What makes two names those of one file.
fn identity(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

#[cfg(test)]
mod tests;
