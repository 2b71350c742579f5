//! Initial values that are computed: where the target would compute others, the text has the value itself.

use std::collections::BTreeMap;

use super::{Change, Written};
use crate::output::Refused;
use onescan_iec::front::Front;
use onescan_iec::ir::{ElementaryType as E, Type};
use onescan_iec::syntax::ast::{Declaration, Section};
use onescan_iec::syntax::{FileId, Span};

/// The initial bytes of the variables that declarations give one, by where their names stand.
type Images<'f> = BTreeMap<(FileId, u32), (&'f Type, &'f [u8])>;

fn images(front: &Front) -> Images<'_> {
    let variables = front.checked.interfaces.values().flatten().chain(&front.checked.globals);
    let image = |each: &onescan_iec::ir::Variable| (each.span.file, each.span.start);
    variables.map(|each| (image(each), (front.checked.types.get(each.ty), &*each.image))).collect()
}

/// The initial values of `own` that are others in `theirs`, which is the same text as the target reads it: their places,
/// and what to write there.
pub(super) fn changed(own: &Front, theirs: &Front) -> Written<Vec<(Span, Change)>> {
    let (wanted, found) = (images(own), images(theirs));
    let mut changes = Vec::new();
    for section in own.units.iter().flat_map(|(_, unit)| &unit.declarations).flat_map(sections) {
        for variable in &section.variables {
            let (Some(initial), Some(name)) = (&variable.initial, variable.names.first()) else { continue };
            let key = (name.span.file, name.span.start);
            let (Some((ty, image)), Some((other, as_read))) = (wanted.get(&key), found.get(&key)) else { continue };
            let is_alike = matches!((ty, other), (Type::Elementary(one), Type::Elementary(two)) if one == two)
                || matches!((ty, other), (Type::Array { .. }, Type::Array { .. }));
            if !is_alike || image.len() != as_read.len() || image == as_read {
                continue;
            }
            let text = number(ty, image).ok_or_else(|| Refused {
                span: initial.span,
                message: "an initial value that is computed, as this one is,".to_owned(),
            })?;
            changes.push((initial.span, Change { at: (initial.span.start, initial.span.end), text }));
        }
    }
    Ok(changes)
}

fn sections(declaration: &Declaration) -> Vec<&Section> {
    match declaration {
        Declaration::Pou(pou) => {
            let members = pou.object.members.iter().flat_map(|member| &member.pou.sections);
            pou.sections.iter().chain(members).collect()
        }
        Declaration::Globals(section) => vec![section],
        Declaration::Configuration(configuration) => configuration.all_sections().collect(),
        Declaration::Type(_) | Declaration::Namespace(_) | Declaration::Using(_) => Vec::new(),
    }
}

/// The literal of a number; nothing for what is none.
fn number(ty: &Type, image: &[u8]) -> Option<String> {
    let Type::Elementary(ty) = ty else { return None };
    match ty {
        E::Real => real(f32::from_le_bytes(image.try_into().ok()?).into()),
        E::Lreal => real(f64::from_le_bytes(image.try_into().ok()?)),
        _ if super::is_whole(*ty) => {
            let bits = image.iter().rev().fold(0_i128, |whole, byte| whole << 8 | i128::from(*byte));
            Some(ty.wrap(bits).to_string())
        }
        _ => None,
    }
}

fn real(value: f64) -> Option<String> {
    let text = format!("{value:?}");
    (value.is_finite() && !text.contains('e')).then_some(text)
}
