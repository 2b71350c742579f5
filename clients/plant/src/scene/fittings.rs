//! Second pass over `[[fitting]]`: friction, spring, damper, counterweight and brake of a joint.

use onescan_server::signal::SignalType;

use super::error::{SceneFaultKind, Thing};
use super::faults::Faults;
use super::format::{FittingTable, SceneFile};
use super::joints::{kind_name, refuse_guided, unit};
use super::model::{Brake, Fitting};
use super::names::Names;
use super::number::{Allowed, Entry, Unit};
use super::placed::Placed;
use super::signals::Signals;
use super::text;
use crate::model::JointKind;

/// Where no velocity is given over which the friction at rest falls, m/s or rad/s.
const STRIBECK: f64 = 0.01;

pub(super) fn check(file: &SceneFile, joints: &Names, signals: &mut Signals, faults: &mut Faults<'_>) -> Vec<Fitting> {
    Names::gather(Thing::Fitting, file.fitting.iter().map(|fitting| &fitting.get_ref().name), faults);
    for (index, fitting) in file.fitting.iter().map(Placed::get_ref).enumerate() {
        let mut before = file.fitting[..index].iter().map(Placed::get_ref);
        if let Some(first) = before.find(|first| text(&first.joint) == text(&fitting.joint)) {
            let (name, first) = (text(&fitting.joint).to_owned(), text(&first.name).to_owned());
            faults.add(fitting.joint.span(), SceneFaultKind::FittedTwice { name, first });
        }
    }
    let each = file.fitting.iter().map(Placed::get_ref);
    each.filter_map(|written| fitting(written, file, joints, signals, faults)).collect()
}

fn fitting(
    written: &FittingTable,
    file: &SceneFile,
    joints: &Names,
    signals: &mut Signals,
    faults: &mut Faults<'_>,
) -> Option<Fitting> {
    let joint = joints.find(&written.joint, faults)?;
    if refuse_guided(file.joint[joint].get_ref(), &written.joint, faults) {
        return None;
    }
    let kind = *file.joint[joint].get_ref().kind.get_ref();
    let (JointKind::Prismatic | JointKind::Revolute, Some(unit)) = (kind, unit(kind)) else {
        let unfit = SceneFaultKind::Undrivable { joint: text(&written.joint).to_owned(), kind: kind_name(kind) };
        faults.add_hinted(
            written.joint.span(),
            unfit,
            Some("fittings are for prismatic and revolute joints".to_owned()),
        );
        return None;
    };
    let whose = format!("fitting `{}`", text(&written.name));
    let mut number =
        |metre: (&'static str, &Option<Placed<f64>>), radian: (&'static str, &Option<Placed<f64>>), allowed| {
            let [metre, radian] = [metre, radian].map(|(key, value)| Entry::new(key, value.as_ref()));
            let entry = faults.in_unit(&whose, unit, metre, radian);
            faults.number(entry, allowed)
        };
    let w = written;
    let friction = number(("friction_n", &w.friction_n), ("friction_nm", &w.friction_nm), Allowed::NotNegative);
    let stiction = number(("stiction_n", &w.stiction_n), ("stiction_nm", &w.stiction_nm), Allowed::NotNegative);
    let stribeck = number(("stribeck_m_s", &w.stribeck_m_s), ("stribeck_rad_s", &w.stribeck_rad_s), Allowed::Positive);
    let damping =
        number(("damping_n_s_m", &w.damping_n_s_m), ("damping_nm_s_rad", &w.damping_nm_s_rad), Allowed::NotNegative);
    let spring = number(("spring_n_m", &w.spring_n_m), ("spring_nm_rad", &w.spring_nm_rad), Allowed::NotNegative);
    let rest = number(("rest_m", &w.rest_m), ("rest_rad", &w.rest_rad), Allowed::Finite);
    let balance = number(("balance_n", &w.balance_n), ("balance_nm", &w.balance_nm), Allowed::Finite);
    let brake = number(("brake_n", &w.brake_n), ("brake_nm", &w.brake_nm), Allowed::Positive);
    let friction = friction.unwrap_or_default();
    if let Some(below) = w.stiction_n.as_ref().or(w.stiction_nm.as_ref())
        && stiction.is_some_and(|stiction| stiction < friction)
    {
        let [lower, upper] = match unit {
            Unit::Metre => ["friction_n", "stiction_n"],
            Unit::Radian => ["friction_nm", "stiction_nm"],
        };
        faults.add(below.span(), SceneFaultKind::Order { lower, upper });
    }
    let release = w.release_signal.as_ref().and_then(|name| signals.read(name, SignalType::BOOL, faults));
    if let (Some(name), None) = (&w.release_signal, brake) {
        let key = if unit == Unit::Metre { "brake_n" } else { "brake_nm" };
        faults.add(name.span(), SceneFaultKind::Missing { whose: whose.clone(), key });
    }
    Some(Fitting {
        name: written.name.get_ref().clone(),
        joint,
        friction,
        stiction: stiction.unwrap_or(friction),
        stribeck: stribeck.unwrap_or(STRIBECK),
        damping: damping.unwrap_or_default(),
        spring: spring.unwrap_or_default(),
        rest: rest.unwrap_or_default(),
        balance: balance.unwrap_or_default(),
        brake: brake.map(|most| Brake { most, release }),
    })
}
