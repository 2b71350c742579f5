//! The tree of a robot: parents before children.

use super::xml::{Element, RobotFault};
use super::{Joint, Link};

/// The links with parents in front of their children, and the joints in the order of their children.
///
/// # Errors
/// Links that do not form a tree.
pub(super) fn sorted(links: &[Link], joints: &[Joint], root: &Element) -> Result<(Vec<Link>, Vec<Joint>), RobotFault> {
    let carried = |link: usize| joints.iter().any(|joint| joint.child == link);
    let roots: Vec<usize> = (0..links.len()).filter(|link| !carried(*link)).collect();
    let [first] = roots[..] else {
        let names: Vec<_> = roots.iter().map(|root| links[*root].name.as_str()).collect();
        let names = if names.is_empty() { "no link".to_owned() } else { names.join(", ") };
        return Err(root.wrong(format!("a robot has one link that no joint carries; these have none: {names}")));
    };
    let mut order = vec![first];
    let mut on = Vec::new();
    let mut at = 0;
    while let Some(parent) = order.get(at).copied() {
        for (index, joint) in joints.iter().enumerate().filter(|(_, joint)| joint.parent == parent) {
            if order.contains(&joint.child) {
                let link = &links[joint.child];
                return Err(link.place.wrong(format!("link `{}` is carried twice", link.name)));
            }
            order.push(joint.child);
            on.push(index);
        }
        at += 1;
    }
    let mut places = vec![None; links.len()];
    for (place, link) in order.iter().enumerate() {
        places[*link] = Some(place);
    }
    let place = |link: usize| {
        let lost = || links[link].place.wrong(format!("link `{}` hangs in a loop of joints", links[link].name));
        places[link].ok_or_else(lost)
    };
    for link in 0..links.len() {
        place(link)?;
    }
    let placed = |index: &usize| {
        let joint = joints[*index].clone();
        Ok(Joint { parent: place(joint.parent)?, child: place(joint.child)?, ..joint })
    };
    let joints = on.iter().map(placed).collect::<Result<_, RobotFault>>()?;
    Ok((order.iter().map(|link| links[*link].clone()).collect(), joints))
}
