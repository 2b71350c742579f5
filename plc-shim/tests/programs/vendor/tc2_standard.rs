//! `Tc2_Standard`: functions of WSTRING, timers of LTIME.

use onescan_iec::Dialect;

use super::hold;
use crate::rig::Rig;

#[test]
fn functions_of_wide_texts() {
    let declarations = "short : WSTRING(4) := \"SUSI\";";
    hold(
        Dialect::TwinCat,
        declarations,
        "",
        &[
            "WLEN(\"SUSI\") = 4",
            "WLEN(short) = 4",
            "WLEFT(\"SUSI\", 3) = \"SUS\"",
            "WRIGHT(\"SUSI\", 3) = \"USI\"",
            "WMID(\"SUSI\", 2, 2) = \"US\"",
            "WMID(STR := \"SUSI\", LEN := 2, POS := 2) = \"US\"",
            "WCONCAT(\"SUSI\", \"WILLI\") = \"SUSIWILLI\"",
            "WINSERT(\"SUSI\", \"XY\", 2) = \"SUXYSI\"",
            "WDELETE(\"SUXYSI\", 2, 3) = \"SUSI\"",
            "WREPLACE(\"SUXYSI\", \"K\", 2, 2) = \"SKYSI\"",
            "WFIND(\"abcdef\", \"de\") = 4",
            "WFIND(\"abcdef\", \"x\") = 0",
            "Tc2_Standard.WLEN(Tc2_Standard.WCONCAT(short, short)) = 8",
            "Tc2_Standard.LEN(Tc2_Standard.CONCAT('a', 'bc')) = 3",
        ],
    );
    hold(Dialect::Codesys, declarations, "", &["Standard64.WLEN(short) = 4", "Standard.LEN('abc') = 3"]);
}

#[test]
fn timers_of_long_durations() {
    let text = "PROGRAM P VAR
        on : LTON; off : LTOF; pulse : LTP; input : BOOL := TRUE; END_VAR
        on(IN := input, PT := LTIME#20MS); off(IN := input, PT := LTIME#20MS); pulse(IN := input, PT := LTIME#15MS);
    END_PROGRAM";
    let mut rig = Rig::in_dialect(Dialect::TwinCat, text);
    let mut seen = Vec::new();
    for scan in 0..6 {
        if scan == 3 {
            rig.set("P.input", 0);
        }
        rig.scan().expect("no fault");
        seen.push(["P.on.Q", "P.off.Q", "P.pulse.Q"].map(|name| rig.bool(name)));
    }
    let [t, f] = [true, false];
    assert_eq!(seen, [[f, t, t], [f, t, t], [t, t, f], [f, t, f], [f, t, f], [f, f, f]]);
}
