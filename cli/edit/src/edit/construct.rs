//! The tables of a scene: added, set, renamed, removed.

use onescan_server::signal::nearest;
use toml_edit::{Item, Table, Value};

use super::change::{Given, Sort, Texts};
use super::document::{Document, Held, Splice, key_text, quoted, whole_end};
use super::error::{EditError, Place, Reference};
use super::field::{self, Field, Form};
use super::reference::{self, base};
use super::wire;

/// The table of a thing; one with a range is there for each of its elements.
fn named<'d>(document: &'d Document<'_>, sort: Sort, name: &str) -> Result<&'d Table, EditError> {
    let names = || document.tables(sort.key()).filter_map(|table| table.get("name")?.as_str());
    let is_it = |table: &&Table| table.get("name").and_then(Item::as_str) == Some(name);
    document.tables(sort.key()).find(is_it).ok_or_else(|| EditError::Missing {
        what: sort.key().to_owned(),
        name: name.to_owned(),
        file: document.file().to_owned(),
        near: nearest(name, names()).map(str::to_owned),
    })
}

/// What a table is, for people.
fn whose(sort: Sort, name: &str) -> String {
    format!("{} `{name}`", sort.key())
}

/// The keys that a table may have; nothing where they are not known.
fn fields(sort: Sort, kind: Option<&str>) -> Option<Vec<Field>> {
    match sort {
        Sort::Component => field::of_kind(kind?),
        _ => Some(field::of_sort(sort)),
    }
}

/// A value as it is written for its key.
fn written(fields: Option<&[Field]>, whose: &str, key: &str, given: &Given) -> Result<String, EditError> {
    let Some(fields) = fields else { return Ok(given.written()) };
    let Some(field) = fields.iter().find(|field| field.key == key) else {
        return Err(EditError::NoKey { what: whose.to_owned(), key: key.to_owned() });
    };
    field.form.check(key, given)?;
    Ok(match (&field.form, given) {
        (Form::Whole { .. }, Given::Number(number)) => format!("{number}"),
        _ => given.written(),
    })
}

/// A name that a scene can have.
fn check_name(name: &str) -> Result<(), EditError> {
    let is_one = !name.is_empty() && name.trim() == name && !name.contains(|c: char| c.is_control() || c == '"');
    if is_one { Ok(()) } else { Err(EditError::Name(name.to_owned())) }
}

/// Refuses a name that another thing of this sort has, an array of this name included.
fn check_free(document: &Document<'_>, sort: Sort, name: &str, but: Option<&str>) -> Result<(), EditError> {
    check_name(name)?;
    let names = document.tables(sort.key()).filter_map(|table| {
        let value = table.get("name")?.as_value()?;
        Some((value.as_str()?, value.span()?))
    });
    let mut others = names.filter(|(known, _)| Some(*known) != but);
    match others.find(|(known, _)| base(known) == base(name)) {
        None => Ok(()),
        Some((known, span)) => Err(EditError::Taken {
            what: sort.key().to_owned(),
            name: known.to_owned(),
            place: document.place(span.start),
        }),
    }
}

/// A new table behind the last one of its sort, or of those that come before it in a scene.
pub(super) fn add(
    texts: &Texts,
    scene: &str,
    sort: Sort,
    name: &str,
    keys: &[(String, Given)],
) -> Result<Texts, EditError> {
    let document = Document::parse(scene, texts.scene(scene)?)?;
    check_free(&document, sort, name, None)?;
    let what = whose(sort, name);
    let kind = keys.iter().find_map(|(key, given)| match given {
        Given::Text(kind) if key == "kind" => Some(kind.as_str()),
        _ => None,
    });
    let fields = fields(sort, kind);
    if let Some(missing) =
        fields.iter().flatten().find(|field| field.needed && !keys.iter().any(|(key, _)| *key == field.key))
    {
        return Err(EditError::Lacking { what, key: missing.key.clone() });
    }
    let mut lines = format!("\n[[{}]]\nname = {}", sort.key(), quoted(name));
    for (key, given) in keys {
        let is_kind = sort == Sort::Component && key == "kind";
        let value = if is_kind { given.to_string() } else { written(fields.as_deref(), &what, key, given)? };
        lines.extend(["\n", key_text(key).as_ref(), " = ", value.as_str()]);
    }
    let front = Sort::ALL.into_iter().take_while(|one| *one <= sort).collect::<Vec<_>>();
    let end = front.into_iter().rev().find_map(|sort| document.tables(sort.key()).filter_map(whole_end).max());
    let splice = document.lines_behind(end.unwrap_or(texts.scene(scene)?.len()), &lines);
    Ok(texts.with_scene(scene, document.with(vec![splice])?))
}

/// Another value for a key, or none.
pub(super) fn set(
    texts: &Texts,
    scene: &str,
    (sort, name): (Sort, &str),
    key: &str,
    value: Option<&Given>,
) -> Result<Texts, EditError> {
    let document = Document::parse(scene, texts.scene(scene)?)?;
    let table = named(&document, sort, name)?;
    let (held, what) = (Held::Header(table), whose(sort, name));
    let fields = fields(sort, table.get("kind").and_then(Item::as_str));
    let is_needed =
        matches!(key, "name" | "kind") || fields.iter().flatten().any(|field| field.key == key && field.needed);
    let splice = match (value, held.value(key)) {
        (None, _) if is_needed => return Err(EditError::Needed { what, key: key.to_owned() }),
        (None, None) => return Err(EditError::NoKey { what, key: key.to_owned() }),
        (None, Some(_)) => document.remove_key(held, key).into_iter().collect(),
        (Some(_), _) if key == "name" || (sort == Sort::Component && key == "kind") => {
            return Err(EditError::Fixed { what, key: key.to_owned() });
        }
        (Some(given), old) => {
            let text = written(fields.as_deref(), &what, key, given)?;
            match old {
                None => vec![document.insert(held, key, &text)],
                Some((old, span)) => changed(old, given, span, text),
            }
        }
    };
    Ok(texts.with_scene(scene, document.with(splice)?))
}

/// The least change of a value: of a list of numbers, those that are others; whole numbers stay whole.
fn changed(old: &Value, given: &Given, span: std::ops::Range<usize>, text: String) -> Vec<Splice> {
    if let (Value::Array(old), Given::Numbers(numbers)) = (old, given)
        && old.len() == numbers.len()
    {
        let each = old.iter().zip(numbers).filter(|(old, number)| number_of(old) != Some(**number));
        let splices = each.filter_map(|(old, number)| Some(Splice::new(old.span()?, as_before(old, *number))));
        return splices.collect();
    }
    match given {
        Given::Number(number) if number_of(old).is_some() => vec![Splice::new(span, as_before(old, *number))],
        _ => vec![Splice::new(span, text)],
    }
}

fn number_of(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
}

/// A number in the place of another: without a point if that had none and it needs none.
fn as_before(old: &Value, number: f64) -> String {
    if old.is_integer() && number.fract() == 0.0 { format!("{number}") } else { Given::Number(number).written() }
}

/// Another name, here and wherever it is referred to.
pub(super) fn rename(texts: &Texts, scene: &str, sort: Sort, name: &str, to: &str) -> Result<Texts, EditError> {
    let document = Document::parse(scene, texts.scene(scene)?)?;
    let table = named(&document, sort, name)?;
    check_free(&document, sort, to, Some(name))?;
    let range = &name[base(name).len()..];
    if to[base(to).len()..] != *range {
        return Err(EditError::Range { name: name.to_owned(), range: range.to_owned() });
    }
    let own = Held::Header(table).value("name").map(|(_, span)| Splice::new(span, quoted(to)));
    let mentions = reference::to(&document, sort, name).into_iter().map(|mention| {
        let renamed = mention.text.replacen(base(name), base(to), 1);
        Splice::new(mention.span, quoted(&renamed))
    });
    let text = document.with(own.into_iter().chain(mentions).collect())?;
    let scenario = Document::parse(wire::FILE, &texts.scenario)?;
    let set = set_keys(&scenario, scene, sort, name).into_iter().map(|(span, _)| Splice::new(span, key_text(to)));
    let scenario = scenario.with(set.collect())?;
    Ok(Texts { scenario, ..texts.with_scene(scene, text) })
}

/// Where `set` of a plant names a component of its scene: the key, and the plant.
fn set_keys(scenario: &Document<'_>, scene: &str, sort: Sort, name: &str) -> Vec<(std::ops::Range<usize>, String)> {
    let clients = scenario.root().get("clients").and_then(Item::as_table_like);
    let plants = clients.into_iter().flat_map(|clients| clients.iter());
    let of_scene = plants.filter(|(_, client)| client.get("scene").and_then(Item::as_str) == Some(scene));
    let key = |(client, item): (&str, &Item)| {
        let set = item.get("set")?.as_table_like()?;
        Some((set.key(name)?.span()?, client.to_owned()))
    };
    if sort == Sort::Component { of_scene.filter_map(key).collect() } else { Vec::new() }
}

/// Takes a thing away that nothing refers to.
pub(super) fn remove(texts: &Texts, scene: &str, sort: Sort, name: &str) -> Result<Texts, EditError> {
    let document = Document::parse(scene, texts.scene(scene)?)?;
    let table = named(&document, sort, name)?;
    let mentions = reference::to(&document, sort, name).into_iter();
    let here = mentions.map(|mention| Reference { by: mention.by, place: document.place(mention.span.start) });
    let scenario = Document::parse(wire::FILE, &texts.scenario)?;
    let set = set_keys(&scenario, scene, sort, name).into_iter();
    let there = set.map(|(span, client)| {
        let place: Place = scenario.place(span.start);
        Reference { by: format!("client `{client}`, set"), place }
    });
    let by: Vec<_> = here.chain(there).collect();
    if !by.is_empty() {
        return Err(EditError::Referred { what: sort.key().to_owned(), name: name.to_owned(), by });
    }
    let splice = document.remove_table(table).into_iter().collect();
    Ok(texts.with_scene(scene, document.with(splice)?))
}
