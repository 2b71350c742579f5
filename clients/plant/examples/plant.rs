//! A plant without a session: a belt carries a box through a light barrier. Run it by
//! `cargo run -p onescan-plant --example plant`.

#![expect(clippy::print_stdout, reason = "an example is for the terminal")]

use std::error::Error;

use onescan_plant::Plant;
use onescan_server::client::Client;
use onescan_server::signal::ClientName;
use onescan_server::time::{TimeSpan, VirtualTime};

const SCENE: &str = r#"
version = 1

[[body]]
name = "belt"
kind = "kinematic"
shape = "box"
size_m = [2.0, 0.4, 0.1]
position_m = [0.0, 0.0, -0.05]

[[body]]
name = "package"
kind = "dynamic"
shape = "box"
size_m = [0.2, 0.2, 0.2]
position_m = [-0.8, 0.0, 0.1]
mass_kg = 5.0

[[component]]
name = "conveyor"
kind = "conveyor"
belt = "belt"
direction = [1.0, 0.0, 0.0]
speed_m_s = 0.5
run_signal = "Run"

[[component]]
name = "barrier"
kind = "light_barrier"
point_m = [0.0, -0.3, 0.1]
direction = [0.0, 1.0, 0.0]
detected_signal = "At_Barrier"
"#;

fn main() -> Result<(), Box<dyn Error>> {
    let period: TimeSpan = "10ms".parse()?;
    let mut plant = Plant::parse(SCENE, "belt.toml", ClientName::new("plant")?, period)?;
    let request = plant.join();
    let names = |ports: &[onescan_server::signal::Port]| -> Vec<String> {
        ports.iter().map(|port| format!("{}: {}", port.name, port.ty)).collect()
    };
    println!("reads {}, writes {}", names(&request.reads).join(", "), names(&request.writes).join(", "));

    // The only input is `Run`, the only output `At_Barrier`: one byte each.
    let (inputs, mut outputs) = ([1], [0]);
    plant.setup(&mut outputs)?;
    let mut before = outputs;
    let mut now = VirtualTime::ZERO;
    while now < VirtualTime::ZERO + "3s".parse()? {
        now = now + period;
        plant.turn(now, &inputs, &mut outputs)?;
        if outputs != before {
            println!("{now}: At_Barrier = {}", outputs[0] == 1);
            before = outputs;
        }
    }
    Ok(())
}
