//! What is asked of the velocities of mechanisms and bodies that touch: rows, each one motion with an impulse along it.
//!
//! A bounded row wants its velocity `u = J v` to be `wanted - softness λ`, with an impulse `λ` from `least` to `most`:
//! the normal of a contact, a drive, a stop, the friction of a joint, a coupling. Two rows in the surface of each
//! contact come after all of these.

use nalgebra::{DMatrix, DMatrixView, DVector, DVectorView};

/// One motion, over the coordinates of one or two movers.
#[derive(Clone, Debug)]
pub(super) struct Row {
    /// Where the coordinates of its movers begin and end; the second may be empty.
    pub(super) spans: [(usize, usize); 2],
    pub(super) wanted: f64,
    pub(super) softness: f64,
    pub(super) least: f64,
    pub(super) most: f64,
    pub(super) impulse: f64,
    /// The velocity by which positions are corrected beside it.
    pub(super) correction: f64,
}

impl Row {
    /// A row that wants a velocity, whatever it takes.
    pub(super) const fn rigid(spans: [(usize, usize); 2], wanted: f64) -> Self {
        let (least, most) = (f64::NEG_INFINITY, f64::INFINITY);
        Self { spans, wanted, softness: 0.0, least, most, impulse: 0.0, correction: 0.0 }
    }
}

/// The friction of a contact: the row of its normal, the first of its two rows in the surface, its coefficient.
#[derive(Clone, Copy, Debug)]
pub(super) struct Friction {
    pub(super) normal: usize,
    pub(super) first: usize,
    pub(super) coefficient: f64,
}

/// All rows over all coordinates.
#[derive(Debug, Default)]
pub(super) struct Problem {
    /// The velocities that all has without the rows; with them, once they are solved.
    pub(super) velocities: Vec<f64>,
    pub(super) rows: Vec<Row>,
    /// How many of the rows are bounded.
    pub(super) bounded: usize,
    pub(super) frictions: Vec<Friction>,
    /// `J` of all rows, and `M⁻¹ Jᵀ`: all coordinates of each row, one row after the other.
    pub(super) along: Vec<f64>,
    pub(super) answers: Vec<f64>,
}

impl Problem {
    /// Adds a row with its `J`; `answer` gives `M⁻¹ Jᵀ` where `J` is not 0.
    pub(super) fn push(&mut self, row: Row, along: &[f64], answer: impl FnOnce(&[f64], &mut [f64])) {
        let n = self.velocities.len();
        let first = self.answers.len();
        self.along.extend_from_slice(along);
        self.answers.resize(first + n, 0.0);
        answer(along, &mut self.answers[first..]);
        self.rows.push(row);
    }

    /// What one unit of impulse of one row adds to the velocity of another.
    fn between(&self, row: usize, other: usize) -> f64 {
        let n = self.velocities.len();
        let (along, answer) = (&self.along[row * n..], &self.answers[other * n..]);
        let span = |(from, to): (usize, usize)| {
            let [along, answer] = [along, answer].map(|of| DVectorView::from_slice(&of[from..to], to - from));
            along.dot(&answer)
        };
        let [one, two] = self.rows[row].spans;
        span(one) + span(two)
    }

    /// What one unit of impulse of each row adds to the velocity of each.
    pub(super) fn matrix(&self) -> DMatrix<f64> {
        let count = self.rows.len();
        let mut matrix = DMatrix::zeros(count, count);
        for row in 0..count {
            for other in 0..=row {
                let entry = self.between(row, other);
                matrix[(row, other)] = entry;
                matrix[(other, row)] = entry;
            }
        }
        matrix
    }

    /// The velocity of a row.
    pub(super) fn velocity(&self, row: usize) -> f64 {
        let n = self.velocities.len();
        let along = &self.along[row * n..(row + 1) * n];
        along.iter().zip(&self.velocities).map(|(along, v)| along * v).sum()
    }

    /// What impulses of the rows add to the velocities.
    pub(super) fn answer(&self, impulses: &DVector<f64>) -> DVector<f64> {
        let n = self.velocities.len();
        let answers = DMatrixView::from_slice(&self.answers, n, impulses.len());
        let mut sum = DVector::zeros(n);
        sum.gemv(1.0, &answers, impulses, 0.0);
        sum
    }
}
