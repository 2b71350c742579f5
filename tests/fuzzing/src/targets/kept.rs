//! What the program has kept itself, and takes back: files that anybody may have changed meanwhile.

use std::ops::Range;
use std::path::{Path, PathBuf};

use onescan_base::VirtualTime;
use onescan_recording::{Choice, ExportFormat, Provenance, Recorder, Recording};
use onescan_regress::snapshot::{Snapshot, compare};
use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_server::checkpoint::Checkpoint;
use onescan_server::client::Client;
use onescan_server::formation::Formation;
use onescan_server::lockstep::Lockstep;
use onescan_server::signal::{ClientName, Port};
use onescan_server::timeline::Timeline;

use super::{Prepared, files, root, shear};

fn at_ms(ms: u64) -> VirtualTime {
    VirtualTime::from_nanos(ms * 1_000_000)
}

fn client(scenario: &Scenario, name: &ClientName) -> Box<dyn Client> {
    match scenario.member(name).expect("the shear") {
        Member::Plant(client) | Member::Plc(client) | Member::Gateway(client) => client,
        Member::External(_) | Member::Seated { .. } => panic!("the shear has no programs of its own"),
    }
}

fn lockstep(scenario: &Scenario) -> Lockstep {
    let mut formation = Formation::new(scenario.plan().clone());
    for name in scenario.file().clients.keys() {
        formation.join(client(scenario, name)).expect("the shear");
    }
    let mut lockstep = formation.start().expect("the shear");
    lockstep.set_settings(scenario.session_settings());
    let timeline = Timeline::new(scenario.timeline().to_vec(), lockstep.session()).expect("the shear");
    lockstep.set_timeline(timeline);
    lockstep
}

/// A checkpoint of the shear.
pub(super) fn checkpoint(scratch: &Path) -> Prepared {
    let scenario = Scenario::load(&shear(scratch)).expect("the shear");
    let mut session = lockstep(&scenario);
    session.run_to(at_ms(100)).expect("the shear");
    let seed = session.checkpoint().expect("the shear").to_bytes().expect("the shear");
    let mut prepared = Prepared::new(vec![seed], move |input| {
        let Ok(checkpoint) = Checkpoint::from_bytes(input) else { return false };
        let _ = (checkpoint.digest(), checkpoint.settings().name.len(), checkpoint.state_hash());
        let until = VirtualTime::from_nanos(checkpoint.t_v().as_nanos().saturating_add(20_000_000));
        let mut session = lockstep(&scenario);
        if session.resume(&checkpoint).is_err() {
            return false;
        }
        // How it ends is reported; that it ends is what is tried.
        let _ = session.run_to(until);
        true
    });
    prepared.mend = |input| mend(input, 16..48);
    prepared
}

/// Puts the hash of all that follows in its place.
fn mend(input: &mut [u8], place: Range<usize>) {
    if let Some((head, body)) = input.split_at_mut_checked(place.end) {
        head[place].copy_from_slice(blake3::hash(body).as_bytes());
    }
}

/// The state of one client of the shear: taken back, and three turns.
fn state_of(scratch: &Path, name: &str) -> Prepared {
    let scenario = Scenario::load(&shear(scratch)).expect("the shear");
    let name = ClientName::new(name).expect("a name");
    let mut client = client(&scenario, &name);
    let request = client.join();
    let bytes = |ports: &[Port]| vec![0_u8; ports.iter().map(|port| port.ty.size()).sum()];
    let (inputs, mut outputs) = (bytes(&request.reads), bytes(&request.writes));
    client.setup(&mut outputs).expect("the shear");
    for step in 1..=10 {
        client.turn(at_ms(step * 10), &inputs, &mut outputs).expect("the shear");
    }
    let seed = client.save().expect("the shear");
    Prepared::new(vec![seed], move |input| {
        if client.restore(input).is_err() {
            return false;
        }
        for step in 11..=13 {
            if client.turn(at_ms(step * 10), &inputs, &mut outputs).is_err() {
                break;
            }
        }
        true
    })
}

/// Variables and tasks.
pub(super) fn plc_state(scratch: &Path) -> Prepared {
    state_of(scratch, "plc")
}

/// The engine's sets and the plant's memory.
pub(super) fn plant_state(scratch: &Path) -> Prepared {
    let mut prepared = state_of(scratch, "plant");
    prepared.mend = |input| mend(input, 12..44);
    prepared
}

/// A recording of the shear in `folder`.
fn recorded(scratch: &Path) -> PathBuf {
    let scenario = Scenario::load(&shear(scratch)).expect("the shear");
    let folder = scratch.join("recording");
    std::fs::create_dir_all(&folder).expect("a scratch folder");
    let provenance = Provenance {
        onescan: "0".to_owned(),
        scenario: "shear".to_owned(),
        folder: String::new(),
        file: None,
        case: None,
        operated: Vec::new(),
        mode: "lockstep".to_owned(),
        until: at_ms(300),
        seed: 0,
        files: Vec::new(),
    };
    let mut session = lockstep(&scenario);
    session.observe(Box::new(Recorder::new(&folder, provenance, Choice::default())));
    session.set_until(Some(at_ms(300)));
    session.run().expect("the shear");
    folder
}

/// All that can be asked of a recording.
fn is_read(folder: &Path, exported: &Path) -> bool {
    let Ok(recording) = Recording::open(folder) else { return false };
    let events = recording.events().is_ok() && recording.operator_inputs().is_ok();
    let Some(steps) = recording.steps() else { return events };
    let _ = (recording.digest(*steps.start()), recording.digest(*steps.end()), recording.header());
    for format in [ExportFormat::Csv, ExportFormat::Mcap, ExportFormat::Parquet] {
        let out = std::fs::File::create(exported).expect("a scratch folder");
        if recording.export(format, &[], steps.clone(), out).is_err() {
            return false;
        }
    }
    events && recording.rows(&[], steps).is_ok()
}

fn file_of_recording(scratch: &Path, file: &str) -> Prepared {
    let folder = recorded(scratch);
    let (path, exported) = (folder.join(file), scratch.join("exported"));
    let seed = std::fs::read(&path).expect("a recording");
    Prepared::new(vec![seed], move |input| {
        std::fs::write(&path, input).expect("a scratch folder");
        is_read(&folder, &exported)
    })
}

/// A part of the trajectory, in Parquet.
pub(super) fn part(scratch: &Path) -> Prepared {
    file_of_recording(scratch, "trajectory/part-000001.parquet")
}

/// `recording.json`.
pub(super) fn header(scratch: &Path) -> Prepared {
    file_of_recording(scratch, "recording.json")
}

/// `events.jsonl`, which an operator is replayed from.
pub(super) fn events(scratch: &Path) -> Prepared {
    let mut prepared = file_of_recording(scratch, "events.jsonl");
    let stamped = r#"{"step":3,"t_v_ns":30000000,"#;
    for event in [
        r#""operation":{"write":{"signal":"Sensor_1","value":"TRUE"}}}"#,
        r#""operation":{"force":{"signal":"Sensor_1","value":"FALSE"}}}"#,
        r#""control":"pause"}"#,
    ] {
        prepared.seeds.push([stamped, event, "\n"].concat().into_bytes());
    }
    prepared
}

/// A trajectory as text, beside a scenario.
pub(super) fn snapshot(_: &Path) -> Prepared {
    let good = root().join("scenarios/shear/snapshots/uneven,speed_m_s=0.15.traj");
    let good = Snapshot::parse(&std::fs::read_to_string(good).expect("a snapshot")).expect("a snapshot");
    Prepared::new(files("scenarios", &[".traj"]), move |input| {
        let Ok(snapshot) = Snapshot::parse(&String::from_utf8_lossy(input)) else { return false };
        let text = snapshot.to_text();
        let again = Snapshot::parse(&text).expect("what we write ourselves");
        assert_eq!(again.to_text(), text, "what is written is stable");
        let _ = (
            compare(&snapshot, &again, &std::collections::BTreeMap::new()),
            compare(&good, &snapshot, &std::collections::BTreeMap::new()),
        );
        true
    })
}
