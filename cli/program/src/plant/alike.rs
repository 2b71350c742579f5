//! Bodies as lines of a tree; neighbours in an array that are alike are one line, as in `package[0..19]`.

use onescan_plant::scene::model::{Body, BodyKind, Mass, Scene, Shape};

/// True for neighbours in an array that are alike and carry nothing: one line says both.
pub(super) fn follows(scene: &Scene, one: usize, next: usize) -> bool {
    let carries = |index: usize| scene.joints.iter().any(|joint| joint.parent == Some(index));
    let [a, b] = [one, next].map(|index| &scene.bodies[index]);
    let is_next = match (element(&a.name), element(&b.name)) {
        (Some((array, at)), Some((other, after))) => array == other && at.checked_add(1) == Some(after),
        _ => false,
    };
    is_next && about(a) == about(b) && !carries(one) && !carries(next)
}

/// Bodies that follow each other, in a line.
pub(super) fn bodies(scene: &Scene, alike: &[usize]) -> String {
    let Some(first) = alike.first().map(|index| &scene.bodies[*index]) else { return String::new() };
    let last = alike.last().and_then(|index| element(&scene.bodies[*index].name));
    match (element(&first.name), last) {
        (Some((array, from)), Some((_, to))) if from < to => format!("{array}[{from}..{to}]: {}", about(first)),
        _ => body(first),
    }
}

/// A body in a line.
pub(super) fn body(body: &Body) -> String {
    format!("{}: {}", body.name, about(body))
}

/// The array of a name such as `box[3]`, and the place in it.
fn element(name: &str) -> Option<(&str, u32)> {
    let (array, index) = name.strip_suffix(']')?.rsplit_once('[')?;
    Some((array, index.parse().ok()?))
}

/// What a body is, without its name.
fn about(body: &Body) -> String {
    let kind = match body.kind {
        BodyKind::Fixed => "fixed",
        BodyKind::Dynamic => "dynamic",
        BodyKind::Kinematic => "kinematic",
    };
    let shape = match &body.shape {
        None => String::new(),
        Some(Shape::Box { size_m: [x, y, z] }) => format!(", box {x} x {y} x {z} m"),
        Some(Shape::Sphere { radius_m }) => format!(", sphere of radius {radius_m} m"),
        Some(Shape::Cylinder { radius_m, length_m }) => format!(", cylinder of radius {radius_m} m, {length_m} m long"),
        Some(Shape::Capsule { radius_m, length_m }) => format!(", capsule of radius {radius_m} m, {length_m} m long"),
        Some(Shape::Hull { file, corners_m }) => format!(", hull of {file} with {} corners", corners_m.len()),
        Some(Shape::Surface { file, triangles, .. }) => {
            format!(", surface of {file} with {} triangles", triangles.len())
        }
    };
    let mass = match (body.kind, body.mass) {
        (BodyKind::Dynamic, Mass::Total { kg } | Mass::Stated { kg, .. }) => format!(", {kg} kg"),
        (BodyKind::Dynamic, Mass::Density { kg_m3 }) => format!(", {kg_m3} kg/m³"),
        _ => String::new(),
    };
    format!("{kind}{shape}{mass}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_in_an_array_is_a_number() {
        assert_eq!(element("box[3]"), Some(("box", 3)));
        assert_eq!(element("cell[1].box[12]"), Some(("cell[1].box", 12)));
        assert_eq!([element("box"), element("box[a]"), element("[]")], [None, None, None]);
    }
}
