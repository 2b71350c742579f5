//! The picture of trajectories, from outside.

use onescan_report::plot::{Mark, Panel, Part, Plot, Shape, Trajectory};
use proptest::prelude::*;

fn every_ms(values: impl IntoIterator<Item = f64>) -> Trajectory {
    let values: Vec<f64> = values.into_iter().collect();
    Trajectory { t_ns: (0..values.len() as u64).map(|step| step * 1_000_000).collect(), values }
}

fn panel(signal: &str, unit: Option<&str>, shape: Shape, runs: Vec<Trajectory>) -> Panel {
    Panel { signal: signal.to_owned(), unit: unit.map(str::to_owned), shape, names: Vec::new(), runs }
}

fn small() -> Plot {
    let ramp = |gain: f64| every_ms((0..12).map(move |step| gain * f64::from(step)));
    let pulse = || every_ms((0..12).map(|step| f64::from(u8::from(step == 7))));
    let gap = || every_ms([1.0, 2.0, f64::NAN, 4.0, f64::INFINITY, 3.0, 3.0]);
    Plot {
        title: "Belts & <pulses>".to_owned(),
        runs: vec!["first".to_owned(), "second".to_owned()],
        panels: vec![
            panel("belt.position", Some("m"), Shape::Line, vec![ramp(0.01), ramp(0.011)]),
            panel("belt.at_end", None, Shape::Step, vec![pulse(), pulse()]),
            panel("belt.count", None, Shape::Step, vec![gap(), gap()]),
            panel("belt.force", Some("N"), Shape::Line, Vec::new()),
            Panel {
                names: vec![(0, "Idle".to_owned()), (2, "Running".to_owned())],
                ..panel("belt.state", None, Shape::Step, vec![every_ms([0.0, 0.0, 1.0, 2.0]); 2])
            },
        ],
        marks: vec![Mark { t_ns: 7_000_000, label: "`at end` violated".to_owned() }],
    }
}

#[test]
fn a_small_picture() {
    insta::assert_snapshot!(small().to_svg());
}

#[test]
fn a_part_of_a_small_picture_is_enlarged() {
    let part = Part::Times { from_ns: 5_500_000, until_ns: 9_000_000 };
    insta::assert_snapshot!(small().to_svg_enlarging(part).expect("there are samples"));
    let after = Part::Times { from_ns: 12_000_000, until_ns: 90_000_000 };
    let nothing = small().to_svg_enlarging(after).expect_err("after the last sample");
    assert_eq!(nothing.drawn, "time is from 0 s to 0.011 s");
}

fn small_plane() -> Plot {
    let circle = |radius: f64| {
        let places = [(1.0, 0.0), (0.7, 0.7), (0.0, 1.0), (-0.7, 0.7), (-1.0, 0.0), (f64::NAN, 0.0), (0.0, -1.0)];
        let (x, z): (Vec<f64>, Vec<f64>) = places.map(|(x, z)| (radius * x, radius * z)).into_iter().unzip();
        [every_ms(x), every_ms(z)]
    };
    let [[x, z], [wider_x, wider_z]] = [circle(1.0), circle(1.5)];
    Plot {
        title: "Tool".to_owned(),
        runs: vec!["first".to_owned(), "second".to_owned()],
        panels: vec![
            panel("tool.x", Some("m"), Shape::Line, vec![x, wider_x]),
            panel("tool.z", Some("m"), Shape::Line, vec![z, wider_z]),
        ],
        marks: Vec::new(),
    }
}

#[test]
fn a_small_plane() {
    insta::assert_snapshot!(small_plane().to_plane_svg().expect("two signals"));
    assert_eq!(Plot { panels: Vec::new(), ..small_plane() }.to_plane_svg(), None);
}

#[test]
fn a_part_of_a_small_plane_is_enlarged() {
    let part = |across, up| small_plane().to_svg_enlarging(Part::Plane { across, up });
    insta::assert_snapshot!(part([0.5, 1.0], [0.2, 0.8]).expect("a path comes there"));
    let nothing = part([5.0, 6.0], [0.0, 1.0]).expect_err("nobody comes there");
    assert_eq!(nothing.drawn, "tool.x (m) is from -1.5 to 1.5, tool.z (m) is from -1.5 to 1.5");
    assert!(part([1.0, 0.0], [0.0, 1.0]).is_err(), "an empty range");
}

#[test]
fn nothing_to_draw_is_a_picture_too() {
    insta::assert_snapshot!(
        Plot { title: String::new(), runs: Vec::new(), panels: Vec::new(), marks: Vec::new() }.to_svg()
    );
}

#[test]
fn what_readers_rely_on_is_written_down() {
    let svg = small().to_svg();
    assert!(svg.contains("<title>Belts &amp; &lt;pulses&gt;</title>"), "{svg}");
    assert!(svg.contains("belt.position (m): 2 different runs, belt.at_end: 2 identical runs"), "{svg}");
    assert!(svg.contains("fill=\"#ffffff\""), "{svg}");
}

#[test]
fn a_run_without_a_name_is_called_by_its_number() {
    let mut plot = small();
    plot.runs.truncate(1);
    let svg = plot.to_svg();
    assert!(svg.contains(">first</text>") && svg.contains(">run 2</text>"), "{svg}");
}

#[test]
fn pictures_stay_small() {
    let noise = |seed: u64, count: u64| {
        let mut state = seed;
        every_ms((0..count).map(move |_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64
        }))
    };
    let plot = |runs: u64, panels: usize, count: u64| {
        let trajectories: Vec<Trajectory> = (0..runs).map(|run| noise(run, count)).collect();
        let panels = vec![panel("noise", Some("m"), Shape::Line, trajectories); panels];
        Plot { title: "Noise".to_owned(), runs: Vec::new(), panels, marks: Vec::new() }.to_svg().len()
    };
    assert!(plot(6, 3, 600) < 150_000);
    assert!(plot(1, 1, 100_000) < 40_000);
}

#[test]
fn one_pulse_among_many_steps_is_drawn() {
    for shape in [Shape::Step, Shape::Line] {
        let drawn = |at: Option<usize>| {
            let values = (0..100_000).map(|step| f64::from(u8::from(Some(step) == at || step == 10)));
            let panels = vec![panel("pulse", None, shape, vec![every_ms(values)])];
            Plot { title: String::new(), runs: Vec::new(), panels, marks: Vec::new() }.to_svg()
        };
        let quiet = drawn(None);
        for at in [300, 50_000, 99_998] {
            assert!(drawn(Some(at)).len() > quiet.len(), "{shape:?} at step {at}");
        }
    }
}

fn value() -> impl Strategy<Value = f64> {
    prop_oneof![any::<f64>(), -1.0..1.0, prop::sample::select(vec![0.0, 1.0, f64::NAN, f64::MAX, f64::MIN])]
}

fn trajectory() -> impl Strategy<Value = Trajectory> {
    let times = prop_oneof![prop::collection::vec(any::<u64>(), 0..40), prop::collection::vec(0_u64..1000, 0..40)];
    (times, prop::collection::vec(value(), 0..40)).prop_map(|(t_ns, values)| Trajectory { t_ns, values })
}

fn any_panel() -> impl Strategy<Value = Panel> {
    let shape = prop_oneof![Just(Shape::Line), Just(Shape::Step)];
    let names = prop::collection::vec((-3_i64..5, any::<String>()), 0..4);
    (any::<String>(), any::<Option<String>>(), shape, names, prop::collection::vec(trajectory(), 0..9))
        .prop_map(|(signal, unit, shape, names, runs)| Panel { signal, unit, shape, names, runs })
}

fn any_plot() -> impl Strategy<Value = Plot> {
    let mark = (any::<u64>(), any::<String>()).prop_map(|(t_ns, label)| Mark { t_ns, label });
    let runs = prop::collection::vec(any::<String>(), 0..14);
    (any::<String>(), runs, prop::collection::vec(any_panel(), 0..5), prop::collection::vec(mark, 0..9))
        .prop_map(|(title, runs, panels, marks)| Plot { title, runs, panels, marks })
}

/// All numbers of an attribute value or a path.
fn numbers(data: &str) -> impl Iterator<Item = f64> {
    data.split(|c: char| !(c.is_ascii_digit() || c == '.')).filter_map(|number| number.parse().ok())
}

fn any_part() -> impl Strategy<Value = Part> {
    let times = prop_oneof![any::<[u64; 2]>(), (0_u64..1000, 0_u64..1000).prop_map(|(from, until)| [from, until])];
    prop_oneof![
        times.prop_map(|[from_ns, until_ns]| Part::Times { from_ns, until_ns }),
        ([value(), value()], [value(), value()]).prop_map(|(across, up)| Part::Plane { across, up }),
    ]
}

proptest! {
    #[test]
    fn any_data_make_a_picture(plot in any_plot(), part in any_part()) {
        let svg = plot.to_svg();
        prop_assert_eq!(&svg, &plot.clone().to_svg());
        prop_assert_eq!(plot.to_plane_svg().is_some(), plot.panels.len() >= 2);
        for svg in std::iter::once(svg).chain(plot.to_plane_svg()).chain(plot.to_svg_enlarging(part).ok()) {
            prop_assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
            prop_assert_eq!(svg.matches("<g ").count(), svg.matches("</g>").count());
            prop_assert!(!svg.chars().any(|c| c < ' ' && c != '\n'), "a control character is not XML");
            for data in svg.split(" d=\"").skip(1).filter_map(|rest| rest.split('"').next()) {
                prop_assert!(data.chars().all(|c| "Mhvl-. ".contains(c) || c.is_ascii_digit()), "{}", data);
                prop_assert!(numbers(data).all(|number| number < 10_000.0), "{}", data);
            }
        }
    }
}
