//! Random programs of every statement: the compiled code and a direct interpretation leave the same memory,
//! to the last bit, and stop at the same statement with the same fault.
//!
//! | module | subject |
//! |---|---|
//! | [`program`] | what is generated, and its text |
//! | [`interpret`] | what it does |

mod interpret;
pub(crate) mod program;

use onescan_iec::Dialect;
use onescan_iec::syntax::printer::print_unit;
use onescan_iec::syntax::{FileId, parse};
use onescan_iec_run::{Application, FaultKind};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;

use crate::rig::{Rig, application, input_in};
use interpret::{Memory, Stop};
use program::{DEPTH, Statement, program, text, trying_program, trying_text};

/// What the PLC holds, in the interpreter's own form.
fn held(rig: &Rig) -> Memory {
    let number = |path: String| rig.int(&path);
    Memory {
        ints: [0, 1, 2, 3].map(|index| number(format!("P.v{index}")) as i16),
        bools: [0, 1, 2].map(|index| rig.bool(&format!("P.b{index}"))),
        array: [0, 1, 2, 3].map(|index| number(format!("P.a[{index}]")) as i32),
        loops: std::array::from_fn::<_, { DEPTH * 3 }, _>(|index| number(format!("P.i{index}")) as i16),
        counts: [0, 1].map(|index| number(format!("P.c{index}.total")) as i16),
        code: if rig.plc.application().variable("P.code").is_ok() { number("P.code".to_owned()) } else { 0 },
    }
}

/// Runs two scans of the program, and interprets them.
fn compare(
    text: &str,
    mut rig: Rig,
    body: &[Statement],
    ints: [i16; 4],
    bools: [bool; 3],
) -> Result<(), TestCaseError> {
    let mut memory = Memory { ints, bools, ..Memory::default() };
    for (index, value) in ints.iter().enumerate() {
        rig.set(&format!("P.v{index}"), i64::from(*value));
    }
    for (index, value) in bools.iter().enumerate() {
        rig.set(&format!("P.b{index}"), i64::from(*value));
    }
    for _ in 0..2 {
        let wanted = memory.run(body);
        let found = rig.scan();
        // Loops in loops may take more turns than a task has instructions for.
        if matches!(&found, Err(fault) if fault.kind == FaultKind::EndlessLoop) {
            break;
        }
        prop_assert_eq!(held(&rig), memory.clone(), "{}", text);
        match wanted {
            Ok(()) => prop_assert!(found.is_ok(), "{:?}", found),
            Err(Stop::Fault(kind)) => {
                prop_assert_eq!(found.map_err(|fault| fault.kind), Err(kind));
                break;
            }
            Err(_) => prop_assert!(false, "EXIT and CONTINUE stay in loops"),
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { max_shrink_iters: 300, ..ProptestConfig::with_cases(100) })]

    #[test]
    fn leave_the_memory_that_they_describe(
        body in program(),
        ints in any::<[i16; 4]>(),
        bools in any::<[bool; 3]>(),
    ) {
        let text = text(&body);
        compare(&text, Rig::new(&text), &body, ints, bools)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { max_shrink_iters: 300, ..ProptestConfig::with_cases(40) })]

    /// `__TRY`: in each of the builds, as what is noted must not change what a program does.
    #[test]
    fn go_on_after_faults_as_they_describe(
        body in trying_program(),
        ints in any::<[i16; 4]>(),
        bools in any::<[bool; 3]>(),
    ) {
        let text = trying_text(&body);
        compare(&text, Rig::in_dialect(Dialect::Codesys, &text), &body, ints, bools)?;
        let covered = Application::from_inputs_with_coverage([input_in(Dialect::Codesys, &text)]);
        compare(&text, Rig::of(&covered.expect("it compiles")), &body, ints, bools)?;
        let traced = Application::builder().inputs([input_in(Dialect::Codesys, &text)]).traced().build();
        compare(&text, Rig::of(&traced.expect("it compiles")), &body, ints, bools)?;
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
