//! A C program, compiled by the machine's own compiler and run as a child that times itself.

use std::path::{Path, PathBuf};
use std::process::Command;

/// A program that runs its scans when asked.
pub struct Native {
    path: PathBuf,
}

impl Native {
    /// Compiles `source` with the driver, each on its own, so that nothing of one is inlined into
    /// the other.
    pub fn compile(name: &str, source: &str) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
        let (file, driver) = (folder.join(format!("{name}.c")), folder.join("driver.c"));
        std::fs::write(&file, source).expect("the folder can be written to");
        std::fs::write(&driver, include_str!("driver.c")).expect("the folder can be written to");
        let path = folder.join(name);
        let mut gcc = Command::new("gcc");
        gcc.arg("-O2").arg("-o").arg(&path).arg(&file).arg(driver).arg("-lm");
        let status = gcc.status().expect("this bench needs gcc");
        assert!(status.success(), "{name} compiles");
        Self { path }
    }

    /// Nanoseconds and the final checksum of so many scans.
    pub fn run(&self, scans: u64) -> (f64, u64) {
        let output = Command::new(&self.path).arg(scans.to_string()).output().expect("it runs");
        let text = String::from_utf8(output.stdout).expect("it prints numbers");
        let mut numbers = text.split_whitespace();
        let mut next = || numbers.next().expect("it prints two numbers");
        (next().parse().expect("nanoseconds"), next().parse().expect("a checksum"))
    }
}
