//! The methods that run without a call: `FB_init`, `FB_reinit`, `FB_exit` (CODESYS, TwinCAT), and their inputs.

use super::Declarations;
use super::class::{Occasion, Role};
use super::scope::Scope;
use crate::diagnostic::{Code, Diagnostic};
use crate::ir::{ElementaryType, PouId, TypeId};

/// A method that runs without a call, and the BOOL inputs that it begins with.
pub(super) struct Hook {
    pub(super) name: &'static str,
    inputs: &'static [&'static str],
    /// True if more inputs may follow.
    open: bool,
}

/// Inputs of `FB_init` that the runtime gives: whether RETAIN variables are initialised, and whether an online change
/// copies the instance, which never happens here.
pub(in crate::check) const INIT_INPUTS: [&str; 2] = ["bInitRetains", "bInCopyCode"];

/// Inputs of `FB_exit` that the runtime gives.
pub(in crate::check) const EXIT_INPUTS: [&str; 1] = ["bInCopyCode"];

pub(super) const INIT: Hook = Hook { name: "FB_INIT", inputs: &INIT_INPUTS, open: true };

const HOOKS: [Hook; 3] = [
    INIT,
    Hook { name: "FB_REINIT", inputs: &[], open: false },
    Hook { name: "FB_EXIT", inputs: &EXIT_INPUTS, open: false },
];

/// True for the name of the method that initialises an instance.
pub(in crate::check) fn is_init(name: &str) -> bool {
    INIT.name.eq_ignore_ascii_case(name)
}

/// True for a method that runs without a call.
pub(in crate::check) fn is_hook(name: &str) -> bool {
    HOOKS.iter().any(|hook| hook.name.eq_ignore_ascii_case(name))
}

impl Declarations<'_> {
    /// The methods of a unit and its bases that run at an occasion; those of the bases first.
    pub(in crate::check) fn hooks(&self, pou: PouId, occasion: Occasion) -> Vec<PouId> {
        let name = match occasion {
            Occasion::Start => "FB_INIT",
            Occasion::AfterStart => return self.called_after_init(pou),
            Occasion::End => "FB_EXIT",
        };
        let key = (Role::Method, name.to_owned());
        let mut found = Vec::new();
        let mut next = Some(pou);
        while let Some(class) = next.and_then(|id| self.class(id)) {
            found.extend(class.members.get(&key));
            next = class.base;
        }
        found.reverse();
        found
    }

    /// The methods with `{attribute 'call_after_init'}` of a block that has it as well, or whose base has it: each as
    /// the block itself has it, or as it is PRIVATE to a base; those that its bases declare first.
    fn called_after_init(&self, pou: PouId) -> Vec<PouId> {
        let chain: Vec<PouId> = self.with_bases(pou).collect();
        if !chain.iter().any(|id| self.pou(*id).ast.object.call_after_init) {
            return Vec::new();
        }
        let mut found: Vec<PouId> = Vec::new();
        for class in chain.iter().rev().filter_map(|id| self.class(*id)) {
            let marked = class
                .members
                .iter()
                .filter(|((role, _), method)| *role == Role::Method && self.pou(**method).ast.object.call_after_init);
            for ((role, name), declared) in marked {
                let own = if self.is_private(*declared) { Some(*declared) } else { self.find_member(pou, *role, name) };
                found.extend(own.filter(|own| !found.contains(own)));
            }
        }
        found
    }

    pub(in crate::check) fn has_hook(&self, pou: PouId, occasion: Occasion) -> bool {
        !self.hooks(pou, occasion).is_empty()
    }

    /// The runtime gives these methods their inputs, so they must be there.
    pub(super) fn check_hooks(&mut self, id: PouId) {
        for hook in &HOOKS {
            let key = (Role::Method, hook.name.to_owned());
            let Some(method) = self.class(id).and_then(|class| class.members.get(&key)).copied() else { continue };
            let Some(scope) = self.pou(method).scope.clone() else { continue };
            if !suits(hook, &scope) && !scope.has_broken() {
                let name = &self.pou(method).ast.name;
                let inputs: Vec<_> = hook.inputs.iter().map(|input| format!("{input} : BOOL;")).collect();
                let message = format!("`{}` does not have the inputs that it is run with", name.text);
                let found = Diagnostic::error(Code::HookInputs, name.span, message);
                self.report(found.with_help(match inputs.as_slice() {
                    [] => "declare it without inputs".to_owned(),
                    _ if hook.open => format!("begin with VAR_INPUT {} and let others follow", inputs.join(" ")),
                    _ => format!("declare VAR_INPUT {} and no others", inputs.join(" ")),
                }));
            }
        }
    }
}

/// True for the variables of an `FB_init` that the runtime can run.
pub(in crate::check) fn suits_init(scope: &Scope) -> bool {
    suits(&INIT, scope)
}

fn suits(hook: &Hook, scope: &Scope) -> bool {
    let bool_type: TypeId = ElementaryType::Bool.into();
    let mut inputs = scope.inputs();
    let begins = hook.inputs.iter().all(|wanted| {
        inputs.next().is_some_and(|input| input.name.eq_ignore_ascii_case(wanted) && input.ty == bool_type)
    });
    begins && (hook.open || inputs.next().is_none())
}
