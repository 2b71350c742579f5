//! The YAML that robots' parameters are kept in, as values. Merged dictionaries and several documents are refused; of a
//! key that is there twice the last one holds, as ROS reads it.
//!
//! Source: YAML 1.1, chs. 7 and 8, for what plain scalars mean; the tags `!degrees` and `!radians` are of ROS.

use std::collections::BTreeMap;

use saphyr_parser::{Event, Parser, ScalarStyle, StrInput, Tag};

use super::value::Value;

/// Deepest nesting, with what aliases stand for.
const DEPTH_MAX: usize = 32;
/// Most memory that a file's values take, with what aliases stand for: ten lines of aliases of each other could fill any.
const SIZE_MAX: usize = 64 << 20;
/// About what a value takes beside its text.
const SIZE_OF_VALUE: usize = 64;

/// The value of a file's text.
///
/// # Errors
/// What is not understood, with its line.
pub(super) fn parse(text: &str) -> Result<Value, String> {
    let last_line = text.trim_end().lines().count().max(1);
    let mut reader = Reader { parser: Parser::new_from_str(text), last_line, anchors: BTreeMap::new(), size: 0 };
    let mut value = None;
    loop {
        match reader.next()? {
            (Event::StreamEnd, _) => return Ok(value.unwrap_or(Value::None)),
            (Event::Nothing | Event::StreamStart | Event::DocumentEnd, _) => {}
            (Event::DocumentStart(_), line) if value.is_some() => {
                return Err(format!("line {line}: a second document is not read"));
            }
            (Event::DocumentStart(_), _) => {
                let first = reader.next()?;
                value = Some(reader.node(first, DEPTH_MAX)?.value);
            }
            (_, line) => return Err(format!("line {line}: it stands outside of the document")),
        }
    }
}

/// A value, and what an alias of it adds.
#[derive(Clone)]
struct Measured {
    value: Value,
    size: usize,
    depth: usize,
}

struct Reader<'t> {
    parser: Parser<'t, StrInput<'t>>,
    /// What is missing is missed by the parser behind it.
    last_line: usize,
    anchors: BTreeMap<usize, Measured>,
    /// Of all values that were made.
    size: usize,
}

impl<'t> Reader<'t> {
    /// The next event, with its line.
    fn next(&mut self) -> Result<(Event<'t>, usize), String> {
        match self.parser.next_event() {
            Some(Ok((event, span))) => Ok((event, span.start.line())),
            Some(Err(error)) => {
                let line = error.marker().line().min(self.last_line);
                Err(format!("line {line}: {}", error.info()))
            }
            None => Err(format!("line {}: it ends within a value", self.last_line)),
        }
    }

    /// The value that begins with an event.
    fn node(&mut self, (event, line): (Event<'t>, usize), depth_left: usize) -> Result<Measured, String> {
        let Some(inner_depth) = depth_left.checked_sub(1) else {
            return Err(format!("line {line}: nested more than {DEPTH_MAX} deep"));
        };
        let (anchor, found) = match event {
            Event::Alias(anchor) => {
                // Only what has ended has a value.
                let within = || format!("line {line}: an alias stands within what it names");
                let &Measured { size, depth, .. } = self.anchors.get(&anchor).ok_or_else(within)?;
                if depth > depth_left {
                    return Err(format!("line {line}: nested more than {DEPTH_MAX} deep"));
                }
                self.grow(size, line)?;
                return self.anchors.get(&anchor).cloned().ok_or_else(within);
            }
            Event::Scalar(text, style, anchor, tag) => {
                let size = SIZE_OF_VALUE + text.len();
                self.grow(size, line)?;
                let value = scalar(&text, style, tag.as_deref()).map_err(|wrong| format!("line {line}: {wrong}"))?;
                (anchor, Measured { value, size, depth: 1 })
            }
            Event::SequenceStart(anchor, None) => (anchor, self.list(line, inner_depth)?),
            Event::MappingStart(anchor, None) => (anchor, self.map(line, inner_depth)?),
            Event::SequenceStart(_, Some(tag)) | Event::MappingStart(_, Some(tag)) => {
                return Err(format!("line {line}: `{tag}` is not understood here"));
            }
            _ => return Err(format!("line {line}: a value is expected")),
        };
        // 0 stands for no anchor.
        if anchor != 0 {
            self.grow(found.size, line)?;
            self.anchors.insert(anchor, found.clone());
        }
        Ok(found)
    }

    fn list(&mut self, line: usize, depth_left: usize) -> Result<Measured, String> {
        self.grow(SIZE_OF_VALUE, line)?;
        let (mut list, mut size, mut depth) = (Vec::new(), SIZE_OF_VALUE, 1);
        loop {
            let next = self.next()?;
            if matches!(next.0, Event::SequenceEnd) {
                return Ok(Measured { value: Value::List(list), size, depth });
            }
            let item = self.node(next, depth_left)?;
            (size, depth) = (size + item.size, depth.max(1 + item.depth));
            list.push(item.value);
        }
    }

    fn map(&mut self, line: usize, depth_left: usize) -> Result<Measured, String> {
        self.grow(SIZE_OF_VALUE, line)?;
        let (mut map, mut size, mut depth) = (Map::default(), SIZE_OF_VALUE, 1);
        loop {
            let next = self.next()?;
            if matches!(next.0, Event::MappingEnd) {
                return Ok(Measured { value: Value::Map(map.entries), size, depth });
            }
            let line = next.1;
            let is_plain = matches!(next.0, Event::Scalar(_, ScalarStyle::Plain, ..));
            let key = self.node(next, depth_left)?;
            size += key.size;
            let key = match key.value {
                Value::Text(text) => text,
                list @ (Value::List(_) | Value::Map(_)) => {
                    return Err(format!("line {line}: {} cannot be a key", list.sort()));
                }
                other => other.to_string(),
            };
            if is_plain && key == "<<" {
                return Err(format!("line {line}: `<<` is not understood here"));
            }
            let next = self.next()?;
            let value = self.node(next, depth_left)?;
            (size, depth) = (size + value.size, depth.max(1 + value.depth));
            map.put(key, value.value);
        }
    }

    fn grow(&mut self, size: usize, line: usize) -> Result<(), String> {
        self.size = self.size.saturating_add(size);
        if self.size > SIZE_MAX {
            return Err(format!(
                "line {line}: the values take more than {} MiB with what aliases stand for",
                SIZE_MAX >> 20
            ));
        }
        Ok(())
    }
}

/// Entries in their order, found by key.
#[derive(Default)]
struct Map {
    entries: Vec<(String, Value)>,
    places: BTreeMap<String, usize>,
}

impl Map {
    fn put(&mut self, key: String, value: Value) {
        if let Some(place) = self.places.get(&key) {
            self.entries[*place].1 = value;
        } else {
            self.places.insert(key.clone(), self.entries.len());
            self.entries.push((key, value));
        }
    }
}

fn scalar(text: &str, style: ScalarStyle, tag: Option<&Tag>) -> Result<Value, String> {
    let value = if style == ScalarStyle::Plain { plain(text) } else { Value::Text(text.to_owned()) };
    let Some(tag) = tag else { return Ok(value) };
    let angle = || value.number().ok_or_else(|| format!("`{text}` is not an angle"));
    match (&*tag.handle, &*tag.suffix) {
        ("!", "degrees") => Ok(Value::Number(angle()?.to_radians())),
        ("!", "radians") => Ok(Value::Number(angle()?)),
        // What has this tag and nothing else is a text, as if it had quotes.
        ("", "!") => Ok(Value::Text(text.to_owned())),
        _ => Err(format!("`{tag}` is not understood here")),
    }
}

fn plain(text: &str) -> Value {
    match text {
        "" | "~" | "null" | "Null" | "NULL" => Value::None,
        "true" | "True" | "TRUE" | "yes" | "Yes" | "on" | "On" => Value::Bool(true),
        "false" | "False" | "FALSE" | "no" | "No" | "off" | "Off" => Value::Bool(false),
        ".inf" => Value::Number(f64::INFINITY),
        "-.inf" => Value::Number(f64::NEG_INFINITY),
        _ => Value::literal(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

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
    fn all_forms_of_scalars_are_read() {
        let text = "%YAML 1.1\n---\r\na: \"x\\ty\"\r\nb: 'it''s'\nc: |\n  two\n  lines\nd: >\n  one\n  line\n\
            1: !radians 2\n? on\n: ~\ne: two\n  words\nf: \"1\"\n...\n";
        let read = parse(text).unwrap().to_string();
        assert_eq!(
            read,
            "{'a': 'x\ty', 'b': 'it's', 'c': 'two\nlines\n', 'd': 'one line\n', '1': 2.0, 'True': None, 'e': 'two words', \
             'f': '1'}"
        );
        assert_eq!([parse(""), parse("# nothing\n"), parse("---\n")], [const { Ok(Value::None) }; 3]);
    }

    #[test]
    fn what_is_not_understood_has_its_line() {
        let cases = [
            ("a: 1\nb: *x\n", "line 2: while parsing node, found unknown anchor"),
            ("a: 1\nb: !x y\n", "line 2: `!x` is not understood here"),
            ("a: 1\nb: !degrees y\n", "line 2: `y` is not an angle"),
            ("a: [1, 2\n", "line 1: while parsing a flow sequence, expected ',' or ']'"),
            ("a: 1\n  b: 2\n", "line 2: mapping values are not allowed in this context"),
            ("a:\n\tb: 2\n", "line 2: tabs disallowed within this context (block indentation)"),
            ("a: 1\nrubbish\n", "line 2: simple key expect ':'"),
            ("a: [1 2}]\n", "line 1: while parsing a flow sequence, expected ',' or ']'"),
            ("a: 1\n<<: {b: 2}\n", "line 2: `<<` is not understood here"),
            ("a: 1\n? [b]\n: 2\n", "line 2: a list cannot be a key"),
            ("a: 1\n---\nb: 2\n", "line 2: a second document is not read"),
            ("a: &b [1, *b]\n", "line 1: an alias stands within what it names"),
        ];
        for (text, reported) in cases {
            assert_eq!(parse(text), Err(reported.to_owned()), "{text}");
        }
    }

    #[test]
    fn depth_is_limited_also_through_aliases() {
        let deep: String = (0..100).map(|k| format!("{}k:\n", " ".repeat(k))).collect();
        assert!(parse(&deep).unwrap_err().contains("nested more than 32 deep"));
        for text in
            [format!("a: {}", "[".repeat(100_000) + &"]".repeat(100_000)), "- ".repeat(100_000), "? ".repeat(100_000)]
        {
            assert!(parse(&text).unwrap_err().starts_with("line 1: "));
        }
        let chain: String = (1..40).map(|k| format!("a{k}: &a{k} [*a{}]\n", k - 1)).collect();
        let error = parse(&format!("a0: &a0 x\n{chain}")).unwrap_err();
        assert_eq!(error, "line 32: nested more than 32 deep");
    }

    #[test]
    fn aliases_of_aliases_do_not_fill_the_memory() {
        let many = |first: &str| {
            let lines = (1..20).map(|k| format!("a{k}: &a{k} [{}]\n", vec![format!("*a{}", k - 1); 10].join(", ")));
            format!("a0: &a0 {first}\n{}", lines.collect::<String>())
        };
        assert_eq!(
            parse(&many("x")).unwrap_err(),
            "line 7: the values take more than 64 MiB with what aliases stand for"
        );
        assert!(parse(&many(&"x".repeat(1 << 20))).unwrap_err().starts_with("line 3: the values take"));
    }

    proptest! {
        #[test]
        fn any_text_is_borne(text in r#"[-?:,\[\]{}#&*!|>'"%@` \n\r\t~<ax1.é\u{feff}\u{85}]{0,60}"#) {
            let read = parse(&text);
            prop_assert!(read.as_ref().err().is_none_or(|error| error.starts_with("line ")), "{read:?}");
        }
    }
}
