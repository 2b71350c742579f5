//! A client's place: what it is granted, what it gives back.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use onescan_server::client::{Client, ClientFault, JoinRequest, Wake};
use onescan_server::signal::PortLayout;
use onescan_server::time::VirtualTime;

struct State {
    inputs: Vec<u8>,
    outputs: Vec<u8>,
    grant: u32,
    grant_time: VirtualTime,
    done: u32,
}

/// The place of one client, shared by the session's thread and the server.
pub struct Seat {
    request: JoinRequest,
    state: Mutex<State>,
    changed: Condvar,
}

impl Seat {
    /// An empty seat for the client that `request` describes.
    pub fn new(request: JoinRequest) -> Arc<Self> {
        let size = |ports: &[_]| PortLayout::new(ports.to_vec()).size();
        let state = State {
            inputs: vec![0; size(&request.reads)],
            outputs: vec![0; size(&request.writes)],
            grant: 0,
            grant_time: VirtualTime::ZERO,
            done: 0,
        };
        Arc::new(Self { request, state: Mutex::new(state), changed: Condvar::new() })
    }

    /// What the client takes part in.
    pub fn request(&self) -> &JoinRequest {
        &self.request
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Number of the turn that is granted, and its time.
    pub fn grant(&self) -> (u32, VirtualTime) {
        let state = self.lock();
        (state.grant, state.grant_time)
    }

    /// Number of the turn that was done last.
    pub fn done(&self) -> u32 {
        self.lock().done
    }

    /// The client says that it has done turn `number`; false for one that is not under way.
    pub fn set_done(&self, number: u32) -> bool {
        let mut state = self.lock();
        let is_it = number == state.grant && state.done != number;
        if is_it {
            state.done = number;
            self.changed.notify_all();
        }
        is_it
    }

    /// Copies the input bytes from `at`.
    pub fn input(&self, at: usize, value: &mut [u8]) {
        if let Some(bytes) = self.lock().inputs.get(at..at + value.len()) {
            value.copy_from_slice(bytes);
        }
    }

    /// Copies the output bytes from `at`.
    pub fn output(&self, at: usize, value: &mut [u8]) {
        if let Some(bytes) = self.lock().outputs.get(at..at + value.len()) {
            value.copy_from_slice(bytes);
        }
    }

    /// The client writes an output; false while no turn of its is under way.
    pub fn set_output(&self, at: usize, value: &[u8]) -> bool {
        let mut state = self.lock();
        let is_granted = state.done != state.grant;
        match state.outputs.get_mut(at..at + value.len()) {
            Some(bytes) if is_granted => bytes.copy_from_slice(value),
            _ => return false,
        }
        true
    }

    /// Grants a turn and waits until it is done.
    fn turn(&self, t_v: VirtualTime, inputs: &[u8], outputs: &mut [u8], patience: Duration) -> Result<(), ClientFault> {
        let mut state = self.lock();
        if !inputs.is_empty() {
            state.inputs.copy_from_slice(inputs);
        }
        state.grant_time = t_v;
        state.grant = state.grant.wrapping_add(1).max(1);
        let granted = state.grant;
        let waited = self.changed.wait_timeout_while(state, patience, |state| state.done != granted);
        let (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        if state.done != granted {
            let message = format!("no OPC UA client has done turn {granted} within {patience:?}");
            return Err(ClientFault::new(message));
        }
        outputs.copy_from_slice(&state.outputs);
        Ok(())
    }
}

/// The client that sits there, as the session sees it.
pub struct SeatClient {
    seat: Arc<Seat>,
    /// For the first answer, and for each later one.
    patience: (Duration, Duration),
}

impl SeatClient {
    /// The client of `seat`; the session waits for it `join` before the first turn and `reply` in each.
    pub fn new(seat: Arc<Seat>, join: Duration, reply: Duration) -> Self {
        Self { seat, patience: (join, reply) }
    }
}

impl Client for SeatClient {
    fn join(&self) -> JoinRequest {
        self.seat.request.clone()
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        let size = self.seat.lock().inputs.len();
        self.seat.turn(VirtualTime::ZERO, &vec![0; size], outputs, self.patience.0)
    }

    fn turn(&mut self, t_v: VirtualTime, inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        self.seat.turn(t_v, inputs, outputs, self.patience.1)?;
        Ok(Wake::NextPeriod)
    }
}

#[cfg(test)]
mod tests {
    use onescan_server::signal::{ClientName, ElementaryType, Port, SignalName};
    use onescan_server::time::TimeSpan;

    use super::*;

    #[test]
    fn a_turn_is_done_once_and_outputs_count_in_it_only() {
        let port = |name: &str| Port { name: SignalName::new(name).unwrap(), ty: ElementaryType::Usint };
        let request = JoinRequest {
            name: ClientName::new("tool").unwrap(),
            period: TimeSpan::from_millis(1).unwrap(),
            reads: vec![port("a")],
            writes: vec![port("b")],
        };
        let seat = Seat::new(request);
        assert!(!seat.set_output(0, &[9]) && !seat.set_done(0) && !seat.set_done(1));
        let other = Arc::clone(&seat);
        let tool = std::thread::spawn(move || {
            for number in 1..=2_u32 {
                while other.grant().0 != number {
                    std::thread::yield_now();
                }
                let mut input = [0];
                other.input(0, &mut input);
                assert!(other.set_output(0, &[input[0] + 1]));
                assert!(!other.set_done(number + 1) && other.set_done(number) && !other.set_done(number));
            }
        });
        let mut client = SeatClient::new(seat, Duration::from_mins(1), Duration::from_mins(1));
        let mut outputs = [0];
        client.setup(&mut outputs).unwrap();
        assert_eq!(outputs, [1]);
        client.turn(VirtualTime::from_nanos(5), &[41], &mut outputs).unwrap();
        assert_eq!(outputs, [42]);
        tool.join().unwrap();
        client.patience.1 = Duration::ZERO;
        assert!(client.turn(VirtualTime::from_nanos(6), &[0], &mut outputs).is_err());
    }
}
