//! Faces on the picture, those behind first.

use super::hull::hull;
use super::side::{Side, cross, dot, unit};
use super::{Solid, Surface};

/// A face is cut so that no part is longer than this part of the scene: the order of large faces by their middles alone
/// would be wrong.
const PART_OF_SCENE: f64 = 1.0 / 30.0;
/// A face has no more parts than this along a side.
const PARTS_MAX: usize = 40;

/// A face, or a part of one.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Seen<'s> {
    pub(super) solid: &'s Solid,
    /// Corners on the picture, m.
    pub(super) corners: Vec<[f64; 2]>,
    /// How near its middle is to the viewer, m.
    pub(super) near: f64,
    /// How bright it is, from 0 to 1.
    pub(super) light: f64,
    /// Sides that are edges of its form.
    pub(super) edges: Vec<[[f64; 2]; 2]>,
}

/// All faces that look to the viewer, those behind first.
pub(super) fn faces(solids: &[Solid], side: Side) -> Vec<Seen<'_>> {
    let directions = side.directions();
    let largest_m = PART_OF_SCENE * span(solids);
    let mut all: Vec<Seen<'_>> = Vec::new();
    for solid in solids {
        match &solid.surface {
            Surface::Faces { faces, edged } => {
                // Nothing is behind a backdrop but another one.
                let largest_m = if solid.backdrop { f64::INFINITY } else { largest_m };
                for corners in faces {
                    all.extend(parts(solid, corners, *edged, largest_m, directions));
                }
            }
            Surface::Convex(points) => all.extend(outline(solid, points, directions)),
        }
    }
    // Faces at one distance keep the scene's order.
    all.sort_by(|a, b| b.solid.backdrop.cmp(&a.solid.backdrop).then(a.near.total_cmp(&b.near)));
    all
}

/// The longest side of the box around everything.
fn span(solids: &[Solid]) -> f64 {
    let points = || {
        solids.iter().filter(|solid| !solid.backdrop).flat_map(|solid| match &solid.surface {
            Surface::Faces { faces, .. } => faces.iter().flatten().collect::<Vec<_>>(),
            Surface::Convex(points) => points.iter().collect(),
        })
    };
    let along = |axis: usize| {
        let ends = points()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at[axis]), high.max(at[axis])));
        ends.1 - ends.0
    };
    (0..3).map(along).fold(0.0, f64::max)
}

fn on_picture(at: [f64; 3], [right, up, _]: [[f64; 3]; 3]) -> [f64; 2] {
    [dot(at, right), dot(at, up)]
}

/// How bright a face with this normal is: most from above, a little less from the sides.
fn light(normal: [f64; 3]) -> f64 {
    let lamp = unit([-0.35, -0.6, 1.0]);
    0.62 + 0.38 * dot(normal, lamp).max(-0.6)
}

fn outline<'s>(solid: &'s Solid, points: &[[f64; 3]], directions: [[f64; 3]; 3]) -> Option<Seen<'s>> {
    let flat: Vec<[f64; 2]> = points.iter().map(|at| on_picture(*at, directions)).collect();
    let corners = hull(&flat);
    let next = corners.iter().cycle().skip(1);
    let edges = corners.iter().zip(next).map(|(from, to)| [*from, *to]).collect();
    let count = points.len().max(1) as f64;
    let near = points.iter().map(|at| dot(*at, directions[2])).sum::<f64>() / count;
    (corners.len() > 2).then_some(Seen { solid, edges, corners, near, light: 0.9 })
}

/// The parts of a face that looks to the viewer.
fn parts<'s>(
    solid: &'s Solid,
    corners: &[[f64; 3]],
    edged: bool,
    largest_m: f64,
    directions: [[f64; 3]; 3],
) -> Vec<Seen<'s>> {
    let [a, b, c, ..] = corners else { return Vec::new() };
    let normal = unit(cross(less(*b, *a), less(*c, *b)));
    // Edge-on faces vanish, too.
    if dot(normal, directions[2]) <= 1e-9 || !corners.iter().flatten().all(|part| part.is_finite()) {
        return Vec::new();
    }
    let whole = Patch { solid, directions, light: light(normal), largest_m };
    match corners {
        [a, b, c] => return whole.parts([*a, *b, *c, *c], [edged, edged, false, edged]),
        [a, b, c, d] => return whole.parts([*a, *b, *c, *d], [edged; 4]),
        // Fewer than three corners have been left out above; more than four follow.
        _ => {}
    }
    // Other faces are cut into triangles around their middle, which are patches with two corners in one place.
    let middle = [0, 1, 2].map(|axis| corners.iter().map(|at| at[axis]).sum::<f64>() / corners.len() as f64);
    let next = corners.iter().cycle().skip(1);
    let triangle =
        |(from, to): (&[f64; 3], &[f64; 3])| whole.parts([*from, *to, middle, middle], [edged, false, false, false]);
    corners.iter().zip(next).flat_map(triangle).collect()
}

/// What the parts of a face have in common.
struct Patch<'s> {
    solid: &'s Solid,
    directions: [[f64; 3]; 3],
    light: f64,
    largest_m: f64,
}

impl<'s> Patch<'s> {
    /// The parts between four corners, of whose sides these are edges.
    fn parts(&self, corners: [[f64; 3]; 4], edges: [bool; 4]) -> Vec<Seen<'s>> {
        let (columns, rows) = (self.count(corners[0], corners[1]), self.count(corners[1], corners[2]));
        let at = |column: usize, row: usize| {
            let (across, up) = (column as f64 / columns as f64, row as f64 / rows as f64);
            [0, 1, 2].map(|axis| {
                let [from, to, above_to, above] = corners.map(|corner| corner[axis]);
                let (low, high) = (from + (to - from) * across, above + (above_to - above) * across);
                low + (high - low) * up
            })
        };
        let part = |(column, row): (usize, usize)| {
            let outer = [row == 0, column + 1 == columns, row + 1 == rows, column == 0];
            let corners = [at(column, row), at(column + 1, row), at(column + 1, row + 1), at(column, row + 1)];
            self.seen(corners, [0, 1, 2, 3].map(|side| outer[side] && edges[side]))
        };
        (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row))).map(part).collect()
    }

    /// Into how many parts a side is cut.
    fn count(&self, from: [f64; 3], to: [f64; 3]) -> usize {
        let along = less(to, from);
        let parts = (dot(along, along).sqrt() / self.largest_m.max(1e-9)).ceil();
        if parts.is_finite() { (parts as usize).clamp(1, PARTS_MAX) } else { 1 }
    }

    fn seen(&self, corners: [[f64; 3]; 4], edges: [bool; 4]) -> Seen<'s> {
        let flat = corners.map(|at| on_picture(at, self.directions));
        let sides = (0..4).filter(|side| edges[*side]).map(|side| [flat[side], flat[(side + 1) % 4]]);
        let near = corners.iter().map(|at| dot(*at, self.directions[2])).sum::<f64>() / 4.0;
        Seen { solid: self.solid, edges: sides.collect(), corners: flat.to_vec(), near, light: self.light }
    }
}

fn less(to: [f64; 3], from: [f64; 3]) -> [f64; 3] {
    [to[0] - from[0], to[1] - from[1], to[2] - from[2]]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(z: f64, upwards: bool) -> Solid {
        let mut face = vec![[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]];
        if !upwards {
            face.reverse();
        }
        Solid {
            name: format!("{z}"),
            kind: 0,
            paint: crate::view::Paint::default(),
            backdrop: false,
            surface: Surface::Faces { faces: vec![face], edged: true },
        }
    }

    #[test]
    fn what_is_behind_comes_first_and_backs_are_not_seen() {
        let solids = [square(3.0, true), square(1.0, true), square(2.0, false)];
        let all = faces(&solids, Side::Top);
        let order: Vec<&str> = all.iter().map(|seen| seen.solid.name.as_str()).collect();
        assert!(order.contains(&"1") && order.contains(&"3") && !order.contains(&"2"), "{order:?}");
        assert!(order.iter().rposition(|name| *name == "1") < order.iter().position(|name| *name == "3"));
    }

    #[test]
    fn the_edges_of_parts_are_the_edges_of_the_face() {
        let solids = [square(0.0, true)];
        let length: f64 = faces(&solids, Side::Top)
            .iter()
            .flat_map(|seen| &seen.edges)
            .map(|[from, to]| (to[0] - from[0]).abs() + (to[1] - from[1]).abs())
            .sum();
        assert!((length - 4.0).abs() < 1e-12, "{length}");
    }
}
