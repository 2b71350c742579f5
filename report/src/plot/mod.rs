//! Trajectories as a picture: panels over one time axis, several runs on top of each other.
//!
//! A plot is plain data and its picture a pure function of it: the same data give the same bytes on
//! every machine. The picture is SVG on a ground of its own, white or, where the reader prefers dark
//! pages, dark; so it reads well on any page.
//!
//! Modules in the order in which data flows through them:
//!
//! | module | subject |
//! |---|---|
//! | `range` | which times and values a panel has to show |
//! | `ticks` | round numbers along an axis, and how they are written |
//! | `lettering` | how much room a text takes |
//! | `layout` | where everything goes |
//! | `trace` | the samples of a signal as pieces of line on the picture |
//! | `reduce` | the same line with fewer points |
//! | `agreement` | how many of the runs differ |
//! | `palette` | the colours, and one stroke for each run |
//! | `caption` | names, units and the description |
//! | `svg` | elements, paths, escapes |
//! | `panel`, `mark`, `time_axis` | the parts of the picture |
//! | `part` | a part of the picture, cut out to be enlarged |
//! | `figure` | all of these as one picture |
//! | `plane` | two signals against each other |
//! | `bars` | parts of a whole |
//! | `histogram` | how many times of which length; how much of the time which values |
//! | `history` | the lowest, mean and highest values in windows of time |
//! | `chart` | the same as data, for charts in a browser |
//! | `value_map` | a table of values over two axes, as colours |
//!
//! Invariants. No input makes it panic, nothing is read from the machine (no clock, no fonts, no
//! locale), and arithmetic is limited to the operations that IEEE 754 rounds exactly. Whatever is
//! left out of a line is invisible: a sample is dropped only if the line passes within 0.02 pixels
//! of it, or if its pixel column shows lower and higher ones; a gap only if it is narrower than a
//! quarter of a pixel.
//!
//! ```
//! use onescan_report::plot::{Panel, Plot, Shape, Trajectory};
//!
//! let plot = Plot {
//!     title: "Belt".to_owned(),
//!     runs: vec!["run 1".to_owned()],
//!     panels: vec![Panel {
//!         signal: "belt.position".to_owned(),
//!         unit: Some("m".to_owned()),
//!         shape: Shape::Line,
//!         names: Vec::new(),
//!         runs: vec![Trajectory { t_ns: vec![0, 1_000_000, 2_000_000], values: vec![0.0, 0.1, 0.3] }],
//!     }],
//!     marks: Vec::new(),
//! };
//! assert!(plot.to_svg().contains("belt.position"));
//! ```

mod agreement;
mod bars;
mod caption;
mod chart;
mod figure;
mod histogram;
mod history;
mod layout;
pub mod lettering;
mod mark;
pub mod palette;
mod panel;
mod part;
mod plane;
mod range;
mod reduce;
pub mod svg;
mod ticks;
mod time_axis;
mod trace;
pub mod value_map;

pub use bars::{Bar, Bars};
pub use histogram::{Histogram, ValueHistogram};
pub use history::{History, Past};
pub use part::{NothingThere, Part};
pub use value_map::{MapAxis, ValueMap};

/// One signal in one run.
///
/// The two lists belong together sample by sample; if one is longer, its rest is not drawn. Times
/// do not decrease: where they do, the line is interrupted.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trajectory {
    /// When the samples were taken, in nanoseconds of virtual time.
    pub t_ns: Vec<u64>,
    /// What the signal was. A value that is not finite is a gap in the line.
    pub values: Vec<f64>,
}

/// How a signal moves from one sample to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    Line,
    /// At once, holding its value until the next sample: BOOL and the integers.
    Step,
}

/// One signal in all runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// The name of the signal.
    pub signal: String,
    /// The unit of its values, if they have one.
    pub unit: Option<String>,
    /// How it moves between samples.
    pub shape: Shape,
    /// Values with a name, which stands at the axis in place of the number.
    pub names: Vec<(i64, String)>,
    /// One trajectory for each run, in the same order in all panels.
    pub runs: Vec<Trajectory>,
}

/// Several signals in several runs over one time axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// What stands above the picture; nothing if empty.
    pub title: String,
    /// The names of the runs for the legend. A run without a name is called by its number.
    pub runs: Vec<String>,
    /// The panels from top to bottom.
    pub panels: Vec<Panel>,
    /// Instants that stand out.
    pub marks: Vec<Mark>,
}

/// An instant that stands out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mark {
    /// When, in nanoseconds of virtual time.
    pub t_ns: u64,
    /// What is at that instant.
    pub label: String,
}

impl Plot {
    /// The picture as an SVG document: the same plot, the same bytes.
    pub fn to_svg(&self) -> String {
        figure::draw(self, None)
    }

    /// The same with a part enlarged beside the whole, over time or in a plane, whichever it is a part of.
    ///
    /// # Errors
    /// Nothing is drawn in that part.
    pub fn to_svg_enlarging(&self, part: Part) -> Result<String, NothingThere> {
        match part {
            Part::Times { from_ns, until_ns } => Ok(figure::draw(self, Some(&part::Cut::of(self, from_ns, until_ns)?))),
            Part::Plane { across, up } => {
                let [along, upwards, ..] = &self.panels[..] else {
                    return Err(NothingThere { drawn: "there are no two signals".to_owned() });
                };
                let part = part::in_plane(along, upwards, [across, up])?;
                Ok(plane::draw(self, along, upwards, Some(part)))
            }
        }
    }

    /// The first signal against the second, across and up, as an SVG document: the paths of all
    /// runs; nothing if there are no two signals. Marks have no place in it.
    pub fn to_plane_svg(&self) -> Option<String> {
        let [along, up, ..] = &self.panels[..] else { return None };
        Some(plane::draw(self, along, up, None))
    }
}
