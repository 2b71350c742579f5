//! The interface of a unit or member (TC6 2.01, `interface`).

use super::super::Written;
use super::super::page::Page;
use super::markup::additions;
use super::types::type_of;
use super::variables;
use onescan_iec::syntax::ast::Pou;

/// `<interface>`: result, variables, and CODESYS' additions.
pub(super) fn interface(pou: &Pou, added: &str, page: &Page<'_>) -> Written {
    let result = match &pou.result {
        Some(result) => format!("<returnType>{}</returnType>\n", type_of(result, page)?),
        None => String::new(),
    };
    let sections = variables::sections(&pou.sections, page)?;
    Ok(format!("<interface>\n{result}{sections}{}</interface>\n", additions(added)))
}
