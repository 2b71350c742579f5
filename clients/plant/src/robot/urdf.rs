//! The robot of a URDF file.
//!
//! Read are `<link>` with `<inertial>` and `<collision>` (and `<visual>`, which counts where a mass is
//! to be found), and `<joint>` with origin, axis, limits of position and `<mimic>`. A mass that no body has,
//! or one that is not there, makes a link a mere frame. Planar joints are faults, as a machine would move
//! otherwise than its file says.
//!
//! Source: ROS, URDF XML specification (wiki.ros.org/urdf/XML).

use onescan_base::nearest;

use super::inertial::{self, is_tensor};
use super::tree::sorted;
use super::xml::{Element, RobotFault};
use super::{Collision, Freedom, Geometry, Inertial, Joint, Link, Mimic, Origin, Robot};

/// The robot of a file's outermost element.
///
/// # Errors
/// Every fault that was found.
pub(super) fn robot(root: &Element) -> Result<Robot, Vec<RobotFault>> {
    if root.name != "robot" {
        return Err(vec![root.wrong(format!("<{}> in place of <robot>", root.name))]);
    }
    let mut faults = Vec::new();
    let mut remarks = Vec::new();
    let mut links: Vec<Link> = Vec::new();
    for element in root.all("link") {
        let Some(link) = link(element, &mut remarks, &mut faults) else { continue };
        if links.iter().any(|known| known.name == link.name) {
            faults.push(element.wrong(format!("link `{}` is there twice", link.name)));
        } else {
            links.push(link);
        }
    }
    let named: Vec<String> = root.all("link").filter_map(|link| link.get("name")).map(str::to_owned).collect();
    let mut joints: Vec<Joint> = Vec::new();
    for element in root.all("joint") {
        match joint(element, &links, &named, &mut remarks) {
            Ok(Some(joint)) if joints.iter().any(|known| known.name == joint.name) => {
                faults.push(element.wrong(format!("joint `{}` is there twice", joint.name)));
            }
            Ok(joint) => joints.extend(joint),
            Err(fault) => faults.push(fault),
        }
    }
    refuse_lost_leaders(root, &joints, &mut faults);
    if !faults.is_empty() {
        return Err(faults);
    }
    let (links, joints) = sorted(&links, &joints, root).map_err(|fault| vec![fault])?;
    Ok(Robot { links, joints, remarks })
}

fn origin(element: &Element) -> Result<Origin, RobotFault> {
    let Some(origin) = element.child("origin") else { return Ok(Origin::default()) };
    Ok(Origin { xyz_m: origin.triple("xyz", [0.0; 3])?, rpy_rad: origin.triple("rpy", [0.0; 3])? })
}

/// A link, with all that is wrong in it.
fn link(element: &Element, remarks: &mut Vec<String>, faults: &mut Vec<RobotFault>) -> Option<Link> {
    let mut kept = |result: Result<(), RobotFault>| faults.extend(result.err());
    let name = element.text("name").map(str::to_owned);
    let mut link = Link {
        name: name.clone().unwrap_or_default(),
        inertial: None,
        collisions: Vec::new(),
        visuals: Vec::new(),
        place: element.place.clone(),
    };
    if let Some(written) = element.child("inertial") {
        match inertial(written) {
            Ok(read) => {
                link.inertial = inertial::of_a_body(read);
                if link.inertial.is_none() {
                    remarks.push(inertial::remark(&link.name, read.mass_kg));
                } else if read.inertia_kg_m2.is_none() {
                    remarks.push(format!(
                        "link `{}` has moments of inertia that no body has: those of a ball of its mass are taken",
                        link.name
                    ));
                }
            }
            Err(fault) => kept(Err(fault)),
        }
    }
    for written in element.all("collision") {
        kept(collision(written).map(|collision| link.collisions.push(collision)));
    }
    // a picture that is wrong is not a fault of a machine
    link.visuals = element.all("visual").filter_map(|written| collision(written).ok()).collect();
    kept(name.map(|_| ()));
    Some(link).filter(|link| !link.name.is_empty())
}

/// Mass and inertia, as they are written.
fn inertial(element: &Element) -> Result<Inertial, RobotFault> {
    let mass = element.needed("mass")?;
    let mass_kg = mass.number("value")?;
    let mut inertia_kg_m2 = [0.0; 6];
    if let Some(tensor) = element.child("inertia") {
        for (value, key) in inertia_kg_m2.iter_mut().zip(["ixx", "iyy", "izz", "ixy", "ixz", "iyz"]) {
            *value = tensor.number_or(key, 0.0)?;
        }
    }
    if mass_kg < 0.0 {
        return Err(mass.wrong_at("value", format!("a mass of {mass_kg} kg")));
    }
    let origin = origin(element)?;
    Ok(Inertial { origin, mass_kg, inertia_kg_m2: is_tensor(inertia_kg_m2).then_some(inertia_kg_m2) })
}

fn collision(element: &Element) -> Result<Collision, RobotFault> {
    let geometry = element.needed("geometry")?;
    let form = geometry.children.first().ok_or_else(|| geometry.wrong("<geometry> is empty"))?;
    let place = form.place.clone();
    let geometry = match form.name.as_str() {
        "box" => {
            form.text("size")?;
            Geometry::Box(form.triple("size", [0.0; 3])?)
        }
        "sphere" => Geometry::Sphere(form.number("radius")?),
        "cylinder" => Geometry::Cylinder(form.number("radius")?, form.number("length")?),
        "capsule" => Geometry::Capsule(form.number("radius")?, form.number("length")?),
        "mesh" => Geometry::Mesh(form.text("filename")?.to_owned(), form.triple("scale", [1.0; 3])?),
        other => {
            let near = nearest(other, ["box", "sphere", "cylinder", "capsule", "mesh"]).unwrap_or("box");
            let wrong = form.wrong(format!("no geometry is called <{other}>"));
            return Err(wrong.hinted(format!("did you mean <{near}>?")));
        }
    };
    Ok(Collision { origin: origin(element)?, geometry, collides: true, weight: None, place })
}

/// A joint; none if the link of one of its ends is at fault itself.
fn joint(
    element: &Element,
    links: &[Link],
    named: &[String],
    remarks: &mut Vec<String>,
) -> Result<Option<Joint>, RobotFault> {
    let name = element.text("name")?.to_owned();
    let end = |which: &str| {
        let end = element.needed(which)?;
        let wanted = end.text("link")?;
        let found = links.iter().position(|link| link.name == wanted);
        if found.is_none() && !named.iter().any(|known| known == wanted) {
            let wrong = end.wrong_at("link", format!("there is no link `{wanted}`"));
            let near = nearest(wanted, links.iter().map(|link| link.name.as_str()));
            return Err(match near {
                Some(near) => wrong.hinted(format!("did you mean `{near}`?")),
                None => wrong,
            });
        }
        Ok(found)
    };
    let kind = element.text("type")?;
    let freedom = match kind {
        "fixed" => Freedom::Fixed,
        "revolute" | "continuous" => Freedom::Turns,
        "prismatic" => Freedom::Slides,
        "spherical" | "ball" => Freedom::Rolls,
        "floating" => Freedom::Floats,
        other => {
            let known = ["fixed", "revolute", "continuous", "prismatic", "floating", "spherical"];
            let near = nearest(other, known).unwrap_or("fixed");
            let wrong = element.wrong_at("type", format!("a joint of type `{other}` is not known"));
            return Err(wrong.hinted(format!("did you mean `{near}`?")));
        }
    };
    let axis = element.child("axis").map(|axis| axis.triple("xyz", [1.0, 0.0, 0.0])).transpose()?;
    let axis = axis.unwrap_or([1.0, 0.0, 0.0]);
    let moves = matches!(freedom, Freedom::Turns | Freedom::Slides);
    if moves && axis.iter().all(|part| *part == 0.0) {
        return Err(element.wrong(format!("joint `{name}` has an axis of no length")));
    }
    let (parent, child, origin) = (end("parent")?, end("child")?, origin(element)?);
    let mimic = mimic(element)?.filter(|_| moves);
    let limits = limits(element, kind, &name, remarks)?;
    let place = element.place.clone();
    let Some((parent, child)) = parent.zip(child) else { return Ok(None) };
    Ok(Some(Joint {
        name,
        freedom,
        parent,
        child,
        origin,
        reference: 0.0,
        anchor_m: [0.0; 3],
        axis,
        limits,
        mimic,
        place,
    }))
}

fn limits(
    element: &Element,
    kind: &str,
    name: &str,
    remarks: &mut Vec<String>,
) -> Result<Option<[f64; 2]>, RobotFault> {
    if !matches!(kind, "revolute" | "prismatic") {
        return Ok(None);
    }
    let limit = element.child("limit");
    let limit = limit.ok_or_else(|| element.wrong(format!("{kind} joint `{name}` needs a <limit>")))?;
    let [lower, upper] = [limit.number_or("lower", 0.0)?, limit.number_or("upper", 0.0)?];
    if lower > upper {
        remarks.push(format!("joint `{name}` has its lower limit above its upper one: they change places"));
    }
    Ok(Some([lower.min(upper), lower.max(upper)]))
}

fn mimic(element: &Element) -> Result<Option<Mimic>, RobotFault> {
    let Some(mimic) = element.child("mimic") else { return Ok(None) };
    let (factor, offset) = (mimic.number_or("multiplier", 1.0)?, mimic.number_or("offset", 0.0)?);
    Ok(Some(Mimic { joint: mimic.text("joint")?.to_owned(), factor, offset }))
}

/// Joints that follow one that is not there, or that does not move.
fn refuse_lost_leaders(root: &Element, joints: &[Joint], faults: &mut Vec<RobotFault>) {
    for (joint, mimic) in joints.iter().filter_map(|joint| Some((joint, joint.mimic.as_ref()?))) {
        let leader = joints.iter().find(|known| known.name == mimic.joint);
        let reported = match leader {
            _ if mimic.joint == joint.name => "follows itself".to_owned(),
            Some(leader) if matches!(leader.freedom, Freedom::Turns | Freedom::Slides) => continue,
            Some(_) => format!("follows `{}`, which has no coordinate", mimic.joint),
            // a joint that is at fault has been reported
            None if root.all("joint").any(|element| element.get("name") == Some(&mimic.joint)) => continue,
            None => format!("follows `{}`, which is not a joint of this robot", mimic.joint),
        };
        faults.push(joint.place.wrong(format!("joint `{}` {reported}", joint.name)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{Packages, Reading};
    use std::path::Path;

    const ARM: &str = r#"<?xml version="1.0"?>
<robot name="arm">
  <material name="grey"/>
  <link name="hand"/>
  <link name="base"><collision><geometry><box size="0.2 0.2 0.1"/></geometry></collision></link>
  <link name="upper">
    <inertial><origin xyz="0 0 0.5"/><mass value="2"/><inertia ixx="0.2" iyy="0.2" izz="0.01"/></inertial>
    <collision><origin xyz="0 0 0.5" rpy="0 0 1"/><geometry><cylinder radius="0.05" length="1"/></geometry></collision>
  </link>
  <joint name="wrist" type="fixed"><parent link="upper"/><child link="hand"/><origin xyz="0 0 1"/></joint>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-1.5" upper="1.5" effort="100" velocity="2"/>
  </joint>
</robot>
"#;

    fn parsed(text: &str) -> Result<Robot, Vec<RobotFault>> {
        let packages = Packages::default();
        let reading = Reading { file: "arm.urdf", packages: &packages, arguments: &[] };
        Robot::read(Path::new("arm.urdf"), text.to_owned(), &reading)
    }

    fn reported(text: &str) -> Vec<String> {
        parsed(text).unwrap_err().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn parents_come_before_children() {
        let robot = parsed(ARM).unwrap();
        let names: Vec<_> = robot.links.iter().map(|link| link.name.as_str()).collect();
        assert_eq!(names, ["base", "upper", "hand"]);
        let shoulder = &robot.joints[0];
        assert_eq!((shoulder.parent, shoulder.child, shoulder.limits), (0, 1, Some([-1.5, 1.5])));
        assert_eq!(robot.joints[1].freedom, Freedom::Fixed);
        assert_eq!(robot.links[1].collisions[0].geometry, Geometry::Cylinder(0.05, 1.0));
        assert_eq!(robot.links[1].inertial.unwrap().inertia_kg_m2, Some([0.2, 0.2, 0.01, 0.0, 0.0, 0.0]));
    }

    #[test]
    fn frames_are_often_written_with_a_mass_of_0() {
        let robot = parsed(&ARM.replace("<mass value=\"2\"/>", "<mass value=\"0\"/>")).unwrap();
        assert_eq!(robot.links[1].inertial, None);
        assert_eq!(robot.remarks, ["link `upper` has a mass of 0: it is a frame"]);
        let robot = parsed(&ARM.replace("<mass value=\"2\"/>", "<mass value=\"1e-9\"/>")).unwrap();
        assert_eq!(robot.links[1].inertial, None);
        assert_eq!(robot.remarks, ["link `upper` has a mass of 1e-9 kg: it is a frame"]);
        let robot = parsed(&ARM.replace("<mass value=\"2\"/>", "<mass value=\"1e-6\"/>")).unwrap();
        assert_eq!((robot.links[1].inertial.unwrap().mass_kg, robot.remarks.len()), (1e-6, 0));
        let robot = parsed(&ARM.replace("ixx=\"0.2\"", "ixx=\"0\"")).unwrap();
        assert_eq!(robot.links[1].inertial.unwrap().inertia_kg_m2, None);
    }

    #[test]
    fn limits_that_are_written_the_wrong_way_round_change_places() {
        let robot = parsed(&ARM.replace("lower=\"-1.5\" upper=\"1.5\"", "lower=\"1\" upper=\"-0.5\"")).unwrap();
        assert_eq!(robot.joints[0].limits, Some([-0.5, 1.0]));
        assert_eq!(robot.remarks, ["joint `shoulder` has its lower limit above its upper one: they change places"]);
    }

    #[test]
    fn what_stands_before_the_declaration_is_of_no_meaning() {
        let robot = parsed(&format!("\n<!-- whose it is -->\n{ARM}")).unwrap();
        assert_eq!(robot.links.len(), 3);
    }

    #[test]
    fn a_joint_may_follow_another() {
        let robot = parsed(&ARM.replace("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 1 0\"/><mimic joint=\"wrist\"/>"));
        let said = robot.unwrap_err()[0].to_string();
        assert_eq!(said, "line 11: joint `shoulder` follows `wrist`, which has no coordinate");
    }

    #[test]
    fn what_is_wrong_has_its_line() {
        let cases = [
            (
                "<child link=\"upper\"/>",
                "<child link=\"uper\"/>",
                "line 12: there is no link `uper` (did you mean `upper`?)",
            ),
            ("<cylinder ", "<cilinder ", "line 8: no geometry is called <cilinder> (did you mean <cylinder>?)"),
            ("type=\"revolute\"", "type=\"planar\"", "line 11: a joint of type `planar` is not known"),
            ("mass value=\"2\"", "mass value=\"two\"", "line 7: `value` must be a number, not \"two\""),
            ("mass value=\"2\"", "mass value=\"-2\"", "line 7: a mass of -2 kg"),
            ("size=\"0.2 0.2 0.1\"", "size=\"0.2 0.2\"", "line 5: `size` must be three numbers, not \"0.2 0.2\""),
            ("<link name=\"hand\"/>", "<link name=\"base\"/>", "line 5: link `base` is there twice"),
            (
                "<link name=\"hand\"/>",
                "<link name=\"hand\"/><link name=\"lost\"/>",
                "line 2: a robot has one link that no joint carries; these have none: lost, base",
            ),
            ("<parent link=\"base\"/>", "<parent link=\"upper\"/>", "line 4: link `hand` hangs in a loop of joints"),
            ("</robot>\n", "", "line 15: the file ends within an element"),
            ("<limit ", "<limits ", "line 11: revolute joint `shoulder` needs a <limit>"),
            ("<axis xyz=\"0 1 0\"/>", "<mimic joint=\"elbow\"/>", "line 11: joint `shoulder` follows `elbow`"),
        ];
        for (right, wrong, said) in cases {
            assert!(ARM.contains(right), "{right}");
            let reported = reported(&ARM.replacen(right, wrong, 1));
            assert!(reported[0].starts_with(said), "{said}\n{reported:?}");
        }
    }

    #[test]
    fn all_faults_are_reported_at_once() {
        let wrong = ARM.replace("<cylinder ", "<cilinder ").replace("value=\"2\"", "value=\"two\"");
        assert_eq!(reported(&wrong.replace("type=\"revolute\"", "type=\"planar\"")).len(), 3);
    }
}
