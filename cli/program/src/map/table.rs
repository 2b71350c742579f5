//! The mapping for people and machines, in the order in which the points lie.

use std::io::{self, Write};

use onescan_links::gateway::listing::{Listing, Part, Row};
use serde::Serialize;

pub(super) struct Table<'a> {
    pub(super) client: &'a str,
    pub(super) url: &'a str,
    pub(super) layout: Option<u32>,
    pub(super) listing: &'a Listing,
}

/// The mapping for machines.
#[derive(Serialize)]
struct Json<'a> {
    client: &'a str,
    url: &'a str,
    /// What `SDSP_Layout` must be; absent if the PLC's sources are not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    layout: Option<u32>,
    to_plc: JsonPart<'a>,
    from_plc: JsonPart<'a>,
}

#[derive(Serialize)]
struct JsonPart<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    place: Option<&'a str>,
    points: Vec<JsonPoint<'a>>,
}

#[derive(Serialize)]
struct JsonPoint<'a> {
    address: &'a str,
    #[serde(rename = "type")]
    ty: String,
    /// The signal, or the word.
    name: &'a str,
    /// The variable's path, where it is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    variable: Option<&'a str>,
    word: bool,
}

impl<'a> JsonPart<'a> {
    fn of(part: &'a Part) -> Self {
        let point = |row: &'a Row| JsonPoint {
            address: &row.address,
            ty: row.point.ty.to_string(),
            name: &row.point.name,
            variable: row.point.variable.as_deref(),
            word: row.point.is_word(),
        };
        Self { place: part.place.as_deref(), points: part.rows.iter().map(point).collect() }
    }
}

impl Table<'_> {
    pub(super) fn write_json(&self, out: &mut dyn Write) -> io::Result<()> {
        let Self { client, url, layout, listing } = *self;
        let (to_plc, from_plc) = (JsonPart::of(&listing.to_plc), JsonPart::of(&listing.from_plc));
        serde_json::to_writer_pretty(&mut *out, &Json { client, url, layout, to_plc, from_plc })?;
        writeln!(out)
    }

    pub(super) fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "{} over {}", self.client, self.url)?;
        match self.layout {
            Some(layout) => writeln!(out, "layout number {layout}")?,
            None => writeln!(out, "no layout number: the sources of this PLC are not known")?,
        }
        let Listing { to_plc, from_plc } = self.listing;
        let rows = || to_plc.rows.iter().chain(&from_plc.rows);
        let widest = |text: &dyn Fn(&Row) -> usize| rows().map(text).max().unwrap_or(0);
        let address = widest(&|row| row.address.chars().count());
        let ty = widest(&|row| row.point.ty.to_string().chars().count());
        let name = widest(&|row| row.point.name.chars().count());
        for (title, part) in [("to the PLC", to_plc), ("from the PLC", from_plc)] {
            let place = part.place.as_ref().map(|place| format!(" ({place})")).unwrap_or_default();
            writeln!(out, "\n{title}{place}")?;
            for Row { point, address: at } in &part.rows {
                let variable = point.variable.as_deref().unwrap_or("");
                let written = point.ty.to_string();
                let line = format!("  {at:address$}  {written:ty$}  {:name$}  {variable}", point.name);
                writeln!(out, "{}", line.trim_end())?;
            }
        }
        Ok(())
    }
}
