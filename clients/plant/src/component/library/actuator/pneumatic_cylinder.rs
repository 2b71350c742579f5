//! A pneumatic cylinder with its directional valve, end cushions and end switches.
//!
//! # Equations
//! Chamber A pushes the rod out, chamber B in. For each, with mass flow `ṁ` into it and area `A`:
//! - `dp/dt = n/V (R T ṁ - p dV/dt)`: air in a chamber, polytropic with exponent n;
//! - `ṁ = C ρ0 p1 ψ(p2/p1)`: ISO 6358-1, from supply or to the atmosphere, by the valve's position;
//!   within `cushion_m` of an end the chamber that empties does so through the cushion's screw, and everywhere through
//!   the one-way throttle in its port, whichever is narrower;
//! - `m dv/dt = p_A A_A - p_B A_B - p_0 A_rod - F_load - d v - F_c sgn(v)`.
//!
//! Pressures are in Pa absolute, signals in bar above the atmosphere. At the set-up the air has been on for
//! long: each chamber has the pressure of the port that its valve connects it to.
//!
//! # Source
//! ISO 6358-1:2013 (flow); P. Beater, *Pneumatic Drives*, Springer 2007, ch. 3 and 5 (chamber, cushion).
//!
//! # Method
//! Sub-steps of at most 50 µs; pressures linearly implicit, motion semi-implicit: first order.

use std::f64::consts::FRAC_PI_4;

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Conflict, Start, Turn};
use crate::component::declare::{choice, failures, own_types, parameters, signals};
use crate::component::dynamics::{OnDelay, Resistance, Travel, slope_of, substeps};
use crate::component::fluid::{AIR_J_KG_K, ATMOSPHERE_PA, BAR_PA, ZERO_DEGC_K, air_kg_s, implicit_pa};
use crate::coupling::{Coordinate, Slides};
use crate::effort::{Effort, Motion};

/// Longest sub-step.
const LONGEST_S: f64 = 50e-6;
/// What opens a pilot-operated check valve, above the atmosphere.
const PILOT_PA: f64 = 1e5;
/// m³/(s·Pa) in a l/(s·bar).
const CONDUCTANCE: f64 = 1e-8;

choice! {
    /// The directional valve.
    Valve {
        /// One coil; a spring takes the rod back.
        Spring = "5/2",
        /// Two coils; the valve stays where it was put.
        Impulse = "5/2-impulse",
        /// Two coils; at rest all ports are closed.
        Closed = "5/3-closed",
        /// Two coils; at rest both chambers are open to the atmosphere.
        Exhausted = "5/3-exhausted",
        /// Two coils; at rest both chambers are open to the supply.
        Pressurised = "5/3-pressurised",
    }
}

parameters! {
    /// A cylinder and its valve.
    Parameters {
        /// diameter of the piston
        bore_m: f64 = 0.05 => 0.004, 1.0;
        /// diameter of the rod, less than the bore
        rod_m: f64 = 0.02 => 0.0, 0.9;
        /// way of the rod from 0
        stroke_m: f64 = 0.2 => 0.001, 10.0;
        /// the valve: "5/2" has a spring, "5/2-impulse" stays, "5/3-…" is so at rest
        valve: Valve = Valve::Spring;
        /// supply, above the atmosphere
        supply_bar: f64 = 6.0 => 0.0, 50.0;
        /// sonic conductance of valve and tube
        conductance_l_s_bar: f64 = 2.0 => 0.001, 1000.0;
        /// ratio of pressures below which the flow is choked
        critical_ratio: f64 = 0.3 => 0.0, 0.9;
        /// from the coil's current to the valve's new position
        valve_delay_s: f64 = 0.015 => 0.0, 1.0;
        /// length of the cushion at each end
        cushion_m: f64 = 0.015 => 0.0, 1.0;
        /// conductance of the cushion's screw
        cushion_l_s_bar: f64 = 0.05 => 0.0, 1000.0;
        /// volume of each chamber and its tube at its end
        dead_cm3: f64 = 20.0 => 0.1, 1e5;
        /// all that moves with the rod; on a joint its bodies do
        moving_kg: f64 = 5.0 => 0.01, 1e5;
        /// constant load against the way out
        load_n: f64 = 0.0 => -1e6, 1e6;
        /// dry friction
        friction_n: f64 = 20.0 => 0.0, 1e5;
        /// viscous friction
        viscous_n_s_m: f64 = 50.0 => 0.0, 1e6;
        /// polytropic exponent: 1 isothermal, 1.4 adiabatic
        polytropic: f64 = 1.2 => 1.0, 1.4;
        /// temperature of the air
        air_degc: f64 = 20.0 => -40.0, 120.0;
        /// how far from its end a switch sees the piston
        switch_m: f64 = 0.003 => 0.0, 0.5;
        /// one-way throttle for the air that leaves while the rod goes out; 0 for none
        throttle_out_l_s_bar: f64 = 0.0 => 0.0, 1000.0;
        /// one-way throttle for the air that leaves while the rod goes in; 0 for none
        throttle_in_l_s_bar: f64 = 0.0 => 0.0, 1000.0;
        /// pilot-operated check valves in both ports: air leaves a chamber only while the other port has 1 bar or more
        holds_air: bool = false;
    }
}

signals! {
    /// The valve's coils.
    Inputs {
        /// coil that drives the rod out
        extend: bool,
        /// coil that drives the rod in; a "5/2" valve has none
        retract: bool,
    }
}

signals! {
    /// The switches, and what an engineer would measure.
    Outputs {
        /// switch at the outer end
        extended: bool,
        /// switch at the inner end
        retracted: bool,
        /// way of the rod
        position_m: f64,
        /// velocity of the rod
        velocity_m_s: f64,
        /// pressure that drives out, above the atmosphere
        cap_bar: f64,
        /// pressure that drives in, above the atmosphere
        rod_bar: f64,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the rod does not move
        Jammed = "jammed",
        /// the piston's seal lets air through, a tenth of the valve's conductance
        Leaking = "leaking",
        /// the supply is open to the atmosphere
        NoSupply = "no_supply",
        /// the valve stays where it is
        ValveStuck = "valve_stuck",
        /// the switch at the outer end stays off
        ExtendedDead = "extended_dead",
        /// the switch at the inner end stays off
        RetractedDead = "retracted_dead",
        /// the throttles are wide open
        ThrottlesOpen = "throttles_open",
    }
}

/// Where the valve connects the chambers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Spool {
    Out,
    Rest,
    In,
}

/// What it remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    spool: Spool,
    switching: OnDelay,
    cap_pa: f64,
    rod_pa: f64,
    rod: Travel,
}

/// A cylinder by its parameters.
pub(crate) struct PneumaticCylinder {
    p: Parameters,
    cap_m2: f64,
    ring_m2: f64,
    heat_j_kg: f64,
    longest_s: f64,
}

impl PneumaticCylinder {
    /// Where the coils want the spool.
    fn wanted(&self, inputs: Inputs, now: Spool) -> Spool {
        match (self.p.valve, inputs.extend, inputs.retract) {
            (Valve::Spring, true, _) | (_, true, false) => Spool::Out,
            (Valve::Spring, false, _) | (_, false, true) => Spool::In,
            (Valve::Impulse, ..) => now,
            (_, true, true) | (_, false, false) => Spool::Rest,
        }
    }

    /// What chambers A and B are connected to, Pa; none for a closed port.
    fn ports(&self, spool: Spool, supply_pa: f64) -> [Option<f64>; 2] {
        match (spool, self.p.valve) {
            (Spool::Out, _) => [Some(supply_pa), Some(ATMOSPHERE_PA)],
            (Spool::In, _) => [Some(ATMOSPHERE_PA), Some(supply_pa)],
            (Spool::Rest, Valve::Pressurised) => [Some(supply_pa); 2],
            (Spool::Rest, Valve::Exhausted) => [Some(ATMOSPHERE_PA); 2],
            (Spool::Rest, _) => [None; 2],
        }
    }

    /// Pressures of chambers A and B where the spool has stood for long: those of their ports. What closed
    /// ports have locked in is not known; it is the atmosphere.
    fn settled_pa(&self, spool: Spool) -> [f64; 2] {
        let supply_pa = ATMOSPHERE_PA + self.p.supply_bar * BAR_PA;
        self.ports(spool, supply_pa).map(|port| port.unwrap_or(ATMOSPHERE_PA))
    }

    /// Mass flow into a chamber that is `left_m` away from being empty and has a one-way throttle in its port.
    fn inflow(&self, [port, other]: [Option<f64>; 2], chamber_pa: f64, left_m: f64, throttle: f64) -> f64 {
        let Some(port_pa) = port else { return 0.0 };
        let mut conductance = self.p.conductance_l_s_bar;
        if chamber_pa > port_pa {
            if self.p.holds_air && other.is_none_or(|other_pa| other_pa < ATMOSPHERE_PA + PILOT_PA) {
                return 0.0;
            }
            if throttle > 0.0 {
                conductance = conductance.min(throttle);
            }
            if left_m < self.p.cushion_m {
                conductance = conductance.min(self.p.cushion_l_s_bar);
            }
        }
        air_kg_s(conductance * CONDUCTANCE, self.p.critical_ratio, port_pa, chamber_pa)
    }

    /// Where the valve connects the chambers to in this turn.
    fn connected(&self, state: &State, turn: &Turn<Option<Coordinate>>) -> [Option<f64>; 2] {
        let lost = turn.failed.has(Failure::NoSupply);
        self.ports(state.spool, ATMOSPHERE_PA + if lost { 0.0 } else { self.p.supply_bar * BAR_PA })
    }

    /// Moves the spool if its delay is over as a sub-step begins: turns may be longer than that is.
    fn switch(&self, state: &mut State, inputs: Inputs, turn: &Turn<Option<Coordinate>>, dt_s: f64) {
        let wanted = self.wanted(inputs, state.spool);
        let stuck = turn.failed.has(Failure::ValveStuck);
        if state.switching.has_held(wanted != state.spool && !stuck, self.p.valve_delay_s, dt_s) {
            state.spool = wanted;
        }
    }

    /// Moves the pressures by a sub-step in which the rod goes on as it does.
    fn breathe(&self, state: &mut State, turn: &Turn<Option<Coordinate>>, dt_s: f64) {
        let p = &self.p;
        let ports = self.connected(state, turn);
        let (x, v) = (state.rod.position, state.rod.velocity);
        let (cap_left, rod_left) = (x, p.stroke_m - x);
        let dead_m3 = p.dead_cm3 * 1e-6;
        let (cap_m3, rod_m3) = (dead_m3 + self.cap_m2 * cap_left, dead_m3 + self.ring_m2 * rod_left);
        let leak = if turn.failed.has(Failure::Leaking) { 0.1 * p.conductance_l_s_bar * CONDUCTANCE } else { 0.0 };
        let open = turn.failed.has(Failure::ThrottlesOpen);
        let [out, back] =
            [p.throttle_out_l_s_bar, p.throttle_in_l_s_bar].map(|throttle| if open { 0.0 } else { throttle });
        let (cap_pa, rod_pa) = (state.cap_pa, state.rod_pa);
        state.cap_pa = implicit_pa(cap_pa, dt_s, |pa| {
            let mass = self.inflow(ports, pa, cap_left, back) + air_kg_s(leak, p.critical_ratio, rod_pa, pa);
            p.polytropic / cap_m3 * (self.heat_j_kg * mass - pa * self.cap_m2 * v)
        });
        state.rod_pa = implicit_pa(rod_pa, dt_s, |pa| {
            let mass =
                self.inflow([ports[1], ports[0]], pa, rod_left, out) + air_kg_s(leak, p.critical_ratio, cap_pa, pa);
            p.polytropic / rod_m3 * (self.heat_j_kg * mass + pa * self.ring_m2 * v)
        });
    }

    fn substep(&self, state: &mut State, inputs: Inputs, turn: &Turn<Option<Coordinate>>, dt_s: f64) {
        let p = &self.p;
        self.switch(state, inputs, turn, dt_s);
        self.breathe(state, turn, dt_s);
        if turn.failed.has(Failure::Jammed) {
            state.rod.velocity = 0.0;
            return;
        }
        let resistance =
            Resistance { mass: p.moving_kg, dry: p.friction_n, viscous: p.viscous_n_s_m, range: (0.0, p.stroke_m) };
        state.rod.push(self.force_n(state), &resistance, dt_s);
    }

    fn force_n(&self, state: &State) -> f64 {
        let rod_m2 = self.cap_m2 - self.ring_m2;
        state.cap_pa * self.cap_m2 - state.rod_pa * self.ring_m2 - ATMOSPHERE_PA * rod_m2 - self.p.load_n
    }
}

impl Component for PneumaticCylinder {
    const NAME: &'static str = "pneumatic_cylinder";
    const SUMMARY: &'static str = "pneumatic cylinder with a 5/2 or 5/3 valve, end cushions and end switches";
    const FORMULA: &'static [&'static str] = &[
        "dp/dt = n/V (R T ṁ - p dV/dt)",
        "ṁ = C ρ0 p1 √(1 - ((p2/p1 - b)/(1 - b))²), choked below p2/p1 = b",
        "m dv/dt = p_A A_A - p_B A_B - p_0 A_rod - F_load - d v - F_c sgn(v)",
    ];
    const SOURCE: &'static str = "ISO 6358-1:2013; P. Beater, Pneumatic Drives, 2007, ch. 3 and 5";
    own_types!(sees Slides);

    fn new(p: Parameters) -> Self {
        let cap_m2 = FRAC_PI_4 * p.bore_m * p.bore_m;
        let ring_m2 = cap_m2 - FRAC_PI_4 * p.rod_m * p.rod_m;
        let heat_j_kg = AIR_J_KG_K * (ZERO_DEGC_K + p.air_degc);
        Self { p, cap_m2, ring_m2, heat_j_kg, longest_s: LONGEST_S }
    }

    fn conflict(p: &Parameters) -> Option<Conflict> {
        (p.rod_m >= p.bore_m).then_some(Conflict { key: "rod_m", wanted: "a number below `bore_m`" })
    }

    fn initial(&self, start: &Start<Option<Coordinate>>) -> State {
        let position = start.seen.map_or(0.0, |joint| joint.position.clamp(0.0, self.p.stroke_m));
        let spool = if matches!(self.p.valve, Valve::Spring | Valve::Impulse) { Spool::In } else { Spool::Rest };
        let [cap_pa, rod_pa] = self.settled_pa(spool);
        State { spool, switching: OnDelay::default(), cap_pa, rod_pa, rod: Travel { position, velocity: 0.0 } }
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Option<Coordinate>>) {
        if turn.seen.is_some() {
            return;
        }
        let (count, dt_s) = substeps(turn.dt_s, self.longest_s);
        for _ in 0..count {
            self.substep(state, *inputs, turn, dt_s);
        }
    }

    fn longest_s(&self) -> f64 {
        self.longest_s
    }

    fn stops(&self) -> Option<[f64; 2]> {
        Some([0.0, self.p.stroke_m])
    }

    fn advance(
        &self,
        state: &mut State,
        inputs: &Inputs,
        turn: &Turn<Option<Coordinate>>,
        motion: Motion,
        dt_s: f64,
    ) -> Effort {
        let p = &self.p;
        state.rod = Travel::on_joint(&motion, (0.0, p.stroke_m));
        self.switch(state, *inputs, turn, dt_s);
        self.breathe(state, turn, dt_s);
        if turn.failed.has(Failure::Jammed) {
            return Effort::BLOCKED;
        }
        let (x, dead_m3) = (state.rod.position, p.dead_cm3 * 1e-6);
        let spring = |pa: f64, area: f64, left_m: f64| p.polytropic * pa * area * area / (dead_m3 + area * left_m);
        let stiffness = spring(state.cap_pa, self.cap_m2, x) + spring(state.rod_pa, self.ring_m2, p.stroke_m - x);
        Effort {
            slope: slope_of(stiffness, &motion, dt_s),
            dry: p.friction_n,
            viscous: p.viscous_n_s_m,
            ..Effort::of(self.force_n(state))
        }
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Option<Coordinate>>) -> Outputs {
        let position_m = turn.seen.map_or(state.rod.position, |joint| joint.position);
        let out = position_m >= self.p.stroke_m - self.p.switch_m;
        Outputs {
            extended: out && !turn.failed.has(Failure::ExtendedDead),
            retracted: position_m <= self.p.switch_m && !turn.failed.has(Failure::RetractedDead),
            position_m,
            velocity_m_s: turn.seen.map_or(state.rod.velocity, |joint| joint.velocity),
            cap_bar: (state.cap_pa - ATMOSPHERE_PA) / BAR_PA,
            rod_bar: (state.rod_pa - ATMOSPHERE_PA) / BAR_PA,
        }
    }
}

#[cfg(test)]
#[path = "pneumatic_cylinder_tests.rs"]
mod tests;
