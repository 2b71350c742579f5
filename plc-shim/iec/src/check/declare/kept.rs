//! What methods keep in their instance (`VAR_INST`; CODESYS, TwinCAT).

use std::collections::BTreeMap;

use super::Declarations;
use crate::ir::{PouId, Variable};
use crate::syntax::Span;
use crate::syntax::ast::SectionKind;

/// What one method keeps in the instances of its unit.
#[derive(Debug)]
pub struct Kept {
    pub method: String,
    pub variables: Vec<Variable>,
}

impl Declarations<'_> {
    /// What methods keep, by the unit whose instances they keep it in, those of its bases included.
    pub(in crate::check) fn kept_by_methods(&self) -> BTreeMap<PouId, Vec<Kept>> {
        let kept = self.classes.keys().map(|id| (*id, self.kept_in(*id)));
        kept.filter(|(_, kept)| !kept.is_empty()).collect()
    }

    fn kept_in(&self, unit: PouId) -> Vec<Kept> {
        let (mut found, mut next): (Vec<Kept>, _) = (Vec::new(), Some(unit));
        while let Some(class) = next.and_then(|id| self.class(id)) {
            for method in class.members.values() {
                let pou = self.pou(*method);
                let (name, hidden) =
                    (&pou.ast.name.text, |kept: &Kept| kept.method.eq_ignore_ascii_case(&pou.ast.name.text));
                let variables = pou.scope.iter().flat_map(|scope| scope.variables());
                let own: Vec<_> = variables.filter(|each| each.section == SectionKind::Instance).cloned().collect();
                if !own.is_empty() && !found.iter().any(hidden) {
                    found.push(Kept { method: name.clone(), variables: own });
                }
            }
            next = class.base;
        }
        found
    }
}

pub(in crate::check) fn place_of(span: Span) -> (u32, u32) {
    (span.file.0, span.start)
}
