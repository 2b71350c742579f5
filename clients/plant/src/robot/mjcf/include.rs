//! `<include>`: what another file has, in place of the element that names it.

use std::path::Path;
use std::sync::Arc;

use crate::file_place::Source;
use crate::robot::package;
use crate::robot::xml::{self, Element, RobotFault};
use crate::robot::{Packages, Reading};

/// Deepest nesting of files, and most elements of all of them together.
const DEPTH_MAX: usize = 16;
const ELEMENTS_MAX: usize = 200_000;

/// A model with what its files include, and with one `<worldbody>`.
///
/// # Errors
/// The first file that cannot be read, or is not XML.
pub(super) fn whole(root: &Element, path: &Path, reading: &Reading<'_>) -> Result<Element, RobotFault> {
    let folder = path.parent().unwrap_or_else(|| Path::new(""));
    let mut files = Files { folder, packages: reading.packages, made: 0 };
    let mut whole = files.expanded(root, 0)?;
    let mut world: Option<Element> = None;
    let mut children = Vec::new();
    for child in whole.children {
        match &mut world {
            Some(world) if child.name == "worldbody" => world.children.extend(child.children),
            None if child.name == "worldbody" => world = Some(child),
            Some(_) | None => children.push(child),
        }
    }
    children.extend(world);
    whole.children = children;
    Ok(whole)
}

struct Files<'f> {
    /// That of the model's own file: paths of all files begin there.
    folder: &'f Path,
    packages: &'f Packages,
    made: usize,
}

impl Files<'_> {
    fn expanded(&mut self, element: &Element, depth: usize) -> Result<Element, RobotFault> {
        self.made += 1;
        if self.made > ELEMENTS_MAX {
            return Err(element.wrong(format!("the robot has more than {ELEMENTS_MAX} elements")));
        }
        let mut children = Vec::new();
        for child in &element.children {
            if child.name == "include" {
                let read = self.included(child, depth)?;
                children.extend(self.expanded(&read, depth + 1)?.children);
            } else {
                children.push(self.expanded(child, depth)?);
            }
        }
        let Element { name, is_xacro, attributes, place, .. } = element;
        let (name, attributes, place) = (name.clone(), attributes.clone(), place.clone());
        Ok(Element { name, is_xacro: *is_xacro, attributes, children, place })
    }

    fn included(&self, include: &Element, depth: usize) -> Result<Element, RobotFault> {
        if depth == DEPTH_MAX {
            return Err(include.wrong(format!("files are included more than {DEPTH_MAX} deep")));
        }
        let named = include.text("file")?;
        let path = self.folder.join(named);
        let unread = |error| include.wrong_at("file", format!("`{named}` cannot be read: {error}"));
        let text = self.packages.read_text(&path).map_err(unread)?;
        xml::parse(&Arc::new(Source { file: package::shown(&path), text: text.into() }))
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::robot::{Packages, Reading, Robot};

    fn read(folder: &Path, text: &str) -> Result<Robot, String> {
        let packages = Packages::default();
        let reading = Reading { file: "arm.xml", packages: &packages, arguments: &[] };
        Robot::read(&folder.join("arm.xml"), text.to_owned(), &reading).map_err(|faults| faults[0].to_string())
    }

    #[test]
    fn an_included_file_stands_where_it_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().expect("inside")).expect("a folder");
            std::fs::write(path, text).expect("written");
        };
        write(
            "parts/settings.xml",
            "<mujoco><compiler angle='radian'/><worldbody><body name='post'/></worldbody></mujoco>",
        );
        // paths begin at the model's own file
        write(
            "parts/hand.xml",
            "<mujocoinclude><body name='hand'><include file='parts/twist.xml'/></body></mujocoinclude>",
        );
        write("parts/twist.xml", "<mujocoinclude><joint name='twist' range='-1 1'/></mujocoinclude>");
        let model = "<mujoco><include file='parts/settings.xml'/><worldbody><body name='arm'>\
            <include file='parts/hand.xml'/></body></worldbody></mujoco>";
        let robot = read(folder.path(), model).expect("read");
        let names: Vec<_> = robot.links.iter().map(|link| link.name.as_str()).collect();
        assert_eq!(names, ["world", "post", "arm", "hand"]);
        assert_eq!(robot.joints.iter().find(|joint| joint.name == "twist").expect("there").limits, Some([-1.0, 1.0]));
        write("arm.xml", "<mujoco>\n<include file='arm.xml'/></mujoco>");
        let endless = read(folder.path(), "<mujoco><include file='arm.xml'/></mujoco>").expect_err("refused");
        assert_eq!(endless, "line 2: files are included more than 16 deep");
        let lost = read(folder.path(), "<mujoco>\n<include file='lost.xml'/></mujoco>").expect_err("refused");
        assert!(lost.starts_with("line 2: `lost.xml` cannot be read: "), "{lost}");
    }
}
