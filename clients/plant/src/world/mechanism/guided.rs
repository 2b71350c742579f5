//! Robots without dynamics: their joints are where their axes set them, whatever is in the way. Their
//! bodies push others and feel nothing.

use rapier3d::glamx::DQuat;
use rapier3d::prelude::*;

use super::dynamics::normalise;
use super::{Link, Mechanism, tree};
use crate::effort::Mark;
use crate::fitting::Fitting;
use crate::model::Follows;
use crate::world::actuator::{Acts, Actuator};

/// A tree of bodies that is moved along the paths of its axes.
pub(crate) struct Guided {
    mechanism: Mechanism,
    /// Joints that follow others, each behind those that it follows: its axis, the other's, and how.
    followers: Vec<(usize, usize, Follows)>,
}

/// The robots that these joints make of bodies.
pub(crate) fn guided(links: &[Link], follows: &[Option<Follows>], bodies: &RigidBodySet) -> Vec<Guided> {
    let moved = |handle: RigidBodyHandle| bodies[handle].is_kinematic();
    let forest = tree::forest(links, &[], bodies, &moved, &|_| false);
    forest.trees.into_iter().map(|tree| Guided::new(Mechanism::new(tree), follows)).collect()
}

impl Guided {
    fn new(mechanism: Mechanism, follows: &[Option<Follows>]) -> Self {
        let axis = |joint: usize| mechanism.axes.iter().position(|(_, own)| *own == Some(joint));
        let each = mechanism.axes.iter().enumerate();
        let found = each.filter_map(|(on, (_, joint))| {
            let follows = follows[(*joint)?]?;
            Some((on, axis(follows.joint)?, follows))
        });
        let mut followers: Vec<_> = found.collect();
        // a chain of followers is no longer than there are of them
        for _ in 0..followers.len() {
            for index in 1..followers.len() {
                let is_behind = |before: usize, index: usize| followers[before].1 == followers[index].0;
                if is_behind(index - 1, index) {
                    followers.swap(index - 1, index);
                }
            }
        }
        Self { mechanism, followers }
    }

    /// The joints of the scene whose coordinates it has.
    pub(crate) fn joints(&self) -> impl Iterator<Item = (usize, f64, f64)> {
        self.mechanism.joints()
    }

    /// Takes its coordinates from what is remembered of its joints.
    pub(crate) fn restore(&mut self, motions: &[Mark], fittings: &[Fitting]) {
        let Mechanism { axes, now, .. } = &mut self.mechanism;
        for ((position, joint), v) in axes.iter().zip(&mut now.v) {
            if let Some(joint) = *joint {
                now.q[*position] = motions[joint].position - fittings[joint].initial;
                *v = motions[joint].velocity;
            }
        }
    }

    /// Gives its bodies the velocities that bring them, in a step that ends at this part of the turn, to
    /// where the paths of its axes lead.
    pub(crate) fn lead(
        &mut self,
        (part, dt_s): (f64, f64),
        actuators: &[Actuator],
        fittings: &[Fitting],
        bodies: &mut RigidBodySet,
    ) {
        let Mechanism { axes, now, tree, equations, .. } = &mut self.mechanism;
        for ((position, joint), v) in axes.iter().zip(&mut now.v) {
            let Some(joint) = *joint else { continue };
            let fitting = &fittings[joint];
            let own = actuators.iter().find(|actuator| actuator.joint == joint);
            if let Some(Acts::Along(path)) = own.map(|actuator| actuator.acts) {
                let wanted = path.at(part) - fitting.initial;
                let reached = wanted.clamp(fitting.lower, fitting.upper);
                *v = if reached == wanted { path.velocity(part) } else { 0.0 };
                now.q[*position] = reached;
            }
        }
        for (on, leader, Follows { factor, offset, .. }) in &self.followers {
            let initial = |axis: usize| axes[axis].1.map_or(0.0, |joint| fittings[joint].initial);
            let leads = now.q[axes[*leader].0] + initial(*leader);
            now.q[axes[*on].0] = factor * leads + offset - initial(*on);
            now.v[*on] = factor * now.v[*leader];
        }
        normalise(tree, &mut now.q);
        equations.place(tree, &now.q);
        for (index, member) in tree.members.iter().enumerate() {
            let Some(body) = member.body.and_then(|handle| bodies.get_mut(handle)) else { continue };
            let (from, to) = (*body.position(), equations.poses[index]);
            body.set_linvel((to * member.centre - from * member.centre) / dt_s, false);
            body.set_angvel(turning(to.rotation * from.rotation.inverse()) / dt_s, false);
        }
    }

    /// Puts its bodies exactly where they were to come, where [`lead`](Self::lead) has placed them.
    pub(crate) fn put(&mut self, bodies: &mut RigidBodySet) {
        self.mechanism.put_as_placed(bodies);
    }
}

/// A rotation as its axis times its angle, the shorter way.
fn turning(rotation: DQuat) -> Vector {
    let axis = Vector::new(rotation.x, rotation.y, rotation.z) * if rotation.w < 0.0 { -1.0 } else { 1.0 };
    let sine = axis.length();
    if sine == 0.0 {
        return Vector::ZERO;
    }
    axis * (2.0 * libm::atan2(sine, rotation.w.abs()) / sine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_is_measured_by_its_shorter_way() {
        let turn = |angle: f64| DQuat::from_xyzw(0.0, libm::sin(0.5 * angle), 0.0, libm::cos(0.5 * angle));
        for angle in [0.0, 1e-9, 0.7, -3.0] {
            assert!((turning(turn(angle)).y - angle).abs() < 1e-15, "{angle}");
        }
        assert!((turning(turn(6.0)).y - (6.0 - std::f64::consts::TAU)).abs() < 1e-14);
    }
}
