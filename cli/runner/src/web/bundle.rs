//! The page itself: what `web/` makes, as a part of the program.

use onescan_report::page::ChartScript;

/// A file of the page: its name, its media type, what it is.
pub(super) type File = (&'static str, &'static str, &'static [u8]);

include!(concat!(env!("OUT_DIR"), "/page.rs"));

/// The answer of a program that was built without the page.
pub(super) const ABSENT: &str =
    "this program was built without its page: `npm ci && npm run build` in `web/`, then build the program again";

/// The file of this path.
pub(super) fn file(path: &str) -> Option<File> {
    let name = if path == "/" { "index.html" } else { path.trim_start_matches('/') };
    PAGE.iter().copied().find(|(known, ..)| *known == name)
}

/// What draws the charts of reports, as the page draws trends; nothing in a program that was built without its page.
pub fn charts() -> Option<ChartScript> {
    let text = |name: &str| file(name).and_then(|(_, _, bytes)| std::str::from_utf8(bytes).ok());
    Some(ChartScript { script: text("report.js")?, style: text("report.css")? })
}

/// Whether there is a page.
pub(super) fn is_there() -> bool {
    !PAGE.is_empty()
}
