//! The modules below a folder, and the paths that each of them names.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::tokens::{Token, tokens};

/// A module's place: the names of the modules around it, from the folder on.
pub type Place = Vec<String>;

/// A path as it is written, from where it is written.
#[derive(Debug, Clone)]
pub struct Named {
    pub file: PathBuf,
    pub line: usize,
    /// The module in which the path stands.
    pub from: Place,
    pub to: Vec<String>,
}

/// A field of a structure that more than its own module sees.
#[derive(Debug, Clone)]
pub struct Field {
    pub file: PathBuf,
    pub line: usize,
    /// The module that declares it.
    pub of: Place,
    pub structure: String,
    pub name: String,
    /// What stands between the parentheses of `pub`; nothing for a plain one.
    pub sight: Vec<String>,
}

/// All modules below a folder.
pub struct Sources {
    /// Modules from the crate's root to the folder: what `crate::` must begin with to lead into it.
    pub above: Place,
    pub modules: BTreeSet<Place>,
    /// Those of them that only the module around them sees.
    pub private: BTreeSet<Place>,
    pub fields: Vec<Field>,
    pub named: Vec<Named>,
    /// What modules import, by the name that it has there: re-exports lead further.
    pub imports: BTreeMap<(Place, String), Vec<String>>,
}

impl Sources {
    /// `None` for a folder that has no file of its own, such as one of texts that are included.
    ///
    /// # Panics
    /// If a source cannot be read.
    pub fn read(folder: &Path) -> Option<Self> {
        let above = folder.components().map(|part| part.as_os_str().to_string_lossy().into_owned());
        let above: Vec<String> = above.collect();
        let src = above.iter().rposition(|part| part == "src").expect("rooms stand below `src`");
        let mut read = Self {
            above: above[src + 1..].to_vec(),
            modules: BTreeSet::new(),
            private: BTreeSet::new(),
            fields: Vec::new(),
            named: Vec::new(),
            imports: BTreeMap::new(),
        };
        let root = ["mod.rs", "lib.rs", "main.rs"].map(|name| folder.join(name)).into_iter().find(|file| file.exists());
        let root = root.or_else(|| Some(folder.with_extension("rs")).filter(|file| file.exists()));
        read.module(&root?, folder, Vec::new());
        Some(read)
    }

    /// Reads the file of a module, then those of the modules that it declares; the files that are theirs lie in `folder`.
    #[expect(clippy::needless_pass_by_value, reason = "each module has its own")]
    fn module(&mut self, file: &Path, folder: &Path, place: Place) {
        let text = std::fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let mut reader = Reader {
            tokens: tokens(&text),
            at: 0,
            file,
            place: place.clone(),
            around: Vec::new(),
            children: Vec::new(),
            sources: self,
        };
        reader.read();
        let children = reader.children;
        self.modules.insert(place.clone());
        for child in children {
            let inner = folder.join(&child);
            let beside = folder.join(format!("{child}.rs"));
            let own = inner.join("mod.rs");
            let mut place = place.clone();
            place.push(child);
            // What a crate includes from elsewhere (`#[path]`, generated text) is not below its folder.
            if let Some(file) = [beside, own].into_iter().find(|file| file.exists()) {
                self.module(&file, &inner, place);
            }
        }
    }
}

/// Words that begin an item; without one of them an attribute stands before an entry, a field or a statement.
const ITEMS: &[&str] = &["const", "enum", "fn", "impl", "mod", "static", "struct", "trait", "type", "union", "use"];

struct Reader<'s> {
    tokens: Vec<(Token, usize)>,
    at: usize,
    file: &'s Path,
    place: Place,
    /// How many braces are open where modules inside of the file end.
    around: Vec<usize>,
    children: Vec<String>,
    sources: &'s mut Sources,
}

impl Reader<'_> {
    fn peek(&self, ahead: usize) -> Option<&Token> {
        self.tokens.get(self.at + ahead).map(|(token, _)| token)
    }

    fn word(&self, ahead: usize) -> Option<String> {
        match self.peek(ahead) {
            Some(Token::Word(word)) => Some(word.clone()),
            _ => None,
        }
    }

    fn is_mark(&self, ahead: usize, mark: char) -> bool {
        self.peek(ahead).is_some_and(|token| token.is_mark(mark))
    }

    fn read(&mut self) {
        let mut depth = 0;
        while let Some(token) = self.peek(0).cloned() {
            match token {
                Token::Mark('#') if self.begins_test() => self.skip_item(),
                Token::Mark('{') => {
                    depth += 1;
                    self.at += 1;
                }
                Token::Mark('}') => {
                    depth -= 1;
                    if self.around.last() == Some(&depth) {
                        self.around.pop();
                        self.place.pop();
                    }
                    self.at += 1;
                }
                Token::Word(word) if word == "mod" && self.word(1).is_some() => {
                    let name = self.word(1).unwrap_or_default();
                    // What is seen has `pub`, or the parenthesis behind it, in front.
                    let before = self.at.checked_sub(1).and_then(|at| self.tokens.get(at));
                    if !before.is_some_and(|(token, _)| token.is_word("pub") || token.is_mark(')')) {
                        let place = self.place.iter().chain([&name]).cloned().collect();
                        self.sources.private.insert(place);
                    }
                    if self.is_mark(2, '{') {
                        self.around.push(depth);
                        self.place.push(name);
                        self.sources.modules.insert(self.place.clone());
                        depth += 1;
                    } else {
                        self.children.push(name);
                    }
                    self.at += 3;
                }
                Token::Word(word) if word == "use" => {
                    self.at += 1;
                    self.tree(&[]);
                }
                Token::Word(word) if word == "struct" => self.structure(),
                Token::Word(_) => self.path(),
                _ => self.at += 1,
            }
        }
    }

    /// `#[cfg(test)]` or `#[test]` here.
    fn begins_test(&self) -> bool {
        let plain = self.peek(2).is_some_and(|token| token.is_word("test")) && self.is_mark(3, ']');
        let cfg = self.peek(2).is_some_and(|token| token.is_word("cfg"));
        self.is_mark(1, '[') && (plain || cfg && self.peek(4).is_some_and(|token| token.is_word("test")))
    }

    /// Skips attributes, then to the end of the item: its `;`, or the brace that closes it. An entry of a list, or a
    /// field, ends at its comma or before the bracket that closes what it stands in.
    fn skip_item(&mut self) {
        let mut depth = 0_usize;
        let mut is_item = false;
        while let Some(token) = self.peek(0).cloned() {
            // The bracket of what stands around belongs to the reader of that.
            if depth == 0 && matches!(token, Token::Mark('}' | ']' | ')')) {
                return;
            }
            self.at += 1;
            match token {
                Token::Word(word) if depth == 0 && ITEMS.contains(&word.as_str()) => is_item = true,
                Token::Mark('{' | '[' | '(') => depth += 1,
                Token::Mark(close @ ('}' | ']' | ')')) => {
                    depth -= 1;
                    if depth == 0 && close == '}' {
                        return;
                    }
                }
                Token::Mark(';') if depth == 0 => return,
                // The commas of an item stand between its type parameters, or in its bounds.
                Token::Mark(',') if depth == 0 && !is_item => return,
                _ => {}
            }
        }
    }

    /// The tree of a `use`, whose paths begin with `before`.
    fn tree(&mut self, before: &[String]) {
        let mut segments = before.to_vec();
        let line = self.tokens.get(self.at).map_or(0, |(_, line)| *line);
        if self.peek(0) == Some(&Token::Path) {
            self.at += 1;
        }
        loop {
            if self.is_mark(0, '{') {
                self.at += 1;
                while self.peek(0).is_some() && !self.is_mark(0, '}') {
                    self.tree(&segments);
                    if self.is_mark(0, ',') {
                        self.at += 1;
                    }
                }
                self.at += 1;
                return;
            }
            match self.word(0) {
                // `a::{self}` is `a`, except at the beginning.
                Some(word) if word == "self" && !segments.is_empty() => {}
                Some(word) => segments.push(word),
                None => {}
            }
            self.at += 1;
            if self.peek(0) != Some(&Token::Path) {
                break;
            }
            self.at += 1;
        }
        let mut name = segments.last().cloned().unwrap_or_default();
        if self.peek(0).is_some_and(|token| token.is_word("as")) {
            name = self.word(1).unwrap_or_default();
            self.at += 2;
        }
        self.sources.imports.insert((self.place.clone(), name), segments.clone());
        self.add(segments, line);
    }

    /// Notes the fields of a structure that others see; their types are read as any text.
    fn structure(&mut self) {
        let structure = self.word(1).unwrap_or_default();
        self.at += 2;
        let mut ahead = 0;
        while self.peek(ahead).is_some() && !self.is_mark(ahead, '{') {
            // A tuple, or nothing inside.
            if self.is_mark(ahead, ';') || self.is_mark(ahead, '(') {
                return;
            }
            ahead += 1;
        }
        let mut depth = 0;
        while let Some(token) = self.peek(ahead).cloned() {
            match token {
                Token::Mark('{' | '(' | '[') => depth += 1,
                Token::Mark('}' | ')' | ']') => depth -= 1,
                Token::Word(word) if word == "pub" && depth == 1 => self.field(&structure, ahead + 1),
                _ => {}
            }
            if depth == 0 {
                return;
            }
            ahead += 1;
        }
    }

    /// A field whose `pub` ends before `ahead`.
    fn field(&mut self, structure: &str, mut ahead: usize) {
        let mut sight = Vec::new();
        if self.is_mark(ahead, '(') {
            while self.peek(ahead).is_some() && !self.is_mark(ahead, ')') {
                sight.extend(self.word(ahead).filter(|word| word != "in"));
                ahead += 1;
            }
            ahead += 1;
        }
        let line = self.tokens.get(self.at + ahead).map_or(0, |(_, line)| *line);
        let (of, name) = (self.place.clone(), self.word(ahead).unwrap_or_default());
        let (file, structure) = (self.file.to_owned(), structure.to_owned());
        self.sources.fields.push(Field { file, line, of, structure, name, sight });
    }

    /// A path in the text; a word alone is none.
    fn path(&mut self) {
        let line = self.tokens.get(self.at).map_or(0, |(_, line)| *line);
        let mut segments = Vec::new();
        while let Some(word) = self.word(0) {
            segments.push(word);
            self.at += 1;
            if self.peek(0) != Some(&Token::Path) {
                break;
            }
            self.at += 1;
        }
        let relative = segments.first().is_some_and(|first| matches!(first.as_str(), "crate" | "super" | "self"));
        if relative && segments.len() > 1 {
            self.add(segments, line);
        }
    }

    fn add(&mut self, to: Vec<String>, line: usize) {
        self.sources.named.push(Named { file: self.file.to_owned(), line, from: self.place.clone(), to });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The paths that a text names, read as a module of its own.
    fn named(text: &str) -> Vec<String> {
        let mut sources = Sources {
            above: Vec::new(),
            modules: BTreeSet::new(),
            private: BTreeSet::new(),
            fields: Vec::new(),
            named: Vec::new(),
            imports: BTreeMap::new(),
        };
        Reader {
            tokens: tokens(text),
            at: 0,
            file: Path::new("text.rs"),
            place: Vec::new(),
            around: Vec::new(),
            children: Vec::new(),
            sources: &mut sources,
        }
        .read();
        sources.named.iter().map(|named| named.to.join("::")).collect()
    }

    #[test]
    fn what_only_tests_compile_ends_where_it_stands() {
        let list = "fn all() { [crate::a, #[cfg(test)] crate::b, crate::c, #[cfg(test)] crate::d] } use crate::e;";
        assert_eq!(named(list), ["crate::a", "crate::c", "crate::e"]);
        let field = "struct S { a: crate::a, #[cfg(test)] b: crate::b } fn f() { crate::c() }";
        assert_eq!(named(field), ["crate::a", "crate::c"]);
        let item = "#[cfg(test)] fn f<A, B>(a: crate::a) -> B where A: X, B: Y { crate::b() } use crate::c;";
        assert_eq!(named(item), ["crate::c"]);
        let tests = "mod m { fn f() { crate::a() } #[cfg(test)] mod tests { use crate::b; } } use crate::c;";
        assert_eq!(named(tests), ["crate::a", "crate::c"]);
    }
}
