//! COLLADA: the triangles of all geometries, where the scene of the file puts them, in metres.
//!
//! As ROS does, the file's unit counts and its `<up_axis>` does not: robots' descriptions turn their
//! meshes themselves. Sources: Khronos, COLLADA 1.4.1 (2008), chs. 5 and 6.

use std::collections::BTreeMap;

use onescan_xml::{Element, parse_within};
use rapier3d::glamx::{DMat3, DQuat, DVec3};

use super::{Mesh, MeshError};

/// Deepest nesting of nodes.
const DEPTH_MAX: usize = 64;
/// Deepest nesting of elements: those that nobody looks at may be nested, too.
const ELEMENTS_DEPTH_MAX: usize = 1024;

/// A linear map and a translation.
#[derive(Clone, Copy)]
struct Place {
    linear: DMat3,
    shift: DVec3,
}

impl Place {
    const IDENTITY: Self = Self { linear: DMat3::IDENTITY, shift: DVec3::ZERO };

    fn then(self, inner: Self) -> Self {
        Self { linear: self.linear * inner.linear, shift: self.linear * inner.shift + self.shift }
    }
}

struct File<'d> {
    text: &'d str,
    /// Every element with an `id`.
    known: BTreeMap<&'d str, &'d Element>,
    mesh: Mesh,
    budget: usize,
}

/// The mesh of a file's text.
///
/// # Errors
/// A text that is no COLLADA, or whose numbers do not go together.
pub(super) fn read(bytes: &[u8]) -> Result<Mesh, MeshError> {
    let text = &*String::from_utf8_lossy(bytes);
    let root = &parse_within(text, ELEMENTS_DEPTH_MAX)
        .map_err(|error| MeshError::Line { line: line(text, error.at), cause: error.to_string() })?;
    let known = root.tree().filter_map(|element| Some((value(element, "id")?, element))).collect();
    // Nodes can be put into one another by reference, so that a short file may mean any number of them: hence `budget`.
    let mut file = File { text, known, mesh: Mesh::default(), budget: 100_000 };
    if root.name != "COLLADA" {
        return Err(file.wrong(root, "<COLLADA> is missing"));
    }
    let unit = root.child("asset").and_then(|asset| asset.child("unit")).and_then(|unit| value(unit, "meter"));
    let unit_m: f64 = unit.and_then(|text| text.trim().parse().ok()).unwrap_or(1.0);
    let all = Place { linear: DMat3::from_diagonal(DVec3::splat(unit_m)), shift: DVec3::ZERO };
    let scene = root.child("scene").and_then(|scene| scene.child("instance_visual_scene"));
    match scene.and_then(|instance| file.referred(instance)) {
        Some(scene) => file.nodes(scene, all, DEPTH_MAX)?,
        None => {
            for geometry in root.tree().filter(|element| element.name == "geometry") {
                file.geometry(geometry, all)?;
            }
        }
    }
    Ok(file.mesh)
}

fn line(text: &str, at: u32) -> usize {
    text.get(..at as usize).unwrap_or(text).matches('\n').count() + 1
}

fn value<'d>(element: &'d Element, name: &str) -> Option<&'d str> {
    element.attribute(name).map(|attribute| &*attribute.value)
}

impl<'d> File<'d> {
    fn wrong(&self, element: &Element, cause: &str) -> MeshError {
        MeshError::Line { line: line(self.text, element.open.start), cause: cause.to_owned() }
    }

    fn numbers(&self, element: &Element) -> Result<Vec<f64>, MeshError> {
        // An element without text is an empty list.
        let text = element.text(self.text);
        let parsed = text.split_whitespace().map(str::parse).collect::<Result<_, _>>();
        parsed.map_err(|_| self.wrong(element, "a number is expected"))
    }

    /// What `url="#id"` or `source="#id"` names.
    fn referred(&self, element: &Element) -> Option<&'d Element> {
        let named = value(element, "url").or_else(|| value(element, "source"))?;
        self.known.get(named.strip_prefix('#')?).copied()
    }

    fn nodes(&mut self, parent: &Element, above: Place, depth: usize) -> Result<(), MeshError> {
        if depth == 0 || self.budget == 0 {
            return Err(self.wrong(parent, "nodes are nested too deep, or too many"));
        }
        self.budget -= 1;
        let mut place = above;
        for inner in parent.elements() {
            match &*inner.name {
                "matrix" | "translate" | "scale" | "rotate" => place = place.then(self.transform(inner)?),
                "node" => self.nodes(inner, place, depth - 1)?,
                "instance_node" => {
                    let node =
                        self.referred(inner).ok_or_else(|| self.wrong(inner, "it names a node that is not there"))?;
                    self.nodes(node, place, depth - 1)?;
                }
                "instance_geometry" => {
                    let found = self.referred(inner);
                    let geometry = found.ok_or_else(|| self.wrong(inner, "it names a geometry that is not there"))?;
                    self.geometry(geometry, place)?;
                }
                // lights, cameras, materials
                _ => {}
            }
        }
        Ok(())
    }

    fn geometry(&mut self, geometry: &Element, place: Place) -> Result<(), MeshError> {
        let Some(mesh) = geometry.child("mesh") else { return Ok(()) };
        for faces in mesh.elements() {
            let kind = &*faces.name;
            if matches!(kind, "triangles" | "polylist" | "polygons" | "trifans" | "tristrips") {
                self.faces(faces, kind, place)?;
                self.mesh.bounded()?;
            }
        }
        Ok(())
    }

    fn faces(&mut self, faces: &Element, kind: &str, place: Place) -> Result<(), MeshError> {
        let inputs = || faces.elements().filter(|inner| inner.name == "input");
        let offset = |input: &Element| value(input, "offset").and_then(|text| text.parse::<usize>().ok());
        // An input without an offset has the first place. The greatest number that a file can give is not a count.
        let stride = inputs().filter_map(offset).max().unwrap_or(0).saturating_add(1);
        let vertex = inputs().find(|input| value(input, "semantic") == Some("VERTEX"));
        let Some(vertex) = vertex.filter(|_| stride < 64) else { return Err(self.wrong(faces, "it has no corners")) };
        let first = self.corners(vertex, place)?;
        let count = self.mesh.corners.len() - first;
        let at = offset(vertex).unwrap_or(0);
        let counts = faces.child("vcount").map(|counts| self.numbers(counts)).transpose()?;
        for list in faces.elements().filter(|inner| inner.name == "p") {
            let indices: Vec<u32> = self
                .numbers(list)?
                .chunks_exact(stride)
                .map(|corner| corner[at])
                .map(|index| (index >= 0.0 && index < count as f64).then_some(first as u32 + index as u32))
                .collect::<Option<_>>()
                .ok_or_else(|| self.wrong(list, "it names a corner that is not there"))?;
            match (kind, &counts) {
                ("triangles", _) => self.mesh.triangles.extend(indices.chunks_exact(3).map(|c| [c[0], c[1], c[2]])),
                ("tristrips", _) => self.mesh.triangles.extend(indices.windows(3).map(|c| [c[0], c[1], c[2]])),
                ("polylist", Some(counts)) => {
                    let mut rest = indices.as_slice();
                    for corners in counts {
                        let cut = rest.split_at_checked(*corners as usize);
                        let (face, behind) =
                            cut.ok_or_else(|| self.wrong(list, "it has fewer corners than it says"))?;
                        self.fan(face);
                        rest = behind;
                    }
                }
                _ => self.fan(&indices),
            }
        }
        Ok(())
    }

    fn fan(&mut self, corners: &[u32]) {
        if let [first, others @ ..] = corners {
            self.mesh.triangles.extend(others.windows(2).map(|pair| [*first, pair[0], pair[1]]));
        }
    }

    /// Adds the corners of an input, each where it is, and gives the index of the first.
    fn corners(&mut self, vertex: &Element, place: Place) -> Result<usize, MeshError> {
        let lost = || self.wrong(vertex, "its corners are not there");
        let vertices = self.referred(vertex).ok_or_else(lost)?;
        let positions = vertices.elements().find(|input| value(input, "semantic") == Some("POSITION"));
        let source = positions.and_then(|input| self.referred(input)).ok_or_else(lost)?;
        let array = source.child("float_array").ok_or_else(lost)?;
        let accessor = source.child("technique_common").and_then(|technique| technique.child("accessor"));
        let stride = accessor.and_then(|accessor| value(accessor, "stride")?.parse().ok()).unwrap_or(3_usize);
        if !(3..64).contains(&stride) {
            return Err(self.wrong(source, "a corner has three numbers"));
        }
        let first = self.mesh.corners.len();
        for corner in self.numbers(array)?.chunks_exact(stride) {
            let placed = place.linear * DVec3::new(corner[0], corner[1], corner[2]) + place.shift;
            self.mesh.corners.push(placed.to_array());
        }
        Ok(first)
    }

    fn transform(&self, element: &Element) -> Result<Place, MeshError> {
        let numbers = self.numbers(element)?;
        Ok(match (&*element.name, &numbers[..]) {
            // three rows of four, and a fourth that says nothing
            ("matrix", rows) if rows.len() == 16 => {
                let [x, y, z, shift] =
                    [0, 1, 2, 3].map(|column| DVec3::new(rows[column], rows[column + 4], rows[column + 8]));
                Place { linear: DMat3::from_cols(x, y, z), shift }
            }
            ("translate", [x, y, z]) => Place { shift: DVec3::new(*x, *y, *z), ..Place::IDENTITY },
            ("scale", [x, y, z]) => Place { linear: DMat3::from_diagonal(DVec3::new(*x, *y, *z)), ..Place::IDENTITY },
            ("rotate", [x, y, z, angle_deg]) => {
                let axis = DVec3::new(*x, *y, *z);
                let (sin, cos) = libm::sincos(0.5 * angle_deg.to_radians());
                let about = if axis.length() > 0.0 { axis / axis.length() * sin } else { DVec3::ZERO };
                let turned = DQuat::from_xyzw(about.x, about.y, about.z, cos);
                Place { linear: DMat3::from_quat(turned), ..Place::IDENTITY }
            }
            _ => return Err(self.wrong(element, "it has another count of numbers than it should")),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &str = r##"<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit name="mm" meter="0.001"/><up_axis>Y_UP</up_axis></asset>
  <library_geometries><geometry id="g"><mesh>
    <source id="s"><float_array id="a" count="12">0 0 0 1 0 0 1 1 0 0 1 0</float_array></source>
    <vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
    <polylist count="1"><input semantic="VERTEX" source="#v" offset="0"/><input semantic="NORMAL" source="#n" offset="1"/>
      <vcount>4</vcount><p>0 0 1 0 2 0 3 0</p></polylist>
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="scene"><node>
    <translate>0 0 5</translate><rotate>0 0 1 90</rotate><scale>2 1 1</scale><instance_geometry url="#g"/>
  </node></visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>"##;

    #[test]
    fn corners_are_where_their_nodes_put_them_in_metres() {
        let mesh = read(SQUARE.as_bytes()).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        // twice as long, a quarter turn, 5 mm up
        let expected = [[0.0, 0.0, 5.0], [0.0, 2.0, 5.0], [-1.0, 2.0, 5.0], [-1.0, 0.0, 5.0]];
        for (corner, expected) in mesh.corners.iter().flatten().zip(expected.iter().flatten()) {
            assert!((corner - 1e-3 * expected).abs() < 1e-15, "{:?}", mesh.corners);
        }
    }

    #[test]
    fn what_does_not_go_together_is_reported() {
        let reported = |from: &str, to: &str| read(SQUARE.replacen(from, to, 1).as_bytes()).unwrap_err().to_string();
        assert_eq!(reported("0 0 1 0 2 0 3 0", "0 0 1 0 2 0 9 0"), "line 8: it names a corner that is not there");
        assert_eq!(reported("<vcount>4", "<vcount>5"), "line 8: it has fewer corners than it says");
        assert_eq!(reported("offset=\"1\"", "offset=\"18446744073709551615\""), "line 7: it has no corners");
        assert_eq!(reported("0 0 5", "0 0"), "line 11: it has another count of numbers than it should");
        assert_eq!(reported("url=\"#g\"", "url=\"#h\""), "line 11: it names a geometry that is not there");
        assert_eq!(reported("<source id=\"s\">", "<source id=\"t\">"), "line 7: its corners are not there");
        let nested = SQUARE.replace("<instance_geometry url=\"#g\"/>", "<instance_node url=\"#scene\"/>");
        assert!(read(nested.as_bytes()).unwrap_err().to_string().contains("nested too deep"));
    }
}
