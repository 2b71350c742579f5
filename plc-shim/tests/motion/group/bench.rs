//! A group `G` of axes `A[1]` to `A[6]`, and every block of coordinated motion.

use onescan_iec_run::Application;

use crate::bench::{Bench, State};

/// Blocks on the group, each called once in a scan.
const BLOCKS: [(&str, &str); 24] = [
    ("Enable", "MC_GroupEnable"),
    ("Disable", "MC_GroupDisable"),
    ("Reset", "MC_GroupReset"),
    ("Remove", "MC_RemoveAxisFromGroup"),
    ("Ungroup", "MC_UngroupAllAxes"),
    ("Kin", "MC_SetKinTransform"),
    ("Cartesian", "MC_SetCartesianTransform"),
    ("Override", "MC_GroupSetOverride"),
    ("Home", "MC_GroupHome"),
    ("Linear", "MC_MoveLinearAbsolute"),
    ("Linear2", "MC_MoveLinearAbsolute"),
    ("Linear3", "MC_MoveLinearAbsolute"),
    ("Relative", "MC_MoveLinearRelative"),
    ("Circular", "MC_MoveCircularAbsolute"),
    ("CircularRelative", "MC_MoveCircularRelative"),
    ("Direct", "MC_MoveDirectAbsolute"),
    ("DirectRelative", "MC_MoveDirectRelative"),
    ("Stop", "MC_GroupStop"),
    ("Halt", "MC_GroupHalt"),
    ("Interrupt", "MC_GroupInterrupt"),
    ("GoOn", "MC_GroupContinue"),
    ("Status", "MC_GroupReadStatus"),
    ("ReadPosition", "MC_GroupReadActualPosition"),
    ("ReadVelocity", "MC_GroupReadActualVelocity"),
];

fn program() -> String {
    let declared: String = BLOCKS.iter().map(|(name, block)| format!("    {name} : {block};\n")).collect();
    let called: String = BLOCKS.iter().map(|(name, _)| format!("    {name}(AxesGroup := G);\n")).collect();
    format!(
        "PROGRAM P\nVAR\n    A : ARRAY [1..6] OF AXIS_REF;\n    G : AXES_GROUP_REF;\n    \
         Power : ARRAY [1..6] OF MC_Power;\n    Add : ARRAY [1..6] OF MC_AddAxisToGroup;\n    \
         ReadError : MC_GroupReadError;\n    Single : MC_MoveAbsolute;\n    AxisStop : MC_Stop;\n{declared}    i : INT;\n\
         END_VAR\n    FOR i := 1 TO 6 DO\n        Power[i](Axis := A[i]);\n        \
         Add[i](AxesGroup := G, Axis := A[i], IdentInGroup := i);\n    END_FOR;\n{called}    \
         ReadError(AxesGroup := G, Enable := TRUE);\n    Single(Axis := A[2]);\n    AxisStop(Axis := A[1]);\nEND_PROGRAM\n"
    )
}

/// The states of a group, in the order of `ONESCAN_GROUP_STATE`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum GroupState {
    Disabled,
    Standby,
    Moving,
    Homing,
    Stopping,
    ErrorStop,
}

impl GroupState {
    pub(super) const ALL: [Self; 6] =
        [Self::Disabled, Self::Standby, Self::Moving, Self::Homing, Self::Stopping, Self::ErrorStop];
}

/// Buffer modes and transitions by their numbers.
pub(super) const BUFFERED: f64 = 1.0;
pub(super) const BLENDING_LOW: f64 = 2.0;
pub(super) const BLENDING_PREVIOUS: f64 = 3.0;
pub(super) const CONSTANT_VELOCITY: f64 = 2.0;
pub(super) const START_VELOCITY: f64 = 1.0;
pub(super) const CORNER_DISTANCE: f64 = 3.0;
pub(super) const CORNER_DEVIATION: f64 = 4.0;

pub(super) fn application() -> &'static Application {
    static APPLICATION: std::sync::OnceLock<Application> = std::sync::OnceLock::new();
    APPLICATION.get_or_init(|| match Application::from_sources([("group.st", program())]) {
        Ok(application) => application,
        Err(diagnostics) => panic!("{diagnostics}"),
    })
}

/// A group of the first `axes` axes, disabled.
pub(super) fn disabled(axes: usize) -> Bench {
    let mut bench = Bench::on(application());
    for k in 1..=axes {
        bench.set(&format!("Power[{k}].Enable"), true);
        bench.set(&format!("Add[{k}].Execute"), true);
        for (limit, value) in [("MaxVelocity", 2.0), ("MaxAcceleration", 20.0), ("MaxDeceleration", 20.0)] {
            bench.set_real(&format!("A[{k}].{limit}"), value);
        }
    }
    bench.set("Status.Enable", true);
    bench.set("ReadPosition.Enable", true);
    bench.set("ReadVelocity.Enable", true);
    bench.scan();
    assert_eq!(state(&bench), GroupState::Disabled);
    bench
}

/// The same, in Standby.
pub(super) fn standby(axes: usize) -> Bench {
    let mut bench = disabled(axes);
    bench.set("Enable.Execute", true);
    bench.scan();
    assert_eq!(state(&bench), GroupState::Standby);
    bench
}

pub(super) fn state(bench: &Bench) -> GroupState {
    GroupState::ALL[usize::try_from(bench.int("G.State")).expect("small")]
}

pub(super) fn axis_state(bench: &Bench, axis: usize) -> State {
    State::ALL[usize::try_from(bench.int(&format!("A[{axis}].State"))).expect("small")]
}

/// Sets the six values of an input, with zeros behind.
pub(super) fn six(bench: &mut Bench, input: &str, values: &[f64]) {
    for k in 0..6 {
        bench.set_real(&format!("{input}[{}]", k + 1), values.get(k).copied().unwrap_or(0.0));
    }
}

/// A line with these dynamics, at the next scan.
pub(super) fn line(bench: &mut Bench, block: &str, to: &[f64], values: &[(&str, f64)]) {
    let input = if block.contains("Relative") { "Distance" } else { "Position" };
    six(bench, &format!("{block}.{input}"), to);
    bench.start(block, values);
}

/// Set positions of the first three axes.
pub(super) fn place(bench: &Bench) -> [f64; 3] {
    [1, 2, 3].map(|k| bench.real(&format!("A[{k}].SetPosition")))
}

pub(super) fn velocity(bench: &Bench) -> [f64; 3] {
    [1, 2, 3].map(|k| bench.real(&format!("A[{k}].SetVelocity")))
}

pub(super) fn norm(vector: [f64; 3]) -> f64 {
    vector.iter().map(|each| each * each).sum::<f64>().sqrt()
}

pub(super) fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    norm([a[0] - b[0], a[1] - b[1], a[2] - b[2]])
}

/// How far a point is from the line between two others.
pub(super) fn off_line(point: [f64; 3], from: [f64; 3], to: [f64; 3]) -> f64 {
    let way = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
    let length = norm(way);
    let along: f64 = (0..3).map(|k| (point[k] - from[k]) * way[k]).sum::<f64>() / (length * length);
    let along = if length == 0.0 { 0.0 } else { along.clamp(0.0, 1.0) };
    apart(point, [0, 1, 2].map(|k| from[k] + along * way[k]))
}

/// Places until `output` is TRUE, scan by scan.
pub(super) fn trace(bench: &mut Bench, output: &str) -> Vec<[f64; 3]> {
    let mut places = vec![place(bench)];
    for _ in 0..60_000 {
        if bench.get(output) {
            return places;
        }
        bench.scan();
        places.push(place(bench));
    }
    panic!("{output} stays FALSE");
}
