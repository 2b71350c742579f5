//! Random networks have the values of the program that Beremiz' own generator makes of them.
//!
//! The peer is `tests/peers/beremiz/generate.py`. It needs a checkout of Beremiz, which `ONESCAN_BEREMIZ` names, and
//! Python with lxml; without, the test says so and compares nothing. What the generator makes is compiled as what is
//! compared with `MatIEC` elsewhere; where `iec2c` is on the `PATH`, that runs it, too. For more networks, and to keep
//! them:
//!
//! ```text
//! ONESCAN_BEREMIZ=../beremiz ONESCAN_BEREMIZ_NETWORKS=2000 ONESCAN_BEREMIZ_FOLDER=/tmp/networks \
//!     cargo test --profile tests --workspace --test programs drawn::beremiz -- --nocapture
//! ```

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;

use onescan_iec::Dialect;

use super::sketch::{Drawing, Sketch};
use super::{BEREMIZ, values};
use crate::matiec::dice::Dice;
use crate::matiec::peer_program::PeerProgram;
use crate::matiec::{Reported, compare, library};
use crate::plcopen::{of_tool, rig};
use crate::rig::Rig;

const SCANS: usize = 100;

#[test]
#[expect(clippy::print_stdout, reason = "a measurement's figures, and why there are none")]
fn random_networks_do_the_same_in_beremiz() {
    let Some(beremiz) = std::env::var_os("ONESCAN_BEREMIZ").map(PathBuf::from) else {
        println!("skipped: `ONESCAN_BEREMIZ` does not name a checkout of Beremiz");
        return;
    };
    let count = std::env::var("ONESCAN_BEREMIZ_NETWORKS").ok().and_then(|text| text.parse().ok()).unwrap_or(100_u64);
    let own = tempfile::tempdir().expect("a folder");
    let folder = std::env::var_os("ONESCAN_BEREMIZ_FOLDER").map_or_else(|| own.path().to_owned(), PathBuf::from);
    std::fs::create_dir_all(&folder).expect("a folder can be made");
    let texts: Vec<String> = (0..count)
        .map(|seed| {
            let sketch = Sketch::random(&mut Dice::new(seed), true);
            let text = of_tool(BEREMIZ, &sketch.project(&Drawing::plain(&sketch)));
            std::fs::write(folder.join(format!("{seed}.xml")), &text).expect("a file can be written");
            text
        })
        .collect();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/peers/beremiz/generate.py");
    let output = Command::new("python3").arg(script).arg(beremiz).arg(&folder).output().expect("Python is here");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let library = library();
    let (mut compared, mut left_out) = (0, 0);
    for (seed, text) in texts.iter().enumerate() {
        // The generator has failed.
        let Ok(made) = std::fs::read_to_string(folder.join(format!("{seed}.st"))) else {
            left_out += 1;
            continue;
        };
        let theirs = values(Rig::in_dialect(Dialect::Matiec, &made), SCANS, seed as u64);
        let ours = values(rig(text), SCANS, seed as u64);
        assert_eq!(ours, theirs, "seed {seed}:\n{text}\n{made}");
        compared += ours.len();
        if library.is_some() {
            write_for_matiec(&folder, seed as u64, text, &made);
        }
    }
    assert!(left_out * 4 <= count, "the generator fails for {left_out} of {count}");
    println!("{} networks, {SCANS} scans, {compared} values, no difference; {left_out} fail there", count - left_out);
    match library {
        Some(library) => compare_with_matiec(&folder, &library),
        None => println!("skipped: `iec2c`, the compiler of MatIEC, is not on the PATH"),
    }
}

/// Networks in a batch for `MatIEC`.
const BATCH: u64 = 50;

fn batch(folder: &Path, seed: u64) -> PathBuf {
    folder.join(format!("matiec-{}", seed / BATCH))
}

/// The program that Beremiz made of a network, and the trace of the network as it is read here.
fn write_for_matiec(folder: &Path, seed: u64, drawn: &str, made: &str) {
    let (blocks, program) = made.split_at(made.find("PROGRAM P\n").expect("it has a program"));
    let batch = batch(folder, seed);
    std::fs::create_dir_all(&batch).expect("a folder can be made");
    std::fs::write(batch.join("prelude.st"), blocks).expect("a file can be written");
    let typed = |name: &str| (name.to_owned(), if name.starts_with('v') { "INT" } else { "BOOL" });
    let peer = PeerProgram {
        dialect: Dialect::Matiec,
        family: "networks",
        text: program.to_owned(),
        inputs: ["v0", "v1", "b0", "b1"].map(typed).to_vec(),
        outputs: Sketch::variables().iter().map(|name| typed(name)).collect(),
        rounded: Vec::new(),
    };
    let name = format!("networks_{seed}");
    let trace = peer.trace_of(rig(drawn), &mut Dice::new(seed));
    std::fs::write(batch.join(format!("{name}.st")), peer.named(&name)).expect("a file can be written");
    std::fs::write(batch.join(format!("{name}.trace")), trace).expect("a file can be written");
}

#[expect(clippy::print_stdout, reason = "a measurement's figures")]
fn compare_with_matiec(folder: &Path, library: &Path) {
    let reported = Mutex::new(Reported::default());
    let batches = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let mut batches: Vec<PathBuf> = batches.filter(|path| path.is_dir()).collect();
    batches.sort();
    for batch in batches {
        compare(&batch, library, &reported);
    }
    let Reported { counts, differences } = reported.into_inner().expect("no panic");
    for (what, count) in counts {
        println!("{what} {count}");
    }
    assert!(differences.is_empty(), "{} differences:\n{}", differences.len(), differences.join("\n"));
}
