//! Folders that are written, the ports and descriptors of this machine, and what the environment permits.

use std::net::{Ipv4Addr, TcpListener};
use std::path::Path;

use super::finding::Finding;
use crate::train;
use crate::web::listener;

/// Below this a page with a few viewers, a recording and its clients are in each other's way.
const DESCRIPTORS_MIN: usize = 256;

pub(super) fn examined() -> Vec<Finding> {
    let mut findings = vec![temporary_folder(), starts(), loopback(), descriptors(), cores()];
    findings.extend(permission());
    findings.push(scenario(Path::new(".")));
    findings
}

fn temporary_folder() -> Finding {
    let folder = std::env::temp_dir();
    match tempfile::tempfile_in(&folder) {
        Ok(_) => Finding::ok("temporary folder", folder.display().to_string()),
        Err(error) => Finding::wrong(
            "temporary folder",
            format!("{}: {error}", folder.display()),
            "reports and pictures are written there first: name a folder that you may write in the variable `TMPDIR`",
        ),
    }
}

/// The folder itself is made when a lesson first needs it; until then the next one above it must take it.
fn starts() -> Finding {
    let folder = train::usual_folder();
    let there = folder.ancestors().find(|folder| folder.is_dir()).unwrap_or(&folder);
    match tempfile::tempfile_in(there) {
        Ok(_) => Finding::ok("cache", folder.display().to_string()),
        Err(error) => Finding::missing(
            "cache",
            format!("{}: {error}", there.display()),
            "lessons keep prepared states there, and make them again each time without it: `onescan train --starts DIR`",
        ),
    }
}

fn loopback() -> Finding {
    match TcpListener::bind((Ipv4Addr::LOCALHOST, 0)) {
        Ok(_) => Finding::ok("loopback", "ports of 127.0.0.1 can be served"),
        Err(error) => Finding::wrong(
            "loopback",
            format!("127.0.0.1: {error}"),
            "pages, clients in processes of their own and links need it: permit it in the container or firewall",
        ),
    }
}

fn descriptors() -> Finding {
    match listener::descriptors() {
        None => Finding::ok("open files", "without a limit"),
        Some(limit) if limit >= DESCRIPTORS_MIN => Finding::ok("open files", format!("up to {limit}")),
        Some(limit) => Finding::missing(
            "open files",
            format!("up to {limit} only"),
            "a page serves few viewers then: raise it with `ulimit -n 1024`",
        ),
    }
}

fn cores() -> Finding {
    match std::thread::available_parallelism() {
        Ok(cores) => Finding::ok("cores", format!("{cores} for `--jobs`")),
        Err(error) => {
            Finding::missing("cores", error.to_string(), "give `--jobs N` to commands that run many sessions")
        }
    }
}

/// What the environment permits to scenarios; nothing where it says nothing.
fn permission() -> Vec<Finding> {
    let set = |name: &str| std::env::var(name).ok().filter(|value| !value.is_empty());
    ["ONESCAN_ALLOW_PATH", "ONESCAN_NO_COMMANDS"]
        .iter()
        .filter_map(|name| set(name).map(|value| Finding::ok("environment", format!("{name}={value}"))))
        .collect()
}

fn scenario(folder: &Path) -> Finding {
    if folder.join("scenario.toml").is_file() {
        return Finding::ok("scenario", "in this folder: `onescan run`");
    }
    Finding::ok("scenario", "none in this folder: `onescan new NAME` writes one")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scenario_is_seen_where_it_lies() {
        let folder = tempfile::tempdir().unwrap();
        assert!(scenario(folder.path()).found.starts_with("none"));
        std::fs::write(folder.path().join("scenario.toml"), "").unwrap();
        assert!(scenario(folder.path()).found.starts_with("in this folder"));
    }
}
