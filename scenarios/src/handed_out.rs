//! Which files of a task are for those who solve it. The build script reads this file, too.

use std::path::{Component, Path};

/// The folder with solutions, hidden cases and wrong programs.
const SOLUTIONS: &str = "solutions";
/// What the names of scenarios with a solution begin with, and those of their cases.
const SOLUTION: &str = "solution-";
/// The folder with what solutions do.
const SNAPSHOTS: &str = "snapshots";

/// True for a file of a task, relative to its folder, that does not give its solution away. Hidden files are the author's
/// own.
pub fn is_handed_out(file: &Path) -> bool {
    file.components().all(|part| {
        let Component::Normal(name) = part else { return false };
        let name = name.to_string_lossy();
        name != SOLUTIONS && name != SNAPSHOTS && !name.starts_with(SOLUTION) && !name.starts_with('.')
    })
}

/// True for a scenario with a solution: `solution-st.toml`, and not the cases of one.
pub fn is_solution(name: &str) -> bool {
    let stem = name.strip_prefix(SOLUTION).and_then(|rest| rest.strip_suffix(".toml"));
    stem.is_some_and(|stem| stem.strip_suffix(".cases").is_none())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solutions_stay_with_the_teacher() {
        for file in
            ["scenario.toml", "cases.toml", "README.md", "skeleton/main.st", "components/lift.st", "machine.svg"]
        {
            assert!(is_handed_out(Path::new(file)), "{file}");
        }
        for file in [
            "solutions/st/main.st",
            "solutions/hidden.toml",
            "solution-st.toml",
            "solution-sfc.cases.toml",
            "snapshots/solution-st/default.traj",
            ".git/config",
            "../other/scenario.toml",
        ] {
            assert!(!is_handed_out(Path::new(file)), "{file}");
        }
    }

    #[test]
    fn the_cases_of_a_solution_are_not_one() {
        assert!(is_solution("solution-st.toml"));
        assert!(
            !is_solution("solution-st.cases.toml") && !is_solution("scenario.toml") && !is_solution("solution-st.md")
        );
    }
}
