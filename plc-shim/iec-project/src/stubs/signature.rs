//! Methods and functions as program text: their own parameters, or those of what is derived.

use std::fmt::Write as _;

use super::foreign::{Argument, Foreign, Function, Signature};
use super::print::Printer;
use super::shape::Shape;
use super::ty::{Slot, Ty};
use super::world::{INIT, INIT_INPUTS, Part};
use onescan_iec::ElementaryType;
use onescan_iec::syntax::ast::{Pou, SectionKind, TypeSpec};

impl<'c> Printer<'c, '_> {
    /// The method that is run with the arguments of a declaration.
    pub(super) fn init(&self, key: &str, found: &Foreign) -> String {
        let called = found.members.get(&INIT.to_ascii_uppercase()).and_then(|member| member.called.as_ref());
        let mut signature = match (&found.init, called) {
            (Some(init), _) => init.clone(),
            (None, Some((explicit, _))) => {
                // Who calls it gives what the system gives, too.
                let mut signature = explicit.clone();
                signature.positional = signature.positional.split_off(2.min(explicit.positional.len()));
                signature
            }
            (None, None) => return String::new(),
        };
        signature.named.retain(|named| !INIT_INPUTS.iter().any(|known| known.eq_ignore_ascii_case(&named.name)));
        // Global variables of other stubs are declared without arguments.
        let globals = self.collector.needs.globals.values();
        let types = globals.map(|global| self.collector.slots.last_choice(global.slot));
        if types.into_iter().any(|ty| ty == Ty::Foreign(key.to_owned())) {
            signature.fewest = Some(0);
        }
        let count = signature.named.len().max(signature.positional.len());
        let inputs = |method: &Pou| {
            let sections = method.sections.iter().filter(|section| section.kind == SectionKind::Input);
            sections.flat_map(|section| &section.variables).map(|each| each.names.len()).sum::<usize>()
        };
        // What is derived has the names.
        if let Some(own) = self.heir(key, Part::Method, INIT).filter(|method| inputs(method) == count + 2) {
            return self.copied_method(own);
        }
        let fixed = INIT_INPUTS.map(|name| format!("        {name} : BOOL;\n")).concat();
        format!("METHOD {INIT} : BOOL\n    VAR_INPUT\n{fixed}    END_VAR\n{}END_METHOD\n", self.parameters(&signature))
    }

    /// The method or property of what is derived.
    pub(super) fn heir(&self, key: &str, part: Part, name: &str) -> Option<&'c Pou> {
        let mut open: Vec<String> = vec![key.to_owned()];
        let mut seen = std::collections::BTreeSet::new();
        while let Some(next) = open.pop() {
            // What stands for an interface has heirs that show the interface's methods.
            let below = self.collector.needs.types.iter().filter(|(_, each)| each.stands_for.contains(&next));
            open.extend(below.map(|(key, _)| key.clone()).filter(|key| seen.insert(key.clone())));
            for unit in self.heirs.get(&next).into_iter().flatten() {
                if let Some(found) = unit.members.get(&(part, name.to_ascii_uppercase())) {
                    return Some(found);
                }
                let own = unit.pou.name.key();
                if seen.insert(own.clone()) {
                    open.push(own);
                }
            }
        }
        None
    }

    pub(super) fn copied_method(&self, method: &Pou) -> String {
        let result = method.result.as_ref().map(|spec| format!(" : {}", self.copied(spec))).unwrap_or_default();
        let mut text = format!("METHOD {}{result}\n", method.name.text);
        for section in &method.sections {
            let word = match section.kind {
                SectionKind::Input => "VAR_INPUT",
                SectionKind::InOut => "VAR_IN_OUT",
                SectionKind::Output => "VAR_OUTPUT",
                _ => continue,
            };
            let _ = writeln!(text, "    {word}");
            for variable in &section.variables {
                let names: Vec<&str> = variable.names.iter().map(|name| name.text.as_str()).collect();
                let _ = writeln!(text, "        {} : {};", names.join(", "), self.copied(&variable.spec));
            }
            text.push_str("    END_VAR\n");
        }
        text.push_str("END_METHOD\n");
        text
    }

    /// A type as the project writes it.
    pub(super) fn copied(&self, spec: &TypeSpec) -> String {
        let text = self.collector.world.sources.text(spec.span);
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    pub(super) fn method(&self, name: &str, signature: &Signature, result: Slot) -> String {
        let ty = self.result(signature, result, name);
        let each = self.overloads(signature).into_iter();
        each.map(|parameters| format!("METHOD {name}{ty}\n{parameters}END_METHOD\n")).collect()
    }

    pub(super) fn result(&self, signature: &Signature, result: Slot, name: &str) -> String {
        if !signature.is_used && !self.collector.slots.is_touched(result) {
            return String::new();
        }
        format!(" : {}", self.slot_text(Some(result), name))
    }

    /// A function, and the list that it belongs to.
    pub(super) fn function(&self, function: &Function) -> (String, String) {
        let (list, name) = function.name.rsplit_once('.').unwrap_or(("", &function.name));
        // What is called as a statement may be a function without a result as well; one that has a result may be lost.
        let result = self.result(&function.signature, function.result, name);
        let each = if name.starts_with("__") {
            // Operators of the compiler take whatever there is.
            vec![any_parameters(&function.signature)]
        } else {
            self.overloads(&function.signature)
        };
        let texts = each
            .into_iter()
            .map(|parameters| format!("{{external}}\nFUNCTION {name}{result}\n{parameters}END_FUNCTION\n"));
        (list.to_owned(), texts.collect())
    }

    /// The parameters; where functions may be overloaded, those for each type that calls give for one of them.
    fn overloads(&self, signature: &Signature) -> Vec<String> {
        let varied = |(index, (_, argument)): (usize, &(String, Argument))| {
            let slots = std::iter::once(argument).chain(signature.positional.get(index)).map(|each| each.slot);
            let types = self.collector.slots.types_given(slots);
            (!types.is_empty()).then_some((index, types))
        };
        let given = signature.in_order();
        let varied: Vec<_> = given.iter().enumerate().filter_map(varied).collect();
        match varied.as_slice() {
            [(index, types)] if self.collector.has_overloads => {
                types.iter().map(|ty| self.parameters_with(signature, Some((*index, *ty)))).collect()
            }
            _ => vec![self.parameters(signature)],
        }
    }

    pub(super) fn parameters(&self, signature: &Signature) -> String {
        self.parameters_with(signature, None)
    }

    /// The same, with a type for the one at an index.
    fn parameters_with(&self, signature: &Signature, chosen: Option<(usize, ElementaryType)>) -> String {
        let mut text = String::new();
        let given = signature.in_order();
        let mut section = "";
        for (index, (name, argument)) in given.iter().enumerate() {
            let mut all = vec![*argument];
            all.extend(signature.positional.get(index));
            let (word, ty) = match chosen.filter(|(chosen, _)| *chosen == index) {
                Some((_, ty)) => ("VAR_INPUT", ty.name().to_owned()),
                None => self.parameter(&all, name),
            };
            if word != section {
                if !section.is_empty() {
                    text.push_str("    END_VAR\n");
                }
                let _ = writeln!(text, "    {word}");
                section = word;
            }
            let is_given = signature.fewest.is_none_or(|fewest| index < fewest) || word != "VAR_INPUT";
            let initial = if is_given { None } else { neutral(&ty) };
            let initial = initial.map(|value| format!(" := {value}")).unwrap_or_default();
            let _ = writeln!(text, "        {name} : {ty}{initial};");
        }
        if !section.is_empty() {
            text.push_str("    END_VAR\n");
        }
        if !signature.outputs.is_empty() {
            text.push_str("    VAR_OUTPUT\n");
            for (name, slot) in &signature.outputs {
                let _ = writeln!(text, "        {name} : {};", self.slot_text(Some(*slot), name));
            }
            text.push_str("    END_VAR\n");
        }
        text
    }

    /// The section and the type of a parameter: what takes anything is generic, a block comes as the caller's own.
    pub(super) fn parameter(&self, all: &[Argument], name: &str) -> (&'static str, String) {
        let Some(first) = all.first() else { return ("VAR_INPUT", "DINT".to_owned()) };
        let slots = &self.collector.slots;
        let is_place = all.iter().all(|argument| argument.is_place);
        let mixed = all.iter().any(|argument| slots.is_mixed(argument.slot));
        if mixed && is_place {
            return ("VAR_INPUT", "ANY".to_owned());
        }
        if let Some(ty) = slots.array_of_any_length(all.iter().map(|argument| argument.slot)) {
            return ("VAR_INPUT", self.type_text(&ty, name));
        }
        let best = all.iter().find(|argument| slots.decided(argument.slot).is_some()).unwrap_or(first);
        let ty = slots.last_choice(best.slot);
        let is_block = match &ty {
            Ty::Declared(key) => self.collector.world.units.get(key).is_some_and(|unit| unit.pou.kind.has_instances()),
            Ty::Foreign(key) => {
                self.collector.needs.types.get(key).is_some_and(|found| self.collector.shape(found) == Shape::Block)
            }
            _ => false,
        };
        let section = if is_block && is_place { "VAR_IN_OUT" } else { "VAR_INPUT" };
        (section, self.type_text(&ty, name))
    }
}

/// An initial value for an input that some calls leave out; structures have none that could be written.
fn neutral(ty: &str) -> Option<&'static str> {
    if ty.starts_with("STRING") {
        return Some("''");
    }
    if ty.starts_with("WSTRING") {
        return Some("\"\"");
    }
    if ty.starts_with("POINTER TO") {
        return Some("0");
    }
    let found = ElementaryType::find(ty)?;
    match found {
        ElementaryType::Bool => Some("FALSE"),
        ElementaryType::Time => Some("T#0s"),
        ElementaryType::Ltime => Some("LTIME#0s"),
        _ => (found.is_number() || found.is_bits()).then_some("0"),
    }
}

fn any_parameters(signature: &Signature) -> String {
    let lines: String = (1..=signature.positional.len()).map(|index| format!("        p{index} : ANY;\n")).collect();
    if lines.is_empty() { lines } else { format!("    VAR_INPUT\n{lines}    END_VAR\n") }
}
