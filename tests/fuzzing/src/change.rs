//! Changes of bytes, drawn from a seed: flips, cuts, copies, numbers at their limits, words of the format, deep nesting,
//! and pieces of one input in another.

/// Longest input that is made: deep enough to exhaust a stack that nobody guards.
pub const LENGTH_MAX: usize = 96 * 1024;

/// Numbers as text at which readers break.
const NUMBERS: &[&str] = &[
    "-1",
    "0",
    "1",
    "2",
    "255",
    "256",
    "65535",
    "65536",
    "2147483647",
    "2147483648",
    "-2147483649",
    "4294967295",
    "9223372036854775807",
    "9223372036854775808",
    "18446744073709551615",
    "18446744073709551616",
    "1e308",
    "1e309",
    "-1e308",
    "1e-320",
    "nan",
    "inf",
    "-inf",
    "-0.0",
    "0.1",
    "1e18",
    "99999999999999999999",
    "0x7fffffff",
];

/// Signs that mean something to most readers of text.
const PIECES: &[&str] = &[
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    "<",
    ">",
    "\"",
    "'",
    "\n",
    "\0",
    "ä",
    "\u{2028}",
    "=",
    "..",
    "/../",
    "16#",
    "T#",
    "&#0;",
    "&#x1F600;",
    "&amp;",
    "\u{1b}[31m",
    "<![CDATA[",
    "]]>",
    "<!--",
    "-->",
    ",",
    ";",
    ":",
    "#",
    "$",
    "%",
    "^",
    "@",
    "*",
    "(*",
    "*)",
    "//",
    "\\",
    "\\u0000",
    "\u{feff}",
    "\r\n",
    "\t",
];

/// What opens and closes again, for nesting.
const NESTS: &[(&str, &str)] = &[
    ("(", ")"),
    ("[", "]"),
    ("{", "}"),
    ("<a>", "</a>"),
    ("[[", "]]"),
    ("(*", "*)"),
    ("{\"a\":", "}"),
    ("not ", ""),
    ("-", ""),
    ("a.", ""),
    ("IF TRUE THEN ", " END_IF;"),
    ("always (", ")"),
    ("${", "}"),
    ("ARRAY[0..1] OF ", ""),
    ("POINTER TO ", ""),
    ("x(", ")"),
    ("<body>", "</body>"),
    ("<node>", "</node>"),
    ("NOT(", ")"),
    ("1+", ""),
];

/// Integers at their limits.
const LIMITS: &[u64] = &[
    0,
    1,
    2,
    0x7f,
    0x80,
    0xff,
    0x7fff,
    0x8000,
    0xffff,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x7fff_ffff_ffff_ffff,
    0x8000_0000_0000_0000,
    u64::MAX,
    0x7ff0_0000_0000_0000,
    0x7ff8_0000_0000_0000,
    0x7f80_0000,
];

/// Draws from a seed: `SplitMix64`, whose numbers are the same on every machine.
#[derive(Clone, Debug)]
pub struct Draw(u64);

impl Draw {
    /// Draws that begin with `seed`, other ones for each `name`.
    pub fn new(seed: u64, name: &str) -> Self {
        let mixed = name.bytes().fold(seed ^ 0x9e37_79b9_7f4a_7c15, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3).rotate_left(23)
        });
        Self(mixed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// A number below `end`, or 0 if that is 0.
    pub fn below(&mut self, end: usize) -> usize {
        if end == 0 { 0 } else { (self.next() % end as u64) as usize }
    }

    /// One of these.
    pub fn of<'a, T>(&mut self, choices: &'a [T]) -> Option<&'a T> {
        choices.get(self.below(choices.len()))
    }

    /// A length, mostly short.
    fn length(&mut self) -> usize {
        let most = [1, 2, 4, 8, 40, 400, 4000][self.below(7)];
        1 + self.below(most)
    }
}

/// Changes inputs of one target.
pub struct Changer {
    draw: Draw,
    words: Vec<Vec<u8>>,
}

impl Changer {
    /// A changer that knows the words of the format: those given, and those of its good inputs.
    pub fn new(draw: Draw, words: &[&str], seeds: &[Vec<u8>]) -> Self {
        let mut words: Vec<Vec<u8>> = words.iter().map(|word| word.as_bytes().to_vec()).collect();
        for seed in seeds {
            let pieces = seed.split(|byte| !byte.is_ascii_alphanumeric() && *byte != b'_');
            words.extend(pieces.filter(|piece| (2..=32).contains(&piece.len())).take(3_000).map(<[u8]>::to_vec));
        }
        words.sort();
        words.dedup();
        Self { draw, words }
    }

    /// One of `corpus` after a few changes, mostly one; another one may lend pieces.
    pub fn next(&mut self, corpus: &[Vec<u8>]) -> Vec<u8> {
        // What was found last leads on; so half of the time it is one of those.
        let recent = corpus.len().saturating_sub(1 + corpus.len() / 8);
        let at = match self.draw.below(2) {
            0 => self.draw.below(corpus.len()),
            _ => recent + self.draw.below(corpus.len() - recent),
        };
        let mut bytes = corpus[at].clone();
        let other = self.draw.below(corpus.len());
        for _ in 0..[1, 1, 1, 2, 3, 6][self.draw.below(6)] {
            self.change(&mut bytes, &corpus[other]);
        }
        bytes.truncate(LENGTH_MAX);
        bytes
    }

    fn change(&mut self, bytes: &mut Vec<u8>, other: &[u8]) {
        let at = self.draw.below(bytes.len() + 1);
        match self.draw.below(16) {
            0 => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << self.draw.below(8);
                }
            }
            1 if self.draw.below(4) == 0 => bytes.truncate(at),
            1 | 2 => {
                let end = (at + self.draw.length()).min(bytes.len());
                bytes.drain(at..end);
            }
            3 => {
                let end = (at + self.draw.length()).min(bytes.len());
                let times = [1, 1, 2, 50, 1000][self.draw.below(5)].min(LENGTH_MAX / (end - at).max(1));
                let piece = bytes[at..end].repeat(times);
                insert(bytes, at, &piece);
            }
            4 => {
                let from = self.draw.below(other.len() + 1);
                let end = (from + self.draw.length()).min(other.len());
                insert(bytes, at, &other[from..end]);
            }
            5 => {
                // the head of one and the tail of the other
                let from = self.draw.below(other.len() + 1);
                bytes.truncate(at);
                bytes.extend_from_slice(&other[from..]);
            }
            6 | 7 => self.number(bytes, at),
            8 => {
                let (value, width) = (LIMITS[self.draw.below(LIMITS.len())], [1, 2, 4, 8][self.draw.below(4)]);
                let written = if self.draw.below(2) == 0 {
                    value.to_le_bytes()[..width].to_vec()
                } else {
                    value.to_be_bytes()[8 - width..].to_vec()
                };
                let end = (at + width).min(bytes.len());
                bytes.splice(at..end, written);
            }
            9 => insert(bytes, at, PIECES[self.draw.below(PIECES.len())].as_bytes()),
            10 => self.nest(bytes, at),
            11 | 12 => self.word(bytes, at),
            13 => self.lines(bytes),
            14 => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte = self.draw.below(256) as u8;
                }
            }
            _ => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte = byte.wrapping_add([1, 255, 16, 240][self.draw.below(4)]);
                }
            }
        }
    }

    /// Another number in place of the next one.
    fn number(&mut self, bytes: &mut Vec<u8>, at: usize) {
        let Some(start) = (at..bytes.len()).find(|at| bytes[*at].is_ascii_digit()) else { return };
        let end = (start..bytes.len()).find(|at| !bytes[*at].is_ascii_digit() && bytes[*at] != b'.');
        let number = NUMBERS[self.draw.below(NUMBERS.len())];
        bytes.splice(start..end.unwrap_or(bytes.len()), number.bytes());
    }

    /// A word of the format, in place of the next one or beside it.
    fn word(&mut self, bytes: &mut Vec<u8>, at: usize) {
        let is_word = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_';
        let Some(word) = self.draw.of(&self.words).cloned() else { return };
        let start = (at..bytes.len()).find(|at| is_word(bytes[*at])).unwrap_or(bytes.len());
        let end = (start..bytes.len()).find(|at| !is_word(bytes[*at])).unwrap_or(bytes.len());
        let end = if self.draw.below(3) == 0 { start } else { end };
        bytes.splice(start..end, word);
    }

    /// Deeper than anybody would write.
    fn nest(&mut self, bytes: &mut Vec<u8>, at: usize) {
        let (open, close) = NESTS[self.draw.below(NESTS.len())];
        let depth = [2, 20, 200, 2000, 20_000][self.draw.below(5)].min(LENGTH_MAX / (open.len() + close.len()));
        let end = (at + self.draw.below(20)).min(bytes.len());
        let inner = bytes[at..end].to_vec();
        let nested = [open.repeat(depth).into_bytes(), inner, close.repeat(depth).into_bytes()].concat();
        bytes.splice(at..end, nested);
    }

    /// Lines swapped, left out or said again and again.
    fn lines(&mut self, bytes: &mut Vec<u8>) {
        let mut lines: Vec<&[u8]> = bytes.split(|byte| *byte == b'\n').collect();
        let (one, other) = (self.draw.below(lines.len()), self.draw.below(lines.len()));
        match self.draw.below(3) {
            0 => lines.swap(one, other),
            1 => drop(lines.remove(one)),
            _ => {
                let times = [1, 10, 300][self.draw.below(3)].min(LENGTH_MAX / (lines[one].len() + 1));
                let again = vec![lines[one]; times];
                lines.splice(other..other, again);
            }
        }
        *bytes = lines.join(&b'\n');
    }
}

fn insert(bytes: &mut Vec<u8>, at: usize, piece: &[u8]) {
    bytes.splice(at..at, piece.iter().copied());
}
