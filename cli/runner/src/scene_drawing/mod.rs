//! A scene as a picture: its bodies and the rays of its sensors, in the scene's pose; of a scenario its figures, too, as the page
//! shows them at the start.
//!
//! | module | subject |
//! |---|---|
//! | `style` | how bodies and figures look then |
//! | `figure` | figures as faces in the world |

mod figure;
mod style;

use std::collections::BTreeSet;

use onescan_plant::scene::model::{BodyKind, Scene, Sensing};
use onescan_plant::{self as plant, Outline};
use onescan_report::view::{Paint, Ray, Side, Solid, Stage, Surface, picture};
use onescan_scenario::file::ClientFile;
use onescan_scenario::{Scenario, ScenarioError};

use style::Styles;

/// What the kinds of solids are called.
const KINDS: [&str; 3] = ["fixed", "moved by forces", "moved by its drive"];
/// What follows them where there are figures.
const FIGURES: &str = "figure, or in its own colour";

/// The scene seen from a side, as SVG.
pub fn svg(scene: &Scene, title: &str, side: Side) -> String {
    picture(&stage(scene, title, |_| false), side)
}

/// The scene of a scenario's plant and the scenario's figures, as SVG: as they look with these values of signals, in the order of
/// the plan. Without any, looks are as before the first values come.
///
/// # Errors
/// A look or a figure of something that is not there.
pub fn svg_of(
    scenario: &Scenario,
    values: Option<&[f64]>,
    (scene, title): (&Scene, &str),
    side: Side,
) -> Result<String, ScenarioError> {
    let styles = Styles::of(scenario, values, scene)?;
    // Bodies keep the colours of the legend, which say what moves them.
    let mut stage = stage(scene, title, |outline| styles.of_body(&called(outline)).is_unseen());
    let figures = figure::solids(scenario, scene, &styles, KINDS.len());
    if !figures.is_empty() {
        stage.kinds.push(FIGURES.to_owned());
    }
    stage.solids.extend(figures);
    lay_ground(&mut stage.solids, KINDS.len());
    Ok(picture(&stage, side))
}

/// How flat a floor is: its height as a part of its width.
const FLAT: f64 = 0.1;
/// How much of the scene a floor covers, at least.
const WIDE: f64 = 0.25;
/// How far what stands on a floor may reach into it with its middle, m.
const SUNK_M: f64 = 0.01;

/// Figures that are floors, flat and wide, with nothing below them, are the ground on which all else stands. As a solid among
/// the others a floor would hide the feet of what stands on it.
fn lay_ground(solids: &mut [Solid], figures: usize) {
    let boxes: Vec<[[f64; 2]; 3]> = solids.iter().map(|solid| ends(corners(&solid.surface))).collect();
    let length = |[low, high]: [f64; 2]| (high - low).max(0.0);
    let area = |of: &[[f64; 2]; 3]| length(of[0]) * length(of[1]);
    let whole = area(&ends(solids.iter().flat_map(|solid| corners(&solid.surface))));
    let is_flat =
        |of: &[[f64; 2]; 3]| length(of[2]) <= FLAT * length(of[0]).min(length(of[1])) && area(of) >= WIDE * whole;
    let tops: Vec<Option<f64>> = solids
        .iter()
        .zip(&boxes)
        .map(|(solid, of)| (solid.kind == figures && is_flat(of)).then_some(of[2][1]))
        .collect();
    let lowest =
        boxes.iter().zip(&tops).filter(|(_, top)| top.is_none()).map(|(of, _)| f64::midpoint(of[2][0], of[2][1]));
    let lowest = lowest.fold(f64::INFINITY, f64::min);
    for (solid, top) in solids.iter_mut().zip(tops) {
        solid.backdrop |= top.is_some_and(|top| top - SUNK_M <= lowest && lowest.is_finite());
    }
}

fn corners(surface: &Surface) -> impl Iterator<Item = [f64; 3]> + '_ {
    let (faces, points): (&[Vec<[f64; 3]>], &[[f64; 3]]) = match surface {
        Surface::Faces { faces, .. } => (faces, &[]),
        Surface::Convex(points) => (&[], points),
    };
    faces.iter().flatten().chain(points).copied()
}

/// From where to where these points reach along the world's axes.
fn ends(points: impl Iterator<Item = [f64; 3]>) -> [[f64; 2]; 3] {
    let none = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    points.fold(none, |ends, at| [0, 1, 2].map(|axis| [ends[axis][0].min(at[axis]), ends[axis][1].max(at[axis])]))
}

/// What a form is called on the page.
fn called(outline: &Outline<'_>) -> String {
    outline.attached.map_or_else(|| outline.body.to_owned(), |shape| format!("{}/{shape}", outline.body))
}

fn stage(scene: &Scene, title: &str, is_hidden: impl Fn(&Outline<'_>) -> bool) -> Stage {
    let room_m = extents(scene.outlines().filter(|outline| outline.kind != BodyKind::Fixed))[0];
    let waiting: BTreeSet<&str> =
        scene.waiting().filter_map(|body| scene.bodies.get(body)).map(|body| body.name.as_str()).collect();
    let seen = scene.outlines().filter(|outline| !is_hidden(outline) && !waiting.contains(outline.body));
    let solids = seen.map(|outline| solid(outline, room_m)).collect();
    let rays = scene.sensors.iter().filter_map(|sensor| match &sensor.sensing {
        Sensing::Proximity { point_m, direction, range_m, .. } => {
            let to = |axis: usize| point_m[axis] + direction[axis] * range_m;
            Some(Ray { name: sensor.name.clone(), from_m: *point_m, to_m: [to(0), to(1), to(2)] })
        }
        Sensing::EndPosition { .. } => None,
    });
    // Who counts the bodies of the picture finds as many as there are.
    let title = match waiting.len() {
        0 => title.to_owned(),
        1 => format!("{title}; a body waits out of the world"),
        count => format!("{title}; {count} bodies wait out of the world"),
    };
    Stage { title, kinds: KINDS.map(str::to_owned).to_vec(), solids, rays: rays.collect() }
}

/// How far the forms reach along the world's axes, the longest first; 0 if there are none.
fn extents<'s>(outlines: impl Iterator<Item = Outline<'s>>) -> [f64; 3] {
    let points = outlines.flat_map(|outline| match outline.surface {
        plant::Surface::Faces { faces, .. } => faces.into_iter().flatten().collect(),
        plant::Surface::Convex(points) => points,
    });
    let mut extents = ends(points).map(|[low, high]| (high - low).max(0.0));
    extents.sort_by(|a, b| b.total_cmp(a));
    extents
}

/// A fixed body that is wider both ways than all that moves is the ground.
fn solid(outline: Outline<'_>, room_m: f64) -> Solid {
    let backdrop = outline.kind == BodyKind::Fixed && extents(std::iter::once(outline.clone()))[1] > room_m;
    let Outline { body, kind, surface, .. } = outline;
    let kind = match kind {
        BodyKind::Fixed => 0,
        BodyKind::Dynamic => 1,
        BodyKind::Kinematic => 2,
    };
    let surface = match surface {
        plant::Surface::Faces { faces, edged } => Surface::Faces { faces, edged },
        plant::Surface::Convex(points) => Surface::Convex(points),
    };
    Solid { name: body.to_owned(), kind, paint: Paint::default(), backdrop, surface }
}

/// The scenes of a scenario's plants, each as a picture. A scene that can no longer be read has none; the rest of the
/// page still reports what ran.
pub fn of_scenario(scenario: &Scenario, side: Side) -> Vec<String> {
    let drawn = scenario.file().clients.iter().filter_map(|(name, client)| {
        let ClientFile::Plant { scene, .. } = client.get_ref() else { return None };
        let scene = scenario.scene_of(name, scene).ok()?;
        (!scene.bodies.is_empty()).then(|| svg(&scene, &format!("{name} as it is set up"), side))
    });
    drawn.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const CELL: &str = include_str!("../../../../scenarios/templates/cell/plant.toml");

    #[test]
    fn what_waits_for_its_source_is_not_drawn() {
        let scene = Scene::parse(CELL, "plant.toml").expect("a scene");
        let stage = stage(&scene, "a cell", |_| false);
        let names: BTreeSet<&str> = stage.solids.iter().map(|solid| solid.name.as_str()).collect();
        assert_eq!(names, ["belt", "chute", "infeed", "pusher"].into_iter().collect());
        assert_eq!(stage.title, "a cell; 4 bodies wait out of the world");
    }
}
