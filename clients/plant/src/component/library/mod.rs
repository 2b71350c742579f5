//! The kinds of component, a file each. This table is all that knows them.
//!
//! | group | subject |
//! |---|---|
//! | `actuator` | what moves, turns, carries, grips |
//! | `sensor` | what measures and detects |
//! | `process` | what is heated, filled, fed and taken away |
//! | `furnace` | what melts steel by an electric arc |
//! | `panel` | what people press and see |
//! | `logic` | what is computed beside the PLC |
//!
//! # A new kind
//! 1. Its file in its group: what it states of itself, its equations, its tests. The nearest kind is
//!    a good start; `own_types!` names its coupling.
//! 2. Its line in the table below.
//! 3. `UPDATE_DOCS=1 cargo test -p onescan-plant --lib` writes its page and its part of the
//!    schema; without the switch the same tests compare them.
//!
//! `cargo fmt` does not see files behind a macro: `rustfmt --edition 2024 FILE` formats a kind.

use std::sync::LazyLock;

use super::behaviour::{self, Built, Component, Conflict, Running};
use super::declare::{ParameterSet, SignalSet, Value};
use super::kind::{Kind, Setting};
use crate::coupling::Unbound;
use crate::model::Bound;
use crate::model::Mechanics;
use crate::world::World;

/// Makes a component of its settings, its seed and what it is bound to.
type Starter = fn(&[Setting], u64, &Bound, &Mechanics, &mut World) -> Result<Box<dyn Running>, Unbound>;

/// A kind in the table.
pub(crate) struct Entry {
    pub(crate) name: &'static str,
    pub(crate) kind: fn() -> Kind,
    /// A conflict between settings, one for each parameter.
    pub(crate) conflict: fn(&[Setting]) -> Option<Conflict>,
    /// A component with these settings, one for each parameter, a seed of its own and what it is
    /// bound to, in a world that still stands in the scene's pose.
    pub(crate) start: Starter,
    /// Whether an input, by its place, is of use with these settings.
    pub(crate) uses: fn(&[Setting], usize) -> bool,
    /// What the world is built with, of these settings.
    pub(crate) built: fn(&[Setting]) -> Built,
    /// What its inputs hold where nothing is connected.
    pub(crate) unconnected: fn() -> Vec<Value>,
    /// What holds for every kind, tried on this one.
    #[cfg(test)]
    pub(crate) laws: fn(),
}

fn conflict<C: Component>(settings: &[Setting]) -> Option<Conflict> {
    C::conflict(&C::Parameters::read(settings))
}

fn uses<C: Component>(settings: &[Setting], input: usize) -> bool {
    C::uses(&C::Parameters::read(settings), input)
}

fn built<C: Component>(settings: &[Setting]) -> Built {
    let component = C::new(C::Parameters::read(settings));
    Built { stops: component.stops(), ports: component.ports() }
}

fn start<C: Component>(
    settings: &[Setting],
    seed: u64,
    bound: &Bound,
    scene: &Mechanics,
    world: &mut World,
) -> Result<Box<dyn Running>, Unbound> {
    behaviour::run(C::new(C::Parameters::read(settings)), seed, bound, scene, world)
}

macro_rules! library {
    ($($group:ident { $($module:ident :: $component:ident),+ $(,)? })+) => {
        $( mod $group { $( pub(super) mod $module; )+ } )+

        /// Every kind, in the order of the documentation.
        pub(crate) const ENTRIES: &[Entry] = &[ $( $( Entry {
            name: <$group::$module::$component as Component>::NAME,
            kind: behaviour::kind::<$group::$module::$component>,
            conflict: conflict::<$group::$module::$component>,
            start: start::<$group::$module::$component>,
            uses: uses::<$group::$module::$component>,
            built: built::<$group::$module::$component>,
            unconnected: <$group::$module::$component as Component>::Inputs::unconnected,
            #[cfg(test)]
            laws: super::tests::laws::<$group::$module::$component>,
        }, )+ )+ ];
    };
}

library! {
    actuator {
        pneumatic_cylinder::PneumaticCylinder,
        hydraulic_cylinder::HydraulicCylinder,
        servo_axis::ServoAxis,
        command_axis::CommandAxis,
        force_drive::ForceDrive,
        torque_drive::TorqueDrive,
        asynchronous_motor::AsynchronousMotor,
        conveyor::Conveyor,
        arm::Arm,
        gripper::Gripper,
        vacuum_cup::VacuumCup,
        turntable::Turntable,
        spindle::Spindle,
        stopper::Stopper,
        lift_table::LiftTable,
        rack_feeder::RackFeeder,
    }
    sensor {
        light_barrier::LightBarrier,
        inductive_sensor::InductiveSensor,
        capacitive_sensor::CapacitiveSensor,
        limit_switch::LimitSwitch,
        incremental_encoder::IncrementalEncoder,
        absolute_encoder::AbsoluteEncoder,
        pressure_sensor::PressureSensor,
        temperature_sensor::TemperatureSensor,
        pyrometer::Pyrometer,
        infrared_scanner::InfraredScanner,
        contact_sensor::ContactSensor,
        collision_monitor::CollisionMonitor,
        line_scanner::LineScanner,
        camera::Camera,
        laser_distance::LaserDistance,
        axis_encoder::AxisEncoder,
        pose_sensor::PoseSensor,
        inclinometer::Inclinometer,
        accelerometer::Accelerometer,
        light_curtain::LightCurtain,
        barcode_reader::BarcodeReader,
        rfid_head::RfidHead,
        weighing_cell::WeighingCell,
    }
    process {
        tank::Tank,
        hydraulic_unit::HydraulicUnit,
        heater::Heater,
        workpiece_source::WorkpieceSource,
        workpiece_sink::WorkpieceSink,
        veneer_lathe::VeneerLathe,
        kiln_shell::KilnShell,
        kiln_heat::KilnHeat,
    }
    furnace {
        arc_circuit::ArcCircuit,
        electrode_mast::ElectrodeMast,
        arc_bath::ArcBath,
        cooled_panel::CooledPanel,
    }
    panel {
        push_button::PushButton,
        emergency_stop::EmergencyStop,
        lamp::Lamp,
        stack_light::StackLight,
        key_switch::KeySwitch,
        two_hand_station::TwoHandStation,
    }
    logic {
        input_controller::InputController,
        gate::Gate,
        loopback::Loopback,
    }
}

static KINDS: LazyLock<Vec<Kind>> = LazyLock::new(|| ENTRIES.iter().map(|entry| (entry.kind)()).collect());

/// Every kind of component in the library.
pub fn kinds() -> &'static [Kind] {
    &KINDS
}
