//! W0714: attributes by which the vendor's tool gives variables other values, and which have no effect here.

use super::Unit;
use crate::diagnostic::{Code, Diagnostic};
use crate::dialect::Dialect;
use crate::front::Front;
use crate::source::Span;
use crate::syntax::lexer::tokenize_in;
use crate::syntax::pragma::{attribute, is_packing};
use crate::syntax::token::TokenKind;

/// Attributes of CODESYS and TwinCAT, each with what is otherwise here.
const EFFECTS: &[(&str, &str)] = &[
    ("call_after_global_init_slot", "nothing calls what it stands before: call it in the first scan"),
    ("call_on_type_change", "nothing calls the method that it stands before"),
    ("global_init_slot", "initial values are computed in the order of the files"),
    ("init_on_onlchange", "nothing is changed while a program runs"),
    ("initialize_on_call", "the input keeps the value of the call before"),
    ("is_connected", "the variable stays FALSE"),
    ("no_init", "the variable begins with its initial value"),
    ("no-init", "the variable begins with its initial value"),
    ("noinit", "the variable begins with its initial value"),
    ("parameterstringof", "the variable keeps its initial value"),
];

pub(super) fn lint(front: &Front, findings: &mut Vec<Diagnostic>) {
    for (id, file) in front.sources.iter() {
        let has_attributes = matches!(file.dialect(), Dialect::Codesys | Dialect::TwinCat);
        if front.library.contains(&id) || !has_attributes || !file.text().contains('{') {
            continue;
        }
        for token in
            tokenize_in(file.dialect(), file.text()).into_iter().filter(|token| token.kind == TokenKind::Pragma)
        {
            let span = Span { file: id, start: token.start, end: token.end };
            if let Some((name, otherwise)) = effect(front.sources.text(span)) {
                let message = format!("the attribute '{name}' has no effect here");
                findings.push(Diagnostic::warning(Code::AttributeWithoutEffect, span, message).with_help(otherwise));
            }
        }
    }
}

/// Methods that are to run after the start of a block which does not say so: the tools want the attribute at both.
pub(super) fn lint_methods(unit: &Unit<'_>, units: &[Unit<'_>], findings: &mut Vec<Diagnostic>) {
    let object = &unit.pou.object;
    let own = unit.pou.name.key();
    let is_extended = units.iter().any(|other| other.pou.object.extends.iter().any(|base| base.key() == own));
    // A base may have it, which is not looked at here, and what is derived as well.
    if object.call_after_init || !object.extends.is_empty() || is_extended {
        return;
    }
    for method in object.members.iter().map(|member| &member.pou).filter(|method| method.object.call_after_init) {
        let message = format!("nothing calls `{}` after the start", method.name.text);
        let help = format!("put `{{attribute 'call_after_init'}}` before `{}` as well", unit.pou.name.text);
        findings.push(Diagnostic::warning(Code::AttributeWithoutEffect, method.name.span, message).with_help(help));
    }
}

/// The attribute of `{attribute 'name' := 'value'}`, if it has an effect on values elsewhere, and what is otherwise here.
fn effect(pragma: &str) -> Option<(&'static str, &'static str)> {
    let inner = pragma.trim_matches(['{', '}']).trim();
    let attribute = attribute(inner)?;
    let name = attribute.strip_prefix('\'')?.split('\'').next()?;
    if name.eq_ignore_ascii_case("pack_mode") {
        return (!is_packing(inner))
            .then_some(("pack_mode", "give it '1', '2', '4' or '8', the most bytes that members are aligned to"));
    }
    EFFECTS.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_are_known_by_their_names() {
        assert_eq!(effect("{attribute 'global_init_slot' := '1'}").map(|(name, _)| name), Some("global_init_slot"));
        assert_eq!(effect("{ATTRIBUTE  'No_Init' }").map(|(name, _)| name), Some("no_init"));
        assert!(
            effect("{attribute 'pack_mode' := '1'}").is_none() && effect("{attribute 'pack_mode' := '3'}").is_some()
        );
        for none in ["{attribute 'hide'}", "{warning disable C0196}", "{attribute}", "{}", "{attribute 'to_string'}"] {
            assert!(effect(none).is_none(), "{none}");
        }
    }
}
