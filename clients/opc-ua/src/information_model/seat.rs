//! A client's place in the session, sans-IO: grants and answers, and which of them are distinguished.
//!
//! | from | what happens | to |
//! |---|---|---|
//! | start | `begin`: a grant for `t_v = 0` | setup |
//! | write | `begin`, after a reset | setup |
//! | write | `grant`: a grant for a later `t_v` | run |
//! | setup, run | `done` with the number of the grant | write |
//! | any | `end` | ended |
//!
//! Grants are numbered from 1 and never again, resets included: an answer that comes late or twice is known by its
//! number.

use std::collections::BTreeSet;

use onescan_server::signal::{ClientName, PortLayout};
use onescan_server::state::ClientState;
use onescan_server::time::{TimeSpan, VirtualTime};
use thiserror::Error;

/// Who writes: the number of an OPC UA session.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Holder(pub u32);

/// Why what a client wrote is not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Refusal {
    /// Nobody has started here.
    #[error("the client has not started: it must write `Start` first")]
    NotStarted,
    /// Somebody else is in.
    #[error("another OPC UA session takes part as this client")]
    Taken,
    #[error("no grant is under way")]
    NotGranted,
    /// This grant has been answered.
    #[error("this grant has been answered already")]
    Doubled,
    #[error("an answer to an old grant")]
    Old,
    /// A grant that was never given.
    #[error("an answer to a grant that was not given")]
    Unknown,
    /// An output was refused since the grant.
    #[error("an output of this grant was refused")]
    Spoilt,
    /// Outputs of another number.
    #[error("not as many outputs as the client has")]
    Count,
    #[error("the session is over")]
    Over,
}

/// An answer to a grant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    pub outputs: Vec<u8>,
    /// The next turn wanted, in ns; 0 for one period later.
    pub wake_ns: i64,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seat {
    pub name: ClientName,
    /// Virtual time of one turn.
    pub period: TimeSpan,
    pub inputs: PortLayout,
    pub outputs: PortLayout,
    holder: Option<Holder>,
    state: ClientState,
    is_ended: bool,
    grant: u64,
    done: u64,
    t_v: VirtualTime,
    wake_ns: i64,
    given: Vec<u8>,
    staged: Vec<u8>,
    spoilt: BTreeSet<usize>,
    answer: Option<Answer>,
    fault: Option<String>,
    /// Where each output lies in the packed outputs.
    ranges: Vec<std::ops::Range<usize>>,
}

impl Seat {
    /// An empty place.
    pub fn new(name: ClientName, period: TimeSpan, inputs: PortLayout, outputs: PortLayout) -> Self {
        let (given, staged) = (vec![0; inputs.size()], vec![0; outputs.size()]);
        let ranges = outputs.iter().map(|(port, offset)| offset..offset + port.ty.size()).collect();
        Self {
            name,
            period,
            inputs,
            outputs,
            holder: None,
            state: ClientState::Start,
            is_ended: false,
            grant: 0,
            done: 0,
            t_v: VirtualTime::ZERO,
            wake_ns: 0,
            given,
            staged,
            spoilt: BTreeSet::new(),
            answer: None,
            fault: None,
            ranges,
        }
    }

    /// The state of `[SDSP]` Fig. 9; `ready` and `read` are passed within a grant.
    pub fn state(&self) -> ClientState {
        self.state
    }

    /// True once the session is over.
    pub fn is_ended(&self) -> bool {
        self.is_ended
    }

    /// Who takes part here.
    pub fn holder(&self) -> Option<Holder> {
        self.holder
    }

    /// Number of the last grant.
    pub fn grant_number(&self) -> u64 {
        self.grant
    }

    /// Virtual time of the last grant.
    pub fn t_v(&self) -> VirtualTime {
        self.t_v
    }

    /// Number of the last answer.
    pub fn done_number(&self) -> u64 {
        self.done
    }

    /// The next turn wanted, as written so far.
    pub fn wake_ns(&self) -> i64 {
        self.wake_ns
    }

    /// The inputs of the last grant, packed.
    pub fn given(&self) -> &[u8] {
        &self.given
    }

    /// The outputs as written so far, packed.
    pub fn staged(&self) -> &[u8] {
        &self.staged
    }

    /// True while a grant waits for its answer.
    pub fn is_granted(&self) -> bool {
        matches!(self.state, ClientState::Setup | ClientState::Run) && !self.is_ended
    }

    /// Why the client cannot go on, if it said so.
    pub fn fault(&self) -> Option<&str> {
        self.fault.as_deref()
    }

    /// Somebody is ready to start as this client. The same may say so again.
    ///
    /// # Errors
    /// Somebody else has; `is_gone` says whether a holder is.
    pub fn start(&mut self, who: Holder, is_gone: impl Fn(Holder) -> bool) -> Result<(), Refusal> {
        if self.is_ended {
            return Err(Refusal::Over);
        }
        match self.holder {
            Some(holder) if holder == who => Ok(()),
            // A session that has begun belongs to who began it: another one does not know its state.
            Some(holder) if self.grant > 0 || !is_gone(holder) => Err(Refusal::Taken),
            _ => {
                self.holder = Some(who);
                Ok(())
            }
        }
    }

    /// The holder takes it back, before the session begins.
    ///
    /// # Errors
    /// It is not the holder, or the session has begun.
    pub fn withdraw(&mut self, who: Holder) -> Result<(), Refusal> {
        self.check(who)?;
        if self.grant > 0 {
            return Err(Refusal::Taken);
        }
        self.holder = None;
        Ok(())
    }

    fn check(&self, who: Holder) -> Result<(), Refusal> {
        match self.holder {
            _ if self.is_ended => Err(Refusal::Over),
            None => Err(Refusal::NotStarted),
            Some(holder) if holder != who => Err(Refusal::Taken),
            Some(_) => Ok(()),
        }
    }

    fn check_granted(&self, who: Holder) -> Result<(), Refusal> {
        self.check(who)?;
        if self.is_granted() { Ok(()) } else { Err(Refusal::NotGranted) }
    }

    /// Writes output `index`, which is not seen before `done`.
    ///
    /// # Errors
    /// It is not the holder's turn.
    pub fn write(&mut self, who: Holder, index: usize, value: &[u8]) -> Result<(), Refusal> {
        self.check_granted(who)?;
        let Some(range) = self.ranges.get(index).cloned() else { return Err(Refusal::Count) };
        self.staged[range].copy_from_slice(value);
        self.spoilt.remove(&index);
        Ok(())
    }

    /// Output `index` was written with something that is not a value of it: the grant cannot be answered before it is
    /// written again.
    ///
    /// # Errors
    /// It is not the holder's turn.
    pub fn spoil(&mut self, who: Holder, index: usize) -> Result<(), Refusal> {
        self.check_granted(who)?;
        self.spoilt.insert(index);
        Ok(())
    }

    /// Asks for the next turn at `wake_ns`; 0 for one period later.
    ///
    /// # Errors
    /// It is not the holder's turn.
    pub fn wake(&mut self, who: Holder, wake_ns: i64) -> Result<(), Refusal> {
        self.check_granted(who)?;
        self.wake_ns = wake_ns;
        Ok(())
    }

    /// Answers grant `number` with the outputs as written.
    ///
    /// # Errors
    /// It is not the grant under way, which is as it was then.
    pub fn done(&mut self, who: Holder, number: u64) -> Result<(), Refusal> {
        self.check_done(who, number)?;
        if !self.spoilt.is_empty() {
            return Err(Refusal::Spoilt);
        }
        self.done = number;
        self.state = ClientState::Write;
        let wake_ns = std::mem::take(&mut self.wake_ns);
        self.answer = Some(Answer { outputs: self.staged.clone(), wake_ns });
        Ok(())
    }

    /// Whether `number` is that of the grant under way.
    ///
    /// # Errors
    /// It is another.
    pub fn check_done(&self, who: Holder, number: u64) -> Result<(), Refusal> {
        self.check(who)?;
        match number {
            number if number > self.grant => Err(Refusal::Unknown),
            number if number == self.done && number > 0 => Err(Refusal::Doubled),
            number if number < self.grant => Err(Refusal::Old),
            _ => self.check_granted(who),
        }
    }

    /// The client cannot go on.
    ///
    /// # Errors
    /// It is not the holder.
    pub fn fail(&mut self, who: Holder, why: &str) -> Result<(), Refusal> {
        self.check(who)?;
        self.fault = Some(why.to_owned());
        Ok(())
    }

    /// A grant to take the initial state; outputs are zero unless written.
    pub fn begin(&mut self) {
        self.staged.fill(0);
        self.give(ClientState::Setup, VirtualTime::ZERO);
    }

    /// A grant of one turn on `inputs` that ends at `t_v`.
    pub fn grant(&mut self, t_v: VirtualTime, inputs: &[u8]) {
        self.given.copy_from_slice(inputs);
        self.give(ClientState::Run, t_v);
    }

    fn give(&mut self, state: ClientState, t_v: VirtualTime) {
        self.grant += 1;
        self.t_v = t_v;
        self.wake_ns = 0;
        self.spoilt.clear();
        self.answer = None;
        self.state = state;
    }

    /// The answer to the last grant, once.
    pub fn take_answer(&mut self) -> Option<Answer> {
        self.answer.take()
    }

    /// The session is over.
    pub fn end(&mut self) {
        self.is_ended = true;
    }
}

#[cfg(test)]
#[path = "seat_tests.rs"]
mod tests;
