//! The program as a user types it: commands, files, messages, exit codes.

mod cases;
mod check;
mod checkpoint;
mod configuration;
mod control;
mod coverage;
mod errors;
mod expectations;
mod faults;
mod filling_machine;
mod freewheel;
mod help;
mod instrument;
mod new;
mod plant;
mod plc_faults;
mod python;
mod regression;
mod reports;
mod review;
mod run;
mod third_party;
mod typed;
mod unit_tests;
mod watch;
mod wiring;
