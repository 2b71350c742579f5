//! The law that what nothing drives gains no energy, or no more than the method of its step lets it (`docs/plant.md`,
//! *accuracy*). `ONESCAN_MECHANISMS` says how many are drawn; `ONESCAN_MECHANISM` shows the scene of one seed.

mod drawn;

use onescan_server::time::TimeSpan;

use super::World;
use crate::effort::Nobody;
use crate::fitting::Fitting;
use crate::scene::Scene;
use drawn::drawn;

/// Mechanisms that are tried where `ONESCAN_MECHANISMS` says nothing.
const COUNT: u64 = 400;
const STEPS: u32 = 200;
const PERIODS_US: [u64; 4] = [100, 1_000, 5_000, 10_000];
/// What rounding leaves of the energy in all steps.
const ROUNDING: f64 = 1e-12;

/// By which method a mechanism is moved, and so what it may gain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Method {
    /// By one of the next two, and its masses are the same in every pose: it only slides.
    Steady,
    /// Runge-Kutta.
    Smooth,
    /// By momentum, in sub-steps with friction and stops.
    Driven,
}

/// The energy of a world, J: what all have, and how much there is of each part of it.
struct Energy {
    all: f64,
    amount: f64,
}

impl Energy {
    fn of(world: &World) -> Self {
        let (mut all, mut amount) = (0.0, 0.0);
        for body in world.bodies().filter(|body| body.is_dynamic()) {
            let local = body.mass_properties().local_mprops;
            let frame = body.position().rotation * local.principal_inertia_local_frame;
            let turning = frame.inverse() * body.angvel();
            let moving = local.mass() * body.linvel().length_squared();
            let kinetic = 0.5 * (moving + (local.principal_inertia() * turning).dot(turning));
            let centre = *body.position() * local.local_com;
            all += kinetic - local.mass() * world.gravity().dot(centre);
            // its weight over a metre: what is at rest has roundings, too
            amount += kinetic + local.mass() * world.gravity().length();
        }
        for (joint, fitting) in world.articulation.fittings.iter().enumerate() {
            let (spring, balance) = fitting.energy(world.motion(joint).position - fitting.initial);
            all += spring - balance;
            amount += spring + balance.abs();
        }
        Self { all, amount }
    }
}

/// How a mechanism of a seed went.
struct Run {
    seed: u64,
    period_us: u64,
    method: Method,
    /// The most that its energy rose above the least that it had had, as a part of it.
    gained: f64,
}

impl Run {
    fn of(seed: u64) -> Self {
        let drawn = drawn(seed, PERIODS_US, STEPS);
        let scene = Scene::parse(&drawn.text, "drawn.toml").unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        let mut world = World::build(&scene, TimeSpan::from_micros(drawn.period_us).expect("not zero"));
        world.find_mechanisms();
        let smooth = world.articulation.fittings.iter().all(Fitting::is_smooth);
        let left = world.articulation.unmoved(&world.physics.bodies).count();
        assert_eq!(left, 0, "seed {seed}: the engine moves {left} joints");
        let method = if drawn.steady {
            Method::Steady
        } else if smooth && scene.couplings.is_empty() {
            Method::Smooth
        } else {
            Method::Driven
        };
        let (mut least, mut rose, mut amount) = (f64::INFINITY, 0.0_f64, 0.0_f64);
        for step in 0..STEPS {
            for (joint, [from, to]) in drawn.released.iter().enumerate() {
                let released = if from < to { (*from..*to).contains(&step) } else { !(*to..*from).contains(&step) };
                world.articulation.fittings[joint].set_brake(released);
            }
            world.step(&scene, &mut Nobody).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
            let now = Energy::of(&world);
            least = least.min(now.all);
            rose = rose.max(now.all - least);
            amount = amount.max(now.amount);
        }
        let gained = if amount > 0.0 { rose / amount } else { 0.0 };
        Self { seed, period_us: drawn.period_us, method, gained }
    }
}

/// What of the mechanisms of a method may gain more than a part of their energy in all steps: that part, and the share
/// of them that may.
fn bound(method: Method, period_us: u64, time_s: f64) -> (f64, f64) {
    match (method, period_us) {
        // the few are chains in which friction stops one joint while others go on
        (Method::Steady, _) => (1e-9 * time_s + ROUNDING, 0.01),
        (Method::Smooth | Method::Driven, 100) => (1e-4, 0.0),
        (Method::Smooth | Method::Driven, _) => (1e-2, 0.0),
    }
}

/// A number that the environment gives.
fn setting(name: &str) -> Option<u64> {
    let text = std::env::var(name).ok()?;
    Some(text.parse().unwrap_or_else(|error| panic!("{name}: {error}")))
}

/// The seeds of runs that gained the most, and by how much.
fn worst(runs: &[&Run]) -> String {
    runs.iter().take(4).map(|run| format!(" {} {:.0e}", run.seed, run.gained)).collect()
}

#[test]
fn what_nothing_drives_gains_no_energy() {
    if let Some(seed) = setting("ONESCAN_MECHANISM") {
        let run = Run::of(seed);
        print_figures(&format!("{}\n{:?} gained {:e}\n", drawn(seed, PERIODS_US, STEPS).text, run.method, run.gained));
        return;
    }
    let runs: Vec<_> = (0..setting("ONESCAN_MECHANISMS").unwrap_or(COUNT)).map(Run::of).collect();
    let mut broken = String::new();
    for method in [Method::Steady, Method::Smooth, Method::Driven] {
        for period_us in PERIODS_US {
            let mut own: Vec<_> =
                runs.iter().filter(|run| (run.method, run.period_us) == (method, period_us)).collect();
            own.sort_by(|one, other| other.gained.total_cmp(&one.gained));
            let over = |part: f64| own.iter().filter(|run| run.gained > part).count();
            let time_s = period_us as f64 * f64::from(STEPS) * 1e-6;
            let figures = format!(
                "{method:?}, {period_us} µs: {} mechanisms; over 1e-9 a second {}, over 1e-6, 1e-4, 1e-2 {:?}; most{}\n",
                own.len(),
                over(1e-9 * time_s + ROUNDING),
                [1e-6, 1e-4, 1e-2].map(over),
                worst(&own),
            );
            let (part, share) = bound(method, period_us, time_s);
            let holds = over(part) as f64 <= share * own.len() as f64;
            broken += if holds { "" } else { &figures };
            print_figures(&figures);
        }
    }
    assert!(broken.is_empty(), "\n{broken}");
}

/// The figures of docs/deep.md, with `--nocapture`.
#[expect(clippy::print_stdout, reason = "what `cargo test` shows with --nocapture")]
fn print_figures(figures: &str) {
    print!("{figures}");
}
