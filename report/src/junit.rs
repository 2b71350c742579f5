//! The report format of `JUnit`, as CI servers read it: a suite for each scenario, a case for each test.
//!
//! `time` of a case is what it took where that was measured, since CI servers share out tests by it; virtual time is a
//! property then. Else it is virtual time, so that equal runs give equal reports.

use std::fmt::{self, Write as _};
use std::time::Duration;

#[derive(Clone, Debug)]
pub struct Tests {
    /// In the order of the report.
    pub suites: Vec<Suite>,
    /// How long it all took, wall clock.
    pub wall_time: Duration,
}

/// Tests that belong together.
#[derive(Clone, Debug)]
pub struct Suite {
    /// The scenario's folder, or the sources.
    pub name: String,
    /// In the order of the report.
    pub cases: Vec<Case>,
}

#[derive(Clone, Debug)]
pub struct Case {
    /// What it belongs to, if not to the suite as a whole.
    pub class: Option<String>,
    /// The case of the scenario or the test program; empty if it is not known.
    pub name: String,
    /// Virtual time at its end.
    pub virtual_time_ns: u64,
    /// How long it took, wall clock, if reports are to say so.
    pub wall_time: Option<Duration>,
    /// File and line that it leads to.
    pub place: Option<(String, u32)>,
    pub ended: Ended,
}

/// How a test ended.
#[derive(Clone, Debug)]
pub enum Ended {
    /// All is as it should be.
    Well,
    /// The test is switched off.
    Skipped,
    /// The test did not find what it wants.
    Failure(Trouble),
    /// The test could not be made.
    Error(Trouble),
}

#[derive(Clone, Debug)]
pub struct Trouble {
    pub word: &'static str,
    /// What there is to say of it.
    pub lines: Vec<String>,
}

impl Tests {
    /// The report as XML.
    pub fn to_xml(&self) -> String {
        let mut text = String::new();
        // A String takes everything, so that there is nothing to report.
        let written = self.write(&mut text);
        debug_assert!(written.is_ok());
        text
    }

    fn write(&self, text: &mut String) -> fmt::Result {
        let all: Vec<&Case> = self.suites.iter().flat_map(|suite| &suite.cases).collect();
        let (counts, wall) = (counts(&all), self.wall_time.as_secs_f64());
        writeln!(text, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>")?;
        writeln!(text, "<testsuites name=\"onescan\" {counts} time=\"{wall:.3}\">")?;
        self.suites.iter().try_for_each(|suite| suite.write(text))?;
        writeln!(text, "</testsuites>")
    }
}

impl Suite {
    fn write(&self, text: &mut String) -> fmt::Result {
        let cases: Vec<&Case> = self.cases.iter().collect();
        let time: f64 = cases.iter().map(|case| case.time_s()).sum();
        let (name, counts) = (escaped(&self.name), counts(&cases));
        let skipped = cases.iter().filter(|case| matches!(case.ended, Ended::Skipped)).count();
        writeln!(text, "  <testsuite name=\"{name}\" {counts} skipped=\"{skipped}\" time=\"{time:.3}\">")?;
        self.cases.iter().try_for_each(|case| case.write(&name, text))?;
        writeln!(text, "  </testsuite>")
    }
}

impl Case {
    fn time_s(&self) -> f64 {
        self.wall_time.map_or(self.virtual_time_ns as f64 / 1e9, |time| time.as_secs_f64())
    }

    /// What stands before the failure.
    fn properties(&self) -> String {
        if self.wall_time.is_none() {
            return String::new();
        }
        let time = self.virtual_time_ns as f64 / 1e9;
        format!("\n      <properties><property name=\"virtual_time_s\" value=\"{time:.3}\"/></properties>")
    }

    /// `suite` is escaped already.
    fn write(&self, suite: &str, text: &mut String) -> fmt::Result {
        let class = self.class.as_ref().map_or_else(|| suite.to_owned(), |class| escaped(class));
        let name = escaped(if self.name.is_empty() { "(all)" } else { &self.name });
        let time = self.time_s();
        write!(text, "    <testcase name=\"{name}\" classname=\"{class}\" time=\"{time:.3}\"")?;
        if let Some((file, line)) = &self.place {
            write!(text, " file=\"{}\" line=\"{line}\"", escaped(file))?;
        }
        let (kind, Trouble { word, lines }) = match &self.ended {
            Ended::Well if self.wall_time.is_none() => return writeln!(text, "/>"),
            Ended::Well => return writeln!(text, ">{}\n    </testcase>", self.properties()),
            Ended::Skipped => return writeln!(text, ">\n      <skipped/>\n    </testcase>"),
            Ended::Failure(trouble) => ("failure", trouble),
            Ended::Error(trouble) => ("error", trouble),
        };
        let first = escaped(lines.first().map_or(*word, String::as_str));
        let all = escaped(&lines.join("\n"));
        let properties = self.properties();
        writeln!(
            text,
            ">{properties}\n      <{kind} message=\"{first}\" type=\"{word}\">{all}</{kind}>\n    </testcase>"
        )
    }
}

fn counts(cases: &[&Case]) -> String {
    let errors = cases.iter().filter(|case| matches!(case.ended, Ended::Error(_))).count();
    let failures = cases.iter().filter(|case| matches!(case.ended, Ended::Failure(_))).count();
    format!("tests=\"{}\" failures=\"{failures}\" errors=\"{errors}\"", cases.len())
}

/// Text that may stand between tags and in quoted attributes of XML. Characters that XML 1.0 has no place
/// for become U+FFFD.
fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\n' | '\t' => safe.push(letter),
            '\u{0}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => safe.push('\u{fffd}'),
            _ => safe.push(letter),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_stays_text() {
        assert_eq!(escaped("a < b && \"c\"\u{1b}"), "a &lt; b &amp;&amp; &quot;c&quot;\u{fffd}");
    }
}
