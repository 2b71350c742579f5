//! Library stubs as they are typed: `--write-stubs`, `--deny-stubs`, and a run in which a stub does nothing.

use std::path::Path;

use crate::typed::{Said, copied_shear, edit, typed};

const MAIN: &str = "PROGRAM Main VAR fb : FB_Lamp; x : INT; END_VAR
  fb(bOn := TRUE);
  x := F_Level(x) + F_Level(2);
END_PROGRAM
";

fn project(main: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("main.st"), main).unwrap();
    folder
}

fn said(folder: &Path, words: &[&str]) -> Said {
    let said = typed(folder, words);
    assert!(!said.err.contains("panicked"), "{said:?}");
    said
}

#[test]
fn stubs_are_written_once_and_reported_when_they_are_called() {
    let folder = project(MAIN);
    assert_eq!(said(folder.path(), &["check", "."]).code, Some(2));
    let written = said(folder.path(), &["check", "--write-stubs", "."]);
    let path = Path::new(".").join("libraries").join("stubs.st");
    assert_eq!((written.code, written.out), (Some(0), format!("{}: 2 declarations added\n", path.display())));
    let file = folder.path().join("libraries/stubs.st");
    let text = std::fs::read_to_string(&file).unwrap();
    let again = said(folder.path(), &["check", "--write-stubs", "."]);
    assert_eq!((again.code, again.out.as_str()), (Some(0), "nothing is missing that stubs could stand for\n"));
    assert_eq!(std::fs::read_to_string(&file).unwrap(), text);
    assert_eq!(said(folder.path(), &["check", "libraries"]).code, Some(0));

    let warned = said(folder.path(), &["check", ".", "--format", "json"]);
    assert_eq!(warned.code, Some(0), "{warned:?}");
    assert!(warned.out.contains("`F_Level` is a stub: its calls do nothing (first of 2 uses)"), "{warned:?}");
    assert!(warned.out.contains("`FB_Lamp` is a stub: its calls do nothing\""), "{warned:?}");
    assert_eq!(said(folder.path(), &["check", ".", "--deny-stubs"]).code, Some(2));
    assert_eq!(said(folder.path(), &["check", ".", "--deny-warnings"]).code, Some(1));
}

#[test]
fn a_file_of_somebody_else_is_left_alone() {
    let folder = project(MAIN);
    std::fs::create_dir(folder.path().join("libraries")).unwrap();
    let file = folder.path().join("libraries/stubs.st");
    std::fs::write(&file, "// mine\n").unwrap();
    let refused = said(folder.path(), &["check", "--write-stubs", "."]);
    assert_eq!(refused.code, Some(2));
    assert!(refused.err.contains("was not written by `--write-stubs`"), "{refused:?}");
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "// mine\n");
    assert_eq!(said(folder.path(), &["check", "--write-stubs=libraries/made", "."]).code, Some(0));
    assert!(folder.path().join("libraries/made/stubs.st").exists());
    assert_eq!(said(folder.path(), &["check", "."]).code, Some(0));
}

#[test]
fn the_folder_beside_a_twincat_project_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let project = r#"<Project xmlns="http://schemas.microsoft.com/developer/msbuild/2003"><ItemGroup>
<Compile Include="MAIN.TcPOU"/></ItemGroup></Project>"#;
    let main = r#"<TcPlcObject Version="1.1.0.1"><POU Name="MAIN"><Declaration><![CDATA[PROGRAM MAIN
VAR fb : FB_Lamp; END_VAR]]></Declaration><Implementation><ST><![CDATA[fb(bOn := TRUE);]]></ST></Implementation></POU></TcPlcObject>"#;
    std::fs::write(folder.path().join("a.plcproj"), project).unwrap();
    std::fs::write(folder.path().join("MAIN.TcPOU"), main).unwrap();
    assert_eq!(said(folder.path(), &["check", "."]).code, Some(2));
    assert_eq!(said(folder.path(), &["check", "--write-stubs", "."]).code, Some(0));
    assert_eq!(said(folder.path(), &["check", "."]).code, Some(0));
    assert_eq!(said(folder.path(), &["check", "a.plcproj"]).code, Some(0));
}

#[test]
fn tests_run_with_stubs_that_do_nothing_unless_they_are_denied() {
    let folder = project(
        "{external} FUNCTION F_Level : INT VAR_INPUT n : INT; END_VAR F_Level := n + 1; END_FUNCTION
{external} FUNCTION_BLOCK FB_Lamp VAR_INPUT bOn : BOOL; END_VAR VAR_OUTPUT bLit : BOOL := TRUE; nCalls : INT; END_VAR
  nCalls := nCalls + 1;
METHOD Blink : INT Blink := 5; END_METHOD
END_FUNCTION_BLOCK
PROGRAM TEST_Stubs VAR fb : FB_Lamp; END_VAR
  fb(bOn := TRUE); fb();
  ASSERT(fb.bOn AND fb.bLit AND fb.nCalls = 0, 'initial values');
  ASSERT(F_Level(7) = 0 AND fb.Blink() = 0, 'no results');
END_PROGRAM
",
    );
    let passed = said(folder.path(), &["test", "main.st"]);
    assert_eq!(passed.code, Some(0), "{passed:?}");
    let denied = said(folder.path(), &["test", "main.st", "--deny-stubs"]);
    assert_eq!(denied.code, Some(2), "{denied:?}");
    assert!(denied.err.contains("W0710"), "{denied:?}");
}

#[test]
fn a_run_refuses_stubs_where_they_are_denied() {
    let shear = copied_shear();
    let words = ["run", ".", "--until", "20ms", "--deny-stubs"];
    assert_eq!(said(shear.path(), &words).code, Some(0));
    let stub = "{external} FUNCTION Ghost VAR_INPUT n : INT; END_VAR END_FUNCTION\nPROGRAM Shear";
    edit(shear.path(), "plc/shear.st", "PROGRAM Shear", stub);
    let path = shear.path().join("plc/shear.st");
    let text = std::fs::read_to_string(&path).unwrap();
    let end = text.rfind("END_PROGRAM").unwrap();
    std::fs::write(&path, format!("{}Ghost(1);\n{}", &text[..end], &text[end..])).unwrap();
    assert_eq!(said(shear.path(), &["run", ".", "--until", "20ms"]).code, Some(0));
    let denied = said(shear.path(), &words);
    assert_eq!(denied.code, Some(2), "{denied:?}");
    assert!(denied.err.contains("`Ghost` is a stub"), "{denied:?}");
}
