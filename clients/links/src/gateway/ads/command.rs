//! Numbers of ADS (Beckhoff: TC3 ADS introduction, ADS commands, index groups, return codes).

pub const READ_DEVICE_INFO: u16 = 1;
/// Reads a length at a group and an offset.
pub const READ: u16 = 2;
/// Writes at a group and an offset.
pub const WRITE: u16 = 3;
/// The state of the device.
pub const READ_STATE: u16 = 4;
pub const WRITE_CONTROL: u16 = 5;
/// Writes, then reads: a call of the service that the group is.
pub const READ_WRITE: u16 = 9;

/// Group: a name is written, its handle read.
pub const HANDLE_BY_NAME: u32 = 0xF003;
/// Group: the value of the handle that the offset is.
pub const VALUE_BY_HANDLE: u32 = 0xF005;
/// Group: the handle that is written is no longer needed.
pub const RELEASE_HANDLE: u32 = 0xF006;
/// Group: a name is written, its entry in the table of symbols read.
pub const INFO_BY_NAME_EX: u32 = 0xF009;
/// Group: the table of symbols.
pub const SYMBOL_UPLOAD: u32 = 0xF00B;
/// Group: how long the tables of data types is; there is none where the device has elementary types only.
pub const TYPE_UPLOAD: u32 = 0xF00E;
/// Group: how many symbols there are, and how many bytes their table has; then the same of data types.
pub const UPLOAD_INFO_2: u32 = 0xF00F;
/// Group: many reads as one; the offset is their count.
pub const SUM_READ: u32 = 0xF080;
/// Group: the same, and each part is answered with its length.
pub const SUM_READ_EX: u32 = 0xF083;
/// Group: many writes as one.
pub const SUM_WRITE: u32 = 0xF081;

/// Most parts of a sum command: the device works them off in one go, between two cycles.
pub const SUM_MAX: usize = 500;

/// Return code: nobody listens at the AMS port.
pub const NO_PORT: u32 = 0x006;
/// Return code: no route to the device.
pub const NO_ROUTE: u32 = 0x007;
/// Return code: the device knows no such service.
pub const NOT_SUPPORTED: u32 = 0x701;
/// Return code: there is no such index group.
pub const BAD_GROUP: u32 = 0x702;
/// Return code: there is no such index offset.
pub const BAD_OFFSET: u32 = 0x703;
/// Return code: it must not be read or written.
pub const NO_ACCESS: u32 = 0x704;
/// Return code: not as many bytes as the symbol has.
pub const BAD_SIZE: u32 = 0x705;
/// Return code: bytes that are not a request.
pub const BAD_DATA: u32 = 0x706;
/// Return code: there is no such symbol.
pub const NO_SYMBOL: u32 = 0x710;

/// State: the program runs.
pub const RUN: u16 = 5;
/// State: it does not.
pub const STOP: u16 = 6;
/// State to write: a start, which keeps RETAIN.
pub const RESET: u16 = 2;

/// What a return code says, for people.
pub fn meaning(code: u32) -> &'static str {
    match code {
        NO_PORT => "nobody listens at this AMS port: does the PLC's runtime run?",
        NO_ROUTE => "the device is not known to the router: is the AMS NetId right, is there a route?",
        0x00D => "the AMS port is not connected",
        0x00F => "no such AMS NetId",
        0x018 => "the port is disabled: the TwinCAT system is not started",
        NOT_SUPPORTED => "the device does not know this service",
        BAD_GROUP => "no such index group",
        BAD_OFFSET => "no such index offset",
        NO_ACCESS => "access is not permitted",
        BAD_SIZE => "its size is another",
        BAD_DATA => "wrong data",
        0x707 => "the device is not ready",
        0x708 => "the device is busy",
        NO_SYMBOL => "no such symbol",
        0x711 => "the symbol's version has changed: the program was downloaded again",
        0x712 => "the device is in a state in which it cannot",
        0x745 => "its time is up",
        _ => "see Beckhoff, ADS return codes",
    }
}

/// A state's name.
pub fn state_name(state: u16) -> &'static str {
    const NAMES: [&str; 17] = [
        "INVALID",
        "IDLE",
        "RESET",
        "INIT",
        "START",
        "RUN",
        "STOP",
        "SAVECFG",
        "LOADCFG",
        "POWERFAILURE",
        "POWERGOOD",
        "ERROR",
        "SHUTDOWN",
        "SUSPEND",
        "RESUME",
        "CONFIG",
        "RECONFIG",
    ];
    NAMES.get(usize::from(state)).copied().unwrap_or("unknown")
}
