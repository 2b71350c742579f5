//! Every variable that has a value of its own.

use super::variable::{Piece, Spot, kept, spot};
use super::{Application, Variable};
use onescan_iec::check::Checked;
use onescan_iec::ir::{PouId, Storage, Type};

impl Application {
    /// Every variable of elementary type and every string, with its path, in the order of
    /// declaration: globals first, then those of each resource, then those of each program.
    pub fn leaves(&self) -> impl Iterator<Item = Variable> {
        let checked = &self.inner.checked;
        let globals = self.globals().filter_map(|(home, global)| spot(checked, home, global, 0));
        let programs = checked.programs.iter().zip(self.entry_names()).flat_map(|(program, name)| {
            let variables = checked.interfaces.get(&program.pou).map_or(&[][..], Vec::as_slice);
            let held = variables
                .iter()
                .filter(|variable| matches!(variable.storage, Storage::Instance(_) | Storage::Located(_)));
            let held = held.filter_map(move |variable| spot(checked, name, variable, program.offset));
            held.chain(kept(checked, program.pou).iter().flat_map(move |kept| {
                let prefix = format!("{name}.{}", kept.method);
                kept.variables.iter().filter_map(move |variable| spot(checked, &prefix, variable, program.offset))
            }))
        });
        let roots: Vec<Spot> = globals.chain(programs).collect();
        roots.into_iter().flat_map(|root| self.leaves_of(root))
    }

    /// The global variables, each behind the name of its resource: those of all resources first, behind no name.
    pub(super) fn globals(&self) -> impl Iterator<Item = (&str, &onescan_iec::ir::Variable)> {
        let checked = &self.inner.checked;
        let resources = checked.configuration.iter().flat_map(|configuration| &configuration.resources);
        let own = resources.flat_map(|resource| {
            // The only resource of a configuration has no name.
            let home = resource.name.as_deref().unwrap_or_default();
            resource.globals.iter().map(move |global| (home, global))
        });
        checked.globals.iter().map(|global| ("", global)).chain(own)
    }

    /// The same of one variable: itself, if it has no parts.
    pub(super) fn leaves_of(&self, root: Spot) -> impl Iterator<Item = Variable> {
        Leaves { application: self, open: vec![Open::new(root)] }
    }
}

/// A variable whose parts are being visited.
struct Open {
    spot: Spot,
    next: u64,
}

impl Open {
    fn new(spot: Spot) -> Self {
        Self { spot, next: 0 }
    }
}

struct Leaves<'a> {
    application: &'a Application,
    open: Vec<Open>,
}

impl Iterator for Leaves<'_> {
    type Item = Variable;

    fn next(&mut self) -> Option<Variable> {
        loop {
            let open = self.open.last_mut()?;
            let types = &self.application.inner.checked.types;
            if types.elementary(open.spot.ty).is_some() || types.text(open.spot.ty).is_some() {
                let leaf = self.open.pop()?;
                return Some(self.application.describe(leaf.spot));
            }
            let piece = self.application.part(&open.spot, open.next);
            open.next += 1;
            match piece {
                // A part that does not lie in its instance is passed over.
                Some(piece) => {
                    let part = self.application.step(&open.spot, &piece);
                    self.open.extend(part.ok().map(Open::new));
                }
                None => {
                    self.open.pop();
                }
            }
        }
    }
}

impl Application {
    /// The way to the part at a position of a structure, array or instance.
    pub(super) fn part(&self, of: &Spot, at: u64) -> Option<Piece> {
        let checked = &self.inner.checked;
        let index = usize::try_from(at).ok()?;
        match checked.types.get(of.ty) {
            Type::Struct { fields, .. } => Some(Piece::Name(fields.get(index)?.name.clone())),
            Type::FunctionBlock { pou, .. } => {
                let own = checked.interfaces.get(pou)?;
                match own.get(index) {
                    Some(variable) => Some(Piece::Name(variable.name.clone())),
                    None => kept_at(checked, *pou, index - own.len()),
                }
            }
            Type::Array { dimensions, .. } => {
                let mut rest = at;
                let mut indices = Vec::with_capacity(dimensions.len());
                for bounds in dimensions.iter().rev() {
                    let count = bounds.count().max(1);
                    indices.push(bounds.low + (rest % count) as i64);
                    rest /= count;
                }
                indices.reverse();
                (rest == 0).then_some(Piece::Index(indices))
            }
            _ => None,
        }
    }
}

/// The way to a variable that a method of the unit keeps, by its position among all of them.
fn kept_at(checked: &Checked, unit: PouId, at: usize) -> Option<Piece> {
    let mut all =
        kept(checked, unit).iter().flat_map(|kept| kept.variables.iter().map(move |variable| (kept, variable)));
    let (kept, variable) = all.nth(at)?;
    Some(Piece::Kept(kept.method.clone(), variable.name.clone()))
}
