//! What a unit keeps for its chart: variables like its own, which only the chart writes.
//!
//! | variable | name | key |
//! |---|---|---|
//! | a step's flag and times | the step's | the same |
//! | a named transition: TRUE in the scan in which it is cleared | the transition's | the same |
//! | the control of an action with statements, whose `Q` the program reads | the action's | [`control_key`] |
//! | the control of a Boolean action | `SFC_` and the variable's | [`control_key`] |
//! | whether the initial situation has been | `SFC_Begun`; of an action's chart `SFC_Begun_` and the action's | [`begun_key`] |
//!
//! No text spells a key with a blank. Charts that are the bodies of actions keep theirs in the unit, too: names of
//! steps, transitions and actions are those of the whole unit (2nd ed. 2.6.2 to 2.6.4.1).

use std::collections::BTreeMap;
use std::sync::Arc;

use super::interface::Interface;
use crate::check::declare::chart::{CONTROL_TYPE, STEP_TYPE, begun_key, control_key, keeps_charts};
use crate::check::declare::{Need, Role, TypedImage};
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{ElementaryType, Storage, Type, TypeId, Variable, Visibility};
use crate::syntax::Span;
use crate::syntax::ast::{self, Association, ChartStep, Ident, MemberKind, PouKind, SectionKind};

impl<'a> Interface<'_, 'a> {
    /// Declares what a unit's charts need: its own, and those of its actions.
    pub(super) fn declare_charts(&mut self, ast: &ast::Pou) {
        if !keeps_charts(ast.kind) {
            return;
        }
        let actions = ast.object.members.iter().filter(|member| member.kind == MemberKind::Action);
        let mut controlled = BTreeMap::new();
        for pou in std::iter::once(ast).chain(actions.map(|member| &member.pou)) {
            if !pou.chart.is_empty() {
                self.declare_chart(pou, &mut controlled);
            }
        }
    }

    /// `controlled` are the actions of charts before it, and where they are named first.
    fn declare_chart(&mut self, ast: &ast::Pou, controlled: &mut BTreeMap<String, Span>) {
        for step in &ast.chart.steps {
            self.declare_step(step);
        }
        let flag = || TypedImage { ty: ElementaryType::Bool.into(), image: Arc::from([0]), starts: Arc::default() };
        for name in ast.chart.transitions.iter().filter_map(|transition| transition.name.as_ref()) {
            self.declare_of_chart(&name.key(), &name.text, name.span, &flag());
        }
        let mut own = BTreeMap::new();
        for Association { action, .. } in ast.chart.steps.iter().flat_map(|step| &step.associations) {
            if own.insert(action.key(), action.span).is_some() {
                continue;
            }
            match controlled.get(&action.key()) {
                Some(first) => self.report_shared(action, *first),
                None => self.declare_control(action),
            }
        }
        for (key, span) in own {
            controlled.entry(key).or_insert(span);
        }
        let name =
            if ast.kind == PouKind::Action { format!("SFC_Begun_{}", ast.name.text) } else { "SFC_Begun".to_owned() };
        self.keep_state(&begun_key(ast), &name, ast.name.span, &flag());
    }

    /// An action has one action control (2nd ed. 2.6.4.5).
    fn report_shared(&mut self, action: &Ident, first: Span) {
        let message = format!("another chart of this unit controls `{}`, too", action.text);
        let found = Diagnostic::error(Code::SharedAction, action.span, message).with_label(first, "there");
        self.report(found.with_help("an action is controlled by the steps of one chart: use a second action"));
    }

    /// An initial step is active before the first scan (2nd ed. 2.6.5).
    fn declare_step(&mut self, step: &ChartStep) {
        let Some(mut declared) = self.library_type(STEP_TYPE, step.name.span) else { return };
        if step.is_initial
            && let Type::Struct { fields, .. } = self.declarations().types().get(declared.ty)
            && let Some(flag) = fields.iter().find(|field| field.name == "X")
        {
            let mut image = declared.image.to_vec();
            image.iter_mut().skip(flag.offset as usize).take(1).for_each(|byte| *byte = 1);
            declared.image = image.into();
        }
        self.declare_of_chart(&step.name.key(), &step.name.text, step.name.span, &declared);
    }

    fn declare_control(&mut self, action: &Ident) {
        let key = control_key(&action.key());
        if self.scope().own(&key).is_some() {
            return;
        }
        let Some(declared) = self.library_type(CONTROL_TYPE, action.span) else { return };
        let unit = self.unit();
        let has_body = unit.is_some_and(|id| self.declarations().has_member(id, Role::Method, &action.text));
        if let Some(variable) = self.scope().own(&action.key()).filter(|_| has_body) {
            let first = variable.span;
            self.declarations_mut().report_duplicate(action, Some(first));
        }
        let name = if has_body { action.text.clone() } else { format!("SFC_{}", action.text) };
        self.keep_state(&key, &name, action.span, &declared);
    }

    fn library_type(&mut self, name: &str, span: Span) -> Option<TypedImage<'a>> {
        self.written().type_by_name(&Ident { text: name.to_owned(), span }, Need::Size)
    }

    /// Steps and transitions have names among those of variables.
    fn declare_of_chart(&mut self, key: &str, name: &str, span: Span, declared: &TypedImage<'a>) {
        match self.scope().own(key).map(|first| first.span) {
            Some(first) => {
                self.declarations_mut().report_duplicate(&Ident { text: name.to_owned(), span }, Some(first));
            }
            None => self.keep_state(key, name, span, declared),
        }
    }

    fn keep_state(&mut self, key: &str, name: &str, span: Span, declared: &TypedImage<'a>) {
        let Some(offset) = self.in_instance(declared, span) else { return };
        let ty: TypeId = declared.ty;
        let variable = Variable {
            name: name.to_owned(),
            section: SectionKind::Local,
            ty,
            storage: Storage::Instance(offset),
            constant: None,
            is_constant: false,
            retention: None,
            address: None,
            span,
            image: declared.image.clone(),
            visibility: Visibility::Protected,
            owner: self.unit(),
            edge: None,
            of_chart: true,
        };
        self.scope_mut().add(key.to_owned(), variable);
    }
}
