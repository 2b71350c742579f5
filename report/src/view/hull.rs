//! The outline of a convex form: the convex hull of its points on the picture (Andrew's monotone chain).

/// The corners of the hull, counter-clockwise, without those on a straight line; none of no points.
pub(super) fn hull(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut sorted: Vec<[f64; 2]> =
        points.iter().copied().filter(|at| at.iter().all(|part| part.is_finite())).collect();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let mut chain = half(sorted.iter());
    let above = half(sorted.iter().rev());
    chain.pop();
    chain.extend(&above[..above.len() - 1]);
    chain
}

/// The corners below the points, which come sorted.
fn half<'p>(points: impl Iterator<Item = &'p [f64; 2]>) -> Vec<[f64; 2]> {
    let mut chain: Vec<[f64; 2]> = Vec::new();
    for &next in points {
        while let [.., a, b] = chain[..]
            && (b[0] - a[0]) * (next[1] - a[1]) - (b[1] - a[1]) * (next[0] - a[0]) <= 0.0
        {
            chain.pop();
        }
        chain.push(next);
    }
    chain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_inside_or_on_a_side_is_left_out() {
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        let mut points = square.to_vec();
        points.extend([[1.0, 0.0], [1.0, 1.0], [0.0, 0.0], [f64::NAN, 0.0]]);
        assert_eq!(hull(&points), square);
    }

    #[test]
    fn few_points_are_their_own_hull() {
        assert_eq!(hull(&[]), <[[f64; 2]; 0]>::default());
        assert_eq!(hull(&[[1.0, 2.0], [1.0, 2.0]]), [[1.0, 2.0]]);
        assert_eq!(hull(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]).len(), 2);
    }
}
