//! Where bodies are, as a tree of boxes: of a thousand bodies a sensor looks at the few whose boxes it meets. What the
//! tree leaves over is looked at exactly, so that the tree decides nothing.

use rapier3d::parry::bounding_volume::{Aabb, BoundingSphere, BoundingVolume};
use rapier3d::parry::partitioning::{Bvh, BvhNode, BvhWorkspace};
use rapier3d::prelude::*;

use super::World;

/// Added to every box, for numbers are rounded.
const MARGIN_M: f64 = 1e-3;
/// How far a body may move before its box is drawn again.
const SKIN_M: f64 = 0.02;
/// From so many bodies on, a search in a tree is faster than a look at each.
const MANY: usize = 64;

/// The boxes of all bodies that have a shape.
pub(super) struct Nearby {
    /// A leaf of the tree is a place in here.
    bodies: Vec<Boxed>,
    /// None of few bodies: each is looked at.
    tree: Option<Tree>,
}

/// A body and the box around it.
struct Boxed {
    handle: RigidBodyHandle,
    /// As the body sees it.
    local: Aabb,
    /// Fixed bodies stay where they are: only dynamic ones are ever put somewhere.
    is_fixed: bool,
    /// Where the body was when its box was drawn, and that box.
    drawn: Option<(Pose, Aabb)>,
}

impl Boxed {
    /// Draws the box of a body again if it is somewhere else.
    fn follow(&mut self, physics: &PhysicsWorld) -> Option<Aabb> {
        if self.is_fixed && self.drawn.is_some() {
            return None;
        }
        let pose = *physics.bodies[self.handle].position();
        if self.drawn.is_some_and(|(before, _)| before == pose) {
            return None;
        }
        let here = self.local.transform_by(&pose).loosened(MARGIN_M);
        self.drawn = Some((pose, here));
        Some(here)
    }
}

#[derive(Default)]
struct Tree {
    tree: Bvh,
    workspace: BvhWorkspace,
}

impl Tree {
    fn draw(&mut self, here: Aabb, leaf: u32) {
        self.tree.insert_or_update_partially(here, leaf, SKIN_M);
    }

    fn tidy(&mut self) {
        self.tree.refit(&mut self.workspace);
        self.tree.optimize_incremental(&mut self.workspace);
    }
}

impl Nearby {
    pub(super) fn of(physics: &PhysicsWorld) -> Self {
        let boxed = |(handle, body): (_, &RigidBody)| {
            let local = own_box(body, &physics.colliders)?;
            Some(Boxed { handle, local, is_fixed: body.is_fixed(), drawn: None })
        };
        let bodies: Vec<_> = physics.bodies.iter().filter_map(boxed).collect();
        let tree = (bodies.len() >= MANY).then(Tree::default);
        let mut nearby = Self { bodies, tree };
        nearby.follow(physics);
        nearby
    }

    /// Bodies whose boxes meet another one, in no order.
    pub(super) fn bodies_in<'a>(&'a self, around: &'a Aabb) -> impl Iterator<Item = RigidBodyHandle> + 'a {
        let leaves = self.tree.as_ref().map(|tree| tree.tree.intersect_aabb(around));
        let in_tree = leaves.into_iter().flatten().filter_map(|leaf| self.bodies.get(leaf as usize));
        let few = if self.tree.is_none() { self.bodies.as_slice() } else { &[] };
        // The tree knows boxes as they were drawn at some time; who is there must not hang on that.
        let is_there = |boxed: &&Boxed| boxed.drawn.is_some_and(|(_, here)| here.intersects(around));
        in_tree.chain(few).filter(is_there).map(|boxed| boxed.handle)
    }

    /// Draws the boxes of bodies that have moved.
    fn follow(&mut self, physics: &PhysicsWorld) {
        let mut moved = false;
        for (leaf, boxed) in (0_u32..).zip(&mut self.bodies) {
            let Some(here) = boxed.follow(physics) else { continue };
            if let Some(tree) = &mut self.tree {
                tree.draw(here, leaf);
                moved = true;
            }
        }
        if let Some(tree) = self.tree.as_mut().filter(|_| moved) {
            tree.tidy();
        }
    }

    /// Gives it a tree, however few the bodies are.
    fn grow_tree(&mut self) {
        let bodies = &self.bodies;
        self.tree.get_or_insert_with(|| {
            let mut tree = Tree::default();
            for (leaf, boxed) in (0_u32..).zip(bodies) {
                if let Some((_, here)) = boxed.drawn {
                    tree.draw(here, leaf);
                }
            }
            tree.tidy();
            tree
        });
    }
}

/// The box around the shapes of a body as the body sees it; none of one without a shape.
pub(super) fn own_box(body: &RigidBody, colliders: &ColliderSet) -> Option<Aabb> {
    let shapes = body.colliders().iter().filter_map(|collider| colliders.get(*collider));
    let boxes = shapes.map(|collider| {
        let local = collider.position_wrt_parent().copied().unwrap_or(Pose::IDENTITY);
        collider.shape().compute_aabb(&local)
    });
    boxes.reduce(|one, other| one.merged(&other))
}

/// A ray, made ready for many boxes.
struct Path {
    from: [f64; 3],
    /// One over each part of its direction; none across which it never goes.
    inverse: [Option<f64>; 3],
}

impl Path {
    fn of(ray: &Ray) -> Self {
        let inverse = ray.dir.to_array().map(|part| (part != 0.0).then(|| part.recip()));
        Self { from: ray.origin.to_array(), inverse }
    }

    /// How far along the ray it enters a box; `f64::MAX`, as the tree has it, if it never does or not before `nearest_m`.
    fn enters_m(&self, around: &Aabb, nearest_m: f64) -> f64 {
        let (mins, maxs) = (around.mins.to_array(), around.maxs.to_array());
        let (mut enters_m, mut leaves_m) = (0.0_f64, nearest_m);
        for axis in 0..3 {
            let (from, [near, far]) = (self.from[axis], [mins[axis], maxs[axis]]);
            match self.inverse[axis] {
                None if from < near || from > far => return f64::MAX,
                None => {}
                Some(inverse) => {
                    let ways = [(near - from) * inverse, (far - from) * inverse];
                    enters_m = enters_m.max(ways[0].min(ways[1]));
                    leaves_m = leaves_m.min(ways[0].max(ways[1]));
                }
            }
        }
        if enters_m <= leaves_m { enters_m } else { f64::MAX }
    }
}

/// The bodies that a sensor looks for, in the order in which its scene names them.
pub(crate) struct Sought {
    handles: Vec<RigidBodyHandle>,
    /// Of many bodies each by its leaf of the tree, with its place among them; none for leaves of others.
    by_leaf: Option<Vec<Option<(u32, RigidBodyHandle)>>>,
}

impl Sought {
    /// All of them.
    pub(crate) fn handles(&self) -> &[RigidBodyHandle] {
        &self.handles
    }
}

/// Bodies that a sensor looks for, and the tree in which it searches.
struct Search<'w> {
    tree: &'w Bvh,
    by_leaf: &'w [Option<(u32, RigidBodyHandle)>],
}

impl Search<'_> {
    /// The body of a leaf with its place, if it is one of those.
    fn found(&self, leaf: u32) -> Option<(u32, RigidBodyHandle)> {
        self.by_leaf.get(leaf as usize).copied().flatten()
    }
}

impl World {
    /// Notes that a sensor looks for these bodies.
    pub(crate) fn seek(&mut self, handles: Vec<RigidBodyHandle>) -> Sought {
        if handles.len() < MANY { Sought { handles, by_leaf: None } } else { self.seek_in_tree(handles) }
    }

    fn seek_in_tree(&mut self, handles: Vec<RigidBodyHandle>) -> Sought {
        let nearby = self.nearby.get_or_insert_with(|| Nearby::of(&self.physics));
        nearby.grow_tree();
        let mut by_leaf = vec![None; nearby.bodies.len()];
        for (place, handle) in (0_u32..).zip(&handles) {
            // The bodies are in the order of their handles, as the engine gives them.
            let number = |handle: RigidBodyHandle| handle.into_raw_parts().0;
            let leaf = nearby.bodies.binary_search_by_key(&number(*handle), |boxed| number(boxed.handle));
            let Ok(leaf) = leaf else { continue };
            if by_leaf[leaf].replace((place, *handle)).is_some() {
                // One that is named twice counts twice, which a leaf cannot tell.
                return Sought { handles, by_leaf: None };
            }
        }
        Sought { handles, by_leaf: Some(by_leaf) }
    }

    /// How to search for bodies of which there are many; none if each is looked at.
    fn search<'w>(&'w self, sought: &'w Sought) -> Option<Search<'w>> {
        let tree = self.nearby.as_ref()?.tree.as_ref()?;
        Some(Search { tree: &tree.tree, by_leaf: sought.by_leaf.as_deref()? })
    }

    /// Takes notice of where the bodies are now, before sensors look.
    pub(crate) fn look_around(&mut self) {
        if let Some(nearby) = &mut self.nearby {
            nearby.follow(&self.physics);
        }
    }

    /// The shortest way along a ray to one of these bodies.
    pub(crate) fn first_hit(&self, ray: &Ray, sought: &Sought) -> Option<f64> {
        let Some(search) = self.search(sought) else {
            return sought.handles.iter().filter_map(|handle| self.ray_distance(ray, *handle)).reduce(f64::min);
        };
        let met = |leaf: u32, _: f64| search.found(leaf).and_then(|(_, handle)| self.ray_distance(ray, handle));
        let path = Path::of(ray);
        let enters_m = |node: &BvhNode, nearest_m: f64| path.enters_m(&node.aabb(), nearest_m);
        search.tree.find_best(self.extent_m, enters_m, met).map(|(_, distance_m)| distance_m)
    }

    /// True if a ray meets the shape of one of these bodies within its range.
    pub(crate) fn any_hit(&self, ray: &Ray, range_m: f64, sought: &Sought) -> bool {
        let Some(search) = self.search(sought) else {
            return sought.handles.iter().any(|handle| self.ray_meets(ray, range_m, *handle));
        };
        let path = Path::of(ray);
        let mut leaves = search.tree.leaves(|node| path.enters_m(&node.aabb(), range_m) <= range_m);
        leaves.any(|leaf| search.found(leaf).is_some_and(|(_, handle)| self.ray_meets(ray, range_m, handle)))
    }

    /// Calls `look` with those of these bodies that may touch something in a ball, each with its place among them, in
    /// no order.
    pub(crate) fn each_near(&self, ball: &BoundingSphere, sought: &Sought, mut look: impl FnMut(u32, RigidBodyHandle)) {
        let mut look_near = |(place, handle): (u32, RigidBodyHandle)| {
            if self.is_near_ball(ball, handle) {
                look(place, handle);
            }
        };
        let Some(search) = self.search(sought) else {
            (0_u32..).zip(sought.handles.iter().copied()).for_each(look_near);
            return;
        };
        let around = Aabb::from_half_extents(ball.center, Vector::splat(ball.radius));
        search.tree.intersect_aabb(&around).filter_map(|leaf| search.found(leaf)).for_each(&mut look_near);
    }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use onescan_server::time::TimeSpan;
    use proptest::prelude::*;

    use super::*;
    use crate::effort::Nobody;
    use crate::scene::Scene;

    /// Boxes that fly through each other, each with its place and its velocity, and a long one among them.
    fn flying(boxes: &[([f64; 3], [f64; 3])]) -> Scene {
        let mut scene = "version = 1\ngravity_m_s2 = [0, 0, 0]\n".to_owned();
        for (index, (place, velocity)) in boxes.iter().enumerate() {
            let length_m = if index == 0 { 5.0 } else { 0.2 };
            write!(
                scene,
                "[[body]]\nname = \"box_{index}\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [{length_m}, 0.2, 0.1]\n\
                 mass_kg = 1.0\ncollides = false\nposition_m = {place:?}\nvelocity_m_s = {velocity:?}\n"
            )
            .expect("a string takes all");
        }
        Scene::parse(&scene, "flying.toml").unwrap_or_else(|error| panic!("{error}"))
    }

    fn triple(range: std::ops::Range<f64>) -> impl Strategy<Value = [f64; 3]> {
        proptest::array::uniform3(range)
    }

    /// Those that touch a body, by their places.
    fn touching(world: &World, body: RigidBodyHandle, sought: &Sought) -> Vec<u32> {
        let surface = world.surface(body, None);
        let mut places = Vec::new();
        let Some(ball) = world.ball_around(surface) else { return places };
        world.each_near(&ball, sought, |place, handle| {
            if world.touch(surface, handle) {
                places.push(place);
            }
        });
        places.sort_unstable();
        places
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]

        #[test]
        fn a_search_finds_what_a_look_at_each_finds(
            boxes in proptest::collection::vec((triple(-2.0..2.0), triple(-3.0..3.0)), 16..64_usize),
            rays in proptest::collection::vec((triple(-3.0..3.0), triple(-1.0..1.0), 0.1..5.0_f64), 20),
            out in any::<prop::sample::Index>(),
        ) {
            let scene = flying(&boxes);
            let mut world = World::build(&scene, TimeSpan::from_millis(10).expect("not zero"));
            world.find_mechanisms();
            // the last first, so that a place is not a number of the engine
            let handles: Vec<_> = (0..boxes.len()).rev().map(|body| world.handle(Some(body))).collect();
            let sought = world.seek_in_tree(handles.clone());
            let plain = Sought { handles: handles.clone(), by_leaf: None };
            prop_assert!(sought.by_leaf.is_some());
            for _ in 0..10 {
                world.step(&scene, &mut Nobody).expect("they stay in the world");
                world.look_around();
                for (from, to, range_m) in &rays {
                    let ray = Ray::new(Vector::from_array(*from), Vector::from_array(*to).normalize_or(Vector::X));
                    prop_assert_eq!(world.first_hit(&ray, &sought), world.first_hit(&ray, &plain));
                    prop_assert_eq!(world.any_hit(&ray, *range_m, &sought), world.any_hit(&ray, *range_m, &plain));
                }
                for handle in &handles {
                    prop_assert_eq!(touching(&world, *handle, &sought), touching(&world, *handle, &plain));
                }
                world.take_out(handles[out.index(handles.len())]).expect("it is there");
            }
        }

        #[test]
        fn who_is_near_does_not_hang_on_where_it_was(
            boxes in proptest::collection::vec((triple(-2.0..2.0), triple(-3.0..3.0)), 4..100_usize),
            places in proptest::collection::vec(triple(-3.0..3.0), 20),
        ) {
            let scene = flying(&boxes);
            let mut world = World::build(&scene, TimeSpan::from_millis(10).expect("not zero"));
            world.find_mechanisms();
            let mut followed = Nearby::of(&world.physics);
            for _ in 0..10 {
                world.step(&scene, &mut Nobody).expect("they stay in the world");
                followed.follow(&world.physics);
                let fresh = Nearby::of(&world.physics);
                for place in &places {
                    let around = Aabb::from_half_extents(Vector::from_array(*place), Vector::splat(0.3));
                    let found = |nearby: &Nearby| {
                        let mut found: Vec<_> = nearby.bodies_in(&around).map(RigidBodyHandle::into_raw_parts).collect();
                        found.sort_unstable();
                        found
                    };
                    prop_assert_eq!(found(&followed), found(&fresh));
                }
            }
        }

        #[test]
        fn what_is_named_twice_counts_twice(boxes in proptest::collection::vec((triple(-2.0..2.0), Just([0.0; 3])), 16)) {
            let scene = flying(&boxes);
            let mut world = World::build(&scene, TimeSpan::from_millis(10).expect("not zero"));
            let first = world.handle(Some(0));
            let handles = (0..boxes.len()).map(|body| world.handle(Some(body))).chain([first]).collect();
            let sought = world.seek_in_tree(handles);
            let ball = world.ball_around(world.surface(first, None)).expect("it has a shape");
            let mut found = 0;
            world.each_near(&ball, &sought, |_, handle| found += u32::from(handle == first));
            prop_assert_eq!(found, 2);
        }
    }
}
