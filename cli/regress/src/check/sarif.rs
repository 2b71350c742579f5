//! Findings as a SARIF log.

use std::io::{self, Write};

use onescan_iec::{Code, Finding};
use onescan_report::sarif::{Found, Region, Rule, log};

use super::report::{Report, severity};

/// Writes the report.
///
/// # Errors
/// Those of `out`.
pub fn write(report: &Report, out: &mut dyn Write) -> io::Result<()> {
    let rules: Vec<Rule<'_>> = Code::ALL.iter().map(|code| Rule { id: code.text(), about: code.about() }).collect();
    // Every code is a rule, so that none is left out.
    let rule = |finding: &Finding| Code::ALL.iter().position(|code| *code == finding.diagnostic().code);
    let found = report.iter().filter_map(|finding| Some(result(rule(finding)?, finding)));
    let passed_over = (!report.passed_over.is_empty()).then(|| report.passed_over.to_string());
    out.write_all(log(&rules, found, passed_over.as_deref()).as_bytes())
}

fn result(rule: usize, finding: &Finding) -> Found<'_> {
    let diagnostic = finding.diagnostic();
    let text = match &diagnostic.help {
        Some(help) => format!("{} ({help})", diagnostic.message),
        None => diagnostic.message.clone(),
    };
    let (start, end) = (finding.start(), finding.end());
    let region = Region { start: [start.line, start.column], end: Some([end.line, end.column]) };
    Found { rule, level: severity(diagnostic.severity), text, file: finding.file(), region }
}
