//! What items hold, as Variants.

use onescan_server::published::SessionView;
use onescan_server::signal::PortLayout;
use onescan_server::state::{ClientState, ServerState};
use onescan_server::time::VirtualTime;
use opcua::types::{UAString, Variant};

use super::board::{Board, Shared};
use super::item::{Item, number};
use super::seat::Seat;
use crate::link::value::to_variant;

/// Number of the end in [`super::types::SESSION_STATES`] and [`super::types::CLIENT_STATES`].
const ENDED: i32 = 6;

/// The value of `item`; nothing for a method.
pub(super) fn of_item(board: &Board, view: &SessionView, shared: &Shared, item: Item) -> Option<Variant> {
    match item {
        Item::Session(number) => of_session(board, view, shared, number),
        Item::Signal(index) => {
            let signal = board.layout().signals().nth(index)?;
            Some(to_variant(board.layout().ty(signal), board.layout().bytes(signal, &view.image)))
        }
        Item::Seat(seat, number) => of_seat(shared.seats.get(seat)?, number),
        Item::Input(seat, index) => shared.seats.get(seat).and_then(|seat| at(&seat.inputs, seat.given(), index)),
        Item::Output(seat, index) => shared.seats.get(seat).and_then(|seat| at(&seat.outputs, seat.staged(), index)),
    }
}

fn at(layout: &PortLayout, bytes: &[u8], index: usize) -> Option<Variant> {
    let (port, offset) = layout.iter().nth(index)?;
    Some(to_variant(port.ty, &bytes[offset..offset + port.ty.size()]))
}

/// All values of a port in their order.
pub(super) fn all(layout: &PortLayout, bytes: &[u8]) -> Vec<Variant> {
    let value = |(port, offset): (&onescan_server::signal::Port, usize)| {
        to_variant(port.ty, &bytes[offset..offset + port.ty.size()])
    };
    layout.iter().map(value).collect()
}

fn of_session(board: &Board, view: &SessionView, shared: &Shared, of: u32) -> Option<Variant> {
    Some(match of {
        number::SESSION_STATE if shared.end.is_some() => Variant::Int32(ENDED),
        number::SESSION_STATE => Variant::Int32(of_state(shared.phase.unwrap_or(view.state))),
        number::VIRTUAL_TIME => ns(view.t_v),
        number::TIME_STEP => Variant::Int64(board.plan().step().as_nanos() as i64),
        number::STEP_COUNT => Variant::UInt64(view.steps.0),
        number::HELD => Variant::Boolean(shared.is_held || view.is_held),
        number::DIGEST => Variant::from(view.digest.map(|digest| digest.to_string()).unwrap_or_default()),
        number::END => Variant::from(shared.end.clone().unwrap_or_default()),
        _ => return None,
    })
}

fn of_seat(seat: &Seat, of: u32) -> Option<Variant> {
    Some(match of {
        number::CLIENT_STATE => Variant::Int32(of_client(seat)),
        number::PERIOD => Variant::Int64(seat.period.as_nanos() as i64),
        number::CLIENT_START => Variant::Boolean(seat.holder().is_some()),
        number::GRANT => Variant::UInt64(seat.grant_number()),
        number::GRANT_TIME => ns(seat.t_v()),
        number::WAKE => Variant::Int64(seat.wake_ns()),
        number::DONE => Variant::UInt64(seat.done_number()),
        number::FAULT => Variant::from(seat.fault().unwrap_or_default()),
        number::INPUT_ORDER => names(&seat.inputs),
        number::OUTPUT_ORDER => names(&seat.outputs),
        _ => return None,
    })
}

fn names(layout: &PortLayout) -> Variant {
    let names: Vec<UAString> = layout.ports().iter().map(|port| UAString::from(port.name.as_str())).collect();
    Variant::from(names)
}

fn ns(t_v: VirtualTime) -> Variant {
    Variant::Int64(t_v.as_nanos() as i64)
}

fn of_state(state: ServerState) -> i32 {
    match state {
        ServerState::Start => 0,
        ServerState::InitialWrite => 1,
        ServerState::PreRead => 2,
        ServerState::Read => 3,
        ServerState::PreWrite => 4,
        ServerState::Write => 5,
    }
}

/// The number of a client's state.
pub(super) fn of_client(seat: &Seat) -> i32 {
    match seat.state() {
        _ if seat.is_ended() => ENDED,
        ClientState::Start => 0,
        ClientState::Setup => 1,
        ClientState::Ready => 2,
        ClientState::Read => 3,
        ClientState::Run => 4,
        ClientState::Write => 5,
    }
}
