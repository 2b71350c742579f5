//! Steps and transitions of a chart: what the archive says of them, and the text that they become.
//!
//! | in the chart | in the text |
//! |---|---|
//! | the action of a step | an association N with an action of its own, which calls it while the step is active |
//! | its entry and exit actions | associations P1 and P0 |
//! | the text at a transition | its condition; the body of a transition of the unit if it is called so |
//!
//! The action of a step is not called when the step has been left, as an action of IEC 61131-3 is (2nd ed. 2.6.4.4).

use std::collections::BTreeMap;
use std::ops::Range;

use super::archive::{Object, Written};
use super::sheet::{Sheet, is_name};
use crate::diagnostic::Code;
use crate::input::plcopen_condition::Form;
use crate::input::statement::Text;

/// What the archive calls the attributes by.
pub(super) const NAME: &str = "38391c6d-6d4a-42f8-8ee7-9f45e5adafa8";
pub(super) const PARALLEL: &str = "23bdaa98-72ec-41f7-817b-9dede5697086";
const EXCLUDED: &str = "01580b27-6378-448b-8ecb-0e4b795b58d6";
const INITIAL: &str = "6844a48e-46c2-4cc8-a185-a478f3b99cc0";
const LEAST_TIME: &str = "cacf1a68-236e-47c2-b7b1-1cf9199718cb";
const GREATEST_TIME: &str = "b693554c-1b01-4a8d-afde-9e3a46f7465d";
const MAIN: &str = "700a583f-b4d4-43e4-8c14-629c7cd3bec8";
const ENTRY: &str = "a6b08bd8-b696-47e3-9cbf-7408b61c9ff8";
const EXIT: &str = "a2621e18-7de3-4ea6-ae6d-89e9e0b7befd";
const PRIORITY: &str = "8294df19-5962-4dee-a874-1051dabb0e3e";

/// The bodies in ST of the transitions that a unit has, by their names as keys.
pub(super) type Bodies<'b> = BTreeMap<String, &'b Written>;

/// The attributes of an element that have a value.
pub(super) struct Attributes {
    values: BTreeMap<String, Written>,
}

impl Attributes {
    pub(super) fn read(file: &str, element: Object<'_>) -> Self {
        let mut values = BTreeMap::new();
        for attribute in element.list("Attributes").into_iter().flatten() {
            let id = attribute.word(file, "AttributeId").trim_matches(['{', '}']).to_ascii_lowercase();
            let value = attribute.object("Value").and_then(|value| value.value(file, "Value"));
            values.extend(value.filter(|value| !value.is_blank()).map(|value| (id, value)));
        }
        Self { values }
    }

    pub(super) fn value(&self, id: &str) -> Option<&Written> {
        self.values.get(id)
    }

    pub(super) fn is_set(&self, id: &str) -> bool {
        self.value(id).is_some_and(|value| value.plain.trim().eq_ignore_ascii_case("true"))
    }
}

pub(super) struct Step {
    pub(super) name: String,
    pub(super) place: Range<u32>,
    initial: bool,
    main: Option<String>,
    entry: Option<String>,
    exit: Option<String>,
}

/// Reports what an element has that is not read.
fn report_rest(sheet: &mut Sheet<'_>, element: Object<'_>, attributes: &Attributes, what: &str) {
    let place = element.place();
    for (id, reported) in [(LEAST_TIME, "a least time"), (GREATEST_TIME, "a greatest time"), (PRIORITY, "a priority")] {
        if attributes.value(id).is_some_and(|value| value.plain.trim() != "0") {
            sheet.unsupported(&place, &format!("{reported} of {what}"));
        }
    }
    if attributes.is_set(EXCLUDED) {
        sheet.unsupported(&place, &format!("{what} that is excluded from the build,"));
    }
    let parts = ["EmbeddedMainAction", "EmbeddedEntryAction", "EmbeddedExitAction", "EmbeddedTransition"];
    if parts.iter().any(|part| element.object(part).is_some()) {
        sheet.unsupported(&place, &format!("a body inside of {what}"));
    }
    if !element.inner("ElementList").is_empty() {
        sheet.unsupported(&place, &format!("an action with a qualifier at {what}"));
    }
}

impl Step {
    pub(super) fn read(sheet: &mut Sheet<'_>, element: Object<'_>) -> Option<Self> {
        let attributes = Attributes::read(sheet.file, element);
        let place = element.place();
        let name = attributes.value(NAME).map_or("", |name| name.plain.trim()).to_owned();
        if !is_name(&name) {
            let message = format!("`{name}` is not the name of a step (element {})", element.id(sheet.file));
            sheet.report(&place, Code::MalformedXml, message);
            return None;
        }
        report_rest(sheet, element, &attributes, &format!("step `{name}`"));
        let mut action = |id: &str| {
            let written = attributes.value(id)?;
            let called = written.plain.trim();
            if is_name(called) {
                return Some(called.to_owned());
            }
            let message = format!("`{called}` is not the name of an action");
            sheet.report(&written.place, Code::MalformedXml, message);
            None
        };
        let (main, entry, exit) = (action(MAIN), action(ENTRY), action(EXIT));
        Some(Self { name, place, initial: attributes.is_set(INITIAL), main, entry, exit })
    }

    /// Appends the step; the action that calls its own while it is active.
    pub(super) fn write(&self, sheet: &mut Sheet<'_>) -> Option<Text> {
        let name = &self.name;
        let word = if self.initial { "INITIAL_STEP" } else { "STEP" };
        sheet.word_line(&format!("{word} {name}:\n"), &self.place);
        if let Some(entry) = &self.entry {
            sheet.word_line(&format!("    {entry}(P1);\n"), &self.place);
        }
        let mut own = format!("{name}_active");
        while sheet.file.to_ascii_uppercase().contains(&own.to_ascii_uppercase()) {
            own.push_str("_n");
        }
        if self.main.is_some() {
            sheet.word_line(&format!("    {own}(N);\n"), &self.place);
        }
        if let Some(exit) = &self.exit {
            sheet.word_line(&format!("    {exit}(P0);\n"), &self.place);
        }
        sheet.word_line("END_STEP\n", &self.place);
        let main = self.main.as_ref()?;
        let text = format!("ACTION {own}:\nIF {name}.X THEN {main}(); END_IF;\nEND_ACTION\n");
        Some(Text::word(text, &self.place))
    }
}

pub(super) struct Transition {
    pub(super) place: Range<u32>,
    from: Vec<String>,
    pub(super) to: Vec<String>,
    condition: Written,
}

impl Transition {
    pub(super) fn read(sheet: &mut Sheet<'_>, element: Object<'_>, from: Vec<String>) -> Option<Self> {
        let attributes = Attributes::read(sheet.file, element);
        let place = element.place();
        report_rest(sheet, element, &attributes, &format!("transition {}", element.id(sheet.file)));
        let Some(condition) = attributes.value(NAME).cloned() else {
            let message = format!("transition {} has no condition", element.id(sheet.file));
            sheet.report(&place, Code::MalformedXml, message);
            return None;
        };
        Some(Self { place, from, to: Vec::new(), condition })
    }

    pub(super) fn write(&self, sheet: &mut Sheet<'_>, bodies: &Bodies<'_>) {
        let list = |names: &[String]| match names {
            [one] => one.clone(),
            several => format!("({})", several.join(", ")),
        };
        let head = format!("TRANSITION FROM {} TO {} := ", list(&self.from), list(&self.to));
        let mut text = Text::word(head, &self.place);
        let named = bodies.get(&self.condition.plain.trim().to_ascii_uppercase());
        let condition = named.map_or(&self.condition, |body| *body);
        if named.is_some() && !matches!(Form::of(&condition.plain), Form::Expression) {
            let what = format!("the transition `{}` that is not a single expression", self.condition.plain.trim());
            return sheet.unsupported(&condition.place, &what);
        }
        let Some(condition) = sheet.expression(&condition.without_end()) else { return };
        text.append(condition);
        text.push(";\nEND_TRANSITION\n", &self.place);
        sheet.line(text);
    }
}
