//! From where one looks at a scene. Its z is up, its x goes to the right of one who looks from the front.

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// From above the corner between front and right.
    #[default]
    Corner,
    /// Along y: x to the right, z up.
    Front,
    Back,
    Left,
    /// Against x: y to the right, z up.
    Right,
    /// From above: x to the right, y up.
    Top,
}

impl Side {
    pub const ALL: [Self; 6] = [Self::Corner, Self::Front, Self::Back, Self::Left, Self::Right, Self::Top];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Corner => "corner",
            Self::Front => "front",
            Self::Back => "back",
            Self::Left => "left",
            Self::Right => "right",
            Self::Top => "top",
        }
    }

    /// Unit vectors to the right of the picture, up it, and out of it.
    pub(super) fn directions(self) -> [[f64; 3]; 3] {
        match self {
            Self::Corner => {
                let out = unit([1.0, -1.6, 1.1]);
                let right = unit(cross([0.0, 0.0, 1.0], out));
                [right, cross(out, right), out]
            }
            Self::Front => [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]],
            Self::Back => [[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
            Self::Left => [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]],
            Self::Right => [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
            Self::Top => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        }
    }
}

pub(super) fn dot(one: [f64; 3], other: [f64; 3]) -> f64 {
    one[0] * other[0] + one[1] * other[1] + one[2] * other[2]
}

pub(super) fn cross(one: [f64; 3], other: [f64; 3]) -> [f64; 3] {
    let part = |i: usize, j: usize| one[i] * other[j] - one[j] * other[i];
    [part(1, 2), part(2, 0), part(0, 1)]
}

/// The direction of a vector; itself if it has none.
pub(super) fn unit(of: [f64; 3]) -> [f64; 3] {
    let length = dot(of, of).sqrt();
    if length > 0.0 && length.is_finite() { of.map(|part| part / length) } else { of }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_a_right_handed_frame() {
        for side in Side::ALL {
            let [right, up, out] = side.directions();
            let across = cross(right, up);
            assert!(across.iter().zip(out).all(|(a, b)| (a - b).abs() < 1e-15), "{side:?}");
            assert!((dot(right, right) - 1.0).abs() < 1e-15 && dot(right, up).abs() < 1e-15, "{side:?}");
        }
    }
}
