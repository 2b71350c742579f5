//! TwinCAT's task files (`.TcTTO`): a task's cycle time, priority and the programs that it calls.
//!
//! Each file becomes a part of one configuration. A program has one instance, of its own name.

use onescan_xml::{Element, Node};

use super::Taken;
use crate::diagnostic::Code;

/// Name of the configuration that a project's tasks make up.
const CONFIGURATION: &str = "TwinCAT";

/// Program text of a task.
pub(super) fn task(taken: &mut Taken, file: &str, element: &Element) {
    let Some(name) = element.attribute("Name") else {
        taken.report(element.open.clone(), Code::MalformedXml, "`<Task>` has no attribute `Name`");
        return;
    };
    write(taken, &format!("CONFIGURATION {CONFIGURATION}\nTASK {} (", name.value), element);
    let cycle = element.child("CycleTime");
    if let Some(cycle) = cycle {
        // Microseconds.
        write(taken, &format!("INTERVAL := T#{}us", text_in(file, cycle)), cycle);
    }
    if let Some(priority) = element.child("Priority") {
        let comma = if cycle.is_some() { ", " } else { "" };
        write(taken, &format!("{comma}PRIORITY := {}", text_in(file, priority)), priority);
    }
    write(taken, ");\n", element);
    for call in element.elements().filter(|inner| inner.name == "PouCall") {
        if let Some(program) = call.child("Name") {
            let program_name = text_in(file, program);
            if program_name.contains('.') {
                pass_over(taken, program_name, program);
                continue;
            }
            write(taken, &format!("PROGRAM {program_name} WITH {} : {program_name};\n", name.value), program);
        }
    }
    taken.extract.instead("END_CONFIGURATION\n", element.close.clone());
}

fn write(taken: &mut Taken, text: &str, at: &Element) {
    taken.extract.instead(text, at.open.clone());
}

/// A program of a library, as `VisuElems.Visu_Prg`, which draws the visualisation: it is not there, nor missed.
fn pass_over(taken: &mut Taken, name: &str, at: &Element) {
    let message = format!("the task calls `{name}` of a library, which is left out");
    let help = "it does not run here; a program of the project has no `.` in its name";
    taken.warn(at.open.clone(), Code::ProgramNeverRuns, &message, Some(help));
}

/// The text that an element holds, without blanks around it.
fn text_in<'f>(file: &'f str, element: &Element) -> &'f str {
    let text = element.children.iter().find_map(|node| match node {
        Node::Verbatim(span) => file.get(span.start as usize..span.end as usize),
        _ => None,
    });
    text.unwrap_or("").trim()
}

#[cfg(test)]
mod tests {
    use crate::input::Input;
    use crate::input::kind::SourceKind;

    const TASK: &str = r#"<?xml version="1.0" encoding="utf-8"?>
<TcPlcObject Version="1.1.0.1">
  <Task Name="PlcTask" Id="{0}">
    <!--CycleTime in micro seconds.-->
    <CycleTime>2500</CycleTime>
    <Priority>20</Priority>
    <PouCall><Name>MAIN</Name></PouCall>
    <PouCall><Name>Other</Name></PouCall>
    <TaskFBGuid>{1}</TaskFBGuid>
  </Task>
</TcPlcObject>"#;

    #[test]
    fn a_program_of_a_library_is_passed_over() {
        let text = TASK.replace("Other", "VisuElems.Visu_Prg");
        let input = Input::from_text("PlcTask.TcTTO", SourceKind::TwinCat, text);
        assert!(!input.file().text().contains("Visu"), "{}", input.file().text());
        let [found] = &input.diagnostics[..] else { panic!("{:?}", input.diagnostics) };
        assert_eq!(found.severity, crate::Severity::Warning);
        assert_eq!(found.message, "the task calls `VisuElems.Visu_Prg` of a library, which is left out");
    }

    #[test]
    fn a_task_is_a_part_of_a_configuration() {
        let input = Input::from_text("PlcTask.TcTTO", SourceKind::TwinCat, TASK);
        insta::assert_snapshot!(input.file().text(), @r"
        CONFIGURATION TwinCAT
        TASK PlcTask (INTERVAL := T#2500us, PRIORITY := 20);
        PROGRAM MAIN WITH PlcTask : MAIN;
        PROGRAM Other WITH PlcTask : Other;
        END_CONFIGURATION
        ");
        assert!(input.diagnostics.is_empty(), "{:?}", input.diagnostics);
    }
}
