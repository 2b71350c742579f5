//! The forms of a scene's bodies as they are, each in the frame of its body, for readers that draw by themselves.

use rapier3d::glamx::DVec3;
use rapier3d::math::Pose;
use rapier3d::parry::transformation::try_convex_hull;

use super::model::{BodyKind, Mechanics, Shape};
use super::pose::from_rpy_deg;

/// A form of a body. A body without one carries joints and sensors only.
#[derive(Clone, Debug, PartialEq)]
pub struct Form<'s> {
    pub body: &'s str,
    /// Its place in the scene.
    pub index: usize,
    /// The name of the shape, if it is not the body's own but attached to it.
    pub attached: Option<&'s str>,
    /// How the body moves.
    pub kind: BodyKind,
    /// Where the form is in the frame of its body.
    pub within: Frame,
    pub geometry: Geometry,
}

/// A position, m, and an orientation, a unit quaternion with the scalar last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    pub position_m: [f64; 3],
    /// x, y, z, w of a quaternion of length 1.
    pub rotation_xyzw: [f64; 4],
}

impl Frame {
    fn of(pose: Pose) -> Self {
        Self { position_m: pose.translation.to_array(), rotation_xyzw: pose.rotation.to_array() }
    }

    /// At a position, m, rolled about x, then pitched about y, then yawed about z.
    #[must_use]
    pub fn at(position_m: [f64; 3], rpy_deg: [f64; 3]) -> Self {
        Self::of(from_rpy_deg(position_m, rpy_deg))
    }

    fn pose(self) -> Pose {
        Pose::from_parts(self.position_m.into(), rapier3d::glamx::DQuat::from_array(self.rotation_xyzw))
    }

    /// This frame, seen from the one in which `outer` is.
    #[must_use]
    pub fn seen_from(self, outer: Self) -> Self {
        Self::of(outer.pose() * self.pose())
    }
}

/// A form about its own origin.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    Nothing,
    /// Edges along the axes.
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
    Capsule {
        /// Radius of the caps and between them.
        radius_m: f64,
        /// Its length without the caps.
        length_m: f64,
    },
    /// Triangles, counter-clockwise from outside.
    Mesh {
        corners_m: Vec<[f64; 3]>,
        /// Indices of three corners each.
        triangles: Vec<[u32; 3]>,
    },
}

impl Geometry {
    fn of(shape: &Shape) -> Self {
        match shape {
            Shape::Box { size_m } => Self::Box { size_m: *size_m },
            Shape::Sphere { radius_m } => Self::Sphere { radius_m: *radius_m },
            Shape::Cylinder { radius_m, length_m } => Self::Cylinder { radius_m: *radius_m, length_m: *length_m },
            Shape::Capsule { radius_m, length_m } => Self::Capsule { radius_m: *radius_m, length_m: *length_m },
            Shape::Hull { corners_m, .. } => Self::hull(corners_m),
            Shape::Surface { corners_m, triangles, .. } => {
                Self::Mesh { corners_m: corners_m.clone(), triangles: triangles.clone() }
            }
        }
    }

    /// The convex hull; nothing of points that lie in a plane, which have none.
    fn hull(corners_m: &[[f64; 3]]) -> Self {
        let points: Vec<DVec3> = corners_m.iter().copied().map(DVec3::from_array).collect();
        match try_convex_hull(&points) {
            Ok((corners, triangles)) => {
                Self::Mesh { corners_m: corners.into_iter().map(|corner| corner.to_array()).collect(), triangles }
            }
            Err(_) => Self::Nothing,
        }
    }
}

impl Mechanics {
    /// Where the bodies are in the scene's pose, in the scene's order.
    pub fn frames(&self) -> impl Iterator<Item = Frame> + '_ {
        self.bodies.iter().map(|body| Frame::of(from_rpy_deg(body.position_m, body.rpy_deg)))
    }

    /// The forms of all bodies, in the scene's order, one of each body; then those that are attached to them.
    pub fn forms(&self) -> impl Iterator<Item = Form<'_>> {
        let own = self.bodies.iter().enumerate().map(|(index, body)| Form {
            body: &body.name,
            index,
            attached: None,
            kind: body.kind,
            within: Frame::of(Pose::IDENTITY),
            geometry: body.shape.as_ref().map_or(Geometry::Nothing, Geometry::of),
        });
        let attached = self.shapes.iter().filter_map(|shape| {
            let body = self.bodies.get(shape.body)?;
            let outer = from_rpy_deg(body.position_m, body.rpy_deg);
            let within = outer.inverse() * from_rpy_deg(shape.position_m, shape.rpy_deg);
            Some(Form {
                body: &body.name,
                index: shape.body,
                attached: Some(&shape.name),
                kind: body.kind,
                within: Frame::of(within),
                geometry: Geometry::of(&shape.shape),
            })
        });
        own.chain(attached)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    const SCENE: &str = r#"
version = 1
[[body]]
name = "arm"
kind = "kinematic"
shape = "box"
size_m = [1.0, 0.2, 0.2]
position_m = [1.0, 2.0, 3.0]
rpy_deg = [0.0, 0.0, 90.0]
[[shape]]
name = "hand"
body = "arm"
shape = "sphere"
radius_m = 0.1
position_m = [1.0, 2.5, 3.0]
"#;

    #[test]
    fn what_is_attached_is_in_the_frame_of_its_body() {
        let scene = Scene::parse(SCENE, "plant.toml").expect("a scene");
        let forms: Vec<Form<'_>> = scene.forms().collect();
        assert_eq!(forms.len(), 2);
        assert_eq!(forms[0].geometry, Geometry::Box { size_m: [1.0, 0.2, 0.2] });
        // half a metre along the world's y is half a metre along the arm's x
        let hand = &forms[1];
        assert_eq!((hand.body, hand.attached, hand.index), ("arm", Some("hand"), 0));
        let [x, y, z] = hand.within.position_m;
        assert!((x - 0.5).abs() < 1e-12 && y.abs() < 1e-12 && z.abs() < 1e-12, "{hand:?}");
        let back = hand.within.seen_from(scene.frames().next().expect("one")).position_m;
        assert!((back[1] - 2.5).abs() < 1e-12 && (back[0] - 1.0).abs() < 1e-12, "{back:?}");
    }

    #[test]
    fn a_hull_has_triangles_and_a_plane_has_none() {
        let cube: Vec<[f64; 3]> =
            (0..8u8).map(|k| [f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)]).collect();
        assert!(matches!(Geometry::hull(&cube), Geometry::Mesh { triangles, .. } if triangles.len() == 12));
        assert_eq!(Geometry::hull(&cube[..2]), Geometry::Nothing);
    }
}
