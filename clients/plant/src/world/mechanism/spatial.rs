//! Spatial vectors: motion and force of rigid bodies as vectors of six, all taken about one point in the world's axes.
//!
//! Source: R. Featherstone, *Rigid Body Dynamics Algorithms*, Springer 2008, ch. 2.

use std::ops::{Add, Mul};

use nalgebra::{Matrix3, Vector3, Vector6};

/// A velocity or an acceleration of a body: of its turning, over that of the point of it that is now at the
/// reference point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Twist(Vector6<f64>);

/// A force's moment about the reference point over the force itself; or a momentum.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Wrench(Vector6<f64>);

#[inline]
fn upper(six: &Vector6<f64>) -> Vector3<f64> {
    Vector3::new(six.x, six.y, six.z)
}

#[inline]
fn lower(six: &Vector6<f64>) -> Vector3<f64> {
    Vector3::new(six.w, six.a, six.b)
}

#[inline]
fn over(upper: Vector3<f64>, lower: Vector3<f64>) -> Vector6<f64> {
    Vector6::new(upper.x, upper.y, upper.z, lower.x, lower.y, lower.z)
}

impl Twist {
    /// Of a body that turns so, and whose point at the reference point moves so.
    #[inline]
    pub(super) fn of(angular: Vector3<f64>, linear: Vector3<f64>) -> Self {
        Self(over(angular, linear))
    }

    /// Of a turn about an axis through a point.
    #[inline]
    pub(super) fn turning(axis: Vector3<f64>, through: Vector3<f64>) -> Self {
        Self::of(axis, through.cross(&axis))
    }

    /// Of a translation.
    #[inline]
    pub(super) fn sliding(axis: Vector3<f64>) -> Self {
        Self::of(Vector3::zeros(), axis)
    }

    #[inline]
    pub(super) fn angular(&self) -> Vector3<f64> {
        upper(&self.0)
    }

    /// How fast the point of the body that is at `arm` from the reference point moves.
    #[inline]
    pub(super) fn at(&self, arm: Vector3<f64>) -> Vector3<f64> {
        lower(&self.0) + self.angular().cross(&arm)
    }

    /// How `moved` changes as it is carried along by this motion.
    #[inline]
    pub(super) fn carries(&self, moved: &Self) -> Self {
        let (angular, linear) = (self.angular(), lower(&self.0));
        let turned = moved.angular();
        Self::of(angular.cross(&turned), angular.cross(&lower(&moved.0)) + linear.cross(&turned))
    }

    /// How a force or a momentum changes as it is carried along by this motion.
    #[inline]
    pub(super) fn carries_force(&self, force: &Wrench) -> Wrench {
        let (angular, linear) = (self.angular(), lower(&self.0));
        let (moment, force) = (upper(&force.0), lower(&force.0));
        Wrench(over(angular.cross(&moment) + linear.cross(&force), angular.cross(&force)))
    }

    /// The power of a force in this motion.
    #[inline]
    pub(super) fn power(&self, force: &Wrench) -> f64 {
        self.angular().dot(&upper(&force.0)) + lower(&self.0).dot(&lower(&force.0))
    }
}

impl Add for Twist {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Mul<f64> for Twist {
    type Output = Self;

    #[inline]
    fn mul(self, factor: f64) -> Self {
        Self(self.0 * factor)
    }
}

impl Add for Wrench {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

/// The inertia of a body about the reference point: ten numbers, of which a matrix of six rows would have 36.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Inertia {
    mass: f64,
    /// Mass times the centre of mass.
    first: Vector3<f64>,
    about: Matrix3<f64>,
}

impl Inertia {
    /// Of nothing.
    pub(super) fn none() -> Self {
        Self { mass: 0.0, first: Vector3::zeros(), about: Matrix3::zeros() }
    }

    /// Of a mass with its centre, and its tensor about that centre.
    #[inline]
    pub(super) fn of(mass: f64, centre: Vector3<f64>, tensor: Matrix3<f64>) -> Self {
        let [x, y, z] = centre.into();
        let square = x * x + y * y + z * z;
        let offset = Matrix3::new(
            square - x * x,
            -x * y,
            -x * z,
            -x * y,
            square - y * y,
            -y * z,
            -x * z,
            -y * z,
            square - z * z,
        );
        Self { mass, first: centre * mass, about: tensor + offset * mass }
    }

    /// The momentum in a motion, or the force for an acceleration.
    #[inline]
    pub(super) fn times(&self, motion: &Twist) -> Wrench {
        let (angular, linear) = (motion.angular(), lower(&motion.0));
        Wrench(over(self.about * angular + self.first.cross(&linear), linear * self.mass + angular.cross(&self.first)))
    }
}

impl Add for Inertia {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self { mass: self.mass + other.mass, first: self.first + other.first, about: self.about + other.about }
    }
}
