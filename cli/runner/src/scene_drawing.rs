//! A scene as a picture: its bodies and the rays of its sensors, in the scene's pose.

use onescan_plant::scene::model::{BodyKind, Scene, Sensing};
use onescan_plant::{self as plant, Outline};
use onescan_report::view::{Ray, Side, Solid, Stage, Surface, picture};
use onescan_scenario::Scenario;
use onescan_scenario::file::ClientFile;

/// The scene seen from a side, as SVG.
pub fn svg(scene: &Scene, title: &str, side: Side) -> String {
    let kinds = ["fixed", "moved by forces", "moved by its drive"].map(str::to_owned).to_vec();
    let room_m = extents(scene.outlines().filter(|outline| outline.kind != BodyKind::Fixed))[0];
    let solids = scene.outlines().map(|outline| solid(outline, room_m)).collect();
    let rays = scene.sensors.iter().filter_map(|sensor| match &sensor.sensing {
        Sensing::Proximity { point_m, direction, range_m, .. } => {
            let to = |axis: usize| point_m[axis] + direction[axis] * range_m;
            Some(Ray { name: sensor.name.clone(), from_m: *point_m, to_m: [to(0), to(1), to(2)] })
        }
        Sensing::EndPosition { .. } => None,
    });
    picture(&Stage { title: title.to_owned(), kinds, solids, rays: rays.collect() }, side)
}

/// How far the forms reach along the world's axes, the longest first; 0 if there are none.
fn extents<'s>(outlines: impl Iterator<Item = Outline<'s>>) -> [f64; 3] {
    let points = outlines.flat_map(|outline| match outline.surface {
        plant::Surface::Faces { faces, .. } => faces.into_iter().flatten().collect(),
        plant::Surface::Convex(points) => points,
    });
    let none = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    let ends = points.fold(none, |mut ends, at| {
        for ([low, high], part) in ends.iter_mut().zip(at) {
            (*low, *high) = (low.min(part), high.max(part));
        }
        ends
    });
    let mut extents = ends.map(|[low, high]| (high - low).max(0.0));
    extents.sort_by(|a, b| b.total_cmp(a));
    extents
}

/// A fixed body that is wider both ways than all that moves is the ground.
fn solid(outline: Outline<'_>, room_m: f64) -> Solid {
    let backdrop = outline.kind == BodyKind::Fixed && extents(std::iter::once(outline.clone()))[1] > room_m;
    let Outline { body, kind, surface } = outline;
    let kind = match kind {
        BodyKind::Fixed => 0,
        BodyKind::Dynamic => 1,
        BodyKind::Kinematic => 2,
    };
    let surface = match surface {
        plant::Surface::Faces { faces, edged } => Surface::Faces { faces, edged },
        plant::Surface::Convex(points) => Surface::Convex(points),
    };
    Solid { name: body.to_owned(), kind, backdrop, surface }
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
