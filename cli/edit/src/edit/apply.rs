//! What a change makes of the files: text for text, nothing read or written here.

use super::change::{Edit, Given, Sort, Texts};
use super::construct;
use super::error::EditError;
use super::wire;

impl Edit {
    /// The files with this change.
    ///
    /// # Errors
    /// It cannot be made, and says why.
    pub fn apply(&self, texts: &Texts) -> Result<Texts, EditError> {
        match self {
            Self::Connect { client, signal, variable } => wire::connect(texts, client, signal, variable),
            Self::Disconnect { client, signal } => wire::disconnect(texts, client, signal),
            Self::Declare { signal, ty, writer, unit, about } => {
                let declared = wire::Declared { signal, ty, writer, unit: unit.as_deref(), about: about.as_deref() };
                wire::declare(texts, &declared)
            }
            Self::Withdraw { signal } => wire::withdraw(texts, signal),
            Self::Add { scene, sort, name, keys } => construct::add(texts, scene, *sort, name, keys),
            Self::Set { scene, sort, name, key, value } => {
                construct::set(texts, scene, (*sort, name), key, value.as_ref())
            }
            Self::Move { scene, body, position_m } => {
                let value = Given::Numbers(position_m.to_vec());
                construct::set(texts, scene, (Sort::Body, body), "position_m", Some(&value))
            }
            Self::Rename { scene, sort, name, to } => construct::rename(texts, scene, *sort, name, to),
            Self::Remove { scene, sort, name } => construct::remove(texts, scene, *sort, name),
        }
    }
}
