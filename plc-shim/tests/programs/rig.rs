//! A PLC under test, with its variables by name.

use onescan_iec::input::kind::SourceKind;
use onescan_iec::{Diagnostics, Dialect, ElementaryType, Input, Task, TaskPlan, TimeSpan, VirtualTime, inspect};
use onescan_iec_run::{Application, PlcFault, SoftPlc, Variable};

pub(crate) const MS: u64 = 1_000_000;

pub(crate) struct Rig {
    pub(crate) plc: SoftPlc,
    pub(crate) step_ns: u64,
    pub(crate) now_ns: u64,
}

/// The application of one file, or its diagnostics as a panic.
pub(crate) fn application(text: &str) -> Application {
    match Application::from_sources([("test.st", text)]) {
        Ok(application) => application,
        Err(diagnostics) => panic!("{diagnostics}"),
    }
}

/// All that is said about one file.
pub(crate) fn findings(text: &str) -> String {
    match Application::from_sources([("test.st", text)]) {
        Ok(application) => application.warnings().to_string(),
        Err(diagnostics) => diagnostics.to_string(),
    }
}

pub(crate) fn task(name: &str, interval_ms: u64, priority: u32, programs: &[&str]) -> Task {
    Task {
        name: name.to_owned(),
        interval: TimeSpan::from_millis(interval_ms),
        priority,
        single: None,
        programs: programs.iter().map(|name| (*name).to_owned()).collect(),
    }
}

/// The application of one file read as `dialect`, or its diagnostics as a panic.
pub(crate) fn application_in(dialect: Dialect, text: &str) -> Application {
    match Application::from_inputs([input_in(dialect, text)]) {
        Ok(application) => application,
        Err(diagnostics) => panic!("{diagnostics}"),
    }
}

/// All that is said about one file read as `dialect`.
pub(crate) fn findings_in(dialect: Dialect, text: &str) -> Diagnostics {
    inspect([input_in(dialect, text)], None)
}

pub(crate) fn input_in(dialect: Dialect, text: &str) -> Input {
    Input::from_text("test.st", SourceKind::Text, text).in_dialect(dialect)
}

impl Rig {
    /// All programs in one task of 10 ms, of a file read as `dialect`.
    pub(crate) fn in_dialect(dialect: Dialect, text: &str) -> Self {
        Self::of(&application_in(dialect, text))
    }

    /// The same of the file `input`.
    pub(crate) fn of_input(input: Input) -> Self {
        let application = match Application::from_inputs([input]) {
            Ok(application) => application,
            Err(diagnostics) => panic!("{diagnostics}"),
        };
        Self::of(&application)
    }

    /// All programs in one task of 10 ms.
    pub(crate) fn new(text: &str) -> Self {
        Self::of(&application(text))
    }

    pub(crate) fn of(application: &Application) -> Self {
        let plan = application.single_task(TimeSpan::millis::<10>());
        Self::with_plan(application, &plan)
    }

    pub(crate) fn with_plan(application: &Application, plan: &TaskPlan) -> Self {
        let plc = SoftPlc::new(application, plan).expect("the plan suits the application");
        let step_ns = plc.period().map_or(0, TimeSpan::as_nanos);
        Self { plc, step_ns, now_ns: 0 }
    }

    pub(crate) fn scan(&mut self) -> Result<(), PlcFault> {
        self.now_ns += self.step_ns;
        self.plc.scan(VirtualTime::from_nanos(self.now_ns))
    }

    pub(crate) fn variable(&self, path: &str) -> Variable {
        self.plc.variable(path).expect("the variable exists")
    }

    pub(crate) fn bytes(&self, path: &str) -> [u8; 8] {
        let variable = self.variable(path);
        let mut bytes = [0; 8];
        let (offset, size) = (variable.offset as usize, variable.size as usize);
        bytes[..size].copy_from_slice(&self.plc.memory()[offset..offset + size]);
        if let Some(bit) = variable.bit {
            bytes[0] = bytes[0] >> bit & 1;
        }
        bytes
    }

    pub(crate) fn memory_of(&self, path: &str) -> &[u8] {
        let variable = self.variable(path);
        &self.plc.memory()[variable.offset as usize..][..variable.size as usize]
    }

    /// A STRING or WSTRING.
    pub(crate) fn text(&self, path: &str) -> String {
        let variable = self.variable(path);
        let mut bytes = self.memory_of(path).to_vec();
        if let Some(text) = variable.zero_terminated {
            let memory = std::mem::take(&mut bytes);
            bytes.resize(memory.len() + 2, 0);
            text.take(&memory, &mut bytes);
        }
        let used = usize::from(u16::from_le_bytes([bytes[0], bytes[1]]));
        if variable.type_name.starts_with('W') {
            let units = bytes[2..].chunks_exact(2).map(|unit| u16::from_le_bytes([unit[0], unit[1]]));
            String::from_utf16_lossy(&units.take(used).collect::<Vec<_>>())
        } else {
            bytes[2..2 + used].iter().map(|byte| char::from(*byte)).collect()
        }
    }

    /// Any integer, bit string, duration or BOOL.
    pub(crate) fn int(&self, path: &str) -> i64 {
        let ty = self.variable(path).ty.expect("an elementary type");
        let raw = i64::from_le_bytes(self.bytes(path));
        let unused = 64 - ty.size() * 8;
        let signed = ty.is_signed();
        if signed { raw << unused >> unused } else { raw }
    }

    pub(crate) fn bool(&self, path: &str) -> bool {
        self.int(path) != 0
    }

    pub(crate) fn real(&self, path: &str) -> f64 {
        let bytes = self.bytes(path);
        match self.variable(path).ty {
            Some(ElementaryType::Real) => f64::from(f32::from_bits(u64::from_le_bytes(bytes) as u32)),
            _ => f64::from_le_bytes(bytes),
        }
    }

    pub(crate) fn set(&mut self, path: &str, value: i64) {
        self.set_bytes(path, &value.to_le_bytes());
    }

    pub(crate) fn set_bytes(&mut self, path: &str, bytes: &[u8]) {
        let variable = self.variable(path);
        let (offset, size) = (variable.offset as usize, variable.size as usize);
        self.plc.memory_mut()[offset..offset + size].copy_from_slice(&bytes[..size]);
    }
}

/// The variable `r` of a program with these declarations and statements, after one scan.
pub(crate) fn result(declarations: &str, statements: &str) -> Rig {
    let text = format!("PROGRAM P VAR {declarations} END_VAR {statements} END_PROGRAM");
    let mut rig = Rig::new(&text);
    rig.scan().expect("no fault");
    rig
}
