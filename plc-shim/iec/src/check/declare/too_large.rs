//! More memory than there is: one finding, which names the greatest variables.

use super::Declarations;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{MemoryLimit, Storage};
use crate::syntax::Span;
use crate::syntax::ast::{self, SectionKind};

/// So many variables are named.
const NAMED: usize = 4;

impl Declarations<'_> {
    /// How much all variables may take.
    pub(in crate::check) fn memory_limit(&self) -> u64 {
        u64::from(self.memory_limit.bytes())
    }

    /// Reports what does not fit, and how large it is. The first reports it; what comes behind it does not fit either.
    pub(in crate::check) fn report_too_large(&mut self, span: Span, size: Option<u64>) {
        self.too_large.push((span, size));
        if !self.findings.has(Code::TooLarge) {
            let message = format!("the variables take more than {}", self.memory_limit);
            self.report(Diagnostic::error(Code::TooLarge, span, message));
        }
    }

    /// Says which variables are the greatest, when all are known.
    pub(in crate::check) fn explain_too_large(&mut self) {
        if self.too_large.is_empty() {
            return;
        }
        let mut all = self.sizes();
        // What is small is of no help.
        all.retain(|(size, _)| size.saturating_mul(100) >= self.memory_limit());
        all.sort_by(|left, right| right.0.cmp(&left.0).then_with(|| left.1.cmp(&right.1)));
        all.dedup();
        let named = all.iter().take(NAMED).map(|(size, name)| format!("`{name}` with {}", in_mib(*size)));
        let named: Vec<String> = named.collect();
        let greatest = match named.as_slice() {
            [] => String::new(),
            [one] => format!("the greatest is {one}; "),
            several => format!("the greatest are {}; ", several.join(", ")),
        };
        let most = MemoryLimit::GREATEST_MIB;
        let raise =
            format!("`memory_limit_mib` of the PLC in scenario.toml and `--memory-limit` set it, to {most} at most");
        self.findings.set_help(Code::TooLarge, &format!("{greatest}{raise}"));
    }

    /// What variables take that have a place of their own, and what those would that have found none.
    fn sizes(&self) -> Vec<(u64, String)> {
        let size = |ty| u64::from(self.types.size(ty));
        let globals = self.globals.values().filter_map(|entry| {
            let variable = entry.variable.as_ref()?;
            Some((size(variable.ty), entry.name.clone()))
        });
        let units = self.unit_ids().filter(|id| !self.is_library(*id));
        let own = units.filter_map(|id| Some((id, self.pou(id).scope.as_ref()?))).flat_map(|(id, scope)| {
            let placed = |storage| matches!(storage, Storage::Instance(_) | Storage::Absolute(_));
            let variables = scope.variables().iter();
            let variables = variables.filter(move |each| placed(each.storage) && each.section != SectionKind::External);
            let variables = variables.filter(move |each| each.owner.is_none_or(|owner| owner == id));
            variables.map(move |each| (size(each.ty), format!("{}.{}", self.display_name(id), each.name)))
        });
        let refused = self.too_large.iter();
        let refused = refused.filter_map(|(span, size)| Some(((*size)?, self.declared_around(*span)?)));
        globals.chain(own).chain(refused).collect()
    }

    /// The variable or type whose declaration a place is part of.
    fn declared_around(&self, place: Span) -> Option<String> {
        let holds = |span: Span| span.file == place.file && span.start <= place.start && place.end <= span.end;
        let is_of = |ast: &ast::Variable| ast.names.iter().any(|name| holds(name.span)) || holds(ast.spec.span);
        let global = self
            .globals
            .values()
            .find(|entry| holds(entry.span) || entry.ast.is_some_and(|(ast, _)| holds(ast.spec.span)));
        if let Some(entry) = global {
            return Some(entry.name.clone());
        }
        for id in self.unit_ids() {
            let ast = self.pou(id).ast;
            let variable = ast.sections.iter().flat_map(|section| &section.variables).find(|each| is_of(each));
            let name = variable
                .and_then(|each| each.names.iter().find(|name| holds(name.span)).or_else(|| each.names.first()));
            if let Some(name) = name {
                return Some(format!("{}.{}", self.display_name(id), name.text));
            }
        }
        let ty = self.type_names.values().find(|entry| holds(entry.ast.span));
        ty.map(|entry| entry.ast.name.text.clone())
    }
}

/// `38.1 MiB`, rounded up: nothing that does not fit is 0.
fn in_mib(bytes: u64) -> String {
    let tenths = bytes.saturating_mul(10).div_ceil(1 << 20);
    format!("{}.{} MiB", tenths / 10, tenths % 10)
}

#[cfg(test)]
mod tests {
    use super::in_mib;

    #[test]
    fn sizes_are_rounded_up() {
        assert_eq!([0, 1, 1 << 20, 40_000_001].map(in_mib), ["0.0 MiB", "0.1 MiB", "1.0 MiB", "38.2 MiB"]);
    }
}
