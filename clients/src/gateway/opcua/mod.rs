//! Variables of an OPC UA server (IEC 62541).
//!
//! | module | subject |
//! |---|---|
//! | [`options`] | security policy, user, certificates, namespace |
//! | [`pki`] | the folder for certificates |
//! | [`value`] | packed values as Variants |
//! | [`connection`] | a session with the server, and what it says when there is none |
//! | [`browse`] | the variables that there are |
//! | [`link`] | one Write and one Read for all points |

pub mod browse;
pub mod connection;
pub mod link;
pub mod options;
pub mod pki;
pub mod value;

pub use link::OpcUaLink;
pub use options::Options;
