//! Methods: operators' wishes, and a client's whole turn in one call.

use std::sync::Arc;
use std::time::Duration;

use onescan_server::mailbox::{Request, Wish};
use onescan_server::operation::Operation;
use onescan_server::signal::SignalName;
use onescan_server::state::ServerState;
use opcua::types::{Array, StatusCode, Variant, VariantScalarTypeId};
use tokio::sync::oneshot;

use super::board::{Board, IsGone};
use super::item::number;
use super::seat::{Holder, Refusal, Seat};
use super::status::{packed, status};
use super::value;

/// How long a method waits for the step boundary at which it takes effect.
const BOUNDARY_TIMEOUT: Duration = Duration::from_secs(3);

/// Longest wait that a client may ask for: a session ends in which nothing is asked for longer, and a client that calls one
/// method after the other asks for nothing meanwhile.
const PATIENCE_MAX: Duration = Duration::from_secs(5);

/// Does what a method of the session asks for, and waits for the step boundary at which it is done. Before the
/// session has begun, or if no boundary comes in time, it is noted only.
pub(super) async fn operate(board: &Board, method: u32, arguments: &[Variant]) -> StatusCode {
    let operation = match operation(method, arguments) {
        Ok(operation) => operation,
        Err(status) => return status,
    };
    let (has_begun, has_ended) = {
        let (view, shared) = (board.view(), board.lock());
        (shared.phase.unwrap_or(view.state) != ServerState::Start, shared.end.is_some())
    };
    if has_ended {
        return StatusCode::BadInvalidState;
    }
    let (reply, answer) = oneshot::channel();
    board.mailbox().post(Request { wish: Wish::Do(operation), reply: Some(reply) });
    if !has_begun {
        return StatusCode::GoodCompletesAsynchronously;
    }
    match tokio::time::timeout(BOUNDARY_TIMEOUT, answer).await {
        Ok(Ok(Ok(_))) => StatusCode::Good,
        // A signal or value that the session has not.
        Ok(Ok(Err(_))) => StatusCode::BadInvalidArgument,
        Ok(Err(_)) => StatusCode::BadInvalidState,
        Err(_) => StatusCode::GoodCompletesAsynchronously,
    }
}

fn operation(method: u32, arguments: &[Variant]) -> Result<Operation, StatusCode> {
    let text = |index: usize| match arguments.get(index) {
        Some(Variant::String(text)) => Ok(text.as_ref().to_owned()),
        _ => Err(StatusCode::BadInvalidArgument),
    };
    let signal = || SignalName::new(text(0)?).map_err(|_| StatusCode::BadInvalidArgument);
    Ok(match method {
        number::START => Operation::Resume,
        number::STOP => Operation::Stop,
        number::PAUSE => Operation::Pause,
        number::STEP => Operation::Step,
        number::RESET => Operation::Reset,
        number::WRITE => Operation::Write { signal: signal()?, value: text(1)? },
        number::FORCE => Operation::Force { signal: signal()?, value: text(1)? },
        number::RELEASE => Operation::Release { signal: signal()? },
        _ => return Err(StatusCode::BadMethodInvalid),
    })
}

/// Starts if need be, answers the grant if there is an answer, and waits for the next.
pub(super) async fn turn(
    board: &Arc<Board>,
    seat: usize,
    (who, is_gone): (Holder, IsGone),
    arguments: &[Variant],
) -> Result<Vec<Variant>, StatusCode> {
    let [Variant::UInt64(done), Variant::Int64(wake_ns), outputs, Variant::UInt32(patience_ms)] = arguments else {
        return Err(StatusCode::BadInvalidArgument);
    };
    let outputs = list(outputs)?;
    if !board.lock().seats[seat].is_ended() {
        board.start(seat, who, is_gone).map_err(status)?;
        if *done > 0 {
            answer(board, seat, who, *done, *wake_ns, outputs)?;
        }
    }
    let patience = Duration::from_millis(u64::from(*patience_ms)).min(PATIENCE_MAX);
    board.wait_for_grant(seat, patience).await;
    Ok(described(&board.lock().seats[seat]))
}

/// Answers a grant as a whole: nothing of it counts if a value is none.
fn answer(
    board: &Board,
    seat: usize,
    who: Holder,
    done: u64,
    wake_ns: i64,
    outputs: &[Variant],
) -> Result<(), StatusCode> {
    let types: Vec<_> = board.lock().seats[seat].outputs.ports().iter().map(|port| port.ty).collect();
    if !outputs.is_empty() && outputs.len() != types.len() {
        return Err(status(Refusal::Count));
    }
    let given: Vec<Vec<u8>> =
        types.iter().zip(outputs).map(|(ty, given)| packed(*ty, given)).collect::<Result<_, _>>()?;
    let taken = board.attempt(seat, |seat| {
        // Distinguished before anything is written: an old answer must not leave its outputs behind.
        seat.check_done(who, done)?;
        for (index, bytes) in given.iter().enumerate() {
            seat.write(who, index, bytes)?;
        }
        seat.wake(who, wake_ns)?;
        seat.done(who, done)
    });
    taken.map_err(status)
}

/// The elements of a list of any type; a list of one type comes as such.
fn list(given: &Variant) -> Result<&[Variant], StatusCode> {
    match given {
        Variant::Empty => Ok(&[]),
        Variant::Array(array) => Ok(&array.values),
        _ => Err(StatusCode::BadTypeMismatch),
    }
}

/// What a client has to know for its turn.
fn described(seat: &Seat) -> Vec<Variant> {
    let wrapped: Vec<Variant> =
        value::all(&seat.inputs, seat.given()).into_iter().map(|value| Variant::Variant(Box::new(value))).collect();
    let inputs = Array { value_type: VariantScalarTypeId::Variant, values: wrapped, dimensions: None };
    vec![
        Variant::UInt32(value::of_client(seat) as u32),
        Variant::UInt64(seat.grant_number()),
        Variant::Int64(seat.t_v().as_nanos() as i64),
        Variant::Array(Box::new(inputs)),
    ]
}
