//! Sensors: end positions of joints, bodies near a point.

use onescan_server::signal::{PortLayout, Slot, SlotError};
use rapier3d::math::Vector;
use rapier3d::prelude::{Ray, RigidBodyHandle};

use super::effort::Mark;
use super::model;
use super::world::{Sought, World};

/// A sensor, bound to what it detects and to its signal.
pub(super) struct Sensor {
    signal: Slot<bool>,
    sensing: Sensing,
}

enum Sensing {
    EndPosition(EndPosition),
    Proximity(Proximity),
}

/// A range of a joint's coordinate.
struct EndPosition {
    joint: usize,
    from: f64,
    to: f64,
    hysteresis: f64,
}

impl EndPosition {
    /// Rises inside the range, falls farther outside of it than the hysteresis.
    fn detects(&self, position: f64, before: bool) -> bool {
        let margin = if before { self.hysteresis } else { 0.0 };
        position >= self.from - margin && position <= self.to + margin
    }
}

/// A ray that a body carries, in that body's own coordinates.
struct Proximity {
    body: RigidBodyHandle,
    point: Vector,
    direction: Vector,
    range_m: f64,
    targets: Sought,
}

impl Proximity {
    fn detects(&self, world: &World) -> bool {
        let pose = *world.body(self.body).position();
        let ray = Ray::new(pose * self.point, pose.rotation * self.direction);
        world.any_hit(&ray, self.range_m, &self.targets)
    }
}

impl Sensor {
    /// Binds a sensor in a world that still stands in the scene's pose.
    pub(super) fn build(sensor: &model::Sensor, world: &mut World, writes: &PortLayout) -> Result<Self, SlotError> {
        let sensing = match &sensor.sensing {
            model::Sensing::EndPosition { joint, from, to, hysteresis } => {
                Sensing::EndPosition(EndPosition { joint: *joint, from: *from, to: *to, hysteresis: *hysteresis })
            }
            model::Sensing::Proximity { body, point_m, direction, range_m, targets } => {
                let body = world.handle(*body);
                let targets = targets.iter().map(|index| world.handle(Some(*index))).collect();
                let targets = world.seek(targets);
                let pose = world.body(body).position();
                Sensing::Proximity(Proximity {
                    body,
                    point: pose.inverse_transform_point(Vector::from_array(*point_m)),
                    direction: pose.inverse_transform_vector(Vector::from_array(*direction)),
                    range_m: *range_m,
                    targets,
                })
            }
        };
        Ok(Self { signal: writes.slot(sensor.signal.as_str())?, sensing })
    }

    /// Looks; `before` is what the sensor saw a period ago.
    pub(super) fn detects(&self, world: &World, motions: &[Mark], before: bool) -> bool {
        match &self.sensing {
            Sensing::EndPosition(range) => range.detects(motions[range.joint].position, before),
            Sensing::Proximity(ray) => ray.detects(world),
        }
    }

    /// Writes what the sensor sees.
    pub(super) fn write(&self, detected: bool, outputs: &mut [u8]) {
        self.signal.set(outputs, detected);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sensor_rises_in_its_range_and_falls_beyond_the_hysteresis() {
        let range = EndPosition { joint: 0, from: -0.002, to: f64::INFINITY, hysteresis: 0.001 };
        let seen: Vec<_> = [-0.01, -0.0021, -0.002, 0.0, -0.0025, -0.003, -0.0031, -0.0025, -0.002]
            .iter()
            .scan(false, |before, position| {
                *before = range.detects(*position, *before);
                Some(*before)
            })
            .collect();
        assert_eq!(seen, [false, false, true, true, true, true, false, false, true]);
    }

    #[test]
    fn no_position_at_all_is_not_detected() {
        let range = EndPosition { joint: 0, from: f64::NEG_INFINITY, to: f64::INFINITY, hysteresis: 0.0 };
        assert!(!range.detects(f64::NAN, true));
    }
}
