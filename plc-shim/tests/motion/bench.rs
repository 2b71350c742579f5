//! Two axes and every motion block, with variables by name.

use onescan_iec::{ElementaryType, TimeSpan, VirtualTime};
use onescan_iec_run::{Application, SoftPlc};

const MS: u64 = 1_000_000;

/// Blocks on axis X; coupled ones have X as master and Y as slave.
const BLOCKS: [(&str, &str); 24] = [
    ("Power", "MC_Power"),
    ("Reset", "MC_Reset"),
    ("Home", "MC_Home"),
    ("Stop", "MC_Stop"),
    ("Halt", "MC_Halt"),
    ("Absolute", "MC_MoveAbsolute"),
    ("Absolute2", "MC_MoveAbsolute"),
    ("Absolute3", "MC_MoveAbsolute"),
    ("Relative", "MC_MoveRelative"),
    ("Relative2", "MC_MoveRelative"),
    ("Additive", "MC_MoveAdditive"),
    ("Velocity", "MC_MoveVelocity"),
    ("Superimposed", "MC_MoveSuperimposed"),
    ("Torque", "MC_TorqueControl"),
    ("SetPosition", "MC_SetPosition"),
    ("Status", "MC_ReadStatus"),
    ("ReadError", "MC_ReadAxisError"),
    ("ReadPosition", "MC_ReadActualPosition"),
    ("ReadVelocity", "MC_ReadActualVelocity"),
    ("ReadTorque", "MC_ReadActualTorque"),
    ("ReadParameter", "MC_ReadParameter"),
    ("ReadBool", "MC_ReadBoolParameter"),
    ("WriteParameter", "MC_WriteParameter"),
    ("WriteBool", "MC_WriteBoolParameter"),
];

/// The program: each block is called once in a scan with the inputs that it has.
fn program() -> String {
    let declared: String = BLOCKS.iter().map(|(name, block)| format!("    {name} : {block};\n")).collect();
    let called: String = BLOCKS.iter().map(|(name, _)| format!("    {name}(Axis := X);\n")).collect();
    format!(
        "PROGRAM P\nVAR\n    X, Y : AXIS_REF;\n    Table : MC_CAM_REF;\n{declared}    PowerY : MC_Power;\n    HaltY : MC_Halt;\n    \
         VelocityY : MC_MoveVelocity;\n    StatusY : MC_ReadStatus;\n    Gear : MC_GearIn;\n    GearOut : MC_GearOut;\n    \
         GearBack : MC_GearIn;\n    \
         Select : MC_CamTableSelect;\n    Cam : MC_CamIn;\n    CamOut : MC_CamOut;\nEND_VAR\n{called}    \
         PowerY(Axis := Y);\n    HaltY(Axis := Y);\n    VelocityY(Axis := Y);\n    Gear(Master := X, Slave := Y);\n    \
         GearOut(Slave := Y);\n    GearBack(Master := Y, Slave := X);\n    \
         Select(Master := X, Slave := Y, CamTable := Table);\n    \
         Cam(Master := X, Slave := Y, CamTableID := Select.CamTableID);\n    CamOut(Slave := Y);\n    StatusY(Axis := Y);\n\
         END_PROGRAM\n"
    )
}

/// The states of an axis (2.1, figure 2), in the order of `ONESCAN_AXIS_STATE`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum State {
    Disabled,
    Standstill,
    Homing,
    DiscreteMotion,
    ContinuousMotion,
    SynchronizedMotion,
    Stopping,
    ErrorStop,
}

impl State {
    pub(crate) const ALL: [Self; 8] = [
        Self::Disabled,
        Self::Standstill,
        Self::Homing,
        Self::DiscreteMotion,
        Self::ContinuousMotion,
        Self::SynchronizedMotion,
        Self::Stopping,
        Self::ErrorStop,
    ];
}

pub(crate) struct Bench {
    plc: SoftPlc,
    now_ns: u64,
    pub(crate) step_ns: u64,
}

/// Compiled once for all tests.
fn application() -> &'static Application {
    static APPLICATION: std::sync::OnceLock<Application> = std::sync::OnceLock::new();
    APPLICATION.get_or_init(|| match Application::from_sources([("bench.st", program())]) {
        Ok(application) => application,
        Err(diagnostics) => panic!("{diagnostics}"),
    })
}

impl Bench {
    /// Nothing has power yet.
    pub(crate) fn cold() -> Self {
        Self::on(application())
    }

    /// Another program `P`.
    pub(crate) fn on(application: &Application) -> Self {
        let plan = application.single_task(TimeSpan::millis::<1>());
        Self { plc: SoftPlc::new(application, &plan).expect("the plan suits"), now_ns: 0, step_ns: 10 * MS }
    }

    /// Both axes have power and stand still.
    pub(crate) fn new() -> Self {
        let mut bench = Self::cold();
        for input in ["Power.Enable", "PowerY.Enable", "Status.Enable", "StatusY.Enable"] {
            bench.set(input, true);
        }
        bench.scan();
        assert_eq!(bench.state(), State::Standstill);
        bench
    }

    pub(crate) fn scan(&mut self) {
        self.now_ns += self.step_ns;
        self.plc.scan(VirtualTime::from_nanos(self.now_ns)).expect("no fault");
    }

    pub(crate) fn scans(&mut self, count: usize) {
        (0..count).for_each(|_| self.scan());
    }

    pub(crate) fn now_s(&self) -> f64 {
        self.now_ns as f64 * 1e-9
    }

    fn place(&self, path: &str) -> (usize, usize, Option<ElementaryType>) {
        let variable = self.plc.variable(&format!("P.{path}")).unwrap_or_else(|error| panic!("{error}"));
        (variable.offset as usize, variable.size as usize, variable.ty)
    }

    fn write(&mut self, path: &str, bytes: &[u8]) {
        let (offset, size, _) = self.place(path);
        self.plc.memory_mut()[offset..offset + size].copy_from_slice(&bytes[..size]);
    }

    pub(crate) fn set(&mut self, path: &str, value: bool) {
        self.write(path, &[u8::from(value)]);
    }

    pub(crate) fn set_int(&mut self, path: &str, value: i64) {
        self.write(path, &value.to_le_bytes());
    }

    pub(crate) fn set_real(&mut self, path: &str, value: f64) {
        assert_eq!(self.place(path).2, Some(ElementaryType::Lreal), "{path}");
        self.write(path, &value.to_le_bytes());
    }

    fn bytes(&self, path: &str) -> [u8; 8] {
        let (offset, size, _) = self.place(path);
        let mut bytes = [0; 8];
        bytes[..size].copy_from_slice(&self.plc.memory()[offset..offset + size]);
        bytes
    }

    pub(crate) fn get(&self, path: &str) -> bool {
        self.bytes(path)[0] != 0
    }

    pub(crate) fn int(&self, path: &str) -> i64 {
        i64::from_le_bytes(self.bytes(path))
    }

    pub(crate) fn real(&self, path: &str) -> f64 {
        assert_eq!(self.place(path).2, Some(ElementaryType::Lreal), "{path}");
        f64::from_le_bytes(self.bytes(path))
    }

    pub(crate) fn position(&self) -> f64 {
        self.real("X.SetPosition")
    }

    pub(crate) fn velocity(&self) -> f64 {
        self.real("X.SetVelocity")
    }

    pub(crate) fn acceleration(&self) -> f64 {
        self.real("X.SetAcceleration")
    }

    /// The one state that `MC_ReadStatus` shows of the axis.
    pub(crate) fn state_of(&self, reader: &str) -> State {
        let shown: Vec<_> = State::ALL.into_iter().filter(|state| self.get(&format!("{reader}.{state:?}"))).collect();
        assert_eq!(shown.len(), 1, "{shown:?}");
        shown[0]
    }

    /// As `state_of`, after what was called later in the scan.
    pub(crate) fn state(&self) -> State {
        State::ALL[usize::try_from(self.int("X.State")).expect("small")]
    }

    /// A command with a rising edge in the next scan: its values, and `Execute`.
    pub(crate) fn start(&mut self, block: &str, values: &[(&str, f64)]) {
        for (name, value) in values {
            let path = format!("{block}.{name}");
            match self.place(&path).2 {
                Some(ElementaryType::Lreal) => self.set_real(&path, *value),
                _ => self.set_int(&path, *value as i64),
            }
        }
        self.set(&format!("{block}.Execute"), true);
    }

    /// Scans until `output` is TRUE.
    pub(crate) fn until(&mut self, output: &str) {
        for _ in 0..20_000 {
            if self.get(output) {
                return;
            }
            self.scan();
        }
        panic!("{output} stays FALSE");
    }

    /// A PLC with the state of this one, which goes on from here.
    pub(crate) fn resumed(&self, application: &Application) -> Self {
        let mut bench = Self { now_ns: self.now_ns, step_ns: self.step_ns, ..Self::on(application) };
        bench.plc.restore(&self.plc.save()).expect("its own state");
        bench
    }

    /// The state of the PLC as bytes.
    pub(crate) fn memory(&self) -> &[u8] {
        self.plc.memory()
    }
}
