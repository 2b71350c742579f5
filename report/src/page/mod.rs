//! One self-contained page: what was run, what came of it, in pictures. Nothing is loaded from elsewhere.
//!
//! | module | subject |
//! |---|---|
//! | [`section`] | one test or run |
//! | [`coverage`] | coverage by file |
//!
//! Equal runs give equal pages, except for the line in the header that says how long it took.

pub mod coverage;
pub mod section;

use maud::{DOCTYPE, Markup, PreEscaped, html};
use sha2::{Digest as _, Sha256};

use crate::table::Table;

pub use coverage::CoveredFile;
pub use section::{Event, Mood, Picture, Section, Shown};

const STYLE: &str = include_str!("style.css");

/// Ends a line of the page's text, so that two pages can be compared line by line.
const LINE: PreEscaped<&str> = PreEscaped("\n");

/// What a page shows.
#[derive(Clone, Debug, Default)]
pub struct Page {
    pub title: String,
    /// What came of it, in a line.
    pub totals: String,
    /// What there is to say of all together, as which cause made which tests fail, a line each.
    pub summary: Vec<String>,
    /// How long it all took; empty if that is not known.
    pub wall: String,
    pub sections: Vec<Section>,
    /// What stands first, a row for each section, in place of their results and steps.
    pub contents: Option<Table>,
    /// Files of the PLC's code; none where nothing was noted.
    pub coverage: Vec<CoveredFile>,
    /// What draws charts in place of pictures that have the data for it; without it, the pictures stay.
    pub charts: Option<ChartScript>,
}

/// Script and style of charts: a part of the page, as all else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChartScript {
    /// The script, a module.
    pub script: &'static str,
    pub style: &'static str,
}

impl Page {
    /// The page as HTML.
    pub fn to_html(&self) -> String {
        let Self { title, totals, summary, wall, sections, contents: own, coverage, charts } = self;
        let has_data = sections.iter().flat_map(|section| &section.pictures).any(|picture| picture.chart.is_some());
        let charts = charts.filter(|_| has_data);
        let script = charts.map(|charts| printable(charts.script));
        let policy = policy(script.as_deref());
        let moods = |wanted: fn(Mood) -> bool| sections.iter().any(|section| wanted(section.mood));
        let can_choose = moods(|mood| mood == Mood::Bad) && moods(|mood| mood != Mood::Bad);
        let made = format!("onescan {} {wall}", env!("CARGO_PKG_VERSION"));
        let page = html! {
            (DOCTYPE) (LINE)
            html lang="en" { (LINE)
                head { (LINE)
                    meta charset="utf-8"; (LINE)
                    meta http-equiv="Content-Security-Policy" content=(policy); (LINE)
                    meta name="viewport" content="width=device-width, initial-scale=1"; (LINE)
                    meta name="color-scheme" content="light dark"; (LINE)
                    title { (title) } (LINE)
                    style { (LINE) (PreEscaped(STYLE)) } (LINE)
                    @if let Some(charts) = charts { style { (PreEscaped(charts.style)) } (LINE) }
                } (LINE)
                body { (LINE)
                    header { h1 { (title) } (LINE)
                        p { (totals) } (LINE)
                        @if !summary.is_empty() {
                            ul class="summary" { @for line in summary { li { (line) } (LINE) } } (LINE)
                        }
                        @if can_choose { (only_bad()) (LINE) }
                        p class="made" { (made) }
                    } (LINE)
                    main { (LINE)
                        @if let Some(table) = own {
                            (own_contents(table, sections)) (LINE)
                        } @else if sections.len() > 1 {
                            (contents(sections)) (LINE)
                        }
                        @for (index, section) in sections.iter().enumerate() { (section.markup(index)) (LINE) }
                        @if !coverage.is_empty() { (coverage::markup(coverage)) (LINE) }
                    } (LINE)
                    @if let Some(script) = script { script type="module" { (PreEscaped(script)) } (LINE) }
                } (LINE)
            } (LINE)
        };
        printable(&page.into_string())
    }
}

/// What a browser may do with the page: show its own styles and pictures, and run no script but that of the charts.
fn policy(script: Option<&str>) -> String {
    let script = script.map(|script| format!("; script-src 'sha256-{}'", base64(&Sha256::digest(script))));
    let script = script.unwrap_or_default();
    format!("default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'{script}")
}

/// Bytes as policies have them (RFC 4648 4).
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for three in bytes.chunks(3) {
        let bits = three.iter().chain([0, 0].iter()).take(3).fold(0_u32, |bits, byte| bits << 8 | u32::from(*byte));
        for place in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * place) & 63) as usize];
            text.push(if place <= three.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

/// A box that hides all that is as it should be; styles do it, as the page may run no script.
fn only_bad() -> Markup {
    html! {
        p class="choice" { label { input type="checkbox" id="only-bad"; " only what is to be looked at" } }
    }
}

/// A line for each section.
fn contents(sections: &[Section]) -> Markup {
    html! {
        table class="contents" {
            thead { tr { th { "test" } th { "result" } th { "virtual time" } th { "steps" } } } (LINE)
            @for (index, section) in sections.iter().enumerate() {
                tr class=(section.mood.of()) {
                    td { a href=(format!("#t{index}")) { (section.title) } }
                    td class=(section.mood.class()) { (section.status) }
                    td { (section.virtual_time) }
                    td { @if let Some(steps) = section.steps { (steps) } }
                } (LINE)
            }
        }
    }
}

/// A table with a row for each section.
fn own_contents(table: &Table, sections: &[Section]) -> Markup {
    html! {
        table class="contents" {
            thead { tr { th { (table.title) } @for head in &table.head { th { (&**head) } } } } (LINE)
            @for (index, (row, section)) in table.rows.iter().zip(sections).enumerate() {
                tr class=(section.mood.of()) {
                    @for (column, cell) in row.iter().enumerate() {
                        @match column {
                            0 => td { a href=(format!("#t{index}")) { (cell) } },
                            1 => td class=(section.mood.class()) { (cell) },
                            _ => td { (cell) },
                        }
                    }
                } (LINE)
            }
        }
    }
}

/// HTML has no place for control characters, which an error's text may bring along. All text of a page goes
/// through here, so that none is forgotten.
fn printable(text: &str) -> String {
    let strange = |letter: char| letter < ' ' && !matches!(letter, '\n' | '\t');
    text.replace(strange, "\u{fffd}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_stays_text() {
        let page = Page { title: "a < b && \"c\"\u{1b}".to_owned(), ..Page::default() };
        assert!(page.to_html().contains("<h1>a &lt; b &amp;&amp; &quot;c&quot;\u{fffd}</h1>"));
    }

    #[test]
    fn no_script_but_that_of_the_charts_may_run() {
        assert_eq!([&b""[..], b"f", b"fo", b"foo", b"foob"].map(base64), ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg=="]);
        let none = policy(None);
        assert!(none.starts_with("default-src 'none'; ") && !none.contains("script-src"), "{none}");
        assert!(policy(Some("draw()")).ends_with("; script-src 'sha256-jm3FkV4tNIdBUr8jRVVl5n9PUixlaxTWD0pdpFiSH5A='"));
        assert!(
            Page::default()
                .to_html()
                .contains("<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'")
        );
    }

    #[test]
    fn data_of_a_chart_cannot_end_its_script() {
        let chart = Some("{\"signal\":\"</script><b>\"}".to_owned());
        let picture = Picture { chart, ..Picture::still("trajectories", "<svg></svg>".to_owned()) };
        let section = Section { pictures: vec![picture], ..Section::default() };
        let charts = Some(ChartScript { script: "draw()", style: "a{}" });
        let page = Page { sections: vec![section], charts, ..Page::default() };
        let text = page.to_html();
        assert!(text.contains("{\"signal\":\"\\u003c/script>\\u003cb>\"}</script>"), "{text}");
        assert!(text.contains("<script type=\"module\">draw()</script>") && text.contains("<svg></svg>"));
        let without = Page { sections: Vec::new(), ..page };
        assert!(!without.to_html().contains("draw()"), "no data, no script");
    }
}
