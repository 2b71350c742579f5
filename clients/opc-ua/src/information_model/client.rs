//! A seat as a client of the session: what the driver asks becomes a grant, what is answered becomes a turn.

use std::sync::Arc;
use std::time::Duration;

use onescan_server::client::{Client, ClientFault, JoinRequest, Wake};
use onescan_server::time::VirtualTime;

use super::board::Board;
use super::seat::Answer;

/// A client that takes part through the information model.
pub struct SeatedClient {
    board: Arc<Board>,
    seat: usize,
    request: JoinRequest,
    patience: Duration,
}

impl SeatedClient {
    /// The client of `seat` on `board`, which joins with `request` and may leave a grant unanswered for `patience`
    /// (wall clock).
    pub fn new(board: Arc<Board>, seat: usize, request: JoinRequest, patience: Duration) -> Self {
        Self { board, seat, request, patience }
    }

    fn answer(&self, outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        let answer = self.board.wait_for_answer(self.seat, self.patience);
        let Answer { outputs: written, wake_ns } = answer.map_err(|fault| ClientFault::new(fault.to_string()))?;
        outputs.copy_from_slice(&written);
        match u64::try_from(wake_ns) {
            Ok(0) => Ok(Wake::NextPeriod),
            Ok(wake_ns) => Ok(Wake::At(VirtualTime::from_nanos(wake_ns))),
            Err(_) => Err(ClientFault::new(format!("its `Wake` is {wake_ns} ns, before the session's start"))),
        }
    }
}

impl Client for SeatedClient {
    fn join(&self) -> JoinRequest {
        self.request.clone()
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        self.board.begin(self.seat);
        self.answer(outputs).map(|_| ())
    }

    fn turn(&mut self, t_v: VirtualTime, inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        self.board.grant(self.seat, t_v, inputs);
        self.answer(outputs)
    }
}
