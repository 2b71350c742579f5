//! The kinds in a folder, for people: read as a scene would read them.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use onescan_base::regular::Within;
use serde::Serialize;

use super::assembly::{Assembly, FOREIGN, Given};
use super::folder::Folder;
use super::{Kinds, Own, ports, text_of};
use crate::component::kind::{Kind, Signal, unit};
use crate::component::page;
use crate::scene::error::SceneFault;
use crate::scene::faults::Faults;
use crate::scene::format::ComponentTable;
use crate::scene::placed::Placed;
use crate::scene::{arrays, robots, text};

/// What a folder of kinds has.
pub struct Listing {
    /// The kinds that are right, in the order of their files.
    pub kinds: Vec<OwnKind>,
    /// What is wrong with the others.
    pub faults: Vec<SceneFault>,
}

/// A kind of the user's own.
#[derive(Debug, Serialize)]
#[serde(untagged)]
pub enum OwnKind {
    Program(Kind),
    /// Parts of a scene.
    Assembly(AssemblyKind),
}

/// An assembly, for people.
#[derive(Debug, Serialize)]
pub struct AssemblyKind {
    name: String,
    summary: String,
    source: String,
    bindings: Vec<Entry>,
    parameters: Vec<Entry>,
    inputs: Vec<Entry>,
    outputs: Vec<Entry>,
    failures: Vec<Entry>,
}

/// A key of an assembly.
#[derive(Debug, Default, Serialize)]
struct Entry {
    key: String,
    about: String,
    #[serde(rename = "type", skip_serializing_if = "Option::is_none")]
    ty: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    preset: Option<String>,
}

impl OwnKind {
    /// What a scene calls it.
    pub fn name(&self) -> &str {
        match self {
            Self::Program(kind) => &kind.name,
            Self::Assembly(kind) => &kind.name,
        }
    }

    /// What it is, in one line.
    pub fn summary(&self) -> &str {
        match self {
            Self::Program(kind) => &kind.summary,
            Self::Assembly(kind) => &kind.summary,
        }
    }

    /// All about it, in Markdown.
    pub fn page(&self) -> String {
        match self {
            Self::Program(kind) => page::page(kind),
            Self::Assembly(kind) => kind.page(),
        }
    }
}

/// Reads all kinds of a folder.
///
/// # Errors
/// The folder cannot be read.
pub fn read(folder: &Path, within: &Within) -> std::io::Result<Listing> {
    let named = folder.display().to_string();
    let found = Folder::list(folder, folder, &named)?;
    let names: Vec<String> = found.names().map(str::to_owned).collect();
    let mut faults = Faults::new("", &named, within);
    let mut kinds = Kinds { folders: vec![found], own: BTreeMap::new(), files: Vec::new() };
    let mut listed = Vec::new();
    for name in names {
        let before = faults.found_so_far();
        let kind = match kinds.read(&Placed::new(0..0, name), &mut faults) {
            Some(Own::Program(origin)) => OwnKind::Program((*origin).clone()),
            Some(Own::Assembly(assembly)) => {
                let found = parts(&assembly, &mut kinds, &mut faults);
                OwnKind::Assembly(described(&assembly, &found, &mut kinds, &mut faults))
            }
            Some(Own::Faulty) | None => continue,
        };
        if faults.found_so_far() == before {
            listed.push(kind);
        }
    }
    Ok(Listing { kinds: listed, faults: faults.into_found() })
}

/// The parts of an assembly that are components, with its presets.
fn parts(assembly: &Assembly, kinds: &mut Kinds, faults: &mut Faults<'_>) -> Vec<Placed<ComponentTable>> {
    let nothing = ComponentTable::new();
    let base = faults.attach(&assembly.name, &assembly.source, 0..0);
    let Some(mut values) = assembly.values(&nothing, faults) else { return Vec::new() };
    // whatever they are bound to
    for key in assembly.header.binding.iter().map(|binding| text(&binding.key)) {
        if !values.iter().any(|given| given.key == key) {
            values.push(Given { key, value: toml::Value::String(format!("{FOREIGN}{key}")), at: None });
        }
    }
    let Some(mut parts) = assembly.parts(&values, base, faults) else { return Vec::new() };
    arrays::expand(&mut parts, faults);
    // what is read otherwise than it is written is for those who use it
    drop(robots::expand(&mut parts, faults));
    for component in &parts.component {
        if let Some(kind) = text_of(component.get_ref(), "kind") {
            kinds.read(&kind, faults);
        }
    }
    let name = Placed::new(0..0, assembly.name.clone());
    // what is wrong with a port is among the faults
    let _: ports::Right = ports::connect(assembly, (&name, base), &nothing, (&mut parts.component, kinds), faults);
    parts.component
}

fn described(
    assembly: &Assembly,
    parts: &[Placed<ComponentTable>],
    kinds: &mut Kinds,
    faults: &mut Faults<'_>,
) -> AssemblyKind {
    let header = &assembly.header;
    let entry = |key: &Placed<String>, about: &str| Entry {
        key: text(key).to_owned(),
        about: about.to_owned(),
        ..Entry::default()
    };
    let mut input = |port: &Placed<String>, faults: &mut Faults<'_>| signal(text(port), parts, kinds, faults, 0);
    let inputs = header.input.iter().map(|one| {
        let inner = one.to.first().and_then(|to| input(to, faults));
        let preset = one.preset.as_ref().map(|preset| preset.get_ref().to_string());
        let preset = preset.or_else(|| inner.as_ref()?.preset.map(|preset| preset.to_string()));
        Entry { ty: inner.map(|inner| inner.values.to_string()), preset, ..entry(&one.key, &one.about) }
    });
    let inputs = inputs.collect();
    let outputs = header.output.iter().map(|one| {
        let inner = input(&one.from, faults);
        Entry { ty: inner.map(|inner| inner.values.to_string()), ..entry(&one.key, &one.about) }
    });
    AssemblyKind {
        name: assembly.name.clone(),
        summary: header.summary.clone(),
        source: header.source.clone().unwrap_or_else(|| assembly.source.file.clone()),
        bindings: header
            .binding
            .iter()
            .map(|one| Entry { preset: one.preset.clone(), ..entry(&one.key, &one.about) })
            .collect(),
        parameters: header
            .parameter
            .iter()
            .map(|one| {
                let preset = Some(one.preset.get_ref().to_string());
                Entry { ty: Some(one.in_words()), preset, ..entry(&one.key, &one.about) }
            })
            .collect(),
        inputs,
        outputs: outputs.collect(),
        failures: header.failure_mode.iter().map(|one| entry(&one.mode, &one.about)).collect(),
    }
}

/// Deepest nesting of assemblies that is looked into.
const DEPTH_MAX: usize = 16;

/// The signal that `"part.port"` names, by that of the innermost part.
fn signal(
    port: &str,
    parts: &[Placed<ComponentTable>],
    kinds: &mut Kinds,
    faults: &mut Faults<'_>,
    depth: usize,
) -> Option<Signal> {
    let (name, wanted) = port.rsplit_once('.')?;
    let part = parts.iter().find(|part| text_of(part.get_ref(), "name").is_some_and(|found| text(&found) == name))?;
    let kind = text_of(part.get_ref(), "kind")?;
    match kinds.own.get(text(&kind)).cloned() {
        Some(Own::Assembly(inner)) if depth < DEPTH_MAX => {
            let to =
                inner.header.input.iter().find(|input| text(&input.key) == wanted).and_then(|input| input.to.first());
            let from = inner.header.output.iter().find(|output| text(&output.key) == wanted).map(|output| &output.from);
            let port = text(to.or(from)?).to_owned();
            let parts = self::parts(&inner, kinds, faults);
            signal(&port, &parts, kinds, faults, depth + 1)
        }
        _ => {
            let kind = kinds.find(text(&kind))?;
            kind.inputs.iter().chain(&kind.outputs).find(|signal| signal.key == wanted).cloned()
        }
    }
}

impl AssemblyKind {
    fn page(&self) -> String {
        let mut page = format!("## {}\n\n{}.\n\nSource: {}.\n", self.name, self.summary, self.source);
        let tables = [
            ("bound to", &self.bindings),
            ("parameter", &self.parameters),
            ("input", &self.inputs),
            ("output", &self.outputs),
            ("failure mode", &self.failures),
        ];
        for (title, entries) in tables.into_iter().filter(|(_, entries)| !entries.is_empty()) {
            // a String grows without fail
            let _ = write!(page, "\n| {title} | preset | unit | type | |\n|---|---|---|---|---|\n");
            for Entry { key, about, ty, preset } in entries {
                // an empty cell for what an entry does not have
                let [preset, ty] = [preset, ty].map(|cell| cell.as_deref().unwrap_or(""));
                let unit = unit(key).1.unwrap_or("");
                let _ = writeln!(page, "| `{key}` | {preset} | {unit} | {ty} | {about} |");
            }
        }
        page
    }
}
