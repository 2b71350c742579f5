//! The properties of a xacro: what a name is worth where it is used.
//!
//! A call of a macro opens a frame above that of the caller, whose names it sees. A property is worth
//! what its text says when somebody first asks, in the frame that it was defined in.

use std::path::Path;
use std::sync::Arc;

use super::evaluate::evaluate;
use super::expression::Expression;
use super::lists;
use super::names::Names;
use super::value::Value;
use super::yaml;
use crate::robot::package::{self, Packages};
use crate::robot::xml::Element;

/// Deepest chain of properties that are each written by another.
const CHAIN_MAX: usize = 32;

/// What a name stands for.
#[derive(Clone, Debug)]
pub(super) enum Property {
    Value(Value),
    /// A text that nobody has asked for yet.
    Text(String),
    Block(Arc<Vec<Element>>),
}

/// Where an export goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reach {
    Here,
    Parent,
    Global,
}

/// All frames that are open, and what expressions ask for beside properties.
pub(super) struct Scope<'r> {
    frames: Vec<Vec<(String, Property)>>,
    /// How many of the frames a text being evaluated sees.
    visible: usize,
    chain: Vec<String>,
    /// How much lists may have that are still to be made.
    size_left: usize,
    pub(super) arguments: Vec<(String, Value)>,
    pub(super) packages: &'r Packages,
    /// The file whose text is read now.
    pub(super) file: std::path::PathBuf,
}

impl<'r> Scope<'r> {
    pub(super) fn new(packages: &'r Packages, file: &Path, arguments: Vec<(String, Value)>) -> Self {
        let file = file.to_path_buf();
        Self {
            frames: vec![Vec::new()],
            visible: 1,
            chain: Vec::new(),
            size_left: lists::SIZE_MAX,
            arguments,
            packages,
            file,
        }
    }

    pub(super) fn open(&mut self, frame: Vec<(String, Property)>) {
        self.frames.push(frame);
        self.visible = self.frames.len();
    }

    pub(super) fn close(&mut self) {
        self.frames.pop();
        self.visible = self.frames.len();
    }

    /// Frame and place of a name, as seen now.
    fn find(&self, name: &str) -> Option<(usize, usize)> {
        (0..self.visible).rev().find_map(|frame| {
            let at = self.frames[frame].iter().position(|(known, _)| known == name)?;
            Some((frame, at))
        })
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.find(name).is_some()
    }

    /// The elements behind a name.
    pub(super) fn block(&self, name: &str) -> Option<Arc<Vec<Element>>> {
        match self.find(name).map(|(frame, at)| &self.frames[frame][at].1) {
            Some(Property::Block(block)) => Some(Arc::clone(block)),
            _ => None,
        }
    }

    /// Takes a name out of all frames that are seen.
    pub(super) fn remove(&mut self, name: &str) {
        while let Some((frame, at)) = self.find(name) {
            self.frames[frame].remove(at);
        }
    }

    pub(super) fn set(&mut self, name: &str, property: Property, reach: Reach) {
        let last = self.frames.len() - 1;
        let frame = match reach {
            Reach::Here => last,
            Reach::Parent => last.saturating_sub(1),
            Reach::Global => 0,
        };
        let frame = &mut self.frames[frame];
        match frame.iter_mut().find(|(known, _)| known == name) {
            Some((_, known)) => *known = property,
            None => frame.push((name.to_owned(), property)),
        }
    }

    /// What a text is worth: the value of its only expression, or the text with all of them put in.
    ///
    /// # Errors
    /// Why an expression in it has no value.
    pub(super) fn text(&mut self, text: &str) -> Result<Value, String> {
        let mut parts: Vec<Value> = Vec::new();
        let mut rest = text;
        while let Some(at) = rest.find('$') {
            let dollars = rest[at..].len() - rest[at..].trim_start_matches('$').len();
            let (before, behind) = (&rest[..at], &rest[at + dollars..]);
            if !before.is_empty() {
                parts.push(Value::Text(before.to_owned()));
            }
            let open = behind.chars().next().filter(|open| matches!(open, '{' | '('));
            match (open, dollars) {
                (Some(open), 1) => {
                    let close = if open == '{' { '}' } else { ')' };
                    let end = closing(behind, open, close).ok_or_else(|| format!("`${behind}` has no end"))?;
                    let inner = &behind[1..end];
                    parts.push(if open == '{' { self.expression(inner)? } else { self.extension(inner)? });
                    rest = &behind[end + 1..];
                }
                // `$${` is a `${` that means nothing
                (open, _) => {
                    let kept = if open.is_some() { dollars - 1 } else { dollars };
                    let letter = open.map(String::from).unwrap_or_default();
                    parts.push(Value::Text("$".repeat(kept) + &letter));
                    rest = &behind[letter.len()..];
                }
            }
        }
        if !rest.is_empty() {
            parts.push(Value::Text(rest.to_owned()));
        }
        if parts.len() == 1 {
            return Ok(parts.remove(0));
        }
        Ok(Value::Text(parts.iter().map(ToString::to_string).collect()))
    }

    fn expression(&mut self, text: &str) -> Result<Value, String> {
        // `$(find …)` may stand within an expression
        let text = if text.contains("$(") { self.text(text)?.to_string() } else { text.to_owned() };
        evaluate(&Expression::parse(&text)?, self)
    }

    /// `$(find package)`, `$(arg name)` and others.
    fn extension(&mut self, text: &str) -> Result<Value, String> {
        let text = if text.contains("$(") { self.text(text)?.to_string() } else { text.to_owned() };
        let (command, rest) = text.trim().split_once(char::is_whitespace).unwrap_or((text.trim(), ""));
        let rest = rest.trim();
        match command {
            "find" => self.package(rest),
            "arg" => self.argument(rest),
            "eval" => self.expression(rest),
            "dirname" => {
                let folder = self.file.parent().unwrap_or_else(|| Path::new(""));
                Ok(Value::Text(package::absolute(folder).display().to_string()))
            }
            "optenv" => Ok(Value::Text(rest.split_once(' ').map_or("", |(_, preset)| preset).to_owned())),
            "env" => Err(format!("`$(env {rest})`: a scene does not depend on the environment")),
            other => Err(format!("`$({other} …)` is not understood here")),
        }
    }

    fn package(&self, name: &str) -> Result<Value, String> {
        let found = self.packages.find_absolute(name, &self.file);
        let lost = || {
            format!("no folder around it is the package `{name}`; say where: `packages = {{ {name} = \"folder\" }}`")
        };
        found.map(|folder| Value::Text(folder.display().to_string())).ok_or_else(lost)
    }
}

/// Where the bracket that a text begins with is closed, outside of quotes.
pub(super) fn closing(text: &str, open: char, close: char) -> Option<usize> {
    let mut depth = 0_usize;
    let mut quote = None;
    for (at, letter) in text.char_indices() {
        if let Some(mark) = quote {
            quote = (mark != letter).then_some(mark);
        } else if open == '{' && matches!(letter, '\'' | '"') {
            quote = Some(letter);
        } else if letter == open {
            depth += 1;
        } else if letter == close {
            depth -= 1;
            if depth == 0 {
                return Some(at);
            }
        }
    }
    None
}

impl Names for Scope<'_> {
    fn value(&mut self, name: &str) -> Result<Option<Value>, String> {
        let Some((frame, at)) = self.find(name) else { return Ok(None) };
        let text = match &self.frames[frame][at].1 {
            Property::Value(value) => return Ok(Some(value.clone())),
            Property::Block(_) => return Err(format!("`{name}` is a block and has no value")),
            Property::Text(text) => text.clone(),
        };
        if let Some(first) = self.chain.iter().position(|known| known == name) {
            let others: String = self.chain[first + 1..].iter().map(|other| format!(" by way of `{other}`")).collect();
            return Err(format!("`{name}` needs itself{others}"));
        }
        if self.chain.len() >= CHAIN_MAX {
            return Err(format!("it needs a chain of more than {CHAIN_MAX} properties"));
        }
        self.chain.push(name.to_owned());
        let seen = std::mem::replace(&mut self.visible, frame + 1);
        let value = self.text(&text);
        self.visible = seen;
        self.chain.pop();
        let value = match value.map_err(|cause| format!("property `{name}`: {cause}"))? {
            Value::Text(text) => Value::literal(&text),
            other => other,
        };
        self.frames[frame][at].1 = Property::Value(value.clone());
        Ok(Some(value))
    }

    fn yaml(&mut self, file: &str) -> Result<Value, String> {
        let path = self.packages.file(file, &self.file).map_err(|cause| format!("names `{file}`, {cause}"))?;
        let file = &package::shown(Path::new(file));
        let text = self.packages.read_text(&path).map_err(|error| format!("`{file}` cannot be read: {error}"))?;
        yaml::parse(&text).map_err(|cause| format!("`{file}` {cause}"))
    }

    fn argument(&mut self, name: &str) -> Result<Value, String> {
        let found = self.arguments.iter().find(|(known, _)| known == name).map(|(_, value)| value.clone());
        found.ok_or_else(|| format!("argument `{name}` is not given; give it: `arguments = {{ {name} = \"…\" }}`"))
    }

    fn spend(&mut self, size: usize) -> Result<(), String> {
        let left = self.size_left.checked_sub(size);
        self.size_left = left.ok_or_else(|| format!("lists have more than {} values and letters", lists::SIZE_MAX))?;
        Ok(())
    }
}
