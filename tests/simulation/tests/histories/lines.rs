//! Files of lines to which several processes add, some of which are killed, or write to a full disk.

use onescan_base::disk::Disk;
use onescan_base::lines::{self, Lines};
use onescan_simulation::chance::Chance;
use onescan_simulation::faulty_disk::{EIO, EMFILE, ENOSPC, Fault, FaultyDisk};
use onescan_simulation::histories::{Kind, try_all};

use crate::recordings::Room;

const KIND: Kind = Kind { name: "lines", few: 2_000, share: 25 };

/// A process with the file open.
struct Process {
    disk: FaultyDisk,
    lines: Option<Lines>,
    name: usize,
}

/// What became of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fate {
    Written,
    Refused,
}

fn fault(chance: &mut Chance) -> Option<(u64, Fault)> {
    let kind = match chance.below(6) {
        0 => Fault::Kill,
        1 => Fault::Once(EIO),
        2 => Fault::Once(EMFILE),
        3 => Fault::Once(ENOSPC),
        4 => Fault::Full,
        _ => return None,
    };
    Some((chance.below(12), kind))
}

fn history(seed: u64) -> Result<u64, String> {
    let mut chance = Chance::new(seed);
    let room = Room::new();
    let path = room.folder().join("lines");
    let mut processes: Vec<Process> = (0..=chance.below(3) as usize)
        .map(|name| Process { disk: FaultyDisk::new(room.folder(), fault(&mut chance)), lines: None, name })
        .collect();
    if chance.one_in(4) {
        std::fs::write(&path, "of another run\nand ha").map_err(|error| error.to_string())?;
    }
    drop(Lines::create(&onescan_base::disk::SystemDisk, &path).map_err(|error| error.to_string())?);
    let mut fates: Vec<(String, Fate)> = Vec::new();
    for number in 0..chance.below(24) {
        let count = processes.len() as u64;
        let process = &mut processes[chance.below(count) as usize];
        let length = chance.below(40) as usize;
        let line = format!("{{{number}:{}:{}}}", process.name, "x".repeat(length));
        let pushed = push(process, &path, &line);
        if let Err(error) = &pushed
            && !process.disk.is_faulty()
        {
            return Err(format!("a line was refused without a reason: {error}"));
        }
        if process.disk.is_killed() {
            process.lines = None;
        }
        fates.push((line, if pushed.is_ok() { Fate::Written } else { Fate::Refused }));
    }
    if let Some(outside) = processes.iter().find_map(|process| process.disk.outside()) {
        return Err(format!("{} was touched", outside.display()));
    }
    judge(&std::fs::read(&path).map_err(|error| error.to_string())?, &fates)?;
    Ok(processes.iter().fold(0, |all, process| all.rotate_left(7) ^ process.disk.trace()))
}

fn push(process: &mut Process, path: &std::path::Path, line: &str) -> std::io::Result<()> {
    if process.lines.is_none() {
        let disk: &dyn Disk = &process.disk;
        process.lines = Some(Lines::append_to(disk, path)?);
    }
    process.lines.as_mut().map_or(Ok(()), |lines| lines.push(line.as_bytes()))
}

/// All that was written is there, once, in its order; what else is there is a part of what was refused, and not a whole line of
/// anything else.
fn judge(bytes: &[u8], fates: &[(String, Fate)]) -> Result<(), String> {
    let mut fates = fates.iter();
    for (place, line) in lines::whole(bytes) {
        let line = String::from_utf8_lossy(line);
        loop {
            let Some((pushed, fate)) = fates.next() else { return Err(format!("line {place}, `{line}`, is nobody's")) };
            if *pushed == line {
                break;
            }
            if *fate == Fate::Written {
                return Err(format!("`{pushed}` was written, and `{line}` is in its place"));
            }
            if !line.is_empty() && pushed.starts_with(&*line) {
                break;
            }
        }
    }
    match fates.find(|(_, fate)| *fate == Fate::Written) {
        Some((lost, _)) => Err(format!("`{lost}` was written, and is not there")),
        None => Ok(()),
    }
}

#[test]
fn lines_are_whole_or_not_there() {
    try_all(KIND, history);
}

/// A process that looks while another one writes begins a line of its own, though the other's is whole in the end.
#[test]
fn a_line_with_nothing_in_it_is_none() {
    let lines: Vec<_> = onescan_base::lines::whole(b"one\n\ntwo\nhal").collect();
    assert_eq!(lines, [(0, &b"one"[..]), (2, b"two")]);
}
