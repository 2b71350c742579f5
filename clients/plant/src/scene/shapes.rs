//! The measures of a shape, and the second pass over `[[shape]]`: more shapes of a body.

use super::placed::Placed;

use super::error::SceneFaultKind;
use super::faults::Faults;
use super::format::{BodyTable, ShapeKind, ShapeTable, Triple};
use super::model::{Attached, FrictionRule, Shape};
use super::names::Names;
use super::number::{Allowed, Entry};
use super::number::{DENSITY_KG_M3, FRICTION, LENGTH_M, MASS_KG, RESTITUTION};
use super::text;
use crate::model::BodyKind;

pub(super) fn check(
    tables: &[Placed<ShapeTable>],
    of: &[Placed<BodyTable>],
    rule: FrictionRule,
    bodies: &Names,
    faults: &mut Faults<'_>,
) -> Vec<Attached> {
    tables.iter().filter_map(|table| attached(table.get_ref(), of, rule, bodies, faults)).collect()
}

fn attached(
    written: &ShapeTable,
    of: &[Placed<BodyTable>],
    rule: FrictionRule,
    bodies: &Names,
    faults: &mut Faults<'_>,
) -> Option<Attached> {
    let body = bodies.find(&written.body, faults);
    let measures = Measures {
        name: text(&written.name),
        kind: &written.shape,
        size_m: written.size_m.as_ref(),
        radius_m: written.radius_m.as_ref(),
        length_m: written.length_m.as_ref(),
        mesh: MeshKeys {
            mesh: written.mesh.as_ref(),
            unit_m: written.unit_m.as_ref(),
            hull: written.hull.as_ref(),
            stretch: written.stretch,
        },
        dynamic: body.is_some_and(|body| of[body].get_ref().kind == BodyKind::Dynamic),
    };
    let shape = measures.shape(faults);
    let mass = Entry::new("mass_kg", written.mass_kg.as_ref());
    let density = Entry::new("density_kg_m3", written.density_kg_m3.as_ref());
    for entry in [mass, density] {
        if let (Some(body), Some(value)) = (body, entry.value)
            && of[body].get_ref().kind != BodyKind::Dynamic
        {
            let whose = format!("`{}`, whose body no force moves,", text(&written.name));
            faults.add(value.span(), SceneFaultKind::Misplaced { whose, key: entry.key });
        }
    }
    if let (Some(_), Some(value)) = (mass.value, density.value) {
        let whose = format!("shape `{}` with a mass", text(&written.name));
        faults.add(value.span(), SceneFaultKind::Misplaced { whose, key: density.key });
    }
    let friction = Entry::new("friction", written.friction.as_ref());
    let restitution = Entry::new("restitution", written.restitution.as_ref());
    Some(Attached {
        name: written.name.get_ref().clone(),
        mass_kg: faults.number(mass, MASS_KG).unwrap_or(0.0),
        density_kg_m3: faults.number(density, DENSITY_KG_M3),
        position_m: faults.triple("position_m", written.position_m.as_ref()).unwrap_or_default(),
        rpy_deg: faults.triple("rpy_deg", written.rpy_deg.as_ref()).unwrap_or_default(),
        friction: faults.number(friction, Allowed::NotNegative).unwrap_or(FRICTION),
        friction_rule: written.friction_rule.unwrap_or(rule),
        restitution: faults.number(restitution, Allowed::NotNegative).unwrap_or(RESTITUTION),
        collides: written.collides.unwrap_or(true),
        body: body?,
        shape: shape?,
    })
}

/// The keys of a shape that is a mesh.
#[derive(Clone, Copy)]
pub(super) struct MeshKeys<'f> {
    pub(super) mesh: Option<&'f Placed<String>>,
    pub(super) unit_m: Option<&'f Placed<f64>>,
    pub(super) hull: Option<&'f Placed<bool>>,
    /// What 1 means along each axis, of a robot's mesh.
    pub(super) stretch: Option<[f64; 3]>,
}

/// The measures of one shape, as they are written.
pub(super) struct Measures<'f> {
    pub(super) name: &'f str,
    pub(super) kind: &'f Placed<ShapeKind>,
    pub(super) size_m: Option<&'f Triple>,
    pub(super) radius_m: Option<&'f Placed<f64>>,
    pub(super) length_m: Option<&'f Placed<f64>>,
    pub(super) mesh: MeshKeys<'f>,
    /// Whether forces move its body.
    pub(super) dynamic: bool,
}

impl Measures<'_> {
    /// The shape, unless a measure is missing or at fault.
    pub(super) fn shape(&self, faults: &mut Faults<'_>) -> Option<Shape> {
        self.refuse_foreign(faults);
        Some(match self.kind.get_ref() {
            ShapeKind::Box => Shape::Box { size_m: self.size(faults)? },
            ShapeKind::Sphere => Shape::Sphere { radius_m: self.length("radius_m", self.radius_m, faults)? },
            ShapeKind::Cylinder => {
                let (radius_m, length_m) = self.radius_and_length(faults)?;
                Shape::Cylinder { radius_m, length_m }
            }
            ShapeKind::Capsule => {
                let (radius_m, length_m) = self.radius_and_length(faults)?;
                Shape::Capsule { radius_m, length_m }
            }
            ShapeKind::Mesh => self.mesh.shape(self, faults)?,
        })
    }

    pub(super) fn whose(&self) -> String {
        let kind = match self.kind.get_ref() {
            ShapeKind::Box => "box",
            ShapeKind::Sphere => "sphere",
            ShapeKind::Cylinder => "cylinder",
            ShapeKind::Capsule => "capsule",
            ShapeKind::Mesh => "mesh",
        };
        format!("{kind} `{}`", self.name)
    }

    pub(super) fn missing(&self, key: &'static str, faults: &mut Faults<'_>) {
        faults.add(self.kind.span(), SceneFaultKind::Missing { whose: self.whose(), key });
    }

    fn length(&self, key: &'static str, value: Option<&Placed<f64>>, faults: &mut Faults<'_>) -> Option<f64> {
        if value.is_none() {
            self.missing(key, faults);
        }
        faults.number(Entry::new(key, value), LENGTH_M)
    }

    fn radius_and_length(&self, faults: &mut Faults<'_>) -> Option<(f64, f64)> {
        let radius_m = self.length("radius_m", self.radius_m, faults);
        let length_m = self.length("length_m", self.length_m, faults);
        radius_m.zip(length_m)
    }

    fn size(&self, faults: &mut Faults<'_>) -> Option<[f64; 3]> {
        let Some(size) = self.size_m else {
            self.missing("size_m", faults);
            return None;
        };
        faults.components("size_m", size, LENGTH_M)
    }

    /// Measures that belong to another shape are faults.
    fn refuse_foreign(&self, faults: &mut Faults<'_>) {
        let (size, radius, length) = match self.kind.get_ref() {
            ShapeKind::Box => (None, self.radius_m, self.length_m),
            ShapeKind::Sphere => (self.size_m, None, self.length_m),
            ShapeKind::Cylinder | ShapeKind::Capsule => (self.size_m, None, None),
            ShapeKind::Mesh => (self.size_m, self.radius_m, self.length_m),
        };
        let foreign = [
            (size.map(Triple::span), "size_m"),
            (radius.map(Placed::span), "radius_m"),
            (length.map(Placed::span), "length_m"),
        ];
        let of_mesh = self.mesh.written().into_iter().filter(|_| *self.kind.get_ref() != ShapeKind::Mesh);
        for (span, key) in foreign.into_iter().chain(of_mesh) {
            if let Some(span) = span {
                faults.add(span, SceneFaultKind::Misplaced { whose: self.whose(), key });
            }
        }
    }
}
