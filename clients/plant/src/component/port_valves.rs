//! Valves in the ports of a hydraulic cylinder, through which oil leaves a chamber: throttles, cushions, flow controls
//! and counterbalance valves. What enters goes past them through check valves.
//!
//! # Source
//! D. Findeisen, *Ölhydraulik*, Springer 2015, ch. 4 (flow control valves, load-holding valves).

use super::fluid::oil_m3_s;

/// A load-holding valve: it opens by its own pressure and, `pilot_ratio` times as well, by that of the other port.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Counterbalance {
    pub(crate) set_pa: f64,
    pub(crate) pilot_ratio: f64,
    /// Flow beyond its opening, m³/(s·Pa).
    pub(crate) gain: f64,
}

/// The valves in each of the two ports. Gains are `Q_N / √Δp_N`, m³/(s·√Pa).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PortValves {
    pub(crate) throttle: Option<f64>,
    /// Length and gain.
    pub(crate) cushion: Option<(f64, f64)>,
    /// What a flow control lets pass, m³/s.
    pub(crate) most_m3_s: Option<f64>,
    pub(crate) counterbalance: Counterbalance,
}

/// A chamber that oil may leave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Leaving {
    /// How far the piston is from where the chamber is empty.
    pub(crate) left_m: f64,
    pub(crate) own_pa: f64,
    pub(crate) other_pa: f64,
    /// Whether the counterbalance valve is in its port.
    pub(crate) balanced: bool,
}

/// The gain of two orifices, one behind the other: their drops of pressure add up.
fn in_series(one: f64, other: f64) -> f64 {
    one * other / (one * one + other * other).sqrt()
}

impl PortValves {
    /// Flow into a chamber from a port behind the spool's edge of this gain; negative if it leaves.
    pub(crate) fn inflow(&self, gain: f64, port_pa: f64, chamber: &Leaving) -> f64 {
        let free = oil_m3_s(gain, port_pa - chamber.own_pa);
        if free >= 0.0 {
            return free;
        }
        let throttled = self.throttle.map_or(gain, |throttle| in_series(gain, throttle));
        let cushion = self.cushion.filter(|(length_m, _)| chamber.left_m < *length_m);
        let throttled = cushion.map_or(throttled, |(_, cushion)| in_series(throttled, cushion));
        let mut out = oil_m3_s(throttled, chamber.own_pa - port_pa);
        if let Some(most) = self.most_m3_s {
            out = out.min(most);
        }
        if chamber.balanced {
            let Counterbalance { set_pa, pilot_ratio, gain } = self.counterbalance;
            out = out.min(gain * (chamber.own_pa + pilot_ratio * chamber.other_pa - set_pa).max(0.0));
        }
        -out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: PortValves = PortValves {
        throttle: None,
        cushion: None,
        most_m3_s: None,
        counterbalance: Counterbalance { set_pa: 2e7, pilot_ratio: 3.0, gain: 1e-10 },
    };

    fn chamber(own_pa: f64) -> Leaving {
        Leaving { left_m: 0.1, own_pa, other_pa: 0.0, balanced: false }
    }

    #[test]
    fn orifices_one_behind_the_other_share_the_drop() {
        let valves = PortValves { throttle: Some(4e-7), ..NONE };
        // of 100 bar the edge takes 16 parts of 25, the throttle 9 where their gains are 3 and 4
        let out = -valves.inflow(3e-7, 0.0, &chamber(1e7));
        assert!((out - 3e-7 * (0.64e7_f64).sqrt()).abs() < 1e-15, "{out}");
        assert_eq!(valves.inflow(3e-7, 2e7, &chamber(1e7)), NONE.inflow(3e-7, 2e7, &chamber(1e7)), "in past it");
    }

    #[test]
    fn a_cushion_counts_at_its_end_and_a_flow_control_has_no_pressure_in_it() {
        let valves = PortValves { cushion: Some((0.02, 1e-8)), most_m3_s: Some(5e-4), ..NONE };
        for own_pa in [1e7, 2e7] {
            assert_eq!(valves.inflow(3e-7, 0.0, &chamber(own_pa)), -5e-4);
        }
        let near = Leaving { left_m: 0.01, ..chamber(1e7) };
        assert!(valves.inflow(3e-7, 0.0, &near) > -1e-8 * (1e7_f64).sqrt());
    }

    #[test]
    fn a_counterbalance_valve_holds_until_its_pilot_opens_it() {
        let held = Leaving { balanced: true, ..chamber(1e7) };
        assert_eq!(NONE.inflow(3e-7, 0.0, &held), 0.0);
        // 100 + 3 · 40 - 200 bar
        let piloted = Leaving { other_pa: 4e6, ..held };
        assert!((NONE.inflow(3e-7, 0.0, &piloted) + 1e-10 * 2e6).abs() < 1e-18);
    }
}
