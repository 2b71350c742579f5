//! The map as SVG: a column for each client, a line with its signal's name from the writer to every
//! reader. What is wrong is drawn in red, what nobody reads ends beside its writer.

use onescan_report::plot::lettering::{NAME_PX, TITLE_PX, shortened, width_px};
use onescan_report::plot::palette::{ALARM, AXIS, FAINT_INK, GROUND, INK};
use onescan_report::plot::svg::Document;

use super::fold::{Line, fold};
use super::map::{Map, TroubleKind};

const MARGIN_PX: i64 = 40;
const COLUMN_PX: i64 = 420;
const ROW_PX: i64 = 26;
const TOP_PX: i64 = 110;
const BOX_PX: (i64, i64) = (150, 34);
const STUB_PX: i64 = 36;

/// A row of the drawing, which may stand for several signals.
struct Row {
    name: String,
    ty: String,
    writer: usize,
    readers: Vec<usize>,
    wrong: bool,
}

pub(super) fn svg(map: &Map, title: &str) -> String {
    let rows = rows(map);
    let columns = map.clients.len() as i64;
    let boxes = MARGIN_PX + BOX_PX.0 + (columns - 1).max(0) * COLUMN_PX;
    let stubs = rows.iter().filter(|row| row.readers.is_empty());
    let stubs = stubs.map(|row| x_of(row.writer) + STUB_PX + 6 + width_px(&label(row), NAME_PX)).max();
    let width = boxes.max(stubs.unwrap_or_default()) + MARGIN_PX;
    let height = TOP_PX + ROW_PX * (rows.len() as i64 + 1);
    let mut document = Document::picture(width, height, &format!("{title}: wiring"), "");
    document.open("g", &[("font-size", &NAME_PX)]);
    let heading: [(&str, &dyn std::fmt::Display); 5] =
        [("x", &MARGIN_PX), ("y", &30), ("font-size", &TITLE_PX), ("font-weight", &"bold"), ("fill", &INK)];
    document.text("text", &heading, &format!("{title}: wiring"));
    for (index, member) in map.clients.iter().enumerate() {
        client(&mut document, index, height, &member.name, member.kind);
    }
    for (index, row) in rows.iter().enumerate() {
        arrows(&mut document, TOP_PX + ROW_PX * (index as i64 + 1), row);
    }
    document.finish()
}

fn label(row: &Row) -> String {
    format!("{} : {}", row.name, row.ty)
}

/// Where the line of a client's column is.
fn x_of(client: usize) -> i64 {
    MARGIN_PX + BOX_PX.0 / 2 + client as i64 * COLUMN_PX
}

fn client(document: &mut Document, index: usize, height: i64, name: &str, kind: &str) {
    let x = x_of(index);
    let (left, top) = (x - BOX_PX.0 / 2, 50);
    let (foot, below) = (height - ROW_PX / 2, top + BOX_PX.1);
    document.empty("line", &[("x1", &x), ("y1", &below), ("x2", &x), ("y2", &foot), ("stroke", &AXIS)]);
    let (width, tall) = BOX_PX;
    document.empty(
        "rect",
        &[
            ("x", &left),
            ("y", &top),
            ("width", &width),
            ("height", &tall),
            ("rx", &4),
            ("fill", &GROUND),
            ("stroke", &INK),
        ],
    );
    let label = shortened(name, NAME_PX, width - 12);
    let (name_y, kind_y) = (top + 15, top + 28);
    document.text("text", &[("x", &x), ("y", &name_y), ("text-anchor", &"middle"), ("fill", &INK)], &label);
    document.text(
        "text",
        &[("x", &x), ("y", &kind_y), ("text-anchor", &"middle"), ("font-size", &10), ("fill", &FAINT_INK)],
        kind,
    );
}

fn arrows(document: &mut Document, y: i64, row: &Row) {
    let colour = if row.wrong { ALARM } else { INK };
    let from = x_of(row.writer);
    document.empty("circle", &[("cx", &from), ("cy", &y), ("r", &3), ("fill", &colour)]);
    let label = label(row);
    let above = y - 5;
    if row.readers.is_empty() {
        let to = from + STUB_PX;
        document.empty(
            "line",
            &[("x1", &from), ("y1", &y), ("x2", &to), ("y2", &y), ("stroke", &colour), ("stroke-dasharray", &"3 3")],
        );
        let (x, y) = (to + 6, y + 4);
        document.text("text", &[("x", &x), ("y", &y), ("fill", &if row.wrong { ALARM } else { FAINT_INK })], &label);
        return;
    }
    for reader in &row.readers {
        let to = x_of(*reader);
        let way = if to > from { 1 } else { -1 };
        let (neck, tip) = (to - 7 * way, to - way);
        document.empty("line", &[("x1", &from), ("y1", &y), ("x2", &neck), ("y2", &y), ("stroke", &colour)]);
        let head = format!("M{tip} {y}L{neck} {}v8z", y - 4);
        document.empty("path", &[("d", &head), ("fill", &colour)]);
    }
    let nearest = row.readers.iter().map(|reader| x_of(*reader)).min_by_key(|x| (x - from).abs()).unwrap_or(from);
    let middle = from.midpoint(nearest);
    let label = shortened(&label, NAME_PX, COLUMN_PX - 24);
    let half = width_px(&label, NAME_PX) / 2 + 2;
    let (left, wide) = (middle - half, 2 * half);
    let over = y - 17;
    document.empty("rect", &[("x", &left), ("y", &over), ("width", &wide), ("height", &14), ("fill", &GROUND)]);
    document.text("text", &[("x", &middle), ("y", &above), ("text-anchor", &"middle"), ("fill", &colour)], &label);
}

/// The signals, arrays as one row, and what is not declared at its end.
fn rows(map: &Map) -> Vec<Row> {
    let wrong = |signal: &str| {
        map.troubles.iter().any(|trouble| trouble.signal == signal && trouble.kind != TroubleKind::Unread)
    };
    let column = |client: &str| map.clients.iter().position(|member| member.name == client);
    let mut lines: Vec<Line> = Vec::new();
    for signal in &map.signals {
        let Some(writer) = column(&signal.writer.client) else { continue };
        let readers = signal.readers.iter().filter_map(|reader| column(&reader.client));
        let readers: Vec<String> = readers.map(|reader| reader.to_string()).collect();
        let key = format!("{writer};{};{}", readers.join(","), wrong(&signal.name));
        lines.push(vec![signal.name.clone(), signal.ty.clone(), key]);
    }
    lines.sort_by(|one, other| one[2].cmp(&other[2]));
    fold(&lines).into_iter().filter_map(row).collect()
}

fn row(line: Line) -> Option<Row> {
    let [name, ty, key] = <[String; 3]>::try_from(line).ok()?;
    let mut parts = key.split(';');
    let writer = parts.next()?.parse().ok()?;
    let readers = parts.next()?.split(',').filter_map(|reader| reader.parse().ok()).collect();
    Some(Row { name, ty, writer, readers, wrong: parts.next()? == "true" })
}
