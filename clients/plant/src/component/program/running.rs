//! A function block at work: inputs in, one scan, outputs out.

use onescan_iec::VirtualTime;
use onescan_iec_run::Application;
use onescan_iec_run::{FaultSite, PlcFault, SoftPlc};
use onescan_server::client::{ClientFault, SourcePlace};

use super::ProgramError;
use super::interface::Interface;
use super::socket::Socket;
use crate::component::behaviour::{Compiled, Running, StateError, Surroundings};
use crate::component::declare::Value;
use crate::component::kind::{Kind, Setting};
use crate::effort::{Effort, Motion};
use crate::world::World;

/// All that is written before a block runs and read afterwards.
pub(super) struct Sockets {
    pub(super) inputs: Vec<Socket>,
    pub(super) outputs: Vec<Socket>,
    /// One for each failure mode.
    pub(super) failures: Vec<Socket>,
    /// The period of the plant.
    pub(super) period: Option<Socket>,
}

impl Sockets {
    /// Those of a block in its program.
    ///
    /// # Errors
    /// None for an interface that was read out of the same file.
    pub(super) fn find(application: &Application, interface: &Interface) -> Result<Self, ProgramError> {
        let one = |name: &str| Socket::find(application, name, |cause, hint| interface.wrong(name, cause, hint));
        let each = |names: Vec<&str>| names.into_iter().map(one).collect::<Result<Vec<_>, _>>();
        let kind = &interface.kind;
        Ok(Self {
            inputs: each(kind.inputs.iter().map(|input| &*input.key).collect())?,
            outputs: each(kind.outputs.iter().map(|output| &*output.key).collect())?,
            failures: each(interface.failing.iter().map(String::as_str).collect())?,
            period: interface.period.as_deref().map(one).transpose()?,
        })
    }
}

/// A block with its memory.
pub(super) struct Block {
    plc: SoftPlc,
    sockets: Sockets,
    kind: Kind,
}

impl Block {
    pub(super) fn new(plc: SoftPlc, sockets: Sockets, kind: Kind) -> Self {
        Self { plc, sockets, kind }
    }

    /// Writes what the block is to see in this turn.
    fn feed(&mut self, inputs: &[Value], around: &Surroundings<'_>) -> Result<(), ClientFault> {
        let Self { plc, sockets, kind } = self;
        let memory = plc.memory_mut();
        for ((socket, value), input) in sockets.inputs.iter().zip(inputs).zip(&kind.inputs) {
            if !socket.set(memory, *value) {
                let value = value.setting().map_or_else(|| "a line of bytes".to_owned(), |value| value.to_string());
                return Err(ClientFault::new(format!("its input `{}` cannot be {value}", input.key)));
            }
        }
        for (mode, socket) in sockets.failures.iter().enumerate() {
            let failed = Value::Bool(around.failed.0 & (1 << mode) != 0);
            if !socket.set(memory, failed) {
                return Err(ClientFault::new("a failure mode of it is not BOOL"));
            }
        }
        match sockets.period {
            Some(socket) if !socket.set(memory, Value::Number(around.dt_s)) => {
                Err(ClientFault::new("its `dt_s` is not a number"))
            }
            _ => Ok(()),
        }
    }

    /// Its outputs as they are.
    fn outputs(&self) -> impl Iterator<Item = Value> {
        let memory = self.plc.memory();
        let each = self.sockets.outputs.iter().zip(&self.kind.outputs);
        // a socket of another type was refused when the kind was read
        each.map(|(socket, output)| socket.get(memory).unwrap_or(Value::zero(output.values)))
    }
}

/// The fault without the program around the block, which is not the user's.
fn reported(fault: &PlcFault) -> ClientFault {
    let FaultSite { pou, part, file, line, column, .. } = &fault.at;
    let part = if part.is_empty() { String::new() } else { format!(", {part}") };
    let place = SourcePlace { file: file.clone(), line: *line, column: *column };
    ClientFault { message: format!("{} in {pou}{part}", fault.kind), place: Some(place) }
}

impl Running for Block {
    fn drive(&mut self, inputs: &[Value], around: &Surroundings<'_>, _: &mut World) -> Result<(), ClientFault> {
        self.feed(inputs, around)?;
        self.plc.scan(VirtualTime::from_nanos(around.t_v_ns)).map_err(|fault| reported(&fault))?;
        for (value, output) in self.outputs().zip(&self.kind.outputs) {
            if let Value::Number(number) = value
                && !number.is_finite()
            {
                return Err(ClientFault::new(format!("its output `{}` is {number}, which is not finite", output.key)));
            }
        }
        Ok(())
    }

    fn sense(&mut self, _: &[Value], _: &Surroundings<'_>, _: &World, outputs: &mut Vec<Value>) {
        outputs.clear();
        outputs.extend(self.outputs());
    }

    fn drive_number(&self) -> Option<usize> {
        None
    }

    fn longest_s(&self) -> f64 {
        f64::INFINITY
    }

    fn advance(&mut self, _: Motion, _: f64) -> Effort {
        Effort::of(0.0)
    }

    fn foresee(&self, _: Motion, _: f64) -> Effort {
        Effort::of(0.0)
    }

    fn tune(&mut self, _: &[Setting]) -> Result<(), Compiled> {
        Err(Compiled)
    }

    fn save(&self) -> postcard::Result<Vec<u8>> {
        Ok(self.plc.save())
    }

    fn check(&self, bytes: &[u8]) -> Result<(), StateError> {
        Ok(self.plc.check_state(bytes)?)
    }

    fn restore(&mut self, bytes: &[u8]) -> Result<(), StateError> {
        Ok(self.plc.restore(bytes)?)
    }
}
