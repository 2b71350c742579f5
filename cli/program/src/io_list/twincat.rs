//! TwinCAT projects: the PLC's variables in its process images, with what they are linked to.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

use onescan_server::time::TimeSpan;

use super::collect::{Collected, Entry};
use super::error::ListError;
use super::point::Direction;
use super::twincat_types::{Types, written};
use super::xml::{Element, document, text};
use super::{IoList, ListKind, ListLink, bytes_of};
use onescan_runner::error::Usage;

/// A variable of a process image.
struct Var {
    name: String,
    ty: String,
    direction: Direction,
    comment: Option<String>,
    line: u32,
}

/// A PLC of a project.
#[derive(Default)]
struct Plc {
    name: String,
    /// The file that it is in, if not the project's own.
    file: Option<std::path::PathBuf>,
    port: Option<u16>,
    cycle: Option<TimeSpan>,
    vars: Vec<Var>,
    /// What each variable is linked to.
    links: BTreeMap<String, FarEnd>,
}

/// The other end of a link, in the words of the tree of devices.
struct FarEnd {
    text: String,
    /// True if it is a variable of the same PLC.
    is_own: bool,
}

/// Reads a project, a part of one, or the description of a compiled PLC.
///
/// # Errors
/// It is none, or has several PLCs of which none is named.
pub fn read(path: &Path, bytes: &[u8], wanted: Option<&str>) -> Result<IoList, ListError> {
    let text = text(path, bytes)?;
    let document = document(path, &text)?;
    let root = Element::root(&document);
    let mut types = Types::default();
    types.take(root);
    let plcs = match root.name() {
        "TcSmProject" | "TcSmItem" => plcs(root, path, &mut types)?,
        "TcModuleClass" => vec![compiled(root)],
        other => {
            let what = format!("<{other}> is no TwinCAT project");
            let help = Some("a project is a `.tsproj`, a part of one an `.xti`, a compiled PLC a `.tmc`".to_owned());
            return Err(ListError::Other { file: path.display().to_string(), what, help });
        }
    };
    types.complete();
    if plcs.is_empty() && root.name() == "TcSmItem" {
        return device(path, root, &types);
    }
    let plc = chosen(path, plcs, wanted)?;
    let mut collected = Collected::of(path);
    if let Some(file) = &plc.file {
        collected.goes_on_in(file);
    }
    for var in &plc.vars {
        let linked = plc.links.get(&var.name);
        if let Some(FarEnd { text, is_own: true }) = linked
            && var.direction == Direction::Input
        {
            collected.leave_out(&var.name, format!("the PLC feeds it itself ({text})"), Some(var.line));
            continue;
        }
        let entry = Entry {
            name: &var.name,
            ty: &var.ty,
            direction: var.direction,
            address: None,
            comment: var.comment.as_deref().or(linked.map(|far| far.text.as_str())),
            line: Some(var.line),
        };
        collected.take(&entry, &types)?;
    }
    Ok(IoList { cycle: plc.cycle, ..collected.list_of_symbols(ListKind::TwinCat, ListLink::Ads(plc.port)) })
}

/// The PLC that is meant.
fn chosen(path: &Path, plcs: Vec<Plc>, wanted: Option<&str>) -> Result<Plc, ListError> {
    let names: Vec<_> = plcs.iter().map(|plc| plc.name.clone()).collect();
    let listed = names.join(", ");
    let file = path.display().to_string();
    if let Some(wanted) = wanted {
        let found = plcs.into_iter().find(|plc| plc.name.eq_ignore_ascii_case(wanted));
        let help = (!names.is_empty()).then(|| format!("its PLCs are {listed}"));
        return found.ok_or_else(|| ListError::Other { file, what: format!("there is no PLC `{wanted}`"), help });
    }
    // A PLC without inputs and outputs is none to choose.
    let mut with_points: Vec<_> = plcs.into_iter().filter(|plc| !plc.vars.is_empty()).collect();
    if let [first, second, ..] = &with_points[..] {
        let help = format!("name one of {listed}, as in `--plc {}`", first.name);
        let text = format!("{file} has several PLCs with inputs and outputs: {} and {}", first.name, second.name);
        return Err(Usage::new(text, Some(help)).into());
    }
    Ok(with_points.pop().unwrap_or_default())
}

/// The PLCs of a project, those in files of their own included.
fn plcs(root: Element, path: &Path, types: &mut Types) -> Result<Vec<Plc>, ListError> {
    let mut plcs = Vec::new();
    let inside = root.below("Plc").flat_map(|plc| plc.all("Project"));
    for project in inside.chain(root.all("Project").filter(|project| project.child("Instance").is_some())) {
        let Some(file) = project.attribute("File") else {
            plcs.extend(plc(root, project));
            continue;
        };
        let part = path.parent().unwrap_or(Path::new("")).join("_Config").join("PLC").join(file.replace('\\', "/"));
        if !part.exists() {
            let what = format!("its PLC is in {}, which is not there", part.display());
            let help = Some("copy the project with its folder `_Config`".to_owned());
            return Err(ListError::Other { file: path.display().to_string(), what, help });
        }
        let text = text(&part, &bytes_of(&part)?)?;
        let document = document(&part, &text)?;
        let root = Element::root(&document);
        types.take(root);
        for project in root.all("Project") {
            plcs.extend(plc(root, project).map(|plc| Plc { file: Some(part.clone()), ..plc }));
        }
    }
    Ok(plcs)
}

fn plc(root: Element, project: Element) -> Option<Plc> {
    let instance = project.child("Instance")?;
    let cycles = instance.below("CycleTime").filter_map(|time| time.text().parse().ok());
    Some(Plc {
        name: project.attribute("Name").unwrap_or("PLC").to_owned(),
        file: None,
        port: project.attribute("AmsPort").and_then(|port| port.parse().ok()),
        cycle: cycles.filter_map(TimeSpan::from_nanos).min(),
        vars: instance.all("Vars").flat_map(vars).collect(),
        links: links(root, &instance.text_of("Name").unwrap_or_default()),
    })
}

/// The variables of a group that is an image of inputs or outputs.
fn vars(group: Element) -> impl Iterator<Item = Var> {
    let direction = match group.attribute("VarGrpType") {
        Some("1") => Some(Direction::Input),
        Some("2") => Some(Direction::Output),
        // Retained and monitored data are not inputs and outputs.
        _ => None,
    };
    direction.into_iter().flat_map(move |direction| {
        group.all("Var").filter_map(move |var| {
            Some(Var {
                name: var.text_of("Name")?.into_owned(),
                ty: var.child("Type").map_or_else(String::new, |ty| written(ty, var)),
                direction,
                comment: var.text_of("Comment").map(Cow::into_owned),
                line: var.line(),
            })
        })
    })
}

/// What the variables of an instance are linked to, in the words of the tree of devices.
fn links(root: Element, instance: &str) -> BTreeMap<String, FarEnd> {
    let mut links = BTreeMap::new();
    let is_ours = |owner: Option<&str>| owner.is_some_and(|owner| owner.rsplit('^').next() == Some(instance));
    let variable = |end: &str| end.split_once('^').map_or(end, |(_, name)| name).to_owned();
    let far = |end: &str, owner: Option<&str>| {
        let device = owner.and_then(|owner| owner.rsplit('^').next()).unwrap_or_default();
        FarEnd { text: format!("{device}: {}", end.replace('^', ", ")), is_own: is_ours(owner) }
    };
    for link in root.below("Link") {
        let (Some(a), Some(b)) = (link.attribute("VarA"), link.attribute("VarB")) else { continue };
        let owner = |name: &str| link.around().find(|around| around.name() == name)?.attribute("Name");
        let (owner_a, owner_b) = (owner("OwnerA"), owner("OwnerB"));
        if is_ours(owner_a) {
            links.entry(variable(a)).or_insert_with(|| far(b, owner_b));
        }
        if is_ours(owner_b) {
            links.entry(variable(b)).or_insert_with(|| far(a, owner_a));
        }
    }
    links
}

/// The images of a compiled PLC.
fn compiled(root: Element) -> Plc {
    let mut vars = Vec::new();
    for area in root.below("DataArea") {
        let direction = match area.child("AreaNo").and_then(|number| number.attribute("AreaType")) {
            Some("InputDst") => Direction::Input,
            Some("OutputSrc") => Direction::Output,
            _ => continue,
        };
        vars.extend(area.all("Symbol").filter_map(|symbol| {
            Some(Var {
                name: symbol.text_of("Name")?.into_owned(),
                ty: symbol.child("BaseType").map_or_else(String::new, |ty| written(ty, symbol)),
                direction,
                comment: symbol.text_of("Comment").map(Cow::into_owned),
                line: symbol.line(),
            })
        }));
    }
    Plc { name: "PLC".to_owned(), vars, ..Plc::default() }
}

/// What devices have for a PLC, of a part that is no PLC: their inputs are the PLC's inputs.
fn device(path: &Path, root: Element, types: &Types) -> Result<IoList, ListError> {
    let mut collected = Collected::of(path);
    let home = |of: Element| {
        let mut names: Vec<_> = of
            .around()
            .filter(|around| matches!(around.name(), "Box" | "Module" | "SubModule" | "Pdo"))
            .filter_map(|around| around.attribute("Name").map(Cow::Borrowed).or_else(|| around.text_of("Name")))
            .collect();
        names.reverse();
        names.into_iter().map(|name| format!("{name}.")).collect::<String>()
    };
    for group in root.below("Vars") {
        for var in vars(group) {
            let name = format!("{}{}", home(group), var.name);
            let comment = var.comment.as_deref();
            let (direction, line) = (var.direction, Some(var.line));
            let entry = Entry { name: &name, ty: &var.ty, direction, address: None, comment, line };
            collected.take(&entry, types)?;
        }
    }
    for entry in root.below("Entry") {
        let Some(pdo) = entry.around().find(|around| around.name() == "Pdo") else { continue };
        // Entries without a name fill space.
        let (Some(name), Some(ty)) = (entry.attribute("Name"), entry.text_of("Type")) else { continue };
        let is_output = pdo.attribute("InOut") == Some("1");
        let direction = if is_output { Direction::Output } else { Direction::Input };
        // Two underlines stand for a level of the tree.
        let name = format!("{}{}", home(entry), name.replace("__", "."));
        let line = Some(entry.line());
        collected.take(&Entry { name: &name, ty: &ty, direction, address: None, comment: None, line }, types)?;
    }
    Ok(collected.list(ListKind::TwinCat))
}
