//! Lists of names: MatIEC crashes where one declaration has three or more instances.

use super::{Finding, Page};
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::ast::Variable;

/// One declaration for each name.
pub(super) fn split(page: &Page<'_>, edits: &mut Edits) -> Vec<Finding> {
    for (_, section) in page.sections() {
        for variable in &section.variables {
            let ([first, .., last], Some(rest)) = (variable.names.as_slice(), rest(page, variable)) else { continue };
            let names = variable.names.iter().take(variable.names.len() - 1);
            let mut one_by_one: String = names.map(|name| format!("{}{rest}; ", name.text)).collect();
            one_by_one.push_str(&last.text);
            edits.replace(first.span.start..last.span.end, one_by_one);
        }
    }
    Vec::new()
}

/// What stands behind the names, up to the semicolon.
fn rest<'t>(page: &Page<'t>, variable: &Variable) -> Option<&'t str> {
    let from = variable.names.last()?.span.end as usize;
    let known = variable.initial.as_ref().map_or(variable.spec.span.end, |initial| initial.span.end) as usize;
    let text: &'t str = page.file.text();
    let end = known + text.get(known..)?.find(';')?;
    text.get(from..end)
}
