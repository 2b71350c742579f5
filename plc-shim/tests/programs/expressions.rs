//! Random well-typed expressions: the compiled code and a direct evaluation agree to the last
//! bit. The evaluation here shares nothing with the compiler.

use proptest::prelude::*;

use crate::rig::Rig;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Width {
    Sint,
    Uint,
    Dint,
    Ulint,
    Lint,
}

impl Width {
    fn name(self) -> &'static str {
        match self {
            Self::Sint => "SINT",
            Self::Uint => "UINT",
            Self::Dint => "DINT",
            Self::Ulint => "ULINT",
            Self::Lint => "LINT",
        }
    }

    fn cut(self, value: i128) -> i128 {
        match self {
            Self::Sint => i128::from(value as i8),
            Self::Uint => i128::from(value as u16),
            Self::Dint => i128::from(value as i32),
            Self::Ulint => i128::from(value as u64),
            Self::Lint => i128::from(value as i64),
        }
    }
}

#[derive(Debug, Clone)]
enum Tree {
    Leaf(usize),
    Negate(Box<Tree>),
    Binary(&'static str, Box<Tree>, Box<Tree>),
    Max(Box<Tree>, Box<Tree>),
    /// `SEL(a < b, c, d)`
    Select(&'static str, Box<[Tree; 4]>),
}

fn tree(operators: &'static [&'static str]) -> impl Strategy<Value = Tree> {
    let leaf = (0_usize..4).prop_map(Tree::Leaf);
    leaf.prop_recursive(5, 40, 4, move |inner| {
        let operator = prop::sample::select(operators);
        let comparison = prop::sample::select(&["<", "<=", ">", ">=", "=", "<>"][..]);
        let boxed = |tree: Tree| Box::new(tree);
        prop_oneof![
            inner.clone().prop_map(move |a| Tree::Negate(boxed(a))),
            (operator, inner.clone(), inner.clone()).prop_map(move |(op, a, b)| Tree::Binary(op, boxed(a), boxed(b))),
            (inner.clone(), inner.clone()).prop_map(move |(a, b)| Tree::Max(boxed(a), boxed(b))),
            (comparison, prop::array::uniform4(inner)).prop_map(|(op, trees)| Tree::Select(op, Box::new(trees))),
        ]
    })
}

/// `negate` spells what `-` stands for: unsigned types have no sign.
fn text(tree: &Tree, signed: bool) -> String {
    let sub = |tree: &Tree| text(tree, signed);
    match tree {
        Tree::Leaf(index) => format!("v{index}"),
        Tree::Negate(a) if signed => format!("(-{})", sub(a)),
        Tree::Negate(a) => format!("(0 - {})", sub(a)),
        Tree::Binary(op, a, b) => format!("({} {op} {})", sub(a), sub(b)),
        Tree::Max(a, b) => format!("MAX({}, {})", sub(a), sub(b)),
        Tree::Select(op, t) => {
            format!("SEL({} {op} {}, {}, {})", sub(&t[0]), sub(&t[1]), sub(&t[2]), sub(&t[3]))
        }
    }
}

fn holds<T: PartialOrd>(op: &str, a: &T, b: &T) -> bool {
    match op {
        "<" => a < b,
        "<=" => a <= b,
        ">" => a > b,
        ">=" => a >= b,
        "=" => a == b,
        _ => a != b,
    }
}

/// Nothing is a PLC fault.
fn integer(tree: &Tree, width: Width, leaves: &[i128]) -> Option<i128> {
    let sub = |tree: &Tree| integer(tree, width, leaves);
    Some(width.cut(match tree {
        Tree::Leaf(index) => leaves[*index],
        Tree::Negate(a) => -sub(a)?,
        Tree::Binary(op, a, b) => {
            let (a, b) = (sub(a)?, sub(b)?);
            match *op {
                "+" => a + b,
                "-" => a - b,
                "*" => a.wrapping_mul(b),
                "/" => a.checked_div(b)?,
                _ if b == 0 => 0,
                _ => a % b,
            }
        }
        Tree::Max(a, b) => sub(a)?.max(sub(b)?),
        Tree::Select(op, t) => {
            let (left, right) = (sub(&t[0])?, sub(&t[1])?);
            let (if_false, if_true) = (sub(&t[2])?, sub(&t[3])?);
            if holds(op, &left, &right) { if_true } else { if_false }
        }
    }))
}

fn real(tree: &Tree, leaves: &[f64], round: fn(f64) -> f64) -> Option<f64> {
    let sub = |tree: &Tree| real(tree, leaves, round);
    Some(round(match tree {
        Tree::Leaf(index) => leaves[*index],
        Tree::Negate(a) => -sub(a)?,
        Tree::Binary(op, a, b) => {
            let (a, b) = (sub(a)?, sub(b)?);
            match *op {
                "+" => a + b,
                "-" => a - b,
                "*" => a * b,
                _ if b == 0.0 => return None,
                _ => a / b,
            }
        }
        Tree::Max(a, b) => {
            let (a, b) = (sub(a)?, sub(b)?);
            // WebAssembly's maximum: NaN wins, and 0 is greater than -0.
            if a.is_nan() || b.is_nan() {
                f64::NAN
            } else if a == b {
                if a.is_sign_negative() { b } else { a }
            } else {
                a.max(b)
            }
        }
        Tree::Select(op, t) => {
            let (left, right) = (sub(&t[0])?, sub(&t[1])?);
            let (if_false, if_true) = (sub(&t[2])?, sub(&t[3])?);
            if holds(op, &left, &right) { if_true } else { if_false }
        }
    }))
}

fn program(ty: &str, tree: &Tree, signed: bool) -> String {
    let expression = text(tree, signed);
    format!("PROGRAM P VAR r, v0, v1, v2, v3 : {ty}; END_VAR r := {expression}; END_PROGRAM")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn integers(
        width in prop::sample::select(&[Width::Sint, Width::Uint, Width::Dint, Width::Ulint, Width::Lint][..]),
        tree in tree(&["+", "-", "*", "/", "MOD"]),
        leaves in prop::array::uniform4(prop_oneof![any::<i64>(), -3_i64..3, Just(i64::MIN), Just(-128)]),
    ) {
        let signed = !matches!(width, Width::Uint | Width::Ulint);
        let mut rig = Rig::new(&program(width.name(), &tree, signed));
        let leaves = leaves.map(|leaf| width.cut(i128::from(leaf)));
        for (index, leaf) in leaves.iter().enumerate() {
            rig.set(&format!("P.v{index}"), *leaf as i64);
        }
        match integer(&tree, width, &leaves) {
            Some(wanted) => {
                rig.scan().expect("no fault");
                prop_assert_eq!(width.cut(i128::from(rig.int("P.r"))), wanted);
            }
            None => prop_assert!(rig.scan().is_err()),
        }
    }

    #[test]
    fn reals(
        single in any::<bool>(),
        tree in tree(&["+", "-", "*", "/"]),
        leaves in prop::array::uniform4(prop_oneof![any::<f64>(), -2.0_f64..2.0, Just(0.0), Just(-0.0), Just(f64::INFINITY)]),
    ) {
        let mut rig = Rig::new(&program(if single { "REAL" } else { "LREAL" }, &tree, true));
        let round: fn(f64) -> f64 = if single { |x| f64::from(x as f32) } else { |x| x };
        let leaves = leaves.map(round);
        for (index, leaf) in leaves.iter().enumerate() {
            let path = format!("P.v{index}");
            if single {
                rig.set_bytes(&path, &(*leaf as f32).to_le_bytes());
            } else {
                rig.set_bytes(&path, &leaf.to_le_bytes());
            }
        }
        match real(&tree, &leaves, round) {
            Some(wanted) => {
                rig.scan().expect("no fault");
                let found = rig.real("P.r");
                let same = found.to_bits() == wanted.to_bits() || found.is_nan() && wanted.is_nan();
                prop_assert!(same, "{} {}", found, wanted);
            }
            None => prop_assert!(rig.scan().is_err()),
        }
    }

    #[test]
    fn booleans(bits in any::<[bool; 4]>(), shape in "[abcd](( AND | OR | XOR | & )(NOT )?[abcd]){0,8}") {
        let names = ["a", "b", "c", "d"];
        let mut rig = Rig::new(&format!(
            "PROGRAM P VAR r, a, b, c, d : BOOL; END_VAR r := {shape}; END_PROGRAM"
        ));
        for (name, bit) in names.iter().zip(bits) {
            rig.set(&format!("P.{name}"), i64::from(bit));
        }
        rig.scan().expect("no fault");
        prop_assert_eq!(rig.bool("P.r"), boolean(&shape, bits));
    }
}

/// OR binds loosest, then XOR, then AND (2nd ed. Table 52).
fn boolean(text: &str, bits: [bool; 4]) -> bool {
    let text = text.replace('&', "AND");
    let operand = |word: &str| {
        let (negated, name) = word.strip_prefix("NOT ").map_or((false, word), |name| (true, name));
        bits[(name.as_bytes()[0] - b'a') as usize] != negated
    };
    text.split(" OR ")
        .any(|term| term.split(" XOR ").fold(false, |sum, factor| sum ^ factor.split(" AND ").all(operand)))
}
