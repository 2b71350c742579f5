//! A scene as a tree: what hangs on what, what moves it, what senses it, and every signal.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use onescan_base::notice::NOTICE;
use onescan_base::regular::Within;
use onescan_plant::component::open_inputs;
use onescan_plant::scene::model::{Component, JointKind, Moved, Scene, Sensing, Wire};
use onescan_plant::{Dynamics, Excess, Loop, Overlap};
use onescan_report::OutputError;
use onescan_report::file::write_output;
use onescan_report::view::Side;
use onescan_scenario::compose::report;
use onescan_scenario::file::ClientFile;
use onescan_scenario::permission::granted;
use onescan_scenario::{Scenario, ScenarioError};
use onescan_server::time::TimeSpan;
use serde::Serialize;

use super::error::PlantError;
use onescan_runner::error::Usage;
use onescan_runner::format::Format;
use onescan_runner::run::values_at_start;
use onescan_runner::scene_drawing as drawing;

use super::alike;
use super::attached::{coupled, fitted};

/// What to make of a scene.
#[derive(Clone, Debug)]
pub struct DescribeConfig {
    /// A scene, or a scenario for the scenes of its plants.
    pub path: PathBuf,
    /// How to write what it is made of.
    pub format: Format,
    /// A file for its picture.
    pub svg: Option<PathBuf>,
    /// From where it is seen.
    pub side: Side,
    /// Mass matrices and gravity forces, too.
    pub dynamics: bool,
}

/// A scene for machines.
#[derive(Serialize)]
struct Described<'s> {
    #[serde(flatten)]
    scene: &'s Scene,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    loops: Vec<Loop>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    overlaps: Vec<Overlap>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    excesses: Vec<Excess>,
    #[serde(skip_serializing_if = "Option::is_none")]
    dynamics: Option<Vec<Dynamics>>,
}

/// A scene that stands alone is looked at as in turns of this period, that of a new scenario.
const USUAL_PERIOD: TimeSpan = TimeSpan::from_millis(10).expect("not zero");

/// Reads the scene of a file, or those of a scenario's plants, and writes what it is made of; draws it if that is wanted.
///
/// # Errors
/// A file that cannot be read or is not a scene, a scenario without one; a picture that cannot be written; those of
/// `out`.
pub fn write(config: &DescribeConfig, out: &mut dyn Write) -> Result<(), PlantError> {
    let DescribeConfig { path, format, svg, side, .. } = config;
    let Found { scenario, scenes, within } = found(path)?;
    if let (Some(_), [_, (other, _), ..]) = (svg, &scenes[..]) {
        let help = format!("give the scene to draw, as `onescan describe {} --svg FILE`", other.display());
        return Err(Usage::new(format!("{} has several scenes", path.display()), Some(help)).into());
    }
    for (path, period) in &scenes {
        if scenes.len() > 1 && *format == Format::Human {
            writeln!(out, "{}", path.display()).map_err(OutputError)?;
        }
        let scene = read(path, &within)?;
        if let Some(svg) = svg {
            let title = path.display().to_string();
            let picture = match &scenario {
                Some(scenario) => drawing::svg_of(scenario, at_start(scenario).as_deref(), (&scene, &title), *side)?,
                None => drawing::svg(&scene, &title, *side),
            };
            write_output(svg, picture.as_bytes())?;
        }
        match format {
            Format::Json => {
                let excesses = scene.excesses(*period);
                let dynamics = config.dynamics.then(|| scene.dynamics());
                let whole =
                    Described { scene: &scene, loops: scene.loops(), overlaps: scene.overlaps(), excesses, dynamics };
                serde_json::to_writer_pretty(&mut *out, &whole).map_err(io::Error::from).map_err(OutputError)?;
                writeln!(out).map_err(OutputError)?;
            }
            Format::Human => {
                tree(&scene, *period, out).map_err(OutputError)?;
                if config.dynamics {
                    at_rest(&scene, out).map_err(OutputError)?;
                }
            }
        }
    }
    Ok(())
}

/// The values by which looks are drawn; nothing where there are none, or where a client cannot begin here, which is said.
fn at_start(scenario: &Scenario) -> Option<Vec<f64>> {
    if scenario.looks().looks.is_empty() {
        return None;
    }
    match values_at_start(scenario) {
        Ok(values) => Some(values),
        Err(error) => {
            tracing::warn!(target: NOTICE, "figures are drawn as without values of signals: {error}");
            None
        }
    }
}

/// What is behind a path.
struct Found {
    /// The scenario, if the path is one.
    scenario: Option<Scenario>,
    /// The scene files, each with the period of its plant's turns.
    scenes: Vec<(PathBuf, TimeSpan)>,
    /// What they may read.
    within: Within,
}

/// True for a file that is a scenario and not a scene: it has clients, or takes them from another.
fn is_scenario_file(path: &Path) -> bool {
    // What cannot be read is reported as a scene.
    let folder = path.parent().unwrap_or_else(|| Path::new(""));
    let keys = granted().within(folder).read_text(path).ok().and_then(|text| text.parse::<toml::Table>().ok());
    keys.is_some_and(|keys| ["base", "clients"].iter().any(|key| keys.contains_key(*key)))
}

fn found(path: &Path) -> Result<Found, PlantError> {
    if !path.is_dir() && !is_scenario_file(path) {
        let folder = path.parent().unwrap_or_else(|| Path::new(""));
        let scenes = vec![(path.to_owned(), USUAL_PERIOD)];
        return Ok(Found { scenario: None, scenes, within: granted().within(folder) });
    }
    let scenario = Scenario::load(path)?;
    let scenes = scenario.file().clients.values().filter_map(|client| match client.get_ref() {
        ClientFile::Plant { scene, period, .. } => {
            Some((scenario.folder().join(scene), period.unwrap_or(scenario.file().step)))
        }
        _ => None,
    });
    let scenes: Vec<_> = scenes.collect();
    if scenes.is_empty() {
        return Err(Usage::new(format!("no client of {} has a scene", path.display()), None).into());
    }
    let within = granted().within(scenario.folder());
    Ok(Found { scenario: Some(scenario), scenes, within })
}

fn read(path: &Path, within: &Within) -> Result<Scene, PlantError> {
    let file = path.display().to_string();
    let text = within.read_text(path).map_err(|source| {
        let help = Some("give a scene, as `my-cell/plant.toml`, or the folder of its scenario".to_owned());
        PlantError::Scenario(ScenarioError::Unreadable { path: path.to_owned(), source, help })
    })?;
    let scene = Scene::parse_with(&text, &file, &[], within);
    Ok(scene.map_err(|error| ScenarioError::from(Box::new(report(&error, &file, &text))))?)
}

fn tree(scene: &Scene, period: TimeSpan, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "bodies and joints")?;
    writeln!(out, "  ground")?;
    hanging(scene, None, 2, out)?;
    let free = |index: &usize| !scene.joints.iter().any(|joint| joint.child == *index);
    let free: Vec<usize> = (0..scene.bodies.len()).filter(free).collect();
    for alike in free.chunk_by(|one, next| alike::follows(scene, *one, *next)) {
        writeln!(out, "  {}", alike::bodies(scene, alike))?;
        // Bodies that carry others stand alone.
        hanging(scene, alike.first().copied(), 2, out)?;
    }
    section(out, "fittings", scene.fittings.iter().map(|fitting| fitted(fitting, scene)))?;
    section(out, "couplings", scene.couplings.iter().map(|coupling| coupled(coupling, scene)))?;
    section(
        out,
        "axes",
        scene.axes.iter().map(|axis| {
            let moved = match axis.moved {
                Moved::Joint(joint) => format!("joint {}", scene.joints[joint].name),
                Moved::Belt { body, .. } => format!("belt {}", scene.bodies[body].name),
            };
            format!("{}: {moved}", axis.name)
        }),
    )?;
    section(
        out,
        "sensors",
        scene.sensors.iter().map(|sensor| {
            let what = match &sensor.sensing {
                Sensing::EndPosition { joint, .. } => format!("end position of joint {}", scene.joints[*joint].name),
                Sensing::Proximity { targets, .. } => format!("proximity of {} bodies", targets.len()),
            };
            format!("{}: {what} -> {}", sensor.name, sensor.signal)
        }),
    )?;
    section(out, "assemblies", scene.assemblies().iter().map(|(name, kind)| format!("{name}: {kind}")))?;
    section(out, "components", scene.components.iter().map(|component| one(component, scene)))?;
    section(out, "reads", scene.reads.iter().map(|port| format!("{} : {}", port.name, port.ty)))?;
    section(out, "writes", scene.writes.iter().map(|port| format!("{} : {}", port.name, port.ty)))?;
    section(out, "remarks", scene.remarks.iter().cloned())?;
    section(out, "loops", scene.loops().iter().map(ToString::to_string))?;
    section(out, "overlaps", scene.overlaps().iter().map(ToString::to_string))?;
    let title = match scene.substeps {
        1 => format!("beyond what a plant can carry in turns of {period}"),
        substeps => format!("beyond what a plant can carry in turns of {period} with {substeps} physics steps"),
    };
    section(out, &title, scene.excesses(period).iter().map(ToString::to_string))
}

/// The mechanisms as they rest: a line for each joint, with its row of the mass matrix.
fn at_rest(scene: &Scene, out: &mut dyn Write) -> io::Result<()> {
    for Dynamics { joints, gravity, mass_matrix } in scene.dynamics() {
        writeln!(out, "mechanism at rest: what holds each joint against gravity, and its row of the mass matrix")?;
        for ((name, holds), row) in joints.iter().zip(gravity).zip(mass_matrix) {
            let slides = scene.joints.iter().any(|joint| joint.name == *name && joint.kind != JointKind::Revolute);
            let unit = if slides { "N" } else { "Nm" };
            let row: Vec<_> = row.iter().map(|entry| format!("{entry:.6}")).collect();
            writeln!(out, "  {name}: {holds:.6} {unit}; {}", row.join(" "))?;
        }
    }
    Ok(())
}

fn section(out: &mut dyn Write, title: &str, lines: impl Iterator<Item = String>) -> io::Result<()> {
    for (index, line) in lines.enumerate() {
        if index == 0 {
            writeln!(out, "{title}")?;
        }
        writeln!(out, "  {line}")?;
    }
    Ok(())
}

/// The joints whose parent a body is, each with its child; a loop is shown where it closes.
fn hanging(scene: &Scene, parent: Option<usize>, depth: usize, out: &mut dyn Write) -> io::Result<()> {
    for (index, joint) in scene.joints.iter().enumerate().filter(|(_, joint)| joint.parent == parent) {
        let child = &scene.bodies[joint.child];
        let kind = format!("{:?}", joint.kind).to_lowercase();
        let first = scene.joints.iter().position(|other| other.child == joint.child) == Some(index);
        let shown = if first { alike::body(child) } else { format!("{} (above or below)", child.name) };
        writeln!(out, "{:width$}{} ({kind}): {shown}", "", joint.name, width = 2 * depth)?;
        // a tree of joints is no deeper than there are bodies
        if first && depth <= scene.bodies.len() + 1 {
            hanging(scene, Some(joint.child), depth + 1, out)?;
        }
    }
    Ok(())
}

/// A component: what it is bound to, what of it is not preset, its wires, and its inputs without one.
fn one(component: &Component, scene: &Scene) -> String {
    let mut lines = vec![format!("{}: {}", component.name, component.kind.name)];
    let kind = &component.kind;
    let bound = kind.coupling.in_words(&component.bound, scene);
    if !bound.is_empty() {
        lines[0].push_str(", ");
        lines[0].push_str(&bound);
    }
    for (parameter, setting) in kind.parameters.iter().zip(&component.settings) {
        if parameter.preset != *setting {
            lines.push(format!("{} = {setting}", parameter.key));
        }
    }
    for (input, wire) in kind.inputs.iter().zip(&component.inputs) {
        match wire {
            Wire::Open => {}
            Wire::Constant(value) => lines.push(format!("{} = {value}", input.key)),
            Wire::Signal(name) => lines.push(format!("{} <- {name}", input.key)),
            Wire::Output { component, output } => {
                let from = &scene.components[*component];
                lines.push(format!("{} <- {}.{}", input.key, from.name, from.kind.outputs[*output].key));
            }
        }
    }
    let open: Vec<_> = open_inputs(component).iter().map(|(key, preset)| format!("{key} = {preset}")).collect();
    if !open.is_empty() {
        lines.push(format!("driven by nobody: {}", open.join(", ")));
    }
    for (output, name) in kind.outputs.iter().zip(&component.outputs) {
        lines.extend(name.as_ref().map(|name| format!("{} -> {name}", output.key)));
    }
    lines.extend(component.failures.iter().map(|failure| format!("may fail: {}", kind.failures[failure.mode].mode)));
    lines.join("\n    ")
}
