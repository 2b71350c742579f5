//! What lies at `%I` inside of instances and structures.

use std::collections::BTreeMap;

use onescan_iec::ir::{Type, TypeId, Variable};
use onescan_iec::syntax::Span;
use onescan_iec::syntax::ast::SectionKind;
use onescan_iec::syntax::direct_address::Area;

use super::Application;
use super::variable::Spot;

/// True for a variable at `%IX0.0`, or at `%I*`, whose place is not known.
pub(super) fn is_at_input(variable: &Variable) -> bool {
    is_input_address(variable.address.as_deref())
}

fn is_input_address(address: Option<&str>) -> bool {
    address.is_some_and(|address| address.get(..2).is_some_and(|area| area.eq_ignore_ascii_case("%I")))
}

/// Goes through the variables of an application.
pub(super) struct InnerInputs<'a> {
    application: &'a Application,
    /// The types that are known to have such members, or not to.
    known: BTreeMap<TypeId, bool>,
    /// Each with the declaration that it stands in.
    pub(super) found: Vec<(Spot, Span)>,
}

impl<'a> InnerInputs<'a> {
    pub(super) fn of(application: &'a Application) -> Self {
        Self { application, known: BTreeMap::new(), found: Vec::new() }
    }

    /// Adds the members of a variable that lie at `%I`, itself left out.
    pub(super) fn add(&mut self, whole: &Spot, declared: Span) {
        if !self.has_inputs(whole.ty) {
            return;
        }
        for at in 0.. {
            let Some(piece) = self.application.part(whole, at) else { return };
            let Ok(part) = self.application.step(whole, &piece) else { continue };
            let declared = self.declaration(whole.ty, at).unwrap_or(declared);
            if self.is_input(whole.ty, at) {
                self.found.push((part, declared));
            } else {
                self.add(&part, declared);
            }
        }
    }

    fn variables(&self, ty: TypeId) -> &'a [Variable] {
        let checked = &self.application.inner.checked;
        match checked.types.get(ty) {
            Type::FunctionBlock { pou, .. } => checked.interfaces.get(pou).map_or(&[][..], Vec::as_slice),
            _ => &[],
        }
    }

    /// Where the member of an instance is declared.
    fn declaration(&self, ty: TypeId, at: u64) -> Option<Span> {
        let at = usize::try_from(at).ok()?;
        self.variables(ty).get(at).map(|variable| variable.span)
    }

    fn is_input(&self, ty: TypeId, at: u64) -> bool {
        let Ok(at) = usize::try_from(at) else { return false };
        match self.application.inner.checked.types.get(ty) {
            Type::Struct { fields, .. } => fields.get(at).is_some_and(|field| field.open == Some(Area::Input)),
            _ => self.variables(ty).get(at).is_some_and(is_own_input),
        }
    }

    /// True for a type some of whose members lie at `%I`.
    fn has_inputs(&mut self, ty: TypeId) -> bool {
        if let Some(known) = self.known.get(&ty) {
            return *known;
        }
        // What refers to itself has nothing more.
        self.known.insert(ty, false);
        let application = self.application;
        let has = match application.inner.checked.types.get(ty) {
            Type::Struct { fields, .. } => {
                fields.iter().any(|field| field.open == Some(Area::Input) || self.has_inputs(field.ty))
            }
            Type::FunctionBlock { .. } => {
                let variables = self.variables(ty);
                variables.iter().any(|variable| is_own_input(variable) || self.has_inputs(variable.ty))
            }
            Type::Array { element, .. } => self.has_inputs(*element),
            _ => false,
        };
        self.known.insert(ty, has);
        has
    }
}

/// True for what the unit itself has there; `VAR_EXTERNAL` names what is declared elsewhere.
fn is_own_input(variable: &Variable) -> bool {
    variable.section != SectionKind::External && is_at_input(variable)
}
