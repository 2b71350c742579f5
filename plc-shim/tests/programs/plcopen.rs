//! Projects in PLCopen XML, written short.

use std::fmt::Write;

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, TimeSpan, inspect};
use onescan_iec_run::Application;

use crate::rig::Rig;

/// A whole project around its units.
pub(crate) fn project(pous: &str) -> String {
    format!(
        "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<project xmlns=\"http://www.plcopen.org/xml/tc6_0201\">\n<types><dataTypes/>\
         <pous>\n{pous}</pous></types>\n<instances><configurations/></instances>\n</project>\n"
    )
}

/// The project as a tool writes it: `codesys`, `twincat`, `beremiz`, `openplc4`, or nobody that is known.
pub(crate) fn of_tool(tool: &str, text: &str) -> String {
    const TWICE: &str =
        "xmlns:ns1=\"http://www.plcopen.org/xml/tc6_0201\" xmlns:xsd=\"http://www.w3.org/2001/XMLSchema";
    let (more, name) = match tool {
        "codesys" => (String::new(), "CODESYS V3.5"),
        "twincat" => (String::new(), "TwinCAT PLC Control"),
        "beremiz" => (format!("{TWICE}\" "), "Unnamed"),
        "openplc4" => (format!("{TWICE}-instance\" "), "Unnamed"),
        _ => (String::new(), ""),
    };
    let header = format!("<fileHeader companyName=\"\" productName=\"{name}\"/>\n<types>");
    text.replacen("<project ", &format!("<project {more}"), 1).replacen("<types>", &header, 1)
}

/// `name : TYPE` for each variable of a section: `local a : BOOL, b : INT; in c : INT`.
pub(crate) fn interface(sections: &str) -> String {
    let mut text = String::from("<interface>");
    for section in sections.split(';').map(str::trim).filter(|section| !section.is_empty()) {
        let (kind, variables) = section.split_once(' ').expect("a section and its variables");
        if kind == "returns" {
            write!(text, "<returnType><{variables}/></returnType>").expect("a string");
            continue;
        }
        let element = match kind {
            "in" => "inputVars",
            "out" => "outputVars",
            "inout" => "inOutVars",
            _ => "localVars",
        };
        write!(text, "<{element}>").expect("a string");
        for variable in variables.split(',') {
            let (name, ty) = variable.split_once(':').expect("a name and a type");
            let (ty, initial) = ty.split_once('=').map_or((ty, None), |(ty, initial)| (ty, Some(initial.trim())));
            let (name, ty) = (name.trim(), ty.trim());
            let elementary = ["BOOL", "INT", "DINT", "REAL", "TIME", "WORD", "BYTE"].contains(&ty);
            let ty = if elementary { format!("<{ty}/>") } else { format!("<derived name=\"{ty}\"/>") };
            let initial = initial.map_or_else(String::new, |value| {
                format!("<initialValue><simpleValue value=\"{value}\"/></initialValue>")
            });
            write!(text, "<variable name=\"{name}\"><type>{ty}</type>{initial}</variable>").expect("a string");
        }
        write!(text, "</{element}>").expect("a string");
    }
    text + "</interface>"
}

/// A unit with a body in one language.
pub(crate) fn pou(kind: &str, name: &str, sections: &str, language: &str, body: &str) -> String {
    let interface = interface(sections);
    format!("<pou name=\"{name}\" pouType=\"{kind}\">{interface}<body><{language}>\n{body}</{language}></body></pou>\n")
}

/// `P` with a body in one language.
pub(crate) fn program(sections: &str, language: &str, body: &str) -> String {
    project(&pou("program", "P", sections, language, body))
}

/// A connection point where these elements' connections end; `5.Q` comes from output Q of element 5.
pub(crate) fn from(sources: &str) -> String {
    if sources.is_empty() {
        return String::new();
    }
    let mut text = String::from("<connectionPointIn>");
    for source in sources.split_whitespace() {
        let (id, pin) = source.split_once('.').unwrap_or((source, ""));
        let pin = if pin.is_empty() { String::new() } else { format!(" formalParameter=\"{pin}\"") };
        write!(text, "<connection refLocalId=\"{id}\"{pin}/>").expect("a string");
    }
    text + "</connectionPointIn>"
}

fn element(name: &str, id: u32, at: (u32, u32), attributes: &str, content: &str) -> String {
    let (x, y) = at;
    format!("<{name} localId=\"{id}\"{attributes}><position x=\"{x}\" y=\"{y}\"/>{content}</{name}>\n")
}

fn attributes(written: &str) -> String {
    if written.is_empty() { String::new() } else { format!(" {written}") }
}

pub(crate) fn rail(id: u32) -> String {
    element("leftPowerRail", id, (0, 0), "", "<connectionPointOut formalParameter=\"\"/>")
}

pub(crate) fn contact(id: u32, at: (u32, u32), left: &str, variable: &str, modifiers: &str) -> String {
    let content = format!("{}<connectionPointOut/><variable>{variable}</variable>", from(left));
    element("contact", id, at, &attributes(modifiers), &content)
}

pub(crate) fn coil(id: u32, at: (u32, u32), left: &str, variable: &str, modifiers: &str) -> String {
    let content = format!("{}<connectionPointOut/><variable>{variable}</variable>", from(left));
    element("coil", id, at, &attributes(modifiers), &content)
}

pub(crate) fn input(id: u32, at: (u32, u32), expression: &str) -> String {
    let content = format!("<connectionPointOut/><expression>{expression}</expression>");
    element("inVariable", id, at, "", &content)
}

pub(crate) fn output(id: u32, at: (u32, u32), left: &str, expression: &str, modifiers: &str) -> String {
    let content = format!("{}<expression>{expression}</expression>", from(left));
    element("outVariable", id, at, &attributes(modifiers), &content)
}

pub(crate) fn through(id: u32, at: (u32, u32), left: &str, expression: &str) -> String {
    let content = format!("{}<connectionPointOut/><expression>{expression}</expression>", from(left));
    element("inOutVariable", id, at, "", &content)
}

/// A block: `TON T1` with an instance, `ADD` without; inputs as `IN=3 PT=4.Q`, outputs as `Q ET`.
pub(crate) fn block(id: u32, at: (u32, u32), callee: &str, inputs: &str, outputs: &str, modifiers: &str) -> String {
    let (name, instance) = callee.split_once(' ').map_or((callee, None), |(name, instance)| (name, Some(instance)));
    let instance = instance.map_or_else(String::new, |instance| format!(" instanceName=\"{instance}\""));
    let mut content = String::from("<inputVariables>");
    for pin in inputs.split_whitespace() {
        let (pin, sources) = pin.split_once('=').expect("a pin and its sources");
        let (pin, negated) = pin.strip_prefix('!').map_or((pin, ""), |pin| (pin, " negated=\"true\""));
        let (pin, edge) = pin.strip_prefix('>').map_or((pin, ""), |pin| (pin, " edge=\"rising\""));
        let point = from(&sources.replace('|', " "));
        write!(content, "<variable formalParameter=\"{pin}\"{negated}{edge}>{point}</variable>").expect("a string");
    }
    content += "</inputVariables><inOutVariables/><outputVariables>";
    for pin in outputs.split_whitespace() {
        let (pin, negated) = pin.strip_prefix('!').map_or((pin, ""), |pin| (pin, " negated=\"true\""));
        write!(content, "<variable formalParameter=\"{pin}\"{negated}><connectionPointOut/></variable>")
            .expect("a string");
    }
    content += "</outputVariables>";
    let attributes = format!(" typeName=\"{name}\"{instance}{}", attributes(modifiers));
    element("block", id, at, &attributes, &content)
}

pub(crate) fn label(id: u32, at: (u32, u32), name: &str) -> String {
    element("label", id, at, &format!(" label=\"{name}\""), "")
}

pub(crate) fn jump(id: u32, at: (u32, u32), left: &str, name: &str) -> String {
    element("jump", id, at, &format!(" label=\"{name}\""), &from(left))
}

pub(crate) fn leave(id: u32, at: (u32, u32), left: &str) -> String {
    element("return", id, at, "", &from(left))
}

fn read(text: &str) -> Input {
    Input::from_text("p.xml", SourceKind::PlcOpen, text)
}

/// The program text that is made of a project.
pub(crate) fn made_of(text: &str) -> String {
    read(text).file().text().to_string()
}

pub(crate) fn findings(text: &str) -> String {
    inspect([read(text)], None).to_string()
}

/// All programs in one task of 10 ms.
pub(crate) fn rig(text: &str) -> Rig {
    let application = match Application::from_inputs([read(text)]) {
        Ok(application) => application,
        Err(diagnostics) => panic!("{diagnostics}\n{}", made_of(text)),
    };
    let plan = application.single_task(TimeSpan::millis::<10>());
    Rig::with_plan(&application, &plan)
}
