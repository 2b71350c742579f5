//! Second pass over `[[axis]]`: which joint, commanded how, how fast and how strong.

use super::placed::Placed;
use onescan_server::signal::{SignalName, SignalType};

use super::error::{SceneFaultKind, Thing};
use super::faults::Faults;
use super::format::{AxisTable, DriveKind, SceneFile};
use super::joints::{kind_name, unit};
use super::model::{Axis, Drive, Moved};
use super::names::Names;
use super::number::{Allowed, Entry, Unit};
use super::signals::Signals;
use super::text;
use crate::model::{BodyKind, JointKind, NumberType};

pub(super) fn check(
    file: &SceneFile,
    bodies: &Names,
    joints: &Names,
    signals: &mut Signals,
    faults: &mut Faults<'_>,
) -> Vec<Axis> {
    Names::gather(Thing::Axis, file.axis.iter().map(|axis| &axis.get_ref().name), faults);
    let mut driven: Vec<(Thing, &str, &str)> = Vec::new();
    let mut axes = Vec::new();
    for written in file.axis.iter().map(Placed::get_ref) {
        let (moved, thing, name) = match (&written.joint, &written.belt) {
            (Some(joint), None) => (drivable(written, joint, file, joints, faults), Thing::Joint, joint),
            (None, Some(belt)) => (runnable(written, belt, file, bodies, faults), Thing::Body, belt),
            (None, None) | (Some(_), Some(_)) => {
                faults.add(written.name.span(), SceneFaultKind::Undriven(text(&written.name).to_owned()));
                continue;
            }
        };
        match driven.iter().find(|(known, driven, _)| *known == thing && *driven == text(name)) {
            Some((_, _, first)) => {
                let (name_text, first) = (name.get_ref().clone(), format!("axis `{first}`"));
                faults.add(name.span(), SceneFaultKind::DrivenTwice { thing, name: name_text, first });
            }
            None => driven.push((thing, text(name), text(&written.name))),
        }
        if let Some((moved, unit)) = moved {
            axes.extend(axis(written, moved, unit, signals, faults));
        }
    }
    axes
}

/// The joint of an axis, which must be one that a motor moves, and its unit.
fn drivable(
    written: &AxisTable,
    name: &Placed<String>,
    file: &SceneFile,
    joints: &Names,
    faults: &mut Faults<'_>,
) -> Option<(Moved, Unit)> {
    if let Some(direction) = &written.direction {
        let whose = format!("axis `{}` of a joint", text(&written.name));
        faults.add(direction.span(), SceneFaultKind::Misplaced { whose, key: "direction" });
    }
    let joint = joints.find(name, faults)?;
    let table = file.joint[joint].get_ref();
    if let Some(follows) = &table.follows {
        let first = format!("joint `{}`, which it follows", text(&follows.joint));
        let twice = SceneFaultKind::DrivenTwice { thing: Thing::Joint, name: text(name).to_owned(), first };
        faults.add(name.span(), twice);
        return None;
    }
    if table.guided {
        let keys = [
            ("force_max_n", written.force_max_n.as_ref().map(Placed::span)),
            ("torque_max_nm", written.torque_max_nm.as_ref().map(Placed::span)),
            ("force_signal", written.force_signal.as_ref().map(Placed::span)),
            ("torque_signal", written.torque_signal.as_ref().map(Placed::span)),
            ("limit_signal", written.limit_signal.as_ref().map(Placed::span)),
        ];
        let whose = format!("axis `{}` of a kinematic robot", text(&written.name));
        for (key, span) in keys.into_iter().filter_map(|(key, span)| span.map(|span| (key, span))) {
            faults.add(span, SceneFaultKind::Misplaced { whose: whose.clone(), key });
        }
    }
    let kind = *table.kind.get_ref();
    if let (JointKind::Prismatic | JointKind::Revolute, Some(unit)) = (kind, unit(kind)) {
        return Some((Moved::Joint(joint), unit));
    }
    let undrivable = SceneFaultKind::Undrivable { joint: name.get_ref().clone(), kind: kind_name(kind) };
    let hint = "an axis drives a prismatic or a revolute joint";
    faults.add_hinted(name.span(), undrivable, Some(hint.to_owned()));
    None
}

/// The belt of an axis, which must be a kinematic body without a velocity of its own.
fn runnable(
    written: &AxisTable,
    name: &Placed<String>,
    file: &SceneFile,
    bodies: &Names,
    faults: &mut Faults<'_>,
) -> Option<(Moved, Unit)> {
    let whose = format!("axis `{}` of a belt", text(&written.name));
    if let Some(force) = &written.force_max_n {
        faults.add(force.span(), SceneFaultKind::Misplaced { whose: whose.clone(), key: "force_max_n" });
    }
    let Some(direction) = &written.direction else {
        faults.add(name.span(), SceneFaultKind::Missing { whose, key: "direction" });
        return None;
    };
    let direction = faults.direction("direction", direction);
    let body = bodies.find(name, faults)?;
    let table = file.body[body].get_ref();
    if table.kind != BodyKind::Kinematic {
        let hint = Some("write `kind = \"kinematic\"` in its table".to_owned());
        faults.add_hinted(name.span(), SceneFaultKind::NotKinematic(name.get_ref().clone()), hint);
    }
    if let Some(velocity) = &table.velocity_m_s {
        let whose = format!("body `{}`, which axis `{}` drives,", text(name), text(&written.name));
        faults.add(velocity.span(), SceneFaultKind::Misplaced { whose, key: "velocity_m_s" });
    }
    Some((Moved::Belt { body, direction: direction? }, Unit::Metre))
}

fn axis(written: &AxisTable, moved: Moved, unit: Unit, signals: &mut Signals, faults: &mut Faults<'_>) -> Option<Axis> {
    let number = match written.signal_type {
        NumberType::Real => SignalType::REAL,
        NumberType::Lreal => SignalType::LREAL,
    };
    let drive = drive(written, number, signals, faults);
    let limits = limits(written, unit, faults);
    let mut feedback = |name: Option<&Placed<String>>, faults: &mut Faults<'_>| {
        name.and_then(|name| signals.write(name, number, faults))
    };
    let position = feedback(written.position_signal.as_ref(), faults);
    let velocity = feedback(written.velocity_signal.as_ref(), faults);
    let (speed, acceleration, effort_max) = limits?;
    let whose = format!("axis `{}`", text(&written.name));
    let belt = matches!(moved, Moved::Belt { .. });
    let [force, torque] = [written.force_signal.as_ref(), written.torque_signal.as_ref()];
    let (right, wrong) = match unit {
        Unit::Metre => (force, torque.map(|name| (name, "torque_signal"))),
        Unit::Radian => (torque, force.map(|name| (name, "force_signal"))),
    };
    let of_belt = [(force, "force_signal"), (written.limit_signal.as_ref(), "limit_signal")];
    let misplaced = of_belt.into_iter().filter(|_| belt).filter_map(|(name, key)| name.map(|name| (name, key)));
    for (name, key) in wrong.into_iter().chain(misplaced) {
        faults.add(name.span(), SceneFaultKind::Misplaced { whose: whose.clone(), key });
    }
    let effort = right.and_then(|name| signals.write(name, number, faults));
    let limit = written.limit_signal.as_ref().and_then(|name| signals.write(name, SignalType::BOOL, faults));
    if let (Some(name), None, false) = (&written.limit_signal, effort_max, belt) {
        let key = if unit == Unit::Metre { "force_max_n" } else { "torque_max_nm" };
        faults.add(name.span(), SceneFaultKind::Missing { whose, key });
    }
    Some(Axis {
        name: written.name.get_ref().clone(),
        moved,
        drive: drive?,
        speed,
        acceleration,
        effort_max,
        position,
        velocity,
        effort,
        limit,
        number: written.signal_type,
    })
}

/// Speed, acceleration and greatest force or torque.
fn limits(written: &AxisTable, unit: Unit, faults: &mut Faults<'_>) -> Option<(f64, f64, Option<f64>)> {
    let whose = format!("axis `{}`", text(&written.name));
    let pairs = [
        (Entry::new("speed_m_s", written.speed_m_s.as_ref()), Entry::new("speed_rad_s", written.speed_rad_s.as_ref())),
        (
            Entry::new("acceleration_m_s2", written.acceleration_m_s2.as_ref()),
            Entry::new("acceleration_rad_s2", written.acceleration_rad_s2.as_ref()),
        ),
        (
            Entry::new("force_max_n", written.force_max_n.as_ref()),
            Entry::new("torque_max_nm", written.torque_max_nm.as_ref()),
        ),
    ];
    let entries = pairs.map(|(metre, radian)| faults.in_unit(&whose, unit, metre, radian));
    for (entry, (metre, radian)) in entries.iter().zip(&pairs[..2]) {
        if metre.value.is_none() && radian.value.is_none() {
            faults.add(written.name.span(), SceneFaultKind::Missing { whose: whose.clone(), key: entry.key });
        }
    }
    let [speed, acceleration, effort] = entries.map(|entry| faults.number(entry, Allowed::Positive));
    Some((speed?, acceleration?, effort))
}

/// The commands that a drive of this kind has; those of another kind are faults.
fn drive(written: &AxisTable, number: SignalType, signals: &mut Signals, faults: &mut Faults<'_>) -> Option<Drive> {
    let kind = *written.drive.get_ref();
    let named = match kind {
        DriveKind::Bidirectional => "bidirectional",
        DriveKind::Velocity => "velocity",
        DriveKind::Position => "position",
    };
    let whose = format!("{named} axis `{}`", text(&written.name));
    let mut command = |key: &'static str, value: Option<&Placed<String>>, ty: Option<SignalType>| {
        match (value, ty) {
            (Some(name), Some(ty)) => return signals.read(name, ty, faults),
            (Some(name), None) => {
                faults.add(name.span(), SceneFaultKind::Misplaced { whose: whose.clone(), key });
            }
            (None, Some(_)) => {
                faults.add(written.drive.span(), SceneFaultKind::Missing { whose: whose.clone(), key });
            }
            (None, None) => {}
        }
        None::<SignalName>
    };
    let by_number = kind != DriveKind::Bidirectional;
    let bool_type = (!by_number).then_some(SignalType::BOOL);
    let forward = command("forward_signal", written.forward_signal.as_ref(), bool_type);
    let reverse = command("reverse_signal", written.reverse_signal.as_ref(), bool_type);
    let number = command("command_signal", written.command_signal.as_ref(), by_number.then_some(number));
    Some(match kind {
        DriveKind::Bidirectional => Drive::Bidirectional { forward: forward?, reverse: reverse? },
        DriveKind::Velocity => Drive::Velocity { command: number? },
        DriveKind::Position => Drive::Position { command: number? },
    })
}
