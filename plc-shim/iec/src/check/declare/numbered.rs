//! Inputs and outputs that a drawing knows by their numbers.
//!
//! An editor that has never seen the declaration of a block saves its pins without names. The drawing then says
//! `` `in.3.5` ``, the third of five inputs, which is found once the declaration is known.

use super::scope::Scope;
use crate::check::types::parameter;
use crate::ir::Variable;
use crate::syntax::ast::SectionKind;

/// A pin by its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::check) struct Numbered<'t> {
    direction: &'t str,
    number: usize,
    count: usize,
}

impl<'t> Numbered<'t> {
    pub(in crate::check) fn of(name: &'t str) -> Option<Self> {
        let mut parts = name.strip_prefix('`')?.trim_end_matches('`').split('.');
        let direction = parts.next().filter(|word| matches!(*word, "in" | "out"))?;
        let mut number = || parts.next()?.parse().ok();
        Some(Self { direction, number: number()?, count: number()? })
    }

    /// What is reported if a block has other inputs and outputs than the drawing.
    pub(in crate::check) fn lost(self, block: &str) -> String {
        let what = if self.direction == "in" { "inputs" } else { "outputs" };
        let count = self.count;
        format!(
            "the drawing does not name the {what} of {block}, and their number in the declaration is not {count}: open the \
             drawing in its editor, update the box and save it"
        )
    }
}

impl Scope {
    /// The input or output of a number, if there are as many as in the drawing.
    pub(in crate::check) fn numbered(&self, wanted: Numbered<'_>) -> Option<&Variable> {
        let pins: Vec<&Variable> = if wanted.direction == "in" {
            // A box has its inputs first and what it changes in its place behind them; a constant input is not a pin.
            let pins = self.positional().filter(|variable| !variable.is_constant);
            let (inputs, changed): (Vec<_>, Vec<_>) = pins.partition(|pin| pin.section == SectionKind::Input);
            inputs.into_iter().chain(changed).collect()
        } else {
            let outputs = self.variables().iter().filter(|variable| variable.section == SectionKind::Output);
            outputs.filter(|variable| !parameter::is_control(variable)).collect()
        };
        if self.has_broken() || pins.len() != wanted.count {
            return None;
        }
        pins.get(wanted.number.checked_sub(1)?).copied()
    }
}
