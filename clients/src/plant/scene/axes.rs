//! Second pass over `[[axis]]`: which joint, commanded how, how fast and how strong.

use onescan_server::signal::{ElementaryType, SignalName};
use toml::Spanned;

use super::error::{SceneFaultKind, Thing};
use super::faults::Faults;
use super::format::{AxisTable, DriveKind, JointKind, JointTable, NumberType};
use super::joints::{kind_name, unit};
use super::model::{Axis, Drive};
use super::names::Names;
use super::number::{Allowed, Entry, Unit};
use super::signals::Signals;
use super::text;

pub(super) fn check(
    tables: &[Spanned<AxisTable>],
    joint_tables: &[Spanned<JointTable>],
    joints: &Names,
    signals: &mut Signals,
    faults: &mut Faults<'_>,
) -> Vec<Axis> {
    Names::gather(Thing::Axis, tables.iter().map(|axis| &axis.get_ref().name), faults);
    let mut driven: Vec<(usize, &str)> = Vec::new();
    let mut axes = Vec::new();
    for table in tables {
        let written = table.get_ref();
        let Some(joint) = drivable(written, joint_tables, joints, faults) else { continue };
        match driven.iter().find(|(index, _)| *index == joint) {
            Some((_, first)) => {
                let kind =
                    SceneFaultKind::DrivenTwice { joint: written.joint.get_ref().clone(), first: (*first).to_owned() };
                faults.add(written.joint.span(), kind);
            }
            None => driven.push((joint, text(&written.name))),
        }
        let unit = unit(*joint_tables[joint].get_ref().kind.get_ref()).unwrap_or(Unit::Metre);
        axes.extend(axis(written, joint, unit, signals, faults));
    }
    axes
}

/// The index of an axis's joint, which must be one that a motor moves.
fn drivable(
    written: &AxisTable,
    joint_tables: &[Spanned<JointTable>],
    joints: &Names,
    faults: &mut Faults<'_>,
) -> Option<usize> {
    let joint = joints.find(&written.joint, faults)?;
    let kind = *joint_tables[joint].get_ref().kind.get_ref();
    if matches!(kind, JointKind::Prismatic | JointKind::Revolute) {
        return Some(joint);
    }
    let undrivable = SceneFaultKind::Undrivable { joint: written.joint.get_ref().clone(), kind: kind_name(kind) };
    let hint = "an axis drives a prismatic or a revolute joint";
    faults.add_hinted(written.joint.span(), undrivable, Some(hint.to_owned()));
    None
}

fn axis(written: &AxisTable, joint: usize, unit: Unit, signals: &mut Signals, faults: &mut Faults<'_>) -> Option<Axis> {
    let number = match written.signal_type {
        NumberType::Real => ElementaryType::Real,
        NumberType::Lreal => ElementaryType::Lreal,
    };
    let drive = drive(written, number, signals, faults);
    let limits = limits(written, unit, faults);
    let mut feedback = |name: Option<&Spanned<String>>, faults: &mut Faults<'_>| {
        name.and_then(|name| signals.write(name, number, faults))
    };
    let position = feedback(written.position_signal.as_ref(), faults);
    let velocity = feedback(written.velocity_signal.as_ref(), faults);
    let (speed, acceleration, effort_max) = limits?;
    Some(Axis {
        name: written.name.get_ref().clone(),
        joint,
        drive: drive?,
        speed,
        acceleration,
        effort_max,
        position,
        velocity,
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
fn drive(written: &AxisTable, number: ElementaryType, signals: &mut Signals, faults: &mut Faults<'_>) -> Option<Drive> {
    let kind = *written.drive.get_ref();
    let named = match kind {
        DriveKind::Bidirectional => "bidirectional",
        DriveKind::Velocity => "velocity",
        DriveKind::Position => "position",
    };
    let whose = format!("{named} axis `{}`", text(&written.name));
    let mut command = |key: &'static str, value: Option<&Spanned<String>>, ty: Option<ElementaryType>| {
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
    let bool_type = (!by_number).then_some(ElementaryType::Bool);
    let forward = command("forward_signal", written.forward_signal.as_ref(), bool_type);
    let reverse = command("reverse_signal", written.reverse_signal.as_ref(), bool_type);
    let number = command("command_signal", written.command_signal.as_ref(), by_number.then_some(number));
    Some(match kind {
        DriveKind::Bidirectional => Drive::Bidirectional { forward: forward?, reverse: reverse? },
        DriveKind::Velocity => Drive::Velocity { command: number? },
        DriveKind::Position => Drive::Position { command: number? },
    })
}
