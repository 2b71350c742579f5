//! Random networks have the values of the program that Beremiz' own generator makes of them.
//!
//! The peer is `tests/peers/beremiz/generate.py`. It needs a checkout of Beremiz, which `ONESCAN_BEREMIZ` names, and
//! Python with lxml; without, the test says so and compares nothing. What the generator makes is compiled as what is
//! compared with `MatIEC` elsewhere. For more networks, and to keep them:
//!
//! ```text
//! ONESCAN_BEREMIZ=../beremiz ONESCAN_BEREMIZ_NETWORKS=2000 ONESCAN_BEREMIZ_FOLDER=/tmp/networks \
//!     cargo test --profile tests --workspace --test programs drawn::beremiz -- --nocapture
//! ```

use std::path::{Path, PathBuf};
use std::process::Command;

use onescan_iec::Dialect;

use super::sketch::{Drawing, Sketch};
use super::{BEREMIZ, values};
use crate::matiec::dice::Dice;
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
    }
    assert!(left_out * 4 <= count, "the generator fails for {left_out} of {count}");
    println!("{} networks, {SCANS} scans, {compared} values, no difference; {left_out} fail there", count - left_out);
}
