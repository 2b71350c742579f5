//! `__NEW` and `__DELETE` of CODESYS and TwinCAT: instances and arrays that a program makes while it runs.
//!
//! The memory is that of `OnescanMemory` in the libraries here, which belongs to the program's variables: what is taken
//! where depends on the calls alone, and a saved state has all of it.

use crate::check::body::Body;
use crate::check::declare::Occasion;
use crate::check::types::build::{assign, load, operation, when};
use crate::check::types::operand::{Operand, constant, converted};
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{
    Argument, Binary, Cast, ElementaryType, Expr, ExprKind, FunctionCall, LocalId, Place, PouId, Rounding, Statement,
    StatementKind, Storage, Type, TypeId, TypeTable, Value,
};
use crate::syntax::Span;
use crate::syntax::ast::{self, Call, ReferenceKind};

const ADDRESS: ElementaryType = ElementaryType::Udint;
const TAKE: &str = "ONESCANMEMORY.TAKE";
const GIVE_BACK: &str = "ONESCANMEMORY.GIVEBACK";

/// What is done with memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::check) enum DynamicMemory {
    New,
    Delete,
}

impl DynamicMemory {
    /// The operator of this name, in capitals.
    pub(in crate::check) fn find(key: &str) -> Option<Self> {
        match key {
            "__NEW" => Some(Self::New),
            "__DELETE" => Some(Self::Delete),
            _ => None,
        }
    }
}

/// What `__NEW` is to make.
struct Wanted<'e> {
    ty: TypeId,
    /// What `FB_init` is given.
    given: &'e [ast::Argument],
    /// How many of them; one, if there is nothing.
    count: Option<Expr>,
    span: Span,
}

impl Body<'_, '_> {
    pub(super) fn dynamic_memory_call(&mut self, operator: DynamicMemory, call: &Call, span: Span) -> Option<Operand> {
        let given: Vec<&ast::Expr> = call.arguments.iter().filter_map(positional).collect();
        match (operator, &given[..]) {
            (DynamicMemory::New, [written]) => self.made(written, None, span),
            (DynamicMemory::New, [written, count]) => self.made(written, Some(count), span),
            (DynamicMemory::Delete, [pointer]) => self.deleted(pointer, span),
            (DynamicMemory::New, _) => self.wrong_count("__NEW takes a type and, of an array, its length", span),
            (DynamicMemory::Delete, _) => self.wrong_count("__DELETE takes one pointer", span),
        }
    }

    fn wrong_count<T>(&mut self, message: &str, span: Span) -> Option<T> {
        self.report(Diagnostic::error(Code::MissingArgument, span, message));
        None
    }

    /// `__NEW(T)`, `__NEW(FB(a := x))`, `__NEW(T, n)`: the address, or 0 if there is no memory left.
    fn made(&mut self, written: &ast::Expr, count: Option<&ast::Expr>, span: Span) -> Option<Operand> {
        let (named, given) = match &written.kind {
            ast::ExprKind::Call(inner) => (&*inner.callee, inner.arguments.as_slice()),
            _ => (written, [].as_slice()),
        };
        let Some(ty) = self.text_type_written(written).or_else(|| self.type_named(named)) else {
            let message = "a type is wanted here";
            self.report(Diagnostic::error(Code::NotAVariable, named.span, message));
            return None;
        };
        let ty = ty?;
        let count = match count {
            Some(count) => Some(self.expression_of(count, ElementaryType::Lint)?),
            None => None,
        };
        let pointer = self.declarations.types_mut().reference(Some(ReferenceKind::Pointer), ty);
        let (address, statements) = self.making(&Wanted { ty, given, count, span })?;
        let value = Expr { ty: pointer, ..load(&Self::number(address, span)) };
        let kind = ExprKind::After(statements, Some(Box::new(value)));
        Some(Operand::Typed(Expr { kind, ty: pointer, span }))
    }

    fn number(register: LocalId, span: Span) -> Place {
        Place::whole(Storage::Register(register), ADDRESS.into(), span)
    }

    /// Takes the memory and begins what lies in it.
    fn making(&mut self, wanted: &Wanted<'_>) -> Option<(LocalId, Vec<Statement>)> {
        let span = wanted.span;
        let size = self.declarations.types().size(wanted.ty);
        let unsigned = |value: u32| constant(Value::Int(i128::from(value)), ADDRESS, span);
        let [address, at, left] = std::array::from_fn(|_| self.scope.register(ADDRESS));
        let [address_place, at_place, left_place] = [address, at, left].map(|register| Self::number(register, span));
        let mut statements = Vec::new();
        let is_array = wanted.count.is_some();
        let bytes = match wanted.count.clone() {
            Some(count) => {
                // What does not fit 32 bits fits no memory.
                let length = self.scope.register(ElementaryType::Lint);
                let length = Place::whole(Storage::Register(length), ElementaryType::Lint.into(), span);
                statements.push(assign(&length, count));
                let most = constant(Value::Int(i128::from(u32::MAX / size.max(1))), ElementaryType::Lint, span);
                let none = constant(Value::Int(0), ElementaryType::Lint, span);
                let bool = ElementaryType::Bool.into();
                let too_many = Expr { ty: bool, ..operation(Binary::Greater, load(&length), most) };
                let too_few = Expr { ty: bool, ..operation(Binary::LessEqual, load(&length), none) };
                let wrong = operation(Binary::Or, too_many, too_few);
                let number = converted(load(&length), ADDRESS, Rounding::NearestEven);
                statements.push(assign(&left_place, number));
                let product = operation(Binary::Multiply, load(&left_place), unsigned(size));
                let kind = ExprKind::Conditional(Box::new([wrong, unsigned(u32::MAX), product]));
                Expr { kind, ty: ADDRESS.into(), span }
            }
            None => unsigned(size),
        };
        let taken = self.memory_function(TAKE, bytes, ADDRESS, span)?;
        statements.push(assign(&address_place, taken));
        let element = Place::whole(Storage::RegisterPointer(if is_array { at } else { address }), wanted.ty, span);
        let mut begun = self.begun(&element, wanted);
        if is_array {
            begun.push(assign(&at_place, operation(Binary::Add, load(&at_place), unsigned(size))));
            begun.push(assign(&left_place, operation(Binary::Subtract, load(&left_place), unsigned(1))));
            let more = is_not_zero(load(&left_place));
            begun = vec![
                assign(&at_place, load(&address_place)),
                Statement { kind: StatementKind::While(more, begun), span },
            ];
        }
        statements.push(when(is_not_zero(load(&address_place)), begun, span));
        Some((address, statements))
    }

    /// Initial values, and what a start of the type does.
    fn begun(&mut self, place: &Place, wanted: &Wanted<'_>) -> Vec<Statement> {
        let image = self.declarations.types().image(wanted.ty).clone();
        let mut statements = vec![self.given_bytes(place.clone(), &image)];
        if let Type::FunctionBlock { pou, .. } = *self.declarations.types().get(wanted.ty) {
            let stage = self.declarations.stage(pou, Occasion::Start);
            statements.extend(stage.and_then(|stage| self.stage_call(place, stage, wanted.span)));
            statements.extend(self.init_calls(place, pou, wanted.given));
            let stage = self.declarations.stage(pou, Occasion::AfterStart);
            statements.extend(stage.and_then(|stage| self.stage_call(place, stage, wanted.span)));
            statements.extend(self.after_init_calls(place, pou));
        } else {
            statements.extend(self.structure_performs(place, Occasion::Start));
            statements.extend(self.structure_performs(place, Occasion::AfterStart));
        }
        statements
    }

    /// What the members of a structure do at an occasion.
    fn structure_performs(&mut self, place: &Place, occasion: Occasion) -> Vec<Statement> {
        let Type::Struct { name, .. } = self.declarations.types().get(place.ty).clone() else { return Vec::new() };
        let Some(key) = self.declarations.type_key(&name.to_ascii_uppercase()) else { return Vec::new() };
        let starts = self.declarations.named_type(&key, Some(place.span)).map(|found| found.starts);
        starts.map(|starts| self.performed(place, &starts, occasion)).unwrap_or_default()
    }

    /// `__DELETE(p)`: ends what `p` leads to, gives its memory back and makes `p` 0; nothing if it is 0 already.
    fn deleted(&mut self, pointer: &ast::Expr, span: Span) -> Option<Operand> {
        if pointer.names_the_object() {
            return self.deleted_itself(pointer, span);
        }
        let place = self.target(pointer)?;
        let ended = match *self.declarations.types().get(place.ty) {
            Type::Reference { kind: ReferenceKind::Pointer, target } => target,
            Type::Interface { .. } => place.ty,
            _ => {
                let found = self.type_name(place.ty);
                return self.mismatch("a pointer or an interface", &found, pointer.span);
            }
        };
        let held = Expr { ty: ADDRESS.into(), ..load(&place) };
        let null = constant(Value::Int(0), ADDRESS, span);
        let after = assign(&place, Expr { ty: place.ty, ..null });
        self.given_back(held, ended, Some(after), span)
    }

    /// `__DELETE(THIS)`: an instance that gives itself back.
    fn deleted_itself(&mut self, pointer: &ast::Expr, span: Span) -> Option<Operand> {
        let operand = self.within(None, |body| body.expression(pointer))?;
        let object = self.settle(operand)?;
        let (ty, address) = (object.ty, Expr { ty: ADDRESS.into(), ..object });
        self.given_back(address, ty, None, span)
    }

    /// Ends what lies at an address and gives its memory back, if that is not 0.
    fn given_back(&mut self, held: Expr, ended: TypeId, after: Option<Statement>, span: Span) -> Option<Operand> {
        let address = self.scope.register(ADDRESS);
        let number = Self::number(address, span);
        let mut statements = vec![assign(&number, held)];
        let mut ending = self.ending(address, ended, span);
        let given_back = self.memory_function(GIVE_BACK, load(&number), ElementaryType::Bool, span)?;
        ending.push(Statement { kind: StatementKind::Evaluate(given_back), span });
        ending.extend(after);
        statements.push(when(is_not_zero(load(&number)), ending, span));
        let kind = ExprKind::After(statements, None);
        Some(Operand::Typed(Expr { kind, ty: TypeTable::nothing(), span }))
    }

    /// `FB_exit` and the like of what lies at an address.
    fn ending(&mut self, address: LocalId, ty: TypeId, span: Span) -> Vec<Statement> {
        let (Type::FunctionBlock { pou, .. } | Type::Interface { pou, .. }) = *self.declarations.types().get(ty) else {
            let place = Place::whole(Storage::RegisterPointer(address), ty, span);
            return self.structure_performs(&place, Occasion::End);
        };
        let variants = self.declarations.variants(pou);
        let mut statements = Vec::new();
        for variant in &variants {
            let done = self.variant_ending(address, *variant, span);
            if done.is_empty() {
                continue;
            }
            match self.declarations.class(*variant).and_then(|class| class.type_id) {
                Some(number) if variants.len() > 1 => {
                    let reference = load(&Self::number(address, span));
                    let pointer = self.scope.register(ADDRESS);
                    let cast = Cast { reference, pointer, types: vec![(number, number)] };
                    let kind = ExprKind::Cast(Box::new(cast));
                    let is_it = is_not_zero(Expr { kind, ty: ADDRESS.into(), span });
                    statements.push(when(is_it, done, span));
                }
                _ => statements.extend(done),
            }
        }
        statements
    }

    fn variant_ending(&mut self, address: LocalId, pou: PouId, span: Span) -> Vec<Statement> {
        let name = self.declarations.pou(pou).ast().name.text.clone();
        let ty = self.declarations.types_mut().block(&name, pou);
        let place = Place::whole(Storage::RegisterPointer(address), ty, span);
        let mut statements = self.exit_calls(&place, pou);
        let stage = self.declarations.stage(pou, Occasion::End);
        statements.extend(stage.and_then(|stage| self.stage_call(&place, stage, span)));
        statements
    }

    /// A call of a function of the memory's own.
    fn memory_function(&mut self, key: &str, argument: Expr, result: ElementaryType, span: Span) -> Option<Expr> {
        let Some(pou) = self.declarations.pou_named(key) else {
            let message = "the memory of __NEW is not there";
            self.report(Diagnostic::error(Code::VendorRuntime, span, message));
            return None;
        };
        self.declarations.interface(pou, span)?;
        self.note_call(pou, span);
        let call = FunctionCall {
            pou,
            before: Vec::new(),
            arguments: vec![Argument::Value(argument)],
            receiver: None,
            outputs: Vec::new(),
            result: None,
        };
        Some(Expr { kind: ExprKind::Call(Box::new(call)), ty: result.into(), span })
    }
}

fn positional(argument: &ast::Argument) -> Option<&ast::Expr> {
    match argument {
        ast::Argument::Positional(expr) => Some(expr),
        ast::Argument::Input(..) | ast::Argument::Output { .. } => None,
    }
}

fn is_not_zero(value: Expr) -> Expr {
    let zero = constant(Value::Int(0), ADDRESS, value.span);
    let value = Expr { ty: ADDRESS.into(), ..value };
    Expr { ty: ElementaryType::Bool.into(), ..operation(Binary::NotEqual, value, zero) }
}
