//! Meshes from files: STL, text or binary, Wavefront OBJ, COLLADA and glTF. Only corners and triangles are
//! read.
//!
//! Sources: STL as of 3D Systems' Stereolithography Interface Specification (1989); OBJ as of Wavefront's
//! Advanced Visualizer, appendix B1, of which faces may have any number of corners.

mod collada;
pub(crate) mod flat;
mod gltf;

use std::path::Path;

use onescan_base::regular::{Limit, Within};
use thiserror::Error;

/// Most triangles of a mesh: beyond, contacts would take longer than any step.
const TRIANGLES_MAX: usize = 200_000;
/// Most corners of a mesh.
const CORNERS_MAX: usize = 3 * TRIANGLES_MAX;
/// Bytes before the triangles of a binary STL: a title, and how many there are.
const STL_HEAD: usize = 84;
/// Bytes of a triangle: a normal, three corners, two bytes without meaning.
const STL_TRIANGLE: usize = 50;

/// Why a file is not a mesh.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum MeshError {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Unreadable(String),
    /// Its name does not end as that of a mesh.
    #[error("is not a mesh that this program reads: `.stl`, `.obj`, `.dae`, `.gltf` or `.glb`")]
    Kind,
    /// It is cut short or has something else in it.
    #[error("line {line}: {cause}")]
    Line {
        /// The line, from 1.
        line: usize,
        /// What is wrong with it.
        cause: String,
    },
    /// A binary STL of another length than it says.
    #[error("is a binary STL of {triangles} triangles and {bytes} bytes, which do not go together")]
    Length {
        /// The triangles that it says it has.
        triangles: usize,
        /// The bytes that it has.
        bytes: usize,
    },
    /// Something in it does not go together.
    #[error("{0}")]
    Content(String),
    /// No triangle at all, or too many.
    #[error("has {0} triangles; from 1 to {TRIANGLES_MAX} are of use")]
    Count(usize),
    /// A corner that is not a finite number.
    #[error("has a corner that is not finite")]
    Infinite,
}

/// Corners and the triangles between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The corners, in the file's unit.
    pub corners: Vec<[f64; 3]>,
    /// Indices of three corners each.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The mesh of a file.
    ///
    /// # Errors
    /// See [`MeshError`].
    pub fn read(path: &Path) -> Result<Self, MeshError> {
        Self::read_within(path, &Within::anywhere())
    }

    /// As [`Mesh::read`], where the file, and what it names, may be read.
    ///
    /// # Errors
    /// See [`MeshError`].
    pub fn read_within(path: &Path, within: &Within) -> Result<Self, MeshError> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        let reader: fn(&[u8], &Path, &Within) -> Result<Self, MeshError> = match ending.as_deref() {
            Some("stl") => |bytes, _, _| Self::stl(bytes),
            Some("obj") => |bytes, _, _| Self::obj(bytes),
            Some("dae") => |bytes, _, _| collada::read(bytes),
            Some("gltf" | "glb") => gltf::read,
            _ => return Err(MeshError::Kind),
        };
        let bytes = within.read(path, Limit::DATA).map_err(|error| MeshError::Unreadable(error.to_string()))?;
        reader(&bytes, path, within)?.checked()
    }

    /// A part that is in many places is there many times: what is too much is not collected to its end.
    fn bounded(&self) -> Result<(), MeshError> {
        let is_bounded = self.triangles.len() <= TRIANGLES_MAX && self.corners.len() <= CORNERS_MAX;
        if is_bounded { Ok(()) } else { Err(MeshError::Count(self.triangles.len().max(TRIANGLES_MAX + 1))) }
    }

    fn checked(self) -> Result<Self, MeshError> {
        if !(1..=TRIANGLES_MAX).contains(&self.triangles.len()) {
            return Err(MeshError::Count(self.triangles.len()));
        }
        let finite = self.corners.iter().flatten().all(|number| number.is_finite());
        if finite { Ok(self) } else { Err(MeshError::Infinite) }
    }

    /// Adds a corner, or finds the last few again: neighbours in a file share most of theirs.
    fn corner(&mut self, corner: [f64; 3]) -> u32 {
        let recent = self.corners.len().saturating_sub(64);
        let known = self.corners[recent..].iter().position(|known| *known == corner);
        let index = known.map_or(self.corners.len(), |index| recent + index);
        if known.is_none() {
            self.corners.push(corner);
        }
        index as u32
    }

    fn stl(bytes: &[u8]) -> Result<Self, MeshError> {
        // a binary file may begin with "solid", too: its length decides
        let count = bytes.get(80..STL_HEAD).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
        let fits = |count: u32| (count as usize).checked_mul(STL_TRIANGLE).and_then(|size| size.checked_add(STL_HEAD));
        if let Some(count) = count
            && fits(count) == Some(bytes.len())
        {
            return Ok(Self::binary_stl(&bytes[STL_HEAD..]));
        }
        match std::str::from_utf8(bytes) {
            Ok(text) if text.trim_start().starts_with("solid") => Self::text_stl(text),
            _ => Err(MeshError::Length { triangles: count.unwrap_or_default() as usize, bytes: bytes.len() }),
        }
    }

    fn binary_stl(bytes: &[u8]) -> Self {
        let mut mesh = Self::default();
        for triangle in bytes.chunks_exact(STL_TRIANGLE) {
            let number = |at: usize| {
                let bytes = triangle[at..].first_chunk::<4>().copied().unwrap_or_default();
                f64::from(f32::from_le_bytes(bytes))
            };
            let corners = [12, 24, 36].map(|at| [number(at), number(at + 4), number(at + 8)]);
            let corners = corners.map(|corner| mesh.corner(corner));
            mesh.triangles.push(corners);
        }
        mesh
    }

    fn text_stl(text: &str) -> Result<Self, MeshError> {
        let mut mesh = Self::default();
        let mut facet = Vec::with_capacity(3);
        for (index, line) in text.lines().enumerate() {
            let mut words = line.split_whitespace();
            match words.next() {
                Some("vertex") => facet.push(mesh.corner(numbers(words, index + 1)?)),
                Some("endfacet") => {
                    let corners = <[u32; 3]>::try_from(std::mem::take(&mut facet));
                    mesh.triangles.push(corners.map_err(|corners| MeshError::Line {
                        line: index + 1,
                        cause: format!("a facet of {} corners", corners.len()),
                    })?);
                }
                // "solid", "facet normal", "outer loop" and their ends say nothing that corners do not
                _ => {}
            }
        }
        Ok(mesh)
    }

    fn obj(bytes: &[u8]) -> Result<Self, MeshError> {
        let text = String::from_utf8_lossy(bytes);
        let mut mesh = Self::default();
        for (index, line) in text.lines().enumerate() {
            let mut words = line.split_whitespace();
            match words.next() {
                Some("v") => mesh.corners.push(numbers(words, index + 1)?),
                Some("f") => mesh.face(words, index + 1)?,
                // normals, textures, materials and groups: only the form matters
                _ => {}
            }
        }
        Ok(mesh)
    }

    /// A face of any number of corners, as a fan of triangles.
    fn face<'w>(&mut self, words: impl Iterator<Item = &'w str>, line: usize) -> Result<(), MeshError> {
        let count = self.corners.len();
        let mut corners = Vec::new();
        for word in words {
            let number: i64 = word.split('/').next().and_then(|number| number.parse().ok()).unwrap_or_default();
            // from 1, or from the last one back
            let index =
                if number < 0 { count.checked_add_signed(number as isize) } else { (number as usize).checked_sub(1) };
            let index = index.filter(|index| *index < count);
            let index = index.ok_or_else(|| MeshError::Line { line, cause: format!("there is no corner `{word}`") })?;
            corners.push(index as u32);
        }
        if corners.len() < 3 {
            return Err(MeshError::Line { line, cause: format!("a face of {} corners", corners.len()) });
        }
        self.triangles.extend(corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]));
        Ok(())
    }
}

fn numbers<'w>(words: impl Iterator<Item = &'w str>, line: usize) -> Result<[f64; 3], MeshError> {
    let numbers: Vec<f64> = words.take(3).filter_map(|word| word.parse().ok()).collect();
    let cause = || MeshError::Line { line, cause: "a corner has three numbers".to_owned() };
    <[f64; 3]>::try_from(numbers).map_err(|_| cause())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1/1 2/2 4/3\nf -4 -1 -2\nf 2 3 4\n";

    fn text_of(mesh: &Mesh) -> String {
        let corner = |index: u32| mesh.corners[index as usize].map(|number| number.to_string()).join(" ");
        let facets = mesh.triangles.iter().map(|triangle| {
            let corners = triangle.map(|index| format!("vertex {}\n", corner(index))).concat();
            format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
        });
        format!("solid part\n{}endsolid part\n", facets.collect::<String>())
    }

    fn bytes_of(mesh: &Mesh) -> Vec<u8> {
        let mut bytes = b"solid, but binary".to_vec();
        bytes.resize(80, 0);
        bytes.extend((mesh.triangles.len() as u32).to_le_bytes());
        for triangle in &mesh.triangles {
            bytes.extend([0; 12]);
            for index in triangle {
                bytes.extend(mesh.corners[*index as usize].iter().flat_map(|number| (*number as f32).to_le_bytes()));
            }
            bytes.extend([0; 2]);
        }
        bytes
    }

    #[test]
    fn three_forms_of_one_body_are_equal() {
        let mesh = Mesh::obj(TETRAHEDRON.as_bytes()).unwrap();
        assert_eq!((mesh.corners.len(), mesh.triangles.len()), (4, 4));
        let place = |mesh: &Mesh| -> Vec<_> {
            mesh.triangles.iter().flatten().map(|index| mesh.corners[*index as usize]).collect()
        };
        for other in [Mesh::stl(text_of(&mesh).as_bytes()).unwrap(), Mesh::stl(&bytes_of(&mesh)).unwrap()] {
            assert_eq!((other.corners.len(), place(&other)), (4, place(&mesh)));
        }
    }

    #[test]
    fn what_is_no_mesh_is_reported() {
        let reported = |text: &str, read: fn(&[u8]) -> Result<Mesh, MeshError>| {
            read(text.as_bytes()).and_then(Mesh::checked).unwrap_err().to_string()
        };
        assert_eq!(reported("v 0 0\n", Mesh::obj), "line 1: a corner has three numbers");
        assert_eq!(reported("v 0 0 0\nf 1 1 2\n", Mesh::obj), "line 2: there is no corner `2`");
        assert_eq!(reported("v 0 0 0\nf 1 1\n", Mesh::obj), "line 2: a face of 2 corners");
        assert_eq!(reported("v 0 0 nan\nf 1 1 1\n", Mesh::obj), "has a corner that is not finite");
        assert_eq!(reported("", Mesh::obj), "has 0 triangles; from 1 to 200000 are of use");
        assert_eq!(reported("solid\nfacet\nvertex 0 0 0\nendfacet\n", Mesh::stl), "line 4: a facet of 1 corners");
        assert!(reported("rubbish", Mesh::stl).contains("which do not go together"));
        assert_eq!(Mesh::read(Path::new("part.step")), Err(MeshError::Kind));
    }
}
