//! The page itself: what `web/` makes, as a part of the program.

use onescan_page::{File, files};
use onescan_report::page::ChartScript;

/// The answer of a program that was built without the page.
pub(super) const ABSENT: &str =
    "this program was built without its page: `npm ci && npm run build` in `web/`, then build the program again";

/// The file of this path.
pub(super) fn file(path: &str) -> Option<File> {
    let name = if path == "/" { "index.html" } else { path.trim_start_matches('/') };
    files().iter().copied().find(|(known, ..)| *known == name)
}

/// What draws the charts of reports, as the page draws trends; nothing in a program that was built without its page.
pub fn charts() -> Option<ChartScript> {
    let text = |name: &str| file(name).and_then(|(_, _, bytes)| std::str::from_utf8(bytes).ok());
    Some(ChartScript { script: text("report.js")?, style: text("report.css")? })
}

/// Whether there is a page.
pub(super) fn is_there() -> bool {
    !files().is_empty()
}

/// How many bytes it has as the program holds it.
pub(super) fn size() -> usize {
    files().iter().map(|(_, _, bytes)| bytes.len()).sum()
}
