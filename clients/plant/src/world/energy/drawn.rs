//! Random mechanisms: trees and loops of bodies on joints, with all that is fitted to joints and couples them, and no
//! drive.

use std::fmt::Write as _;

use onescan_server::random::Random;

/// A scene, and in which steps brakes are released.
#[derive(Debug)]
pub(super) struct Drawn {
    pub(super) text: String,
    pub(super) period_us: u64,
    /// For each joint the steps from which on its brake is released, and applied again.
    pub(super) released: Vec<[u32; 2]>,
    /// Whether its masses are the same in every pose.
    pub(super) steady: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Prismatic,
    Revolute,
    Fixed,
    Ball,
    Slot,
}

/// What is drawn from.
struct Draws {
    random: Random,
    text: String,
    /// Where the bodies are.
    places: Vec<[f64; 3]>,
    kinds: Vec<Kind>,
    released: Vec<[u32; 2]>,
    steady: bool,
}

/// The mechanism of a seed, for so many steps of one of these periods.
pub(super) fn drawn(seed: u64, periods_us: [u64; 4], steps: u32) -> Drawn {
    let mut draws = Draws {
        random: Random::new(seed),
        text: String::new(),
        places: Vec::new(),
        kinds: Vec::new(),
        released: Vec::new(),
        steady: true,
    };
    let period_us = periods_us[draws.below(4)];
    draws.text += "version = 1\nextent_m = 1e6\n";
    if draws.is(0.2) {
        draws.text += "gravity_m_s2 = [0.0, 0.0, 0.0]\n";
    }
    let bodies = 1 + draws.below(5);
    for body in 0..bodies {
        draws.body(body);
        let parent = if body == 0 || draws.is(0.2) { None } else { Some(draws.below(body)) };
        draws.joint(parent, body, steps);
    }
    if bodies > 1 && draws.is(0.15) {
        let parent = draws.below(bodies - 1);
        let parent = if draws.is(0.5) { None } else { Some(parent) };
        draws.joint(parent, bodies - 1, steps);
    } else if draws.is(0.4) {
        draws.couplings();
    }
    Drawn { text: draws.text, period_us, released: draws.released, steady: draws.steady }
}

impl Draws {
    fn below(&mut self, count: usize) -> usize {
        (self.random.bits() % count as u64) as usize
    }

    fn is(&mut self, part: f64) -> bool {
        self.random.uniform() <= part
    }

    fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.random.uniform()
    }

    /// A size between two powers of ten.
    fn size(&mut self, from: f64, to: f64) -> f64 {
        libm::pow(10.0, self.between(from, to))
    }

    fn vector(&mut self, most: f64) -> [f64; 3] {
        [(); 3].map(|()| self.between(-most, most))
    }

    fn line(&mut self, line: std::fmt::Arguments<'_>) {
        self.text.write_fmt(line).expect("a text takes all that is written to it");
        self.text.push('\n');
    }

    fn body(&mut self, body: usize) {
        let near = match self.places.last() {
            Some(last) if self.random.uniform() < 0.7 => *last,
            _ => [0.0; 3],
        };
        let away = self.vector(0.6);
        let place = [0, 1, 2].map(|k| near[k] + away[k]);
        self.places.push(place);
        let (mass, turn) = (self.size(-0.5, 1.0), self.vector(180.0));
        let shape = match self.below(3) {
            0 => format!("shape = \"sphere\"\nradius_m = {:?}", self.size(-1.5, -0.5)),
            1 => {
                let size = [(); 3].map(|()| self.size(-1.5, 0.0));
                format!("shape = \"box\"\nsize_m = {size:?}")
            }
            _ => format!(
                "shape = \"cylinder\"\nradius_m = {:?}\nlength_m = {:?}",
                self.size(-1.5, -0.5),
                self.size(-1.0, 0.0)
            ),
        };
        self.line(format_args!(
            "[[body]]\nname = \"b{body}\"\nkind = \"dynamic\"\n{shape}\nmass_kg = {mass:?}\nposition_m = {place:?}\n\
             rpy_deg = {turn:?}\ncollides = false"
        ));
        if self.is(0.5) {
            let velocity = self.vector(2.0);
            self.line(format_args!("velocity_m_s = {velocity:?}"));
        }
    }

    fn joint(&mut self, parent: Option<usize>, child: usize, steps: u32) {
        let kind = match self.random.uniform() {
            part if part < 0.3 => Kind::Prismatic,
            part if part < 0.75 => Kind::Revolute,
            part if part < 0.85 => Kind::Fixed,
            part if part < 0.95 => Kind::Ball,
            _ => Kind::Slot,
        };
        let joint = self.kinds.len();
        self.kinds.push(kind);
        self.steady &= matches!(kind, Kind::Prismatic | Kind::Fixed);
        let name = match kind {
            Kind::Prismatic => "prismatic",
            Kind::Revolute => "revolute",
            Kind::Fixed => "fixed",
            Kind::Ball => "ball",
            Kind::Slot => "slot",
        };
        let parent = parent.map_or_else(|| "ground".to_owned(), |parent| format!("b{parent}"));
        let (offset, place) = (self.vector(0.5), self.places[child]);
        let anchor = [0, 1, 2].map(|k| place[k] + offset[k]);
        self.line(format_args!(
            "[[joint]]\nname = \"j{joint}\"\nkind = \"{name}\"\nparent = \"{parent}\"\nchild = \"b{child}\"\nanchor_m = {anchor:?}"
        ));
        let which = self.below(3);
        let along = [0, 1, 2].map(|k| if k == which { 1.0 } else { 0.0 });
        let across = [along[2], along[0], along[1]];
        match kind {
            Kind::Slot => self.line(format_args!("axis = {along:?}\nslide = {across:?}")),
            Kind::Prismatic | Kind::Revolute if self.is(0.5) => {
                let axis = self.vector(1.0);
                self.line(format_args!("axis = {axis:?}"));
            }
            Kind::Prismatic | Kind::Revolute => self.line(format_args!("axis = {along:?}")),
            Kind::Fixed | Kind::Ball => {}
        }
        if matches!(kind, Kind::Prismatic | Kind::Revolute) {
            self.fit(joint, kind, steps);
        } else {
            self.released.push([0; 2]);
        }
    }

    /// Stops of a joint, and what is fitted to it.
    fn fit(&mut self, joint: usize, kind: Kind, steps: u32) {
        let turns = kind == Kind::Revolute;
        let unit = if turns { "rad" } else { "m" };
        let stops = [("lower", -1.0), ("upper", 1.0)].map(|(stop, sign)| (stop, sign * self.size(-2.0, 0.3)));
        // a joint that turns has both stops or none
        let [lower, upper] = if turns { [self.is(0.3); 2] } else { [self.is(0.2), self.is(0.2)] };
        for ((stop, at), has) in stops.into_iter().zip([lower, upper]) {
            if has {
                self.line(format_args!("{stop}_{unit} = {at:?}"));
            }
        }
        let released = [0, 1].map(|_| self.below(steps as usize) as u32);
        self.released.push(released);
        if self.is(0.4) {
            return;
        }
        let (force, spring, damping, speed) =
            if turns { ("nm", "nm_rad", "nm_s_rad", "rad_s") } else { ("n", "n_m", "n_s_m", "m_s") };
        self.line(format_args!("[[fitting]]\nname = \"f{joint}\"\njoint = \"j{joint}\""));
        if self.is(0.5) {
            let (stiff, rest) = (self.size(0.0, 4.0), self.between(-0.3, 0.3));
            self.line(format_args!("spring_{spring} = {stiff:?}\nrest_{unit} = {rest:?}"));
        }
        if self.is(0.3) {
            let viscous = self.size(-2.0, 3.0);
            self.line(format_args!("damping_{damping} = {viscous:?}"));
        }
        if self.is(0.4) {
            let dry = self.size(-2.0, 2.0);
            self.line(format_args!("friction_{force} = {dry:?}"));
            if self.is(0.5) {
                let (rest, within) = (dry * self.between(1.0, 3.0), self.size(-3.0, 0.0));
                self.line(format_args!("stiction_{force} = {rest:?}\nstribeck_{speed} = {within:?}"));
            }
        }
        if self.is(0.3) {
            let constant = self.between(-100.0, 100.0);
            self.line(format_args!("balance_{force} = {constant:?}"));
        }
        if self.is(0.3) {
            let held = self.size(-1.0, 3.0);
            self.line(format_args!("brake_{force} = {held:?}"));
        }
    }

    /// Gears, differentials, cams and what slips, between any joints; each is led once, by joints before it.
    fn couplings(&mut self) {
        let movable = |kind: &Kind| matches!(kind, Kind::Prismatic | Kind::Revolute);
        let free: Vec<usize> = (0..self.kinds.len()).filter(|joint| movable(&self.kinds[*joint])).collect();
        for (at, joint) in free.iter().enumerate().skip(1) {
            if !self.is(0.6) {
                continue;
            }
            let leader = free[self.below(at)];
            let other = free[self.below(at)];
            self.line(format_args!("[[coupling]]\nname = \"c{joint}\"\njoint = \"j{joint}\""));
            let ratio = [(); 2].map(|()| self.size(-1.0, 0.7) * if self.is(0.5) { -1.0 } else { 1.0 });
            let unit = if self.kinds[*joint] == Kind::Revolute { "rad" } else { "m" };
            match self.below(4) {
                0 if leader != other => {
                    self.line(format_args!("of = [\"j{leader}\", \"j{other}\"]\nratio = {ratio:?}"));
                }
                1 => {
                    let points =
                        [-1.0, -0.4, 0.0, 0.9].map(|x| [x, if x == 0.0 { 0.0 } else { self.between(-0.3, 0.3) }]);
                    // what it leads weighs as much as the curve is steep
                    self.steady = false;
                    self.line(format_args!("of = [\"j{leader}\"]\ncam = {points:?}"));
                }
                2 => {
                    let (play, slips) = (self.size(-4.0, -1.0), self.size(-1.0, 2.0));
                    self.line(format_args!("of = [\"j{leader}\"]\nratio = [{:?}]", ratio[0]));
                    if self.is(0.5) {
                        // a flank stops it where it is to be, by which it gains or loses some
                        self.steady = false;
                        self.line(format_args!("backlash_{unit} = {play:?}"));
                    } else {
                        let force = if unit == "rad" { "nm" } else { "n" };
                        self.line(format_args!("slip_{force} = {slips:?}"));
                    }
                }
                _ => self.line(format_args!("of = [\"j{leader}\"]\nratio = [{:?}]", ratio[0])),
            }
        }
    }
}
