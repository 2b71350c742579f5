//! A 4/3 proportional valve on a cylinder, as the control of a machine knows it: a table of voltage and flow, the
//! area of the piston, and behind them the spool and the spring of the oil.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::component::dynamics::{lag, substeps};
use crate::setpoint::Setpoint;

/// Greatest control voltage, V.
const FULL_V: f64 = 10.0;
/// Longest sub-step, s: a twentieth of the spool's time constant or of a period of the oil's spring divided by 2π.
const LONGEST_S: f64 = 0.5e-3;
/// A worn edge of the spool lets nothing through up to this voltage more.
const WORN_V: f64 = 0.8;

/// The voltage at which flow begins, the knee of the flow, and the flow at 10 V: a table of three points. Flow is in
/// units of the axis per second, as the piston moves by it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FlowTable {
    pub(super) dead_v: f64,
    pub(super) knee_v: f64,
    pub(super) knee: f64,
    pub(super) full: f64,
}

impl FlowTable {
    /// The flow at a voltage.
    pub(super) fn flow(&self, volt: f64) -> f64 {
        let size = volt.abs().min(FULL_V);
        let flow = if size <= self.dead_v {
            0.0
        } else if size <= self.knee_v {
            self.knee * (size - self.dead_v) / (self.knee_v - self.dead_v)
        } else {
            self.knee + (self.full - self.knee) * (size - self.knee_v) / (FULL_V - self.knee_v)
        };
        flow.copysign(volt)
    }

    /// The voltage that lets a flow through; at most 10 V.
    pub(super) fn voltage(&self, flow: f64) -> f64 {
        let size = flow.abs();
        let volt = if size == 0.0 {
            return 0.0;
        } else if size <= self.knee {
            self.dead_v + (self.knee_v - self.dead_v) * size / self.knee
        } else {
            self.knee_v + (FULL_V - self.knee_v) * (size - self.knee) / (self.full - self.knee)
        };
        volt.min(FULL_V).copysign(flow)
    }
}

/// A valve and its cylinder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Valve {
    pub(super) table: FlowTable,
    pub(super) spool_s: f64,
    /// Natural frequency of the oil's spring with the moving mass, Hz, and its damping.
    pub(super) natural_hz: f64,
    pub(super) damping: f64,
    /// Gain of the position loop, 1/s.
    pub(super) gain_1_s: f64,
}

/// What it remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Oil {
    /// Control voltage, V.
    pub(super) command_v: f64,
    /// Where the spool is, V.
    spool_v: f64,
    /// Acceleration of the piston, units/s².
    acceleration: f64,
}

impl Oil {
    /// The oil once a piston has met something.
    pub(super) const REST: Self = Self { command_v: 0.0, spool_v: 0.0, acceleration: 0.0 };
}

/// What the control wants in a period.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    pub(super) from: Setpoint,
    pub(super) to: Setpoint,
    /// The control is on: without it the spool centres.
    pub(super) is_on: bool,
}

/// What is wrong with valve and pump.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wear {
    pub(super) worn: bool,
    pub(super) no_pressure: bool,
}

impl Valve {
    /// Moves piston and oil by a period.
    pub(super) fn advance(&self, oil: &mut Oil, piston: &mut Setpoint, wanted: &Wanted, wear: Wear, dt_s: f64) {
        let (count, part_s) = substeps(dt_s, LONGEST_S);
        let natural = TAU * self.natural_hz;
        let real = if wear.worn { FlowTable { dead_v: self.table.dead_v + WORN_V, ..self.table } } else { self.table };
        let mut path = wanted.from.position;
        for index in 1..=count {
            let part = f64::from(index) / f64::from(count);
            let velocity = wanted.from.velocity + (wanted.to.velocity - wanted.from.velocity) * part;
            let speed = velocity + self.gain_1_s * (path - piston.position);
            path += velocity * part_s;
            oil.command_v = if wanted.is_on { self.table.voltage(speed) } else { 0.0 };
            oil.spool_v = lag(oil.spool_v, oil.command_v, self.spool_s, part_s);
            let flow = if wear.no_pressure { 0.0 } else { real.flow(oil.spool_v) };
            let spring = natural * natural * (flow - piston.velocity);
            // implicit in the damping: stable for any
            oil.acceleration = (oil.acceleration + spring * part_s) / (1.0 + 2.0 * self.damping * natural * part_s);
            piston.velocity += oil.acceleration * part_s;
            piston.position += piston.velocity * part_s;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: FlowTable = FlowTable { dead_v: 0.3, knee_v: 4.0, knee: 2000.0, full: 10_000.0 };

    #[test]
    fn the_table_and_its_inverse_agree() {
        for flow in [-9999.0, -2000.0, -10.0, 0.0, 1.0, 1999.0, 2001.0, 10_000.0] {
            assert!((TABLE.flow(TABLE.voltage(flow)) - flow).abs() < 1e-9, "{flow}");
        }
        assert_eq!(TABLE.flow(0.3), 0.0);
        assert_eq!(TABLE.voltage(20_000.0), 10.0);
    }

    #[test]
    fn a_constant_speed_is_followed_without_error() {
        let valve = Valve { table: TABLE, spool_s: 0.008, natural_hz: 12.0, damping: 0.3, gain_1_s: 10.0 };
        let (mut oil, mut piston) = (Oil::default(), Setpoint::default());
        for k in 0..200 {
            let at = |k: u32| Setpoint { position: 3000.0 * 0.01 * f64::from(k), velocity: 3000.0 };
            let wanted = Wanted { from: at(k), to: at(k + 1), is_on: true };
            valve.advance(&mut oil, &mut piston, &wanted, Wear::default(), 0.01);
        }
        // fed forward by the table, so the loop has nothing left to do
        assert!((piston.position - 6000.0).abs() < 0.5 && (piston.velocity - 3000.0).abs() < 0.5, "{piston:?}");
    }
}
