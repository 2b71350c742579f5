//! What names mean: what the project declares, or what somebody else must have.

use super::class::Found;
use super::collect::{Collector, Scope, path_of};
use super::foreign::{Function, Global, Head};
use super::hint;
use super::ty::Ty;
use super::world::{VALUE, has_value};
use onescan_iec::ElementaryType;
use onescan_iec::check::{is_list, joined};
use onescan_iec::syntax::ast::{Expr, ExprKind, Ident, ReferenceKind, TypeSpecKind};

/// What is done to a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Access {
    Read,
    Write,
    /// A member or an element of it is written.
    WriteBelow,
    /// Its value is wanted before the program runs.
    Constant,
    /// It is given an initial value.
    Initial,
}

impl Access {
    /// What is done to what a member or an element of which is accessed.
    pub(super) fn of_base(self) -> Self {
        match self {
            Self::Write | Self::WriteBelow => Self::WriteBelow,
            Self::Read | Self::Constant | Self::Initial => Self::Read,
        }
    }
}

/// What an unknown name is taken for.
pub(super) enum Kind {
    /// An enumeration, by the key of its type.
    Enumeration(String),
    /// A library, whose name may stand before others.
    Library,
    /// A list of global variables.
    List,
    /// A variable or a function.
    Global,
    /// A member of a base, by that one's key.
    Member(String),
}

/// True for types that every tool has, where one stands as a value in `SIZEOF(INT)`, and for operators of the tools:
/// no stub may declare them.
fn is_of_the_language(key: &str) -> bool {
    key.starts_with("__") || matches!(key, "STRING" | "WSTRING" | "BIT") || ElementaryType::find(key).is_some()
}

/// `.name` of CODESYS as `name`, outside of all units; nothing for any other name.
pub(super) fn outer<'a>(name: &Ident, scope: &Scope<'a>) -> Option<(Ident, Scope<'a>)> {
    let text = name.text.strip_prefix('.')?.to_owned();
    let outside = Scope { home: scope.home.clone(), class: None, local: None };
    Some((Ident { text, span: name.span }, outside))
}

impl<'a> Collector<'a> {
    /// What a name alone stands for.
    pub(super) fn name(&mut self, name: &Ident, access: Access, scope: &Scope<'a>) -> Ty {
        if let Some((name, outside)) = outer(name, scope) {
            return self.name(&name, access, &outside);
        }
        if let Some(found) = self.seen(name, scope) {
            return found;
        }
        let key = name.key();
        let head = self.head(name, scope);
        head.bare = true;
        head.written |= access == Access::Write;
        match self.kind(&key, scope) {
            None => Ty::Unknown,
            Some(Kind::Member(base)) => self.foreign_member(&base, name, access, true),
            Some(_) => self.global(&key, &name.text, access),
        }
    }

    /// What the scope declares of a name.
    pub(super) fn seen(&mut self, name: &Ident, scope: &Scope<'a>) -> Option<Ty> {
        let key = name.key();
        if key == "THIS" {
            return Some(scope.class.clone().map_or(Ty::Unknown, Ty::Declared));
        }
        if key == "SUPER" {
            return Some(self.base_type(scope));
        }
        if let Some(local) = scope.local {
            for section in &local.sections {
                for variable in &section.variables {
                    if variable.names.iter().any(|each| each.key() == key) {
                        return Some(self.type_of(&variable.spec, &scope.home, 0));
                    }
                    if has_value(&variable.spec, &key) {
                        return Some(VALUE);
                    }
                }
            }
            if local.name.key() == key {
                return Some(local.result.as_ref().map_or(Ty::Unknown, |spec| self.type_of(spec, &scope.home, 0)));
            }
        }
        if let Some(class) = &scope.class {
            match self.find(class, &key) {
                Some(Found::Variable(ty)) => return Some(ty),
                Some(Found::Method(..)) => return Some(Ty::Unknown),
                _ => {}
            }
        }
        self.global_seen(&key, scope)
    }

    /// The same, of what can be called: values of enumerations and types leave their names to functions.
    pub(super) fn seen_callable(&mut self, name: &Ident, scope: &Scope<'a>) -> Option<Ty> {
        let key = name.key();
        let is_hidden = self.world.enumerators.contains_key(&key) || self.world.type_key(&scope.home, &key).is_some();
        if is_hidden && !self.local_seen(name, scope) {
            return None;
        }
        self.seen(name, scope)
    }

    fn global_seen(&mut self, key: &str, scope: &Scope<'a>) -> Option<Ty> {
        if let Some(found) = self.world.global_key(&scope.home, key) {
            let (spec, home) = self.world.globals.get(&found)?;
            return Some(self.type_of(spec, home, 0));
        }
        if let Some(found) = self.world.enumerators.get(key) {
            return Some(Ty::Declared(found.clone()));
        }
        if self.world.loose_values.contains(key) {
            return Some(VALUE);
        }
        if let Some(found) = self.world.unit_key(&scope.home, key) {
            return Some(Ty::Declared(found));
        }
        if let Some(found) = self.world.type_key(&scope.home, key) {
            return Some(Ty::Declared(found));
        }
        matches!(key, "TRUE" | "FALSE" | "NULL" | "INIT_RETAINS" | "VIRTUAL_TIME")
            .then_some(Ty::Unknown)
            .or_else(|| is_of_the_language(key).then_some(Ty::Unknown))
    }

    fn base_type(&mut self, scope: &Scope<'a>) -> Ty {
        let Some(unit) = scope.class.as_ref().and_then(|class| self.world.units.get(class)) else {
            return Ty::Unknown;
        };
        unit.pou.object.extends.first().map_or(Ty::Unknown, |base| self.named(base, &unit.home, 0))
    }

    /// Notes the use of a name that nobody declares.
    pub(super) fn head(&mut self, name: &Ident, scope: &Scope<'a>) -> &mut Head {
        let based = scope.class.clone().and_then(|class| self.foreign_base(&class));
        let head = self.needs.heads.entry(name.key()).or_default();
        if head.name.is_empty() {
            name.text.trim_start_matches('.').clone_into(&mut head.name);
        }
        head.outside |= based.is_none();
        head
    }

    /// What an unknown name is, by all of its uses; nothing before they are known.
    pub(super) fn kind(&mut self, key: &str, scope: &Scope<'a>) -> Option<Kind> {
        let head = self.known.as_ref()?.get(key)?.clone();
        if self.needs.types.contains_key(key) {
            return Some(Kind::Enumeration(key.to_owned()));
        }
        if self.needs.libraries.contains_key(key) {
            return Some(Kind::Library);
        }
        let based = scope.class.clone().and_then(|class| self.foreign_base(&class));
        let is_alone = head.bare || head.called;
        let is_enumeration =
            !head.parts.is_empty() && !is_alone && !head.part_called && !head.part_written && !head.part_deep;
        if let Some(base) = based
            && !head.outside
            && (!hint::is_global(&head.name) || head.written || head.part_written)
        {
            return Some(Kind::Member(base));
        }
        if is_alone {
            return Some(Kind::Global);
        }
        if is_enumeration && hint::of_type(&head.name) == Some(hint::TypeHint::Enumeration) {
            return Some(Kind::Enumeration(key.to_owned()));
        }
        Some(Kind::List)
    }

    pub(super) fn global(&mut self, key: &str, name: &str, access: Access) -> Ty {
        let slot = self.slots.of(&format!("global:{name}"));
        let found = self.needs.globals.entry(key.to_owned()).or_insert_with(|| Global {
            name: name.to_owned(),
            slot,
            written: false,
            is_constant: false,
        });
        found.written |= matches!(access, Access::Write | Access::WriteBelow);
        found.is_constant |= access == Access::Constant;
        Ty::Slot(slot)
    }

    pub(super) fn function(&mut self, name: &str) -> &mut Function {
        let key = name.to_ascii_uppercase();
        let result = self.slots.of(&format!("{name}()"));
        self.slots.make_value(result);
        self.needs.functions.entry(key).or_insert_with(|| Function {
            name: name.to_owned(),
            signature: super::foreign::Signature::default(),
            result,
        })
    }

    /// A member of what is of a type.
    pub(super) fn member(&mut self, base: &Ty, name: &Ident, access: Access, inside: bool) -> Ty {
        match self.slots.resolved(base) {
            Ty::Declared(key) => match self.find(&key, &name.text) {
                Some(Found::Variable(ty)) => ty,
                Some(Found::Foreign(foreign)) => self.foreign_member(&foreign, name, access, inside),
                _ => Ty::Unknown,
            },
            Ty::Foreign(key) => self.foreign_member(&key, name, access, inside),
            Ty::Slot(slot) => {
                self.slots.use_parts(slot);
                Ty::Unknown
            }
            Ty::Pointer(ReferenceKind::Reference, inner) => self.member(&inner, name, access, inside),
            Ty::Nameless(file, start) => self.nameless_member(file, start, name),
            Ty::Any => match name.key().as_str() {
                "PVALUE" => Ty::Pointer(ReferenceKind::Pointer, Box::new(Ty::Elementary(ElementaryType::Byte))),
                "DISIZE" => Ty::Elementary(ElementaryType::Dint),
                _ => Ty::Unknown,
            },
            _ => Ty::Unknown,
        }
    }

    pub(super) fn foreign_member(&mut self, key: &str, name: &Ident, access: Access, inside: bool) -> Ty {
        let home = self.needs.relations.home(key, &name.text).to_owned();
        let key = home.as_str();
        let shown = self.foreign(key).name.clone();
        let slot = self.slots.of(&format!("{shown}.{}", name.text));
        let is_value = {
            let found = self.foreign(key);
            found.implemented || found.base_of_interface || found.is_value
        };
        if is_value {
            self.slots.make_value(slot);
        }
        let member = self.foreign(key).member(&name.text);
        member.field = Some(slot);
        match access {
            Access::Write if inside => member.written_inside = true,
            Access::Write | Access::Initial => member.written_outside = true,
            Access::WriteBelow => {
                member.read = true;
                member.written_below = true;
            }
            Access::Constant => member.is_constant = true,
            Access::Read => member.read = true,
        }
        Ty::Slot(slot)
    }

    /// `a.b.c` that begins with a name which is not a variable; nothing if it is one.
    pub(super) fn dotted(&mut self, expr: &Expr, access: Access, scope: &Scope<'a>) -> Option<Ty> {
        let ExprKind::Member(base, last) = &expr.kind else { return None };
        let path = path_of(base)?;
        if self.local_seen(path.first()?, scope) {
            return None;
        }
        let (rest, in_library) = self.behind_libraries(&path, scope);
        let outside = Scope { home: scope.home.clone(), class: None, local: None };
        let scope = if in_library { &outside } else { scope };
        match rest {
            [] => Some(self.name(last, access, scope)),
            [first] => self.of_alias_or_namespace(first, last, access, scope).or_else(|| {
                let found = in_library.then(|| self.global_seen(&first.key(), scope)).flatten();
                match found {
                    Some(found) => Some(self.member(&found, last, access, false)),
                    None => self.unknown_head(first, last, access, scope),
                }
            }),
            _ => None,
        }
    }

    fn of_alias_or_namespace(&mut self, first: &Ident, last: &Ident, access: Access, scope: &Scope<'a>) -> Option<Ty> {
        self.value_by_alias(first, last, scope).or_else(|| self.in_namespace(first, last, access, scope))
    }

    /// `Alias.Value` where the project declares another name of an enumeration that nobody declares.
    fn value_by_alias(&mut self, first: &Ident, last: &Ident, scope: &Scope<'a>) -> Option<Ty> {
        let key = self.world.type_key(&scope.home, &first.key())?;
        let named = self.world.types.get(&key)?;
        if !matches!(named.ast.spec.kind, TypeSpecKind::Name(_)) {
            return None;
        }
        let Ty::Foreign(found) = self.named(first, &scope.home, 0) else { return None };
        self.foreign(&found).add_value(&last.text);
        Some(Ty::Foreign(found))
    }

    /// The names behind those of libraries, and whether there is such a library in front.
    pub(super) fn behind_libraries<'p, 'e>(
        &mut self,
        path: &'p [&'e Ident],
        scope: &Scope<'a>,
    ) -> (&'p [&'e Ident], bool) {
        let mut rest = path;
        while let [first, behind @ ..] = rest {
            let key = first.key();
            if super::hint::is_library(&first.text) && !self.world.is_namespace(&scope.home, &key) {
                self.needs.libraries.entry(key.clone()).or_insert_with(|| first.text.clone());
            }
            if !self.needs.libraries.contains_key(&key) && !self.world.is_library(&key) {
                break;
            }
            rest = behind;
        }
        // A list of global variables in a library.
        if rest.len() < path.len()
            && let [list, behind @ ..] = rest
            && is_list(&list.text)
        {
            rest = behind;
        }
        (rest, rest.len() < path.len())
    }

    /// True for a variable that a body sees.
    fn local_seen(&mut self, name: &Ident, scope: &Scope<'a>) -> bool {
        let key = name.key();
        if matches!(key.as_str(), "THIS" | "SUPER") {
            return true;
        }
        let local = scope.local.is_some_and(|local| {
            let names = local.sections.iter().flat_map(|section| &section.variables).flat_map(|each| &each.names);
            local.name.key() == key && local.result.is_some() || names.into_iter().any(|each| each.key() == key)
        });
        if local {
            return true;
        }
        let member = scope.class.clone().and_then(|class| self.find(&class, &key));
        matches!(member, Some(Found::Variable(_) | Found::Method(..)))
            || self.world.global_key(&scope.home, &key).is_some()
    }

    /// What a namespace has of a name.
    fn in_namespace(&mut self, first: &Ident, last: &Ident, access: Access, scope: &Scope<'a>) -> Option<Ty> {
        let key = first.key();
        let full = joined(&key, &last.key());
        if self.needs.types.contains_key(&full) {
            return Some(Ty::Foreign(full));
        }
        if !self.world.is_namespace(&scope.home, &key) {
            return None;
        }
        if let Some(found) = self.global_seen(&full, scope) {
            return Some(found);
        }
        Some(self.listed(&key, &first.text, last, access))
    }

    /// A variable of a list.
    pub(super) fn listed(&mut self, list: &str, shown: &str, name: &Ident, access: Access) -> Ty {
        let shown = shown.trim_start_matches('.');
        self.needs.lists.entry(list.to_owned()).or_insert_with(|| shown.to_owned());
        self.global(&joined(list, &name.key()), &format!("{shown}.{}", name.text), access)
    }

    /// `a.b` where nobody declares `a`.
    pub(super) fn unknown_head(
        &mut self,
        first: &Ident,
        last: &Ident,
        access: Access,
        scope: &Scope<'a>,
    ) -> Option<Ty> {
        if self.global_seen(&first.key(), scope).is_some() {
            return None;
        }
        let head = self.head(first, scope);
        head.parts.insert(last.key());
        head.part_written |= access == Access::Write;
        let key = first.key();
        match self.kind(&key, scope) {
            None => Some(Ty::Unknown),
            Some(Kind::Enumeration(ty)) => {
                let found = self.foreign(&ty);
                if found.name == ty {
                    found.name.clone_from(&first.text);
                }
                found.add_value(&last.text);
                Some(Ty::Foreign(ty))
            }
            Some(Kind::List) => Some(self.listed(&key, &first.text, last, access)),
            Some(Kind::Library) => Some(self.global(&last.key(), &last.text, access)),
            Some(Kind::Member(base)) => {
                let ty = self.foreign_member(&base, first, access.of_base(), true);
                Some(self.member(&ty, last, access, false))
            }
            Some(Kind::Global) => {
                let ty = self.global(&key, &first.text, access.of_base());
                Some(self.member(&ty, last, access, false))
            }
        }
    }
}
