//! The machine: the bodies and components of a scene, as the page draws and lists them.

use onescan_plant::component::kind::{self, unit};
use onescan_plant::scene::model::{BodyKind, Bound, Component, Driven, Joint, JointKind, Mass, Wire};
use onescan_plant::{Form, Frame, Geometry, Scene};
use schemars::JsonSchema;
use serde::Serialize;

use super::picture::Stage;

/// A body, or a shape of one, where the scene has it.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Body {
    pub(super) name: String,
    pub(super) kind: &'static str,
    pub(super) shape: Shape,
    pub(super) position_m: [f64; 3],
    /// x, y, z, w.
    #[schemars(default = "upright")]
    pub(super) rotation: [f64; 4],
    /// The body in whose frame it is; its place is in the world's without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) on: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) colour: Option<String>,
    /// How much one sees through it, 0 to 1.
    #[serde(skip_serializing_if = "is_zero")]
    #[schemars(default)]
    pub(super) transparent: f64,
    /// What it is made of, as its density says; nothing of one that no force moves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) density_kg_m3: Option<f64>,
}

/// The shape of a body; a cylinder and a capsule lie along z.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "lowercase")]
#[schemars(extend("x-check" = "shape"))]
pub(super) enum Shape {
    None,
    Box {
        size_m: [f64; 3],
    },
    Sphere {
        radius_m: f64,
    },
    Cylinder {
        radius_m: f64,
        length_m: f64,
    },
    /// A cylinder or a cone, without ends if it is open.
    Round {
        radius_m: f64,
        top_radius_m: f64,
        length_m: f64,
        #[schemars(default)]
        open: bool,
    },
    Capsule {
        radius_m: f64,
        length_m: f64,
    },
    /// Positions are flat triples, indices flat triangles.
    Mesh {
        positions_m: Vec<f64>,
        indices: Vec<u32>,
    },
}

fn upright() -> [f64; 4] {
    [0.0, 0.0, 0.0, 1.0]
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde asks for it")]
fn is_zero(share: &f64) -> bool {
    *share == 0.0
}

/// A component of a plant.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "Component")]
pub(super) struct Part {
    pub(super) name: String,
    kind: String,
    pub(super) body: Option<String>,
    /// Where it is in the scene, for its shape.
    #[serde(skip_serializing_if = "Option::is_none")]
    place: Option<Place>,
    /// Its inputs and outputs that have a signal: the key, and the signal's name.
    #[schemars(default)]
    pins: Vec<[String; 2]>,
    /// The names of the signals that it reads and writes.
    #[schemars(default)]
    signals: Vec<String>,
    /// The signal that is true while a sensor sees something; its body is lit then.
    senses: Option<String>,
    #[schemars(default)]
    parameters: Vec<Parameter>,
    #[schemars(default)]
    pub(super) failures: Vec<Failure>,
}

/// Where a component is in the scene's pose, in the world, as far as it is anywhere.
#[derive(Debug, Serialize, JsonSchema)]
struct Place {
    /// Where it begins, as a beam does.
    #[serde(skip_serializing_if = "Option::is_none")]
    point_m: Option<[f64; 3]>,
    /// Unit vector along which it points or runs.
    #[serde(skip_serializing_if = "Option::is_none")]
    direction: Option<[f64; 3]>,
    /// Unit vector along which one of its beams is beside the other.
    #[serde(skip_serializing_if = "Option::is_none")]
    along: Option<[f64; 3]>,
    /// The body that it moves: a belt, or what a joint lets move.
    #[serde(skip_serializing_if = "Option::is_none")]
    moves: Option<String>,
    /// The joint that it drives.
    #[serde(skip_serializing_if = "Option::is_none")]
    joint: Option<DrivenJoint>,
}

/// A joint that a component drives.
#[derive(Debug, Serialize, JsonSchema)]
struct DrivenJoint {
    /// Whether it turns; it slides if not.
    turns: bool,
    /// The body in whose frame it is; the ground's without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    parent: Option<String>,
    anchor_m: [f64; 3],
    axis: [f64; 3],
    /// How far it may go from where the scene has it, m or rad; nothing where it has no end.
    #[serde(skip_serializing_if = "Option::is_none")]
    back: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ahead: Option<f64>,
}

/// A parameter of a component, as it is shown.
#[derive(Debug, Serialize, JsonSchema)]
struct Parameter {
    name: String,
    value: String,
    unit: Option<&'static str>,
    /// As a scene has it, with its unit; a change names it so.
    #[schemars(default)]
    key: String,
    /// The type of its values: `LREAL`, `DINT`, `BOOL`; empty for one of `words`.
    #[serde(rename = "type")]
    #[schemars(default)]
    ty: String,
    /// What it may be, if it is one of some words.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(default)]
    words: Vec<&'static str>,
    /// Whether a component only begins with it, so that it does not change while the plant runs.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    #[schemars(default)]
    fixed: bool,
}

/// A mode in which a component can fail.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Failure {
    name: String,
}

/// The bodies of a scene, as it is set up.
pub fn bodies_of(scene: &Scene) -> Vec<Body> {
    let mut bodies = Vec::new();
    add_bodies(scene, &mut bodies, &mut Stage::default());
    bodies
}

/// Adds the bodies of a scene to those of others; `stage` learns which of them move with which.
pub(super) fn add_bodies(scene: &Scene, bodies: &mut Vec<Body>, stage: &mut Stage) {
    let frames: Vec<Frame> = scene.frames().collect();
    for form in scene.forms() {
        let number = u32::try_from(bodies.len()).unwrap_or(u32::MAX);
        if form.kind != BodyKind::Fixed {
            stage.follow(form.body, number, form.within);
        }
        let place = form.within.seen_from(frames[form.index]);
        let density_kg_m3 = scene.bodies.get(form.index).and_then(|body| density_kg_m3(body, &form.geometry));
        let Form { body, attached, kind, geometry, .. } = form;
        bodies.push(Body {
            name: attached.map_or_else(|| body.to_owned(), |shape| format!("{body}/{shape}")),
            kind: match kind {
                BodyKind::Fixed => "fixed",
                BodyKind::Kinematic => "kinematic",
                BodyKind::Dynamic => "dynamic",
            },
            shape: shape(geometry),
            position_m: place.position_m,
            rotation: place.rotation_xyzw,
            on: None,
            colour: None,
            transparent: 0.0,
            density_kg_m3,
        });
    }
}

/// The density of a body that forces move; nothing where its volume is not known.
fn density_kg_m3(body: &onescan_plant::scene::model::Body, geometry: &Geometry) -> Option<f64> {
    if body.kind != BodyKind::Dynamic {
        return None;
    }
    let kg = match body.mass {
        Mass::Density { kg_m3 } => return Some(kg_m3),
        Mass::Total { kg } | Mass::Stated { kg, .. } => kg,
    };
    let volume_m3 = volume_m3(geometry);
    (volume_m3 > 0.0).then(|| kg / volume_m3)
}

/// The volume of a form, m³; that of a mesh if it is closed.
fn volume_m3(geometry: &Geometry) -> f64 {
    use std::f64::consts::PI;
    let ball = |radius_m: f64| 4.0 / 3.0 * PI * radius_m * radius_m * radius_m;
    let barrel = |radius_m: f64, length_m: f64| PI * radius_m * radius_m * length_m;
    match geometry {
        Geometry::Nothing => 0.0,
        Geometry::Box { size_m } => size_m.iter().product(),
        Geometry::Sphere { radius_m } => ball(*radius_m),
        Geometry::Cylinder { radius_m, length_m } => barrel(*radius_m, *length_m),
        Geometry::Capsule { radius_m, length_m } => barrel(*radius_m, *length_m) + ball(*radius_m),
        Geometry::Mesh { corners_m, triangles } => {
            let corner = |index: u32| corners_m.get(index as usize).copied().unwrap_or_default();
            let sixfold = |[a, b, c]: [[f64; 3]; 3]| {
                let minor = |row: usize, column: usize| b[row] * c[column] - b[column] * c[row];
                a[0] * minor(1, 2) + a[1] * minor(2, 0) + a[2] * minor(0, 1)
            };
            (triangles.iter().map(|of| sixfold(of.map(corner))).sum::<f64>() / 6.0).abs()
        }
    }
}

fn shape(geometry: Geometry) -> Shape {
    match geometry {
        Geometry::Nothing => Shape::None,
        Geometry::Box { size_m } => Shape::Box { size_m },
        Geometry::Sphere { radius_m } => Shape::Sphere { radius_m },
        Geometry::Cylinder { radius_m, length_m } => Shape::Cylinder { radius_m, length_m },
        Geometry::Capsule { radius_m, length_m } => Shape::Capsule { radius_m, length_m },
        Geometry::Mesh { corners_m, triangles } => Shape::Mesh {
            positions_m: corners_m.into_iter().flatten().collect(),
            indices: triangles.into_iter().flatten().collect(),
        },
    }
}

/// A component of a scene.
pub(super) fn part(component: &Component, scene: &Scene) -> Part {
    let taken = component.inputs.iter().filter_map(|wire| match wire {
        Wire::Signal(name) => Some(name.to_string()),
        Wire::Open | Wire::Constant(_) | Wire::Output { .. } => None,
    });
    let given: Vec<String> = component.outputs.iter().flatten().map(ToString::to_string).collect();
    let parameter = |(parameter, setting): (&kind::Parameter, &kind::Setting)| {
        let (name, unit) = unit(&parameter.key);
        let (ty, words) = match parameter.form {
            kind::Form::Number { .. } => ("LREAL", Vec::new()),
            kind::Form::Count { .. } => ("DINT", Vec::new()),
            kind::Form::Flag => ("BOOL", Vec::new()),
            kind::Form::Choice(words) => ("", words.to_vec()),
        };
        let (key, value, ty) = (parameter.key.to_string(), setting.to_string(), ty.to_owned());
        Parameter { name: name.to_owned(), value, unit, key, ty, words, fixed: parameter.initial }
    };
    Part {
        name: component.name.clone(),
        kind: component.kind.name.to_string(),
        body: component.bound.body.and_then(|body| scene.bodies.get(body)).map(|body| body.name.clone()),
        place: place(component, scene),
        pins: pins(component),
        senses: senses(component),
        signals: taken.chain(given.iter().cloned()).collect(),
        parameters: component.kind.parameters.iter().zip(&component.settings).map(parameter).collect(),
        failures: component.kind.failures.iter().map(|mode| Failure { name: mode.mode.to_string() }).collect(),
    }
}

/// Its inputs and outputs with their signals.
fn pins(component: &Component) -> Vec<[String; 2]> {
    let inputs = component.kind.inputs.iter().zip(&component.inputs).filter_map(|(pin, wire)| match wire {
        Wire::Signal(name) => Some([pin.key.to_string(), name.to_string()]),
        Wire::Open | Wire::Constant(_) | Wire::Output { .. } => None,
    });
    let outputs = component.kind.outputs.iter().zip(&component.outputs);
    let outputs = outputs.filter_map(|(pin, name)| Some([pin.key.to_string(), name.as_ref()?.to_string()]));
    inputs.chain(outputs).collect()
}

/// Where it is; nothing of a component that is nowhere.
fn place(component: &Component, scene: &Scene) -> Option<Place> {
    let Bound { drives, point_m, direction, along, .. } = component.bound;
    let body = |index: usize| scene.bodies.get(index).map(|body| body.name.clone());
    let (moves, joint) = match drives {
        Some(Driven::Belt(belt)) => (body(belt), None),
        Some(Driven::Joint(joint)) => {
            let joint = scene.joints.get(joint)?;
            (body(joint.child), driven(joint, joint.parent.and_then(body)))
        }
        None => (None, None),
    };
    // A tank or a lamp acts on no body, and is where the scene shows it.
    let point_m = point_m.or(component.shown_at_m);
    let is_somewhere = point_m.is_some() || direction.is_some() || moves.is_some();
    is_somewhere.then_some(Place { point_m, direction, along, moves, joint })
}

/// A joint as a drive's shape needs it; nothing of one that neither slides nor turns about one axis.
fn driven(joint: &Joint, parent: Option<String>) -> Option<DrivenJoint> {
    let turns = match joint.kind {
        JointKind::Revolute => true,
        JointKind::Prismatic => false,
        JointKind::Fixed | JointKind::Slot | JointKind::Ball => return None,
    };
    let from = |end: Option<f64>| end.map(|end| end - joint.initial);
    let (back, ahead) = (from(joint.lower), from(joint.upper));
    Some(DrivenJoint { turns, parent, anchor_m: joint.anchor_m, axis: joint.axis, back, ahead })
}

/// The signal that is true while a sensor sees something.
fn senses(component: &Component) -> Option<String> {
    const SEES: &[&str] = &["detected", "contact", "pulse", "present", "in_range"];
    let mut outputs = component.kind.outputs.iter().zip(&component.outputs);
    outputs.find(|(output, _)| SEES.contains(&&*output.key))?.1.as_ref().map(ToString::to_string)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CELL: &str = include_str!("../../../../scenarios/templates/cell/plant.toml");
    const LAMP: &str = "
[[component]]
name = \"ready\"
kind = \"lamp\"
shown_at_m = [1.0, 2.0, 0.5]
";

    fn scene(more: &str) -> Scene {
        Scene::parse(&format!("{CELL}{more}"), "plant.toml").expect("a scene")
    }

    #[test]
    fn a_density_is_that_of_mass_and_volume() {
        let bodies = bodies_of(&scene(""));
        let density = |name: &str| bodies.iter().find(|body| body.name == name).and_then(|body| body.density_kg_m3);
        // 0.5 kg in a litre, and 2 kg in 0.256 of one
        assert!(density("box[0]").is_some_and(|kg_m3| (kg_m3 - 500.0).abs() < 1e-9), "{:?}", density("box[0]"));
        assert!(density("pusher").is_some_and(|kg_m3| (kg_m3 - 7812.5).abs() < 1e-9), "{:?}", density("pusher"));
        assert_eq!((density("belt"), density("chute")), (None, None), "no force moves them");
    }

    #[test]
    fn a_closed_mesh_has_its_volume() {
        let corners_m = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
        let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        assert!((volume_m3(&Geometry::Mesh { corners_m, triangles }) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_acts_on_no_body_is_where_the_scene_shows_it() {
        let scene = scene(LAMP);
        let place = |name: &str| {
            let component = scene.components.iter().find(|one| one.name == name).expect("it is there");
            part(component, &scene).place.and_then(|place| place.point_m)
        };
        assert_eq!(place("ready"), Some([1.0, 2.0, 0.5]));
        assert_eq!(place("barrier"), Some([0.36, -0.145, 0.09]), "a beam is where it begins");
        let parameters = part(&scene.components[0], &scene).parameters;
        let speed = parameters.iter().find(|parameter| parameter.key == "speed_m_s").expect("a belt has one");
        assert_eq!((speed.name.as_str(), speed.ty.as_str(), speed.fixed), ("speed", "LREAL", false));
    }
}
