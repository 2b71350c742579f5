//! Second pass over `[[coupling]]`: which joint others lead, and by what ratio or cam.

use super::error::{SceneFaultKind, Thing};
use super::faults::Faults;
use super::format::{CouplingTable, SceneFile};
use super::joints::{kind_name, refuse_guided, unit};
use super::model::{Coupling, CouplingLaw, Joint, Share};
use super::names::Names;
use super::number::{Allowed, Entry, Unit};
use super::placed::Placed;
use super::text;
use crate::coupled::Law;
use crate::model::JointKind;

/// The most joints that lead another: a differential has two.
const LEADING_MAX: usize = 2;
/// How far from its cam a joint may be in the scene's pose, m or rad.
const OFF_MAX: f64 = 1e-6;

pub(super) fn check(file: &SceneFile, joints: &Names, checked: &[Joint], faults: &mut Faults<'_>) -> Vec<Coupling> {
    Names::gather(Thing::Coupling, file.coupling.iter().map(|coupling| &coupling.get_ref().name), faults);
    let each = file.coupling.iter().map(Placed::get_ref);
    let found = each.filter_map(|written| {
        let coupling = coupling(written, file, joints, faults)?;
        // joints at fault are reported as such
        if checked.len() == file.joint.len() {
            refuse_off(written, &coupling, checked, faults);
        }
        Some(coupling)
    });
    found.collect()
}

fn coupling(written: &CouplingTable, file: &SceneFile, joints: &Names, faults: &mut Faults<'_>) -> Option<Coupling> {
    let (joint, unit) = coordinate(&written.joint, file, joints, faults)?;
    let mut of = Vec::new();
    for name in &written.of {
        of.push(coordinate(name, file, joints, faults)?.0);
    }
    let whose = format!("coupling `{}`", text(&written.name));
    if of.is_empty() || of.len() > LEADING_MAX || of.contains(&joint) || (of.len() == 2 && of[0] == of[1]) {
        let wanted = "one or two other joints".to_owned();
        let value = format!("{} names", of.len());
        faults.add(written.name.span(), SceneFaultKind::Number { key: "of".into(), wanted, value });
        return None;
    }
    let metre = Entry::new("backlash_m", written.backlash_m.as_ref());
    let radian = Entry::new("backlash_rad", written.backlash_rad.as_ref());
    let backlash = faults.in_unit(&whose, unit, metre, radian);
    let backlash = faults.number(backlash, Allowed::NotNegative).unwrap_or_default();
    let slip = slip(written, backlash, unit, &whose, faults);
    let laws = laws(written, of.len(), &whose, faults)?;
    let of = of.into_iter().zip(laws).map(|(joint, law)| Share { joint, law }).collect();
    Some(Coupling { name: written.name.get_ref().clone(), joint, of, backlash, slip })
}

/// The force beyond which it slips. What slips has no place of its own, as a cam and play have.
fn slip(written: &CouplingTable, backlash: f64, unit: Unit, whose: &str, faults: &mut Faults<'_>) -> Option<f64> {
    let newton = Entry::new("slip_n", written.slip_n.as_ref());
    let newton_metre = Entry::new("slip_nm", written.slip_nm.as_ref());
    let entry = faults.in_unit(whose, unit, newton, newton_metre);
    let beside = match (&written.cam, backlash > 0.0) {
        (Some(_), _) => Some("a `cam`"),
        (None, true) => Some("backlash"),
        (None, false) => None,
    };
    if let (Some(value), Some(beside)) = (entry.value, beside) {
        let whose = format!("{whose} with {beside}");
        faults.add(value.span(), SceneFaultKind::Misplaced { whose, key: entry.key });
        return None;
    }
    faults.number(entry, Allowed::Positive)
}

/// In the scene's pose a joint must be where its cam has it.
fn refuse_off(written: &CouplingTable, coupling: &Coupling, joints: &[Joint], faults: &mut Faults<'_>) {
    for share in &coupling.of {
        if let CouplingLaw::Ratio(_) = share.law {
            continue;
        }
        let [x, y] = [joints[share.joint].initial, joints[coupling.joint].initial];
        let on = Law::of(&share.law, [0.0; 2]).at(x).0;
        if (on - y).abs() > OFF_MAX {
            let span = written.cam.as_ref().map_or_else(|| written.name.span(), Placed::span);
            let (wanted, value) = (format!("a curve with {y} at {x}, where the scene has the joints"), on.to_string());
            faults.add(span, SceneFaultKind::Number { key: "cam".into(), wanted, value });
        }
    }
}

/// A prismatic or revolute joint, and the unit of its coordinate.
fn coordinate(
    name: &Placed<String>,
    file: &SceneFile,
    joints: &Names,
    faults: &mut Faults<'_>,
) -> Option<(usize, Unit)> {
    let joint = joints.find(name, faults)?;
    if refuse_guided(file.joint[joint].get_ref(), name, faults) {
        return None;
    }
    let kind = *file.joint[joint].get_ref().kind.get_ref();
    if let (JointKind::Prismatic | JointKind::Revolute, Some(unit)) = (kind, unit(kind)) {
        return Some((joint, unit));
    }
    let unfit = SceneFaultKind::Undrivable { joint: text(name).to_owned(), kind: kind_name(kind) };
    faults.add_hinted(name.span(), unfit, Some("couplings are for prismatic and revolute joints".to_owned()));
    None
}

/// By what each of the leading joints leads: a ratio each, or the one cam.
fn laws(written: &CouplingTable, count: usize, whose: &str, faults: &mut Faults<'_>) -> Option<Vec<CouplingLaw>> {
    if let (Some(repeats), None) = (&written.cam_repeats, &written.cam) {
        let whose = format!("{whose} without a `cam`");
        faults.add(repeats.span(), SceneFaultKind::Misplaced { whose, key: "cam_repeats" });
    }
    match (&written.ratio, &written.cam) {
        (Some(ratios), None) => {
            let ratios_given = ratios.get_ref();
            let sound = ratios_given.iter().all(|ratio| ratio.is_finite() && *ratio != 0.0);
            if ratios_given.len() == count && sound {
                return Some(ratios_given.iter().map(|ratio| CouplingLaw::Ratio(*ratio)).collect());
            }
            let wanted = format!("{count} numbers other than 0, one for each joint in `of`");
            let value = format!("{ratios_given:?}");
            faults.add(ratios.span(), SceneFaultKind::Number { key: "ratio".into(), wanted, value });
        }
        (None, Some(cam)) => {
            let points = cam.get_ref();
            let rising = points.windows(2).all(|pair| pair[0][0] < pair[1][0]);
            let finite = points.iter().flatten().all(|number| number.is_finite());
            if points.len() >= 2 && rising && finite && count == 1 {
                let repeats = written.cam_repeats.as_ref().is_some_and(|repeats| *repeats.get_ref());
                let law = if repeats { CouplingLaw::RepeatingCam } else { CouplingLaw::Cam };
                return Some(vec![law(points.clone())]);
            }
            let wanted =
                "two points or more, [leading, led] in rising order of the first, of one leading joint".to_owned();
            let value = format!("{} points", points.len());
            faults.add(cam.span(), SceneFaultKind::Number { key: "cam".into(), wanted, value });
        }
        (None, None) => {
            faults.add(written.name.span(), SceneFaultKind::Missing { whose: whose.to_owned(), key: "ratio" });
        }
        (Some(_), Some(cam)) => {
            faults.add(cam.span(), SceneFaultKind::Misplaced { whose: format!("{whose} with a `ratio`"), key: "cam" });
        }
    }
    None
}
