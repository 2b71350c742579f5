//! An instrumented PLC as a client: a gateway in between, which grants steps.

use onescan_iec_run::SoftPlc;
use onescan_server::client::{Client, ClientFault, JoinRequest, StateError, Wake};
use onescan_server::time::VirtualTime;
use onescan_soft_plc::Bindings;

const MS: u64 = 1_000_000;

/// A gateway to an instrumented PLC that goes through cycles of its own.
pub(crate) struct Granted {
    request: JoinRequest,
    bindings: Bindings,
    plc: SoftPlc,
    /// What stands before the names of the shim's variables.
    prefix: &'static str,
    /// The PLC's own clock.
    own_ns: u64,
    session: u32,
    grant: u32,
}

impl Granted {
    /// A PLC that has not been started, with what it takes part in.
    pub(crate) fn new(plc: SoftPlc, bindings: Bindings, request: JoinRequest, prefix: &'static str) -> Self {
        Self { request, bindings, plc, prefix, own_ns: 0, session: 0, grant: 0 }
    }

    fn write(&mut self, word: &str, bytes: &[u8]) {
        let variable = self.plc.variable(&format!("{}{word}", self.prefix)).expect("it exists");
        self.plc.memory_mut()[variable.offset as usize..][..bytes.len()].copy_from_slice(bytes);
    }

    fn number(&self, word: &str) -> u32 {
        let variable = self.plc.variable(&format!("{}{word}", self.prefix)).expect("it exists");
        let bytes = &self.plc.memory()[variable.offset as usize..][..4];
        u32::from_le_bytes(bytes.try_into().expect("four bytes"))
    }

    fn cycle(&mut self) {
        self.own_ns += MS;
        self.plc.scan(onescan_iec::VirtualTime::from_nanos(self.own_ns)).expect("no fault");
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

impl Client for Granted {
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
