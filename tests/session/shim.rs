//! The shear with an instrumented PLC: a gateway in between, and the same digest.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use onescan::scenario::Scenario;
use onescan::scenario::compose::Member;
use onescan_clients::soft_plc::{Bindings, bind};
use onescan_plc_shim::input::kind::SourceKind;
use onescan_plc_shim::instrument::{Options, instrument};
use onescan_plc_shim::{Application, Input, SoftPlc, Task, TaskPlan};
use onescan_server::client::{Client, ClientFault, JoinRequest, StateError, Wake};
use onescan_server::signal::SignalDecl;
use onescan_server::time::VirtualTime;
use onescan_tests::run::{in_process, run};
use onescan_tests::{at_ms, client};

const MS: u64 = 1_000_000;

/// A gateway to an instrumented PLC that goes through cycles of its own.
struct Gateway {
    request: JoinRequest,
    bindings: Bindings,
    plc: SoftPlc,
    /// The PLC's own clock.
    own_ns: u64,
    session: u32,
    grant: u32,
}

impl Gateway {
    fn write(&mut self, path: &str, bytes: &[u8]) {
        let variable = self.plc.variable(path).expect("it exists");
        self.plc.memory_mut()[variable.offset as usize..][..bytes.len()].copy_from_slice(bytes);
    }

    fn number(&self, path: &str) -> u32 {
        let variable = self.plc.variable(path).expect("it exists");
        let bytes = &self.plc.memory()[variable.offset as usize..][..4];
        u32::from_le_bytes(bytes.try_into().expect("four bytes"))
    }

    fn cycle(&mut self) {
        self.own_ns += MS;
        self.plc.scan(onescan_plc_shim::VirtualTime::from_ns(self.own_ns)).expect("no fault");
    }

    fn grant(&mut self, t_v: VirtualTime) {
        self.write("SDSP_Session", &self.session.to_le_bytes());
        self.write("SDSP_TV", &t_v.as_nanos().to_le_bytes());
        self.write("SDSP_Grant", &self.grant.to_le_bytes());
        for _ in 0..100 {
            self.cycle();
            if self.number("SDSP_Joined") == self.session && self.number("SDSP_Done") == self.grant {
                return;
            }
        }
        panic!("the grant is not done; the PLC answers {}", self.number("SDSP_Answer") as u16);
    }

    fn take_outputs(&self, outputs: &mut [u8]) {
        let mut port = 0;
        for bound in &self.bindings.outputs {
            let (size, offset) = (bound.port.ty.size(), bound.places[0].offset);
            outputs[port..port + size].copy_from_slice(&self.plc.memory()[offset..offset + size]);
            port += size;
        }
    }
}

impl Client for Gateway {
    fn join(&self) -> JoinRequest {
        self.request.clone()
    }

    fn setup(&mut self, outputs: &mut [u8]) -> Result<(), ClientFault> {
        self.plc.cold_start();
        (self.own_ns, self.session) = (0, self.grant + 1);
        self.grant = self.session;
        self.write("SDSP_Limit", &u32::MAX.to_le_bytes());
        self.grant(VirtualTime::ZERO);
        self.take_outputs(outputs);
        Ok(())
    }

    fn turn(&mut self, t_v: VirtualTime, inputs: &[u8], outputs: &mut [u8]) -> Result<Wake, ClientFault> {
        let mut port = 0;
        for bound in self.bindings.inputs.clone() {
            let size = bound.port.ty.size();
            for offset in bound.places.iter().map(|place| place.offset) {
                self.plc.memory_mut()[offset..offset + size].copy_from_slice(&inputs[port..port + size]);
            }
            port += size;
        }
        self.grant += 1;
        self.grant(t_v);
        // The PLC does not wait for its gateway.
        (0..t_v.as_nanos() / MS % 3).for_each(|_| self.cycle());
        self.take_outputs(outputs);
        Ok(Wake::At(t_v + self.request.period))
    }

    fn save(&self) -> Result<Vec<u8>, StateError> {
        Ok(self.plc.save())
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), StateError> {
        self.plc.restore(state).map_err(|error| StateError::Corrupt(error.to_string()))
    }
}

fn shear_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/shear")
}

fn member(scenario: &Scenario, name: &str) -> Box<dyn Client> {
    match scenario.member(&client(name)).expect("it has this client") {
        Member::Plant(client) | Member::Plc(client) | Member::Gateway(client) => client,
        Member::External(_) | Member::Seated { .. } => panic!("no client of the shear is external"),
    }
}

fn gateway(plc_folder: &Path, signals: &[SignalDecl], request: JoinRequest) -> Gateway {
    let task = |name: &str, interval_ms: u64, priority: u32, programs: &[&str]| Task {
        name: name.to_owned(),
        interval_ns: interval_ms * MS,
        priority,
        programs: programs.iter().map(|program| (*program).to_owned()).collect(),
        ..Task::default()
    };
    let tasks = vec![task("main", 10, 0, &["Shear", "Alignment"])];
    let sources = ["shear.st", "alignment.st"].map(|name| {
        Input::from_text(name, SourceKind::Text, std::fs::read_to_string(plc_folder.join(name)).expect("a source"))
    });
    let project = instrument(&sources, &Options { tasks: Some(tasks), ..Options::default() }).expect("it is right");
    let files = project.files.into_iter().map(|file| (file.name, file.text.expect("a text")));
    let application = Application::from_sources(files).expect("it compiles");
    let own =
        TaskPlan::new(vec![task("sdsp", 1, 0, &["SDSP_Scheduler"]), task("programs", 2, 1, &["Shear", "Alignment"])]);
    let plc = SoftPlc::new(&application, &own).expect("the plan suits");
    let bindings = bind(&application, &client("plc"), signals, &BTreeMap::new()).expect("all signals have a variable");
    Gateway { request, bindings, plc, own_ns: 0, session: 0, grant: 0 }
}

/// The digest of the scenario in a folder with its own PLC, and with the instrumented one.
fn digests(folder: &Path) -> [String; 2] {
    let scenario = Scenario::load(folder).expect("it is a scenario");
    let digest = |plc: Box<dyn Client>| {
        let lockstep = in_process(scenario.plan().clone(), [member(&scenario, "plant"), plc]);
        run(lockstep, at_ms(3_000)).digest.expect("it ran").to_string()
    };
    let plain = digest(member(&scenario, "plc"));
    let request = member(&scenario, "plc").join();
    [plain, digest(Box::new(gateway(&folder.join("plc"), scenario.plan().signals(), request)))]
}

#[test]
fn the_instrumented_shear_has_the_digest_of_the_shear() {
    let [plain, instrumented] = digests(&shear_folder());
    assert_eq!(instrumented, plain);
}

#[test]
fn the_shear_as_a_chart_has_the_same_digest_instrumented() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("plc")).expect("a folder");
    for file in ["scenario.toml", "plant.toml", "plc/alignment.st"] {
        std::fs::copy(shear_folder().join(file), folder.path().join(file)).expect("a copy");
    }
    let chart = include_str!("shear_chart.st");
    std::fs::write(folder.path().join("plc/shear.st"), chart).expect("a file");
    let [plain, instrumented] = digests(folder.path());
    assert_eq!(instrumented, plain);
    assert_ne!(plain, digests(&shear_folder())[0], "it is the chart that ran");
    insta::assert_snapshot!(plain);
}
