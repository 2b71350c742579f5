//! glTF 2.0 and GLB: the triangles of all meshes, where the scene of the file puts them.
//!
//! Its y axis points up; here, as in a scene, z does. Source: Khronos, glTF 2.0 Specification (2021),
//! 3.5 (scenes), 3.6 (buffers), 3.7 (geometry), 4 (GLB).

use std::path::Path;

use onescan_base::regular::{Limit, Within};
use rapier3d::glamx::{DMat3, DQuat, DVec3};
use serde::Deserialize;

use super::{CORNERS_MAX, Mesh, MeshError};

/// Deepest nesting of nodes.
const DEPTH_MAX: usize = 64;
/// First bytes of a GLB, and the kinds of its chunks.
const MAGIC: &[u8] = b"glTF";
const JSON: u32 = 0x4E4F_534A;
const BINARY: u32 = 0x004E_4942;
const FLOAT: u32 = 5126;

#[derive(Deserialize)]
#[serde(rename_all = "camelCase", default)]
#[derive(Default)]
struct Document {
    scene: Option<usize>,
    scenes: Vec<Scene>,
    nodes: Vec<NodeFields>,
    meshes: Vec<MeshFields>,
    accessors: Vec<Accessor>,
    buffer_views: Vec<View>,
    buffers: Vec<Buffer>,
    extensions_required: Vec<String>,
}

#[derive(Deserialize)]
struct Scene {
    #[serde(default)]
    nodes: Vec<usize>,
}

#[derive(Deserialize)]
struct NodeFields {
    #[serde(default)]
    children: Vec<usize>,
    mesh: Option<usize>,
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

#[derive(Deserialize)]
struct MeshFields {
    primitives: Vec<Primitive>,
}

#[derive(Deserialize)]
struct Primitive {
    attributes: Attributes,
    indices: Option<usize>,
    mode: Option<u32>,
}

#[derive(Deserialize)]
struct Attributes {
    #[serde(rename = "POSITION")]
    position: Option<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Accessor {
    buffer_view: Option<usize>,
    #[serde(default)]
    byte_offset: usize,
    component_type: u32,
    count: usize,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct View {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: Option<usize>,
}

#[derive(Deserialize)]
struct Buffer {
    uri: Option<String>,
}

#[derive(Clone, Copy)]
struct Place {
    linear: DMat3,
    shift: DVec3,
}

struct File {
    document: Document,
    buffers: Vec<Vec<u8>>,
    mesh: Mesh,
    budget: usize,
}

fn wrong(cause: impl Into<String>) -> MeshError {
    MeshError::Content(cause.into())
}

/// The mesh of a file; `path` is where its buffers are beside.
///
/// # Errors
/// Bytes that are no glTF, or that do not go together.
pub(super) fn read(bytes: &[u8], path: &Path, within: &Within) -> Result<Mesh, MeshError> {
    let (json, binary) = if bytes.starts_with(MAGIC) { chunks(bytes)? } else { (bytes, None) };
    let document: Document = serde_json::from_slice(json)
        .map_err(|error| MeshError::Line { line: error.line(), cause: error.to_string() })?;
    if let Some(extension) = document.extensions_required.first() {
        return Err(wrong(format!("needs the extension {extension}, which is not read")));
    }
    let mut buffers = Vec::new();
    for buffer in &document.buffers {
        buffers.push(contents(buffer, binary, (path, within))?);
    }
    let mut file = File { document, buffers, mesh: Mesh::default(), budget: 100_000 };
    // y up becomes z up: a quarter turn about x
    let turned = DMat3::from_cols(DVec3::X, DVec3::Z, -DVec3::Y);
    let above = Place { linear: turned, shift: DVec3::ZERO };
    let scene = file.document.scenes.get(file.document.scene.unwrap_or(0));
    let roots = scene.map_or_else(Vec::new, |scene| scene.nodes.clone());
    for root in roots {
        file.node(root, above, DEPTH_MAX)?;
    }
    Ok(file.mesh)
}

/// The JSON of a GLB, and its binary chunk.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), MeshError> {
    let word = |at: usize| bytes.get(at..at + 4)?.try_into().ok().map(u32::from_le_bytes);
    let (mut json, mut binary) = (None, None);
    let mut at = 12;
    while let (Some(length), Some(kind)) = (word(at), word(at + 4)) {
        let chunk = bytes.get(at + 8..).and_then(|rest| rest.get(..length as usize));
        let chunk = chunk.ok_or_else(|| wrong("is a GLB that is cut short"))?;
        match kind {
            JSON => json = json.or(Some(chunk)),
            BINARY => binary = binary.or(Some(chunk)),
            // glTF 2.0, 4.4.3.1: chunks of unknown types are passed over
            _ => {}
        }
        at += 8 + length as usize;
    }
    json.map(|json| (json, binary)).ok_or_else(|| wrong("is a GLB without JSON"))
}

fn contents(buffer: &Buffer, binary: Option<&[u8]>, (path, within): (&Path, &Within)) -> Result<Vec<u8>, MeshError> {
    let Some(uri) = &buffer.uri else {
        return binary.map(<[u8]>::to_vec).ok_or_else(|| wrong("has a buffer without bytes"));
    };
    if let Some(data) = uri.strip_prefix("data:") {
        let encoded = data.split_once(";base64,").map(|(_, encoded)| encoded);
        return encoded.and_then(base64).ok_or_else(|| wrong("has a buffer that is not base64"));
    }
    let file = path.parent().unwrap_or_else(|| Path::new("")).join(uri);
    within.read(&file, Limit::DATA).map_err(|error| wrong(format!("needs `{uri}`, which cannot be read: {error}")))
}

/// RFC 4648, 4.
fn base64(text: &str) -> Option<Vec<u8>> {
    let value = |letter: u8| match letter {
        b'A'..=b'Z' => Some(letter - b'A'),
        b'a'..=b'z' => Some(letter - b'a' + 26),
        b'0'..=b'9' => Some(letter - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    };
    let mut bytes = Vec::new();
    for four in text.trim_end_matches('=').as_bytes().chunks(4) {
        let bits = four.iter().try_fold(0_u32, |bits, letter| Some(bits << 6 | u32::from(value(*letter)?)))?;
        let bits = bits << (6 * (4 - four.len()));
        bytes.extend_from_slice(bits.to_be_bytes().get(1..four.len())?);
    }
    Some(bytes)
}

impl File {
    fn node(&mut self, index: usize, above: Place, depth: usize) -> Result<(), MeshError> {
        if depth == 0 || self.budget == 0 {
            return Err(wrong("has nodes that are nested too deep, or too many"));
        }
        self.budget -= 1;
        let node = self.document.nodes.get(index).ok_or_else(|| wrong(format!("has no node {index}")))?;
        let own = node.place();
        let place = Place { linear: above.linear * own.linear, shift: above.linear * own.shift + above.shift };
        let (mesh, children) = (node.mesh, node.children.clone());
        if let Some(mesh) = mesh {
            self.add(mesh, place)?;
        }
        children.into_iter().try_for_each(|child| self.node(child, place, depth - 1))
    }

    fn add(&mut self, index: usize, place: Place) -> Result<(), MeshError> {
        let fields = self.document.meshes.get(index).ok_or_else(|| wrong(format!("has no mesh {index}")))?;
        let mut added = Mesh::default();
        for primitive in &fields.primitives {
            let (Some(position), None | Some(4)) = (primitive.attributes.position, primitive.mode) else { continue };
            let corners = self.numbers(position, 3)?;
            let first = (self.mesh.corners.len() + added.corners.len()) as u32;
            let count = corners.len() as u32 / 3;
            let placed =
                corners.chunks_exact(3).map(|c| (place.linear * DVec3::new(c[0], c[1], c[2]) + place.shift).to_array());
            added.corners.extend(placed);
            let indices = match primitive.indices {
                Some(accessor) => self.numbers(accessor, 1)?.into_iter().map(|index| index as u32).collect(),
                None => (0..count).collect::<Vec<u32>>(),
            };
            if indices.iter().any(|index| *index >= count) {
                return Err(wrong("names a corner that is not there"));
            }
            added.triangles.extend(indices.chunks_exact(3).map(|c| [c[0], c[1], c[2]].map(|index| first + index)));
        }
        self.mesh.corners.extend(added.corners);
        self.mesh.triangles.extend(added.triangles);
        self.mesh.bounded()
    }

    /// The numbers of an accessor whose elements have so many each.
    fn numbers(&self, accessor: usize, each: usize) -> Result<Vec<f64>, MeshError> {
        let lost = || wrong("has numbers that are not there");
        let accessor = self.document.accessors.get(accessor).ok_or_else(lost)?;
        let view = accessor.buffer_view.and_then(|view| self.document.buffer_views.get(view)).ok_or_else(lost)?;
        let buffer = self.buffers.get(view.buffer).and_then(|bytes| bytes.get(view.byte_offset..)).ok_or_else(lost)?;
        let bytes =
            buffer.get(..view.byte_length).and_then(|bytes| bytes.get(accessor.byte_offset..)).ok_or_else(lost)?;
        let size = match accessor.component_type {
            5121 => 1,
            5123 => 2,
            5125 | FLOAT => 4,
            other => return Err(wrong(format!("has numbers of type {other}, which is not read"))),
        };
        // Elements may lie in one place: no number of bytes says how many there are.
        if accessor.count > CORNERS_MAX {
            return Err(wrong(format!("has {} numbers, which is too many", accessor.count)));
        }
        let stride = view.byte_stride.unwrap_or(size * each);
        let mut numbers = Vec::new();
        for element in 0..accessor.count {
            for part in 0..each {
                let at = element.checked_mul(stride).and_then(|at| at.checked_add(part * size)).ok_or_else(lost)?;
                let bytes = bytes.get(at..).and_then(|rest| rest.get(..size)).ok_or_else(lost)?;
                numbers.push(number(bytes, accessor.component_type));
            }
        }
        Ok(numbers)
    }
}

fn number(bytes: &[u8], kind: u32) -> f64 {
    match *bytes {
        [a] => f64::from(a),
        [a, b] => f64::from(u16::from_le_bytes([a, b])),
        [a, b, c, d] if kind == FLOAT => f64::from(f32::from_le_bytes([a, b, c, d])),
        [a, b, c, d] => f64::from(u32::from_le_bytes([a, b, c, d])),
        _ => 0.0,
    }
}

impl NodeFields {
    fn place(&self) -> Place {
        if let Some([a, b, c, _, d, e, f, _, g, h, i, _, x, y, z, _]) = self.matrix {
            let linear = DMat3::from_cols(DVec3::new(a, b, c), DVec3::new(d, e, f), DVec3::new(g, h, i));
            return Place { linear, shift: DVec3::new(x, y, z) };
        }
        let [x, y, z, w] = self.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
        let scale = DMat3::from_diagonal(DVec3::from_array(self.scale.unwrap_or([1.0; 3])));
        let linear = DMat3::from_quat(DQuat::from_xyzw(x, y, z, w)) * scale;
        Place { linear, shift: self.translation.map_or(DVec3::ZERO, DVec3::from_array) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::TRIANGLES_MAX;
    use super::*;

    /// A triangle: three corners of three `f32` in base64, with `node` for its node.
    fn triangle(node: &str) -> String {
        // (0,0,0) (1,0,0) (0,1,0)
        let data = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
        format!(
            r#"{{"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0{node}}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3}}],"bufferViews":[{{"buffer":0,"byteLength":36}}],
            "buffers":[{{"byteLength":36,"uri":"data:application/octet-stream;base64,{data}"}}]}}"#
        )
    }

    fn mesh_of(text: &[u8]) -> Result<Mesh, String> {
        read(text, Path::new("part.gltf"), &Within::anywhere()).map_err(|error| error.to_string())
    }

    #[test]
    fn y_up_becomes_z_up() {
        let mesh = mesh_of(triangle("").as_bytes()).unwrap();
        assert_eq!((&mesh.triangles[..], mesh.corners.len()), (&[[0, 1, 2]][..], 3));
        assert_eq!(mesh.corners[2], [0.0, 0.0, 1.0]);
        let moved = triangle(r#","translation":[0,2,0],"scale":[3,1,1]"#);
        assert_eq!(mesh_of(moved.as_bytes()).unwrap().corners[1], [3.0, 0.0, 2.0]);
    }

    #[test]
    fn a_glb_is_the_same() {
        let text = triangle("");
        let padded = format!("{text}{}", " ".repeat(text.len().next_multiple_of(4) - text.len()));
        let mut bytes = MAGIC.to_vec();
        bytes.extend([2_u32, 20 + padded.len() as u32, padded.len() as u32, JSON].map(u32::to_le_bytes).concat());
        bytes.extend(padded.as_bytes());
        assert_eq!(mesh_of(&bytes), mesh_of(text.as_bytes()));
        assert_eq!(mesh_of(&bytes[..40]), Err("is a GLB that is cut short".to_owned()));
    }

    #[test]
    fn what_does_not_go_together_is_reported() {
        let reported = |from: &str, to: &str| mesh_of(triangle("").replacen(from, to, 1).as_bytes()).unwrap_err();
        assert_eq!(reported("\"count\":3", "\"count\":4"), "has numbers that are not there");
        let count = reported("\"count\":3}", "\"count\":9000000000}");
        assert_eq!(count, "has 9000000000 numbers, which is too many");
        let nodes = format!("\"nodes\":[{}0]", "0,".repeat(TRIANGLES_MAX));
        assert_eq!(reported("\"nodes\":[0]", &nodes), "has nodes that are nested too deep, or too many");
        assert_eq!(reported("\"nodes\":[0]", "\"nodes\":[1]"), "has no node 1");
        assert_eq!(reported("base64,AAAA", "base64,AA!A"), "has a buffer that is not base64");
        assert_eq!(
            reported("\"mesh\":0", "\"mesh\":0,\"children\":[0]"),
            "has nodes that are nested too deep, or too many"
        );
        assert!(reported("{", "{,").starts_with("line 1: "));
    }
}
