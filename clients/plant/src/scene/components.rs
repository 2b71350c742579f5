//! Second pass over `[[component]]`: kind, parameters, bindings and wires, all by the kind's table.

use onescan_base::byte_line::{DEFAULT_WINDOW, WINDOW_MAX};
use onescan_base::nearest;
use onescan_server::signal::{SignalName, SignalType};
use toml::Value;

use super::placed::Placed;

use super::bindings::Lookup;
use super::component_keys::Keys;
use super::error::{SceneFaultKind, Thing};
use super::faults::Faults;
use super::format::SHOWN_AT;
use super::model::{Bound, Component, Wire};
use super::names::Names;
use super::own::Kinds;
use super::signals::Signals;
use super::text;
use crate::component::kind::{Dependence, Frames, Kind, Parameter, Setting, Signal, Values, unit};
use crate::component::origin::Origin;
use crate::model::NumberType;

/// A component whose kind is known.
struct Known<'f> {
    keys: Keys<'f>,
    kind: Origin,
}

/// The components, and the names of those whose kind is not known, which nobody else shall miss.
pub(super) fn check(
    placed: &Lookup<'_>,
    signals: &mut Signals,
    faults: &mut Faults<'_>,
) -> (Vec<Component>, Vec<String>) {
    let tables = placed.file.component.iter();
    let keys: Vec<_> = tables.filter_map(|table| Keys::of(table, faults)).collect();
    Names::gather(Thing::Component, keys.iter().map(|keys| &keys.name), faults);
    let named: Vec<String> = keys.iter().map(|keys| text(&keys.name).to_owned()).collect();
    let known: Vec<_> = keys.into_iter().filter_map(|keys| known(keys, placed.kinds, faults)).collect();
    let known_name = |name: &String| known.iter().any(|one| text(&one.keys.name) == name);
    let lost: Vec<String> = named.into_iter().filter(|name| !known_name(name)).collect();
    let mut bound: Vec<(String, Bound)> = Vec::new();
    let mut components = Vec::new();
    for one in &known {
        refuse_unknown_keys(one, faults);
        let to = placed.bind(one.kind.coupling, &one.keys, &bound, faults);
        // of no meaning where a fault was found
        let to = to.unwrap_or_default();
        bound.push((text(&one.keys.name).to_owned(), to.clone()));
        let types = Types { number: number_type(&one.keys, faults), window: window(one, faults) };
        let settings = settings(one, faults);
        let kind = settled(one, &settings, faults);
        components.push(Component {
            name: text(&one.keys.name).to_owned(),
            code: kind.code().map(str::to_owned),
            kind,
            settings,
            bound: to,
            inputs: inputs(one, (&known, &lost), types, signals, faults),
            outputs: outputs(one, types, signals, faults),
            number: types.number,
            window: types.window,
            shown_at_m: shown_at(&one.keys, faults),
            failures: Vec::new(),
        });
    }
    (components, lost)
}

fn known<'f>(keys: Keys<'f>, kinds: &Kinds, faults: &mut Faults<'_>) -> Option<Known<'f>> {
    let kind = kinds.find(text(&keys.kind));
    if kind.is_none() {
        kinds.miss(&keys.kind, faults);
    }
    kind.map(|kind| Known { keys, kind })
}

/// The kind as it is with a component's settings.
fn settled(one: &Known<'_>, settings: &[Setting], faults: &mut Faults<'_>) -> Origin {
    one.kind.clone().settled(settings).unwrap_or_else(|error| {
        let wrong = SceneFaultKind::OwnKind { kind: text(&one.keys.kind).to_owned(), cause: error.to_string() };
        faults.add(one.keys.kind.span(), wrong);
        one.kind.clone()
    })
}

/// Keys that the kind has not.
fn refuse_unknown_keys(one: &Known<'_>, faults: &mut Faults<'_>) {
    let Known { keys, kind } = one;
    let mut right: Vec<String> = ["name", "kind", "signal_type", SHOWN_AT].map(str::to_owned).to_vec();
    right.extend(kind.coupling.keys().iter().map(|binding| binding.key.to_owned()));
    right.extend(kind.parameters.iter().map(|parameter| parameter.key.to_string()));
    right.extend(kind.inputs.iter().flat_map(|input| [format!("{}_signal", input.key), format!("{}_from", input.key)]));
    right.extend(kind.inputs.iter().map(|input| kind.constant_key(&input.key)));
    right.extend(kind.outputs.iter().map(|output| format!("{}_signal", output.key)));
    right.extend(
        kind.frames.by_key().into_iter().filter(|(_, signals)| !signals.is_empty()).map(|(key, _)| key.to_owned()),
    );
    if has_lines(kind) {
        right.push(WINDOW.to_owned());
    }
    for key in keys.table.keys().filter(|key| !right.contains(key.get_ref())) {
        let wrong = SceneFaultKind::ComponentKey { whose: keys.whose(), key: key.get_ref().clone() };
        faults.add_hinted(key.span(), wrong, hint(key.get_ref(), kind, &right));
    }
}

/// The key that was meant: the same except for its unit, or the nearest.
fn hint(wrong: &str, kind: &Kind, right: &[String]) -> Option<String> {
    let stem = |key: &str| match unit(key) {
        (stem, Some(_)) => stem.to_owned(),
        // a unit that nobody has, as in `stroke_mm`
        (whole, None) => whole.rsplit_once('_').map_or(whole, |(stem, _)| stem).to_owned(),
    };
    let meant = |parameter: &&Parameter| {
        unit(&parameter.key).1.is_some() && (unit(&parameter.key).0 == wrong || unit(&parameter.key).0 == stem(wrong))
    };
    if let Some(parameter) = kind.parameters.iter().find(meant) {
        let unit = unit(&parameter.key).1.unwrap_or_default();
        return Some(format!("did you mean `{}`, in {unit}?", parameter.key));
    }
    nearest(wrong, right.iter().map(String::as_str)).map(|near| format!("did you mean `{near}`?"))
}

/// Settings for all parameters: what is written, or the preset.
fn settings(one: &Known<'_>, faults: &mut Faults<'_>) -> Vec<Setting> {
    let Known { keys, kind } = one;
    let mut whole = true;
    let mut settings = Vec::new();
    for parameter in &kind.parameters {
        let setting = keys.get(&parameter.key).map(|written| (written, parameter.form.read(written.get_ref())));
        if let Some((written, None)) = &setting {
            let wanted = parameter.form.in_words();
            let value = written.get_ref().to_string();
            faults.add(written.span(), SceneFaultKind::Number { key: parameter.key.clone(), wanted, value });
            whole = false;
        }
        settings.push(setting.and_then(|(_, setting)| setting).unwrap_or(parameter.preset));
    }
    if whole && let Some(conflict) = kind.conflict(&settings) {
        let span = keys.get(conflict.key).map_or_else(|| keys.kind.span(), Placed::span);
        let at = kind.parameters.iter().position(|parameter| parameter.key == conflict.key);
        let value = at.and_then(|at| settings.get(at)).map(ToString::to_string).unwrap_or_default();
        faults
            .add(span, SceneFaultKind::Number { key: conflict.key.into(), wanted: conflict.wanted.to_owned(), value });
    }
    settings
}

fn number_type(keys: &Keys<'_>, faults: &mut Faults<'_>) -> NumberType {
    let Some(written) = keys.get("signal_type") else { return NumberType::default() };
    match written.get_ref().as_str() {
        Some("REAL") => NumberType::Real,
        Some("LREAL") => NumberType::Lreal,
        _ => {
            let kind = SceneFaultKind::Text { key: "signal_type".to_owned(), wanted: "\"LREAL\" or \"REAL\"" };
            faults.add(written.span(), kind);
            NumberType::default()
        }
    }
}

fn shown_at(keys: &Keys<'_>, faults: &mut Faults<'_>) -> Option<[f64; 3]> {
    let at = keys.triple(SHOWN_AT, faults)?;
    let is_somewhere = at.get_ref().iter().all(|part| part.is_finite());
    if !is_somewhere {
        faults.add(at.span(), SceneFaultKind::Text { key: SHOWN_AT.to_owned(), wanted: "three finite numbers" });
    }
    is_somewhere.then_some(*at.get_ref())
}

/// What a component says of the types of its signals.
#[derive(Clone, Copy)]
struct Types {
    number: NumberType,
    /// Of its lines of bytes, if it has some.
    window: Option<u16>,
}

/// The key that says how many bytes the window of each line of a component has.
pub(super) const WINDOW: &str = "line_window";

/// Whether a kind has lines of bytes.
pub(super) fn has_lines(kind: &Kind) -> bool {
    kind.inputs.iter().chain(&kind.outputs).any(|signal| signal.values == Values::Bytes)
}

fn window(one: &Known<'_>, faults: &mut Faults<'_>) -> Option<u16> {
    if !has_lines(&one.kind) {
        return None;
    }
    let Some(written) = one.keys.get(WINDOW) else { return Some(DEFAULT_WINDOW) };
    let window = written.get_ref().as_integer().and_then(|bytes| u16::try_from(bytes).ok());
    let window = window.filter(|bytes| (1..=WINDOW_MAX).contains(bytes));
    if window.is_none() {
        let wanted = format!("a whole number from 1 to {WINDOW_MAX}");
        let value = written.get_ref().to_string();
        faults.add(written.span(), SceneFaultKind::Number { key: WINDOW.into(), wanted, value });
    }
    Some(window.unwrap_or(DEFAULT_WINDOW))
}

/// The type of a signal of these values.
fn type_of(values: Values, types: Types) -> SignalType {
    match (values, types.number) {
        (Values::Bytes, _) => SignalType::Bytes(types.window.unwrap_or(DEFAULT_WINDOW)),
        (Values::Bool, _) => SignalType::BOOL,
        (Values::Whole, _) => SignalType::DINT,
        (Values::Number, NumberType::Real) => SignalType::REAL,
        (Values::Number, NumberType::Lreal) => SignalType::LREAL,
    }
}

const SIGNAL: &str = "the name of a signal";
const STRUCTURE: &str = "the name of a structure of signals";

/// The member of a structure of signals that an input or output is, if its kind has it in a frame.
fn member(structure: Option<&Placed<String>>, frame: &[&str], key: &str) -> Option<Placed<String>> {
    let structure = structure.filter(|_| frame.contains(&key))?;
    Some(Placed::new(structure.span(), format!("{}.{}", text(structure), Frames::member(key))))
}

fn inputs(
    one: &Known<'_>,
    known: (&[Known<'_>], &[String]),
    types: Types,
    signals: &mut Signals,
    faults: &mut Faults<'_>,
) -> Vec<Wire> {
    let mut wires = Vec::new();
    let frame = one.keys.text(Frames::COMMAND, STRUCTURE, faults);
    for input in &one.kind.inputs {
        let (by_signal, by_wire) = (format!("{}_signal", input.key), format!("{}_from", input.key));
        let by_value = one.kind.constant_key(&input.key);
        let written = one.keys.get(&by_value);
        let sources = [written, one.keys.get(&by_signal), one.keys.get(&by_wire)];
        if let Some(second) = sources.into_iter().flatten().nth(1) {
            faults.add(
                second.span(),
                SceneFaultKind::WiredTwice { whose: one.keys.whose(), input: input.key.to_string() },
            );
        }
        let signal = one.keys.text(&by_signal, SIGNAL, faults);
        let from = one.keys.text(&by_wire, "\"component.output\"", faults);
        let wire = match (written, signal, from) {
            (Some(value), ..) => constant(input, by_value, value, faults),
            (None, Some(name), _) => signals.read(&name, type_of(input.values, types), faults).map(Wire::Signal),
            (None, None, Some(from)) if input.values == Values::Bytes => {
                let wanted = "no wire: a line of bytes joins two clients by a signal";
                faults.add(from.span(), SceneFaultKind::Text { key: by_wire, wanted });
                None
            }
            (None, None, Some(from)) => output_of(&from, &by_wire, input.values, known, faults),
            (None, None, None) => {
                let member = member(frame.as_ref(), one.kind.frames.command, &input.key);
                member.and_then(|name| signals.read(&name, type_of(input.values, types), faults)).map(Wire::Signal)
            }
        };
        wires.push(wire.unwrap_or(Wire::Open));
    }
    refuse_idle(one, &wires, faults);
    wires
}

fn constant(input: &Signal, key: String, value: &Placed<Value>, faults: &mut Faults<'_>) -> Option<Wire> {
    let constant = input.constant(value.get_ref());
    if constant.is_none() {
        faults.add(value.span(), SceneFaultKind::Text { key, wanted: input.values.in_words() });
    }
    constant.map(Wire::Constant)
}

/// Inputs that are driven and of which nothing comes, because nobody drives what they depend on.
fn refuse_idle(one: &Known<'_>, wires: &[Wire], faults: &mut Faults<'_>) {
    let Known { keys, kind } = one;
    let written = |input: &str| {
        let ways = [kind.constant_key(input), format!("{input}_signal"), format!("{input}_from")];
        ways.into_iter().find_map(|key| keys.get(&key).map(|value| (key, value.span())))
    };
    let open = |key: &str| kind.inputs.iter().zip(wires).any(|(input, wire)| input.key == key && *wire == Wire::Open);
    for Dependence { inputs, on } in kind.dependences {
        // a key that is written and wrong has its own fault
        if !on.iter().all(|key| open(key) && written(key).is_none()) {
            continue;
        }
        for (key, span) in inputs.iter().filter_map(|input| written(input)) {
            let idle = SceneFaultKind::Idle { whose: keys.whose(), key, on: on.join("` or `") };
            let hint = format!("bind `{0}_signal`, or write `{0} = true`", on[0]);
            faults.add_hinted(span, idle, Some(hint));
        }
    }
}

/// The output that `"component.output"` names.
fn output_of(
    from: &Placed<String>,
    key: &str,
    wanted: Values,
    (known, lost): (&[Known<'_>], &[String]),
    faults: &mut Faults<'_>,
) -> Option<Wire> {
    let Some((name, output)) = text(from).rsplit_once('.') else {
        faults.add(from.span(), SceneFaultKind::Text { key: key.to_owned(), wanted: "\"component.output\"" });
        return None;
    };
    if lost.iter().any(|lost| lost == name) {
        return None;
    }
    let Some(component) = known.iter().position(|other| text(&other.keys.name) == name) else {
        let named = Placed::new(from.span(), name.to_owned());
        faults.unknown(Thing::Component, &named, known.iter().map(|other| text(&other.keys.name)));
        return None;
    };
    let outputs = &known[component].kind.outputs;
    let Some(index) = outputs.iter().position(|known| known.key == output) else {
        let near = nearest(output, outputs.iter().map(|output| &*output.key));
        let kind =
            SceneFaultKind::ComponentPart { component: name.to_owned(), what: "output", name: output.to_owned() };
        faults.add_hinted(from.span(), kind, near.map(|near| format!("did you mean `{near}`?")));
        return None;
    };
    if outputs[index].values != wanted {
        let (is, wanted) = (outputs[index].values.to_string(), wanted.to_string());
        let output = text(from).to_owned();
        faults.add(from.span(), SceneFaultKind::WireType { output, is, key: key.to_owned(), wanted });
        return None;
    }
    Some(Wire::Output { component, output: index })
}

fn outputs(one: &Known<'_>, types: Types, signals: &mut Signals, faults: &mut Faults<'_>) -> Vec<Option<SignalName>> {
    let mut names = Vec::new();
    let frame = one.keys.text(Frames::FEEDBACK, STRUCTURE, faults);
    for output in &one.kind.outputs {
        let own = one.keys.text(&format!("{}_signal", output.key), SIGNAL, faults);
        let name = own.or_else(|| member(frame.as_ref(), one.kind.frames.feedback, &output.key));
        names.push(name.and_then(|name| signals.write(&name, type_of(output.values, types), faults)));
    }
    names
}
