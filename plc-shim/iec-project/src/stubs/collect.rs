//! What every declaration and statement wants of what nobody declares.

use super::foreign::{Foreign, Needs};
use super::slots::Slots;
use super::ty::Ty;
use super::world::{Home, Unit, World};
use onescan_iec::ElementaryType;
use onescan_iec::check::of_pointer_width;
use onescan_iec::dialect::Feature;
use onescan_iec::syntax::ast::{
    BinaryOp, Expr, ExprKind, Field, Ident, Literal, Pou, PouKind, Section, SectionKind, TransitionCondition, TypeSpec,
    TypeSpecKind,
};
use onescan_iec::syntax::{FileId, Span};

/// Greatest number of types that stand for one another in a row.
const MAX_DEPTH: u8 = 40;

/// One pass over the project.
pub(super) struct Collector<'a> {
    pub(super) world: &'a World<'a>,
    pub(super) slots: Slots,
    pub(super) needs: Needs,
    /// Heads as an earlier pass has found them; nothing in the first one.
    pub(super) known: Option<std::collections::BTreeMap<String, super::foreign::Head>>,
    /// The members of structures without names, by the places where these stand.
    pub(super) nameless: std::collections::BTreeMap<(FileId, u32), (Vec<Field>, Home)>,
    /// Functions of one name may take other parameters.
    pub(super) has_overloads: bool,
}

/// Where a body stands.
#[derive(Clone)]
pub(super) struct Scope<'a> {
    pub(super) home: Home,
    /// The unit whose members are seen by their names alone.
    pub(super) class: Option<String>,
    /// The method or function.
    pub(super) local: Option<&'a Pou>,
}

impl<'a> Collector<'a> {
    /// Goes through everything once.
    pub(super) fn pass(&mut self) {
        self.slots.begin_pass();
        let world = self.world;
        self.declared(world);
        for (section, home) in &world.loose {
            let scope = Scope { home: home.clone(), class: None, local: None };
            self.initials(section, &scope);
        }
        for (key, unit) in world.units.iter().filter(|(_, unit)| !unit.library) {
            self.overrides(key, unit);
            self.unit(key, unit);
        }
    }

    /// Types first: what is one is known when names are looked up.
    fn declared(&mut self, world: &'a World<'a>) {
        for named in world.types.values() {
            self.spec(&named.ast.spec, &named.home, &[]);
            if let Some(base) = &named.ast.extends {
                let ty = self.named(base, &named.home, 0);
                if let Ty::Foreign(key) = ty {
                    self.foreign(&key).base_of_structure = true;
                }
            }
        }
        for (section, home) in &world.loose {
            self.section_types(section, home);
        }
        for unit in world.units.values().filter(|unit| !unit.library) {
            self.heritage(unit);
            let members = unit.pou.object.members.iter().map(|member| &member.pou);
            for pou in members.chain([unit.pou]) {
                pou.result.iter().for_each(|result| self.spec(result, &unit.home, &[]));
                pou.sections.iter().for_each(|section| self.section_types(section, &unit.home));
            }
        }
    }

    fn heritage(&mut self, unit: &Unit<'_>) {
        // A unit that bears the name of its base is not its own base.
        for base in unit.pou.object.extends.iter().chain(&unit.pou.object.implements) {
            let key = base.key();
            if let Some((library, last)) = key.split_once('.')
                && last == unit.pou.name.key()
                && !self.world.units.contains_key(&key)
            {
                let name = base.text.split('.').next().unwrap_or(library).to_owned();
                self.needs.libraries.insert(library.to_owned(), name);
                self.needs.shadowed.insert(key);
            }
        }
        for base in &unit.pou.object.extends {
            if let Ty::Foreign(key) = self.named(base, &unit.home, 0) {
                let is_interface = unit.pou.kind == PouKind::Interface;
                let found = self.foreign(&key);
                found.base_of_interface |= is_interface;
                found.base_of_block |= !is_interface;
                found.base_of_class |= unit.pou.kind == PouKind::Class;
            }
        }
        for base in &unit.pou.object.implements {
            if let Ty::Foreign(key) = self.named(base, &unit.home, 0) {
                self.foreign(&key).implemented = true;
            }
        }
    }

    fn section_types(&mut self, section: &Section, home: &Home) {
        for variable in &section.variables {
            let names: Vec<&str> = variable.names.iter().map(|name| name.text.as_str()).collect();
            self.spec(&variable.spec, home, &names);
            // What keeps nothing has no instances but with vendors: it is a reference to one.
            if section.kind == SectionKind::Temp
                && !self.world.dialect(variable.spec.span).has(Feature::FleetingInstances)
                && let TypeSpecKind::Name(name) = &variable.spec.kind
                && let Ty::Foreign(key) = self.named(name, home, 0)
            {
                self.foreign(&key).is_value = true;
            }
        }
    }

    /// Notes the types that a specification names, for variables of these names.
    fn spec(&mut self, spec: &TypeSpec, home: &Home, variables: &[&str]) {
        match &spec.kind {
            TypeSpecKind::Name(name) | TypeSpecKind::Instance(name, _) | TypeSpecKind::Subrange(name, _) => {
                if let Ty::Foreign(key) = self.named(name, home, 0) {
                    let found = self.foreign(&key);
                    found.variables.extend(variables.iter().map(|name| (*name).to_owned()));
                }
            }
            TypeSpecKind::Array(_, inner) | TypeSpecKind::OpenArray(_, inner) => self.spec(inner, home, variables),
            TypeSpecKind::Reference(_, inner) => self.spec(inner, home, &[]),
            TypeSpecKind::Union(fields) | TypeSpecKind::Struct(fields) | TypeSpecKind::Overlapping(fields) => {
                for field in fields {
                    self.spec(&field.spec, home, &[&field.name.text]);
                }
            }
            TypeSpecKind::String(..) | TypeSpecKind::Enumeration(..) | TypeSpecKind::Error => {}
        }
    }

    /// What a specification is.
    pub(super) fn type_of(&mut self, spec: &TypeSpec, home: &Home, depth: u8) -> Ty {
        match &spec.kind {
            TypeSpecKind::Name(name) | TypeSpecKind::Instance(name, _) | TypeSpecKind::Subrange(name, _) => {
                self.named(name, home, depth)
            }
            TypeSpecKind::String(name, _) => Ty::Text(name.key() == "WSTRING"),
            TypeSpecKind::Array(dimensions, inner) => {
                let bounds =
                    dimensions.iter().map(|each| match (self.bound(&each.low, home), self.bound(&each.high, home)) {
                        (Some(low), Some(high)) => format!("{low}..{high}"),
                        _ => super::slots::ANY_BOUNDS.to_owned(),
                    });
                let bounds = bounds.collect::<Vec<_>>();
                match self.type_of(inner, home, depth) {
                    Ty::Any => Ty::Any,
                    element => Ty::Array(bounds, Box::new(element)),
                }
            }
            TypeSpecKind::Struct(fields) => self.structure_here(fields, spec.span, home),
            TypeSpecKind::OpenArray(count, inner) => {
                let bounds = (0..*count).map(|_| super::slots::OPEN_BOUNDS.to_owned()).collect();
                Ty::Array(bounds, Box::new(self.type_of(inner, home, depth)))
            }
            TypeSpecKind::Reference(kind, inner) => Ty::Pointer(*kind, Box::new(self.type_of(inner, home, depth))),
            _ => Ty::Unknown,
        }
    }

    fn structure_here(&mut self, fields: &[Field], span: Span, home: &Home) -> Ty {
        let place = (span.file, span.start);
        self.nameless.entry(place).or_insert_with(|| (fields.to_vec(), home.clone()));
        Ty::Nameless(span.file, span.start)
    }

    /// A member of a structure without a name.
    pub(super) fn nameless_member(&mut self, file: FileId, start: u32, name: &Ident) -> Ty {
        let found = self.nameless.get(&(file, start)).and_then(|(fields, home)| {
            let field = fields.iter().find(|field| field.name.key() == name.key())?;
            Some((field.spec.clone(), home.clone()))
        });
        found.map_or(Ty::Unknown, |(spec, home)| self.type_of(&spec, &home, 0))
    }

    /// The text of a bound that means the same in the file of stubs: of numbers and global constants.
    fn bound(&self, expr: &Expr, home: &Home) -> Option<String> {
        if let Some(value) = number(expr) {
            return Some(value.to_string());
        }
        match &expr.kind {
            ExprKind::Paren(inner) => self.bound(inner, home),
            ExprKind::Binary(op @ (BinaryOp::Add | BinaryOp::Subtract | BinaryOp::Multiply), left, right) => {
                Some(format!("({} {} {})", self.bound(left, home)?, op.text(), self.bound(right, home)?))
            }
            _ => {
                let path = path_of(expr)?;
                let key = path.iter().map(|name| name.key()).collect::<Vec<_>>().join(".");
                let known = self.world.global_key(home, &key);
                let foreign = self.needs.globals.get(&key).filter(|global| global.is_constant);
                known.or_else(|| foreign.map(|global| global.name.clone()))
            }
        }
    }

    /// What a type's name means; what it names is foreign if nobody declares it.
    pub(super) fn named(&mut self, name: &Ident, home: &Home, depth: u8) -> Ty {
        if let Some((template, given)) = name.text.split_once('<') {
            let ty = self.named(&Ident { text: template.to_owned(), span: name.span }, home, depth);
            if let Ty::Foreign(key) = &ty {
                let found = self.foreign(key);
                found.constants = found.constants.max(arguments_in(given));
            }
            return ty;
        }
        let key = name.key();
        if let Some(elementary) = ElementaryType::find(&key) {
            return Ty::Elementary(elementary);
        }
        if let Some(elementary) = of_pointer_width(&key, self.world.word_size(name.span)) {
            return Ty::Elementary(elementary);
        }
        match key.as_str() {
            "STRING" => return Ty::Text(false),
            "WSTRING" => return Ty::Text(true),
            "BIT" => return Ty::Elementary(ElementaryType::Bool),
            _ if key.starts_with("ANY") && super::is_generic(&key) => return Ty::Any,
            _ => {}
        }
        if let Some(unit) = self.world.unit_key(home, &key) {
            return Ty::Declared(unit);
        }
        if let Some(found) = self.world.type_key(home, &key) {
            let Some(named) = self.world.types.get(&found) else { return Ty::Unknown };
            return match &named.ast.spec.kind {
                TypeSpecKind::Struct(_)
                | TypeSpecKind::Union(_)
                | TypeSpecKind::Overlapping(_)
                | TypeSpecKind::Enumeration(..) => Ty::Declared(found),
                _ if depth < MAX_DEPTH => self.type_of(&named.ast.spec, &named.home.clone(), depth + 1),
                _ => Ty::Unknown,
            };
        }
        self.foreign_named(name, home)
    }

    fn foreign_named(&mut self, name: &Ident, home: &Home) -> Ty {
        if self.needs.shadowed.contains(&name.key()) {
            let key = name.key();
            self.foreign(&key).name.clone_from(&name.text);
            return Ty::Foreign(key);
        }
        let first = name.text.split_once('.').map(|(first, rest)| (first, first.to_ascii_uppercase(), rest));
        let own = |key: &str| self.world.is_namespace(home, key) && !self.world.is_library(key);
        let Some((first, library, rest)) = first.filter(|(_, key, _)| !own(key)) else {
            // A namespace that is declared lacks it.
            let key = name.key();
            let found = self.foreign_type(key.clone());
            if found == Ty::Foreign(key.clone()) {
                self.foreign(&key).name.clone_from(&name.text);
            }
            return found;
        };
        // A name in front of a type's is that of a library.
        if !self.world.is_namespace(home, &library) {
            self.needs.libraries.entry(library).or_insert_with(|| first.to_owned());
        }
        let inner = Ident { text: rest.to_owned(), span: name.span };
        self.named(&inner, home, MAX_DEPTH - 1)
    }

    pub(super) fn foreign(&mut self, key: &str) -> &mut Foreign {
        let slots = &mut self.slots;
        self.needs.types.entry(key.to_owned()).or_insert_with(|| Foreign {
            name: key.to_owned(),
            value: Some(slots.of(&format!("type:{key}"))),
            ..Foreign::default()
        })
    }

    fn unit(&mut self, key: &str, unit: &'a Unit<'a>) {
        if unit.pou.external {
            return;
        }
        let is_function = unit.pou.kind == PouKind::Function;
        let class = (!is_function).then(|| key.to_owned());
        let scope = Scope { home: unit.home.clone(), class, local: is_function.then_some(unit.pou) };
        self.body(unit.pou, &scope);
        for member in &unit.pou.object.members {
            let scope = Scope { local: Some(&member.pou), ..scope.clone() };
            self.body(&member.pou, &scope);
        }
    }

    fn body(&mut self, pou: &'a Pou, scope: &Scope<'a>) {
        pou.result.iter().for_each(|result| self.constants_of(result, scope));
        pou.sections.iter().for_each(|section| self.initials(section, scope));
        for association in pou.chart.steps.iter().flat_map(|step| &step.associations) {
            association.time.iter().for_each(|time| self.wanted(time, &elementary(ElementaryType::Time), scope));
        }
        for transition in &pou.chart.transitions {
            match &transition.condition {
                TransitionCondition::Expression(condition) => self.condition(condition, scope),
                TransitionCondition::Network(network) => self.statements(network, scope),
            }
        }
        self.statements(&pou.body, scope);
    }
}

pub(super) fn elementary(ty: ElementaryType) -> Ty {
    Ty::Elementary(ty)
}

fn number(expr: &Expr) -> Option<i128> {
    match &expr.kind {
        ExprKind::Literal(Literal::Integer(value)) => Some(*value),
        ExprKind::Unary(onescan_iec::syntax::ast::UnaryOp::Negate, inner) => number(inner).map(|value| -value),
        ExprKind::Paren(inner) => number(inner),
        _ => None,
    }
}

/// How many constants a generic block is given, by the text behind its name.
fn arguments_in(given: &str) -> usize {
    let mut depth = 0_u32;
    let mut count = 1;
    for character in given.chars() {
        match character {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            ',' if depth == 0 => count += 1,
            _ => {}
        }
    }
    count
}

/// The names of `a.b.c`, if it is nothing else.
pub(super) fn path_of(expr: &Expr) -> Option<Vec<&Ident>> {
    match &expr.kind {
        ExprKind::Name(name) => (!name.text.starts_with('`')).then(|| vec![name]),
        ExprKind::Member(base, name) => {
            let mut path = path_of(base)?;
            path.push(name);
            Some(path)
        }
        _ => None,
    }
}
