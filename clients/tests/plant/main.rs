//! The plant as a client, driven turn by turn without a session around it.

mod arrays;
mod belt;
mod bench;
mod components;
mod constants;
mod failures;
mod faults;
mod friction;
mod handling;
mod holding;
mod measuring;
mod meshes;
mod motion;
mod robots;
mod robustness;
mod sensors;
mod shear;
mod state;
