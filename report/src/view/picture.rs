//! The picture of a scene: faces, rays, a scale and a legend.

use std::fmt::Write as _;

use super::Stage;
use super::face::{Seen, faces};
use super::side::{Side, dot};
use crate::number::short;
use crate::plot::lettering::{NAME_PX, TITLE_PX, shortened, width_px};
use crate::plot::palette::{ALARM, AXIS, FAINT_INK, INK};
use crate::plot::svg::{Attribute, Document};

const WIDTH_PX: f64 = 880.0;
/// The room of the scene, from the smallest to the largest height.
const HEIGHT_PX: (f64, f64) = (220.0, 620.0);
const MARGIN_PX: f64 = 24.0;
const TOP_PX: f64 = 40.0;
const FOOT_PX: f64 = 44.0;
/// The scale is no longer than this part of the width.
const SCALE_PART: f64 = 0.2;

/// Red, green and blue of each kind; more kinds begin again.
const KINDS: [[f64; 3]; 4] =
    [[176.0, 184.0, 193.0], [240.0, 180.0, 80.0], [110.0, 170.0, 220.0], [160.0, 166.0, 171.0]];

/// The scene seen from a side, as an SVG document.
pub fn picture(stage: &Stage, side: Side) -> String {
    let seen = faces(&stage.solids, side);
    let frame = Frame::of(stage, &seen, side);
    let (height, described) = ((TOP_PX + frame.height_px + FOOT_PX) as i64, described(stage, side));
    let mut document = Document::picture(WIDTH_PX as i64, height, &stage.title, &described);
    let title = shortened(&stage.title, TITLE_PX, WIDTH_PX as i64 * 9 / 10);
    let place = (MARGIN_PX as i64, 26);
    document.text(
        "text",
        &[("x", &place.0), ("y", &place.1), ("font-size", &TITLE_PX), ("font-weight", &"bold")],
        &title,
    );
    // A backdrop ends where the picture does.
    let (width, tall) = (WIDTH_PX - MARGIN_PX, frame.height_px + 8.0);
    document.open("clipPath", &[("id", &format!("room-{height}"))]);
    document.empty("rect", &[("x", &(MARGIN_PX / 2.0)), ("y", &(TOP_PX - 4.0)), ("width", &width), ("height", &tall)]);
    document.close();
    document.open("g", &[("clip-path", &format!("url(#room-{height})"))]);
    draw_faces(&mut document, &seen, &frame);
    document.close();
    draw_rays(&mut document, stage, side, &frame);
    draw_foot(&mut document, stage, &frame, height);
    document.finish()
}

fn described(stage: &Stage, side: Side) -> String {
    let mut names: Vec<&str> = stage.solids.iter().map(|solid| solid.name.as_str()).collect();
    names.dedup();
    format!("The scene from side `{}`. Bodies: {}.", side.name(), names.join(", "))
}

/// Where metres are on the picture.
struct Frame {
    left_m: f64,
    top_m: f64,
    px_per_m: f64,
    left_px: f64,
    height_px: f64,
}

impl Frame {
    fn of(stage: &Stage, seen: &[Seen<'_>], side: Side) -> Self {
        let is_bare = stage.solids.iter().all(|solid| solid.backdrop);
        let ends = stage.rays.iter().flat_map(|ray| [flat(ray.from_m, side), flat(ray.to_m, side)]);
        let before = seen.iter().filter(|seen| !seen.solid.backdrop || is_bare);
        let corners = before.flat_map(|seen| seen.corners.iter().copied()).chain(ends);
        let none = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        let finite = corners.filter(|at| at.iter().all(|part| part.is_finite()));
        let [x, y] =
            finite.fold(none, |[x, y], at| [[x[0].min(at[0]), x[1].max(at[0])], [y[0].min(at[1]), y[1].max(at[1])]]);
        let room_px = WIDTH_PX - 2.0 * MARGIN_PX;
        let (width_m, height_m) = (x[1] - x[0], y[1] - y[0]);
        let per_m = (room_px / width_m).min(HEIGHT_PX.1 / height_m);
        if !(per_m.is_finite() && per_m > 0.0 && width_m >= 0.0 && height_m >= 0.0) {
            return Self { left_m: 0.0, top_m: 0.0, px_per_m: 1.0, left_px: MARGIN_PX, height_px: HEIGHT_PX.0 };
        }
        let height_px = (height_m * per_m).max(HEIGHT_PX.0);
        Self {
            left_m: x[0],
            top_m: y[1] + (height_px / per_m - height_m) / 2.0,
            px_per_m: per_m,
            left_px: MARGIN_PX + (room_px - width_m * per_m) / 2.0,
            height_px,
        }
    }

    fn at(&self, [x, y]: [f64; 2]) -> String {
        let across = self.left_px + (x - self.left_m) * self.px_per_m;
        let down = TOP_PX + (self.top_m - y) * self.px_per_m;
        format!("{across:.1} {down:.1}")
    }
}

fn flat(at: [f64; 3], side: Side) -> [f64; 2] {
    let [right, up, _] = side.directions();
    [dot(at, right), dot(at, up)]
}

/// A group for each run of faces of one solid, so that its name is there once.
fn draw_faces(document: &mut Document, seen: &[Seen<'_>], frame: &Frame) {
    for group in seen.chunk_by(|a, b| std::ptr::eq(a.solid, b.solid) && a.light == b.light) {
        let Some(first) = group.first() else { continue };
        let colour = colour(first);
        let opacity = 1.0 - first.solid.paint.transparent;
        let mut attributes: Vec<Attribute<'_>> =
            vec![("fill", &colour), ("stroke", &colour), ("stroke-width", &"1"), ("stroke-linejoin", &"round")];
        if opacity < 1.0 {
            attributes.push(("opacity", &opacity));
        }
        document.open("g", &attributes);
        document.text("title", &[], &first.solid.name);
        let mut surface = String::new();
        let mut edges = String::new();
        for face in group {
            for (index, corner) in face.corners.iter().enumerate() {
                let _ = write!(surface, "{}{}", if index == 0 { "M" } else { "L" }, frame.at(*corner));
            }
            surface.push('z');
            for [from, to] in &face.edges {
                let _ = write!(edges, "M{}L{}", frame.at(*from), frame.at(*to));
            }
        }
        document.empty("path", &[("d", &surface)]);
        if !edges.is_empty() {
            document.empty("path", &[("d", &edges), ("stroke", &"#3d444d"), ("fill", &"none")]);
        }
        document.close();
    }
}

fn colour(seen: &Seen<'_>) -> String {
    let kind = KINDS[seen.solid.kind % KINDS.len()];
    shade(seen.solid.paint.colour.unwrap_or(kind), seen.light)
}

fn shade(colour: [f64; 3], light: f64) -> String {
    let [red, green, blue] = colour.map(|part| (part * light).clamp(0.0, 255.0).round() as u8);
    format!("#{red:02x}{green:02x}{blue:02x}")
}

fn draw_rays(document: &mut Document, stage: &Stage, side: Side, frame: &Frame) {
    for ray in &stage.rays {
        let line = format!("M{}L{}", frame.at(flat(ray.from_m, side)), frame.at(flat(ray.to_m, side)));
        document.open("g", &[("stroke", &ALARM), ("stroke-dasharray", &"5 3"), ("fill", &"none")]);
        document.text("title", &[], &ray.name);
        document.empty("path", &[("d", &line)]);
        document.close();
    }
}

/// The scale to the left, the kinds to the right.
fn draw_foot(document: &mut Document, stage: &Stage, frame: &Frame, height: i64) {
    let baseline_px = height - 16;
    let length_m = round_down((WIDTH_PX * SCALE_PART) / frame.px_per_m);
    let (left_px, length_px) = (MARGIN_PX as i64, length_m * frame.px_per_m);
    let bar = format!("M{left_px} {}v6h{length_px:.1}v-6", baseline_px - 8);
    document.empty("path", &[("d", &bar), ("stroke", &AXIS), ("fill", &"none")]);
    document.open("g", &[("font-size", &NAME_PX)]);
    let mut x = left_px + length_px as i64 + 10;
    let label = format!("{} m", short(length_m));
    document.text("text", &[("x", &x), ("y", &baseline_px), ("fill", &FAINT_INK)], &label);
    x += width_px(&label, NAME_PX) + 40;
    for (kind, name) in stage.kinds.iter().enumerate() {
        let (top_px, fill) = (baseline_px - 10, shade(KINDS[kind % KINDS.len()], 0.95));
        document.empty("rect", &[("x", &x), ("y", &top_px), ("width", &12), ("height", &12), ("fill", &fill)]);
        document.text("text", &[("x", &(x + 18)), ("y", &baseline_px), ("fill", &INK)], name);
        x += 18 + width_px(name, NAME_PX) + 24;
    }
    if !stage.rays.is_empty() {
        let line = format!("M{x} {}h22", baseline_px - 4);
        document.empty("path", &[("d", &line), ("stroke", &ALARM), ("stroke-dasharray", &"5 3")]);
        document.text("text", &[("x", &(x + 28)), ("y", &baseline_px), ("fill", &INK)], "ray of a sensor");
    }
    document.close();
}

/// The longest of 1, 2 or 5 times a power of ten that is not above `length`.
fn round_down(length: f64) -> f64 {
    let written = format!("{length:e}");
    let Some((mantissa, exponent)) = written.split_once('e') else { return length };
    let digit = match mantissa.parse::<f64>() {
        Ok(mantissa) if mantissa >= 5.0 => 5,
        Ok(mantissa) if mantissa >= 2.0 => 2,
        _ => 1,
    };
    format!("{digit}e{exponent}").parse().unwrap_or(length)
}

#[cfg(test)]
mod tests {
    use super::super::{Paint, Ray, Solid, Surface};
    use super::*;

    fn stage() -> Stage {
        let cube = |name: &str, x: f64, kind: usize| {
            let at = |a: f64, b: f64, c: f64| [x + a, b, c];
            let corners = [at(0., 0., 0.), at(1., 0., 0.), at(1., 0., 1.), at(0., 0., 1.)];
            Solid {
                name: name.to_owned(),
                kind,
                paint: Paint::default(),
                backdrop: false,
                surface: Surface::Faces { faces: vec![corners.to_vec()], edged: true },
            }
        };
        let ball = Solid {
            name: "ball & <chain>".to_owned(),
            kind: 1,
            paint: Paint::default(),
            backdrop: false,
            surface: Surface::Convex(vec![[3.0, 0.0, 0.0], [4.0, 0.0, 0.0], [3.5, 0.0, 1.0]]),
        };
        Stage {
            title: "A cell".to_owned(),
            kinds: vec!["fixed".to_owned(), "free".to_owned()],
            solids: vec![cube("table", 0.0, 0), ball],
            rays: vec![Ray { name: "S1".to_owned(), from_m: [0.0, 0.0, 1.5], to_m: [4.0, 0.0, 1.5] }],
        }
    }

    #[test]
    fn a_scene_from_the_front() {
        insta::assert_snapshot!(picture(&stage(), Side::Front));
    }

    #[test]
    fn nothing_is_a_picture_too() {
        for side in Side::ALL {
            let svg = picture(&Stage::default(), side);
            assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n") && !svg.contains("NaN"), "{svg}");
        }
    }

    #[test]
    fn a_scale_is_round() {
        assert_eq!([0.37, 7.0, 19.9, 1.0].map(round_down), [0.2, 5.0, 10.0, 1.0]);
    }
}
