//! All parts as one picture.

use super::agreement::Agreement;
use super::layout::{Contents, Height, LABEL_GAP_PX, LEGEND_LINE_PX, Layout, WIDTH_PX};
use super::lettering::{NAME_PX, TITLE_PX, shortened};
use super::mark::{Marks, NUMBERS_PX};
use super::palette::stroke;
use super::panel::Axis;
use super::svg::{Document, draw_line, draw_note};
use super::time_axis::TimeAxis;
use super::{Plot, caption};

/// Draws a plot.
pub(super) fn draw(plot: &Plot) -> String {
    let time = TimeAxis::of(plot);
    let panels: Vec<Axis<'_>> = plot.panels.iter().map(Axis::of).collect();
    let runs = caption::run_labels(plot);
    let agreements: Vec<&Agreement> = panels.iter().map(|axis| &axis.agreement).collect();
    let legend = Legend::of(&agreements, &runs);
    let heights: Vec<Height> = panels.iter().map(Axis::height).collect();
    let marks = Marks::of(plot, time.range);
    let layout = Layout::of(&Contents {
        title: &plot.title,
        run_labels: &legend.labels,
        texts: marks.texts.len(),
        value_label_px: panels.iter().map(Axis::label_px).max().unwrap_or(0),
        panels: &heights,
    });

    let title = if plot.title.is_empty() { "Trajectories" } else { &plot.title };
    let signals = panels.iter().map(|axis| (axis.panel, &axis.agreement));
    let description = caption::description(time.range, signals, &runs);
    let mut document = Document::picture(WIDTH_PX, layout.height_px, title, &description);
    draw_title(&mut document, &plot.title, &layout);
    legend.draw(&mut document, &layout);
    let numbers_px = if marks.texts.is_empty() { 0 } else { NUMBERS_PX };
    for (index, (axis, &area)) in panels.iter().zip(&layout.panels).enumerate() {
        axis.draw(&mut document, area, if index == 0 { numbers_px } else { 0 }, &time, runs.len());
    }
    marks.draw(&mut document, &layout.panels, layout.texts);
    for &area in &layout.time_labels {
        time.draw_labels(&mut document, area);
    }
    match layout.panels.last() {
        Some(&area) => time.draw(&mut document, area),
        None => draw_note(&mut document, WIDTH_PX / 2, layout.height_px - 2 * NAME_PX, "no signals"),
    }
    document.finish()
}

pub(super) fn draw_title(document: &mut Document, title: &str, layout: &Layout) {
    if title.is_empty() {
        return;
    }
    let left_px = layout.left_px();
    // Bold letters are wider than the plain ones by which texts are measured.
    let title = shortened(title, TITLE_PX, (WIDTH_PX - left_px) * 9 / 10);
    let baseline_px = layout.title_baseline_px;
    document.text(
        "text",
        &[("x", &left_px), ("y", &baseline_px), ("font-size", &TITLE_PX), ("font-weight", &"bold")],
        &title,
    );
}

/// Which lines there are; one for all runs that are equal.
pub(super) struct Legend {
    pub(super) labels: Vec<String>,
    /// The run whose stroke a line has.
    firsts: Vec<usize>,
    run_count: usize,
}

impl Legend {
    pub(super) fn of(panels: &[&Agreement], runs: &[String]) -> Self {
        let groups = Agreement::of_all(panels, runs.len()).groups();
        let names = |group: &Vec<usize>| -> Vec<&str> {
            group.iter().filter_map(|&run| runs.get(run)).map(String::as_str).collect()
        };
        Self {
            labels: groups.iter().map(|group| caption::together(&names(group))).collect(),
            firsts: groups.iter().filter_map(|group| group.first().copied()).collect(),
            run_count: runs.len(),
        }
    }

    pub(super) fn draw(&self, document: &mut Document, layout: &Layout) {
        if layout.legend.is_empty() {
            return;
        }
        document.open("g", &[("font-size", &NAME_PX)]);
        for (&run, entry) in self.firsts.iter().zip(&layout.legend) {
            let line = format!("M{} {}h{LEGEND_LINE_PX}", entry.left_px, entry.middle_px);
            draw_line(document, &line, stroke(run, self.run_count));
            let label_px = entry.left_px + LEGEND_LINE_PX + LABEL_GAP_PX;
            document.text("text", &[("x", &label_px), ("y", &(entry.middle_px + 4))], &entry.label);
        }
        document.close();
    }
}
