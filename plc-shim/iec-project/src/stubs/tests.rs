//! What is made of each kind of use: small projects, their stubs, and that they check with these.

use super::{MARK, write};
use onescan_iec::diagnostic::Severity;
use onescan_iec::dialect::Dialect;
use onescan_iec::input::Input;
use onescan_iec::input::kind::SourceKind;
use onescan_iec::lint::inspect;

fn input(text: &str) -> Input {
    Input::from_text("main.st", SourceKind::Text, text).in_dialect(Dialect::TwinCat)
}

/// The stubs of a project, without the remarks in front; asserts that it checks with them, and they alone.
fn stubs(text: &str) -> String {
    declarations(&sound_stubs(|| input(text)))
}

/// The same of a project in the language of the standard, with the remarks.
fn stubs_in_iec3(text: &str) -> String {
    sound_stubs(|| Input::from_text("main.st", SourceKind::Text, text))
}

fn sound_stubs(project: impl Fn() -> Input) -> String {
    let written = write(&[project()], None);
    let own = || Input::from_text("stubs.st", SourceKind::Text, written.text.as_str());
    for inputs in [vec![own()], vec![project(), own()]] {
        let findings = inspect(inputs, None);
        let errors: Vec<String> = findings
            .findings()
            .iter()
            .filter(|found| found.diagnostic().severity == Severity::Error)
            .map(|found| format!("{}:{}: {found}", found.file(), found.start().line))
            .collect();
        assert!(errors.is_empty(), "{errors:#?}\n{}", written.text);
    }
    let again = write(&[project()], Some(&written.text));
    assert_eq!((again.added, again.text.as_str()), (0, written.text.as_str()), "a second time adds nothing");
    written.text
}

/// What stands behind the remarks at the beginning.
fn declarations(text: &str) -> String {
    text.splitn(3, "*)\n").last().unwrap_or_default().trim().to_owned()
}

#[test]
fn what_is_declared_needs_no_stub() {
    let text = "PROGRAM P VAR t : TON; x : INT; END_VAR t(IN := TRUE, PT := T#1s); x := ABS(x); END_PROGRAM";
    let written = write(&[input(text)], None);
    assert_eq!(written.added, 0);
    assert!(written.text.starts_with(MARK));
}

/// Of a library that is there in part, only what it does not have gets a stub.
#[test]
fn what_a_library_lacks_is_declared_beside_it() {
    let text = stubs(
        "PROGRAM P VAR axis : Tc2_MC2.AXIS_REF; move : Tc2_MC2.MC_MoveAbsolute; torque : Tc2_MC2.MC_TorqueControl; END_VAR
  move(Axis := axis, Execute := axis.Status.Operational, Velocity := 5.0);
  torque(Axis := axis, Execute := TRUE, Torque := 5.0);
  IF axis.NcToPlc.ActPos > 5.0 AND torque.InTorque THEN axis.ReadStatus(); END_IF
END_PROGRAM",
    );
    assert!(text.contains("MC_TorqueControl") && text.contains("TC2_MC2.AXIS_REF"), "{text}");
    assert!(!text.contains("MC_MoveAbsolute") && !text.contains("BLOCK AXIS_REF") && !text.contains("TYPE"), "{text}");
}

#[test]
fn a_function_by_its_arguments_and_result() {
    insta::assert_snapshot!(stubs(
        "PROGRAM P VAR x : UDINT; s : STRING; w : WORD; END_VAR
  x := F_Crc(pData := ADR(s), cbData := SIZEOF(s));
  IF F_IsValid(s, 5) THEN w := F_Swap(w); END_IF
  F_Log(1.5, n => w);
END_PROGRAM"
    ));
}

#[test]
fn a_block_by_its_call() {
    insta::assert_snapshot!(stubs(
        "PROGRAM P VAR fb : FB_EcCoESdoRead; busy : BOOL; id : UDINT; data : ARRAY [0..7] OF BYTE; END_VAR
  fb(sNetId := '1.2.3', nSlave := 5, pDst := ADR(data), bExecute := NOT busy, tTimeout := T#5s, bBusy => busy);
  IF fb.bError THEN id := fb.nErrId; END_IF
END_PROGRAM"
    ));
}

#[test]
fn a_base_by_what_is_derived() {
    insta::assert_snapshot!(stubs(
        "FUNCTION_BLOCK FB_Test EXTENDS FB_TestSuite
VAR n : INT; END_VAR
  Adds();
METHOD Adds
  TEST('adds');
  AssertEquals(Expected := n, Actual := 5, Message := 'five');
  _count := _count + 1;
END_METHOD
METHOD SetUp : BOOL VAR_INPUT level : LREAL; END_VAR
  SetUp := SUPER^.SetUp(level);
END_METHOD
END_FUNCTION_BLOCK
PROGRAM P VAR t : FB_Test; END_VAR t(); t.Run(); END_PROGRAM"
    ));
}

/// As projects of SIMATIC AX have their bases in packages.
#[test]
fn a_base_of_a_class_is_a_class() {
    let text = "CLASS MoveAxis EXTENDS Command
VAR PUBLIC target : LREAL; END_VAR
METHOD PUBLIC Run : BOOL
  THIS.Begin(target := target);
  Run := state = INT#3;
END_METHOD
END_CLASS
PROGRAM P VAR m : MoveAxis; b : BOOL; END_VAR b := m.Run(); END_PROGRAM";
    let written = stubs_in_iec3(text);
    assert!(written.contains("{external}\nCLASS Command\nVAR PUBLIC\n"), "{written}");
}

/// What `REF_TO` variables exchange is of one type.
#[test]
fn references_that_are_assigned_refer_to_one_type() {
    let text = "CLASS Axis
VAR one : REF_TO TO_Speed; two : REF_TO TO_Pos; END_VAR
METHOD PUBLIC Attach : BOOL VAR_INPUT given : REF_TO TO_Pos; END_VAR
  two := given; one := given; Attach := one <> NULL;
END_METHOD
END_CLASS
PROGRAM P VAR m : Axis; b : BOOL; END_VAR b := m.Attach(NULL); END_PROGRAM";
    stubs_in_iec3(text);
}

/// What is compared with NULL, or stands where nothing is kept, refers to an instance.
#[test]
fn a_reference_to_an_instance_is_an_interface() {
    let text = "CLASS Lamp
VAR PUBLIC output : BinOutput; END_VAR
METHOD PUBLIC Switch : BOOL VAR_TEMP sensor : BinSignal; END_VAR
  IF output <> NULL THEN output.SetOn(); END_IF;
  Switch := sensor.IsOn();
END_METHOD
END_CLASS
PROGRAM P VAR l : Lamp; b : BOOL; END_VAR b := l.Switch(); END_PROGRAM";
    let written = stubs_in_iec3(text);
    assert!(written.contains("INTERFACE BinOutput") && written.contains("INTERFACE BinSignal"), "{written}");
}

/// What an heir overrides stands in its base, once, however often the stubs are written; a caller's array has its bounds.
#[test]
fn a_base_of_a_class_has_what_its_heirs_override() {
    let text = "CLASS Drive EXTENDS Command
METHOD PUBLIC OVERRIDE Run : BOOL VAR_INPUT fast : BOOL; END_VAR
  Run := fast;
END_METHOD
END_CLASS
FUNCTION Count : INT VAR_IN_OUT values : ARRAY [*] OF INT; END_VAR Count := CountOf(values); END_FUNCTION
PROGRAM P VAR m : Drive; b : BOOL; n : INT; a : ARRAY [1..3] OF INT; END_VAR b := m.Run(b); n := Count(a); END_PROGRAM";
    let written = stubs_in_iec3(text);
    assert_eq!(written.matches("METHOD Run : BOOL").count(), 1, "{written}");
    assert!(written.contains("ARRAY [*] OF INT"), "{written}");
}

#[test]
fn an_interface_by_what_implements_it() {
    insta::assert_snapshot!(stubs(
        "FUNCTION_BLOCK FB_Drive IMPLEMENTS I_Drive
METHOD Move : BOOL VAR_INPUT speed : LREAL; END_VAR Move := speed > 0; END_METHOD
PROPERTY Position : LREAL GET Position := 1.0; END_GET END_PROPERTY
END_FUNCTION_BLOCK
PROGRAM P VAR drive : FB_Drive; any : I_Drive; x : LREAL; END_VAR
  any := drive;
  IF any.Move(speed := 2.0) THEN x := any.Position; END_IF
END_PROGRAM"
    ));
}

#[test]
fn structures_enumerations_and_aliases() {
    insta::assert_snapshot!(stubs(
        "PROGRAM P VAR st : ST_Status; eMode : E_Mode; handle : T_Handle; x : INT; other : E_Kind; END_VAR
  st.nState := 5; st.fValue := 1.5; x := st.aItems[2];
  CASE eMode OF E_Mode.Idle: eMode := E_Mode.Busy; END_CASE
  other := E_Kind#Large;
  handle := 16#FF; x := x + handle;
END_PROGRAM"
    ));
}

#[test]
fn constants_and_lists_of_globals() {
    insta::assert_snapshot!(stubs(
        "PROGRAM P VAR a : ARRAY [0..MAX_ITEMS] OF INT; x : LREAL; t : TIME; END_VAR
  x := GVL_Param.fSpeed; GVL_Param.bEnable := TRUE; t := GVL_Param.axis.tRamp;
  GVL_Param.Reset(5);
  a[0] := DEFAULT_ITEM;
END_PROGRAM"
    ));
}

#[test]
fn names_behind_those_of_libraries() {
    insta::assert_snapshot!(stubs(
        "PROGRAM P VAR id : Tc2_Utilities.T_Id; x : INT; s : STRING; END_VAR
  id := 5; x := Tc2_Utilities.F_Count(s); x := Tc2_Standard.LEN(s);
  x := Tc2_Utilities.GVL_Limits.nMax;
END_PROGRAM"
    ));
}

#[test]
fn arguments_of_fb_init_and_chained_calls() {
    insta::assert_snapshot!(stubs(
        "FUNCTION_BLOCK FB_Own EXTENDS FB_Base END_FUNCTION_BLOCK
PROGRAM P VAR log : FB_Logger(5, 'main'); own : FB_Own(TRUE); ok : BOOL; END_VAR
  log.Text('a').Number(5).Send();
  ok := log.Last.bSent;
END_PROGRAM"
    ));
}

#[test]
fn what_takes_anything_is_generic() {
    insta::assert_snapshot!(stubs(
        "PROGRAM P VAR x : INT; s : STRING; t : TIME; END_VAR
  F_Show(x); F_Show(s); F_Show(t);
END_PROGRAM"
    ));
}

#[test]
fn the_compilers_operators_and_names_alone() {
    insta::assert_snapshot!(stubs(
        "PROGRAM P VAR xReady, other : BOOL; sName : STRING; END_VAR
  sName := __POUNAME();
  xReady := bStart AND NOT xStop;
  IF nLevel > 5 THEN other := Enable; END_IF
END_PROGRAM"
    ));
}

#[test]
fn types_that_every_tool_has_and_what_a_point_leads_to() {
    let text = "PROGRAM P VAR n : UDINT; p : POINTER TO STRING(5); s : STRING; END_VAR
  n := SIZEOF(STRING(255)) + SIZEOF(BOOL) + SIZEOF(WSTRING) + SIZEOF(REAL);
  p := __NEW(STRING(5), 3); s := __POSITION();
  .nLimit := n; .F_Report(n := n);
END_PROGRAM";
    insta::assert_snapshot!(stubs(text), @r"
    {dialect 'twincat'}

    {external}
    FUNCTION F_Report
        VAR_INPUT
            n : UDINT;
        END_VAR
    END_FUNCTION

    VAR_GLOBAL
        nLimit : UDINT;
    END_VAR
    ");
}

#[test]
fn operators_of_tools_get_no_stub() {
    let text = "PROGRAM P VAR v : BOOL; END_VAR v := __VARINFO(v); __XADD(v); END_PROGRAM";
    assert_eq!(write(&[input(text)], None).added, 0);
}

#[test]
fn a_stub_gets_what_a_project_uses_later() {
    let first = "PROGRAM P VAR fb : FB_Gate; END_VAR fb(bOpen := TRUE); END_PROGRAM";
    let later = "PROGRAM P VAR fb : FB_Gate; st : ST_A; x : INT; END_VAR
  fb(bOpen := TRUE, bClose := FALSE); x := fb.nState; st.a := 1; END_PROGRAM";
    let own = write(&[input(first)], None).text.replace("bOpen : BOOL;", "bOpen : BOOL; (* mine *)");
    let written = write(&[input(later)], Some(&own));
    insta::assert_snapshot!(declarations(&written.text));
}

#[test]
fn nothing_makes_it_fail() {
    for text in [
        "",
        "PROGRAM",
        "PROGRAM P x.y.z(; END_PROGRAM",
        "TYPE A : A; END_TYPE PROGRAM P VAR a : A; END_VAR a.b := a; END_PROGRAM",
        "FUNCTION_BLOCK A EXTENDS A x := SUPER^.y; END_FUNCTION_BLOCK",
        "PROGRAM P a^[1]^.b(c^ := d, e => f[g]); END_PROGRAM",
    ] {
        let written = write(&[input(text)], None);
        assert!(written.text.starts_with(MARK), "{text}");
    }
}

#[test]
fn what_a_drawing_knows_by_its_number_is_not_declared() {
    let drawn = include_str!("../../../tests/inputs/level.TcPOU").replace("R_TRIG", "FB_Unknown");
    let input = Input::from_text("Level.TcPOU", SourceKind::TwinCat, drawn);
    let written = write(&[input], None).text;
    assert!(written.contains("FB_Unknown"), "{written}");
    assert!(!declarations(&written).contains('`'), "{written}");
}

#[test]
fn a_base_implements_what_its_heirs_are_given_for() {
    insta::assert_snapshot!(stubs(
        "FUNCTION_BLOCK Press EXTENDS Components.Machine
VAR task : Components.Task(THIS^); slow : Slow(THIS^); END_VAR
METHOD Work : Components.ITask
  Work := slow;
  Follow(task, 0);
END_METHOD
END_FUNCTION_BLOCK
FUNCTION_BLOCK Slow EXTENDS Components.Task
METHOD FB_init : BOOL VAR_INPUT bInitRetains, bInCopyCode : BOOL; Parent : Components.IObject; END_VAR END_METHOD
END_FUNCTION_BLOCK
PROGRAM P VAR p1 : Press; i : Components.ITask; END_VAR
  i := p1.Work();
  p1.Config.Limit := 5;
END_PROGRAM"
    ));
}

#[test]
fn what_calls_leave_out_has_a_value_and_names_have_their_places() {
    insta::assert_snapshot!(stubs(
        "PROGRAM P VAR s : STRING(255); ok : BOOL; n : INT; END_VAR
  s := F_Join('a', F_Join('b', 'c', 'd', 7));
  ok := F_Equals(n = 5, Message := 'five');
  ok := F_Equals(Condition := ok, Message := 'again');
END_PROGRAM"
    ));
}

#[test]
fn what_is_linked_has_one_type() {
    insta::assert_snapshot!(stubs(
        "FUNCTION_BLOCK F EXTENDS Base
VAR task : Task; i : T_Index; list : ARRAY [0..MAX_LIST] OF INT; wide : UINT; narrow : INT; END_VAR
  StepDoneWhen(task.Done);
  FOR i := 0 TO 9 DO list[i] := 0; END_FOR
  FOR narrow := 1 TO MAX_LIST DO wide := MAX_LIST; END_FOR
  CASE wide OF STATE_IDLE: wide := 0; STATE_BUSY: wide := 1; END_CASE
END_FUNCTION_BLOCK"
    ));
}

/// What stubs take over of the constants that a project gives.
#[test]
fn a_generic_block_has_as_many_constants_as_it_is_given() {
    let text = stubs(
        "FUNCTION_BLOCK Own EXTENDS Lib.Base<3> END_FUNCTION_BLOCK
PROGRAM P VAR l : Lib.Pairs<(1 + 2), 8>; o : Own; n : DINT; END_VAR l.Add(5); n := l.Count; o(); END_PROGRAM",
    );
    assert!(text.contains("FUNCTION_BLOCK Base\nVAR_GENERIC CONSTANT\n    generic1 : DINT := 1;\nEND_VAR\n"), "{text}");
    assert!(text.contains("generic2 : DINT := 1;") && !text.contains("generic3"), "{text}");
}

#[test]
fn bounds_keep_their_constants_and_lengths_that_differ_are_open() {
    let text = stubs(
        "FUNCTION_BLOCK Own EXTENDS Tester
VAR a : ARRAY [0..2] OF INT; b : ARRAY [1..5] OF INT; END_VAR
  Same(Expected := a, Actual := b); Same(Expected := b, Actual := b);
END_FUNCTION_BLOCK
PROGRAM P VAR o : Own; p : ARRAY [0..Parameters.Most] OF LREAL; m : Mover; END_VAR
  o(); p := m.Places; m.Places := p; END_PROGRAM",
    );
    assert!(text.contains("Expected : ARRAY [*] OF INT;") && text.contains("Actual : ARRAY [1..5] OF INT;"), "{text}");
    assert!(text.contains("Places : ARRAY [0..Parameters.Most] OF LREAL;"), "{text}");
}

#[test]
fn what_is_handed_on_and_what_goes_away_is_of_their_types() {
    let text = stubs(
        "FUNCTION_BLOCK Own EXTENDS Base
METHOD Put : BOOL VAR_INPUT v : ANY; END_VAR Put := Store(v); __DELETE(rest); END_METHOD
END_FUNCTION_BLOCK
PROGRAM P VAR CONSTANT wait : TIME := T#5s; most : UINT := Parameters.Most + 1; END_VAR
VAR o : Own; i : INT; t : Stopwatch; left : TIME; c : Counter; END_VAR
  o.Put(i); left := wait - t.Elapsed; c.Limit := 16#FFEF0000; c.Add(134052566194980000);
END_PROGRAM",
    );
    assert!(text.contains("p1 : ANY;") && text.contains("rest : POINTER TO BYTE;"), "{text}");
    assert!(
        text.contains("Elapsed : TIME;") && text.contains("Limit : UDINT;") && text.contains("p1 : LINT;"),
        "{text}"
    );
    assert!(text.contains("CONSTANT\n    Most : "), "{text}");
}

#[test]
fn values_of_enumerations_without_a_name_are_declared() {
    let text = stubs(
        "FUNCTION_BLOCK Own EXTENDS Base
VAR state : (Waiting, Running); END_VAR
METHOD Go : BOOL state := Running; Go := state = Waiting; END_METHOD
  CASE state OF Waiting: state := Running; END_CASE
END_FUNCTION_BLOCK
PROGRAM P VAR o : Own; END_VAR o(); END_PROGRAM",
    );
    assert!(!text.contains("Waiting") && !text.contains("Running"), "{text}");
}

#[test]
fn an_enumeration_holds_the_numbers_that_go_into_it() {
    let text = stubs(
        "PROGRAM P VAR e : E_Command; n : UDINT; END_VAR e := n; IF e = E_Command.Stop THEN n := 0; END_IF END_PROGRAM",
    );
    assert!(text.contains("TYPE E_Command : (Stop) UDINT; END_TYPE"), "{text}");
}

#[test]
fn globals_and_namespaces_that_are_named_only() {
    let text = stubs(
        "USING System.Math;
PROGRAM P VAR_EXTERNAL far : STRING[20]; list : ARRAY [0..3] OF INT; END_VAR list[0] := LEN(far); END_PROGRAM",
    );
    assert!(text.contains("{external}\nNAMESPACE System.Math END_NAMESPACE"), "{text}");
    assert!(text.contains("    far : STRING[20];\n    list : ARRAY [0..3] OF INT;\n"), "{text}");
}

#[test]
fn what_is_referred_to_and_given_a_value_is_no_reference() {
    let text = stubs(
        "FUNCTION_BLOCK Own VAR set : FB_Value := (fValue := 5); seen : REFERENCE TO REAL REF= set.fValue; END_VAR
  IF seen > 3.0 THEN set(); END_IF
END_FUNCTION_BLOCK
PROGRAM P VAR o : Own; END_VAR o(); END_PROGRAM",
    );
    assert!(text.contains("fValue : REAL") && !text.contains("REFERENCE TO"), "{text}");
}

#[test]
fn a_label_that_the_project_s_enumeration_lacks_is_a_number() {
    let text = "TYPE E : (Idle, Busy); END_TYPE
PROGRAM P VAR s : ST_Far; e1 : E; END_VAR
  s.state := e1; s.state := OPEN; IF s.state = OPEN THEN e1 := Busy; END_IF
  CASE s.state OF OPEN: e1 := Idle; END_CASE
END_PROGRAM";
    let written = write(&[input(text)], None);
    assert!(written.text.contains("VAR_GLOBAL CONSTANT\n    OPEN : INT := "), "{}", written.text);
    let own = Input::from_text("stubs.st", SourceKind::Text, written.text.as_str());
    let findings = inspect([input(text), own], None);
    assert!(findings.findings().iter().all(|found| found.diagnostic().severity != Severity::Error), "{findings}");
}

/// Nobody else can name the type of such a structure.
#[test]
fn a_structure_without_a_name_is_given_for_any() {
    let text =
        "FUNCTION_BLOCK \"F\" VAR s : STRUCT a : INT; END_STRUCT; list : ARRAY [0..3] OF STRUCT b : INT; END_STRUCT;
  n : INT; END_VAR BEGIN #n := RD_FAR(INFO := #s, ALL := #list); END_FUNCTION_BLOCK";
    let project = || Input::from_text("main.scl", SourceKind::Text, text).in_dialect(Dialect::SiemensScl);
    let written = write(&[project()], None);
    assert!(written.text.contains("INFO : ANY;") && written.text.contains("ALL : ANY;"), "{}", written.text);
    let findings = inspect([project(), Input::from_text("stubs.st", SourceKind::Text, written.text.as_str())], None);
    assert!(findings.findings().iter().all(|found| found.diagnostic().severity != Severity::Error), "{findings}");
}

#[test]
fn structures_that_go_into_one_another_are_one_type() {
    let text = stubs(
        "FUNCTION_BLOCK Old VAR_INPUT state : DUT_State; END_VAR VAR n : INT; END_VAR n := state.number; END_FUNCTION_BLOCK
PROGRAM P VAR o : Old; s : ST_State; a : ARRAY [1..3] OF ST_State; END_VAR
  s.name := 'x'; a[1] := s; o(state := a[1]);
END_PROGRAM",
    );
    assert!(text.contains("TYPE ST_State : DUT_State; END_TYPE"), "{text}");
    assert!(text.contains("number : INT;") && text.contains("name : STRING(255);"), "{text}");
}

#[test]
fn values_of_an_enumeration_are_known_by_another_name_of_it_and_begin_where_its_array_does() {
    let text = stubs(
        "TYPE T_Area : E_Area; END_TYPE
PROGRAM P VAR e : E_Area; a : ARRAY [1..9] OF INT; b : BOOL; END_VAR
  b := e = T_Area.Static; a[E_Area.Dynamic] := 3;
END_PROGRAM",
    );
    assert!(text.contains("TYPE E_Area : (Static := 1, Dynamic); END_TYPE"), "{text}");
}

#[test]
fn a_member_is_called_before_its_own_members_are_used() {
    let text = stubs(
        "PROGRAM P VAR m : DUT_Stage; b : BOOL; END_VAR
  m.run(start := TRUE, stop := m.run.halted); b := m.run.done;
END_PROGRAM",
    );
    assert!(text.contains("FUNCTION_BLOCK T_DUT_Stage_run"), "{text}");
}

#[test]
fn members_of_structures_without_names_are_known() {
    let text =
        "VAR_GLOBAL db : STRUCT run : BOOL; part : STRUCT header : STRING; day : INT; END_STRUCT END_STRUCT; END_VAR
PROGRAM P VAR log : DataLog; END_VAR
  log(REQ := db.run, HEADER := db.part.header, DATA := db.part); db.part.day := DayOf(clock := db.part.day);
END_PROGRAM";
    let text = stubs(text);
    for line in ["REQ : BOOL;", "HEADER : STRING(255);", "DATA : ANY;", "FUNCTION DayOf : INT"] {
        assert!(text.contains(line), "{line} {text}");
    }
}

#[test]
fn an_input_that_a_call_leaves_out_begins_with_a_constant() {
    let text = stubs(
        "FUNCTION_BLOCK B EXTENDS Sequencer METHOD Go : INT VAR_INPUT n : INT := MinStep - 1; END_VAR Go := n; END_METHOD END_FUNCTION_BLOCK
PROGRAM P VAR b1 : B; x : INT; END_VAR x := b1.Go(); END_PROGRAM",
    );
    assert!(text.contains("VAR CONSTANT\n    MinStep : INT := 100;"), "{text}");
}

#[test]
fn an_array_whose_bounds_the_stub_cannot_name_is_one_of_any_length() {
    let text = stubs(
        "FUNCTION_BLOCK H VAR CONSTANT n : INT := 7; END_VAR VAR a : ARRAY [0..n] OF BYTE; END_VAR Fill('ab', a); END_FUNCTION_BLOCK
PROGRAM P VAR h1 : H; END_VAR h1(); END_PROGRAM",
    );
    assert!(text.contains("p2 : ARRAY [*] OF BYTE;"), "{text}");
}

#[test]
fn a_property_of_an_interface_has_the_type_of_who_implements_it_by_a_base() {
    let text = stubs(
        "INTERFACE ITask EXTENDS IExecutable END_INTERFACE
FUNCTION_BLOCK Task EXTENDS BaseObject IMPLEMENTS ITask END_FUNCTION_BLOCK
FUNCTION_BLOCK Own EXTENDS Task PROPERTY Size : ULINT GET Size := 3; END_GET END_PROPERTY END_FUNCTION_BLOCK
PROGRAM P VAR t : ITask; o : Own; n : INT; END_VAR t := o; n := Parts(t.Size); END_PROGRAM",
    );
    assert!(text.contains("p1 : ULINT;"), "{text}");
}

#[test]
fn a_function_of_ax_has_an_overload_for_each_type_that_fits_no_other() {
    let text = stubs_in_iec3(
        "USING System.Serialization;
PROGRAM P VAR b : BYTE; u : UINT; s : SINT; i : INT; n : UDINT; a : ARRAY [0..7] OF BYTE; END_VAR
  n := SerializeBig(offset := n, value := b, buffer := a); n := SerializeBig(offset := n, value := u, buffer := a);
  n := Rank(s) + Rank(i);
END_PROGRAM",
    );
    assert_eq!(text.matches("FUNCTION SerializeBig : UDINT").count(), 2, "{text}");
    assert!(text.contains("value : BYTE;") && text.contains("value : UINT;"), "{text}");
    assert_eq!(text.matches("FUNCTION Rank : UDINT").count(), 1, "SINT becomes INT: {text}");
}

#[test]
fn a_method_of_ax_calls_the_function_of_its_name() {
    let text = stubs_in_iec3(
        "USING System.Strings;
NAMESPACE Own
  CLASS Builder VAR text : STRING; END_VAR
    METHOD PUBLIC Insert : INT VAR_INPUT t : STRING; pos : INT; END_VAR text := Insert(text, pos, t); Insert := pos; END_METHOD
    METHOD PUBLIC Left : INT VAR_INPUT n : INT; END_VAR text := Left(text, n); Left := n; END_METHOD
    METHOD PUBLIC StartOf : INT VAR_INPUT n : INT; END_VAR text := StartOf(text, n); StartOf := n; END_METHOD
  END_CLASS
END_NAMESPACE
PROGRAM P VAR b : Own.Builder; n : INT; END_VAR n := b.Insert('a', 1) + b.StartOf(2) + b.Left(1); END_PROGRAM",
    );
    let (before, library) = text.split_once("NAMESPACE System.Strings\n").expect("a namespace of the library");
    assert!(library.contains("FUNCTION Insert : STRING") && library.contains("p2 : INT;"), "{text}");
    assert!(before.contains("FUNCTION StartOf : STRING") && !text.contains("FUNCTION Left"), "{text}");
}

#[test]
fn a_member_of_ax_that_begins_with_an_instance_is_an_interface() {
    let text = stubs_in_iec3(
        "PROGRAM P VAR_EXTERNAL stack : LightStack; END_VAR stack.SwitchOn(); END_PROGRAM
CONFIGURATION C TASK T (INTERVAL := T#10ms); PROGRAM P1 WITH T : P;
  VAR_GLOBAL stack : LightStack := (red := lamp); lamp : BinOutput; limit : Guard := (time := T#3s); next : Transition := (when := limit); END_VAR
END_CONFIGURATION",
    );
    for line in [
        "red : I_LightStack_red;",
        "FUNCTION_BLOCK BinOutput IMPLEMENTS I_LightStack_red",
        "INTERFACE I_LightStack_red",
    ] {
        assert!(text.contains(line), "{line} {text}");
    }
    assert!(text.contains("FUNCTION_BLOCK Guard IMPLEMENTS I_Transition_when"), "{text}");
}

#[test]
fn a_constant_that_is_a_string_has_a_value() {
    let text = stubs(
        "TYPE T_Id : STRING(23); END_TYPE
VAR_GLOBAL CONSTANT own : T_Id := GCL.cLocalId; shown : STRING := GCL.cName; END_VAR
PROGRAM P VAR s : STRING; END_VAR s := own; s := shown; END_PROGRAM",
    );
    assert!(text.contains("cLocalId : STRING(255) := '';") && text.contains("cName : STRING(255) := '';"), "{text}");
}
