//! Gathers the faults of one file and finds their lines.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::placed::Placed;
use onescan_base::nearest;
use onescan_base::regular::Within;
use onescan_server::client::SourcePlace;

use super::error::{Inside, SceneError, SceneFault, SceneFaultKind, Thing};
use crate::file_place::{Place, Source};
use crate::mesh::{Mesh, MeshError};

/// The faults found so far in one file.
pub(super) struct Faults<'t> {
    text: &'t str,
    file: &'t str,
    /// What the files that it names may be.
    within: &'t Within,
    found: Vec<SceneFault>,
    /// Beginnings of names that are not there because a robot was refused.
    lost: Vec<String>,
    /// Files whose tables are read as if they stood in the scene.
    attached: Vec<Attached>,
    /// Meshes that were read: a robot names many of them more than once.
    meshes: RefCell<BTreeMap<PathBuf, Arc<Mesh>>>,
}

/// A file whose places are those of the scene behind all of its own.
struct Attached {
    /// The kind of component that it defines.
    kind: String,
    source: Arc<Source>,
    /// Where its places begin.
    base: usize,
    /// Where the scene names the kind.
    named_at: Range<usize>,
}

/// Where the places of attached files begin: behind any scene, and behind the overrides.
const ATTACHED: usize = 1 << 31;

impl<'t> Faults<'t> {
    pub(super) fn new(text: &'t str, file: &'t str, within: &'t Within) -> Self {
        Self {
            text,
            file,
            within,
            found: Vec::new(),
            lost: Vec::new(),
            attached: Vec::new(),
            meshes: RefCell::default(),
        }
    }

    /// The file's text.
    pub(super) fn text(&self) -> &'t str {
        self.text
    }

    /// True if nothing was found so far.
    pub(super) fn is_empty(&self) -> bool {
        self.found.is_empty()
    }

    /// Line and column of a byte of the file, or of one that is attached to it.
    pub(super) fn place(&self, byte: usize) -> SourcePlace {
        if let Some(Attached { source, base, .. }) = self.attached.iter().rfind(|file| file.base <= byte) {
            return Place { source: Arc::clone(source), span: byte - base..byte - base }.start();
        }
        let mut end = byte.min(self.text.len());
        while !self.text.is_char_boundary(end) {
            end -= 1;
        }
        let before = &self.text[..end];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        SourcePlace {
            file: self.file.to_owned(),
            line: before.matches('\n').count() as u32 + 1,
            column: before[line_start..].chars().count() as u32 + 1,
        }
    }

    /// What the files that it names may be.
    pub(super) fn within(&self) -> &'t Within {
        self.within
    }

    /// A file that the scene names, found beside its own.
    pub(super) fn beside(&self, name: &str) -> PathBuf {
        Path::new(self.file).parent().unwrap_or_else(|| Path::new("")).join(name)
    }

    /// The mesh of a file, which is read once.
    pub(super) fn mesh(&self, path: &Path) -> Result<Arc<Mesh>, MeshError> {
        if let Some(known) = self.meshes.borrow().get(path) {
            return Ok(Arc::clone(known));
        }
        let mesh = Arc::new(Mesh::read_within(path, self.within)?);
        self.meshes.borrow_mut().insert(path.to_path_buf(), Arc::clone(&mesh));
        Ok(mesh)
    }

    pub(super) fn add(&mut self, span: Range<usize>, kind: SceneFaultKind) {
        self.add_hinted(span, kind, None);
    }

    /// Reads a file as if it stood in the scene, named at `named_at`; what is to be added to its places.
    pub(super) fn attach(&mut self, kind: &str, source: &Arc<Source>, named_at: Range<usize>) -> usize {
        let base = self.attached.last().map_or(ATTACHED, |last| last.base + last.source.text.len() + 1);
        self.attached.push(Attached { kind: kind.to_owned(), source: Arc::clone(source), base, named_at });
        base
    }

    pub(super) fn add_hinted(&mut self, span: Range<usize>, kind: SceneFaultKind, hint: Option<String>) {
        match self.attached.iter().rfind(|file| file.base <= span.start) {
            None => self.add_own(span, kind, hint),
            Some(Attached { kind: name, source, base, named_at }) => {
                let span = span.start - base..span.end.saturating_sub(*base);
                let place = Place { source: Arc::clone(source), span };
                let is_there = |fault: &SceneFault| fault.inside.as_ref().is_some_and(|inside| inside.place == place);
                if self.found.iter().any(is_there) {
                    // another component of the same kind
                    return;
                }
                let reported = match kind {
                    SceneFaultKind::OwnKind { cause, .. } => cause,
                    kind => kind.to_string(),
                };
                let cause = format!("{} line {}: {reported}", source.file, place.start().line);
                let (kind, named_at) = (SceneFaultKind::OwnKind { kind: name.clone(), cause }, named_at.clone());
                // an assembly within another is named in that one's file
                self.add_hinted(named_at, kind, hint);
                if let Some(fault) = self.found.last_mut() {
                    fault.inside = Some(Inside { reported, place });
                }
            }
        }
    }

    fn add_own(&mut self, span: Range<usize>, kind: SceneFaultKind, hint: Option<String>) {
        let place = self.place(span.start);
        let overridden = index_of(&span, self.text);
        self.found.push(SceneFault { kind, place, span, hint, inside: None, overridden });
    }

    /// A fault in a file that the scene names.
    pub(super) fn add_inside(
        &mut self,
        span: Range<usize>,
        kind: SceneFaultKind,
        hint: Option<String>,
        inside: Inside,
    ) {
        self.add_hinted(span, kind, hint);
        if let Some(fault) = self.found.last_mut() {
            fault.inside = Some(inside);
        }
    }

    /// The fault in the form of an attached file that the TOML reader stopped at; `base` is added to its place.
    pub(super) fn add_form(&mut self, base: usize, error: &toml::de::Error) {
        let (message, hint) = reworded(error.message());
        let span = error.span().unwrap_or(0..0);
        self.add_hinted(base + span.start..base + span.end, SceneFaultKind::Form(message), hint);
    }

    /// The fault in the form of a file that the TOML reader stopped at.
    pub(super) fn into_form_error(mut self, error: &toml::de::Error) -> SceneError {
        let (message, hint) = reworded(error.message());
        self.add_hinted(error.span().unwrap_or(0..0), SceneFaultKind::Form(message), hint);
        SceneError::Faulty(self.found)
    }

    pub(super) fn unknown<'n>(
        &mut self,
        thing: Thing,
        name: &Placed<String>,
        candidates: impl IntoIterator<Item = &'n str>,
    ) {
        if self.lost.iter().any(|lost| name.get_ref().starts_with(lost)) {
            return;
        }
        let hint = nearest(name.get_ref(), candidates).map(|near| format!("did you mean `{near}`?"));
        self.add_hinted(name.span(), SceneFaultKind::Unknown { thing, name: name.get_ref().clone() }, hint);
    }

    /// From now on nobody misses what begins so.
    pub(super) fn lose(&mut self, beginning: String) {
        self.lost.push(beginning);
    }

    /// How many were found so far.
    pub(super) fn found_so_far(&self) -> usize {
        self.found.len()
    }

    /// What was found.
    pub(super) fn into_found(self) -> Vec<SceneFault> {
        self.found
    }

    /// What was found so far, as an error.
    pub(super) fn into_error(mut self) -> SceneError {
        self.found.sort_by_key(|fault| fault.span.start);
        SceneError::Faulty(self.found)
    }

    /// `value`, if nothing at all was found.
    pub(super) fn into_result<T>(self, value: T) -> Result<T, SceneError> {
        if self.found.is_empty() { Ok(value) } else { Err(self.into_error()) }
    }
}

/// A message of the TOML reader in the words of a scene file, with a hint: the nearest right key
/// out of a message like "unknown field `masskg`, expected one of `name`, `mass_kg`".
fn reworded(message: &str) -> (String, Option<String>) {
    let reported = message
        .replacen("unknown field", "unknown key", 1)
        .replacen("unknown variant", "unknown value", 1)
        .replacen("missing field", "missing key", 1)
        .replacen("expected f64", "expected a number", 1)
        .replacen("expected i64", "expected a whole number", 1);
    let mut quoted = message.split('`').skip(1).step_by(2);
    let wrong = quoted.next().filter(|_| message.starts_with("unknown"));
    let near = wrong.and_then(|wrong| nearest(wrong, quoted));
    match (near, reported.split_once(", expected")) {
        (Some(near), Some((short, _))) => (short.to_owned(), Some(format!("did you mean `{near}`?"))),
        _ => (reported, None),
    }
}

/// The override that stands at a place; nothing for a place in the file.
fn index_of(place: &Range<usize>, text: &str) -> Option<usize> {
    place.start.checked_sub(text.len() + 1)
}
