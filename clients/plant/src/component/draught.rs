//! The draught of a kiln: the gas that a fan draws through it, what a blockage leaves of that, and where the heat then is.
//!
//! The fan draws with the same pressure `p` whatever comes, and losses go with the square of the flow `m`. Of the loss of an
//! open kiln a part `ζ` is the velocity head of its cross section; where a part `β` of that is closed, the head is
//! `1/(1−β)²` times as large, and as much of it more is lost:
//! - `p = p·(m/m_0)²·(1 + ζ·(1/(1−β)² − 1))`, so `f = m/m_0 = 1/√(1 + ζ·(1/(1−β)² − 1))`;
//! - across the blockage there are `Δp = p·(1 − f²)`, and at the hood, where an open kiln has a part `h` of the draught,
//!   there are `h·p·f²`.
//!
//! The burner gives as much heat as before. By as much as the flow has fallen, less of it gets behind the blockage: the gas
//! there is hotter than at the ends by `f` times as much. The rest stays before it: there by `1 + (1−f)·E_b/E_a` times as
//! much, with `E_a` and `E_b` the sums over the zones before and behind. So the sum over all zones stays.

use crate::temperature_field::ZONES;

/// What flows of an open kiln's gas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Draught {
    flow: f64,
}

impl Draught {
    /// Of an open kiln.
    pub(crate) const OPEN: Self = Self { flow: 1.0 };

    /// With a part of the cross section closed, less than 1; `head` is the part of the draught that is its velocity head.
    pub(crate) fn blocked(closed: f64, head: f64) -> Self {
        let open = 1.0 - closed;
        Self { flow: 1.0 / (1.0 + head * (1.0 / (open * open) - 1.0)).sqrt() }
    }

    /// As a part of that of an open kiln.
    pub(crate) const fn flow(self) -> f64 {
        self.flow
    }

    /// What is left of a pressure that goes with the square of the flow.
    pub(crate) const fn left_of(self, pressure_pa: f64) -> f64 {
        pressure_pa * self.flow * self.flow
    }

    /// By how much gas is hotter than at the ends, zone by zone, where a blockage lies before the zone `behind`; as it is
    /// with nothing before the blockage, where the heat then goes out at the hood.
    pub(crate) fn carries(self, excess_k: &[f64; ZONES], behind: usize) -> [f64; ZONES] {
        if self.flow == 1.0 {
            return *excess_k;
        }
        let behind = behind.min(ZONES);
        let (before_k, behind_k): (f64, f64) = (excess_k[..behind].iter().sum(), excess_k[behind..].iter().sum());
        std::array::from_fn(|zone| match zone {
            zone if zone >= behind => self.flow * excess_k[zone],
            zone if before_k > 0.0 => excess_k[zone] + (1.0 - self.flow) * behind_k * (excess_k[zone] / before_k),
            zone => excess_k[zone],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_cross_section_quadruples_its_head() {
        // of the loss of 1 a tenth is the head, and three times as much comes to it
        let half = Draught::blocked(0.5, 0.1);
        assert!((half.flow() - 1.0 / 1.3_f64.sqrt()).abs() < 1e-15);
        assert!((half.left_of(130.0) - 100.0).abs() < 1e-12);
        assert_eq!(Draught::blocked(0.0, 0.1), Draught::OPEN);
        assert_eq!(Draught::blocked(0.9, 0.0), Draught::OPEN, "nothing is lost in it");
    }

    #[test]
    fn no_heat_is_lost_but_where_nothing_is_before_the_blockage() {
        let excess: [f64; ZONES] = std::array::from_fn(|zone| 100.0 + 10.0 * zone as f64);
        let blocked = Draught::blocked(0.9, 0.05);
        for behind in 1..=ZONES + 1 {
            let carried = blocked.carries(&excess, behind);
            assert!((carried.iter().sum::<f64>() - excess.iter().sum::<f64>()).abs() < 1e-9, "{behind}");
            assert!(
                carried
                    .iter()
                    .zip(&excess)
                    .enumerate()
                    .all(|(zone, (now, before))| { if zone < behind { now >= before } else { now < before } })
            );
        }
        let (lost, cold) = (blocked.carries(&excess, 0), blocked.carries(&[0.0; ZONES], 5));
        assert!((lost.iter().sum::<f64>() / excess.iter().sum::<f64>() - blocked.flow()).abs() < 1e-12);
        assert_eq!(cold, [0.0; ZONES]);
        assert_eq!(Draught::OPEN.carries(&excess, 7), excess);
    }
}
