//! Files of TwinCAT whose text is broken and that no task uses: the target's build leaves them out, as `check` does
//! (W0731), and so they stay as they are.

use std::collections::BTreeSet;

use onescan_iec::diagnostic::{Code, Diagnostic, Severity};
use onescan_iec::input::Input;
use onescan_iec::lint::inspect;
use onescan_iec::syntax::SourceMap;
use onescan_iec::syntax::parser::parse_source;

/// The names of files of `inputs` that hold what no task uses, if the text of a file of `sources` is broken.
pub(super) fn names(inputs: &[Input], sources: &SourceMap) -> BTreeSet<String> {
    let is_broken = sources.iter().any(|(id, file)| parse_source(id, file).diagnostics.iter().any(is_error));
    if !is_broken {
        return BTreeSet::new();
    }
    let found = inspect(inputs.iter().cloned(), None);
    let unused = found.findings().iter().filter(|found| found.diagnostic().code == Code::UnusedUnit);
    unused.map(|found| found.file().to_owned()).collect()
}

/// What is said of a file that stays as it is; nothing if its text is whole.
pub(super) fn warning(findings: &[Diagnostic]) -> Option<Diagnostic> {
    let first = findings.iter().find(|found| is_error(found))?;
    let message = format!(
        "no task uses what stands here, so it stays as it is, without the shim: {} {}",
        first.code.text(),
        first.message
    );
    let help = "correct it before a program uses it, or take it out of the project";
    Some(Diagnostic::warning(Code::UnusedUnit, first.span, message).with_help(help))
}

fn is_error(found: &Diagnostic) -> bool {
    found.severity == Severity::Error
}

#[cfg(test)]
mod tests {
    use onescan_iec::input::Input;
    use onescan_iec::input::kind::SourceKind;

    use crate::instrument::{Options, Target, instrument};

    fn object(name: &str, declaration: &str, body: &str) -> Input {
        let text = format!(
            "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<TcPlcObject>\n<POU Name=\"{name}\" Id=\"{{1}}\">\n<Declaration><![CDATA[{declaration}]]>\
             </Declaration>\n<Implementation>\n<ST><![CDATA[{body}]]></ST>\n</Implementation>\n</POU>\n</TcPlcObject>\n"
        );
        Input::from_text(&format!("{name}.TcPOU"), SourceKind::TwinCat, text)
    }

    #[test]
    fn what_is_broken_and_unused_stays_as_it_is() {
        let task = "<TcPlcObject><Task Name=\"T\"><CycleTime>10000</CycleTime><Priority>1</Priority><PouCall><Name>MAIN</Name>\
            </PouCall></Task></TcPlcObject>";
        let task = Input::from_text("T.TcTTO", SourceKind::TwinCat, task);
        let main = |uses: &str| object("MAIN", &format!("PROGRAM MAIN VAR t : TON; {uses} END_VAR"), "t(IN := TRUE);");
        let draft = || object("Draft", "FUNCTION_BLOCK Draft VAR t : TON; END_VAR", "IF t.Q THEN t(IN :=");
        let options = Options { target: Target::TwinCat, ..Options::default() };
        let made = instrument(&[task.clone(), main(""), draft()], &options).expect("it is instrumented");
        let changed = |name: &str| made.files.iter().any(|file| file.name == name && file.is_changed());
        assert!(changed("MAIN.TcPOU") && !changed("Draft.TcPOU"));
        let said: Vec<String> = made.warnings.iter().map(|found| found.message.clone()).collect();
        assert!(
            said.iter().any(|said| said.starts_with("no task uses what stands here, so it stays as it is")),
            "{said:?}"
        );
        assert!(instrument(&[task, main("d : Draft;"), draft()], &options).is_err(), "what is used is compiled");
    }
}
