//! The joints of a body, and those that follow others.
//!
//! Joints of one body act in the file's order, each in the frame that those before it have turned and moved. So each
//! but the last carries a frame without mass that has the body's place, and the last one the body.

use super::pose::origin;
use super::{Placed, Reader};
use crate::robot::xml::{Element, RobotFault};
use crate::robot::{Freedom, Joint, Link, Mimic, Origin};

impl Reader<'_> {
    /// The joints of a body, which is fixed to its parent without one.
    pub(super) fn joints(
        &mut self,
        placed: Placed<'_>,
        [parent, child]: [usize; 2],
        class: &str,
    ) -> Result<(), RobotFault> {
        let body = placed.element;
        let base = Joint {
            name: self.links[child].name.clone(),
            freedom: Freedom::Fixed,
            parent,
            child,
            origin: origin(&(placed.at * self.pose(body)?)),
            reference: 0.0,
            anchor_m: [0.0; 3],
            axis: [0.0, 0.0, 1.0],
            limits: None,
            mimic: None,
            place: body.place.clone(),
        };
        let written = body.children.iter().filter(|inner| matches!(inner.name.as_str(), "joint" | "freejoint"));
        let mut joints = Vec::new();
        for joint in written {
            joints.push(match joint.name.as_str() {
                "freejoint" => Joint { freedom: Freedom::Floats, place: joint.place.clone(), ..base.clone() },
                _ => self.one_joint(&self.complete(joint, class), base.clone())?,
            });
        }
        let Some(last) = joints.pop() else { return self.add(base) };
        if let Some(free) = joints.iter().chain([&last]).find(|joint| joint.freedom == Freedom::Floats)
            && !joints.is_empty()
        {
            let reported = format!("body `{}` has a free joint, which leaves nothing to its others", base.name);
            return Err(free.place.wrong(reported).hinted("remove the others, or give them a body within this one"));
        }
        let (mut parent, mut at) = (parent, base.origin);
        for joint in joints {
            let child = self.links.len();
            self.frame(format!("{}.{}", base.name, joint.name), &joint)?;
            self.add(Joint { parent, child, origin: at, ..joint })?;
            (parent, at) = (child, Origin::default());
        }
        self.add(Joint { parent, origin: at, ..last })
    }

    /// A link without mass that a joint carries.
    fn frame(&mut self, name: String, joint: &Joint) -> Result<(), RobotFault> {
        if self.links.iter().any(|known| known.name == name) {
            return Err(joint
                .place
                .wrong(format!("body `{name}` is there already: give joint `{}` a name", joint.name)));
        }
        let place = joint.place.clone();
        self.links.push(Link { name, inertial: None, collisions: Vec::new(), visuals: Vec::new(), place });
        Ok(())
    }

    fn add(&mut self, joint: Joint) -> Result<(), RobotFault> {
        if self.joints.iter().any(|known| known.name == joint.name) {
            return Err(joint.place.wrong(format!("joint `{}` is there twice", joint.name)));
        }
        self.joints.push(joint);
        Ok(())
    }

    fn one_joint(&self, joint: &Element, base: Joint) -> Result<Joint, RobotFault> {
        let freedom = match joint.get("type").unwrap_or("hinge") {
            "hinge" => Freedom::Turns,
            "slide" => Freedom::Slides,
            "ball" => Freedom::Rolls,
            "free" => Freedom::Floats,
            other => return Err(joint.wrong_at("type", format!("a joint of type `{other}` is not known"))),
        };
        let axis = joint.triple("axis", [0.0, 0.0, 1.0])?;
        if axis.iter().all(|part| *part == 0.0) {
            return Err(joint.wrong_at("axis", "an axis of no length"));
        }
        let turns = freedom == Freedom::Turns && self.compiler.degrees;
        let limited = joint.get("limited").is_none_or(|limited| limited != "false");
        let range = joint.numbers::<2>("range")?.filter(|[lower, upper]| limited && lower < upper);
        let limits = range.map(|range| if turns { range.map(f64::to_radians) } else { range });
        let limits = limits.filter(|_| matches!(freedom, Freedom::Turns | Freedom::Slides));
        let stands = joint.number_or("ref", 0.0)?;
        let reference = if turns { stands.to_radians() } else { stands };
        let name = joint.get("name").map_or(base.name, str::to_owned);
        let (anchor_m, place) = (joint.triple("pos", [0.0; 3])?, joint.place.clone());
        Ok(Joint { name, freedom, reference, anchor_m, axis, limits, place, ..base })
    }

    /// The joints of `<equality>` that follow others in a straight line.
    pub(super) fn follow(&mut self, root: &Element) {
        let mut others = 0;
        for element in root.all("equality").flat_map(|equality| &equality.children) {
            let Some((follower, leader)) = element.get("joint1").zip(element.get("joint2")) else {
                others += 1;
                continue;
            };
            let read = |key: &str| element.get(key).unwrap_or("0 1 0 0 0");
            let numbers: Vec<f64> = read("polycoef").split_whitespace().filter_map(|word| word.parse().ok()).collect();
            let [offset, factor, curved @ ..] = &numbers[..] else {
                self.faults.push(element.wrong_at("polycoef", "`polycoef` must be numbers"));
                continue;
            };
            // both count from where the file has them
            let reference =
                |name: &str| self.joints.iter().find(|joint| joint.name == name).map_or(0.0, |joint| joint.reference);
            let offset = offset + reference(follower) - factor * reference(leader);
            let mimic = Mimic { joint: leader.to_owned(), factor: *factor, offset };
            if curved.iter().any(|coefficient| *coefficient != 0.0) {
                self.faults.push(element.wrong_at("polycoef", "a joint that follows another otherwise than straight"));
            } else if let Some(joint) = self.joints.iter_mut().find(|joint| joint.name == follower) {
                joint.mimic = Some(mimic);
            } else {
                self.faults.push(element.wrong_at("joint1", format!("there is no joint `{follower}`")));
            }
            if !self.joints.iter().any(|joint| joint.name == leader) {
                self.faults.push(element.wrong_at("joint2", format!("there is no joint `{leader}`")));
            }
        }
        if others > 0 {
            self.remarks.push(format!("{others} equalities of the model are not taken over"));
        }
    }
}
