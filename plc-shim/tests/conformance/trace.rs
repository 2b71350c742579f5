//! A case run from its text to its last scan.

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Input, TimeSpan, VirtualTime};
use onescan_iec_run::{Application, PlcFault, SoftPlc, Variable};

use super::case::{Case, Row};
use super::cell;

/// Compiles and runs a case; the error shows the first scan that differs.
pub(crate) fn run(case: &Case, text: &str) -> Result<(), String> {
    let mut input = Input::from_text("case.st", SourceKind::Text, text);
    if let Some(dialect) = case.dialect {
        input = input.in_dialect(dialect);
    }
    let application = match Application::from_inputs([input]) {
        Ok(application) => application,
        Err(found) if case.findings.is_some() => return same_findings(case, &found),
        Err(found) => return Err(format!("it does not compile\n{found}")),
    };
    if case.findings.is_some() {
        same_findings(case, application.warnings())?;
    }
    let single = || application.single_task(case.interval());
    let plan = application.configured_tasks().unwrap_or_else(single);
    let plc = SoftPlc::new(&application, &plan).map_err(|error| error.to_string())?;
    let interval_ns = plc.period().map_or(0, TimeSpan::as_nanos);
    let first = application.programs().next().map(|program| program.name);
    let mut run = Run { plc, prefix: first.unwrap_or_default(), now_ns: 0, interval_ns };
    for scan in 0..case.scans {
        run.scan(case, scan).map_err(|why| format!("scan {}: {why}", scan + 1))?;
    }
    Ok(())
}

fn same_findings(case: &Case, found: &onescan_iec::Diagnostics) -> Result<(), String> {
    let codes: Vec<_> = found.iter().map(|each| each.code.text()).collect();
    let wanted = case.findings.as_deref().unwrap_or(&[]);
    if codes == wanted { Ok(()) } else { Err(format!("wanted {}, found\n{found}", wanted.join(" "))) }
}

struct Run {
    plc: SoftPlc,
    /// The first program, whose variables need no prefix.
    prefix: String,
    now_ns: u64,
    interval_ns: u64,
}

impl Run {
    fn variable(&self, path: &str) -> Result<Variable, String> {
        variable(&self.plc, &self.prefix, path)
    }

    /// The bytes of a variable; a BOOL that is a bit of one as a byte.
    fn held(&self, variable: &Variable) -> Vec<u8> {
        let bytes = &self.plc.memory()[variable.offset as usize..][..variable.size as usize];
        variable.bit.map_or(bytes.to_vec(), |bit| vec![bytes[0] >> bit & 1])
    }

    fn scan(&mut self, case: &Case, scan: usize) -> Result<(), String> {
        match case.restarts.get(scan).map(String::as_str) {
            Some("warm") => self.plc.warm_start(),
            Some("cold") => self.plc.cold_start(),
            Some("-") | None => {}
            Some(other) => return Err(format!("`{other}` is not a start")),
        }
        for row in &case.given {
            give(&mut self.plc, &self.prefix, row, scan)?;
        }
        self.now_ns += self.interval_ns;
        let outcome = self.plc.scan(VirtualTime::from_nanos(self.now_ns));
        let last = scan + 1 == case.scans;
        same_outcome(case.fault.as_deref().filter(|_| last), outcome)?;
        let wrong: Vec<_> = case.wanted.iter().filter_map(|row| self.difference(row, scan).transpose()).collect();
        let wrong = wrong.into_iter().collect::<Result<Vec<_>, _>>()?;
        if wrong.is_empty() { Ok(()) } else { Err(wrong.join("; ")) }
    }

    /// What is wrong with a variable after a scan.
    fn difference(&self, row: &Row, scan: usize) -> Result<Option<String>, String> {
        let Some(value) = row.wanted(scan) else { return Ok(None) };
        let variable = self.variable(&row.path)?;
        let (wanted, found) = (encoded(value, &variable)?, self.held(&variable));
        let same = cell::same(&wanted, &found, &variable);
        Ok((!same).then(|| format!("{} is {}, not {value}", row.path, cell::text(&found, &variable))))
    }
}

/// The variable of a path, in which the first program needs no prefix.
fn variable(plc: &SoftPlc, prefix: &str, path: &str) -> Result<Variable, String> {
    let own = plc.variable(&format!("{prefix}.{path}"));
    own.or_else(|_| plc.variable(path)).map_err(|error| error.to_string())
}

/// Writes what is given before a scan.
pub(crate) fn give(plc: &mut SoftPlc, prefix: &str, row: &Row, scan: usize) -> Result<(), String> {
    let Some(value) = row.given(scan) else { return Ok(()) };
    let variable = variable(plc, prefix, &row.path)?;
    let mut bytes = encoded(value, &variable)?;
    if let Some(bit) = variable.bit {
        let others = plc.memory()[variable.offset as usize] & !(1 << bit);
        bytes[0] = others | bytes[0] << bit;
    }
    plc.memory_mut()[variable.offset as usize..][..bytes.len()].copy_from_slice(&bytes);
    Ok(())
}

fn encoded(value: &str, variable: &Variable) -> Result<Vec<u8>, String> {
    cell::bytes(value, variable).ok_or_else(|| format!("`{value}` is not a value of {}", variable.type_name))
}

fn same_outcome(wanted: Option<&str>, outcome: Result<(), PlcFault>) -> Result<(), String> {
    match (wanted, outcome) {
        (None, Ok(())) => Ok(()),
        (Some(wanted), Err(fault)) if format!("{:?}", fault.kind) == wanted => Ok(()),
        (_, Err(fault)) => Err(format!("the PLC stopped: {fault} ({:?})", fault.kind)),
        (Some(wanted), Ok(())) => Err(format!("no fault {wanted}")),
    }
}
