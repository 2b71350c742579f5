//! Shapes from mesh files: read, brought to metres, checked to be bodies.

use std::ops::Range;

use super::error::SceneFaultKind;
use super::faults::Faults;
use super::model::Shape;
use super::number::{Allowed, Entry};
use super::placed::Placed;
use super::shapes::{Measures, MeshKeys};
use crate::mesh::flat::{hull_is_flat, stretched};

/// What a file's unit may be: from micrometres to kilometres.
const UNIT_M: Allowed = Allowed::Within(1e-6, 1e3);
/// How far from its body's origin a corner may be.
const CORNER_M: f64 = 1e4;

impl MeshKeys<'_> {
    /// The places of these keys, where they are written.
    pub(super) fn written(&self) -> [(Option<Range<usize>>, &'static str); 3] {
        [
            (self.mesh.map(Placed::span), "mesh"),
            (self.unit_m.map(Placed::span), "unit_m"),
            (self.hull.map(Placed::span), "hull"),
        ]
    }

    /// The shape that the file has, unless something is wrong with it.
    pub(super) fn shape(&self, of: &Measures<'_>, faults: &mut Faults<'_>) -> Option<Shape> {
        let Some(name) = self.mesh else {
            of.missing("mesh", faults);
            return None;
        };
        let unit_m = faults.number(Entry::new("unit_m", self.unit_m), UNIT_M).unwrap_or(1.0);
        let hull = self.hull.is_none_or(|hull| *hull.get_ref());
        if let (true, false, Some(written)) = (of.dynamic, hull, self.hull) {
            faults.add(written.span(), SceneFaultKind::OpenSurface(of.whose()));
        }
        let file = name.get_ref().clone();
        let mesh = match faults.mesh(&faults.beside(&file)) {
            Ok(mesh) => mesh,
            Err(cause) => {
                faults.add(name.span(), SceneFaultKind::Mesh { file, cause: cause.to_string() });
                return None;
            }
        };
        let stretch = self.stretch.unwrap_or([unit_m; 3]);
        let corners_m = stretched(&mesh, stretch);
        if let Some(cause) = flaw(&corners_m) {
            faults.add(name.span(), SceneFaultKind::Mesh { file, cause });
            return None;
        }
        let triangles = mesh.triangles.clone();
        Some(if hull { Shape::Hull { file, corners_m } } else { Shape::Surface { file, corners_m, triangles } })
    }
}

/// What keeps corners from being those of a body.
fn flaw(corners_m: &[[f64; 3]]) -> Option<String> {
    if corners_m.iter().flatten().any(|number| number.abs() > CORNER_M) {
        return Some(format!("has a corner more than {CORNER_M} m away: `unit_m` is the file's unit, 0.001 for mm"));
    }
    hull_is_flat(corners_m).then(|| "is flat, and no body".to_owned())
}
