//! Inputs, outputs and failure modes of an assembly, as those of its parts.

use std::collections::BTreeMap;
use std::sync::Arc;

use onescan_base::nearest;

use super::assembly::{Assembly, FOREIGN};
use super::{Kinds, Own, text_of};
use crate::scene::error::SceneFaultKind;
use crate::scene::faults::Faults;
use crate::scene::format::{ComponentTable, FailureTable};
use crate::scene::placed::Placed;
use crate::scene::text;

/// What names of a scene's assemblies stand for.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Aliases {
    /// Components that are assemblies, and what those are called.
    assemblies: Vec<(String, String)>,
    outputs: BTreeMap<String, String>,
    /// The mode of a component, as the mode of a part.
    modes: BTreeMap<String, String>,
    /// Components whose parts are not there, because something is wrong.
    lost: Vec<String>,
}

/// What an instance gives an input, by the ending of its key.
const WAYS: [&str; 3] = ["_signal", "_from", ""];

/// Whether every port of an assembly is one of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Right(pub(super) bool);

/// Gives the parts what the component's keys say of the assembly's ports; `base` is to be added to places in the
/// assembly's file.
pub(super) fn connect(
    assembly: &Assembly,
    (name, base): (&Placed<String>, usize),
    table: &ComponentTable,
    (parts, kinds): (&mut [Placed<ComponentTable>], &Kinds),
    faults: &mut Faults<'_>,
) -> Right {
    let mut right = Right(true);
    refuse_signals(assembly, parts, faults);
    for input in &assembly.header.input {
        let key = text(&input.key);
        let given: Vec<_> =
            WAYS.iter().filter_map(|way| Some((*way, table.get(format!("{key}{way}").as_str())?.clone()))).collect();
        if let Some((_, second)) = given.get(1) {
            let whose = format!("{} `{}`", assembly.name, text(name));
            faults.add(second.span(), SceneFaultKind::WiredTwice { whose, input: key.to_owned() });
        }
        let preset = || input.preset.as_ref().map(|preset| ("", shifted(preset, base)));
        for to in &input.to {
            let Some((part, own, target)) = port(to, parts, kinds, Side::Input) else {
                refuse(assembly, to, base, "input", (parts, kinds), faults);
                right = Right(false);
                continue;
            };
            let Some((way, mut value)) = given.first().cloned().or_else(preset) else { continue };
            if let ("_from", toml::Value::String(from)) = (way, value.get_mut()) {
                // named outside of the assembly
                from.insert(0, FOREIGN);
            }
            let key = if way.is_empty() { own } else { format!("{target}{way}") };
            set(part, key, value, to, base, faults);
        }
    }
    for output in &assembly.header.output {
        let Some((part, _, target)) = port(&output.from, parts, kinds, Side::Output) else {
            refuse(assembly, &output.from, base, "output", (parts, kinds), faults);
            right = Right(false);
            continue;
        };
        if let Some(signal) = table.get(format!("{}_signal", text(&output.key)).as_str()) {
            set(part, format!("{target}_signal"), signal.clone(), &output.from, base, faults);
        }
    }
    for mode in &assembly.header.failure_mode {
        if port(&mode.of, parts, kinds, Side::Mode).is_none() {
            refuse(assembly, &mode.of, base, "failure mode", (parts, kinds), faults);
            right = Right(false);
        }
    }
    if let Some(number) = table.get("signal_type") {
        for part in parts.iter_mut().map(Placed::get_mut).filter(|part| !part.contains_key("signal_type")) {
            part.insert(Placed::new(number.span(), "signal_type".to_owned()), number.clone());
        }
    }
    right
}

/// Signals that a part names itself: all components of the assembly would have the same.
fn refuse_signals(assembly: &Assembly, parts: &[Placed<ComponentTable>], faults: &mut Faults<'_>) {
    for key in parts.iter().flat_map(|part| part.get_ref().keys()).filter(|key| text(key).ends_with("_signal")) {
        let cause = format!("a part has no `{}`: signals come in and go out by the ports of its assembly", text(key));
        let hint = Some("name it in an `[[input]]` or `[[output]]`".to_owned());
        faults.add_hinted(key.span(), SceneFaultKind::OwnKind { kind: assembly.name.clone(), cause }, hint);
    }
}

fn shifted(value: &Placed<toml::Value>, base: usize) -> Placed<toml::Value> {
    let span = value.span();
    Placed::new(base + span.start..base + span.end, value.get_ref().clone())
}

fn set(
    part: &mut Placed<ComponentTable>,
    key: String,
    value: Placed<toml::Value>,
    port: &Placed<String>,
    base: usize,
    faults: &mut Faults<'_>,
) {
    if part.get_ref().contains_key(key.as_str()) {
        let span = port.span();
        let cause = format!("`{}` is connected twice", text(port));
        faults.add(base + span.start..base + span.end, SceneFaultKind::Form(cause));
        return;
    }
    part.get_mut().insert(Placed::new(value.span(), key), value);
}

/// What a port of a part is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Input,
    Output,
    Mode,
}

/// By its name, a part.
fn named<'t>(parts: &'t mut [Placed<ComponentTable>], name: &str) -> Option<&'t mut Placed<ComponentTable>> {
    parts.iter_mut().find(|part| text_of(part.get_ref(), "name").is_some_and(|found| text(&found) == name))
}

/// The part that `"part.port"` names, the key of a constant for the port, and the port; none if there is none.
fn port<'p>(
    named_port: &Placed<String>,
    parts: &'p mut [Placed<ComponentTable>],
    kinds: &Kinds,
    side: Side,
) -> Option<(&'p mut Placed<ComponentTable>, String, String)> {
    let (name, wanted) = text(named_port).rsplit_once('.')?;
    let part = named(parts, name)?;
    let kind = text_of(part.get_ref(), "kind")?;
    let constant = match kinds.own.get(text(&kind)) {
        // something is wrong with it, and is reported: its ports are not known
        Some(Own::Faulty) => Some(wanted.to_owned()),
        Some(Own::Assembly(inner)) => {
            inner_ports(inner, side).iter().any(|port| port == wanted).then(|| wanted.to_owned())
        }
        _ => {
            // one that is not there is missed once, as a kind
            let Some(kind) = kinds.find(text(&kind)) else { return Some((part, wanted.to_owned(), wanted.to_owned())) };
            let known = match side {
                Side::Input => kind.inputs.iter().any(|input| input.key == wanted),
                Side::Output => kind.outputs.iter().any(|output| output.key == wanted),
                Side::Mode => kind.failures.iter().any(|failure| failure.mode == wanted),
            };
            known.then(|| kind.constant_key(wanted))
        }
    };
    Some((part, constant?, wanted.to_owned()))
}

fn inner_ports(assembly: &Assembly, side: Side) -> Vec<String> {
    let header = &assembly.header;
    let keys: Vec<&Placed<String>> = match side {
        Side::Input => header.input.iter().map(|input| &input.key).collect(),
        Side::Output => header.output.iter().map(|output| &output.key).collect(),
        Side::Mode => header.failure_mode.iter().map(|mode| &mode.mode).collect(),
    };
    keys.into_iter().map(|key| text(key).to_owned()).collect()
}

/// A port of no part.
fn refuse(
    assembly: &Assembly,
    wrong: &Placed<String>,
    base: usize,
    what: &str,
    (parts, kinds): (&[Placed<ComponentTable>], &Kinds),
    faults: &mut Faults<'_>,
) {
    let span = base + wrong.span().start..base + wrong.span().end;
    let names: Vec<_> = parts.iter().filter_map(|part| text_of(part.get_ref(), "name")).collect();
    let (name, port) = text(wrong).rsplit_once('.').unwrap_or((text(wrong), ""));
    let part = parts.iter().find(|part| text_of(part.get_ref(), "name").is_some_and(|found| text(&found) == name));
    let (cause, hint) = match part {
        None => {
            let near = nearest(name, names.iter().map(text));
            (
                format!("no part `{name}` in this assembly; it is to be \"part.{}\"", what.replace(' ', "_")),
                near.map(str::to_owned),
            )
        }
        Some(part) => {
            let kind = text_of(part.get_ref(), "kind").and_then(|kind| kinds.find(text(&kind)));
            let ports: Vec<String> = kind.map_or_else(Vec::new, |kind| match what {
                "input" => kind.inputs.iter().map(|input| input.key.to_string()).collect(),
                "output" => kind.outputs.iter().map(|output| output.key.to_string()).collect(),
                _ => kind.failures.iter().map(|failure| failure.mode.to_string()).collect(),
            });
            (
                format!("part `{name}` has no {what} `{port}`"),
                nearest(port, ports.iter().map(String::as_str)).map(str::to_owned),
            )
        }
    };
    let hint = hint.map(|near| format!("did you mean `{near}`?"));
    faults.add_hinted(span, SceneFaultKind::OwnKind { kind: assembly.name.clone(), cause }, hint);
}

impl Aliases {
    /// Components that are assemblies, each with what that is called.
    pub(crate) fn assemblies(&self) -> &[(String, String)] {
        &self.assemblies
    }

    /// The part and its mode that a mode of an assembly stands for.
    pub(crate) fn mode(&self, component: &str, mode: &str) -> Option<(&str, &str)> {
        let mut found = self.modes.get(&format!("{component}.{mode}"))?;
        // an assembly within another
        while let Some(inner) = self.modes.get(found) {
            found = inner;
        }
        found.rsplit_once('.')
    }

    /// The modes of a component that is an assembly.
    pub(crate) fn modes_of(&self, component: &str) -> impl Iterator<Item = &str> {
        self.modes.keys().filter_map(move |known| known.strip_prefix(component)?.strip_prefix('.'))
    }

    pub(super) fn begin(&mut self, name: &Placed<String>, assembly: &Arc<Assembly>) {
        self.assemblies.push((text(name).to_owned(), assembly.name.clone()));
    }

    pub(super) fn lose(&mut self, name: &Placed<String>) {
        self.lost.push(text(name).to_owned());
    }

    /// What a component's outputs and modes stand for.
    pub(super) fn take(&mut self, assembly: &Assembly, name: &Placed<String>) {
        let name = text(name);
        for output in &assembly.header.output {
            self.outputs.insert(format!("{name}.{}", text(&output.key)), format!("{name}.{}", text(&output.from)));
        }
        for mode in &assembly.header.failure_mode {
            self.modes.insert(format!("{name}.{}", text(&mode.mode)), format!("{name}.{}", text(&mode.of)));
        }
    }

    /// Puts the names of parts in the place of those of assemblies.
    pub(super) fn rename(
        &self,
        components: &mut [Placed<ComponentTable>],
        failures: &mut [Placed<FailureTable>],
        faults: &mut Faults<'_>,
    ) {
        for component in components {
            let mut wrong = Vec::new();
            for (key, value) in component.get_mut().iter_mut().filter(|(key, _)| text(key).ends_with("_from")) {
                let span = value.span();
                let toml::Value::String(from) = value.get_mut() else { continue };
                while let Some(inner) = self.outputs.get(from.as_str()) {
                    from.clone_from(inner);
                }
                if let Some((name, output)) = from.rsplit_once('.')
                    && self.is_assembly(name)
                {
                    self.refuse(span, name, "output", output, faults);
                    wrong.push(text(key).to_owned());
                }
            }
            // what is reported is not looked for again
            for key in wrong {
                component.get_mut().remove(key.as_str());
            }
        }
        for failure in failures.iter_mut().map(Placed::get_mut) {
            if let Some((part, mode)) = self.mode(text(&failure.component), text(&failure.mode)) {
                *failure.component.get_mut() = part.to_owned();
                *failure.mode.get_mut() = mode.to_owned();
            }
        }
    }

    pub(crate) fn is_assembly(&self, name: &str) -> bool {
        self.assemblies.iter().any(|(known, _)| known == name)
    }

    /// Components whose parts are not there.
    pub(crate) fn lost(&self) -> impl Iterator<Item = &str> {
        self.lost.iter().map(String::as_str)
    }

    /// Whether it is a component whose parts are not there.
    fn is_lost(&self, name: &str) -> bool {
        self.lost.iter().any(|lost| lost == name)
    }

    /// An output that an assembly does not have.
    fn refuse(
        &self,
        span: std::ops::Range<usize>,
        component: &str,
        what: &'static str,
        name: &str,
        faults: &mut Faults<'_>,
    ) {
        if self.is_lost(component) {
            return;
        }
        let outputs = self.outputs.keys().filter_map(|known| known.strip_prefix(component)?.strip_prefix('.'));
        let hint = nearest(name, outputs).map(|near| format!("did you mean `{near}`?"));
        let kind = SceneFaultKind::ComponentPart { component: component.to_owned(), what, name: name.to_owned() };
        faults.add_hinted(span, kind, hint);
    }
}
