//! Second pass over `[[joint]]`: bodies, directions, coordinate and limits.

use super::placed::Placed;

use super::bodies::GROUND;
use super::error::SceneFaultKind;
use super::faults::Faults;
use super::format::{BodyTable, JointTable, Triple};
use super::model::{Follows, Joint};
use super::names::Names;
use super::number::{Allowed, Entry, Unit};
use super::text;
use crate::model::{BodyKind, JointKind};

/// How far from a right angle `slide` may be, as a cosine.
const OBLIQUE_MAX: f64 = 1e-6;

pub(super) fn check(
    tables: &[Placed<JointTable>],
    body_tables: &[Placed<BodyTable>],
    bodies: &Names,
    faults: &mut Faults<'_>,
) -> Vec<Joint> {
    let mut joints: Vec<Joint> =
        tables.iter().filter_map(|table| joint(table.get_ref(), body_tables, bodies, faults)).collect();
    // a robot's file, which was checked, is the only one to say this
    for table in tables.iter().map(Placed::get_ref) {
        let Some(follows) = &table.follows else { continue };
        let place = |name: &str| joints.iter().position(|joint| joint.name == name);
        if let (Some(at), Some(leader)) = (place(text(&table.name)), place(text(&follows.joint))) {
            joints[at].follows = Some(Follows { joint: leader, factor: follows.factor, offset: follows.offset });
        }
    }
    joints
}

/// The unit of a joint's coordinate; none for a joint that has no coordinate of its own.
pub(super) fn unit(kind: JointKind) -> Option<Unit> {
    match kind {
        JointKind::Prismatic | JointKind::Slot => Some(Unit::Metre),
        JointKind::Revolute => Some(Unit::Radian),
        JointKind::Fixed | JointKind::Ball => None,
    }
}

/// The kind of a joint in the words of a scene file.
pub(super) fn kind_name(kind: JointKind) -> &'static str {
    match kind {
        JointKind::Prismatic => "prismatic",
        JointKind::Revolute => "revolute",
        JointKind::Fixed => "fixed",
        JointKind::Slot => "slot",
        JointKind::Ball => "ball",
    }
}

fn joint(
    written: &JointTable,
    body_tables: &[Placed<BodyTable>],
    bodies: &Names,
    faults: &mut Faults<'_>,
) -> Option<Joint> {
    let kind = *written.kind.get_ref();
    let directions = directions(written, faults);
    let coordinate = coordinate(written, faults);
    let anchor = faults.triple("anchor_m", written.anchor_m.as_ref());
    let (parent, child) = joined(written, body_tables, bodies, faults)?;
    let (axis, across) = directions?;
    let child_position = body_tables[child].get_ref().position_m.as_ref().map(|position| *position.get_ref());
    Some(Joint {
        name: written.name.get_ref().clone(),
        kind,
        parent,
        child,
        anchor_m: anchor.or(child_position).unwrap_or_default(),
        axis,
        across,
        initial: coordinate.initial,
        lower: coordinate.lower,
        upper: coordinate.upper,
        contacts: written.contacts.unwrap_or(false),
        guided: written.guided,
        follows: None,
    })
}

/// The bodies of a joint: two different ones, of which a force moves one at least.
fn joined(
    written: &JointTable,
    body_tables: &[Placed<BodyTable>],
    bodies: &Names,
    faults: &mut Faults<'_>,
) -> Option<(Option<usize>, usize)> {
    let name = text(&written.name).to_owned();
    let child = bodies.find(&written.child, faults);
    let parent = if text(&written.parent) == GROUND {
        None
    } else {
        Some(bodies.find_beside(&written.parent, Some(GROUND), faults)?)
    };
    let child = child?;
    if parent == Some(child) {
        faults.add(written.child.span(), SceneFaultKind::SelfJoined(name));
        return None;
    }
    let moved = |index: usize| body_tables[index].get_ref().kind == BodyKind::Dynamic;
    if !written.guided && !moved(child) && !parent.is_some_and(moved) {
        let hint = Some("make one of the bodies dynamic".to_owned());
        faults.add_hinted(written.child.span(), SceneFaultKind::Immovable(name), hint);
        return None;
    }
    Some((parent, child))
}

/// Refuses what would act on a joint of a robot without dynamics, which only an `[[axis]]` moves; true if so.
pub(super) fn refuse_guided(joint: &JointTable, name: &Placed<String>, faults: &mut Faults<'_>) -> bool {
    if joint.guided {
        let hint = Some("leave `kinematic` out of the robot's table, or move the joint by an `[[axis]]`".to_owned());
        faults.add_hinted(name.span(), SceneFaultKind::Guided(text(name).to_owned()), hint);
    }
    joint.guided
}

/// Axis and slide of a joint, perpendicular and of unit length.
fn directions(written: &JointTable, faults: &mut Faults<'_>) -> Option<([f64; 3], [f64; 3])> {
    let kind = *written.kind.get_ref();
    let axis = direction(written, "axis", written.axis.as_ref(), unit(kind).is_some(), faults);
    let slide = direction(written, "slide", written.slide.as_ref(), kind == JointKind::Slot, faults);
    let (axis, slide) = (axis?, slide?);
    if kind != JointKind::Slot {
        return Some((axis, across(axis)));
    }
    let cosine = dot(axis, slide);
    if cosine.abs() > OBLIQUE_MAX {
        let span = written.slide.as_ref().map_or_else(|| written.name.span(), Triple::span);
        faults.add(span, SceneFaultKind::Oblique(text(&written.name).to_owned()));
    }
    Some((axis, unit_vector([0, 1, 2].map(|i| slide[i] - cosine * axis[i]))))
}

/// A direction that this kind of joint needs or must not have; x where it is not needed.
fn direction(
    written: &JointTable,
    key: &'static str,
    value: Option<&Triple>,
    needed: bool,
    faults: &mut Faults<'_>,
) -> Option<[f64; 3]> {
    let whose = || format!("{} joint `{}`", kind_name(*written.kind.get_ref()), text(&written.name));
    match (value, needed) {
        (Some(value), true) => faults.direction(key, value),
        (None, true) => {
            faults.add(written.name.span(), SceneFaultKind::Missing { whose: whose(), key });
            None
        }
        (Some(value), false) => {
            faults.add(value.span(), SceneFaultKind::Misplaced { whose: whose(), key });
            None
        }
        (None, false) => Some([1.0, 0.0, 0.0]),
    }
}

/// A unit vector at a right angle to `axis`, always the same one.
fn across(axis: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = axis;
    if x.abs() <= y.abs() && x.abs() <= z.abs() {
        unit_vector([0.0, z, -y])
    } else if y.abs() <= z.abs() {
        unit_vector([-z, 0.0, x])
    } else {
        unit_vector([y, -x, 0.0])
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit_vector(vector: [f64; 3]) -> [f64; 3] {
    let length = dot(vector, vector).sqrt();
    vector.map(|component| component / length)
}

/// The coordinate of a joint: its value in the scene's pose and its limits.
#[derive(Default)]
struct Coordinate {
    initial: f64,
    lower: Option<f64>,
    upper: Option<f64>,
}

fn coordinate(written: &JointTable, faults: &mut Faults<'_>) -> Coordinate {
    let kind = *written.kind.get_ref();
    let whose = format!("{} joint `{}`", kind_name(kind), text(&written.name));
    let pairs = [
        (Entry::new("initial_m", written.initial_m.as_ref()), Entry::new("initial_rad", written.initial_rad.as_ref())),
        (Entry::new("lower_m", written.lower_m.as_ref()), Entry::new("lower_rad", written.lower_rad.as_ref())),
        (Entry::new("upper_m", written.upper_m.as_ref()), Entry::new("upper_rad", written.upper_rad.as_ref())),
    ];
    let Some(unit) = unit(kind) else {
        for entry in pairs.into_iter().flat_map(|(metre, radian)| [metre, radian]) {
            if let Some(value) = entry.value {
                faults.add(value.span(), SceneFaultKind::Misplaced { whose: whose.clone(), key: entry.key });
            }
        }
        return Coordinate::default();
    };
    let [initial, lower, upper] = pairs.map(|(metre, radian)| faults.in_unit(&whose, unit, metre, radian));
    let coordinate = Coordinate {
        initial: faults.number(initial, Allowed::Finite).unwrap_or_default(),
        lower: faults.number(lower, Allowed::Finite),
        upper: faults.number(upper, Allowed::Finite),
    };
    refuse_disorder(&coordinate, [initial, lower, upper], faults);
    coordinate
}

/// Limits must be in order, with the initial coordinate between them.
fn refuse_disorder(coordinate: &Coordinate, entries: [Entry<'_>; 3], faults: &mut Faults<'_>) {
    let [initial, lower, upper] = entries;
    let least = coordinate.lower.unwrap_or(f64::NEG_INFINITY);
    let most = coordinate.upper.unwrap_or(f64::INFINITY);
    let (low, high, at) = if least > most {
        (lower, upper, upper)
    } else if coordinate.initial < least {
        (lower, initial, lower)
    } else if coordinate.initial > most {
        (initial, upper, upper)
    } else {
        return;
    };
    if let Some(value) = at.value {
        faults.add(value.span(), SceneFaultKind::Order { lower: low.key, upper: high.key });
    }
}
