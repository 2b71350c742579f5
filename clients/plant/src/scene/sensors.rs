//! Second pass over `[[sensor]]`: what each detects and where it says so.

use super::placed::Placed;
use onescan_server::signal::SignalType;

use super::arrays::listed;
use super::bodies::GROUND;
use super::error::{SceneFaultKind, Thing};
use super::faults::Faults;
use super::format::{JointTable, SceneFile, SensorKind, SensorTable, Triple};
use super::joints::{kind_name, unit};
use super::model::{Sensing, Sensor};
use super::names::Names;
use super::number::{Allowed, Entry};
use super::signals::Signals;
use super::text;

pub(super) fn check(
    written: &SceneFile,
    bodies: &Names,
    joints: &Names,
    signals: &mut Signals,
    faults: &mut Faults<'_>,
) -> Vec<Sensor> {
    let tables = &written.sensor;
    Names::gather(Thing::Sensor, tables.iter().map(|sensor| &sensor.get_ref().name), faults);
    let mut sensors = Vec::new();
    for table in tables {
        let sensor = table.get_ref();
        let signal = signals.write(&sensor.signal, SignalType::BOOL, faults);
        refuse_foreign(sensor, faults);
        let sensing = match sensor.kind.get_ref() {
            SensorKind::EndPosition => end_position(sensor, &written.joint, joints, faults),
            SensorKind::Proximity => proximity(sensor, written.body.len(), bodies, faults),
        };
        if let (Some(signal), Some(sensing)) = (signal, sensing) {
            sensors.push(Sensor { name: sensor.name.get_ref().clone(), signal, sensing });
        }
    }
    sensors
}

fn whose(sensor: &SensorTable) -> String {
    let kind = match sensor.kind.get_ref() {
        SensorKind::EndPosition => "end-position",
        SensorKind::Proximity => "proximity",
    };
    format!("{kind} sensor `{}`", text(&sensor.name))
}

/// Keys of the other kind of sensor are faults.
fn refuse_foreign(sensor: &SensorTable, faults: &mut Faults<'_>) {
    let number = |value: &Option<Placed<f64>>| value.as_ref().map(Placed::span);
    let foreign = match sensor.kind.get_ref() {
        SensorKind::EndPosition => vec![
            ("body", sensor.body.as_ref().map(Placed::span)),
            ("point_m", sensor.point_m.as_ref().map(Triple::span)),
            ("direction", sensor.direction.as_ref().map(Triple::span)),
            ("range_m", number(&sensor.range_m)),
            ("targets", sensor.targets.as_ref().map(|_| sensor.kind.span())),
        ],
        SensorKind::Proximity => vec![
            ("joint", sensor.joint.as_ref().map(Placed::span)),
            ("from_m", number(&sensor.from_m)),
            ("from_rad", number(&sensor.from_rad)),
            ("to_m", number(&sensor.to_m)),
            ("to_rad", number(&sensor.to_rad)),
            ("hysteresis_m", number(&sensor.hysteresis_m)),
            ("hysteresis_rad", number(&sensor.hysteresis_rad)),
        ],
    };
    for (key, span) in foreign {
        if let Some(span) = span {
            faults.add(span, SceneFaultKind::Misplaced { whose: whose(sensor), key });
        }
    }
}

/// A key that this sensor needs; its absence is a fault.
fn needed<'f, T>(
    sensor: &SensorTable,
    key: &'static str,
    value: Option<&'f T>,
    faults: &mut Faults<'_>,
) -> Option<&'f T> {
    if value.is_none() {
        faults.add(sensor.kind.span(), SceneFaultKind::Missing { whose: whose(sensor), key });
    }
    value
}

fn end_position(
    sensor: &SensorTable,
    joint_tables: &[Placed<JointTable>],
    joints: &Names,
    faults: &mut Faults<'_>,
) -> Option<Sensing> {
    let name = needed(sensor, "joint", sensor.joint.as_ref(), faults)?;
    let joint = joints.find(name, faults)?;
    let kind = *joint_tables[joint].get_ref().kind.get_ref();
    let Some(unit) = unit(kind) else {
        let unmeasurable = SceneFaultKind::Unmeasurable { joint: name.get_ref().clone(), kind: kind_name(kind) };
        faults.add(name.span(), unmeasurable);
        return None;
    };
    let pairs = [
        (Entry::new("from_m", sensor.from_m.as_ref()), Entry::new("from_rad", sensor.from_rad.as_ref())),
        (Entry::new("to_m", sensor.to_m.as_ref()), Entry::new("to_rad", sensor.to_rad.as_ref())),
        (
            Entry::new("hysteresis_m", sensor.hysteresis_m.as_ref()),
            Entry::new("hysteresis_rad", sensor.hysteresis_rad.as_ref()),
        ),
    ];
    let [from, to, hysteresis] = pairs.map(|(metre, radian)| faults.in_unit(&whose(sensor), unit, metre, radian));
    if from.value.is_none() && to.value.is_none() {
        let kind = SceneFaultKind::Missing { whose: whose(sensor), key: from.key };
        faults.add_hinted(sensor.kind.span(), kind, Some(format!("`{}`, `{}` or both", from.key, to.key)));
    }
    let least = faults.number(from, Allowed::Finite).unwrap_or(f64::NEG_INFINITY);
    let most = faults.number(to, Allowed::Finite).unwrap_or(f64::INFINITY);
    if least > most
        && let Some(value) = to.value
    {
        faults.add(value.span(), SceneFaultKind::Order { lower: from.key, upper: to.key });
    }
    let hysteresis = faults.number(hysteresis, Allowed::NotNegative).unwrap_or(0.0);
    Some(Sensing::EndPosition { joint, from: least, to: most, hysteresis })
}

fn proximity(sensor: &SensorTable, body_count: usize, bodies: &Names, faults: &mut Faults<'_>) -> Option<Sensing> {
    let body = match &sensor.body {
        Some(name) if text(name) != GROUND => Some(bodies.find_beside(name, Some(GROUND), faults)?),
        Some(_) | None => None,
    };
    let point_m = needed(sensor, "point_m", sensor.point_m.as_ref(), faults);
    let direction = needed(sensor, "direction", sensor.direction.as_ref(), faults);
    let range_m = needed(sensor, "range_m", sensor.range_m.as_ref(), faults);
    let targets = match &sensor.targets {
        Some(names) => listed(names, faults).iter().filter_map(|name| bodies.find(name, faults)).collect(),
        None => (0..body_count).filter(|index| Some(*index) != body).collect(),
    };
    let point_m = faults.triple("point_m", point_m);
    let direction = direction.and_then(|direction| faults.direction("direction", direction));
    let range_m = faults.number(Entry::new("range_m", range_m), Allowed::Positive);
    Some(Sensing::Proximity { body, point_m: point_m?, direction: direction?, range_m: range_m?, targets })
}
