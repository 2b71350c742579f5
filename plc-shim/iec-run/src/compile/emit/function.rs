//! One unit to one function.

use wasm_encoder::Function;

use super::emitter::{Emitter, Shared, value_type};
use crate::compile::analyse::Address;
use crate::compile::fault::{Mark, Unit};
use onescan_iec::ir::{Pou, PouId};

/// A function's code and what its instructions stand for.
pub(crate) struct Made {
    pub(crate) body: Function,
    pub(crate) marks: Vec<(u32, Mark)>,
    pub(crate) units: Vec<Unit>,
}

/// The function of a unit. A program with one instance only is given its address.
pub(crate) fn unit(shared: &mut Shared<'_>, id: PouId, pou: &Pou, instance: Option<u32>) -> Made {
    let parameters = pou.registers.iter().take(pou.parameters as usize).map(|ty| value_type(*ty)).collect();
    let mut emitter = Emitter::new(shared, parameters);
    emitter.enter(id, pou, pou.parameters, None);
    if let Some(offset) = instance {
        emitter.runs_on(Address::absolute(offset));
    }
    emitter.body(pou);
    let (body, marks, units) = emitter.finish(id);
    Made { body, marks, units }
}
