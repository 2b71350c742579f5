//! The program as a user types it: commands, files, messages, exit codes.

mod check;
mod checkpoint;
mod compare;
mod configuration;
mod control;
mod coverage;
mod errors;
mod expectations;
mod faults;
mod freewheel;
mod help;
mod instrument;
mod plant;
mod plc;
mod plc_faults;
mod plc_peers;
mod plc_untrusted;
mod run;
mod third_party;
mod typed;
