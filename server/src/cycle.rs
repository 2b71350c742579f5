//! The barrier: server and client states, virtual time, delays. No values, no clock, no wire.
//!
//! A state is left only when `synchronize = AND(client_i.sync)` holds, with
//! `client_i.sync = ready_i OR t_delay_i > t_v` (`[SDSP]` sec. IV). `t_delay_i` is kept as the
//! virtual time of the client's next turn ([`Cycle::wake`]); a client takes part in a step if that
//! time has come, and otherwise sleeps through it in its last state without losing synchrony.
//!
//! With [`Coupling::Parallel`] every client due takes its turn in one pass through pre-read to write.
//! With [`Coupling::Sequential`] a step is one such pass for each client in the listed order.

use crate::client::ClientId;
use crate::plan::Coupling;
use crate::state::{ClientState, ServerState};
use crate::time::{StepCount, TimeSpan, VirtualTime};

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Seat {
    state: ClientState,
    /// The ready signal: done with what `state` asks for.
    ready: bool,
    /// Takes part in this pass; `NOT t_delay > t_v`.
    due: bool,
    /// Virtual time of the next turn, `t_delay`.
    wake: VirtualTime,
    /// The next turn as asked for in the turn under way; in force from its commit on, as its outputs.
    asked: VirtualTime,
}

/// The state machine of a session.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Cycle {
    step: TimeSpan,
    coupling: Coupling<ClientId>,
    server: ServerState,
    t_v: VirtualTime,
    steps: StepCount,
    /// Which pass of the step is under way; always 0 in parallel coupling.
    pass: usize,
    seats: Vec<Seat>,
}

impl Cycle {
    /// A session in `start` with `clients` seats, nobody ready.
    pub fn new(step: TimeSpan, coupling: Coupling<ClientId>, clients: usize) -> Self {
        debug_assert!(
            !matches!(&coupling, Coupling::Sequential { order } if order.iter().any(|client| client.index() >= clients)),
            "a sequential order lists clients of the session only"
        );
        let seat = Seat {
            state: ClientState::Start,
            ready: false,
            due: true,
            wake: VirtualTime::ZERO,
            asked: VirtualTime::ZERO,
        };
        Self {
            step,
            coupling,
            server: ServerState::Start,
            t_v: VirtualTime::ZERO,
            steps: StepCount(0),
            pass: 0,
            seats: vec![seat; clients],
        }
    }

    /// The server's state.
    pub fn server(&self) -> ServerState {
        self.server
    }

    /// The state of `client`.
    pub fn client(&self, client: ClientId) -> ClientState {
        self.seats[client.index()].state
    }

    /// Virtual time, the end of the step under way from state `read` on.
    pub fn t_v(&self) -> VirtualTime {
        self.t_v
    }

    /// The number of the step under way from state `read` on; 0 before the first.
    pub fn steps(&self) -> StepCount {
        self.steps
    }

    /// The smallest increment of virtual time.
    pub fn step(&self) -> TimeSpan {
        self.step
    }

    /// The pass of the step that is under way, from 0; always 0 in parallel coupling.
    pub fn pass(&self) -> usize {
        self.pass
    }

    /// When `client` takes its next turn.
    pub fn wake(&self, client: ClientId) -> VirtualTime {
        self.seats[client.index()].wake
    }

    /// True while `client` takes part in the pass and has not signalled ready.
    pub fn is_awaited(&self, client: ClientId) -> bool {
        let seat = &self.seats[client.index()];
        seat.due && !seat.ready
    }

    /// True if `client` takes part in the pass under way.
    pub fn is_due(&self, client: ClientId) -> bool {
        self.seats[client.index()].due
    }

    /// The ready signal of `client` for the state it is in.
    pub fn signal_ready(&mut self, client: ClientId) {
        let seat = &mut self.seats[client.index()];
        debug_assert!(seat.due, "only a client that takes part in the pass signals ready");
        seat.ready = true;
    }

    /// Takes the ready signal of `client` back: it has gone before the session began.
    pub fn withdraw_ready(&mut self, client: ClientId) {
        self.seats[client.index()].ready = false;
    }

    /// Asks for a delay of `client` from the commit on: it sleeps through every step before `wake`.
    pub fn sleep_until(&mut self, client: ClientId, wake: VirtualTime) {
        let seat = &mut self.seats[client.index()];
        seat.asked = wake;
        // No `write` lies between the set-up and the first turns, so it is in force at once.
        if seat.state == ClientState::Setup {
            seat.wake = wake;
        }
    }

    /// Ends a delay of `client` with the next step of which it is not decided yet who takes part. A client that takes part
    /// in the step under way says itself when it wants its next turn.
    pub(crate) fn wake_next(&mut self, client: ClientId) {
        let under_way = self.server == ServerState::PreRead;
        let seat = &mut self.seats[client.index()];
        if under_way && seat.due {
            return;
        }
        // Behind the end of virtual time nobody has a turn.
        let steps = if under_way { 2 } else { 1 };
        let next = self.step.times(steps).and_then(|span| self.t_v.checked_add(span)).unwrap_or(VirtualTime::MAX);
        (seat.wake, seat.asked) = (seat.wake.min(next), seat.asked.min(next));
    }

    /// `synchronize = AND(client_i.sync)`.
    pub fn is_synchronised(&self) -> bool {
        self.seats.iter().all(|seat| seat.ready || !seat.due)
    }

    /// True when the state under way is the last of a step and all are done with it: the only
    /// moments at which stop, pause, single step and reset act.
    pub fn is_at_boundary(&self) -> bool {
        let last = match self.server {
            ServerState::InitialWrite => true,
            ServerState::Write => self.pass + 1 == self.passes(),
            _ => false,
        };
        last && self.is_synchronised()
    }

    /// True while the outputs of the step under way are all in the image.
    pub fn ends_step(&self) -> bool {
        self.server == ServerState::Write && self.pass + 1 == self.passes()
    }

    /// Leaves the state if the clients are synchronised, and says which one was entered.
    /// `None` while a client is awaited, or when virtual time can not grow any more.
    pub fn advance(&mut self) -> Option<ServerState> {
        if !self.is_synchronised() {
            return None;
        }
        if self.server == ServerState::Write {
            self.pass = (self.pass + 1) % self.passes();
        }
        let entered = self.server.next();
        match entered {
            ServerState::PreRead => self.call_those_due()?,
            ServerState::Read if self.pass == 0 => {
                self.t_v = self.t_v.checked_add(self.step)?;
                self.steps.0 += 1;
            }
            ServerState::Write => {
                for seat in self.seats.iter_mut().filter(|seat| seat.due) {
                    seat.wake = seat.asked;
                }
            }
            _ => {}
        }
        self.enter(entered);
        Some(entered)
    }

    /// How many whole steps follow from here in which nobody is due; 0 within a step.
    ///
    /// With `client_i.sync = ready_i OR t_delay_i > t_v` true for every client, such a step waits for nobody and changes
    /// nothing but the time.
    pub fn idle_steps(&self) -> u64 {
        if !self.is_at_boundary() {
            return 0;
        }
        let end = self.seats.iter().map(|seat| seat.wake).min().unwrap_or(VirtualTime::MAX);
        whole_steps_before(self.t_v, end, self.step)
    }

    /// Goes through so many steps in which nobody is due at once, at most [`idle_steps`](Self::idle_steps) of them: as
    /// if it had entered all their states. How many they were.
    pub fn pass_over(&mut self, steps: u64) -> u64 {
        let steps = steps.min(self.idle_steps());
        let span = self.step.times(steps).and_then(|span| self.t_v.checked_add(span));
        let Some(t_v) = span.filter(|_| steps > 0) else { return 0 };
        debug_assert!(t_v > self.t_v, "virtual time grows with every step");
        debug_assert!(self.seats.iter().all(|seat| seat.wake > t_v), "nobody is due in a step that is passed over");
        self.t_v = t_v;
        self.steps.0 += steps;
        self.server = ServerState::Write;
        self.pass = self.passes() - 1;
        self.seats.iter_mut().for_each(|seat| seat.due = false);
        debug_assert!(self.is_at_boundary(), "steps are passed over whole");
        steps
    }

    /// Back to initial-write from any state: a reset.
    pub fn restart(&mut self) {
        self.t_v = VirtualTime::ZERO;
        self.steps = StepCount(0);
        self.pass = 0;
        for seat in &mut self.seats {
            seat.due = true;
            (seat.wake, seat.asked) = (VirtualTime::ZERO, VirtualTime::ZERO);
        }
        self.enter(ServerState::InitialWrite);
        debug_assert!(
            self.seats.iter().all(|seat| seat.due && !seat.ready),
            "a reset waits for the set-up of everybody"
        );
    }

    /// Takes up a session at the boundary after step `steps`, with every client asleep until its
    /// turn in `wakes`.
    pub(crate) fn resume_at(&mut self, steps: StepCount, t_v: VirtualTime, wakes: &[VirtualTime]) {
        debug_assert_eq!(wakes.len(), self.seats.len(), "a checkpoint has one delay per client");
        debug_assert!(wakes.iter().all(|wake| *wake > t_v), "at a boundary every turn is yet to come");
        self.steps = steps;
        self.t_v = t_v;
        (self.server, self.pass) = match steps.0 {
            0 => (ServerState::InitialWrite, 0),
            _ => (ServerState::Write, self.passes() - 1),
        };
        for (seat, wake) in self.seats.iter_mut().zip(wakes) {
            *seat = Seat { state: self.server.of_clients(), ready: true, due: false, wake: *wake, asked: *wake };
        }
        debug_assert!(self.is_at_boundary(), "a session is taken up at a step boundary");
    }

    fn passes(&self) -> usize {
        match &self.coupling {
            Coupling::Parallel => 1,
            Coupling::Sequential { order } => order.len().max(1),
        }
    }

    /// Decides who takes part in the pass that begins: those whose delay has run out by the end of
    /// the step, and in sequential coupling only the one whose pass it is.
    fn call_those_due(&mut self) -> Option<()> {
        let end_of_step = if self.pass == 0 { self.t_v.checked_add(self.step)? } else { self.t_v };
        for (index, seat) in self.seats.iter_mut().enumerate() {
            let in_turn = match &self.coupling {
                Coupling::Parallel => true,
                Coupling::Sequential { order } => order.get(self.pass) == Some(&ClientId::from_index(index)),
            };
            seat.due = in_turn && seat.wake <= end_of_step;
        }
        debug_assert!(
            self.coupling == Coupling::Parallel || self.seats.iter().filter(|seat| seat.due).count() <= 1,
            "in sequential coupling one client at most takes part in a pass"
        );
        Some(())
    }

    fn enter(&mut self, server: ServerState) {
        self.server = server;
        for seat in self.seats.iter_mut().filter(|seat| seat.due) {
            seat.state = server.of_clients();
            seat.ready = false;
        }
    }
}

/// How many steps from `t_v` on end before `end`.
pub(crate) fn whole_steps_before(t_v: VirtualTime, end: VirtualTime, step: TimeSpan) -> u64 {
    let left_ns = end.as_nanos().saturating_sub(t_v.as_nanos());
    left_ns.saturating_sub(1) / step.as_nanos()
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: TimeSpan = TimeSpan::from_millis(1).expect("not zero");

    fn at(ms: u64) -> VirtualTime {
        VirtualTime::from_nanos(ms * 1_000_000)
    }

    /// Lets everybody be ready at once until `state` is entered.
    fn run_to(cycle: &mut Cycle, clients: usize, state: ServerState) {
        loop {
            for client in (0..clients).map(ClientId::from_index) {
                if cycle.is_awaited(client) {
                    cycle.signal_ready(client);
                }
            }
            if cycle.advance() == Some(state) {
                return;
            }
        }
    }

    #[test]
    fn nobody_passes_before_all_are_ready() {
        let mut cycle = Cycle::new(STEP, Coupling::Parallel, 2);
        cycle.signal_ready(ClientId(0));
        assert_eq!(cycle.advance(), None);
        cycle.signal_ready(ClientId(1));
        assert_eq!(cycle.advance(), Some(ServerState::InitialWrite));
        assert_eq!(cycle.advance(), None);
    }

    #[test]
    fn time_grows_on_entering_read() {
        let mut cycle = Cycle::new(STEP, Coupling::Parallel, 1);
        run_to(&mut cycle, 1, ServerState::PreRead);
        assert_eq!(cycle.t_v(), VirtualTime::ZERO);
        run_to(&mut cycle, 1, ServerState::Read);
        assert_eq!(cycle.t_v(), at(1));
        assert_eq!(cycle.steps(), StepCount(1));
    }

    #[test]
    fn a_delayed_client_sleeps_and_the_others_go_on() {
        let mut cycle = Cycle::new(STEP, Coupling::Parallel, 2);
        run_to(&mut cycle, 2, ServerState::InitialWrite);
        cycle.sleep_until(ClientId(1), at(3));
        for ms in 1..3 {
            run_to(&mut cycle, 2, ServerState::PreWrite);
            assert_eq!(cycle.t_v(), at(ms));
            assert!(cycle.is_due(ClientId(0)) && !cycle.is_due(ClientId(1)));
            assert_eq!(cycle.client(ClientId(1)), ClientState::Setup);
        }
        run_to(&mut cycle, 2, ServerState::PreWrite);
        assert!(cycle.is_due(ClientId(1)), "due at 3 ms");
        assert_eq!(cycle.client(ClientId(1)), ClientState::Run);
    }

    #[test]
    fn sequential_passes_share_one_step_of_time() {
        let order = vec![ClientId(1), ClientId(0)];
        let mut cycle = Cycle::new(STEP, Coupling::Sequential { order }, 2);
        let mut runs = Vec::new();
        for _ in 0..4 {
            run_to(&mut cycle, 2, ServerState::PreWrite);
            let running = (0..2).map(ClientId::from_index).find(|client| cycle.is_due(*client));
            runs.push((running.map(ClientId::index), cycle.t_v()));
        }
        assert_eq!(runs, [(Some(1), at(1)), (Some(0), at(1)), (Some(1), at(2)), (Some(0), at(2))]);
    }

    #[test]
    fn steps_passed_over_are_as_if_gone_through() {
        for coupling in [Coupling::Parallel, Coupling::Sequential { order: vec![ClientId(1), ClientId(0)] }] {
            let mut slow = Cycle::new(STEP, coupling, 2);
            run_to(&mut slow, 2, ServerState::InitialWrite);
            assert_eq!(slow.idle_steps(), 0, "nobody has set itself up");
            slow.sleep_until(ClientId(0), at(7));
            slow.sleep_until(ClientId(1), at(9));
            for client in [0, 1] {
                slow.signal_ready(ClientId(client));
            }
            let mut fast = slow.clone();
            assert_eq!(fast.idle_steps(), 6);
            while slow.steps() < StepCount(6) || slow.server() != ServerState::Write || !slow.is_at_boundary() {
                slow.advance();
            }
            assert_eq!((fast.pass_over(2), fast.pass_over(100), fast.pass_over(1)), (2, 4, 0));
            assert_eq!(fast, slow);
            run_to(&mut fast, 2, ServerState::PreWrite);
            assert!(fast.t_v() == at(7) && fast.idle_steps() == 0);
        }
    }

    #[test]
    fn who_never_wakes_lets_time_run_out_without_overflow() {
        let mut cycle = Cycle::new(STEP, Coupling::Parallel, 1);
        run_to(&mut cycle, 1, ServerState::InitialWrite);
        cycle.sleep_until(ClientId(0), VirtualTime::MAX);
        cycle.signal_ready(ClientId(0));
        let all = cycle.idle_steps();
        assert_eq!(cycle.pass_over(u64::MAX), all);
        assert!(cycle.t_v() < VirtualTime::MAX);
    }

    #[test]
    fn a_restart_is_a_new_session() {
        let mut fresh = Cycle::new(STEP, Coupling::Parallel, 2);
        run_to(&mut fresh, 2, ServerState::InitialWrite);
        let mut used = fresh.clone();
        run_to(&mut used, 2, ServerState::Write);
        used.restart();
        assert_eq!(used, fresh);
    }
}
