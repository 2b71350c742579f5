//! What the project names and nobody declares, and how it is used.

use std::collections::{BTreeMap, BTreeSet};

use super::ty::Slot;

/// The arguments that calls give.
#[derive(Debug, Clone, Default)]
pub(super) struct Signature {
    /// What is given without a name, by position.
    pub(super) positional: Vec<Argument>,
    /// `a := x`, in the order in which they were found first.
    pub(super) named: Vec<Named>,
    pub(super) outputs: Vec<(String, Slot)>,
    /// The result is used.
    pub(super) is_used: bool,
    /// How many arguments the call gives that gives the fewest.
    pub(super) fewest: Option<usize>,
}

impl Signature {
    /// The parameters by their places: calls with names give the names, others the number. A place that no name can
    /// have has one from its number.
    pub(super) fn in_order(&self) -> Vec<(String, Argument)> {
        let mut open: Vec<&Named> = self.named.iter().collect();
        let mut given: Vec<(String, Argument)> = Vec::new();
        loop {
            let place = given.len();
            let next = open.iter().position(|named| named.behind <= place).map(|index| open.remove(index));
            match (next, self.positional.get(place)) {
                (Some(named), _) => given.push((named.name.clone(), named.argument)),
                (None, Some(argument)) => given.push((format!("p{}", place + 1), *argument)),
                // What stands behind all places stands there in its order.
                (None, None) if open.is_empty() => return given,
                (None, None) => {
                    let named = open.remove(0);
                    given.push((named.name.clone(), named.argument));
                }
            }
        }
    }
}

/// A parameter that calls name.
#[derive(Debug, Clone)]
pub(super) struct Named {
    pub(super) name: String,
    pub(super) argument: Argument,
    /// So many arguments without names stand before it: its place is not one of theirs.
    pub(super) behind: usize,
}

/// What is given for a parameter.
#[derive(Debug, Clone, Copy)]
pub(super) struct Argument {
    pub(super) slot: Slot,
    /// All that was given are variables.
    pub(super) is_place: bool,
}

/// A member of a type that nobody declares.
#[derive(Debug, Clone, Default)]
#[expect(clippy::struct_excessive_bools, reason = "each is a use that was seen or not")]
pub(super) struct Member {
    pub(super) name: String,
    pub(super) field: Option<Slot>,
    pub(super) read: bool,
    pub(super) written_inside: bool,
    pub(super) written_outside: bool,
    /// A member or an element of it is written.
    pub(super) written_below: bool,
    pub(super) input: bool,
    /// It is the bound of an array or the like.
    pub(super) is_constant: bool,
    /// It is used as `SUPER^.member`, which properties are.
    pub(super) via_super: bool,
    pub(super) called: Option<(Signature, Slot)>,
}

/// A type that nobody declares.
#[derive(Debug, Clone, Default)]
#[expect(clippy::struct_excessive_bools, reason = "each is a use that was seen or not")]
pub(super) struct Foreign {
    pub(super) name: String,
    /// The type as a value: an alias has its type.
    pub(super) value: Option<Slot>,
    pub(super) members: BTreeMap<String, Member>,
    /// The members' keys, in the order in which they were found.
    pub(super) order: Vec<String>,
    pub(super) called: bool,
    /// A variable of it, not its value, is what a member begins with.
    pub(super) is_held: bool,
    /// So many constants are given to it, as a generic block.
    pub(super) constants: usize,
    /// So many inputs are given without names.
    pub(super) inputs: usize,
    pub(super) base_of_block: bool,
    /// A CLASS extends it, which extends classes alone.
    pub(super) base_of_class: bool,
    pub(super) base_of_interface: bool,
    pub(super) base_of_structure: bool,
    pub(super) implemented: bool,
    /// Interfaces that what is of the type, or of a type derived from it, is given for.
    pub(super) stands_for: BTreeSet<String>,
    pub(super) init: Option<Signature>,
    /// Names of its values, as an enumeration.
    pub(super) values: Vec<String>,
    /// The first index of arrays that its values are indices of.
    pub(super) first_index: i128,
    /// Names of variables of it.
    pub(super) variables: BTreeSet<String>,
    /// It is the type of what a call gives.
    pub(super) is_value: bool,
    /// It got its name here.
    pub(super) is_anonymous: bool,
    /// The key of the declared unit that it adds members to.
    pub(super) extends_stub: bool,
}

impl Foreign {
    pub(super) fn member(&mut self, name: &str) -> &mut Member {
        let key = name.to_ascii_uppercase();
        if !self.members.contains_key(&key) {
            self.order.push(key.clone());
        }
        self.members.entry(key).or_insert_with(|| Member { name: name.to_owned(), ..Member::default() })
    }

    pub(super) fn add_value(&mut self, name: &str) {
        if !self.values.iter().any(|known| known.eq_ignore_ascii_case(name)) {
            self.values.push(name.to_owned());
        }
    }
}

/// A function that nobody declares.
#[derive(Debug, Clone)]
pub(super) struct Function {
    pub(super) name: String,
    pub(super) signature: Signature,
    pub(super) result: Slot,
}

/// A global variable or constant that nobody declares.
#[derive(Debug, Clone)]
pub(super) struct Global {
    pub(super) name: String,
    pub(super) slot: Slot,
    pub(super) written: bool,
    /// It is the bound of an array or the like.
    pub(super) is_constant: bool,
}

/// How an unknown name that begins an expression is used.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each is a use that was seen or not")]
pub(super) struct Head {
    pub(super) name: String,
    /// It is a value by itself, is indexed or followed.
    pub(super) bare: bool,
    pub(super) called: bool,
    pub(super) written: bool,
    /// What follows its dot.
    pub(super) parts: BTreeSet<String>,
    pub(super) part_called: bool,
    pub(super) part_written: bool,
    pub(super) part_deep: bool,
    /// It is used where no base of an unknown type can have it.
    pub(super) outside: bool,
}

/// What the project names and nobody declares, by keys.
#[derive(Debug, Default)]
pub(super) struct Needs {
    pub(super) types: BTreeMap<String, Foreign>,
    pub(super) functions: BTreeMap<String, Function>,
    pub(super) globals: BTreeMap<String, Global>,
    /// Names of libraries in front of types.
    pub(super) libraries: BTreeMap<String, String>,
    /// Names of lists of globals.
    pub(super) lists: BTreeMap<String, String>,
    /// Types of libraries whose names the project has for units of its own.
    pub(super) shadowed: BTreeSet<String>,
    pub(super) heads: BTreeMap<String, Head>,
    /// Types that are other names of structures which go into one another: as written, and the key of the one that is
    /// declared.
    pub(super) aliases: BTreeMap<String, (String, String)>,
    /// What an earlier pass has found of types and the interfaces that they stand for, with those ones' members.
    pub(super) relations: Relations,
}

/// Types and the interfaces that they stand for.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Relations {
    pub(super) stands_for: BTreeMap<String, BTreeSet<String>>,
    /// Members of each interface that something stands for.
    pub(super) members: BTreeMap<String, BTreeSet<String>>,
}

impl Relations {
    pub(super) fn of(types: &BTreeMap<String, Foreign>) -> Self {
        let mut found = Self::default();
        for (key, each) in types.iter().filter(|(_, each)| !each.stands_for.is_empty()) {
            found.stands_for.insert(key.clone(), each.stands_for.clone());
            for interface in &each.stands_for {
                let members = types.get(interface).map(|each| each.members.keys().cloned().collect());
                found.members.insert(interface.clone(), members.unwrap_or_default());
            }
        }
        found
    }

    /// The interface above a type that has the member; the type itself if none has.
    pub(super) fn home<'k>(&'k self, key: &'k str, member: &str) -> &'k str {
        let above = self.stands_for.get(key).into_iter().flatten();
        let member = member.to_ascii_uppercase();
        let mut has = above.filter(|each| self.members.get(*each).is_some_and(|members| members.contains(&member)));
        // Two that stand for each other agree on one of them.
        has.find(|each| !self.stands_for.get(*each).is_some_and(|back| back.contains(key)) || each.as_str() < key)
            .map_or(key, String::as_str)
    }
}
