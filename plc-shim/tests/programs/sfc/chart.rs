//! Random charts that are safe: sequences, alternatives and simultaneous branches inside of each other.

use std::fmt::Write;

use proptest::prelude::*;

/// What a chart is made of.
#[derive(Debug, Clone)]
pub(crate) enum Part {
    Step,
    Sequence(Vec<Part>),
    Alternative(Vec<Part>),
    Simultaneous(Vec<Part>),
}

pub(crate) fn arbitrary_part() -> impl Strategy<Value = Part> {
    let several = |part| prop::collection::vec(part, 2..4);
    Just(Part::Step).prop_recursive(3, 14, 3, move |inner| {
        prop_oneof![
            several(inner.clone()).prop_map(Part::Sequence),
            several(inner.clone()).prop_map(Part::Alternative),
            several(inner).prop_map(Part::Simultaneous),
        ]
    })
}

/// How an action is used by a step.
#[derive(Debug, Clone)]
pub(crate) struct Use {
    pub(crate) step: usize,
    pub(crate) action: usize,
    pub(crate) qualifier: &'static str,
    pub(crate) time_ms: u64,
}

impl Use {
    /// Its time as it is written; nothing if its qualifier has none.
    pub(crate) fn time(&self) -> String {
        let timed = ["L", "D", "SD", "DS", "SL"].contains(&self.qualifier);
        if timed { format!("T#{}ms", self.time_ms) } else { String::new() }
    }
}

/// When a transition is cleared.
#[derive(Debug, Clone)]
pub(crate) enum Condition {
    Input(usize),
    Elapsed(usize, u64),
    Active(usize),
    Always,
}

#[derive(Debug, Clone)]
pub(crate) struct Link {
    pub(crate) from: Vec<usize>,
    pub(crate) to: Vec<usize>,
    pub(crate) condition: Condition,
    pub(crate) priority: Option<u32>,
}

/// A chart whose first step is the initial one.
#[derive(Debug, Clone, Default)]
pub(crate) struct Chart {
    pub(crate) steps: usize,
    pub(crate) links: Vec<Link>,
    pub(crate) uses: Vec<Use>,
}

pub(crate) const INPUTS: usize = 4;
/// Boolean actions come first, then those with statements.
pub(crate) const BOOLEAN: usize = 3;
pub(crate) const ACTIONS: usize = 6;

const QUALIFIERS: [&str; 11] = ["N", "R", "S", "P", "P0", "P1", "L", "D", "SD", "DS", "SL"];

/// The sets of steps that a part begins with, and those that it ends with.
type Ends = (Vec<Vec<usize>>, Vec<Vec<usize>>);

/// Numbers that decide what is not said, each used in its turn.
struct Choices<'c> {
    numbers: &'c [u32],
    at: usize,
}

impl Choices<'_> {
    fn below(&mut self, limit: usize) -> usize {
        self.at += 1;
        self.numbers[(self.at * 7) % self.numbers.len()] as usize % limit
    }
}

impl Chart {
    pub(crate) fn new(part: &Part, numbers: &[u32]) -> Self {
        let mut chart = Self { steps: 1, ..Self::default() };
        let mut choices = Choices { numbers, at: 0 };
        let inside = chart.add(part, &mut choices);
        let start = (vec![vec![0]], vec![vec![0]]);
        chart.join(&start, &inside, &mut choices);
        chart.join(&inside, &start, &mut choices);
        let mut is_timed = [false; ACTIONS];
        for step in 0..chart.steps {
            for _ in 0..choices.below(4) {
                let (action, number) = (choices.below(ACTIONS), choices.below(QUALIFIERS.len()));
                let timed = number > 5;
                // One association with a time for each action, so that no two of them meet.
                if timed && std::mem::replace(&mut is_timed[action], true) {
                    continue;
                }
                let time_ms = choices.below(5) as u64 * 10;
                chart.uses.push(Use { step, action, qualifier: QUALIFIERS[number], time_ms });
            }
        }
        chart
    }

    fn add(&mut self, part: &Part, choices: &mut Choices<'_>) -> Ends {
        match part {
            Part::Step => {
                self.steps += 1;
                let only = vec![vec![self.steps - 1]];
                (only.clone(), only)
            }
            Part::Sequence(parts) => {
                let all: Vec<Ends> = parts.iter().map(|part| self.add(part, choices)).collect();
                for pair in all.windows(2) {
                    self.join(&pair[0], &pair[1], choices);
                }
                (all[0].0.clone(), all[all.len() - 1].1.clone())
            }
            Part::Alternative(parts) => {
                let all: Vec<Ends> = parts.iter().map(|part| self.add(part, choices)).collect();
                let begin = all.iter().flat_map(|ends| ends.0.clone()).collect();
                (begin, all.iter().flat_map(|ends| ends.1.clone()).collect())
            }
            Part::Simultaneous(parts) => {
                let nothing = (vec![Vec::new()], vec![Vec::new()]);
                parts.iter().fold(nothing, |sum, part| {
                    let ends = self.add(part, choices);
                    (both(&sum.0, &ends.0), both(&sum.1, &ends.1))
                })
            }
        }
    }

    /// Transitions from every end of one part to every beginning of the next.
    fn join(&mut self, before: &Ends, behind: &Ends, choices: &mut Choices<'_>) {
        for from in &before.1 {
            for to in &behind.0 {
                let condition = match choices.below(6) {
                    0..=2 => Condition::Input(choices.below(INPUTS)),
                    3 => Condition::Elapsed(from[choices.below(from.len())], choices.below(4) as u64 * 10),
                    4 => Condition::Active(choices.below(self.steps)),
                    _ => Condition::Always,
                };
                let priority = (choices.below(3) == 0).then(|| choices.below(3) as u32);
                self.links.push(Link { from: from.clone(), to: to.clone(), condition, priority });
            }
        }
    }

    /// It as a program `P`.
    pub(crate) fn text(&self) -> String {
        let mut text = String::from("PROGRAM P\nVAR c0, c1, c2, c3, b0, b1, b2 : BOOL; log : UDINT; END_VAR\n");
        for step in 0..self.steps {
            let word = if step == 0 { "INITIAL_STEP" } else { "STEP" };
            let uses = self.uses.iter().filter(|used| used.step == step).map(|used| {
                let time = used.time();
                let time = if time.is_empty() { time } else { format!(", {time}") };
                format!("b{}({}{time}); ", used.action, used.qualifier)
            });
            let uses: String = uses.collect();
            writeln!(text, "{word} s{step}: {uses}END_STEP").expect("a string");
        }
        for link in &self.links {
            let list = |steps: &[usize]| {
                let names: Vec<_> = steps.iter().map(|step| format!("s{step}")).collect();
                if let [only] = names.as_slice() { only.clone() } else { format!("({})", names.join(", ")) }
            };
            let condition = match link.condition {
                Condition::Input(number) => format!("c{number}"),
                Condition::Elapsed(step, ms) => format!("s{step}.T >= T#{ms}ms"),
                Condition::Active(step) => format!("s{step}.X"),
                Condition::Always => "TRUE".to_owned(),
            };
            let priority = link.priority.map_or_else(String::new, |rank| format!("(PRIORITY := {rank}) "));
            let (from, to) = (list(&link.from), list(&link.to));
            writeln!(text, "TRANSITION {priority}FROM {from} TO {to} := {condition}; END_TRANSITION")
                .expect("a string");
        }
        for action in (BOOLEAN..ACTIONS).filter(|action| self.uses.iter().any(|used| used.action == *action)) {
            let value = format!("log := log * 31 + {} + BOOL_TO_UDINT(b{action}.Q);", action * 2);
            writeln!(text, "ACTION b{action}: {value} END_ACTION").expect("a string");
        }
        text + "END_PROGRAM\n"
    }
}

impl Chart {
    /// It as the body of an action, which runs while `go` holds and once more when it ends.
    pub(crate) fn nested(&self) -> String {
        let text = self.text();
        let split = |word: &str| text.find(word).map(|at| text.split_at(at));
        let (declared, rest) = split("INITIAL_STEP").expect("it has a step");
        let parts = rest.find("ACTION ").or_else(|| rest.find("END_PROGRAM")).expect("it has an end");
        let (chart, behind) = rest.split_at(parts);
        format!(
            "{declared}VAR go : BOOL; END_VAR
INITIAL_STEP Off: END_STEP
STEP On: Inner(N); END_STEP
TRANSITION FROM Off TO On := go; END_TRANSITION
TRANSITION FROM On TO Off := NOT go; END_TRANSITION
ACTION Inner:
{chart}END_ACTION
{behind}"
        )
    }
}

/// Each of the one joined with each of the other.
fn both(one: &[Vec<usize>], other: &[Vec<usize>]) -> Vec<Vec<usize>> {
    one.iter().flat_map(|left| other.iter().map(|right| [left.clone(), right.clone()].concat())).collect()
}
