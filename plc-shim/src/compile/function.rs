//! One unit to one function.

use wasm_encoder::Function;

use super::address::Address;
use super::emitter::{Emitter, Shared, value_type};
use super::fault::{Mark, Unit};
use super::place::INSTANCE;
use crate::ir::{Pou, PouId};

/// A function's code and what its instructions stand for.
pub(super) struct Made {
    pub(super) body: Function,
    pub(super) marks: Vec<(u32, Mark)>,
    pub(super) units: Vec<Unit>,
}

/// The function of a unit. A program with one instance only is given its address.
pub(super) fn unit(shared: &mut Shared<'_>, id: PouId, pou: &Pou, instance: Option<u32>) -> Made {
    let parameters = pou.registers.iter().take(pou.parameters as usize).map(|ty| value_type(*ty)).collect();
    let mut emitter = Emitter::new(shared, parameters);
    emitter.enter(id, pou, pou.parameters, None);
    if let (Some(offset), Some(frame)) = (instance, emitter.frames.last_mut()) {
        frame.pointers.insert(INSTANCE, Address::absolute(offset));
    }
    emitter.body(pou);
    let (body, marks, units) = emitter.finish(id);
    Made { body, marks, units }
}
