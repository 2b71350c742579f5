//! Symmetric positive definite matrices of any number of rows, in room that is used again.
//!
//! nalgebra's Cholesky decomposition, its solves and its products of a matrix with a vector add in one order, whatever
//! the processor. A product of two matrices of dynamic size would not: it goes to kernels that the processor
//! chooses, so none stands here (see `docs/decisions/013-mechanisms-and-the-engine.md`).

use nalgebra::{Cholesky, DMatrix, Dim, Dyn, Matrix, StorageMut, VecStorage};

/// The factor `L` of a matrix `L Lᵀ`; of one of no row until it has taken one that has a factor.
#[derive(Clone, Debug)]
pub(in crate::world) struct Factor(Cholesky<f64, Dyn>);

impl Default for Factor {
    fn default() -> Self {
        Self(Cholesky::pack_dirty(DMatrix::zeros(0, 0)))
    }
}

impl Factor {
    /// Factors the matrix of `n` rows with these entries (row and column, row not before column); false if it is not
    /// positive definite.
    #[must_use]
    pub(in crate::world) fn take(&mut self, n: usize, entry: impl Fn(usize, usize) -> f64) -> bool {
        let none = Cholesky::pack_dirty(DMatrix::from_data(VecStorage::new(Dyn(0), Dyn(0), Vec::new())));
        let mut room: Vec<f64> = std::mem::replace(&mut self.0, none).unpack_dirty().data.into();
        room.clear();
        for column in 0..n {
            // what is above the diagonal is not looked at
            room.extend((0..n).map(|row| if row < column { 0.0 } else { entry(row, column) }));
        }
        let factored = Cholesky::new(DMatrix::from_data(VecStorage::new(Dyn(n), Dyn(n), room)));
        // an infinite pivot has a root, too
        let whole = |own: &Cholesky<f64, Dyn>| (0..n).all(|row| own.l_dirty()[(row, row)].is_finite());
        let Some(factored) = factored.filter(whole) else { return false };
        self.0 = factored;
        true
    }

    /// Solves `L Lᵀ x = b` in place of `b`, for each of its columns.
    pub(in crate::world) fn solve<C: Dim, S: StorageMut<f64, Dyn, C>>(&self, b: &mut Matrix<f64, Dyn, C, S>) {
        self.0.solve_mut(b);
    }

    /// The whole inverse of `L Lᵀ`.
    pub(in crate::world) fn inverse(&self, inverse: &mut DMatrix<f64>) {
        let n = self.0.l_dirty().nrows();
        if inverse.nrows() != n {
            inverse.resize_mut(n, n, 0.0);
        }
        inverse.fill_with_identity();
        let lower = self.0.l_dirty();
        for column in 0..n {
            // above its 1 each column is 0, and stays so
            let (place, size) = ((column, column), n - column);
            let mut under = inverse.view_mut(place, (size, 1));
            lower.view(place, (size, size)).solve_lower_triangular_unchecked_mut(&mut under);
        }
        lower.ad_solve_lower_triangular_unchecked_mut(inverse);
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use super::*;

    fn factor(rows: &[&[f64]]) -> Option<Factor> {
        let mut factor = Factor::default();
        factor.take(rows.len(), |row, column| rows[row][column]).then_some(factor)
    }

    #[test]
    fn what_is_solved_solves() {
        let matrix: [&[f64]; 3] = [&[4.0, 2.0, 0.4], &[2.0, 5.0, 1.0], &[0.4, 1.0, 3.0]];
        let factor = factor(&matrix).expect("positive definite");
        let mut inverse = DMatrix::zeros(0, 0);
        factor.inverse(&mut inverse);
        for (row, line) in matrix.iter().enumerate() {
            for (column, inverse) in inverse.column_iter().enumerate() {
                let product: f64 = line.iter().zip(&inverse).map(|(one, other)| one * other).sum();
                let wanted = if row == column { 1.0 } else { 0.0 };
                assert!((product - wanted).abs() < 1e-15, "{row} {column} {product}");
            }
        }
        let mut solved = DVector::from_vec(vec![0.0, 1.0, 0.0]);
        factor.solve(&mut solved);
        assert_eq!(solved.as_slice(), inverse.column(1).as_slice());
    }

    #[test]
    fn what_is_not_positive_definite_has_no_factor() {
        for wrong in [[1.0, 2.0, 1.0], [0.0, 0.0, 1.0], [f64::NAN, 0.0, 1.0], [f64::INFINITY, 0.0, 1.0]] {
            let [a, b, c] = wrong;
            assert!(factor(&[&[a, b], &[b, c]]).is_none(), "{wrong:?}");
        }
    }

    #[test]
    fn a_factor_of_one_size_has_room_for_one_of_another() {
        let mut factor = Factor::default();
        for n in [3, 1, 5, 0, 2] {
            assert!(factor.take(n, |row, column| if row == column { 4.0 } else { 0.0 }));
            let mut solved = DVector::from_element(n, 2.0);
            factor.solve(&mut solved);
            assert_eq!(solved, DVector::from_element(n, 0.5));
        }
    }
}
