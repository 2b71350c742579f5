//! A run and a PLC that cannot meet: the one in lockstep, the other on its own clock. Each says so at once.

use crate::plc::Plc;
use crate::typed::{scenario, typed};

const SCHEMES: [&str; 4] = ["tcp://", "modbus://", "opc.tcp://", "ads://"];

#[test]
fn a_run_without_lockstep_does_not_wait_for_a_plc_in_lockstep() {
    let plc = Plc::start(&scenario("shear"), &[]);
    for mode in ["freewheel", "halt", "follow"] {
        for scheme in SCHEMES {
            let gateway = plc.gateway(scheme);
            let said = typed(&scenario("shear"), &["run", ".", "--until", "1s", "--mode", mode, "--gateway", &gateway]);
            assert_eq!(said.code, Some(3), "{mode} {scheme}: {said:?}");
            assert!(
                said.out.contains("the PLC is in lockstep: SDSP_Answer is 0 and not 7"),
                "{mode} {scheme}: {said:?}"
            );
        }
    }
}

#[test]
fn a_run_in_lockstep_does_not_wait_for_a_plc_on_its_own_clock() {
    let plc = Plc::start(&scenario("shear"), &["--mode", "freewheel"]);
    for scheme in SCHEMES {
        let gateway = plc.gateway(scheme);
        let said = typed(&scenario("shear"), &["run", ".", "--until", "1s", "--gateway", &gateway]);
        assert_eq!(said.code, Some(3), "{scheme}: {said:?}");
        assert!(said.out.contains("the PLC free-wheels: SDSP_Simulated is FALSE"), "{scheme}: {said:?}");
    }
}

/// How a plant keeps its cycle is not a mode of a PLC.
#[test]
fn a_plc_is_in_lockstep_or_on_its_own_clock() {
    for mode in ["halt", "follow"] {
        let said = typed(&scenario("shear"), &["plc", ".", "--mode", mode]);
        assert_eq!(said.code, Some(2), "{said:?}");
        assert!(said.err.contains("[possible values: lockstep, freewheel]"), "{said:?}");
    }
}
