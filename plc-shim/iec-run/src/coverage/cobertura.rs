//! The report format of Cobertura (`coverage-04.dtd`): a class for each file.

use std::collections::BTreeMap;
use std::io;

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};

use super::{Coverage, FileCoverage, covered};

impl Coverage {
    /// As a Cobertura report. It has no time of its making, so that equal runs give equal reports.
    ///
    /// # Errors
    /// The XML writer's own; it has no reason for one while it writes to memory.
    pub fn to_cobertura(&self) -> io::Result<String> {
        let mut writer = Writer::new_with_indent(Vec::new(), b' ', 2);
        self.write(&mut writer)?;
        let mut text = String::from_utf8(writer.into_inner()).map_err(io::Error::other)?;
        text.push('\n');
        Ok(text)
    }

    fn write(&self, writer: &mut Writer<Vec<u8>>) -> io::Result<()> {
        writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
        writer.write_event(Event::DocType(BytesText::from_escaped(
            r#"coverage SYSTEM "http://cobertura.sourceforge.net/xml/coverage-04.dtd""#,
        )))?;
        if let Some(from) = self.counted_from {
            let note = format!(" A run was resumed: it is counted from {from} on. ");
            writer.write_event(Event::Comment(BytesText::new(&note)))?;
        }
        let ((lines, lines_hit), (branches, branches_hit)) = (self.lines(), self.branches());
        let numbers = [
            ("line-rate", rate(lines, lines_hit)),
            ("branch-rate", rate(branches, branches_hit)),
            ("lines-covered", lines_hit.to_string()),
            ("lines-valid", lines.to_string()),
            ("branches-covered", branches_hit.to_string()),
            ("branches-valid", branches.to_string()),
            ("complexity", "0".to_owned()),
            ("version", env!("CARGO_PKG_VERSION").to_owned()),
            ("timestamp", "0".to_owned()),
        ];
        let root = writer.create_element("coverage").with_attributes(pairs(&numbers));
        root.write_inner_content(|writer| {
            writer.create_element("sources").write_inner_content(|writer| {
                writer.create_element("source").write_text_content(BytesText::new(".")).map(drop)
            })?;
            writer.create_element("packages").write_inner_content(|writer| self.write_package(writer)).map(drop)
        })
        .map(drop)
    }

    fn write_package(&self, writer: &mut Writer<Vec<u8>>) -> io::Result<()> {
        let ((lines, lines_hit), (branches, branches_hit)) = (self.lines(), self.branches());
        let rates = rates((lines, lines_hit), (branches, branches_hit), "plc");
        writer
            .create_element("package")
            .with_attributes(pairs(&rates))
            .write_inner_content(|writer| {
                let classes = writer.create_element("classes");
                let all = |writer: &mut Writer<Vec<u8>>| {
                    self.files.iter().try_for_each(|(name, file)| write_class(writer, name, file))
                };
                classes.write_inner_content(all).map(drop)
            })
            .map(drop)
    }
}

fn rate(all: usize, some: usize) -> String {
    format!("{:.4}", if all == 0 { 1.0 } else { some as f64 / all as f64 })
}

fn rates(lines: (usize, usize), branches: (usize, usize), name: &str) -> [(&'static str, String); 4] {
    [
        ("name", name.to_owned()),
        ("line-rate", rate(lines.0, lines.1)),
        ("branch-rate", rate(branches.0, branches.1)),
        ("complexity", "0".to_owned()),
    ]
}

fn pairs<'p>(attributes: &'p [(&'static str, String)]) -> impl Iterator<Item = (&'p str, &'p str)> {
    attributes.iter().map(|(name, value)| (*name, value.as_str()))
}

fn write_class(writer: &mut Writer<Vec<u8>>, name: &str, file: &FileCoverage) -> io::Result<()> {
    let lines = covered(file.lines.values());
    let branches = covered(file.decisions.values().flat_map(BTreeMap::values));
    let [_, line_rate, branch_rate, complexity] = rates(lines, branches, name);
    let attributes = [("name", name.to_owned()), ("filename", name.to_owned()), line_rate, branch_rate, complexity];
    writer
        .create_element("class")
        .with_attributes(pairs(&attributes))
        .write_inner_content(|writer| {
            writer.create_element("methods").write_inner_content(|writer| {
                file.units.iter().try_for_each(|((line, unit), count)| write_method(writer, *line, unit, *count))
            })?;
            let decisions = by_line(file);
            let lines = writer.create_element("lines");
            let all = |writer: &mut Writer<Vec<u8>>| {
                file.lines.iter().try_for_each(|(line, count)| write_line(writer, *line, *count, decisions.get(line)))
            };
            lines.write_inner_content(all).map(drop)
        })
        .map(drop)
}

fn write_method(writer: &mut Writer<Vec<u8>>, line: u32, unit: &str, count: u64) -> io::Result<()> {
    let called = (1, usize::from(count > 0));
    let [name, line_rate, branch_rate, complexity] = rates(called, (0, 0), unit);
    let attributes = [name, ("signature", "()".to_owned()), line_rate, branch_rate, complexity];
    let method = writer.create_element("method").with_attributes(pairs(&attributes));
    method
        .write_inner_content(|writer| {
            let lines = writer.create_element("lines");
            lines.write_inner_content(|writer| write_line(writer, line, count, None)).map(drop)
        })
        .map(drop)
}

/// Outcomes of all decisions of a line, and how many occurred.
fn by_line(file: &FileCoverage) -> BTreeMap<u32, (usize, usize)> {
    let mut found: BTreeMap<u32, (usize, usize)> = BTreeMap::new();
    for ((line, _), outcomes) in &file.decisions {
        let (all, some) = covered(outcomes.values());
        let known = found.entry(*line).or_default();
        *known = (known.0 + all, known.1 + some);
    }
    found
}

fn write_line(
    writer: &mut Writer<Vec<u8>>,
    line: u32,
    count: u64,
    branches: Option<&(usize, usize)>,
) -> io::Result<()> {
    let mut attributes =
        vec![("number", line.to_string()), ("hits", count.to_string()), ("branch", branches.is_some().to_string())];
    if let Some((all, some)) = branches {
        let percent = 100 * some / (*all).max(1);
        attributes.push(("condition-coverage", format!("{percent}% ({some}/{all})")));
    }
    writer.create_element("line").with_attributes(pairs(&attributes)).write_empty().map(drop)
}
