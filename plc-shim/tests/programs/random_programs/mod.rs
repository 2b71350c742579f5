//! Random programs of every statement: the compiled code and a direct interpretation leave the same memory,
//! to the last bit, and stop at the same statement with the same fault.
//!
//! | module | subject |
//! |---|---|
//! | [`program`] | what is generated, and its text |
//! | [`interpret`] | what it does |

mod interpret;
pub(crate) mod program;

use onescan_iec::syntax::printer::print_unit;
use onescan_iec::syntax::{FileId, parse};
use onescan_iec_run::FaultKind;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;

use crate::rig::{Rig, application};
use interpret::{Memory, Stop};
use program::{DEPTH, program, text};

/// What the PLC holds, in the interpreter's own form.
fn held(rig: &Rig) -> Memory {
    let number = |path: String| rig.int(&path);
    Memory {
        ints: [0, 1, 2, 3].map(|index| number(format!("P.v{index}")) as i16),
        bools: [0, 1, 2].map(|index| rig.bool(&format!("P.b{index}"))),
        array: [0, 1, 2, 3].map(|index| number(format!("P.a[{index}]")) as i32),
        loops: std::array::from_fn::<_, { DEPTH * 3 }, _>(|index| number(format!("P.i{index}")) as i16),
        counts: [0, 1].map(|index| number(format!("P.c{index}.total")) as i16),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { max_shrink_iters: 300, ..ProptestConfig::with_cases(100) })]

    #[test]
    fn leave_the_memory_that_they_describe(
        body in program(),
        ints in any::<[i16; 4]>(),
        bools in any::<[bool; 3]>(),
    ) {
        let mut rig = Rig::new(&text(&body));
        let mut memory = Memory { ints, bools, ..Memory::default() };
        for (index, value) in ints.iter().enumerate() {
            rig.set(&format!("P.v{index}"), i64::from(*value));
        }
        for (index, value) in bools.iter().enumerate() {
            rig.set(&format!("P.b{index}"), i64::from(*value));
        }
        for _ in 0..2 {
            let wanted = memory.run(&body);
            let found = rig.scan();
            // Loops in loops may take more turns than a task has instructions for.
            if matches!(&found, Err(fault) if fault.kind == FaultKind::EndlessLoop) {
                break;
            }
            prop_assert_eq!(held(&rig), memory.clone());
            match wanted {
                Ok(()) => prop_assert!(found.is_ok(), "{:?}", found),
                Err(Stop::Fault(kind)) => {
                    prop_assert_eq!(found.map_err(|fault| fault.kind), Err(kind));
                    break;
                }
                Err(_) => prop_assert!(false, "EXIT and CONTINUE stay in loops"),
            }
        }
    }
}

/// Spans aside, a printed tree is the tree: it prints alike and compiles to the same code.
#[test]
fn are_printed_as_what_they_are() {
    let printed = |source: &str| {
        let parsed = parse(FileId(0), source);
        assert_eq!(parsed.diagnostics, [], "{source}");
        print_unit(&parsed.unit)
    };
    let config = ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(60) };
    let outcome = TestRunner::new(config).run(&program(), |body| {
        let source = text(&body);
        let once = printed(&source);
        prop_assert_eq!(&printed(&once), &once);
        let (before, after) = (application(&source), application(&once));
        prop_assert_eq!(before.wasm(), after.wasm());
        Ok(())
    });
    outcome.unwrap_or_else(|failure| panic!("{failure}"));
}
