//! Second pass over `[[body]]`: shape, mass, pose and what it collides with.

use super::placed::Placed;

use super::error::SceneFaultKind;
use super::faults::Faults;
use super::format::BodyTable;
use super::model::{Body, Collisions, FrictionRule, GROUPS_MAX, Mass, Shape};
use super::number::{Allowed, DENSITY_KG_M3, Entry, FRICTION, MASS_KG, RESTITUTION};
use super::shapes::{Measures, MeshKeys};
use super::text;
use crate::model::BodyKind;

/// What joints and sensors call the world itself.
pub(super) const GROUND: &str = "ground";

pub(super) fn check(tables: &[Placed<BodyTable>], rule: FrictionRule, faults: &mut Faults<'_>) -> Vec<Body> {
    let mut groups = Vec::new();
    tables.iter().filter_map(|table| body(table, rule, &mut groups, faults)).collect()
}

fn body<'f>(
    table: &'f Placed<BodyTable>,
    rule: FrictionRule,
    groups: &mut Vec<&'f str>,
    faults: &mut Faults<'_>,
) -> Option<Body> {
    let written = table.get_ref();
    if text(&written.name) == GROUND {
        faults.add(written.name.span(), SceneFaultKind::Reserved(GROUND.to_owned()));
    }
    let shape = shape(table, faults);
    let mass = mass(written, faults);
    let friction = Entry::new("friction", written.friction.as_ref());
    let restitution = Entry::new("restitution", written.restitution.as_ref());
    if written.kind == BodyKind::Fixed
        && let Some(velocity) = &written.velocity_m_s
    {
        let whose = format!("fixed body `{}`", text(&written.name));
        faults.add(velocity.span(), SceneFaultKind::Misplaced { whose, key: "velocity_m_s" });
    }
    Some(Body {
        name: written.name.get_ref().clone(),
        kind: written.kind,
        shape,
        position_m: faults.triple("position_m", written.position_m.as_ref()).unwrap_or_default(),
        rpy_deg: faults.triple("rpy_deg", written.rpy_deg.as_ref()).unwrap_or_default(),
        velocity_m_s: faults.triple("velocity_m_s", written.velocity_m_s.as_ref()).unwrap_or_default(),
        mass: mass?,
        friction: faults.number(friction, Allowed::NotNegative).unwrap_or(FRICTION),
        friction_rule: written.friction_rule.unwrap_or(rule),
        restitution: faults.number(restitution, Allowed::NotNegative).unwrap_or(RESTITUTION),
        collisions: collisions(written, groups, faults),
    })
}

/// The shape of a body; none where none is written or where it is at fault.
fn shape(table: &Placed<BodyTable>, faults: &mut Faults<'_>) -> Option<Shape> {
    let written = table.get_ref();
    let name = text(&written.name);
    let Some(kind) = &written.shape else {
        if written.kind == BodyKind::Dynamic && written.inertia_kg_m2.is_none() && !written.weighed_by_shapes {
            let whose = format!("dynamic body `{name}`");
            faults.add(written.name.span(), SceneFaultKind::Missing { whose, key: "shape" });
        }
        return None;
    };
    let measures = Measures {
        name,
        kind,
        size_m: written.size_m.as_ref(),
        radius_m: written.radius_m.as_ref(),
        length_m: written.length_m.as_ref(),
        mesh: MeshKeys {
            mesh: written.mesh.as_ref(),
            unit_m: written.unit_m.as_ref(),
            hull: written.hull.as_ref(),
            stretch: None,
        },
        dynamic: written.kind == BodyKind::Dynamic,
    };
    measures.shape(faults)
}

fn mass(written: &BodyTable, faults: &mut Faults<'_>) -> Option<Mass> {
    let name = text(&written.name);
    let total = Entry::new("mass_kg", written.mass_kg.as_ref());
    let density = Entry::new("density_kg_m3", written.density_kg_m3.as_ref());
    if written.kind != BodyKind::Dynamic {
        for entry in [total, density] {
            if let Some(value) = entry.value {
                let whose = format!("`{name}`, which no force moves,");
                faults.add(value.span(), SceneFaultKind::Misplaced { whose, key: entry.key });
            }
        }
        return Some(Mass::Total { kg: 0.0 });
    }
    if written.weighed_by_shapes {
        return Some(Mass::Total { kg: 0.0 });
    }
    if written.centre_m.is_some() || written.inertia_kg_m2.is_some() {
        return stated(written, faults);
    }
    match (total.value, density.value) {
        (Some(_), None) => faults.number(total, MASS_KG).map(|kg| Mass::Total { kg }),
        (None, Some(_)) => faults.number(density, DENSITY_KG_M3).map(|kg_m3| Mass::Density { kg_m3 }),
        (None, None) | (Some(_), Some(_)) => {
            faults.add(written.name.span(), SceneFaultKind::Mass(name.to_owned()));
            None
        }
    }
}

/// The mass properties that are stated as such, unless they are at fault.
fn stated(written: &BodyTable, faults: &mut Faults<'_>) -> Option<Mass> {
    let whose = || format!("body `{}` with mass properties of its own", text(&written.name));
    let Some(inertia) = &written.inertia_kg_m2 else {
        let centre = written.centre_m.as_ref()?;
        faults.add(centre.span(), SceneFaultKind::Missing { whose: whose(), key: "inertia_kg_m2" });
        return None;
    };
    let inertia_kg_m2 = *inertia.get_ref();
    let [xx, yy, zz, xy, xz, yz] = inertia_kg_m2;
    let minor = xx * yy - xy * xy;
    let determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
    if !(xx > 0.0 && minor > 0.0 && determinant > 0.0 && determinant.is_finite()) {
        let wanted = "a tensor whose principal moments are above 0".to_owned();
        let value = format!("{inertia_kg_m2:?}");
        faults.add(inertia.span(), SceneFaultKind::Number { key: "inertia_kg_m2".into(), wanted, value });
        return None;
    }
    if written.mass_kg.is_none() {
        faults.add(inertia.span(), SceneFaultKind::Missing { whose: whose(), key: "mass_kg" });
    }
    let kg = faults.number(Entry::new("mass_kg", written.mass_kg.as_ref()), MASS_KG);
    let origin = faults.triple("position_m", written.position_m.as_ref()).unwrap_or_default();
    let centre_m = faults.triple("centre_m", written.centre_m.as_ref()).unwrap_or(origin);
    kg.map(|kg| Mass::Stated { kg, centre_m, inertia_kg_m2 })
}

fn collisions<'f>(written: &'f BodyTable, groups: &mut Vec<&'f str>, faults: &mut Faults<'_>) -> Collisions {
    if written.collides == Some(false) {
        return Collisions::None;
    }
    let Some(group) = &written.group else { return Collisions::All };
    if let Some(index) = groups.iter().position(|known| *known == text(group)) {
        return Collisions::OutsideGroup(index as u32);
    }
    if groups.len() == GROUPS_MAX {
        faults.add(group.span(), SceneFaultKind::Groups(group.get_ref().clone()));
        return Collisions::None;
    }
    groups.push(text(group));
    Collisions::OutsideGroup(groups.len() as u32 - 1)
}
