//! A hydraulic cylinder with a 4/3 proportional valve, valves in its ports and end cushions.
//!
//! # Equations
//! With the spool at `u` from -1 to 1, chamber A (piston side) and B (rod side):
//! - `T du/dt = u_command - u`: the spool;
//! - `q = Q_N u √(Δp/Δp_N)` over each of the two edges that are open: the orifice equation, with the
//!   rated flow at the rated difference of pressure;
//! - `dp_A/dt = E/V_A (q_A - A_A v - q_leak)`, `dp_B/dt = E/V_B (q_leak + A_B v - q_B)`: compressible oil;
//! - `m dv/dt = p_A A_A - p_B A_B - F_load - d v - F_c sgn(v)`.
//!
//! What leaves a chamber goes through the valves in its port (`port_valves`); what
//! enters passes them by their check valves.
//!
//! Commanded by a velocity, the valve is fed forward as a machine's control does it from its table
//! of flows and areas: `u = A v / (Q_N √(Δp/Δp_N))` with the pressures that hold now.
//!
//! # Source
//! M. Jelali, A. Kroll, *Hydraulic Servo-systems*, Springer 2003, ch. 4; feed-forward: the axes of the
//! peeling machine simulator (Nyyssönen 2018, 3.1.4).
//!
//! # Method
//! Sub-steps of at most 50 µs; pressures linearly implicit, motion semi-implicit: first order.

use std::f64::consts::FRAC_PI_4;

use serde::{Deserialize, Serialize};

use crate::component::behaviour::{Component, Conflict, Start, Turn};
use crate::component::declare::{choice, failures, own_types, parameters, signals};
use crate::component::dynamics::{Resistance, Travel, lag, slope_of, substeps};
use crate::component::fluid::{BAR_PA, L_MIN_M3_S, implicit_pa};
use crate::component::port_valves::{Counterbalance, Leaving, PortValves};
use crate::coupling::{Coordinate, Slides};
use crate::effort::{Effort, Motion};

/// Longest sub-step.
const LONGEST_S: f64 = 50e-6;
/// The place of `unit_bar` among the inputs.
const UNIT_BAR: usize = 2;
/// A greater spool than this counts as open.
const SPOOL_MIN: f64 = 1e-9;

choice! {
    /// What the command means.
    Command {
        /// The spool, from -1 to 1.
        Spool = "spool",
        /// The rod's velocity, fed forward to the spool.
        Velocity = "velocity",
    }
}

choice! {
    /// Where the supply comes from.
    Supply {
        /// It is constant.
        Constant = "constant",
        /// A hydraulic unit.
        Unit = "unit",
    }
}

choice! {
    /// The chamber whose port has a counterbalance valve.
    Balanced {
        /// No chamber.
        Neither = "none",
        /// The piston's side: a load that pushes in.
        Cap = "cap",
        /// The rod's side: a load that pulls out.
        Rod = "rod",
    }
}

parameters! {
    /// A cylinder, its valve and its supply.
    Parameters {
        /// diameter of the piston
        bore_m: f64 = 0.063 => 0.005, 2.0;
        /// diameter of the rod, less than the bore
        rod_m: f64 = 0.036 => 0.0, 1.9;
        /// way of the rod from 0
        stroke_m: f64 = 0.5 => 0.001, 20.0;
        /// where the rod stands at the set-up, unless a joint says so
        initial_m: f64 = 0.0 => 0.0, 20.0;
        /// what `command` means: "spool" from -1 to 1, or "velocity" in m/s
        command: Command = Command::Spool;
        /// supply
        supply_bar: f64 = 160.0 => 1.0, 700.0;
        /// where the supply comes from: "constant" is `supply_bar`, "unit" the input `unit_bar`
        supply: Supply = Supply::Constant;
        /// tank
        tank_bar: f64 = 0.0 => 0.0, 50.0;
        /// the valve's flow over one edge, open, at the rated difference
        rated_l_min: f64 = 40.0 => 0.01, 10000.0;
        /// difference of pressure over one edge at the rated flow
        rated_bar: f64 = 35.0 => 0.1, 350.0;
        /// time constant of the spool
        spool_s: f64 = 0.008 => 0.0, 1.0;
        /// bulk modulus of the oil with its air
        bulk_bar: f64 = 12000.0 => 500.0, 30000.0;
        /// volume of each chamber and its hose at its end
        dead_cm3: f64 = 100.0 => 1.0, 1e6;
        /// leakage over the piston
        leak_l_s_bar: f64 = 0.0 => 0.0, 1.0;
        /// all that moves with the rod; on a joint its bodies do
        moving_kg: f64 = 200.0 => 0.1, 1e6;
        /// constant load against the way out
        load_n: f64 = 0.0 => -1e7, 1e7;
        /// dry friction
        friction_n: f64 = 100.0 => 0.0, 1e6;
        /// viscous friction
        viscous_n_s_m: f64 = 500.0 => 0.0, 1e7;
        /// how far from its end a switch sees the piston
        switch_m: f64 = 0.003 => 0.0, 0.5;
        /// length of the cushion at each end; 0 for none
        cushion_m: f64 = 0.0 => 0.0, 1.0;
        /// flow through the cushion's screw at `rated_bar`
        cushion_l_min: f64 = 2.0 => 0.001, 10000.0;
        /// one-way throttle in each port: flow out at `rated_bar`; 0 for none
        throttle_l_min: f64 = 0.0 => 0.0, 10000.0;
        /// one-way flow control in each port: greatest flow out, whatever the pressure; 0 for none
        flow_control_l_min: f64 = 0.0 => 0.0, 10000.0;
        /// the chamber whose port has a counterbalance valve: "none", "cap" or "rod"
        counterbalance: Balanced = Balanced::Neither;
        /// pressure of that chamber at which the valve opens by itself
        counterbalance_bar: f64 = 200.0 => 1.0, 700.0;
        /// what of the other chamber's pressure counts for opening it, as a ratio to its own
        pilot_ratio: f64 = 3.0 => 0.0, 20.0;
        /// flow that the valve lets pass for each bar beyond its opening
        counterbalance_l_s_bar: f64 = 0.02 => 1e-6, 100.0;
    }
}

signals! {
    /// What the valve's amplifier gets.
    Inputs {
        /// the amplifier is on; without it the spool centres
        enable: bool = true,
        /// spool from -1 (in) to 1 (out), or velocity in m/s
        command: f64,
        /// pressure of the hydraulic unit, if it is the `supply`
        unit_bar: f64,
    }
}

signals! {
    /// What transducers measure.
    Outputs {
        /// way of the rod
        position_m: f64,
        /// velocity of the rod
        velocity_m_s: f64,
        /// pressure on the piston's side
        cap_bar: f64,
        /// pressure on the rod's side
        rod_bar: f64,
        /// where the spool is, from -1 to 1
        spool: f64,
        /// switch at the outer end
        extended: bool,
        /// switch at the inner end
        retracted: bool,
        /// flow from the supply, mean over the period
        drawn_l_min: f64,
    }
}

failures! {
    /// How it fails.
    Failure {
        /// the spool stays where it is
        SpoolStuck = "spool_stuck",
        /// the piston's seal leaks: 0.002 l/(s·bar) more
        Leaking = "leaking",
        /// the pump stands: supply at the tank's pressure
        NoSupply = "no_supply",
        /// the rod does not move
        Jammed = "jammed",
        /// the counterbalance valve stays open
        CounterbalanceOpen = "counterbalance_open",
    }
}

/// What it remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    spool: f64,
    cap_pa: f64,
    rod_pa: f64,
    rod: Travel,
    /// What it has drawn in this period.
    drawn_m3: f64,
}

/// A cylinder by its parameters.
pub(crate) struct HydraulicCylinder {
    p: Parameters,
    cap_m2: f64,
    ring_m2: f64,
    /// `Q_N / √Δp_N`, m³/(s·√Pa)
    gain: f64,
    valves: PortValves,
    longest_s: f64,
}

impl HydraulicCylinder {
    /// The command of the spool that lets the rod move at a velocity, by the pressures of now.
    fn fed_forward(&self, state: &State, velocity_m_s: f64, supply_pa: f64) -> f64 {
        let out = velocity_m_s >= 0.0;
        let (area, drop_pa) =
            if out { (self.cap_m2, supply_pa - state.cap_pa) } else { (self.ring_m2, supply_pa - state.rod_pa) };
        // never asks for more than a tenth of the rated difference would need
        let least_pa = 0.1 * self.p.rated_bar * BAR_PA;
        (area * velocity_m_s / (self.gain * drop_pa.max(least_pa).sqrt())).clamp(-1.0, 1.0)
    }

    /// Flows into chambers A and B at these pressures and a way of the rod, m³/s.
    fn flows(&self, spool: f64, supply_pa: f64, [cap_pa, rod_pa]: [f64; 2], x: f64, open: bool) -> [f64; 2] {
        let tank_pa = self.p.tank_bar * BAR_PA;
        let gain = self.gain * spool.abs();
        if spool.abs() < SPOOL_MIN {
            return [0.0, 0.0];
        }
        let [cap_port, rod_port] = if spool > 0.0 { [supply_pa, tank_pa] } else { [tank_pa, supply_pa] };
        let balances = |side: Balanced| self.p.counterbalance == side && !open;
        let cap = Leaving { left_m: x, own_pa: cap_pa, other_pa: rod_pa, balanced: balances(Balanced::Cap) };
        let rod = Leaving {
            left_m: self.p.stroke_m - x,
            own_pa: rod_pa,
            other_pa: cap_pa,
            balanced: balances(Balanced::Rod),
        };
        [self.valves.inflow(gain, cap_port, &cap), self.valves.inflow(gain, rod_port, &rod)]
    }

    /// The pressure of the supply in this turn.
    fn supply_pa(&self, inputs: &Inputs, turn: &Turn<Option<Coordinate>>) -> f64 {
        let lost = turn.failed.has(Failure::NoSupply);
        let bar = match self.p.supply {
            _ if lost => self.p.tank_bar,
            Supply::Constant => self.p.supply_bar,
            Supply::Unit => inputs.unit_bar.max(0.0),
        };
        bar * BAR_PA
    }

    /// Moves spool and pressures by a sub-step in which the rod goes on as it does.
    fn flow(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Option<Coordinate>>, dt_s: f64) {
        let p = &self.p;
        let supply_pa = self.supply_pa(inputs, turn);
        let wanted = match (inputs.enable, p.command) {
            (false, _) => 0.0,
            (true, Command::Spool) => inputs.command.clamp(-1.0, 1.0),
            (true, Command::Velocity) => self.fed_forward(state, inputs.command, supply_pa),
        };
        if !turn.failed.has(Failure::SpoolStuck) {
            state.spool = lag(state.spool, wanted, p.spool_s, dt_s);
        }
        let (x, v) = (state.rod.position, state.rod.velocity);
        let (dead_m3, bulk_pa) = (p.dead_cm3 * 1e-6, p.bulk_bar * BAR_PA);
        let cap_m3 = dead_m3 + self.cap_m2 * x;
        let rod_m3 = dead_m3 + self.ring_m2 * (p.stroke_m - x);
        let worn = if turn.failed.has(Failure::Leaking) { 0.002 } else { 0.0 };
        let leak = (p.leak_l_s_bar + worn) * 1e-3 / BAR_PA;
        let (cap_pa, rod_pa, spool) = (state.cap_pa, state.rod_pa, state.spool);
        let open = turn.failed.has(Failure::CounterbalanceOpen);
        let flows = |pressures: [f64; 2]| self.flows(spool, supply_pa, pressures, x, open);
        let cap_rate = |pa: f64| {
            let inflow = flows([pa, rod_pa])[0];
            bulk_pa / cap_m3 * (inflow - self.cap_m2 * v - leak * (pa - rod_pa))
        };
        let rod_rate = |pa: f64| {
            let inflow = flows([cap_pa, pa])[1];
            bulk_pa / rod_m3 * (inflow + self.ring_m2 * v - leak * (pa - cap_pa))
        };
        // oil does not pull: below zero it would turn to vapour
        state.cap_pa = implicit_pa(cap_pa, dt_s, cap_rate).max(0.0);
        state.rod_pa = implicit_pa(rod_pa, dt_s, rod_rate).max(0.0);
        let drawn = if spool > 0.0 { flows([state.cap_pa, rod_pa])[0] } else { flows([cap_pa, state.rod_pa])[1] };
        state.drawn_m3 += drawn * dt_s;
    }

    fn force_n(&self, state: &State) -> f64 {
        state.cap_pa * self.cap_m2 - state.rod_pa * self.ring_m2 - self.p.load_n
    }

    fn substep(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Option<Coordinate>>, dt_s: f64) {
        let p = &self.p;
        self.flow(state, inputs, turn, dt_s);
        if turn.failed.has(Failure::Jammed) {
            state.rod.velocity = 0.0;
            return;
        }
        let resistance =
            Resistance { mass: p.moving_kg, dry: p.friction_n, viscous: p.viscous_n_s_m, range: (0.0, p.stroke_m) };
        state.rod.push(self.force_n(state), &resistance, dt_s);
    }
}

impl Component for HydraulicCylinder {
    const NAME: &'static str = "hydraulic_cylinder";
    const SUMMARY: &'static str =
        "hydraulic cylinder with a 4/3 proportional valve, valves in its ports and end cushions";
    const FORMULA: &'static [&'static str] = &[
        "q = Q_N u √(Δp/Δp_N)",
        "dp_A/dt = E/V_A (q_A - A_A v - q_leak), dp_B/dt = E/V_B (q_leak + A_B v - q_B)",
        "m dv/dt = p_A A_A - p_B A_B - F_load - d v - F_c sgn(v)",
        "fed forward: u = A v / (Q_N √(Δp/Δp_N))",
        "out through a throttle or cushion behind the spool's edge: 1/k² = 1/k_1² + 1/k_2²",
        "out through a counterbalance valve: q ≤ K (p + R p_other - p_set)",
    ];
    const SOURCE: &'static str = "M. Jelali, A. Kroll, Hydraulic Servo-systems, 2003, ch. 4; Nyyssönen 2018, 3.1.4";
    const INITIAL: &'static [&'static str] = &["initial_m"];
    own_types!(sees Slides);

    fn new(p: Parameters) -> Self {
        let cap_m2 = FRAC_PI_4 * p.bore_m * p.bore_m;
        let ring_m2 = cap_m2 - FRAC_PI_4 * p.rod_m * p.rod_m;
        let gain = p.rated_l_min / 60_000.0 / (p.rated_bar * BAR_PA).sqrt();
        let at_rated = |l_min: f64| l_min * L_MIN_M3_S / (p.rated_bar * BAR_PA).sqrt();
        let valves = PortValves {
            throttle: (p.throttle_l_min > 0.0).then(|| at_rated(p.throttle_l_min)),
            cushion: (p.cushion_m > 0.0).then(|| (p.cushion_m, at_rated(p.cushion_l_min))),
            most_m3_s: (p.flow_control_l_min > 0.0).then_some(p.flow_control_l_min * L_MIN_M3_S),
            counterbalance: Counterbalance {
                set_pa: p.counterbalance_bar * BAR_PA,
                pilot_ratio: p.pilot_ratio,
                gain: p.counterbalance_l_s_bar * 1e-3 / BAR_PA,
            },
        };
        Self { p, cap_m2, ring_m2, gain, valves, longest_s: LONGEST_S }
    }

    fn conflict(p: &Parameters) -> Option<Conflict> {
        if p.rod_m >= p.bore_m {
            return Some(Conflict { key: "rod_m", wanted: "a number below `bore_m`" });
        }
        (p.initial_m > p.stroke_m).then_some(Conflict { key: "initial_m", wanted: "a number up to `stroke_m`" })
    }

    fn initial(&self, start: &Start<Option<Coordinate>>) -> State {
        let position = start.seen.map_or(self.p.initial_m, |joint| joint.position.clamp(0.0, self.p.stroke_m));
        // the pressures that hold the load, as oil that was locked in does
        let load_n = self.p.load_n;
        State {
            spool: 0.0,
            cap_pa: load_n.max(0.0) / self.cap_m2,
            rod_pa: (-load_n).max(0.0) / self.ring_m2,
            rod: Travel { position, velocity: 0.0 },
            drawn_m3: 0.0,
        }
    }

    fn uses(p: &Parameters, input: usize) -> bool {
        p.supply == Supply::Unit || input != UNIT_BAR
    }

    fn drive(&self, state: &mut State, inputs: &Inputs, turn: &Turn<Option<Coordinate>>) {
        state.drawn_m3 = 0.0;
        if turn.seen.is_some() {
            return;
        }
        let (count, dt_s) = substeps(turn.dt_s, self.longest_s);
        for _ in 0..count {
            self.substep(state, inputs, turn, dt_s);
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
        self.flow(state, inputs, turn, dt_s);
        if turn.failed.has(Failure::Jammed) {
            return Effort::BLOCKED;
        }
        let (x, dead_m3) = (state.rod.position, p.dead_cm3 * 1e-6);
        let spring = |area: f64, left_m: f64| p.bulk_bar * BAR_PA * area * area / (dead_m3 + area * left_m);
        let stiffness = spring(self.cap_m2, x) + spring(self.ring_m2, p.stroke_m - x);
        Effort {
            slope: slope_of(stiffness, &motion, dt_s),
            dry: p.friction_n,
            viscous: p.viscous_n_s_m,
            ..Effort::of(self.force_n(state))
        }
    }

    fn sense(&self, state: &mut State, _: &Inputs, turn: &Turn<Option<Coordinate>>) -> Outputs {
        let position_m = turn.seen.map_or(state.rod.position, |joint| joint.position);
        Outputs {
            position_m,
            velocity_m_s: turn.seen.map_or(state.rod.velocity, |joint| joint.velocity),
            cap_bar: state.cap_pa / BAR_PA,
            rod_bar: state.rod_pa / BAR_PA,
            spool: state.spool,
            extended: position_m >= self.p.stroke_m - self.p.switch_m,
            retracted: position_m <= self.p.switch_m,
            drawn_l_min: if turn.dt_s > 0.0 { state.drawn_m3 / turn.dt_s / L_MIN_M3_S } else { 0.0 },
        }
    }
}

#[cfg(test)]
#[path = "hydraulic_cylinder_tests.rs"]
mod tests;
