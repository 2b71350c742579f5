//! A test bench: drives one client turn by turn, without a session around it.

use onescan_plant::Plant;
use onescan_server::client::{Client, ClientFault};
use onescan_server::signal::{ClientName, PortLayout, SlotType};
use onescan_server::time::{TimeSpan, VirtualTime};

/// The period of all tests that do not ask for another.
pub(crate) const PERIOD: TimeSpan = TimeSpan::from_millis(10).expect("not zero");

/// A plant with its inputs and outputs.
pub(crate) struct Bench {
    pub(crate) plant: Plant,
    pub(crate) reads: PortLayout,
    pub(crate) writes: PortLayout,
    pub(crate) inputs: Vec<u8>,
    pub(crate) outputs: Vec<u8>,
    pub(crate) t_v: VirtualTime,
    period: TimeSpan,
}

impl Bench {
    pub(crate) fn new(scene: &str) -> Self {
        Self::with_period(scene, PERIOD)
    }

    pub(crate) fn with_period(scene: &str, period: TimeSpan) -> Self {
        let name = ClientName::new("plant").expect("a name");
        let plant = Plant::parse(scene, "scene.toml", name, period).unwrap_or_else(|error| panic!("{error}"));
        Self::of(plant, period)
    }

    pub(crate) fn of(plant: Plant, period: TimeSpan) -> Self {
        let join = plant.join();
        let (reads, writes) = (PortLayout::new(join.reads), PortLayout::new(join.writes));
        let (inputs, outputs) = (vec![0; reads.size()], vec![0; writes.size()]);
        let mut bench = Self { plant, reads, writes, inputs, outputs, t_v: VirtualTime::ZERO, period };
        bench.set_up();
        bench
    }

    /// The same with a period in microseconds.
    pub(crate) fn at_us(scene: &str, period_us: u64) -> Self {
        Self::with_period(scene, TimeSpan::from_micros(period_us).expect("not zero"))
    }

    /// Turns for so long.
    pub(crate) fn run_us(&mut self, time_us: u64) {
        for _ in 0..time_us * 1000 / self.period.as_nanos() {
            self.turn();
        }
    }

    /// Sets the plant up, again if need be; inputs and outputs begin at zero.
    pub(crate) fn set_up(&mut self) {
        self.inputs.fill(0);
        self.outputs.fill(0);
        self.t_v = VirtualTime::ZERO;
        self.plant.setup(&mut self.outputs).expect("a set-up");
    }

    pub(crate) fn command<V: SlotType>(&mut self, signal: &str, value: V) {
        self.reads.slot::<V>(signal).expect("an input").set(&mut self.inputs, value);
    }

    pub(crate) fn read<V: SlotType>(&self, signal: &str) -> V {
        self.writes.slot::<V>(signal).expect("an output").get(&self.outputs)
    }

    pub(crate) fn try_turn(&mut self) -> Result<(), ClientFault> {
        self.t_v = self.t_v + self.period;
        self.plant.turn(self.t_v, &self.inputs, &mut self.outputs).map(|_| ())
    }

    pub(crate) fn turn(&mut self) {
        self.try_turn().expect("a turn");
    }
}
