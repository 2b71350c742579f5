//! Direct addresses (2nd ed. 2.4.1.1, Table 15; 2.4.3.1, Table 17; 3rd ed. 6.5.5).

use crate::rig::{Rig, application, findings};

/// The first line of what is said about a program with these declarations and statements.
fn reported(declarations: &str, statements: &str) -> String {
    let text = format!("PROGRAM P VAR {declarations} END_VAR {statements} END_PROGRAM");
    findings(&text).lines().next().unwrap_or_default().to_owned()
}

#[test]
fn iec2_2_4_1_1_table_15_addresses_that_overlap_share_their_bytes() {
    let mut rig = Rig::new(
        "PROGRAM P VAR d : DWORD; w : WORD; b : BYTE; x, y : BOOL; END_VAR
        %MD1 := 16#12345678; w := %MW3; b := %MB4; x := %MX4.3; y := %M4.7;
        %MX7.0 := FALSE; %MB5 := 16#AB; d := %MD1; END_PROGRAM",
    );
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.w"), rig.int("P.b")), (0x1234, 0x78));
    assert_eq!((rig.bool("P.x"), rig.bool("P.y")), (true, false));
    assert_eq!(rig.int("P.d"), 0x1234_AB78 & !0x0100_0000);
}

#[test]
fn iec2_2_4_1_1_bits_of_a_byte_are_read_and_written_alone() {
    let mut rig = Rig::new(
        "FUNCTION Set : BOOL VAR_INPUT a : BOOL; END_VAR %QX0.7 := a; Set := TRUE; END_FUNCTION
        PROGRAM P VAR n : INT; END_VAR
        %QX0.1 := %IX0.0 AND %MX3.2; %QX0.2 := Set(TRUE); %Q0.3 := NOT %Q0.3; n := BOOL_TO_INT(%QX0.1); END_PROGRAM",
    );
    let input = rig.variable("%IX0.0");
    let memory = rig.variable("%MX3.2");
    assert_eq!((input.bit, memory.bit, memory.size), (Some(0), Some(2), 1));
    let trace: Vec<(i64, i64)> = [(0, 0xff), (1, 0xfb), (0xff, 4), (1, 4)]
        .map(|(inputs, marks)| {
            rig.plc.memory_mut()[input.offset as usize] = inputs;
            rig.plc.memory_mut()[memory.offset as usize] = marks;
            rig.scan().expect("no fault");
            (i64::from(rig.plc.memory()[rig.variable("%QX0.0").offset as usize]), rig.int("P.n"))
        })
        .to_vec();
    // The value is computed before the byte is read: what the function sets stays.
    assert_eq!(trace, [(0b1000_1100, 0), (0b1000_0100, 0), (0b1000_1110, 1), (0b1000_0110, 1)]);
}

#[test]
fn iec2_2_4_3_1_table_17_variables_are_located() {
    let mut rig = Rig::new(
        "TYPE Pair : STRUCT a, b : INT; END_STRUCT; Mode : (Off := 3, On := 5); END_TYPE
        VAR_GLOBAL lamp AT %QX0.1 : BOOL := TRUE; row AT %IW6 : ARRAY [0..3] OF INT; END_VAR
        VAR_GLOBAL RETAIN kept AT %MW500 : INT := 7; END_VAR
        FUNCTION_BLOCK B VAR_IN_OUT x : BOOL; END_VAR x := NOT x; END_FUNCTION_BLOCK
        FUNCTION Flip VAR_IN_OUT x : BOOL; END_VAR x := NOT x; END_FUNCTION
        PROGRAM P VAR p AT %MB100 : Pair := (a := 1, b := 2); low AT %MB100 : USINT; m AT %MW60 : Mode;
          o AT %QX0.4 : BOOL; sum : INT; fb : B; text AT %MB200 : STRING[5] := 'abc'; open AT %I* : BOOL; END_VAR
        sum := row[0] + row[3] + p.b + kept; kept := kept + 1; low := low + 1;
        fb(x := o); Flip(lamp); %QW5 := INT_TO_WORD(p.a); END_PROGRAM",
    );
    let lamp = rig.variable("lamp");
    let outputs = |rig: &Rig| rig.plc.memory()[rig.variable("%QB0").offset as usize];
    assert_eq!(
        (lamp.bit, lamp.offset, lamp.address.as_deref()),
        (Some(1), rig.variable("%QB0").offset, Some("%QX0.1"))
    );
    assert_eq!(outputs(&rig), 0b10);
    rig.set("row[3]", 40);
    rig.scan().expect("no fault");
    assert_eq!((rig.int("P.sum"), rig.int("P.p.a"), rig.int("P.m"), rig.int("%QW5")), (49, 2, 3, 2));
    assert_eq!((outputs(&rig), rig.text("P.text")), (0b1_0000, "abc".to_owned()));
    assert_eq!(rig.variable("row[3]").offset, rig.variable("row[0]").offset + 6);
    assert_eq!((rig.variable("P.open").bit, rig.variable("P.open").address.as_deref()), (None, Some("%I*")));
    rig.plc.warm_start();
    assert_eq!((rig.int("kept"), rig.int("P.low"), outputs(&rig)), (8, 1, 0b10));
}

#[test]
fn an_area_is_part_of_the_saved_state() {
    let text = "PROGRAM P VAR n : INT; END_VAR n := n + 1; %MW3 := INT_TO_WORD(n); %MX0.3 := n > 1; END_PROGRAM";
    let mut rig = Rig::new(text);
    rig.scan().expect("no fault");
    let saved = rig.plc.save();
    rig.scan().expect("no fault");
    let then = rig.plc.memory().to_vec();
    rig.plc.restore(&saved).expect("its own state");
    assert_eq!(rig.int("%MW3"), 1);
    rig.now_ns -= rig.step_ns;
    rig.scan().expect("no fault");
    assert_eq!(rig.plc.memory(), then);
}

#[test]
fn an_address_that_the_program_does_not_use_is_unknown() {
    let application = application("PROGRAM P %QB3 := 1; END_PROGRAM");
    assert_eq!(application.variable("%qw1").expect("used").type_name, "WORD");
    for path in ["%QB4", "%QW2", "%IX0.0", "%Q", "%QX0.9", "%Q*"] {
        assert!(application.variable(path).is_err(), "{path}");
    }
}

#[test]
fn wrong_addresses_are_reported() {
    let statements = [
        ("%IX1.8 := TRUE;", "test.st:1:24: error[R0901]: `%IX1.8` is not a direct address: a byte has the bits 0 to 7"),
        (
            "%QZ1 := 1;",
            "test.st:1:24: error[R0901]: `%QZ1` is not a direct address: behind the area stands X, B, W, D, L or a number",
        ),
        (
            "%MD999999 := 1;",
            "test.st:1:24: error[R0901]: `%MD999999` is not a direct address: an area ends at byte 1048575",
        ),
        ("%QX* := TRUE;", "test.st:1:24: error[R0901]: `%QX*` is open, so it stands in declarations only"),
        ("%QX0.0 := 2;", "test.st:1:34: error[T0202]: 2 does not fit BOOL (0 to 1)"),
        (
            "%IX0.0 := TRUE;",
            "test.st:1:24: warning[D0402]: an input is written by the machine; this value is overwritten",
        ),
    ];
    for (statement, expected) in statements {
        assert_eq!(reported("", statement), expected, "{statement}");
    }
    let declarations = [
        ("a AT %QX0.1 : INT;", "(INT takes 16 bits: write %QW behind the area)"),
        ("a AT %MW1 : DINT;", "(DINT takes 32 bits: write %MD behind the area)"),
        ("a AT %MB1 : BOOL;", "(a BOOL takes a bit, as in %MX0.0)"),
        ("a AT %IX0.0 : ARRAY [0..7] OF BOOL;", "(ARRAY [0..7] OF BOOL begins at a byte, as in %IB0)"),
        ("a AT %MB1 : TON;", "(instances have no direct address)"),
        ("a AT %MB1048570 : ARRAY [0..7] OF BYTE;", "an area ends at byte 1048575"),
        ("a AT %MX7.9 : BOOL;", "a byte has the bits 0 to 7"),
    ];
    for (declaration, expected) in declarations {
        let found = reported(declaration, "");
        assert!(found.ends_with(expected), "{found}");
    }
    for unit in [
        "FUNCTION F : INT VAR a AT %MW1 : INT; END_VAR F := a; END_FUNCTION",
        "FUNCTION_BLOCK F VAR_INPUT a AT %MW1 : INT; END_VAR END_FUNCTION_BLOCK",
        "FUNCTION_BLOCK F VAR_TEMP a AT %MW1 : INT; END_VAR END_FUNCTION_BLOCK",
    ] {
        assert!(findings(unit).contains("error[R0902]: a variable of this section has no direct address"), "{unit}");
    }
}

#[test]
fn a_hierarchical_address_is_one_place_whoever_names_it() {
    let text = "PROGRAM P VAR a AT %IW2.5.7.1 : WORD; b AT %QW0.0.2.8193.0 : WORD := 16#12; c AT %IW2.5.7.2 : UINT; n, m : WORD; END_VAR
          n := %IW2.5.7.1; %QW0.0.2.8193.0 := %QW0.0.2.8193.0 + 1; m := Q.d; END_PROGRAM
        PROGRAM Q VAR d AT %iw2.5.7.1 : WORD; e AT %QX1.2.3 : BOOL; END_VAR e := TRUE; END_PROGRAM";
    let mut rig = Rig::in_dialect(onescan_iec::Dialect::Codesys, text);
    rig.plc.write("P.a", "16#ABCD").expect("it is a variable");
    rig.scan().expect("no fault");
    assert_eq!(["P.n", "P.m", "P.b", "P.c"].map(|path| rig.int(path)), [0xabcd, 0xabcd, 0x13, 0]);
    assert!(rig.bool("Q.e"));
}
