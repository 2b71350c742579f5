//! Data types with their size, alignment and initial image.

use std::collections::BTreeMap;
use std::sync::Arc;

use onescan_base::ElementaryType;

use super::pou::PouId;
use super::text::TextShape;
use crate::syntax::ast::ReferenceKind;
use crate::syntax::direct_address::Area;

/// Identifies a type within its [`TypeTable`]; equal ids are equal types.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TypeId(u32);

impl TypeId {
    /// Its place in the table, which distinguishes types while a program runs.
    pub(crate) fn number(self) -> u32 {
        self.0
    }
}

impl From<ElementaryType> for TypeId {
    fn from(ty: ElementaryType) -> Self {
        // The table begins with the elementary types in their order.
        Self(ty as u32)
    }
}

#[derive(Debug, Clone)]
pub enum Type {
    Elementary(ElementaryType),
    /// What a function without a result gives.
    Nothing,
    /// What NULL is: a value of every reference.
    Null,
    /// The address of something, 0 for NULL.
    Reference {
        kind: ReferenceKind,
        target: TypeId,
    },
    /// What ADR gives: an address that any pointer takes.
    Address {
        target: TypeId,
    },
    /// Some values of an integer type. Values of it are of that type; places check them.
    Subrange {
        base: ElementaryType,
        low: i128,
        high: i128,
    },
    /// A string and what it may hold.
    Text(TextShape),
    Enumeration {
        name: String,
        base: ElementaryType,
        values: Vec<(String, i128)>,
        /// The declaration says the base type: its other values are of the type as well (3rd ed. 6.4.4.3).
        has_base: bool,
        /// The text of a value is its name (`{attribute 'to_string'}`).
        shows_names: bool,
        /// It takes its own values only, and nothing is reckoned with them (`{attribute 'strict'}`).
        is_strict: bool,
    },
    Array {
        dimensions: Vec<Dimension>,
        element: TypeId,
    },
    /// An array whose bounds come with it (3rd ed. 6.5.3): what lies in memory is its address, then
    /// the lower and upper bound of each dimension as DINT.
    OpenArray {
        dimensions: u32,
        element: TypeId,
    },
    Struct {
        name: String,
        fields: Vec<Field>,
    },
    /// An instance of a function block or class.
    FunctionBlock {
        name: String,
        pou: PouId,
    },
    /// The address of an instance that implements the interface, or 0.
    Interface {
        name: String,
        pou: PouId,
    },
}

impl Type {
    /// What the elements of an array are, and how many there are in all its dimensions; nothing of another type.
    pub fn elements(&self) -> Option<(TypeId, u64)> {
        let Self::Array { dimensions, element } = self else { return None };
        let counts = dimensions.iter().map(|dimension| dimension.count());
        Some((*element, counts.fold(1, u64::saturating_mul)))
    }
}

/// Bounds of one dimension of an array, both within 32 bits signed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Dimension {
    pub low: i64,
    pub high: i64,
}

impl Dimension {
    /// How many elements the dimension has; none if its bounds are the wrong way round.
    pub fn count(self) -> u64 {
        (self.high - self.low + 1).max(0) as u64
    }
}

/// A member of a structure.
#[derive(Debug, Clone)]
pub struct Field {
    pub name: String,
    pub ty: TypeId,
    pub offset: u32,
    /// Of a BOOL that is one bit of its byte, which.
    pub bit: Option<u8>,
    /// The area of an open address, as in `AT %I*`, which `VAR_CONFIG` may complete.
    pub open: Option<Area>,
}

#[derive(Debug, Clone)]
struct Entry {
    ty: Type,
    size: u32,
    align: u32,
    image: Arc<[u8]>,
    /// Of a structure: which of its members has a name, in capitals.
    members: BTreeMap<String, usize>,
}

/// All types of an application.
#[derive(Debug, Clone)]
pub struct TypeTable {
    entries: Vec<Entry>,
    arrays: BTreeMap<(TypeId, Vec<Dimension>), TypeId>,
    open_arrays: BTreeMap<(TypeId, u32), TypeId>,
    blocks: BTreeMap<PouId, TypeId>,
    texts: BTreeMap<TextShape, TypeId>,
    subranges: BTreeMap<(ElementaryType, i128, i128), TypeId>,
    /// By kind, none for addresses.
    references: BTreeMap<(Option<ReferenceKind>, TypeId), TypeId>,
}

/// Bytes of one dimension's bounds in the description of an array.
pub const OPEN_BOUNDS: u32 = 8;

/// References are offsets in memory.
const REFERENCE: ElementaryType = ElementaryType::Udint;

impl TypeTable {
    /// The elementary types.
    #[expect(clippy::new_without_default, reason = "a table without types of its own is nobody's default")]
    pub fn new() -> Self {
        let members = BTreeMap::new;
        let entry = |ty: ElementaryType| Entry {
            ty: Type::Elementary(ty),
            size: ty.size(),
            align: ty.size(),
            image: vec![0; ty.size() as usize].into(),
            members: members(),
        };
        let mut entries: Vec<_> = ElementaryType::ALL.iter().map(|ty| entry(*ty)).collect();
        entries.push(Entry { ty: Type::Nothing, size: 0, align: 1, image: Arc::from([]), members: members() });
        entries.push(Entry { ty: Type::Null, ..entry(REFERENCE) });
        Self {
            entries,
            arrays: BTreeMap::new(),
            open_arrays: BTreeMap::new(),
            blocks: BTreeMap::new(),
            texts: BTreeMap::new(),
            subranges: BTreeMap::new(),
            references: BTreeMap::new(),
        }
    }

    /// The type of a function call without a result.
    pub fn nothing() -> TypeId {
        TypeId(ElementaryType::ALL.len() as u32)
    }

    /// The type of NULL.
    pub fn null() -> TypeId {
        TypeId(ElementaryType::ALL.len() as u32 + 1)
    }

    /// The type of references of a kind, or of addresses.
    pub fn reference(&mut self, kind: Option<ReferenceKind>, target: TypeId) -> TypeId {
        if let Some(found) = self.references.get(&(kind, target)) {
            return *found;
        }
        let ty = kind.map_or(Type::Address { target }, |kind| Type::Reference { kind, target });
        let id = self.add(ty, REFERENCE.size(), REFERENCE.size(), Arc::from([0; 4]));
        self.references.insert((kind, target), id);
        id
    }

    fn add(&mut self, ty: Type, size: u32, align: u32, image: Arc<[u8]>) -> TypeId {
        self.entries.push(Entry { ty, size, align, image, members: BTreeMap::new() });
        TypeId(self.entries.len() as u32 - 1)
    }

    fn entry(&self, id: TypeId) -> &Entry {
        // Ids are made by this table only, and entries are never removed.
        &self.entries[id.0 as usize]
    }

    /// What a type is.
    pub fn get(&self, id: TypeId) -> &Type {
        &self.entry(id).ty
    }

    /// The size of a value, in bytes; 0 until a structure or block is complete.
    pub fn size(&self, id: TypeId) -> u32 {
        self.entry(id).size
    }

    /// The alignment of a value, in bytes.
    pub fn align(&self, id: TypeId) -> u32 {
        self.entry(id).align
    }

    /// The bytes of a new variable of the type.
    pub fn image(&self, id: TypeId) -> &Arc<[u8]> {
        &self.entry(id).image
    }

    /// The elementary type that holds the value; nothing for aggregates.
    pub fn elementary(&self, id: TypeId) -> Option<ElementaryType> {
        match self.get(id) {
            Type::Elementary(ty) | Type::Enumeration { base: ty, .. } | Type::Subrange { base: ty, .. } => Some(*ty),
            Type::Interface { .. } => Some(ElementaryType::Udint),
            Type::Reference { .. } | Type::Address { .. } | Type::Null => Some(REFERENCE),
            _ => None,
        }
    }

    /// The shape of a string type; nothing for all others.
    pub fn text(&self, id: TypeId) -> Option<TextShape> {
        match self.get(id) {
            Type::Text(shape) => Some(*shape),
            _ => None,
        }
    }

    /// The type that a value from a place of type `id` has.
    pub fn of_value(&self, id: TypeId) -> TypeId {
        match self.get(id) {
            Type::Subrange { base, .. } => (*base).into(),
            _ => id,
        }
    }

    /// The subrange type. A variable begins with the lowest value (2nd ed. Table 13).
    pub fn subrange(&mut self, base: ElementaryType, low: i128, high: i128) -> TypeId {
        if let Some(found) = self.subranges.get(&(base, low, high)) {
            return *found;
        }
        let image = super::Value::Int(low).bytes()[..base.size() as usize].into();
        let id = self.add(Type::Subrange { base, low, high }, base.size(), base.size(), image);
        self.subranges.insert((base, low, high), id);
        id
    }

    /// The string type. A count may stand at any address, so that strings lie close in arrays.
    pub fn string(&mut self, shape: TextShape) -> TypeId {
        if let Some(found) = self.texts.get(&shape) {
            return *found;
        }
        let image = vec![0; shape.size() as usize];
        let id = self.add(Type::Text(shape), shape.size(), shape.unit(), image.into());
        self.texts.insert(shape, id);
        id
    }

    /// An enumeration; without a base type in its declaration, of INT.
    pub fn enumeration(
        &mut self,
        name: String,
        base: Option<ElementaryType>,
        values: Vec<(String, i128)>,
        (shows_names, is_strict): (bool, bool),
    ) -> TypeId {
        let (base, has_base) = (base.unwrap_or(ElementaryType::Int), base.is_some());
        // A variable begins with the first value (2nd ed. Table 13).
        let first = values.first().map_or(0, |(_, value)| *value);
        let image = super::Value::Int(first).bytes()[..base.size() as usize].into();
        self.add(
            Type::Enumeration { name, base, values, has_base, shows_names, is_strict },
            base.size(),
            base.size(),
            image,
        )
    }

    /// The array type; `size` is that of the whole array.
    pub fn array(&mut self, dimensions: Vec<Dimension>, element: TypeId, size: u32) -> TypeId {
        let key = (element, dimensions.clone());
        if let Some(found) = self.arrays.get(&key) {
            return *found;
        }
        let image = self.image(element).repeat((size / self.size(element).max(1)) as usize);
        let align = self.align(element);
        let id = self.add(Type::Array { dimensions, element }, size, align, image.into());
        self.arrays.insert(key, id);
        id
    }

    /// The type of an array without bounds of its own; `size` is that of the description.
    pub fn open_array(&mut self, dimensions: u32, element: TypeId) -> TypeId {
        if let Some(found) = self.open_arrays.get(&(element, dimensions)) {
            return *found;
        }
        let size = REFERENCE.size() + dimensions * OPEN_BOUNDS;
        let ty = Type::OpenArray { dimensions, element };
        let id = self.add(ty, size, REFERENCE.size(), vec![0; size as usize].into());
        self.open_arrays.insert((element, dimensions), id);
        id
    }

    /// A structure that [`Self::complete_structure`] gives its members: they may refer to it.
    pub fn structure(&mut self, name: String) -> TypeId {
        self.add(Type::Struct { name, fields: Vec::new() }, 0, 1, Arc::from([]))
    }

    /// The alignment of a structure of these members, whose own ones are at most `packing` bytes.
    pub fn structure_align(&self, members: &[Field], packing: Option<u32>) -> u32 {
        members.iter().map(|field| self.packed_align(field.ty, packing)).max().unwrap_or(1)
    }

    /// The alignment of a member of this type.
    pub fn packed_align(&self, id: TypeId, packing: Option<u32>) -> u32 {
        let own = self.align(id);
        packing.map_or(own, |packing| packing.min(own))
    }

    /// Gives a structure that was only named its members, its alignment and its initial image.
    pub fn complete_structure(&mut self, id: TypeId, members: Vec<Field>, align: u32, image: Arc<[u8]>) {
        if let Some(entry) = self.entries.get_mut(id.0 as usize) {
            for (at, field) in members.iter().enumerate() {
                entry.members.entry(field.name.to_ascii_uppercase()).or_insert(at);
            }
            if let Type::Struct { fields, .. } = &mut entry.ty {
                *fields = members;
            }
            entry.size = image.len() as u32;
            entry.align = align;
            entry.image = image;
        }
    }

    /// The type of a function block's instances; [`Self::complete_block`] gives it its size.
    pub fn block(&mut self, name: &str, pou: PouId) -> TypeId {
        if let Some(found) = self.blocks.get(&pou) {
            return *found;
        }
        let ty = Type::FunctionBlock { name: name.to_owned(), pou };
        let id = self.add(ty, 0, 1, Arc::from([]));
        self.blocks.insert(pou, id);
        id
    }

    /// The type of variables that refer to what implements an interface (3rd ed. 6.6.6).
    pub fn interface(&mut self, name: &str, pou: PouId) -> TypeId {
        if let Some(found) = self.blocks.get(&pou) {
            return *found;
        }
        let size = ElementaryType::Udint.size();
        let ty = Type::Interface { name: name.to_owned(), pou };
        let id = self.add(ty, size, size, vec![0; size as usize].into());
        self.blocks.insert(pou, id);
        id
    }

    /// The type of a unit's instances, if there are any.
    pub fn known_block(&self, pou: PouId) -> Option<TypeId> {
        self.blocks.get(&pou).copied()
    }

    /// Gives a block that was only named its alignment and its initial image.
    pub fn complete_block(&mut self, id: TypeId, align: u32, image: Arc<[u8]>) {
        if let Some(entry) = self.entries.get_mut(id.0 as usize) {
            entry.size = image.len() as u32;
            entry.align = align;
            entry.image = image;
        }
    }

    /// The member of a structure that is called so; names are compared without regard to case.
    pub fn field(&self, id: TypeId, name: &str) -> Option<&Field> {
        let Entry { ty: Type::Struct { fields, .. }, members, .. } = self.entry(id) else { return None };
        fields.get(*members.get(&name.to_ascii_uppercase())?)
    }

    /// The type's name as a user would write it.
    pub fn name(&self, id: TypeId) -> String {
        match self.get(id) {
            Type::Elementary(ty) => ty.name().to_owned(),
            Type::Nothing => "nothing".to_owned(),
            Type::Null => "NULL".to_owned(),
            Type::Reference { kind, target } => format!("{} {}", kind.text(), self.name(*target)),
            Type::Address { target } => format!("the address of {}", self.name(*target)),
            Type::Subrange { base, low, high } => format!("{base} ({low}..{high})"),
            Type::Text(shape) => format!("{}[{}]", shape.keyword(), shape.capacity),
            Type::Enumeration { name, .. }
            | Type::Struct { name, .. }
            | Type::FunctionBlock { name, .. }
            | Type::Interface { name, .. } => name.clone(),
            Type::OpenArray { dimensions, element } => {
                let stars = vec!["*"; *dimensions as usize].join(", ");
                format!("ARRAY [{stars}] OF {}", self.name(*element))
            }
            Type::Array { dimensions, element } => {
                let bounds: Vec<_> = dimensions.iter().map(|each| format!("{}..{}", each.low, each.high)).collect();
                format!("ARRAY [{}] OF {}", bounds.join(", "), self.name(*element))
            }
        }
    }
}
