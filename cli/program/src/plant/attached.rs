//! What is attached to joints, in words.

use std::fmt::Write as _;

use onescan_plant::scene::model::{Coupling, CouplingLaw, Fitting, JointKind, Scene};

/// A fitting: its joint, and what of it is not 0.
pub(super) fn fitted(fitting: &Fitting, scene: &Scene) -> String {
    let joint = &scene.joints[fitting.joint];
    let (way, force) = units(joint.kind);
    let mut text = format!("{}: joint {}", fitting.name, joint.name);
    let mut part = |what: &str, value: f64, unit: &str| {
        if value != 0.0 {
            write!(text, ", {what} {value} {unit}").expect("a text takes all");
        }
    };
    part("spring", fitting.spring, &format!("{force}/{way}"));
    part("at rest at", if fitting.spring == 0.0 { 0.0 } else { fitting.rest }, way);
    part("damping", fitting.damping, &format!("{force}·s/{way}"));
    part("friction", fitting.friction, force);
    part("friction at rest", if fitting.stiction > fitting.friction { fitting.stiction } else { 0.0 }, force);
    part("balance", fitting.balance, force);
    part("brake", fitting.brake.as_ref().map_or(0.0, |brake| brake.most), force);
    if let Some(signal) = fitting.brake.as_ref().and_then(|brake| brake.release.as_ref()) {
        write!(text, " released by {signal}").expect("a text takes all");
    }
    text
}

/// A coupling: the joint that it leads, and by which others.
pub(super) fn coupled(coupling: &Coupling, scene: &Scene) -> String {
    let joint = &scene.joints[coupling.joint];
    let (way, force) = units(joint.kind);
    let led = coupling.of.iter().map(|share| {
        let by = &scene.joints[share.joint].name;
        match &share.law {
            CouplingLaw::Ratio(ratio) => format!("{ratio} x {by}"),
            CouplingLaw::Cam(points) => format!("a cam of {} points over {by}", points.len()),
            CouplingLaw::RepeatingCam(points) => format!("a repeated cam of {} points over {by}", points.len()),
        }
    });
    let led: Vec<_> = led.collect();
    let play =
        if coupling.backlash == 0.0 { String::new() } else { format!(", with a play of {} {way}", coupling.backlash) };
    let slip = coupling.slip.map_or_else(String::new, |slip| format!(", slips beyond {slip} {force}"));
    format!("{}: joint {} = {}{play}{slip}", coupling.name, joint.name, led.join(" + "))
}

/// The units of a joint's coordinate and of its force.
fn units(kind: JointKind) -> (&'static str, &'static str) {
    match kind {
        JointKind::Revolute => ("rad", "N·m"),
        JointKind::Prismatic | JointKind::Slot | JointKind::Fixed | JointKind::Ball => ("m", "N"),
    }
}
