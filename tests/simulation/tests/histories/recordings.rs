//! Recordings into one folder, one after the other, on a disk that fails, or by processes that are killed at any call.
//!
//! What was whole stays whole until something else is; what was cut short has all steps that it promises; what the user keeps in
//! the folder stays his; a run with a disk that works leaves exactly what it would leave alone.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock};

use onescan_base::disk::{Disk, SystemDisk};
use onescan_base::signal_type::STRING_CAPACITY_MAX;
use onescan_recording::place::{REPORT, SCENARIO, kept_in};
use onescan_recording::recorder::{EVENTS, HEADER};
use onescan_recording::{Choice, Event, EventKind, FlushPolicy, Place, Recorder, Recording, Row};
use onescan_server::digest::TrajectoryDigest;
use onescan_server::lockstep::Lockstep;
use onescan_server::observer::{Observer, RecordError};
use onescan_server::operation::{Author, Operation, OperatorInput};
use onescan_server::plan::Coupling;
use onescan_server::session::Session;
use onescan_server::time::{StepCount, VirtualTime};
use onescan_simulation::at_ms;
use onescan_simulation::chance::Chance;
use onescan_simulation::faulty_disk::{EIO, EMFILE, ENOSPC, Fault, FaultyDisk};
use onescan_simulation::histories::{Kind, try_all};
use onescan_simulation::run::{boxed, in_process, provenance};
use onescan_simulation::toy::{Wide, ring, ring_plan};
use parquet::file::reader::{FileReader, SerializedFileReader};

const KIND: Kind = Kind { name: "recordings", few: 300, share: 5 };
/// A step of the ring.
const STEP_MS: u64 = 10;
/// Steps of the longest run.
const STEPS_MAX: u64 = 2_000;
/// The same with a wide image, and how many texts of 32 kB that is.
const WIDE_STEPS_MAX: u64 = 80;
const WIDE_SIGNALS: usize = 28;
/// How many steps complete parts have, from the first part on, at steps of 10 ms: they double, up to ten seconds.
const PARTS: [u64; 6] = [64, 192, 448, 960, 1_960, 2_960];
/// What the user keeps beside recordings.
const NOTES: &str = "notes.txt";
/// Where the lock would be, and an earlier recording.
const ASIDE: &str = ".earlier";
const ON_ITS_WAY: &str = ".earlier.partial";

/// A folder that goes when it is over, in memory where the system has such a place.
pub(crate) struct Room(tempfile::TempDir);

impl Room {
    pub(crate) fn new() -> Self {
        let memory = tempfile::Builder::new().prefix("onescan").tempdir_in("/dev/shm");
        Self(memory.or_else(|_| tempfile::tempdir()).expect("a folder"))
    }

    pub(crate) fn folder(&self) -> &Path {
        self.0.path()
    }
}

/// All steps, as a recording has them that nothing disturbs and a thread encodes: digests, times, values.
fn quiet(width: Width, steps: u64) -> Vec<Row> {
    let room = Room::new();
    let mut lockstep = session(width, None);
    lockstep.observe(Box::new(Recorder::new(room.folder(), provenance(), Choice::default())));
    lockstep.set_until(Some(at_ms(STEP_MS * steps)));
    let outcome = lockstep.run().expect("nothing disturbs it");
    let recording = Recording::open(room.folder()).expect("it is whole");
    let rows = recording.rows(&[], 0..=steps).expect("all steps").rows;
    assert_eq!(rows.last().map(|row| row.digest), outcome.digest, "the digest that is recorded is the session's");
    rows
}

static QUIET: LazyLock<Vec<Row>> = LazyLock::new(|| quiet(Width::Narrow, STEPS_MAX));
static QUIET_WIDE: LazyLock<Vec<Row>> = LazyLock::new(|| quiet(Width::Wide, WIDE_STEPS_MAX));

/// How large the image of a session is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Width {
    Narrow,
    /// So large that blocks end before parts do, and that not all of a part is kept for an early write.
    Wide,
}

impl Width {
    fn rows(self) -> &'static [Row] {
        match self {
            Self::Narrow => &QUIET,
            Self::Wide => &QUIET_WIDE,
        }
    }
}

/// A session in which a client fails at `fails_at`, if it is to.
fn session(width: Width, fails_at: Option<VirtualTime>) -> Lockstep {
    match width {
        Width::Narrow => {
            let mut clients = ring();
            clients[0].fails_at = fails_at;
            in_process(ring_plan(&Coupling::Parallel), boxed(clients))
        }
        Width::Wide => {
            let wide = Wide::new(WIDE_SIGNALS, STEP_MS);
            in_process(wide.plan(), boxed([wide]))
        }
    }
}

/// What is drawn for a run.
#[derive(Clone, Debug)]
struct Draw {
    number: u64,
    width: Width,
    steps: u64,
    /// The step after which an operator resets the session, once.
    reset: Option<u64>,
    flush: Option<u64>,
    choice: Choice,
    violated: u64,
    /// Whether it ends as a client fails, in the step behind the last.
    fails: bool,
    /// Whether it has a session at all: a client may be missing.
    begins: bool,
    fault: Option<(u64, Fault)>,
}

impl Draw {
    fn new(chance: &mut Chance, number: u64) -> Self {
        let width = if chance.one_in(100) { Width::Wide } else { Width::Narrow };
        let most = match width {
            Width::Wide => WIDE_STEPS_MAX,
            Width::Narrow if chance.one_in(40) => STEPS_MAX,
            Width::Narrow if chance.one_in(10) => 700,
            Width::Narrow => 250,
        };
        let steps = 1 + chance.below(most);
        let kind = match chance.below(8) {
            0..=2 => Some(Fault::Kill),
            3 => Some(Fault::Once(EIO)),
            4 => Some(Fault::Once(EMFILE)),
            5 => Some(Fault::Once(ENOSPC)),
            6 => Some(Fault::Full),
            _ => None,
        };
        // What is kept of large images for an early write is seen after a kill alone.
        let (kind, flushes) = match width {
            Width::Wide => (Some(Fault::Kill).filter(|_| !chance.one_in(4)), true),
            Width::Narrow => (kind, chance.one_in(2)),
        };
        let at = chance.below(if steps > 60 { 200 } else { 60 });
        Self {
            number,
            width,
            steps,
            reset: chance.one_in(4).then(|| chance.below(steps)),
            flush: flushes.then(|| 1 + chance.below(if width == Width::Wide { 56 } else { 40 })),
            choice: Choice { signals: Vec::new(), csv: chance.one_in(3), mcap: chance.one_in(5) },
            violated: chance.below(4),
            fails: width == Width::Narrow && chance.one_in(8),
            begins: !chance.one_in(10),
            fault: kind.map(|kind| (at, kind)),
        }
    }

    /// Has the fault within the calls of this run, which is tried on a copy of the folder: so each of them is met.
    fn aim(&mut self, chance: &mut Chance, folder: &Path) -> Result<(), String> {
        let Some((_, fault)) = self.fault else { return Ok(()) };
        let copy = Room::new();
        for file in files(folder, folder) {
            let to = copy.folder().join(&file);
            std::fs::create_dir_all(to.parent().expect("within")).map_err(|error| error.to_string())?;
            std::fs::copy(folder.join(&file), to).map_err(|error| error.to_string())?;
        }
        let disk = FaultyDisk::new(copy.folder(), None);
        let place = Place::begin(Arc::new(disk.clone()), copy.folder()).map_err(|error| error.to_string())?;
        // One that is not to begin ends early, which is what is counted.
        drop(run(self, place, &disk, copy.folder(), &Progress::default()));
        self.fault = Some((chance.below(disk.calls().max(1)), fault));
        Ok(())
    }

    fn report(&self) -> Vec<u8> {
        format!("{{\"run\":{},\"steps\":{}}}", self.number, self.steps).into_bytes()
    }
}

/// How far the recorder has come: steps that it has taken since the session began, or began again.
#[derive(Clone, Debug, Default)]
struct Progress(Arc<std::sync::Mutex<Option<u64>>>);

impl Progress {
    fn set(&self, step: u64) {
        *self.0.lock().expect("one thread") = Some(step);
    }

    fn step(&self) -> Option<u64> {
        *self.0.lock().expect("one thread")
    }
}

/// Observes behind the recorder, so it sees what that has taken.
impl Observer for Progress {
    fn begin(&mut self, session: &Session, digest: &TrajectoryDigest) -> Result<(), RecordError> {
        self.step(session, digest)
    }

    fn step(&mut self, session: &Session, _digest: &TrajectoryDigest) -> Result<(), RecordError> {
        self.set(session.cycle().steps().0);
        Ok(())
    }

    fn end(&mut self, _session: &Session) -> Result<(), RecordError> {
        Ok(())
    }
}

/// One run in its place, as the program does it.
fn run(draw: &Draw, place: Place, disk: &FaultyDisk, folder: &Path, progress: &Progress) -> Result<(), String> {
    let scenario = folder.join(SCENARIO);
    let copy = || {
        disk.create_folder(&scenario)?;
        onescan_base::disk::write_whole(disk, &scenario.join("a.st"), &draw.report())
    };
    copy().map_err(|error| error.to_string())?;
    if !draw.begins {
        return Err("a client is missing".to_owned());
    }
    let policy = draw.flush.map_or(FlushPolicy::Steps(u64::MAX), FlushPolicy::Steps);
    let recorder = Recorder::new(folder, provenance(), draw.choice.clone()).writing(policy);
    let mut lockstep = session(draw.width, draw.fails.then(|| at_ms(STEP_MS * (draw.steps + 1))));
    lockstep.observe(Box::new(recorder.simulated(Arc::new(disk.clone()))));
    lockstep.observe(Box::new(progress.clone()));
    lockstep.set_until(Some(at_ms(STEP_MS * (draw.steps + u64::from(draw.fails)))));
    lockstep.replay(draw.reset.into_iter().map(reset_after).collect());
    lockstep.run().map_err(|error| error.to_string())?;
    let violated = |number: u64| Event {
        step: StepCount(number),
        t_v: VirtualTime::ZERO,
        what: EventKind::Violated { expectation: format!("number {number}") },
    };
    let events: Vec<Event> = (0..draw.violated).map(violated).collect();
    place.end(&events, &draw.report()).map_err(|error| error.to_string())
}

fn reset_after(step: u64) -> OperatorInput {
    let (author, operation) = (Author::Operator, Operation::Reset);
    OperatorInput { resets: 0, step: StepCount(step), t_v: at_ms(STEP_MS * step), author, operation }
}

/// One history.
fn history(seed: u64) -> Result<u64, String> {
    let mut chance = Chance::new(seed);
    let room = Room::new();
    let folder = room.folder();
    std::fs::write(folder.join(NOTES), "mine").expect("written");
    if chance.one_in(8) {
        // What another program has left is not the report of a run here.
        std::fs::write(folder.join(REPORT), "{}").expect("written");
    }
    let mut standing: Option<Draw> = None;
    let mut trace = 0_u64;
    let runs = 1 + chance.below(4);
    for number in 0..runs {
        let mut draw = Draw::new(&mut chance, number);
        if chance.one_in(4) {
            draw.aim(&mut chance, folder)?;
        }
        standing = attempt(&draw, standing, folder, &mut chance, &mut trace)
            .map_err(|wrong| format!("{wrong} in {draw:?}"))?;
    }
    let last = Draw { fault: None, begins: true, ..Draw::new(&mut chance, runs) };
    attempt(&last, standing, folder, &mut chance, &mut trace).map_err(|wrong| format!("{wrong} in {last:?}"))?;
    Ok(trace)
}

/// A run and what must be true after it; the recording that stands then.
fn attempt(
    draw: &Draw,
    standing: Option<Draw>,
    folder: &Path,
    chance: &mut Chance,
    trace: &mut u64,
) -> Result<Option<Draw>, String> {
    let (disk, progress) = (FaultyDisk::new(folder, draw.fault), Progress::default());
    let place = Place::begin(Arc::new(disk.clone()), folder).map_err(|error| error.to_string());
    let is_begun = place.is_ok();
    let outcome = place.and_then(|place| run(draw, place, &disk, folder, &progress));
    *trace = trace.rotate_left(7) ^ disk.trace();
    if let Some(outside) = disk.outside() {
        return Err(format!("{} was touched", outside.display()));
    }
    if std::fs::read(folder.join(NOTES)).ok().as_deref() != Some(b"mine") {
        return Err("the user's own file is gone".to_owned());
    }
    match outcome {
        Ok(()) => {
            whole(draw, folder)?;
            nothing_else(draw, folder)?;
            return Ok(Some(draw.clone()));
        }
        Err(error) if draw.begins && !disk.is_faulty() => return Err(format!("it failed without a reason: {error}")),
        Err(_) => {}
    }
    if reported(folder) == Some(draw.report()) {
        // It failed once all was written.
        whole(draw, folder)?;
        return Ok(Some(draw.clone()));
    }
    let is_known = standing.as_ref().map(Draw::report);
    if is_begun && reported(folder).is_some_and(|report| Some(report) != is_known) {
        return Err("there is a report of another run".to_owned());
    }
    cut(draw, folder, &disk, &progress)?;
    if let Some(standing) = &standing {
        let is_split = folder.join(ON_ITS_WAY).exists();
        if !is_split {
            let place =
                if reported(folder) == Some(standing.report()) { folder.to_owned() } else { folder.join(ASIDE) };
            whole(standing, &place).map_err(|wrong| format!("what was to be replaced: {wrong}"))?;
        } else if !is_begun && matches!(draw.fault, Some((_, Fault::Once(_)))) {
            return Err("what was to be replaced is left in two halves".to_owned());
        }
        // Somebody looks after it: a run that does not begin.
        if chance.one_in(2) {
            drop(Place::begin(Arc::new(SystemDisk), folder).map_err(|error| error.to_string())?);
            whole(standing, folder).map_err(|wrong| format!("what was to be replaced does not come back: {wrong}"))?;
            nothing_else(standing, folder)?;
        }
    }
    Ok(standing)
}

fn reported(folder: &Path) -> Option<Vec<u8>> {
    std::fs::read(folder.join(REPORT)).ok()
}

/// The recording in `place` is that of `draw`, as a whole.
fn whole(draw: &Draw, place: &Path) -> Result<(), String> {
    if reported(place) != Some(draw.report()) {
        return Err(format!("there is no report of run {} in {}", draw.number, place.display()));
    }
    let recording = Recording::open(place).map_err(|error| error.to_string())?;
    if !recording.is_whole() || recording.steps() != Some(0..=draw.steps) {
        return Err(format!("it has steps {:?} of {}", recording.steps(), draw.steps));
    }
    same_rows(draw, &recording, draw.steps)?;
    let events = recording.events().map_err(|error| error.to_string())?;
    let resets = u64::from(draw.reset.is_some());
    // It began, was reset and began again, ended, and was judged.
    let failed = events.iter().filter(|event| matches!(event.what, EventKind::Failed { .. })).count();
    if failed != usize::from(draw.fails) {
        return Err("it does not say that a client failed".to_owned());
    }
    if (events.len() - failed) as u64 != 2 + 2 * resets + draw.violated {
        return Err(format!("it has {} events", events.len()));
    }
    let ended = events.iter().find(|event| matches!(event.what, EventKind::Ended { .. }));
    if ended.is_none_or(|event| event.step != StepCount(draw.steps) || event.t_v != at_ms(STEP_MS * draw.steps)) {
        return Err(format!("it says that it ended: {ended:?}"));
    }
    if std::fs::read(place.join(SCENARIO).join("a.st")).ok() != Some(draw.report()) {
        return Err("it has the files of another scenario".to_owned());
    }
    same_blocks(draw, place)?;
    if draw.choice.csv {
        let text = std::fs::read_to_string(place.join("trajectory.csv")).map_err(|error| error.to_string())?;
        if text.lines().count() as u64 != draw.steps + 2 || !text.ends_with('\n') {
            return Err(format!("its CSV has {} lines", text.lines().count()));
        }
    }
    Ok(())
}

fn same_rows(draw: &Draw, recording: &Recording, last: u64) -> Result<(), String> {
    let rows = recording.rows(&[], 0..=last).map_err(|error| error.to_string())?.rows;
    let same = rows.iter().zip(draw.width.rows()).take_while(|(row, quiet)| row == quiet).count();
    if same as u64 == last + 1 { Ok(()) } else { Err(format!("step {same} is another one")) }
}

/// Blocks end with their part, or where they are as large as they may be: 8 MiB of images.
fn same_blocks(draw: &Draw, place: &Path) -> Result<(), String> {
    let rows_max = match draw.width {
        Width::Narrow => 8_192,
        Width::Wide => (8 << 20) / (WIDE_SIGNALS as u64 * (u64::from(STRING_CAPACITY_MAX) + 2)),
    };
    for file in files(&place.join("trajectory"), place) {
        let opened = std::fs::File::open(place.join(&file)).map_err(|error| error.to_string())?;
        let part = SerializedFileReader::new(opened).map_err(|error| error.to_string())?;
        let groups: Vec<u64> = part.metadata().row_groups().iter().map(|group| group.num_rows() as u64).collect();
        let (last, full) = groups.split_last().ok_or("a part without rows")?;
        if *last > rows_max || full.iter().any(|rows| *rows != rows_max) {
            return Err(format!("{} has blocks of {groups:?} rows, where {rows_max} are a full one", file.display()));
        }
    }
    Ok(())
}

/// The folder holds the recording of `draw`, the user's file, and nothing else.
fn nothing_else(draw: &Draw, folder: &Path) -> Result<(), String> {
    let mut expected: BTreeSet<PathBuf> =
        [NOTES, HEADER, EVENTS, REPORT, "scenario/a.st"].iter().map(PathBuf::from).collect();
    let complete = PARTS.iter().filter(|rows| **rows <= draw.steps).count();
    let parts = (1..=complete + 1).map(|part| PathBuf::from(format!("trajectory/part-{part:06}.parquet")));
    // One that would begin behind the last step is not begun.
    let is_even = PARTS.contains(&(draw.steps + 1));
    expected.extend(parts.take(complete + usize::from(!is_even || complete == 0)));
    if is_even {
        expected.insert(PathBuf::from(format!("trajectory/part-{:06}.parquet", complete + 1)));
    }
    expected.extend(draw.choice.csv.then(|| PathBuf::from("trajectory.csv")));
    expected.extend(draw.choice.mcap.then(|| PathBuf::from("trajectory.mcap")));
    let found = files(folder, folder);
    if found == expected { Ok(()) } else { Err(format!("the folder holds {found:?}")) }
}

fn files(folder: &Path, root: &Path) -> BTreeSet<PathBuf> {
    let mut found = BTreeSet::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(files(&path, root));
        } else {
            found.insert(path.strip_prefix(root).expect("within").to_owned());
        }
    }
    found
}

/// What a run has left that was cut short: all that it has promised, and nothing that never was.
fn cut(draw: &Draw, folder: &Path, disk: &FaultyDisk, progress: &Progress) -> Result<(), String> {
    if !folder.join(HEADER).exists() || folder.join(ON_ITS_WAY).exists() || reported(folder).is_some() {
        return Ok(());
    }
    let recording = Recording::open(folder).map_err(|error| format!("it cannot be opened: {error}"))?;
    let events = recording.events().map_err(|error| format!("its events cannot be read: {error}"))?;
    let Some(step) = progress.step() else { return Ok(()) };
    if events.is_empty() {
        return Err("it does not say that it began".to_owned());
    }
    let last = recording.steps().map(|steps| *steps.end());
    let promised = promised(draw, step);
    if last < promised {
        return Err(format!(
            "it has {last:?}, where {promised:?} of {step} steps were to be there ({} calls)",
            disk.calls()
        ));
    }
    // The first step is written at once.
    if disk.is_killed() && is_given_up(draw, step) && last > Some(0) {
        return Err(format!("it has {last:?}, where no more than 32 MiB are kept to be written early"));
    }
    // The step in hand may be there, and what was there before a reset.
    if let Some(last) = last
        && draw.reset.is_none()
        && last > step + 1
    {
        return Err(format!("it has {last} steps of {step}"));
    }
    last.map_or(Ok(()), |last| same_rows(draw, &recording, last))?;
    if kept_in(folder).is_some_and(|kept| kept != folder.join(ASIDE)) {
        return Err("what was to be replaced is somewhere else".to_owned());
    }
    Ok(())
}

/// The last step that is on the disk in any case once `step` has been taken.
fn promised(draw: &Draw, step: u64) -> Option<u64> {
    // A reset throws away what there is, and may have come just now.
    if draw.reset == Some(step) {
        return None;
    }
    let in_parts = PARTS.iter().rev().find(|rows| **rows <= step + 1).map(|rows| rows - 1);
    // Of large images no more than 32 MiB are kept to be written early.
    let is_kept = draw.width == Width::Narrow || step < 32;
    let flushed = draw.flush.filter(|_| is_kept).map(|steps| step / steps * steps);
    in_parts.max(flushed)
}

/// Whether more has come of the first part before the first early write than is kept for it: a row has 0.9 MB, and five blocks are
/// full. Behind the last step all of it is written.
fn is_given_up(draw: &Draw, step: u64) -> bool {
    let is_late = draw.flush.is_some_and(|steps| steps > 46);
    draw.width == Width::Wide && is_late && draw.reset.is_none() && step < draw.steps && step + 1 < PARTS[0]
}

/// Looks at what is on the disk once a step has been taken.
#[derive(Clone, Debug)]
struct Look {
    folder: PathBuf,
    at: u64,
    last: Arc<std::sync::Mutex<Option<u64>>>,
}

impl Observer for Look {
    fn begin(&mut self, _session: &Session, _digest: &TrajectoryDigest) -> Result<(), RecordError> {
        Ok(())
    }

    fn step(&mut self, session: &Session, _digest: &TrajectoryDigest) -> Result<(), RecordError> {
        if session.cycle().steps().0 == self.at {
            let recording = Recording::open(&self.folder).expect("it can be opened at any moment");
            *self.last.lock().expect("one thread") = recording.steps().map(|steps| *steps.end());
        }
        Ok(())
    }

    fn end(&mut self, _session: &Session) -> Result<(), RecordError> {
        Ok(())
    }
}

/// Nine rows are a block; four blocks are kept to be written early, and of five nothing is before the part is full.
#[test]
fn what_was_too_much_to_keep_comes_with_its_part() {
    for (flush, last) in [(36, 36), (45, 0)] {
        let room = Room::new();
        let mut lockstep = session(Width::Wide, None);
        let recorder = Recorder::new(room.folder(), provenance(), Choice::default()).writing(FlushPolicy::Steps(flush));
        lockstep.observe(Box::new(recorder.simulated(Arc::new(SystemDisk))));
        let look = Look { folder: room.folder().to_owned(), at: flush + 1, last: Arc::default() };
        lockstep.observe(Box::new(look.clone()));
        lockstep.set_until(Some(at_ms(STEP_MS * WIDE_STEPS_MAX)));
        lockstep.run().expect("nothing disturbs it");
        assert_eq!(*look.last.lock().expect("one thread"), Some(last), "written early every {flush} steps");
    }
}

#[test]
fn what_was_whole_stays_whole() {
    try_all(KIND, history);
}
