//! The files as they are worked on: what was changed, taken back, done again. No file is read or written here.

use super::change::{Edit, Texts};
use super::document::Document;
use super::error::EditError;
use super::wire;

/// How many changes can be taken back.
const STEPS_MAX: usize = 1_000;

/// A change that was made or taken back.
#[derive(Clone, Debug)]
struct Step {
    what: String,
    /// The files on its other side.
    other: Texts,
}

/// The files, and the way that led to them.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    texts: Texts,
    done: Vec<Step>,
    undone: Vec<Step>,
    revision: u64,
}

impl Workspace {
    /// Files as they are found, after those of this revision.
    pub fn new(texts: Texts, revision: u64) -> Self {
        Self { texts, revision, ..Self::default() }
    }

    /// As they are now.
    pub fn texts(&self) -> &Texts {
        &self.texts
    }

    /// Another number after every change, so that nobody changes what he has not seen.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// What would be taken back, and what would be done again.
    pub fn steps(&self) -> (Option<&str>, Option<&str>) {
        (what(&self.done), what(&self.undone))
    }

    /// Makes changes together: all of them, or none.
    ///
    /// # Errors
    /// The first that cannot be made; a key that is written twice by them.
    pub fn change(&mut self, edits: &[Edit]) -> Result<(), EditError> {
        let mut texts = self.texts.clone();
        for edit in edits {
            texts = edit.apply(&texts)?;
        }
        Document::parse(wire::FILE, &texts.scenario)?;
        for (file, text) in &texts.scenes {
            Document::parse(file, text)?;
        }
        if texts == self.texts {
            return Ok(());
        }
        let said: Vec<String> = edits.iter().map(ToString::to_string).collect();
        let other = std::mem::replace(&mut self.texts, texts);
        self.done.push(Step { what: said.join(", "), other });
        if self.done.len() > STEPS_MAX {
            self.done.remove(0);
        }
        self.undone.clear();
        self.revision += 1;
        Ok(())
    }

    /// Takes the last change back; false if there is none.
    pub fn undo(&mut self) -> bool {
        Self::turn(&mut self.texts, &mut self.done, &mut self.undone, &mut self.revision)
    }

    /// Makes the change again that was taken back last; false if there is none.
    pub fn redo(&mut self) -> bool {
        Self::turn(&mut self.texts, &mut self.undone, &mut self.done, &mut self.revision)
    }

    fn turn(texts: &mut Texts, from: &mut Vec<Step>, to: &mut Vec<Step>, revision: &mut u64) -> bool {
        let Some(Step { what, other }) = from.pop() else { return false };
        to.push(Step { what, other: std::mem::replace(texts, other) });
        *revision += 1;
        true
    }
}

fn what(steps: &[Step]) -> Option<&str> {
    steps.last().map(|step| step.what.as_str())
}

#[cfg(test)]
mod tests;
