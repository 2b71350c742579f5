//! `check` and `explain` as they are typed: what is found, for people and for machines.

use std::path::Path;

use crate::typed::{Said, copied_shear, edit, scenario, typed};

/// A folder with these files.
fn folder(files: &[(&str, &[u8])]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }
    folder
}

fn checked(folder: &Path, words: &[&str]) -> Said {
    let mut all = vec!["check"];
    all.extend_from_slice(words);
    let said = typed(folder, &all);
    assert!(!said.err.contains("panicked"), "{said:?}");
    said
}

const CLEAN: &[u8] = b"PROGRAM Main VAR_OUTPUT o : INT; END_VAR o := o + 1; END_PROGRAM\n";

/// An error, a warning of the compiler, and a file that is good.
const WRONG: &[(&str, &[u8])] = &[
    ("a.st", b"PROGRAM A\nVAR level : INT; END_VAR\n  level := levle + 1;\n  ABS(level);\nEND_PROGRAM\n"),
    ("b/good.st", CLEAN),
];

const POU: &[u8] = br#"<?xml version="1.0" encoding="utf-8"?>
<TcPlcObject Version="1.1.0.1">
  <POU Name="FB_Ramp">
    <Declaration><![CDATA[FUNCTION_BLOCK FB_Ramp
VAR_INPUT up : BOOL; END_VAR
VAR_OUTPUT level : INT; END_VAR]]></Declaration>
    <Implementation>
      <ST><![CDATA[IF up THEN
  level := levle + 1;
END_IF]]></ST>
    </Implementation>
    <Method Name="Reset"><Declaration><![CDATA[METHOD Reset]]></Declaration></Method>
  </POU>
</TcPlcObject>
"#;

#[test]
fn all_is_well() {
    let folder = folder(&[("main.st", CLEAN)]);
    let said = checked(folder.path(), &["main.st"]);
    assert_eq!((said.code, said.out.as_str(), said.err.as_str()), (Some(0), "1 file, no findings\n", ""));
    assert_eq!(checked(folder.path(), &["main.st", "./main.st", "."]).out, "1 file, no findings\n");
    assert_eq!(checked(folder.path(), &["main.st", "--format", "json"]).out, "");
}

#[test]
fn a_dialect_is_reported_by_name_flag_and_scenario() {
    let latch: &[u8] = b"PROGRAM Main VAR_OUTPUT o : BOOL; END_VAR VAR_INPUT i : BOOL; END_VAR o S= i; END_PROGRAM\n";
    let folder = folder(&[("latch.st", latch), ("latch.exp", latch)]);
    assert_eq!(checked(folder.path(), &["latch.exp"]).code, Some(0));
    assert_eq!(checked(folder.path(), &["latch.st", "--dialect", "twincat"]).code, Some(0));
    let said = checked(folder.path(), &["latch.st", "--format", "json"]);
    assert!(said.code == Some(2) && said.out.contains("S0110") && said.out.contains("codesys and twincat"), "{said:?}");
    let said = checked(folder.path(), &["latch.st", "--dialect", "s7"]);
    assert!(said.code == Some(2) && said.err.contains("siemens-scl"), "{said:?}");

    let shear = copied_shear();
    edit(shear.path(), "scenario.toml", "sources = ", "dialect = \"codesys\"\nsources = ");
    assert_eq!(checked(shear.path(), &["."]).code, Some(0));
    edit(shear.path(), "scenario.toml", "\"codesys\"", "\"s7\"");
    let said = checked(shear.path(), &["."]);
    assert!(said.code == Some(2) && said.err.contains("`s7` is not a dialect"), "{said:?}");
}

/// As `OpenPLC` Editor leaves its folder after a build: the program is there three times.
#[test]
fn what_beremiz_generates_is_passed_over() {
    let xml = br#"<?xml version="1.0" encoding="utf-8"?>
<project xmlns="http://www.plcopen.org/xml/tc6_0201"><fileHeader companyName="" productName="" productVersion="1"
 creationDateTime="2026-01-01T00:00:00"/><contentHeader name="x"><coordinateInfo><fbd><scaling x="1" y="1"/></fbd>
<ld><scaling x="1" y="1"/></ld><sfc><scaling x="1" y="1"/></sfc></coordinateInfo></contentHeader><types><dataTypes/><pous>
<pou name="Main" pouType="program"><interface><outputVars><variable name="o"><type><INT/></type></variable></outputVars>
</interface><body><ST><xhtml xmlns="http://www.w3.org/1999/xhtml">o := o + 1;</xhtml></ST></body></pou></pous></types>
<instances><configurations/></instances></project>"#;
    let files: [(&str, &[u8]); 5] = [
        ("plc.xml", xml),
        ("beremiz.xml", b"<BeremizRoot/>"),
        ("exported.st", CLEAN),
        ("build/plc.st", CLEAN),
        ("build/generated_plc.st", CLEAN),
    ];
    let project = folder(&files);
    let said = checked(project.path(), &["."]);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(said.out.contains("3 generated files passed over"), "{said:?}");
    // Without Beremiz' own file they are sources as any others.
    assert_eq!(checked(folder(&[files[0], files[2]]).path(), &["."]).code, Some(2));
}

#[test]
fn a_word_size_is_that_of_flag_text_and_scenario() {
    let cut: &[u8] =
        b"PROGRAM Main VAR_OUTPUT o : LINT; END_VAR VAR_INPUT i : DINT; END_VAR o := i * 1000; END_PROGRAM\n";
    let named = [b"{dialect 'codesys' 32}\n", cut].concat();
    let folder = folder(&[("wide.exp", cut), ("small.st", named.as_slice())]);
    let is_cut = |arguments: &[&str]| checked(folder.path(), arguments).out.contains("W0713");
    assert!(!is_cut(&["wide.exp"]) && is_cut(&["wide.exp", "--word-size", "32"]));
    assert!(is_cut(&["small.st"]) && !is_cut(&["small.st", "--word-size", "64"]));
    let said = checked(folder.path(), &["wide.exp", "--word-size", "16"]);
    assert!(said.code == Some(2) && said.err.contains("`16` is not a word size: 32 or 64 bits"), "{said:?}");

    let shear = copied_shear();
    edit(shear.path(), "scenario.toml", "sources = ", "dialect = \"codesys\"\nword_size_bits = 32\nsources = ");
    assert_eq!(checked(shear.path(), &["."]).code, Some(0));
    edit(shear.path(), "scenario.toml", "word_size_bits = 32", "word_size_bits = 16");
    let said = checked(shear.path(), &["."]);
    assert!(said.code == Some(2) && said.err.contains("`16` is not a word size"), "{said:?}");
}

#[test]
fn findings_read_well() {
    let said = checked(folder(WRONG).path(), &["."]);
    assert_eq!((said.code, said.err.as_str()), (Some(2), ""), "{said:?}");
    insta::assert_snapshot!(said.out);
}

#[test]
fn findings_are_json_lines() {
    let said = checked(folder(WRONG).path(), &[".", "--format", "json"]);
    assert_eq!(said.code, Some(2));
    insta::assert_snapshot!(said.out);
}

#[test]
fn findings_are_a_sarif_log() {
    let said = checked(folder(WRONG).path(), &[".", "--format", "sarif"]);
    assert_eq!(said.code, Some(2));
    let mut log: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    let driver = &mut log["runs"][0]["tool"]["driver"];
    let rules = driver["rules"].as_array_mut().unwrap();
    assert!(rules.len() > 40 && rules.iter().all(|rule| rule["id"].is_string()));
    let named = rules.iter().position(|rule| rule["id"] == "N0101").unwrap();
    assert_eq!(log["runs"][0]["results"][0]["ruleIndex"], named);
    log["runs"][0]["tool"]["driver"]["rules"] = "left out".into();
    log["runs"][0]["tool"]["driver"]["version"] = "left out".into();
    for result in log["runs"][0]["results"].as_array_mut().unwrap() {
        result["ruleIndex"] = "left out".into();
    }
    insta::assert_snapshot!(serde_json::to_string_pretty(&log).unwrap());
}

#[test]
fn places_in_twincat_files_are_those_of_the_file() {
    let folder = folder(&[("POUs/FB_Ramp.TcPOU", POU)]);
    let said = checked(folder.path(), &["."]);
    assert_eq!(said.code, Some(2), "{said:?}");
    insta::assert_snapshot!(said.out);
}

#[test]
fn a_project_says_which_files_are_meant() {
    let project = br#"<Project><ItemGroup>
        <Compile Include="POUs\Main.TcPOU"/><Compile Include="Task.TcTTO"/>
    </ItemGroup></Project>"#;
    let main = br"<TcPlcObject><POU Name='Main'><Declaration><![CDATA[PROGRAM Main]]></Declaration>
        <Implementation><ST><![CDATA[]]></ST></Implementation></POU></TcPlcObject>";
    let task = br#"<TcPlcObject><Task Name="PlcTask"><CycleTime>10000</CycleTime><Priority>20</Priority>
        <PouCall><Name>Main</Name></PouCall></Task></TcPlcObject>"#;
    let files: [(&str, &[u8]); 4] =
        [("plc.plcproj", project), ("POUs/Main.TcPOU", main), ("Task.TcTTO", task), ("POUs/Old.TcPOU", b"left over")];
    let folder = folder(&files);
    for words in ["plc.plcproj", "."] {
        assert_eq!(checked(folder.path(), &[words]).out, "2 files, no findings\n");
    }
}

#[test]
fn a_missing_file_of_a_project_is_reported_and_the_others_are_checked() {
    let project = b"<Project><ItemGroup>\n  <Compile Include=\"POUs\\FB_Ramp.TcPOU\"/>\n  <Compile Include=\"Old.TcDUT\"/>\n</ItemGroup></Project>";
    let folder = folder(&[("plc.plcproj", project), ("POUs/FB_Ramp.TcPOU", POU)]);
    let said = checked(folder.path(), &["."]);
    assert_eq!((said.code, said.err.as_str()), (Some(2), ""), "{said:?}");
    insta::assert_snapshot!(said.out);
}

#[test]
fn a_file_that_is_quite_wrong_does_not_hide_the_others() {
    let wrong =
        format!("PROGRAM Wrong\nVAR a : INT; END_VAR\n{}END_PROGRAM\n", "  a := missing.x;;\n  a = 1;\n".repeat(40));
    let folder = folder(&[("a.st", wrong.as_bytes()), ("b.st", WRONG[0].1)]);
    let said = checked(folder.path(), &["."]);
    let lines: Vec<&str> =
        said.out.lines().filter(|line| line.contains("more") || line.contains("in 2 files")).collect();
    assert_eq!(lines, ["... and 16 more errors in a.st", "42 errors, 1 warning in 2 files"]);
    let json = checked(folder.path(), &[".", "--format", "json"]);
    assert_eq!(json.out.lines().count(), 43, "machines receive all");
}

#[test]
fn a_run_of_what_does_not_compile_ends_with_the_error_and_the_count() {
    let folder = copied_shear();
    edit(folder.path(), "plc/alignment.st", "a.Q AND b.Q", "a.Q AND bb.Q");
    let path = folder.path().join("plc/alignment.st");
    let text = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, format!("{text}\nPROGRAM Later VAR x : INT; END_VAR ABS(x); ABS(x); END_PROGRAM\n")).unwrap();
    let said = typed(folder.path(), &["run", "."]);
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(said.err.contains("N0101") && !said.err.contains("C0307"), "{said:?}");
    let end = "1 error, 2 warnings; `onescan check` shows the warnings";
    assert!(said.err.trim_end().ends_with(end), "{said:?}");
}

#[test]
fn more_memory_is_a_setting() {
    let big = b"PROGRAM Big VAR_OUTPUT o : USINT; END_VAR VAR list : ARRAY[0..99999999] OF USINT; END_VAR
        o := list[o]; list[0] := 1; END_PROGRAM\n";
    let folder = folder(&[("big.st", big)]);
    let said = checked(folder.path(), &["big.st"]);
    assert!(said.code == Some(2) && said.out.contains("L0502"), "{said:?}");
    assert_eq!(checked(folder.path(), &["big.st", "--memory-limit", "96"]).out, "1 file, no findings\n");
    assert_eq!(checked(folder.path(), &["big.st", "--memory-limit", "95"]).code, Some(2));
    for (limit, why) in [("0", "from 1 to 2047"), ("2048", "from 1 to 2047"), ("much", "not a whole number")] {
        let said = checked(folder.path(), &["big.st", "--memory-limit", limit]);
        assert!(said.code == Some(2) && said.err.contains(why), "{said:?}");
    }
}

#[test]
fn a_scenario_says_how_much_memory_its_plc_has() {
    let folder = copied_shear();
    edit(
        folder.path(),
        "plc/alignment.st",
        "VAR_OUTPUT\n",
        "VAR\n  list : ARRAY[0..99999999] OF BYTE;\nEND_VAR\nVAR_OUTPUT\n",
    );
    assert!(checked(folder.path(), &["."]).out.contains("L0502"));
    assert!(typed(folder.path(), &["run", "."]).err.contains("L0502"));
    let edited = |limit: &str| {
        edit(
            folder.path(),
            "scenario.toml",
            "kind = \"soft-plc\"",
            &format!("kind = \"soft-plc\"\nmemory_limit_mib = {limit}"),
        );
    };
    edited("128");
    assert!(!checked(folder.path(), &["."]).out.contains("L0502"));
    let said = typed(folder.path(), &["run", ".", "--until", "100ms"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    edit(folder.path(), "scenario.toml", "memory_limit_mib = 128", "memory_limit_mib = 5000");
    let said = typed(folder.path(), &["run", "."]);
    assert!(said.code == Some(2) && said.err.contains("from 1 to 2047"), "{said:?}");
}

#[test]
fn the_sources_of_a_scenario_are_clean() {
    let said = checked(&scenario("shear"), &["."]);
    assert_eq!((said.code, said.out.as_str()), (Some(0), "2 files, no findings\n"), "{said:?}");
    let folder = copied_shear();
    edit(folder.path(), "plc/alignment.st", "a.Q AND b.Q", "a.Q AND bb.Q");
    let said = checked(folder.path(), &["scenario.toml"]);
    assert_eq!(said.code, Some(2));
    assert!(said.out.ends_with("1 error in 1 file\n"), "{said:?}");
}

#[test]
fn warnings_fail_only_where_they_are_denied() {
    let folder = folder(&[("w.st", b"PROGRAM P VAR x : INT; END_VAR END_PROGRAM")]);
    let said = checked(folder.path(), &["w.st"]);
    assert!(said.code == Some(0) && said.out.ends_with("1 warning in 1 file\n"), "{said:?}");
    assert_eq!(checked(folder.path(), &["w.st", "--deny-warnings"]).code, Some(1));
    std::fs::write(folder.path().join("e.st"), "PROGRAM E x := 1; END_PROGRAM").unwrap();
    assert_eq!(checked(folder.path(), &["w.st", "e.st", "--deny-warnings"]).code, Some(2));
}

#[test]
fn files_that_are_not_sources_are_reported() {
    let folder = folder(&[("notes.txt", b"x"), ("empty/readme.md", b"")]);
    let cases = [
        (&["missing.st"][..], "missing.st: "),
        (&["missing.txt"], "missing.txt: "),
        (&["notes.txt"], "notes.txt is of no kind that is read"),
        (&["empty"], "there are no PLC sources here"),
        (&[], "there are no PLC sources here"),
    ];
    for (words, message) in cases {
        let said = checked(folder.path(), words);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{said:?}");
        assert!(said.err.contains(message), "{words:?} {said:?}");
    }
}

/// A PLCopen XML project with an undeclared name.
const PROJECT: &str = r#"<?xml version="1.0" encoding="utf-16"?>
<project xmlns="http://www.plcopen.org/xml/tc6_0201"><types><pous><pou name="B" pouType="program">
<body><ST><xhtml xmlns="http://www.w3.org/1999/xhtml">nowhere := 1;</xhtml></ST></body>
</pou></pous></types></project>
"#;

fn utf_16(text: &str) -> Vec<u8> {
    "\u{feff}".encode_utf16().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect()
}

#[test]
fn a_folder_reads_every_encoding_that_a_named_file_may_have() {
    let folder = folder(&[("a.st", CLEAN), ("b.xml", &utf_16(PROJECT))]);
    let named = checked(folder.path(), &["b.xml"]);
    assert!(named.code == Some(2) && named.out.contains("N0101"), "{named:?}");
    assert_eq!(checked(folder.path(), &["."]), named);
    std::fs::write(folder.path().join("b.xml"), PROJECT).unwrap();
    assert_eq!(checked(folder.path(), &["."]), named);
}

#[test]
fn what_is_passed_over_in_a_folder_is_counted() {
    let page = utf_16("<?xml version=\"1.0\"?><page/>");
    let folder = folder(&[("a.st", CLEAN), ("b/page.xml", b"<html/>"), ("c.xml", &page)]);
    let said = checked(folder.path(), &[".", "b"]);
    assert_eq!((said.code, said.out.as_str()), (Some(0), "1 file, no findings; 2 other XML files passed over\n"));
    let said = checked(folder.path(), &[".", "--format", "json"]);
    assert_eq!((said.code, said.out.as_str()), (Some(0), "{\"passed_over\":{\"other_xml\":2}}\n"));
    let log: serde_json::Value =
        serde_json::from_str(&checked(folder.path(), &[".", "--format", "sarif"]).out).unwrap();
    let notice = &log["runs"][0]["invocations"][0]["toolExecutionNotifications"][0]["message"]["text"];
    assert_eq!(notice, "2 other XML files passed over");
    let said = checked(folder.path(), &["b"]);
    assert!(said.code == Some(2) && said.err.contains("1 other XML file passed over"), "{said:?}");
    // A named file is meant, whatever is in it.
    let said = checked(folder.path(), &[".", "b/page.xml"]);
    assert!(said.code == Some(2) && said.out.ends_with("in 1 file; 1 other XML file passed over\n"), "{said:?}");
}

#[test]
fn a_project_with_its_shim_as_one_file_is_passed_over_beside_its_sources() {
    let whole: &[u8] = b"(*@sdsp whole*)\nPROGRAM Main VAR_OUTPUT o : INT; END_VAR o := o + 1; END_PROGRAM\n";
    let folder = folder(&[("a.st", CLEAN), ("sdsp.st", whole)]);
    let said = checked(folder.path(), &["."]);
    assert_eq!((said.code, said.out.as_str()), (Some(0), "1 file, no findings; 1 instrumented project passed over\n"));
    let said = checked(folder.path(), &[".", "--format", "json"]);
    assert_eq!(said.out, "{\"passed_over\":{\"instrumented_projects\":1}}\n");
    std::fs::remove_file(folder.path().join("a.st")).unwrap();
    assert_eq!(checked(folder.path(), &["."]).out, "1 file, no findings\n");
}

#[test]
fn what_cannot_be_read_in_a_folder_is_an_error() {
    let koi: &[u8] = b"<?xml version=\"1.0\" encoding=\"koi8-r\"?><a/>";
    let folder = folder(&[("a.st", CLEAN), ("b.xml", koi)]);
    let said = checked(folder.path(), &["."]);
    assert!(said.code == Some(2) && said.out.contains("the encoding `koi8-r` is not read"), "{said:?}");
    // A file of the largest size and a byte, of which nothing is on the disk.
    let large = std::fs::File::create(folder.path().join("b.xml")).unwrap();
    large.set_len((64 << 20) + 1).unwrap();
    let said = checked(folder.path(), &["."]);
    assert!(said.code == Some(2) && said.err.contains("b.xml: it is larger than 64 MiB"), "{said:?}");
}

#[test]
fn strange_files_give_findings_and_never_a_panic() {
    let huge = format!("PROGRAM P VAR x : INT; END_VAR {} y := 1; END_PROGRAM", "x := x + 1;".repeat(50_000));
    let garbage: Vec<u8> = (0..20_000_u32).map(|at| (at.wrapping_mul(2_654_435_761) >> 13) as u8 | 1).collect();
    let files: &[(&str, &[u8])] = &[
        ("empty.st", b""),
        ("blank.TcPOU", b""),
        ("binary.st", b"\x7fELF\x02\x01\0\0"),
        ("garbage.st", &garbage),
        ("garbage.TcPOU", &garbage),
        ("garbage.xml", &garbage),
        ("huge.st", huge.as_bytes()),
        ("half.TcPOU", &POU[..POU.len() / 2]),
        ("latin.st", b"(* F\xf6rderband *) PROGRAM P VAR_OUTPUT x : INT; END_VAR x := 1; END_PROGRAM"),
        ("wide.st", b"\xff\xfe;\0\n\0"),
        ("odd.st", b"\xff\xfe;\0\n"),
        ("page.xml", b"<html/>"),
    ];
    let folder = folder(files);
    let mut table = Vec::new();
    for (name, _) in files {
        let said = checked(folder.path(), &[name]);
        let last = said.out.lines().last().unwrap_or_default();
        let first = said.out.lines().find(|line| !line.trim().is_empty()).unwrap_or_default();
        let first: String = first.chars().take(90).collect();
        // What is found in garbage is of no interest, only that it is.
        let shown = if name.starts_with("garbage.st") { "garbage" } else { first.trim() };
        let last = if name.starts_with("garbage.st") { "" } else { last };
        table.push(format!("{name}: {} | {shown} | {last}", said.code.unwrap()));
        assert!(said.out.len() < 200_000, "{name}: {} bytes", said.out.len());
    }
    insta::assert_snapshot!(table.join("\n"));
}

#[test]
fn codes_are_explained() {
    let here = Path::new(".");
    let said = typed(here, &["explain", "w0703"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    insta::assert_snapshot!(said.out);
    let list = typed(here, &["explain", "--list"]).out;
    assert!(list.contains("N0101  a name is not declared\n") && list.lines().count() > 40, "{list}");
    let said = typed(here, &["explain", "X1"]);
    assert_eq!((said.code, said.out.as_str()), (Some(2), ""));
    assert!(said.err.contains("there is no code `X1`"), "{said:?}");
    assert_eq!(typed(here, &["explain"]).code, Some(2));
}
