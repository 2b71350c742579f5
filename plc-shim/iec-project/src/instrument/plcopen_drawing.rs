//! Elements of a drawing in PLCopen XML: where one stands, and numbers for new ones.

use onescan_xml::Element;

use super::plcopen::Refused;
use onescan_iec::input::plcopen_chart_graph::number;
use onescan_iec::syntax::Span;

/// What cannot be put on virtual time, and where it stands.
pub(super) type RefusedAt = (Span, Refused);

/// Numbers of new elements: those that no element of the unit has.
pub(super) struct LocalIds {
    next: u64,
}

impl LocalIds {
    pub(super) fn of(pou: &Element) -> Self {
        let mut open = vec![pou];
        let mut greatest = 0;
        while let Some(element) = open.pop() {
            let id = element.attribute("localId").and_then(|id| id.value.trim().parse().ok());
            greatest = greatest.max(id.unwrap_or(0));
            open.extend(element.elements());
        }
        Self { next: greatest }
    }

    pub(super) fn next(&mut self) -> u64 {
        self.next = self.next.saturating_add(1);
        self.next
    }
}

/// Where an element stands.
pub(super) fn position(element: &Element) -> (i64, i64) {
    let coordinate = |name| {
        let position = element.child("position").or_else(|| element.child("relPosition"));
        position.and_then(|position| position.attribute(name)).and_then(|found| number(&found.value)).unwrap_or(0)
    };
    (coordinate("x"), coordinate("y"))
}
