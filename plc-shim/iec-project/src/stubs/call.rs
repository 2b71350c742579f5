//! Calls: of what is declared, whose parameters show the arguments; of what is not, which show the parameters.

use super::class::Found;
use super::collect::{Collector, Scope, elementary};
use super::heirs::inputs;
use super::names::{Access, Kind, outer};
use super::ty::Ty;
use super::world::{Home, World};
use onescan_iec::ElementaryType as E;
use onescan_iec::syntax::ast::{Argument, Call, Expr, ExprKind, Ident, Pou, PouKind, ReferenceKind};

impl<'a> Collector<'a> {
    /// The type of a call's result; `is_used` if it goes anywhere.
    pub(super) fn call(&mut self, call: &Call, is_used: bool, scope: &Scope<'a>) -> Ty {
        match &call.callee.kind {
            ExprKind::Name(name) => self.call_of_name(name, call, is_used, scope),
            ExprKind::Member(base, name) => self.call_of_member(base, name, call, is_used, scope),
            ExprKind::Paren(_) | ExprKind::Dereference(_) | ExprKind::Index(..) | ExprKind::Call(_) => {
                let instance = self.infer(&call.callee, scope);
                self.instance_call(&instance, call, scope)
            }
            _ => Ty::Unknown,
        }
    }

    fn call_of_name(&mut self, name: &Ident, call: &Call, is_used: bool, scope: &Scope<'a>) -> Ty {
        if let Some((name, outside)) = outer(name, scope) {
            return self.call_of_library(&name, call, is_used, &outside, scope);
        }
        let key = name.key();
        let own = scope.local.is_some_and(|local| local.name.key() == key);
        if let Some(found) = self.call_of_namesake(name, own, call, is_used, scope) {
            return found;
        }
        if !own {
            if let Some(class) = &scope.class
                && let Some(Found::Method(method, home)) = self.find(class, &key)
            {
                return self.declared_call(method, &home, call, scope);
            }
            if let Some(unit) = self.world.function(&scope.home, &key) {
                let (pou, home) = (unit.pou, unit.home.clone());
                return self.declared_call(pou, &home, call, scope);
            }
            if World::has_function(&key) && !self.is_variable(name, scope) {
                return self.standard_call(&key, call, scope);
            }
            if let Some(instance) = self.seen_callable(name, scope) {
                return self.instance_call(&instance, call, scope);
            }
        }
        if own {
            call.arguments.iter().for_each(|argument| self.argument(argument, scope));
            return Ty::Unknown;
        }
        let head = self.head(name, scope);
        head.called = true;
        let is_instance = !head.parts.is_empty() || head.bare;
        match self.kind(&key, scope) {
            None => {
                call.arguments.iter().for_each(|argument| self.argument(argument, scope));
                Ty::Unknown
            }
            Some(Kind::Member(base)) => {
                let known = self.known.as_ref().and_then(|known| known.get(&key));
                if known.is_some_and(|head| !head.parts.is_empty()) {
                    let ty = self.foreign_member(&base, name, Access::Read, true);
                    return self.instance_call(&ty, call, scope);
                }
                self.method_of(&base, name, call, is_used, scope)
            }
            Some(_)
                if is_instance
                    || self
                        .known
                        .as_ref()
                        .and_then(|known| known.get(&key))
                        .is_some_and(|head| !head.parts.is_empty() || head.bare) =>
            {
                let ty = self.global(&key, &name.text, Access::Read);
                self.instance_call(&ty, call, scope)
            }
            Some(_) => self.function_call(&name.text, call, is_used, scope),
        }
    }

    fn is_variable(&mut self, name: &Ident, scope: &Scope<'a>) -> bool {
        let key = name.key();
        let local = scope.local.is_some_and(|local| {
            local
                .sections
                .iter()
                .flat_map(|section| &section.variables)
                .any(|each| each.names.iter().any(|name| name.key() == key))
        });
        local || scope.class.clone().is_some_and(|class| matches!(self.find(&class, &key), Some(Found::Variable(_))))
    }

    pub(super) fn function_call(&mut self, name: &str, call: &Call, is_used: bool, scope: &Scope<'a>) -> Ty {
        let types = self.given(&call.arguments, scope);
        let found = self.function(name);
        let (result, mut signature) = (found.result, found.signature.clone());
        signature.is_used |= is_used;
        self.arguments(&mut signature, &format!("{name}()"), &call.arguments, &types);
        self.function(name).signature = signature;
        Ty::Slot(result)
    }

    fn call_of_member(&mut self, base: &Expr, name: &Ident, call: &Call, is_used: bool, scope: &Scope<'a>) -> Ty {
        if let Some(found) = self.call_in_namespace(base, name, call, is_used, scope) {
            return found;
        }
        let object = self.infer(base, scope);
        match self.slots.resolved(&object) {
            Ty::Declared(key) => match self.find(&key, &name.text) {
                Some(Found::Method(method, home)) => self.declared_call(method, &home, call, scope),
                Some(Found::Variable(instance)) => self.instance_call(&instance, call, scope),
                Some(Found::Foreign(foreign)) => self.method_of(&foreign, name, call, is_used, scope),
                None => {
                    call.arguments.iter().for_each(|argument| self.argument(argument, scope));
                    Ty::Unknown
                }
            },
            Ty::Foreign(key) => self.method_of(&key, name, call, is_used, scope),
            Ty::Slot(slot) => {
                self.slots.use_parts(slot);
                call.arguments.iter().for_each(|argument| self.argument(argument, scope));
                Ty::Unknown
            }
            _ => {
                call.arguments.iter().for_each(|argument| self.argument(argument, scope));
                Ty::Unknown
            }
        }
    }

    /// `Library.function(x)`, `List.instance(x)`, `unknown.function(x)`
    fn call_in_namespace(
        &mut self,
        base: &Expr,
        name: &Ident,
        call: &Call,
        is_used: bool,
        scope: &Scope<'a>,
    ) -> Option<Ty> {
        let path = super::collect::path_of(base)?;
        if self.seen(path.first()?, scope).is_some() {
            return None;
        }
        let (rest, in_library) = self.behind_libraries(&path, scope);
        // What a library has is not a member of a base; arguments still stand where they stand.
        let outside = Scope { home: scope.home.clone(), class: None, local: None };
        let around = if in_library { &outside } else { scope };
        let first = match rest {
            [] => return Some(self.call_of_library(name, call, is_used, &outside, scope)),
            [first] => *first,
            _ => return None,
        };
        if in_library && let Some(found) = self.seen(first, around) {
            return Some(self.method_on(&found, name, call, is_used, scope));
        }
        let key = first.key();
        let full = format!("{key}.{}", name.key());
        if let Some(unit) = self.world.function(&scope.home, &full) {
            let (pou, home) = (unit.pou, unit.home.clone());
            return Some(self.declared_call(pou, &home, call, scope));
        }
        if let Some(found) = self.world.global_key(&scope.home, &full) {
            let (spec, home) = self.world.globals.get(&found)?;
            let instance = self.type_of(spec, home, 0);
            return Some(self.instance_call(&instance, call, scope));
        }
        if self.world.is_namespace(&scope.home, &key) {
            if World::has_function(&name.key()) {
                return Some(self.standard_call(&name.key(), call, scope));
            }
            let shown = format!("{}.{}", first.text, name.text);
            return Some(self.function_call(&shown, call, is_used, scope));
        }
        let head = self.head(first, around);
        head.parts.insert(name.key());
        head.part_called = true;
        match self.kind(&key, around) {
            None => {
                call.arguments.iter().for_each(|argument| self.argument(argument, scope));
                Some(Ty::Unknown)
            }
            Some(Kind::Library) => Some(self.function_call(&name.text, call, is_used, scope)),
            Some(Kind::List) => {
                self.needs.lists.entry(key).or_insert_with(|| first.text.clone());
                Some(self.function_call(&format!("{}.{}", first.text, name.text), call, is_used, scope))
            }
            Some(Kind::Member(base)) => {
                let ty = self.foreign_member(&base, first, Access::Read, true);
                Some(self.method_on(&ty, name, call, is_used, scope))
            }
            Some(Kind::Global) => {
                let ty = self.global(&key, &first.text, Access::Read);
                Some(self.method_on(&ty, name, call, is_used, scope))
            }
            Some(Kind::Enumeration(_)) => Some(Ty::Unknown),
        }
    }

    /// `Library.function(x)`
    fn call_of_library(
        &mut self,
        name: &Ident,
        call: &Call,
        is_used: bool,
        outside: &Scope<'a>,
        scope: &Scope<'a>,
    ) -> Ty {
        let key = name.key();
        if let Some(unit) = self.world.function(&scope.home, &key) {
            let (pou, home) = (unit.pou, unit.home.clone());
            return self.declared_call(pou, &home, call, scope);
        }
        if World::has_function(&key) {
            return self.standard_call(&key, call, scope);
        }
        if let Some(instance) = self.seen_callable(name, outside) {
            return self.instance_call(&instance, call, scope);
        }
        let head = self.head(name, outside);
        head.called = true;
        self.function_call(&name.text, call, is_used, scope)
    }

    fn method_on(&mut self, ty: &Ty, name: &Ident, call: &Call, is_used: bool, scope: &Scope<'a>) -> Ty {
        match self.slots.resolved(ty) {
            Ty::Foreign(key) => self.method_of(&key, name, call, is_used, scope),
            Ty::Declared(key) => match self.find(&key, &name.text) {
                Some(Found::Method(method, home)) => self.declared_call(method, &home, call, scope),
                Some(Found::Variable(instance)) => self.instance_call(&instance, call, scope),
                Some(Found::Foreign(foreign)) => self.method_of(&foreign, name, call, is_used, scope),
                None => Ty::Unknown,
            },
            other => {
                if let Ty::Slot(slot) = other {
                    self.slots.use_parts(slot);
                }
                call.arguments.iter().for_each(|argument| self.argument(argument, scope));
                Ty::Unknown
            }
        }
    }

    /// A method of a type that nobody declares.
    fn method_of(&mut self, key: &str, name: &Ident, call: &Call, is_used: bool, scope: &Scope<'a>) -> Ty {
        let home = self.needs.relations.home(key, &name.text).to_owned();
        let key = home.as_str();
        // What has members of its own is an instance.
        let shown = self.foreign(key).name.clone();
        // An earlier pass may have seen it, in statements behind this one.
        let field = self.foreign(key).member(&name.text).field;
        let field = field.or_else(|| self.slots.known(&format!("{shown}.{}", name.text)));
        if let Some(field) = field
            && matches!(self.slots.resolved(&Ty::Slot(field)), Ty::Foreign(_) | Ty::Declared(_))
        {
            self.foreign(key).member(&name.text).field = Some(field);
            return self.instance_call(&Ty::Slot(field), call, scope);
        }
        let types = self.given(&call.arguments, scope);
        let path = format!("{shown}.{}()", name.text);
        let result = self.slots.of(&path);
        self.slots.make_value(result);
        let known = self.foreign(key).member(&name.text).called.take();
        let mut signature = known.map(|(signature, _)| signature).unwrap_or_default();
        signature.is_used |= is_used;
        self.arguments(&mut signature, &path, &call.arguments, &types);
        self.foreign(key).member(&name.text).called = Some((signature, result));
        Ty::Slot(result)
    }

    /// A call of a function block's statements.
    fn instance_call(&mut self, instance: &Ty, call: &Call, scope: &Scope<'a>) -> Ty {
        match self.slots.resolved(instance) {
            Ty::Declared(key) => self.block_call(&key, call, scope),
            Ty::Foreign(key) => {
                self.foreign(&key).called = true;
                for (index, argument) in call.arguments.iter().enumerate() {
                    if matches!(argument, Argument::Positional(_)) {
                        let found = self.foreign(&key);
                        found.inputs = found.inputs.max(index + 1);
                    }
                    self.block_argument(&key, argument, scope);
                }
            }
            Ty::Pointer(_, inner) => return self.instance_call(&inner, call, scope),
            other => {
                if let Ty::Slot(slot) = other {
                    self.slots.use_parts(slot);
                }
                call.arguments.iter().for_each(|argument| self.argument(argument, scope));
            }
        }
        Ty::Unknown
    }

    fn block_argument(&mut self, key: &str, argument: &Argument, scope: &Scope<'a>) {
        match argument {
            Argument::Positional(value) => {
                self.infer(value, scope);
            }
            Argument::Input(name, value) => {
                let parameter = self.foreign_member(key, name, Access::Initial, false);
                self.foreign(key).member(&name.text).input = true;
                self.wanted(value, &parameter, scope);
            }
            Argument::Output { name, target, .. } => {
                let parameter = self.foreign_member(key, name, Access::Read, false);
                if let Some(target) = target {
                    let target = self.place(target, Access::Write, scope);
                    self.flow(&parameter, &target);
                }
            }
        }
    }

    fn block_call(&mut self, key: &str, call: &Call, scope: &Scope<'a>) {
        if let Some(unit) = self.world.units.get(key)
            && unit.pou.kind == PouKind::Function
        {
            let (pou, home) = (unit.pou, unit.home.clone());
            self.declared_call(pou, &home, call, scope);
            return;
        }
        for argument in &call.arguments {
            let (Argument::Input(name, _) | Argument::Output { name, .. }) = argument else {
                self.argument(argument, scope);
                continue;
            };
            match self.find(key, &name.text) {
                Some(Found::Variable(ty)) => self.argument_to(argument, &ty, scope),
                Some(Found::Foreign(foreign)) => self.block_argument(&foreign, argument, scope),
                _ => self.argument(argument, scope),
            }
        }
    }

    /// A call of a function or method that is declared.
    pub(super) fn declared_call(&mut self, pou: &'a Pou, home: &Home, call: &Call, scope: &Scope<'a>) -> Ty {
        let inputs = inputs(pou);
        let all = pou.sections.iter().flat_map(|section| &section.variables);
        let all: Vec<_> = all.flat_map(|each| each.names.iter().map(move |name| (name.key(), &each.spec))).collect();
        let mut given = 0;
        for argument in &call.arguments {
            let index = given;
            given += usize::from(!matches!(argument, Argument::Output { .. }));
            let spec = match argument {
                Argument::Positional(_) => inputs.get(index).map(|(_, spec)| *spec),
                Argument::Input(name, _) | Argument::Output { name, .. } => {
                    let key = name.key();
                    all.iter().find(|(known, _)| *known == key).map(|(_, spec)| *spec)
                }
            };
            let ty = spec.map_or(Ty::Unknown, |spec| self.type_of(spec, home, 0));
            self.argument_to(argument, &ty, scope);
        }
        let result = pou.result.as_ref().map_or(Ty::Unknown, |spec| self.type_of(spec, home, 0));
        match result {
            Ty::Pointer(ReferenceKind::Reference, inner) => *inner,
            other => other,
        }
    }

    pub(super) fn argument_to(&mut self, argument: &Argument, ty: &Ty, scope: &Scope<'a>) {
        match argument {
            Argument::Positional(value) | Argument::Input(_, value) => {
                let found = self.infer(value, scope);
                let ty = match ty {
                    Ty::Pointer(ReferenceKind::Reference, inner) => inner,
                    _ => ty,
                };
                self.flow(&found, ty);
            }
            Argument::Output { target, .. } => {
                if let Some(target) = target {
                    let target = self.place(target, Access::Write, scope);
                    self.flow(ty, &target);
                }
            }
        }
    }

    /// An argument of what nothing is known of.
    fn argument(&mut self, argument: &Argument, scope: &Scope<'a>) {
        self.argument_to(argument, &Ty::Unknown, scope);
    }

    /// A function of the language.
    pub(super) fn standard_call(&mut self, key: &str, call: &Call, scope: &Scope<'a>) -> Ty {
        if key == "__NEW" {
            return self.made(call, scope);
        }
        let values = call.arguments.iter().map(|argument| match argument {
            Argument::Positional(value) | Argument::Input(_, value) => self.infer(value, scope),
            Argument::Output { target, .. } => {
                target.as_ref().map_or(Ty::Unknown, |target| self.place(target, Access::Write, scope))
            }
        });
        let values: Vec<Ty> = values.collect();
        self.standard_result(key, &values)
    }

    /// `__NEW(Type(a := x), n)`
    fn made(&mut self, call: &Call, scope: &Scope<'a>) -> Ty {
        let Some(Argument::Positional(wanted)) = call.arguments.first() else { return Ty::Unknown };
        let (named, arguments) = match &wanted.kind {
            ExprKind::Call(inner) => (&*inner.callee, inner.arguments.as_slice()),
            _ => (wanted, [].as_slice()),
        };
        let Some(path) = super::collect::path_of(named) else { return Ty::Unknown };
        let text = path.iter().map(|name| name.text.as_str()).collect::<Vec<_>>().join(".");
        let ty = self.named(&Ident { text, span: named.span }, &scope.home, 0);
        if !arguments.is_empty() {
            let arguments = onescan_iec::syntax::ast::InitArguments::Same(arguments.to_vec());
            self.init_arguments(&ty, &arguments, scope);
        }
        call.arguments.iter().skip(1).for_each(|argument| self.argument(argument, scope));
        Ty::Pointer(ReferenceKind::Pointer, Box::new(ty))
    }

    fn standard_result(&mut self, key: &str, values: &[Ty]) -> Ty {
        if let Some((from, to)) = key.split_once("_TO_") {
            if let (Some(from), Some(value)) = (named(from), values.first()) {
                self.flow(value, &from);
            }
            return named(to).unwrap_or(Ty::Unknown);
        }
        if let Some(to) = key.strip_prefix("TO_") {
            if let (Some(value), Some(true)) = (values.first(), E::find(to).map(E::is_integer)) {
                self.flow(value, &Ty::Integer);
            }
            return named(to).unwrap_or(Ty::Unknown);
        }
        let first = values.first().cloned().unwrap_or(Ty::Unknown);
        match key {
            "ADR" => Ty::Pointer(ReferenceKind::Pointer, Box::new(first)),
            "REF" => Ty::Pointer(ReferenceKind::RefTo, Box::new(first)),
            "SIZEOF" => elementary(E::Udint),
            "LEN" | "FIND" => {
                for value in values {
                    self.flow(value, &Ty::Text(false));
                }
                elementary(E::Int)
            }
            "CONCAT" | "INSERT" | "REPLACE" => {
                for value in values.iter().take(2) {
                    self.flow(value, &Ty::Text(false));
                }
                Ty::Text(false)
            }
            "LEFT" | "RIGHT" | "MID" | "DELETE" => {
                self.flow(&first, &Ty::Text(false));
                Ty::Text(false)
            }
            "SQRT" | "LN" | "LOG" | "EXP" | "SIN" | "COS" | "TAN" | "ASIN" | "ACOS" | "ATAN" => {
                let known = self.slots.resolved(&first);
                if matches!(known, Ty::Elementary(found) if found.is_real()) { known } else { elementary(E::Lreal) }
            }
            "MIN" | "MAX" | "LIMIT" => {
                values.windows(2).for_each(|pair| self.beside_pair(pair));
                values
                    .iter()
                    .map(|value| self.slots.resolved(value))
                    .find(|ty| matches!(ty, Ty::Elementary(_)))
                    .unwrap_or(first)
            }
            "SEL" => {
                self.flow(&first, &elementary(E::Bool));
                values.get(1..).unwrap_or_default().windows(2).for_each(|pair| self.beside_pair(pair));
                let rest = values.get(1..).unwrap_or_default();
                rest.iter()
                    .find(|ty| !matches!(ty, Ty::Integer | Ty::Wide(_) | Ty::Real))
                    .or(rest.first())
                    .cloned()
                    .unwrap_or(Ty::Unknown)
            }
            "TIME" => elementary(E::Time),
            "LTIME" => elementary(E::Ltime),
            "ABS" | "MOVE" | "SHL" | "SHR" | "ROL" | "ROR" => first,
            "TRUNC" => elementary(E::Dint),
            "__QUERYINTERFACE" | "__QUERYPOINTER" => {
                // What is asked is an interface, and what answers may be one.
                let count = if key == "__QUERYINTERFACE" { 2 } else { 1 };
                values.iter().take(count).for_each(|value| self.asked(value));
                elementary(E::Bool)
            }
            "__DELETE" => {
                self.flow(&first, &Ty::Pointer(ReferenceKind::Pointer, Box::new(Ty::Unknown)));
                Ty::Unknown
            }
            "__ISVALIDREF" | "GT" | "GE" | "EQ" | "LE" | "LT" | "NE" => elementary(E::Bool),
            _ => Ty::Unknown,
        }
    }

    fn beside_pair(&mut self, pair: &[Ty]) {
        if let [one, other] = pair {
            self.beside(one, other);
        }
    }
}

fn named(key: &str) -> Option<Ty> {
    match key {
        "STRING" => Some(Ty::Text(false)),
        "WSTRING" => Some(Ty::Text(true)),
        _ => E::find(key).map(elementary),
    }
}
