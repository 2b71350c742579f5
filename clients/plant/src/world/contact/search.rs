//! Impulses of all rows at once, with Coulomb's law in every contact.
//!
//! # Method
//! An active set of bounded rows: those within their bounds are solved together, the others are at their bounds. How
//! these rows answer to an impulse in the surface of a contact is known with it (the Schur complement), so friction is
//! sought among what they leave free, contact by contact, each within its own cone, until nothing changes any more. Then
//! rows that break a bound are set to it, those that want back are freed, and so on until none does.
//!
//! Friction so has no part in what the normals hold: a weight on a floor stays on the floor, also where a face at its
//! side could carry some of it. Coulomb's law leaves that open, as nothing slips there; friction that was taken
//! before the normals are right, or kept from a former step, would carry what it came to carry by chance.

use nalgebra::{DMatrix, DVector};

use super::cone;
use super::problem::{Friction, Problem};
use crate::world::mechanism::matrix::Factor;

/// Added to each diagonal, as a part of it: rows that say the same share their impulse.
const REGULAR: f64 = 1e-11;
/// Most sweeps over all contacts in one search for friction.
const SWEEPS: usize = 400;
/// The search ends once no contact changes its velocity by more than this part of the greatest one.
const ENOUGH: f64 = 1e-9;
/// What is left after the last sweep may be this part of it.
const TOLERATED: f64 = 1e-6;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Held {
    Free,
    Least,
    Most,
}

struct Search<'p> {
    problem: &'p Problem,
    matrix: DMatrix<f64>,
    /// What each row is short of its velocity without any impulse.
    start: Vec<f64>,
    scale: f64,
    held: Vec<Held>,
    free: Vec<usize>,
    /// Of the free rows.
    factor: Factor,
    impulses: DVector<f64>,
}

impl Problem {
    /// Finds all impulses and adds what they do to the velocities; gives the velocities that correct positions. None,
    /// and all unchanged, if the search does not come to an end.
    pub(super) fn solve(&mut self) -> Option<DVector<f64>> {
        let mut search = Search::new(self);
        let rounds = 4 * self.bounded + 8;
        let mut rubs = false;
        for round in 0..rounds {
            if !search.factor() {
                return None;
            }
            // most rows find their places without friction
            let settled = if rubs {
                search.slide()
            } else {
                search.take(&search.smooth());
                true
            };
            if search.revise(2 * round > rounds) {
                continue;
            }
            if !rubs && !self.frictions.is_empty() {
                rubs = true;
                continue;
            }
            if !settled || search.impulses.iter().any(|impulse| !impulse.is_finite()) {
                return None;
            }
            let corrected = self.answer(&search.corrections());
            let impulses = search.impulses;
            let changes = self.answer(&impulses);
            for (v, change) in self.velocities.iter_mut().zip(&changes) {
                *v += change;
            }
            for (row, impulse) in self.rows.iter_mut().zip(&impulses) {
                row.impulse = *impulse;
            }
            return Some(corrected);
        }
        None
    }
}

impl<'p> Search<'p> {
    fn new(problem: &'p Problem) -> Self {
        let count = problem.rows.len();
        let mut matrix = problem.matrix();
        let start: Vec<f64> =
            problem.rows.iter().enumerate().map(|(index, row)| row.wanted - problem.velocity(index)).collect();
        for (index, row) in problem.rows.iter().enumerate().take(problem.bounded) {
            matrix[(index, index)] *= 1.0 + REGULAR;
            matrix[(index, index)] += row.softness;
        }
        let held = problem.rows.iter().zip(&start).take(problem.bounded).map(|(row, start)| {
            // what is not reached without an impulse needs none
            match (row.least == 0.0 && *start <= 0.0, row.most == 0.0 && *start >= 0.0) {
                (true, _) => Held::Least,
                (_, true) => Held::Most,
                (false, false) => Held::Free,
            }
        });
        let scale = problem.velocities.iter().fold(0.0, |scale: f64, v| scale.max(v.abs()));
        Self {
            matrix,
            scale,
            held: held.collect(),
            free: Vec::new(),
            factor: Factor::default(),
            impulses: DVector::zeros(count),
            start,
            problem,
        }
    }

    /// Factors the matrix of the free rows, with all others at their bounds.
    fn factor(&mut self) -> bool {
        for (index, held) in self.held.iter().enumerate() {
            match held {
                Held::Free => {}
                Held::Least => self.impulses[index] = self.problem.rows[index].least,
                Held::Most => self.impulses[index] = self.problem.rows[index].most,
            }
        }
        let held = &self.held;
        self.free.clear();
        self.free.extend((0..held.len()).filter(|index| held[*index] == Held::Free));
        let (free, matrix) = (&self.free, &self.matrix);
        self.factor.take(free.len(), |row, column| matrix[(free[row], free[column])])
    }

    /// What a row is short of with all impulses of rows at their bounds.
    fn short(&self, row: usize) -> f64 {
        let held = (0..self.held.len()).filter(|other| self.held[*other] != Held::Free);
        self.start[row] - held.map(|other| self.matrix[(row, other)] * self.impulses[other]).sum::<f64>()
    }

    /// What the free rows take without friction.
    fn smooth(&self) -> DVector<f64> {
        let mut answer = DVector::from_iterator(self.free.len(), self.free.iter().map(|row| self.short(*row)));
        self.factor.solve(&mut answer);
        answer
    }

    /// Gives the free rows these impulses.
    fn take(&mut self, answer: &DVector<f64>) {
        for (row, impulse) in self.free.iter().zip(answer) {
            self.impulses[*row] = *impulse;
        }
    }

    /// Finds the friction of all contacts that press, with the free rows answering; false if it does not settle.
    fn slide(&mut self) -> bool {
        let answer = self.smooth();
        let pressed = |friction: &&Friction| self.held[friction.normal] == Held::Free && friction.coefficient > 0.0;
        let pressed: Vec<Friction> = self.problem.frictions.iter().filter(pressed).copied().collect();
        for row in self.impulses.iter_mut().skip(self.problem.bounded) {
            // what a former set of rows gave is not taken over, nor what a former step did
            *row = 0.0;
        }
        let mut sliding = Sliding::new(self, &pressed, answer);
        let settled = sliding.settle(self.scale);
        let Sliding { impulses, answer, .. } = sliding;
        for (friction, impulse) in pressed.iter().zip(impulses.chunks_exact(2)) {
            self.impulses.as_mut_slice()[friction.first..friction.first + 2].copy_from_slice(impulse);
        }
        self.take(&answer);
        settled
    }

    /// Sets rows to the bounds that they break and frees those that want back, the first alone if need be; false if
    /// none does.
    fn revise(&mut self, one: bool) -> bool {
        let greatest = self.impulses.iter().fold(0.0, |greatest: f64, impulse| greatest.max(impulse.abs()));
        let slack = 1e-12 * greatest;
        let mut revised = false;
        for index in 0..self.held.len() {
            let (row, impulse) = (&self.problem.rows[index], self.impulses[index]);
            let now = match self.held[index] {
                Held::Free if impulse < row.least - slack => Held::Least,
                Held::Free if impulse > row.most + slack => Held::Most,
                Held::Free => continue,
                held => {
                    let line = self.matrix.column(index);
                    let reached: f64 = line.iter().zip(&self.impulses).map(|(entry, impulse)| entry * impulse).sum();
                    let missing = self.start[index] - reached;
                    let slack = 1e-9 * (self.start[index].abs() + reached.abs()) + 1e-12 * self.scale;
                    let back = if held == Held::Least { missing > slack } else { missing < -slack };
                    if !back {
                        continue;
                    }
                    Held::Free
                }
            };
            self.held[index] = now;
            revised = true;
            if one {
                return true;
            }
        }
        revised
    }

    /// Impulses that give the free rows the velocities by which positions are corrected, and no friction.
    fn corrections(&self) -> DVector<f64> {
        let wanted = self.free.iter().map(|row| self.problem.rows[*row].correction);
        let mut each = DVector::from_iterator(self.free.len(), wanted);
        let mut impulses = DVector::zeros(self.impulses.len());
        if each.iter().any(|correction| *correction != 0.0) {
            self.factor.solve(&mut each);
            for (row, impulse) in self.free.iter().zip(&each) {
                impulses[*row] = *impulse;
            }
        }
        impulses
    }
}

/// The friction of contacts that press, among what the free rows leave.
struct Sliding {
    frictions: Vec<(Friction, usize)>,
    /// What the free rows answer to one unit of impulse in each row of friction, a column each.
    gives: DMatrix<f64>,
    /// What one unit of impulse of each adds to the velocity of each.
    schur: DMatrix<f64>,
    /// What each contact would move alone, with nothing held.
    alone: Vec<f64>,
    impulses: Vec<f64>,
    /// What each is short of.
    left: Vec<f64>,
    /// The impulses of the free rows.
    answer: DVector<f64>,
}

impl Sliding {
    fn new(search: &Search<'_>, pressed: &[Friction], answer: DVector<f64>) -> Self {
        let rows: Vec<usize> = pressed.iter().flat_map(|friction| [friction.first, friction.first + 1]).collect();
        let entry = |row: usize, other: usize| search.matrix[(row, other)];
        let mut gives = DMatrix::from_fn(search.free.len(), rows.len(), |k, of| entry(search.free[k], rows[of]));
        search.factor.solve(&mut gives);
        let answered = |row: usize, of: &[f64]| -> f64 {
            search.free.iter().zip(of).map(|(free, answer)| entry(row, *free) * answer).sum()
        };
        let mut schur = DMatrix::zeros(rows.len(), rows.len());
        for (a, row) in rows.iter().enumerate() {
            for (b, other) in rows.iter().enumerate().take(a + 1) {
                let moved = entry(*row, *other) - answered(*row, gives.column(b).as_slice());
                (schur[(a, b)], schur[(b, a)]) = (moved, moved);
            }
        }
        let left = rows.iter().map(|row| search.short(*row) - answered(*row, answer.as_slice())).collect();
        let place = |normal: usize| search.free.iter().position(|free| *free == normal);
        let frictions = pressed.iter().filter_map(|friction| Some((*friction, place(friction.normal)?))).collect();
        let alone = pressed
            .iter()
            .map(|friction| entry(friction.first, friction.first).max(entry(friction.first + 1, friction.first + 1)));
        Self { frictions, gives, schur, alone: alone.collect(), impulses: vec![0.0; rows.len()], left, answer }
    }

    /// Sweeps over all contacts until nothing changes any more.
    fn settle(&mut self, scale: f64) -> bool {
        let mut moved = 0.0;
        for _ in 0..SWEEPS {
            moved = 0.0;
            for index in 0..self.frictions.len() {
                moved = f64::max(moved, self.settle_one(index));
            }
            if moved <= ENOUGH * scale {
                return true;
            }
        }
        moved <= TOLERATED * scale
    }

    /// Finds the friction of one contact; by how much its velocity changed.
    fn settle_one(&mut self, index: usize) -> f64 {
        let (friction, normal) = self.frictions[index];
        let [x, y] = [2 * index, 2 * index + 1];
        let [xx, xy, yy] = [self.schur[(x, x)], self.schur[(x, y)], self.schur[(y, y)]];
        let before = [self.impulses[x], self.impulses[y]];
        let wanted = [self.left[x] + xx * before[0] + xy * before[1], self.left[y] + xy * before[0] + yy * before[1]];
        let radius = friction.coefficient * self.answer[normal].max(0.0);
        let after = cone::within([xx, xy, yy], wanted, radius, self.alone[index]);
        let change = [after[0] - before[0], after[1] - before[1]];
        if change == [0.0; 2] {
            return 0.0;
        }
        (self.impulses[x], self.impulses[y]) = (after[0], after[1]);
        for (row, left) in self.left.iter_mut().enumerate() {
            *left -= self.schur[(row, x)] * change[0] + self.schur[(row, y)] * change[1];
        }
        for (k, answer) in self.answer.iter_mut().enumerate() {
            *answer -= self.gives[(k, x)] * change[0] + self.gives[(k, y)] * change[1];
        }
        let moved = [xx * change[0] + xy * change[1], xy * change[0] + yy * change[1]];
        (moved[0] * moved[0] + moved[1] * moved[1]).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::super::problem::Row;
    use super::*;

    /// A point of 2 kg, which rows along its three axes push.
    fn point(velocities: [f64; 3]) -> Problem {
        Problem { velocities: velocities.to_vec(), ..Problem::default() }
    }

    fn push(problem: &mut Problem, axis: usize, row: Row) {
        let mut along = [0.0; 3];
        along[axis] = 1.0;
        problem.push(row, &along, |along, answer| {
            for (answer, along) in answer.iter_mut().zip(along) {
                *answer = 0.5 * along;
            }
        });
    }

    fn row(wanted: f64) -> Row {
        Row::rigid([(0, 3), (0, 0)], wanted)
    }

    /// The point on a floor, with a face at its side that comes with 1 m/s along x and goes up with `rises`.
    fn pushed(velocities: [f64; 3], rises: f64, coefficient: f64) -> Problem {
        let mut problem = point(velocities);
        for (axis, wanted) in [(2, 0.0), (0, 1.0)] {
            push(&mut problem, axis, Row { least: 0.0, ..row(wanted) });
        }
        problem.bounded = 2;
        for (normal, [one, other], up) in [(0, [0, 1], 0.0), (1, [1, 2], rises)] {
            problem.frictions.push(Friction { normal, first: problem.rows.len(), coefficient });
            push(&mut problem, one, row(0.0));
            push(&mut problem, other, row(up));
        }
        problem
    }

    fn assert_close(got: f64, wanted: f64) {
        assert!((got - wanted).abs() < 1e-5, "{got} {wanted}");
    }

    #[test]
    fn what_slides_has_all_of_its_friction_and_what_holds_what_it_takes() {
        for (speed, left) in [(0.5, 0.4), (0.1, 0.0)] {
            let mut problem = point([speed, 0.0, -0.2]);
            push(&mut problem, 2, Row { least: 0.0, ..row(0.0) });
            problem.bounded = 1;
            problem.frictions.push(Friction { normal: 0, first: 1, coefficient: 0.5 });
            push(&mut problem, 0, row(0.0));
            push(&mut problem, 1, row(0.0));
            assert!(problem.solve().is_some());
            assert_close(problem.velocities[0], left);
            assert_close(problem.velocities[2], 0.0);
            assert_close(problem.rows[0].impulse, 0.4);
        }
    }

    #[test]
    fn a_face_at_the_side_carries_nothing_of_what_stands_on_a_floor() {
        let mut problem = pushed([0.0, 0.0, -0.1], 0.0, 0.5);
        assert!(problem.solve().is_some());
        assert_close(problem.rows[0].impulse, 0.2);
        // 2 kg at 1 m/s and the friction of the floor
        assert_close(problem.rows[1].impulse, 2.1);
        assert_close(problem.rows[5].impulse, 0.0);
    }

    #[test]
    fn a_face_that_goes_up_takes_it_along_as_far_as_friction_goes() {
        let mut problem = pushed([0.0, 0.0, -0.1], 1.0, 0.5);
        assert!(problem.solve().is_some());
        // half of 2 Ns, of which 0.2 hold it against its fall
        assert_close(problem.rows[0].impulse, 0.0);
        assert_close(problem.rows[5].impulse, 1.0);
        assert_close(problem.velocities[2], 0.4);
        let mut problem = pushed([0.0, 0.0, -0.1], 1.0, 0.05);
        assert!(problem.solve().is_some());
        assert_close(problem.rows[5].impulse, 0.05 * problem.rows[1].impulse);
        assert_close(problem.rows[0].impulse, 0.2 - problem.rows[5].impulse);
        assert_close(problem.velocities[2], 0.0);
    }

    #[test]
    fn what_is_not_reached_is_not_touched() {
        let mut problem = point([0.0, 0.0, -0.1]);
        push(&mut problem, 2, Row { least: 0.0, ..row(-0.5) });
        problem.bounded = 1;
        assert_eq!(problem.solve(), Some(DVector::zeros(3)));
        assert_eq!((problem.velocities[2], problem.rows[0].impulse), (-0.1, 0.0));
    }
}
