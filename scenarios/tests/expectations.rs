//! Signal temporal logic over traces: what formulas are worth, by hand and against a peer.

use onescan_scenario::expect::{Expectation, FormulaError, Judge, KnownSignal, Outcome, TraceEnd, Verdict};
use onescan_server::signal::SignalType;
use onescan_server::time::VirtualTime;

fn known() -> Vec<KnownSignal> {
    let signal =
        |name: &str, ty, unit: Option<&str>| KnownSignal { name: name.to_owned(), ty, unit: unit.map(str::to_owned) };
    vec![
        signal("closed", SignalType::BOOL, None),
        signal("done", SignalType::BOOL, None),
        signal("pressure", SignalType::REAL, Some("bar")),
        signal("position", SignalType::LREAL, Some("m")),
        signal("count", SignalType::DINT, Some("pcs")),
        signal("elapsed", SignalType::TIME, None),
        signal("name", SignalType::String(80), None),
    ]
}

/// Judges samples 100 ms apart of the signals in the order in which the formula names them.
fn judge(formula: &str, samples: &[&[f64]]) -> Outcome {
    judge_until(formula, samples, TraceEnd::Complete)
}

fn judge_until(formula: &str, samples: &[&[f64]], end: TraceEnd) -> Outcome {
    let mut columns = Vec::new();
    let expectation = Expectation::parse(formula, &known(), &mut columns).expect("a formula");
    let mut judge = Judge::new([expectation], columns.len());
    for (step, sample) in (0..).zip(samples) {
        judge.push(step * 100_000_000, sample.iter().copied());
    }
    judge.finish(end).pop().expect("an outcome for each expectation")
}

fn refused(formula: &str) -> FormulaError {
    Expectation::parse(formula, &known(), &mut Vec::new()).expect_err("no formula")
}

/// The sample at which an expectation is violated.
fn violated_at(outcome: &Outcome) -> Option<u64> {
    match outcome.verdict {
        Verdict::Violated { at, .. } => Some(at.as_nanos() / 100_000_000),
        _ => None,
    }
}

#[test]
fn a_response_in_time() {
    let formula = "always (rose(closed) implies within 200ms pressure > 5 bar)";
    let late = judge(formula, &[&[0., 0.], &[1., 2.], &[1., 4.], &[1., 4.5], &[1., 6.]]);
    assert_eq!(violated_at(&late), Some(1));
    let Verdict::Violated { at, values } = late.verdict else { unreachable!() };
    assert_eq!(at, VirtualTime::from_nanos(100_000_000));
    assert_eq!(values, [("closed".to_owned(), 1.0), ("pressure".to_owned(), 2.0)]);
    assert_eq!(late.margin.greatest, -0.5);

    let in_time = judge(formula, &[&[0., 0.], &[1., 2.], &[1., 4.], &[1., 5.5], &[1., 6.]]);
    assert_eq!(in_time.verdict, Verdict::Met);
}

#[test]
fn what_a_run_cuts_off_is_open_unless_it_is_decided() {
    let formula = "always (rose(closed) implies within 200ms pressure > 5 bar)";
    assert_eq!(judge(formula, &[&[0., 0.], &[0., 0.], &[1., 2.]]).verdict, Verdict::Open);
    assert_eq!(judge("always[0,1s] pressure < 5", &[&[1.], &[2.]]).verdict, Verdict::Open);
    assert_eq!(violated_at(&judge("always[0,1s] pressure < 5", &[&[1.], &[6.]])), Some(1));
    assert_eq!(judge("eventually[0,1s] pressure < 5", &[&[6.], &[2.]]).verdict, Verdict::Met);
    assert_eq!(judge("eventually pressure < 5", &[]).verdict, Verdict::Open);
}

#[test]
fn without_a_window_a_run_s_end_decides_and_a_cut_does_not() {
    let samples: &[&[f64]] = &[&[0.], &[0.]];
    assert_eq!(violated_at(&judge("eventually done", samples)), Some(1), "it could have come until the end");
    assert_eq!(judge_until("eventually done", samples, TraceEnd::Cut).verdict, Verdict::Open);
}

#[test]
fn what_is_waited_for_in_vain_is_violated_when_the_wait_is_over() {
    let ms = |formula: &str, samples: &[&[f64]]| match judge(formula, samples).verdict {
        Verdict::Violated { at, .. } => Some(at.as_nanos() / 1_000_000),
        _ => None,
    };
    let never: &[&[f64]] = &[&[0.], &[0.], &[0.], &[0.]];
    assert_eq!(ms("eventually done", never), Some(300), "at the end of the run");
    assert_eq!(ms("eventually[0,250ms] done", never), Some(250), "at the end of the window, between two samples");
    assert_eq!(ms("always eventually[0,100ms] done", never), Some(100));
    let neither: &[&[f64]] = &[&[0., 0.], &[0., 0.], &[0., 0.], &[0., 0.]];
    assert_eq!(ms("(eventually[0,100ms] done) or (eventually[0,200ms] closed)", neither), Some(200), "not both came");
    assert_eq!(ms("(eventually[0,100ms] done) and (eventually[0,200ms] closed)", neither), Some(100), "one did not");
    let broken: &[&[f64]] = &[&[1., 0.], &[0., 0.], &[1., 0.], &[1., 1.]];
    assert_eq!(ms("closed until[0,300ms] done", broken), Some(100), "it was open before the time");
    let held: &[&[f64]] = &[&[1., 0.], &[1., 0.], &[1., 0.], &[1., 0.]];
    assert_eq!(ms("closed until[0,300ms] done", held), Some(300));
}

#[test]
fn the_past_begins_with_the_run() {
    let at_start = |formula: &str| judge(formula, &[&[0.], &[1.]]).verdict;
    assert_eq!(at_start("historically[100ms,1s] done"), Verdict::Met);
    assert_ne!(at_start("once[100ms,1s] done"), Verdict::Met);
    assert_ne!(at_start("rose(done)"), Verdict::Met);
    assert_eq!(
        violated_at(&judge(
            "always (done implies once[100ms,200ms] closed)",
            &[&[0., 1.], &[0., 0.], &[0., 0.], &[1., 0.]]
        )),
        Some(3)
    );
}

#[test]
fn until_and_since_hold_what_is_between() {
    let until = |samples: &[&[f64]]| judge("closed until[100ms,300ms] done", samples).verdict;
    assert_eq!(until(&[&[1., 0.], &[1., 0.], &[0., 1.]]), Verdict::Met);
    assert_ne!(until(&[&[1., 0.], &[0., 0.], &[0., 1.], &[0., 0.]]), Verdict::Met);
    // Reached too early only.
    assert_ne!(until(&[&[1., 1.], &[1., 0.], &[1., 0.], &[1., 0.], &[1., 1.]]), Verdict::Met);
    let since = "always (done implies (closed since rose(closed)))";
    assert_eq!(judge(since, &[&[0., 0.], &[0., 1.], &[1., 1.]]).verdict, Verdict::Met);
}

#[test]
fn a_signal_holds_between_samples() {
    // Windows that begin between samples see what holds there.
    assert_eq!(judge("eventually[150ms,180ms] done", &[&[0.], &[1.], &[0.]]).verdict, Verdict::Met);
    assert_eq!(violated_at(&judge("eventually[150ms,180ms] done", &[&[1.], &[0.], &[1.]])), Some(1));
}

#[test]
fn numbers_take_the_unit_of_what_they_are_compared_with() {
    assert_eq!(judge("always position <= 200 mm", &[&[0.2]]).margin.greatest, 0.0);
    assert_eq!(judge("always 0.3 MPa <= pressure", &[&[3.0]]).margin.greatest, 0.0);
    assert_eq!(judge("always abs(rate(position)) < 500 mm/s", &[&[0.0], &[0.04], &[0.07]]).verdict, Verdict::Met);
    assert_eq!(judge("always elapsed < 1s", &[&[0.5]]).margin.greatest, 0.5);
    assert_eq!(judge("always count < 5 pcs", &[&[4.0]]).verdict, Verdict::Met);
    assert_eq!(judge("always 2 * position < 1", &[&[0.4]]).verdict, Verdict::Met);
}

#[test]
fn nan_holds_nothing() {
    for formula in ["always pressure < 5", "always pressure >= 5", "always pressure = 5"] {
        assert_eq!(violated_at(&judge(formula, &[&[f64::NAN]])), Some(0), "{formula}");
    }
}

#[test]
fn what_cannot_be_meant_is_refused() {
    let wrong = |formula: &str| {
        let error = refused(formula);
        let help = error.help.as_ref().map(|help| format!(" ({help})")).unwrap_or_default();
        format!("{}: {error}{help}\n", &formula[error.place.clone()])
    };
    let formulas = [
        "always clsed",
        "always pressure",
        "always closed < 3",
        "always name = 1",
        "pressure < 5 mm",
        "pressure < 5 bars",
        "pressure + position < 3",
        "always count < 5 kg",
    ];
    insta::assert_snapshot!(formulas.map(wrong).concat());
}
