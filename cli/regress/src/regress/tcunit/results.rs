//! What `TcUnit` stores when its suites have finished: `ST_TestSuiteResults`.

use onescan_iec::ElementaryType;
use onescan_iec_run::{Application, Variable};

use super::super::memory_text::bytes;
use super::memory::View;

/// The list of global variables that `TcUnit` has.
const GLOBALS: &str = "GVL_TcUnit";

/// What is known of a test.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Case {
    /// The path of the suite that it is in.
    pub(super) class: String,
    pub(super) name: String,
    pub(super) is_finished: bool,
    pub(super) is_failed: bool,
    pub(super) is_skipped: bool,
    /// The text of the first assert that did not hold.
    pub(super) message: String,
    /// Of which type that is, as in `INT`.
    pub(super) assertion: Option<String>,
    pub(super) asserts: u64,
    pub(super) duration_s: f64,
}

/// A suite and its tests.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Suite {
    pub(super) name: String,
    /// How many tests it has, also of those that there is no room for.
    pub(super) size: u64,
    /// True if it has been called.
    pub(super) is_begun: bool,
    pub(super) cases: Vec<Case>,
}

/// Where `TcUnit` says how far it is.
pub(super) struct Results {
    stored: Variable,
    /// Messages that are still to be sent.
    waiting: Option<Variable>,
}

impl Results {
    /// Where they are in an application that has `TcUnit`.
    pub(super) fn find(application: &Application) -> Option<Self> {
        let found = |path: &str| application.variable(&format!("{GLOBALS}.{path}")).ok();
        let stored = found("TcUnitRunner.TestResults.StoredGeneralTestResults")?;
        found("TcUnitRunner.TestResults.TestSuiteResults.NumberOfTestSuites")?;
        let waiting = found("AdsMessageQueue.MemRingBuffer.nCount");
        (stored.ty == Some(ElementaryType::Bool)).then_some(Self { stored, waiting })
    }

    /// True if all suites have finished and their results are stored.
    pub(super) fn are_stored(&self, memory: &[u8]) -> bool {
        is_not_zero(&self.stored, memory)
    }

    /// True if no message waits to be sent.
    pub(super) fn are_sent(&self, memory: &[u8]) -> bool {
        !self.waiting.as_ref().is_some_and(|waiting| is_not_zero(waiting, memory))
    }
}

fn is_not_zero(variable: &Variable, memory: &[u8]) -> bool {
    bytes(variable, memory).is_some_and(|bytes| bytes.iter().any(|byte| *byte != 0))
}

/// The path of what `TcUnit` has in its global variables.
pub(super) fn global(member: &str) -> String {
    format!("{GLOBALS}.{member}")
}

/// The suites that are stored, in their order.
pub(super) fn stored(view: View) -> Vec<Suite> {
    let all = global("TcUnitRunner.TestResults.TestSuiteResults");
    let suites = view.number(&format!("{all}.NumberOfTestSuites")).unwrap_or(0);
    (1..=suites).map(|number| suite(view, &format!("{all}.TestSuiteResults[{number}]"))).collect()
}

fn suite(view: View, at: &str) -> Suite {
    let size = view.number(&format!("{at}.NumberOfTests")).unwrap_or(0);
    let cases = (1..=size).map_while(|number| case(view, &format!("{at}.TestCaseResults[{number}]")));
    let name = view.text(&format!("{at}.Name")).unwrap_or_default();
    Suite { name, size, is_begun: true, cases: cases.collect() }
}

fn case(view: View, at: &str) -> Option<Case> {
    Some(Case {
        class: view.text(&format!("{at}.TestClassName"))?,
        name: view.text(&format!("{at}.TestName"))?,
        is_finished: true,
        is_failed: view.is_true(&format!("{at}.TestIsFailed")),
        is_skipped: view.is_true(&format!("{at}.TestIsSkipped")),
        message: view.text(&format!("{at}.FailureMessage")).unwrap_or_default(),
        assertion: assertion(view, &format!("{at}.FailureType")),
        asserts: view.number(&format!("{at}.NumberOfAsserts")).unwrap_or(0),
        duration_s: view.real(&format!("{at}.Duration")).unwrap_or(0.0),
    })
}

/// `INT` of `Type_INT`; nothing where no assert has failed.
pub(super) fn assertion(view: View, at: &str) -> Option<String> {
    let name = view.name(at)?;
    let ty = name.strip_prefix("Type_")?;
    (ty != "UNDEFINED").then(|| ty.to_owned())
}
