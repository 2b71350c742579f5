//! What declarations want of constants: bounds, lengths, initial values, arguments of `FB_init`.

use super::class::Found;
use super::collect::{Collector, Scope};
use super::names::Access;
use super::ty::Ty;
use onescan_iec::syntax::ast::{
    Argument, Expr, ExprKind, InitArguments, Initialiser, InitialiserKind, Qualifier, Section, SectionKind, TypeSpec,
    TypeSpecKind,
};
use onescan_iec::{Dialect, ElementaryType};

impl<'a> Collector<'a> {
    pub(super) fn initials(&mut self, section: &Section, scope: &Scope<'a>) {
        // An input of a call that is not given has its value from before the program runs.
        let is_input = scope.local.is_some() && section.kind == SectionKind::Input;
        let is_constant = is_input || section.qualifiers.contains(&Qualifier::Constant);
        for variable in &section.variables {
            self.constants_of(&variable.spec, scope);
            let ty = self.type_of(&variable.spec, &scope.home, 0);
            match variable.initial.as_ref().map(|initial| (&initial.kind, initial)) {
                Some((InitialiserKind::Value(value), _)) if is_constant => {
                    let found = self.place(value, Access::Constant, scope);
                    self.flow(&found, &ty);
                }
                Some((_, initial)) => self.initial(&ty, initial, scope),
                None => {}
            }
        }
    }

    pub(super) fn init_arguments(&mut self, ty: &Ty, arguments: &InitArguments, scope: &Scope<'a>) {
        let lists = match arguments {
            InitArguments::Same(list) => std::slice::from_ref(list),
            InitArguments::Listed(lists) => lists,
        };
        let foreign = match ty {
            Ty::Foreign(key) => Some(key.clone()),
            Ty::Declared(class) => match self.find(class, "FB_init") {
                Some(Found::Foreign(key)) => Some(key),
                _ => None,
            },
            _ => None,
        };
        let declared = match ty {
            Ty::Declared(class) => self.declared_init(class).unwrap_or_default(),
            _ => Vec::new(),
        };
        for list in lists {
            let Some(key) = &foreign else {
                for (index, argument) in list.iter().enumerate() {
                    let wanted = match argument {
                        Argument::Positional(_) => declared.get(index),
                        Argument::Input(name, _) | Argument::Output { name, .. } => {
                            declared.iter().find(|(known, _)| *known == name.key())
                        }
                    };
                    self.argument_to(argument, wanted.map_or(&Ty::Unknown, |(_, ty)| ty), scope);
                }
                continue;
            };
            let path = format!("{key}.FB_init");
            let types = self.given(list, scope);
            let mut signature = self.foreign(key).init.take().unwrap_or_default();
            self.arguments(&mut signature, &path, list, &types);
            self.foreign(key).init = Some(signature);
        }
    }

    /// Bounds and lengths are constants.
    pub(super) fn constants_of(&mut self, spec: &TypeSpec, scope: &Scope<'a>) {
        match &spec.kind {
            TypeSpecKind::Array(dimensions, inner) => {
                for dimension in dimensions {
                    self.constant(&dimension.low, scope);
                    self.constant(&dimension.high, scope);
                }
                self.constants_of(inner, scope);
            }
            TypeSpecKind::Instance(name, arguments) => {
                let ty = self.named(name, &scope.home, 0);
                self.init_arguments(&ty, arguments, scope);
            }
            TypeSpecKind::String(_, Some(length)) => {
                self.constant(length, scope);
            }
            TypeSpecKind::Subrange(_, bounds) => {
                self.constant(&bounds.low, scope);
                self.constant(&bounds.high, scope);
            }
            TypeSpecKind::Reference(_, inner) | TypeSpecKind::OpenArray(_, inner) => self.constants_of(inner, scope),
            TypeSpecKind::Struct(fields) | TypeSpecKind::Union(fields) | TypeSpecKind::Overlapping(fields) => {
                for field in fields {
                    self.constants_of(&field.spec, scope);
                    let ty = self.type_of(&field.spec, &scope.home, 0);
                    field.initial.iter().for_each(|initial| self.initial(&ty, initial, scope));
                }
            }
            TypeSpecKind::Enumeration(values, base) => {
                let base = base.as_ref().and_then(|base| ElementaryType::find(&base.key()));
                for value in values.iter().filter_map(|each| each.value.as_ref()) {
                    let found = self.constant(value, scope);
                    if let (Ty::Slot(slot), Some(base)) = (found, base) {
                        self.slots.taken(slot, &Ty::Elementary(base));
                    }
                }
            }
            _ => {}
        }
    }

    /// The constants that types are made of.
    pub(super) fn type_constants(&mut self) {
        let world = self.world;
        for named in world.types.values() {
            let scope = Scope { home: named.home.clone(), class: None, local: None };
            self.constants_of(&named.ast.spec, &scope);
            let ty = self.type_of(&named.ast.spec, &named.home, 0);
            named.ast.initial.iter().for_each(|initial| self.initial(&ty, initial, &scope));
        }
    }

    fn constant(&mut self, expr: &Expr, scope: &Scope<'a>) -> Ty {
        let found = self.place(expr, Access::Constant, scope);
        self.flow(&found, &Ty::Integer);
        if let Ty::Slot(slot) = found {
            self.slots.given(slot, &Ty::Integer);
        }
        found
    }

    /// Notes a variable that a member begins with: in SIMATIC AX an instance for an interface, never a copy.
    fn held(&mut self, initial: &Initialiser, scope: &Scope<'a>) {
        let InitialiserKind::Value(Expr { kind: ExprKind::Name(name), span, .. }) = &initial.kind else { return };
        if self.world.dialect(*span) != Dialect::Iec3 {
            return;
        }
        if let Some(Ty::Foreign(key)) = self.seen(name, scope) {
            self.foreign(&key).is_held = true;
        }
    }

    fn initial(&mut self, ty: &Ty, initial: &Initialiser, scope: &Scope<'a>) {
        match &initial.kind {
            InitialiserKind::Value(value) => self.wanted(value, ty, scope),
            InitialiserKind::Array(values) => {
                let element = self.element(ty, 1);
                for value in values {
                    self.initial(&element, value, scope);
                }
            }
            InitialiserKind::Repeat(count, value) => {
                self.constant(count, scope);
                if let Some(value) = value {
                    self.initial(ty, value, scope);
                }
            }
            InitialiserKind::Struct(values) => {
                for each in values {
                    let member = self.member(ty, &each.name, Access::Initial, false);
                    self.initial(&member, &each.value, scope);
                    self.held(&each.value, scope);
                }
            }
            InitialiserKind::Elements(elements) => {
                for element in elements {
                    self.initial(&Ty::Unknown, &element.value, scope);
                }
            }
        }
    }
}
