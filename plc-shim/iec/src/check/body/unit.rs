//! The body of a unit, with what surrounds its statements (2nd ed. 2.4.3, 2.5).

use super::Body;
use super::call::enable::boolean;
use crate::check::declare::{Declarations, Occasion, is_hook};
use crate::check::types::build::{assign, load, not, operation};
use crate::check::types::constant::decode;
use crate::check::types::operand::constant;
use crate::check::types::parameter::is_control;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{
    Binary, EdgeDetection, ElementaryType, Expr, ExprKind, LocalId, Place, Pou, PouId, Statement, StatementKind,
    Storage, Variable,
};
use crate::syntax::ast::{Edge, PouKind, SectionKind};

/// Checks the body of a unit; nothing if its declaration is wrong as a whole.
pub(in crate::check) fn check_unit(declarations: &mut Declarations<'_>, id: PouId) -> Option<Pou> {
    let home = declarations.pou(id).home().clone();
    declarations.at_home(home, |declarations| {
        let span = declarations.pou(id).ast().name.span;
        let scope = declarations.interface(id, span)?;
        Some(Body::new(declarations, (*scope).clone(), Some(id)).into_unit(id))
    })
}

impl Body<'_, '_> {
    fn into_unit(mut self, id: PouId) -> Pou {
        self.is_running = true;
        let ast = self.declarations.pou(id).ast();
        let mut statements = self.prologue(ast.kind);
        // A prototype is called where a stub stands for what would have the method.
        let external = self.declarations.is_external(id) || self.declarations.is_prototype(id);
        if external {
            // What is done elsewhere does nothing here, whatever its text says.
        } else if let Some((owner, occasion)) = self.declarations.stage_of(id) {
            statements.extend(self.staged(owner, occasion));
        } else {
            statements.extend(self.open_views(id));
            statements.extend(self.chart(ast));
            statements.extend(self.statements(&ast.body));
        }
        if self.scope.result().is_some() && !self.result_assigned && !external && !is_hook(&ast.name.text) {
            let message = format!("function `{}` never assigns its result", ast.name.text);
            self.report(Diagnostic::warning(Code::MissingResult, ast.name.span, message));
        }
        let name = self.declarations.display_name(id);
        self.scope.into_pou(name, ast.name.span, statements)
    }

    /// Gives what does not outlive a call its initial value (2nd ed. 2.4.3, `VAR_TEMP`).
    fn prologue(&mut self, kind: PouKind) -> Vec<Statement> {
        let mut statements = Vec::new();
        let variables = self.scope.variables().to_vec();
        let mut register = u32::from(kind != PouKind::Function);
        for variable in &variables {
            let parameter = matches!(variable.section, SectionKind::Input | SectionKind::InOut);
            if kind.keeps_nothing() && parameter {
                let elementary = self.elementary(variable.ty).is_some();
                statements.extend(copied_parameter(variable, elementary, LocalId(register)));
                register += 1;
                continue;
            }
            if let Some(detection) = variable.edge {
                statements.extend(Self::detected(variable, detection));
            }
            let fleeting = match variable.section {
                SectionKind::Temp => true,
                SectionKind::External | SectionKind::Global | SectionKind::Static | SectionKind::Instance => false,
                // What the caller gives has its values already.
                SectionKind::Output if self.is_open(variable.ty) => false,
                _ => kind.keeps_nothing(),
            };
            if fleeting {
                statements.push(self.initialised(variable));
                statements.extend(self.computed(variable));
            }
            statements.extend(Self::outcome_begins(variable));
        }
        statements
    }

    /// What makes an initial value that is not a constant.
    fn computed(&mut self, variable: &Variable) -> Vec<Statement> {
        // Outside of units nothing is declared for one call.
        let fleeting = self.pou.map(|id| self.declarations.pou(id).fleeting().clone()).unwrap_or_default();
        let key = variable.name.to_ascii_uppercase();
        let Some((_, starts)) = fleeting.iter().find(|(name, _)| *name == key) else { return Vec::new() };
        let place = Place::whole(variable.storage, variable.ty, variable.span);
        let mut statements = self.performed(&place, starts, Occasion::Start);
        statements.extend(self.performed(&place, starts, Occasion::AfterStart));
        statements
    }

    fn initialised(&self, variable: &Variable) -> Statement {
        let (ty, span) = (variable.ty, variable.span);
        let place = Place::whole(variable.storage, ty, span);
        let kind = match self.elementary(ty) {
            Some(elementary) => {
                let value = constant(decode(elementary, &variable.image), elementary, span);
                StatementKind::Assign(place, Expr { ty, ..value })
            }
            None => StatementKind::Initialise(place, variable.image.clone()),
        };
        Statement { kind, span }
    }
}

/// An aggregate comes by address; the callee works on its own copy. So it does on that of a value whose
/// address it takes.
fn copied_parameter(variable: &Variable, elementary: bool, register: LocalId) -> Option<Statement> {
    if !matches!(variable.storage, Storage::Absolute(_)) {
        return None;
    }
    let (ty, span) = (variable.ty, variable.span);
    let storage = if elementary { Storage::Register(register) } else { Storage::RegisterPointer(register) };
    let target = Place::whole(variable.storage, ty, span);
    let value = Expr { kind: ExprKind::Load(Place::whole(storage, ty, span)), ty, span };
    let kind = if elementary { StatementKind::Assign(target, value) } else { StatementKind::Copy(target, value) };
    Some(Statement { kind, span })
}

impl Body<'_, '_> {
    /// Looks for the edge once in every call of the unit.
    fn detected(variable: &Variable, detection: EdgeDetection) -> [Statement; 2] {
        let place = |storage| Place::whole(storage, ElementaryType::Bool.into(), variable.span);
        let level = match detection.edge {
            Edge::Rising => load(&place(variable.storage)),
            Edge::Falling => not(load(&place(variable.storage))),
        };
        let memory = place(detection.memory);
        let edge = operation(Binary::And, level.clone(), not(load(&memory)));
        [assign(&place(Storage::Register(detection.seen)), edge), assign(&memory, level)]
    }
}

impl Body<'_, '_> {
    /// ENO is TRUE when the unit begins.
    fn outcome_begins(variable: &Variable) -> Option<Statement> {
        let outcome = is_control(variable) && variable.section == SectionKind::Output;
        let (ty, span) = (variable.ty, variable.span);
        let kind = StatementKind::Assign(Place::whole(variable.storage, ty, span), boolean(true, span));
        (outcome && ty == ElementaryType::Bool.into()).then_some(Statement { kind, span })
    }
}
