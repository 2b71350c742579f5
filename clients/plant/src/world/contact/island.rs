//! What touches each other, from a mechanism on.

use nalgebra::{Matrix3, Vector3};
use rapier3d::prelude::*;

use super::before::{Before, Motion, inverse_inertia};
use super::problem::{Friction, Problem, Row};
use crate::world::mechanism::{Mechanism, Surroundings};

/// Surfaces that touch overlap by so much, m, so that what asks for touch finds it whatever the rounding.
const SUNK_M: f64 = 1e-8;
/// Surfaces within this distance touch, m.
const NEAR_M: f64 = 1e-6;
/// The part of an overlap that is made up for in a step, and the fastest that it is, m/s.
const MADE_UP: f64 = 0.2;
const MADE_UP_M_S: f64 = 0.1;
/// More points of contact than this are left to the engine: the search takes the cube of their number.
const MOST_POINTS: usize = 64;

/// A mechanism for the search of what it touches.
pub(in crate::world) trait Part {
    /// Its shapes that collide.
    fn colliders(&self) -> &[ColliderHandle];
    fn mechanism(&mut self) -> &mut Mechanism;
    fn seen(&self) -> &Mechanism;
}

/// Mechanisms and bodies that touch each other.
#[derive(Debug)]
pub(in crate::world) struct Island {
    /// Mechanisms by their index.
    pub(in crate::world) members: Vec<usize>,
    bodies: Vec<RigidBodyHandle>,
    /// Pairs in contact, in a fixed order.
    pairs: Vec<(ColliderHandle, ColliderHandle)>,
}

/// Who moves a side of a contact.
#[derive(Clone, Copy, Debug)]
enum Mover {
    /// The mechanism of this place in the island, by a body of it.
    Member(usize, RigidBodyHandle),
    /// The body of this place in the island.
    Body(usize),
    /// What no force moves, and how fast it moves there.
    Given(Vector),
}

/// A body that moves freely, as the step began.
struct Free {
    handle: RigidBodyHandle,
    before: Motion,
    centre: Vector,
    inverse_mass: f64,
    inverse_inertia: Matrix3<f64>,
}

/// A point at which two sides touch.
struct Point {
    sides: [Mover; 2],
    place: Vector,
    normal: Vector,
    apart: f64,
    friction: f64,
    restitution: f64,
    /// The velocity along the surface that friction seeks.
    along: Vector,
}

impl Point {
    /// How fast sides that no force moves go away from each other in a direction.
    fn given(&self, direction: Vector) -> f64 {
        let each = self.sides.into_iter().zip([-1.0, 1.0]);
        let speed =
            |(mover, sign)| if let Mover::Given(velocity) = mover { velocity.dot(direction) * sign } else { 0.0 };
        each.map(speed).sum()
    }
}

impl Island {
    /// What touches each other from a mechanism on; none if the engine has to move some of it: a joint of its own is
    /// in it, or it is too large.
    pub(in crate::world) fn around<P: Part>(first: usize, parts: &[P], physics: &PhysicsWorld) -> Option<Self> {
        let owner = |collider: ColliderHandle| parts.iter().position(|part| part.colliders().contains(&collider));
        let mut island = Self { members: vec![first], bodies: Vec::new(), pairs: Vec::new() };
        let mut open: Vec<ColliderHandle> = parts[first].colliders().to_vec();
        let mut points = 0;
        while let Some(collider) = open.pop() {
            for pair in physics.narrow_phase.contact_pairs_with(collider) {
                let key = (pair.collider1, pair.collider2);
                if !pair.has_any_active_contact() || island.pairs.contains(&key) {
                    continue;
                }
                island.pairs.push(key);
                points += pair.solver_manifolds().iter().map(|m| m.data.solver_contacts.len()).sum::<usize>();
                if points > MOST_POINTS {
                    return None;
                }
                let other = if pair.collider1 == collider { pair.collider2 } else { pair.collider1 };
                let Some(handle) = physics.colliders.get(other).and_then(Collider::parent) else { continue };
                let Some(body) = physics.bodies.get(handle).filter(|body| body.is_dynamic()) else { continue };
                if let Some(member) = owner(other) {
                    if !island.members.contains(&member) {
                        island.members.push(member);
                        open.extend(parts[member].colliders());
                    }
                } else if !island.bodies.contains(&handle) {
                    let mut joints = physics.impulse_joints.attached_joints(handle);
                    if joints.any(|(_, _, _, joint)| joint.data.is_enabled()) {
                        return None;
                    }
                    island.bodies.push(handle);
                    open.extend(body.colliders());
                }
            }
        }
        let raw = |collider: ColliderHandle| collider.into_raw_parts();
        island.members.sort_unstable();
        island.bodies.sort_unstable_by_key(|body| body.into_raw_parts());
        island.pairs.sort_unstable_by_key(|(one, other)| (raw(*one), raw(*other)));
        Some(island)
    }

    /// Solves for the step of `dt_s` that begins with all bodies as they were `before`, and moves all there; the
    /// mechanisms on which something pressed. None, and nothing moved, if the engine's step has to stand.
    pub(in crate::world) fn step<P: Part>(
        &self,
        dt_s: f64,
        parts: &mut [P],
        physics: &mut PhysicsWorld,
        before: &Before,
        around: &mut Surroundings<'_>,
    ) -> Option<Vec<usize>> {
        for member in &self.members {
            if !parts[*member].mechanism().aim(dt_s, around) {
                return None;
            }
        }
        let mut built = Built::new(self, parts, physics, before, dt_s);
        built.tie(self, parts);
        let points = self.points(parts, physics, before);
        built.touch(&points, self, parts, dt_s);
        let corrections = built.problem.solve()?;
        let pressed: Vec<usize> = (0..self.members.len()).filter(|place| built.is_pressed(*place)).collect();
        if pressed.is_empty() {
            // the bodies are not in touch with a mechanism: they go on as the engine moves them
            return Some(pressed);
        }
        let corrections = corrections.as_slice();
        built.go(corrections, physics, dt_s);
        for place in &pressed {
            let (from, to) = built.spans[*place];
            let velocities = [&built.problem.velocities[from..to], &corrections[from..to]];
            let impulses = built.problem.rows[built.ties[*place].clone()].iter().map(|row| row.impulse);
            parts[self.members[*place]].mechanism().arrive(dt_s, velocities, impulses, around);
        }
        Some(pressed.into_iter().map(|place| self.members[place]).collect())
    }

    fn points<P: Part>(&self, parts: &[P], physics: &PhysicsWorld, before: &Before) -> Vec<Point> {
        let mut points = Vec::new();
        for (one, other) in &self.pairs {
            let Some(pair) = physics.narrow_phase.contact_pair(*one, *other) else { continue };
            let mover = |collider: ColliderHandle, point: Vector| self.mover(collider, point, parts, physics, before);
            for manifold in pair.solver_manifolds() {
                let data = &manifold.data;
                for contact in &data.solver_contacts {
                    let world = |anchor: Vector, body: Option<RigidBodyHandle>, given: bool| {
                        let body =
                            body.filter(|_| !given).and_then(|handle| Some((handle, physics.bodies.get(handle)?)));
                        body.map_or(anchor, |(handle, body)| {
                            let centre = body.mass_properties().local_mprops.local_com;
                            before.of(handle, body).pose * (centre + anchor)
                        })
                    };
                    let ends = [
                        world(contact.anchor1, data.rigid_body1, data.relative_dominance > 0),
                        world(contact.anchor2, data.rigid_body2, data.relative_dominance < 0),
                    ];
                    let point = 0.5 * (ends[0] + ends[1]);
                    points.push(Point {
                        sides: [mover(*one, point), mover(*other, point)],
                        place: point,
                        normal: data.normal,
                        apart: (ends[1] - ends[0]).dot(data.normal),
                        friction: data.friction,
                        restitution: data.restitution,
                        along: contact.tangent_velocity,
                    });
                }
            }
        }
        points
    }

    /// Who moves a shape.
    fn mover<P: Part>(
        &self,
        collider: ColliderHandle,
        point: Vector,
        parts: &[P],
        physics: &PhysicsWorld,
        before: &Before,
    ) -> Mover {
        let Some(handle) = physics.colliders.get(collider).and_then(Collider::parent) else {
            return Mover::Given(Vector::ZERO);
        };
        let mine = |member: &usize| parts[*member].colliders().contains(&collider);
        if let Some(place) = self.members.iter().position(mine) {
            return Mover::Member(place, handle);
        }
        if let Some(place) = self.bodies.iter().position(|body| *body == handle) {
            return Mover::Body(place);
        }
        let body = physics.bodies.get(handle).filter(|body| !body.is_fixed());
        let given = body.map_or(Vector::ZERO, |body| {
            let before = before.of(handle, body);
            let centre = before.pose * body.mass_properties().local_mprops.local_com;
            Motion { linear: body.linvel(), angular: body.angvel(), ..before }.at(point, centre)
        });
        Mover::Given(given)
    }
}

/// The rows of an island.
struct Built {
    problem: Problem,
    /// Where the coordinates of each mechanism are, and after them those of each body.
    spans: Vec<(usize, usize)>,
    members: usize,
    free: Vec<Free>,
    /// The rows of what holds at the joints of each mechanism.
    ties: Vec<std::ops::Range<usize>>,
    /// The rows of contacts, each with the movers of its sides.
    normals: Vec<(usize, [Mover; 2])>,
}

impl Built {
    fn new<P: Part>(island: &Island, parts: &[P], physics: &PhysicsWorld, before: &Before, dt_s: f64) -> Self {
        let mut problem = Problem::default();
        let mut spans = Vec::new();
        let velocities = &mut problem.velocities;
        for member in &island.members {
            let from = velocities.len();
            velocities.extend_from_slice(parts[*member].seen().aimed());
            spans.push((from, velocities.len()));
        }
        let mut free = Vec::new();
        for handle in &island.bodies {
            let Some(body) = physics.bodies.get(*handle) else { continue };
            let before = before.of(*handle, body);
            let from = velocities.len();
            velocities.extend((before.linear + physics.gravity * dt_s).to_array());
            velocities.extend(before.angular.to_array());
            spans.push((from, velocities.len()));
            let properties = body.mass_properties().local_mprops;
            free.push(Free {
                handle: *handle,
                before,
                centre: before.pose * properties.local_com,
                inverse_mass: properties.inv_mass,
                inverse_inertia: inverse_inertia(body, before.pose.rotation),
            });
        }
        Self { problem, spans, members: island.members.len(), free, ties: Vec::new(), normals: Vec::new() }
    }

    /// Adds what holds at the joints of the mechanisms.
    fn tie<P: Part>(&mut self, island: &Island, parts: &[P]) {
        for (place, member) in island.members.iter().enumerate() {
            let mechanism = parts[*member].seen();
            let first = self.problem.rows.len();
            let (from, to) = self.spans[place];
            for tie in mechanism.ties() {
                let mut along = vec![0.0; self.problem.velocities.len()];
                for (axis, factor) in tie.parts {
                    along[from + axis] += factor;
                }
                let row = Row {
                    softness: tie.softness,
                    least: tie.least,
                    most: tie.most,
                    ..Row::rigid([(from, to), (0, 0)], tie.wanted)
                };
                self.push(row, &along, island, parts);
            }
            self.ties.push(first..self.problem.rows.len());
        }
    }

    /// Adds the contacts: first all normals, then all directions in their surfaces.
    fn touch<P: Part>(&mut self, points: &[Point], island: &Island, parts: &[P], dt_s: f64) {
        let mut frictions = Vec::new();
        for point in points {
            let along = self.along(point, point.normal, island, parts);
            let reaches = along.iter().map(|along| along.abs()).fold(0.0, f64::max);
            if reaches < 1e-12 {
                // neither side gives way along the normal
                continue;
            }
            let approach = self.approach(point, island, parts);
            let given = point.given(point.normal);
            let bounces = point.restitution > 0.0 && approach < 0.0 && point.apart + approach * dt_s <= 0.0;
            let wanted = if bounces {
                -point.restitution * approach
            } else if point.apart > NEAR_M {
                -point.apart / dt_s
            } else {
                0.0
            };
            let correction = if point.apart > NEAR_M {
                0.0
            } else {
                (MADE_UP * (-SUNK_M - point.apart) / dt_s).clamp(-MADE_UP_M_S, MADE_UP_M_S)
            };
            let row = Row { least: 0.0, correction, ..Row::rigid(self.spans_of(point), wanted - given) };
            self.push(row, &along, island, parts);
            let normal = self.problem.rows.len() - 1;
            self.normals.push((normal, point.sides));
            frictions.push((normal, point));
        }
        self.problem.bounded = self.problem.rows.len();
        for (normal, point) in frictions {
            let first = self.problem.rows.len();
            for direction in surface(point.normal) {
                let along = self.along(point, direction, island, parts);
                let wanted = point.along.dot(direction) - point.given(direction);
                self.push(Row::rigid(self.spans_of(point), wanted), &along, island, parts);
            }
            self.problem.frictions.push(Friction { normal, first, coefficient: point.friction });
        }
    }

    fn push<P: Part>(&mut self, row: Row, along: &[f64], island: &Island, parts: &[P]) {
        let Self { problem, spans, members, free, .. } = self;
        let touched = row.spans;
        problem.push(row, along, |along, answer| {
            for span in touched.into_iter().filter(|(from, to)| from < to) {
                let Some(place) = spans.iter().position(|own| *own == span) else { continue };
                let (from, to) = span;
                if place < *members {
                    parts[island.members[place]].seen().answers(&along[from..to], &mut answer[from..to]);
                } else {
                    free[place - *members].answers(&along[from..to], &mut answer[from..to]);
                }
            }
        });
    }

    /// The coordinates of the sides of a point; one of a mechanism that touches itself only once.
    fn spans_of(&self, point: &Point) -> [(usize, usize); 2] {
        let span = |mover: Mover| match mover {
            Mover::Member(place, _) => self.spans[place],
            Mover::Body(place) => self.spans[self.members + place],
            Mover::Given(_) => (0, 0),
        };
        let [one, other] = point.sides.map(span);
        if one == other { [one, (0, 0)] } else { [one, other] }
    }

    /// How fast the second side goes away from the first in a direction with each velocity.
    fn along<P: Part>(&self, point: &Point, direction: Vector, island: &Island, parts: &[P]) -> Vec<f64> {
        let mut along = vec![0.0; self.problem.velocities.len()];
        for (mover, sign) in point.sides.into_iter().zip([-1.0, 1.0]) {
            let direction = direction * sign;
            match mover {
                Mover::Member(place, body) => {
                    let (from, to) = self.spans[place];
                    let mechanism = parts[island.members[place]].seen();
                    mechanism.lever(body, point.place, direction, &mut along[from..to]);
                }
                Mover::Body(place) => {
                    let (from, _) = self.spans[self.members + place];
                    let turning = (point.place - self.free[place].centre).cross(direction);
                    for (k, value) in direction.to_array().into_iter().chain(turning.to_array()).enumerate() {
                        along[from + k] += value;
                    }
                }
                Mover::Given(_) => {}
            }
        }
        along
    }

    /// How fast both sides go away from each other as the step begins.
    fn approach<P: Part>(&self, point: &Point, island: &Island, parts: &[P]) -> f64 {
        let speed = |mover: Mover| match mover {
            Mover::Member(place, body) => parts[island.members[place]].seen().approach(body, point.place, point.normal),
            Mover::Body(place) => {
                let free = &self.free[place];
                free.before.at(point.place, free.centre).dot(point.normal)
            }
            Mover::Given(velocity) => velocity.dot(point.normal),
        };
        let [one, other] = point.sides.map(speed);
        other - one
    }

    /// Whether anything presses on a mechanism.
    fn is_pressed(&self, place: usize) -> bool {
        let mine = |mover: &Mover| matches!(mover, Mover::Member(own, _) if *own == place);
        let mut rows = self.normals.iter().filter(|(_, sides)| sides.iter().any(mine));
        rows.any(|(row, _)| self.problem.rows[*row].impulse != 0.0)
    }

    /// Moves the bodies.
    fn go(&self, corrections: &[f64], physics: &mut PhysicsWorld, dt_s: f64) {
        let vector = |all: &[f64], from: usize| Vector::new(all[from], all[from + 1], all[from + 2]);
        for (free, (from, _)) in self.free.iter().zip(&self.spans[self.members..]) {
            let Some(body) = physics.bodies.get_mut(free.handle) else { continue };
            let both = |from: usize| vector(&self.problem.velocities, from) + vector(corrections, from);
            let centre = body.mass_properties().local_mprops.local_com;
            let pose = free.before.after([both(*from), both(*from + 3)], centre, dt_s);
            body.set_position(pose, false);
            body.set_linvel(vector(&self.problem.velocities, *from), false);
            body.set_angvel(vector(&self.problem.velocities, *from + 3), false);
        }
    }
}

impl Free {
    /// What an impulse and its moment add to its velocities.
    fn answers(&self, along: &[f64], answer: &mut [f64]) {
        let turned = self.inverse_inertia * Vector3::new(along[3], along[4], along[5]);
        for (answer, along) in answer.iter_mut().zip(&along[..3]) {
            *answer = along * self.inverse_mass;
        }
        answer[3..6].copy_from_slice(turned.as_slice());
    }
}

/// Two directions in a surface, at right angles.
fn surface(normal: Vector) -> [Vector; 2] {
    let [x, y, z] = normal.to_array().map(f64::abs);
    let away = if x <= y && x <= z {
        Vector::X
    } else if y <= z {
        Vector::Y
    } else {
        Vector::Z
    };
    let first = normal.cross(away).normalize();
    [first, normal.cross(first)]
}
