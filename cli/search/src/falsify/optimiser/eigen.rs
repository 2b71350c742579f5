//! Eigenvalues and eigenvectors of a symmetric matrix, by Jacobi's rotations.
//!
//! Rotations row by row, until none is left that changes anything ("cyclic Jacobi"). Matrices have as many rows as a point
//! has numbers, so that simplicity counts for more than speed. Additions, multiplications, divisions and square roots
//! in a fixed order: the result has the same bits on every platform.

/// A matrix, row by row.
pub(super) type Rows = Vec<Vec<f64>>;

/// Six to ten sweeps are usual. This many guard against values that are not numbers.
const SWEEPS_MAX: usize = 40;

/// `A = B D Bᵀ`.
pub(super) struct Eigen {
    /// The diagonal of D, in no particular order.
    pub(super) values: Vec<f64>,
    /// The columns of B, one eigenvector per row.
    pub(super) vectors: Rows,
}

/// The matrix with 1 on its diagonal and 0 elsewhere.
pub(super) fn identity(size: usize) -> Rows {
    (0..size).map(|row| (0..size).map(|column| if row == column { 1.0 } else { 0.0 }).collect()).collect()
}

/// The decomposition of a symmetric matrix.
pub(super) fn decomposed(mut matrix: Rows) -> Eigen {
    let mut vectors = identity(matrix.len());
    for _ in 0..SWEEPS_MAX {
        let mut is_diagonal = true;
        for second in 1..matrix.len() {
            for first in 0..second {
                let pair = (matrix[first][first], matrix[first][second], matrix[second][second]);
                let Some(angle) = rotation(pair) else { continue };
                is_diagonal = false;
                turn_rows(&mut matrix, (first, second), angle);
                for row in &mut matrix {
                    (row[first], row[second]) = turned((row[first], row[second]), angle);
                }
                (matrix[first][second], matrix[second][first]) = (0.0, 0.0);
                turn_rows(&mut vectors, (first, second), angle);
            }
        }
        if is_diagonal {
            break;
        }
    }
    let values = matrix.iter().enumerate().map(|(place, row)| row[place]).collect();
    Eigen { values, vectors }
}

/// Cosine and sine of the rotation that makes the value beside the diagonal 0; nothing where it is negligible already.
fn rotation((upper, beside, lower): (f64, f64, f64)) -> Option<(f64, f64)> {
    let least = f64::EPSILON * upper.abs().sqrt() * lower.abs().sqrt();
    if beside == 0.0 || beside.abs() <= least {
        return None;
    }
    let cotangent = (lower - upper) / (2.0 * beside);
    // The smaller of the two angles: the larger one would exchange the eigenvalues, sweep after sweep.
    let tangent = 1.0_f64.copysign(cotangent) / (cotangent.abs() + (1.0 + cotangent * cotangent).sqrt());
    let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
    Some((cosine, tangent * cosine))
}

fn turned((first, second): (f64, f64), (cosine, sine): (f64, f64)) -> (f64, f64) {
    (cosine * first - sine * second, sine * first + cosine * second)
}

/// Turns two rows, of which `second` is the later one.
fn turn_rows(rows: &mut Rows, (first, second): (usize, usize), angle: (f64, f64)) {
    let (before, after) = rows.split_at_mut(second);
    for (one, other) in before[first].iter_mut().zip(&mut after[0]) {
        (*one, *other) = turned((*one, *other), angle);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Eigenvalues, the least first.
    fn values(matrix: Rows) -> Vec<f64> {
        let mut values = decomposed(matrix).values;
        values.sort_by(f64::total_cmp);
        values
    }

    fn assert_near(found: &[f64], expected: &[f64]) {
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() <= 1e-13 * expected.abs().max(1.0), "{found}, not {expected}");
        }
    }

    #[test]
    fn known_matrices_have_their_eigenvalues() {
        assert_near(&values(vec![vec![2.0, 1.0], vec![1.0, 2.0]]), &[1.0, 3.0]);
        assert_near(&values(vec![vec![4.0, 0.0], vec![0.0, -3.0]]), &[-3.0, 4.0]);
        // All ones: one eigenvalue is the size, the others are 0.
        assert_near(&values(vec![vec![1.0; 4]; 4]), &[0.0, 0.0, 0.0, 4.0]);
        // The second difference: 2 - 2 cos(k pi / (n + 1)).
        let size = 10;
        let difference = |row: usize, column: usize| match row.abs_diff(column) {
            0 => 2.0,
            1 => -1.0,
            _ => 0.0,
        };
        let second = (0..size).map(|row| (0..size).map(|column| difference(row, column)).collect()).collect();
        let angle = |number: usize| std::f64::consts::PI * number as f64 / (size + 1) as f64;
        let expected: Vec<f64> = (1..=size).map(|number| 2.0 - 2.0 * libm::cos(angle(number))).collect();
        assert_near(&values(second), &expected);
        // Eigenvalues far apart are both exact: their product is the determinant, 1 - 2^-20.
        let apart = values(vec![vec![1_048_576.0, 0.000_976_562_5], vec![0.000_976_562_5, 1.0 / 1_048_576.0]]);
        assert!((apart[0] * apart[1] - (1.0 - 1.0 / 1_048_576.0)).abs() < 1e-14, "{apart:?}");
    }

    #[test]
    fn an_eigenvector_keeps_its_direction() {
        let Eigen { values, vectors } = decomposed(vec![vec![2.0, 1.0], vec![1.0, 2.0]]);
        for (value, vector) in values.iter().zip(&vectors) {
            // (1, 1) for 3 and (1, -1) for 1, of length 1.
            let expected = if *value > 2.0 { 0.5 } else { -0.5 };
            assert!((vector[0] * vector[1] - expected).abs() < 1e-15, "{value}: {vector:?}");
        }
    }

    #[test]
    fn what_is_not_a_number_ends_too() {
        let found = decomposed(vec![vec![1.0, f64::NAN], vec![f64::NAN, 1.0]]);
        assert!(found.values.iter().all(|value| value.is_nan()));
    }

    fn symmetric() -> impl Strategy<Value = Rows> {
        (1_usize..16).prop_flat_map(|size| {
            prop::collection::vec(-1.0..1.0_f64, size * size).prop_map(move |cells| {
                let cell = |row: usize, column: usize| cells[row.min(column) * size + row.max(column)];
                (0..size).map(|row| (0..size).map(|column| cell(row, column)).collect()).collect()
            })
        })
    }

    proptest! {
        #[test]
        fn a_symmetric_matrix_is_the_product_of_its_parts(matrix in symmetric()) {
            let Eigen { values, vectors } = decomposed(matrix.clone());
            for (row, cells) in matrix.iter().enumerate() {
                for (column, cell) in cells.iter().enumerate() {
                    let parts = values.iter().zip(&vectors);
                    let product: f64 = parts.map(|(value, vector)| vector[row] * value * vector[column]).sum();
                    prop_assert!((product - cell).abs() < 1e-12, "{product}, not {cell}");
                    let between: f64 = vectors[row].iter().zip(&vectors[column]).map(|(one, other)| one * other).sum();
                    let expected = if row == column { 1.0 } else { 0.0 };
                    prop_assert!((between - expected).abs() < 1e-12, "{row} and {column}: {between}");
                }
            }
        }
    }
}
