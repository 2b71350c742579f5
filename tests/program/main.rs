//! The program as a user types it: commands, files, messages, exit codes.

mod check;
mod checkpoint;
mod configuration;
mod control;
mod coverage;
mod diff;
mod errors;
mod expectations;
mod faults;
mod filling_machine;
mod freewheel;
mod help;
mod instrument;
mod new;
mod operator;
mod plant;
mod plc_faults;
mod python;
mod recording;
mod run;
mod third_party;
mod typed;
mod venv;
mod watch;
mod wiring;
