//! PLCopen XML: configurations, resources, tasks and instances of programs (TC6 2.01, `instances`).

use onescan_base::duration::XmlDuration;
use onescan_xml::{Attribute, Element};

use super::plcopen::Writer;
use super::plcopen_addition::additions;
use crate::diagnostic::Code;
use crate::dialect::Dialect;

/// What an element of a configuration or resource may hold beside what is read.
const REMARKS: [&str; 2] = ["documentation", "addData"];

impl Writer<'_> {
    /// Of several devices of a CODESYS project, each with an application of its own, the first is read: the others are
    /// other PLCs.
    pub(super) fn leave_out_devices(&mut self, configurations: &[&Element]) {
        let is_of_vendor = matches!(self.tool.dialect(), Dialect::Codesys | Dialect::TwinCat);
        let mut devices = configurations.iter().filter(|each| is_of_vendor && runs(each));
        let Some(first) = devices.next().and_then(|first| first.attribute("name")) else { return };
        for device in devices {
            let name = device.attribute("name").map_or("", |name| name.value.as_str());
            let message = format!("`{name}` is another device beside `{}`: it is left out", first.value);
            let help = "to check it, export it to a file of its own";
            self.taken.warn(device.open.clone(), Code::SecondConfiguration, &message, Some(help));
            self.left_out.insert(device.open.start);
        }
    }

    pub(super) fn is_left_out(&self, element: &Element) -> bool {
        self.left_out.contains(&element.open.start)
    }

    /// A configuration; one without tasks and programs is its global variables alone.
    pub(super) fn configuration(&mut self, element: &Element) {
        if !runs(element) {
            self.globals(element);
            resources(element).for_each(|resource| self.globals_of_resource(resource));
            return;
        }
        self.write("CONFIGURATION ", &element.open);
        self.identifier(element, "name");
        self.write("\n", &element.open);
        for inner in element.elements() {
            match inner.name.as_str() {
                "resource" => self.resource(inner),
                "globalVars" => self.section(inner),
                "accessVars" => self.lines("VAR_ACCESS\n", inner, Self::access_variable),
                "configVars" => self.lines("VAR_CONFIG\n", inner, Self::instance_value),
                other if REMARKS.contains(&other) => {}
                _ => self.unread(inner),
            }
        }
        self.write("END_CONFIGURATION\n", &element.close);
    }

    /// The tasks of an application that CODESYS exports by itself: they stand in `addData`, and no configuration has any.
    pub(super) fn applications(&mut self, root: &Element, configurations: &[&Element]) {
        if configurations.iter().any(|each| runs(each)) {
            return;
        }
        let mut all = additions(root, "application").flat_map(|held| {
            let itself = (held.name == "resource").then_some(held);
            itself.into_iter().chain(resources(held))
        });
        let Some(first) = all.find(|resource| has_programs(resource)) else { return };
        self.write("CONFIGURATION Device\n", &first.open);
        self.resource(first);
        self.write("END_CONFIGURATION\n", &first.close);
    }

    fn globals_of_resource(&mut self, resource: &Element) {
        for section in resource.elements().filter(|inner| inner.name == "globalVars") {
            if !self.is_list(section) {
                self.section(section);
            }
        }
    }

    fn unread(&mut self, element: &Element) {
        self.taken.unsupported(element.open.clone(), &format!("`<{}>`", element.name));
    }

    /// An attribute that names something; what no name may hold becomes an underscore.
    fn identifier(&mut self, element: &Element, name: &str) {
        let Some(found) = element.attribute(name) else {
            self.attribute(element, name);
            return;
        };
        self.write(&plain(&found.value), &found.span);
    }

    fn lines(&mut self, keyword: &str, element: &Element, each: fn(&mut Self, &Element)) {
        self.write(keyword, &element.open);
        element.elements().filter(|inner| !REMARKS.contains(&inner.name.as_str())).for_each(|inner| each(self, inner));
        self.write("END_VAR\n", &element.close);
    }

    fn resource(&mut self, element: &Element) {
        self.write("RESOURCE ", &element.open);
        self.identifier(element, "name");
        self.write(" ON PLC\n", &element.open);
        for inner in element.elements() {
            match inner.name.as_str() {
                // A list stands outside: it has a name of its own.
                "globalVars" if self.is_list(inner) => {}
                "globalVars" => self.section(inner),
                "task" => self.task(inner),
                "pouInstance" => self.program_instance(inner, None),
                other if REMARKS.contains(&other) => {}
                _ => self.unread(inner),
            }
        }
        self.write("END_RESOURCE\n", &element.close);
    }

    fn task(&mut self, element: &Element) {
        self.write("TASK ", &element.open);
        self.identifier(element, "name");
        self.write(" (", &element.open);
        let given = [("single", "SINGLE"), ("interval", "INTERVAL"), ("priority", "PRIORITY")];
        let given = given.iter().filter_map(|(name, input)| Some((element.attribute(name)?, *input)));
        for (index, (value, input)) in given.filter(|(value, _)| !value.value.is_empty()).enumerate() {
            self.write(if index > 0 { ", " } else { "" }, &value.span);
            self.write(&format!("{input} := {}", duration(&value.value)), &value.span);
        }
        self.write(");\n", &element.open);
        for inner in element.elements() {
            match inner.name.as_str() {
                "pouInstance" => self.program_instance(inner, element.attribute("name")),
                other if REMARKS.contains(&other) => {}
                _ => self.unread(inner),
            }
        }
    }

    fn program_instance(&mut self, element: &Element, task: Option<&Attribute>) {
        self.write("PROGRAM ", &element.open);
        self.identifier(element, "name");
        if let Some(task) = task {
            self.write(&format!(" WITH {}", task.value), &element.open);
        }
        self.write(" : ", &element.open);
        // Older files name the type `type`.
        let program = ["typeName", "type"].into_iter().find(|name| element.attribute(name).is_some());
        match program.and_then(|name| element.attribute(name)) {
            // CODESYS has no instances: a task calls programs by their names.
            Some(program) if program.value.is_empty() => self.identifier(element, "name"),
            _ => self.attribute(element, program.unwrap_or("typeName")),
        }
        self.write(";\n", &element.close);
    }

    fn access_variable(&mut self, element: &Element) {
        self.write("    ", &element.open);
        self.attribute(element, "alias");
        self.write(" : ", &element.open);
        self.attribute(element, "instancePathAndName");
        self.write(" : ", &element.open);
        self.inner_type(element, "type");
        let writable = element.attribute("direction").is_some_and(|found| found.value == "readWrite");
        self.write(if writable { " READ_WRITE;\n" } else { " READ_ONLY;\n" }, &element.close);
    }

    fn instance_value(&mut self, element: &Element) {
        self.write("    ", &element.open);
        self.attribute(element, "instancePathAndName");
        self.address_and_type(element);
    }
}

fn resources(configuration: &Element) -> impl Iterator<Item = &Element> {
    configuration.elements().filter(|inner| inner.name == "resource")
}

/// True for a configuration with tasks or programs.
fn runs(configuration: &Element) -> bool {
    resources(configuration).any(has_programs)
}

fn has_programs(resource: &Element) -> bool {
    resource.elements().any(|inner| matches!(inner.name.as_str(), "task" | "pouInstance"))
}

/// What an element is called in program text.
pub fn name_of(element: &Element) -> Option<String> {
    element.attribute("name").map(|name| plain(&name.value))
}

fn plain(name: &str) -> String {
    name.chars().map(|one| if one.is_alphanumeric() { one } else { '_' }).collect()
}

/// A duration as XML Schema writes it, `PT0.02S` or as a time of the day, `00:00:00.02`, as the standard does;
/// anything else as it is.
fn duration(text: &str) -> String {
    let nanos = text.parse().ok().map(|duration: XmlDuration| duration.nanos()).or_else(|| clock_nanos(text));
    nanos.map_or_else(|| text.to_owned(), |nanos| format!("T#{nanos}ns"))
}

/// Nanoseconds from midnight to `hh:mm:ss.fff`, the form of intervals before TC6 2.01.
fn clock_nanos(text: &str) -> Option<u64> {
    let (hours, rest) = text.split_once(':')?;
    let (minutes, rest) = rest.split_once(':')?;
    let (seconds, fraction) = rest.split_once('.').unwrap_or((rest, "0"));
    let two = |digits: &str, below: u64| {
        let number = digits.bytes().all(|one| one.is_ascii_digit()).then(|| digits.parse::<u64>().ok()).flatten();
        number.filter(|number| digits.len() == 2 && *number < below)
    };
    let decimals = fraction.bytes().all(|one| one.is_ascii_digit()) && (1..=9).contains(&fraction.len());
    let nanos = decimals.then(|| format!("{fraction:0<9}").parse::<u64>().ok()).flatten()?;
    let whole = (two(hours, 24)? * 60 + two(minutes, 60)?) * 60 + two(seconds, 60)?;
    Some(whole * 1_000_000_000 + nanos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::Input;
    use crate::input::kind::SourceKind;

    #[test]
    fn durations_of_xml_become_those_of_the_standard() {
        for (written, meant) in [
            ("PT0.02S", "T#20000000ns"),
            ("PT1M30S", "T#90000000000ns"),
            ("PT0S", "T#0ns"),
            ("T#20ms", "T#20ms"),
            ("PTxS", "PTxS"),
            ("PT1D", "PT1D"),
            ("P1D", "P1D"),
            ("00:00:00.100000", "T#100000000ns"),
            ("01:02:03", "T#3723000000000ns"),
            ("00:00:60", "00:00:60"),
            ("0:00:01", "0:00:01"),
            ("00:00:00.", "00:00:00."),
        ] {
            assert_eq!(duration(written), meant);
        }
    }

    #[test]
    fn iec2_2_7_a_configuration_becomes_text() {
        let project = include_str!("../../../tests/inputs/line.xml");
        let input = Input::from_text("line.xml", SourceKind::PlcOpen, project);
        insta::assert_snapshot!(input.file().text());
        assert!(input.diagnostics.is_empty(), "{:?}", input.diagnostics);
    }

    #[test]
    fn tasks_of_codesys_call_programs_by_name() {
        let project = r#"<project><types><dataTypes/><pous><pou name="PLC_PRG" pouType="program"><body><ST><p>;</p></ST>
            </body></pou></pous></types><instances><configurations><configuration name="Device"><resource name="App">
            <task name="Main" interval="PT0.02S" priority="1"><pouInstance name="PLC_PRG" typeName=""/></task></resource>
            </configuration></configurations></instances></project>"#;
        let input = Input::from_text("app.xml", SourceKind::PlcOpen, project);
        assert!(input.file().text().contains("PROGRAM PLC_PRG WITH Main : PLC_PRG;"), "{}", input.file().text());
    }

    #[test]
    fn tasks_of_an_application_that_stands_alone_are_read() {
        let project = r#"<project><types><dataTypes/><pous/></types><instances><configurations/></instances><addData>
            <data name="http://www.3s-software.com/plcopenxml/application" handleUnknown="implementation">
            <resource name="Application"><task name="Main" interval="PT0.02S" priority="1">
            <pouInstance name="PLC_PRG" typeName=""/></task><addData>
            <data name="http://www.3s-software.com/plcopenxml/pou" handleUnknown="implementation">
            <pou name="PLC_PRG" pouType="program"><body><ST><p>;</p></ST></body></pou></data></addData></resource></data>
            </addData></project>"#;
        let input = Input::from_text("app.xml", SourceKind::PlcOpen, project);
        let text = input.file().text();
        assert!(text.contains("TASK Main (INTERVAL := T#20000000ns, PRIORITY := 1);"), "{text}");
        assert!(text.contains("PROGRAM PLC_PRG WITH Main : PLC_PRG;"), "{text}");
    }
}
