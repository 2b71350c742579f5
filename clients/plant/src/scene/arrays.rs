//! Tables whose name has a range, as in `name = "arm[0..9]"`: written once, there as often as the
//! range has indices.
//!
//! `[i]` in any other text of such a table is the index of the copy. Bodies and shapes may be placed
//! in a row by `step_m`, from one copy to the next, or evenly on a circle by `turn_about_m`, a point
//! of the vertical that the copies are turned about. So may components: an assembly by its place, a kind of
//! the library by the points and directions that it is bound to.

use toml::Value;

use super::placed::Placed;

use super::error::SceneFaultKind;
use super::faults::Faults;
use super::format::{
    AxisTable, BodyTable, ComponentTable, CouplingTable, FailureTable, FittingTable, JointTable, SceneFile,
    SensorTable, ShapeTable, SignalTable, Triple,
};
use crate::component::origin::Origin;
use crate::coupling::Names;
use onescan_base::array::{ArrayError, at_index, indices, name_at, names};

type Text = Placed<String>;

/// A table that may be an array.
trait Table: Clone {
    /// Its own name.
    fn name(&self) -> Option<Text>;
    /// Writes the copy of this index into it.
    fn become_copy(&mut self, name: String, index: usize);
    /// Moves the k-th of n copies to its place.
    fn place(&mut self, _k: usize, _n: usize, _faults: &mut Faults<'_>) {}
}

/// Expands every array of a file.
pub(super) fn expand(written: &mut SceneFile, faults: &mut Faults<'_>) {
    tables(&mut written.body, faults);
    tables(&mut written.shape, faults);
    tables(&mut written.joint, faults);
    tables(&mut written.fitting, faults);
    tables(&mut written.coupling, faults);
    tables(&mut written.axis, faults);
    tables(&mut written.sensor, faults);
    tables(&mut written.component, faults);
    tables(&mut written.failure, faults);
    tables(&mut written.signal, faults);
}

fn tables<T: Table>(all: &mut Vec<Placed<T>>, faults: &mut Faults<'_>) {
    let mut expanded = Vec::with_capacity(all.len());
    for table in std::mem::take(all) {
        let Some(name) = table.get_ref().name() else {
            expanded.push(table);
            continue;
        };
        match indices(name.get_ref()) {
            Ok(None) => {
                let mut single = table;
                single.get_mut().place(0, 1, faults);
                expanded.push(single);
            }
            Ok(Some(range)) => {
                let count = range.clone().count();
                for (k, index) in range.enumerate() {
                    let mut copy = table.clone();
                    copy.get_mut().become_copy(name_at(name.get_ref(), index), index);
                    copy.get_mut().place(k, count, faults);
                    expanded.push(copy);
                }
            }
            Err(error) => faults.add(name.span(), error.into()),
        }
    }
    *all = expanded;
}

/// The names of a list, each range among them as all that it stands for.
pub(super) fn listed(list: &[Text], faults: &mut Faults<'_>) -> Vec<Text> {
    let mut all = Vec::new();
    for name in list {
        match names(name.get_ref()) {
            Ok(names) => all.extend(names.into_iter().map(|one| Placed::new(name.span(), one))),
            Err(error) => faults.add(name.span(), error.into()),
        }
    }
    all
}

/// Where the k-th of n copies is.
fn placed(
    (position, rpy): (&mut Option<Triple>, &mut Option<Triple>),
    (turn_about, step): (Option<&Triple>, Option<&Triple>),
    (index, count): (usize, usize),
    faults: &mut Faults<'_>,
) {
    let around = |written: Option<&Triple>, value: [f64; 3]| {
        let span = written.or(turn_about).or(step).map_or(0..0, Placed::span);
        Some(Placed::new(span, value))
    };
    if let (Some(_), Some(step)) = (turn_about, step) {
        let whose = "an array that is turned about a point".to_owned();
        faults.add(step.span(), SceneFaultKind::Misplaced { whose, key: "step_m" });
        return;
    }
    let [x, y, z] = position.as_ref().map_or([0.0; 3], |position| *position.get_ref());
    if let Some(step) = step {
        let [dx, dy, dz] = step.get_ref().map(|step_m| step_m * index as f64);
        *position = around(position.as_ref(), [x + dx, y + dy, z + dz]);
    }
    if let Some(centre) = turn_about {
        let [cx, cy, _] = *centre.get_ref();
        let turn_deg = 360.0 * index as f64 / count as f64;
        let (sin, cos) = libm::sincos(turn_deg.to_radians());
        let (dx, dy) = (x - cx, y - cy);
        let turned = [cx + cos * dx - sin * dy, cy + sin * dx + cos * dy, z];
        let [roll, pitch, yaw] = rpy.as_ref().map_or([0.0; 3], |rpy| *rpy.get_ref());
        if index > 0 {
            *position = around(position.as_ref(), turned);
            *rpy = around(rpy.as_ref(), [roll, pitch, yaw + turn_deg]);
        }
    }
}

fn renamed(name: &mut Text, new: String) {
    *name.get_mut() = new;
}

fn counted(text: &mut Text, index: usize) {
    let new = at_index(text.get_ref(), index);
    *text.get_mut() = new;
}

/// A table of fixed keys: its name, the other texts that may count, and whether it has a place.
macro_rules! table {
    ($table:ty, $name:ident, [$($text:ident),*], [$($maybe:ident),*] $(, placed $placed:tt)?) => {
        impl Table for $table {
            fn name(&self) -> Option<Text> {
                Some(self.$name.clone())
            }

            #[allow(unused_variables, reason = "a table without other texts has nothing to count")]
            fn become_copy(&mut self, name: String, index: usize) {
                renamed(&mut self.$name, name);
                $( counted(&mut self.$text, index); )*
                $( if let Some(text) = &mut self.$maybe { counted(text, index); } )*
            }

            $( table!(@place $placed); )?
        }
    };
    (@place here) => {
        fn place(&mut self, k: usize, n: usize, faults: &mut Faults<'_>) {
            let spread = (self.turn_about_m.as_ref(), self.step_m.as_ref());
            placed((&mut self.position_m, &mut self.rpy_deg), spread, (k, n), faults);
        }
    };
}

table!(BodyTable, name, [], [group], placed here);
table!(ShapeTable, name, [body], [], placed here);
table!(JointTable, name, [parent, child], []);

table!(FittingTable, name, [joint], [release_signal]);
table!(
    AxisTable,
    name,
    [],
    [
        joint,
        belt,
        forward_signal,
        reverse_signal,
        command_signal,
        position_signal,
        velocity_signal,
        force_signal,
        torque_signal,
        limit_signal
    ]
);
table!(SensorTable, name, [signal], [joint, body]);
table!(FailureTable, component, [], [signal]);
table!(SignalTable, name, [], []);

impl Table for CouplingTable {
    fn name(&self) -> Option<Text> {
        Some(self.name.clone())
    }

    fn become_copy(&mut self, name: String, index: usize) {
        renamed(&mut self.name, name);
        counted(&mut self.joint, index);
        self.of.iter_mut().for_each(|one| counted(one, index));
    }
}

impl Table for ComponentTable {
    fn name(&self) -> Option<Text> {
        let value = self.get("name")?;
        value.get_ref().as_str().map(|name| Placed::new(value.span(), name.to_owned()))
    }

    fn become_copy(&mut self, name: String, index: usize) {
        for value in self.values_mut() {
            count_in(value.get_mut(), index);
        }
        if let Some(value) = self.get_mut("name") {
            *value.get_mut() = Value::String(name);
        }
    }

    /// A kind of the library has its points moved, and its directions turned; an assembly has a place of its own.
    fn place(&mut self, k: usize, n: usize, faults: &mut Faults<'_>) {
        let [turn_about, step] = ["turn_about_m", "step_m"].map(|key| triple(self, key));
        if turn_about.is_none() && step.is_none() {
            return;
        }
        let kind = self.get("kind").and_then(|kind| kind.get_ref().as_str());
        let Some(kind) = kind.and_then(Origin::of_library) else {
            let [mut position, mut rpy] = ["position_m", "rpy_deg"].map(|key| triple(self, key));
            placed((&mut position, &mut rpy), (turn_about.as_ref(), step.as_ref()), (k, n), faults);
            put(self, "position_m", position);
            put(self, "rpy_deg", rpy);
            return;
        };
        let keys = kind.coupling.keys();
        if !keys.iter().any(|binding| binding.names == Names::Point && self.contains_key(binding.key)) {
            // nothing of it has a place: the keys stay, and are refused
            return;
        }
        for binding in keys {
            let written = triple(self, binding.key);
            match binding.names {
                Names::Point if written.is_some() => {
                    let mut point = written;
                    placed((&mut point, &mut None), (turn_about.as_ref(), step.as_ref()), (k, n), faults);
                    put(self, binding.key, point);
                }
                Names::Direction | Names::Along if turn_about.is_some() && k > 0 => {
                    let turned = written.map(|written| turned(&written, k, n));
                    put(self, binding.key, turned);
                }
                // bodies, joints and sides stay the same by name; directions too unless they turn
                _ => {}
            }
        }
        for key in ["turn_about_m", "step_m"] {
            self.remove(key);
        }
    }
}

/// Three numbers behind a key of a component.
fn triple(table: &ComponentTable, key: &str) -> Option<Triple> {
    let value = table.get(key)?;
    numbers(value.get_ref()).map(|numbers| Placed::new(value.span(), numbers))
}

fn put(table: &mut ComponentTable, key: &str, triple: Option<Triple>) {
    if let Some(triple) = triple {
        let value = Value::Array(triple.get_ref().map(Value::Float).to_vec());
        table.insert(Placed::new(triple.span(), key.to_owned()), Placed::new(triple.span(), value));
    }
}

/// The direction that a copy has of so many around a vertical.
fn turned(direction: &Triple, copy: usize, count: usize) -> Triple {
    let [x, y, z] = *direction.get_ref();
    let (sin, cos) = libm::sincos((360.0 * copy as f64 / count as f64).to_radians());
    Placed::new(direction.span(), [cos * x - sin * y, sin * x + cos * y, z])
}

/// Three numbers of a list.
pub(super) fn numbers(value: &Value) -> Option<[f64; 3]> {
    let number = |value: &Value| value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
    let numbers: Option<Vec<_>> = value.as_array()?.iter().map(number).collect();
    numbers?.try_into().ok()
}

fn count_in(value: &mut Value, index: usize) {
    match value {
        Value::String(text) => *text = at_index(text, index),
        Value::Array(list) => list.iter_mut().for_each(|one| count_in(one, index)),
        // what is not a text, nor a list of texts, is the same in every copy
        Value::Integer(_) | Value::Float(_) | Value::Boolean(_) | Value::Datetime(_) | Value::Table(_) => {}
    }
}

impl From<ArrayError> for SceneFaultKind {
    fn from(error: ArrayError) -> Self {
        Self::Array(error)
    }
}
