//! Scenarios to begin with, as texts: `{name}` stands for the name that a scenario gets.
//!
//! They are in this crate, because a crate is packed with the files of its own folder only.

/// Name and text of a file.
pub type File = (&'static str, &'static str);

macro_rules! files {
    ($folder:literal: $($file:literal),+) => {
        &[ $( ($file, include_str!(concat!("../templates/", $folder, "/", $file))) ),+ ]
    };
}

/// Bodies, a conveyor, a sensor, pneumatics.
pub const CELL: &[File] = files!("cell": "scenario.toml", "plant.toml", "plc/main.st", "README.md");

/// Process engineering, no bodies.
pub const TANK: &[File] = files!("tank": "scenario.toml", "plant.toml", "plc/main.st", "README.md");

/// A program, and no machine yet.
pub const BLANK: &[File] = files!("blank": "scenario.toml", "plant.toml", "plc/main.st", "README.md");

/// A plant in Python.
pub const PYTHON: &[File] = files!("python": "scenario.toml", "plant.py", "plc/main.st", "README.md");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_plant_in_python_is_the_example_of_the_package() {
        let example = include_str!("../../clients/python/examples/tank.py");
        // Who has the package reads an example; who begins with a template may not have it yet.
        let import = "from onescan_client import Input, Output, Simulation\n";
        let guarded = format!(
            "try:\n    {import}except ModuleNotFoundError as missing:\n    \
             raise SystemExit(f\"plant.py needs the package {{missing.name}}: type `pip install onescan`\") from None\n"
        );
        let plant = PYTHON.iter().find(|(file, _)| *file == "plant.py").map(|(_, text)| (*text).to_owned());
        assert_eq!(plant, Some(example.replacen(import, &guarded, 1)), "copy clients/python/examples/tank.py over it");
    }
}
