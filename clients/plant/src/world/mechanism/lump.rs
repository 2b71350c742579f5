//! A tree whose welded bodies are one body each, which has the same coordinates and the same equations.

use nalgebra::{Matrix3, Vector3};
use rapier3d::glamx::DMat3;
use rapier3d::math::Pose;

use super::tree::{Closure, End, Freedom, Member, Tree};

/// What a member has become: a part of a lump, or of the ground, and where it is in that.
type Place = (Option<usize>, Pose);

impl Tree {
    /// The tree with all that is welded together as one body.
    pub(super) fn lumped(&self) -> Self {
        let mut lumps: Vec<Member> = Vec::new();
        let mut places: Vec<Place> = Vec::with_capacity(self.members.len());
        for member in &self.members {
            let (on, base) = member.on.map_or((None, Pose::IDENTITY), |on| places[on]);
            let place = base * member.place;
            if member.freedom == Freedom::Weld {
                let place = place * member.tip;
                if let Some(lump) = on {
                    lumps[lump].take_up(member, place);
                }
                places.push((on, place));
            } else {
                places.push((Some(lumps.len()), Pose::IDENTITY));
                lumps.push(Member { on, place, ..member.clone() });
            }
        }
        let moved = |end: End| {
            let (member, place) = end.member.map_or((None, Pose::IDENTITY), |member| places[member]);
            End { member, frame: place * end.frame }
        };
        let closures = self.closures.iter().map(|one| Closure { ends: one.ends.map(moved), ..*one }).collect();
        Self { members: lumps, joints: Vec::new(), closures, ..*self }
    }
}

impl Member {
    /// Takes up the mass of another that is welded to it, whose body is at a place seen from its own.
    fn take_up(&mut self, other: &Self, place: Pose) {
        let mass = self.mass + other.mass;
        if other.mass <= 0.0 {
            return;
        }
        let theirs = place * other.centre;
        let centre = (self.centre * self.mass + theirs * other.mass) / mass;
        let turned = Matrix3::from(DMat3::from_quat(place.rotation));
        self.tensor = self.tensor
            + about(self.mass, (self.centre - centre).into())
            + turned * other.tensor * turned.transpose()
            + about(other.mass, (theirs - centre).into());
        (self.mass, self.centre) = (mass, centre);
    }
}

/// The inertia of a point of mass about a place that is so far away.
fn about(mass: f64, away: Vector3<f64>) -> Matrix3<f64> {
    let [x, y, z] = away.into();
    let unit =
        Matrix3::new(y * y + z * z, -x * y, -x * z, -x * y, x * x + z * z, -y * z, -x * z, -y * z, x * x + y * y);
    unit * mass
}

#[cfg(test)]
mod tests {
    use rapier3d::glamx::DQuat;
    use rapier3d::math::Vector;

    use super::super::dynamics::Equations;
    use super::*;

    fn member(on: Option<usize>, freedom: Freedom, first: usize, mass: f64) -> Member {
        let place = Pose::from_parts(Vector::new(0.3, -0.2, 0.5), DQuat::from_xyzw(0.6, 0.0, 0.8, 0.0));
        let tip = Pose::from_parts(Vector::new(0.1, 0.4, -0.2), DQuat::from_xyzw(0.0, 0.28, 0.0, 0.96));
        let tensor = Matrix3::new(0.3, 0.01, 0.0, 0.01, 0.2, 0.02, 0.0, 0.02, 0.4);
        let centre = Vector::new(0.05, 0.1, -0.15);
        Member { on, place, freedom, first: [first; 2], tip, body: None, is_part: false, mass, centre, tensor }
    }

    #[test]
    fn a_lump_has_the_equations_of_its_parts() {
        let turn = Freedom::Turn(Vector::Z);
        let members = vec![
            member(None, Freedom::Weld, 0, 5.0),
            member(Some(0), turn, 0, 2.0),
            member(Some(1), Freedom::Weld, 1, 0.7),
            member(Some(2), Freedom::Weld, 1, 1.3),
            member(Some(2), turn, 1, 0.4),
            member(Some(4), Freedom::Weld, 2, 3.0),
        ];
        let tree = Tree { members, positions: 2, velocities: 2, ..Tree::default() };
        let lumped = tree.lumped();
        assert_eq!(lumped.members.len(), 2);
        let equations = |tree: &Tree| {
            let mut equations = Equations::new(tree);
            equations.evaluate(tree, &[0.4, -1.1], &[2.0, 3.0], Vector::new(0.5, 1.0, -9.81));
            [equations.mass.as_slice(), equations.bias.as_slice()].concat()
        };
        for (one, other) in equations(&tree).iter().zip(&equations(&lumped)) {
            // forces of some 100 N at 1 m, rounded to 2^-53, in some dozen operations
            assert!((one - other).abs() < 1e-12, "{one} {other}");
        }
    }
}
