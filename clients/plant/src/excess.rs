//! What a scene asks for beyond what the plant can carry at its physics step.
//!
//! The plant stays stable with all of it, but what it then shows is not the machine: a spring whose swing takes fewer
//! than [`STEPS_A_SWING`] steps is seen at three places of it or fewer, a light body between heavy ones gets their
//! momenta by a few sweeps of the solver, and every corner of a hull is looked at in each contact.

use std::f64::consts::TAU;

use onescan_server::time::TimeSpan;
use rapier3d::prelude::{Collider, ContactPair, Group, RigidBody, RigidBodyHandle};
use serde::Serialize;

use crate::fitting::Fitting;
use crate::model::{JointKind, Mechanics, Moved};
use crate::scene::Scene;
use crate::world::World;

/// A swing takes this many physics steps at least, and a time constant a third of one.
pub const STEPS_A_SWING: f64 = 3.0;
/// Masses that touch or are joined are no further apart.
pub const MASS_RATIO_MAX: f64 = 1e4;
/// Points of a convex hull that collides: each contact looks at all of them.
pub const HULL_POINTS_MAX: usize = 1000;
/// Triangles of a surface that collides.
pub const TRIANGLES_MAX: usize = 100_000;

/// Something that a scene has too much of.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Excess {
    /// A spring swings too fast.
    Swing {
        /// The fitting that it belongs to.
        fitting: String,
        /// Its joint.
        joint: String,
        /// Its frequency, with all that the joint moves.
        hz: f64,
        /// A physics step that would do.
        step_s: f64,
    },
    /// A damper brakes too fast.
    TimeConstant {
        /// The fitting that it belongs to.
        fitting: String,
        /// Its joint.
        joint: String,
        /// In this time it takes two thirds of a velocity.
        time_s: f64,
        /// A physics step that would do.
        step_s: f64,
    },
    /// The mass of one body is far greater than that of another that touches it or is joined to it.
    MassRatio {
        /// The heavier one first.
        bodies: [String; 2],
        /// Of their masses.
        ratio: f64,
    },
    /// A convex hull has many points.
    Hull {
        /// The body or `[[shape]]` that has it.
        shape: String,
        /// How many.
        points: usize,
    },
    /// A surface has many triangles.
    Surface {
        /// The body or `[[shape]]` that has it.
        shape: String,
        /// How many.
        triangles: usize,
    },
}

impl std::fmt::Display for Excess {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Swing { fitting, joint, hz, step_s } => write!(
                f,
                "the spring of `{fitting}` on joint `{joint}` swings with {hz:.1} Hz, which takes a physics step of {}",
                Step(*step_s)
            ),
            Self::TimeConstant { fitting, joint, time_s, step_s } => write!(
                f,
                "the damping of `{fitting}` on joint `{joint}` has a time constant of {:.3} ms, which takes a physics \
                 step of {}",
                1e3 * time_s,
                Step(*step_s)
            ),
            Self::MassRatio { bodies: [heavy, light], ratio } => {
                write!(f, "`{heavy}` has {ratio:.0} times the mass of `{light}`, which touches it or is joined to it")
            }
            Self::Hull { shape, points } => write!(f, "the hull of `{shape}` has {points} points"),
            Self::Surface { shape, triangles } => write!(f, "the surface of `{shape}` has {triangles} triangles"),
        }
    }
}

/// A step for people.
struct Step(f64);

impl std::fmt::Display for Step {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let nanos = (1e9 * self.0).round().max(1.0) as u64;
        match TimeSpan::from_nanos(nanos) {
            Some(step) => write!(f, "{step}"),
            None => write!(f, "{} s", self.0),
        }
    }
}

impl Scene {
    /// What it asks for beyond what the plant can carry in turns of one `period`: springs and dampers in the order of
    /// its fittings, then masses, then shapes.
    pub fn excesses(&self, period: TimeSpan) -> Vec<Excess> {
        let mut world = World::at_the_start(self, period);
        let step_s = period.as_secs_f64() / f64::from(self.substeps);
        let mut found = fast_fittings(self, &mut world, step_s);
        found.extend(world.uneven_masses(self));
        found.extend(world.costly_shapes(self));
        found
    }
}

/// The fittings that are too fast for a step.
fn fast_fittings(scene: &Scene, world: &mut World, step_s: f64) -> Vec<Excess> {
    if scene.fittings.is_empty() {
        return Vec::new();
    }
    // what follows a path with all the force that it takes gives no way
    let held = |joint: usize| {
        let moves = |moved: &Moved| matches!(moved, Moved::Joint(driven) if *driven == joint);
        scene.axes.iter().any(|axis| axis.effort_max.is_none() && moves(&axis.moved))
    };
    let apparent = world.apparent(&held);
    let fast = scene.fittings.iter().filter_map(|fitted| {
        let (_, per_mass) = apparent.iter().find(|(joint, _)| *joint == fitted.joint)?;
        let fitting = Fitting::new(scene, fitted.joint);
        let names = || (fitted.name.clone(), scene.joints[fitted.joint].name.clone());
        match Mode::of(fitting.spring * per_mass, fitting.damping * per_mass)? {
            Mode::Swings { rad_s } => {
                let hz = rad_s / TAU;
                let ((fitting, joint), enough_s) = (names(), round(1.0 / (STEPS_A_SWING * hz)));
                (hz * step_s * STEPS_A_SWING > 1.0).then_some(Excess::Swing { fitting, joint, hz, step_s: enough_s })
            }
            Mode::Fades { time_s } => {
                let ((fitting, joint), enough_s) = (names(), round(STEPS_A_SWING * time_s));
                (STEPS_A_SWING * time_s < step_s).then_some(Excess::TimeConstant {
                    fitting,
                    joint,
                    time_s,
                    step_s: enough_s,
                })
            }
        }
    });
    fast.collect()
}

/// What a spring and a damper make of a mass.
enum Mode {
    Swings { rad_s: f64 },
    Fades { time_s: f64 },
}

impl Mode {
    /// Of `x'' = -stiffness x - damping x'`, the faster one of two that fade.
    fn of(stiffness: f64, damping: f64) -> Option<Self> {
        let half = 0.5 * damping;
        let within = half * half - stiffness;
        if within < 0.0 {
            return Some(Self::Swings { rad_s: (-within).sqrt() });
        }
        let rate = half + within.sqrt();
        (rate > 0.0).then(|| Self::Fades { time_s: 1.0 / rate })
    }
}

/// The greatest of 1, 2 and 5 times a power of ten that is not above a time.
fn round(time_s: f64) -> f64 {
    let decade = libm::pow(10.0, libm::floor(libm::log10(time_s)));
    let within = |factor: &f64| factor * decade <= time_s * (1.0 + 1e-12);
    [5.0, 2.0].into_iter().find(within).unwrap_or(1.0) * decade
}

impl World {
    /// The joints of the scene that have a coordinate, with the inverse of what each moves; those that no mechanism has
    /// as if their bodies hung on nothing else.
    fn apparent(&mut self, held: &dyn Fn(usize) -> bool) -> Vec<(usize, f64)> {
        let gravity = self.gravity();
        let mut found = self.articulation.apparent(gravity, held);
        for (joint, kind, [one, other], frame) in self.articulation.unmoved(&self.physics.bodies) {
            let along = frame.rotation * rapier3d::math::Vector::X;
            let gives = |handle: RigidBodyHandle| {
                let body = self.body(handle);
                match kind {
                    _ if !body.is_dynamic() => 0.0,
                    JointKind::Prismatic => 1.0 / body.mass(),
                    JointKind::Revolute => 1.0 / inertia_about(body, frame.translation, along),
                    JointKind::Slot | JointKind::Fixed | JointKind::Ball => 0.0,
                }
            };
            found.push((joint, gives(one) + gives(other)));
        }
        found
    }

    /// Pairs of bodies that touch at the start, or are joined and collide with others, of masses too far apart.
    fn uneven_masses(&mut self, scene: &Mechanics) -> Vec<Excess> {
        self.physics.detect_collisions(&(), &());
        let touching = self.physics.narrow_phase.contact_pairs();
        let touching =
            touching.filter(|pair| self.may_touch(pair) && pair.manifolds().iter().any(|m| !m.points.is_empty()));
        let bodies = |pair: &ContactPair| Some([self.body_of(pair.collider1)?, self.body_of(pair.collider2)?]);
        let mut pairs: Vec<_> = touching.filter_map(bodies).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        let joined = scene.joints.iter().filter(|joint| !joint.guided && joint.kind != JointKind::Fixed);
        pairs.extend(
            joined.filter_map(|joint| joint.parent.map(|parent| [parent.min(joint.child), parent.max(joint.child)])),
        );
        pairs.sort_unstable();
        pairs.dedup();
        let mass = |index: usize| {
            let body = self.body(self.handle(Some(index)));
            (body.is_dynamic() && body.mass() > 0.0).then(|| body.mass())
        };
        let uneven = pairs.into_iter().filter_map(|[one, other]| {
            let (a, b) = (mass(one)?, mass(other)?);
            let (heavy, light, ratio) = if a >= b { (one, other, a / b) } else { (other, one, b / a) };
            let name = |index: usize| scene.bodies[index].name.clone();
            (ratio > MASS_RATIO_MAX).then(|| Excess::MassRatio { bodies: [name(heavy), name(light)], ratio })
        });
        uneven.collect()
    }

    /// Shapes that collide and have many points or triangles.
    fn costly_shapes(&self, scene: &Mechanics) -> Vec<Excess> {
        let own =
            scene.bodies.iter().enumerate().filter(|(_, body)| body.shape.is_some()).filter_map(|(index, body)| {
                let handle = *self.body(self.handle(Some(index))).colliders().first()?;
                Some((body.name.clone(), handle))
            });
        let more = scene.shapes.iter().enumerate().map(|(index, shape)| (shape.name.clone(), self.shape(index)));
        let costly = own.chain(more).filter_map(|(shape, handle)| {
            let collides = |collider: &&Collider| collider.collision_groups().memberships != Group::NONE;
            let collider = self.physics.colliders.get(handle).filter(collides)?;
            if let Some(hull) = collider.shape().as_convex_polyhedron() {
                let points = hull.points().len();
                return (points > HULL_POINTS_MAX).then_some(Excess::Hull { shape, points });
            }
            let triangles = collider.shape().as_trimesh()?.indices().len();
            (triangles > TRIANGLES_MAX).then_some(Excess::Surface { shape, triangles })
        });
        costly.collect()
    }
}

/// The inertia of a body about an axis through a point.
fn inertia_about(body: &RigidBody, point: rapier3d::math::Vector, axis: rapier3d::math::Vector) -> f64 {
    let own = body.mass_properties();
    let turned = (body.rotation().inverse()) * axis;
    let tensor = own.local_mprops.reconstruct_inertia_matrix();
    let lever = (own.world_com - point).cross(axis);
    turned.dot(tensor * turned) + body.mass() * lever.length_squared()
}
