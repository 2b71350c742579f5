//! Spatial vectors: motion and force of rigid bodies, all taken about one point in the world's axes.
//!
//! Source: R. Featherstone, *Rigid Body Dynamics Algorithms*, Springer 2008, ch. 2.

use rapier3d::glamx::DMat3;
use rapier3d::math::Vector;

/// A velocity or an acceleration of a body: of its turning, and of the point of it that is now at the
/// reference point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Twist {
    pub(super) angular: Vector,
    pub(super) linear: Vector,
}

impl Twist {
    /// Of a turn about an axis through a point.
    #[inline]
    pub(super) fn turning(axis: Vector, through: Vector) -> Self {
        Self { angular: axis, linear: through.cross(axis) }
    }

    /// Of a translation.
    #[inline]
    pub(super) fn sliding(axis: Vector) -> Self {
        Self { angular: Vector::ZERO, linear: axis }
    }

    #[inline]
    pub(super) fn plus(self, other: Self) -> Self {
        Self { angular: self.angular + other.angular, linear: self.linear + other.linear }
    }

    #[inline]
    pub(super) fn times(self, factor: f64) -> Self {
        Self { angular: self.angular * factor, linear: self.linear * factor }
    }

    /// How `moved` changes as it is carried along by this motion.
    #[inline]
    pub(super) fn carries(self, moved: Self) -> Self {
        Self {
            angular: self.angular.cross(moved.angular),
            linear: self.angular.cross(moved.linear) + self.linear.cross(moved.angular),
        }
    }

    /// How a force or a momentum changes as it is carried along by this motion.
    #[inline]
    pub(super) fn carries_force(self, force: Wrench) -> Wrench {
        Wrench {
            moment: self.angular.cross(force.moment) + self.linear.cross(force.force),
            force: self.angular.cross(force.force),
        }
    }

    /// The power of a force in this motion.
    #[inline]
    pub(super) fn power(self, force: Wrench) -> f64 {
        self.angular.dot(force.moment) + self.linear.dot(force.force)
    }
}

/// A force and its moment about the reference point; or a momentum.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Wrench {
    pub(super) moment: Vector,
    pub(super) force: Vector,
}

impl Wrench {
    #[inline]
    pub(super) fn plus(self, other: Self) -> Self {
        Self { moment: self.moment + other.moment, force: self.force + other.force }
    }
}

/// The inertia of a body about the reference point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Inertia {
    mass: f64,
    /// Mass times the centre of mass.
    first: Vector,
    about: DMat3,
}

impl Inertia {
    /// Of nothing. A derived default would have the matrix's own, which is the identity.
    pub(super) const NONE: Self = Self { mass: 0.0, first: Vector::ZERO, about: DMat3::ZERO };

    /// Of a mass with its centre, and its tensor about that centre.
    #[inline]
    pub(super) fn of(mass: f64, centre: Vector, tensor: DMat3) -> Self {
        let [x, y, z] = centre.to_array();
        let square = centre.length_squared();
        let offset = DMat3::from_cols(
            Vector::new(square - x * x, -x * y, -x * z),
            Vector::new(-x * y, square - y * y, -y * z),
            Vector::new(-x * z, -y * z, square - z * z),
        );
        Self { mass, first: centre * mass, about: tensor + offset * mass }
    }

    #[inline]
    pub(super) fn plus(self, other: Self) -> Self {
        Self { mass: self.mass + other.mass, first: self.first + other.first, about: self.about + other.about }
    }

    /// The momentum in a motion, or the force for an acceleration.
    #[inline]
    pub(super) fn times(&self, motion: Twist) -> Wrench {
        Wrench {
            moment: self.about * motion.angular + self.first.cross(motion.linear),
            force: motion.linear * self.mass + motion.angular.cross(self.first),
        }
    }
}
