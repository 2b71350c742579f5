//! One test or run of a page.

use maud::{Markup, PreEscaped, html};

use super::LINE;
use crate::number::short;
use crate::plot::Plot;
use crate::table::Table;
use crate::verdict::Verdict;

/// So many events are listed; a machine's signals change often.
const EVENTS_MAX: usize = 200;

/// What a page says of one test or run.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// The test or run.
    pub title: String,
    /// How it ended, in a word.
    pub status: String,
    /// How that is taken.
    pub mood: Mood,
    /// Steps or scans, if they are known.
    pub steps: Option<u64>,
    /// Virtual time of the last of them, with its unit.
    pub virtual_time: String,
    pub facts: Vec<(&'static str, String)>,
    /// What there is to say of it.
    pub lines: Vec<String>,
    /// What it had to show.
    pub expectations: Vec<Shown>,
    /// What it produced, and what else is counted of it.
    pub tables: Vec<Table>,
    /// What happened, in the order of time.
    pub events: Vec<Event>,
    /// Its trajectories and what else is drawn of it.
    pub pictures: Vec<Picture>,
}

/// A picture and what it shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// What it shows, in a word or two.
    pub title: &'static str,
    /// An SVG document of this program.
    pub svg: String,
    /// The same as data, for a chart in its place where the page has a script for it.
    pub chart: Option<String>,
}

impl Picture {
    /// A picture that stays as it is.
    pub fn still(title: &'static str, svg: String) -> Self {
        Self { title, svg, chart: None }
    }

    /// A plot, which becomes a chart where the page has a script for it.
    pub fn of_plot(title: &'static str, plot: &Plot) -> Self {
        Self { title, svg: plot.to_svg(), chart: Some(plot.to_chart()) }
    }

    fn markup(&self) -> Markup {
        // `<` begins the end of a script, and means the same in a text of JSON when it is written so.
        let chart = self.chart.as_ref().map(|data| data.replace('<', "\\u003c"));
        html! {
            figure {
                figcaption { h3 { (self.title) } } (PreEscaped(&self.svg))
                @if let Some(data) = chart { (LINE) script type="application/json" { (PreEscaped(data)) } }
            } (LINE)
        }
    }
}

/// How a status is taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mood {
    /// As all should be.
    #[default]
    Good,
    Open,
    /// To be looked at.
    Bad,
}

impl Mood {
    pub(super) fn class(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Open => "open",
            Self::Bad => "bad",
        }
    }

    /// The class of a whole row or section, by which some are hidden.
    pub(super) fn of(self) -> &'static str {
        if self == Self::Bad { "of-bad" } else { "of-good" }
    }
}

impl From<Verdict> for Mood {
    fn from(verdict: Verdict) -> Self {
        match verdict {
            Verdict::Met => Self::Good,
            Verdict::Open => Self::Open,
            Verdict::Violated => Self::Bad,
        }
    }
}

/// What came of an expectation.
#[derive(Clone, Debug)]
pub struct Shown {
    pub name: String,
    /// Whether it was met.
    pub verdict: Verdict,
    /// When it was first violated, with the unit; empty if it was not.
    pub at: String,
    /// What its signals were then.
    pub values: Vec<(String, f64)>,
    /// By how much it was met; absent where that is infinite or not known.
    pub margin: Option<f64>,
    /// What the margin is measured in, if that is one unit.
    pub unit: Option<String>,
}

#[derive(Clone, Debug)]
pub struct Event {
    /// When, with the unit.
    pub at: String,
    pub what: String,
}

impl Section {
    pub(super) fn markup(&self, index: usize) -> Markup {
        html! {
            section id=(format!("t{index}")) class=(self.mood.of()) {
                h2 { (self.title) " " span class=(self.mood.class()) { (self.status) } } (LINE)
                @if !self.lines.is_empty() { pre { (self.lines.join("\n")) } (LINE) }
                table {
                    @for (name, value) in &self.facts { tr { th { (name) } td class="value" { (value) } } (LINE) }
                } (LINE)
                @if !self.expectations.is_empty() { (expectations(&self.expectations)) (LINE) }
                @for table in &self.tables { (table_markup(table)) (LINE) }
                // The picture is a document of this program, whose own text is escaped.
                @if !self.pictures.is_empty() {
                    div class="pictures" { (LINE)
                        @for picture in &self.pictures { (picture.markup()) }
                    } (LINE)
                }
                @if !self.events.is_empty() { (events(&self.events)) (LINE) }
            }
        }
    }
}

fn expectations(all: &[Shown]) -> Markup {
    let values = |shown: &Shown| -> String {
        let values: Vec<String> =
            shown.values.iter().map(|(signal, value)| format!("{signal} = {}", short(*value))).collect();
        values.join(", ")
    };
    // Where all are met, nothing was seen at a time.
    let has_times = all.iter().any(|shown| !shown.at.is_empty() || !shown.values.is_empty());
    html! {
        h3 { "expectations" } (LINE)
        table {
            thead { tr {
                th { "name" } th { "verdict" } @if has_times { th { "at" } th { "signals" } } th { "margin" }
            } } (LINE)
            @for shown in all {
                tr {
                    td { (shown.name) }
                    td class=(Mood::from(shown.verdict).class()) { (shown.verdict.word()) }
                    @if has_times { td { (shown.at) } td class="value" { (values(shown)) } }
                    td { (margin(shown)) }
                } (LINE)
            }
        }
    }
}

/// A column whose cells say what they are has no heading; an empty one is read out as one.
fn heading(head: &str) -> Markup {
    html! { @if head.is_empty() { td {} } @else { th { (head) } } }
}

fn table_markup(table: &Table) -> Markup {
    let cells = html! {
        table {
            thead { tr { th { (table.title) } @for head in &table.head { (heading(head)) } } } (LINE)
            @for row in &table.rows { tr { @for cell in row { td { (cell) } } } (LINE) }
        }
    };
    html! {
        @if table.is_folded {
            details { summary { (table.title) } (cells) }
        } @else {
            (cells)
        }
        @for remark in &table.remarks { p { (remark) } (LINE) }
    }
}

fn margin(shown: &Shown) -> String {
    let unit = shown.unit.as_ref().map(|unit| format!(" {unit}")).unwrap_or_default();
    shown.margin.map(|margin| format!("{}{unit}", short(margin))).unwrap_or_default()
}

fn events(all: &[Event]) -> Markup {
    html! {
        details {
            summary { (all.len()) " events" } (LINE)
            table {
                @for Event { at, what } in all.iter().take(EVENTS_MAX) {
                    tr { td class="value" { (at) } td { (what) } } (LINE)
                }
                @if let Some(more @ 1..) = all.len().checked_sub(EVENTS_MAX) {
                    tr { td {} td { "... and " (more) " more" } } (LINE)
                }
            }
        }
    }
}
