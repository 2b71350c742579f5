//! The friction of one point of contact: of all impulses in the surface that are no greater than a radius, the one
//! that stops the surfaces, or else the one against their slip.

/// A direction in which the rest lets the surfaces move by less than this part of what they would move alone counts as
/// moved by so much, so that friction there costs nothing where nothing slips.
const STUCK: f64 = 1e-6;
/// Steps of Newton's method for the slip, which converges quadratically from below.
const STEPS: usize = 40;

/// The impulse of least `½ λ·S λ - λ·wanted` within the radius; `S` is `[xx, xy, yy]`, what one unit of impulse moves,
/// and `alone` what it would move of these two bodies alone.
pub(super) fn within([xx, xy, yy]: [f64; 3], wanted: [f64; 2], radius: f64, alone: f64) -> [f64; 2] {
    if radius <= 0.0 || alone <= 0.0 {
        return [0.0; 2];
    }
    let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let spread = (half * half + xy * xy).sqrt();
    // the axes of S, by the larger of the two ways to write them
    let [a, b] = if half >= 0.0 { [half + spread, xy] } else { [xy, spread - half] };
    let length = (a * a + b * b).sqrt();
    let axis = if length > 0.0 { [a / length, b / length] } else { [1.0, 0.0] };
    let least = STUCK * alone;
    let moved = [(mean + spread).max(least), (mean - spread).max(least)];
    let pulled = [axis[0] * wanted[0] + axis[1] * wanted[1], axis[0] * wanted[1] - axis[1] * wanted[0]];
    let slip = slip(moved, pulled, radius);
    let impulse = [pulled[0] / (moved[0] + slip), pulled[1] / (moved[1] + slip)];
    [axis[0] * impulse[0] - axis[1] * impulse[1], axis[1] * impulse[0] + axis[0] * impulse[1]]
}

/// How far the surfaces slip for each unit of friction against it: 0 where they hold.
fn slip(moved: [f64; 2], pulled: [f64; 2], radius: f64) -> f64 {
    let mut slip = 0.0;
    for _ in 0..STEPS {
        let each = [pulled[0] / (moved[0] + slip), pulled[1] / (moved[1] + slip)];
        let square = each[0] * each[0] + each[1] * each[1];
        let size = square.sqrt();
        if size <= radius * (1.0 + 1e-14) {
            break;
        }
        // 1/|λ| is close to a straight line over the slip
        let fall = each[0] * each[0] / (moved[0] + slip) + each[1] * each[1] / (moved[1] + slip);
        slip += square / fall * (size / radius - 1.0);
    }
    slip
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_close(got: [f64; 2], wanted: [f64; 2]) {
        assert!((got[0] - wanted[0]).abs() + (got[1] - wanted[1]).abs() < 1e-12, "{got:?} {wanted:?}");
    }

    #[test]
    fn what_holds_stops_the_slip() {
        // [[2, 1], [1, 3]] λ = [1, -2]
        assert_close(within([2.0, 1.0, 3.0], [1.0, -2.0], 10.0, 3.0), [1.0, -1.0]);
    }

    #[test]
    fn what_slips_brakes_against_the_slip_with_all_it_has() {
        let (matrix, wanted) = ([2.0, 1.0, 3.0], [1.0, -2.0]);
        let [x, y] = within(matrix, wanted, 0.5, 3.0);
        assert!((x.hypot(y) - 0.5).abs() < 1e-12);
        // what is left of the slip is along the impulse
        let left = [wanted[0] - 2.0 * x - y, wanted[1] - x - 3.0 * y];
        assert!((left[0] * y - left[1] * x).abs() < 1e-12 && left[0] * x + left[1] * y > 0.0, "{left:?}");
    }

    #[test]
    fn a_direction_that_is_held_needs_no_friction_and_has_it_all_once_it_slips() {
        assert_close(within([2.0, 0.0, 0.0], [1.0, 0.0], 10.0, 2.0), [0.5, 0.0]);
        assert_close(within([2.0, 0.0, 0.0], [0.0, 1.0], 10.0, 2.0), [0.0, 10.0]);
        assert_eq!(within([2.0, 0.0, 2.0], [1.0, 1.0], 0.0, 2.0), [0.0, 0.0]);
    }
}
