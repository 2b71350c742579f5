//! The tables that a robot's file stands for.

use rapier3d::glamx::{DQuat, DVec3};
use rapier3d::math::Pose;

use super::format::{BodyTable, FollowTable, JointTable, SceneFile, ShapeKind, ShapeTable, UrdfTable};
use super::number::LENGTH_MIN_M;
use super::placed::Placed;
use crate::model::{BodyKind, JointKind};
use crate::pose::{from_rpy_deg, to_rpy_deg, turned_tensor};
use crate::robot::{Collision, Freedom, Geometry, Inertial, Joint, Origin, Robot, RobotFault, Weight};

/// What a link without any shape is taken for where it must have a mass: a ball.
const BALL_RADIUS_M: f64 = 0.03;
/// Of aluminium, what robots are made of; where the scene gives no density.
const DENSITY_KG_M3: f64 = 2700.0;
/// Of a ball's volume, `4/3 π`.
const BALL: f64 = 4.0 / 3.0 * std::f64::consts::PI;

/// A robot on its way into the scene.
pub(super) struct Tables<'t> {
    pub(super) table: &'t UrdfTable,
    pub(super) robot: &'t Robot,
    pub(super) density_kg_m3: Option<f64>,
    /// Of each joint, in the scene's pose.
    pub(super) coordinates: &'t [f64],
    /// A mesh's file as the scene names it, or why it is not found.
    pub(super) find: &'t dyn Fn(&str) -> Result<String, String>,
}

/// What a link is in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    /// A body that stays in place.
    Rests,
    /// A body that forces move.
    Moves,
    /// A frame on the body of another link, by that link's index.
    FrameOn(usize),
}

impl Tables<'_> {
    /// Adds the robot's bodies, shapes and joints; what was read otherwise than it is written.
    ///
    /// # Errors
    /// Links that cannot be bodies, shapes that are not found.
    pub(super) fn add_to(&self, written: &mut SceneFile) -> Result<Vec<String>, Vec<RobotFault>> {
        let poses = self.poses();
        let parts = self.parts()?;
        let mut faults = Vec::new();
        let mut remarks = Vec::new();
        for (index, link) in self.robot.links.iter().enumerate() {
            let body = match parts[index] {
                Part::FrameOn(other) => other,
                Part::Rests | Part::Moves => {
                    written.body.push(self.at(self.body(index, parts[index], &poses[index], &mut remarks)));
                    index
                }
            };
            let (shapes, mark) = self.shapes_of(index, parts[body]);
            for (k, shape) in shapes.iter().enumerate() {
                if is_nothing(&shape.geometry) {
                    let size = "has no size or less than 0.1 mm";
                    remarks.push(format!("a shape of link `{}` {size}: it is left out", link.name));
                    continue;
                }
                let place = poses[index] * pose(&shape.origin);
                let name = self.named(&format!("{}.{mark}[{k}]", link.name));
                let on = self.named(&self.robot.links[body].name);
                match self.shape([name, on], shape, &place, shape.collides && mark == "shape") {
                    Ok(mut table) => {
                        let weighs = parts[body] == Part::Moves && !self.is_kinematic();
                        if weighs && self.robot.links[body].inertial.is_none() {
                            self.weigh(shape, &mut table);
                        }
                        written.shape.push(self.at(table));
                    }
                    // a picture that is not there is no fault of a machine
                    Err(_) if mark == "visual" => {}
                    Err(fault) => faults.push(fault),
                }
            }
        }
        for (index, joint) in self.robot.joints.iter().enumerate() {
            written.joint.extend(self.joint(index, joint, &parts, &poses).map(|table| self.at(table)));
        }
        if faults.is_empty() { Ok(remarks) } else { Err(faults) }
    }

    /// Whether its joints are where they are set, without dynamics.
    fn is_kinematic(&self) -> bool {
        self.table.kinematic.as_ref().is_some_and(|kinematic| *kinematic.get_ref())
    }

    fn at<T>(&self, value: T) -> Placed<T> {
        Placed::new(self.table.file.span(), value)
    }

    fn named(&self, name: &str) -> Placed<String> {
        self.at(format!("{}.{name}", self.table.name.get_ref()))
    }

    /// Where each link is in the scene's pose.
    fn poses(&self) -> Vec<Pose> {
        let zero = [0.0; 3];
        let base = from_rpy_deg(
            self.table.position_m.as_ref().map_or(zero, |position| *position.get_ref()),
            self.table.rpy_deg.as_ref().map_or(zero, |rpy| *rpy.get_ref()),
        );
        let mut poses = vec![base];
        for (joint, coordinate) in self.robot.joints.iter().zip(self.coordinates) {
            poses.push(poses[joint.parent] * pose(&joint.origin) * motion(joint, *coordinate));
        }
        poses
    }

    /// What each link is: a frame where it has no mass and is fixed to another one.
    fn parts(&self) -> Result<Vec<Part>, Vec<RobotFault>> {
        let root = if self.table.fixed.unwrap_or(true) { Part::Rests } else { Part::Moves };
        let mut parts = vec![root];
        for joint in &self.robot.joints {
            let (fixed, massless) = (joint.freedom == Freedom::Fixed, self.robot.links[joint.child].inertial.is_none());
            let on = match parts[joint.parent] {
                Part::FrameOn(other) => other,
                Part::Rests | Part::Moves => joint.parent,
            };
            parts.push(match (fixed, massless, parts[on]) {
                (true, true, _) => Part::FrameOn(on),
                (true, false, Part::Rests) => Part::Rests,
                _ => Part::Moves,
            });
        }
        let weighed =
            |index: usize| self.robot.links[index].collisions.iter().any(|shape| self.weight(shape).is_some());
        let all = &parts;
        let on =
            |index: usize| (0..all.len()).filter(move |other| *other == index || all[*other] == Part::FrameOn(index));
        let massless = |(index, part): &(usize, &Part)| {
            let moves = **part == Part::Moves && !self.is_kinematic();
            let needs = moves && self.robot.links[*index].inertial.is_none();
            needs && self.density_kg_m3.is_none() && !on(*index).any(weighed)
        };
        let hint = "`density_kg_m3 = 2700` in the table of this robot gives each such link the mass of its shapes";
        let faults = parts.iter().enumerate().filter(massless).map(|(index, _)| {
            let link = &self.robot.links[index];
            let wrong = RobotFault { place: link.place.clone(), cause: String::new(), hint: Some(hint.to_owned()) };
            RobotFault { cause: format!("link `{}` moves and has no mass", link.name), ..wrong }
        });
        let faults: Vec<_> = faults.collect();
        if faults.is_empty() { Ok(parts) } else { Err(faults) }
    }

    /// What a shape weighs where its link has no mass: what the file says, or what the scene does.
    fn weight(&self, shape: &Collision) -> Option<Weight> {
        shape.weight.filter(|weight| weight.is_some()).or(self.density_kg_m3.map(Weight::Density))
    }

    fn weigh(&self, shape: &Collision, table: &mut ShapeTable) {
        match self.weight(shape) {
            Some(Weight::Mass(mass_kg)) => table.mass_kg = Some(self.at(mass_kg)),
            Some(Weight::Density(density_kg_m3)) => table.density_kg_m3 = Some(self.at(density_kg_m3)),
            None => {}
        }
    }

    /// The shapes of a link and what they are called. Where a mass is to be found and nothing collides,
    /// what a picture shows stands for them.
    fn shapes_of(&self, link: usize, body: Part) -> (&[Collision], &'static str) {
        let link = &self.robot.links[link];
        let wanted = body == Part::Moves && self.density_kg_m3.is_some() && link.inertial.is_none();
        if link.collisions.is_empty() && wanted { (&link.visuals, "visual") } else { (&link.collisions, "shape") }
    }

    fn body(&self, index: usize, part: Part, place: &Pose, remarks: &mut Vec<String>) -> BodyTable {
        let link = &self.robot.links[index];
        let moves = part == Part::Moves;
        let (position, rpy) = spot(place);
        let moves_freely = moves && !self.is_kinematic();
        let inertial = if moves_freely { self.inertial(index, remarks) } else { None };
        let centre = inertial.map(|inertial| (*place * pose(&inertial.origin)).translation.to_array());
        BodyTable {
            name: self.named(&link.name),
            kind: match (moves, self.is_kinematic()) {
                (false, _) => BodyKind::Fixed,
                (true, true) => BodyKind::Kinematic,
                (true, false) => BodyKind::Dynamic,
            },
            shape: None,
            size_m: None,
            radius_m: None,
            length_m: None,
            mesh: None,
            unit_m: None,
            hull: None,
            position_m: Some(self.at(position)),
            rpy_deg: Some(self.at(rpy)),
            velocity_m_s: None,
            mass_kg: inertial.map(|inertial| self.at(inertial.mass_kg)),
            density_kg_m3: None,
            centre_m: centre.map(|centre| self.at(centre)),
            inertia_kg_m2: inertial.map(|inertial| self.at(tensor(&inertial, place, self.density_kg_m3))),
            friction: None,
            friction_rule: None,
            restitution: None,
            collides: self.table.collides,
            // links that a joint joins overlap where they meet
            group: Some(self.at(format!("urdf {}", self.table.name.get_ref()))),
            turn_about_m: None,
            step_m: None,
            weighed_by_shapes: moves_freely && inertial.is_none(),
        }
    }

    /// Mass and inertia of a link that moves; none if its shapes give them.
    fn inertial(&self, index: usize, remarks: &mut Vec<String>) -> Option<Inertial> {
        let link = &self.robot.links[index];
        if let Some(inertial) = link.inertial {
            return Some(inertial);
        }
        let frames = || {
            let parts = self.parts().unwrap_or_default();
            (0..parts.len()).filter(move |other| parts[*other] == Part::FrameOn(index))
        };
        let has_shape = |link: usize| {
            let (shapes, mark) = self.shapes_of(link, Part::Moves);
            let counts = |shape: &Collision| !is_nothing(&shape.geometry) && self.weight(shape).is_some();
            shapes.iter().any(|shape| counts(shape) && (mark == "shape" || self.is_found(shape)))
        };
        if has_shape(index) || frames().any(has_shape) {
            return None;
        }
        let density_kg_m3 = self.density_kg_m3.unwrap_or(DENSITY_KG_M3);
        let mass_kg = density_kg_m3 * BALL * BALL_RADIUS_M.powi(3);
        remarks.push(format!("link `{}` moves and has no shape: it is a ball of {mass_kg:.3} kg", link.name));
        Some(Inertial { origin: Origin::default(), mass_kg, inertia_kg_m2: None })
    }

    fn is_found(&self, shape: &Collision) -> bool {
        match &shape.geometry {
            Geometry::Mesh(file, _) => (self.find)(file).is_ok(),
            Geometry::Box(_) | Geometry::Sphere(_) | Geometry::Cylinder(..) | Geometry::Capsule(..) => true,
        }
    }

    fn shape(
        &self,
        [name, body]: [Placed<String>; 2],
        shape: &Collision,
        place: &Pose,
        collides: bool,
    ) -> Result<ShapeTable, RobotFault> {
        let (position, rpy) = spot(place);
        let mut table = ShapeTable {
            name,
            body,
            shape: self.at(ShapeKind::Box),
            size_m: None,
            radius_m: None,
            length_m: None,
            mesh: None,
            unit_m: None,
            hull: None,
            position_m: Some(self.at(position)),
            rpy_deg: Some(self.at(rpy)),
            mass_kg: None,
            density_kg_m3: None,
            friction: self.table.friction.clone(),
            friction_rule: None,
            restitution: None,
            collides: if collides { self.table.collides } else { Some(false) },
            turn_about_m: None,
            step_m: None,
            stretch: None,
        };
        let round = |table: &mut ShapeTable, kind, radius_m: f64, length_m: f64| {
            table.shape = self.at(kind);
            (table.radius_m, table.length_m) = (Some(self.at(radius_m)), Some(self.at(length_m)));
        };
        match &shape.geometry {
            Geometry::Box(size_m) => table.size_m = Some(self.at(*size_m)),
            Geometry::Sphere(radius_m) => {
                table.shape = self.at(ShapeKind::Sphere);
                table.radius_m = Some(self.at(*radius_m));
            }
            Geometry::Cylinder(radius_m, length_m) => round(&mut table, ShapeKind::Cylinder, *radius_m, *length_m),
            Geometry::Capsule(radius_m, length_m) => round(&mut table, ShapeKind::Capsule, *radius_m, *length_m),
            Geometry::Mesh(file, stretch) => {
                let found = (self.find)(file).map_err(|cause| {
                    let cause = format!("names the mesh `{file}`, {cause}");
                    RobotFault { place: shape.place.clone(), cause, hint: None }
                })?;
                table.shape = self.at(ShapeKind::Mesh);
                (table.mesh, table.stretch) = (Some(self.at(found)), Some(*stretch));
            }
        }
        Ok(table)
    }

    /// A joint between two bodies; none where a link is a frame, floats, or rests as its parent does.
    fn joint(&self, index: usize, joint: &Joint, parts: &[Part], poses: &[Pose]) -> Option<JointTable> {
        let on = match parts[joint.parent] {
            Part::FrameOn(other) => other,
            Part::Rests | Part::Moves => joint.parent,
        };
        if parts[joint.child] != Part::Moves || joint.freedom == Freedom::Floats {
            return None;
        }
        let place = poses[joint.child];
        let moves = matches!(joint.freedom, Freedom::Turns | Freedom::Slides);
        let turns = joint.freedom == Freedom::Turns;
        // a follower's are its leader's
        let limits = joint.limits.filter(|_| joint.mimic.is_none());
        let bound =
            |which: usize, wanted: bool| limits.filter(|_| turns == wanted).map(|limits| self.at(limits[which]));
        let initial = |wanted: bool| (moves && turns == wanted).then(|| self.at(self.coordinates[index]));
        let follows = joint.mimic.as_ref().map(|mimic| FollowTable {
            joint: self.named(&mimic.joint),
            factor: mimic.factor,
            offset: mimic.offset,
        });
        Some(JointTable {
            name: self.named(&joint.name),
            kind: self.at(match joint.freedom {
                Freedom::Turns => JointKind::Revolute,
                Freedom::Slides => JointKind::Prismatic,
                Freedom::Rolls => JointKind::Ball,
                Freedom::Fixed | Freedom::Floats => JointKind::Fixed,
            }),
            parent: self.named(&self.robot.links[on].name),
            child: self.named(&self.robot.links[joint.child].name),
            anchor_m: Some(self.at((place * DVec3::from_array(joint.anchor_m)).to_array())),
            axis: moves.then(|| self.at((place.rotation * axis(joint)).to_array())),
            slide: None,
            initial_m: initial(false),
            initial_rad: initial(true),
            lower_m: bound(0, false),
            lower_rad: bound(0, true),
            upper_m: bound(1, false),
            upper_rad: bound(1, true),
            contacts: None,
            guided: self.is_kinematic(),
            follows,
        })
    }
}

/// Whether a shape has no size, or less than a body can have, as placeholders in robots' files.
fn is_nothing(geometry: &Geometry) -> bool {
    let none = |size_m: f64| (0.0..LENGTH_MIN_M).contains(&size_m);
    match geometry {
        Geometry::Box(size_m) => size_m.iter().any(|size_m| none(*size_m)),
        Geometry::Sphere(radius_m) | Geometry::Capsule(radius_m, _) => none(*radius_m),
        Geometry::Cylinder(radius_m, length_m) => none(*radius_m) || none(*length_m),
        Geometry::Mesh(_, stretch) => stretch.contains(&0.0),
    }
}

fn axis(joint: &Joint) -> DVec3 {
    let axis = DVec3::from_array(joint.axis);
    axis / axis.length()
}

/// What a joint's coordinate does to the child's frame, seen in that frame.
fn motion(joint: &Joint, coordinate: f64) -> Pose {
    let coordinate = coordinate - joint.reference;
    match joint.freedom {
        Freedom::Slides => Pose::from_parts(axis(joint) * coordinate, DQuat::IDENTITY),
        Freedom::Turns => {
            let (sin, cos) = libm::sincos(0.5 * coordinate);
            let about = axis(joint) * sin;
            let turned = DQuat::from_xyzw(about.x, about.y, about.z, cos);
            let anchor = DVec3::from_array(joint.anchor_m);
            Pose::from_parts(anchor - turned * anchor, turned)
        }
        Freedom::Fixed | Freedom::Rolls | Freedom::Floats => Pose::IDENTITY,
    }
}

fn pose(origin: &Origin) -> Pose {
    from_rpy_deg(origin.xyz_m, origin.rpy_rad.map(f64::to_degrees))
}

/// Position and angles of a pose, as a scene writes them.
fn spot(pose: &Pose) -> ([f64; 3], [f64; 3]) {
    (pose.translation.to_array(), to_rpy_deg(pose.rotation))
}

/// The tensor of inertia along the world's axes; where the file has none that a body can have, that of a
/// ball of the same mass.
fn tensor(inertial: &Inertial, link: &Pose, density_kg_m3: Option<f64>) -> [f64; 6] {
    let Some([xx, yy, zz, xy, xz, yz]) = inertial.inertia_kg_m2 else {
        let radius_m = libm::cbrt(inertial.mass_kg / (density_kg_m3.unwrap_or(DENSITY_KG_M3) * BALL));
        let moment = 0.4 * inertial.mass_kg * radius_m * radius_m;
        return [moment, moment, moment, 0.0, 0.0, 0.0];
    };
    turned_tensor([xx, yy, zz, xy, xz, yz], (*link * pose(&inertial.origin)).rotation)
}
