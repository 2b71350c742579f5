//! What a table of a scene may say: its keys with their units and ranges, from the library's kinds and the schema of scenes.
//! The page makes its forms of this, and a change is measured by it.

use onescan_plant::component::kind::{self, Kind, Setting, unit};
use onescan_plant::component::kinds;
use onescan_plant::coupling::{BindingKey, Names};
use onescan_plant::scene::schema::schema;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value as Json;

use super::change::{Given, Sort};
use super::error::EditError;

/// A key.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "FieldInfo")]
pub(super) struct Field {
    /// As it is written.
    pub(super) key: String,
    /// What it is called, without unit and ending.
    pub(super) name: String,
    /// Its unit, as people write it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) unit: Option<&'static str>,
    /// What it means.
    pub(super) about: String,
    /// What it may be.
    pub(super) form: Form,
    /// Whether nothing goes without it.
    pub(super) needed: bool,
    /// What it is where it is absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) preset: Option<Json>,
    /// What part it has in its table.
    pub(super) part: Part,
}

/// The part of a key in its table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum Part {
    /// Describes the thing.
    Parameter,
    /// Binds it to others of the scene.
    Binding,
    /// The session's signal of an input.
    Input,
    /// The session's signal of an output.
    Output,
    /// Another component's output for an input, or a constant.
    Wire,
}

/// What may be written.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub(super) enum Form {
    /// A number, bounds included.
    Number { least: Option<f64>, most: Option<f64> },
    /// A whole number, bounds included.
    Whole { least: i64, most: i64 },
    /// `true` or `false`.
    Flag,
    /// One word of these.
    Choice { words: Vec<String> },
    /// A text; `names` says of what it is the name.
    Text { names: Option<Sort> },
    /// So many numbers.
    Numbers { count: usize },
    /// Names.
    Texts { names: Option<Sort> },
}

impl Form {
    /// In words.
    fn wanted(&self) -> String {
        match self {
            Self::Number { least: Some(least), most: Some(most) } => format!("a number from {least} to {most}"),
            Self::Number { .. } => "a number".to_owned(),
            Self::Whole { least, most } => format!("a whole number from {least} to {most}"),
            Self::Flag => "true or false".to_owned(),
            Self::Choice { words } => format!("one of {}", words.join(", ")),
            Self::Text { .. } => "a text".to_owned(),
            Self::Numbers { count } => format!("{count} numbers"),
            Self::Texts { .. } => "a list of names".to_owned(),
        }
    }

    /// Whether it takes a value.
    fn takes(&self, given: &Given) -> bool {
        match (self, given) {
            (Self::Number { least, most }, Given::Number(number)) => {
                least.is_none_or(|least| least <= *number) && most.is_none_or(|most| *number <= most)
            }
            (Self::Whole { least, most }, Given::Number(number)) => {
                number.fract() == 0.0 && (*least as f64) <= *number && *number <= (*most as f64)
            }
            (Self::Choice { words }, Given::Text(text)) => words.contains(text),
            (Self::Numbers { count }, Given::Numbers(numbers)) => numbers.len() == *count,
            (Self::Text { .. }, Given::Text(text)) => !text.is_empty() && !text.contains(char::is_control),
            (Self::Flag, Given::Flag(_)) | (Self::Texts { .. }, Given::Texts(_)) => true,
            // an empty list is one of numbers for a reader of JSON
            (Self::Texts { .. }, Given::Numbers(none)) => none.is_empty(),
            _ => false,
        }
    }

    /// Refuses a value that a key cannot have.
    pub(super) fn check(&self, key: &str, given: &Given) -> Result<(), EditError> {
        if self.takes(given) {
            return Ok(());
        }
        Err(EditError::Value { key: key.to_owned(), wanted: self.wanted(), value: given.to_string() })
    }
}

/// The keys of the components of a kind; none of a kind of the user's own.
pub(super) fn of_kind(name: &str) -> Option<Vec<Field>> {
    kinds().iter().find(|kind| kind.name == name).map(of_component)
}

/// The keys of a component, in the order in which people write them.
pub(super) fn of_component(kind: &Kind) -> Vec<Field> {
    let mut fields: Vec<Field> = kind.coupling.keys().iter().map(binding).collect();
    fields.extend(kind.parameters.iter().map(parameter));
    for input in &kind.inputs {
        fields.push(signal(&input.key, &input.about, Part::Input));
    }
    for output in &kind.outputs {
        fields.push(signal(&output.key, &output.about, Part::Output));
    }
    for input in &kind.inputs {
        let about = format!("{}: the output of another component, as `barrier.detected`", input.about);
        let form = Form::Text { names: None };
        fields.push(Field { key: format!("{}_from", input.key), ..plain(about, form, Part::Wire) });
        let form = match input.preset {
            Some(Setting::Flag(_)) => Form::Flag,
            Some(Setting::Number(_)) => Form::Number { least: None, most: None },
            Some(Setting::Count(_)) => Form::Whole { least: i32::MIN.into(), most: i32::MAX.into() },
            Some(Setting::Choice(_)) | None => continue,
        };
        let field = plain(format!("{}: a constant", input.about), form, Part::Wire);
        fields.push(Field { key: kind.constant_key(&input.key), preset: input.preset.map(json), ..field });
    }
    for (key, _) in kind.frames.by_key().into_iter().filter(|(_, signals)| !signals.is_empty()) {
        let field = plain("a structure of signals".to_owned(), Form::Text { names: None }, Part::Wire);
        fields.push(Field { key: key.to_owned(), ..field });
    }
    let words = vec!["LREAL".to_owned(), "REAL".to_owned()];
    let about = "type of its signals that are numbers".to_owned();
    fields.push(Field { key: "signal_type".to_owned(), ..plain(about, Form::Choice { words }, Part::Parameter) });
    let about = "where pictures show it, if nothing that it is bound to says so".to_owned();
    let shown = plain(about, Form::Numbers { count: 3 }, Part::Parameter);
    fields.push(Field { key: "shown_at_m".to_owned(), unit: Some("m"), ..shown });
    named(fields)
}

/// Fields with the names that people read.
fn named(mut fields: Vec<Field>) -> Vec<Field> {
    for field in &mut fields {
        let key = field.key.strip_suffix("_signal").unwrap_or(&field.key);
        field.name = unit(key).0.replace('_', " ");
    }
    fields
}

fn plain(about: String, form: Form, part: Part) -> Field {
    Field { key: String::new(), name: String::new(), unit: None, about, form, needed: false, preset: None, part }
}

fn signal(key: &str, about: &str, part: Part) -> Field {
    let field = plain(about.to_owned(), Form::Text { names: None }, part);
    Field { key: format!("{key}_signal"), unit: unit(key).1, ..field }
}

fn binding(BindingKey { key, about, names, needed }: &BindingKey) -> Field {
    let form = match names {
        Names::DrivenJoint(_) | Names::DrivenBeside(_) | Names::MeasuredJoint => {
            Form::Text { names: Some(Sort::Joint) }
        }
        Names::Belt | Names::Carrier | Names::Body | Names::TouchedBody => Form::Text { names: Some(Sort::Body) },
        Names::ShapeOfBody => Form::Text { names: Some(Sort::Shape) },
        Names::Direction | Names::Along | Names::Point => Form::Numbers { count: 3 },
        Names::Bodies { .. } => Form::Texts { names: Some(Sort::Body) },
    };
    let field = plain((*about).to_owned(), form, Part::Binding);
    Field { key: (*key).to_owned(), unit: unit(key).1, needed: *needed, ..field }
}

fn parameter(parameter: &kind::Parameter) -> Field {
    let form = match &parameter.form {
        kind::Form::Number { least, most } if *least == f64::MIN && *most == f64::MAX => {
            Form::Number { least: None, most: None }
        }
        kind::Form::Number { least, most } => Form::Number { least: Some(*least), most: Some(*most) },
        kind::Form::Count { least, most } => Form::Whole { least: *least, most: *most },
        kind::Form::Flag => Form::Flag,
        kind::Form::Choice(words) => Form::Choice { words: words.iter().map(|word| (*word).to_owned()).collect() },
    };
    let field = plain(parameter.about.clone(), form, Part::Parameter);
    let (key, preset) = (parameter.key.to_string(), Some(json(parameter.preset)));
    Field { unit: unit(&parameter.key).1, key, preset, ..field }
}

fn json(setting: Setting) -> Json {
    match setting {
        Setting::Number(number) => Json::from(number),
        Setting::Count(whole) => Json::from(whole),
        Setting::Flag(flag) => Json::from(flag),
        Setting::Choice(word) => Json::from(word),
    }
}

/// The keys of the tables of a sort, by the schema of scenes; those of components are their kinds'.
pub(super) fn of_sort(sort: Sort) -> Vec<Field> {
    let schema = schema();
    let table = &schema["properties"][sort.key()]["items"];
    let needed = |key: &str| table["required"].as_array().is_some_and(|all| all.iter().any(|one| one == key));
    let properties = table["properties"].as_object().into_iter().flatten();
    let known = properties.filter(|(key, _)| *key != "name").filter_map(|(key, property)| {
        let about = property["description"].as_str().unwrap_or_default().to_owned();
        let (form, part) = (form(key, property)?, if refers(key).is_some() { Part::Binding } else { Part::Parameter });
        Some(Field { key: key.clone(), unit: unit(key).1, needed: needed(key), ..plain(about, form, part) })
    });
    named(known.collect())
}

/// The sort of what a key of a table names.
pub(super) fn refers(key: &str) -> Option<Sort> {
    match key {
        "parent" | "child" | "body" | "belt" | "targets" => Some(Sort::Body),
        "joint" | "of" => Some(Sort::Joint),
        _ => None,
    }
}

/// What the schema lets a key be; nothing of what the page cannot show.
fn form(key: &str, property: &Json) -> Option<Form> {
    let words = |all: &Json| -> Option<Vec<String>> {
        let word = |one: &Json| one.as_str().or_else(|| one["const"].as_str()).map(str::to_owned);
        all.as_array()?.iter().map(word).collect()
    };
    let choice = [&property["enum"], &property["oneOf"], &property["anyOf"][0]["oneOf"]].into_iter().find_map(words);
    if let Some(words) = choice {
        return Some(Form::Choice { words });
    }
    match property["type"].as_str()? {
        "number" => Some(Form::Number { least: None, most: None }),
        "boolean" => Some(Form::Flag),
        "string" => Some(Form::Text { names: refers(key) }),
        "array" => match (property["items"]["type"].as_str()?, property["minItems"].as_u64()) {
            ("number", Some(count)) => Some(Form::Numbers { count: usize::try_from(count).ok()? }),
            ("string", _) => Some(Form::Texts { names: refers(key) }),
            _ => None,
        },
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_has_fields_with_units_and_ranges() {
        let fields = of_kind("pneumatic_cylinder").expect("in the library");
        let stroke = fields.iter().find(|field| field.key == "stroke_m").expect("a parameter");
        assert_eq!((stroke.unit, &stroke.form), (Some("m"), &Form::Number { least: Some(0.001), most: Some(10.0) }));
        assert_eq!(stroke.preset, Some(Json::from(0.2)));
        assert!(kinds().iter().all(|kind| !of_component(kind).is_empty()));
        assert_eq!(of_kind("gearbox_of_mine"), None);
    }

    #[test]
    fn tables_have_the_keys_of_the_schema() {
        let body = of_sort(Sort::Body);
        let of = |key: &str| body.iter().find(|field| field.key == key).map(|field| field.form.clone());
        assert_eq!(of("position_m"), Some(Form::Numbers { count: 3 }));
        assert!(matches!(of("kind"), Some(Form::Choice { words }) if words.len() == 3));
        assert!(matches!(of("friction_rule"), Some(Form::Choice { words }) if words.len() == 4));
        assert!(body.iter().any(|field| field.key == "kind" && field.needed));
        assert!(of_sort(Sort::Joint).iter().any(|field| field.form == Form::Text { names: Some(Sort::Body) }));
    }

    #[test]
    fn values_outside_of_their_range_are_refused_in_words() {
        let form = Form::Number { least: Some(0.0), most: Some(2.0) };
        let error = form.check("speed_m_s", &Given::Number(3.0)).expect_err("too much");
        assert_eq!(error.to_string(), "`speed_m_s` is a number from 0 to 2, which 3 is not");
        assert!(Form::Texts { names: None }.check("targets", &Given::Numbers(vec![])).is_ok());
        assert!(Form::Whole { least: 0, most: 5 }.check("teeth", &Given::Number(1.5)).is_err());
    }
}
