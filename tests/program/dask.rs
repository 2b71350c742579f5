//! Campaigns from Python on a Dask cluster: a worker that is lost costs time and nothing else.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::typed::copied_shear;
use crate::venv;

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Faults at the set-up, at times, on a condition.
const CAMPAIGN: &str = r#"version = 1

[[campaign]]
name = "feedback"
until = "3s"
detected = "eventually[0,400ms] Strokes >= 3"
fault = [
    { name = "sensor-off", kind = "hardware", force = { signal = "Sensor_1", value = false } },
    { name = "frame-lost", kind = "hardware", disturbance = { client = "plant", kind = "lost", rate = 0.4 } },
    { name = "count", kind = "software", variable = { variable = "Shear.Strokes", value = 7 } },
]
activation = [
    { name = "start", at = "0s" },
    { name = "first-step", at = "10ms", for = "500ms" },
    { name = "off-grid", at = "1203ms", for = "1s" },
    { name = "third-stroke", when = "rose(Actuator_1_Down)", nth = 3, for = "300ms" },
    { name = "late", when = "rose(Sensor_1)", from = "2s" },
    { name = "never", when = "Strokes > 40 and once Sensor_1" },
]
"#;

#[test]
fn a_cluster_that_loses_a_worker_comes_to_the_table_of_one_process() {
    let python = match venv::tried("dask", &["dask[distributed]"]) {
        Ok(python) => python,
        Err(why) => {
            eprintln!("skipped: dask cannot be installed: {why}");
            return;
        }
    };
    let shear = copied_shear();
    std::fs::write(shear.path().join("cases.toml"), CAMPAIGN).expect("a file");
    let mut command = Command::new(python);
    command.arg("-B").arg(repository().join("tests/peers/dask_campaign.py"));
    command.arg(env!("CARGO_BIN_EXE_onescan-under-test")).arg(shear.path());
    let output = command.env("PYTHONPATH", repository().join("clients/python/src")).output().expect("Python starts");
    let (said, errors) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    let line = said.lines().last().unwrap_or_else(|| panic!("it said nothing: {errors}"));
    let done: Value = serde_json::from_str(line).unwrap_or_else(|_| panic!("{said} {errors}"));
    assert_eq!(done["same"], true, "{done}");
    assert_eq!((&done["runs"], &done["killed"], &done["lost"]), (&18.into(), &1.into(), &1.into()), "{errors}");
}
