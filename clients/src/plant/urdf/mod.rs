//! Robots described in URDF: links with masses and collision shapes, joints between them.
//!
//! Read are `<link>` with `<inertial>` and `<collision>`, and `<joint>` with origin, axis and limits of
//! position. What a picture shows (`<visual>`, `<material>`), what a controller limits (effort, velocity)
//! and what simulators add (`<gazebo>`, `<transmission>`) is left aside: a scene says these things itself. `<mimic>`
//! and planar joints are faults, as a machine would move otherwise than its file says.
//!
//! Source: ROS, URDF XML specification (wiki.ros.org/urdf/XML).

mod xml;

use onescan_base::nearest;
use thiserror::Error;

use xml::Element;

/// What is wrong with a URDF file, and where.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("line {line}: {cause}")]
pub struct UrdfError {
    /// The line, from 1.
    pub line: usize,
    /// What is wrong.
    pub cause: String,
}

/// A robot: a tree of links, its root first.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    /// The links; each but the first is the child of a joint whose parent comes before it.
    pub links: Vec<Link>,
    /// The joints, in the order of their children.
    pub joints: Vec<Joint>,
}

/// A place and an orientation: roll about x, then pitch about y, then yaw about z.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Origin {
    /// Where.
    pub xyz_m: [f64; 3],
    /// How turned.
    pub rpy_rad: [f64; 3],
}

/// A rigid part.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Its name.
    pub name: String,
    /// Its mass, none for a mere frame.
    pub inertial: Option<Inertial>,
    /// Its shapes.
    pub collisions: Vec<Collision>,
    line: usize,
}

/// Mass and inertia of a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertial {
    /// The centre of mass, and the axes of the tensor.
    pub origin: Origin,
    /// The mass.
    pub mass_kg: f64,
    /// ixx, iyy, izz, ixy, ixz, iyz.
    pub inertia_kg_m2: [f64; 6],
}

/// A shape of a link.
#[derive(Clone, Debug, PartialEq)]
pub struct Collision {
    /// Where it is on its link.
    pub origin: Origin,
    /// Its form.
    pub geometry: Geometry,
}

/// A form, centred on its origin.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// Whole edges.
    Box([f64; 3]),
    /// A radius.
    Sphere(f64),
    /// Radius and whole length, along z.
    Cylinder(f64, f64),
    /// A file, and what 1 means in it.
    Mesh(String, f64),
}

/// What a joint leaves free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Freedom {
    /// Nothing.
    Fixed,
    /// Rotation about its axis.
    Turns,
    /// Translation along its axis.
    Slides,
    /// Everything: it is no joint.
    Floats,
}

/// A joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// What it leaves free.
    pub freedom: Freedom,
    /// Index of the link that it is measured from.
    pub parent: usize,
    /// Index of the link that it carries.
    pub child: usize,
    /// The child's frame on the parent, when the coordinate is 0.
    pub origin: Origin,
    /// Its axis in the child's frame.
    pub axis: [f64; 3],
    /// Limits of its coordinate, m or rad.
    pub limits: Option<[f64; 2]>,
}

impl Robot {
    /// The robot of a file's text.
    ///
    /// # Errors
    /// See [`UrdfError`].
    pub fn parse(text: &str) -> Result<Self, UrdfError> {
        let document = xml::document(text)?;
        let root = Element::root(&document);
        if root.name() != "robot" {
            return Err(root.wrong(format!("<{}> in place of <robot>", root.name())));
        }
        let links = root.all("link").map(link).collect::<Result<Vec<_>, _>>()?;
        if let Some(twin) = (1..links.len()).find(|at| links[..*at].iter().any(|link| link.name == links[*at].name)) {
            let Link { name, line, .. } = &links[twin];
            return Err(UrdfError { line: *line, cause: format!("link `{name}` is there twice") });
        }
        let joints = root.all("joint").map(|element| joint(element, &links)).collect::<Result<Vec<_>, _>>()?;
        sorted(&links, &joints, root)
    }
}

fn origin(element: Element<'_>) -> Result<Origin, UrdfError> {
    let Some(origin) = element.child("origin") else { return Ok(Origin::default()) };
    Ok(Origin { xyz_m: origin.triple("xyz", [0.0; 3])?, rpy_rad: origin.triple("rpy", [0.0; 3])? })
}

fn link(element: Element<'_>) -> Result<Link, UrdfError> {
    let inertial = element.child("inertial").map(inertial).transpose()?;
    let collisions = element.all("collision").map(collision).collect::<Result<_, _>>()?;
    Ok(Link { name: element.text("name")?.to_owned(), inertial, collisions, line: element.line() })
}

fn inertial(element: Element<'_>) -> Result<Inertial, UrdfError> {
    let mass = element.needed("mass")?;
    let mass_kg = mass.number("value")?;
    let tensor = element.needed("inertia")?;
    let mut inertia_kg_m2 = [0.0; 6];
    for (value, key) in inertia_kg_m2.iter_mut().zip(["ixx", "iyy", "izz", "ixy", "ixz", "iyz"]) {
        *value = if tensor.attribute(key).is_some() || key.len() == 3 && key[1..2] == key[2..3] {
            tensor.number(key)?
        } else {
            0.0
        };
    }
    if mass_kg <= 0.0 {
        return Err(mass.wrong(format!("a mass of {mass_kg} kg: leave <inertial> out for a mere frame")));
    }
    if inertia_kg_m2[..3].iter().any(|moment| *moment <= 0.0) {
        return Err(tensor.wrong("a moment of inertia is above 0".to_owned()));
    }
    Ok(Inertial { origin: origin(element)?, mass_kg, inertia_kg_m2 })
}

fn collision(element: Element<'_>) -> Result<Collision, UrdfError> {
    let geometry = element.needed("geometry")?;
    let form = geometry.first().ok_or_else(|| geometry.wrong("<geometry> is empty".to_owned()))?;
    let geometry = match form.name() {
        "box" => {
            form.text("size")?;
            Geometry::Box(form.triple("size", [0.0; 3])?)
        }
        "sphere" => Geometry::Sphere(form.number("radius")?),
        "cylinder" => Geometry::Cylinder(form.number("radius")?, form.number("length")?),
        "mesh" => {
            let [x, y, z] = form.triple("scale", [1.0; 3])?;
            if x != y || y != z {
                return Err(form.wrong("a mesh that is scaled otherwise along each axis".to_owned()));
            }
            Geometry::Mesh(form.text("filename")?.to_owned(), x)
        }
        other => {
            let near = nearest(other, ["box", "sphere", "cylinder", "mesh"]).unwrap_or("box");
            return Err(form.wrong(format!("no geometry is called <{other}> (did you mean <{near}>?)")));
        }
    };
    Ok(Collision { origin: origin(element)?, geometry })
}

fn joint(element: Element<'_>, links: &[Link]) -> Result<Joint, UrdfError> {
    let name = element.text("name")?.to_owned();
    let end = |which: &str| {
        let end = element.needed(which)?;
        let wanted = end.text("link")?;
        links.iter().position(|link| link.name == wanted).ok_or_else(|| {
            let near = nearest(wanted, links.iter().map(|link| link.name.as_str()));
            let hint = near.map(|near| format!(" (did you mean `{near}`?)")).unwrap_or_default();
            end.wrong(format!("there is no link `{wanted}`{hint}"))
        })
    };
    let kind = element.text("type")?;
    let freedom = match kind {
        "fixed" => Freedom::Fixed,
        "revolute" | "continuous" => Freedom::Turns,
        "prismatic" => Freedom::Slides,
        "floating" => Freedom::Floats,
        other => {
            let known = ["fixed", "revolute", "continuous", "prismatic", "floating"];
            let near = nearest(other, known).unwrap_or("fixed");
            return Err(element.wrong(format!("a joint of type `{other}` is not known (did you mean `{near}`?)")));
        }
    };
    if let Some(mimic) = element.child("mimic") {
        return Err(mimic.wrong(format!("joint `{name}` mimics another, which a scene has no means for")));
    }
    let axis = element.child("axis").map(|axis| axis.triple("xyz", [1.0, 0.0, 0.0])).transpose()?;
    let limits = match (kind, element.child("limit")) {
        ("revolute" | "prismatic", Some(limit)) => {
            let bound = |key| if limit.attribute(key).is_some() { limit.number(key) } else { Ok(0.0) };
            Some([bound("lower")?, bound("upper")?])
        }
        ("revolute" | "prismatic", None) => return Err(element.wrong(format!("{kind} joint `{name}` needs a <limit>"))),
        _ => None,
    };
    let axis = axis.unwrap_or([1.0, 0.0, 0.0]);
    let (parent, child) = (end("parent")?, end("child")?);
    Ok(Joint { name, freedom, parent, child, origin: origin(element)?, axis, limits })
}

/// The tree with parents in front of their children.
fn sorted(links: &[Link], joints: &[Joint], root: Element<'_>) -> Result<Robot, UrdfError> {
    let above = |link: usize| joints.iter().filter(move |joint| joint.child == link).count();
    let roots: Vec<usize> = (0..links.len()).filter(|link| above(*link) == 0).collect();
    let [first] = roots[..] else {
        return Err(root.wrong(format!("a robot has one link that no joint carries, not {}", roots.len())));
    };
    let mut order = vec![first];
    let mut carried = Vec::new();
    let mut at = 0;
    while let Some(parent) = order.get(at).copied() {
        for (index, joint) in joints.iter().enumerate().filter(|(_, joint)| joint.parent == parent) {
            if order.contains(&joint.child) {
                let line = links[joint.child].line;
                return Err(UrdfError { line, cause: format!("link `{}` is carried twice", links[joint.child].name) });
            }
            order.push(joint.child);
            carried.push(index);
        }
        at += 1;
    }
    if let Some(lost) = (0..links.len()).find(|link| !order.contains(link)) {
        let Link { name, line, .. } = &links[lost];
        return Err(UrdfError { line: *line, cause: format!("link `{name}` hangs in a loop of joints") });
    }
    // every link has its place in the order, or was refused as lost above
    let place = |link: usize| {
        let Link { name, line, .. } = &links[link];
        let lost = || UrdfError { line: *line, cause: format!("link `{name}` has no place in the tree") };
        order.iter().position(|known| *known == link).ok_or_else(lost)
    };
    let placed = |index: &usize| {
        let joint = joints[*index].clone();
        Ok(Joint { parent: place(joint.parent)?, child: place(joint.child)?, ..joint })
    };
    let joints = carried.iter().map(placed).collect::<Result<_, UrdfError>>()?;
    Ok(Robot { joints, links: order.iter().map(|link| links[*link].clone()).collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn parents_come_before_children() {
        let robot = Robot::parse(ARM).unwrap();
        let names: Vec<_> = robot.links.iter().map(|link| link.name.as_str()).collect();
        assert_eq!(names, ["base", "upper", "hand"]);
        let shoulder = &robot.joints[0];
        assert_eq!((shoulder.parent, shoulder.child, shoulder.limits), (0, 1, Some([-1.5, 1.5])));
        assert_eq!(robot.joints[1].freedom, Freedom::Fixed);
        assert_eq!(robot.links[1].collisions[0].geometry, Geometry::Cylinder(0.05, 1.0));
        assert_eq!(robot.links[1].inertial.unwrap().inertia_kg_m2, [0.2, 0.2, 0.01, 0.0, 0.0, 0.0]);
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
            ("mass value=\"2\"", "mass value=\"0\"", "line 7: a mass of 0 kg: leave <inertial> out for a mere frame"),
            ("size=\"0.2 0.2 0.1\"", "size=\"0.2 0.2\"", "line 5: `size` must be three numbers, not \"0.2 0.2\""),
            ("<link name=\"hand\"/>", "<link name=\"base\"/>", "line 5: link `base` is there twice"),
            (
                "<link name=\"hand\"/>",
                "<link name=\"hand\"/><link name=\"lost\"/>",
                "line 2: a robot has one link that no joint carries, not 2",
            ),
            ("<parent link=\"base\"/>", "<parent link=\"upper\"/>", "line 4: link `hand` hangs in a loop of joints"),
            ("</robot>\n", "", "line 15: the file ends within an element"),
            ("<limit ", "<limits ", "line 11: revolute joint `shoulder` needs a <limit>"),
            ("<axis xyz=\"0 1 0\"/>", "<mimic joint=\"wrist\"/>", "line 12: joint `shoulder` mimics another"),
        ];
        for (right, wrong, told) in cases {
            assert!(ARM.contains(right), "{right}");
            let said = Robot::parse(&ARM.replacen(right, wrong, 1)).unwrap_err().to_string();
            assert!(said.starts_with(told), "{told}\n{said}");
        }
    }
}
