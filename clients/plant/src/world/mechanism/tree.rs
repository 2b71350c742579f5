//! Which bodies hang together on joints, and in which order: trees that stand on what no force moves.

use nalgebra::Matrix3;
use rapier3d::dynamics::RigidBodyAdditionalMassProps;
use rapier3d::glamx::DQuat;
use rapier3d::prelude::*;

use crate::coupled::Coupled;
use crate::model::JointKind;

/// A joint between two bodies: one of the scene, or one that holds a body fast.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link {
    /// Its index in the scene.
    pub(crate) joint: Option<usize>,
    pub(crate) handle: ImpulseJointHandle,
    pub(crate) kind: JointKind,
    pub(crate) bodies: [RigidBodyHandle; 2],
    /// The joint's frame as each of them sees it.
    pub(crate) frames: [Pose; 2],
}

/// What a member of a tree can do against the one that it stands on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Freedom {
    Weld,
    /// Along this axis of the joint's frame.
    Slide(Vector),
    /// About this axis of the joint's frame.
    Turn(Vector),
    Ball,
}

impl Freedom {
    pub(super) const fn velocities(self) -> usize {
        match self {
            Self::Weld => 0,
            Self::Slide(_) | Self::Turn(_) => 1,
            Self::Ball => 3,
        }
    }

    pub(super) const fn turns(self) -> bool {
        matches!(self, Self::Turn(_) | Self::Ball)
    }

    /// A ball's position is a quaternion.
    pub(super) const fn positions(self) -> usize {
        match self {
            Self::Ball => 4,
            other => other.velocities(),
        }
    }
}

/// A member of a tree: a body and what joins it to the member that it stands on.
#[derive(Clone, Debug)]
pub(super) struct Member {
    /// An earlier one; none for what stands on the ground.
    pub(super) on: Option<usize>,
    /// The joint's frame seen from the body of `on`, or from the world.
    pub(super) place: Pose,
    pub(super) freedom: Freedom,
    /// Its first position and velocity among those of the tree.
    pub(super) first: [usize; 2],
    /// The body seen from the joint's frame after its motion.
    pub(super) tip: Pose,
    /// None for the inner member of a joint that slides and turns.
    pub(super) body: Option<RigidBodyHandle>,
    /// Whether another member stands for its body already, of which it has a part of the mass.
    pub(super) is_part: bool,
    pub(super) mass: f64,
    /// Centre of mass in the body's frame.
    pub(super) centre: Vector,
    /// Inertia about the centre in the body's frame.
    pub(super) tensor: Matrix3<f64>,
}

/// How a joint of the scene is measured in a tree: where its first coordinates are.
#[derive(Clone, Debug)]
pub(super) struct Jointed {
    pub(super) link: Link,
    /// Whether the tree grows from the scene's child to its parent.
    pub(super) reversed: bool,
    /// Its first position and velocity. A slot's first is its slide, whichever way it is passed.
    pub(super) first: [usize; 2],
    pub(super) second: usize,
}

/// What closes a loop.
#[derive(Clone, Debug)]
pub(super) struct Closure {
    /// A joint, or none where the two halves of a body hold each other.
    pub(super) link: Option<Link>,
    pub(super) kind: JointKind,
    /// The frames that it holds against each other: of a joint those on its parent and on its child.
    pub(super) ends: [End; 2],
}

/// A frame on a member of the tree, or in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    pub(super) member: Option<usize>,
    pub(super) frame: Pose,
}

/// A tree of bodies.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    pub(super) members: Vec<Member>,
    pub(super) joints: Vec<Jointed>,
    /// What closes loops: joints whose coordinates the tree does not have, and halves of bodies.
    pub(super) closures: Vec<Closure>,
    pub(super) positions: usize,
    pub(super) velocities: usize,
}

impl Tree {
    /// Whether anything in it turns.
    pub(super) fn turns(&self) -> bool {
        self.members.iter().any(|member| member.freedom.turns())
    }

    fn add(&mut self, member: Member) -> usize {
        let mut member = member;
        member.first = [self.positions, self.velocities];
        self.positions += member.freedom.positions();
        self.velocities += member.freedom.velocities();
        self.members.push(member);
        self.members.len() - 1
    }

    /// Adds the body at the far end of a joint; the member of that body.
    fn grow(&mut self, link: &Link, on: Option<usize>, reversed: bool, bodies: &RigidBodySet) -> usize {
        let [near, far] = if reversed { [1, 0] } else { [0, 1] };
        let sign = if reversed { -1.0 } else { 1.0 };
        let place = match on {
            Some(_) => link.frames[near],
            None => *bodies[link.bodies[near]].position() * link.frames[near],
        };
        let inner = Member {
            on,
            place,
            freedom: Freedom::Weld,
            first: [0; 2],
            tip: Pose::IDENTITY,
            body: None,
            is_part: false,
            mass: 0.0,
            centre: Vector::ZERO,
            tensor: Matrix3::zeros(),
        };
        let properties = properties(&bodies[link.bodies[far]]);
        let outer = Member {
            tip: link.frames[far].inverse(),
            body: Some(link.bodies[far]),
            mass: properties.mass(),
            centre: properties.local_com,
            tensor: properties.reconstruct_inertia_matrix().into(),
            ..inner.clone()
        };
        let (slide, turn) = (Freedom::Slide(Vector::Y * sign), Freedom::Turn(Vector::X * sign));
        let first = [self.positions, self.velocities];
        let (member, first, second) = match link.kind {
            JointKind::Fixed => (self.add(outer), first, 0),
            JointKind::Prismatic => (self.add(Member { freedom: Freedom::Slide(Vector::X * sign), ..outer }), first, 0),
            JointKind::Revolute => (self.add(Member { freedom: turn, ..outer }), first, 0),
            JointKind::Ball => (self.add(Member { freedom: Freedom::Ball, ..outer }), first, 0),
            JointKind::Slot => {
                let [before, after] = if reversed { [turn, slide] } else { [slide, turn] };
                let on = Some(self.add(Member { freedom: before, ..inner }));
                let last = self.add(Member { on, freedom: after, place: Pose::IDENTITY, ..outer });
                let [position, velocity] = first;
                let slides = if reversed { [position + 1, velocity + 1] } else { first };
                (last, slides, if reversed { position } else { position + 1 })
            }
        };
        self.joints.push(Jointed { link: *link, reversed, first, second });
        member
    }

    /// Closes a loop by a joint at which coordinates are needed: it gets half of the body at its far end, of which `half`
    /// is the other, and both halves hold each other.
    fn split(&mut self, link: &Link, half: usize, on: Option<usize>, reversed: bool, bodies: &RigidBodySet) {
        let own = self.grow(link, on, reversed, bodies);
        let (mass, tensor) = (0.5 * self.members[half].mass, 0.5 * self.members[half].tensor);
        for member in [half, own] {
            (self.members[member].mass, self.members[member].tensor) = (mass, tensor);
        }
        self.members[own].is_part = true;
        let ends = [half, own].map(|member| End { member: Some(member), frame: Pose::IDENTITY });
        self.closures.push(Closure { link: None, kind: JointKind::Fixed, ends });
    }
}

/// What joints make of the bodies.
pub(super) struct Forest {
    pub(super) trees: Vec<Tree>,
    /// The joints, by their index in the scene, of what is not a tree: it stands on nothing or on what moves by itself, or
    /// what holds a body fast closes a loop.
    pub(super) others: Vec<usize>,
}

/// The forest of these joints, of bodies that are `moved`. A loop is closed by a joint that is `plain`, if it has one:
/// nothing drives it, brakes it, stops it or asks for its coordinate in a coupling. Else a body of it is halved.
pub(super) fn forest(
    links: &[Link],
    couplings: &[Coupled],
    bodies: &RigidBodySet,
    moved: &impl Fn(RigidBodyHandle) -> bool,
    plain: &impl Fn(&Link) -> bool,
) -> Forest {
    let mut forest = Forest { trees: Vec::new(), others: Vec::new() };
    let mut done = vec![false; links.len()];
    for start in 0..links.len() {
        if done[start] {
            continue;
        }
        let together = together(links, couplings, start, moved);
        for index in &together {
            done[*index] = true;
        }
        // in the scene's order if that will do; else what is plain comes last, so that it closes the loops
        let plain_last = || {
            let mut order = together.clone();
            order.sort_by_key(|index| plain(&links[*index]));
            order
        };
        let grown = |order: &[usize], may_split: bool| grown(links, order, bodies, moved, plain, may_split);
        let tree = grown(&together, false).or_else(|| grown(&plain_last(), false));
        match tree.or_else(|| grown(&plain_last(), true)) {
            Some(tree) => forest.trees.push(tree),
            None => forest.others.extend(together.iter().filter_map(|index| links[*index].joint)),
        }
    }
    forest
}

/// All joints that hang together with one, by bodies that forces move or by couplings, in order.
fn together(
    links: &[Link],
    couplings: &[Coupled],
    start: usize,
    moved: &impl Fn(RigidBodyHandle) -> bool,
) -> Vec<usize> {
    let mut found = vec![start];
    let mut next = 0;
    while next < found.len() {
        let one = &links[found[next]];
        next += 1;
        for (index, other) in links.iter().enumerate() {
            let share = other.bodies.into_iter().any(|body| moved(body) && one.bodies.contains(&body));
            let bound = |coupled: &Coupled| {
                let joins = |joint: Option<usize>| joint.is_some_and(|joint| coupled.joins(joint));
                joins(one.joint) && joins(other.joint)
            };
            if !found.contains(&index) && (share || couplings.iter().any(bound)) {
                found.push(index);
            }
        }
    }
    found.sort_unstable();
    found
}

/// The tree of joints that hang together, if they are one; joints that are `plain` may close loops of it, and, if it
/// `may_split` bodies, all joints of the scene.
fn grown(
    links: &[Link],
    together: &[usize],
    bodies: &RigidBodySet,
    moved: &impl Fn(RigidBodyHandle) -> bool,
    plain: &impl Fn(&Link) -> bool,
    may_split: bool,
) -> Option<Tree> {
    let mut tree = Tree::default();
    let mut left = together.to_vec();
    let mut place: Vec<(RigidBodyHandle, usize)> = Vec::new();
    let whole = |handle: RigidBodyHandle| bodies[handle].is_enabled();
    while !left.is_empty() {
        let find = |body: RigidBodyHandle, place: &[(RigidBodyHandle, usize)]| {
            place.iter().find(|(known, _)| *known == body).map(|(_, member)| *member)
        };
        let ready = left.iter().position(|index| {
            links[*index].bodies.into_iter().any(|body| bodies[body].is_fixed() || find(body, &place).is_some())
        })?;
        let link = &links[left.remove(ready)];
        let known = link.bodies.map(|body| bodies[body].is_fixed() || find(body, &place).is_some());
        let reversed = match known {
            [true, false] => false,
            [false, true] => true,
            // both are known: a loop, if they are not both of the ground
            _ if plain(link) && !tree.members.is_empty() && link.bodies.into_iter().all(whole) => {
                let end = |at: usize| {
                    let (body, frame) = (link.bodies[at], link.frames[at]);
                    let member = find(body, &place);
                    End { member, frame: if member.is_none() { *bodies[body].position() * frame } else { frame } }
                };
                tree.closures.push(Closure { link: Some(*link), kind: link.kind, ends: [end(0), end(1)] });
                continue;
            }
            _ if may_split
                && link.joint.is_some()
                && !tree.members.is_empty()
                && link.bodies.into_iter().all(whole) =>
            {
                // what is split must be one that forces move
                let reversed = bodies[link.bodies[1]].is_fixed();
                let [near, far] = if reversed { [link.bodies[1], link.bodies[0]] } else { link.bodies };
                tree.split(link, find(far, &place)?, find(near, &place), reversed, bodies);
                continue;
            }
            _ => return None,
        };
        let [near, far] = if reversed { [link.bodies[1], link.bodies[0]] } else { link.bodies };
        if !moved(far) || !whole(far) || !whole(near) {
            return None;
        }
        let member = tree.grow(link, find(near, &place), reversed, bodies);
        place.push((far, member));
    }
    Some(tree)
}

/// The coordinates of a joint in the scene's sense, from where its bodies are: what it slides by, turns
/// by, and how it is turned.
pub(super) fn between(link: &Link, bodies: &RigidBodySet) -> (Vector, f64, DQuat) {
    let [parent, child] = [0, 1].map(|end| *bodies[link.bodies[end]].position() * link.frames[end]);
    let between = parent.inv_mul(&child);
    (between.translation, 2.0 * libm::atan2(between.rotation.x, between.rotation.w), between.rotation)
}
/// What a body weighs. The engine adds up its shapes by way of principal axes, which loses digits, and all but three of
/// them for a light finger; where none of them has a mass, what the scene says is exact.
fn properties(body: &RigidBody) -> MassProperties {
    let whole = body.mass_properties();
    match whole.additional_local_mprops.as_deref() {
        Some(RigidBodyAdditionalMassProps::MassProps(stated))
            if (stated.mass() - whole.local_mprops.mass()).abs() < 1e-14 * stated.mass() =>
        {
            *stated
        }
        Some(_) | None => whole.local_mprops,
    }
}
