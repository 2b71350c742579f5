//! A run's recording: the scenario's own files beside what the server records.

use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use onescan_base::disk::SystemDisk;
use onescan_base::regular::Limit;
use onescan_recording::event::{Event, EventKind};
use onescan_recording::place::SCENARIO;
use onescan_recording::recorder::HEADER;
use onescan_recording::{Place, Provenance, Recorder, Recording, SourceFile};
use onescan_report::{OutputError, file};
use onescan_scenario::load::FILE_NAME;
use onescan_scenario::{Mode, Scenario, ScenarioError, permission};
use onescan_server::signal::ClientName;
use onescan_server::time::VirtualTime;

use super::config::{RecordRequest, Subject};
use super::error::RunError;
use super::record_lock::RecordLock;
use super::report::RunReport;
use crate::error::Usage;

/// The recording of one run.
pub(crate) struct Recorded {
    folder: PathBuf,
    /// Before the lock, which is kept until what it replaces has come back.
    place: Place,
    _lock: RecordLock,
}

impl Recorded {
    /// Makes the folder of run `number` with the scenario's files in it, and a recorder for the rest.
    pub(crate) fn begin(
        request: &RecordRequest,
        subject: &Subject,
        (mode, operated): (Mode, &[ClientName]),
        scenario: &Scenario,
        number: u32,
    ) -> Result<(Self, Recorder), RunError> {
        let folder = file::create_folder(&folder_of(request, number))?;
        let lock = RecordLock::of(&folder)?;
        // Another run may have recorded here since it was looked at.
        refuse_to_overwrite_run(request, number)?;
        // What an earlier run left here would be taken for this one's.
        let place = Place::begin(Arc::new(SystemDisk), &folder)?;
        let (own_folder, files) = copy_scenario(scenario, &folder.join(SCENARIO))?;
        let provenance = Provenance {
            onescan: env!("CARGO_PKG_VERSION").to_owned(),
            scenario: scenario.name().to_owned(),
            folder: own_folder,
            file: unusual_name(scenario.path()),
            case: subject.case.clone(),
            operated: operated.to_vec(),
            mode: mode.name().to_owned(),
            until: subject.end(scenario),
            seed: scenario.seed(),
            files,
        };
        let recorder = Recorder::new(&folder, provenance, request.choice.clone());
        Ok((Self { folder, place, _lock: lock }, recorder))
    }

    /// What there is of a recording that was cut off, in words.
    pub(super) fn kept(&self) -> String {
        let folder = self.folder.display();
        match Recording::open(&self.folder).ok().and_then(|recording| Some(*recording.steps()?.end())) {
            Some(last) => format!("steps 0 to {last} are kept in {folder}"),
            None => format!("nothing could be kept in {folder}"),
        }
    }

    /// Adds what came of the run.
    pub(super) fn end(self, report: &RunReport) -> Result<(), RunError> {
        let violated = |expectation: &super::expectation::ExpectationReport| {
            let t_v: VirtualTime = expectation.at?;
            let what = EventKind::Violated { expectation: expectation.name.clone() };
            Some(Event { step: report.step_at(t_v), t_v, what })
        };
        let events: Vec<Event> = report.expectations.iter().filter_map(violated).collect();
        let mut text = serde_json::to_vec_pretty(report).map_err(|e| OutputError(e.into()))?;
        text.push(b'\n');
        Ok(self.place.end(&events, &text)?)
    }
}

fn folder_of(request: &RecordRequest, number: u32) -> PathBuf {
    request.folder.join(format!("run-{number}"))
}

/// Refuses to record over earlier runs, unless that is asked for.
pub(super) fn refuse_to_overwrite(request: &RecordRequest, runs: u32) -> Result<(), Usage> {
    (1..=runs).try_for_each(|number| refuse_to_overwrite_run(request, number))
}

fn refuse_to_overwrite_run(request: &RecordRequest, number: u32) -> Result<(), Usage> {
    let folder = folder_of(request, number);
    if request.overwrite || !folder.join(HEADER).exists() {
        return Ok(());
    }
    let help = "record into another folder, or replace what is there with `--overwrite`".to_owned();
    Err(Usage::new(format!("{} holds an earlier recording", folder.display()), Some(help)))
}

/// Copies the scenario's files so that it can be run from the copy. Says where its own folder is
/// among them, and all files with their hashes.
fn copy_scenario(scenario: &Scenario, target: &Path) -> Result<(String, Vec<SourceFile>), RunError> {
    let files: Vec<PathBuf> = scenario.files()?;
    let own_folder = own_folder(scenario.folder(), &files);
    let mut copied = Vec::new();
    for file in files {
        let path = scenario.folder().join(&file);
        let bytes = permission::granted().read(scenario.folder(), &path, Limit::DATA)?;
        let bytes = bytes.map_err(|source| ScenarioError::Unreadable { path, source, help: None })?;
        match within(&own_folder, &file) {
            Some(place) => {
                let to = target.join(&place);
                if let Some(parent) = to.parent() {
                    file::create_folder(parent)?;
                }
                file::write_whole(&to, &bytes)?;
                copied.push(SourceFile::new(with_slashes(&place), &bytes));
            }
            None => copied.push(SourceFile::new(file.display().to_string(), &bytes)),
        }
    }
    copied.sort_by(|a, b| a.path.cmp(&b.path));
    Ok((with_slashes(&own_folder), copied))
}

/// The name of a scenario's file that is not called as usual.
fn unusual_name(path: &Path) -> Option<String> {
    let name = path.file_name().filter(|name| *name != FILE_NAME)?;
    Some(name.to_string_lossy().into_owned())
}

/// The scenario's folder below the topmost that its files lead to by `..`.
fn own_folder(folder: &Path, files: &[PathBuf]) -> PathBuf {
    let up = |file: &PathBuf| file.components().take_while(|part| *part == Component::ParentDir).count();
    let levels = files.iter().map(up).max().unwrap_or(0);
    let absolute = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
    let names: Vec<_> = absolute.components().filter(|part| matches!(part, Component::Normal(_))).collect();
    names[names.len().saturating_sub(levels)..].iter().collect()
}

/// Where `file` is, as seen from above `folder`; nothing if it is not below.
fn within(folder: &Path, file: &Path) -> Option<PathBuf> {
    let mut place = folder.to_owned();
    for part in file.components() {
        match part {
            Component::Normal(name) => place.push(name),
            Component::CurDir => {}
            Component::ParentDir if place.pop() => {}
            _ => return None,
        }
    }
    Some(place)
}

fn with_slashes(path: &Path) -> String {
    let parts: Vec<_> = path.components().map(|part| part.as_os_str().to_string_lossy()).collect();
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_above_the_scenario_keep_their_place_to_it() {
        let files = ["scenario.toml", "../lib/a.st", "plc/b.st"].map(PathBuf::from);
        let folder = own_folder(Path::new("/x/cell/shear"), &files);
        assert_eq!(folder, Path::new("shear"));
        let places: Vec<_> = files.iter().map(|file| within(&folder, file).map(|place| with_slashes(&place))).collect();
        let expected = ["shear/scenario.toml", "lib/a.st", "shear/plc/b.st"].map(|place| Some(place.to_owned()));
        assert_eq!(places, expected);
        assert_eq!(own_folder(Path::new("/x/shear"), &files[..1]), Path::new(""));
        assert_eq!(within(Path::new("shear"), Path::new("/etc/hosts")), None);
    }
}
