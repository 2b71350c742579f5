//! All parts as one picture.

use super::layout::{Contents, Height, LABEL_GAP_PX, LEGEND_LINE_PX, Layout, WIDTH_PX};
use super::lettering::{FONT_FAMILY, NAME_PX, TITLE_PX, shortened};
use super::mark::draw_marks;
use super::palette::{GROUND, INK, stroke};
use super::panel::Axis;
use super::svg::{Document, draw_line, draw_note};
use super::time_axis::TimeAxis;
use super::{Plot, caption};

/// Draws a plot.
pub(super) fn draw(plot: &Plot) -> String {
    let time = TimeAxis::of(plot);
    let panels: Vec<Axis<'_>> = plot.panels.iter().map(Axis::of).collect();
    let run_labels = caption::run_labels(plot);
    let heights: Vec<Height> = panels.iter().map(Axis::height).collect();
    let layout = Layout::of(&Contents {
        title: &plot.title,
        run_labels: &run_labels,
        value_label_px: panels.iter().map(Axis::label_px).max().unwrap_or(0),
        panels: &heights,
    });

    let mut document = Document::default();
    open(&mut document, layout.height_px);
    document.text("title", &[], if plot.title.is_empty() { "Trajectories" } else { &plot.title });
    let signals = panels.iter().map(|axis| (axis.panel, &axis.agreement));
    document.text("desc", &[], &caption::description(time.range, signals, &run_labels));
    document.empty("rect", &[("width", &WIDTH_PX), ("height", &layout.height_px), ("fill", &GROUND)]);
    draw_title(&mut document, &plot.title, &layout);
    draw_legend(&mut document, &layout);
    for (axis, &area) in panels.iter().zip(&layout.panels) {
        axis.draw(&mut document, area, &time, run_labels.len());
    }
    draw_marks(&mut document, plot, &layout.panels, &time);
    match layout.panels.last() {
        Some(&area) => time.draw(&mut document, area),
        None => draw_note(&mut document, WIDTH_PX / 2, layout.height_px - 2 * NAME_PX, "no signals"),
    }
    document.finish()
}

pub(super) fn open(document: &mut Document, height_px: i64) {
    document.open(
        "svg",
        &[
            ("xmlns", &"http://www.w3.org/2000/svg"),
            ("width", &WIDTH_PX),
            ("height", &height_px),
            ("viewBox", &format!("0 0 {WIDTH_PX} {height_px}")),
            ("role", &"img"),
            ("font-family", &FONT_FAMILY),
            ("fill", &INK),
        ],
    );
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

pub(super) fn draw_legend(document: &mut Document, layout: &Layout) {
    if layout.legend.is_empty() {
        return;
    }
    document.open("g", &[("font-size", &NAME_PX)]);
    for (run, entry) in layout.legend.iter().enumerate() {
        let line = format!("M{} {}h{LEGEND_LINE_PX}", entry.left_px, entry.middle_px);
        draw_line(document, &line, stroke(run, layout.legend.len(), 0));
        let label_px = entry.left_px + LEGEND_LINE_PX + LABEL_GAP_PX;
        document.text("text", &[("x", &label_px), ("y", &(entry.middle_px + 4))], &entry.label);
    }
    document.close();
}
