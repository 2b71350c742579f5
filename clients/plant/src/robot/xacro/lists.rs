//! Lists in expressions: comprehensions, and what Python's functions make of them. A set is a list in which nothing
//! is there twice.

use super::arithmetic;
use super::expression::{Comprehension, Expression};
use super::names::{Evaluate, Evaluated, Names};
use super::value::{Value, quoted};

/// How many values and bytes all lists of a robot's file may have that are made of others: loops in loops would else take
/// all memory and time.
pub(super) const SIZE_MAX: usize = 1_000_000;

/// Names of a comprehension before those around it.
struct Bound<'n> {
    own: Vec<(&'n str, Value)>,
    around: &'n mut dyn Names,
}

impl Names for Bound<'_> {
    fn value(&mut self, name: &str) -> Result<Option<Value>, String> {
        match self.own.iter().find(|(known, _)| *known == name) {
            Some((_, value)) => Ok(Some(value.clone())),
            None => self.around.value(name),
        }
    }

    fn yaml(&mut self, file: &str) -> Evaluated {
        self.around.yaml(file)
    }

    fn argument(&mut self, name: &str) -> Evaluated {
        self.around.argument(name)
    }

    fn spend(&mut self, size: usize) -> Result<(), String> {
        self.around.spend(size)
    }
}

pub(super) fn comprehension(of: &Comprehension, names: &mut dyn Names, evaluate: Evaluate) -> Evaluated {
    let mut list = Vec::new();
    for item in iterated(&evaluate(&of.of, names)?)? {
        names.spend(item.size())?;
        let mut bound = Bound { own: bind(&of.names, item)?, around: names };
        let kept = of.filter.as_ref().map(|filter| evaluate(filter, &mut bound)).transpose()?;
        if kept.is_none_or(|kept| kept.is_true()) {
            let each = evaluate(&of.each, &mut bound)?;
            bound.spend(each.size())?;
            list.push(each);
        }
    }
    Ok(Value::List(list))
}

/// An item under its name, or its parts under theirs.
fn bind(names: &[String], item: Value) -> Result<Vec<(&str, Value)>, String> {
    if let [name] = names {
        return Ok(vec![(name, item)]);
    }
    match item {
        Value::List(parts) if parts.len() == names.len() => Ok(names.iter().map(String::as_str).zip(parts).collect()),
        other => Err(format!("{} is not {} values", quoted(&other), names.len())),
    }
}

/// What a loop over a value goes through.
fn iterated(value: &Value) -> Result<Vec<Value>, String> {
    match value {
        Value::List(list) => Ok(list.clone()),
        Value::Text(text) => Ok(text.chars().map(|letter| Value::Text(letter.to_string())).collect()),
        Value::Map(map) => Ok(map.iter().map(|(key, _)| Value::Text(key.clone())).collect()),
        other => Err(format!("{} has no items", quoted(other))),
    }
}

/// `n * list`, and a set without another's items; none for other operands.
pub(super) fn binary(sign: &str, left: &Value, right: &Value, names: &mut dyn Names) -> Option<Evaluated> {
    match (sign, left, right) {
        ("*", Value::Whole(times), many @ (Value::List(_) | Value::Text(_)))
        | ("*", many @ (Value::List(_) | Value::Text(_)), Value::Whole(times)) => Some(repeated(many, *times, names)),
        ("-", Value::List(all), Value::List(without)) => {
            if let Err(cause) = names.spend(all.len().saturating_mul(without.len())) {
                return Some(Err(cause));
            }
            let kept = all.iter().filter(|item| !without.iter().any(|other| other.equals(item)));
            Some(Ok(Value::List(kept.cloned().collect())))
        }
        _ => None,
    }
}

fn repeated(many: &Value, times: i64, names: &mut dyn Names) -> Evaluated {
    let times = usize::try_from(times).unwrap_or(0);
    names.spend(many.size().saturating_mul(times))?;
    Ok(match many {
        Value::List(list) => Value::List(std::iter::repeat_n(list, times).flatten().cloned().collect()),
        other => Value::Text(other.to_string().repeat(times)),
    })
}

/// The entries of a dictionary, each as its key and its value.
pub(super) fn items(map: &[(String, Value)]) -> Vec<Value> {
    map.iter().map(|(key, value)| Value::List(vec![Value::Text(key.clone()), value.clone()])).collect()
}

/// The words of a text, apart by any letter of `by`.
pub(super) fn tokens(text: &str, by: Option<&Value>) -> Value {
    let by = by.map_or_else(|| ",; ".to_owned(), ToString::to_string);
    let words = text.split(|letter| by.contains(letter)).filter(|word| !word.is_empty());
    Value::List(words.map(|word| Value::Text(word.to_owned())).collect())
}

/// `isinstance(value, type)`, whose second argument is the name of a type, not a property; none for other calls.
pub(super) fn is_instance(
    callee: &Expression,
    plain: &[Expression],
    names: &mut dyn Names,
    evaluate: Evaluate,
) -> Option<Evaluated> {
    let (Expression::Name(function) | Expression::Member(_, function)) = callee else { return None };
    let ("isinstance", [value, Expression::Name(sort)]) = (function.as_str(), plain) else { return None };
    let value = match evaluate(value, names) {
        Ok(value) => value,
        Err(cause) => return Some(Err(cause)),
    };
    Some(Ok(Value::Bool(match sort.as_str() {
        "list" | "tuple" => matches!(value, Value::List(_)),
        "dict" => matches!(value, Value::Map(_)),
        "str" => matches!(value, Value::Text(_)),
        "bool" => matches!(value, Value::Bool(_)),
        // for Python, truth values are whole numbers too
        "int" => matches!(value, Value::Whole(_) | Value::Bool(_)),
        "float" => matches!(value, Value::Number(_)),
        other => return Some(Err(format!("`{other}` is not a sort of values that is known here"))),
    })))
}

/// Functions of lists; none for others.
pub(super) fn function(name: &str, values: &[Value], names: &mut dyn Names) -> Option<Evaluated> {
    Some(match (name, values) {
        ("list" | "tuple", [of]) => iterated(of).map(Value::List),
        ("set" | "frozenset", [of]) => iterated(of).and_then(|list| without_repetitions(list, names)),
        ("zip", lists @ [_, ..]) => zip(lists),
        ("any", [of]) => iterated(of).map(|list| Value::Bool(list.iter().any(Value::is_true))),
        ("all", [of]) => iterated(of).map(|list| Value::Bool(list.iter().all(Value::is_true))),
        ("sum", [Value::List(list)]) => {
            list.iter().try_fold(Value::Whole(0), |sum, item| arithmetic::binary("+", &sum, item))
        }
        ("range", [Value::Whole(end)]) => range([0, *end, 1], names),
        ("range", [Value::Whole(start), Value::Whole(end)]) => range([*start, *end, 1], names),
        ("range", [Value::Whole(start), Value::Whole(end), Value::Whole(step)]) => range([*start, *end, *step], names),
        ("dict", [Value::List(pairs)]) => dictionary(pairs, names),
        ("dict" | "dotify", [map @ Value::Map(_)]) => Ok(map.clone()),
        _ => return None,
    })
}

fn without_repetitions(list: Vec<Value>, names: &mut dyn Names) -> Evaluated {
    let mut kept: Vec<Value> = Vec::new();
    for item in list {
        names.spend(kept.len())?;
        if !kept.iter().any(|known| known.equals(&item)) {
            kept.push(item);
        }
    }
    Ok(Value::List(kept))
}

fn zip(lists: &[Value]) -> Evaluated {
    let lists: Vec<_> = lists.iter().map(iterated).collect::<Result<_, _>>()?;
    let length = lists.iter().map(Vec::len).min().unwrap_or(0);
    let row = |at: usize| Value::List(lists.iter().map(|list| list[at].clone()).collect());
    Ok(Value::List((0..length).map(row).collect()))
}

fn range([start, end, step]: [i64; 3], names: &mut dyn Names) -> Evaluated {
    if step == 0 {
        return Err("a range of step 0".to_owned());
    }
    let mut list = Vec::new();
    let mut at = Some(start);
    while let Some(number) = at.filter(|at| if step > 0 { *at < end } else { *at > end }) {
        names.spend(1)?;
        list.push(Value::Whole(number));
        at = number.checked_add(step);
    }
    Ok(Value::List(list))
}

/// Of a key that is there twice the last value holds, as in Python.
fn dictionary(pairs: &[Value], names: &mut dyn Names) -> Evaluated {
    let mut map: Vec<(String, Value)> = Vec::new();
    for pair in pairs {
        names.spend(map.len())?;
        let Value::List(pair) = pair else { return Err(format!("{} is not a key and a value", quoted(pair))) };
        let [key, value] = &pair[..] else { return Err("a key and a value are expected".to_owned()) };
        let key = key.to_string();
        match map.iter_mut().find(|(known, _)| *known == key) {
            Some((_, known)) => known.clone_from(value),
            None => map.push((key, value.clone())),
        }
    }
    Ok(Value::Map(map))
}
