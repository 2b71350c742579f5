//! `[[urdf]]`: a robot from its maker's file, as bodies, shapes and joints of the scene.
//!
//! A link `upper` of a robot that the scene calls `arm` is the body `arm.upper`, its collision shapes are
//! `arm.upper.shape[0]` and so on, a joint `elbow` is `arm.elbow`. A link without mass is a mere frame: what it
//! has belongs to the link that it is fixed to. The root is fixed to the world unless the scene says
//! otherwise; what hangs on it by fixed joints only stays in place with it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use onescan_base::did_you_mean;

use super::error::{Inside, SceneFaultKind};
use super::faults::Faults;
use super::format::{SceneFile, UrdfTable};
use super::number::{Allowed, Entry};
use super::placed::Placed;
use super::robot_tables::Tables;
use crate::mesh::Mesh;
use crate::robot::{Collision, Freedom, Geometry, Joint, Packages, Reading, Robot, RobotFault};

/// Adds what the robots of a file are made of, behind its own bodies, shapes and joints; what was read
/// otherwise than it is written, for people.
pub(super) fn expand(written: &mut SceneFile, faults: &mut Faults<'_>) -> Vec<String> {
    let mut remarks = Vec::new();
    for table in std::mem::take(&mut written.urdf) {
        let table = table.get_ref();
        match one(table, written, faults) {
            Some(reported) => {
                remarks.extend(reported.into_iter().map(|reported| format!("{}: {reported}", table.name.get_ref())));
            }
            None => faults.lose(format!("{}.", table.name.get_ref())),
        }
    }
    remarks
}

/// Adds one robot, unless something is wrong with it.
fn one(table: &UrdfTable, written: &mut SceneFile, faults: &mut Faults<'_>) -> Option<Vec<String>> {
    let file = table.file.get_ref();
    let path = faults.beside(file);
    if let (Some(kinematic), Some(false)) = (&table.kinematic, table.fixed)
        && *kinematic.get_ref()
    {
        let whose = format!("kinematic robot `{}`, whose root rests,", table.name.get_ref());
        faults.add(kinematic.span(), SceneFaultKind::Misplaced { whose, key: "fixed" });
        return None;
    }
    let packages = packages(table, faults);
    let arguments = arguments(table, faults)?;
    let reading = Reading { file, packages: &packages, arguments: &arguments };
    let text = faults.within().read_text(&path);
    let text = text.map_err(|error| {
        let cause = format!("cannot be read: {error}");
        faults.add(table.file.span(), SceneFaultKind::Urdf { file: file.clone(), cause });
    });
    let mut robot = match Robot::read(&path, text.ok()?, &reading) {
        Ok(robot) => robot,
        Err(found) => {
            for fault in found {
                refuse(table, fault, faults);
            }
            return None;
        }
    };
    // by the name under which the scene reads it again
    let beside = |named: &str| Some(faults.beside(&named_from(&packages.file(named, &path).ok()?, &faults.beside(""))));
    let mesh = |named: &str| faults.mesh(&beside(named)?).ok();
    leave_out_flat(&mut robot, table.density_kg_m3.is_some(), &mesh);
    // reported as the link's or the joint's, so that one of a hundred joints is found
    let coordinates = coordinates(table, &mut robot, faults)?;
    let density = Entry::new("density_kg_m3", table.density_kg_m3.as_ref());
    let density_kg_m3 = faults.number(density, Allowed::Within(1e-2, 1e5));
    let scene_folder = faults.beside("");
    let find = |mesh: &str| packages.file(mesh, &path).map(|found| named_from(&found, &scene_folder));
    let tables = Tables { table, robot: &robot, density_kg_m3, coordinates: &coordinates, find: &find };
    match tables.add_to(written) {
        Ok(reported) => robot.remarks.extend(reported),
        Err(mut found) => {
            // a macro that is called twice
            found.dedup();
            for fault in found {
                refuse(table, fault, faults);
            }
            return None;
        }
    }
    Some(robot.remarks)
}

/// Takes out flat meshes: they show a label or the edge of a colour, and are no bodies, also where the file lets them
/// collide. Where links without mass are to be weighed, what is shown of one that does not collide counts, too.
fn leave_out_flat(robot: &mut Robot, weighs: bool, mesh: &dyn Fn(&str) -> Option<Arc<Mesh>>) {
    for link in &mut robot.links {
        let mut is_flat = |shape: &Collision| {
            let Geometry::Mesh(file, stretch) = &shape.geometry else { return false };
            // what cannot be read is reported with the shapes that are kept
            let flat = mesh(file).is_some_and(|mesh| crate::mesh::flat::is_flat(&mesh, *stretch));
            if flat {
                robot.remarks.push(format!("the mesh `{file}` of link `{}` is flat: it is left out", link.name));
            }
            flat
        };
        let seen = weighs && link.collisions.is_empty() && link.inertial.is_none();
        link.collisions.retain(|shape| !is_flat(shape));
        if seen {
            link.visuals.retain(|shape| !is_flat(shape));
        }
    }
}

/// A fault in a robot's file, reported at the file's name in the scene.
fn refuse(table: &UrdfTable, fault: RobotFault, faults: &mut Faults<'_>) {
    let file = table.file.get_ref().clone();
    let start = fault.place.start();
    let inner = if start.file == file { String::new() } else { format!("in {} ", start.file) };
    let cause = format!("{inner}line {}: {}", start.line, fault.cause);
    let kind = SceneFaultKind::Urdf { file, cause };
    faults.add_inside(table.file.span(), kind, fault.hint, Inside { reported: fault.cause, place: fault.place });
}

/// A path as the scene would name it.
fn named_from(path: &Path, scene_folder: &Path) -> String {
    // what a xacro has found is absolute, where the scene may be named from the folder in which the program runs
    let whole = std::path::absolute(if scene_folder.as_os_str().is_empty() { Path::new(".") } else { scene_folder });
    let inside = whole.as_ref().ok().and_then(|whole| path.strip_prefix(whole).ok());
    inside.or_else(|| path.strip_prefix(scene_folder).ok()).unwrap_or(path).display().to_string()
}

fn packages(table: &UrdfTable, faults: &mut Faults<'_>) -> Packages {
    let mut named: Vec<(String, PathBuf)> = Vec::new();
    for (name, folder) in table.packages.iter().flatten() {
        let path = faults.beside(folder.get_ref());
        if !path.is_dir() {
            let cause = format!("is to find package `{name}` in `{}`, which is not a folder", folder.get_ref());
            faults.add(folder.span(), SceneFaultKind::Urdf { file: table.file.get_ref().clone(), cause });
        }
        named.push((name.clone(), path));
    }
    Packages::new(named, faults.within().clone())
}

/// The arguments of a xacro, as text.
fn arguments(table: &UrdfTable, faults: &mut Faults<'_>) -> Option<Vec<(String, String)>> {
    let mut arguments = Vec::new();
    for (name, value) in table.arguments.iter().flatten() {
        let text = match value.get_ref() {
            toml::Value::String(text) => text.clone(),
            plain @ (toml::Value::Integer(_) | toml::Value::Float(_) | toml::Value::Boolean(_)) => plain.to_string(),
            toml::Value::Datetime(_) | toml::Value::Array(_) | toml::Value::Table(_) => {
                let wanted = "a text, a number or a truth value";
                faults.add(value.span(), SceneFaultKind::Text { key: name.clone(), wanted });
                return None;
            }
        };
        arguments.push((name.clone(), text));
    }
    Some(arguments)
}

/// Where every joint stands in the scene's pose: as the scene says, as the file does (at 0, if it does not), or in the
/// middle of limits that do not have that between them. A joint that follows another stands where that one takes it.
fn coordinates(table: &UrdfTable, robot: &mut Robot, faults: &mut Faults<'_>) -> Option<Vec<f64>> {
    let mut given: Vec<Option<f64>> = vec![None; robot.joints.len()];
    let mut right = true;
    for (keys, unit, wanted) in
        [(&table.initial_rad, "initial_rad", Freedom::Turns), (&table.initial_m, "initial_m", Freedom::Slides)]
    {
        for (name, value) in keys.iter().flatten() {
            let joint = robot.joints.iter().position(|joint| joint.name == *name && joint.freedom == wanted);
            if let Some(joint) = joint.filter(|at| robot.joints[*at].mimic.is_none()) {
                right &= place(&robot.joints[joint], value, unit, &mut given[joint], faults);
            } else {
                refuse_joint(table, robot, (name, value.span()), unit, faults);
                right = false;
            }
        }
    }
    if !right {
        return None;
    }
    let mut coordinates: Vec<f64> = Vec::with_capacity(given.len());
    let mut remarks = Vec::new();
    for (joint, given) in robot.joints.iter().zip(&given) {
        coordinates.push(given.unwrap_or_else(|| match joint.limits {
            Some([lower, upper]) if !(lower..=upper).contains(&joint.reference) => {
                let middle = 0.5 * (lower + upper);
                let (name, stands) = (&joint.name, joint.reference);
                remarks.push(format!("joint `{name}` cannot stand at {stands}: it begins at {middle}"));
                middle
            }
            Some(_) | None => joint.reference,
        }));
    }
    robot.remarks.extend(remarks);
    follow(robot, &mut coordinates);
    Some(coordinates)
}

/// One joint's coordinate, unless it lies beyond the limits.
fn place(joint: &Joint, value: &Placed<f64>, key: &'static str, to: &mut Option<f64>, faults: &mut Faults<'_>) -> bool {
    let [lower, upper] = joint.limits.unwrap_or([-1e9, 1e9]);
    *to = faults.number(Entry::new(key, Some(value)), Allowed::Within(lower, upper));
    to.is_some()
}

fn refuse_joint(
    table: &UrdfTable,
    robot: &Robot,
    (name, span): (&str, std::ops::Range<usize>),
    key: &'static str,
    faults: &mut Faults<'_>,
) {
    let file = table.file.get_ref().clone();
    let cause = match robot.joints.iter().find(|joint| joint.name == name) {
        None => format!("has no joint `{name}`"),
        Some(joint) if joint.mimic.is_some() => format!("has a joint `{name}` that follows another"),
        Some(_) => format!("has a joint `{name}` to which `{key}` does not apply"),
    };
    let known = robot.joints.iter().any(|joint| joint.name == name);
    let hint = did_you_mean(name, robot.joints.iter().map(|joint| joint.name.as_str()));
    faults.add_hinted(span, SceneFaultKind::Urdf { file, cause }, hint.filter(|_| !known));
}

/// Puts the joints that follow others where those take them; as often as a chain of them can be long.
fn follow(robot: &Robot, coordinates: &mut [f64]) {
    let leader = |joint: &Joint| {
        let mimic = joint.mimic.as_ref()?;
        let at = robot.joints.iter().position(|known| known.name == mimic.joint)?;
        Some((at, mimic.factor, mimic.offset))
    };
    let followers: Vec<_> =
        robot.joints.iter().enumerate().filter_map(|(at, joint)| Some((at, leader(joint)?))).collect();
    for _ in 0..followers.len() {
        for (at, (leader, factor, offset)) in &followers {
            coordinates[*at] = factor * coordinates[*leader] + offset;
        }
    }
}
