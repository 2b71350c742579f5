//! Histograms and bars: what they look like, and that nothing makes them panic.

use onescan_report::plot::{Bar, Bars, Histogram};
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
        let bars = Bars { bars: values.into_iter().map(|value| bar(&text, value, false)).collect(), title: text };
        prop_assert!(bars.to_svg().ends_with("</svg>\n"));
    }
}
