//! Variables of an OPC UA server (IEC 62541).
//!
//! | module | subject |
//! |---|---|
//! | [`options`] | security policy, user, certificates, namespace |
//! | [`value`] | packed values as Variants |
//! | [`connection`] | a session with the server, and what it says when there is none |
//! | [`browse`] | the variables that there are |
//! | [`link`] | one Write and one Read for all points |
//! | `absent` | what stands for all of this but the options without the feature `opcua` |

#[cfg(not(feature = "opcua"))]
mod absent;
#[cfg(feature = "opcua")]
pub mod browse;
#[cfg(feature = "opcua")]
pub mod connection;
#[cfg(feature = "opcua")]
pub mod link;
pub mod options;
#[cfg(feature = "opcua")]
pub mod value;

#[cfg(not(feature = "opcua"))]
pub use absent::OpcUaLink;
#[cfg(feature = "opcua")]
pub use link::OpcUaLink;
pub use options::Options;
