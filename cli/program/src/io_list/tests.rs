//! Readers, given lists that are cut, changed and made to do harm: they answer with a list or an error.

use std::io::{Cursor, Write};
use std::path::Path;

use proptest::prelude::*;

use super::*;

/// A reader, and a list that it reads.
type Case = (&'static str, ListKind, &'static [u8]);

const CASES: &[Case] = &[
    ("press.tsproj", ListKind::TwinCat, include_bytes!("fixtures/press.tsproj")),
    ("term.xti", ListKind::TwinCat, include_bytes!("fixtures/term.xti")),
    ("press.tmc", ListKind::TwinCat, include_bytes!("fixtures/press.tmc")),
    ("press-eni.xml", ListKind::Eni, include_bytes!("fixtures/press-eni.xml")),
    ("press-tags.xml", ListKind::TiaXml, include_bytes!("fixtures/press-tags.xml")),
    ("press.sdf", ListKind::TiaText, include_bytes!("fixtures/press.sdf")),
    ("press-tags.csv", ListKind::TiaText, include_bytes!("fixtures/press-tags.csv")),
    ("press-mapping.csv", ListKind::Codesys, include_bytes!("fixtures/press-mapping.csv")),
];

fn read_bytes(name: &str, kind: ListKind, bytes: &[u8]) -> Result<IoList, ListError> {
    let path = Path::new(name);
    match kind {
        ListKind::TwinCat => twincat::read(path, bytes, None),
        ListKind::Eni => eni::read(path, bytes),
        ListKind::TiaXlsx => tia_xlsx::read(path, bytes.to_vec()),
        ListKind::TiaXml => tia_xml::read(path, bytes),
        ListKind::TiaText => tia_text::read(path, bytes),
        ListKind::Codesys => codesys::read(path, bytes),
        ListKind::Sources | ListKind::Server => unreachable!("not read from bytes"),
    }
}

/// A workbook with these files in it.
fn workbook(files: &[(&str, &str)]) -> Vec<u8> {
    let mut book = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in files {
        book.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
        book.write_all(text.as_bytes()).unwrap();
    }
    book.finish().unwrap().into_inner()
}

const TYPES: &str = r#"<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"/>"#;
const RELATIONS: &str = r#"<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="r1" Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/worksheet" Target="worksheets/sheet1.xml"/></Relationships>"#;

const ROOT: &str = r#"<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="r0" Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/officeDocument" Target="xl/workbook.xml"/></Relationships>"#;

/// A sheet of this name with these rows; texts stand in their cells.
fn sheet(name: &str, cells: &str) -> Vec<u8> {
    let book = format!(
        r#"<workbook xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main" xmlns:r="http://schemas.openxmlformats.org/officeDocument/2006/relationships"><sheets><sheet name="{name}" sheetId="1" r:id="r1"/></sheets></workbook>"#
    );
    let sheet = format!(
        r#"<worksheet xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"><sheetData>{cells}</sheetData></worksheet>"#
    );
    workbook(&[
        ("[Content_Types].xml", TYPES),
        ("_rels/.rels", ROOT),
        ("xl/workbook.xml", &book),
        ("xl/_rels/workbook.xml.rels", RELATIONS),
        ("xl/worksheets/sheet1.xml", &sheet),
    ])
}

fn rows(rows: &[&[&str]]) -> String {
    let row = |(number, cells): (usize, &&[&str])| {
        let cells = cells.iter().enumerate().map(|(column, text)| {
            let column = char::from(b'A' + column as u8);
            format!(r#"<c r="{column}{0}" t="inlineStr"><is><t>{text}</t></is></c>"#, number + 1)
        });
        format!(r#"<row r="{}">{}</row>"#, number + 1, cells.collect::<String>())
    };
    rows.iter().enumerate().map(row).collect()
}

fn tags() -> Vec<u8> {
    sheet(
        "PLC Tags",
        &rows(&[
            &["Name", "Path", "Data Type", "Logical Address", "Comment", "Hmi Visible"],
            &["Guard closed", "Press", "Bool", "%I0.0", "the guard", "True"],
            &["Speed", "Press", "Int", "%QW64", "", "True"],
            &["Hours", "Press", "DInt", "%MD4", "", "True"],
            &["Left", "Press", "S5Time", "%IW8", "", "True"],
        ]),
    )
}

/// A list in short.
fn shown(list: &IoList) -> String {
    let points = list.points.iter().map(|point| {
        let way = if point.direction == Direction::Input { "in" } else { "out" };
        let address = point.address.as_deref().unwrap_or("-");
        format!("{} {way} {} {} {address} {}\n", point.at, point.name, point.ty, point.comment.as_deref().unwrap_or(""))
    });
    let left_out = list.left_out.iter().map(|entry| format!("{} left out {}: {}\n", entry.at, entry.name, entry.why));
    let cycle = list.cycle.map(|cycle| format!("cycle {cycle}\n"));
    points.chain(left_out).chain(cycle).collect::<String>().replace(" \n", "\n")
}

#[test]
fn each_kind_of_list_is_read() {
    let lists = CASES.iter().map(|(name, kind, bytes)| {
        let list = read_bytes(name, *kind, bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(guess(Path::new(name), bytes).unwrap(), *kind, "{name}");
        format!("{name}\n{}\n", shown(&list))
    });
    let workbook = shown(&read_bytes("tags.xlsx", ListKind::TiaXlsx, &tags()).unwrap());
    let all: String = lists.chain([format!("tags.xlsx\n{workbook}")]).collect();
    insta::assert_snapshot!(all);
}

#[test]
fn sources_are_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/io_list/fixtures");
    let mut all = String::new();
    for name in ["press.st", "press-plcopen.xml"] {
        let list = sources::read(&folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        let sources = list.sources.as_ref().unwrap();
        let text = format!("{name} {:?} {:?}\n{}\n", sources.programs, sources.variables, shown(&list));
        all += &text.replace(&format!("{}/", folder.display()), "");
    }
    insta::assert_snapshot!(all);
}

#[test]
fn a_list_that_is_cut_is_an_error_or_a_shorter_list() {
    for (name, kind, bytes) in CASES {
        // The line break at the end is not part of it.
        for end in 0..bytes.trim_ascii_end().len() {
            if let Ok(list) = read_bytes(name, *kind, &bytes[..end]) {
                assert!(
                    !matches!(kind, ListKind::TwinCat | ListKind::Eni | ListKind::TiaXml),
                    "{name} cut at {end}: {list:?}"
                );
            }
        }
    }
    let book = tags();
    for end in 0..book.len() {
        assert!(read_bytes("tags.xlsx", ListKind::TiaXlsx, &book[..end]).is_err(), "cut at {end}");
    }
}

#[test]
fn what_would_fill_the_memory_is_refused() {
    let bomb = r#"<!DOCTYPE a [<!ENTITY b "bbbbbbbbbb"><!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;">]><EtherCATConfig>&c;</EtherCATConfig>"#;
    let error = read_bytes("bomb.xml", ListKind::Eni, bomb.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("DTD"), "{error}");
    let huge = include_str!("fixtures/press.tsproj").replace("ARRAY [0..1] OF BOOL", "ARRAY [0..2000000000] OF BOOL");
    let error = read_bytes("huge.tsproj", ListKind::TwinCat, huge.as_bytes());
    assert!(error.unwrap().left_out.iter().any(|entry| entry.why.contains("elements")));
    let many = "Name,Data Type,Logical Address\n".to_owned() + &"a,Array[0..99999] of Bool,%I0.0\n".repeat(2);
    let error = read_bytes("many.csv", ListKind::TiaText, many.as_bytes()).unwrap_err();
    assert!(matches!(error, ListError::TooMany { .. }), "{error}");
    let wide = r#"<row r="1048576"><c r="XFD1048576" t="inlineStr"><is><t>x</t></is></c></row>"#;
    let error = read_bytes("wide.xlsx", ListKind::TiaXlsx, &sheet("PLC Tags", wide)).unwrap_err().to_string();
    assert!(error.contains("no columns"), "{error}");
    let zeros = workbook(&[("xl/workbook.xml", &"0".repeat(600 << 20))]);
    let error = read_bytes("zeros.xlsx", ListKind::TiaXlsx, &zeros).unwrap_err().to_string();
    assert!(error.contains("unpacks to more than 512 MiB"), "{error}");
}

#[test]
fn another_sheet_is_named() {
    let error = read_bytes("tags.xlsx", ListKind::TiaXlsx, &sheet("Constants", "")).unwrap_err().to_string();
    assert_eq!(error, "tags.xlsx: it has no sheet `PLC Tags`, but Constants");
}

#[test]
fn many_rows_are_read() {
    let rows = (0..65_000).map(|row| {
        let number = row + 2;
        format!(
            r#"<row r="{number}"><c r="A{number}" t="inlineStr"><is><t>T{row}</t></is></c><c r="B{number}" t="inlineStr"><is><t>Bool</t></is></c><c r="C{number}" t="inlineStr"><is><t>%I{}.{}</t></is></c></row>"#,
            row / 8,
            row % 8
        )
    });
    let head = r#"<row r="1"><c r="A1" t="inlineStr"><is><t>Name</t></is></c><c r="B1" t="inlineStr"><is><t>Data Type</t></is></c><c r="C1" t="inlineStr"><is><t>Logical Address</t></is></c></row>"#;
    let book = sheet("PLC Tags", &(head.to_owned() + &rows.collect::<String>()));
    let list = read_bytes("many.xlsx", ListKind::TiaXlsx, &book).unwrap();
    assert_eq!(list.points.len(), 65_000);
    assert_eq!(list.points[64_999].at.line, Some(65_001));
}

proptest! {
    #[test]
    fn a_list_with_other_bytes_does_no_harm(
        case in 0..CASES.len(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let (name, kind, bytes) = CASES[case];
        let mut bytes = bytes.to_vec();
        for (place, byte) in changes {
            let at = place.index(bytes.len());
            bytes[at] = byte;
        }
        let _ = read_bytes(name, kind, &bytes);
    }

    #[test]
    fn a_workbook_with_other_bytes_does_no_harm(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        in_text in any::<bool>(),
    ) {
        let mut book = tags();
        if in_text {
            // Within the sheet, so that what is unpacked is read.
            let mut cells = rows(&[&["Name", "Data Type", "Logical Address"], &["Guard", "Bool", "%I0.0"]]).into_bytes();
            for (place, byte) in &changes {
                let at = place.index(cells.len());
                cells[at] = byte % 128;
            }
            book = sheet("PLC Tags", &String::from_utf8(cells).unwrap());
        } else {
            for (place, byte) in &changes {
                let at = place.index(book.len());
                book[at] = *byte;
            }
        }
        let _ = read_bytes("tags.xlsx", ListKind::TiaXlsx, &book);
    }
}
