//! What CODESYS adds to PLCopen XML in `addData`: lists with constants and variables, interfaces with a base.

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, TimeSpan};
use onescan_iec_run::Application;

use crate::plcopen::program;
use crate::rig::Rig;

const VENDOR: &str = "http://www.3s-software.com/plcopenxml/";

fn data(kind: &str, content: &str) -> String {
    format!("<data name=\"{VENDOR}{kind}\" handleUnknown=\"implementation\">{content}</data>")
}

fn rig(statements: &str, variables: &str, additions: &str) -> Rig {
    let body = format!("<xhtml xmlns=\"http://www.w3.org/1999/xhtml\">{statements}</xhtml>");
    let text = program(variables, "ST", &body);
    let text = text.replace("</project>", &format!("<addData>{additions}</addData></project>"));
    let input = Input::from_text("plc.xml", SourceKind::PlcOpen, text);
    let application = match Application::from_inputs([input]) {
        Ok(application) => application,
        Err(found) => panic!("{found}"),
    };
    Rig::with_plan(&application, &application.single_task(TimeSpan::millis::<10>()))
}

#[test]
fn a_list_has_constants_and_variables() {
    let variable = |name: &str, value: &str| {
        format!(
            "<variable name=\"{name}\"><type><INT/></type><initialValue><simpleValue value=\"{value}\"/></initialValue></variable>"
        )
    };
    let (most, index) = (variable("most", "10"), variable("index", "3"));
    let parts = format!(
        "<MixedAttrsVarList><globalVars name=\"Lists\" constant=\"true\">{most}</globalVars>\
         <globalVars name=\"Lists\">{index}</globalVars></MixedAttrsVarList>"
    );
    let parts = data("mixedattrsvarlist", &parts);
    // The whole list says `constant`, as its first section does.
    let list =
        format!("<globalVars name=\"Lists\" constant=\"true\">{most}{index}<addData>{parts}</addData></globalVars>");
    let mut rig =
        rig("Lists.index := Lists.index + Lists.most; r := index;", "local r : INT", &data("globalvars", &list));
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.r"), 13);
}

#[test]
fn an_interface_has_a_base() {
    let method = |name: &str| {
        format!(
            "<Methods><Method name=\"{name}\"><interface><returnType><INT/></returnType></interface></Method></Methods>"
        )
    };
    let first = format!("<Interface name=\"IFirst\">{}</Interface>", method("One"));
    let second = format!(
        "<Interface name=\"ISecond\">{}<Inheritance><Extends>IFirst</Extends></Inheritance></Interface>",
        method("Two")
    );
    let body = |value: u32| {
        format!(
            "<interface><returnType><INT/></returnType></interface><body><ST><xhtml xmlns=\"http://www.w3.org/1999/xhtml\">{value}</xhtml></ST></body>"
        )
    };
    let own = |name: &str, value: u32| {
        let text = body(value).replace(&format!("{value}<"), &format!("{name} := {value};<"));
        data("method", &format!("<Method name=\"{name}\">{text}</Method>"))
    };
    let inheritance = data("pouinheritance", "<Inheritance><Implements>ISecond</Implements></Inheritance>");
    let block = format!(
        "<pou name=\"F\" pouType=\"functionBlock\"><interface><addData>{inheritance}</addData></interface>\
         <body><ST><xhtml xmlns=\"http://www.w3.org/1999/xhtml\"></xhtml></ST></body><addData>{}{}</addData></pou>",
        own("One", 4),
        own("Two", 5)
    );
    let additions = [data("interface", &first), data("interface", &second), data("pou", &block)].concat();
    let mut rig = rig("i := f1; r := i.One() + i.Two();", "local f1 : F, i : ISecond, r : INT", &additions);
    rig.scan().expect("no fault");
    assert_eq!(rig.int("P.r"), 9);
}

#[test]
fn of_several_devices_the_first_is_read() {
    let device = |name: &str, task: &str, program: &str, value: u32| {
        let unit = format!(
            "<pou name=\"{program}\" pouType=\"program\"><interface><localVars><variable name=\"n\"><type><INT/></type></variable>\
             </localVars></interface><body><ST><xhtml xmlns=\"http://www.w3.org/1999/xhtml\">n := n + List.step;</xhtml></ST></body></pou>"
        );
        format!(
            "<configuration name=\"{name}\"><resource name=\"App\"><task name=\"Main\" {task} priority=\"1\"><pouInstance \
             name=\"{program}\" typeName=\"\"/></task><globalVars name=\"List\"><variable name=\"step\"><type><INT/></type>\
             <initialValue><simpleValue value=\"{value}\"/></initialValue></variable></globalVars>\
             <addData>{}</addData></resource></configuration>",
            data("pou", &unit)
        )
    };
    let file = |task: &str| {
        let devices = [device("Lab", task, "PRG", 3), device("Virtual", "interval=\"PT0.2S\"", "PRG", 5)].concat();
        let text = format!(
            "<project xmlns=\"http://www.plcopen.org/xml/tc6_0200\"><fileHeader productName=\"CODESYS\"/><types><dataTypes/><pous/>\
             </types><instances><configurations>{devices}</configurations></instances></project>"
        );
        Input::from_text("plc.xml", SourceKind::PlcOpen, text)
    };
    // A freewheeling task has no interval: it runs in each scan.
    for (task, tasks) in [("interval=\"PT0.01S\"", 1), ("", 0)] {
        let application = Application::from_inputs([file(task)]).expect("it compiles");
        let plan = application.configured_tasks().expect("a configuration");
        assert_eq!((plan.tasks.len(), plan.background.len()), (tasks, 1 - tasks));
        let mut rig = Rig::with_plan(&application, &plan);
        rig.step_ns = 10 * crate::rig::MS;
        rig.scan().expect("no fault");
        rig.scan().expect("no fault");
        assert_eq!(rig.int("PRG.n"), 6);
        let said = application.warnings().to_string();
        assert!(said.contains("`Virtual` is another device beside `Lab`: it is left out"), "{said}");
    }
}
