//! Configurations (TC6 2.01, `instances`), and the tasks of an application of CODESYS.

use std::collections::BTreeSet;

use onescan_base::TimeSpan;
use onescan_base::duration::XmlDuration;

use super::super::page::Page;
use super::super::{Refused, Written};
use super::markup::{data, escaped};
use super::value::{expression, initial};
use super::{types, variables};
use onescan_iec::syntax::ast::{
    AccessDirection, AccessPath, Configuration, InstanceValue, ProgramDeclaration, Resource, TaskDeclaration,
};

/// The name of the only resource of a configuration without any.
const RESOURCE: &str = "Application";

/// A task that calls programs, as CODESYS has them: a program is called by its name, and has no instances.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Cycle {
    pub(crate) name: String,
    pub(crate) interval: TimeSpan,
    pub(crate) priority: u32,
    pub(crate) programs: Vec<String>,
}

/// The tasks of the application, as an addition to the project.
pub(super) fn application(cycles: &[Cycle]) -> String {
    let call = |name: &String| format!("<pouInstance name=\"{}\" typeName=\"\"/>\n", escaped(name));
    let task = |cycle: &Cycle| {
        format!(
            "<task name=\"{}\" interval=\"{}\" priority=\"{}\">\n{}</task>\n",
            escaped(&cycle.name),
            XmlDuration::from_nanos(cycle.interval.as_nanos()),
            cycle.priority,
            cycle.programs.iter().map(call).collect::<String>()
        )
    };
    let tasks: String = cycles.iter().map(task).collect();
    data("application", &format!("<resource name=\"{RESOURCE}\">\n{tasks}</resource>\n"))
}

/// `<configuration>`
pub(super) fn configuration(configuration: &Configuration, page: &Page<'_>) -> Written {
    let mut programs = BTreeSet::new();
    for program in configuration.resources.iter().flat_map(|resource| &resource.programs) {
        if !programs.insert(program.program.key()) {
            return Err(Refused::plcopen(program.span, "a second instance of a program"));
        }
    }
    let resources = configuration.resources.iter().map(|each| resource(each, page)).collect::<Written<String>>()?;
    let globals = variables::sections(&configuration.sections, page)?;
    let access = list("accessVars", &configuration.access, |each| access(each, page))?;
    let values = list("configVars", &configuration.instances, |each| instance_value(each, page))?;
    let name = escaped(&configuration.name.text);
    Ok(format!("<configuration name=\"{name}\">\n{resources}{globals}{access}{values}</configuration>\n"))
}

fn list<T>(element: &str, items: &[T], each: impl Fn(&T) -> Written) -> Written {
    if items.is_empty() {
        return Ok(String::new());
    }
    let items = items.iter().map(each).collect::<Written<String>>()?;
    Ok(format!("<{element}>\n{items}</{element}>\n"))
}

/// Tasks with the programs that they run, then those that run without one.
fn resource(resource: &Resource, page: &Page<'_>) -> Written {
    let with_programs = |declared: &TaskDeclaration| {
        let is_its =
            |program: &&ProgramDeclaration| program.task.as_ref().is_some_and(|task| task.key() == declared.name.key());
        let programs = resource.programs.iter().filter(is_its).map(program).collect::<Written<String>>()?;
        Ok(format!("<task{}>\n{programs}</task>\n", task(declared, page)))
    };
    let tasks = resource.tasks.iter().map(with_programs).collect::<Written<String>>()?;
    let alone = resource.programs.iter().filter(|program| program.task.is_none());
    let alone = alone.map(program).collect::<Written<String>>()?;
    let globals = variables::sections(&resource.sections, page)?;
    let name = resource.name.as_ref().map_or(RESOURCE, |(name, _)| name.text.as_str());
    Ok(format!("<resource name=\"{}\">\n{tasks}{globals}{alone}</resource>\n", escaped(name)))
}

/// The attributes of a task. Its priority must be given; 0 is what it has without one.
fn task(task: &TaskDeclaration, page: &Page<'_>) -> String {
    let input = |wanted: &str| task.inputs.iter().find(|(name, _)| name.key() == wanted);
    let attribute = |wanted: &str, name: &str| {
        let given = input(wanted).map(|(_, value)| escaped(&expression(value, page)));
        given.map(|given| format!(" {name}=\"{given}\"")).unwrap_or_default()
    };
    let priority =
        if input("PRIORITY").is_none() { " priority=\"0\"".to_owned() } else { attribute("PRIORITY", "priority") };
    let (single, interval) = (attribute("SINGLE", "single"), attribute("INTERVAL", "interval"));
    format!(" name=\"{}\"{single}{interval}{priority}", escaped(&task.name.text))
}

fn program(program: &ProgramDeclaration) -> Written {
    if program.qualifier.is_some() {
        return Err(Refused::plcopen(program.span, "RETAIN of a program"));
    }
    if !program.connections.is_empty() {
        return Err(Refused::plcopen(program.span, "what a program's variables are connected to"));
    }
    let (name, of) = (escaped(&program.name.text), escaped(&program.program.text));
    Ok(format!("<pouInstance name=\"{name}\" typeName=\"{of}\"/>\n"))
}

fn access(access: &AccessPath, page: &Page<'_>) -> Written {
    let (alias, path) = (escaped(&access.name.text), escaped(&expression(&access.path, page)));
    let direction = match access.direction {
        AccessDirection::ReadOnly => "readOnly",
        AccessDirection::ReadWrite => "readWrite",
    };
    let ty = types::type_of(&access.spec, page)?;
    Ok(format!(
        "<accessVariable alias=\"{alias}\" instancePathAndName=\"{path}\" direction=\"{direction}\"><type>{ty}</type></accessVariable>\n"
    ))
}

fn instance_value(value: &InstanceValue, page: &Page<'_>) -> Written {
    let path = escaped(&expression(&value.path, page));
    let address = value.address.as_ref().map(|address| format!(" address=\"{}\"", escaped(&address.text)));
    let (ty, initial) = (types::type_of(&value.spec, page)?, initial(value.initial.as_ref(), page)?);
    let address = address.unwrap_or_default();
    Ok(format!("<configVariable instancePathAndName=\"{path}\"{address}><type>{ty}</type>{initial}</configVariable>\n"))
}
