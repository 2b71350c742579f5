//! Two runs of one signal as a picture, drawn over each other. Run it by
//! `cargo run -p onescan-report --example picture > picture.svg`.

#![expect(clippy::print_stdout, reason = "an example is for the terminal")]

use onescan_report::plot::{Panel, Plot, Shape, Trajectory};

fn main() {
    // A step response, sampled every 10 ms; the second run lags behind.
    let run = |time_constant_s: f64| -> Trajectory {
        let t_ns: Vec<u64> = (0..200).map(|step| step * 10_000_000).collect();
        let values = t_ns.iter().map(|t_ns| 1.0 - (-(*t_ns as f64) * 1e-9 / time_constant_s).exp()).collect();
        Trajectory { t_ns, values }
    };
    let panel = Panel {
        signal: "speed".to_owned(),
        unit: Some("m/s".to_owned()),
        shape: Shape::Line,
        names: Vec::new(),
        runs: vec![run(0.2), run(0.3)],
    };
    let plot = Plot {
        title: "Two runs".to_owned(),
        runs: vec!["light".to_owned(), "loaded".to_owned()],
        panels: vec![panel],
        marks: Vec::new(),
    };
    println!("{}", plot.to_svg());
}
