//! Which statement of one program is which of the other, and which variable.

use std::collections::BTreeMap;
use std::ops::Range;

use super::record::{Place, own_text};
use onescan_iec_run::{Application, Declaration, Statement, StatementId, Variable, Way, WayId};
use onescan_soft_plc::journal::Part;
use similar::{Algorithm, DiffOp, capture_diff_slices};

/// The statements of two programs.
pub(super) struct Statements {
    /// Those of each, by their numbers.
    pub(super) known: [BTreeMap<StatementId, Statement>; 2],
    /// The partner of a statement in the other program.
    partner: [BTreeMap<StatementId, StatementId>; 2],
    /// The ways of decisions.
    pub(super) ways: [BTreeMap<WayId, Way>; 2],
}

impl Statements {
    pub(super) fn of(applications: &[Application; 2]) -> Self {
        let lists = applications.each_ref().map(Application::statements);
        let mut partner = [BTreeMap::new(), BTreeMap::new()];
        let units = lists.each_ref().map(by_unit);
        for (unit, ours) in &units[0] {
            let Some(theirs) = units[1].get(unit) else { continue };
            for (a, b) in pairs(ours, theirs) {
                partner[0].insert(a, b);
                partner[1].insert(b, a);
            }
        }
        let known = lists.map(|list| list.into_iter().map(|statement| (statement.id, statement)).collect());
        Self { known, partner, ways: applications.each_ref().map(Application::ways) }
    }

    /// True if the statement of the first program is that of the second.
    pub(super) fn are_one(&self, [a, b]: [StatementId; 2]) -> bool {
        self.partner[0].get(&a) == Some(&b)
    }

    /// True if the other program has such a statement.
    pub(super) fn has_partner(&self, side: usize, id: StatementId) -> bool {
        self.partner[side].contains_key(&id)
    }

    /// The statement that a statement is in the other program.
    pub(super) fn partner(&self, side: usize, id: StatementId) -> Option<StatementId> {
        self.partner[side].get(&id).copied()
    }

    /// Where a statement stands in its program.
    pub(super) fn place(&self, side: usize, id: StatementId) -> Option<Place> {
        let partner = self.partner(side, id).and_then(|other| self.known[1 - side].get(&other));
        self.known[side].get(&id).map(|own| Place::of(own, partner))
    }

    /// True if a statement reads in the other program as it does in its own.
    pub(super) fn is_unchanged(&self, side: usize, id: StatementId) -> bool {
        let other = self.partner[side].get(&id).and_then(|other| self.known[1 - side].get(other));
        self.known[side].get(&id).is_some_and(|own| other.is_some_and(|other| own_text(other) == own_text(own)))
    }

    /// True if two decisions went the same way.
    pub(super) fn same_way(&self, [a, b]: [WayId; 2]) -> bool {
        let branch = |side: usize, way: WayId| self.ways[side].get(&way).map(|way| way.branch);
        branch(0, a) == branch(1, b)
    }
}

/// The statements of each unit in the order of the text; the case of names does not matter.
fn by_unit(list: &Vec<Statement>) -> BTreeMap<String, Vec<&Statement>> {
    let mut units: BTreeMap<String, Vec<&Statement>> = BTreeMap::new();
    for statement in list {
        units.entry(statement.unit.to_ascii_lowercase()).or_default().push(statement);
    }
    for statements in units.values_mut() {
        statements.sort_by_key(|statement| (&statement.file, statement.line, statement.column));
    }
    units
}

/// What is the same, and what stands in the place of what.
fn pairs(ours: &[&Statement], theirs: &[&Statement]) -> Vec<(StatementId, StatementId)> {
    let texts = |list: &[&Statement]| list.iter().map(|statement| own_text(statement)).collect::<Vec<_>>();
    let operations = capture_diff_slices(Algorithm::Myers, &texts(ours), &texts(theirs));
    let mut found = Vec::new();
    for operation in operations {
        // Of as many, each stands for one; of fewer or more it is not known which.
        if let DiffOp::Equal { .. } | DiffOp::Replace { .. } = operation {
            let (old, new) = (operation.old_range(), operation.new_range());
            if old.len() == new.len() {
                found.extend(old.zip(new).map(|(old, new)| (ours[old].id, theirs[new].id)));
            }
        }
    }
    found
}

/// Variables that are declared otherwise in the other program.
pub(super) struct Declarations {
    /// By name, in small letters.
    changed: BTreeMap<String, Vec<[Declaration; 2]>>,
}

impl Declarations {
    pub(super) fn of(applications: &[Application; 2]) -> Self {
        let [a, b] = applications.each_ref().map(Application::declarations);
        let key = |each: &Declaration| (each.unit.to_ascii_lowercase(), each.name.to_ascii_lowercase());
        let theirs: BTreeMap<_, _> = b.into_iter().map(|each| (key(&each), each)).collect();
        let mut changed: BTreeMap<String, Vec<[Declaration; 2]>> = BTreeMap::new();
        for ours in a {
            if let Some(other) = theirs.get(&key(&ours)).filter(|other| other.rows != ours.rows) {
                changed.entry(ours.name.to_ascii_lowercase()).or_default().push([ours, other.clone()]);
            }
        }
        Self { changed }
    }

    /// The declarations of one that a text names, those of `unit` first.
    pub(super) fn named_in(&self, text: &str, unit: &str) -> Option<&[Declaration; 2]> {
        let mut found = names(text).filter_map(|name| self.changed.get(&name)).flatten();
        let first = found.clone().find(|[ours, _]| ours.unit.eq_ignore_ascii_case(unit));
        first.or_else(|| found.next())
    }
}

/// The names in a text, in small letters.
pub(super) fn names(text: &str) -> impl Iterator<Item = String> + Clone + '_ {
    let is_part = |letter: char| letter.is_alphanumeric() || letter == '_';
    let names = text.split(move |letter: char| !is_part(letter));
    names.filter(|name| !name.is_empty()).map(str::to_ascii_lowercase)
}

/// A variable that both programs have.
#[derive(Debug, Clone)]
pub(super) struct Leaf {
    pub(super) path: String,
    /// Where it lies in each.
    pub(super) variables: [Variable; 2],
}

impl Leaf {
    /// What it is in one run, as a literal.
    pub(super) fn text(&self, side: usize, application: &Application, memory: &[u8]) -> String {
        application.value_text(&self.variables[side], memory)
    }
}

/// The variables that both programs have, each of elementary type or a string.
pub(super) struct Leaves {
    pub(super) list: Vec<Leaf>,
    /// Of each side: first byte, end, greatest end so far and number, by first byte.
    places: [Vec<(usize, usize, usize, usize)>; 2],
}

impl Leaves {
    pub(super) fn of(applications: &[Application; 2]) -> Self {
        let [a, b] = applications;
        let mut theirs: BTreeMap<String, Variable> =
            b.leaves().map(|variable| (variable.path.to_ascii_lowercase(), variable)).collect();
        let mut list = Vec::new();
        for variable in a.leaves() {
            let Some(other) = theirs.remove(&variable.path.to_ascii_lowercase()) else { continue };
            if other.type_name == variable.type_name && other.size == variable.size {
                list.push(Leaf { path: variable.path.clone(), variables: [variable, other] });
            }
        }
        let places = [0, 1].map(|side| places(&list, side));
        Self { list, places }
    }

    /// The first byte behind all of them.
    pub(super) fn end(&self, side: usize) -> usize {
        self.places[side].last().map_or(0, |(_, _, greatest, _)| *greatest)
    }

    /// The parts of memory that they lie in.
    pub(super) fn parts(&self, side: usize) -> Vec<Part> {
        self.list.iter().map(|leaf| part(&leaf.variables[side])).collect()
    }

    /// Those that share bytes with a range of one side's memory.
    pub(super) fn within(&self, side: usize, range: Range<usize>) -> Vec<usize> {
        let places = &self.places[side];
        let before = places.partition_point(|(start, ..)| *start < range.end);
        let mut found = Vec::new();
        for (_, end, greatest, number) in places[..before].iter().rev() {
            if *greatest <= range.start {
                break;
            }
            if *end > range.start {
                found.push(*number);
            }
        }
        found.reverse();
        found
    }

    /// True if a variable has not the same value in both memories.
    pub(super) fn differs(&self, number: usize, memories: [&[u8]; 2]) -> bool {
        let values = [0, 1].map(|side| {
            let (range, bit) = part(&self.list[number].variables[side]);
            let bytes = memories[side].get(range).unwrap_or_default();
            bit.map_or_else(|| bytes.to_vec(), |bit| bytes.iter().map(|byte| byte >> bit & 1).collect())
        });
        values[0] != values[1]
    }
}

fn places(list: &[Leaf], side: usize) -> Vec<(usize, usize, usize, usize)> {
    let mut places: Vec<_> =
        list.iter().enumerate().map(|(number, leaf)| (part(&leaf.variables[side]).0, number)).collect();
    places.sort_by_key(|(range, number)| (range.start, *number));
    let mut greatest = 0;
    let place = |(range, number): (Range<usize>, usize)| {
        greatest = greatest.max(range.end);
        (range.start, range.end, greatest, number)
    };
    places.into_iter().map(place).collect()
}

fn part(variable: &Variable) -> Part {
    let start = variable.offset as usize;
    (start..start + variable.size as usize, variable.bit)
}
