//! Motion control in PLCopen XML: moved by virtual time in lockstep.

use super::plcopen_charts::assert_equal;
use crate::plcopen::{block, coil, contact, input, output, pou, project, rail};
use crate::rig::task;

/// An axis that is powered in a ladder diagram and moved in a function block diagram.
pub(super) fn drive() -> String {
    let ld = rail(1)
        + &contact(2, (0, 0), "1", "i", "")
        + &block(3, (50, 0), "MC_Power power", "Enable=2", "Status", "").replace(
            "<inOutVariables/>",
            "<inOutVariables><variable formalParameter=\"Axis\"><connectionPointIn><connection refLocalId=\"5\"/>\
             </connectionPointIn><connectionPointOut/></variable></inOutVariables>",
        )
        + &coil(4, (100, 0), "3.Status", "on", "")
        + &input(5, (0, 40), "x");
    let st = "move(Axis := x, Execute := on AND j, Position := 1.5, Velocity := 5.0, Acceleration := 20.0, Jerk := 200.0);\n\
              halt(Axis := x, Execute := NOT j, Deceleration := 30.0);\n\
              there := move.Done OR halt.Done;\nread(Axis := x, Enable := TRUE, Position => p);";
    let fbd = input(1, (0, 0), "there") + &output(2, (90, 0), "1", "seen", "");
    let power = "inout x : AXIS_REF; in i : BOOL; out on : BOOL; local power : MC_Power";
    let main = "in i : BOOL, j : BOOL; local x : AXIS_REF, on : BOOL, drive : Drive, move : MC_MoveAbsolute, halt : MC_Halt, \
                read : MC_ReadActualPosition, there : BOOL, p : LREAL";
    let units = pou("functionBlock", "Drive", power, "LD", &ld)
        + &pou("program", "Main", main, "ST", &format!("drive(x := x, i := i); on := drive.on;\n{st}"))
        + &pou("program", "Net", "local there : BOOL, seen : BOOL", "FBD", &fbd);
    project(&units.replace("<derived name=\"LREAL\"/>", "<LREAL/>"))
}

#[test]
fn motion_blocks_of_xml_are_moved_by_virtual_time() {
    assert_equal(&drive(), &[task("main", 5, 1, &["Main", "Net"])], &["Main.i", "Main.j"]);
}
