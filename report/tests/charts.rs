//! Histograms, histories and bars: what they look like, and that nothing makes them panic.

use onescan_report::plot::{Bar, Bars, Histogram, History, Past, ValueHistogram};
use proptest::prelude::*;

fn histogram(counts: &[u64]) -> Histogram {
    Histogram {
        title: "hand-over".to_owned(),
        remark: "7 cycles, median 0.03 s".to_owned(),
        from_ns: 20_000_000,
        bin_ns: 10_000_000,
        counts: counts.to_vec(),
    }
}

fn bar(name: &str, value: f64, is_faint: bool) -> Bar {
    Bar { name: name.to_owned(), value, label: format!("{value} s"), is_faint }
}

#[test]
fn a_histogram_is_bars_over_an_axis_of_time() {
    insta::assert_snapshot!(histogram(&[2, 4, 0, 1]).to_svg());
}

fn values(shares: &[f64]) -> ValueHistogram {
    ValueHistogram {
        title: "zone 3".to_owned(),
        remark: "2 % above".to_owned(),
        unit: Some("°C".to_owned()),
        from: 200.0,
        to: 280.0,
        shares: shares.to_vec(),
    }
}

fn history(windows: &[Option<[f64; 3]>]) -> History {
    let past =
        |signal: &str| Past { signal: signal.to_owned(), unit: Some("°C".to_owned()), windows: windows.to_vec() };
    History {
        title: "zones".to_owned(),
        from_ns: 0,
        to_ns: 302_400_000_000_000,
        window_ns: 86_400_000_000_000,
        signals: vec![past("zone 3"), past("zone <4>")],
    }
}

#[test]
fn a_histogram_of_values_is_bars_over_an_axis_of_values() {
    insta::assert_snapshot!(values(&[0.25, 0.5, 0.0, 0.23]).to_svg());
}

#[test]
fn a_history_is_a_band_with_a_line_in_it() {
    insta::assert_snapshot!(
        history(&[Some([200.0, 210.0, 230.0]), None, Some([205.0; 3]), Some([180.0, 190.0, 200.0])]).to_svg()
    );
    assert!(history(&[None, None]).to_svg().contains("no values"));
    assert!(History { signals: Vec::new(), ..history(&[]) }.to_svg().contains("nothing"));
}

#[test]
fn bars_have_their_names_and_numbers() {
    let bars = [bar("jam & stop", 12.0, false), bar("set-up", 3.0, true), bar("never", 0.0, false)];
    insta::assert_snapshot!(Bars { title: "down 15 s of 60 s".to_owned(), bars: bars.to_vec() }.to_svg());
    assert!(Bars { title: String::new(), bars: Vec::new() }.to_svg().contains("nothing"));
}

#[test]
fn one_among_thousands_can_be_seen() {
    let svg = histogram(&[100_000, 1]).to_svg();
    assert_eq!(svg.matches("v1h-").count(), 1, "a bar of one pixel: {svg}");
}

proptest! {
    #[test]
    fn nothing_makes_them_panic(
        from_ns: u64,
        bin_ns: u64,
        counts in prop::collection::vec(any::<u64>(), 0..40),
        values in prop::collection::vec(any::<f64>(), 0..10),
        text in ".*",
    ) {
        let histogram = Histogram { title: text.clone(), remark: text.clone(), from_ns, bin_ns, counts };
        prop_assert!(histogram.to_svg().ends_with("</svg>\n"));
        let past = values.chunks_exact(3).map(|three| Some([three[0], three[1], three[2]])).collect();
        let past = Past { signal: text.clone(), unit: Some(text.clone()), windows: past };
        let history = History { title: text.clone(), from_ns, to_ns: bin_ns, window_ns: bin_ns, signals: vec![past] };
        prop_assert!(history.to_svg().ends_with("</svg>\n"));
        let edges = (values.first().copied().unwrap_or(0.0), values.last().copied().unwrap_or(1.0));
        let spread = ValueHistogram { from: edges.0, to: edges.1, ..self::values(&values) };
        prop_assert!(spread.to_svg().ends_with("</svg>\n"));
        let bars = Bars { bars: values.into_iter().map(|value| bar(&text, value, false)).collect(), title: text };
        prop_assert!(bars.to_svg().ends_with("</svg>\n"));
    }
}
