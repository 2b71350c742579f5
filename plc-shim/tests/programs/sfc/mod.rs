//! Sequential Function Charts (2nd ed. 2.6, 3rd ed. 6.7).

pub(crate) mod chart;
pub(crate) mod drawn;
mod evolution;
mod findings;
mod interpret;
pub(crate) mod plcopen;
mod random;
mod running;
mod timing;
