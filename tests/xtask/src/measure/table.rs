//! The figures as tables in Markdown.

use std::fmt::{Display, Write as _};

use super::Measured;
use super::package::PackageFigures;

const PACKAGE_HEAD: [&str; 21] = [
    "crate",
    "files",
    "src lines",
    "test lines",
    "median",
    "p90",
    "largest",
    "> 500",
    "`//` %",
    "`///` %",
    "docs",
    "<= 3 words",
    "%",
    "unwrap_or_default",
    "`let _ =`",
    "`_ => {}`",
    "assert / debug",
    "functions",
    "> 60 lines",
    "pub",
    "examples",
];

/// All figures.
pub(crate) fn markdown(measured: &Measured) -> String {
    let mut text = String::from("## Crates\n\n");
    head(&mut text, &PACKAGE_HEAD);
    for package in measured.packages.iter().chain([&measured.whole]) {
        package_row(&mut text, package);
    }
    text.push_str("\n## Documents\n\n");
    head(&mut text, &["place", "files", "words", "words of prose", "you/your", "per 1,000 words of prose"]);
    for each in &measured.documents {
        row(&mut text, &[&each.place, &each.files, &each.words, &each.prose_words, &each.you, &each.you_per_thousand]);
    }
    text.push_str("\n## Foreign sentences, without tests\n\n");
    head(&mut text, &["phrase", "better", "strings", "`//`", "`///`", "Markdown"]);
    for each in &measured.sentences {
        row(&mut text, &[&each.phrase, &each.better, &each.texts, &each.comments, &each.docs, &each.markdown]);
    }
    text.push_str("\n## Old words, with tests\n\n");
    head(&mut text, &["old", "new", "names", "comments", "strings", "Markdown"]);
    for each in &measured.old_words {
        row(&mut text, &[&each.old, &each.new, &each.code, &each.comments, &each.texts, &each.markdown]);
    }
    text
}

fn package_row(text: &mut String, of: &PackageFigures) {
    let largest = match of.largest_file.rsplit_once('/') {
        Some((_, name)) => format!("{} {name}", of.file_lines_max),
        None => String::new(),
    };
    let asserts = format!("{} / {}", of.asserts, of.debug_asserts);
    let long = format!("{} = {} %", of.functions_over_60, of.functions_over_60_percent);
    let cells: [&dyn Display; PACKAGE_HEAD.len()] = [
        &of.name,
        &of.files,
        &of.source_lines,
        &of.test_lines,
        &of.file_lines_median,
        &of.file_lines_p90,
        &largest,
        &of.files_over_500,
        &of.comment_percent,
        &of.doc_percent,
        &of.doc_blocks,
        &of.short_docs,
        &of.short_docs_percent,
        &of.unwrap_or_default,
        &of.let_underscore,
        &of.empty_arm,
        &asserts,
        &of.functions,
        &long,
        &of.public_items,
        &of.doc_examples,
    ];
    row(text, &cells);
}

fn head(text: &mut String, names: &[&str]) {
    let cells: Vec<&dyn Display> = names.iter().map(|name| name as &dyn Display).collect();
    row(text, &cells);
    text.push_str(&"|---".repeat(names.len()));
    text.push_str("|\n");
}

fn row(text: &mut String, cells: &[&dyn Display]) {
    for cell in cells {
        write!(text, "| {cell} ").expect("a string takes all");
    }
    text.push_str("|\n");
}
