//! The ports of a soft PLC as `scenario.toml` has them.

use onescan_server::signal::SignalName;
use schemars::JsonSchema;
use serde::Deserialize;

use crate::form::Name;

/// One `[clients.NAME.ports.PORT]`: a line of bytes to a device.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PortFile {
    /// The signal `BYTES[n]` that it reads: what the device sends.
    #[schemars(with = "Name")]
    pub receive: SignalName,
    /// The signal `BYTES[n]` that it writes; the PLC is its writer.
    #[schemars(with = "Name")]
    pub transmit: SignalName,
    /// A terminal with a process image of 22 bytes.
    #[serde(default)]
    pub serial: Option<SerialFile>,
    /// A connection that the program begins.
    #[serde(default)]
    pub tcp: Option<TcpFile>,
}

/// A serial terminal.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SerialFile {
    /// Bits in a second; 9600 if absent.
    #[serde(default)]
    pub baud: Option<u32>,
    /// Bits of a byte with its start, parity and stop bits; 10, as for 8N1, if absent.
    #[serde(default)]
    pub bits_per_byte: Option<u32>,
    /// The terminal: EL6001, EL6021, KL6001, KL6011, KL6021, KL6031 or KL6041; EL6021 if absent.
    #[serde(default)]
    pub terminal: Option<String>,
    /// Bytes that it keeps until the program takes them; those of the terminal if absent.
    #[serde(default)]
    pub receive_buffer: Option<u32>,
    /// Path of the variable that is the input of its process image, as `GVL.In`.
    #[serde(default)]
    pub input: Option<String>,
    /// Path of the variable that is its output.
    #[serde(default)]
    pub output: Option<String>,
    /// In place of a terminal with a process image: the hardware identifier of a communication module, as the program's blocks
    /// have it.
    #[serde(default)]
    pub module: Option<u16>,
}

/// A connection of TCP.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TcpFile {
    /// Whom it reaches, as the program says it: `192.168.42.30:2727`.
    pub address: String,
    /// Each message is cut once, behind so many bytes; the rest goes in the next turn.
    #[serde(default)]
    pub cut_behind: Option<u32>,
    /// Each message is cut into segments of so many bytes.
    #[serde(default)]
    pub cut_every: Option<u32>,
    /// Each message is cut once, at random by the scenario's seed.
    #[serde(default)]
    pub cut_at_random: bool,
}
