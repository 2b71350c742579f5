//! PLCopen's motion control as program text, and whose of it a program has.

/// Whose motion control a program has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    None,
    Plcopen,
    /// That of a project with files of TwinCAT: the same axis behind the names of `Tc2_MC2`.
    TwinCat,
}

/// Motion control (PLCopen, Function blocks for motion control, 2.0), for programs that name an axis.
pub const MOTION: [(&str, &str); 16] = [
    ("iec/motion/activate.st", include_str!("../../library/motion/activate.st")),
    ("iec/motion/axis.st", include_str!("../../library/motion/axis.st")),
    ("iec/motion/cam.st", include_str!("../../library/motion/cam.st")),
    ("iec/motion/command.st", include_str!("../../library/motion/command.st")),
    ("iec/motion/enumerations.st", include_str!("../../library/motion/enumerations.st")),
    ("iec/motion/gear.st", include_str!("../../library/motion/gear.st")),
    ("iec/motion/home.st", include_str!("../../library/motion/home.st")),
    ("iec/motion/move.st", include_str!("../../library/motion/move.st")),
    ("iec/motion/parameter.st", include_str!("../../library/motion/parameter.st")),
    ("iec/motion/power.st", include_str!("../../library/motion/power.st")),
    ("iec/motion/profile.st", include_str!("../../library/motion/profile.st")),
    ("iec/motion/status.st", include_str!("../../library/motion/status.st")),
    ("iec/motion/stop.st", include_str!("../../library/motion/stop.st")),
    ("iec/motion/superimposed.st", include_str!("../../library/motion/superimposed.st")),
    ("iec/motion/types.st", include_str!("../../library/motion/types.st")),
    ("iec/motion/velocity.st", include_str!("../../library/motion/velocity.st")),
];

/// Coordinated motion (part 4, 1.0), for programs that name a group of axes.
pub const GROUPS: [(&str, &str); 20] = [
    ("iec/motion/group/arm.st", include_str!("../../library/motion/group/arm.st")),
    ("iec/motion/group/build.st", include_str!("../../library/motion/group/build.st")),
    ("iec/motion/group/circular.st", include_str!("../../library/motion/group/circular.st")),
    ("iec/motion/group/curve.st", include_str!("../../library/motion/group/curve.st")),
    ("iec/motion/group/direct.st", include_str!("../../library/motion/group/direct.st")),
    ("iec/motion/group/enable.st", include_str!("../../library/motion/group/enable.st")),
    ("iec/motion/group/halt.st", include_str!("../../library/motion/group/halt.st")),
    ("iec/motion/group/home.st", include_str!("../../library/motion/group/home.st")),
    ("iec/motion/group/kinematics.st", include_str!("../../library/motion/group/kinematics.st")),
    ("iec/motion/group/linear.st", include_str!("../../library/motion/group/linear.st")),
    ("iec/motion/group/members.st", include_str!("../../library/motion/group/members.st")),
    ("iec/motion/group/order.st", include_str!("../../library/motion/group/order.st")),
    ("iec/motion/group/path.st", include_str!("../../library/motion/group/path.st")),
    ("iec/motion/group/speed.st", include_str!("../../library/motion/group/speed.st")),
    ("iec/motion/group/status.st", include_str!("../../library/motion/group/status.st")),
    ("iec/motion/group/stop.st", include_str!("../../library/motion/group/stop.st")),
    ("iec/motion/group/transform.st", include_str!("../../library/motion/group/transform.st")),
    ("iec/motion/group/turn.st", include_str!("../../library/motion/group/turn.st")),
    ("iec/motion/group/types.st", include_str!("../../library/motion/group/types.st")),
    ("iec/motion/group/way.st", include_str!("../../library/motion/group/way.st")),
];
