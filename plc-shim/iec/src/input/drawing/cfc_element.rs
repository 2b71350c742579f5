//! The elements of a Continuous Function Chart as the archive has them.

use std::collections::BTreeMap;
use std::ops::Range;

use super::archive::{Object, Written};
use super::sheet::Storing;

/// Where lines end or begin.
#[derive(Debug, Clone)]
pub(super) struct Pin {
    pub(super) id: String,
    /// Its name at a box; empty where the editor stored none.
    pub(super) name: String,
    pub(super) negated: bool,
    pub(super) storing: Storing,
    /// A value that the archive has in the place of a line, or anything else that is not read.
    pub(super) oddity: Option<&'static str>,
    pub(super) place: Range<u32>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BoxKind {
    Instance,
    Program,
    Action,
    /// A function, an operator, or a method of the unit itself.
    Function,
}

#[derive(Debug)]
pub(super) enum Kind {
    Box {
        kind: BoxKind,
        type_name: String,
        instance: String,
        enable: bool,
        parameter: Option<Range<u32>>,
    },
    Input,
    Output,
    Jump,
    Return,
    Label,
    /// A structure whose members are the inputs; nothing of the type if the archive does not say it.
    Composer {
        type_name: String,
    },
    /// A structure whose members are the outputs.
    Selector,
    /// Nothing that is evaluated.
    Comment,
    /// What is not read.
    Unknown,
}

#[derive(Debug)]
pub(super) struct Element<'e> {
    pub(super) kind: Kind,
    /// As the archive names its type.
    pub(super) type_in_archive: &'e str,
    pub(super) id: String,
    pub(super) place: Range<u32>,
    /// Where it stands in the chart, from the left and from the top.
    pub(super) left: i64,
    pub(super) top: i64,
    pub(super) text: Option<Written>,
    pub(super) inputs: Vec<Pin>,
    pub(super) outputs: Vec<Pin>,
}

/// The elements in the order of the archive, and the source of each pin that a line leads to.
#[derive(Debug, Default)]
pub(super) struct Elements<'e> {
    pub(super) elements: Vec<Element<'e>>,
    /// By the id of the pin at which lines end: those at which they begin.
    pub(super) sources: BTreeMap<String, Vec<String>>,
}

impl<'e> Elements<'e> {
    pub(super) fn read(file: &str, chart: Object<'e>) -> Self {
        let mut found = Self::default();
        for object in chart.inner("Items") {
            if object.kind == "CFCConnection" {
                let id = |name| object.word(file, name).trim_end_matches('L').to_owned();
                let sources = found.sources.entry(id("DestPinId")).or_default();
                let source = id("SourcePinId");
                // A line that is drawn twice is one.
                if !sources.contains(&source) {
                    sources.push(source);
                }
            } else {
                found.elements.push(element(file, object));
            }
        }
        found
    }
}

fn element<'e>(file: &str, object: Object<'e>) -> Element<'e> {
    let bounds = object.word(file, "Bounds");
    let mut bounds = bounds.split(',').map(|number| number.trim().parse().unwrap_or(0));
    let (left, top) = (bounds.next().unwrap_or(0), bounds.next().unwrap_or(0));
    let mut read = Element {
        kind: Kind::Unknown,
        left,
        top,
        type_in_archive: object.kind,
        id: object.id(file),
        place: object.place(),
        text: object.object("Text").and_then(|text| text.value(file, "Text")),
        inputs: object.object("Input").map(|object| pin(file, object)).into_iter().collect(),
        outputs: object.object("Output").map(|object| pin(file, object)).into_iter().collect(),
    };
    let texts = || -> Vec<String> {
        object.inner("Texts").iter().map(|text| text.word(file, "Text").trim().to_owned()).collect()
    };
    read.kind = match object.kind {
        "CFCComposerElement" => return composer(file, object, read, texts()),
        "CFCSelectorElement" => return selector(file, object, read, texts()),
        "CFCBoxElement" => return called(file, object, read),
        "CFCInputElement" => Kind::Input,
        "CFCOutputElement" => Kind::Output,
        "CFCJumpElement" => Kind::Jump,
        "CFCReturnElement" => Kind::Return,
        "CFCLabelElement" => Kind::Label,
        "CFCCommentElement" => Kind::Comment,
        _ => Kind::Unknown,
    };
    read
}

/// A composer: its texts are the names of the members, and the type.
fn composer<'e>(file: &str, object: Object<'e>, read: Element<'e>, texts: Vec<String>) -> Element<'e> {
    let mut inputs: Vec<Pin> = object.inner("Inputs").into_iter().map(|object| pin(file, object)).collect();
    let Some(type_name) = texts.get(inputs.len()).cloned().filter(|_| texts.len() == inputs.len() + 1) else {
        return read;
    };
    for (pin, name) in inputs.iter_mut().zip(texts) {
        pin.name = name;
    }
    Element { kind: Kind::Composer { type_name }, inputs, ..read }
}

/// A selector: its texts are the type, and the names of the members.
fn selector<'e>(file: &str, object: Object<'e>, read: Element<'e>, texts: Vec<String>) -> Element<'e> {
    let mut outputs: Vec<Pin> = object.inner("Outputs").into_iter().map(|object| pin(file, object)).collect();
    if texts.len() != outputs.len() + 1 {
        return read;
    }
    for (pin, name) in outputs.iter_mut().zip(texts.into_iter().skip(1)) {
        pin.name = name;
    }
    Element { kind: Kind::Selector, outputs, ..read }
}

/// A box: its texts are the names of the inputs, those of the outputs, the type and the instance.
fn called<'e>(file: &str, object: Object<'e>, read: Element<'e>) -> Element<'e> {
    let pins = |list| object.inner(list).into_iter().map(|object| pin(file, object)).collect::<Vec<Pin>>();
    let (mut inputs, mut outputs) = (pins("Inputs"), pins("Outputs"));
    let texts: Vec<String> =
        object.inner("Texts").iter().map(|text| text.word(file, "Text").trim().to_owned()).collect();
    let count = inputs.len() + outputs.len();
    if texts.len() != count + 2 {
        return Element { inputs, outputs, ..read };
    }
    for (pin, name) in inputs.iter_mut().chain(&mut outputs).zip(&texts) {
        pin.name.clone_from(name);
    }
    let (type_name, instance) = (texts.get(count).cloned(), texts.get(count + 1).cloned());
    let (type_name, instance) = (type_name.unwrap_or_default(), instance.unwrap_or_default());
    let kind = match object.word(file, "KindOfCall").as_str() {
        "Program" => BoxKind::Program,
        "Action" => BoxKind::Action,
        "FunctionBlock" => BoxKind::Instance,
        // A box that was never resolved is said to be an operator; an instance shows what it is.
        "Operator" if !instance.is_empty() => BoxKind::Instance,
        "Operator" | "Function" | "LocalMethod" => BoxKind::Function,
        _ => return Element { inputs, outputs, ..read },
    };
    let enable = object.is_set(file, "EnEno");
    let given = |parameter: &Object<'_>| parameter.value(file, "Value").is_some_and(|value| !value.is_blank());
    let parameter = object.inner("Parameters").iter().find(|each| given(each)).map(Object::place);
    Element { kind: Kind::Box { kind, type_name, instance, enable, parameter }, inputs, outputs, ..read }
}

fn pin(file: &str, object: Object<'_>) -> Pin {
    let mut oddity = None;
    let storing = match object.word(file, "SetReset").as_str() {
        "" | "None" => Storing::Plain,
        "Set" => Storing::Set,
        "Reset" => Storing::Reset,
        _ => {
            oddity = Some("what a pin does with its value");
            Storing::Plain
        }
    };
    if !matches!(object.word(file, "SetResetRef").as_str(), "" | "None") {
        oddity = Some("an assignment of a reference at a pin");
    }
    if !object.word(file, "ProcessValue").trim().is_empty() {
        oddity = Some("a value at a pin");
    }
    let negated = object.is_set(file, "Negated");
    Pin { id: object.id(file), name: String::new(), negated, storing, oddity, place: object.place() }
}
