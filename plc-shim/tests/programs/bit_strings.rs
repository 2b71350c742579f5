//! Random expressions of bit strings, durations and moments: the compiled code and a direct evaluation agree
//! on every bit. The evaluation here shares nothing with the compiler.

use proptest::prelude::*;

use crate::rig::Rig;

#[derive(Debug, Clone)]
enum Bits {
    Leaf(usize),
    Not(Box<Bits>),
    Join(&'static str, Box<Bits>, Box<Bits>),
    /// `SHL`, `SHR`, `ROL`, `ROR` by a count.
    Move(&'static str, Box<Bits>, i64),
    /// `SEL(a < b, c, d)`
    Select(Box<[Bits; 4]>),
    /// `LIMIT(a, b, c)`
    Limit(Box<[Bits; 3]>),
}

fn bits() -> impl Strategy<Value = Bits> {
    let leaf = (0_usize..4).prop_map(Bits::Leaf);
    leaf.prop_recursive(4, 24, 4, |inner| {
        let boxed = inner.clone().prop_map(Box::new).boxed();
        let join = prop::sample::select(&["AND", "OR", "XOR"][..]);
        let shift = prop::sample::select(&["SHL", "SHR", "ROL", "ROR"][..]);
        prop_oneof![
            boxed.clone().prop_map(Bits::Not),
            (join, boxed.clone(), boxed.clone()).prop_map(|(op, a, b)| Bits::Join(op, a, b)),
            (shift, boxed, -2_i64..70).prop_map(|(op, a, n)| Bits::Move(op, a, n)),
            prop::array::uniform4(inner.clone()).prop_map(|trees| Bits::Select(Box::new(trees))),
            prop::array::uniform3(inner).prop_map(|trees| Bits::Limit(Box::new(trees))),
        ]
    })
}

fn bits_text(tree: &Bits) -> String {
    let sub = bits_text;
    match tree {
        Bits::Leaf(index) => format!("v{index}"),
        Bits::Not(a) => format!("(NOT {})", sub(a)),
        Bits::Join(op, a, b) => format!("({} {op} {})", sub(a), sub(b)),
        Bits::Move(op, a, n) => format!("{op}({}, {n})", sub(a)),
        Bits::Select(t) => format!("SEL({} < {}, {}, {})", sub(&t[0]), sub(&t[1]), sub(&t[2]), sub(&t[3])),
        Bits::Limit(t) => format!("LIMIT({}, {}, {})", sub(&t[0]), sub(&t[1]), sub(&t[2])),
    }
}

fn bits_value(tree: &Bits, width: u32, leaves: &[u64; 4]) -> u64 {
    let sub = |tree: &Bits| bits_value(tree, width, leaves);
    let mask = u64::MAX >> (64 - width);
    let rotated = |value: u64, left: u32| match left % width {
        0 => value,
        left => (value << left | value >> (width - left)) & mask,
    };
    match tree {
        Bits::Leaf(index) => leaves[*index] & mask,
        Bits::Not(a) => !sub(a) & mask,
        Bits::Join("AND", a, b) => sub(a) & sub(b),
        Bits::Join("OR", a, b) => sub(a) | sub(b),
        Bits::Join(_, a, b) => sub(a) ^ sub(b),
        Bits::Move("ROL", a, n) => rotated(sub(a), n.rem_euclid(i64::from(width)) as u32),
        Bits::Move("ROR", a, n) => rotated(sub(a), (-n).rem_euclid(i64::from(width)) as u32),
        Bits::Move(_, _, n) if !(0..i64::from(width)).contains(n) => 0,
        Bits::Move("SHL", a, n) => sub(a) << n & mask,
        Bits::Move(_, a, n) => sub(a) >> n,
        Bits::Select(t) => sub(if sub(&t[0]) < sub(&t[1]) { &t[3] } else { &t[2] }),
        Bits::Limit(t) => sub(&t[1]).max(sub(&t[0])).min(sub(&t[2])),
    }
}

#[derive(Debug, Clone)]
enum Span {
    Leaf(usize),
    Negate(Box<Span>),
    Join(&'static str, Box<Span>, Box<Span>),
    Scale(Box<Span>, i32),
    Divide(Box<Span>, i32),
    /// `a - b` of two moments.
    Between(Box<Moment>, Box<Moment>),
    Least(Box<Span>, Box<Span>),
}

#[derive(Debug, Clone)]
enum Moment {
    Leaf(usize),
    Later(Box<Moment>, Box<Span>),
    Earlier(Box<Moment>, Box<Span>),
    /// Midnight before, and the time of day put together again some time later.
    Rebuilt(Box<Moment>, Box<Span>),
}

fn moment(span: BoxedStrategy<Span>) -> impl Strategy<Value = Moment> {
    let leaf = (0_usize..2).prop_map(Moment::Leaf);
    leaf.prop_recursive(2, 4, 2, move |inner| {
        let pair = (inner.prop_map(Box::new), span.clone().prop_map(Box::new)).boxed();
        prop_oneof![
            pair.clone().prop_map(|(m, s)| Moment::Later(m, s)),
            pair.clone().prop_map(|(m, s)| Moment::Earlier(m, s)),
            pair.prop_map(|(m, s)| Moment::Rebuilt(m, s)),
        ]
    })
}

fn span() -> impl Strategy<Value = Span> {
    let leaf = (0_usize..3).prop_map(Span::Leaf);
    leaf.prop_recursive(3, 16, 2, |inner| {
        let boxed = inner.clone().prop_map(Box::new).boxed();
        let moment = moment(inner.boxed()).prop_map(Box::new).boxed();
        let join = prop::sample::select(&["+", "-"][..]);
        prop_oneof![
            boxed.clone().prop_map(Span::Negate),
            (join, boxed.clone(), boxed.clone()).prop_map(|(op, a, b)| Span::Join(op, a, b)),
            (boxed.clone(), -5_i32..9).prop_map(|(a, n)| Span::Scale(a, n)),
            (boxed.clone(), prop_oneof![1_i32..9, -9_i32..0]).prop_map(|(a, n)| Span::Divide(a, n)),
            (moment.clone(), moment).prop_map(|(a, b)| Span::Between(a, b)),
            (boxed.clone(), boxed).prop_map(|(a, b)| Span::Least(a, b)),
        ]
    })
}

fn span_text(tree: &Span) -> String {
    let sub = span_text;
    match tree {
        Span::Leaf(index) => format!("t{index}"),
        Span::Negate(a) => format!("(-{})", sub(a)),
        Span::Join(op, a, b) => format!("({} {op} {})", sub(a), sub(b)),
        Span::Scale(a, n) => format!("({} * DINT#{n})", sub(a)),
        Span::Divide(a, n) => format!("DIV_LTIME({}, DINT#{n})", sub(a)),
        Span::Between(a, b) => format!("({} - {})", moment_text(a), moment_text(b)),
        Span::Least(a, b) => format!("MIN({}, {})", sub(a), sub(b)),
    }
}

fn moment_text(tree: &Moment) -> String {
    match tree {
        Moment::Leaf(index) => format!("m{index}"),
        Moment::Later(m, s) => format!("({} + {})", moment_text(m), span_text(s)),
        Moment::Earlier(m, s) => format!("SUB_LDT_LTIME({}, {})", moment_text(m), span_text(s)),
        Moment::Rebuilt(m, s) => {
            let (m, s) = (moment_text(m), span_text(s));
            format!("CONCAT_DATE_LTOD(LDT_TO_LDATE({m}), LDT_TO_LTOD({m}) + {s})")
        }
    }
}

const DAY: i64 = 86_400_000_000_000;

struct Clock {
    spans: [i64; 3],
    moments: [i64; 2],
}

impl Clock {
    fn span(&self, tree: &Span) -> i64 {
        match tree {
            Span::Leaf(index) => self.spans[*index],
            Span::Negate(a) => self.span(a).wrapping_neg(),
            Span::Join("+", a, b) => self.span(a).wrapping_add(self.span(b)),
            Span::Join(_, a, b) => self.span(a).wrapping_sub(self.span(b)),
            Span::Scale(a, n) => self.span(a).wrapping_mul(i64::from(*n)),
            Span::Divide(a, n) => self.span(a).wrapping_div(i64::from(*n)),
            Span::Between(a, b) => self.moment(a).wrapping_sub(self.moment(b)),
            Span::Least(a, b) => self.span(a).min(self.span(b)),
        }
    }

    fn moment(&self, tree: &Moment) -> i64 {
        match tree {
            Moment::Leaf(index) => self.moments[*index],
            Moment::Later(m, s) => self.moment(m).wrapping_add(self.span(s)),
            Moment::Earlier(m, s) => self.moment(m).wrapping_sub(self.span(s)),
            Moment::Rebuilt(m, s) => {
                let moment = self.moment(m);
                let time = moment.rem_euclid(DAY);
                moment.wrapping_sub(time).wrapping_add(time.wrapping_add(self.span(s)).rem_euclid(DAY))
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(80))]

    #[test]
    fn bit_strings(
        (name, width) in prop::sample::select(&[("BYTE", 8), ("WORD", 16), ("DWORD", 32), ("LWORD", 64)][..]),
        tree in bits(),
        leaves in any::<[u64; 4]>(),
    ) {
        let text = bits_text(&tree);
        let mut rig = Rig::new(&format!("PROGRAM P VAR r, v0, v1, v2, v3 : {name}; END_VAR r := {text}; END_PROGRAM"));
        for (index, leaf) in leaves.iter().enumerate() {
            rig.set(&format!("P.v{index}"), *leaf as i64);
        }
        rig.scan().expect("no fault");
        prop_assert_eq!(u64::from_le_bytes(rig.bytes("P.r")), bits_value(&tree, width, &leaves));
    }

    #[test]
    fn durations_and_moments(
        tree in span(),
        spans in prop::array::uniform3(prop_oneof![-2 * DAY..2 * DAY, any::<i64>()]),
        moments in prop::array::uniform2(-9_000 * DAY..9_000 * DAY),
    ) {
        let mut rig = Rig::new(&format!(
            "PROGRAM P VAR r, t0, t1, t2 : LTIME; m0, m1 : LDT; END_VAR r := {}; END_PROGRAM",
            span_text(&tree)
        ));
        for (index, span) in spans.iter().enumerate() {
            rig.set(&format!("P.t{index}"), *span);
        }
        for (index, moment) in moments.iter().enumerate() {
            rig.set(&format!("P.m{index}"), *moment);
        }
        rig.scan().expect("no fault");
        prop_assert_eq!(rig.int("P.r"), Clock { spans, moments }.span(&tree));
    }
}
