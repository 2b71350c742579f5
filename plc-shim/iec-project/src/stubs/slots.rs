//! The types that are not known yet, and what was wanted of them.

use std::collections::BTreeMap;

use super::hint;
use super::ty::{Slot, Ty};
use onescan_iec::ElementaryType;
use onescan_iec::syntax::ast::ReferenceKind;

/// What is known of a slot.
#[derive(Debug, Default)]
struct Evidence {
    /// The last part of its path, which may show its type.
    name: String,
    /// How an anonymous type of it is called.
    path: String,
    /// What goes into it.
    from: Vec<Ty>,
    /// Where it goes to.
    to: Vec<Ty>,
    /// What it stands beside in a comparison or an operation.
    beside: Vec<Ty>,
    /// Members of it are used, or it is called.
    has_parts: bool,
    /// It is what a call or a property of an interface gives, and so no place of its own.
    is_value: bool,
    /// What has been decided stands, whatever else is found.
    is_settled: bool,
    decided: Option<Ty>,
}

impl Evidence {
    fn all(&self) -> impl Iterator<Item = &Ty> {
        self.from.iter().chain(&self.to).chain(&self.beside)
    }
}

/// The bounds of an array of which only elements are known.
pub(super) const ANY_BOUNDS: &str = "0..255";
/// Of an array that has those of what a caller gives.
pub(super) const OPEN_BOUNDS: &str = "*";

/// All slots, by their paths.
#[derive(Debug, Default)]
pub(super) struct Slots {
    keys: BTreeMap<String, usize>,
    all: Vec<Evidence>,
}

impl Slots {
    /// The slot of a path as written, as in `FB_X.member`.
    pub(super) fn of(&mut self, path: &str) -> Slot {
        let key = path.to_ascii_uppercase();
        if let Some(found) = self.keys.get(&key) {
            return Slot(*found);
        }
        let name = path.rsplit(['.', ':']).find(|part| !part.is_empty()).unwrap_or(path).to_owned();
        self.all.push(Evidence { name, path: path.to_owned(), ..Evidence::default() });
        self.keys.insert(key, self.all.len() - 1);
        Slot(self.all.len() - 1)
    }

    /// The slot of a path, if there has been one.
    pub(super) fn known(&self, path: &str) -> Option<Slot> {
        self.keys.get(&path.to_ascii_uppercase()).map(|index| Slot(*index))
    }

    /// What a slot refers to, or its elements.
    pub(super) fn below(&mut self, slot: Slot, mark: &str) -> Slot {
        let path = self.all.get(slot.0).map(|each| each.path.clone()).unwrap_or_default();
        self.of(&format!("{path}{mark}"))
    }

    fn at(&mut self, slot: Slot) -> &mut Evidence {
        // Slots are made by `of` only.
        &mut self.all[slot.0]
    }

    /// Forgets what was wanted, and keeps what has been decided.
    pub(super) fn begin_pass(&mut self) {
        for each in &mut self.all {
            each.from.clear();
            each.to.clear();
            each.beside.clear();
            each.has_parts = false;
        }
    }

    pub(super) fn decided(&self, slot: Slot) -> Option<&Ty> {
        self.all.get(slot.0).and_then(|each| each.decided.as_ref())
    }

    /// The type as far as it is decided.
    pub(super) fn resolved(&self, ty: &Ty) -> Ty {
        match ty {
            Ty::Slot(slot) => self.decided(*slot).cloned().unwrap_or_else(|| ty.clone()),
            _ => ty.clone(),
        }
    }

    pub(super) fn use_parts(&mut self, slot: Slot) {
        self.at(slot).has_parts = true;
    }

    pub(super) fn make_value(&mut self, slot: Slot) {
        self.at(slot).is_value = true;
    }

    pub(super) fn is_touched(&self, slot: Slot) -> bool {
        self.all.get(slot.0).is_some_and(|each| {
            each.has_parts || !each.from.is_empty() || !each.to.is_empty() || !each.beside.is_empty()
        })
    }

    pub(super) fn given(&mut self, slot: Slot, from: &Ty) {
        push(&mut self.at(slot).from, from, slot);
    }

    pub(super) fn taken(&mut self, slot: Slot, to: &Ty) {
        push(&mut self.at(slot).to, to, slot);
    }

    pub(super) fn beside(&mut self, slot: Slot, other: &Ty) {
        push(&mut self.at(slot).beside, other, slot);
    }

    /// Decides what the evidence decides; true if that is more than before.
    pub(super) fn decide(&mut self) -> bool {
        let mut changed = false;
        for index in 0..self.all.len() {
            let Some(found) = self.choice(Slot(index)) else { continue };
            let each = self.at(Slot(index));
            if each.decided.as_ref() != Some(&found) {
                changed = true;
                each.decided = Some(found);
            }
        }
        changed
    }

    fn choice(&self, slot: Slot) -> Option<Ty> {
        let each = self.all.get(slot.0)?;
        if each.is_settled {
            return each.decided.clone();
        }
        let resolved = |list: &[Ty]| -> Vec<Ty> { list.iter().map(|ty| self.resolved(ty)).collect() };
        let (from, to, beside) = (resolved(&each.from), resolved(&each.to), resolved(&each.beside));
        if from.iter().any(|ty| *ty == Ty::Any || ty.is_nameless()) {
            return Some(Ty::Any);
        }
        let in_order = || to.iter().chain(&from).chain(&beside);
        let named = |ty: &&Ty| matches!(ty, Ty::Declared(_) | Ty::Foreign(_));
        // What is indexed is not an instance, whatever it is given.
        let is_indexed = in_order().any(|ty| matches!(ty, Ty::Array(..)));
        if let Some(found) = in_order().find(named).filter(|_| !is_indexed) {
            return Some(found.clone());
        }
        if each.has_parts {
            // What has been called anonymous stays so.
            return each.decided.clone().filter(|ty| matches!(ty, Ty::Foreign(_)));
        }
        let kept = each.decided.clone().filter(|ty| matches!(ty, Ty::Foreign(_)));
        if kept.is_some() {
            return kept;
        }
        // An address, which is given as a pointer here and as a number there.
        let is_pointer = |ty: &Ty| matches!(ty, Ty::Pointer(..));
        let is_number = |ty: &Ty| matches!(ty, Ty::Elementary(found) if found.is_integer() || found.is_bits() && *found != ElementaryType::Bool);
        if from.iter().any(is_pointer) && from.iter().any(is_number) {
            return Some(Ty::Elementary(ElementaryType::Lword));
        }
        // A reference to it is made here, and a value goes into it there: it is not a reference itself.
        let is_value = |ty: &Ty| matches!(ty, Ty::Elementary(_) | Ty::Integer | Ty::Wide(_) | Ty::Real | Ty::Text(_));
        let referred = to.iter().find_map(|ty| match ty {
            Ty::Pointer(ReferenceKind::Reference, inner) if matches!(**inner, Ty::Elementary(_)) => Some(&**inner),
            _ => None,
        });
        if let Some(inner) = referred.filter(|_| from.iter().any(is_value)) {
            return Some(inner.clone());
        }
        let built = |ty: &&Ty| matches!(ty, Ty::Array(..) | Ty::Pointer(..));
        // One that a declaration shows takes precedence over one that is only indexed or followed.
        let reported = |ty: &&Ty| match ty {
            Ty::Array(bounds, _) => bounds.iter().any(|each| each != ANY_BOUNDS && each != OPEN_BOUNDS),
            Ty::Pointer(_, inner) => !matches!(**inner, Ty::Slot(_)),
            _ => false,
        };
        if let Some(found) = in_order().find(reported).or_else(|| in_order().find(built)) {
            return Some(found.clone());
        }
        if let Some(Ty::Text(_)) = in_order().find(|ty| matches!(ty, Ty::Text(_))) {
            return Some(Ty::Text(in_order().any(|ty| *ty == Ty::Text(true))));
        }
        let elementary = |list: &[Ty]| -> Vec<ElementaryType> {
            list.iter().filter_map(|ty| if let Ty::Elementary(found) = ty { Some(*found) } else { None }).collect()
        };
        elementary_of(&elementary(&from), &elementary(&to), &elementary(&beside)).map(Ty::Elementary)
    }

    /// What is written where the evidence decides nothing more: what literals and the names say, its own and those of
    /// what is linked with it.
    pub(super) fn last_choice(&self, slot: Slot) -> Ty {
        if let Some(decided) = self.decided(slot) {
            return decided.clone();
        }
        let linked = self.linked(slot);
        let has = |wanted: &Ty| linked.iter().any(|each| each.all().any(|ty| ty == wanted));
        // The same one for all of them, wherever the question begins.
        let clearest = linked.iter().map(|each| each.name.as_str()).filter(|name| hint::shows_type(name)).min();
        // A slot of another table has no evidence, so no name either: nothing hints at its type.
        let clearest = clearest.or(linked.first().map(|each| each.name.as_str())).unwrap_or_default();
        if has(&Ty::Real) {
            return Ty::Elementary(hint::real(clearest));
        }
        let wide = linked.iter().flat_map(|each| each.all()).filter_map(|ty| match ty {
            Ty::Wide(found) => Some(*found),
            _ => None,
        });
        let wide = wide.max_by_key(|ty| (ty.size(), ty.is_signed()));
        if has(&Ty::Integer) || wide.is_some() {
            return match (hint::integer(clearest), wide) {
                (Ty::Elementary(named), Some(wide)) if named.size() <= wide.size() && !named.is_bits() => {
                    Ty::Elementary(wide)
                }
                (named, _) => named,
            };
        }
        hint::of_name(clearest)
    }

    /// What is known of a slot and of all undecided ones that it is linked with, itself first.
    fn linked(&self, slot: Slot) -> Vec<&Evidence> {
        let mut found = Vec::new();
        let mut seen = std::collections::BTreeSet::new();
        let mut open = std::collections::VecDeque::from([slot]);
        while let Some(next) = open.pop_front() {
            let Some(each) = self.all.get(next.0).filter(|each| each.decided.is_none()) else { continue };
            if seen.insert(next) {
                found.push(each);
                open.extend(each.all().filter_map(|ty| if let Ty::Slot(slot) = ty { Some(*slot) } else { None }));
            }
        }
        found
    }

    /// Everything that a slot is known to meet.
    pub(super) fn evidence(&self, slot: Slot) -> impl Iterator<Item = Ty> + '_ {
        self.all.get(slot.0).into_iter().flat_map(|each| each.all().map(|ty| self.resolved(ty)))
    }

    /// What a parameter is that takes arrays of several lengths.
    pub(super) fn array_of_any_length(&self, parameter: impl Iterator<Item = Slot>) -> Option<Ty> {
        let given = parameter.filter_map(|slot| self.all.get(slot.0)).flat_map(|each| &each.from);
        let arrays: Vec<(Vec<String>, Box<Ty>)> = given
            .filter_map(|ty| match self.resolved(ty) {
                Ty::Array(bounds, element) if !matches!(*element, Ty::Slot(_)) => Some((bounds, element)),
                _ => None,
            })
            .collect();
        let ((first, element), rest) = arrays.split_first()?;
        let is_open = arrays.iter().any(|(bounds, _)| bounds.iter().any(|each| each == OPEN_BOUNDS));
        // Bounds that say nothing in the file of stubs are those of a length of its own.
        let is_unknown = first.iter().any(|each| each == ANY_BOUNDS);
        let differ = is_open || is_unknown || rest.iter().any(|(bounds, _)| bounds != first);
        let alike = rest.iter().all(|(bounds, other)| bounds.len() == first.len() && other == element);
        (differ && alike).then(|| Ty::Array(vec![OPEN_BOUNDS.to_owned(); first.len()], element.clone()))
    }

    /// The plain types that are given for a parameter, if none of them takes all.
    pub(super) fn types_given(&self, parameter: impl Iterator<Item = Slot>) -> Vec<ElementaryType> {
        let given = parameter.filter_map(|slot| self.all.get(slot.0)).flat_map(|each| &each.from);
        let plain =
            given.filter_map(|ty| if let Ty::Elementary(found) = self.resolved(ty) { Some(found) } else { None });
        let mut types: Vec<ElementaryType> = Vec::new();
        for ty in plain {
            if !types.contains(&ty) {
                types.push(ty);
            }
        }
        let takes_all = |one: &ElementaryType| types.iter().all(|other| other == one || other.widens_to(*one));
        if types.iter().any(takes_all) { Vec::new() } else { types }
    }

    /// True if what is given for a parameter has no type in common.
    pub(super) fn is_mixed(&self, slot: Slot) -> bool {
        let Some(each) = self.all.get(slot.0) else { return false };
        let resolved: Vec<Ty> = each.from.iter().map(|ty| self.resolved(ty)).collect();
        let has = |test: fn(ElementaryType) -> bool| {
            resolved.iter().any(|ty| matches!(ty, Ty::Elementary(found) if test(*found)))
        };
        if has(ElementaryType::is_real) && has(ElementaryType::is_bits) {
            return true;
        }
        let mut groups: Vec<String> = resolved.iter().filter_map(group).collect();
        groups.sort();
        groups.dedup();
        groups.len() > 1
    }

    /// Slots whose members are used and whose types nothing decides, each with its path, and whether it is a value;
    /// those that are linked are listed together.
    pub(super) fn anonymous(&self) -> Vec<Vec<(Slot, String, bool)>> {
        let mut done = std::collections::BTreeSet::new();
        let mut found = Vec::new();
        for (index, each) in self.all.iter().enumerate() {
            if !each.has_parts || each.decided.is_some() || done.contains(&index) {
                continue;
            }
            let mut group = Vec::new();
            let mut open = vec![index];
            while let Some(next) = open.pop() {
                if !done.insert(next) {
                    continue;
                }
                let Some(data) = self.all.get(next) else { continue };
                group.push((Slot(next), data.path.clone(), data.is_value));
                let links = data.from.iter().chain(&data.to).chain(&data.beside);
                open.extend(links.filter_map(|ty| match ty {
                    Ty::Slot(slot) if self.decided(*slot).is_none() => Some(slot.0),
                    _ => None,
                }));
            }
            found.push(group);
        }
        found
    }

    pub(super) fn set(&mut self, slot: Slot, ty: Ty) {
        self.at(slot).decided = Some(ty);
    }

    pub(super) fn path(&self, slot: Slot) -> String {
        self.all.get(slot.0).map(|each| each.path.clone()).unwrap_or_default()
    }

    /// What has been decided as a type that has become another.
    pub(super) fn rename(&mut self, gone: &str, kept: &str) {
        for each in &mut self.all {
            if matches!(&each.decided, Some(Ty::Foreign(key)) if key == gone) {
                each.decided = Some(Ty::Foreign(kept.to_owned()));
            }
        }
    }

    /// Decides a slot for good.
    pub(super) fn settle(&mut self, slot: Slot, ty: Ty) {
        self.at(slot).decided = Some(ty);
        self.at(slot).is_settled = true;
    }

    /// What has not been decided for good: each slot with its path, what goes into it and where it goes to.
    pub(super) fn unsettled(&self) -> impl Iterator<Item = (Slot, &str, Vec<Ty>, Vec<Ty>)> {
        let open = self.all.iter().enumerate().filter(|(_, each)| !each.is_settled);
        let resolved = |list: &[Ty]| list.iter().map(|ty| self.resolved(ty)).collect();
        open.map(move |(index, each)| (Slot(index), each.path.as_str(), resolved(&each.from), resolved(&each.to)))
    }

    /// The type of a constant: the narrowest of all that it meets, so that it fits each.
    pub(super) fn narrowest(&self, slot: Slot) -> ElementaryType {
        let met: Vec<ElementaryType> = self
            .evidence(slot)
            .filter_map(|ty| if let Ty::Elementary(found) = ty { Some(found) } else { None })
            .filter(|ty| ty.is_integer() || ty.is_bits() && *ty != ElementaryType::Bool)
            .collect();
        let Some(size) = met.iter().map(|ty| ty.size()).min() else { return ElementaryType::Dint };
        let narrow: Vec<ElementaryType> = met.into_iter().filter(|ty| ty.size() == size).collect();
        match narrow.as_slice() {
            [first, rest @ ..] if rest.iter().all(|ty| ty == first) => *first,
            // One byte less, and no sign: it fits signed and unsigned ones.
            _ if size > 1 => ElementaryType::Usint,
            _ => narrow.into_iter().find(|ty| ty.is_signed()).unwrap_or(ElementaryType::Usint),
        }
    }
}

/// So many pieces of evidence are kept; more of them say the same.
const KEPT: usize = 64;

fn push(list: &mut Vec<Ty>, ty: &Ty, slot: Slot) {
    if *ty != Ty::Unknown && *ty != Ty::Slot(slot) && list.len() < KEPT && !list.contains(ty) {
        list.push(ty.clone());
    }
}

/// Types of one group are converted into one another.
fn group(ty: &Ty) -> Option<String> {
    Some(match ty {
        Ty::Unknown | Ty::Slot(_) | Ty::Any | Ty::Nameless(..) => return None,
        Ty::Integer | Ty::Wide(_) | Ty::Real => "number".to_owned(),
        Ty::Elementary(found) if found.is_number() || found.is_bits() && *found != ElementaryType::Bool => {
            "number".to_owned()
        }
        Ty::Elementary(found) => found.name().to_owned(),
        Ty::Text(wide) => format!("text {wide}"),
        Ty::Declared(key) | Ty::Foreign(key) => key.clone(),
        Ty::Array(..) => "array".to_owned(),
        Ty::Pointer(..) => "pointer".to_owned(),
    })
}

/// The type of what takes `from`, goes to `to` and stands beside others.
fn elementary_of(from: &[ElementaryType], to: &[ElementaryType], beside: &[ElementaryType]) -> Option<ElementaryType> {
    let all = || to.iter().chain(from).chain(beside).copied();
    if let Some(found) = all().find(|ty| *ty == ElementaryType::Bool || !(ty.is_number() || ty.is_bits())) {
        return Some(found);
    }
    let weight = |ty: &ElementaryType| (ty.is_real(), ty.size(), ty.is_signed());
    // What is given must fit; where nothing is, what it goes to must hold it.
    let given = from.iter().copied().max_by_key(weight);
    let taken = to.iter().copied().min_by_key(weight);
    given.or(taken).or_else(|| beside.iter().copied().max_by_key(weight))
}
