//! Where paths begin: `VAR_ACCESS` names, global variables, programs' instances, each of them with
//! or without the names of its configuration and resource in front.

use super::Application;
use super::variable::{Piece, Spot, VariableAccess, spot};
use onescan_iec::diagnostic::did_you_mean;
use onescan_iec::ir::{Program, Resource, Storage};

/// Why a path begins nowhere: the nearest name, if one is near.
type NoRoot = Option<String>;

impl Application {
    /// What the first pieces of a path name, and what is left of it.
    pub(super) fn root<'p>(&self, pieces: &'p [Piece]) -> Result<(Spot, &'p [Piece]), NoRoot> {
        let [Piece::Name(first), rest @ ..] = pieces else { return Err(None) };
        if let Some(found) = self.shared_root(first) {
            return Ok((found, rest));
        }
        if let Some(found) = self.qualified_root(pieces) {
            return Ok(found);
        }
        let Some(configuration) = &self.inner.checked.configuration else {
            return Err(self.similar_root(first));
        };
        let resources = &configuration.resources;
        if let Some(index) = resources.iter().position(|resource| is_named(resource, first)) {
            let [Piece::Name(second), rest @ ..] = rest else { return Err(None) };
            let found = self.root_in(index, second).map(|found| (found, rest));
            return found.ok_or_else(|| self.similar_root(second));
        }
        if configuration.name.eq_ignore_ascii_case(first) && !rest.is_empty() {
            return self.root(rest);
        }
        Err(self.similar_root(first))
    }

    /// What a name means without its resource.
    fn shared_root(&self, name: &str) -> Option<Spot> {
        let checked = &self.inner.checked;
        let mut access = checked.configuration.iter().flat_map(|configuration| &configuration.access);
        if let Some(access) = access.find(|access| access.name.eq_ignore_ascii_case(name)) {
            let target = &access.target;
            let offset = match target.storage {
                Storage::Located(location) => checked.areas.offset(location) + target.inside,
                _ => target.inside,
            };
            let rights = if access.writable { VariableAccess::ReadWrite } else { VariableAccess::ReadOnly };
            let (path, ty, bit) = (access.name.clone(), target.ty, target.bit());
            return Some(Spot { path, offset, bit, ty, address: None, access: rights });
        }
        let global = checked.globals.iter().find(|each| each.name.eq_ignore_ascii_case(name));
        if let Some(found) = global.and_then(|global| spot(checked, "", global, 0)) {
            return Some(found);
        }
        if let Some(index) = self.entry_index(name).filter(|index| *index < checked.programs.len()) {
            return self.program_spot(name_of(self, index), checked.programs.get(index)?);
        }
        // A name that only one resource has needs no resource in front of it.
        let resources = 0..checked.configuration.as_ref().map_or(0, |configuration| configuration.resources.len());
        let mut found = resources.filter_map(|index| self.global_in(index, name));
        let first = found.next()?;
        found.next().is_none().then_some(first)
    }

    fn root_in(&self, resource: usize, name: &str) -> Option<Spot> {
        let programs = &self.inner.checked.programs;
        let is_it = |each: &Program| each.resource == Some(resource) && each.name.eq_ignore_ascii_case(name);
        self.global_in(resource, name).or_else(|| {
            let (index, program) = programs.iter().enumerate().find(|(_, each)| is_it(each))?;
            self.program_spot(name_of(self, index), program)
        })
    }

    fn global_in(&self, resource: usize, name: &str) -> Option<Spot> {
        let checked = &self.inner.checked;
        let resource = checked.configuration.as_ref()?.resources.get(resource)?;
        let global = resource.globals.iter().find(|each| each.name.eq_ignore_ascii_case(name))?;
        spot(&self.inner.checked, resource.name.as_deref().unwrap_or_default(), global, 0)
    }

    fn program_spot(&self, path: &str, program: &Program) -> Option<Spot> {
        let ty = self.inner.checked.types.known_block(program.pou)?;
        Some(Spot {
            path: path.to_owned(),
            offset: program.offset,
            bit: None,
            ty,
            address: None,
            access: VariableAccess::ReadWrite,
        })
    }

    fn similar_root(&self, name: &str) -> NoRoot {
        let checked = &self.inner.checked;
        let own = checked.configuration.iter().flat_map(|configuration| &configuration.resources);
        let own = own.flat_map(|resource| {
            resource.globals.iter().map(|global| global.name.as_str()).chain(resource.name.as_deref())
        });
        let globals = checked.globals.iter().map(|global| global.name.as_str());
        did_you_mean(name, globals.chain(self.entry_names()).chain(own))
    }
}

fn is_named(resource: &Resource, name: &str) -> bool {
    resource.name.as_ref().is_some_and(|own| own.eq_ignore_ascii_case(name))
}

fn name_of(application: &Application, program: usize) -> &str {
    application.entry_name(program).unwrap_or_default()
}
