//! What a component is bound to: the keys of its coupling, found in the scene.

use toml::Spanned;

use super::bodies::GROUND;
use super::components::Keys;
use super::error::{SceneFaultKind, Thing};
use super::faults::Faults;
use super::format::{BodyKind, JointKind, SceneFile};
use super::joints::{kind_name, unit};
use super::model::{Axis, Bound, Moved};
use super::names::Names;
use super::text;
use crate::plant::component::coupling::Coupling;

/// What of the scene has its place already.
pub(super) struct Placed<'s> {
    pub(super) file: &'s SceneFile,
    pub(super) bodies: &'s Names,
    pub(super) shapes: &'s Names,
    pub(super) joints: &'s Names,
    pub(super) axes: &'s [Axis],
}

impl Placed<'_> {
    /// Who drives a joint or a belt already.
    fn driver(&self, bound: &Bound, components: &[(String, Bound)]) -> Option<String> {
        let driven = |bound: &Bound| match bound {
            Bound::Drives(joint) => Some((Thing::Joint, *joint)),
            Bound::Belt { body, .. } => Some((Thing::Body, *body)),
            _ => None,
        };
        let by_axis = |moved: Moved| match moved {
            Moved::Joint(joint) => (Thing::Joint, joint),
            Moved::Belt { body, .. } => (Thing::Body, body),
        };
        let wanted = driven(bound)?;
        let axis = self.axes.iter().find(|axis| by_axis(axis.moved) == wanted);
        let component = components.iter().find(|(_, known)| driven(known) == Some(wanted));
        axis.map(|axis| format!("axis `{}`", axis.name))
            .or_else(|| component.map(|(name, _)| format!("component `{name}`")))
    }

    /// What a component with these keys is bound to; `others` were bound before.
    pub(super) fn bind(
        &self,
        coupling: Coupling,
        keys: &Keys<'_>,
        others: &[(String, Bound)],
        faults: &mut Faults<'_>,
    ) -> Option<Bound> {
        for key in coupling.keys() {
            if key.needed && keys.get(key.key).is_none() {
                faults.add(keys.kind.span(), SceneFaultKind::Missing { whose: keys.whose(), key: key.key });
            }
        }
        match coupling {
            Coupling::None => Some(Bound::Nothing),
            Coupling::Slides | Coupling::Turns if keys.get("joint").is_none() => Some(Bound::Nothing),
            Coupling::Slides | Coupling::Turns => {
                let wanted = if coupling == Coupling::Slides { JointKind::Prismatic } else { JointKind::Revolute };
                let name = keys.text("joint", "the name of a joint", faults)?;
                let (joint, kind) = self.joint(&name, faults)?;
                if kind != wanted {
                    let undrivable =
                        SceneFaultKind::Undrivable { joint: text(&name).to_owned(), kind: kind_name(kind) };
                    let hint = format!("a {} drives a {} joint", text(&keys.kind), kind_name(wanted));
                    faults.add_hinted(name.span(), undrivable, Some(hint));
                    return None;
                }
                self.alone(Bound::Drives(joint), Thing::Joint, &name, others, faults)
            }
            Coupling::Measures => {
                let name = keys.text("joint", "the name of a joint", faults)?;
                let (joint, kind) = self.joint(&name, faults)?;
                if unit(kind).is_none() {
                    let joint = text(&name).to_owned();
                    faults.add(name.span(), SceneFaultKind::Unmeasurable { joint, kind: kind_name(kind) });
                    return None;
                }
                Some(Bound::Measures(joint))
            }
            Coupling::Belt => self.belt(keys, others, faults),
            Coupling::Ray => self.ray(keys, faults),
            Coupling::Touch | Coupling::Contact => self.touch(coupling, keys, faults),
            Coupling::Collect => {
                let body = self.shaped(keys, faults);
                let targets = self.dynamic_targets(keys, body, faults);
                Some(Bound::Collect { body: body?, targets })
            }
            Coupling::Meet => {
                let mut targets = self.dynamic_targets(keys, None, faults);
                targets.sort_unstable();
                targets.dedup();
                Some(Bound::Meet { targets })
            }
            Coupling::Place => {
                let body = self.body(keys, faults);
                let targets = self.targets(&keys.texts("targets", faults)?, faults);
                Some(Bound::Place { body: body?, targets })
            }
        }
    }

    /// The bound, unless something else drives the same.
    fn alone(
        &self,
        bound: Bound,
        thing: Thing,
        name: &Spanned<String>,
        others: &[(String, Bound)],
        faults: &mut Faults<'_>,
    ) -> Option<Bound> {
        match self.driver(&bound, others) {
            None => Some(bound),
            Some(first) => {
                let name_text = text(name).to_owned();
                faults.add(name.span(), SceneFaultKind::DrivenTwice { thing, name: name_text, first });
                None
            }
        }
    }

    fn joint(&self, name: &Spanned<String>, faults: &mut Faults<'_>) -> Option<(usize, JointKind)> {
        let joint = self.joints.find(name, faults)?;
        Some((joint, *self.file.joint[joint].get_ref().kind.get_ref()))
    }

    fn body(&self, keys: &Keys<'_>, faults: &mut Faults<'_>) -> Option<usize> {
        self.bodies.find(&keys.text("body", "the name of a body", faults)?, faults)
    }

    /// A body that others touch, or one of its shapes.
    fn touch(&self, coupling: Coupling, keys: &Keys<'_>, faults: &mut Faults<'_>) -> Option<Bound> {
        let named = keys.text("shape", "the name of a shape", faults);
        let body = if named.is_some() { self.body(keys, faults) } else { self.shaped(keys, faults) };
        let shape = named.as_ref().map(|name| (name, self.shapes.find(name, faults)));
        if let (Some(body), Some((name, Some(shape)))) = (body, &shape)
            && text(&self.file.shape[*shape].get_ref().body) != text(&self.file.body[body].get_ref().name)
        {
            let body = text(&self.file.body[body].get_ref().name).to_owned();
            faults.add(name.span(), SceneFaultKind::ForeignShape { shape: text(name).to_owned(), body });
        }
        let targets = match (coupling, keys.texts("targets", faults)) {
            (Coupling::Contact, Some(names)) => {
                names.iter().filter_map(|name| self.bodies.find(name, faults)).collect()
            }
            (_, Some(names)) => self.targets(&names, faults),
            (_, None) => self.dynamic().filter(|index| Some(*index) != body).collect(),
        };
        let shape = match shape {
            Some((_, found)) => Some(found?),
            None => None,
        };
        Some(Bound::Touch { body: body?, shape, targets })
    }

    /// The dynamic bodies that count, all but one if nothing is said.
    fn dynamic_targets(&self, keys: &Keys<'_>, but: Option<usize>, faults: &mut Faults<'_>) -> Vec<usize> {
        match keys.texts("targets", faults) {
            Some(names) => self.targets(&names, faults),
            None => self.dynamic().filter(|index| Some(*index) != but).collect(),
        }
    }

    /// The body that targets touch: one with a shape.
    fn shaped(&self, keys: &Keys<'_>, faults: &mut Faults<'_>) -> Option<usize> {
        let body = self.body(keys, faults)?;
        let name = text(&self.file.body[body].get_ref().name);
        let attached = self.file.shape.iter().any(|shape| text(&shape.get_ref().body) == name);
        if self.file.body[body].get_ref().shape.is_none() && !attached {
            let span = keys.get("body").map_or_else(|| keys.kind.span(), Spanned::span);
            let name = text(&self.file.body[body].get_ref().name).to_owned();
            faults.add(span, SceneFaultKind::Shapeless(name));
            return None;
        }
        Some(body)
    }

    /// Indices of the dynamic bodies.
    fn dynamic(&self) -> impl Iterator<Item = usize> {
        let bodies = self.file.body.iter().enumerate();
        bodies.filter(|(_, body)| body.get_ref().kind == BodyKind::Dynamic).map(|(index, _)| index)
    }

    /// Bodies that are touched, held or placed, which must be dynamic.
    fn targets(&self, names: &[Spanned<String>], faults: &mut Faults<'_>) -> Vec<usize> {
        let mut found = Vec::new();
        for name in names {
            let Some(index) = self.bodies.find(name, faults) else { continue };
            if self.file.body[index].get_ref().kind == BodyKind::Dynamic {
                found.push(index);
            } else {
                faults.add(name.span(), SceneFaultKind::NotDynamic(text(name).to_owned()));
            }
        }
        found
    }

    fn belt(&self, keys: &Keys<'_>, others: &[(String, Bound)], faults: &mut Faults<'_>) -> Option<Bound> {
        let direction = keys.triple("direction", faults);
        let name = keys.text("belt", "the name of a body", faults)?;
        let body = self.bodies.find(&name, faults)?;
        if self.file.body[body].get_ref().kind != BodyKind::Kinematic {
            let hint = Some("write `kind = \"kinematic\"` in its table".to_owned());
            faults.add_hinted(name.span(), SceneFaultKind::NotKinematic(text(&name).to_owned()), hint);
            return None;
        }
        let direction = faults.direction("direction", &direction?)?;
        self.alone(Bound::Belt { body, direction }, Thing::Body, &name, others, faults)
    }

    fn ray(&self, keys: &Keys<'_>, faults: &mut Faults<'_>) -> Option<Bound> {
        let carrier = keys.text("body", "the name of a body", faults);
        let body = match &carrier {
            Some(name) if text(name) != GROUND => Some(self.bodies.find_beside(name, Some(GROUND), faults)?),
            Some(_) | None => None,
        };
        let (point, direction) = (keys.triple("point_m", faults), keys.triple("direction", faults));
        let targets = match keys.texts("targets", faults) {
            Some(names) => names.iter().filter_map(|name| self.bodies.find(name, faults)).collect(),
            None => (0..self.file.body.len()).filter(|index| Some(*index) != body).collect(),
        };
        let point_m = faults.triple("point_m", point.as_ref());
        let direction = direction.and_then(|direction| faults.direction("direction", &direction));
        Some(Bound::Ray { body, point_m: point_m?, direction: direction?, targets })
    }
}
