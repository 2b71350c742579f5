//! The plot as data for a chart in a browser, which can be enlarged and read by a cursor.

use serde_json::{Value, json};

use super::{Mark, Panel, Plot, Shape, Trajectory};

/// Most samples of a trajectory in a chart: a page stays small enough to be sent to somebody.
const SAMPLES_MAX: usize = 20_000;
/// Samples that stand for those of a stretch of time: the first, the lowest, the highest, the last.
const KEPT_PER_STRETCH: usize = 4;

impl Plot {
    /// The plot as JSON for the chart of a page. Long trajectories are thinned: what lies between two samples that are left
    /// out is neither higher nor lower than those that are kept around them.
    pub fn to_chart(&self) -> String {
        let panel = |Panel { signal, unit, shape, names, runs }: &Panel| {
            // A step holds its value until the next one.
            let runs: Vec<Value> = runs.iter().map(|run| thinned(run, *shape)).map(data).collect();
            json!({ "signal": signal, "unit": unit, "steps": *shape == Shape::Step, "names": names, "runs": runs })
        };
        let mark = |Mark { t_ns, label }: &Mark| json!({ "t_ns": t_ns, "label": label });
        let panels: Vec<Value> = self.panels.iter().map(panel).collect();
        let marks: Vec<Value> = self.marks.iter().map(mark).collect();
        json!({ "runs": self.runs, "panels": panels, "marks": marks }).to_string()
    }
}

/// Times and values; a gap where a value is not a number.
fn data(samples: Vec<(u64, f64)>) -> Value {
    let (t_ns, values): (Vec<u64>, Vec<f64>) = samples.into_iter().unzip();
    json!({ "t_ns": t_ns, "values": values })
}

/// A trajectory in as few samples as its curve needs, and no more than a page may have.
fn thinned(run: &Trajectory, shape: Shape) -> Vec<(u64, f64)> {
    let all: Vec<(u64, f64)> = run.t_ns.iter().copied().zip(run.values.iter().copied()).collect();
    let needed = match shape {
        Shape::Step => changes(&all),
        Shape::Line => corners(&all),
    };
    if needed.len() <= SAMPLES_MAX { needed } else { stretches(&needed) }
}

/// The samples at which the value is another one, and the last.
fn changes(all: &[(u64, f64)]) -> Vec<(u64, f64)> {
    let is_last = |index: usize| index + 1 == all.len();
    let differs = |index: usize| index == 0 || all[index].1.to_bits() != all[index - 1].1.to_bits();
    (0..all.len()).filter(|index| differs(*index) || is_last(*index)).map(|index| all[index]).collect()
}

/// The samples without those in the middle of a stretch of equal values.
fn corners(all: &[(u64, f64)]) -> Vec<(u64, f64)> {
    let same = |one: usize, other: usize| all[one].1.to_bits() == all[other].1.to_bits();
    let inner = |index: &usize| *index > 0 && *index + 1 < all.len();
    let is_flat = |index: &usize| inner(index) && same(*index, *index - 1) && same(*index, *index + 1);
    (0..all.len()).filter(|index| !is_flat(index)).map(|index| all[index]).collect()
}

/// Four samples of each of equal stretches.
fn stretches(all: &[(u64, f64)]) -> Vec<(u64, f64)> {
    let length = all.len().div_ceil(SAMPLES_MAX / KEPT_PER_STRETCH);
    let mut kept = Vec::with_capacity(SAMPLES_MAX);
    for stretch in all.chunks(length) {
        let places = || 0..stretch.len();
        let by_value = |one: &usize, other: &usize| stretch[*one].1.total_cmp(&stretch[*other].1);
        let ends = [Some(0), places().min_by(by_value), places().max_by(by_value), stretch.len().checked_sub(1)];
        let mut chosen: Vec<usize> = ends.into_iter().flatten().collect();
        chosen.sort_unstable();
        chosen.dedup();
        kept.extend(chosen.into_iter().map(|place| stretch[place]));
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(shape: Shape, values: Vec<f64>) -> Plot {
        let t_ns = (0..values.len() as u64).map(|step| step * 1_000_000).collect();
        Plot {
            title: "Belt".to_owned(),
            runs: vec!["run 1".to_owned()],
            panels: vec![Panel {
                signal: "belt".to_owned(),
                unit: Some("m".to_owned()),
                shape,
                names: vec![(0, "off".to_owned())],
                runs: vec![Trajectory { t_ns, values }],
            }],
            marks: vec![Mark { t_ns: 5, label: "a < b".to_owned() }],
        }
    }

    #[test]
    fn a_plot_is_data() {
        let chart = plot(Shape::Step, vec![0.0, 0.0, 1.0, 1.0, f64::NAN, 1.0]).to_chart();
        let chart: Value = serde_json::from_str(&chart).unwrap();
        let run = json!({ "t_ns": [0, 2_000_000, 4_000_000, 5_000_000], "values": [0.0, 1.0, null, 1.0] });
        let panel = json!({ "signal": "belt", "unit": "m", "steps": true, "names": [[0, "off"]], "runs": [run] });
        let marks = json!([{ "t_ns": 5, "label": "a < b" }]);
        assert_eq!(chart, json!({ "runs": ["run 1"], "panels": [panel], "marks": marks }));
        let line = plot(Shape::Line, vec![0.0, 0.0, 0.0, 1.0, 1.0]).to_chart();
        assert!(line.contains("\"t_ns\":[0,2000000,3000000,4000000]"), "{line}");
    }

    #[test]
    fn a_pulse_of_one_step_is_in_a_long_chart() {
        let mut values: Vec<f64> = (0..1_000_000).map(|step| f64::from(step % 7)).collect();
        values[654_321] = 99.0;
        values[123_456] = -99.0;
        let run = &plot(Shape::Line, values).panels[0].runs[0];
        let kept = thinned(run, Shape::Line);
        assert!(kept.len() <= SAMPLES_MAX && kept.is_sorted_by_key(|(t_ns, _)| *t_ns));
        assert!(kept.contains(&(654_321_000_000, 99.0)) && kept.contains(&(123_456_000_000, -99.0)));
    }
}
