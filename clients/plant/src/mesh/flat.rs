//! Whether a mesh is flat, and no body.

use rapier3d::glamx::DVec3;
use rapier3d::math::Vector;
use rapier3d::prelude::SharedShape;

use super::Mesh;

/// Part of the volume around it below which a hull is flat.
const FLAT: f64 = 1e-9;
/// Part of the cube of its length above which what four corners span is a body beyond doubt.
const THICK: f64 = 1e-3;

/// Whether a mesh is too flat to be a body: pictures have such meshes for labels and for lines between colours.
pub(crate) fn is_flat(mesh: &Mesh, stretch: [f64; 3]) -> bool {
    let corners_m = stretched(mesh, stretch);
    // a hull takes long, and few meshes are flat
    !is_thick(&corners_m) && hull_is_flat(&corners_m)
}

/// The corners of a mesh, along each axis so many times as far from the origin.
pub(crate) fn stretched(mesh: &Mesh, stretch: [f64; 3]) -> Vec<[f64; 3]> {
    mesh.corners.iter().map(|corner| [0, 1, 2].map(|axis| corner[axis] * stretch[axis])).collect()
}

/// Whether four corners, each far from those before, span so much volume that their hull cannot be flat. The engine
/// also finds no hull around what is a curved sheet, which this does not.
fn is_thick(corners_m: &[[f64; 3]]) -> bool {
    let corners = || corners_m.iter().map(|corner| DVec3::from_array(*corner));
    let farthest = |distance: &dyn Fn(DVec3) -> f64| corners().max_by(|a, b| distance(*a).total_cmp(&distance(*b)));
    let Some(a) = corners().next() else { return false };
    let Some(b) = farthest(&|corner| (corner - a).length()) else { return false };
    let Some(c) = farthest(&|corner| (corner - a).cross(b - a).length()) else { return false };
    let across = (b - a).cross(c - a);
    let volume_m3 = corners().map(|corner| (corner - a).dot(across).abs() / 6.0).fold(0.0, f64::max);
    volume_m3 > THICK * (b - a).length().powi(3)
}

/// Whether the hull of corners has next to no volume.
pub(crate) fn hull_is_flat(corners_m: &[[f64; 3]]) -> bool {
    let points: Vec<_> = corners_m.iter().map(|corner| Vector::from_array(*corner)).collect();
    let volume_m3 = SharedShape::convex_hull(&points).map_or(0.0, |hull| hull.mass_properties(1.0).mass());
    volume_m3 <= FLAT * extent_m(corners_m).powi(3)
}

fn extent_m(corners_m: &[[f64; 3]]) -> f64 {
    corners_m.iter().flatten().fold(0.0_f64, |most, number| most.max(number.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flat_mesh_is_not_a_thin_one() {
        let plate = |thick: f64| {
            let corners = (0..8).map(|k| [f64::from(k & 1), f64::from(k >> 1 & 1), thick * f64::from(k >> 2)]);
            Mesh { corners: corners.collect(), triangles: vec![[0, 1, 2]] }
        };
        assert!(!is_flat(&plate(1e-3), [1.0; 3]) && is_flat(&plate(0.0), [1.0; 3]));
        assert!(!is_flat(&plate(1.0), [1.0, 1.0, 1e-3]) && is_flat(&plate(1.0), [1.0, 1.0, 0.0]));
        let line = Mesh { corners: vec![[0.0; 3], [1.0; 3], [2.0; 3]], triangles: vec![[0, 1, 2]] };
        assert!(is_flat(&line, [1.0; 3]) && is_flat(&Mesh::default(), [1.0; 3]));
    }
}
