//! What may stand behind the signals of a list, by their names, comments and types: components for the scene, as comments
//! until somebody takes them.

use std::fmt::Write;

use onescan_base::{ElementaryType, SignalType};

use super::names::Taken;
use super::signal::Signal;
use super::text::quoted;
use crate::io_list::Direction;

/// Nobody reads more of them.
const PROPOSED_MAX: usize = 200;
/// A word of so many letters counts only where it stands by itself, as `LS` in `LS_1`.
const SHORT: usize = 4;

/// Words that stand in the program.
type Words = &'static [&'static str];

/// A kind of component for the signals that name one of some words.
#[derive(Debug)]
struct Rule {
    direction: Direction,
    value: Value,
    /// In small letters, in English and German.
    words: Words,
    kind: &'static str,
    /// What it is bound to; words in capitals are to be replaced.
    bound: Words,
    /// The key that names the signal.
    key: &'static str,
}

/// What a signal is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Value {
    Bool,
    Number,
}

const ALONE: &[&str] = &[];
const RAY: &[&str] = &["point_m = [0, 0, 0]", "direction = [1, 0, 0]"];
const JOINT: &[&str] = &["joint = \"JOINT\""];
const BELT: &[&str] = &["belt = \"BELT\"", "direction = [1, 0, 0]"];
const BODY: &[&str] = &["body = \"BODY\""];

const fn sensor(words: Words, kind: &'static str, bound: Words, key: &'static str) -> Rule {
    Rule { direction: Direction::Input, value: Value::Bool, words, kind, bound, key }
}

const fn gauge(words: Words, kind: &'static str, bound: Words, key: &'static str) -> Rule {
    Rule { value: Value::Number, ..sensor(words, kind, bound, key) }
}

const fn drive(words: Words, kind: &'static str, bound: Words, key: &'static str) -> Rule {
    Rule { direction: Direction::Output, ..sensor(words, kind, bound, key) }
}

/// The first that fits counts.
const RULES: &[Rule] = &[
    sensor(&["emergency", "estop", "notaus", "nothalt"], "emergency_stop", ALONE, "channel_a_signal"),
    sensor(&["curtain", "ossd", "lichtvorhang", "lichtgitter"], "light_curtain", RAY, "ossd_1_signal"),
    sensor(&["twohand", "zweihand"], "two_hand_station", ALONE, "valid_signal"),
    sensor(&["keyswitch", "schlüssel", "schluessel"], "key_switch", ALONE, "at_1_signal"),
    sensor(&["barrier", "ls", "lb", "photo", "beam", "lichtschranke"], "light_barrier", RAY, "detected_signal"),
    sensor(&["extended", "ausgefahren"], "pneumatic_cylinder", ALONE, "extended_signal"),
    sensor(&["retracted", "eingefahren"], "pneumatic_cylinder", ALONE, "retracted_signal"),
    sensor(&["limit", "guard", "door", "gate", "endschalter", "schutzt"], "limit_switch", JOINT, "contact_signal"),
    sensor(&["prox", "inductive", "ini", "bero", "sensor", "induktiv"], "inductive_sensor", RAY, "detected_signal"),
    sensor(&["start", "stop", "reset", "button", "key", "taster", "quit"], "push_button", ALONE, "make_signal"),
    gauge(&["weight", "scale", "gewicht", "waage"], "weighing_cell", BODY, "gross_kg_signal"),
    gauge(&["level", "niveau", "stand", "füllstand", "fuellstand"], "tank", ALONE, "level_m_signal"),
    gauge(&["temp", "temperat"], "temperature_sensor", ALONE, "measured_degc_signal"),
    gauge(&["pressure", "druck"], "pressure_sensor", ALONE, "measured_bar_signal"),
    gauge(&["distance", "abstand"], "laser_distance", RAY, "distance_m_signal"),
    gauge(&["position", "pos", "encoder", "geber"], "axis_encoder", JOINT, "position_signal"),
    drive(&["stacklight", "stack", "ampel", "signalsäule", "signalsaeule"], "stack_light", ALONE, "red_signal"),
    drive(&["stopper"], "stopper", ALONE, "lower_signal"),
    drive(&["lamp", "light", "led", "leuchte"], "lamp", ALONE, "on_signal"),
    drive(&["conveyor", "belt", "band", "förder", "foerder"], "conveyor", BELT, "run_signal"),
    drive(&["grip", "gripper", "greifer"], "gripper", BODY, "close_signal"),
    drive(&["vacuum", "vakuum", "sauger"], "vacuum_cup", BODY, "on_signal"),
    drive(&["heat", "heater", "heiz"], "heater", ALONE, "on_signal"),
    drive(&["valve", "cylinder", "extend", "ventil", "zylinder"], "pneumatic_cylinder", ALONE, "extend_signal"),
    drive(&["motor", "drive", "pump", "fan", "antrieb", "pumpe", "lüfter"], "asynchronous_motor", ALONE, "run_signal"),
];

/// A component that may stand behind a signal.
#[derive(Clone, Copy, Debug)]
pub struct Proposal<'s> {
    signal: &'s Signal,
    rule: &'static Rule,
}

impl Proposal<'_> {
    /// The signal behind which it may stand.
    pub(super) fn signal(&self) -> &str {
        &self.signal.name
    }

    /// The kind of the component.
    pub(super) fn kind(&self) -> &'static str {
        self.rule.kind
    }

    /// The component as a scene has it, called `name`.
    fn component(&self, name: &str) -> String {
        let Self { signal, rule } = self;
        let mut text = format!("[[component]]\nname = {}\nkind = \"{}\"\n", quoted(name), rule.kind);
        for line in rule.bound {
            text.push_str(line);
            text.push('\n');
        }
        text + &format!("{} = {}\n", rule.key, quoted(&signal.name))
    }

    /// What there is to say of it: the signal's type, and what its component writes in its place.
    fn remark(&self) -> String {
        let ty = self.signal.point.ty;
        let is_other = self.rule.value == Value::Number && ty != SignalType::Elementary(ElementaryType::Lreal);
        let but = if is_other { "; its component writes LREAL: change the type in `[signals]`" } else { "" };
        format!("{} : {ty}{but}", self.signal.name)
    }
}

/// The components that the names of `signals` suggest, in their order.
pub(super) fn of(signals: &[Signal]) -> Vec<Proposal<'_>> {
    let proposed = signals.iter().filter_map(|signal| Some(Proposal { signal, rule: rule_for(signal)? }));
    proposed.take(PROPOSED_MAX).collect()
}

fn rule_for(signal: &Signal) -> Option<&'static Rule> {
    let point = &signal.point;
    let value = match point.ty {
        SignalType::Elementary(ElementaryType::Bool) => Value::Bool,
        SignalType::Elementary(ty) if ty.is_number() => Value::Number,
        _ => return None,
    };
    let text = format!("{} {}", point.name, point.comment.as_deref().unwrap_or(""));
    let words = words(&text);
    let names = |word: &&str| {
        let is_short = word.chars().count() <= SHORT;
        words.iter().any(|own| if is_short { own == word } else { own.contains(*word) })
    };
    let fits = |rule: &&Rule| rule.direction == point.direction && rule.value == value && rule.words.iter().any(&names);
    RULES.iter().find(fits)
}

/// The words of a name or a comment in small letters: `LS_1`, `xStartButton` and `Guard closed` have two each, and a number.
fn words(text: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut was_small = false;
    for letter in text.chars() {
        if !letter.is_alphabetic() || was_small && letter.is_uppercase() {
            words.push(String::new());
        }
        was_small = letter.is_lowercase();
        if let Some(word) = words.last_mut().filter(|_| letter.is_alphabetic()) {
            word.extend(letter.to_lowercase());
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// `plant.toml` with all of them as comments.
pub(super) fn scene(name: &str, proposals: &[Proposal]) -> String {
    let mut text = format!(
        "# {name}: components that the names of the signals suggest, as comments. Take the `#` from what is right, put your own
# bodies and joints in the place of words in capitals, and name this file in scenario.toml: `[clients.plant]` with
# `kind = \"plant\"` and `scene = \"plant.toml\"`. `onescan components KIND` says what a component can do,
# `onescan edit {name}` builds the machine in a browser.

version = 1
"
    );
    let mut taken = Taken::default();
    for proposal in proposals {
        let component = proposal.component(&taken.variable(proposal.signal()));
        // Writing to a text cannot fail.
        let _ = writeln!(text, "\n# {}", proposal.remark());
        for line in component.lines() {
            let _ = writeln!(text, "# {line}");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use onescan_plant::Scene;

    use super::*;
    use crate::io_list::Direction::{Input, Output};
    use crate::io_list::{IoPoint, Place};

    fn signal(name: &str, direction: Direction, ty: &str) -> Signal {
        let at = Place { file: Arc::from("list.csv"), line: None };
        let ty = ty.parse().expect("a type");
        let point = IoPoint { name: name.to_owned(), ty, direction, address: None, symbol: None, comment: None, at };
        Signal { name: name.to_owned(), point }
    }

    #[test]
    fn names_suggest_components() {
        let kind = |name: &str, direction, ty| rule_for(&signal(name, direction, ty)).map(|rule| rule.kind);
        assert_eq!(kind("LS_1", Input, "BOOL"), Some("light_barrier"));
        assert_eq!(kind("B2_Lichtschranke", Input, "BOOL"), Some("light_barrier"));
        assert_eq!(kind("xStartButton", Input, "BOOL"), Some("push_button"));
        assert_eq!(kind("Emergency_Stop", Input, "BOOL"), Some("emergency_stop"));
        assert_eq!(kind("B5_Lichtvorhang", Input, "BOOL"), Some("light_curtain"));
        assert_eq!(kind("Zweihand_OK", Input, "BOOL"), Some("two_hand_station"));
        assert_eq!(kind("S3_Schluessel", Input, "BOOL"), Some("key_switch"));
        assert_eq!(kind("Waage_1", Input, "REAL"), Some("weighing_cell"));
        assert_eq!(kind("H1_Ampel", Output, "BOOL"), Some("stack_light"));
        assert_eq!(kind("Stopper_1_Senken", Output, "BOOL"), Some("stopper"));
        assert_eq!(kind("Tank_Level", Input, "INT"), Some("tank"));
        assert_eq!(kind("MotorM1", Output, "BOOL"), Some("asynchronous_motor"));
        assert_eq!(kind("BeltRun", Output, "BOOL"), Some("conveyor"));
        assert_eq!([kind("False", Input, "BOOL"), kind("Start", Output, "BOOL")], [None, None]);
        assert_eq!(kind("Level_Text", Input, "STRING[8]"), None);
    }

    /// Each is a component of the library, with its keys, as soon as its `#` is taken away.
    #[test]
    fn what_is_proposed_is_a_scene() {
        let machine = "[[body]]\nname = \"BELT\"\nkind = \"kinematic\"\nshape = \"box\"\nsize_m = [1, 1, 1]\n
                       [[body]]\nname = \"BODY\"\nkind = \"dynamic\"\nshape = \"box\"\nsize_m = [1, 1, 1]\nmass_kg = 1\n
                       [[joint]]\nname = \"JOINT\"\nkind = \"prismatic\"\nparent = \"ground\"\nchild = \"BODY\"\naxis = [0, 0, 1]\n";
        for rule in RULES {
            let ty = if rule.value == Value::Bool { "BOOL" } else { "LREAL" };
            let signals = [signal(rule.words[0], rule.direction, ty)];
            let proposals = of(&signals);
            assert_eq!(proposals.len(), 1, "{rule:?}");
            let proposed = scene("cell", &[Proposal { rule, ..proposals[0] }]);
            let taken = proposed.lines().skip_while(|line| !line.starts_with("version"));
            let taken = taken.map(|line| line.strip_prefix("# ").filter(|line| !line.contains(" : ")).unwrap_or(line));
            let text = format!("{}\n{machine}", taken.collect::<Vec<_>>().join("\n"));
            let made = Scene::parse(&text, "plant.toml");
            assert!(made.is_ok(), "{:?}\n{text}", made.err());
        }
    }
}
