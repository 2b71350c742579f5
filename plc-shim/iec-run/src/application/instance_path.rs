//! Strings that hold the path of the instance that they are in: `{attribute 'instance-path'}` of CODESYS and TwinCAT.
//!
//! They are written into the memory of a cold start, so that `FB_init` finds them. What stands before the path, the
//! name of a project or of a device and its application, is not known here and always the same.

use std::collections::{BTreeMap, BTreeSet};

use onescan_iec::check::Checked;
use onescan_iec::dialect::Dialect;
use onescan_iec::ir::{Storage, Type, TypeId, Variable};
use onescan_iec::syntax::pragma::behind_pragma;
use onescan_iec::syntax::{FileId, SourceMap, tokenize_in};

/// The attribute, as it is written.
const ATTRIBUTE: &str = "'instance-path'";
/// What stands before a path in TwinCAT: the project, as `_AppInfo.ProjectName` has it.
const PROJECT: &str = "onescan.";
/// What stands before a path in CODESYS: the device and its application.
const DEVICE: &str = "Device.Application.";

/// A path without what stands before it: the names by which a program's own variables are known.
pub fn without_home(path: &str) -> &str {
    [PROJECT, DEVICE].iter().find_map(|before| path.strip_prefix(before)).unwrap_or(path)
}

/// Writes the paths into the memory of a cold start.
pub(super) fn write(checked: &mut Checked, sources: &SourceMap) {
    let marked = marked(sources);
    if marked.is_empty() {
        return;
    }
    let mut finder = Finder { checked, marked: &marked, known: BTreeMap::new(), found: Vec::new() };
    finder.roots();
    let found = std::mem::take(&mut finder.found);
    for (offset, bytes) in found {
        let start = offset as usize;
        debug_assert!(start + bytes.len() <= checked.image.len(), "a variable lies within memory");
        if let Some(place) = checked.image.get_mut(start..start + bytes.len()) {
            place.copy_from_slice(&bytes);
        }
    }
}

/// Where the names stand that the attribute is before, with what stands before a path there.
fn marked(sources: &SourceMap) -> BTreeMap<(FileId, u32), &'static str> {
    let mut marked = BTreeMap::new();
    for (id, file) in sources.iter() {
        let (text, dialect) = (file.text(), file.dialect());
        let before = match dialect {
            Dialect::TwinCat => PROJECT,
            Dialect::Codesys => DEVICE,
            _ => continue,
        };
        if !text.contains(ATTRIBUTE) {
            continue;
        }
        let starts =
            behind_pragma(&tokenize_in(dialect, text), text, |pragma| pragma.contains(ATTRIBUTE).then_some(()));
        marked.extend(starts.into_iter().map(|(start, ())| ((id, start), before)));
    }
    marked
}

struct Finder<'c> {
    checked: &'c Checked,
    marked: &'c BTreeMap<(FileId, u32), &'static str>,
    /// Whether a type has such a string in it.
    known: BTreeMap<TypeId, bool>,
    /// Places in memory, and what belongs there.
    found: Vec<(u32, Vec<u8>)>,
}

impl Finder<'_> {
    fn roots(&mut self) {
        let checked = self.checked;
        self.variables("", &checked.globals, 0);
        for resource in checked.configuration.iter().flat_map(|configuration| &configuration.resources) {
            // A resource without a name adds none to the paths of its variables.
            self.variables(resource.name.as_deref().unwrap_or(""), &resource.globals, 0);
        }
        for (program, entry) in checked.programs.iter().zip(&checked.entries) {
            let variables = checked.interfaces.get(&program.pou).map_or(&[][..], Vec::as_slice);
            self.variables(&entry.name, variables, program.offset);
        }
    }

    fn variables(&mut self, path: &str, variables: &[Variable], base: u32) {
        for variable in variables {
            let offset = match variable.storage {
                Storage::Absolute(offset) => offset,
                Storage::Instance(offset) => base + offset,
                _ => continue,
            };
            self.text(path, variable, offset);
            if self.holds(variable.ty) {
                let dot = if path.is_empty() { "" } else { "." };
                self.part(&format!("{path}{dot}{}", variable.name), variable.ty, offset);
            }
        }
    }

    /// A string that the attribute stands before gets the path of what it is in.
    fn text(&mut self, path: &str, variable: &Variable, offset: u32) {
        let Some(before) = self.marked.get(&(variable.span.file, variable.span.start)) else { return };
        if let Some(shape) = self.checked.types.text(variable.ty) {
            let units: Vec<u16> = format!("{before}{path}").encode_utf16().collect();
            self.found.push((offset, shape.encode(&units)));
        }
    }

    fn part(&mut self, path: &str, ty: TypeId, offset: u32) {
        let types = &self.checked.types;
        match types.get(ty) {
            Type::FunctionBlock { pou, .. } => {
                let variables = self.checked.interfaces.get(pou).map_or(&[][..], Vec::as_slice);
                self.variables(path, variables, offset);
            }
            Type::Struct { fields, .. } => {
                for field in fields.iter().filter(|field| field.bit.is_none()) {
                    if self.holds(field.ty) {
                        self.part(&format!("{path}.{}", field.name), field.ty, offset + field.offset);
                    }
                }
            }
            Type::Array { dimensions, element } => {
                let stride = types.size(*element);
                let count: u64 = dimensions.iter().map(|bounds| bounds.count()).product();
                for at in 0..count {
                    let (mut rest, mut indices) = (at, Vec::with_capacity(dimensions.len()));
                    for bounds in dimensions.iter().rev() {
                        indices.push((bounds.low + (rest % bounds.count().max(1)) as i64).to_string());
                        rest /= bounds.count().max(1);
                    }
                    indices.reverse();
                    self.part(&format!("{path}[{}]", indices.join(",")), *element, offset + at as u32 * stride);
                }
            }
            _ => {}
        }
    }

    /// True if instances of the type have such a string.
    fn holds(&mut self, ty: TypeId) -> bool {
        if let Some(known) = self.known.get(&ty) {
            return *known;
        }
        let checked = self.checked;
        let holds = match checked.types.get(ty) {
            Type::FunctionBlock { pou, .. } => {
                let variables = checked.interfaces.get(pou).map_or(&[][..], Vec::as_slice);
                let is_marked =
                    |variable: &Variable| self.marked.contains_key(&(variable.span.file, variable.span.start));
                variables.iter().any(is_marked) || variables.iter().any(|variable| self.holds(variable.ty))
            }
            Type::Struct { fields, .. } => {
                let types: BTreeSet<TypeId> = fields.iter().map(|field| field.ty).collect();
                types.into_iter().any(|ty| self.holds(ty))
            }
            Type::Array { element, .. } => self.holds(*element),
            _ => false,
        };
        self.known.insert(ty, holds);
        holds
    }
}
