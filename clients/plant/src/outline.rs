//! The forms of a scene's bodies as plane faces in the world, for pictures.

use rapier3d::glamx::DVec3;
use rapier3d::math::Pose;

use super::model::{BodyKind, Mechanics, Shape};
use super::pose::from_rpy_deg;

/// Corners of a circle.
const SEGMENTS: usize = 32;
/// A mesh of more triangles is drawn by its convex hull.
const TRIANGLES_MAX: usize = 2000;

/// A form of a body, in the scene's pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline<'s> {
    pub body: &'s str,
    /// The shape that is attached to the body; nothing for the body's own.
    pub attached: Option<&'s str>,
    pub kind: BodyKind,
    pub surface: Surface,
}

/// A surface, in world coordinates, m.
#[derive(Clone, Debug, PartialEq)]
pub enum Surface {
    /// Plane faces, each with its corners in order, counter-clockwise from outside.
    Faces {
        faces: Vec<Vec<[f64; 3]>>,
        /// Whether the borders between them are edges of the form. Those of a round form are not.
        edged: bool,
    },
    /// A convex form: the smallest that has these points.
    Convex(Vec<[f64; 3]>),
}

impl Mechanics {
    /// The forms of all bodies and of what is attached to them, in the scene's order.
    pub fn outlines(&self) -> impl Iterator<Item = Outline<'_>> {
        let own = self
            .bodies
            .iter()
            .filter_map(|body| Some((body, None, body.shape.as_ref()?, from_rpy_deg(body.position_m, body.rpy_deg))));
        let attached = self.shapes.iter().filter_map(|shape| {
            let body = self.bodies.get(shape.body)?;
            Some((body, Some(&*shape.name), &shape.shape, from_rpy_deg(shape.position_m, shape.rpy_deg)))
        });
        own.chain(attached).flat_map(|(body, attached, shape, pose)| {
            let outline = move |surface| Outline { body: &body.name, attached, kind: body.kind, surface };
            surfaces(shape, pose).into_iter().map(outline)
        })
    }
}

/// The surfaces of a form: one, or for round ones with flat ends those apart.
fn surfaces(shape: &Shape, pose: Pose) -> Vec<Surface> {
    match shape {
        Shape::Box { size_m } => vec![Surface::Faces { faces: cuboid(*size_m, pose), edged: true }],
        Shape::Sphere { radius_m } => vec![Surface::Convex(globe(*radius_m, 0.0, pose))],
        Shape::Capsule { radius_m, length_m } => vec![Surface::Convex(globe(*radius_m, length_m / 2.0, pose))],
        Shape::Cylinder { radius_m, length_m } => {
            let ring = |z: f64| circle(*radius_m, z, pose);
            let (low, high) = (ring(-length_m / 2.0), ring(length_m / 2.0));
            let beside = |index: usize| {
                let next = (index + 1) % SEGMENTS;
                vec![low[index], low[next], high[next], high[index]]
            };
            let mantle = (0..SEGMENTS).map(beside).collect();
            let ends = vec![low.iter().rev().copied().collect(), high.clone()];
            vec![Surface::Faces { faces: mantle, edged: false }, Surface::Faces { faces: ends, edged: true }]
        }
        Shape::Hull { corners_m, .. } => vec![Surface::Convex(corners_m.iter().map(|at| placed(pose, *at)).collect())],
        Shape::Surface { corners_m, triangles, .. } if triangles.len() <= TRIANGLES_MAX => {
            let corner = |index: &u32| corners_m.get(*index as usize).map(|at| placed(pose, *at));
            let faces = triangles.iter().filter_map(|of| of.iter().map(corner).collect::<Option<Vec<_>>>()).collect();
            vec![Surface::Faces { faces, edged: false }]
        }
        Shape::Surface { corners_m, .. } => {
            vec![Surface::Convex(corners_m.iter().map(|at| placed(pose, *at)).collect())]
        }
    }
}

fn placed(pose: Pose, [x, y, z]: [f64; 3]) -> [f64; 3] {
    (pose * DVec3::new(x, y, z)).to_array()
}

fn cuboid(size_m: [f64; 3], pose: Pose) -> Vec<Vec<[f64; 3]>> {
    let [x, y, z] = size_m.map(|length| length / 2.0);
    let faces = [
        [[-x, -y, -z], [-x, y, -z], [x, y, -z], [x, -y, -z]],
        [[-x, -y, z], [x, -y, z], [x, y, z], [-x, y, z]],
        [[-x, -y, -z], [x, -y, -z], [x, -y, z], [-x, -y, z]],
        [[-x, y, -z], [-x, y, z], [x, y, z], [x, y, -z]],
        [[-x, -y, -z], [-x, -y, z], [-x, y, z], [-x, y, -z]],
        [[x, -y, -z], [x, y, -z], [x, y, z], [x, -y, z]],
    ];
    faces.map(|face| face.map(|corner| placed(pose, corner)).to_vec()).to_vec()
}

fn circle(radius_m: f64, z: f64, pose: Pose) -> Vec<[f64; 3]> {
    let corner = |index: usize| {
        let (sine, cosine) = libm::sincos(std::f64::consts::TAU * index as f64 / SEGMENTS as f64);
        placed(pose, [radius_m * cosine, radius_m * sine, z])
    };
    (0..SEGMENTS).map(corner).collect()
}

/// Points of a ball whose halves are `half_m` above and below its centre.
fn globe(radius_m: f64, half_m: f64, pose: Pose) -> Vec<[f64; 3]> {
    let quarter = SEGMENTS / 4;
    let rings = (0..=quarter).flat_map(|ring| {
        let (sine, cosine) = libm::sincos(std::f64::consts::FRAC_PI_2 * ring as f64 / quarter as f64);
        [1.0, -1.0].map(|side: f64| circle(radius_m * cosine, side * (half_m + radius_m * sine), pose))
    });
    rings.flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn normal(face: &[[f64; 3]]) -> DVec3 {
        let [a, b, c] = [face[0], face[1], face[2]].map(DVec3::from_array);
        (b - a).cross(c - b)
    }

    #[test]
    fn faces_look_outwards() {
        let pose = from_rpy_deg([1.0, 2.0, 3.0], [30.0, 40.0, 50.0]);
        let centre = DVec3::new(1.0, 2.0, 3.0);
        for shape in [Shape::Box { size_m: [1.0, 2.0, 3.0] }, Shape::Cylinder { radius_m: 0.5, length_m: 2.0 }] {
            for surface in surfaces(&shape, pose) {
                let Surface::Faces { faces, .. } = surface else { panic!("{shape:?} has faces") };
                for face in faces {
                    assert!(normal(&face).dot(DVec3::from_array(face[0]) - centre) > 0.0, "{face:?}");
                }
            }
        }
    }

    #[test]
    fn a_ball_is_as_wide_as_its_radius_says() {
        let points = globe(2.0, 1.0, Pose::identity());
        let widest = points.iter().map(|[x, y, _]| (x * x + y * y).sqrt()).fold(0.0, f64::max);
        let highest = points.iter().map(|[.., z]| *z).fold(0.0, f64::max);
        assert!((widest - 2.0).abs() < 1e-12 && (highest - 3.0).abs() < 1e-12);
    }
}
