//! The objects of a TwinCAT 3 project. A declaration and its statements are parts of an XML file of
//! their own; together, and with the end that the format leaves out, they are program text.

use std::ops::Range;

use super::Taken;
use super::xml::{Element, Node, XmlError, parse};
use crate::diagnostic::Code;
use crate::dialect::Dialect;
use crate::syntax::token::{Keyword, TokenKind};
use crate::syntax::tokenize;

/// Program text of a `.TcPOU`, `.TcDUT`, `.TcGVL`, `.TcIO` or `.TcTTO`.
pub(super) fn extract(file: &str) -> Result<Taken, XmlError> {
    let root = parse(file)?;
    let mut taken = Taken { dialect: Dialect::TwinCat, ..Taken::default() };
    if root.name != "TcPlcObject" {
        taken.report(root.open.clone(), Code::MalformedXml, "`<TcPlcObject>` is wanted here");
        return Ok(taken);
    }
    for object in root.elements() {
        match object.name.as_str() {
            "POU" => pou(&mut taken, file, object),
            "DUT" | "GVL" => declaration(&mut taken, file, object),
            "Task" => super::twincat_task::task(&mut taken, file, object),
            "Itf" => taken.unsupported(place(object), &described("INTERFACE", object)),
            _ => taken.unsupported(place(object), &described(&object.name, object)),
        }
    }
    Ok(taken)
}

fn pou(taken: &mut Taken, file: &str, object: &Element) {
    let start = taken.extract.text().len();
    declaration(taken, file, object);
    let end = taken.extract.text().get(start..).and_then(end_of_unit);
    if let Some(implementation) = object.child("Implementation") {
        body(taken, file, implementation);
    }
    if let Some(end) = end {
        let close = object.child("Implementation").unwrap_or(object).close.clone();
        taken.extract.instead(end.text(), close.clone());
        taken.extract.instead("\n", close);
    }
    for part in object.elements() {
        match part.name.as_str() {
            "Method" | "Property" | "Action" | "Transition" => {
                taken.unsupported(place(part), &described(&part.name.to_uppercase(), part));
            }
            _ => {}
        }
    }
}

fn declaration(taken: &mut Taken, file: &str, object: &Element) {
    let Some(declaration) = object.child("Declaration") else {
        let message = format!("{} has no `<Declaration>`", described(&object.name, object));
        taken.report(place(object), Code::MalformedXml, &message);
        return;
    };
    taken.text_of(file, declaration);
    taken.extract.instead("\n", declaration.close.clone());
}

fn body(taken: &mut Taken, file: &str, implementation: &Element) {
    for language in implementation.elements() {
        match language.name.as_str() {
            "ST" => {
                taken.text_of(file, language);
                taken.extract.instead("\n", language.close.clone());
            }
            other => taken.unsupported(language.open.clone(), &format!("a body in {other}")),
        }
    }
}

/// The keyword that ends the unit which `declaration` begins.
fn end_of_unit(declaration: &str) -> Option<Keyword> {
    let tokens = tokenize(declaration);
    let first = tokens.into_iter().find(|token| !token.kind.is_trivia())?;
    Some(match first.kind {
        TokenKind::Keyword(Keyword::Program) => Keyword::EndProgram,
        TokenKind::Keyword(Keyword::FunctionBlock) => Keyword::EndFunctionBlock,
        TokenKind::Keyword(Keyword::Function) => Keyword::EndFunction,
        _ => return None,
    })
}

fn described(kind: &str, object: &Element) -> String {
    object.attribute("Name").map_or_else(|| kind.to_owned(), |name| format!("{kind} `{}`", name.value))
}

/// Where an object is best pointed at: its name in its declaration, or its tag.
fn place(object: &Element) -> Range<u32> {
    let text = |element: &Element| match element.children.as_slice() {
        [Node::Verbatim(span), ..] => Some(span.start..span.start),
        _ => None,
    };
    let named = object.attribute("Name").map(|name| name.span.clone());
    named.or_else(|| object.child("Declaration").and_then(text)).unwrap_or_else(|| object.open.clone())
}

#[cfg(test)]
mod tests {
    use crate::input::Input;
    use crate::input::kind::SourceKind;

    const POU: &str = r#"<?xml version="1.0" encoding="utf-8"?>
<TcPlcObject Version="1.1.0.1">
  <POU Name="FB_Ramp" Id="{0}" SpecialFunc="None">
    <Declaration><![CDATA[{attribute 'x'}
FUNCTION_BLOCK FB_Ramp
VAR_INPUT up : BOOL; END_VAR
VAR_OUTPUT level : INT; END_VAR]]></Declaration>
    <Implementation>
      <ST><![CDATA[IF up THEN level := level + 1; END_IF]]></ST>
    </Implementation>
    <Method Name="Reset"><Declaration><![CDATA[METHOD Reset]]></Declaration></Method>
  </POU>
</TcPlcObject>"#;

    #[test]
    fn a_unit_is_its_declaration_its_statements_and_its_end() {
        let input = Input::from_text("FB_Ramp.TcPOU", SourceKind::TwinCat, POU);
        insta::assert_snapshot!(input.file().text(), @r"
        {attribute 'x'}
        FUNCTION_BLOCK FB_Ramp
        VAR_INPUT up : BOOL; END_VAR
        VAR_OUTPUT level : INT; END_VAR
        IF up THEN level := level + 1; END_IF
        END_FUNCTION_BLOCK
        ");
    }

    #[test]
    fn what_is_left_out_is_told() {
        let input = Input::from_text("FB_Ramp.TcPOU", SourceKind::TwinCat, POU);
        let [found] = input.diagnostics.as_slice() else { panic!("{:?}", input.diagnostics) };
        assert_eq!(found.message, "METHOD `Reset` is not supported yet");
        let range = input.file().shown_range(found.span.start, found.span.end);
        assert_eq!(&POU[range.start as usize..range.end as usize], "Reset");
    }
}
