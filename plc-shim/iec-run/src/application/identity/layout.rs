//! Which variables there are, of which types, and where they lie.
//!
//! Constants are not part of it: they are code. Nor is what no variable has, such as string literals and
//! temporary variables, which hold nothing between two scans.

use std::collections::BTreeMap;
use std::ops::Range;

use super::bytes::{Reader, Writer};
use super::{Digest, digest};
use onescan_iec::check::Checked;
use onescan_iec::ir::{self, PouId, Storage, Type, TypeId};
use onescan_iec::syntax::ast::{Edge, SectionKind};
use onescan_iec::syntax::direct_address::Area;

/// The variables of an application.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Layout {
    pub(super) roots: Vec<Member>,
    /// The types of variables and their parts; a type stands behind those that it is made of.
    pub(super) shapes: Vec<Shape>,
}

/// A variable, or a member of one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Member {
    pub(super) name: String,
    /// Position of its type among the shapes.
    pub(super) shape: u32,
    /// In bytes, from where what it is a member of begins.
    pub(super) offset: u32,
    /// Of a BOOL that shares its byte with others, which bit it is.
    pub(super) bit: Option<u8>,
}

/// A type as far as states depend on it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Shape {
    /// The type's name; of an enumeration with its values, of an array with its bounds.
    pub(super) name: String,
    pub(super) size: u32,
    pub(super) parts: Parts,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Parts {
    None,
    /// The position of an array's element type among the shapes.
    Elements(u32),
    Members(Vec<Member>),
}

impl Layout {
    /// The layout of a checked program whose instances of programs bear these names.
    pub(in crate::application) fn new<'n>(checked: &Checked, programs: impl Iterator<Item = &'n str>) -> Self {
        let mut builder = Builder { checked, layout: Self::default(), known: BTreeMap::new() };
        builder.areas();
        builder.variables("", 0, &checked.globals);
        let resources = checked.configuration.iter().flat_map(|configuration| &configuration.resources);
        for resource in resources {
            builder.variables(resource.name.as_deref().unwrap_or_default(), 0, &resource.globals);
        }
        for (program, name) in checked.programs.iter().zip(programs) {
            if let Some(ty) = checked.types.known_block(program.pou) {
                builder.root(name.to_owned(), ty, program.offset, None);
            }
        }
        for pou in checked.pous.values() {
            let of_all_calls = |variable: &&ir::Variable| variable.section == SectionKind::Static;
            builder.variables(&pou.name, 0, pou.variables.iter().filter(of_all_calls));
        }
        builder.layout
    }

    /// Equal for layouts whose names differ in case alone.
    pub(crate) fn digest(&self) -> Digest {
        let fold = |members: &mut Vec<Member>| members.iter_mut().for_each(|member| member.name.make_ascii_uppercase());
        let mut folded = self.clone();
        fold(&mut folded.roots);
        for shape in &mut folded.shapes {
            shape.name.make_ascii_uppercase();
            if let Parts::Members(members) = &mut shape.parts {
                fold(members);
            }
        }
        digest(&folded.encode())
    }

    pub(crate) fn encode(&self) -> Vec<u8> {
        let mut writer = Writer::default();
        writer.count(self.shapes.len());
        for Shape { name, size, parts } in &self.shapes {
            writer.text(name);
            writer.small_number(*size);
            match parts {
                Parts::None => writer.byte(0),
                Parts::Elements(element) => {
                    writer.byte(1);
                    writer.small_number(*element);
                }
                Parts::Members(members) => {
                    writer.byte(2);
                    encode_members(members, &mut writer);
                }
            }
        }
        encode_members(&self.roots, &mut writer);
        writer.finish()
    }

    /// Nothing unless the bytes are a layout.
    pub(crate) fn decode(bytes: &[u8]) -> Option<Self> {
        let mut reader = Reader::new(bytes);
        let mut at = 0;
        let shapes = reader.list(|reader| {
            let (name, size) = (reader.text()?, reader.small_number()?);
            let parts = match reader.byte()? {
                0 => Parts::None,
                // Only what came before, so that no type holds itself.
                1 => Parts::Elements(reader.small_number().filter(|element| *element < at)?),
                2 => Parts::Members(decode_members(reader, at)?),
                _ => return None,
            };
            at += 1;
            Some(Shape { name, size, parts })
        })?;
        let roots = decode_members(&mut reader, at)?;
        reader.is_at_end().then_some(Self { roots, shapes })
    }

    /// The bytes of memory that variables have, in ascending order.
    pub(crate) fn ranges(&self) -> Vec<Range<usize>> {
        let mut found = Vec::new();
        for root in &self.roots {
            self.add_ranges(root.shape, root.offset as usize, &mut found);
        }
        joined(found)
    }

    fn add_ranges(&self, shape: u32, base: usize, found: &mut Vec<Range<usize>>) {
        let Some(Shape { size, parts, .. }) = self.shapes.get(shape as usize) else { return };
        let size = *size as usize;
        match parts {
            Parts::None => found.push(base..base + size),
            Parts::Members(members) => {
                for member in members {
                    self.add_ranges(member.shape, base + member.offset as usize, found);
                }
            }
            Parts::Elements(element) => {
                let mut inside = Vec::new();
                self.add_ranges(*element, 0, &mut inside);
                let inside = joined(inside);
                let stride = self.shapes.get(*element as usize).map_or(0, |shape| shape.size as usize).max(1);
                if matches!(&inside[..], [range] if *range == (0..stride)) {
                    // Without a gap, so that a large array of numbers is one range.
                    found.push(base..base + size);
                    return;
                }
                for start in (base..base + size).step_by(stride) {
                    found.extend(inside.iter().map(|range| start + range.start..start + range.end));
                }
            }
        }
    }
}

fn joined(mut ranges: Vec<Range<usize>>) -> Vec<Range<usize>> {
    ranges.sort_by_key(|range| (range.start, range.end));
    let mut joined: Vec<Range<usize>> = Vec::new();
    for range in ranges {
        match joined.last_mut() {
            Some(last) if range.start <= last.end => last.end = last.end.max(range.end),
            _ => joined.push(range),
        }
    }
    debug_assert!(joined.windows(2).all(|pair| pair[0].end < pair[1].start), "ranges ascend with gaps between them");
    joined
}

fn encode_members(members: &[Member], writer: &mut Writer) {
    writer.count(members.len());
    for Member { name, shape, offset, bit } in members {
        writer.text(name);
        writer.small_number(*shape);
        writer.small_number(*offset);
        writer.byte(bit.map_or(u8::MAX, |bit| bit));
    }
}

/// Members whose types are among the first `known` shapes.
fn decode_members(reader: &mut Reader<'_>, known: u32) -> Option<Vec<Member>> {
    reader.list(|reader| {
        let name = reader.text()?;
        let shape = reader.small_number().filter(|shape| *shape < known)?;
        let (offset, bit) = (reader.small_number()?, reader.byte()?);
        Some(Member { name, shape, offset, bit: (bit != u8::MAX).then_some(bit) })
    })
}

struct Builder<'c> {
    checked: &'c Checked,
    layout: Layout,
    known: BTreeMap<TypeId, u32>,
}

impl<'c> Builder<'c> {
    /// The areas of direct addresses as a whole: not all of them need have a variable.
    fn areas(&mut self) {
        for area in Area::ALL {
            let range = self.checked.areas.range(area);
            if !range.is_empty() {
                let size = range.end - range.start;
                let shape = self.add(Shape { name: format!("{size} bytes"), size, parts: Parts::None });
                let name = format!("%{}", area.letter());
                self.layout.roots.push(Member { name, shape, offset: range.start, bit: None });
            }
        }
    }

    fn variables<'v>(&mut self, prefix: &str, base: u32, variables: impl IntoIterator<Item = &'v ir::Variable>) {
        for variable in variables {
            let (offset, bit) = match variable.storage {
                _ if variable.is_constant => continue,
                Storage::Absolute(offset) => (base + offset, None),
                Storage::Located(location) => (self.checked.areas.offset(location), location.bit),
                _ => continue,
            };
            let dot = if prefix.is_empty() { "" } else { "." };
            self.root(format!("{prefix}{dot}{}", variable.name), variable.ty, offset, bit);
        }
    }

    fn root(&mut self, name: String, ty: TypeId, offset: u32, bit: Option<u8>) {
        let shape = self.shape(ty);
        self.layout.roots.push(Member { name, shape, offset, bit });
    }

    fn add(&mut self, shape: Shape) -> u32 {
        let is_known = |part: u32| (part as usize) < self.layout.shapes.len();
        debug_assert!(
            match &shape.parts {
                Parts::None => true,
                Parts::Elements(element) => is_known(*element),
                Parts::Members(members) => members.iter().all(|member| is_known(member.shape)),
            },
            "a type stands behind those that it is made of"
        );
        self.layout.shapes.push(shape);
        self.layout.shapes.len() as u32 - 1
    }

    fn shape(&mut self, ty: TypeId) -> u32 {
        if let Some(known) = self.known.get(&ty) {
            return *known;
        }
        let checked: &'c Checked = self.checked;
        let types = &checked.types;
        let (mut name, size) = (types.name(ty), types.size(ty));
        let parts = match types.get(ty) {
            Type::Array { element, .. } => Parts::Elements(self.shape(*element)),
            Type::Struct { fields, .. } => {
                let member = |field: &ir::Field| {
                    let (name, shape) = (field.name.clone(), self.shape(field.ty));
                    Member { name, shape, offset: field.offset, bit: field.bit }
                };
                Parts::Members(fields.iter().map(member).collect())
            }
            Type::FunctionBlock { pou, .. } => Parts::Members(self.block_members(*pou)),
            Type::Enumeration { values, .. } => {
                let values: Vec<_> = values.iter().map(|(value, number)| format!("{value} := {number}")).collect();
                name = format!("{name} ({})", values.join(", "));
                Parts::None
            }
            _ => Parts::None,
        };
        let shape = self.add(Shape { name, size, parts });
        self.known.insert(ty, shape);
        shape
    }

    /// What an instance of a unit holds: its variables, what it remembers for them, and what its methods keep.
    fn block_members(&mut self, pou: PouId) -> Vec<Member> {
        let checked = self.checked;
        let own = checked.interfaces.get(&pou).into_iter().flatten();
        let mut members: Vec<Member> = own.flat_map(|variable| self.held(&variable.name, variable)).collect();
        for kept in checked.kept.get(&pou).into_iter().flatten() {
            for variable in &kept.variables {
                members.extend(self.held(&format!("{}.{}", kept.method, variable.name), variable));
            }
        }
        members
    }

    fn held(&mut self, name: &str, variable: &ir::Variable) -> Vec<Member> {
        let mut members = Vec::new();
        let mut add = |name: String, shape, offset| members.push(Member { name, shape, offset, bit: None });
        let udint = ir::ElementaryType::Udint;
        match variable.storage {
            Storage::Instance(offset) if !variable.is_constant => add(name.to_owned(), self.shape(variable.ty), offset),
            // The address that the last call gave.
            Storage::InstancePointer(offset) => {
                let of = self.checked.types.name(variable.ty);
                let (of, size) = (format!("VAR_IN_OUT {of}"), udint.size());
                add(name.to_owned(), self.add(Shape { name: of, size, parts: Parts::None }), offset);
            }
            // Others lie elsewhere or in no memory.
            _ => {}
        }
        if let Some(edge) = &variable.edge
            && let Storage::Instance(offset) = edge.memory
        {
            let word = match edge.edge {
                Edge::Rising => "R_EDGE",
                Edge::Falling => "F_EDGE",
            };
            add(format!("{name} {word}"), self.shape(ir::ElementaryType::Bool.into()), offset);
        }
        members
    }
}
