//! A component that is an assembly, as tables of the scene.
//!
//! A part `rod` of a component `clamp` is `clamp.rod`. Bodies, shapes, joints, fittings and couplings come behind the
//! scene's own, in the order of the components; components come in the place of the one that they are parts of, so
//! that a scene is evaluated as if it had been written out.

use std::sync::Arc;

use onescan_base::did_you_mean;

use super::assembly::{Assembly, OWN_KEYS};
use super::ports::{self, Aliases};
use super::{Kinds, Own, parts, text_of};
use crate::scene::error::SceneFaultKind;
use crate::scene::faults::Faults;
use crate::scene::format::{ComponentTable, SceneFile};
use crate::scene::placed::Placed;
use crate::scene::{arrays, robots, text};

/// Most components of a scene, so that assemblies of assemblies end.
const PARTS_MAX: usize = 100_000;

/// The components of a scene, written out.
#[derive(Default)]
pub(super) struct Expansion {
    components: Vec<Placed<ComponentTable>>,
    aliases: Aliases,
    remarks: Vec<String>,
    /// The assemblies whose parts are being taken, the outermost first.
    within: Vec<String>,
}

impl Expansion {
    /// Takes a component, or its parts in its place. Other parts go into `written`.
    pub(super) fn take(
        &mut self,
        table: Placed<ComponentTable>,
        kinds: &mut Kinds,
        written: &mut SceneFile,
        faults: &mut Faults<'_>,
    ) {
        let kind = text_of(table.get_ref(), "kind");
        let own = kind.as_ref().and_then(|kind| kinds.read(kind, faults));
        match (own, kind, text_of(table.get_ref(), "name")) {
            (Some(Own::Assembly(assembly)), Some(kind), Some(name)) => {
                let contains_itself = self.within.contains(&assembly.name);
                if contains_itself || self.components.len() >= PARTS_MAX {
                    let cause = if contains_itself {
                        format!("it contains itself: {} > {}", self.within.join(" > "), assembly.name)
                    } else {
                        format!("the scene has more than {PARTS_MAX} components")
                    };
                    faults.add(kind.span(), SceneFaultKind::OwnKind { kind: text(&kind).to_owned(), cause });
                    self.aliases.begin(&name, &assembly);
                    self.aliases.lose(&name);
                    return;
                }
                self.within.push(assembly.name.clone());
                self.instance(&assembly, (&name, &kind), table.get_ref(), kinds, written, faults);
                self.within.pop();
            }
            _ => self.components.push(table),
        }
    }

    fn instance(
        &mut self,
        assembly: &Arc<Assembly>,
        (name, kind): (&Placed<String>, &Placed<String>),
        table: &ComponentTable,
        kinds: &mut Kinds,
        written: &mut SceneFile,
        faults: &mut Faults<'_>,
    ) {
        self.aliases.begin(name, assembly);
        refuse_unknown_keys(assembly, (name, kind), table, faults);
        let base = faults.attach(&assembly.name, &assembly.source, kind.span());
        let made = assembly.values(table, faults).and_then(|values| assembly.parts(&values, base, faults));
        let Some(mut parts) = made else {
            self.aliases.lose(name);
            faults.lose(format!("{}.", text(name)));
            return;
        };
        arrays::expand(&mut parts, faults);
        for remark in robots::expand(&mut parts, faults) {
            self.remarks.push(format!("{}: {remark}", text(name)));
        }
        for component in &parts.component {
            // the keys of a part are those of its kind, so that is to be known first
            if let Some(kind) = text_of(component.get_ref(), "kind") {
                kinds.read(&kind, faults);
            }
        }
        let right = ports::connect(assembly, (name, base), table, (&mut parts.component, kinds), faults);
        parts::belong(&mut parts, text(name), kinds);
        parts::put(&mut parts, table, kinds, faults);
        match right {
            ports::Right(true) => self.aliases.take(assembly, name),
            ports::Right(false) => self.aliases.lose(name),
        }
        written.body.append(&mut parts.body);
        written.shape.append(&mut parts.shape);
        written.joint.append(&mut parts.joint);
        written.fitting.append(&mut parts.fitting);
        written.coupling.append(&mut parts.coupling);
        for component in parts.component {
            self.take(component, kinds, written, faults);
        }
    }

    /// Puts the components into the scene, with what they and failures call by the names of assemblies.
    pub(super) fn finish(mut self, written: &mut SceneFile, faults: &mut Faults<'_>) -> (Aliases, Vec<String>) {
        self.aliases.rename(&mut self.components, &mut written.failure, faults);
        written.component = self.components;
        (self.aliases, self.remarks)
    }
}

/// Keys that a component of this assembly does not have.
fn refuse_unknown_keys(
    assembly: &Assembly,
    (name, kind): (&Placed<String>, &Placed<String>),
    table: &ComponentTable,
    faults: &mut Faults<'_>,
) {
    let header = &assembly.header;
    let mut right: Vec<String> = OWN_KEYS.map(str::to_owned).to_vec();
    right.extend(header.parameter.iter().map(|parameter| text(&parameter.key).to_owned()));
    right.extend(header.binding.iter().map(|binding| text(&binding.key).to_owned()));
    for key in header.input.iter().map(|input| text(&input.key)) {
        right.extend([key.to_owned(), format!("{key}_signal"), format!("{key}_from")]);
    }
    right.extend(header.output.iter().map(|output| format!("{}_signal", text(&output.key))));
    for key in table.keys().filter(|key| !right.contains(key.get_ref())) {
        let whose = format!("{} `{}`", text(kind), text(name));
        let wrong = SceneFaultKind::ComponentKey { whose, key: key.get_ref().clone() };
        faults.add_hinted(key.span(), wrong, did_you_mean(key.get_ref(), right.iter().map(String::as_str)));
    }
}
