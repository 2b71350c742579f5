//! Steel as enthalpy: solid, melting, liquid.

use serde::{Deserialize, Serialize};

/// Where enthalpy is counted from, °C.
pub(crate) const REFERENCE_DEGC: f64 = 25.0;

/// Steel per kilogram. 385 kWh/t at 1600 °C with the presets of the furnace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Steel {
    /// Heat capacity, solid and liquid, J/(kg·K).
    pub(crate) heat_j_kg_k: f64,
    /// Heat of fusion, J/kg.
    pub(crate) fusion_j_kg: f64,
    /// Where it melts, °C.
    pub(crate) melting_degc: f64,
}

impl Steel {
    /// Enthalpy of solid steel at its melting point, J/kg.
    pub(crate) fn solidus_j_kg(&self) -> f64 {
        self.heat_j_kg_k * (self.melting_degc - REFERENCE_DEGC)
    }

    /// Enthalpy of liquid steel at its melting point, J/kg.
    pub(crate) fn liquidus_j_kg(&self) -> f64 {
        self.solidus_j_kg() + self.fusion_j_kg
    }

    /// Temperature at an enthalpy, °C.
    pub(crate) fn temperature_degc(&self, enthalpy_j_kg: f64) -> f64 {
        let above_j_kg = (enthalpy_j_kg - self.liquidus_j_kg()).max(0.0);
        let below_j_kg = enthalpy_j_kg.min(self.solidus_j_kg());
        REFERENCE_DEGC + (below_j_kg + above_j_kg) / self.heat_j_kg_k
    }
}

/// So much steel with so much enthalpy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Lump {
    pub(crate) mass_kg: f64,
    pub(crate) enthalpy_j: f64,
}

impl Lump {
    /// Per kilogram; that of cold steel where there is none.
    pub(crate) fn enthalpy_j_kg(&self) -> f64 {
        if self.mass_kg > 0.0 { self.enthalpy_j / self.mass_kg } else { 0.0 }
    }

    pub(crate) fn temperature_degc(&self, steel: &Steel) -> f64 {
        steel.temperature_degc(self.enthalpy_j_kg())
    }

    /// Takes out so much, or all of it if that is less, as it is.
    pub(crate) fn take(&mut self, mass_kg: f64) -> Self {
        if mass_kg >= self.mass_kg {
            return std::mem::take(self);
        }
        let taken = Self { mass_kg: mass_kg.max(0.0), enthalpy_j: mass_kg.max(0.0) * self.enthalpy_j_kg() };
        self.mass_kg -= taken.mass_kg;
        self.enthalpy_j -= taken.enthalpy_j;
        taken
    }

    pub(crate) fn add(&mut self, other: Self) {
        self.mass_kg += other.mass_kg;
        self.enthalpy_j += other.enthalpy_j;
    }

    /// Heats solid steel: `on_the_spot` of the heat melts a part of it, the rest warms it, and what is then above the
    /// melting point melts too. What has melted.
    pub(crate) fn melt(&mut self, heat_j: f64, on_the_spot: f64, steel: &Steel) -> Self {
        if self.mass_kg <= 0.0 {
            return Self { mass_kg: 0.0, enthalpy_j: heat_j };
        }
        let missing_j_kg = steel.liquidus_j_kg() - self.enthalpy_j_kg();
        let mut melted = self.take(on_the_spot * heat_j / missing_j_kg);
        let spent_j = melted.mass_kg * steel.liquidus_j_kg() - melted.enthalpy_j;
        melted.enthalpy_j += spent_j;
        self.enthalpy_j += heat_j - spent_j;
        let excess_j = self.enthalpy_j - self.mass_kg * steel.solidus_j_kg();
        if excess_j > 0.0 {
            let also_kg = excess_j / steel.fusion_j_kg;
            if also_kg >= self.mass_kg {
                melted.add(std::mem::take(self));
            } else {
                self.mass_kg -= also_kg;
                self.enthalpy_j -= also_kg * steel.liquidus_j_kg();
                melted.add(Self { mass_kg: also_kg, enthalpy_j: also_kg * steel.liquidus_j_kg() });
            }
        }
        melted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: Steel = Steel { heat_j_kg_k: 720.0, fusion_j_kg: 252e3, melting_degc: 1520.0 };

    #[test]
    fn a_tonne_at_1600_degrees_has_385_kwh() {
        let tonne = Lump { mass_kg: 1000.0, enthalpy_j: 385.0 * 3.6e6 };
        assert!((tonne.temperature_degc(&STEEL) - 1600.0).abs() < 1e-9);
        let melting = Lump { enthalpy_j: 1000.0 * (STEEL.solidus_j_kg() + 100e3), ..tonne };
        assert!((melting.temperature_degc(&STEEL) - 1520.0).abs() < 1e-9);
    }

    #[test]
    fn what_melts_and_what_stays_have_all_the_heat() {
        for on_the_spot in [0.0, 0.6, 1.0] {
            let (mut scrap, mut bath, mut given_j) = (Lump { mass_kg: 50e3, enthalpy_j: 0.0 }, Lump::default(), 0.0);
            for _ in 0..3000 {
                bath.add(scrap.melt(20e6, on_the_spot, &STEEL));
                given_j += 20e6;
                assert!((scrap.mass_kg + bath.mass_kg - 50e3).abs() < 1e-6);
                assert!((scrap.enthalpy_j + bath.enthalpy_j - given_j).abs() < 1e-9 * given_j);
                assert!(scrap.temperature_degc(&STEEL) <= 1520.0 + 1e-9);
            }
            // 50 t at their melting point take 53.8 GJ solid and 66.4 GJ liquid; 60 GJ leave some
            assert!(scrap.mass_kg > 0.0 && bath.mass_kg > 24e3, "{on_the_spot}: {scrap:?}");
        }
    }

    #[test]
    fn more_than_there_is_cannot_be_taken() {
        let mut bath = Lump { mass_kg: 10.0, enthalpy_j: 1e7 };
        assert_eq!(bath.take(-1.0), Lump::default());
        assert_eq!(bath.take(20.0), Lump { mass_kg: 10.0, enthalpy_j: 1e7 });
        assert_eq!(bath, Lump::default());
    }
}
