//! What the turns of a loop do, found by a walk through its body before anything is made of it.
//!
//! The walk goes where the code will go: into units that are put in the place of calls, and past those that
//! are called. It need not be exact in what it counts, as that only decides what pays; but whatever the code
//! changes, the walk must have found.

use super::address::{Address, Base, Extent, Register};
use super::choice::Choice;
use super::drift::step_of;
use super::effect::Effects;
use super::nan::may_be_any_nan;
use super::price;
use super::program::Program;
use super::reach::RunsOn;
use super::scope::{INSTANCE, Scope, constant_index};
use super::size::leaves;
use crate::ir::text::{TextCall, TextFunction};
use crate::ir::{
    Argument, CaseStatement, Cast, Dispatch, ElementaryType, Expr, ExprKind, ForStatement, FunctionCall, IfBranch,
    InstanceCall, Intrinsic, Labelled, LocalId, MemoryFunction, Place, Pou, PouId, Receiver, Statement, StatementKind,
    Step, Storage, Unary,
};

/// Registers of units that only the walk enters are numbered from here on, where no function has any: WebAssembly
/// allows 50,000.
const FIRST_OWN_REGISTER: u32 = 1 << 31;

/// What a loop does.
#[derive(Debug)]
pub(crate) struct Survey {
    effects: Effects,
    cost: u64,
    leaves: bool,
    metered: bool,
}

impl Survey {
    /// Of the body of a FOR loop.
    pub(crate) fn of_body(program: &Program<'_>, scope: &Scope<'_>, leaving: u32, body: &[Statement]) -> Self {
        Walk::new(program, scope, leaving).survey(|walk| {
            walk.charge(price::LOOP);
            walk.turn(body);
        })
    }

    /// Of a FOR loop that sets its variable in every turn, and asks for it four times.
    pub(crate) fn of_for(program: &Program<'_>, scope: &Scope<'_>, leaving: u32, inner: &ForStatement) -> Self {
        Walk::new(program, scope, leaving).survey(|walk| walk.turns(inner))
    }

    /// Of the turns of a WHILE loop.
    pub(crate) fn of_while(
        program: &Program<'_>,
        scope: &Scope<'_>,
        leaving: u32,
        condition: &Expr,
        body: &[Statement],
    ) -> Self {
        Walk::new(program, scope, leaving).survey(|walk| {
            walk.expression(condition);
            walk.turn(body);
        })
    }

    /// Of the turns of a REPEAT loop.
    pub(crate) fn of_repeat(
        program: &Program<'_>,
        scope: &Scope<'_>,
        leaving: u32,
        body: &[Statement],
        until: &Expr,
    ) -> Self {
        Walk::new(program, scope, leaving).survey(|walk| {
            walk.turn(body);
            walk.expression(until);
        })
    }

    /// Of statements that jumps lead back into.
    pub(crate) fn of_labelled(program: &Program<'_>, scope: &Scope<'_>, leaving: u32, inner: &Labelled) -> Self {
        Walk::new(program, scope, leaving).survey(|walk| walk.parts(inner))
    }

    /// What the turns read and change.
    pub(crate) fn effects(&self) -> &Effects {
        &self.effects
    }

    pub(crate) fn effects_mut(&mut self) -> &mut Effects {
        &mut self.effects
    }

    /// What one turn costs, about.
    pub(crate) fn cost(&self) -> u64 {
        self.cost
    }

    /// True if nothing ends a turn early, and nothing inside pays for itself.
    pub(crate) fn is_plain(&self) -> bool {
        !self.leaves && !self.metered
    }
}

struct Walk<'w, 'p> {
    program: &'w Program<'p>,
    scope: Scope<'p>,
    /// How many branches are around that leave their unit.
    leaving: u32,
    next_register: u32,
    effects: Effects,
    cost: u64,
    leaves: bool,
    metered: bool,
}

impl<'w, 'p> Walk<'w, 'p> {
    fn new(program: &'w Program<'p>, scope: &Scope<'p>, leaving: u32) -> Self {
        Self {
            program,
            scope: scope.clone(),
            leaving,
            next_register: FIRST_OWN_REGISTER,
            effects: Effects::default(),
            cost: 0,
            leaves: false,
            metered: false,
        }
    }

    fn survey(mut self, walk: impl FnOnce(&mut Self)) -> Survey {
        walk(&mut self);
        let Self { effects, cost, leaves, metered, .. } = self;
        Survey { effects, cost, leaves, metered }
    }

    fn charge(&mut self, instructions: u64) {
        self.cost = self.cost.saturating_add(instructions);
    }

    fn statements(&mut self, list: &[Statement]) {
        for statement in list {
            self.statement(&statement.kind);
        }
    }

    fn statement(&mut self, kind: &StatementKind) {
        match kind {
            StatementKind::Assign(target, value) => self.assign(target, value),
            StatementKind::Copy(target, source) => {
                self.full_address(target);
                self.expression(source);
                self.charge(price::COPY);
                self.changed(self.scope.extent(target));
            }
            StatementKind::Bind(pointer, place) => self.store(pointer, |walk| walk.full_address(place)),
            StatementKind::Initialise(place, _) => {
                self.full_address(place);
                self.charge(price::COPY);
                self.changed(self.scope.extent(place));
            }
            StatementKind::Evaluate(expr) => self.expression(expr),
            StatementKind::CallInstance(call) => self.call_instance(call),
            StatementKind::If(branches, otherwise) => self.if_statement(branches, otherwise),
            StatementKind::Case(inner) => self.case_statement(inner),
            StatementKind::For(inner) => self.for_statement(inner),
            StatementKind::While(condition, body) => {
                self.metered = true;
                self.charge(price::PAYMENT);
                self.expression(condition);
                self.turn(body);
            }
            StatementKind::Repeat(body, until) => {
                self.metered = true;
                self.charge(price::PAYMENT);
                self.turn(body);
                self.expression(until);
            }
            StatementKind::Labelled(inner) if inner.register.is_some() => {
                self.metered = true;
                self.charge(price::PAYMENT);
                self.parts(inner);
            }
            StatementKind::Labelled(inner) => self.parts_once(inner),
            StatementKind::Exit | StatementKind::Continue | StatementKind::Return | StatementKind::Jump(_) => {
                self.charge(1);
                self.leaves = true;
            }
            StatementKind::Pass => {}
        }
    }

    fn assign(&mut self, target: &Place, value: &Expr) {
        if let Some((slot, ty, by)) = step_of(&self.scope, target, value) {
            self.effects.steps_mut().note(slot, ty, by);
        }
        self.store(target, |walk| walk.settled(value));
    }

    fn if_statement(&mut self, branches: &[IfBranch], otherwise: &[Statement]) {
        if !self.program.has_whole_branches()
            && let Some(Choice { target, condition, first, second }) = Choice::of(&self.scope, branches, otherwise)
        {
            self.store(target, |walk| {
                for expr in [first, second, condition] {
                    walk.expression(expr);
                }
                walk.charge(1);
            });
            return;
        }
        self.charge(2);
        for branch in branches {
            self.expression(&branch.condition);
            self.charge(price::BRANCH);
            self.leaving += u32::from(leaves(&branch.body));
            self.statements(&branch.body);
            self.leaving -= u32::from(leaves(&branch.body));
        }
        self.statements(otherwise);
    }

    fn case_statement(&mut self, inner: &CaseStatement) {
        self.expression(&inner.selector);
        self.set(self.scope.register(inner.register));
        let labels = inner.arms.iter().map(|arm| arm.labels.len() as u64).sum();
        self.charge(price::case(inner.arms.len() as u64, labels));
        for arm in &inner.arms {
            self.statements(&arm.body);
        }
        self.statements(&inner.otherwise);
    }

    fn for_statement(&mut self, inner: &ForStatement) {
        // It may turn out to end soon and not to pay, but what is around it pays for its turns then.
        self.metered = true;
        for (expr, local) in [(&inner.to, inner.last), (&inner.by, inner.step)] {
            self.expression(expr);
            self.set(self.scope.register(local));
        }
        self.store(&inner.variable, |walk| walk.expression(&inner.from));
        self.turns(inner);
    }

    /// The turns of a FOR loop that sets its variable.
    fn turns(&mut self, inner: &ForStatement) {
        self.charge(price::FOR);
        self.load(&inner.variable);
        self.turn(&inner.body);
        self.load(&inner.variable);
        self.load(&inner.variable);
        self.store(&inner.variable, |walk| walk.load(&inner.variable));
    }

    fn turn(&mut self, body: &[Statement]) {
        self.charge(price::TURN);
        self.effects.steps_mut().open_turn();
        self.statements(body);
        self.effects.steps_mut().close_turn();
    }

    /// What a part does may be done any number of times in a turn of a loop around.
    fn parts(&mut self, inner: &Labelled) {
        self.effects.steps_mut().open_turn();
        self.parts_once(inner);
        self.effects.steps_mut().close_turn();
    }

    fn parts_once(&mut self, inner: &Labelled) {
        if let Some(local) = inner.register {
            self.set(self.scope.register(local));
        }
        self.charge(price::BRANCH * (1 + inner.parts.len() as u64));
        self.statements(&inner.first);
        for (_, part) in &inner.parts {
            self.statements(part);
        }
    }

    fn call_instance(&mut self, call: &InstanceCall) {
        let address = self.instance_address(call);
        self.scope.point(call.pointer, address);
        self.statements(&call.inputs);
        let inlined = self.program.inlined(call.pou, &self.scope, self.leaving);
        match inlined.filter(|_| call.dispatch == Dispatch::Direct) {
            Some(pou) => {
                self.enter(call.pou, pou);
                self.scope.point(INSTANCE, address);
                self.body(pou);
            }
            None => {
                let size = self.scope.types().size(call.instance.ty);
                self.call(call.pou, call.dispatch, RunsOn::Instance(Extent::new(address, size)));
            }
        }
        self.statements(&call.outputs);
    }

    fn instance_address(&mut self, call: &InstanceCall) -> Address {
        if let Some(address) = self.scope.fixed_address(&call.instance) {
            return address;
        }
        let extent = self.scope.extent(&call.instance);
        self.full_address(&call.instance);
        let register = self.scope.register(call.pointer);
        self.set(register);
        self.scope.lead(register, extent);
        Address::of_register(register)
    }

    fn enter(&mut self, id: PouId, pou: &Pou) {
        let first = self.next_register;
        self.next_register = first.saturating_add(pou.registers.len() as u32);
        self.scope.enter(id, (first..self.next_register).map(Register::new).collect());
    }

    /// What an inlined unit does, which is left behind it.
    fn body(&mut self, pou: &Pou) {
        self.charge(2);
        self.statements(&pou.body);
        if let Some(result) = &pou.result {
            self.load(result);
        }
        self.scope.leave();
    }

    fn call(&mut self, pou: PouId, dispatch: Dispatch, on: RunsOn) {
        let costs = self.program.costs();
        if let Dispatch::Row(_) = dispatch {
            self.metered = true;
            self.charge(price::ROW_CALL);
            self.changed(None);
            return;
        }
        self.metered |= costs.is_metered(pou);
        self.charge(costs.of_call(pou).saturating_add(1));
        match on {
            RunsOn::Nothing if costs.stays_inside(pou) => {}
            RunsOn::Instance(extent) if costs.stays_inside(pou) => self.changed(Some(extent)),
            RunsOn::Nothing | RunsOn::Instance(_) | RunsOn::Anywhere => self.changed(None),
        }
    }

    fn call_function(&mut self, call: &FunctionCall) {
        if let Some(receiver) = &call.receiver {
            self.receiver(receiver);
            self.statements(&call.before);
            self.arguments(&call.arguments);
            self.call(call.pou, receiver.dispatch, RunsOn::Anywhere);
        } else {
            self.statements(&call.before);
            match self.program.inlined(call.pou, &self.scope, self.leaving) {
                Some(pou) => self.inline_function(call, pou),
                None => {
                    self.arguments(&call.arguments);
                    self.call(call.pou, Dispatch::Direct, RunsOn::Nothing);
                }
            }
        }
        if let Some(place) = &call.result {
            self.full_address(place);
            self.charge(price::COPY);
            self.changed(self.scope.extent(place));
            self.full_address(place);
        }
        self.statements(&call.outputs);
    }

    fn inline_function(&mut self, call: &FunctionCall, pou: &Pou) {
        let targets: Vec<_> = call.arguments.iter().map(|argument| self.scope.argument(argument)).collect();
        self.arguments(&call.arguments);
        self.enter(call.pou, pou);
        for (index, (address, extent)) in targets.into_iter().enumerate().rev() {
            let local = LocalId(index as u32);
            let register = self.scope.register(local);
            self.set(register);
            self.scope.lead(register, extent);
            if let Some(address) = address {
                self.scope.point(local, address);
            }
        }
        self.body(pou);
    }

    fn arguments(&mut self, arguments: &[Argument]) {
        for argument in arguments {
            match argument {
                Argument::Value(expr) => self.settled(expr),
                Argument::Reference(place) => self.full_address(place),
            }
        }
    }

    fn receiver(&mut self, receiver: &Receiver) {
        self.expression(&receiver.instance);
        self.points_anywhere(receiver.pointer);
        self.charge(if receiver.may_be_null { 5 } else { 0 });
    }

    fn cast(&mut self, cast: &Cast) {
        self.expression(&cast.reference);
        self.points_anywhere(cast.pointer);
        self.charge(3 + 7 * cast.types.len() as u64);
    }

    fn points_anywhere(&mut self, pointer: LocalId) {
        let register = self.scope.register(pointer);
        self.scope.lead(register, None);
        self.scope.unpoint(pointer);
        self.set(register);
    }

    fn settled(&mut self, expr: &Expr) {
        self.expression(expr);
        if may_be_any_nan(&self.scope, expr) {
            self.charge(price::CANONICAL);
        }
    }

    fn expression(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Constant(_) => self.charge(1),
            ExprKind::Load(place) => self.load(place),
            ExprKind::Address(place) => self.full_address(place),
            ExprKind::Unary(Unary::Negate, operand) if self.scope.held_as(operand.ty).is_real() => {
                self.settled(operand);
                self.charge(1);
            }
            ExprKind::Unary(_, operand) => {
                self.expression(operand);
                self.charge(price::unary(self.scope.held_as(operand.ty)));
            }
            ExprKind::Binary(operator, left, right) => {
                self.expression(left);
                self.expression(right);
                let by_constant = matches!(right.kind, ExprKind::Constant(_));
                self.charge(price::binary(*operator, self.scope.held_as(left.ty), by_constant));
            }
            ExprKind::Convert(_, operand) => {
                self.expression(operand);
                self.charge(price::conversion(self.scope.held_as(operand.ty), self.scope.held_as(expr.ty)));
            }
            ExprKind::Conditional(parts) => {
                self.expressions(&parts[..]);
                self.charge(price::BRANCH);
            }
            ExprKind::Limited(_, _, operand) => {
                self.expression(operand);
                self.charge(price::LIMITS);
            }
            ExprKind::Intrinsic(intrinsic, operands) => self.intrinsic(*intrinsic, operands, expr),
            ExprKind::Text(call) => self.text(call),
            ExprKind::Call(call) => self.call_function(call),
            ExprKind::Cast(cast) => self.cast(cast),
            ExprKind::After(statements, value) => {
                self.statements(statements);
                if let Some(value) = value {
                    self.expression(value);
                }
            }
        }
    }

    fn expressions(&mut self, list: &[Expr]) {
        for expr in list {
            self.expression(expr);
        }
    }

    fn intrinsic(&mut self, intrinsic: Intrinsic, operands: &[Expr], whole: &Expr) {
        let shift = matches!(intrinsic, Intrinsic::ShiftLeft | Intrinsic::ShiftRight);
        match operands {
            // The count is part of the instruction.
            [value, Expr { kind: ExprKind::Constant(_), .. }] if shift => {
                self.expression(value);
                self.charge(3);
                return;
            }
            _ => self.expressions(operands),
        }
        self.charge(price::intrinsic(intrinsic, operands.len() as u64, self.scope.held_as(whole.ty)));
        if let Intrinsic::Memory(MemoryFunction::Copy | MemoryFunction::Fill) = intrinsic {
            self.changed(None);
        }
    }

    fn text(&mut self, call: &TextCall) {
        self.expressions(&call.operands);
        if let Some(target) = &call.target {
            self.full_address(target);
        }
        self.charge(if call.function == TextFunction::Length { 6 } else { price::TEXT_CALL });
        let makes = matches!(call.function, TextFunction::Edit(_) | TextFunction::Format(_));
        if makes {
            self.changed(call.target.as_ref().and_then(|target| self.scope.extent(target)));
        }
    }

    fn load(&mut self, place: &Place) {
        let Some(ty) = self.scope.types().elementary(place.ty) else {
            self.full_address(place);
            return;
        };
        if place.part.is_some() {
            if !matches!(place.storage, Storage::Register(_)) {
                self.address(place);
            }
            self.charge(price::PART);
        } else if let Storage::Register(_) = place.storage {
            self.charge(1);
        } else if let Some(address) = self.scope.fixed_address(place) {
            self.load_at(address, ty);
        } else {
            self.address(place);
            self.charge(1);
        }
    }

    fn load_at(&mut self, address: Address, ty: ElementaryType) {
        let again = self.effects.loads_again(address, ty);
        self.charge(if again { price::HELD_LOAD } else { price::LOAD });
        self.effects.load(address, ty);
    }

    fn store(&mut self, place: &Place, value: impl FnOnce(&mut Self)) {
        if place.part.is_some() {
            if let Storage::Register(local) = place.storage {
                value(self);
                self.set(self.scope.register(local));
            } else {
                self.address(place);
                value(self);
            }
            self.charge(2 * price::PART);
            self.changed(self.scope.extent(place));
        } else if let Storage::Register(local) = place.storage {
            value(self);
            self.set(self.scope.register(local));
        } else if let Some(address) = self.scope.fixed_address(place) {
            value(self);
            self.store_at(address, self.scope.held_as(place.ty));
        } else {
            self.address(place);
            value(self);
            self.charge(1);
            self.changed(self.scope.extent(place));
        }
    }

    fn store_at(&mut self, address: Address, ty: ElementaryType) {
        self.charge(price::STORE);
        let extent = Extent::new(address, ty.size());
        match self.scope.roots().settled(extent, |register| self.effects.sets(register)) {
            settled if settled == extent => self.effects.store(address, ty),
            settled => self.effects.change(Some(settled)),
        }
    }

    fn set(&mut self, register: Register) {
        self.charge(1);
        self.effects.set(register);
    }

    /// Memory there is changed by other means than an elementary store; anywhere if nothing is known of it.
    fn changed(&mut self, extent: Option<Extent>) {
        let settled = |extent| self.scope.roots().settled(extent, |register| self.effects.sets(register));
        let extent = extent.map(settled);
        self.effects.change(extent);
    }

    fn address(&mut self, place: &Place) {
        let mut pushed = self.storage(place.storage);
        for step in &place.steps {
            match step {
                Step::Offset(_) => {}
                Step::Pointer { address, .. } => {
                    self.expression(address);
                    self.charge(price::REFERENCE);
                    pushed = true;
                }
                Step::Open { description, indices, .. } => {
                    self.full_address(description);
                    self.charge(price::open_element(indices.len() as u64));
                    self.expressions(indices);
                }
                Step::Index { index, low, count, stride } => {
                    if constant_index(index, *low, *count).is_none() {
                        self.expression(index);
                        let added = u64::from(pushed);
                        self.charge(price::index(self.scope.held_as(index.ty), *low, *stride) + added);
                        pushed = true;
                    }
                }
            }
        }
        self.charge(u64::from(!pushed));
    }

    /// True if the address that a variable begins at is not known, so that it must be fetched.
    fn storage(&mut self, storage: Storage) -> bool {
        match storage {
            Storage::InstancePointer(at) => {
                self.load_at(self.scope.pointer(INSTANCE).further(at), ElementaryType::Udint);
                true
            }
            Storage::AbsolutePointer(at) => {
                self.load_at(Address::absolute(at), ElementaryType::Udint);
                true
            }
            Storage::Absolute(_) | Storage::Located(_) | Storage::Instance(_) | Storage::RegisterPointer(_) => {
                let beginning = self.scope.beginning(storage);
                let register = matches!(beginning, Some(Address { base: Base::Register(_), .. }));
                self.charge(u64::from(register));
                register
            }
            Storage::Register(_) | Storage::Referred => false,
        }
    }

    fn full_address(&mut self, place: &Place) {
        match self.scope.fixed_address(place) {
            Some(Address { base: Base::Memory, .. }) => self.charge(1),
            _ => {
                self.address(place);
                self.charge(2);
            }
        }
    }
}
