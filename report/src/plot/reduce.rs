//! The same line with fewer points.
//!
//! All on a grid of hundredths of a pixel, so that comparisons are between integers and exact.

/// The edge of a pixel on the grid.
pub(super) const PIXEL_CPX: i64 = 100;
/// How far a dropped point may lie above or below the line.
pub(super) const DEVIATION_MAX_CPX: i64 = 2;
/// How many points of a line may lie in one pixel column.
const POINTS_PER_COLUMN_MAX: usize = 4;

/// A place on the picture, in hundredths of a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Point {
    pub(super) x_cpx: i64,
    pub(super) y_cpx: i64,
}

/// Leaves at most four points in each pixel column: the first, the lowest, the highest, the last.
///
/// What remains covers the same pixels, however short a pulse was.
pub(super) fn thin_columns(points: &[Point]) -> Vec<Point> {
    let same_column = |a: &Point, b: &Point| a.x_cpx.div_euclid(PIXEL_CPX) == b.x_cpx.div_euclid(PIXEL_CPX);
    let mut kept = Vec::new();
    for column in points.chunk_by(same_column) {
        if column.len() <= POINTS_PER_COLUMN_MAX {
            kept.extend_from_slice(column);
            continue;
        }
        let indices = || 0..column.len();
        let low = indices().min_by_key(|&index| column[index].y_cpx).unwrap_or(0);
        let high = indices().max_by_key(|&index| column[index].y_cpx).unwrap_or(0);
        let mut chosen = [0, low, high, column.len() - 1];
        chosen.sort_unstable();
        let mut previous = None;
        for index in chosen {
            if previous.replace(index) != Some(index) {
                kept.push(column[index]);
            }
        }
    }
    kept
}

/// Drops points on straight stretches of a line that runs from left to right.
///
/// A greedy walk: from the last point kept, a cone of directions passes all points since then
/// closely enough; the first point outside of it starts a new stretch.
pub(super) fn straighten(points: &[Point]) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    let mut stretch: Option<(Point, Cone)> = None;
    for &point in points {
        let Some(&anchor) = kept.last() else {
            kept.push(point);
            continue;
        };
        stretch = match stretch {
            Some((_, cone)) if cone.contains(anchor, point) => Some((point, cone.narrowed(anchor, point))),
            Some((end, _)) => {
                kept.push(end);
                begin(&mut kept, end, point)
            }
            None => begin(&mut kept, anchor, point),
        };
    }
    kept.extend(stretch.map(|(end, _)| end));
    kept
}

/// The stretch from `anchor` over `point`; a vertical one ends at once.
fn begin(kept: &mut Vec<Point>, anchor: Point, point: Point) -> Option<(Point, Cone)> {
    if point.x_cpx > anchor.x_cpx {
        return Some((point, Cone::around(anchor, point)));
    }
    if point != anchor {
        kept.push(point);
    }
    None
}

/// The directions from a point, between two slopes.
#[derive(Debug, Clone, Copy)]
struct Cone {
    low: Slope,
    high: Slope,
}

/// A slope as a fraction: `rise` over a positive `run`.
#[derive(Debug, Clone, Copy)]
struct Slope {
    rise: i64,
    run: i64,
}

impl Slope {
    fn between(from: Point, to: Point, offset_cpx: i64) -> Self {
        Self { rise: to.y_cpx - from.y_cpx + offset_cpx, run: to.x_cpx - from.x_cpx }
    }

    fn is_below(self, other: Self) -> bool {
        self.rise * other.run < other.rise * self.run
    }
}

impl Cone {
    fn around(anchor: Point, point: Point) -> Self {
        let edge = |offset_cpx| Slope::between(anchor, point, offset_cpx);
        Self { low: edge(-DEVIATION_MAX_CPX), high: edge(DEVIATION_MAX_CPX) }
    }

    fn contains(self, anchor: Point, point: Point) -> bool {
        let slope = Slope::between(anchor, point, 0);
        slope.run > 0 && !slope.is_below(self.low) && !self.high.is_below(slope)
    }

    fn narrowed(self, anchor: Point, point: Point) -> Self {
        let other = Self::around(anchor, point);
        Self {
            low: if self.low.is_below(other.low) { other.low } else { self.low },
            high: if other.high.is_below(self.high) { other.high } else { self.high },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn points(coordinates: &[(i64, i64)]) -> Vec<Point> {
        coordinates.iter().map(|&(x_cpx, y_cpx)| Point { x_cpx, y_cpx }).collect()
    }

    /// Whether the line through `kept` passes close above or below `point`, or through it.
    fn passes(kept: &[Point], point: Point) -> bool {
        kept.contains(&point)
            || kept.windows(2).any(|pair| {
                let (a, b) = (pair[0], pair[1]);
                let run = b.x_cpx - a.x_cpx;
                let rise = (b.y_cpx - a.y_cpx) * (point.x_cpx - a.x_cpx);
                (a.x_cpx..=b.x_cpx).contains(&point.x_cpx)
                    && ((point.y_cpx - a.y_cpx) * run - rise).abs() <= DEVIATION_MAX_CPX * run
            })
    }

    #[test]
    fn straight_stretches_keep_their_ends() {
        let ramp: Vec<(i64, i64)> = (0..100).map(|i| (i * 10, i * 7)).collect();
        assert_eq!(straighten(&points(&ramp)), points(&[(0, 0), (990, 693)]));
        let edge = points(&[(0, 0), (10, 0), (10, 500), (20, 500)]);
        assert_eq!(straighten(&edge), edge);
    }

    #[test]
    fn a_crowded_column_keeps_its_extremes() {
        let mut crowd: Vec<(i64, i64)> = (0..50).map(|i| (i, 0)).collect();
        crowd[17].1 = 900;
        crowd[31].1 = -900;
        assert_eq!(thin_columns(&points(&crowd)), points(&[(0, 0), (17, 900), (31, -900), (49, 0)]));
    }

    proptest! {
        #[test]
        fn the_line_passes_every_dropped_point(steps in prop::collection::vec((0_i64..30, -6_i64..6), 1..200)) {
            let mut at = (0, 0);
            let walk: Vec<(i64, i64)> = steps.iter().map(|step| { at = (at.0 + step.0, at.1 + step.1); at }).collect();
            let all = points(&walk);
            let kept = straighten(&all);
            prop_assert!(all.iter().all(|&point| passes(&kept, point)), "{:?}", kept);
            prop_assert_eq!((kept.first(), kept.last()), (all.first(), all.last()));
        }

        #[test]
        fn columns_keep_extremes_and_order(steps in prop::collection::vec((0_i64..30, -900_i64..900), 1..300)) {
            let mut x_cpx = 0;
            let all: Vec<Point> = steps.iter().map(|step| { x_cpx += step.0; Point { x_cpx, y_cpx: step.1 } }).collect();
            let kept = thin_columns(&all);
            prop_assert!(kept.is_sorted_by_key(|point| point.x_cpx));
            for column in 0..=x_cpx / PIXEL_CPX {
                let heights = |points: &[Point]| {
                    let inside = points.iter().filter(|point| point.x_cpx / PIXEL_CPX == column);
                    inside.map(|point| point.y_cpx).collect::<Vec<_>>()
                };
                let (before, after) = (heights(&all), heights(&kept));
                prop_assert_eq!((before.iter().min(), before.iter().max()), (after.iter().min(), after.iter().max()));
                prop_assert!(after.len() <= POINTS_PER_COLUMN_MAX);
            }
        }
    }
}
