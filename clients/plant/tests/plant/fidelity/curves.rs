//! What differential equations give, integrated here and not by the plant.

/// The values of `y' = rates(t, y)` after a time, by Runge-Kutta of order 4.
pub(crate) fn runge_kutta<const N: usize>(
    start: [f64; N],
    time_s: f64,
    steps: u32,
    rates: impl Fn(f64, &[f64; N]) -> [f64; N],
) -> [f64; N] {
    let step_s = time_s / f64::from(steps);
    let mut y = start;
    for step in 0..steps {
        let t = step_s * f64::from(step);
        let along = |y: &[f64; N], k: &[f64; N], part: f64| std::array::from_fn(|i| y[i] + part * k[i]);
        let k1 = rates(t, &y);
        let k2 = rates(t + 0.5 * step_s, &along(&y, &k1, 0.5 * step_s));
        let k3 = rates(t + 0.5 * step_s, &along(&y, &k2, 0.5 * step_s));
        let k4 = rates(t + step_s, &along(&y, &k3, step_s));
        y = std::array::from_fn(|i| y[i] + step_s / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    y
}

/// The time at which `value` of the solution first rises to 0, by steps of `h` and a straight line in the last.
pub(super) fn rises<const N: usize>(
    start: [f64; N],
    h: f64,
    mut next: impl FnMut(f64, [f64; N]) -> [f64; N],
    value: impl Fn(&[f64; N]) -> f64,
) -> f64 {
    let (mut y, mut before) = (start, value(&start));
    for step in 0..10_000_000_u32 {
        let t = h * f64::from(step);
        y = next(t, y);
        let now = value(&y);
        if before < 0.0 && now >= 0.0 {
            return t + h * before / (before - now);
        }
        before = now;
    }
    f64::NAN
}

/// What is left after a time of a unit step that a system with this frequency and rate of damping answers.
pub(super) fn step_of_second_order(rad_s: f64, rate: f64, time_s: f64) -> f64 {
    let w = (rad_s * rad_s - rate * rate).sqrt();
    let (sin, cos) = libm::sincos(w * time_s);
    libm::exp(-rate * time_s) * (cos + rate / w * sin)
}
