//! The robot of a MuJoCo model: bodies, joints, geoms.
//!
//! Read are `<include>`, `<compiler>`, `<default>` classes, `<asset>` meshes, and of `<worldbody>` the bodies and frames
//! with `<inertial>`, hinges, slides, balls, free joints and geoms; of `<equality>` the joints that follow others. What
//! a geom weighs is taken where a body has no `<inertial>`, as MuJoCo does. Actuators, tendons, sensors and
//! contacts are left aside, with a remark. A scene has a body between any two joints, so a body with several has
//! frames without mass between them.
//!
//! | module | subject |
//! |---|---|
//! | `include` | models in several files |
//! | `joint` | the joints of a body, and those that follow others |
//! | `pose` | where a body, a geom or a mass is |
//!
//! Source: MuJoCo documentation, XML reference (3.3).

mod include;
mod joint;
mod pose;

use std::path::Path;

use rapier3d::glamx::DVec3;
use rapier3d::math::Pose;

use super::inertial::{self, is_tensor};
use super::tree::sorted;
use super::xml::{Element, RobotFault};
use super::{Collision, Geometry, Inertial, Joint, Link, Reading, Robot, Weight};
use pose::{along, origin};

/// What MuJoCo takes where a geom says nothing.
const DENSITY_KG_M3: f64 = 1000.0;

/// The settings of `<compiler>`.
struct Compiler {
    degrees: bool,
    euler: String,
    mesh_folder: String,
}

/// A class of `<default>`: its name, that of the class around it, and its element.
struct Class<'e> {
    name: String,
    parent: Option<usize>,
    element: &'e Element,
}

/// A mesh of `<asset>`: its name, its file and what 1 means in it along each axis.
struct Asset {
    name: String,
    file: String,
    scale: [f64; 3],
}

/// An element of a body, and what the frames around it do to it.
#[derive(Clone, Copy)]
struct Placed<'b> {
    element: &'b Element,
    at: Pose,
    class: &'b str,
}

struct Reader<'e> {
    compiler: Compiler,
    classes: Vec<Class<'e>>,
    meshes: Vec<Asset>,
    links: Vec<Link>,
    joints: Vec<Joint>,
    faults: Vec<RobotFault>,
    remarks: Vec<String>,
}

/// The robot of a file's outermost element.
///
/// # Errors
/// Every fault that was found.
pub(super) fn robot(root: &Element, path: &Path, reading: &Reading<'_>) -> Result<Robot, Vec<RobotFault>> {
    let root = &include::whole(root, path, reading).map_err(|fault| vec![fault])?;
    // what several files say, the last one says
    let get = |key: &str| root.all("compiler").filter_map(|compiler| compiler.get(key)).last();
    let mut reader = Reader {
        compiler: Compiler {
            degrees: get("angle") != Some("radian"),
            euler: get("eulerseq").unwrap_or("xyz").to_owned(),
            mesh_folder: get("meshdir").or_else(|| get("assetdir")).unwrap_or_default().to_owned(),
        },
        classes: Vec::new(),
        meshes: Vec::new(),
        links: Vec::new(),
        joints: Vec::new(),
        faults: Vec::new(),
        remarks: Vec::new(),
    };
    root.all("default").for_each(|element| reader.class(element, None));
    for mesh in root.all("asset").flat_map(|asset| asset.all("mesh")) {
        let read = reader.asset(mesh);
        reader.keep(read);
    }
    let world = root.needed("worldbody").map_err(|fault| vec![fault])?;
    reader.body(Placed { element: world, at: Pose::IDENTITY, class: "main" }, None);
    reader.follow(root);
    for (section, what) in
        [("actuator", "actuators"), ("tendon", "tendons"), ("sensor", "sensors"), ("contact", "contacts")]
    {
        let count: usize = root.all(section).map(|element| element.children.len()).sum();
        if count > 0 {
            reader.remarks.push(format!("{count} {what} of the model are not taken over"));
        }
    }
    let Reader { links, joints, faults, remarks, .. } = reader;
    if !faults.is_empty() {
        return Err(faults);
    }
    let (links, joints) = sorted(&links, &joints, root).map_err(|fault| vec![fault])?;
    Ok(Robot { links, joints, remarks })
}

impl<'e> Reader<'e> {
    fn keep(&mut self, result: Result<(), RobotFault>) {
        self.faults.extend(result.err());
    }

    fn class(&mut self, element: &'e Element, parent: Option<usize>) {
        let name = element.get("class").unwrap_or("main").to_owned();
        let own = self.classes.len();
        self.classes.push(Class { name, parent, element });
        element.all("default").for_each(|inner| self.class(inner, Some(own)));
    }

    /// An element with what its class says of it: its own attributes come first.
    fn complete(&self, element: &Element, class: &str) -> Element {
        let mut whole = element.clone();
        let wanted = element.get("class").unwrap_or(class);
        let mut at = self.classes.iter().position(|class| class.name == wanted);
        while let Some(class) = at.map(|at| &self.classes[at]) {
            let preset = class.element.child(&element.name);
            for attribute in preset.into_iter().flat_map(|preset| &preset.attributes) {
                if whole.attribute(&attribute.key).is_none() {
                    whole.attributes.push(attribute.clone());
                }
            }
            at = class.parent;
        }
        whole
    }

    fn asset(&mut self, mesh: &Element) -> Result<(), RobotFault> {
        let mesh = self.complete(mesh, "main");
        let file = mesh.text("file")?;
        let stem = file.rsplit('/').next().and_then(|name| name.rsplit_once('.')).map_or(file, |(stem, _)| stem);
        let name = mesh.get("name").unwrap_or(stem).to_owned();
        let folder = &self.compiler.mesh_folder;
        let file = if folder.is_empty() { file.to_owned() } else { format!("{folder}/{file}") };
        let scale = mesh.triple("scale", [1.0; 3])?;
        self.meshes.push(Asset { name, file, scale });
        Ok(())
    }

    /// What a body has, that of its frames too, with where these are and the class that they give.
    fn contents<'b>(&self, of: Placed<'b>, into: &mut Vec<Placed<'b>>) -> Result<(), RobotFault> {
        for element in &of.element.children {
            if element.name == "frame" {
                let at = of.at * self.pose(element)?;
                let class = element.get("childclass").unwrap_or(of.class);
                self.contents(Placed { element, at, class }, into)?;
            } else {
                into.push(Placed { element, ..of });
            }
        }
        Ok(())
    }

    /// A body with all that is in it; the world is the root.
    fn body(&mut self, placed: Placed<'_>, parent: Option<usize>) {
        let element = placed.element;
        let class = element.get("childclass").unwrap_or(placed.class);
        let index = self.links.len();
        let name = match (parent, element.get("name")) {
            (None, _) => "world".to_owned(),
            (Some(_), Some(name)) => name.to_owned(),
            (Some(_), None) => format!("body[{index}]"),
        };
        if self.links.iter().any(|known| known.name == name) {
            self.faults.push(element.wrong(format!("body `{name}` is there twice")));
        }
        let place = element.place.clone();
        self.links.push(Link { name, inertial: None, collisions: Vec::new(), visuals: Vec::new(), place });
        if let Some(written) = element.child("inertial") {
            match self.inertial(written) {
                Ok(read) => {
                    self.links[index].inertial = inertial::of_a_body(read);
                    if self.links[index].inertial.is_none() {
                        self.remarks.push(inertial::remark(&self.links[index].name, read.mass_kg));
                    }
                }
                Err(fault) => self.faults.push(fault),
            }
        }
        if let Some(parent) = parent {
            let joints = self.joints(placed, [parent, index], class);
            self.keep(joints);
        }
        let is_weighed = element.child("inertial").is_some();
        let mut contents = Vec::new();
        let read = self.contents(Placed { element, at: Pose::IDENTITY, class }, &mut contents);
        self.keep(read);
        for geom in contents.iter().filter(|inner| inner.element.name == "geom") {
            match self.geom(&self.complete(geom.element, geom.class), geom.at) {
                // what a geom weighs counts only where nothing else says what the body does
                Ok(Some(shape)) if is_weighed => {
                    self.links[index].collisions.push(Collision { weight: None, ..shape });
                }
                Ok(Some(shape)) => self.links[index].collisions.push(shape),
                Ok(None) => {}
                Err(fault) => self.faults.push(fault),
            }
        }
        for inner in contents.into_iter().filter(|inner| inner.element.name == "body") {
            self.body(inner, Some(index));
        }
    }

    fn inertial(&self, element: &Element) -> Result<Inertial, RobotFault> {
        let mass_kg = element.number("mass")?;
        if mass_kg < 0.0 {
            return Err(element.wrong_at("mass", format!("a mass of {mass_kg} kg")));
        }
        let diagonal = element.numbers::<3>("diaginertia")?.map(|[x, y, z]| [x, y, z, 0.0, 0.0, 0.0]);
        let full = element.numbers::<6>("fullinertia")?;
        let inertia_kg_m2 = full.or(diagonal).filter(|tensor| is_tensor(*tensor));
        let origin = origin(&self.pose(element)?);
        Ok(Inertial { origin, mass_kg, inertia_kg_m2 })
    }

    /// A shape; none for what is only shown, and for planes, of which a robot has none.
    fn geom(&mut self, geom: &Element, at: Pose) -> Result<Option<Collision>, RobotFault> {
        // 32 bits each; MuJoCo's groups and classes do not say who collides
        let collides = geom.number_or("contype", 1.0)? != 0.0 || geom.number_or("conaffinity", 1.0)? != 0.0;
        let mut place = at * self.pose(geom)?;
        let sizes: Vec<f64> = geom
            .get("size")
            .map_or_else(Vec::new, |text| text.split_whitespace().filter_map(|word| word.parse().ok()).collect());
        let ends = geom.numbers::<6>("fromto")?;
        let half = ends.map(|[x, y, z, u, v, w]| {
            let (from, to) = (DVec3::new(x, y, z), DVec3::new(u, v, w));
            place = at * Pose::from_parts((from + to) * 0.5, along(to - from));
            0.5 * (to - from).length()
        });
        let kind = geom.get("type").unwrap_or(if geom.attribute("mesh").is_some() { "mesh" } else { "sphere" });
        // of what is round, half the length stands behind the radius, unless its ends are given
        let half = half.or_else(|| sizes.get(1).copied());
        let geometry = match (kind, &sizes[..], half) {
            ("sphere", [radius, ..], _) => Geometry::Sphere(*radius),
            ("box", [x, y, z, ..], _) => Geometry::Box([2.0 * x, 2.0 * y, 2.0 * z]),
            ("cylinder", [radius, ..], Some(half)) => Geometry::Cylinder(*radius, 2.0 * half),
            ("capsule", [radius, ..], Some(half)) => Geometry::Capsule(*radius, 2.0 * half),
            ("mesh", ..) => {
                let wanted = geom.text("mesh")?;
                let asset = self.meshes.iter().find(|asset| asset.name == wanted);
                let asset = asset.ok_or_else(|| geom.wrong_at("mesh", format!("there is no mesh `{wanted}`")))?;
                Geometry::Mesh(asset.file.clone(), asset.scale)
            }
            ("plane" | "hfield", ..) => {
                self.remarks.push(format!("a geom of type `{kind}` is not taken over"));
                return Ok(None);
            }
            ("sphere" | "box" | "cylinder" | "capsule", ..) => {
                return Err(geom.wrong(format!("a {kind} lacks numbers in its `size`")));
            }
            _ => return Err(geom.wrong_at("type", format!("a geom of type `{kind}` is not known"))),
        };
        let weight = match (geom.attribute("mass"), geom.attribute("density")) {
            (Some(_), _) => Weight::Mass(geom.number("mass")?),
            (None, Some(_)) => Weight::Density(geom.number("density")?),
            (None, None) => Weight::Density(DENSITY_KG_M3),
        };
        let place_in_file = geom.place.clone();
        Ok(Some(Collision { origin: origin(&place), geometry, collides, weight: Some(weight), place: place_in_file }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{Freedom, Mimic, Origin, Packages, Reading};
    use std::path::Path;

    const ARM: &str = r#"<mujoco model="arm">
  <compiler angle="degree" meshdir="assets"/>
  <default>
    <geom type="capsule"/>
    <default class="visual"><geom contype="0" conaffinity="0"/></default>
    <default class="hinge"><joint axis="0 1 0" range="-90 90"/></default>
  </default>
  <asset><mesh file="tip.stl" scale="0.001 0.001 0.001"/></asset>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="upper" pos="0 0 1" quat="0 1 0 0">
      <joint name="shoulder" class="hinge" pos="0 0 0.1"/>
      <geom fromto="0 0 0 0 0 0.5" size="0.05"/>
      <geom class="visual" type="mesh" mesh="tip"/>
      <body name="lower" pos="0 0 0.5" euler="0 90 0">
        <joint name="elbow" type="slide" range="0 0.2"/>
        <inertial pos="0 0 0.1" mass="2" diaginertia="0.1 0.1 0.01"/>
        <geom type="box" size="0.1 0.2 0.3" mass="3"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor joint="shoulder"/></actuator>
</mujoco>"#;

    fn read(text: &str) -> Result<Robot, Vec<RobotFault>> {
        let packages = Packages::default();
        let reading = Reading { file: "arm.xml", packages: &packages, arguments: &[] };
        Robot::read(Path::new("arm.xml"), text.to_owned(), &reading)
    }

    #[test]
    fn a_model_is_a_tree_of_links() {
        let robot = read(ARM).unwrap();
        let names: Vec<_> = robot.links.iter().map(|link| link.name.as_str()).collect();
        assert_eq!(names, ["world", "upper", "lower"]);
        let [shoulder, elbow] = &robot.joints[..] else { panic!("two joints") };
        assert_eq!(
            (shoulder.freedom, shoulder.axis, shoulder.anchor_m),
            (Freedom::Turns, [0.0, 1.0, 0.0], [0.0, 0.0, 0.1])
        );
        assert_eq!(shoulder.limits, Some([-std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_2]));
        assert_eq!((elbow.freedom, elbow.limits), (Freedom::Slides, Some([0.0, 0.2])));
        assert!((elbow.origin.rpy_rad[1] - std::f64::consts::FRAC_PI_2).abs() < 1e-15, "{:?}", elbow.origin);
        assert!((shoulder.origin.rpy_rad[0].abs() - std::f64::consts::PI).abs() < 1e-12, "{:?}", shoulder.origin);
        let [capsule, mesh] = &robot.links[1].collisions[..] else { panic!("two shapes") };
        assert_eq!((&capsule.geometry, capsule.weight), (&Geometry::Capsule(0.05, 0.5), Some(Weight::Density(1000.0))));
        assert_eq!(capsule.origin.xyz_m, [0.0, 0.0, 0.25]);
        assert_eq!((&mesh.geometry, mesh.collides), (&Geometry::Mesh("assets/tip.stl".to_owned(), [0.001; 3]), false));
        let lower = &robot.links[2];
        assert_eq!(lower.collisions[0].geometry, Geometry::Box([0.2, 0.4, 0.6]));
        assert_eq!(lower.inertial.unwrap().mass_kg, 2.0);
        assert_eq!(
            robot.remarks,
            ["a geom of type `plane` is not taken over", "1 actuators of the model are not taken over"]
        );
    }

    #[test]
    fn joints_of_one_body_act_in_their_order() {
        let more =
            "<joint name=\"lift\" type=\"slide\" axis=\"0 0 1\"/><joint name=\"twist\" pos=\"0 0 0.2\"/><geom fromto";
        let robot = read(&ARM.replace("<geom fromto", more)).unwrap();
        let names: Vec<_> = robot.links.iter().map(|link| link.name.as_str()).collect();
        assert_eq!(names, ["world", "upper.shoulder", "upper.lift", "upper", "lower"]);
        let chain: Vec<_> = robot.joints.iter().map(|joint| (joint.name.as_str(), joint.parent, joint.child)).collect();
        assert_eq!(chain, [("shoulder", 0, 1), ("lift", 1, 2), ("twist", 2, 3), ("elbow", 3, 4)]);
        assert_eq!(robot.joints[0].origin.xyz_m, [0.0, 0.0, 1.0]);
        assert_eq!([&robot.joints[1].origin, &robot.joints[2].origin], [&Origin::default(); 2]);
        let anchors: Vec<_> = robot.joints.iter().map(|joint| joint.anchor_m[2]).collect();
        assert_eq!(anchors, [0.1, 0.0, 0.2, 0.0]);
        assert!(robot.links[1..3].iter().all(|frame| frame.inertial.is_none() && frame.collisions.is_empty()));
    }

    #[test]
    fn a_frame_places_what_it_has() {
        let frames = "<frame pos=\"0 0 1\" euler=\"0 90 0\" childclass=\"visual\"><frame pos=\"1 0 0\">\
            <geom type=\"box\" size=\"1 1 1\"/><body name=\"post\" pos=\"1 0 0\"/></frame></frame><body name=\"upper\"";
        let robot = read(&ARM.replace("<body name=\"upper\"", frames)).unwrap();
        let [shape] = &robot.links[0].collisions[..] else { panic!("a shape") };
        assert!(!shape.collides && (shape.origin.rpy_rad[1] - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        // x of the outer frame is down
        let post = robot.joints.iter().find(|joint| joint.name == "post").expect("there");
        for (z, wanted) in [(shape.origin.xyz_m[2], 0.0), (post.origin.xyz_m[2], -1.0)] {
            assert!((z - wanted).abs() < 1e-15, "{z}");
        }
    }

    #[test]
    fn a_joint_may_stand_elsewhere_than_at_0() {
        let stands = ARM
            .replace("type=\"slide\"", "type=\"slide\" ref=\"0.1\"")
            .replace("class=\"hinge\" pos", "class=\"hinge\" ref=\"45\" pos");
        let equality = "<equality><joint joint1=\"elbow\" joint2=\"shoulder\" polycoef=\"0.01 2 0 0 0\"/></equality>";
        let robot = read(&stands.replace("<actuator>", &format!("{equality}<actuator>"))).unwrap();
        let quarter = std::f64::consts::FRAC_PI_4;
        assert_eq!([robot.joints[0].reference, robot.joints[1].reference], [quarter, 0.1]);
        let mimic = robot.joints[1].mimic.clone().expect("it follows");
        // both are counted from where they stand
        assert!((mimic.offset - (0.1 + 0.01 - 2.0 * quarter)).abs() < 1e-15, "{mimic:?}");
    }

    #[test]
    fn a_mass_that_no_body_has_makes_a_frame() {
        let robot = read(&ARM.replace("mass=\"2\"", "mass=\"1e-08\"")).unwrap();
        let lower = &robot.links[2];
        assert_eq!((lower.inertial, lower.collisions[0].weight), (None, None), "its geom has a mass of its own");
        assert_eq!(robot.remarks[1], "link `lower` has a mass of 1e-8 kg: it is a frame");
    }

    #[test]
    fn a_joint_may_follow_another() {
        let equality = "<equality><joint joint1=\"elbow\" joint2=\"shoulder\" polycoef=\"0.1 -0.5 0 0 0\"/></equality>";
        let robot = read(&ARM.replace("<actuator>", &format!("{equality}<actuator>"))).unwrap();
        assert_eq!(robot.joints[1].mimic, Some(Mimic { joint: "shoulder".to_owned(), factor: -0.5, offset: 0.1 }));
    }

    #[test]
    fn all_faults_are_reported_with_their_lines() {
        let wrong = ARM
            .replace("mesh=\"tip\"", "mesh=\"tap\"")
            .replace("type=\"slide\"", "type=\"slyde\"")
            .replace("size=\"0.1 0.2 0.3\"", "size=\"0.1\"");
        let reported: Vec<_> = read(&wrong).unwrap_err().iter().map(ToString::to_string).collect();
        assert_eq!(
            reported,
            [
                "line 14: there is no mesh `tap`",
                "line 16: a joint of type `slyde` is not known",
                "line 18: a box lacks numbers in its `size`"
            ]
        );
        let two = ARM.replace("<geom fromto", "<freejoint/><geom fromto");
        assert_eq!(
            read(&two).unwrap_err()[0].to_string(),
            "line 13: body `upper` has a free joint, which leaves nothing to its others (remove the others, or give them a \
             body within this one)"
        );
        let light = ARM.replace("mass=\"2\"", "mass=\"-2\"");
        assert_eq!(read(&light).unwrap_err()[0].to_string(), "line 17: a mass of -2 kg");
    }
}
