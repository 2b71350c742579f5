//! Texts made of others.

use std::path::{Path, PathBuf};

use onescan_iec::input::kind::{FileKind, SourceKind};
use onescan_iec::syntax::tokenize;

/// A source file.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    pub(crate) kind: SourceKind,
    pub(crate) text: String,
}

/// The sources of the project.
pub(crate) struct Corpus {
    /// Program text: the standard library, the shim, the scenarios, the benches, the conformance suite and the examples
    /// of the diagnostics' pages.
    texts: Vec<Source>,
    /// Text in XML.
    documents: Vec<Source>,
}

/// Where they are.
const FOLDERS: [&str; 11] = [
    "iec/library",
    "iec/library/motion",
    "iec-project/shim",
    "docs/codes",
    "tests/inputs",
    "tests/conformance/cases",
    "../scenarios/shear/plc",
    "../scenarios/filling-machine/plc",
    "../scenarios/gantry-robot/plc",
    "../tests/benches/scan",
    "../tests/session",
];

impl Corpus {
    pub(crate) fn read() -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the tests stand beside the crates");
        let files = FOLDERS.iter().flat_map(|folder| sorted(&root.join(folder)));
        let all = files.flat_map(|path| sources(&path));
        let (texts, documents): (Vec<_>, Vec<_>) = all.partition(|source| source.kind == SourceKind::Text);
        assert!(texts.len() > 100 && documents.len() > 3, "the corpus is there");
        Self { texts, documents }
    }
}

fn sorted(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<_> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.sort();
    paths
}

/// What a file holds: a page holds its examples.
fn sources(path: &Path) -> Vec<Source> {
    let Ok(text) = std::fs::read_to_string(path) else { return Vec::new() };
    if path.extension().is_some_and(|extension| extension == "md") {
        let blocks = text.split("```").skip(1).step_by(2);
        let code = |block: &str| block.split_once('\n').map_or(block, |(_, code)| code).to_owned();
        return blocks.map(|block| Source { kind: SourceKind::Text, text: code(block) }).collect();
    }
    match FileKind::of(path) {
        Some(FileKind::Source(kind)) => vec![Source { kind, text }],
        _ => Vec::new(),
    }
}

/// A seeded source of changes (Knuth's linear congruential generator).
pub(crate) struct Mutator {
    state: u64,
}

/// What is put around or between; deep and unfinished on purpose.
const PIECES: [&str; 18] = [
    "(", ")", "[", "]", "(*", "*)", "{", "'", "\"", "END_IF;", "END_VAR", "16#", "T#", ":=", "..", "^", "\u{e4}", "\0",
];

impl Mutator {
    pub(crate) fn new(seed: u64) -> Self {
        Self { state: seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x1234_5678_9abc_def1 }
    }

    fn below(&mut self, limit: usize) -> usize {
        self.state = self.state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.state >> 33) as usize % limit.max(1)
    }

    /// A source of the corpus after one to four changes; one of eight is XML.
    pub(crate) fn mutant(&mut self, corpus: &Corpus) -> Source {
        let among = if self.below(8) == 0 { &corpus.documents } else { &corpus.texts };
        let mut source = among[self.below(among.len())].clone();
        for _ in 0..=self.below(4) {
            source.text = self.change(&source.text, among);
        }
        source
    }

    fn change(&mut self, text: &str, corpus: &[Source]) -> String {
        match self.below(8) {
            0 | 1 => self.tokens(text, |mutator, words| {
                let (one, other) = (mutator.below(words.len()), mutator.below(words.len()));
                words.swap(one, other);
            }),
            2 => self.tokens(text, |mutator, words| {
                words.remove(mutator.below(words.len()));
            }),
            3 => self.tokens(text, |mutator, words| {
                let (from, to) = (mutator.below(words.len()), mutator.below(words.len()));
                words[to] = words[from].clone();
            }),
            4 => self.bytes(text),
            5 => self.splice(text, corpus),
            6 => self.cut(text),
            _ => self.nest(text),
        }
    }

    fn tokens(&mut self, text: &str, change: impl FnOnce(&mut Self, &mut Vec<String>)) -> String {
        let word = |start: u32, end: u32| text.get(start as usize..end as usize).unwrap_or("").to_owned();
        let mut words: Vec<String> = tokenize(text).iter().map(|token| word(token.start, token.end)).collect();
        if !words.is_empty() {
            change(self, &mut words);
        }
        words.concat()
    }

    fn bytes(&mut self, text: &str) -> String {
        let mut bytes = text.as_bytes().to_vec();
        if !bytes.is_empty() {
            let at = self.below(bytes.len());
            bytes[at] ^= 1 << self.below(8);
        }
        String::from_utf8_lossy(&bytes).into_owned()
    }

    /// A place between two characters.
    fn place(&mut self, text: &str) -> usize {
        let mut at = self.below(text.len() + 1);
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        at
    }

    fn splice(&mut self, text: &str, corpus: &[Source]) -> String {
        let other = &corpus[self.below(corpus.len())].text;
        let (front, back) = (self.place(text), self.place(other));
        format!("{}{}", &text[..front], &other[back..])
    }

    fn cut(&mut self, text: &str) -> String {
        let end = self.place(text);
        text[..end].to_owned()
    }

    fn nest(&mut self, text: &str) -> String {
        let (at, piece) = (self.place(text), PIECES[self.below(PIECES.len())]);
        let times = 1 + self.below(300);
        format!("{}{}{}", &text[..at], piece.repeat(times), &text[at..])
    }
}
