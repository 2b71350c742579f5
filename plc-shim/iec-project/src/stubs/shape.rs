//! What a type that nobody declares is: by its use first, by its name where that does not decide.

use super::collect::Collector;
use super::foreign::Foreign;
use super::hint::{self, TypeHint};
use super::ty::Ty;
use onescan_iec::ElementaryType;
use onescan_iec::syntax::ast::TypeSpecKind;

/// What a stub of a type is.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Shape {
    Block,
    Interface,
    Structure,
    Enumeration,
    /// Another name of a type.
    Alias(Ty),
}

impl Collector<'_> {
    pub(super) fn shape(&self, found: &Foreign) -> Shape {
        if found.implemented || found.base_of_interface {
            return Shape::Interface;
        }
        let is_held = found.is_held && found.values.is_empty();
        if found.base_of_block || found.called || found.init.is_some() || found.constants > 0 || is_held {
            return Shape::Block;
        }
        if found.base_of_structure {
            return Shape::Structure;
        }
        if !found.values.is_empty() && found.members.is_empty() {
            return Shape::Enumeration;
        }
        let hint = hint::of_type(&found.name);
        let has_methods = found.members.values().any(|member| member.called.is_some());
        if has_methods {
            let is_interface = hint == Some(TypeHint::Interface) || found.is_value;
            return if is_interface { Shape::Interface } else { Shape::Block };
        }
        if !found.members.is_empty() {
            return match hint {
                Some(TypeHint::Block) => Shape::Block,
                Some(TypeHint::Interface) => Shape::Interface,
                _ if found.variables.iter().any(|name| hint::of_type(name) == Some(TypeHint::Block)) => Shape::Block,
                _ => Shape::Structure,
            };
        }
        match hint {
            Some(TypeHint::Block) => return Shape::Block,
            Some(TypeHint::Interface) => return Shape::Interface,
            Some(TypeHint::Structure) => return Shape::Structure,
            Some(TypeHint::Enumeration) => return Shape::Enumeration,
            None => {}
        }
        self.by_value(found)
    }

    /// An empty string as a value of a type of strings.
    pub(super) fn empty_text(&self, ty: &Ty) -> Option<&'static str> {
        let wide = match ty {
            Ty::Text(wide) => *wide,
            Ty::Declared(key) => match &self.world.types.get(key)?.ast.spec.kind {
                TypeSpecKind::String(word, _) => word.key() == "WSTRING",
                _ => return None,
            },
            _ => return None,
        };
        Some(if wide { "\"\"" } else { "''" })
    }

    /// The type of an enumeration's numbers, where an INT would not hold what goes into it.
    pub(super) fn base_of(&self, found: &Foreign) -> Option<ElementaryType> {
        let numbers = self.slots.evidence(found.value?).filter_map(|ty| match ty {
            Ty::Elementary(found) if found.is_integer() => Some(found),
            _ => None,
        });
        numbers.filter(|ty| !ty.widens_to(ElementaryType::Int)).max_by_key(|ty| (ty.size(), ty.is_signed()))
    }

    /// Nothing of it is used but the value as a whole.
    fn by_value(&self, found: &Foreign) -> Shape {
        if let Some(plain) = self.plain_value(found) {
            return Shape::Alias(plain);
        }
        if let Some(slot) = found.value {
            match self.slots.decided(slot) {
                Some(Ty::Declared(key)) if self.world.units.contains_key(key) => return Shape::Interface,
                Some(Ty::Declared(_) | Ty::Foreign(_)) => {}
                Some(other) => return Shape::Alias(other.clone()),
                None if self.slots.is_touched(slot) => return Shape::Alias(self.slots.last_choice(slot)),
                None => {}
            }
        }
        let by_variable = found.variables.iter().find_map(|name| hint::of_type(name));
        match by_variable {
            Some(TypeHint::Block) => Shape::Block,
            Some(TypeHint::Enumeration) => Shape::Enumeration,
            _ => Shape::Structure,
        }
    }

    /// The plain type of a type whose values are numbers, times or strings, be it by way of other types that nobody
    /// declares.
    fn plain_value(&self, found: &Foreign) -> Option<Ty> {
        let mut seen = std::collections::BTreeSet::new();
        let mut open = vec![found];
        let mut literal = None;
        while let Some(next) = open.pop() {
            let Some(slot) = next.value.filter(|slot| seen.insert(*slot)) else { continue };
            for ty in self.slots.evidence(slot) {
                match ty {
                    Ty::Elementary(_) | Ty::Text(_) => return Some(ty),
                    Ty::Real => literal = Some(Ty::Elementary(hint::real(&found.name))),
                    Ty::Integer if literal.is_none() => literal = Some(hint::integer(&found.name)),
                    Ty::Wide(wide) if literal.is_none() => literal = Some(Ty::Elementary(wide)),
                    Ty::Foreign(key) => open.extend(self.needs.types.get(&key).filter(|each| each.members.is_empty())),
                    _ => {}
                }
            }
        }
        literal
    }
}
