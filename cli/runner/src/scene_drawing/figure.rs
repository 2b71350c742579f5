//! Figures as faces in the world, where the page has them at the start.

use std::collections::BTreeMap;

use onescan_plant::Frame;
use onescan_plant::scene::model::Scene;
use onescan_report::view::{Paint, Solid, Surface};
use onescan_scenario::Scenario;
use onescan_scenario::figure::{Figure, FigureForm};

use super::style::{Style, Styles};

/// Corners of a circle.
const SEGMENTS: usize = 32;
/// Edges of a box between these corners, by the signs of their coordinates; counter-clockwise from outside.
const CUBOID: [[[f64; 3]; 4]; 6] = [
    [[-1., -1., -1.], [-1., 1., -1.], [1., 1., -1.], [1., -1., -1.]],
    [[-1., -1., 1.], [1., -1., 1.], [1., 1., 1.], [-1., 1., 1.]],
    [[-1., -1., -1.], [1., -1., -1.], [1., -1., 1.], [-1., -1., 1.]],
    [[-1., 1., -1.], [-1., 1., 1.], [1., 1., 1.], [1., 1., -1.]],
    [[-1., -1., -1.], [-1., -1., 1.], [-1., 1., 1.], [-1., 1., -1.]],
    [[1., -1., -1.], [1., 1., -1.], [1., 1., 1.], [1., -1., 1.]],
];

/// The figures of a scenario that are to be seen, as solids of this kind, in the scenario's order.
pub(super) fn solids(scenario: &Scenario, scene: &Scene, styles: &Styles<'_>, kind: usize) -> Vec<Solid> {
    let mut places: BTreeMap<&str, Frame> =
        scene.bodies.iter().map(|body| body.name.as_str()).zip(scene.frames()).collect();
    let mut solids = Vec::new();
    for figure in &scenario.looks().figures {
        let style = styles.over(&figure.name, Style::plain(figure.colour.as_deref(), figure.transparent));
        let outer = figure.on.as_deref().and_then(|on| places.get(on));
        let within = bent(figure.place, &style);
        let place = outer.map_or(within, |outer| within.seen_from(*outer));
        // What is on it is not hidden with it.
        places.insert(&figure.name, place);
        if style.is_unseen() {
            continue;
        }
        let paint = Paint { colour: style.colour, transparent: style.transparent };
        solids.extend(surfaces(figure, &style, place).into_iter().map(|surface| Solid {
            name: figure.name.clone(),
            kind,
            paint,
            backdrop: false,
            surface,
        }));
    }
    solids
}

/// Where looks put it, in the frame of what it is on.
fn bent(place: Frame, style: &Style) -> Frame {
    let moved = [0, 1, 2].map(|axis| place.position_m[axis] + style.moved_m[axis]);
    style.turns.iter().fold(Frame { position_m: moved, ..place }, |at, (turn, about_m)| {
        let about = about_m.unwrap_or(at.position_m);
        let away = Frame { position_m: about.map(|part| -part), ..UPRIGHT };
        at.seen_from(away).seen_from(Frame { position_m: about, ..*turn })
    })
}

const UPRIGHT: Frame = Frame { position_m: [0.0; 3], rotation_xyzw: [0.0, 0.0, 0.0, 1.0] };

/// The surfaces of a figure in the world: one, or for round ones with flat ends those apart.
fn surfaces(figure: &Figure, style: &Style, place: Frame) -> Vec<Surface> {
    let half_m = half_lengths(figure.form);
    // It grows from its lower end.
    let grown = |at: [f64; 3]| {
        [0, 1, 2].map(|axis| {
            let (share, low) = (style.grown[axis], -half_m[axis]);
            at[axis] * share * style.scale + low * (1.0 - share)
        })
    };
    let placed = |at: [f64; 3]| Frame { position_m: grown(at), ..UPRIGHT }.seen_from(place).position_m;
    match figure.form {
        FigureForm::Box { .. } => {
            let corner = |signs: [f64; 3]| placed([0, 1, 2].map(|axis| signs[axis] * half_m[axis]));
            let faces = CUBOID.iter().map(|face| face.iter().map(|signs| corner(*signs)).collect()).collect();
            vec![Surface::Faces { faces, edged: true }]
        }
        FigureForm::Sphere { radius_m } => vec![Surface::Convex(globe(radius_m).into_iter().map(placed).collect())],
        FigureForm::Round { radius_m, top_radius_m, length_m, is_open } => {
            let ring = |radius_m, z| circle(radius_m, z).map(placed).collect::<Vec<_>>();
            let (low, high) = (ring(radius_m, -length_m / 2.0), ring(top_radius_m, length_m / 2.0));
            round(&low, &high, is_open)
        }
    }
}

/// A mantle between two rings, with its ends, or with its inside if it is open.
fn round(low: &[[f64; 3]], high: &[[f64; 3]], is_open: bool) -> Vec<Surface> {
    let beside = |index: usize| {
        let next = (index + 1) % low.len();
        // a cone's side has no upper edge
        let corners = [low[index], low[next], high[next], high[index]];
        if high[next] == high[index] { corners[..3].to_vec() } else { corners.to_vec() }
    };
    let mantle: Vec<Vec<[f64; 3]>> = (0..low.len()).map(beside).collect();
    let turned = |face: &Vec<[f64; 3]>| face.iter().rev().copied().collect::<Vec<_>>();
    if is_open {
        let both = mantle.iter().cloned().chain(mantle.iter().map(turned)).collect();
        return vec![Surface::Faces { faces: both, edged: false }];
    }
    let ends = vec![low.iter().rev().copied().collect(), high.to_vec()];
    vec![Surface::Faces { faces: mantle, edged: false }, Surface::Faces { faces: ends, edged: true }]
}

/// How far a form reaches from its middle along its own axes, m.
fn half_lengths(form: FigureForm) -> [f64; 3] {
    match form {
        FigureForm::Box { size_m } => size_m.map(|length| length / 2.0),
        FigureForm::Sphere { radius_m } => [radius_m; 3],
        FigureForm::Round { radius_m, top_radius_m, length_m, .. } => {
            let widest = radius_m.max(top_radius_m);
            [widest, widest, length_m / 2.0]
        }
    }
}

fn circle(radius_m: f64, z: f64) -> impl Iterator<Item = [f64; 3]> {
    (0..SEGMENTS).map(move |index| {
        let (sine, cosine) = libm::sincos(std::f64::consts::TAU * index as f64 / SEGMENTS as f64);
        [radius_m * cosine, radius_m * sine, z]
    })
}

/// Points of a ball.
fn globe(radius_m: f64) -> Vec<[f64; 3]> {
    let half = SEGMENTS / 2;
    let ring = |number: usize| {
        let (sine, cosine) = libm::sincos(std::f64::consts::PI * (number as f64 / half as f64 - 0.5));
        circle(radius_m * cosine, radius_m * sine)
    };
    (0..=half).flat_map(ring).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faces(form: FigureForm, style: &Style) -> Vec<Vec<[f64; 3]>> {
        let figure = Figure { name: "one".to_owned(), form, place: UPRIGHT, on: None, colour: None, transparent: 0.0 };
        let place = Frame::at([1.0, 2.0, 3.0], [30.0, 40.0, 50.0]);
        let all = surfaces(&figure, style, place).into_iter().map(|surface| match surface {
            Surface::Faces { faces, .. } => faces,
            Surface::Convex(points) => vec![points],
        });
        all.flatten().collect()
    }

    fn less(one: [f64; 3], other: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| one[axis] - other[axis])
    }

    fn cross(one: [f64; 3], other: [f64; 3]) -> [f64; 3] {
        let minor = |row: usize, column: usize| one[row] * other[column] - one[column] * other[row];
        [minor(1, 2), minor(2, 0), minor(0, 1)]
    }

    #[test]
    fn faces_look_outwards() {
        let style = Style::plain(None, 0.0);
        let cone = FigureForm::Round { radius_m: 0.5, top_radius_m: 0.0, length_m: 2.0, is_open: false };
        for form in [FigureForm::Box { size_m: [1.0, 2.0, 3.0] }, cone] {
            for face in faces(form, &style).iter().filter(|face| face[0] != face[1]) {
                let normal = cross(less(face[1], face[0]), less(face[2], face[1]));
                let out = less(face[0], [1.0, 2.0, 3.0]);
                let along: f64 = normal.iter().zip(out).map(|(n, o)| n * o).sum();
                assert!(along > 0.0 || normal.iter().all(|part| part.abs() < 1e-12), "{form:?} {face:?}");
            }
        }
    }

    #[test]
    fn a_level_grows_from_its_lower_end() {
        let style = Style { grown: [1.0, 1.0, 0.25], ..Style::plain(None, 0.0) };
        let figure = FigureForm::Box { size_m: [1.0, 1.0, 4.0] };
        let one =
            Figure { name: "level".to_owned(), form: figure, place: UPRIGHT, on: None, colour: None, transparent: 0.0 };
        let Surface::Faces { faces, .. } = &surfaces(&one, &style, UPRIGHT)[0] else { panic!("a box has faces") };
        let z = |pick: fn(f64, f64) -> f64| faces.iter().flatten().map(|at| at[2]).reduce(pick).expect("corners");
        assert_eq!((z(f64::min), z(f64::max)), (-2.0, -1.0));
    }
}
