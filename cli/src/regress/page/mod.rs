//! One self-contained page: what was run, what came of it, in pictures. Nothing is loaded from elsewhere.
//!
//! | module | subject |
//! |---|---|
//! | [`markup`] | elements and escapes |
//! | [`section`] | one test or run |
//! | [`files`] | coverage by file |
//!
//! Equal runs give equal pages, but for the line in the header that says how long it took.

pub mod files;
pub mod markup;
pub mod section;

use std::fmt::Write as _;

use onescan_plc_shim::Coverage;
use onescan_report::plot::Plot;

use super::outcome::Report;
use super::ran::{Event, Ran};
use super::summary::totals;
use crate::run::RunReport;
use markup::escaped;
use section::Section;

const STYLE: &str = include_str!("style.css");

/// The page of a test run.
pub fn of_tests(report: &Report, coverage: &Coverage) -> String {
    let sections: Vec<Section> = report.outcomes.iter().map(Section::of_test).collect();
    let wall = format!("{:.1} s", report.wall_time.as_secs_f64());
    page("onescan test", &totals(report), &wall, &sections, coverage)
}

/// The page of the runs of one scenario, with what happened to each from outside.
pub fn of_runs(reports: &[RunReport], step_ns: u64, events: &[Event], plot: &Plot, coverage: &Coverage) -> String {
    let wall: f64 = reports.iter().map(|report| report.wall_time_s).sum();
    let sections: Vec<Section> = reports
        .iter()
        .enumerate()
        .map(|(index, report)| {
            let name = format!("run {}", report.run);
            let ran = Ran { events: events.to_vec(), ..Ran::of(&name, report, step_ns) };
            // All runs are in one picture, which stands with the first.
            Section::of_run(&ran, (index == 0).then(|| plot.to_svg()))
        })
        .collect();
    let title = reports.first().map_or_else(String::new, |report| report.scenario.clone());
    let count = format!("{} run{}", reports.len(), if reports.len() == 1 { "" } else { "s" });
    page(&title, &count, &format!("{wall:.1} s"), &sections, coverage)
}

/// A page of these sections; `wall` is how long it all took.
pub(crate) fn page(title: &str, totals: &str, wall: &str, sections: &[Section], coverage: &Coverage) -> String {
    let mut text = String::new();
    let title = escaped(title);
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<header><h1>{title}</h1>\n\
         <p>{}</p>\n<p class=\"made\">onescan {} {wall}</p></header>\n<main>\n",
        escaped(totals),
        env!("CARGO_PKG_VERSION"),
    );
    let _ = contents(&mut text, sections);
    for (index, section) in sections.iter().enumerate() {
        let _ = section.write(index, &mut text);
    }
    let _ = files::write(coverage, &mut text);
    text.push_str("</main>\n</body>\n</html>\n");
    text
}

/// A line for each section, where there are several.
fn contents(text: &mut String, sections: &[Section]) -> std::fmt::Result {
    if sections.len() < 2 {
        return Ok(());
    }
    text.push_str("<table class=\"contents\"><thead><tr><th>test<th>result<th>virtual time<th>steps</thead>\n");
    for (index, section) in sections.iter().enumerate() {
        let Section { title, status, virtual_time, steps, .. } = section;
        let (title, class) = (escaped(title), section.class());
        writeln!(
            text,
            "<tr><td><a href=\"#t{index}\">{title}</a><td class=\"{class}\">{status}<td>{virtual_time}<td>{steps}"
        )?;
    }
    text.push_str("</table>\n");
    Ok(())
}
