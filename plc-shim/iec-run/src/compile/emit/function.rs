//! One unit to one function.

use super::emitter::{Emitter, Made, Shared, value_type};
use crate::compile::analyse::Address;
use onescan_iec::ir::{Pou, PouId};

/// The function of a unit. A program with one instance only is given its address.
pub(crate) fn unit(shared: &mut Shared<'_>, id: PouId, pou: &Pou, instance: Option<u32>) -> Made {
    let parameters = pou.registers.iter().take(pou.parameters as usize).map(|ty| value_type(*ty)).collect();
    let mut emitter = Emitter::new(shared, parameters);
    emitter.enter(id, pou, pou.parameters, None);
    if let Some(offset) = instance {
        emitter.runs_on(Address::absolute(offset));
    }
    emitter.body(pou);
    emitter.finish(id)
}
