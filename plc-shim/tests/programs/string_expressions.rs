//! Random string expressions: the compiled code and a direct evaluation agree on every character.
//! The evaluation here shares nothing with the compiler.

use proptest::prelude::*;

use crate::rig::Rig;

#[derive(Debug, Clone)]
enum Tree {
    Leaf(usize),
    Literal(String),
    Concat(Box<Tree>, Box<Tree>),
    Left(Box<Tree>, i64),
    Right(Box<Tree>, i64),
    Middle(Box<Tree>, i64, i64),
    Insert(Box<Tree>, Box<Tree>, i64),
    Delete(Box<Tree>, i64, i64),
    Replace(Box<Tree>, Box<Tree>, i64, i64),
    Max(Box<Tree>, Box<Tree>),
    /// `SEL(a < b, a, b)`
    Select(Box<Tree>, Box<Tree>),
}

fn tree() -> impl Strategy<Value = Tree> {
    let leaf = prop_oneof![(0_usize..3).prop_map(Tree::Leaf), "[a-c]{0,4}".prop_map(Tree::Literal)];
    leaf.prop_recursive(4, 20, 2, |inner| {
        let one = inner.clone().prop_map(Box::new);
        let two = (inner.clone().prop_map(Box::new), inner.prop_map(Box::new));
        let number = -2_i64..8;
        prop_oneof![
            two.clone().prop_map(|(a, b)| Tree::Concat(a, b)),
            (one.clone(), number.clone()).prop_map(|(a, l)| Tree::Left(a, l)),
            (one.clone(), number.clone()).prop_map(|(a, l)| Tree::Right(a, l)),
            (one.clone(), number.clone(), number.clone()).prop_map(|(a, l, p)| Tree::Middle(a, l, p)),
            (two.clone(), number.clone()).prop_map(|((a, b), p)| Tree::Insert(a, b, p)),
            (one, number.clone(), number.clone()).prop_map(|(a, l, p)| Tree::Delete(a, l, p)),
            (two.clone(), number.clone(), number).prop_map(|((a, b), l, p)| Tree::Replace(a, b, l, p)),
            two.clone().prop_map(|(a, b)| Tree::Max(a, b)),
            two.prop_map(|(a, b)| Tree::Select(a, b)),
        ]
    })
}

fn text(tree: &Tree) -> String {
    match tree {
        Tree::Leaf(index) => format!("v{index}"),
        Tree::Literal(text) => format!("'{text}'"),
        Tree::Concat(a, b) => format!("CONCAT({}, {})", text(a), text(b)),
        Tree::Left(a, l) => format!("LEFT({}, {l})", text(a)),
        Tree::Right(a, l) => format!("RIGHT({}, {l})", text(a)),
        Tree::Middle(a, l, p) => format!("MID({}, {l}, {p})", text(a)),
        Tree::Insert(a, b, p) => format!("INSERT({}, {}, {p})", text(a), text(b)),
        Tree::Delete(a, l, p) => format!("DELETE({}, {l}, {p})", text(a)),
        Tree::Replace(a, b, l, p) => format!("REPLACE({}, {}, {l}, {p})", text(a), text(b)),
        Tree::Max(a, b) => format!("MAX({}, {})", text(a), text(b)),
        Tree::Select(a, b) => format!("SEL({} < {}, {}, {})", text(a), text(b), text(a), text(b)),
    }
}

fn value(tree: &Tree, leaves: &[String]) -> String {
    let sub = |tree: &Tree| value(tree, leaves);
    let count = |length: i64| length.max(0) as usize;
    match tree {
        Tree::Leaf(index) => leaves[*index].clone(),
        Tree::Literal(text) => text.clone(),
        Tree::Concat(a, b) => sub(a) + &sub(b),
        Tree::Left(a, l) => sub(a).chars().take(count(*l)).collect(),
        Tree::Right(a, l) => {
            let a = sub(a);
            a.chars().skip(a.len().saturating_sub(count(*l))).collect()
        }
        Tree::Middle(a, _, p) if *p < 1 || *p as usize > sub(a).len() => String::new(),
        Tree::Middle(a, l, p) => sub(a).chars().skip(*p as usize - 1).take(count(*l)).collect(),
        Tree::Insert(a, b, p) => {
            let mut whole = sub(a);
            if (0..=whole.len() as i64).contains(p) {
                whole.insert_str(*p as usize, &sub(b));
            }
            whole
        }
        Tree::Delete(a, l, p) => replaced(sub(a), "", *l, *p),
        Tree::Replace(a, b, l, p) => replaced(sub(a), &sub(b), *l, *p),
        Tree::Max(a, b) => sub(a).max(sub(b)),
        Tree::Select(a, b) => {
            let (a, b) = (sub(a), sub(b));
            if a < b { b } else { a }
        }
    }
}

fn replaced(mut whole: String, by: &str, length: i64, position: i64) -> String {
    if (1..=whole.len() as i64).contains(&position) {
        let start = position as usize - 1;
        let end = (start + length.max(0) as usize).min(whole.len());
        whole.replace_range(start..end, by);
    }
    whole
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn strings(tree in tree(), leaves in prop::array::uniform3("[a-c]{0,6}")) {
        let [a, b, c] = &leaves;
        let mut rig = Rig::new(&format!(
            "PROGRAM P VAR r : STRING[2000]; s : STRING[3]; n : INT; v0 : STRING[6] := '{a}'; v1 : STRING := '{b}'; v2 : STRING[9] := '{c}'; END_VAR
             r := {}; s := r; n := LEN(r); END_PROGRAM",
            text(&tree)
        ));
        rig.scan().expect("no fault");
        let wanted = value(&tree, &leaves);
        prop_assert_eq!(rig.text("P.s"), wanted.chars().take(3).collect::<String>());
        prop_assert_eq!(rig.int("P.n"), wanted.len() as i64);
        prop_assert_eq!(rig.text("P.r"), wanted);
    }
}
