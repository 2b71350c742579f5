//! Springs and dampers of joints in steps with friction, brakes and drives.
//!
//! # Method
//! The implicit midpoint rule. A spring pulls as it does half way through the sub-step,
//! `F = -k (q + h (v + v')/4)`, and a damper brakes half of both velocities. What of that depends on `v'`
//! acts like a mass that the joint has beside its own, `h²k/4 + h c/2`, so it goes into the matrix of the
//! sub-step. Without friction, spring and mass then keep their energy at every step, however stiff the
//! spring is; friction takes some of it. Taken at the start of the sub-step, a spring gives the mass energy:
//! the amplitude grows by `ω²h/4` a second.
//!
//! A joint that goes on with its new velocity alone (it is driven along a path, coupled, or near a stop)
//! has the spring half way along that, `-k (q + h v'/2)`. It loses energy, `½ m (v' - v)²` a sub-step.

use nalgebra::{DMatrix, DVector};

use super::Mechanism;
use crate::fitting::Fitting;

impl Mechanism {
    /// Notes which axes have springs.
    pub(super) fn find_springs(&mut self, fittings: &[Fitting]) {
        let sprung = |joint: Option<usize>| joint.is_some_and(|joint| fittings[joint].spring != 0.0);
        self.room.sprung.clear();
        self.room.sprung.extend(self.axes.iter().map(|(_, joint)| sprung(*joint)));
    }

    /// Where the spring of an axis is taken: half way at the velocity that it has, where it has one.
    pub(super) fn spring_at(&self, axis: usize, dt_s: f64) -> f64 {
        let q = self.now.q[self.axes[axis].0];
        if self.room.sprung[axis] { q + 0.5 * dt_s * self.now.v[axis] } else { q }
    }

    /// The inverse of the matrix of a sub-step: masses, and what springs and dampers add to them.
    pub(super) fn stiffen(&mut self, dt_s: f64, fittings: &[Fitting]) {
        let Self { room, axes, .. } = self;
        room.stiff.copy_from(&room.inverse);
        room.added.clear();
        room.added.resize(axes.len(), 0.0);
        for (axis, (_, joint)) in axes.iter().enumerate() {
            let Some(joint) = joint.filter(|_| room.sprung[axis]) else { continue };
            let share = if room.exact[axis] { 1.0 } else { 0.5 };
            let added = share * dt_s * (0.5 * dt_s * fittings[joint].spring + room.viscous[axis]);
            room.column.copy_from(&room.stiff.column(axis));
            room.added[axis] = added;
            add_mass(&mut room.stiff, axis, &room.column, added);
        }
    }

    /// How fast an axis goes through a sub-step, of which it has these velocities at both ends: by their mean.
    ///
    /// In a sub-step in which it turns round or stops, friction brakes the way back, and its impulse does work on the way
    /// that the mean still goes on: spring and weight would gain that. There the axis goes less far. Along its way the
    /// energy of both is convex, so a part of the way takes no more than that part of it.
    pub(super) fn through(&self, axis: usize, [before, after]: [f64; 2], dt_s: f64, fitting: &Fitting) -> f64 {
        let mean = 0.5 * (before + after);
        let braked: f64 = self.rows.all.iter().filter(|row| row.on == axis).map(|row| row.impulse).sum();
        let gained = braked * mean;
        if gained <= 0.0 {
            return mean;
        }
        let half_way = self.now.q[self.axes[axis].0] - fitting.rest + 0.5 * dt_s * mean;
        // weight and counterweight take their part of it, too
        let steady = self.moving.bias[axis] - fitting.balance;
        let taken = (fitting.spring * half_way + steady) * dt_s * mean;
        if gained < taken { mean * (1.0 - gained / taken) } else { 0.0 }
    }
}

/// Adds a mass to one coordinate, in the inverse of the matrix, of which its column is given (Sherman and
/// Morrison).
fn add_mass(inverse: &mut DMatrix<f64>, axis: usize, column: &DVector<f64>, added: f64) {
    let factor = added / (1.0 + added * column[axis]);
    inverse.ger(-factor, column, column, 1.0);
}

#[cfg(test)]
mod tests {
    use onescan_server::time::TimeSpan;
    use proptest::prelude::*;

    use super::*;
    use crate::effort::{Mark, Nobody};
    use crate::scene::Scene;
    use crate::world::World;

    #[test]
    fn a_mass_that_is_added_is_in_the_inverse() {
        // [[2, 1], [1, 3]] and 4 more on the second: [[2, 1], [1, 7]]
        let mut inverse = DMatrix::from_row_slice(2, 2, &[0.6, -0.2, -0.2, 0.4]);
        add_mass(&mut inverse, 1, &DVector::from_vec(vec![-0.2, 0.4]), 4.0);
        for (entry, exact) in inverse.iter().zip([7.0, -1.0, -1.0, 2.0]) {
            assert!((entry - exact / 13.0).abs() < 1e-15, "{inverse:?}");
        }
    }

    /// A mass on a spring, let go at `from_m`, and what brakes it.
    #[derive(Debug)]
    struct Swing {
        mass_kg: f64,
        spring_n_m: f64,
        from_m: f64,
        brakes: String,
        stop_m: Option<f64>,
        period_us: u64,
    }

    impl Swing {
        fn scene(&self) -> Scene {
            let Self { mass_kg, spring_n_m, from_m, brakes, stop_m, .. } = self;
            let stop = stop_m.map_or_else(String::new, |stop_m| format!("lower_m = {stop_m:?}"));
            let text = format!(
                "version = 1\n[[body]]\nname = \"mass\"\nkind = \"dynamic\"\nshape = \"sphere\"\nradius_m = 0.1\n\
                 mass_kg = {mass_kg:?}\nposition_m = [{from_m:?}, 0.0, 0.0]\n\
                 [[joint]]\nname = \"slide\"\nkind = \"prismatic\"\nparent = \"ground\"\nchild = \"mass\"\n\
                 axis = [1.0, 0.0, 0.0]\ninitial_m = {from_m:?}\n{stop}\n\
                 [[fitting]]\nname = \"spring\"\njoint = \"slide\"\nspring_n_m = {spring_n_m:?}\n{brakes}\n"
            );
            Scene::parse(&text, "swing.toml").unwrap_or_else(|error| panic!("{error}"))
        }

        /// The energy after each step, J.
        fn energies(&self, steps: u32) -> Vec<f64> {
            let scene = self.scene();
            let mut world = World::build(&scene, TimeSpan::from_micros(self.period_us).expect("not zero"));
            world.find_mechanisms();
            let energy = |world: &World| {
                let Mark { position, velocity } = world.motion(0);
                0.5 * (self.mass_kg * velocity * velocity + self.spring_n_m * position * position)
            };
            let mut energies = vec![energy(&world)];
            for _ in 0..steps {
                world.step(&scene, &mut Nobody).expect("it stays in the world");
                energies.push(energy(&world));
            }
            energies
        }
    }

    fn brakes() -> impl Strategy<Value = String> {
        let dry = prop_oneof![Just(0.0), (-6.0..2.0_f64).prop_map(|exponent| 10.0_f64.powf(exponent))];
        let viscous = prop_oneof![Just(0.0), (-3.0..4.0_f64).prop_map(|exponent| 10.0_f64.powf(exponent))];
        (dry, viscous).prop_map(|(dry, viscous)| format!("friction_n = {dry:?}\ndamping_n_s_m = {viscous:?}"))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn springs_never_gain_energy(
            (mass, spring) in (-2.0..3.0_f64, 0.0..6.0_f64),
            from_m in 0.001..0.1_f64,
            brakes in brakes(),
            stop in proptest::option::of(-1.0..1.0_f64),
            period_us in 100..10_000_u64,
        ) {
            let (mass_kg, spring_n_m) = (10.0_f64.powf(mass), 10.0_f64.powf(spring));
            let swing = Swing { mass_kg, spring_n_m, from_m, brakes, stop_m: stop.map(|part| part * from_m), period_us };
            let energies = swing.energies(300);
            for (step, pair) in energies.windows(2).enumerate() {
                // roundings of a sub-step, of which there are some
                prop_assert!(pair[1] <= pair[0] + 1e-11 * energies[0], "step {step}: {} {}", pair[0], pair[1]);
            }
        }
    }
}
