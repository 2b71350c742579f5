//! What expressions are worth.

use onescan_base::nearest;

use super::arithmetic::binary;
use super::expression::Expression;
use super::lists;
use super::names::{Evaluated, Names};
use super::value::{Value, quoted};

/// The value of an expression.
///
/// # Errors
/// Why it has none.
pub(super) fn evaluate(expression: &Expression, names: &mut dyn Names) -> Evaluated {
    match expression {
        Expression::Constant(value) => Ok(value.clone()),
        Expression::Name(name) => self::name(name, names),
        Expression::List(list) => {
            list.iter().map(|inner| evaluate(inner, names)).collect::<Result<_, _>>().map(Value::List)
        }
        Expression::Comprehension(inner) => lists::comprehension(inner, names, evaluate),
        Expression::Index(of, index) => {
            let (of, index) = (evaluate(of, names)?, evaluate(index, names)?);
            item(&of, &index)
        }
        Expression::Member(of, member) => {
            if let Expression::Name(space) = &**of
                && matches!(space.as_str(), "math" | "numpy" | "np")
            {
                return self::name(member, names);
            }
            item(&evaluate(of, names)?, &Value::Text(member.clone()))
        }
        Expression::Call(callee, plain, named) => call(callee, plain, named, names),
        Expression::Minus(inner) => match evaluate(inner, names)? {
            Value::Whole(whole) => Ok(whole.checked_neg().map_or(Value::Number(-(whole as f64)), Value::Whole)),
            other => numeric(&other).map(|number| Value::Number(-number)),
        },
        Expression::Not(inner) => Ok(Value::Bool(!evaluate(inner, names)?.is_true())),
        Expression::Binary(sign, left, right) => {
            let (left, right) = (evaluate(left, names)?, evaluate(right, names)?);
            lists::binary(sign, &left, &right, names).unwrap_or_else(|| binary(sign, &left, &right))
        }
        Expression::Compare(first, others) => {
            let mut left = evaluate(first, names)?;
            for (operator, right) in others {
                let right = evaluate(right, names)?;
                if !compare(operator, &left, &right)? {
                    return Ok(Value::Bool(false));
                }
                left = right;
            }
            Ok(Value::Bool(true))
        }
        Expression::And(left, right) => {
            let left = evaluate(left, names)?;
            if left.is_true() { evaluate(right, names) } else { Ok(left) }
        }
        Expression::Or(left, right) => {
            let left = evaluate(left, names)?;
            if left.is_true() { Ok(left) } else { evaluate(right, names) }
        }
        Expression::Choice(condition, then, otherwise) => {
            let chosen = if evaluate(condition, names)?.is_true() { then } else { otherwise };
            evaluate(chosen, names)
        }
    }
}

fn name(name: &str, names: &mut dyn Names) -> Evaluated {
    if let Some(value) = names.value(name)? {
        return Ok(value);
    }
    match name {
        "pi" => Ok(Value::Number(std::f64::consts::PI)),
        "e" => Ok(Value::Number(std::f64::consts::E)),
        "tau" => Ok(Value::Number(std::f64::consts::TAU)),
        "inf" => Ok(Value::Number(f64::INFINITY)),
        _ => Err(format!("there is no property `{name}`")),
    }
}

fn numeric(value: &Value) -> Result<f64, String> {
    value.number().ok_or_else(|| format!("{} is not a number", quoted(value)))
}

/// `of[index]`, or `of.index` of a dictionary.
fn item(of: &Value, index: &Value) -> Evaluated {
    let at = |length: usize| match index {
        Value::Whole(whole) if *whole < 0 => usize::try_from(-whole).ok().and_then(|back| length.checked_sub(back)),
        Value::Whole(whole) => usize::try_from(*whole).ok(),
        _ => None,
    };
    match of {
        Value::Map(map) => {
            let key = index.to_string();
            let found = map.iter().find(|(known, _)| *known == key).map(|(_, value)| value.clone());
            found.ok_or_else(|| {
                let near = nearest(&key, map.iter().map(|(known, _)| known.as_str()));
                let near = near.map(|near| format!("; did you mean '{near}'?")).unwrap_or_default();
                format!("the dictionary has no '{key}'{near}")
            })
        }
        Value::List(list) => {
            at(list.len()).and_then(|at| list.get(at)).cloned().ok_or_else(|| format!("the list has no item {index}"))
        }
        Value::Text(text) => {
            let count = text.chars().count();
            let letter = at(count).and_then(|at| text.chars().nth(at));
            letter
                .map(|letter| Value::Text(letter.to_string()))
                .ok_or_else(|| format!("'{text}' has no letter {index}"))
        }
        Value::None | Value::Bool(_) | Value::Whole(_) | Value::Number(_) => {
            Err(format!("{} has no items", quoted(of)))
        }
    }
}

fn compare(operator: &str, left: &Value, right: &Value) -> Result<bool, String> {
    match operator {
        "==" => return Ok(left.equals(right)),
        "!=" => return Ok(!left.equals(right)),
        "in" => return contains(right, left),
        "not in" => return contains(right, left).map(|found| !found),
        _ => {}
    }
    let order = match (left, right) {
        (Value::Text(one), Value::Text(other)) => Some(one.cmp(other)),
        _ => numeric(left)?.partial_cmp(&numeric(right)?),
    };
    Ok(order.is_some_and(|order| match operator {
        "<" => order.is_lt(),
        "<=" => order.is_le(),
        ">" => order.is_gt(),
        _ => order.is_ge(),
    }))
}

fn contains(whole: &Value, part: &Value) -> Result<bool, String> {
    match (whole, part) {
        (Value::Text(text), Value::Text(part)) => Ok(text.contains(part.as_str())),
        (Value::List(list), _) => Ok(list.iter().any(|item| item.equals(part))),
        (Value::Map(map), _) => Ok(map.iter().any(|(key, _)| *key == part.to_string())),
        _ => Err(format!("nothing is in {}", quoted(whole))),
    }
}

fn call(callee: &Expression, plain: &[Expression], named: &[(String, Expression)], names: &mut dyn Names) -> Evaluated {
    if let Some(known) = lists::is_instance(callee, plain, names, evaluate) {
        return known;
    }
    let values: Vec<Value> = plain.iter().map(|inner| evaluate(inner, names)).collect::<Result<_, _>>()?;
    let function = match callee {
        Expression::Name(name) => name.as_str(),
        Expression::Member(of, name) => match &**of {
            Expression::Name(space) if matches!(space.as_str(), "xacro" | "math" | "python" | "numpy" | "np") => name,
            of => return method(&evaluate(of, names)?, name, &values),
        },
        _ => return Err("what is called is not a function".to_owned()),
    };
    match (function, &values[..]) {
        ("load_yaml", [Value::Text(file)]) => names.yaml(file),
        ("arg", [Value::Text(name)]) => names.argument(name),
        ("dict", []) => {
            let entries = named.iter().map(|(key, inner)| Ok((key.clone(), evaluate(inner, names)?)));
            entries.collect::<Result<_, String>>().map(Value::Map)
        }
        // what a robot's author reports is for who runs xacro
        ("warning" | "message" | "print_location", _) => Ok(Value::Text(String::new())),
        ("error" | "fatal", [reported]) => Err(reported.to_string()),
        ("len", [Value::Text(text)]) => Ok(Value::Whole(text.chars().count() as i64)),
        ("len", [Value::List(list)]) => Ok(Value::Whole(list.len() as i64)),
        ("len", [Value::Map(map)]) => Ok(Value::Whole(map.len() as i64)),
        ("str", [value]) => Ok(Value::Text(value.to_string())),
        ("bool", [value]) => Ok(Value::Bool(value.is_true())),
        ("int", [value]) => {
            let number = Value::literal(&value.to_string());
            Ok(Value::Whole(libm::trunc(numeric(&number)?) as i64))
        }
        ("float", [value]) => numeric(&Value::literal(&value.to_string())).map(Value::Number),
        ("tokenize", [Value::Text(text)]) => {
            let by = named.iter().find(|(key, _)| key == "sep").map(|(_, inner)| evaluate(inner, names)).transpose()?;
            Ok(lists::tokens(text, by.as_ref()))
        }
        ("min" | "max", [Value::List(list)]) => extreme(function, list),
        ("min" | "max", list @ [_, _, ..]) => extreme(function, list),
        _ => lists::function(function, &values, names).unwrap_or_else(|| mathematics(function, &values)),
    }
}

fn extreme(function: &str, list: &[Value]) -> Evaluated {
    let mut best = list.first().cloned().ok_or_else(|| format!("`{function}` of nothing"))?;
    for value in &list[1..] {
        let (new, old) = (numeric(value)?, numeric(&best)?);
        if if function == "min" { new < old } else { new > old } {
            best = value.clone();
        }
    }
    Ok(best)
}

fn mathematics(function: &str, values: &[Value]) -> Evaluated {
    let numbers: Vec<f64> = values.iter().map(numeric).collect::<Result<_, _>>()?;
    let value = match (function, &numbers[..]) {
        ("radians", [x]) => x.to_radians(),
        ("degrees", [x]) => x.to_degrees(),
        ("sin", [x]) => libm::sin(*x),
        ("cos", [x]) => libm::cos(*x),
        ("tan", [x]) => libm::tan(*x),
        ("asin", [x]) => libm::asin(*x),
        ("acos", [x]) => libm::acos(*x),
        ("atan", [x]) => libm::atan(*x),
        ("atan2", [y, x]) => libm::atan2(*y, *x),
        ("hypot", [y, x]) => libm::hypot(*y, *x),
        ("sqrt", [x]) => x.sqrt(),
        ("exp", [x]) => libm::exp(*x),
        ("log", [x]) => libm::log(*x),
        ("pow", [x, y]) => libm::pow(*x, *y),
        ("abs" | "fabs", [x]) => x.abs(),
        ("floor", [x]) => libm::floor(*x),
        ("ceil", [x]) => libm::ceil(*x),
        ("round", [x]) => libm::rint(*x),
        _ => return Err(format!("there is no function `{function}` of {} arguments", values.len())),
    };
    Ok(Value::Number(value))
}

fn method(of: &Value, name: &str, values: &[Value]) -> Evaluated {
    match (of, name, values) {
        (Value::Text(text), "split", []) => {
            Ok(Value::List(text.split_whitespace().map(|part| Value::Text(part.to_owned())).collect()))
        }
        (Value::Text(text), "split", [Value::Text(by)]) if !by.is_empty() => {
            Ok(Value::List(text.split(by.as_str()).map(|part| Value::Text(part.to_owned())).collect()))
        }
        (Value::Text(text), "replace", [Value::Text(from), Value::Text(to)]) => Ok(Value::Text(text.replace(from, to))),
        (Value::Text(text), "strip", []) => Ok(Value::Text(text.trim().to_owned())),
        (Value::Text(text), "lower", []) => Ok(Value::Text(text.to_lowercase())),
        (Value::Text(text), "upper", []) => Ok(Value::Text(text.to_uppercase())),
        (Value::Text(text), "startswith", [Value::Text(part)]) => Ok(Value::Bool(text.starts_with(part.as_str()))),
        (Value::Text(text), "endswith", [Value::Text(part)]) => Ok(Value::Bool(text.ends_with(part.as_str()))),
        (Value::Map(map), "keys", []) => Ok(Value::List(map.iter().map(|(key, _)| Value::Text(key.clone())).collect())),
        (Value::Map(map), "values", []) => Ok(Value::List(map.iter().map(|(_, value)| value.clone()).collect())),
        (Value::Map(map), "items", []) => Ok(Value::List(lists::items(map))),
        (Value::Text(by), "join", [Value::List(list)]) => {
            Ok(Value::Text(list.iter().map(ToString::to_string).collect::<Vec<_>>().join(by)))
        }
        (Value::Map(_), "get", [key]) => Ok(item(of, key).unwrap_or(Value::None)),
        (Value::Map(_), "get", [key, preset]) => Ok(item(of, key).unwrap_or_else(|_| preset.clone())),
        _ => Err(format!("{} has no `{name}` of {} arguments", quoted(of), values.len())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Arm;

    impl Names for Arm {
        fn value(&mut self, name: &str) -> Result<Option<Value>, String> {
            Ok(match name {
                "length" => Some(Value::Number(0.5)),
                "count" => Some(Value::Whole(7)),
                "name" => Some(Value::Text("ur5e".to_owned())),
                "limits" => Some(Value::Map(vec![("lower".to_owned(), Value::Number(-1.5))])),
                _ => None,
            })
        }

        fn yaml(&mut self, file: &str) -> Result<Value, String> {
            Err(format!("{file} cannot be read"))
        }

        fn argument(&mut self, name: &str) -> Result<Value, String> {
            Err(format!("argument `{name}` is not given"))
        }

        fn spend(&mut self, size: usize) -> Result<(), String> {
            if size > 1000 { Err("too much".to_owned()) } else { Ok(()) }
        }
    }

    fn worth(text: &str) -> Result<String, String> {
        evaluate(&Expression::parse(text)?, &mut Arm).map(|value| value.to_string())
    }

    #[test]
    fn expressions_are_worth_what_python_says() {
        // each by `python3 -c "print(…)"`
        let cases = [
            ("1 + 2 * 3 ** 2", "19"),
            ("-2 ** 2", "-4"),
            ("2 ** -1", "0.5"),
            ("7 / 2", "3.5"),
            ("7 // 2", "3"),
            ("-7 % 4", "1"),
            ("1/12.0 * 3 * (length**2 + length**2)", "0.125"),
            ("radians(180) == pi", "True"),
            ("'a' if count > 5 and not name == '' else 'b'", "a"),
            ("1 < count <= 7", "True"),
            ("'5' in name", "True"),
            ("limits['lower'] * 2", "-3.0"),
            ("limits.lower", "-1.5"),
            ("name + '_' + str(count)", "ur5e_7"),
            ("'0.1 0.2 0.3'.split(' ')[1]", "0.2"),
            ("[1, 2.5, 'x'][-1]", "x"),
            ("min(3, 1, 2)", "1"),
            ("None or 'preset'", "preset"),
            ("math.sqrt(16)", "4.0"),
            ("dict(a=1, b='c')['b']", "c"),
            ("not not count", "True"),
            ("2 * [1, 'a']", "[1, 'a', 1, 'a']"),
            ("[0] * -1", "[]"),
            ("'ab' * 2", "abab"),
            ("[f.upper() for f in 'th ff'.split()]", "['TH', 'FF']"),
            ("[k + v for k, v in python.zip(['a', 'b'], ['c', 'd']) if k != 'a']", "['bd']"),
            ("[n for n in 'a b'.split() if n in 'ab' and count > 5]", "['a', 'b']"),
            ("dict([(k, v) for k, v in dict(a=1).items()])['a']", "1"),
            ("list(python.set(['a', 'b']) - python.set(['b']))", "['a']"),
            ("len(python.set([1, 2, 1]))", "2"),
            ("python.isinstance(name, list) or python.isinstance(limits, dict)", "True"),
            ("python.any([s in 'a,b' for s in ',;'])", "True"),
            ("python.sum([1, 2.5])", "3.5"),
            ("len(range(1, 7, 2))", "3"),
            ("'-'.join(xacro.tokenize('a, b;c'))", "a-b-c"),
            ("xacro.tokenize('a=1', sep='=')[1]", "1"),
            ("xacro.dotify(dict(a=dict(b=2))).a.b", "2"),
        ];
        for (text, value) in cases {
            assert_eq!(worth(text).as_deref(), Ok(value), "{text}");
        }
    }

    #[test]
    fn what_has_no_value_is_reported() {
        let cases = [
            ("lenght", "there is no property `lenght`"),
            ("1 +", "the expression ends where a value should stand"),
            ("(1", "the expression lacks a `)`"),
            ("1 / 0", "division by 0"),
            ("name * 2.5", "`*` does not go with the text 'ur5e' and a number"),
            ("[1] * 2000", "too much"),
            ("[a for a, b in [1]]", "a number is not 2 values"),
            ("[a for a in count]", "a number has no items"),
            ("[a for 1 in name]", "`for` needs names and an `in`"),
            ("limits['loer']", "the dictionary has no 'loer'; did you mean 'lower'?"),
            ("import os", "`import os` is not an expression that is understood here"),
            ("system('ls')", "the text 'ls' is not a number"),
            ("1 ; 2", "`;` means nothing in an expression"),
            ("xacro.load_yaml('none.yaml')", "none.yaml cannot be read"),
        ];
        for (text, reported) in cases {
            assert_eq!(worth(text), Err(reported.to_owned()), "{text}");
        }
        assert!(worth(&"(".repeat(10_000)).is_err() && worth(&"-".repeat(5_000)).is_err());
        assert!(worth(&"2**".repeat(900)).is_err());
    }
}
