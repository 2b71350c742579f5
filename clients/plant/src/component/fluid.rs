//! Flow of air and oil through orifices, and the pressure in a chamber.

/// Pa in a bar.
pub(crate) const BAR_PA: f64 = 1e5;
/// Atmosphere, Pa: the reference of every gauge pressure.
pub(crate) const ATMOSPHERE_PA: f64 = 101_325.0;
/// m³/s in a l/min.
pub(crate) const L_MIN_M3_S: f64 = 1.0 / 60_000.0;
/// Gas constant of dry air, J/(kg·K).
pub(crate) const AIR_J_KG_K: f64 = 287.05;
/// Absolute temperature of 0 °C.
pub(crate) const ZERO_DEGC_K: f64 = 273.15;
/// Density of air in the reference atmosphere of ISO 8778 (100 kPa, 20 °C, 65 %), kg/m³.
pub(crate) const AIR_KG_M3: f64 = 1.185;
/// Above this ratio of pressures the flow of air is taken as linear, as ISO 6358-1 annex does, for
/// its slope has no bound at equal pressures.
const LAMINAR_RATIO: f64 = 0.999;
/// Below this difference the flow of oil is linear, Pa.
const LAMINAR_PA: f64 = 1e4;

/// Mass flow of air from `up_pa` to `down_pa` (absolute; negative if the second is higher), kg/s, by
/// ISO 6358-1: `C ρ0 p1` below the critical ratio `b`, `C ρ0 p1 √(1 - ((p2/p1 - b)/(1 - b))²)` above.
/// `conductance` is C in m³/(s·Pa); the air is at its reference temperature.
pub(crate) fn air_kg_s(conductance: f64, critical_ratio: f64, up_pa: f64, down_pa: f64) -> f64 {
    if down_pa > up_pa {
        return -air_kg_s(conductance, critical_ratio, down_pa, up_pa);
    }
    let choked = conductance * AIR_KG_M3 * up_pa;
    let part = |ratio: f64| {
        let subsonic = ((ratio - critical_ratio) / (1.0 - critical_ratio)).max(0.0);
        (1.0 - subsonic * subsonic).max(0.0).sqrt()
    };
    let ratio = down_pa / up_pa;
    if ratio <= LAMINAR_RATIO {
        return choked * part(ratio);
    }
    choked * part(LAMINAR_RATIO) * (1.0 - ratio) / (1.0 - LAMINAR_RATIO)
}

/// Volume flow of oil through a sharp edge, `gain √Δp` with the sign of Δp; `gain` is `Q_N / √Δp_N`
/// in m³/(s·√Pa).
pub(crate) fn oil_m3_s(gain: f64, difference_pa: f64) -> f64 {
    let size = difference_pa.abs();
    if size < LAMINAR_PA {
        return gain * difference_pa / LAMINAR_PA.sqrt();
    }
    gain * size.sqrt().copysign(difference_pa)
}

/// The pressure a sub-step later where `rate` gives dp/dt at a pressure: Euler's linearly implicit
/// step, stable however stiff a small chamber is; first order.
pub(crate) fn implicit_pa(pressure_pa: f64, dt_s: f64, rate: impl Fn(f64) -> f64) -> f64 {
    let now = rate(pressure_pa);
    let apart = 1.0 + 1e-6 * pressure_pa.abs();
    let slope = (rate(pressure_pa + apart) - now) / apart;
    pressure_pa + dt_s * now / (1.0 - dt_s * slope.min(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn air_is_choked_below_the_critical_ratio() {
        let at = |down: f64| air_kg_s(1e-8, 0.3, 7e5, down);
        assert_eq!(at(1e5), 1e-8 * 1.185 * 7e5);
        assert_eq!(at(1e5), at(0.3 * 7e5));
        assert!(at(0.5 * 7e5) < at(1e5) && at(7e5) == 0.0);
        // the ellipse at half way between b and 1
        let half = at(0.65 * 7e5) / at(0.0);
        // one square root of a number near 1
        assert!((half - 0.75_f64.sqrt()).abs() < 1e-12, "{half}");
        assert_eq!(air_kg_s(1e-8, 0.3, 1e5, 7e5), -at(1e5), "backwards alike");
    }

    #[test]
    fn oil_has_its_rated_flow_and_no_corner_at_zero() {
        let gain = 1e-3 / (35.0 * BAR_PA).sqrt();
        assert!((oil_m3_s(gain, 35.0 * BAR_PA) - 1e-3).abs() < 1e-18);
        assert!((oil_m3_s(gain, -140.0 * BAR_PA) + 2e-3).abs() < 1e-18);
        let (below, above) = (oil_m3_s(gain, LAMINAR_PA * 0.999_999), oil_m3_s(gain, LAMINAR_PA * 1.000_001));
        assert!((above / below - 1.0).abs() < 1e-5);
    }

    #[test]
    fn an_implicit_step_is_stable_where_an_explicit_one_is_not() {
        // dp/dt = -1e6 (p - 5) with a step of 1 ms
        let mut pressure = 100.0;
        for _ in 0..10 {
            pressure = implicit_pa(pressure, 1e-3, |p| -1e6 * (p - 5.0));
        }
        assert!((pressure - 5.0).abs() < 1e-6, "{pressure}");
    }
}
