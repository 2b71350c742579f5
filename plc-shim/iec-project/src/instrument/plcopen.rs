//! The shim in a project of PLCopen XML (TC6 2.01): its units and variables become elements of the project.
//!
//! A body in ST gets header and footer in its text. Any other body stays as it is, to the byte, and becomes the
//! action `SDSP_Body`, which a body in ST calls for a grant: so no network is drawn again, positions and ids stay,
//! and a RETURN in it ends the action, not the controller.

use std::ops::Range;

use onescan_base::duration::XmlDuration;
use onescan_xml::Element;

use super::controller;
use super::marks;
use super::plcopen_unit as unit;
use super::sources::Sources;
use super::tasks::{TaskTable, literal};
use super::template::{self, Controller, Number};
use onescan_iec::input::plcopen_instances;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::SourceFile;
use onescan_iec::syntax::ast::{Pou, PouKind};

/// The action that a body becomes which is not text.
const ACTION: &str = "SDSP_Body";

/// The file as a tree; it has been read once already.
pub(super) fn tree(file: &SourceFile) -> Option<Element> {
    onescan_xml::parse(file.shown_text()).ok()
}

/// Every element of this name.
fn all<'e>(root: &'e Element, name: &str) -> Vec<&'e Element> {
    let mut found = Vec::new();
    let mut open = vec![root];
    while let Some(element) = open.pop() {
        if element.name == name {
            found.push(element);
        }
        open.extend(element.elements());
    }
    found.sort_by_key(|element| element.open.start);
    found
}

fn is_named(element: &Element, name: &str) -> bool {
    element.attribute("name").is_some_and(|found| found.value.eq_ignore_ascii_case(name))
}

/// The end of the tag around `at`.
pub(super) fn tag_end(text: &str, at: u32) -> u32 {
    let rest = text.get(at as usize..).unwrap_or("");
    // `at` stands in a value: the quote that ends it comes first.
    rest.find(['"', '\''])
        .and_then(|quote| Some(quote + rest.get(quote..)?.find('>')?))
        .map_or(at, |end| at + end as u32 + 1)
}

/// Puts `new` in the place of a name. In the project's own text it is marked there, in a tag behind the tag; what
/// stands for an element as a whole is its block's own name.
pub(super) fn rename(file: &SourceFile, span: Range<u32>, name: &str, new: &str, edits: &mut Edits) {
    let at = file.shown_range(span.start, span.end);
    if file.origin().is_some_and(|origin| origin.is_verbatim(span.start)) {
        return edits.replace(at, marks::renamed(new, name));
    }
    let text = file.shown_text();
    if text.get(at.start as usize..at.end as usize) == Some(name) {
        edits.insert(tag_end(text, at.end), marks::renamed_before(name));
        edits.replace(at, new);
    }
}

/// Renames the types of blocks, which no declaration names in the program text.
pub(super) fn rename_blocks(root: &Element, text: &str, new: &dyn Fn(&str) -> Option<String>, edits: &mut Edits) {
    for block in all(root, "block") {
        let Some(name) = block.attribute("typeName") else { continue };
        if let Some(new) = new(&name.value) {
            edits.insert(tag_end(text, name.span.end), marks::renamed_before(&name.value));
            edits.replace(name.span.clone(), new);
        }
    }
}

/// Lines in front of `at`, and nothing else.
pub(super) fn insert(text: &str, at: u32, xml: &str, edits: &mut Edits) {
    edits.insert(at, marks::xml_lines(xml, marks::line_break(text)));
}

/// Lines at the end of an element's content.
pub(super) fn append(text: &str, element: &Element, xml: &str, edits: &mut Edits) {
    if element.open != element.close {
        return insert(text, element.close.start, xml, edits);
    }
    let tag = text.get(element.open.start as usize..element.open.end as usize).unwrap_or("");
    let opening = tag.trim_end_matches('>').trim_end().trim_end_matches('/').trim_end();
    let name = opening.trim_start_matches('<').split_whitespace().next().unwrap_or("");
    let whole = format!("{opening}>\n{xml}</{name}>");
    edits.insert(element.open.start, marks::xml_lines(&whole, marks::line_break(text)));
    edits.replace(element.open.clone(), marks::cut(tag));
}

/// Takes out declarations that CODESYS keeps as text beside their elements: it would read that text, not the elements,
/// and so not what is put in there.
pub(super) fn cut_plain_text(root: &Element, text: &str, edits: &mut Edits) {
    let is_plain_text = |data: &&&Element| {
        let name = data.attribute("name").map_or("", |name| name.value.as_str());
        name.rsplit('/').next().is_some_and(|kind| kind.eq_ignore_ascii_case("interfaceasplaintext"))
    };
    for data in all(root, "data").iter().filter(is_plain_text) {
        let at = data.open.start..data.close.end;
        let written = text.get(at.start as usize..at.end as usize).unwrap_or("");
        edits.replace(at, marks::cut(written));
    }
}

/// What cannot be done with a project.
pub(super) type Refused = &'static str;

/// The element of a unit.
pub(super) fn element<'e>(pou: &Pou, root: &'e Element) -> Result<&'e Element, Refused> {
    let kind = if pou.kind == PouKind::Program { "program" } else { "functionBlock" };
    let is_it = |element: &&Element| {
        is_named(element, &pou.name.text) && element.attribute("pouType").is_some_and(|found| found.value == kind)
    };
    all(root, "pou").into_iter().find(is_it).ok_or("this program has no element of its own")
}

/// Puts variables into the interface of a unit.
pub(super) fn declare(pou: &Element, declared: &str, text: &str, edits: &mut Edits) {
    let Some(interface) = pou.child("interface") else {
        return insert(text, pou.open.end, &format!("<interface>\n{declared}</interface>\n"), edits);
    };
    let remarks = interface.elements().find(|inner| matches!(inner.name.as_str(), "addData" | "documentation"));
    match remarks {
        Some(first) => insert(text, first.open.start, declared, edits),
        None => append(text, interface, declared, edits),
    }
}

/// The execution controller of a program.
pub(super) fn control(
    pou: &Pou,
    number: Number,
    line: &str,
    (file, root): (&SourceFile, &Element),
    edits: &mut Edits,
) -> Result<(), Refused> {
    let element = element(pou, root)?;
    let text = file.shown_text();
    let controller = template::controller(number, line);
    let Some(declared) = unit::declarations(&controller.declarations) else {
        return Err("its controller has no form in PLCopen XML");
    };
    declare(element, &declared, text, edits);
    let bodies: Vec<&Element> = element.elements().filter(|inner| inner.name == "body").collect();
    let is_text = bodies.iter().any(|body| body.child("ST").is_some()) && !pou.body.is_empty();
    if is_text {
        controller::control_statements(pou, &controller, file, edits);
        return Ok(());
    }
    into_action(element, &bodies, &controller, text, edits)
}

/// Makes the body an action that the controller calls.
fn into_action(
    pou: &Element,
    bodies: &[&Element],
    controller: &Controller,
    text: &str,
    edits: &mut Edits,
) -> Result<(), Refused> {
    let call = if bodies.is_empty() { String::from("    ;") } else { format!("    {ACTION}();") };
    let statements = format!("{}\n{call}\n{}\n", controller.header, controller.footer);
    let own = unit::body(&statements);
    let (Some(first), Some(last)) = (bodies.first(), bodies.last()) else {
        let behind = pou.elements().filter(|inner| matches!(inner.name.as_str(), "interface" | "actions")).last();
        let at = behind.map_or(pou.open.end, |inner| inner.close.end);
        insert(text, at, &own, edits);
        return Ok(());
    };
    if pou.child("transitions").is_some_and(|list| list.elements().next().is_some()) {
        return Err("a unit with transitions is a chart, and this one has none");
    }
    match pou.child("actions") {
        Some(actions) if actions.open != actions.close => {
            let end = text.get(actions.close.start as usize..actions.close.end as usize).unwrap_or("");
            edits.replace(actions.close.clone(), marks::cut(end));
            insert(text, first.open.start, &format!("<action name=\"{ACTION}\">"), edits);
        }
        Some(actions) => {
            let tag = text.get(actions.open.start as usize..actions.open.end as usize).unwrap_or("");
            edits.replace(actions.open.clone(), marks::cut(tag));
            insert(text, first.open.start, &format!("<actions><action name=\"{ACTION}\">"), edits);
        }
        None => insert(text, first.open.start, &format!("<actions><action name=\"{ACTION}\">"), edits),
    }
    insert(text, last.close.end, &format!("</action></actions>\n{own}"), edits);
    Ok(())
}

/// Puts the shim's units, variables and task into the project.
pub(super) fn attach(
    root: &Element,
    text: &str,
    tasks: &TaskTable<'_>,
    sources: &Sources,
    edits: &mut Edits,
) -> Result<(), Refused> {
    let nothing = || "a unit of the shim has no form in PLCopen XML";
    let of = |texts: Vec<String>, form: fn(&str) -> Option<String>| -> Option<String> {
        texts.iter().map(|text| form(text)).collect()
    };
    let pous = of(sources.units(), unit::unit).ok_or_else(nothing)?;
    let types = of(sources.types(), unit::data_type).ok_or_else(nothing)?;
    let place = |list| root.child("types").and_then(|types| types.child(list));
    append(text, place("pous").ok_or("this project has no `<pous>`")?, &pous, edits);
    if !types.is_empty() {
        append(text, place("dataTypes").ok_or("this project has no `<dataTypes>`")?, &types, edits);
    }
    let globals = &sources.globals;
    match configuration(root) {
        Some(configuration) => configure(configuration, text, tasks, globals, edits),
        None => alone(root, text, globals, edits).ok_or_else(nothing),
    }
}

/// The configuration that runs programs.
pub(super) fn configuration(root: &Element) -> Option<&Element> {
    all(root, "configuration").into_iter().find(|each| !all(each, "pouInstance").is_empty())
}

/// Puts the scheduler's task into a configuration, and variables of the shim's.
pub(super) fn configure(
    configuration: &Element,
    text: &str,
    tasks: &TaskTable<'_>,
    globals: &str,
    edits: &mut Edits,
) -> Result<(), Refused> {
    let variables = unit::globals(globals, None).ok_or("a variable of the shim has no form in PLCopen XML")?;
    let behind = configuration.elements().filter(|inner| inner.name == "resource").last();
    let at = behind.map_or(configuration.open.end, |resource| resource.close.end);
    if !variables.is_empty() {
        insert(text, at, &variables, edits);
    }
    let resource = configuration.elements().find(|inner| !all(inner, "pouInstance").is_empty());
    if let Some(resource) = resource {
        insert(text, resource.open.end, &cycle(configuration, tasks), edits);
    }
    number(configuration, text, tasks, edits);
    Ok(())
}

/// Gives each of several instances of a program its number, by an initial value of its own (2nd ed. 2.7.1): the schema
/// has no connections of a program's variables.
fn number(configuration: &Element, text: &str, tasks: &TaskTable<'_>, edits: &mut Edits) {
    let mut values = String::new();
    for resource in configuration.elements().filter(|inner| inner.name == "resource") {
        for instance in all(resource, "pouInstance") {
            let path = [resource, instance].map(|each| plcopen_instances::name_of(each).unwrap_or_default()).join(".");
            let Some(number) = tasks.number_of_instance(&path) else { continue };
            values += &unit::instance_number(&path, number);
        }
    }
    if values.is_empty() {
        return;
    }
    if let Some(list) = configuration.child("configVars") {
        let remarks = list.elements().find(|inner| inner.name != "configVariable");
        return match remarks {
            Some(first) => insert(text, first.open.start, &values, edits),
            None => append(text, list, &values, edits),
        };
    }
    let list = format!("<configVars>\n{values}</configVars>\n");
    let before = |inner: &&Element| matches!(inner.name.as_str(), "resource" | "globalVars" | "accessVars");
    let at = configuration.elements().filter(before).last().map_or(configuration.open.end, |inner| inner.close.end);
    insert(text, at, &list, edits);
}

/// Variables of a project that has no tasks: CODESYS' own list, or a configuration of the standard's.
fn alone(root: &Element, text: &str, globals: &str, edits: &mut Edits) -> Option<()> {
    if text.contains("3s-software.com/plcopenxml/") {
        let list = unit::globals(globals, Some("SDSP"))?;
        let name = "http://www.3s-software.com/plcopenxml/globalvars";
        let data = format!("<data name=\"{name}\" handleUnknown=\"implementation\">\n{list}</data>\n");
        match root.child("addData") {
            Some(place) => append(text, place, &data, edits),
            None => append(text, root, &format!("<addData>\n{data}</addData>\n"), edits),
        }
        return Some(());
    }
    let variables = unit::globals(globals, None)?;
    let own = format!("<configuration name=\"SDSP\">\n{variables}</configuration>\n");
    match root.child("instances").map(|instances| (instances, instances.child("configurations"))) {
        Some((_, Some(place))) => append(text, place, &own, edits),
        Some((instances, None)) => {
            append(text, instances, &format!("<configurations>\n{own}</configurations>\n"), edits);
        }
        None => {
            let own = format!("<instances><configurations>\n{own}</configurations></instances>\n");
            match root.child("types") {
                Some(types) => insert(text, types.close.end, &own, edits),
                None => append(text, root, &own, edits),
            }
        }
    }
    Some(())
}

/// The scheduler's task, its interval written as the others are.
fn cycle(configuration: &Element, tasks: &TaskTable<'_>) -> String {
    let is_schema = |task: &&Element| task.attribute("interval").is_some_and(|found| found.value.starts_with("PT"));
    let interval = if all(configuration, "task").iter().any(is_schema) {
        XmlDuration::from_nanos(tasks.shortest.as_nanos()).to_string()
    } else {
        literal(tasks.shortest)
    };
    format!(
        "<task name=\"SDSP_Cycle\" priority=\"0\" interval=\"{interval}\">\n<pouInstance name=\"SDSP\" \
         typeName=\"SDSP_Scheduler\"/>\n</task>\n"
    )
}
