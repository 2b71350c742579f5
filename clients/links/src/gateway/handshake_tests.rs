use proptest::prelude::*;

use super::*;

/// Steps of a session.
const STEPS: u64 = 5;

/// A PLC with the shim's scheduler, as `plc-shim/iec-project/shim/scheduler.st` has it, and a program that writes down
/// what it ran for.
#[derive(Clone, Debug, Default)]
struct Plc {
    order: Order,
    input: u64,
    joined: u32,
    done: u32,
    answer: i16,
    last: u64,
    is_used: bool,
    boots: u32,
    layout: u32,
    output: u64,
    log: Vec<(u64, u64)>,
}

impl Plc {
    fn cycle(&mut self) {
        let Order { session, limit, t_v, grant, start } = self.order;
        let t_v = t_v.as_nanos();
        if start == self.boots + 1 {
            let log = std::mem::take(&mut self.log);
            *self = Self { boots: start, layout: self.layout, log, ..Self::default() };
            return;
        }
        self.answer = if session != self.joined {
            if session == 0 {
                self.joined = 0;
                0
            } else if self.joined == 0 && !self.is_used {
                (self.is_used, self.joined, self.done, self.last) = (true, session, session, t_v);
                0
            } else {
                6
            }
        } else if self.joined == 0 || grant == self.done {
            0
        } else if grant < self.done {
            2
        } else if grant - self.done > 1 {
            3
        } else if grant > limit {
            4
        } else if t_v <= self.last {
            5
        } else {
            (self.last, self.done) = (t_v, grant);
            self.log.push((t_v, self.input));
            self.output = t_v ^ self.input << 8;
            0
        };
    }

    fn report(&self, is_counting: bool) -> Report {
        Report {
            joined: self.joined,
            done: self.done,
            answer: Answer::from(self.answer),
            layout: self.layout,
            boots: is_counting.then_some(self.boots),
            running: None,
        }
    }
}

/// What happens to a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Luck {
    Good,
    /// The connection breaks before it.
    Before,
    /// It arrives, and the connection breaks behind it.
    After,
    /// It arrives; an order as old as can be arrives once more behind it.
    Echo,
    /// It arrives; the gateway becomes impatient and writes again.
    Quiet,
    /// It arrives, and the PLC does not come to its next cycle before the next message.
    Slow,
}

/// A gateway, a PLC, and a link with this luck, message by message; all good behind the end.
struct World {
    handshake: Handshake,
    plc: Plc,
    luck: std::vec::IntoIter<Luck>,
    messages: usize,
    old: Option<(Order, u64)>,
    is_counting: bool,
    /// Whoever has the PLC starts it when it says that it must be started.
    is_started: bool,
}

impl World {
    fn new(luck: Vec<Luck>) -> Self {
        Self {
            handshake: Handshake::new(),
            plc: Plc::default(),
            luck: luck.into_iter(),
            messages: 0,
            old: None,
            is_counting: false,
            is_started: false,
        }
    }

    fn cycle(&mut self) {
        self.plc.cycle();
        if self.is_started && self.plc.answer == 6 {
            let Plc { layout, boots, ref mut log, .. } = self.plc;
            self.plc = Plc { layout, boots: boots + 1, log: std::mem::take(log), ..Plc::default() };
        }
    }

    /// Until nothing is asked for; the output that was read last.
    fn drive(&mut self, input: u64) -> Result<u64, GatewayFault> {
        let mut output = 0;
        for _ in 0..1_000 {
            let luck = match self.handshake.ask() {
                Ask::Nothing => return Ok(output),
                _ => self.luck.next().unwrap_or(Luck::Good),
            };
            self.messages += 1;
            match self.handshake.ask() {
                _ if luck == Luck::Before => self.handshake.lost(),
                Ask::Nothing => {}
                Ask::Connect => self.handshake.connected(),
                Ask::Write(order) => {
                    (self.plc.order, self.plc.input) = (order, input);
                    self.handshake.written();
                    if luck != Luck::Slow {
                        self.cycle();
                    }
                    if let (Luck::Echo, Some((order, input))) = (luck, self.old) {
                        (self.plc.order, self.plc.input) = (order, input);
                        self.cycle();
                    }
                    self.old.get_or_insert((order, input));
                }
                Ask::Read => {
                    output = self.plc.output;
                    self.handshake.look(self.plc.report(self.is_counting))?;
                    self.cycle();
                }
            }
            match luck {
                Luck::After if self.handshake.ask() != Ask::Nothing => self.handshake.lost(),
                Luck::Quiet => self.handshake.quiet()?,
                // Orders that were overtaken by an old one are written again in the end.
                _ if self.messages.is_multiple_of(7) => self.handshake.quiet()?,
                _ => {}
            }
        }
        panic!("{:?} goes on for ever", self.handshake);
    }

    /// Runs a session; outputs of all steps.
    fn session(&mut self) -> Result<Vec<u64>, GatewayFault> {
        self.handshake.join(VirtualTime::ZERO);
        self.drive(0)?;
        let step = |k: u64| -> Result<u64, GatewayFault> {
            self.handshake.grant(VirtualTime::from_nanos(k * 10))?;
            self.drive(k + 100)
        };
        (1..=STEPS).map(step).collect()
    }
}

fn expected() -> (Vec<(u64, u64)>, Vec<u64>) {
    let steps = 1..=STEPS;
    (steps.clone().map(|k| (k * 10, k + 100)).collect(), steps.map(|k| (k * 10) ^ ((k + 100) << 8)).collect())
}

#[test]
fn every_step_is_run_once_wherever_the_link_is_cut() {
    let mut undisturbed = World::new(Vec::new());
    let (log, outputs) = expected();
    assert_eq!(undisturbed.session().unwrap(), outputs);
    assert_eq!(undisturbed.plc.log, log);
    for first in 0..undisturbed.messages {
        for second in 0..=undisturbed.messages {
            for (a, b) in [(Luck::Before, Luck::After), (Luck::After, Luck::Before), (Luck::After, Luck::Echo)] {
                let mut luck = vec![Luck::Good; first + second + 2];
                (luck[first], luck[first + 1 + second]) = (a, b);
                let mut world = World::new(luck);
                assert_eq!(world.session().unwrap(), outputs, "cut at {first} and {second} after it, {a:?} {b:?}");
                assert_eq!(world.plc.log, log, "cut at {first} and {second} after it, {a:?} {b:?}");
            }
        }
    }
}

#[test]
fn a_restart_in_mid_session_ends_it_wherever_it_comes() {
    for is_counting in [false, true] {
        for at in 1..=STEPS {
            let mut world = World::new(Vec::new());
            world.is_counting = is_counting;
            world.handshake.join(VirtualTime::ZERO);
            world.drive(0).unwrap();
            for k in 1..at {
                world.handshake.grant(VirtualTime::from_nanos(k * 10)).unwrap();
                world.drive(k + 100).unwrap();
            }
            let log = world.plc.log.clone();
            world.plc = Plc { boots: world.plc.boots + 1, log: log.clone(), ..Plc::default() };
            world.handshake.grant(VirtualTime::from_nanos(at * 10)).unwrap();
            let fault = world.drive(0).unwrap_err();
            assert!(matches!(fault, GatewayFault::Restarted { .. }), "{fault}");
            assert_eq!(world.plc.log, log, "a step was run by a PLC that has just been started");
        }
    }
}

#[test]
fn the_next_session_begins_with_a_cold_start() {
    let (log, outputs) = expected();
    let mut world = World::new(Vec::new());
    world.is_counting = true;
    for session in 1..=3 {
        assert_eq!(world.session().unwrap(), outputs);
        assert_eq!(std::mem::take(&mut world.plc.log), log);
        assert_eq!(world.plc.boots, session - 1);
    }
    // A PLC that is started by hand is waited for, once it has said that it must be.
    world.is_counting = false;
    world.handshake.join(VirtualTime::ZERO);
    for _ in 0..10 {
        assert_eq!(world.handshake.ask(), Ask::Read);
        world.handshake.look(world.plc.report(false)).unwrap();
    }
    assert_eq!(world.handshake.take_notice(), None);
    world.handshake.quiet().unwrap();
    assert_eq!(world.handshake.ask(), Ask::Read, "it may just have been found");
    world.handshake.quiet().unwrap();
    let Ask::Write(order) = world.handshake.ask() else { panic!("{:?}", world.handshake) };
    world.plc.order = order;
    world.handshake.written();
    for _ in 0..10 {
        world.handshake.look(world.plc.report(false)).unwrap();
        assert_eq!(world.handshake.ask(), Ask::Read);
        world.plc.cycle();
    }
    assert_eq!(world.handshake.take_notice(), Some(Notice::StartPlc));
    assert_eq!(world.handshake.take_notice(), None);
    assert_eq!(world.handshake.late(std::time::Duration::ZERO), GatewayFault::MustBeStarted);
    world.plc = Plc::default();
    world.drive(0).unwrap();
    assert_ne!(world.plc.joined, 0);
}

/// Without words about itself, too: its program says that it must be started, and whoever has it starts it then.
#[test]
fn a_plc_that_is_started_when_it_says_so_takes_part_in_the_next_session() {
    let (log, outputs) = expected();
    let mut world = World::new(Vec::new());
    world.is_started = true;
    for session in 1..=3 {
        // Each with another gateway.
        world.handshake = Handshake::new();
        assert_eq!(world.session().unwrap(), outputs);
        assert_eq!(std::mem::take(&mut world.plc.log), log);
        assert_eq!((world.plc.boots, world.handshake.take_notice()), (session - 1, None));
    }
}

/// One that keeps what was written over its start joins by itself.
#[test]
fn a_plc_that_keeps_its_words_over_a_start_has_joined() {
    let mut world = World::new(Vec::new());
    world.session().unwrap();
    world.handshake = Handshake::new();
    world.handshake.join(VirtualTime::ZERO);
    while world.plc.answer != 6 {
        match world.handshake.ask() {
            Ask::Connect => world.handshake.connected(),
            Ask::Write(order) => {
                world.plc.order = order;
                world.handshake.written();
            }
            Ask::Read => world.handshake.look(world.plc.report(false)).unwrap(),
            Ask::Nothing => panic!("{:?}", world.handshake),
        }
        world.plc.cycle();
        world.handshake.quiet().unwrap();
    }
    world.plc = Plc { order: world.plc.order, ..Plc::default() };
    world.drive(0).unwrap();
    assert_eq!(world.plc.joined, world.plc.order.session);
}

/// While another gateway's grants are run, nothing is written.
#[test]
fn a_plc_that_runs_somebody_elses_grants_is_left_alone() {
    let mut world = World::new(Vec::new());
    world.session().unwrap();
    let mut intruder = Handshake::new();
    intruder.connected();
    intruder.join(VirtualTime::ZERO);
    intruder.look(world.plc.report(false)).unwrap();
    intruder.quiet().unwrap();
    world.handshake.grant(VirtualTime::from_nanos(1_000)).unwrap();
    world.drive(0).unwrap();
    assert_eq!(intruder.ask(), Ask::Read);
    assert_eq!(intruder.look(world.plc.report(false)), Err(GatewayFault::InUse { joined: 1 }));
}

/// A report that cannot be in the middle of a session, and the name of what is wrong.
#[test]
fn what_a_plc_may_say_has_a_name() {
    let reported = |change: &dyn Fn(&mut Report)| {
        let mut world = World::new(Vec::new());
        world.handshake.join(VirtualTime::ZERO);
        world.drive(0).unwrap();
        world.handshake.grant(VirtualTime::from_nanos(10)).unwrap();
        world.handshake.written();
        let mut report = world.plc.report(false);
        change(&mut report);
        let seconds = std::time::Duration::from_secs(5);
        let fault = world.handshake.look(report).err().unwrap_or_else(|| world.handshake.late(seconds));
        fault.to_string()
    };
    let all = [
        reported(&|report| report.running = Some(false)),
        reported(&|report| report.joined = 0),
        reported(&|report| (report.joined, report.answer) = (0, Answer::NotSimulated)),
        reported(&|report| report.joined = 9),
        reported(&|report| report.done = 40),
        reported(&|report| report.done = 0),
        reported(&|_| {}),
        reported(&|report| report.answer = Answer::Running),
        reported(&|report| report.answer = Answer::OldGrant),
        reported(&|report| report.answer = Answer::Held),
        reported(&|report| report.answer = Answer::Other(77)),
    ];
    insta::assert_snapshot!(all.join("\n"));
}

#[test]
fn a_program_that_was_made_for_another_mapping_is_found_before_the_first_step() {
    let join = |expected, found| {
        let mut world = World::new(Vec::new());
        world.handshake = Handshake::new().expecting(expected);
        world.plc.layout = found;
        world.handshake.join(VirtualTime::ZERO);
        let joined = world.drive(0).map(|_| world.handshake.take_notice());
        assert_eq!(world.plc.log, []);
        (joined, world.plc.joined)
    };
    assert_eq!(join(Some(7), 7), (Ok(None), 1));
    assert_eq!(join(Some(7), 8), (Err(GatewayFault::OtherLayout { expected: 7, found: 8 }), 0));
    // Neither a program without a number nor a scenario without one can be compared.
    assert_eq!(join(Some(7), 0), (Ok(Some(Notice::NoLayout)), 1));
    assert_eq!(join(None, 8), (Ok(None), 1));
}

#[test]
fn a_program_without_a_number_is_reported_once() {
    let mut world = World::new(Vec::new());
    world.is_counting = true;
    world.handshake = Handshake::new().expecting(Some(7));
    world.session().unwrap();
    assert_eq!(world.handshake.take_notice(), Some(Notice::NoLayout));
    world.session().unwrap();
    assert_eq!(world.handshake.take_notice(), None);
}

fn luck() -> impl Strategy<Value = Luck> {
    prop_oneof![
        4 => Just(Luck::Good),
        1 => Just(Luck::Before),
        1 => Just(Luck::After),
        1 => Just(Luck::Echo),
        1 => Just(Luck::Quiet),
        1 => Just(Luck::Slow),
    ]
}

proptest! {
    #[test]
    fn no_step_is_run_twice_or_skipped_on_any_link(luck in prop::collection::vec(luck(), 0..80)) {
        let (log, outputs) = expected();
        let mut world = World::new(luck);
        prop_assert_eq!(world.session().unwrap(), outputs);
        prop_assert_eq!(world.plc.log, log);
    }

    /// Whatever words a PLC shows, there is an answer and no panic.
    #[test]
    fn nonsense_is_survived(words in prop::collection::vec((any::<u32>(), any::<u32>(), any::<i16>(), any::<Option<u32>>()), 1..20)) {
        let mut handshake = Handshake::new();
        handshake.connected();
        for (k, (joined, done, answer, boots)) in words.into_iter().enumerate() {
            match handshake.ask() {
                Ask::Connect => handshake.connected(),
                Ask::Write(_) => handshake.written(),
                Ask::Read => drop(handshake.quiet()),
                Ask::Nothing => drop(handshake.grant(VirtualTime::from_nanos(k as u64 + 1))),
            }
            let report = Report { joined, done, answer: answer.into(), layout: 0, boots, running: None };
            if handshake.look(report).is_err() {
                handshake.join(VirtualTime::ZERO);
            }
        }
    }
}
