//! The suites themselves, `FB_TestSuite` and what extends it, where `TcUnit` does not come to store results.
//!
//! `TcUnit` knows them by their addresses. All that extend one block begin as that does, so the place of a member in one
//! of them is its place in all.

use onescan_iec_run::without_home;

use super::memory::View;
use super::results::{Case, Suite, assertion, global};

/// The member by which a suite is recognised.
const PATH: &str = ".InstancePath";

/// The suites that have begun, in their order, with what is known of their tests.
pub(super) fn all(view: View) -> Vec<Suite> {
    let count = view.number(&global("NumberOfInitializedTestSuites")).unwrap_or(0);
    let Some((named, offset)) = any(view) else { return Vec::new() };
    let addresses = (1..=count).map_while(|number| view.number(&global(&format!("TestSuiteAddresses[{number}]"))));
    addresses.map(|address| suite(view.moved(offset, address), &named)).collect()
}

/// The path of some suite, and where it begins.
fn any(view: View) -> Option<(String, u32)> {
    let is_suite = |path: &str| view.number(&format!("{path}.NumberOfTests")).is_some();
    let paths = view.application.leaves().filter_map(|leaf| leaf.path.strip_suffix(PATH).map(str::to_owned));
    let named =
        paths.into_iter().find(|path| is_suite(path) && view.text(&format!("{path}.Tests[1].TestName")).is_some())?;
    let offset = view.application.variable(&named).ok()?.offset;
    Some((named, offset))
}

fn suite(view: View, at: &str) -> Suite {
    let path = view.text(&format!("{at}{PATH}")).unwrap_or_default();
    let name = without_home(&path).to_owned();
    let size = view.number(&format!("{at}.NumberOfTests")).unwrap_or(0);
    let cases = (1..=size).map_while(|number| case(view, &name, &format!("{at}.Tests[{number}]"))).collect();
    Suite { name, size, is_begun: view.is_true(&format!("{at}.StartedAt")), cases }
}

fn case(view: View, class: &str, at: &str) -> Option<Case> {
    let is_skipped = view.is_true(&format!("{at}.TestIsSkipped"));
    Some(Case {
        class: class.to_owned(),
        name: view.text(&format!("{at}.TestName"))?,
        is_finished: is_skipped || view.is_true(&format!("{at}.TestIsFinished")),
        is_failed: view.is_true(&format!("{at}.TestIsFailed")),
        is_skipped,
        message: view.text(&format!("{at}.AssertionMessage")).unwrap_or_default(),
        assertion: assertion(view, &format!("{at}.AssertionType")),
        asserts: view.number(&format!("{at}.NumberOfAssertions")).unwrap_or(0),
        duration_s: view.real(&format!("{at}.Duration")).unwrap_or(0.0),
    })
}
