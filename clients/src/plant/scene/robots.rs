//! `[[urdf]]`: a robot from a URDF file, as bodies, shapes and joints of the scene.
//!
//! A link `upper` of a robot that the scene calls `arm` is the body `arm.upper`, its collision shapes are
//! `arm.upper.shape[0]` and so on, a joint `elbow` is `arm.elbow`; its coordinate is 0 in the scene's
//! pose. A link without mass is a mere frame: what it has belongs to the link that it is fixed to. The root is fixed to the
//! world unless the scene says otherwise.

use std::f64::consts::TAU;
use std::ops::Range;
use std::path::Path;

use super::placed::Placed;
use rapier3d::glamx::{DMat3, DQuat, DVec3};
use rapier3d::math::Pose;

use super::error::SceneFaultKind;
use super::faults::Faults;
use super::format::{BodyKind, BodyTable, JointKind, JointTable, SceneFile, ShapeKind, ShapeTable, UrdfTable};
use crate::plant::pose::{from_rpy_deg, to_rpy_deg};
use crate::plant::urdf::{Freedom, Geometry, Inertial, Joint, Origin, Robot};

/// Adds what the robots of a file are made of, behind its own bodies, shapes and joints.
pub(super) fn expand(written: &mut SceneFile, faults: &mut Faults<'_>) {
    for table in std::mem::take(&mut written.urdf) {
        let table = table.get_ref();
        let file = table.file.get_ref();
        let text = std::fs::read_to_string(faults.beside(file)).map_err(|error| format!("cannot be read: {error}"));
        let robot = text.and_then(|text| Robot::parse(&text).map_err(|error| error.to_string()));
        let placed = robot.and_then(|robot| {
            let placing = Placing { table, place: table.file.span(), folder: folder_of(faults, file) };
            placing.add(&robot, written)
        });
        if let Err(cause) = placed {
            faults.add(table.file.span(), SceneFaultKind::Urdf { file: file.clone(), cause });
        }
    }
}

/// The folder of the robot's file, and how the scene finds it.
fn folder_of(faults: &Faults<'_>, file: &str) -> (std::path::PathBuf, String) {
    let beside = Path::new(file).parent().map(|folder| folder.display().to_string()).unwrap_or_default();
    (faults.beside(&beside), beside)
}

/// One robot on its way into the scene.
struct Placing<'t> {
    table: &'t UrdfTable,
    place: Range<usize>,
    folder: (std::path::PathBuf, String),
}

impl Placing<'_> {
    fn at<T>(&self, value: T) -> Placed<T> {
        Placed::new(self.place.clone(), value)
    }

    fn named(&self, name: &str) -> Placed<String> {
        self.at(format!("{}.{name}", self.table.name.get_ref()))
    }

    fn add(&self, robot: &Robot, written: &mut SceneFile) -> Result<(), String> {
        let zero = [0.0; 3];
        let base = from_rpy_deg(
            self.table.position_m.as_ref().map_or(zero, |position| *position.get_ref()),
            self.table.rpy_deg.as_ref().map_or(zero, |rpy| *rpy.get_ref()),
        );
        let mut poses = vec![base];
        let mut bodies = vec![0];
        for joint in &robot.joints {
            poses.push(poses[joint.parent] * pose(&joint.origin));
            let frame = robot.links[joint.child].inertial.is_none();
            if frame && joint.freedom != Freedom::Fixed {
                let name = &robot.links[joint.child].name;
                return Err(format!("link `{name}` moves and has no <inertial>"));
            }
            bodies.push(if frame { bodies[joint.parent] } else { joint.child });
        }
        for (index, link) in robot.links.iter().enumerate() {
            if bodies[index] == index {
                written.body.push(self.at(self.body(index, robot, &poses)?));
            }
            for (k, shape) in link.collisions.iter().enumerate() {
                let place = poses[index] * pose(&shape.origin);
                let name = self.named(&format!("{}.shape[{k}]", link.name));
                let body = self.named(&robot.links[bodies[index]].name);
                written.shape.push(self.at(self.shape(name, body, &shape.geometry, &place)?));
            }
        }
        let kept = robot.joints.iter().filter(|joint| bodies[joint.child] == joint.child);
        for joint in kept.filter(|joint| joint.freedom != Freedom::Floats) {
            let parent = self.named(&robot.links[bodies[joint.parent]].name);
            let child = self.named(&robot.links[joint.child].name);
            written.joint.push(self.at(self.joint(joint, [parent, child], &poses[joint.child])));
        }
        Ok(())
    }

    fn body(&self, index: usize, robot: &Robot, poses: &[Pose]) -> Result<BodyTable, String> {
        let link = &robot.links[index];
        let fixed = index == 0 && self.table.fixed.unwrap_or(true);
        let inertial = link.inertial.filter(|_| !fixed);
        if inertial.is_none() && !fixed {
            return Err(format!("link `{}` is not fixed and has no <inertial>", link.name));
        }
        let (position, rpy) = spot(&poses[index]);
        let centre = inertial.map(|inertial| (poses[index] * pose(&inertial.origin)).translation.to_array());
        Ok(BodyTable {
            name: self.named(&link.name),
            kind: if fixed { BodyKind::Fixed } else { BodyKind::Dynamic },
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
            inertia_kg_m2: inertial.map(|inertial| self.at(tensor(&inertial, &poses[index]))),
            friction: None,
            restitution: None,
            collides: self.table.collides,
            // links that a joint joins overlap where they meet
            group: Some(self.at(format!("urdf {}", self.table.name.get_ref()))),
            turn_about_m: None,
            step_m: None,
        })
    }

    fn shape(
        &self,
        name: Placed<String>,
        body: Placed<String>,
        geometry: &Geometry,
        place: &Pose,
    ) -> Result<ShapeTable, String> {
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
            friction: self.table.friction.clone(),
            restitution: None,
            collides: self.table.collides,
            turn_about_m: None,
            step_m: None,
        };
        match geometry {
            Geometry::Box(size_m) => table.size_m = Some(self.at(*size_m)),
            Geometry::Sphere(radius_m) => {
                table.shape = self.at(ShapeKind::Sphere);
                table.radius_m = Some(self.at(*radius_m));
            }
            Geometry::Cylinder(radius_m, length_m) => {
                table.shape = self.at(ShapeKind::Cylinder);
                (table.radius_m, table.length_m) = (Some(self.at(*radius_m)), Some(self.at(*length_m)));
            }
            Geometry::Mesh(file, unit_m) => {
                table.shape = self.at(ShapeKind::Mesh);
                (table.mesh, table.unit_m) = (Some(self.at(self.found(file)?)), Some(self.at(*unit_m)));
            }
        }
        Ok(table)
    }

    /// A mesh's file as the scene finds it: beside the robot's, or in a package around it.
    fn found(&self, file: &str) -> Result<String, String> {
        let (folder, beside) = &self.folder;
        let Some(packaged) = file.strip_prefix("package://") else {
            return Ok(Path::new(beside).join(file.strip_prefix("file://").unwrap_or(file)).display().to_string());
        };
        let inside = packaged.split_once('/').map_or(packaged, |(_, inside)| inside);
        let mut up = Path::new(beside).to_path_buf();
        let mut around = folder.clone();
        for _ in 0..8 {
            if around.join(inside).is_file() {
                return Ok(up.join(inside).display().to_string());
            }
            up.push("..");
            around.push("..");
        }
        Err(format!("names the mesh `{file}`, of which no folder around it has `{inside}`"))
    }

    fn joint(&self, joint: &Joint, [parent, child]: [Placed<String>; 2], place: &Pose) -> JointTable {
        let axis = place.rotation * DVec3::from_array(joint.axis);
        let turns = joint.freedom == Freedom::Turns;
        // bodies cannot keep limits that are a turn or more apart
        let limits = joint.limits.filter(|[lower, upper]| !turns || upper - lower < TAU);
        let bound =
            |which: usize, wanted: bool| limits.filter(|_| turns == wanted).map(|limits| self.at(limits[which]));
        JointTable {
            name: self.named(&joint.name),
            kind: self.at(match joint.freedom {
                Freedom::Turns => JointKind::Revolute,
                Freedom::Slides => JointKind::Prismatic,
                Freedom::Fixed | Freedom::Floats => JointKind::Fixed,
            }),
            parent,
            child,
            anchor_m: Some(self.at(place.translation.to_array())),
            axis: (joint.freedom != Freedom::Fixed).then(|| self.at(axis.to_array())),
            slide: None,
            initial_m: None,
            initial_rad: None,
            lower_m: bound(0, false),
            lower_rad: bound(0, true),
            upper_m: bound(1, false),
            upper_rad: bound(1, true),
            contacts: None,
        }
    }
}

fn pose(origin: &Origin) -> Pose {
    from_rpy_deg(origin.xyz_m, origin.rpy_rad.map(f64::to_degrees))
}

/// Position and angles of a pose, as a scene writes them.
fn spot(pose: &Pose) -> ([f64; 3], [f64; 3]) {
    (pose.translation.to_array(), to_rpy_deg(pose.rotation))
}

/// The tensor of inertia along the world's axes.
fn tensor(inertial: &Inertial, link: &Pose) -> [f64; 6] {
    let turned: DQuat = (*link * pose(&inertial.origin)).rotation;
    let [xx, yy, zz, xy, xz, yz] = inertial.inertia_kg_m2;
    let own = DMat3::from_cols(DVec3::new(xx, xy, xz), DVec3::new(xy, yy, yz), DVec3::new(xz, yz, zz));
    let rotation = DMat3::from_quat(turned);
    let world = rotation * own * rotation.transpose();
    let [x, y, z] = [world.x_axis, world.y_axis, world.z_axis];
    [x.x, y.y, z.z, x.y, x.z, y.z]
}
