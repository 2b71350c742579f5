//! The library of components and the user's own kinds, listed, or one kind in full.

use std::io::Write;
use std::path::{Path, PathBuf};

use onescan_plant::component::kind::Kind;
use onescan_plant::component::kinds;
use onescan_plant::component::page::page;
use onescan_plant::scene::own::listing::{self, Listing, OwnKind};
use onescan_plant::{SceneError, SceneFault};
use onescan_report::OutputError;
use onescan_scenario::ScenarioError;
use onescan_scenario::compose::report;
use onescan_scenario::permission::granted;
use onescan_server::signal::did_you_mean;
use serde::Serialize;

use super::error::PlantError;
use super::page_text;
use onescan_runner::error::Usage;
use onescan_runner::format::Format;

/// What to say of which kinds.
#[derive(Clone, Debug)]
pub struct ComponentsConfig {
    /// The kind to describe; all are listed if none is named.
    pub kind: Option<String>,
    /// Folders with kinds of the user's own.
    pub libraries: Vec<PathBuf>,
    /// How to write it.
    pub format: Format,
}

/// A kind of the library or of the user's own.
#[derive(Serialize)]
#[serde(untagged)]
enum Known<'k> {
    Library(&'k Kind),
    Own(&'k OwnKind),
}

impl Known<'_> {
    fn name(&self) -> &str {
        match self {
            Self::Library(kind) => &kind.name,
            Self::Own(kind) => kind.name(),
        }
    }

    fn summary(&self) -> &str {
        match self {
            Self::Library(kind) => &kind.summary,
            Self::Own(kind) => kind.summary(),
        }
    }

    fn page(&self) -> String {
        match self {
            Self::Library(kind) => page(kind),
            Self::Own(kind) => kind.page(),
        }
    }
}

/// Writes every kind with a line about it, or all about one; then what is wrong with kinds of the user's own.
///
/// # Errors
/// The kind does not exist, a folder cannot be read, a file in it is not a kind, or `out` cannot be written.
pub fn write(config: &ComponentsConfig, out: &mut dyn Write) -> Result<(), PlantError> {
    let listings = config.libraries.iter().map(|folder| read(folder)).collect::<Result<Vec<_>, _>>()?;
    let library: Vec<Known<'_>> = kinds().iter().map(Known::Library).collect();
    let own = listings.iter().map(|listing| listing.kinds.iter().map(Known::Own).collect::<Vec<_>>());
    let shelves: Vec<Vec<Known<'_>>> = std::iter::once(library).chain(own).collect();
    match (&config.kind, config.format) {
        (Some(name), format) => one(name, &shelves, &listings, format, out)?,
        (None, Format::Json) => json(&shelves.iter().flatten().collect::<Vec<_>>(), out)?,
        (None, Format::Human) => list(&shelves, &config.libraries, out).map_err(OutputError)?,
    }
    let faults: Vec<SceneFault> = listings.into_iter().flat_map(|listing| listing.faults).collect();
    refuse(faults)
}

fn read(folder: &Path) -> Result<Listing, PlantError> {
    listing::read(folder, &granted().within(folder)).map_err(|source| {
        let help = Some("`--library` names a folder with files of kinds, as `components`".to_owned());
        ScenarioError::Unreadable { path: folder.to_owned(), source, help }.into()
    })
}

/// All that is wrong, as with a scene.
fn refuse(faults: Vec<SceneFault>) -> Result<(), PlantError> {
    if faults.is_empty() {
        return Ok(());
    }
    Err(ScenarioError::from(Box::new(report(&SceneError::Faulty(faults), "", ""))).into())
}

fn one(
    name: &str,
    shelves: &[Vec<Known<'_>>],
    listings: &[Listing],
    format: Format,
    out: &mut dyn Write,
) -> Result<(), PlantError> {
    let all = || shelves.iter().flatten();
    let Some(kind) = all().find(|kind| kind.name() == name) else {
        // one that is there and wrong has its own message
        refuse(listings.iter().flat_map(|listing| listing.faults.iter().cloned()).collect())?;
        let help = did_you_mean(name, all().map(Known::name));
        let help = help.unwrap_or_else(|| {
            "`onescan components` names them all, with `--library FOLDER` those of a folder, too".to_owned()
        });
        return Err(Usage::new(format!("there is no component `{name}`"), Some(help)).into());
    };
    match format {
        Format::Json => json(kind, out),
        Format::Human => Ok(out.write_all(page_text::of_markdown(&kind.page()).as_bytes()).map_err(OutputError)?),
    }
}

fn list(shelves: &[Vec<Known<'_>>], folders: &[PathBuf], out: &mut dyn Write) -> std::io::Result<()> {
    let width = shelves.iter().flatten().map(|kind| kind.name().len()).max().unwrap_or_default();
    for (index, shelf) in shelves.iter().enumerate() {
        if let Some(folder) = index.checked_sub(1).and_then(|index| folders.get(index)) {
            writeln!(out, "\n{}", folder.display())?;
        }
        shelf.iter().try_for_each(|kind| writeln!(out, "{:width$}  {}", kind.name(), kind.summary()))?;
    }
    Ok(())
}

fn json(value: &(impl serde::Serialize + ?Sized), out: &mut dyn Write) -> Result<(), PlantError> {
    serde_json::to_writer_pretty(&mut *out, value).map_err(std::io::Error::from).map_err(OutputError)?;
    Ok(writeln!(out).map_err(OutputError)?)
}
