//! The tables of an assembly's parts: named for their component, and moved to its place.

use rapier3d::glamx::DQuat;
use rapier3d::math::{Pose, Vector};
use toml::Value;

use super::assembly::FOREIGN;
use super::{Kinds, Own, text_of};
use crate::coupling::Names;
use crate::pose::{from_rpy_deg, to_rpy_deg, turned_tensor};
use crate::scene::arrays::numbers;
use crate::scene::error::SceneFaultKind;
use crate::scene::faults::Faults;
use crate::scene::format::SHOWN_AT;
use crate::scene::format::{ComponentTable, SceneFile, Triple};
use crate::scene::placed::Placed;
use crate::scene::text;
use onescan_base::array;

/// Names that are of the assembly, and those that a component was given from outside.
struct Renaming<'o> {
    owner: &'o str,
    /// Bodies, shapes and joints.
    own: Vec<String>,
}

impl Renaming<'_> {
    /// The name of a part.
    fn name(&self, name: &mut Placed<String>) {
        let new = format!("{}.{}", self.owner, name.get_ref());
        *name.get_mut() = new;
    }

    /// A name that may be a part's, or that of something outside.
    fn reference(&self, name: &mut Placed<String>) {
        let new = self.referred(name.get_ref());
        *name.get_mut() = new;
    }

    fn referred(&self, name: &str) -> String {
        if let Some(foreign) = name.strip_prefix(FOREIGN) {
            return foreign.to_owned();
        }
        let is_own = |name: &str| self.own.iter().any(|own| own == name);
        // a range of names is own if its first is
        let first = || array::names(name).ok().and_then(|names| names.into_iter().next());
        let owned = is_own(name) || first().is_some_and(|first| is_own(&first));
        if owned { format!("{}.{name}", self.owner) } else { name.to_owned() }
    }

    fn value(&self, value: &mut Value) {
        match value {
            Value::String(name) => *name = self.referred(name),
            Value::Array(list) => list.iter_mut().for_each(|one| self.value(one)),
            Value::Integer(_) | Value::Float(_) | Value::Boolean(_) | Value::Datetime(_) | Value::Table(_) => {}
        }
    }
}

/// Names all parts for the component that they belong to.
pub(super) fn belong(parts: &mut SceneFile, owner: &str, kinds: &Kinds) {
    let bodies = parts.body.iter().map(|body| &body.get_ref().name);
    let shapes = parts.shape.iter().map(|shape| &shape.get_ref().name);
    let joints = parts.joint.iter().map(|joint| &joint.get_ref().name);
    let own = bodies.chain(shapes).chain(joints).map(|name| text(name).to_owned()).collect();
    let renaming = Renaming { owner, own };
    for body in parts.body.iter_mut().map(Placed::get_mut) {
        renaming.name(&mut body.name);
        body.group.iter_mut().for_each(|group| renaming.name(group));
    }
    for shape in parts.shape.iter_mut().map(Placed::get_mut) {
        renaming.name(&mut shape.name);
        renaming.reference(&mut shape.body);
    }
    for joint in parts.joint.iter_mut().map(Placed::get_mut) {
        renaming.name(&mut joint.name);
        renaming.reference(&mut joint.parent);
        renaming.reference(&mut joint.child);
        joint.follows.iter_mut().for_each(|follows| renaming.reference(&mut follows.joint));
    }
    for fitting in parts.fitting.iter_mut().map(Placed::get_mut) {
        renaming.name(&mut fitting.name);
        renaming.reference(&mut fitting.joint);
    }
    for coupling in parts.coupling.iter_mut().map(Placed::get_mut) {
        renaming.name(&mut coupling.name);
        renaming.reference(&mut coupling.joint);
        coupling.of.iter_mut().for_each(|one| renaming.reference(one));
    }
    for component in parts.component.iter_mut().map(Placed::get_mut) {
        component_belongs(component, &renaming, kinds);
    }
}

fn component_belongs(component: &mut ComponentTable, renaming: &Renaming<'_>, kinds: &Kinds) {
    let binding_keys = binding_keys(component, kinds);
    for (key, value) in component.iter_mut() {
        let key = key.get_ref();
        match value.get_mut() {
            Value::String(name) if key == "name" => *name = format!("{}.{name}", renaming.owner),
            Value::String(from) if key.ends_with("_from") => match from.strip_prefix(FOREIGN) {
                Some(foreign) => *from = foreign.to_owned(),
                None => *from = format!("{}.{from}", renaming.owner),
            },
            value if binding_keys.iter().any(|binding| binding == key) => renaming.value(value),
            _ => {}
        }
    }
}

/// The keys by which a part is bound to things of the scene.
fn binding_keys(component: &ComponentTable, kinds: &Kinds) -> Vec<String> {
    let Some(kind) = text_of(component, "kind") else { return Vec::new() };
    match kinds.own.get(text(&kind)) {
        Some(Own::Assembly(assembly)) => {
            assembly.header.binding.iter().map(|binding| text(&binding.key).to_owned()).collect()
        }
        _ => kinds
            .find(text(&kind))
            .map_or_else(Vec::new, |kind| kind.coupling.keys().iter().map(|binding| binding.key.to_owned()).collect()),
    }
}

/// Moves all parts from the assembly's own origin to where the component is.
pub(super) fn put(parts: &mut SceneFile, table: &ComponentTable, kinds: &Kinds, faults: &mut Faults<'_>) {
    let [position_m, rpy_deg] = ["position_m", "rpy_deg"].map(|key| triple(table, key, faults).unwrap_or_default());
    let place = Place { pose: from_rpy_deg(position_m, rpy_deg) };
    if place.is_here() {
        return;
    }
    for body in parts.body.iter_mut().map(Placed::get_mut) {
        place.spot(&mut body.position_m, &mut body.rpy_deg);
        body.centre_m.iter_mut().for_each(|centre| place.point(centre));
        body.velocity_m_s.iter_mut().for_each(|velocity| place.direction(velocity));
        if let Some(inertia) = body.inertia_kg_m2.as_mut().filter(|_| !place.is_upright()) {
            let turned = turned_tensor(*inertia.get_ref(), place.pose.rotation);
            *inertia.get_mut() = turned;
        }
    }
    for shape in parts.shape.iter_mut().map(Placed::get_mut) {
        place.spot(&mut shape.position_m, &mut shape.rpy_deg);
    }
    for joint in parts.joint.iter_mut().map(Placed::get_mut) {
        joint.anchor_m.iter_mut().for_each(|anchor| place.point(anchor));
        joint.axis.iter_mut().for_each(|axis| place.direction(axis));
        joint.slide.iter_mut().for_each(|slide| place.direction(slide));
    }
    for component in parts.component.iter_mut().map(Placed::get_mut) {
        place.component(component, kinds);
    }
}

/// Where a component is.
struct Place {
    pose: Pose,
}

impl Place {
    fn is_here(&self) -> bool {
        self.pose.translation == Vector::ZERO && self.is_upright()
    }

    /// Whether nothing is turned. What is not keeps its numbers to the bit.
    fn is_upright(&self) -> bool {
        self.pose.rotation == DQuat::IDENTITY
    }

    fn moved(&self, at: [f64; 3]) -> [f64; 3] {
        (self.pose * Vector::from_array(at)).to_array()
    }

    fn turned(&self, direction: [f64; 3]) -> [f64; 3] {
        (self.pose.rotation * Vector::from_array(direction)).to_array()
    }

    fn point(&self, at: &mut Triple) {
        let moved = self.moved(*at.get_ref());
        *at.get_mut() = moved;
    }

    fn direction(&self, direction: &mut Triple) {
        let turned = self.turned(*direction.get_ref());
        *direction.get_mut() = turned;
    }

    fn spot(&self, position: &mut Option<Triple>, rpy: &mut Option<Triple>) {
        let span = position.as_ref().or(rpy.as_ref()).map_or(0..0, Placed::span);
        let at = |spot: &Option<Triple>| spot.as_ref().map_or([0.0; 3], |spot| *spot.get_ref());
        let (position_m, rpy_deg) = self.spot_of(at(position), at(rpy));
        *position = Some(Placed::new(span.clone(), position_m));
        if !self.is_upright() {
            *rpy = Some(Placed::new(span, rpy_deg));
        }
    }

    fn spot_of(&self, position_m: [f64; 3], rpy_deg: [f64; 3]) -> ([f64; 3], [f64; 3]) {
        let turned = (self.pose * from_rpy_deg(position_m, rpy_deg)).rotation;
        (self.moved(position_m), to_rpy_deg(turned))
    }

    /// Moves what a component says of points and directions; a part that is an assembly has a place of its own.
    fn component(&self, component: &mut ComponentTable, kinds: &Kinds) {
        let Some(kind) = text_of(component, "kind") else { return };
        if let Some(Own::Assembly(_)) = kinds.own.get(text(&kind)) {
            let at = |key: &str| component.get(key).and_then(|value| numbers(value.get_ref())).unwrap_or_default();
            let (position_m, rpy_deg) = self.spot_of(at("position_m"), at("rpy_deg"));
            set(component, "position_m", position_m, &kind);
            if !self.is_upright() {
                set(component, "rpy_deg", rpy_deg, &kind);
            }
            return;
        }
        let Some(known) = kinds.find(text(&kind)) else { return };
        for binding in known.coupling.keys() {
            let written = component.get(binding.key).and_then(|value| numbers(value.get_ref()));
            match (binding.names, written) {
                (Names::Point, Some(at)) => set(component, binding.key, self.moved(at), &kind),
                (Names::Direction | Names::Along, Some(direction)) => {
                    set(component, binding.key, self.turned(direction), &kind);
                }
                _ => {}
            }
        }
        if let Some(at) = component.get(SHOWN_AT).and_then(|value| numbers(value.get_ref())) {
            set(component, SHOWN_AT, self.moved(at), &kind);
        }
    }
}

/// Three numbers behind a key of a component that is an assembly.
fn triple(table: &ComponentTable, key: &str, faults: &mut Faults<'_>) -> Option<[f64; 3]> {
    let value = table.get(key)?;
    let found = numbers(value.get_ref()).filter(|triple| triple.iter().all(|number| number.is_finite()));
    if found.is_none() {
        faults.add(value.span(), SceneFaultKind::Text { key: key.to_owned(), wanted: "three numbers" });
    }
    found
}

fn set(component: &mut ComponentTable, key: &str, triple: [f64; 3], at: &Placed<String>) {
    let value = Value::Array(triple.map(Value::Float).to_vec());
    match component.get_mut(key) {
        Some(written) => *written.get_mut() = value,
        None => {
            component.insert(Placed::new(at.span(), key.to_owned()), Placed::new(at.span(), value));
        }
    }
}
