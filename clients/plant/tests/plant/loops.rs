//! Joints that close a loop.

use onescan_plant::Scene;

fn loops(joints: &[[&str; 3]]) -> Vec<String> {
    let body = |(index, name): (usize, &str)| {
        format!(
            "[[body]]\nname = \"{name}\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [0.1, 0.1, 0.1]\nmass_kg = 1.0\n\
             position_m = [{index}, 0, 0]\n"
        )
    };
    let joint = |[name, parent, child]: &[&str; 3]| {
        format!(
            "[[joint]]\nname = \"{name}\"\nkind = \"revolute\"\nparent = \"{parent}\"\nchild = \"{child}\"\naxis = [0, 1, 0]\n"
        )
    };
    let frame = "[[body]]\nname = \"frame\"\nkind = \"fixed\"\nshape = \"box\"\nsize_m = [0.1, 0.1, 0.1]\n\
                 position_m = [9, 0, 0]\n";
    let bodies: String = ["a", "b", "c"].into_iter().enumerate().map(body).collect();
    let text = format!("version = 1\n{bodies}{frame}{}", joints.iter().map(joint).collect::<String>());
    let scene = Scene::parse(&text, "plant.toml").unwrap_or_else(|error| panic!("{error}"));
    scene.loops().iter().map(ToString::to_string).collect()
}

#[test]
fn a_loop_is_named_by_the_joint_that_closes_it() {
    let chain = [["p", "ground", "a"], ["q", "a", "b"], ["r", "b", "c"]];
    assert_eq!(loops(&chain), Vec::<String>::new());
    let four_bar = [chain[0], chain[1], ["s", "frame", "b"]];
    assert_eq!(loops(&four_bar), ["joint `s` closes a loop with `p`, `q`"], "what stands is one place");
    let ring = [chain[1], chain[2], ["s", "c", "a"]];
    insta::assert_snapshot!(loops(&ring).join("\n"), @"joint `s` closes a loop with `r`, `q`, exact only to the first order of the step: nothing of it stands on what is fixed");
}
