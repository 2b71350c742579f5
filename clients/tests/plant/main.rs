//! The plant as a client, driven turn by turn without a session around it.

mod arm;
mod arrays;
mod belt;
mod bench;
mod components;
mod constants;
mod couplings;
mod drives;
mod failures;
mod faults;
mod fittings;
mod friction;
mod guided;
mod handling;
mod holding;
mod kiln_scanner;
mod measuring;
mod mechanism;
mod meshes;
mod motion;
mod own_kinds;
mod robots;
mod robustness;
mod sensors;
mod shear;
mod state;
