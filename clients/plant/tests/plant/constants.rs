//! Inputs of components that a scene gives a constant, and inputs that nobody drives.

use crate::bench::Bench;
use onescan_plant::Scene;
use onescan_server::client::Client;

fn heater(keys: &str) -> String {
    format!(
        "version = 1\n[[component]]\nname = \"oven\"\nkind = \"heater\"\n{keys}temperature_degc_signal = \"Heat\"\n\
         power_w_signal = \"Power\"\n"
    )
}

fn refusal(scene: &str) -> String {
    Scene::parse(scene, "scene.toml").expect_err("refused").to_string()
}

#[test]
fn a_constant_drives_an_input_for_good() {
    let mut bench = Bench::new(&heater("on = true\nfraction_signal = \"Part\"\n"));
    bench.command("Part", 0.25);
    bench.turn();
    assert_eq!(bench.read::<f64>("Power"), 500.0);
    let mut bench = Bench::new(&heater("on_signal = \"On\"\nfraction = 0.5\nheat_w = 100\n"));
    bench.turn();
    assert_eq!(bench.read::<f64>("Power"), 0.0);
    bench.command("On", true);
    bench.turn();
    assert_eq!(bench.read::<f64>("Power"), 1000.0);
    // C/G = 500 s; the first period heats with 100 W, the second with 1100 W
    let [start, first_gain, second_gain] = [20.0, 100.0 / 10.0, 1100.0 / 10.0];
    let share = -libm::expm1(-0.01 / 500.0);
    let warmed = first_gain * share;
    let exact = start + warmed + (second_gain - warmed) * share;
    assert!((bench.read::<f64>("Heat") - exact).abs() < 1e-12, "{}", bench.read::<f64>("Heat"));
}

#[test]
fn a_state_of_another_constant_is_refused_by_its_key() {
    let state = Bench::new(&heater("on = true\nfraction = 0.5\n")).plant.save().expect("a state");
    let mut other = Bench::new(&heater("on = true\nfraction = 0.75\n"));
    let refused = other.plant.restore(&state).expect_err("refused").to_string();
    assert!(refused.contains("another `fraction` at component `oven`, 0.5 in the state and 0.75 here"), "{refused}");
}

#[test]
fn what_cannot_act_is_reported_with_its_place() {
    let reported: Vec<_> = [
        "fraction_signal = \"Part\"\n",
        "fraction = 0.5\n",
        "on = 1\n",
        "on = true\non_signal = \"On\"\n",
        "on = true\nfraction = \"half\"\n",
        "on = true\nfraction = nan\n",
    ]
    .into_iter()
    .map(|keys| refusal(&heater(keys)))
    .collect();
    insta::assert_snapshot!(reported.join("\n"));
}

#[test]
fn an_input_that_a_parameter_hides_takes_a_constant_too() {
    let scene = "version = 1\n[[component]]\nname = \"press\"\nkind = \"hydraulic_cylinder\"\n\
                 command = \"velocity\"\ncommand_constant = 0.05\nvelocity_m_s_signal = \"Speed\"\n\
                 [[component]]\nname = \"axis\"\nkind = \"servo_axis\"\nneeds_homing = false\nspeed_m_s = 1.0\n\
                 speed_m_s_constant = 0.2\nenable = true\njog_forward = true\nvelocity_m_s_signal = \"Jog\"\n";
    let mut bench = Bench::new(scene);
    bench.run_us(500_000);
    assert!((bench.read::<f64>("Speed") - 0.05).abs() < 1e-3, "{}", bench.read::<f64>("Speed"));
    assert!((bench.read::<f64>("Jog") - 0.2).abs() < 1e-6, "{}", bench.read::<f64>("Jog"));
    let refused = refusal(&scene.replace("command_constant = 0.05", "command_constant = \"slow\""));
    assert!(refused.contains("command_constant"), "{refused}");
}

#[test]
fn every_input_has_a_key_of_its_own_for_a_constant() {
    for kind in onescan_plant::component::kinds() {
        for input in &kind.inputs {
            let key = kind.constant_key(&input.key);
            assert!(kind.parameters.iter().all(|parameter| parameter.key != key), "{} {key}", kind.name);
        }
    }
}
