//! Joints that close a loop.
//!
//! A loop that stands on the ground is moved by the coordinates of its joints, as exactly as a tree. The engine moves any
//! other: joints give by micrometres, and all is of the first order of the step only.

use std::collections::VecDeque;

use serde::Serialize;

use crate::model::{BodyKind, Joint};
use crate::scene::Scene;
use crate::start::ANY_PERIOD;
use crate::world::World;

/// A loop of joints.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Loop {
    /// The joint that closes it: the last one of it in the scene.
    pub closing: String,
    /// The others, from one body of that joint to the other.
    pub joints: Vec<String>,
    /// Whether the engine moves it.
    pub by_engine: bool,
}

impl std::fmt::Display for Loop {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let joints: Vec<_> = self.joints.iter().map(|joint| format!("`{joint}`")).collect();
        write!(f, "joint `{}` closes a loop with {}", self.closing, joints.join(", "))?;
        if self.by_engine {
            write!(f, ", exact only to the first order of the step: nothing of it stands on what is fixed")?;
        }
        Ok(())
    }
}

/// A place where joints meet: a body that moves, or all that stands.
type Node = Option<usize>;

impl Scene {
    /// The loops of its joints, each with the joint that closes it, in the scene's order. Robots without dynamics have
    /// none.
    pub fn loops(&self) -> Vec<Loop> {
        let world = World::at_the_start(self, ANY_PERIOD);
        let mut tree: Vec<(usize, [Node; 2])> = Vec::new();
        let mut found = Vec::new();
        for (index, joint) in self.joints.iter().enumerate().filter(|(_, joint)| !joint.guided) {
            let ends = self.ends(joint);
            match way(&tree, ends) {
                Some(way) => {
                    let joints = way.into_iter().map(|index| self.joints[index].name.clone()).collect();
                    found.push(Loop {
                        closing: joint.name.clone(),
                        joints,
                        by_engine: world.articulation.leaves(index),
                    });
                }
                None => tree.push((index, ends)),
            }
        }
        found
    }

    fn ends(&self, joint: &Joint) -> [Node; 2] {
        let moves = |body: &usize| self.bodies[*body].kind != BodyKind::Fixed;
        [joint.parent.filter(moves), Some(joint.child).filter(moves)]
    }
}

/// The joints of a tree from one place to another, if they are in one.
fn way(tree: &[(usize, [Node; 2])], [from, to]: [Node; 2]) -> Option<Vec<usize>> {
    let mut reached: Vec<(Node, Vec<usize>)> = vec![(from, Vec::new())];
    let mut next = VecDeque::from([0]);
    while let Some(at) = next.pop_front() {
        let (node, way) = reached[at].clone();
        if node == to {
            return Some(way);
        }
        for (joint, [one, other]) in tree {
            let beyond = if *one == node { *other } else { *one };
            let meets = (*one == node) != (*other == node);
            if meets && reached.iter().all(|(known, _)| *known != beyond) {
                reached.push((beyond, [&way[..], &[*joint]].concat()));
                next.push_back(reached.len() - 1);
            }
        }
    }
    None
}
