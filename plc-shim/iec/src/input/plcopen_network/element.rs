//! The elements of a network as the file has them (TC6 2.01, `fbdObjects`, `ldObjects`, `commonObjects`).

use std::ops::Range;

use onescan_xml::Element;

/// What an element of a network is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    InVariable,
    OutVariable,
    InOutVariable,
    Block,
    Connector,
    Continuation,
    Label,
    Jump,
    Return,
    LeftRail,
    RightRail,
    Contact,
    Coil,
}

impl Kind {
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "inVariable" => Self::InVariable,
            "outVariable" => Self::OutVariable,
            "inOutVariable" => Self::InOutVariable,
            "block" => Self::Block,
            "connector" => Self::Connector,
            "continuation" => Self::Continuation,
            "label" => Self::Label,
            "jump" => Self::Jump,
            "return" => Self::Return,
            "leftPowerRail" => Self::LeftRail,
            "rightPowerRail" => Self::RightRail,
            "contact" => Self::Contact,
            "coil" => Self::Coil,
            _ => return None,
        })
    }

    /// True for what joins no elements to one network.
    pub(super) fn is_rail(self) -> bool {
        matches!(self, Self::LeftRail | Self::RightRail)
    }

    /// True for what hands on control and so comes last in its network.
    pub(super) fn is_control(self) -> bool {
        matches!(self, Self::Jump | Self::Return)
    }
}

/// An edge of which a connection point sees nothing else.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Edge {
    Rising,
    Falling,
}

/// How a value is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Storage {
    None,
    Set,
    Reset,
}

/// What becomes of a value on its way.
#[derive(Debug, Clone, Copy)]
pub(super) struct Modifiers {
    pub(super) negated: bool,
    pub(super) edge: Option<Edge>,
    pub(super) storage: Storage,
}

impl Modifiers {
    /// Those that the attributes with this suffix say, which `inOutVariable` has one for each side of.
    pub(super) fn of(element: &Element, suffix: &str) -> Self {
        let value = |name: &str| element.attribute(&format!("{name}{suffix}")).map_or("", |found| found.value.as_str());
        let edge = match value("edge") {
            "rising" => Some(Edge::Rising),
            "falling" => Some(Edge::Falling),
            _ => None,
        };
        let storage = match value("storage") {
            "set" => Storage::Set,
            "reset" => Storage::Reset,
            _ => Storage::None,
        };
        Self { negated: matches!(value("negated"), "true" | "1"), edge, storage }
    }
}

/// A connection as it is written at its end.
#[derive(Debug)]
pub(super) struct Link<'e> {
    pub(super) element: &'e Element,
    /// The element that it comes from, by its place in the list; nothing if there is none.
    pub(super) source: Option<usize>,
    /// The output that it comes from.
    pub(super) pin: &'e str,
}

#[derive(Debug)]
pub(super) struct Input<'e> {
    /// Its name at a block.
    pub(super) name: &'e str,
    pub(super) element: &'e Element,
    pub(super) modifiers: Modifiers,
    pub(super) links: Vec<Link<'e>>,
    pub(super) in_out: bool,
}

/// Where connections begin at a block.
#[derive(Debug)]
pub(super) struct Output<'e> {
    pub(super) name: &'e str,
    pub(super) element: &'e Element,
    pub(super) modifiers: Modifiers,
}

/// An element of a network.
#[derive(Debug)]
pub(super) struct Node<'e> {
    pub(super) kind: Kind,
    pub element: &'e Element,
    pub(super) id: &'e str,
    /// `executionOrderId`; nothing if it is 0 or missing.
    pub(super) order: Option<u32>,
    /// Down, then right; what stands nowhere stands at the top left.
    pub(super) position: (i64, i64),
    pub(super) inputs: Vec<Input<'e>>,
    pub(super) outputs: Vec<Output<'e>>,
}

impl<'e> Node<'e> {
    fn of(element: &'e Element) -> Option<Self> {
        let kind = Kind::of(&element.name)?;
        let coordinate = |name| {
            let found = element.child("position").and_then(|position| position.attribute(name));
            found.and_then(|found| found.value.parse::<f64>().ok()).map_or(0, |number| number as i64)
        };
        let order = element.attribute("executionOrderId").and_then(|found| found.value.parse().ok());
        Some(Self {
            kind,
            element,
            id: attribute(element, "localId"),
            order: order.filter(|order| *order > 0),
            position: (coordinate("y"), coordinate("x")),
            inputs: inputs(kind, element),
            outputs: outputs(element),
        })
    }

    /// Where the element begins.
    pub(super) fn place(&self) -> Range<u32> {
        self.element.open.clone()
    }
}

pub(super) fn attribute<'e>(element: &'e Element, name: &str) -> &'e str {
    element.attribute(name).map_or("", |found| found.value.as_str())
}

fn links(holder: &Element) -> Vec<Link<'_>> {
    let points = holder.elements().filter(|inner| inner.name == "connectionPointIn");
    let connections = points.flat_map(Element::elements).filter(|inner| inner.name == "connection");
    connections.map(|element| Link { element, source: None, pin: attribute(element, "formalParameter") }).collect()
}

/// The connections that end at an element of any kind.
pub(super) fn inputs_of(element: &Element) -> Input<'_> {
    Input { name: "", element, modifiers: Modifiers::of(element, ""), links: links(element), in_out: false }
}

fn inputs(kind: Kind, element: &Element) -> Vec<Input<'_>> {
    if kind != Kind::Block {
        let suffix = if kind == Kind::InOutVariable { "In" } else { "" };
        let modifiers = Modifiers::of(element, suffix);
        return vec![Input { name: "", element, modifiers, links: links(element), in_out: false }];
    }
    let list = |name: &'static str, in_out: bool| {
        element.child(name).into_iter().flat_map(Element::elements).filter(|inner| inner.name == "variable").map(
            move |variable| Input {
                name: attribute(variable, "formalParameter"),
                element: variable,
                modifiers: Modifiers::of(variable, ""),
                links: links(variable),
                in_out,
            },
        )
    };
    list("inputVariables", false).chain(list("inOutVariables", true)).collect()
}

fn outputs(element: &Element) -> Vec<Output<'_>> {
    let list = element.child("outputVariables").into_iter().flat_map(Element::elements);
    let variables = list.filter(|inner| inner.name == "variable");
    let output = |variable| Output {
        name: attribute(variable, "formalParameter"),
        element: variable,
        modifiers: Modifiers::of(variable, ""),
    };
    variables.map(output).collect()
}

/// The elements of a body in the order of the file; what is not part of a network is left out.
pub(super) fn nodes(body: &Element) -> Vec<Node<'_>> {
    body.elements().filter_map(Node::of).collect()
}
