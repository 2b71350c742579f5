//! Bad scenes, bad calls, worlds that come apart: errors, never panics.

use onescan_plant::{Plant, SceneError};
use onescan_server::client::Client;
use onescan_server::time::VirtualTime;
use proptest::prelude::*;

use crate::bench::{Bench, PERIOD};
use crate::shear::SHEAR;

fn plant(scene: &str) -> Result<Plant, SceneError> {
    let name = "plant".to_owned().try_into().expect("a name");
    Plant::parse(scene, "scene.toml", name, PERIOD)
}

#[test]
fn a_body_that_falls_off_the_world_is_named() {
    let scene = "version = 1\nextent_m = 10.0\n[[body]]\nname = \"nut\"\nkind = \"dynamic\"\nshape = \"sphere\"\n\
                 radius_m = 0.01\nmass_kg = 0.01\n";
    let mut bench = Bench::new(scene);
    let fault = (0..1000).find_map(|_| bench.try_turn().err()).expect("a fault");
    assert_eq!(fault.to_string(), "body `nut`: it has left the world, whose extent `extent_m` gives");
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let name = "plant".to_owned().try_into().expect("a name");
    let Err(error) = Plant::load("no/such/plant.toml".as_ref(), name, PERIOD) else { panic!("it is not there") };
    assert!(error.to_string().starts_with("no/such/plant.toml: cannot be read: "), "{error}");
}

#[test]
fn a_call_out_of_order_or_of_the_wrong_size_is_a_fault() {
    let mut plant = plant(SHEAR).expect("a scene");
    let fault = plant.turn(VirtualTime::ZERO, &[0; 4], &mut [0; 18]).expect_err("no set-up yet");
    assert_eq!(fault.to_string(), "a turn before the set-up");
    assert!(plant.setup(&mut [0; 17]).is_err());
    plant.setup(&mut [0; 18]).expect("a set-up");
    let fault = plant.turn(VirtualTime::ZERO, &[0; 3], &mut [0; 18]).expect_err("too short");
    assert_eq!(fault.to_string(), "inputs of 3 bytes where 4 are wanted");
}

#[test]
fn a_plant_can_be_moved_to_another_thread() {
    fn sendable<T: Send>() {}
    sendable::<Plant>();
}

proptest! {
    #[test]
    fn reading_never_panics(text in ".*") {
        let _ = plant(&text);
    }

    /// One damaged character leaves a scene that is refused, or one that runs or faults.
    #[test]
    fn a_damaged_scene_never_panics(at in 0..SHEAR.len(), with in "[0-9a-z.=\\[\\]\"\n-]") {
        let mut damaged: Vec<char> = SHEAR.chars().collect();
        damaged[at] = with.chars().next().unwrap_or('x');
        let damaged: String = damaged.into_iter().collect();
        if let Ok(mut plant) = plant(&damaged) {
            let sizes = [plant.join().reads, plant.join().writes]
                .map(|ports| ports.iter().map(|port| port.ty.size()).sum::<usize>());
            let mut outputs = vec![0; sizes[1]];
            plant.setup(&mut outputs).expect("a set-up");
            for _ in 0..5 {
                if plant.turn(VirtualTime::ZERO, &vec![1; sizes[0]], &mut outputs).is_err() {
                    break;
                }
            }
        }
    }

    /// Numbers of any size that the checks let through must not break the engine.
    #[test]
    fn extreme_numbers_never_panic(exponents in prop::collection::vec(prop_oneof![-300..300_i32, -5..9_i32, -4..4_i32], 6)) {
        let n: Vec<String> = exponents.iter().map(|exponent| format!("1.5e{exponent}")).collect();
        let scene = format!(
            "version = 1\n[[body]]\nname = \"floor\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [{0}, {0}, {1}]\n\
             [[body]]\nname = \"x\"\nkind = \"dynamic\"\nshape = \"cylinder\"\nradius_m = {1}\nlength_m = {2}\n\
             mass_kg = {3}\nposition_m = [{4}, 0.0, {5}]\n\
             [[joint]]\nname = \"j\"\nkind = \"revolute\"\nparent = \"floor\"\nchild = \"x\"\naxis = [{0}, {1}, 0.0]\n\
             [[axis]]\nname = \"a\"\njoint = \"j\"\ndrive = \"bidirectional\"\nforward_signal = \"f\"\n\
             reverse_signal = \"r\"\nspeed_rad_s = {4}\nacceleration_rad_s2 = {5}\nposition_signal = \"p\"\n",
            n[0], n[1], n[2], n[3], n[4], n[5]
        );
        if let Ok(mut plant) = plant(&scene) {
            let mut outputs = [0; 8];
            plant.setup(&mut outputs).expect("a set-up");
            for _ in 0..5 {
                if plant.turn(VirtualTime::ZERO, &[1, 0], &mut outputs).is_err() {
                    break;
                }
            }
        }
    }
}
