//! The model for NuSMV that `onescan model --nusmv` writes, read by its grammar, explored, and held against
//! the session itself.
//!
//! | module | subject |
//! |---|---|
//! | `syntax` | the part of NuSMV's language that models are written in: text to a tree |
//! | `system` | a tree to variables, their first values and what may follow |
//! | `check` | all states that can be reached, and branching time over them |
//!
//! NuSMV is another program's name for the same rules, so that a mistake in the text would show there, too;
//! here the text and the session are compared state by state, which a checker of one of them cannot do.

mod check;
mod syntax;
mod system;

use std::collections::BTreeSet;

use onescan_server::nusmv::{Size, model};
use onescan_server::plan::Coupling;

use self::check::Reached;
use self::syntax::parse;
use self::system::System;
use crate::barrier::{Barrier, BarrierState, Shown};
use crate::graph::explore;
use crate::stamped::{DELAYS, report};

fn text(clients: u32, delay_max: u32, tv_max: u32) -> String {
    model(Size::new(clients, delay_max, tv_max).expect("a size that can be checked"))
}

fn reached(text: &str) -> Reached {
    let modules = parse(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    Reached::of(System::new(&modules).unwrap_or_else(|error| panic!("{error}\n{text}")))
}

/// The states of a model as those of a session are shown; virtual time is left out, on which nothing depends, and so
/// are the states before all clients have joined: the session is explored from there on.
fn shown(reached: &Reached, clients: u32) -> BTreeSet<Shown> {
    let value = |state: &[system::Value], name: &str| reached.system().shown(state, name);
    let of = |state: &Vec<system::Value>| {
        let client =
            |k: u32| ["state", "readysignal", "tdelay", "asked"].map(|of| value(state, &format!("client{k}.{of}")));
        (value(state, "simulationserver.state"), (1..=clients).map(client).collect())
    };
    let joined = |(server, clients): &Shown| server != "start" || clients.iter().all(|[_, ready, ..]| ready == "true");
    reached.states().iter().map(of).filter(joined).collect()
}

/// The states of the session that runs, in every order of what its clients may do.
fn of_the_session(clients: u32) -> BTreeSet<Shown> {
    let graph = explore(&Barrier::undisturbed(clients as usize, Coupling::Parallel));
    graph.states.iter().map(BarrierState::shown).collect()
}

#[test]
fn the_model_reaches_the_states_of_the_session_and_no_others() {
    for clients in [2, 3] {
        let reached = reached(&text(clients, *DELAYS.end() as u32, 1));
        let (model, session) = (shown(&reached, clients), of_the_session(clients));
        let (more, less) = (model.difference(&session).next(), session.difference(&model).next());
        assert!(more.is_none() && less.is_none(), "only in the model: {more:?}; only in the session: {less:?}");
        // as many as NuSMV 2.5.4 finds in this text (`NuSMV -r`), with the values of `tv` and before all have joined
        assert_eq!(reached.states().len(), if clients == 2 { 1_070 } else { 14_670 });
        report(format_args!(
            "nusmv model, {clients} clients, delays 0..5: {} states, those of the session",
            model.len()
        ));
    }
}

#[test]
fn its_specifications_hold() {
    for (clients, delay_max, tv_max) in [(1, 5, 3), (2, 5, 3), (3, 5, 1), (2, 0, 1000), (4, 0, 2)] {
        let reached = reached(&text(clients, delay_max, tv_max));
        let verdicts = reached.specifications();
        assert!(verdicts.len() > 2);
        for (specification, holds) in verdicts {
            assert!(holds, "{clients} clients, delays up to {delay_max}: {specification}");
        }
    }
}

/// "Valid when the time delays are equal", and only then.
#[test]
fn clients_with_other_delays_are_not_in_equal_states() {
    let claim = "SPEC AG (client1.state = client2.state)\n";
    let verdict = |delay_max| {
        let reached = reached(&(text(2, delay_max, 1) + claim));
        reached.specifications().last().expect("a claim").1
    };
    assert!(verdict(0) && !verdict(1));
}

/// The comparison can fail: each of these changes of the text is found.
#[test]
fn another_rule_would_be_found() {
    let right = text(2, 5, 1);
    let session = of_the_session(2);
    for (rule, other) in [
        ("sync := readysignal | tdelay != 0;", "sync := TRUE;"),
        ("tdelay = 0 : asked;", "tdelay = 0 : 0;"),
        ("serverstate = write : tdelay = 1;", "serverstate = write : tdelay = 2;"),
        ("serverstate = pre_write : write;", "serverstate = pre_write : ready;"),
        ("\n      state = pre_read : read;", "\n      state = pre_read : pre_write;"),
        ("client1.sync & client2.sync", "client1.sync"),
        ("      synchronize & takes_part : FALSE;\n", ""),
    ] {
        assert_eq!(right.matches(rule).count(), 1, "{rule}");
        let reached = reached(&right.replace(rule, other));
        assert!(shown(&reached, 2) != session, "{other} in place of {rule}");
    }
}

#[test]
fn what_is_not_a_model_is_refused_with_its_line() {
    for (wrong, why) in [
        ("MODULE main\nVAR\n  x : boolean\n", "line 4: `;` expected"),
        (
            "MODULE main\nVAR\n  x : boolean;\nASSIGN\n  init (x) := case TRUE : FALSE;\n",
            "line 6: an expression expected",
        ),
        ("MODULE main\nVAR\n  x % 1;\n", "line 3: nothing begins with `%`"),
        ("VAR x : boolean;", "line 1: `MODULE` expected"),
    ] {
        assert_eq!(parse(wrong).expect_err(wrong).to_string(), why);
    }
    let free = parse("MODULE main\nVAR\n  x : boolean;\n").expect("a model");
    assert_eq!(System::new(&free).expect_err("nothing moves x").to_string(), "nothing says what `x` is at first");
}
