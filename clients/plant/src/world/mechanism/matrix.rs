//! Symmetric matrices of a few rows, in place and in a fixed order of operations.
//!
//! The linear algebra of `nalgebra` and the like chooses its kernels by the processor that it runs on,
//! with and without fused operations. Sums would then differ in their last bits from machine to
//! machine, so these few lines are our own.

/// Factors a symmetric positive definite matrix of `n` rows into `L Lᵀ`, in its lower triangle; false
/// if it is not positive definite.
#[must_use]
pub(in crate::world) fn factor(matrix: &mut [f64], n: usize) -> bool {
    for column in 0..n {
        for row in column..n {
            let mut sum = matrix[row * n + column];
            for k in 0..column {
                sum -= matrix[row * n + k] * matrix[column * n + k];
            }
            if row > column {
                matrix[row * n + column] = sum / matrix[column * n + column];
            } else if sum > 0.0 && sum.is_finite() {
                matrix[column * n + column] = sum.sqrt();
            } else {
                return false;
            }
        }
    }
    true
}

/// Solves `L Lᵀ x = b` in place of `b`.
pub(in crate::world) fn solve(lower: &[f64], n: usize, b: &mut [f64]) {
    for row in 0..n {
        let sum = (0..row).fold(b[row], |sum, k| sum - lower[row * n + k] * b[k]);
        b[row] = sum / lower[row * n + row];
    }
    for row in (0..n).rev() {
        let sum = (row + 1..n).fold(b[row], |sum, k| sum - lower[k * n + row] * b[k]);
        b[row] = sum / lower[row * n + row];
    }
}

/// The whole inverse of `L Lᵀ`.
pub(in crate::world) fn inverse(lower: &[f64], n: usize, inverse: &mut [f64]) {
    inverse.fill(0.0);
    for row in 0..n {
        // the inverse is symmetric, so that its rows are its columns
        let line = &mut inverse[row * n..(row + 1) * n];
        line[row] = 1.0;
        solve(lower, n, line);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_solved_solves() {
        let matrix = [4.0, 2.0, 0.4, 2.0, 5.0, 1.0, 0.4, 1.0, 3.0];
        let mut lower = matrix;
        assert!(factor(&mut lower, 3));
        let mut inverted = [0.0; 9];
        inverse(&lower, 3, &mut inverted);
        for row in 0..3 {
            for column in 0..3 {
                let product: f64 = (0..3).map(|k| matrix[row * 3 + k] * inverted[k * 3 + column]).sum();
                let wanted = if row == column { 1.0 } else { 0.0 };
                assert!((product - wanted).abs() < 1e-15, "{row} {column} {product}");
            }
        }
        assert!(!factor(&mut [1.0, 2.0, 2.0, 1.0], 2), "not positive definite");
    }
}
