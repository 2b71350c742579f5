//! The YAML that robots' parameters are kept in: dictionaries and lists by indentation or in brackets,
//! plain and quoted scalars, anchors, comments. Block texts, merged dictionaries and several documents are
//! refused; of a key that is there twice the last one holds, as ROS reads it.
//!
//! Source: YAML 1.1, chs. 7 and 8; the tags `!degrees` and `!radians` are of ROS.

use super::value::Value;

/// Deepest nesting.
const DEPTH_MAX: usize = 32;

struct Line<'t> {
    number: usize,
    indent: usize,
    text: &'t str,
}

/// The value of a file's text.
///
/// # Errors
/// What is not understood, with its line.
pub(super) fn parse(text: &str) -> Result<Value, String> {
    let mut lines = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = uncommented(line).trim_end();
        let inner = line.trim_start();
        if inner.is_empty() || inner == "---" || line.starts_with('%') {
            continue;
        }
        if line[..line.len() - inner.len()].contains('\t') {
            return Err(format!("line {}: a tab in an indentation", index + 1));
        }
        lines.push(Line { number: index + 1, indent: line.len() - inner.len(), text: inner });
    }
    let mut reader = Reader { lines, at: 0, anchors: Vec::new() };
    let Some(first) = reader.lines.first() else { return Ok(Value::None) };
    let indent = first.indent;
    let value = reader.block(indent, DEPTH_MAX)?;
    match reader.lines.get(reader.at) {
        None => Ok(value),
        Some(line) => Err(format!("line {}: `{}` fits in no list or dictionary", line.number, line.text)),
    }
}

/// A line without its comment.
fn uncommented(line: &str) -> &str {
    let mut quote = None;
    let mut before = ' ';
    for (at, letter) in line.char_indices() {
        match (quote, letter) {
            (None, '#') if before.is_whitespace() => return &line[..at],
            (None, '\'' | '"') if !before.is_alphanumeric() => quote = Some(letter),
            (Some(open), letter) if open == letter => quote = None,
            _ => {}
        }
        before = letter;
    }
    line
}

struct Reader<'t> {
    lines: Vec<Line<'t>>,
    at: usize,
    anchors: Vec<(&'t str, Value)>,
}

impl<'t> Reader<'t> {
    /// The list or dictionary whose lines are indented so far.
    fn block(&mut self, indent: usize, depth: usize) -> Result<Value, String> {
        let Some(first) = self.lines.get(self.at) else { return Ok(Value::None) };
        if depth == 0 {
            return Err(format!("line {}: nested more than {DEPTH_MAX} deep", first.number));
        }
        if first.text == "-" || first.text.starts_with("- ") {
            return self.list(indent, depth);
        }
        if split_key(first.text).is_some() {
            return self.map(indent, depth);
        }
        let (number, text) = (first.number, first.text);
        self.at += 1;
        self.value(text, number, indent, depth)
    }

    fn list(&mut self, indent: usize, depth: usize) -> Result<Value, String> {
        let mut list = Vec::new();
        while let Some(line) = self.lines.get(self.at).filter(|line| line.indent == indent) {
            let Some(item) = line.text.strip_prefix('-').filter(|rest| rest.is_empty() || rest.starts_with(' ')) else {
                break;
            };
            let inner = item.trim_start();
            let number = line.number;
            if split_key(inner).is_some() {
                // the item is a dictionary that begins behind the dash
                let indent = indent + line.text.len() - inner.len();
                self.lines[self.at] = Line { number, indent, text: inner };
                list.push(self.map(indent, depth - 1)?);
            } else {
                self.at += 1;
                list.push(self.value(inner, number, indent + 1, depth)?);
            }
        }
        Ok(Value::List(list))
    }

    fn map(&mut self, indent: usize, depth: usize) -> Result<Value, String> {
        let mut map: Vec<(String, Value)> = Vec::new();
        while let Some(line) = self.lines.get(self.at).filter(|line| line.indent == indent) {
            let number = line.number;
            let Some((key, rest)) = split_key(line.text) else {
                return Err(format!("line {number}: `{}` is no `key: value`", line.text));
            };
            let key = match scalar(key, number)? {
                Value::Text(text) => text,
                other => other.to_string(),
            };
            if key == "<<" {
                return Err(format!("line {number}: `<<` is not understood here"));
            }
            self.at += 1;
            let value = self.value(rest, number, indent + 1, depth)?;
            match map.iter_mut().find(|(known, _)| *known == key) {
                Some((_, known)) => *known = value,
                None => map.push((key, value)),
            }
        }
        Ok(Value::Map(map))
    }

    /// What stands behind a key or a dash, or in the lines below that are indented by `indent` or more.
    fn value(&mut self, text: &'t str, number: usize, indent: usize, depth: usize) -> Result<Value, String> {
        if let Some(anchored) = text.strip_prefix('&') {
            let (name, rest) = anchored.split_once(' ').unwrap_or((anchored, ""));
            let value = self.value(rest.trim(), number, indent, depth)?;
            self.anchors.push((name, value.clone()));
            return Ok(value);
        }
        if let Some(name) = text.strip_prefix('*') {
            let found = self.anchors.iter().rev().find(|(known, _)| *known == name).map(|(_, value)| value.clone());
            return found.ok_or_else(|| format!("line {number}: there is no `&{name}`"));
        }
        if text.is_empty() {
            let Some(next) = self.lines.get(self.at) else { return Ok(Value::None) };
            // a list may stand right below its key
            let beside = next.indent + 1 == indent && next.text.starts_with('-');
            let inner = next.indent;
            return if inner >= indent || beside { self.block(inner, depth - 1) } else { Ok(Value::None) };
        }
        if !text.starts_with(['[', '{']) {
            return scalar(text, number);
        }
        let mut whole = text.to_owned();
        while !is_closed(&whole) {
            let Some(next) = self.lines.get(self.at) else {
                return Err(format!("line {number}: a bracket is not closed"));
            };
            whole.push(' ');
            whole.push_str(next.text);
            self.at += 1;
        }
        let mut rest = whole.as_str();
        let value = flow(&mut rest, number, depth)?;
        if rest.trim().is_empty() { Ok(value) } else { Err(format!("line {number}: `{rest}` stands behind a bracket")) }
    }
}

/// Key and rest of a line; none for a line without a key.
fn split_key(text: &str) -> Option<(&str, &str)> {
    if text.starts_with(['[', '{']) {
        return None;
    }
    let behind_quote = match text.chars().next() {
        Some(quote @ ('\'' | '"')) => text[1..].find(quote).map(|end| end + 2)?,
        _ => 0,
    };
    let colon = text[behind_quote..].match_indices(':').map(|(at, _)| at + behind_quote);
    let at = colon.into_iter().find(|at| text[at + 1..].is_empty() || text[at + 1..].starts_with(' '))?;
    Some((text[..at].trim(), text[at + 1..].trim()))
}

fn is_closed(text: &str) -> bool {
    let count = |signs: [char; 2]| text.matches(signs).count();
    count(['[', '{']) <= count([']', '}'])
}

/// A list or a dictionary in brackets, or a scalar in one.
fn flow(rest: &mut &str, number: usize, depth: usize) -> Result<Value, String> {
    let wrong = |what: &str| Err(format!("line {number}: {what}"));
    if depth == 0 {
        return wrong("brackets are nested too deep");
    }
    *rest = rest.trim_start();
    if let Some(inner) = rest.strip_prefix('[') {
        *rest = inner;
        let mut list = Vec::new();
        loop {
            *rest = rest.trim_start();
            if let Some(behind) = rest.strip_prefix(']') {
                *rest = behind;
                return Ok(Value::List(list));
            }
            list.push(flow(rest, number, depth - 1)?);
            separator(rest, ']', number)?;
        }
    }
    if let Some(inner) = rest.strip_prefix('{') {
        *rest = inner;
        let mut map = Vec::new();
        loop {
            *rest = rest.trim_start();
            if let Some(behind) = rest.strip_prefix('}') {
                *rest = behind;
                return Ok(Value::Map(map));
            }
            let Some((key, behind)) = rest.split_once(':') else { return wrong("a dictionary's key lacks a `:`") };
            let key = scalar(key.trim(), number)?.to_string();
            *rest = behind;
            map.push((key, flow(rest, number, depth - 1)?));
            separator(rest, '}', number)?;
        }
    }
    let end = match rest.chars().next() {
        Some(quote @ ('\'' | '"')) => rest[1..].find(quote).map_or(rest.len(), |end| end + 2),
        _ => rest.find([',', ']', '}']).unwrap_or(rest.len()),
    };
    let (text, behind) = rest.split_at(end);
    *rest = behind;
    scalar(text.trim(), number)
}

fn separator(rest: &mut &str, close: char, number: usize) -> Result<(), String> {
    *rest = rest.trim_start();
    if let Some(behind) = rest.strip_prefix(',') {
        *rest = behind;
        return Ok(());
    }
    if rest.starts_with(close) { Ok(()) } else { Err(format!("line {number}: a `,` or a `{close}` is missing")) }
}

fn scalar(text: &str, number: usize) -> Result<Value, String> {
    let text = text.trim();
    for quote in ['\'', '"'] {
        if let Some(inner) = text.strip_prefix(quote).and_then(|rest| rest.strip_suffix(quote)) {
            return Ok(Value::Text(inner.to_owned()));
        }
    }
    if let Some(tagged) = text.strip_prefix("!degrees ").or_else(|| text.strip_prefix("!radians ")) {
        let angle = scalar(tagged, number)?;
        let angle = angle.number().ok_or_else(|| format!("line {number}: `{tagged}` is no angle"))?;
        return Ok(Value::Number(if text.starts_with("!degrees") { angle.to_radians() } else { angle }));
    }
    if text.starts_with(['&', '*', '|', '>', '!', '%', '@', '`']) {
        return Err(format!("line {number}: `{text}` is not understood here"));
    }
    Ok(match text {
        "" | "~" | "null" | "Null" | "NULL" => Value::None,
        "true" | "True" | "TRUE" | "yes" | "Yes" | "on" | "On" => Value::Bool(true),
        "false" | "False" | "FALSE" | "no" | "No" | "off" | "Off" => Value::Bool(false),
        ".inf" => Value::Number(f64::INFINITY),
        "-.inf" => Value::Number(f64::NEG_INFINITY),
        _ => Value::literal(text),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_robots_keep_is_read() {
        let text = "# limits\n---\njoint_limits:\n  shoulder_pan:   # first\n    has_limits: true\n    min: !degrees -180.0\n    \
            max: 1e-1\n  empty:\nlist:\n- a\n- {x: 1, y: [2, 3.5]}\n- k: v\n  n: 'it # is'\nflow: [1,\n  2]\n\
            file: package://a/b.dae\n\
            left: &l\n  x: 1\nright: *l\nright: *l\n";
        let read = parse(text).unwrap().to_string();
        assert_eq!(
            read,
            "{'joint_limits': {'shoulder_pan': {'has_limits': True, 'min': -3.141592653589793, 'max': 0.1}, 'empty': None}, \
             'list': ['a', {'x': 1, 'y': [2, 3.5]}, {'k': 'v', 'n': 'it # is'}], 'flow': [1, 2], \
             'file': 'package://a/b.dae', 'left': {'x': 1}, 'right': {'x': 1}}"
        );
    }

    #[test]
    fn what_is_not_understood_has_its_line() {
        let cases = [
            ("a: 1\nb: *x\n", "line 2: there is no `&x`"),
            ("a: 1\nb: |\n", "line 2: `|` is not understood here"),
            ("a: [1, 2\n", "line 1: a bracket is not closed"),
            ("a: 1\n  b: 2\n", "line 2: `b: 2` fits in no list or dictionary"),
            ("a:\n\tb: 2\n", "line 2: a tab in an indentation"),
            ("a: 1\nrubbish\n", "line 2: `rubbish` is no `key: value`"),
            ("a: [1 2}]\n", "line 1: a `,` or a `]` is missing"),
        ];
        for (text, told) in cases {
            assert_eq!(parse(text), Err(told.to_owned()), "{text}");
        }
        let deep: String = (0..100).map(|k| format!("{}k:\n", " ".repeat(k))).collect();
        assert!(parse(&deep).is_err() && parse(&format!("a: {}", "[".repeat(100_000) + &"]".repeat(100_000))).is_err());
    }
}
