//! What a component is bound to: the keys of its coupling, found in the scene.

use super::placed::Placed;

use super::bodies::GROUND;
use super::component_keys::Keys;
use super::error::{SceneFaultKind, Thing};
use super::faults::Faults;
use super::format::SceneFile;
use super::joints::{kind_name, refuse_guided, unit};
use super::model::{Axis, Bound, Driven, Moved};
use super::names::Names;
use super::own::Kinds;
use super::text;
use crate::coupling::{BindingKey, Coupling, Names as Named, Which};
use crate::model::{BodyKind, JointKind};

/// What of a direction is across another one.
fn across(along: [f64; 3], direction: Option<[f64; 3]>) -> [f64; 3] {
    let Some(direction) = direction else { return along };
    let part: f64 = along.iter().zip(&direction).map(|(one, other)| one * other).sum();
    [0, 1, 2].map(|axis| along[axis] - part * direction[axis])
}

/// What of the scene has its place already.
pub(super) struct Lookup<'s> {
    pub(super) file: &'s SceneFile,
    pub(super) bodies: &'s Names,
    pub(super) shapes: &'s Names,
    pub(super) joints: &'s Names,
    pub(super) axes: &'s [Axis],
    pub(super) kinds: &'s Kinds,
}

impl Lookup<'_> {
    /// What a component with these keys is bound to; none if a key is wrong. `others` were bound
    /// before.
    pub(super) fn bind(
        &self,
        coupling: Coupling,
        keys: &Keys<'_>,
        others: &[(String, Bound)],
        faults: &mut Faults<'_>,
    ) -> Option<Bound> {
        let mut bound = Some(Bound::default());
        for key in coupling.keys() {
            if key.needed && keys.get(key.key).is_none() {
                faults.add(keys.kind.span(), SceneFaultKind::Missing { whose: keys.whose(), key: key.key });
                bound = None;
                continue;
            }
            let so_far = bound.clone().unwrap_or_default();
            let found = self.find(key, so_far, keys, others, faults);
            bound = bound.and(found);
        }
        bound
    }

    /// A binding with what one key adds to it; none if that is wrong.
    fn find(
        &self,
        BindingKey { key, names, .. }: &BindingKey,
        mut bound: Bound,
        keys: &Keys<'_>,
        others: &[(String, Bound)],
        faults: &mut Faults<'_>,
    ) -> Option<Bound> {
        // bodies are the only things that a key without a value stands for
        if let Named::Bodies { named, absent } = names {
            bound.targets = match keys.texts(key, faults) {
                Some(texts) => self.named_bodies(&texts, *named, faults),
                None => self.bodies_but(bound.body, *absent),
            };
            return Some(bound);
        }
        if keys.get(key).is_none() {
            return Some(bound);
        }
        match names {
            Named::DrivenJoint(kind) => {
                bound.drives = Some(self.driven_joint(key, *kind, keys, others, faults)?);
            }
            Named::DrivenBeside(kind) => {
                let driven = self.driven_joint(key, *kind, keys, others, faults)?;
                let joint = self.beside(driven, &bound, key, keys, faults)?;
                bound.beside.push(joint);
            }
            Named::MeasuredJoint => bound.measures = Some(self.measured_joint(key, keys, faults)?),
            Named::Belt => bound.drives = Some(self.belt(key, keys, others, faults)?),
            Named::Carrier => bound.body = self.carrier(key, keys, faults)?,
            Named::Body => bound.body = Some(self.body(key, keys, faults)?),
            Named::TouchedBody => bound.body = Some(self.touched_body(key, keys, faults)?),
            Named::ShapeOfBody => bound.shape = Some(self.shape_of(bound.body, key, keys, faults)?),
            Named::Direction => {
                let direction = keys.triple(key, faults)?;
                bound.direction = Some(faults.direction(key, &direction)?);
            }
            Named::Along => {
                let along = keys.triple(key, faults)?;
                let across = Placed::new(along.span(), across(*along.get_ref(), bound.direction));
                bound.along = Some(faults.direction(key, &across)?);
            }
            Named::Point => {
                let point = keys.triple(key, faults)?;
                bound.point_m = Some(faults.triple(key, Some(&point))?);
            }
            Named::Bodies { .. } => {}
        }
        Some(bound)
    }

    fn driven_joint(
        &self,
        key: &'static str,
        wanted: JointKind,
        keys: &Keys<'_>,
        others: &[(String, Bound)],
        faults: &mut Faults<'_>,
    ) -> Option<Driven> {
        let name = keys.text(key, "the name of a joint", faults)?;
        let (joint, kind) = self.joint(&name, faults)?;
        if refuse_guided(self.file.joint[joint].get_ref(), &name, faults) {
            return None;
        }
        if kind != wanted {
            let undrivable = SceneFaultKind::Undrivable { joint: text(&name).to_owned(), kind: kind_name(kind) };
            let hint = format!("a {} drives a {} joint", text(&keys.kind), kind_name(wanted));
            faults.add_hinted(name.span(), undrivable, Some(hint));
            return None;
        }
        self.alone(Driven::Joint(joint), &name, others, faults)
    }

    /// A joint that a component drives beside others of its own.
    fn beside(
        &self,
        driven: Driven,
        own: &Bound,
        key: &'static str,
        keys: &Keys<'_>,
        faults: &mut Faults<'_>,
    ) -> Option<usize> {
        let Driven::Joint(joint) = driven else { return None };
        if own.driven().all(|known| known != driven) {
            return Some(joint);
        }
        let name = text(&self.file.joint[joint].get_ref().name).to_owned();
        let span = keys.get(key).map_or_else(|| keys.kind.span(), Placed::span);
        let first = format!("{}, by another of its keys", keys.whose());
        faults.add(span, SceneFaultKind::DrivenTwice { thing: Thing::Joint, name, first });
        None
    }

    fn measured_joint(&self, key: &'static str, keys: &Keys<'_>, faults: &mut Faults<'_>) -> Option<usize> {
        let name = keys.text(key, "the name of a joint", faults)?;
        let (joint, kind) = self.joint(&name, faults)?;
        if unit(kind).is_none() {
            let joint = text(&name).to_owned();
            faults.add(name.span(), SceneFaultKind::Unmeasurable { joint, kind: kind_name(kind) });
            return None;
        }
        Some(joint)
    }

    fn belt(
        &self,
        key: &'static str,
        keys: &Keys<'_>,
        others: &[(String, Bound)],
        faults: &mut Faults<'_>,
    ) -> Option<Driven> {
        let name = keys.text(key, "the name of a body", faults)?;
        let body = self.bodies.find(&name, faults)?;
        if self.file.body[body].get_ref().kind != BodyKind::Kinematic {
            let hint = Some("write `kind = \"kinematic\"` in its table".to_owned());
            faults.add_hinted(name.span(), SceneFaultKind::NotKinematic(text(&name).to_owned()), hint);
            return None;
        }
        self.alone(Driven::Belt(body), &name, others, faults)
    }

    /// What is driven, unless something else drives the same.
    fn alone(
        &self,
        driven: Driven,
        name: &Placed<String>,
        others: &[(String, Bound)],
        faults: &mut Faults<'_>,
    ) -> Option<Driven> {
        let Some(first) = self.driver(driven, others) else { return Some(driven) };
        let thing = match driven {
            Driven::Joint(_) => Thing::Joint,
            Driven::Belt(_) => Thing::Body,
        };
        faults.add(name.span(), SceneFaultKind::DrivenTwice { thing, name: text(name).to_owned(), first });
        None
    }

    /// Who drives a joint or a belt already.
    fn driver(&self, wanted: Driven, components: &[(String, Bound)]) -> Option<String> {
        let by_axis = |moved: Moved| match moved {
            Moved::Joint(joint) => Driven::Joint(joint),
            Moved::Belt { body, .. } => Driven::Belt(body),
        };
        let axis = self.axes.iter().find(|axis| by_axis(axis.moved) == wanted);
        let component = components.iter().find(|(_, known)| known.driven().any(|driven| driven == wanted));
        let leader = match wanted {
            Driven::Joint(joint) => self.file.joint[joint].get_ref().follows.as_ref(),
            Driven::Belt(_) => None,
        };
        leader
            .map(|leader| format!("joint `{}`, which it follows", text(&leader.joint)))
            .or_else(|| axis.map(|axis| format!("axis `{}`", axis.name)))
            .or_else(|| component.map(|(name, _)| format!("component `{name}`")))
    }

    fn joint(&self, name: &Placed<String>, faults: &mut Faults<'_>) -> Option<(usize, JointKind)> {
        let joint = self.joints.find(name, faults)?;
        Some((joint, *self.file.joint[joint].get_ref().kind.get_ref()))
    }

    fn body(&self, key: &'static str, keys: &Keys<'_>, faults: &mut Faults<'_>) -> Option<usize> {
        self.bodies.find(&keys.text(key, "the name of a body", faults)?, faults)
    }

    /// A body or the ground, which is none; the outer none is a fault.
    #[expect(clippy::option_option, reason = "nothing is a fault, the inner nothing is the ground")]
    fn carrier(&self, key: &'static str, keys: &Keys<'_>, faults: &mut Faults<'_>) -> Option<Option<usize>> {
        let name = keys.text(key, "the name of a body", faults)?;
        if text(&name) == GROUND {
            return Some(None);
        }
        self.bodies.find_beside(&name, Some(GROUND), faults).map(Some)
    }

    /// A body that targets touch: one with a shape, unless `shape` names the one that counts.
    fn touched_body(&self, key: &'static str, keys: &Keys<'_>, faults: &mut Faults<'_>) -> Option<usize> {
        let body = self.body(key, keys, faults)?;
        let name = text(&self.file.body[body].get_ref().name);
        let attached = self.file.shape.iter().any(|shape| text(&shape.get_ref().body) == name);
        if self.file.body[body].get_ref().shape.is_none() && !attached && keys.get("shape").is_none() {
            let span = keys.get(key).map_or_else(|| keys.kind.span(), Placed::span);
            faults.add(span, SceneFaultKind::Shapeless(name.to_owned()));
            return None;
        }
        Some(body)
    }

    /// One of the shapes of a body; of a body that is not known itself nothing more is said.
    fn shape_of(
        &self,
        body: Option<usize>,
        key: &'static str,
        keys: &Keys<'_>,
        faults: &mut Faults<'_>,
    ) -> Option<usize> {
        let name = keys.text(key, "the name of a shape", faults)?;
        let shape = self.shapes.find(&name, faults)?;
        let body = text(&self.file.body[body?].get_ref().name);
        if text(&self.file.shape[shape].get_ref().body) != body {
            let (shape, body) = (text(&name).to_owned(), body.to_owned());
            faults.add(name.span(), SceneFaultKind::ForeignShape { shape, body });
        }
        Some(shape)
    }

    /// All bodies but one.
    fn bodies_but(&self, but: Option<usize>, which: Which) -> Vec<usize> {
        (0..self.file.body.len()).filter(|index| Some(*index) != but && self.is(*index, which)).collect()
    }

    fn named_bodies(&self, names: &[Placed<String>], which: Which, faults: &mut Faults<'_>) -> Vec<usize> {
        let mut found = Vec::new();
        for name in names {
            let Some(index) = self.bodies.find(name, faults) else { continue };
            if self.is(index, which) {
                found.push(index);
            } else {
                faults.add(name.span(), SceneFaultKind::NotDynamic(text(name).to_owned()));
            }
        }
        found
    }

    fn is(&self, body: usize, which: Which) -> bool {
        match which {
            Which::Any => true,
            Which::Dynamic => self.file.body[body].get_ref().kind == BodyKind::Dynamic,
        }
    }
}
