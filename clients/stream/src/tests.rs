//! Two ports on a line, and what holds for every line.

use proptest::prelude::*;

use super::*;

const MS: u64 = 1_000_000;

/// Two sides that take turns, each with its period in steps of 1 ms, in parallel coupling.
struct Pair {
    ports: [Port; 2],
    periods: [u64; 2],
    /// What each wrote, as the other sees it.
    lines: [Vec<u8>; 2],
    step: u64,
}

impl Pair {
    fn new(forms: [Form; 2], window: u16, periods: [u64; 2]) -> Self {
        let ports = forms.map(|form| Port::new(form, [window; 2], 7));
        let lines = ports.each_ref().map(|port| port.state().line.clone());
        Self { ports, periods, lines, step: 0 }
    }

    /// One step; `act` is what a side does in its turn.
    fn step(&mut self, mut act: impl FnMut(usize, u64, &mut Port)) {
        self.step += 1;
        let before = self.lines.clone();
        for side in 0..2 {
            if self.step.is_multiple_of(self.periods[side]) {
                let (now_ns, input) = (self.step * MS, &before[1 - side]);
                self.ports[side].arrive(now_ns, input);
                act(side, self.step, &mut self.ports[side]);
                self.ports[side].depart(now_ns, input, &mut self.lines[side]);
            }
        }
    }
}

fn serial(baud: u32) -> [Form; 2] {
    [Form::Serial(Rate::of(baud, 10).expect("not zero")); 2]
}

fn connection(cuts: Cuts) -> [Form; 2] {
    [Form::Connection(Role::Connects, cuts), Form::Connection(Role::Listens, cuts)]
}

#[test]
fn a_line_lasts_as_long_as_its_bits() {
    for (count, lasts_ns) in [(258, 268_750_000), (1026, 1_068_750_000)] {
        let mut pair = Pair::new(serial(9600), 64, [1, 2]);
        let (mut got, mut last_step) = (0, 0);
        for _ in 0..1200 {
            pair.step(|side, step, port| match side {
                0 if step == 10 => assert!(port.send(&vec![0x55; count])),
                0 => {}
                _ => {
                    let new = port.take(usize::MAX).len();
                    got += new;
                    last_step = if new > 0 { step } else { last_step };
                }
            });
        }
        assert_eq!(got, count);
        let measured_ns = last_step * MS - 10 * MS;
        // the sender shows a byte at its next step, and the reader reads it one of its periods later at most
        assert!((lasts_ns..=lasts_ns + 4 * MS).contains(&measured_ns), "{count}: {measured_ns} ns");
    }
}

#[test]
fn a_reader_that_sleeps_for_longer_than_the_window_learns_what_it_missed() {
    let mut pair = Pair::new(serial(9600), 16, [1, 100]);
    let mut got = 0;
    for _ in 0..400 {
        pair.step(|side, step, port| match side {
            0 if step == 1 => assert!(port.send(&[1; 200])),
            0 => {}
            _ => got += port.take(usize::MAX).len() as u64,
        });
    }
    assert_eq!(got + pair.ports[1].losses().window, 200);
    assert!((32..=64).contains(&got), "{got}");
}

#[test]
fn a_full_buffer_loses_bytes_of_a_serial_line_and_holds_up_a_connection() {
    let mut slow = Pair::new(serial(115_200), 64, [1, 1]);
    slow.ports[1].buffer = 10;
    slow.step(|side, _, port| assert!(side == 1 || port.send(&[9; 50])));
    (0..20).for_each(|_| slow.step(|_, _, _| ()));
    assert_eq!((slow.ports[1].available(), slow.ports[1].losses().buffer), (10, 40));
    let mut kept = Pair::new(connection(Cuts::Nowhere), 16, [1, 1]);
    kept.ports[1].buffer = 10;
    kept.step(|side, _, port| {
        if side == 0 {
            port.connect();
        }
    });
    let mut sent = false;
    let mut got = Vec::new();
    for step in 0..40 {
        kept.step(|side, _, port| match side {
            0 if !sent && port.link() == Link::Open => sent = port.send(&(0..50).collect::<Vec<u8>>()),
            1 if step > 20 => got.extend(port.take(usize::MAX)),
            _ => {}
        });
    }
    assert_eq!(got, (0..50).collect::<Vec<u8>>());
    assert_eq!(kept.ports[1].losses(), Losses::default());
}

#[test]
fn both_sides_learn_of_the_end_of_a_connection_after_its_last_byte() {
    use Link::{Closed, Connecting, Ended, Open};
    let mut pair = Pair::new(connection(Cuts::Every(5)), 64, [1, 3]);
    let mut seen = Vec::new();
    let mut got = [0, 0];
    for _ in 0..200 {
        pair.step(|side, step, port| {
            got[side] += port.take(usize::MAX).len();
            if side == 0 && [1, 100].contains(&step) {
                port.connect();
            }
            if side == 0 && [20, 120].contains(&step) {
                assert!(port.send(&[1; 23]));
                port.disconnect();
            }
            if seen.last() != Some(&(side, port.link())) {
                seen.push((side, port.link()));
            }
        });
    }
    assert_eq!(got, [0, 46]);
    let of = |wanted: usize| {
        let mut list: Vec<_> = seen.iter().filter(|(side, _)| *side == wanted).map(|(_, link)| *link).collect();
        list.dedup();
        list
    };
    assert_eq!(of(0), [Connecting, Open, Closed, Connecting, Open, Closed]);
    assert_eq!(of(1), [Open, Ended, Closed, Open, Ended, Closed]);
}

#[test]
fn a_saved_port_goes_on_in_the_middle_of_a_byte() {
    let mut whole = Pair::new(serial(9600), 64, [1, 1]);
    let mut got = Vec::new();
    let run = |pair: &mut Pair, steps: u64, got: &mut Vec<u8>| {
        for _ in 0..steps {
            pair.step(|side, step, port| match side {
                0 if step == 1 => assert!(port.send(&(0..40).collect::<Vec<u8>>())),
                0 => {}
                _ => got.extend(port.take(usize::MAX)),
            });
        }
    };
    run(&mut whole, 17, &mut got);
    let saved = postcard::to_stdvec(whole.ports[0].state()).expect("plain data");
    let mut other = Pair::new(serial(9600), 64, [1, 1]);
    other.ports[0].restore(postcard::from_bytes(&saved).expect("saved")).expect("its own");
    other.ports[1].restore(whole.ports[1].state().clone()).expect("its own");
    (other.step, other.lines) = (whole.step, whole.lines.clone());
    let mut resumed = got.clone();
    run(&mut whole, 60, &mut got);
    run(&mut other, 60, &mut resumed);
    assert_eq!(got, (0..40).collect::<Vec<u8>>());
    assert_eq!(resumed, got);
    let foreign = Port::new(connection(Cuts::Nowhere)[0], [64; 2], 1);
    assert_eq!(foreign.check(whole.ports[0].state()), Err(ForeignPort));
}

/// Messages of one length are cut at each of their places in turn: the rest of a message comes a turn later.
#[test]
fn a_cut_that_moves_onwards_comes_to_every_place() {
    let mut pair = Pair::new(connection(Cuts::Onwards), 64, [1, 1]);
    let (mut sent, mut parts) = (0, Vec::new());
    for _ in 0..60 {
        pair.step(|side, step, port| match side {
            0 if step == 1 => port.connect(),
            0 if step > 8 && step.is_multiple_of(5) && sent < 9 => {
                assert!(port.send(&[7; 8]));
                sent += 1;
            }
            0 => {}
            _ => parts.extend(Some(port.take(usize::MAX).len()).filter(|count| *count > 0)),
        });
    }
    assert_eq!(parts, [8, 1, 7, 2, 6, 3, 5, 4, 4, 5, 3, 6, 2, 7, 1, 8]);
}

fn cuts() -> impl Strategy<Value = Cuts> {
    prop_oneof![
        Just(Cuts::Nowhere),
        (1_u32..40).prop_map(Cuts::Behind),
        // a segment a turn: shorter ones would take too long
        (8_u32..40).prop_map(Cuts::Every),
        Just(Cuts::Random),
        Just(Cuts::Onwards)
    ]
}

proptest! {
    #[test]
    fn any_turns_deliver_the_same_bytes_in_order(
        periods in [1_u64..12, 1_u64..12],
        // which side sends how many bytes when
        messages in proptest::collection::vec((0_usize..2, 1_u64..200, 0_usize..80), 0..12),
        cuts in cuts(),
        is_serial: bool,
    ) {
        let forms = if is_serial { serial(9600) } else { connection(cuts) };
        // a window of 64 bytes covers the 24 ms that two periods of 12 ms are at most
        let mut pair = Pair::new(forms, 64, periods);
        let (mut sent, mut got) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
        let mut waiting = messages;
        waiting.sort_by_key(|(_, at, _)| *at);
        for _ in 0..3000 {
            pair.step(|side, step, port| {
                got[side].extend(port.take(usize::MAX));
                if side == 0 && port.link() == Link::Closed {
                    port.connect();
                }
                let due = waiting.iter().position(|(whose, at, _)| *whose == side && *at <= step);
                if let (Some(due), Link::Open) = (due, port.link()) {
                    let (_, at, length) = waiting.remove(due);
                    let message: Vec<u8> = (0..length).map(|k| (k as u64 + at) as u8).collect();
                    assert!(port.send(&message));
                    sent[side].extend(message);
                }
            });
        }
        prop_assert!(waiting.is_empty());
        prop_assert_eq!(&sent[0], &got[1]);
        prop_assert_eq!(&sent[1], &got[0]);
    }
}
