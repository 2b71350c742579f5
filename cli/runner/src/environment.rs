//! What programs that are not ours see of this process's environment: what programs need to run, and what a scenario
//! names for its own. Secrets of whoever runs it, as of a CI server, are not among that.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Variables that are passed on: where programs and libraries are, who and where the user is, how to speak to him.
const PRESETS: [&str; 37] = [
    "PATH",
    "HOME",
    "USER",
    "LOGNAME",
    "SHELL",
    "LANG",
    "LANGUAGE",
    "TZ",
    "TERM",
    "NO_COLOR",
    "TMPDIR",
    "TEMP",
    "TMP",
    "DISPLAY",
    "WAYLAND_DISPLAY",
    "XAUTHORITY",
    "XDG_RUNTIME_DIR",
    "LD_LIBRARY_PATH",
    "DYLD_LIBRARY_PATH",
    "PYTHONPATH",
    "PYTHONHOME",
    "VIRTUAL_ENV",
    "CONDA_PREFIX",
    "JAVA_HOME",
    "NODE_PATH",
    "ROS_DISTRO",
    "AMENT_PREFIX_PATH",
    "SystemRoot",
    "SystemDrive",
    "ComSpec",
    "PATHEXT",
    "windir",
    "USERPROFILE",
    "APPDATA",
    "LOCALAPPDATA",
    "ProgramFiles",
    "ONESCAN_LOG",
];

const PRESET_PREFIXES: [&str; 1] = ["LC_"];

/// Lets `command` see no more of this process's environment than programs need, and what is in `named`.
pub(crate) fn confine(command: &mut Command, named: &[String]) {
    let passed: Vec<(OsString, OsString)> =
        std::env::vars_os().filter(|(name, _)| passes(name.to_str(), named)).collect();
    command.env_clear().envs(passed);
}

/// The program of this name in the folders of `PATH`, or the file itself where the name has a folder.
pub(crate) fn on_path(name: &OsStr) -> Option<PathBuf> {
    found_in(name, &folders())
}

/// The folders of `PATH`. Where it is not set there are none, and only a name with a folder finds its program.
pub(crate) fn folders() -> OsString {
    std::env::var_os("PATH").unwrap_or_default()
}

/// As [`on_path`], in these folders.
pub(crate) fn found_in(name: &OsStr, folders: &OsStr) -> Option<PathBuf> {
    if Path::new(name).components().count() > 1 {
        return Some(PathBuf::from(name)).filter(|file| file.is_file());
    }
    // Windows finds `git.exe` by `git`.
    let mut file = name.to_owned();
    if Path::new(name).extension().is_none() {
        file.push(std::env::consts::EXE_SUFFIX);
    }
    std::env::split_paths(folders).map(|folder| folder.join(&file)).find(|file| file.is_file())
}

fn passes(name: Option<&str>, named: &[String]) -> bool {
    // Windows does not distinguish upper case from lower.
    let is = |known: &str, name: &str| if cfg!(windows) { known.eq_ignore_ascii_case(name) } else { known == name };
    name.is_some_and(|name| {
        PRESETS.iter().any(|known| is(known, name))
            || PRESET_PREFIXES.iter().any(|prefix| name.starts_with(prefix))
            || named.iter().any(|known| is(known, name))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn secrets_stay_unless_they_are_named() {
        let named = ["LICENSE_SERVER".to_owned()];
        assert!(passes(Some("PATH"), &[]) && passes(Some("LC_ALL"), &[]));
        assert!(passes(Some("LICENSE_SERVER"), &named) && !passes(Some("LICENSE_SERVER"), &[]));
        for secret in ["GITHUB_TOKEN", "AWS_SECRET_ACCESS_KEY", "ONESCAN_TOKEN", "ONESCAN_OPCUA_PASSWORD"] {
            assert!(!passes(Some(secret), &named), "{secret}");
        }
    }
}
