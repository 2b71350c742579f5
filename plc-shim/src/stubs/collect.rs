//! What every declaration and statement wants of what nobody declares.

use super::foreign::{Foreign, Needs, Signature};
use super::names::Access;
use super::ty::{Slots, Ty};
use super::world::{Home, Part, Unit, World};
use crate::ElementaryType;
use crate::syntax::ast::{
    Argument, Expr, ExprKind, Ident, InitArguments, Initialiser, InitialiserKind, Literal, Pou, PouKind, Section,
    Statement, StatementKind, TransitionCondition, TypeSpec, TypeSpecKind, UpdateOp,
};

/// Greatest number of types that stand for one another in a row.
const MAX_DEPTH: u8 = 40;

/// One pass over the project.
pub(super) struct Collector<'a> {
    pub(super) world: &'a World<'a>,
    pub(super) slots: Slots,
    pub(super) needs: Needs,
    /// Heads as an earlier pass has found them; nothing in the first one.
    pub(super) known: Option<std::collections::BTreeMap<String, super::foreign::Head>>,
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
        for (key, unit) in &world.units {
            if !unit.library {
                self.unit(key, unit);
            }
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
                fields.iter().for_each(|field| self.spec(&field.spec, home, &[&field.name.text]));
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
                let bounds = dimensions.iter().map(|each| match (number(&each.low), number(&each.high)) {
                    (Some(low), Some(high)) => format!("{low}..{high}"),
                    _ => super::ty::ANY_BOUNDS.to_owned(),
                });
                Ty::Array(bounds.collect(), Box::new(self.type_of(inner, home, depth)))
            }
            TypeSpecKind::OpenArray(count, inner) => {
                let bounds = (0..*count).map(|_| super::ty::ANY_BOUNDS.to_owned()).collect();
                Ty::Array(bounds, Box::new(self.type_of(inner, home, depth)))
            }
            TypeSpecKind::Reference(kind, inner) => Ty::Pointer(*kind, Box::new(self.type_of(inner, home, depth))),
            _ => Ty::Unknown,
        }
    }

    /// What a type's name means; what it names is foreign if nobody declares it.
    pub(super) fn named(&mut self, name: &Ident, home: &Home, depth: u8) -> Ty {
        let key = name.key();
        if let Some(elementary) = ElementaryType::find(&key) {
            return Ty::Elementary(elementary);
        }
        match key.as_str() {
            "STRING" => return Ty::Text(false),
            "WSTRING" => return Ty::Text(true),
            "BIT" => return Ty::Elementary(ElementaryType::Bool),
            _ if key.starts_with("ANY") && super::is_generic(&key) => return Ty::Unknown,
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
            self.foreign(&key).name.clone_from(&name.text);
            return Ty::Foreign(key);
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

    fn initials(&mut self, section: &Section, scope: &Scope<'a>) {
        for variable in &section.variables {
            self.constants_of(&variable.spec, scope);
            let ty = self.type_of(&variable.spec, &scope.home, 0);
            if let Some(initial) = &variable.initial {
                self.initial(&ty, initial, scope);
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
        for list in lists {
            let Some(key) = &foreign else {
                list.iter().for_each(|argument| self.plain_argument(argument, scope));
                continue;
            };
            let path = format!("{key}.FB_init");
            let mut signature = self.foreign(key).init.take().unwrap_or_default();
            self.arguments(&mut signature, &path, list, scope);
            self.foreign(key).init = Some(signature);
        }
    }

    fn plain_argument(&mut self, argument: &Argument, scope: &Scope<'a>) {
        match argument {
            Argument::Positional(value) | Argument::Input(_, value) => {
                self.infer(value, scope);
            }
            Argument::Output { target, .. } => {
                target.iter().for_each(|target| {
                    self.place(target, Access::Write, scope);
                });
            }
        }
    }

    /// Bounds and lengths are constants.
    fn constants_of(&mut self, spec: &TypeSpec, scope: &Scope<'a>) {
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
            TypeSpecKind::String(_, Some(length)) => self.constant(length, scope),
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
            TypeSpecKind::Enumeration(values, _) => {
                values.iter().filter_map(|each| each.value.as_ref()).for_each(|value| self.constant(value, scope));
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

    fn constant(&mut self, expr: &Expr, scope: &Scope<'a>) {
        let found = self.place(expr, Access::Constant, scope);
        self.flow(&found, &Ty::Integer);
        if let Ty::Slot(slot) = found {
            self.slots.given(slot, &Ty::Integer);
        }
    }

    fn initial(&mut self, ty: &Ty, initial: &Initialiser, scope: &Scope<'a>) {
        match &initial.kind {
            InitialiserKind::Value(value) => self.wanted(value, ty, scope),
            InitialiserKind::Array(values) => {
                let element = self.element(ty, 1);
                values.iter().for_each(|value| self.initial(&element, value, scope));
            }
            InitialiserKind::Repeat(count, value) => {
                self.constant(count, scope);
                value.iter().for_each(|value| self.initial(ty, value, scope));
            }
            InitialiserKind::Struct(values) => {
                for each in values {
                    let member = self.member(ty, &each.name, Access::Initial, false);
                    self.initial(&member, &each.value, scope);
                }
            }
            InitialiserKind::Elements(elements) => {
                elements.iter().for_each(|element| self.initial(&Ty::Unknown, &element.value, scope));
            }
        }
    }

    fn statements(&mut self, list: &[Statement], scope: &Scope<'a>) {
        list.iter().for_each(|statement| self.statement(&statement.kind, scope));
    }

    fn condition(&mut self, expr: &Expr, scope: &Scope<'a>) {
        self.wanted(expr, &elementary(ElementaryType::Bool), scope);
    }

    /// An expression whose value goes to what is of a type.
    pub(super) fn wanted(&mut self, expr: &Expr, ty: &Ty, scope: &Scope<'a>) {
        let found = self.infer(expr, scope);
        self.flow(&found, ty);
    }

    fn statement(&mut self, kind: &StatementKind, scope: &Scope<'a>) {
        match kind {
            StatementKind::Assign(target, value)
            | StatementKind::Attempt(target, value)
            | StatementKind::Refer(target, value) => {
                let target = self.place(target, Access::Write, scope);
                self.wanted(value, &target, scope);
            }
            StatementKind::Chain(targets, value) => {
                let value = self.infer(value, scope);
                for target in targets {
                    let target = self.place(target, Access::Write, scope);
                    self.flow(&value, &target);
                }
            }
            StatementKind::Update(op, target, value) => {
                let target = self.place(target, Access::Write, scope);
                if matches!(op, UpdateOp::Set | UpdateOp::Reset) {
                    self.flow(&elementary(ElementaryType::Bool), &target);
                    self.condition(value, scope);
                } else {
                    self.wanted(value, &target, scope);
                }
            }
            StatementKind::Call(call) => {
                self.call(call, false, scope);
            }
            StatementKind::If(inner) => {
                for branch in &inner.branches {
                    self.condition(&branch.condition, scope);
                    self.statements(&branch.body, scope);
                }
                self.statements(&inner.otherwise, scope);
            }
            StatementKind::Case(inner) => {
                let selector = self.infer(&inner.selector, scope);
                for branch in &inner.branches {
                    for label in &branch.labels {
                        for value in [Some(&label.low), label.high.as_ref()].into_iter().flatten() {
                            let label = self.place(value, Access::Constant, scope);
                            self.beside(&label, &selector);
                        }
                    }
                    self.statements(&branch.body, scope);
                }
                self.statements(&inner.otherwise, scope);
            }
            StatementKind::For(inner) => {
                let variable = self.place(&inner.variable, Access::Write, scope);
                self.flow(&Ty::Integer, &variable);
                for value in [Some(&inner.from), Some(&inner.to), inner.by.as_ref()].into_iter().flatten() {
                    self.wanted(value, &variable, scope);
                }
                self.statements(&inner.body, scope);
            }
            StatementKind::While(inner) => {
                self.condition(&inner.condition, scope);
                self.statements(&inner.body, scope);
            }
            StatementKind::Repeat(inner) => {
                self.statements(&inner.body, scope);
                self.condition(&inner.until, scope);
            }
            _ => {}
        }
    }

    /// A value of one type goes to what is of another.
    pub(super) fn flow(&mut self, from: &Ty, to: &Ty) {
        if from == to {
            return;
        }
        if let Ty::Slot(slot) = from {
            self.slots.taken(*slot, to);
        }
        if let Ty::Slot(slot) = to {
            self.slots.given(*slot, from);
        }
        if let (Ty::Pointer(_, from), Ty::Pointer(_, to)) | (Ty::Array(_, from), Ty::Array(_, to)) = (from, to) {
            self.beside(&from.clone(), &to.clone());
        }
        let (from, to) = (self.slots.resolved(from), self.slots.resolved(to));
        if from == to {
            return;
        }
        if let Some(slot) = self.value_of(&from) {
            self.slots.taken(slot, &to);
        }
        if let Some(slot) = self.value_of(&to) {
            self.slots.given(slot, &from);
        }
    }

    /// Two values that are compared or joined.
    pub(super) fn beside(&mut self, one: &Ty, other: &Ty) {
        for (one, other) in [(one, other), (other, one)] {
            if let Ty::Slot(slot) = one {
                self.slots.beside(*slot, other);
            }
            let (one, other) = (self.slots.resolved(one), self.slots.resolved(other));
            if let Some(slot) = self.value_of(&one)
                && one != other
            {
                self.slots.beside(slot, &other);
            }
        }
    }

    fn value_of(&self, ty: &Ty) -> Option<super::ty::Slot> {
        let Ty::Foreign(key) = ty else { return None };
        self.needs.types.get(key).and_then(|found| found.value)
    }

    /// The members of a class by the unit that declares them, its bases last.
    pub(super) fn find(&mut self, class: &str, name: &str) -> Option<Found<'a>> {
        let key = name.to_ascii_uppercase();
        let mut open = std::collections::VecDeque::from([class.to_owned()]);
        let mut seen = std::collections::BTreeSet::new();
        let mut foreign = None;
        while let Some(next) = open.pop_front() {
            if !seen.insert(next.clone()) {
                continue;
            }
            if let Some(unit) = self.world.units.get(&next) {
                if let Some((spec, _)) = unit.variables.get(&key) {
                    return Some(Found::Variable(self.type_of(spec, &unit.home, 0)));
                }
                if let Some(method) = unit.members.get(&(Part::Method, key.clone())) {
                    return Some(Found::Method(method, unit.home.clone()));
                }
                if let Some(property) = unit.members.get(&(Part::Property, key.clone())) {
                    let ty = property.result.as_ref().map_or(Ty::Unknown, |spec| self.type_of(spec, &unit.home, 0));
                    return Some(Found::Variable(ty));
                }
                if unit.pou.external && !unit.library && unit.pou.kind != PouKind::Function {
                    foreign = foreign.or_else(|| Some(next.clone()));
                    let (name, found) = (unit.pou.name.text.clone(), self.foreign(&next));
                    found.name = name;
                    found.extends_stub = true;
                }
                for base in &unit.pou.object.extends {
                    match self.named(base, &unit.home, 0) {
                        Ty::Declared(base) => open.push_back(base),
                        Ty::Foreign(key) => foreign = foreign.or(Some(key)),
                        _ => {}
                    }
                }
            } else if let Some(named) = self.world.types.get(&next) {
                if let TypeSpecKind::Struct(fields) | TypeSpecKind::Union(fields) | TypeSpecKind::Overlapping(fields) =
                    &named.ast.spec.kind
                    && let Some(field) = fields.iter().find(|field| field.name.key() == key)
                {
                    return Some(Found::Variable(self.type_of(&field.spec, &named.home, 0)));
                }
                if let TypeSpecKind::Enumeration(values, _) = &named.ast.spec.kind
                    && values.iter().any(|value| value.name.key() == key)
                {
                    return Some(Found::Variable(Ty::Declared(next)));
                }
                if named.ast.external {
                    foreign = foreign.or_else(|| Some(next.clone()));
                    let (name, found) = (named.ast.name.text.clone(), self.foreign(&next));
                    found.name = name;
                    found.extends_stub = true;
                }
                if let Some(base) = &named.ast.extends {
                    match self.named(base, &named.home, 0) {
                        Ty::Declared(base) => open.push_back(base),
                        Ty::Foreign(key) => foreign = foreign.or(Some(key)),
                        _ => {}
                    }
                }
            }
        }
        foreign.map(Found::Foreign)
    }

    /// The base of a class that nobody declares, if it has one.
    pub(super) fn foreign_base(&mut self, class: &str) -> Option<String> {
        // No unit has a member of this name.
        match self.find(class, "\u{0}") {
            Some(Found::Foreign(key)) => Some(key),
            _ => None,
        }
    }

    pub(super) fn arguments(&mut self, signature: &mut Signature, path: &str, list: &[Argument], scope: &Scope<'a>) {
        // Names and places may be mixed: what has no name is counted with what has.
        let mut given = 0;
        for argument in list {
            let position = given;
            given += usize::from(!matches!(argument, Argument::Output { .. }));
            match argument {
                Argument::Positional(value) => {
                    let found = self.infer(value, scope);
                    let is_place = is_place(value);
                    while signature.positional.len() <= position {
                        let slot = self.slots.of(&format!("{path}.p{}", signature.positional.len() + 1));
                        signature.positional.push(super::foreign::Argument { slot, is_place: true });
                    }
                    if let Some(parameter) = signature.positional.get_mut(position) {
                        parameter.is_place &= is_place;
                        let slot = parameter.slot;
                        self.flow(&found, &Ty::Slot(slot));
                    }
                }
                Argument::Input(name, value) => {
                    let found = self.infer(value, scope);
                    let slot = self.slots.of(&format!("{path}.{}", name.text));
                    let is_place = is_place(value);
                    match signature.named.iter_mut().find(|(known, _)| known.eq_ignore_ascii_case(&name.text)) {
                        Some((_, known)) => known.is_place &= is_place,
                        None => {
                            let argument = super::foreign::Argument { slot, is_place };
                            signature.named.push((name.text.clone(), argument));
                        }
                    }
                    self.flow(&found, &Ty::Slot(slot));
                }
                Argument::Output { name, target, .. } => {
                    let slot = self.slots.of(&format!("{path}.{}", name.text));
                    if !signature.outputs.iter().any(|(known, _)| known.eq_ignore_ascii_case(&name.text)) {
                        signature.outputs.push((name.text.clone(), slot));
                    }
                    if let Some(target) = target {
                        let target = self.place(target, Access::Write, scope);
                        self.flow(&Ty::Slot(slot), &target);
                    }
                }
            }
        }
    }
}

/// What a name of a class means.
pub(super) enum Found<'a> {
    /// A variable or property.
    Variable(Ty),
    Method(&'a Pou, Home),
    /// A base that nobody declares may have it.
    Foreign(String),
}

pub(super) fn elementary(ty: ElementaryType) -> Ty {
    Ty::Elementary(ty)
}

fn number(expr: &Expr) -> Option<i128> {
    match &expr.kind {
        ExprKind::Literal(Literal::Integer(value)) => Some(*value),
        ExprKind::Unary(crate::syntax::ast::UnaryOp::Negate, inner) => number(inner).map(|value| -value),
        ExprKind::Paren(inner) => number(inner),
        _ => None,
    }
}

/// True for what has an address.
fn is_place(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Name(_) | ExprKind::Member(..) | ExprKind::Index(..) | ExprKind::Dereference(_) => true,
        ExprKind::Paren(inner) => is_place(inner),
        _ => false,
    }
}
