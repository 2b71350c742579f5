//! Random networks without loops: what they give, compiled, is what their elements give, one by one.

use std::fmt::Write;

use proptest::prelude::*;

use crate::plcopen::{block, input, output, program, rig};

/// What an element does with the values of two before it.
#[derive(Debug, Clone, Copy)]
enum Function {
    Add,
    Sub,
    Mul,
    Max,
    Min,
}

const FUNCTIONS: [(Function, &str); 5] = [
    (Function::Add, "ADD"),
    (Function::Sub, "SUB"),
    (Function::Mul, "MUL"),
    (Function::Max, "MAX"),
    (Function::Min, "MIN"),
];

fn apply(function: Function, a: i16, b: i16) -> i16 {
    match function {
        Function::Add => a.wrapping_add(b),
        Function::Sub => a.wrapping_sub(b),
        Function::Mul => a.wrapping_mul(b),
        Function::Max => a.max(b),
        Function::Min => a.min(b),
    }
}

/// Function, sources and height of an element.
type Element = (usize, usize, usize, u32);

/// Four inputs, then elements of which each takes two values from what is before it; where each stands is as
/// random as everything else.
fn network() -> impl Strategy<Value = (Vec<i16>, Vec<Element>)> {
    let element = (0..FUNCTIONS.len(), any::<usize>(), any::<usize>(), 0..400_u32);
    (prop::collection::vec(any::<i16>(), 4), prop::collection::vec(element, 1..30))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn a_random_network_gives_what_its_elements_give((inputs, elements) in network()) {
        let mut values = inputs.clone();
        let mut body = String::new();
        for at in 0..inputs.len() {
            body += &input(at as u32, (0, 7 * at as u32), &format!("i{at}"));
        }
        for (function, left, right, y) in elements {
            let (left, right) = (left % values.len(), right % values.len());
            let (function, name) = FUNCTIONS[function];
            let from = |at: usize| if at < inputs.len() { format!("{at}") } else { format!("{at}.OUT") };
            let pins = format!("IN1={} IN2={}", from(left), from(right));
            body += &block(values.len() as u32, (y * 13 % 50, y), name, &pins, "OUT", "");
            values.push(apply(function, values[left], values[right]));
        }
        let mut sections = String::from("local r0 : INT");
        for (at, value) in inputs.iter().enumerate() {
            write!(sections, ", i{at} : INT = {value}").expect("a string");
        }
        for at in inputs.len()..values.len() {
            body += &output(1000 + at as u32, (500, at as u32), &format!("{at}.OUT"), &format!("o{at}"), "");
            write!(sections, ", o{at} : INT").expect("a string");
        }
        let mut rig = rig(&program(&sections, "FBD", &body));
        rig.scan().expect("no fault");
        for (at, value) in values.iter().enumerate().skip(inputs.len()) {
            prop_assert_eq!(rig.int(&format!("P.o{at}")), i64::from(*value));
        }
    }
}
