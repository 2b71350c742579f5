//! Types that a TwinCAT project, a part of one or the description of a compiled PLC declares.

use std::collections::BTreeMap;

use super::flatten::{Declared, Shape};
use super::xml::Element;

/// How many structures may extend each other.
const EXTENDS_MAX: usize = 16;

/// Declared types by name; of equal names the first counts.
#[derive(Debug, Default)]
pub(super) struct Types {
    shapes: BTreeMap<String, Shape>,
    extends: BTreeMap<String, String>,
}

impl Types {
    /// Takes what is declared below an element.
    pub(super) fn take(&mut self, root: Element) {
        for declared in root.below("DataType") {
            let Some(name) = declared.text_of("Name") else { continue };
            let fields = fields(declared);
            let shape = if fields.is_empty() {
                let Some(base) = declared.child("BaseType") else { continue };
                Shape::Alias(written(base, declared))
            } else {
                Shape::Structure(fields)
            };
            if let Some(base) = declared.text_of("ExtendsType") {
                self.extends.entry(name.clone().into_owned()).or_insert_with(|| base.into_owned());
            }
            self.shapes.entry(name.into_owned()).or_insert(shape);
        }
    }

    /// Puts the fields of extended structures in front of their own.
    pub(super) fn complete(&mut self) {
        let mut complete = BTreeMap::new();
        for name in self.extends.keys() {
            let mut all = Vec::new();
            let mut next = Some(name);
            for _ in 0..EXTENDS_MAX {
                let Some(name) = next else { break };
                if let Some(Shape::Structure(fields)) = self.shapes.get(name) {
                    all.splice(0..0, fields.iter().cloned());
                }
                next = self.extends.get(name);
            }
            complete.insert(name.clone(), Shape::Structure(all));
        }
        self.shapes.extend(complete);
    }
}

impl Declared for Types {
    fn shape(&self, name: &str) -> Option<&Shape> {
        self.shapes.get(name)
    }
}

fn fields(declared: Element) -> Vec<(String, String)> {
    let fields = declared.all("SubItem").filter_map(|field| {
        let ty = field.child("Type").map(|ty| written(ty, field))?;
        Some((field.text_of("Name")?.into_owned(), ty))
    });
    fields.collect()
}

/// The type of a variable or field as it would be written in a program.
pub(super) fn written(ty: Element, of: Element) -> String {
    if let Some(levels) = ty.attribute("PointerTo") {
        return format!("{}{}", "POINTER TO ".repeat(levels.parse().unwrap_or(1).clamp(1, 4)), ty.text());
    }
    if ty.attribute("ReferenceTo").is_some() {
        return format!("REFERENCE TO {}", ty.text());
    }
    let bounds = of.all("ArrayInfo").filter_map(|dimension| {
        let low: i64 = dimension.text_of("LBound")?.parse().ok()?;
        let elements: i64 = dimension.text_of("Elements")?.parse().ok()?;
        Some(format!("{low}..{}", low.checked_add(elements)?.checked_sub(1)?))
    });
    let bounds: Vec<_> = bounds.collect();
    if bounds.is_empty() { ty.text().into_owned() } else { format!("ARRAY [{}] OF {}", bounds.join(","), ty.text()) }
}
