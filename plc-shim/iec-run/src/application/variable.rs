//! Programs and variables by name, for those outside.

use onescan_base::SignalType;
use thiserror::Error;

use super::Application;
use super::zero_terminated::ZeroTerminated;
use onescan_iec::check::{Checked, Kept};
use onescan_iec::diagnostic::did_you_mean;
use onescan_iec::ir::{self, ElementaryType, Location, Storage, Type, TypeId, TypeTable};
use onescan_iec::syntax::ast::SectionKind;
use onescan_iec::syntax::direct_address::DirectAddress;

/// A variable in the PLC's memory. A BOOL is one byte, 0 or 1; no other value may be written. One at a
/// bit address is that bit alone.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Variable {
    /// Its full name, as in `Shear.axis[2].position`.
    pub path: String,
    /// Where it begins in memory.
    pub offset: u32,
    /// Its size in bytes.
    pub size: u32,
    /// Of a BOOL that shares its byte with others, which bit it is.
    pub bit: Option<u8>,
    /// Its elementary type; nothing for structures, arrays, instances and strings, whose
    /// length stands in `type_name` (`STRING[80]`). A value of an
    /// enumeration or subrange is one of its base type.
    pub ty: Option<ElementaryType>,
    /// Of an array of elementary values, their type; they lie one behind the other, the last index fastest.
    pub element: Option<ElementaryType>,
    /// Its type as a session has it: also of strings, with their length. Nothing for what no signal can be.
    pub signal_type: Option<SignalType>,
    /// Set for a string that lies in memory otherwise than a signal has it.
    pub zero_terminated: Option<ZeroTerminated>,
    /// The name of its type.
    pub type_name: String,
    /// The direct address it is located at (`AT`), as written.
    pub address: Option<String>,
    /// Whether it may be written from outside.
    pub access: VariableAccess,
    /// Its type in the application it belongs to.
    pub(crate) type_id: TypeId,
}

/// What those outside may do with a variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VariableAccess {
    /// Read and write it.
    ReadWrite,
    /// Read it: `VAR_ACCESS` says so.
    ReadOnly,
    /// Read it: it is `CONSTANT`, and programs hold its value.
    Constant,
}

/// A program and its variables.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Program {
    pub name: String,
    /// True if another unit calls it: then it runs with that.
    pub is_called: bool,
    /// True for an organization block that the start calls: no task runs it.
    pub runs_at_start: bool,
    pub inputs: Vec<Variable>,
    pub outputs: Vec<Variable>,
    pub locals: Vec<Variable>,
}

/// A path that leads to no variable.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("there is no variable `{path}`{}", .help.as_ref().map(|help| format!(" ({help})")).unwrap_or_default())]
pub struct UnknownVariable {
    /// The path as it was given.
    pub path: String,
    pub help: Option<String>,
}

/// One piece of a path.
#[derive(Debug, Clone)]
pub(super) enum Piece {
    Name(String),
    /// A method, and a variable of its `VAR_INST`.
    Kept(String, String),
    Index(Vec<i64>),
}

/// A place on the way along a path.
#[derive(Debug, Clone)]
pub(super) struct Spot {
    pub(super) path: String,
    pub(super) offset: u32,
    pub(super) bit: Option<u8>,
    pub(super) ty: TypeId,
    pub(super) address: Option<String>,
    pub(super) access: VariableAccess,
}

impl Application {
    /// The programs in the order of their declaration; with a configuration, their instances.
    pub fn programs(&self) -> impl Iterator<Item = Program> {
        let checked = &self.inner.checked;
        checked.programs.iter().zip(self.entry_names()).filter_map(|(program, name)| {
            let pou = checked.pous.get(&program.pou)?;
            let of = |wanted: SectionKind| {
                let in_section = pou.variables.iter().filter(move |variable| variable.section == wanted);
                let found = in_section.filter_map(|each| spot(checked, name, each, program.offset));
                found.map(|spot| self.describe(spot)).collect()
            };
            Some(Program {
                name: name.to_owned(),
                is_called: program.is_called,
                runs_at_start: program.runs_at_start,
                inputs: of(SectionKind::Input),
                outputs: of(SectionKind::Output),
                locals: of(SectionKind::Local),
            })
        })
    }

    /// The variable at a path: a global variable or a program's instance, members and indices, as in
    /// `Shear.axis[2].position`; or at a direct address that the program uses, as in `%QX0.1`; or a part of a bit string, as in `P.status.%X3`. The names
    /// of configuration and resource may stand in front, as in `Plant.Line.Shear.axis[2].position`; a
    /// name of `VAR_ACCESS` is a path too. What a method keeps stands behind its name, as in
    /// `Shear.axis.Count.calls`.
    ///
    /// # Errors
    /// The path leads nowhere; the error has the nearest name.
    pub fn variable(&self, path: &str) -> Result<Variable, UnknownVariable> {
        let unknown = |help| UnknownVariable { path: path.to_owned(), help };
        if path.starts_with('%') {
            let spot = self.direct(path).ok_or_else(|| unknown(None))?;
            return Ok(self.describe(spot));
        }
        let pieces = pieces(path).ok_or_else(|| unknown(None))?;
        let (mut spot, rest) = self.root(&pieces).map_err(unknown)?;
        let mut rest = rest.iter();
        while let Some(piece) = rest.next() {
            spot = match (piece, rest.as_slice()) {
                (Piece::Name(method), [Piece::Name(name), ..]) if self.keeps(&spot, method) => {
                    rest.next();
                    self.step(&spot, &Piece::Kept(method.clone(), name.clone()))
                }
                _ => self.step(&spot, piece),
            }
            .map_err(unknown)?;
        }
        if self.is_program(spot.ty) {
            return Err(unknown(None));
        }
        Ok(self.describe(spot))
    }

    fn is_program(&self, ty: TypeId) -> bool {
        let checked = &self.inner.checked;
        matches!(checked.types.get(ty), Type::FunctionBlock { pou, .. } if checked.programs.iter().any(|each| each.pou == *pou))
    }

    /// What lies at a direct address; nothing if the program does not use that part of the area.
    pub(super) fn direct(&self, path: &str) -> Option<Spot> {
        let checked = &self.inner.checked;
        let address = DirectAddress::parse(path).ok()?;
        let (offset, bit) = address.place(checked.address_unit).ok()??;
        let location = Location { area: address.area, offset, bit };
        let ty = address.width.bit_string();
        let offset = checked.areas.has(location, ty.size()).then(|| checked.areas.offset(location))?;
        let (path, access) = (path.to_ascii_uppercase(), VariableAccess::ReadWrite);
        Some(Spot { address: Some(path.clone()), path, offset, bit, ty: ty.into(), access })
    }

    pub(super) fn step(&self, from: &Spot, piece: &Piece) -> Result<Spot, Option<String>> {
        let checked = &self.inner.checked;
        match (checked.types.get(from.ty), piece) {
            (Type::Struct { fields, .. }, Piece::Name(name)) => {
                let field = fields.iter().find(|field| field.name.eq_ignore_ascii_case(name));
                let field = field.ok_or_else(|| did_you_mean(name, fields.iter().map(|field| field.name.as_str())))?;
                let path = format!("{}.{}", from.path, field.name);
                let (offset, access) = (from.offset + field.offset, from.access);
                Ok(Spot { path, offset, bit: field.bit, ty: field.ty, address: None, access })
            }
            (Type::FunctionBlock { pou, .. }, Piece::Name(name)) => {
                let variables = checked.interfaces.get(pou).map_or(&[][..], Vec::as_slice);
                let found = member(checked, &from.path, variables, from.offset, name)?;
                let access = if from.access == VariableAccess::ReadWrite { found.access } else { from.access };
                Ok(Spot { access, ..found })
            }
            (Type::FunctionBlock { pou, .. }, Piece::Kept(method, name)) => {
                let kept =
                    kept(checked, *pou).iter().find(|kept| kept.method.eq_ignore_ascii_case(method)).ok_or(None)?;
                let prefix = format!("{}.{}", from.path, kept.method);
                let found = member(checked, &prefix, &kept.variables, from.offset, name)?;
                let access = if from.access == VariableAccess::ReadWrite { found.access } else { from.access };
                Ok(Spot { access, ..found })
            }
            (Type::Array { dimensions, element }, Piece::Index(indices)) => {
                let offset = self.element(dimensions, *element, indices).ok_or(None)?;
                let list: Vec<_> = indices.iter().map(i64::to_string).collect();
                let path = format!("{}[{}]", from.path, list.join(","));
                let (offset, access) = (from.offset + offset, from.access);
                Ok(Spot { path, offset, bit: None, ty: *element, address: None, access })
            }
            (_, Piece::Name(name)) => self.part_of(from, name).ok_or(None),
            _ => Err(None),
        }
    }

    /// True if the name is that of a method which keeps something in the instance, and of no variable.
    fn keeps(&self, instance: &Spot, method: &str) -> bool {
        let checked = &self.inner.checked;
        let Type::FunctionBlock { pou, .. } = checked.types.get(instance.ty) else { return false };
        let variables = checked.interfaces.get(pou).map_or(&[][..], Vec::as_slice);
        !variables.iter().any(|variable| variable.name.eq_ignore_ascii_case(method))
            && kept(checked, *pou).iter().any(|kept| kept.method.eq_ignore_ascii_case(method))
    }

    pub(super) fn elementary(&self, spot: &Spot) -> Option<ElementaryType> {
        self.inner.checked.types.elementary(spot.ty)
    }

    /// Offset of an array's element; nothing if it is outside.
    fn element(&self, dimensions: &[ir::Dimension], element: TypeId, indices: &[i64]) -> Option<u32> {
        if dimensions.len() != indices.len() {
            return None;
        }
        let mut number: u64 = 0;
        for (bounds, index) in dimensions.iter().zip(indices) {
            if !(bounds.low..=bounds.high).contains(index) {
                return None;
            }
            number = number * bounds.count() + (index - bounds.low) as u64;
        }
        Some(number as u32 * self.inner.checked.types.size(element))
    }

    pub(super) fn describe(&self, spot: Spot) -> Variable {
        let types = &self.inner.checked.types;
        Variable {
            path: spot.path,
            offset: spot.offset,
            size: types.size(spot.ty),
            bit: spot.bit,
            ty: types.elementary(spot.ty),
            element: element(types, spot.ty),
            signal_type: signal_type(types, spot.ty),
            zero_terminated: types.text(spot.ty).and_then(ZeroTerminated::of),
            type_name: types.name(spot.ty),
            address: spot.address,
            access: spot.access,
            type_id: spot.ty,
        }
    }
}

/// The type of the values of an array.
fn element(types: &TypeTable, ty: TypeId) -> Option<ElementaryType> {
    match types.get(ty) {
        Type::Array { element, .. } => types.elementary(*element),
        _ => None,
    }
}

/// Both sides hold a value in the same bytes, strings left out that end with a 0 ([`ZeroTerminated`]), so the type is
/// all that they must agree on.
fn signal_type(types: &TypeTable, ty: TypeId) -> Option<SignalType> {
    match types.get(ty) {
        // No signal holds so many characters as vendors' strings may.
        Type::Text(shape) => {
            let capacity = u16::try_from(shape.capacity).ok()?;
            if shape.wide { SignalType::wstring(capacity) } else { SignalType::string(capacity) }
        }
        _ => types.elementary(ty).map(SignalType::from),
    }
}

/// What the methods of a unit keep in its instances.
pub(super) fn kept(checked: &Checked, unit: ir::PouId) -> &[Kept] {
    checked.kept.get(&unit).map_or(&[], Vec::as_slice)
}

/// Where a variable of an instance at `base` lies, if it lies in memory for good.
pub(super) fn spot(checked: &Checked, prefix: &str, variable: &ir::Variable, base: u32) -> Option<Spot> {
    let (offset, bit) = match variable.storage {
        Storage::Absolute(offset) if variable.section != SectionKind::Temp => (offset, None),
        Storage::Located(location) => (checked.areas.offset(location), location.bit),
        Storage::Instance(offset) => (base + offset, None),
        _ => return None,
    };
    let dot = if prefix.is_empty() { "" } else { "." };
    let path = format!("{prefix}{dot}{}", variable.name);
    let access = if variable.is_constant { VariableAccess::Constant } else { VariableAccess::ReadWrite };
    Some(Spot { path, offset, bit, ty: variable.ty, address: variable.address.clone(), access })
}

fn member(
    checked: &Checked,
    prefix: &str,
    variables: &[ir::Variable],
    base: u32,
    name: &str,
) -> Result<Spot, Option<String>> {
    let found = variables.iter().find(|variable| variable.name.eq_ignore_ascii_case(name));
    found
        .and_then(|variable| spot(checked, prefix, variable, base))
        .ok_or_else(|| did_you_mean(name, variables.iter().map(|variable| variable.name.as_str())))
}

/// `a.b[1,2].c` in pieces; nothing if it is not of that form.
fn pieces(path: &str) -> Option<Vec<Piece>> {
    let mut pieces = Vec::new();
    for part in path.split('.') {
        let (name, mut rest) = part.split_at(part.find('[').unwrap_or(part.len()));
        if name.trim().is_empty() {
            return None;
        }
        pieces.push(Piece::Name(name.trim().to_owned()));
        while let Some(inside) = rest.trim().strip_prefix('[') {
            let (indices, tail) = inside.split_once(']')?;
            let indices = indices.split(',').map(|index| index.trim().parse().ok());
            pieces.push(Piece::Index(indices.collect::<Option<_>>()?));
            rest = tail;
        }
        if !rest.trim().is_empty() {
            return None;
        }
    }
    Some(pieces)
}
