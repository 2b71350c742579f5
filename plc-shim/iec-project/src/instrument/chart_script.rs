//! The text of the action that runs in every scan of a chart, line by line.

use std::collections::BTreeMap;

use super::chart_action::Moved;
use onescan_iec::syntax::ast::Ident;

/// Which of two rounds over the actions of a chart is run.
pub(super) const ROUND: &str = "SDSP_Round";

/// Lines that are put in, each with the original's line that it has been moved from.
#[derive(Default)]
pub(super) struct Script {
    pub(super) text: String,
    pub(super) origins: Vec<Option<u32>>,
}

impl Script {
    pub(super) fn put(&mut self, lines: &str) {
        lines.lines().for_each(|line| self.line(line, None));
    }

    pub(super) fn join(&mut self, other: Self) {
        self.text.push_str(&other.text);
        self.origins.extend(other.origins);
    }

    fn line(&mut self, line: &str, origin: Option<u32>) {
        self.text.push_str(line);
        self.text.push('\n');
        self.origins.push(origin);
    }

    /// Runs actions, those whose flag is FALSE before the others, in two rounds that `counter` counts.
    pub(super) fn run<'u>(
        &mut self,
        bodies: impl Iterator<Item = &'u Ident> + Clone,
        moved: &BTreeMap<String, Moved>,
        counter: &str,
    ) {
        let has_rounds = bodies.clone().count() > 1;
        if has_rounds {
            self.put(&format!("    FOR {counter} := 0 TO 1 DO (* what runs for the last time comes first *)"));
        }
        for action in bodies {
            let round =
                if has_rounds { format!(" AND SDSP_Ctl_{}.Q = ({counter} = 1)", action.text) } else { String::new() };
            self.put(&format!("    IF SDSP_Ctl_{}.SDSP_Runs{round} THEN", action.text));
            match moved.get(&action.key()) {
                Some(moved) => moved.lines.iter().for_each(|(line, origin)| self.line(line, *origin)),
                None => self.put(&format!("        {}();", action.text)),
            }
            self.put("    END_IF;");
        }
        if has_rounds {
            self.put("    END_FOR;");
        }
    }
}
