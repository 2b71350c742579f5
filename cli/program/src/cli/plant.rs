//! With scenes and scenarios: `onescan components`, `describe`, `wiring`, `show`, `edit`, `new` and `templates`.

use std::net::SocketAddr;
use std::path::PathBuf;

use clap::{Args as ClapArgs, ValueEnum};
use onescan_report::OutputError;
use onescan_report::view::Side;

use super::error::CommandError;
use super::value::FormatArg;
use super::verdict_output::VerdictOutput;
use crate::io_list::{ListKind, Wanted};
use crate::new::from_list::FromListConfig;
use crate::new::{self, Template};
use crate::plant::components::ComponentsConfig;
use crate::plant::describe::DescribeConfig;
use crate::plant::{components, describe};
use crate::show::{self, ShowConfig};
use onescan_edit::edit::{self, EditConfig};
use onescan_edit::wiring::{self, WiringConfig};
use onescan_runner::error::ExitCode;
use onescan_runner::how_far::{HowFar, Total};

/// Options of `components`.
#[derive(Debug, ClapArgs)]
pub struct ComponentsArgs {
    /// A kind, for its equations, parameters, signals and failure modes
    pub kind: Option<String>,
    /// A folder with kinds of your own, as the `libraries` of a scene name it; may be given several times
    #[arg(long, value_name = "FOLDER")]
    pub library: Vec<PathBuf>,
    /// For people, or JSON for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
}

/// Lists the library of components and kinds of the user's own.
///
/// # Errors
/// See [`CommandError`].
pub fn components(args: &ComponentsArgs) -> Result<ExitCode, CommandError> {
    let config =
        ComponentsConfig { kind: args.kind.clone(), libraries: args.library.clone(), format: args.format.into() };
    components::write(&config, &mut std::io::stdout().lock())?;
    Ok(ExitCode::Ok)
}

/// Options of `describe`.
#[derive(Debug, ClapArgs)]
pub struct DescribeArgs {
    /// The scene, a `plant.toml`; or a scenario, for the scenes of its plants
    #[arg(default_value = ".")]
    pub scene: PathBuf,
    /// For people, or JSON for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
    /// Draws the scene as it is set up to this file
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
    /// From where the picture shows it
    #[arg(long, value_enum, default_value_t, requires = "svg")]
    pub view: ViewArg,
    /// With mass matrix and gravity forces of each mechanism in the scene's pose
    #[arg(long)]
    pub dynamics: bool,
}

/// A side of a scene; x goes to the right of one who looks from the front, z is up.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum ViewArg {
    /// From above the corner between front and right
    #[default]
    Corner,
    /// Along y
    Front,
    /// Against y
    Back,
    /// Along x
    Left,
    /// Against x
    Right,
    /// From above
    Top,
}

impl From<ViewArg> for Side {
    fn from(view: ViewArg) -> Self {
        match view {
            ViewArg::Corner => Self::Corner,
            ViewArg::Front => Self::Front,
            ViewArg::Back => Self::Back,
            ViewArg::Left => Self::Left,
            ViewArg::Right => Self::Right,
            ViewArg::Top => Self::Top,
        }
    }
}

/// Prints what a scene is made of.
///
/// # Errors
/// See [`CommandError`].
pub fn describe(args: &DescribeArgs) -> Result<ExitCode, CommandError> {
    let config = DescribeConfig {
        path: args.scene.clone(),
        format: args.format.into(),
        svg: args.svg.clone(),
        side: args.view.into(),
        dynamics: args.dynamics,
    };
    describe::write(&config, &mut std::io::stdout().lock())?;
    Ok(ExitCode::Ok)
}

/// Options of `wiring`.
#[derive(Debug, ClapArgs)]
pub struct WiringArgs {
    /// The scenario: a folder with a `scenario.toml`
    #[arg(default_value = ".")]
    pub scenario: PathBuf,
    /// For people, or JSON for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
    /// Draw it into this SVG file, too
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
}

/// Prints how signals connect clients.
///
/// # Errors
/// See [`CommandError`].
pub fn wiring(args: WiringArgs) -> Result<ExitCode, CommandError> {
    let config = WiringConfig { scenario: args.scenario, format: args.format.into(), svg: args.svg };
    let sound = wiring::write(&config, &mut VerdictOutput::lock())?;
    Ok(if sound { ExitCode::Ok } else { ExitCode::WrongInput })
}

/// Options of `show`.
#[derive(Debug, ClapArgs)]
pub struct ShowArgs {
    /// The scenario: a folder with a `scenario.toml`, or a file of another name
    #[arg(default_value = ".")]
    pub scenario: PathBuf,
    /// TOML for people, or JSON for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
}

/// Shows a scenario with its bases.
///
/// # Errors
/// See [`CommandError`].
pub fn show(args: ShowArgs) -> Result<ExitCode, CommandError> {
    let config = ShowConfig { scenario: args.scenario, format: args.format.into() };
    show::write(&config, &mut std::io::stdout().lock())?;
    Ok(ExitCode::Ok)
}

/// Options of `edit`.
#[derive(Debug, ClapArgs)]
pub struct EditArgs {
    /// The scenario: a folder with a `scenario.toml`
    #[arg(default_value = ".")]
    pub scenario: PathBuf,
    /// Where browsers of this machine find the page [default: a free port]
    #[arg(long, value_name = "ADDRESS:PORT")]
    pub web: Option<SocketAddr>,
}

/// Serves the editor of a scenario until the program is ended.
///
/// # Errors
/// See [`CommandError`].
pub fn edit(args: EditArgs) -> Result<ExitCode, CommandError> {
    let address = args.web.unwrap_or_else(|| SocketAddr::from(([127, 0, 0, 1], 0)));
    let how_far = HowFar::of(["change in its files", "changes in its files"], Total::Exact);
    how_far.on_signals();
    edit::serve(&EditConfig { scenario: args.scenario, address, how_far })?;
    Ok(ExitCode::Ok)
}

/// Options of `new`.
#[derive(Debug, ClapArgs)]
pub struct NewArgs {
    /// The folder to make; its name is the scenario's
    pub folder: PathBuf,
    /// What to begin with
    #[arg(long, value_enum, default_value_t)]
    pub template: TemplateArg,
    /// A task to learn on, without its solutions: one that `onescan templates` lists, or a folder
    #[arg(long, value_name = "NAME|FOLDER", conflicts_with = "template")]
    pub task: Option<String>,
    /// Make it of an I/O list: a TwinCAT project, an ENI, a tag table of TIA Portal, an I/O mapping of CODESYS,
    /// PLC sources (PLCopen XML too), or a PLC that can be browsed
    #[arg(long, value_name = "FILE|FOLDER|URL", conflicts_with_all = ["template", "task"])]
    pub from: Option<String>,
    /// What wrote the list [default: what its name and text say]
    #[arg(long = "as", value_name = "KIND", value_enum, requires = "from")]
    pub kind: Option<ListKindArg>,
    /// Of a TwinCAT project with several PLCs, which one
    #[arg(long, value_name = "NAME", requires = "from")]
    pub plc: Option<String>,
    /// What was taken over: for people, or one JSON object for machines
    #[arg(long, value_enum, default_value_t, requires = "from")]
    pub format: FormatArg,
}

/// See [`ListKind`].
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum ListKindArg {
    /// A TwinCAT project, `.tsproj`, `.xti` or `.tmc`
    Twincat,
    /// EtherCAT Network Information
    Eni,
    /// PLC tags of TIA Portal, `.xlsx`
    TiaXlsx,
    /// PLC tags of TIA Portal, XML
    TiaXml,
    /// PLC tags of TIA Portal or STEP 7, `.sdf` or CSV
    TiaText,
    /// I/O mapping of CODESYS, CSV
    Codesys,
    /// PLC sources
    Sources,
    /// A PLC at a URL
    Server,
}

impl From<ListKindArg> for ListKind {
    fn from(arg: ListKindArg) -> Self {
        match arg {
            ListKindArg::Twincat => Self::TwinCat,
            ListKindArg::Eni => Self::Eni,
            ListKindArg::TiaXlsx => Self::TiaXlsx,
            ListKindArg::TiaXml => Self::TiaXml,
            ListKindArg::TiaText => Self::TiaText,
            ListKindArg::Codesys => Self::Codesys,
            ListKindArg::Sources => Self::Sources,
            ListKindArg::Server => Self::Server,
        }
    }
}

/// See [`Template`].
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum TemplateArg {
    /// A cylinder pushes boxes off a belt: bodies, a conveyor, a sensor, pneumatics
    #[default]
    Cell,
    /// A tank with a pump, a valve and a level: process engineering, no bodies
    Tank,
    /// A plant of your own in Python, over TCP
    Python,
    /// A control program, and a machine to be built with `onescan edit`
    Blank,
}

impl From<TemplateArg> for Template {
    fn from(arg: TemplateArg) -> Self {
        match arg {
            TemplateArg::Cell => Self::Cell,
            TemplateArg::Tank => Self::Tank,
            TemplateArg::Python => Self::Python,
            TemplateArg::Blank => Self::Blank,
        }
    }
}

/// Writes a scenario to begin with.
///
/// # Errors
/// See [`CommandError`].
pub fn new(args: NewArgs) -> Result<ExitCode, CommandError> {
    let mut out = std::io::stdout().lock();
    if let Some(from) = args.from {
        let list = Wanted { from, kind: args.kind.map(Into::into), plc: args.plc };
        let config = FromListConfig { folder: args.folder, list, format: args.format.into() };
        new::from_list::write(&config, &mut out)?;
        return Ok(ExitCode::Ok);
    }
    if let Some(task) = args.task {
        new::task::write(&args.folder, &task, &mut out)?;
        return Ok(ExitCode::Ok);
    }
    new::write(&args.folder, args.template.into(), &mut out)?;
    Ok(ExitCode::Ok)
}

/// Options of `templates`.
#[derive(Debug, ClapArgs)]
pub struct TemplatesArgs {
    /// For people, or JSON for machines
    #[arg(long, value_enum, default_value_t)]
    pub format: FormatArg,
}

/// Lists what `new` writes.
///
/// # Errors
/// See [`CommandError`].
pub fn templates(args: &TemplatesArgs) -> Result<ExitCode, CommandError> {
    let of = |arg: &TemplateArg| {
        let value = arg.to_possible_value()?;
        Some((value.get_name().to_owned(), value.get_help().map(ToString::to_string).unwrap_or_default()))
    };
    let templates: Vec<(String, String)> = TemplateArg::value_variants().iter().filter_map(of).collect();
    new::task::list(&templates, args.format.into(), &mut std::io::stdout().lock()).map_err(OutputError)?;
    Ok(ExitCode::Ok)
}
