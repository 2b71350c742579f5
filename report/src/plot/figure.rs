//! All parts as one picture.

use super::agreement::Agreement;
use super::layout::{Contents, Height, LABEL_GAP_PX, LEGEND_LINE_PX, Layout, WIDTH_PX};
use super::lettering::{NAME_PX, TITLE_PX, shortened};
use super::mark::{Marks, NUMBERS_PX};
use super::palette::stroke;
use super::panel::Axis;
use super::part::{Cut, draw_edge, draw_frame};
use super::range::{TimeRange, is_empty};
use super::svg::{Document, draw_line, draw_note};
use super::time_axis::TimeAxis;
use super::trace::{Area, Frame};
use super::{Plot, caption};

/// Draws a plot, with a part of it enlarged beside the whole if one is given.
pub(super) fn draw(plot: &Plot, cut: Option<&Cut>) -> String {
    let times = TimeRange::of(plot);
    let panels: Vec<Axis<'_>> = plot.panels.iter().map(Axis::of).collect();
    let enlarged: Option<Vec<Axis<'_>>> = cut.map(|cut| cut.panels.iter().map(Axis::of).collect());
    let runs = caption::run_labels(plot);
    let agreements: Vec<&Agreement> = panels.iter().map(|axis| &axis.agreement).collect();
    let legend = Legend::of(&agreements, &runs);
    let heights: Vec<Height> = panels.iter().map(Axis::height).collect();
    let marks = Marks::of(plot, times);
    let widest = |axes: &Vec<Axis<'_>>| axes.iter().map(Axis::label_px).max().unwrap_or(0);
    let layout = Layout::of(&Contents {
        title: &plot.title,
        run_labels: &legend.labels,
        texts: marks.texts.len(),
        value_label_px: widest(&panels),
        beside_label_px: enlarged.as_ref().map(widest),
        panels: &heights,
    });

    let title = if plot.title.is_empty() { "Trajectories" } else { &plot.title };
    let signals = panels.iter().map(|axis| (axis.panel, &axis.agreement));
    let description = caption::description(times, cut.map(|cut| cut.times), signals, &runs);
    let mut document = Document::picture(WIDTH_PX, layout.height_px, title, &description);
    draw_title(&mut document, &plot.title, &layout);
    legend.draw(&mut document, &layout);
    let numbers_px = if marks.texts.is_empty() { 0 } else { NUMBERS_PX };
    let time = if cut.is_some() { TimeAxis::of_column(times) } else { TimeAxis::of(times) };
    let whole = Column { axes: &panels, time, areas: &layout.panels, labelled: &layout.time_labels, marks: &marks };
    whole.draw(&mut document, &layout, numbers_px, runs.len());
    if let (Some(cut), Some(enlarged), Some(beside)) = (cut, &enlarged, layout.beside) {
        let areas = |areas: &[Area]| -> Vec<Area> { areas.iter().map(|area| beside.next_to(*area)).collect() };
        let (right, labelled) = (areas(&layout.panels), areas(&layout.time_labels));
        let (time, marks) = (TimeAxis::of_column(cut.times), marks.within(cut.times));
        let column = Column { axes: enlarged, time, areas: &right, labelled: &labelled, marks: &marks };
        column.draw(&mut document, &layout, numbers_px, runs.len());
        whole.draw_frames(&mut document, &column);
    }
    document.finish()
}

/// Panels beneath each other, over one time axis.
struct Column<'a> {
    axes: &'a [Axis<'a>],
    time: TimeAxis,
    areas: &'a [Area],
    /// Those that have the labels of the time axis beneath them, beside the last one.
    labelled: &'a [Area],
    marks: &'a Marks,
}

impl Column<'_> {
    /// Draws all of it; `numbers_px` is the room for the numbers of marks above the first panel.
    fn draw(&self, document: &mut Document, layout: &Layout, numbers_px: i64, run_count: usize) {
        for (index, (axis, &area)) in self.axes.iter().zip(self.areas).enumerate() {
            axis.draw(document, area, if index == 0 { numbers_px } else { 0 }, &self.time, run_count);
        }
        self.marks.draw(document, self.areas, layout.texts);
        for &area in self.labelled {
            self.time.draw_labels(document, area);
        }
        match self.areas.last() {
            Some(&area) => self.time.draw(document, area),
            None => draw_note(document, WIDTH_PX / 2, layout.height_px - 2 * NAME_PX, "no signals"),
        }
    }

    /// Draws frames around what another column shows enlarged, here and there.
    fn draw_frames(&self, document: &mut Document, enlarged: &Self) {
        let here = self.axes.iter().zip(self.areas);
        for ((axis, &area), (part, &edge)) in here.zip(enlarged.axes.iter().zip(enlarged.areas)) {
            let frame = Frame { area, times: self.time.range, values: axis.values };
            if !is_empty(part.panel) {
                draw_frame(
                    document,
                    frame.place(enlarged.time.range.start_ns, part.values.low),
                    frame.place(enlarged.time.range.end_ns, part.values.high),
                );
                draw_edge(document, edge);
            }
        }
    }
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
