//! Stops of revolute joints that are a turn or more apart, as the engine can keep them.
//!
//! The engine reads an angle off the poses of two bodies, which look alike after a turn, and so keeps no stops that
//! leave a whole one. The coordinates of joints count turns: near a stop the engine gets that one alone, and elsewhere
//! none.

use std::f64::consts::{PI, TAU};

use rapier3d::math::Real;
use rapier3d::prelude::ImpulseJointSet;

use super::measured_axis;
use super::mechanism::Link;
use crate::effort::Mark;
use crate::fitting::Fitting;
use crate::model::JointKind;

/// Gives the engine the stops of revolute joints that are a turn or more apart, for where the joints are now.
pub(super) fn limit(links: &[Link], fittings: &[Fitting], motions: &[Mark], joints: &mut ImpulseJointSet) {
    let turning = |((link, _), _): &((&Link, _), _)| link.kind == JointKind::Revolute;
    for ((link, fitting), motion) in links.iter().zip(fittings).zip(motions).filter(turning) {
        let near = limits(motion.position - fitting.initial, [fitting.lower, fitting.upper]);
        if let Some(near) = near
            && let Some(joint) = joints.get_mut(link.handle, false)
        {
            joint.data.set_limits(measured_axis(link.kind), near);
        }
    }
}

/// What the engine limits of a joint at a coordinate between these stops, all counted from the scene's pose; none if the
/// stops are less than a turn apart, and the engine keeps them as they are.
fn limits(position: f64, [lower, upper]: [f64; 2]) -> Option<[Real; 2]> {
    let stops = lower.is_finite() || upper.is_finite();
    if !stops || upper - lower < TAU {
        return None;
    }
    // half a turn beyond keeps it apart from the far side, whatever moves in a step
    Some(if position - lower <= PI {
        [lower, lower + 1.5 * PI]
    } else if upper - position <= PI {
        [upper - 1.5 * PI, upper]
    } else {
        [-Real::MAX, Real::MAX]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_a_stop_it_is_that_one_alone() {
        let stops = [-1.0, 20.0];
        assert_eq!(limits(0.0, stops), Some([-1.0, -1.0 + 1.5 * PI]));
        assert_eq!(limits(10.0, stops), Some([-Real::MAX, Real::MAX]));
        assert_eq!(limits(19.0, stops), Some([20.0 - 1.5 * PI, 20.0]));
        assert_eq!(limits(-1.2, [-1.0, f64::INFINITY]), Some([-1.0, -1.0 + 1.5 * PI]));
        assert_eq!(limits(1e9, [-1.0, f64::INFINITY]), Some([-Real::MAX, Real::MAX]));
    }

    #[test]
    fn others_are_as_they_are() {
        assert_eq!(limits(0.0, [-1.0, 1.0]), None);
        assert_eq!(limits(0.0, [f64::NEG_INFINITY, f64::INFINITY]), None);
    }
}
