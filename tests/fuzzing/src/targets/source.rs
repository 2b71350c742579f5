//! What PLCs are programmed with, and what tools say of them.

use std::path::Path;

use onescan::io_list::{Wanted, read};
use onescan_base::VirtualTime;
use onescan_iec::input::kind::SourceKind;
use onescan_iec::input::project::{files as project_files, listing};
use onescan_iec::syntax::printer::print_unit;
use onescan_iec::syntax::{FileId, parse};
use onescan_iec::{Input, Task, TaskPlan, inspect};
use onescan_iec_project::instrument::{Options, Target, instrument, remove};
use onescan_iec_run::{Application, SoftPlc};

use super::{Prepared, files, root, seed};

/// The whole way of a source: checked, compiled, three scans, instrumented for two tools.
fn goes_all_the_way(name: &str, kind: SourceKind, bytes: &[u8]) -> bool {
    let input = Input::read(name, kind, bytes);
    if inspect([input.clone()], None).has_errors() {
        return false;
    }
    let Ok(application) = Application::builder().input(input.clone()).build() else { return false };
    let plan = application.configured_tasks().unwrap_or_else(|| {
        let programs = application.programs().filter(|each| !each.is_called).map(|each| each.name).collect();
        let interval = "10ms".parse().ok();
        TaskPlan::new(vec![Task { name: "main".to_owned(), interval, programs, ..Task::default() }])
    });
    if let Ok(mut plc) = SoftPlc::new(&application, &plan) {
        for step in 0..3 {
            // A fault of the program is a result.
            if plc.scan(VirtualTime::from_nanos(step * 10_000_000)).is_err() {
                break;
            }
        }
        let state = plc.save();
        plc.restore(&state).expect("a PLC takes back what it has saved");
    }
    for target in [Target::Iec, Target::TwinCat] {
        let options = Options { target, ..Options::default() };
        // Not all that can be run can be instrumented for everybody.
        let _ = instrument(std::slice::from_ref(&input), &options);
    }
    let _ = remove(&[input]);
    true
}

/// What parses is printed so that it parses to the same text again.
fn prints_what_it_parses(text: &str) {
    let parsed = parse(FileId(0), text);
    if !parsed.diagnostics.is_empty() {
        return;
    }
    let printed = print_unit(&parsed.unit);
    let again = parse(FileId(0), &printed);
    assert!(again.diagnostics.is_empty(), "what is printed parses");
    assert_eq!(print_unit(&again.unit), printed, "what is printed is stable");
}

/// Structured Text and what else is text.
pub(super) fn st(_: &Path) -> Prepared {
    let mut seeds = files("plc-shim/iec", &[".st"]);
    seeds.extend(files("plc-shim/tests", &[".st"]));
    seeds.extend(files("scenarios", &[".st"]));
    Prepared::new(seeds, |input| {
        prints_what_it_parses(&String::from_utf8_lossy(input));
        goes_all_the_way("source.st", SourceKind::Text, input)
    })
}

/// Siemens' dialect.
pub(super) fn scl(_: &Path) -> Prepared {
    let mut seeds = files("plc-shim/iec-project/shim/scl", &[".scl"]);
    seeds.extend(files("tests/session", &[".scl"]));
    Prepared::new(seeds, |input| goes_all_the_way("source.scl", SourceKind::Text, input))
}

/// Text, networks, charts and drawings in PLCopen XML.
pub(super) fn plcopen(_: &Path) -> Prepared {
    let mut seeds = files("plc-shim/tests/inputs", &[".xml"]);
    seeds.extend(files("scenarios", &[".xml"]));
    Prepared::new(seeds, |input| goes_all_the_way("source.xml", SourceKind::PlcOpen, input))
}

/// Objects of TwinCAT, drawn ones, too.
pub(super) fn twincat(_: &Path) -> Prepared {
    let mut seeds = files("plc-shim/tests/inputs", &[".TcPOU"]);
    seeds.push(seed("tank.TcPOU"));
    Prepared::new(seeds, |input| goes_all_the_way("source.TcPOU", SourceKind::TwinCat, input))
}

/// `.plcproj`.
pub(super) fn project(_: &Path) -> Prepared {
    let text = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<Project DefaultTargets=\"Build\" xmlns=\"http://schemas.microsoft.com/\
                developer/msbuild/2003\"><PropertyGroup><Name>cell</Name></PropertyGroup><ItemGroup>\n\
                <Compile Include=\"POUs\\MAIN.TcPOU\"><SubType>Code</SubType></Compile>\n\
                <Compile Include=\"GVLs\\IO.TcGVL\"/><None Include=\"a.tmc\"/></ItemGroup>\n\
                <ItemGroup><PlaceholderReference Include=\"Tc2_Standard\"><DefaultResolution>Tc2_Standard, * (Beckhoff Automation \
                GmbH)</DefaultResolution><Namespace>Tc2_Standard</Namespace></PlaceholderReference></ItemGroup></Project>\n";
    Prepared::new(vec![text.as_bytes().to_vec()], |input| {
        let listed = listing(input).is_ok();
        assert_eq!(project_files(input).is_ok(), listed);
        listed
    })
}

/// Lists of inputs and outputs; the first byte says whose.
pub(super) fn io_list(scratch: &Path) -> Prepared {
    let fixtures = root().join("cli/program/src/io_list/fixtures");
    let mut names: Vec<String> = std::fs::read_dir(&fixtures)
        .expect("fixtures")
        .map(|entry| entry.expect("a fixture").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    let of = |(number, name): (usize, &String)| {
        let bytes = std::fs::read(fixtures.join(name)).expect("a fixture");
        [vec![b'a' + number as u8], bytes].concat()
    };
    let seeds = names.iter().enumerate().map(of).collect();
    let folder = scratch.join("list");
    std::fs::create_dir_all(&folder).expect("a scratch folder");
    Prepared::new(seeds, move |input| {
        let Some((number, bytes)) = input.split_first() else { return false };
        let path = folder.join(&names[usize::from(number.wrapping_sub(b'a')) % names.len()]);
        std::fs::write(&path, bytes).expect("a scratch folder");
        let list = read(&Wanted { from: path.display().to_string(), kind: None, plc: None });
        list.is_ok_and(|list| !list.points.is_empty())
    })
}
