//! Methods, properties, actions and interfaces in the files of vendors.

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, TimeSpan, inspect};
use onescan_iec_run::Application;

use crate::rig::Rig;

const TANK: &str = include_str!("../inputs/tank.TcPOU");
const PUMP: &str = include_str!("../inputs/pump.xml");
const LEVEL: &str = r#"<TcPlcObject><Itf Name="I_Level"><Declaration><![CDATA[INTERFACE I_Level]]></Declaration>
<Property Name="Level"><Declaration><![CDATA[PROPERTY Level : INT]]></Declaration>
<Get Name="Get"><Declaration /></Get><Set Name="Set"><Declaration /></Set></Property></Itf></TcPlcObject>"#;
const MAIN: &str = "PROGRAM Main VAR t : FB_Tank; i : I_Level; a, b : INT; END_VAR
  t(bFill := TRUE); i := t; a := i.Level; i.Level := 50; b := t.Level; t.Empty();
END_PROGRAM";

fn rig(inputs: impl IntoIterator<Item = Input>) -> Rig {
    let application = match Application::from_inputs(inputs) {
        Ok(application) => application,
        Err(found) => panic!("{found}"),
    };
    let plan = application.single_task(TimeSpan::millis::<10>());
    let mut rig = Rig::with_plan(&application, &plan);
    rig.scan().expect("no fault");
    rig
}

fn tank(text: &str) -> [Input; 3] {
    [
        Input::from_text("FB_Tank.TcPOU", SourceKind::TwinCat, text),
        Input::from_text("I_Level.TcIO", SourceKind::TwinCat, LEVEL),
        Input::from_text("Main.st", SourceKind::Text, MAIN),
    ]
}

#[test]
fn twincat_members_belong_to_their_unit() {
    let rig = rig(tank(TANK));
    assert_eq!(["a", "b", "t.nLitres"].map(|name| rig.int(&format!("Main.{name}"))), [5, 50, 0]);
}

#[test]
fn places_in_twincat_members_are_those_of_the_file() {
    let wrong = TANK
        .replace("nLitres := nLitres + nStep", "nLitres := nLitres + nStop")
        .replace("nLitres := 0", "nLiters := 0");
    insta::assert_snapshot!(inspect(tank(&wrong), None), @r#"
    FB_Tank.TcPOU:25:43: error[N0101]: `nStop` is not declared (did you mean `nStep`?)
    FB_Tank.TcPOU:51:22: error[N0101]: `nLiters` is not declared
    "#);
}

#[test]
fn plcopen_additions_of_codesys_are_read() {
    let rig = rig([Input::from_text("pump.xml", SourceKind::PlcOpen, PUMP)]);
    assert_eq!((rig.bool("Main.done"), rig.int("GVL.speed"), rig.int("Main.p.n")), (false, 7, 0));
    let wrong = PUMP.replace("n := n + step", "n := n + stop");
    insta::assert_snapshot!(inspect([Input::from_text("pump.xml", SourceKind::PlcOpen, wrong)], None), @"pump.xml:26:78: error[N0101]: `stop` is not declared (did you mean `step`?)");
}
