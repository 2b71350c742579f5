//! What a client may write when.

use onescan_server::signal::{ClientName, Port, PortLayout, SignalName, SignalType};

use super::*;

const ME: Holder = Holder(1);
const OTHER: Holder = Holder(2);

fn seat() -> Seat {
    let port = |name: &str| Port { name: SignalName::new(name).unwrap(), ty: SignalType::INT };
    let layout = |names: &[&str]| PortLayout::new(names.iter().map(|name| port(name)).collect());
    let period = TimeSpan::from_millis(10).unwrap();
    Seat::new(ClientName::new("plant").unwrap(), period, layout(&["in"]), layout(&["a", "b"]))
}

fn at(ms: u64) -> VirtualTime {
    VirtualTime::from_nanos(ms * 1_000_000)
}

/// Started by `ME`, set up with grant 1, and granted turn 2.
fn running() -> Seat {
    let mut seat = seat();
    seat.start(ME, |_| false).unwrap();
    seat.begin();
    seat.done(ME, 1).unwrap();
    seat.grant(at(10), &[7, 0]);
    seat
}

#[test]
fn outputs_count_with_the_answer_all_at_once() {
    let mut seat = running();
    seat.write(ME, 0, &[1, 0]).unwrap();
    assert_eq!(seat.take_answer(), None, "nothing is answered yet");
    seat.write(ME, 1, &[2, 0]).unwrap();
    seat.wake(ME, 30_000_000).unwrap();
    seat.done(ME, 2).unwrap();
    assert_eq!(seat.take_answer(), Some(Answer { outputs: vec![1, 0, 2, 0], wake_ns: 30_000_000 }));
    assert_eq!((seat.take_answer(), seat.wake_ns()), (None, 0));
    seat.grant(at(20), &[8, 0]);
    seat.done(ME, 3).unwrap();
    assert_eq!(seat.take_answer().unwrap().outputs, [1, 0, 2, 0], "what is not written stays");
}

#[test]
fn answers_are_distinguished_by_their_number() {
    let mut seat = running();
    assert_eq!(seat.done(ME, 1), Err(Refusal::Doubled), "the last one answered, while the next is under way");
    assert_eq!(seat.done(ME, 0), Err(Refusal::Old));
    assert_eq!(seat.done(ME, 3), Err(Refusal::Unknown));
    assert_eq!(seat.take_answer(), None, "none of them answers");
    seat.done(ME, 2).unwrap();
    assert_eq!(seat.done(ME, 2), Err(Refusal::Doubled));
    assert_eq!(seat.done(ME, 1), Err(Refusal::Old));
    assert_eq!(seat.write(ME, 0, &[9, 9]), Err(Refusal::NotGranted), "a late output");
    assert_eq!(seat.take_answer().unwrap().outputs, [0, 0, 0, 0]);
}

#[test]
fn numbers_go_on_over_a_reset() {
    let mut seat = running();
    seat.done(ME, 2).unwrap();
    seat.begin();
    assert_eq!((seat.grant_number(), seat.t_v(), seat.state()), (3, VirtualTime::ZERO, ClientState::Setup));
    assert_eq!(seat.done(ME, 2), Err(Refusal::Doubled), "an answer from before the reset");
    seat.done(ME, 3).unwrap();
}

#[test]
fn a_refused_output_holds_the_answer_back() {
    let mut seat = running();
    seat.spoil(ME, 1).unwrap();
    assert_eq!(seat.done(ME, 2), Err(Refusal::Spoilt));
    seat.write(ME, 1, &[5, 0]).unwrap();
    seat.done(ME, 2).unwrap();
}

#[test]
fn a_place_is_held_by_one() {
    let mut seat = seat();
    seat.begin();
    assert_eq!(seat.done(ME, 1), Err(Refusal::NotStarted));
    let mut seat = self::seat();
    seat.start(ME, |_| false).unwrap();
    assert_eq!(seat.start(OTHER, |_| false), Err(Refusal::Taken));
    seat.start(OTHER, |holder| holder == ME).expect("the first is gone, and nothing has begun");
    seat.withdraw(OTHER).unwrap();
    seat.start(ME, |_| false).unwrap();
    seat.begin();
    assert_eq!(seat.start(OTHER, |_| true), Err(Refusal::Taken), "nobody else knows its state");
    assert_eq!(seat.withdraw(ME), Err(Refusal::Taken));
    assert_eq!(seat.write(OTHER, 0, &[0, 0]), Err(Refusal::Taken));
    assert_eq!(seat.fail(OTHER, "no"), Err(Refusal::Taken));
    seat.end();
    assert_eq!(seat.done(ME, 1), Err(Refusal::Over));
}
