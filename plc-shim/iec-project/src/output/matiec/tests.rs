use super::*;

fn low(text: &str) -> String {
    let lowered = lowered(text, Dialect::default());
    lowered.map_or_else(|unsaid| panic!("{unsaid:?}"), |lowered| lowered.text)
}

/// The text with one blank for each gap.
fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn refused(text: &str) -> Vec<(Option<u32>, String)> {
    match lowered(text, Dialect::default()) {
        Ok(lowered) => panic!("{}", lowered.text),
        Err(unsaid) => unsaid.into_iter().map(|each| (each.line, each.message)).collect(),
    }
}

#[test]
fn declarations_stand_one_by_one() {
    let text = low("PROGRAM P\nVAR a, b, c : R_TRIG; n, m : INT := 3; END_VAR\na(CLK := TRUE);\nEND_PROGRAM\n");
    assert!(text.contains("a : R_TRIG; b : R_TRIG; c : R_TRIG; n : INT := 3; m : INT := 3;"), "{text}");
}

#[test]
fn enumerations_become_integers_and_conversions_name_both_types() {
    let text = low(
        "TYPE State : (Idle := 4, Busy); END_TYPE\nPROGRAM P\nVAR s : State; t : State := Busy; d : DINT; r : REAL; \
                    END_VAR\nCASE s OF Idle: s := State#Busy; Busy: d := TO_DINT(s); END_CASE;\nr := TO_REAL(d);\n\
                    END_PROGRAM\n",
    );
    assert!(text.contains("s : INT := 4; t : INT := 5;"), "{text}");
    assert!(text.contains("CASE s OF 4: s := 5; 5: d := INT_TO_DINT(s); END_CASE;"), "{text}");
    assert!(text.contains("r := DINT_TO_REAL(d);"), "{text}");
}

#[test]
fn arrays_of_blocks_become_instances_and_loops_over_them_their_rounds() {
    let block =
        "FUNCTION_BLOCK B VAR_INPUT x : BOOL; END_VAR VAR_OUTPUT y : BOOL; END_VAR y := x; END_FUNCTION_BLOCK\n";
    let text = low(&format!(
        "{block}PROGRAM P\nVAR b : ARRAY [1..2] OF B; i : INT; n : INT; END_VAR\n\
         FOR i := 1 TO 2 DO b[i](x := b[2].y); n := n + i; END_FOR;\nEND_PROGRAM\n"
    ));
    let text = words(&text);
    assert!(text.contains("b_1 : B; b_2 : B;"), "{text}");
    let rounds = "i := 1; b_1(x := b_2.y); n := n + i; i := 2; b_2(x := b_2.y); n := n + i; i := 3;";
    assert!(text.contains(rounds), "{text}");
    let found = refused(&format!(
        "{block}PROGRAM P\nVAR b : ARRAY [1..2] OF B; i : INT; END_VAR\ni := 2;\nb[i]();\nEND_PROGRAM\n"
    ));
    assert_eq!(found, [(Some(5), "a function block that is chosen while it runs cannot be had in MatIEC".to_owned())]);
}

#[test]
fn what_an_action_does_is_lowered_like_the_body() {
    let text = words(&low("FUNCTION_BLOCK B VAR_INPUT x : BOOL; END_VAR ; END_FUNCTION_BLOCK\n\
                           PROGRAM P\nVAR b : ARRAY [1..2] OF B; a : BOOL; i : INT; n : INT; END_VAR\n\
                           INITIAL_STEP S: Work(N); END_STEP\n\
                           ACTION Work:\nFOR i := 1 TO 2 DO b[i](x := a); END_FOR;\n\
                           FOR i := 9 TO 1 BY -2 DO n := n + 1; END_FOR;\nIF a THEN END_IF;\nEND_ACTION\nEND_PROGRAM\n"));
    assert!(text.contains("i := 1; b_1(x := a); i := 2; b_2(x := a); i := 3;"), "{text}");
    assert!(text.contains("i := 9; WHILE i >= 1 DO n := n + 1; i := i - 2; END_WHILE;"), "{text}");
    assert!(text.contains("IF a THEN WHILE FALSE DO EXIT; END_WHILE; END_IF;"), "{text}");
}

#[test]
fn a_chart_goes_on_as_the_standard_has_it() {
    let text = words(&low("PROGRAM P\nVAR a : BOOL; END_VAR\nINITIAL_STEP S: Work(N); END_STEP\nSTEP T: END_STEP\n\
                           TRANSITION FROM S TO T := NOT a OR a; END_TRANSITION\nACTION Work:\na := TRUE;\nEND_ACTION\nEND_PROGRAM\n"));
    assert!(text.contains("VAR SDSP_Begun : BOOL; END_VAR INITIAL_STEP S:"), "{text}");
    assert!(text.contains(":= SDSP_Begun AND (NOT a OR a); END_TRANSITION"), "{text}");
    let last = "END_ACTION INITIAL_STEP SDSP_First: SDSP_Begin(N); END_STEP \
                ACTION SDSP_Begin: SDSP_Begun := TRUE; END_ACTION END_PROGRAM";
    assert!(text.ends_with(last), "{text}");
    let text = words(&low(
        "PROGRAM P\nVAR a : BOOL; b : BOOL; c : BOOL; END_VAR\nINITIAL_STEP S: END_STEP\nSTEP T: END_STEP\n\
                           TRANSITION FROM S TO T := a; END_TRANSITION\nTRANSITION FROM S TO S := b; END_TRANSITION\n\
                           TRANSITION (PRIORITY := 1) FROM (S, T) TO S := c; END_TRANSITION\nEND_PROGRAM\n",
    ));
    let both = "AND NOT (S.X AND T.X AND (c))";
    assert!(text.contains(&format!(":= SDSP_Begun AND (a) {both}; END_TRANSITION")), "{text}");
    assert!(text.contains(&format!(":= SDSP_Begun AND (b) {both} AND NOT (a); END_TRANSITION")), "{text}");
    assert!(text.contains(":= SDSP_Begun AND (c); END_TRANSITION"), "{text}");
}

#[test]
fn loops_run_also_where_the_first_value_is_the_last() {
    let text = words(&low("PROGRAM P\nVAR i : INT; j : INT; n : INT; END_VAR\n\
                           FOR i := 1 TO 1 DO FOR j := 9 TO 1 BY -2 DO n := n + 1; END_FOR; END_FOR;\n\
                           FOR i := 0 TO n DO n := n - 1; END_FOR;\nEND_PROGRAM\n"));
    let nested =
        "i := 1; WHILE i <= 1 DO j := 9; WHILE j >= 1 DO n := n + 1; j := j - 2; END_WHILE; i := i + 1; END_WHILE;";
    assert!(text.contains(nested), "{text}");
    assert!(text.contains(": INT; END_VAR") && text.contains(":= n; WHILE i <= Last_"), "{text}");
}

#[test]
fn branches_have_statements_and_comments_are_of_the_second_edition() {
    let text =
        low("PROGRAM P\nVAR a : BOOL; END_VAR\n// one (* two\nIF a THEN ; ELSE a := TRUE; END_IF; {pragma}\n;\n\
                    END_PROGRAM\n");
    assert!(text.contains("(* one ( * two *)") && !text.contains("pragma"), "{text}");
    assert!(words(&text).contains("IF a THEN WHILE FALSE DO EXIT; END_WHILE; ELSE a := TRUE; END_IF;"), "{text}");
}

#[test]
fn global_variables_are_declared_where_they_are_used() {
    let text = low("VAR_GLOBAL g : INT; h : INT; END_VAR\nVAR_GLOBAL CONSTANT k : INT := 2; END_VAR\n\
                    PROGRAM P\nVAR_EXTERNAL h : INT; END_VAR\ng := h + k;\nEND_PROGRAM\n");
    assert!(text.contains("VAR_EXTERNAL g : INT; END_VAR\nVAR_EXTERNAL CONSTANT k : INT; END_VAR"), "{text}");
    assert_eq!(text.matches("VAR_EXTERNAL h").count(), 1, "{text}");
}

#[test]
fn arrays_of_structures_get_their_values_in_the_first_scan() {
    let text = low("TYPE T : STRUCT X : INT; END_STRUCT; END_TYPE\nPROGRAM P\n\
                    VAR t : ARRAY [1..2] OF T := [(X := 5), (X := 6)]; END_VAR\nt[1].X := 1;\nEND_PROGRAM\n");
    let text = words(&text);
    assert!(text.contains("t : ARRAY [1..2] OF T; END_VAR VAR Values_Given : BOOL; END_VAR"), "{text}");
    assert!(
        text.contains("IF NOT Values_Given THEN Values_Given := TRUE; t[1].X := 5; t[2].X := 6; END_IF;"),
        "{text}"
    );
}

#[test]
fn what_there_is_no_way_for_is_refused_at_its_line() {
    let found =
        refused("PROGRAM P\nVAR t : LTIME; n : DINT; END_VAR\nWHILE n < 3 DO\nCONTINUE;\nEND_WHILE;\nEND_PROGRAM\n");
    let found: Vec<_> = found.iter().map(|(line, message)| format!("{line:?} {message}")).collect();
    let expected = ["Some(4) CONTINUE cannot be had in MatIEC", "Some(2) the type LTIME cannot be had in MatIEC"];
    assert_eq!(found, expected);
}

#[test]
fn the_file_has_an_order_and_a_configuration() {
    let text = "PROGRAM P\nVAR s : Outer; END_VAR\ns.i.x := F(1);\nEND_PROGRAM\nVAR_GLOBAL g : INT := 7; h AT %MW3 : INT; END_VAR\n\
                FUNCTION F : INT VAR_INPUT a : INT; END_VAR F := a; END_FUNCTION\n\
                TYPE Outer : STRUCT i : Inner; END_STRUCT; Inner : STRUCT x, y : INT; END_STRUCT; END_TYPE\n";
    let cycle = Cycle { interval: "T#10ms".to_owned(), programs: vec![("Run_P".to_owned(), "P".to_owned())] };
    let addresses = BTreeMap::from([("G".to_owned(), "%MW0".to_owned())]);
    let whole = assembled(text, Dialect::default(), &addresses, &cycle);
    let at = |part: &str| whole.find(part).unwrap_or_else(|| panic!("{part}: {whole}"));
    let order = ["Inner : STRUCT", "Outer : STRUCT", "FUNCTION F", "PROGRAM P", "CONFIGURATION Config0"];
    assert!(order.map(at).is_sorted(), "{whole}");
    assert!(whole.contains("g AT %MW0 : INT := 7;") && whole.contains("h AT %MW3 : INT;"), "{whole}");
    assert!(whole.contains("PROGRAM Run_P WITH SDSP_Cycle : P;"), "{whole}");
}

#[test]
fn variables_get_other_names_where_matiec_keeps_them() {
    let text = low("TYPE T : STRUCT left, step : INT; END_STRUCT; END_TYPE\n\
                    FUNCTION_BLOCK B VAR_INPUT limit : INT; END_VAR VAR_OUTPUT len : INT; END_VAR len := limit; \
                    END_FUNCTION_BLOCK\n\
                    PROGRAM P\nVAR move : B; t : T; n : INT; ramp : TON; s : STRING; END_VAR\n\
                    CASE n OF 1: move(limit := t.left); ELSE ramp(IN := n > 1); END_CASE;\n\
                    t.step := move.len + LEN(s) + LIMIT(0, n, 5);\nEND_PROGRAM\n");
    assert!(text.contains("VAR_INPUT limit_v : INT;") && text.contains("len_v := limit_v;"), "{text}");
    assert!(text.contains("1: move_v(limit_v := t.left);") && text.contains("ramp_v(IN := n > 1)"), "{text}");
    assert!(text.contains("move_v : B;") && text.contains("ramp_v : TON;"), "{text}");
    assert!(text.contains("t.step_v := move_v.len_v + LEN(s) + LIMIT(0, n, 5);"), "{text}");
    assert_eq!(
        refused("VAR_GLOBAL limit : INT; END_VAR\nPROGRAM P\nVAR n : INT; END_VAR\nn := limit;\nEND_PROGRAM\n"),
        [(Some(1), "a global variable of the name `limit` cannot be had in MatIEC".to_owned())]
    );
}

#[test]
fn functions_get_the_global_variables_that_they_use() {
    let text = words(&low("VAR_GLOBAL g, h : INT; END_VAR\nVAR_GLOBAL CONSTANT k : INT := 2; END_VAR\n\
         FUNCTION Inner : INT VAR_INPUT a : INT; END_VAR VAR_EXTERNAL g : INT; END_VAR g := g + a * k; Inner := g; \
         END_FUNCTION\n\
         FUNCTION Outer : INT VAR_INPUT b : INT; END_VAR Outer := Inner(b) + h; END_FUNCTION\n\
         PROGRAM P\nVAR n : INT; END_VAR\nn := Outer(b := 1);\nEND_PROGRAM\n"));
    assert!(text.contains("FUNCTION Inner : INT VAR_IN_OUT g : INT; END_VAR VAR_INPUT k : INT; END_VAR"), "{text}");
    assert!(text.contains("Outer := Inner(g, k, b) + h;"), "{text}");
    assert!(text.contains("n := Outer(g := g, k := k, h := h, b := 1);"), "{text}");
    assert!(text.contains("VAR_EXTERNAL g : INT; END_VAR VAR_EXTERNAL h : INT; END_VAR"), "{text}");
    let found = refused(
        "VAR_GLOBAL g : INT; END_VAR\nFUNCTION F : INT g := 1; F := g; END_FUNCTION\n\
         PROGRAM P\nVAR g : INT; END_VAR\ng := F();\nEND_PROGRAM\n",
    );
    let what = "a variable `g` that hides the global one which `F` uses cannot be had in MatIEC";
    assert_eq!(found, [(Some(5), what.to_owned())]);
}

#[test]
fn functions_are_called_for_their_values_alone() {
    let text = words(&low("FUNCTION F : INT VAR_INPUT a : INT; END_VAR F := a; END_FUNCTION\n\
         FUNCTION G VAR n : INT; END_VAR n := 1; END_FUNCTION\n\
         PROGRAM P\nVAR n : INT; END_VAR\nF(a := 1);\nG();\nEND_PROGRAM\n"));
    assert!(text.contains("FUNCTION G : BOOL VAR_INPUT Unused_Input : BOOL; END_VAR VAR n : INT;"), "{text}");
    assert!(text.contains("VAR Unread_BOOL : BOOL; END_VAR VAR Unread_INT : INT; END_VAR"), "{text}");
    assert!(text.contains("Unread_INT := F(a := 1); Unread_BOOL := G(Unused_Input := FALSE);"), "{text}");
    let block = "FUNCTION F : INT VAR_IN_OUT a : INT; END_VAR F := a; END_FUNCTION\n\
                 FUNCTION H : INT VAR_INPUT a : INT; END_VAR H := a; END_FUNCTION\n";
    let found = refused(&format!(
        "{block}PROGRAM P\nVAR n : ARRAY [1..2] OF INT; m : INT; END_VAR\nm := F(a := n[1]);\nm := H(F(a := m));\n\
         END_PROGRAM\n"
    ));
    let found: Vec<_> = found.iter().map(|(line, message)| format!("{line:?} {message}")).collect();
    let expected = [
        "Some(5) an element of an array as VAR_IN_OUT of a function cannot be had in MatIEC",
        "Some(6) a call with VAR_IN_OUT or VAR_OUTPUT inside of another cannot be had in MatIEC",
    ];
    assert_eq!(found, expected);
}

#[test]
fn conversions_mean_what_they_do_in_the_project() {
    let source = "PROGRAM P\nVAR t : TIME; d : DINT; l : LREAL; r : REAL; w : WORD; b : BOOL; o : TOD; END_VAR\n\
                  d := TIME_TO_DINT(t); l := TIME_TO_LREAL(t + T#1s); t := DINT_TO_TIME(d); t := REAL_TO_TIME(r);\n\
                  b := WORD_TO_BOOL(w); d := TOD_TO_DINT(o); t := TO_TIME(d);\nEND_PROGRAM\n";
    let text = low(source);
    for expected in [
        "d := LINT_TO_DINT(SDSP_Nanoseconds(t) / 1000000);",
        "l := (LINT_TO_LREAL(SDSP_Nanoseconds(t + T#1s)) / 1000000.0);",
        "t := SDSP_Duration(DINT_TO_LINT(d) * 1000000);",
        "t := SDSP_Duration(LREAL_TO_LINT(REAL_TO_LREAL(r) * 1000000.0));",
        "b := (((w) AND WORD#1) <> WORD#0);",
        "d := LINT_TO_DINT(SDSP_Nanoseconds((o) - TOD#00:00:00) / 1000000);",
    ] {
        assert!(text.contains(expected), "{expected}: {text}");
    }
    let own = lowered(source, Dialect::Matiec).map(|lowered| lowered.text).unwrap_or_default();
    assert!(own.contains("d := TIME_TO_DINT(t);") && own.contains("b := WORD_TO_BOOL(w);"), "{own}");
}
