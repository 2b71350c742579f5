//! docs/fidelity.md: textbook and catalogue values beside those of the plant at three steps.
//!
//! `UPDATE_DOCS=1 cargo test -p onescan-plant --test plant fidelity` rewrites the page.

mod contacts;
pub(crate) mod curves;
mod drives;
mod electric;
mod handling;
mod hydraulics;
mod linkage;
mod mechanics;
mod mechanisms;
mod pneumatics;
mod process;
mod robots;
mod scenes;
mod springs;
mod touching;

use std::fmt::Write as _;
use std::path::Path;

/// Turns of 100 µs, 1 ms and 10 ms.
const STEPS_US: [u64; 3] = [100, 1_000, 10_000];
/// A smaller part of the value is not shown as an error.
const SHOWN: f64 = 5e-5;
/// A greater error in turns of 1 ms needs a reason, as a part of the value, or as it is where the value is 0.
const UNEXPLAINED: f64 = 0.01;

/// A line of the page.
struct Line {
    what: &'static str,
    unit: &'static str,
    exact: f64,
    source: &'static str,
    /// The plant's value in turns of so many microseconds.
    ours: Box<dyn Fn(u64) -> f64>,
    /// Too much to compute in turns of 100 µs.
    coarse: bool,
    /// Why it is inexact in turns of 1 ms.
    reason: Option<&'static str>,
}

impl Line {
    fn new(
        what: &'static str,
        (exact, unit): (f64, &'static str),
        source: &'static str,
        ours: impl Fn(u64) -> f64 + 'static,
    ) -> Self {
        Self { what, unit, exact, source, ours: Box::new(ours), coarse: false, reason: None }
    }

    /// The same without turns of 100 µs.
    fn coarse(self) -> Self {
        Self { coarse: true, ..self }
    }

    /// The same, inexact for a reason.
    fn because(self, reason: &'static str) -> Self {
        Self { reason: Some(reason), ..self }
    }

    /// The plant's values at each step.
    fn computed(&self) -> [Option<f64>; 3] {
        STEPS_US.map(|step_us| (!self.coarse || step_us > STEPS_US[0]).then(|| (self.ours)(step_us)))
    }

    fn off(&self, ours: f64) -> f64 {
        if self.exact == 0.0 { ours } else { ours / self.exact - 1.0 }
    }

    fn cell(&self, ours: Option<f64>) -> String {
        let Some(ours) = ours else { return "-".to_owned() };
        let off = self.off(ours);
        if off.abs() < SHOWN || self.exact == 0.0 {
            return number(ours);
        }
        format!("{} ({:+.2} %)", number(ours), 100.0 * off)
    }

    /// Whether its error in turns of 1 ms asks for a reason that it does not have.
    fn lacks_a_reason(&self, ours: [Option<f64>; 3]) -> bool {
        let off = ours[1].map_or(f64::NAN, |ours| self.off(ours).abs());
        self.reason.is_none() && (off.is_nan() || off > UNEXPLAINED)
    }
}

/// Five digits; what is a rounding beside other values of the page is 0.
fn number(value: f64) -> String {
    if value.abs() < 1e-6 {
        return "0".to_owned();
    }
    let whole = value.abs().log10().floor();
    let decimals = (4.0 - whole).clamp(0.0, 9.0) as usize;
    format!("{value:.decimals$}")
}

/// What draws up the lines of a section.
type Lines = fn() -> Vec<Line>;

/// The sections of the page.
const SECTIONS: [(&str, Lines); 10] = [
    ("Joints", mechanics::falls),
    ("Springs, friction, brakes, stops", || [mechanics::swings(), springs::lines()].into_iter().flatten().collect()),
    ("Mechanisms", || [mechanics::couplings(), mechanisms::lines()].into_iter().flatten().collect()),
    ("Arms and loads", robots::lines),
    ("Electric drives", || [drives::electric(), electric::lines()].into_iter().flatten().collect()),
    ("Pneumatics", || [drives::air(), pneumatics::lines()].into_iter().flatten().collect()),
    ("Hydraulics", || [drives::oil(), hydraulics::lines()].into_iter().flatten().collect()),
    ("Tanks, heat, instruments", || [drives::water(), process::lines()].into_iter().flatten().collect()),
    ("Contacts", || [contacts::lines(), touching::lines()].into_iter().flatten().collect()),
    ("Handling", handling::lines),
];

/// A section, and what of it is inexact for no reason.
fn section(title: &str, lines: &[Line]) -> (String, Vec<&'static str>) {
    let mut text =
        format!("\n## {title}\n\n| what | exact | 100 µs | 1 ms | 10 ms | source |\n|---|---|---|---|---|---|\n");
    let (mut reasons, mut unexplained) = (String::new(), Vec::new());
    for line in lines {
        let ours = line.computed();
        let cells = ours.map(|ours| line.cell(ours)).join(" | ");
        let exact = format!("{} {}", number(line.exact), line.unit);
        writeln!(text, "| {} | {exact} | {cells} | {} |", line.what, line.source).expect("a text");
        if let Some(reason) = line.reason {
            writeln!(reasons, "- {}: {reason}.", line.what).expect("a text");
        }
        if line.lacks_a_reason(ours) {
            unexplained.push(line.what);
        }
    }
    if !reasons.is_empty() {
        write!(text, "\n{reasons}").expect("a text");
    }
    (text, unexplained)
}

/// The page, and what of it is inexact for no reason.
fn page() -> (String, Vec<&'static str>) {
    let mut page = String::from(
        "# Fidelity\n\nTextbook and catalogue values beside those of the plant, in turns of 100 µs, 1 ms and 10 ms with one \
         physics step\neach. A percentage is the error, where it is 0.005 % or more; `-` is not computed. An error of more \
         than 1 % at 1 ms has\nits reason below the table. A test computes this page and holds it to date:\n\
         `UPDATE_DOCS=1 cargo test -p onescan-plant --test plant fidelity` rewrites it. See also\n\
         [accuracy](plant.md#accuracy-and-cost).\n",
    );
    let sections = std::thread::scope(|scope| {
        let begun = SECTIONS.map(|(title, lines)| scope.spawn(move || section(title, &lines())));
        begun.map(|section| section.join().expect("a section"))
    });
    let mut unexplained = Vec::new();
    for (text, inexact) in sections {
        page += &text;
        unexplained.extend(inexact);
    }
    (page, unexplained)
}

#[test]
fn the_page_is_up_to_date() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/fidelity.md");
    let (now, unexplained) = page();
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(&path, &now).expect("written");
    }
    assert_eq!(unexplained, Vec::<&str>::new(), "these are inexact: find the fault, or say why");
    let written = std::fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(written, now, "docs/fidelity.md: UPDATE_DOCS=1 rewrites it");
}
