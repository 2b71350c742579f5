//! A Chromium without a window.

use std::ffi::{OsStr, OsString};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use super::error::ShotError;
use crate::environment;
use crate::web::Drawn;

/// Where the browser is, if it is to be another one than the first of [`NAMES`].
const VARIABLE: &str = "CHROMIUM";
/// Programs that are a Chromium.
const NAMES: &[&str] =
    &["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "microsoft-edge"];
/// How often it is looked whether the browser is still there.
const LOOK: Duration = Duration::from_millis(200);

/// A Chromium that is installed.
pub(super) struct Browser {
    program: PathBuf,
}

/// The browser while it runs; it goes when the picture is there, or nobody waits for it any more.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        // It may have gone by itself.
        self.0.kill().ok();
        self.0.wait().ok();
    }
}

impl Browser {
    /// The one that `CHROMIUM` names, or the first that is found.
    pub(super) fn installed() -> Result<Self, ShotError> {
        let named = || std::env::var_os(VARIABLE).map(|named| named.to_string_lossy().into_owned());
        program().map(|program| Self { program }).ok_or_else(|| ShotError::NoBrowser { named: named() })
    }

    /// Opens a page that sends pictures.
    pub(super) fn open(&self, url: &str) -> Result<Window, ShotError> {
        let wrong = |source| ShotError::Browser { program: self.program.display().to_string(), source };
        let profile = tempfile::tempdir().map_err(wrong)?;
        let mut command = Command::new(&self.program);
        environment::confine(&mut command, &[]);
        command.args([
            "--headless=new",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
        ]);
        command.args(["--disable-sync", "--disable-quic", "--hide-scrollbars", "--disable-gpu"]);
        // Pixels are those of the processor, whatever graphics card there is.
        command.args(["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]);
        if is_root() {
            // It refuses to run as root with its sandbox; what it opens is our own page.
            command.arg("--no-sandbox");
        }
        let mut folder = OsString::from("--user-data-dir=");
        folder.push(profile.path());
        command.arg(folder).arg(url).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        let running = Running(command.spawn().map_err(wrong)?);
        Ok(Window { running, program: self.program.display().to_string(), _profile: profile })
    }
}

/// A page that is open, and sends pictures.
pub(super) struct Window {
    // Before the folder that the browser writes to.
    running: Running,
    program: String,
    _profile: tempfile::TempDir,
}

impl Window {
    /// The next picture.
    pub(super) fn next(&mut self, drawn: &Receiver<Drawn>, patience: Duration) -> Result<Vec<u8>, ShotError> {
        let wrong = |source| ShotError::Browser { program: self.program.clone(), source };
        let until = Instant::now() + patience;
        loop {
            match drawn.recv_timeout(LOOK) {
                Ok(Ok(picture)) => return Ok(picture),
                Ok(Err(why)) => return Err(ShotError::Page(why)),
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(ShotError::Page("the page is not served".to_owned()));
                }
                Err(RecvTimeoutError::Timeout) => {
                    if let Some(status) = self.running.0.try_wait().map_err(wrong)? {
                        return Err(ShotError::Gone { program: self.program.clone(), status });
                    }
                    if Instant::now() > until {
                        return Err(ShotError::Late(patience));
                    }
                }
            }
        }
    }
}

/// The one that `CHROMIUM` names, or the first that is found; nothing where there is none.
pub(crate) fn program() -> Option<PathBuf> {
    found(std::env::var_os(VARIABLE).as_deref(), &environment::folders())
}

/// The browser that is named, or the first of [`NAMES`] in the folders of `path`.
fn found(named: Option<&OsStr>, path: &OsStr) -> Option<PathBuf> {
    match named {
        Some(named) => environment::found_in(named, path),
        None => NAMES.iter().find_map(|name| environment::found_in(name.as_ref(), path)),
    }
}

/// Whether this process is root's.
#[cfg(target_os = "linux")]
fn is_root() -> bool {
    use std::os::unix::fs::MetadataExt as _;

    std::fs::metadata("/proc/self").is_ok_and(|own| own.uid() == 0)
}

/// Elsewhere it has no such rule.
#[cfg(not(target_os = "linux"))]
fn is_root() -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_browser_is_named_or_found() {
        let folder = tempfile::tempdir().expect("a folder");
        let program = folder.path().join("google-chrome");
        let path = folder.path().as_os_str();
        assert_eq!(found(None, path), None);
        std::fs::write(&program, "").expect("written");
        assert_eq!(found(None, path), Some(program.clone()));
        assert_eq!(found(Some(program.as_os_str()), OsStr::new("")), Some(program));
        assert_eq!(found(Some(OsStr::new("chromium")), path), None);
    }
}
