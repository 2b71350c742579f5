//! What vendors' libraries declare and programs take for granted, as program text. A file of it is there for
//! the programs that name something of it, and for the files that do; a user's own declaration of a name takes precedence.
//!
//! A file that is a namespace, as in `NAMESPACE OPEN Tc2_System`, is a library by that name: its names are known
//! without it, too.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use super::motion_library::Motion;
use crate::check::is_qualified_only;
use crate::dialect::Dialect;
use crate::syntax::token::{Keyword, Punctuation, Token, TokenKind};
use crate::syntax::tokenize;

/// A file of a library.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    pub(super) name: &'static str,
    pub(super) text: &'static str,
    pub(super) dialect: Dialect,
    /// The programs it is there for; any, if it is written in the standard's own language.
    homes: &'static [Dialect],
    /// The motion control that it belongs to, and is there only with; none: any program may have it.
    motion: Option<Motion>,
}

impl Part {
    /// True for blocks of an axis, and the axis itself.
    pub(super) fn stands_on_an_axis(&self) -> bool {
        self.motion == Some(Motion::TwinCat) && self.name != TWINCAT_TYPES
    }
}

macro_rules! parts {
    ($($dialect:ident $homes:expr, $name:literal;)*) => {
        &[$(Part {
            name: concat!("iec/vendor/", $name, ".st"),
            text: include_str!(concat!("../../library/vendor/", $name, ".st")),
            dialect: Dialect::$dialect,
            homes: $homes,
            motion: None,
        }),*]
    };
}

/// TwinCAT's motion control: types, then the axis and its blocks.
macro_rules! twincat_motion {
    ($($name:literal)*) => {
        [$(Part {
            name: concat!("iec/vendor/", $name, ".st"),
            text: include_str!(concat!("../../library/vendor/", $name, ".st")),
            dialect: Dialect::TwinCat,
            homes: &[Dialect::TwinCat],
            motion: Some(Motion::TwinCat),
        }),*]
    };
}

/// Projects go from one of the two to the other, and take what they name along.
const BOTH: &[Dialect] = &[Dialect::Codesys, Dialect::TwinCat];
const SCL: &[Dialect] = &[Dialect::SiemensScl];
const AX: &[Dialect] = &[Dialect::Iec3];
const MATIEC: &[Dialect] = &[Dialect::Matiec];

const PARTS: &[Part] = parts![
    Iec3 &Dialect::ALL, "generic_inputs";
    Iec3 &Dialect::ALL, "dtl";
    Codesys BOTH, "dynamic_memory";
    Codesys BOTH, "system_constants";
    Codesys BOTH, "system_exception";
    Codesys BOTH, "system_var_info";
    TwinCat BOTH, "tc2_standard";
    TwinCat BOTH, "tc2_system";
    TwinCat BOTH, "tc2_system_files";
    TwinCat BOTH, "tc2_serialcom";
    TwinCat BOTH, "tc2_tcpip";
    TwinCat BOTH, "onescan_ports";
    TwinCat BOTH, "tc2_utilities_conversion";
    TwinCat BOTH, "tc2_utilities_format";
    TwinCat BOTH, "tc2_utilities_memory";
    TwinCat BOTH, "tc2_utilities_strings";
    TwinCat BOTH, "tc2_utilities_time";
    TwinCat BOTH, "tc2_ethercat";
    TwinCat BOTH, "tc3_eventlogger";
    TwinCat BOTH, "tc3_system_info";
    Codesys BOTH, "codesys_util";
    Codesys BOTH, "codesys_util_bits";
    Codesys BOTH, "codesys_systime";
    Codesys BOTH, "caa_types";
    Codesys BOTH, "codesys_sysfile";
    Codesys BOTH, "codesys_nbs";
    Codesys BOTH, "codesys_syssock";
    SiemensScl SCL, "siemens_conversion";
    SiemensScl SCL, "siemens_variant";
    SiemensScl SCL, "siemens_time";
    Iec3 SCL, "siemens_clock";
    Iec3 SCL, "siemens_timers";
    TwinCat SCL, "siemens_open_communication";
    TwinCat SCL, "siemens_point_to_point";
    Codesys AX, "ax_unit";
    Matiec MATIEC, "matiec_control";
    Matiec MATIEC, "beremiz_hmi";
    Matiec MATIEC, "beremiz_runtime";
];

/// Files that words of the language ask for, which no file declares: of what inputs of generic types are inside, and
/// of the memory of `__NEW`, of VARIANT, and a namespace that is named as a whole.
const BY_WORDS: [(&str, &[&str]); 5] = [
    ("iec/vendor/siemens_variant.st", &["VARIANT"]),
    ("iec/vendor/generic_inputs.st", &["ANY", "ANY_BIT", "ANY_DATE", "ANY_NUM", "ANY_REAL", "ANY_INT", "ANY_STRING"]),
    ("iec/vendor/dynamic_memory.st", &["__NEW", "__DELETE"]),
    ("iec/vendor/system_var_info.st", &["__VARINFO"]),
    // Named by `USING AxUnit;`, and then only in parts.
    ("iec/vendor/ax_unit.st", &["AXUNIT"]),
];

/// What many programs name and mean otherwise: it is there for those who ask for another part of its file.
const PLAIN_WORDS: [&str; 1] = ["VERSION"];

const TWINCAT_TYPES: &str = "iec/vendor/tc2_mc2_types.st";

const MOTION: [Part; 7] = twincat_motion![
    "tc2_mc2_types"
    "tc2_mc2_axis"
    "tc2_mc2_gear"
    "tc2_mc2_jog"
    "tc2_mc2_move"
    "tc2_mc2_power"
    "tc2_mc2_status"
];

/// Names of `Tc2_MC2` for PLCopen's motion control.
const PLCOPEN_MOTION: Part = Part {
    name: "iec/vendor/tc2_mc2.st",
    text: include_str!("../../library/vendor/tc2_mc2.st"),
    dialect: Dialect::Iec3,
    homes: &Dialect::ALL,
    motion: Some(Motion::Plcopen),
};

/// The files that programs of these texts ask for, in the order of the list; `motion` is whose they have.
pub(super) fn for_texts(texts: &[(&str, Dialect)], motion: Motion) -> Vec<Part> {
    let index = Index::get();
    let mut wanted = vec![false; index.parts.len()];
    let mut unread = texts.to_vec();
    while let Some((text, dialect)) = unread.pop() {
        for at in index.named_in(text) {
            let (part, is_wanted) = (&index.parts[at], &mut wanted[at]);
            let is_at_home = part.homes.contains(&dialect) || part.motion == Some(Motion::TwinCat);
            if !*is_wanted && is_at_home && part.motion.is_none_or(|wanted| wanted == motion) {
                *is_wanted = true;
                unread.push((part.text, part.dialect));
            }
        }
    }
    index.parts.iter().zip(wanted).filter(|(_, wanted)| *wanted).map(|(part, _)| *part).collect()
}

/// Which file declares a name.
struct Index {
    parts: Vec<Part>,
    /// Positions in `parts` by names in capitals.
    by_name: BTreeMap<String, Vec<usize>>,
}

impl Index {
    fn get() -> &'static Self {
        static INDEX: OnceLock<Index> = OnceLock::new();
        INDEX.get_or_init(|| {
            let parts: Vec<Part> = PARTS.iter().copied().chain([PLCOPEN_MOTION]).chain(MOTION).collect();
            let mut by_name: BTreeMap<String, Vec<usize>> = BTreeMap::new();
            for (at, part) in parts.iter().enumerate() {
                let words = BY_WORDS.iter().filter(|(name, _)| part.name == *name).flat_map(|(_, words)| *words);
                let names = declared(part.text).into_iter().filter(|name| !PLAIN_WORDS.contains(&name.as_str()));
                for name in names.chain(words.map(|word| (*word).to_owned())) {
                    let homes = by_name.entry(name.to_ascii_uppercase()).or_default();
                    if homes.last() != Some(&at) {
                        homes.push(at);
                    }
                }
            }
            Self { parts, by_name }
        })
    }

    /// The files that declare what stands in the text by itself, in any case; some of them several times. The name of
    /// a namespace counts before a dot only.
    fn named_in(&self, text: &str) -> impl Iterator<Item = usize> {
        let is_word = |character: char| character.is_ascii_alphanumeric() || character == '_';
        let mut key = String::new();
        text.split_inclusive(move |character| !is_word(character)).flat_map(move |word| {
            let (name, end) = word.split_at(word.trim_end_matches(|character| !is_word(character)).len());
            key.clear();
            key.push_str(name);
            key.make_ascii_uppercase();
            let plain = self.by_name.get(&key);
            key.push('.');
            let space = self.by_name.get(&key).filter(|_| end == ".");
            plain.into_iter().chain(space).flatten().copied()
        })
    }
}

/// What a file declares outside of units: units, types, values of enumerations, global variables. Of a namespace
/// whose names are known with it only, its own name with a dot.
fn declared(text: &str) -> Vec<String> {
    let tokens: Vec<Token> = tokenize(text).into_iter().filter(|token| !token.kind.is_trivia()).collect();
    let mut scan = Scan { text, tokens: &tokens, at: 0, names: Vec::new() };
    scan.file();
    scan.names
}

/// Reads what our own files have, which a test compares with the parser's trees.
struct Scan<'t, 'k> {
    text: &'t str,
    tokens: &'k [Token],
    at: usize,
    names: Vec<String>,
}

impl<'t> Scan<'t, '_> {
    fn kind(&self) -> Option<TokenKind> {
        self.tokens.get(self.at).map(|token| token.kind)
    }

    fn keyword(&self) -> Option<Keyword> {
        match self.kind()? {
            TokenKind::Keyword(keyword) => Some(keyword),
            // Some are names where no other name follows.
            TokenKind::Identifier => Keyword::find(self.word()),
            _ => None,
        }
    }

    fn word(&self) -> &'t str {
        let token = self.tokens.get(self.at);
        // Behind the last token there is no word.
        token.and_then(|token| self.text.get(token.start as usize..token.end as usize)).unwrap_or_default()
    }

    fn skip_to(&mut self, end: Keyword) {
        while self.kind().is_some() && self.keyword() != Some(end) {
            self.at += 1;
        }
    }

    fn skip_to_semicolon(&mut self) {
        while self.kind().is_some_and(|kind| kind != TokenKind::Punctuation(Punctuation::Semicolon)) {
            self.at += 1;
        }
    }

    fn file(&mut self) {
        while self.kind().is_some() {
            let found = self.keyword();
            self.at += 1;
            match found {
                Some(Keyword::Namespace) => self.namespace(),
                Some(Keyword::Function) => self.unit(Keyword::EndFunction),
                Some(Keyword::FunctionBlock) => self.unit(Keyword::EndFunctionBlock),
                Some(Keyword::Interface) => self.unit(Keyword::EndInterface),
                Some(Keyword::Type) => self.declarations(Keyword::EndType),
                Some(Keyword::VarGlobal) => self.declarations(Keyword::EndVar),
                // The ends of namespaces, and marks between declarations.
                _ => {}
            }
        }
    }

    fn namespace(&mut self) {
        let is_open = self.word().eq_ignore_ascii_case("OPEN");
        self.at += usize::from(is_open);
        if !is_open {
            self.names.push(format!("{}.", self.word()));
            self.skip_to(Keyword::EndNamespace);
        }
    }

    fn unit(&mut self, end: Keyword) {
        while self.kind().is_some_and(|kind| kind != TokenKind::Identifier) {
            self.at += 1;
        }
        self.names.push(self.word().to_owned());
        self.skip_to(end);
    }

    /// The names before a colon, and those in parentheses, up to `end`; nothing of structures.
    fn declarations(&mut self, end: Keyword) {
        let mut depth = 0;
        let mut is_value = false;
        while self.kind().is_some() && self.keyword() != Some(end) {
            match self.tokens[self.at].kind {
                TokenKind::Keyword(Keyword::Struct) => {
                    self.skip_to(Keyword::EndStruct);
                    is_value = false;
                }
                TokenKind::Punctuation(Punctuation::LeftParen) => depth += 1,
                TokenKind::Punctuation(Punctuation::RightParen) => (depth, is_value) = (depth - 1, true),
                TokenKind::Punctuation(Punctuation::Assign | Punctuation::Colon) => is_value = true,
                TokenKind::Punctuation(Punctuation::Semicolon) => is_value = false,
                TokenKind::Punctuation(Punctuation::Comma) if depth > 0 => is_value = false,
                TokenKind::Identifier if depth == 0 && !is_value && is_qualified_only(self.word()) => {
                    self.names.push(self.word().to_owned());
                    self.skip_to_semicolon();
                    is_value = false;
                }
                TokenKind::Identifier
                    if depth == 0 && !is_value
                        || depth > 0 && end == Keyword::EndType && (!is_value || self.follows_opening()) =>
                {
                    self.names.push(self.word().to_owned());
                }
                // Types and values declare nothing.
                _ => {}
            }
            self.at += 1;
        }
    }

    fn follows_opening(&self) -> bool {
        let before = self.at.checked_sub(1).and_then(|at| self.tokens.get(at));
        before.is_some_and(|token| token.kind == TokenKind::Punctuation(Punctuation::LeftParen))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::fmt::Write;

    use super::*;
    use crate::front::Front;
    use crate::input::Input;
    use crate::input::kind::SourceKind;
    use crate::syntax::ast::{Declaration, Ident, NamespaceKind, PouKind, TypeSpecKind};
    use crate::syntax::{FileId, SourceFile, parse_source};

    fn files(text: &str) -> Vec<&'static str> {
        for_texts(&[(text, Dialect::TwinCat)], Motion::None).iter().map(|part| part.name).collect()
    }

    #[test]
    fn a_part_is_there_for_who_names_it() {
        assert_eq!(files("VAR many, ANY_TO, xDTL : INT; END_VAR"), [""; 0]);
        assert_eq!(files("errors := errors + caa;"), [""; 0], "they are names of namespaces");
        assert_eq!(files("VAR_INPUT v : any_num; END_VAR"), ["iec/vendor/generic_inputs.st"]);
        assert_eq!(files("VAR a : T_MAXSTRING; d : DTL; END_VAR").len(), 2);
        assert_eq!(
            files("text := F_LTRIM(text);"),
            ["iec/vendor/generic_inputs.st", "iec/vendor/tc2_system.st", "iec/vendor/tc2_utilities_strings.st"]
        );
    }

    #[test]
    fn tc2_mc2_comes_with_motion_control() {
        let files = |motion| {
            let parts = for_texts(&[("VAR mode : mc_buffermode; END_VAR", Dialect::Iec3)], motion);
            parts.iter().map(|part| part.name).collect::<Vec<_>>()
        };
        assert_eq!(files(Motion::None), [""; 0]);
        assert_eq!(files(Motion::Plcopen), [PLCOPEN_MOTION.name]);
        assert_eq!(files(Motion::TwinCat), [TWINCAT_TYPES]);
    }

    #[test]
    fn each_file_says_what_it_follows() {
        for part in &Index::get().parts {
            assert!(part.text.starts_with("(* "), "{}", part.name);
        }
    }

    /// What a file declares, by kind; what only its own units use is left out.
    fn listed(list: &[Declaration], around: &str, into: &mut BTreeMap<&'static str, Vec<String>>) {
        let mut add = |kind, name: &str| {
            if !name.to_ascii_lowercase().starts_with("onescan") {
                into.entry(kind).or_default().push(format!("`{around}{name}`"));
            }
        };
        for declaration in list {
            match declaration {
                Declaration::Pou(pou) if pou.kind == PouKind::Function => add("functions", &pou.name.text),
                Declaration::Pou(pou) => add("blocks", &pou.name.text),
                Declaration::Type(ty) => add("types", &ty.name.text),
                Declaration::Globals(section) => {
                    let names = section.variables.iter().flat_map(|each| &each.names);
                    names.for_each(|name| add("variables and constants", &name.text));
                }
                _ => {}
            }
        }
        for declaration in list {
            if let Declaration::Namespace(namespace) = declaration {
                let is_open = namespace.kind == NamespaceKind::Open;
                let around = if is_open { String::new() } else { format!("{}.", namespace.name.text) };
                listed(&namespace.declarations, &around, into);
            }
        }
    }

    fn page() -> String {
        let mut page = include_str!("vendor_library.md").to_owned();
        for part in &Index::get().parts {
            let file = SourceFile::new(part.name, part.text).in_dialect(part.dialect);
            let parsed = parse_source(FileId(0), &file);
            let (about, _) = part.text["(* ".len()..].split_once(" *)").expect("a comment at the head");
            let about = about.split_whitespace().collect::<Vec<_>>().join(" ");
            let homes: Vec<_> = part.homes.iter().map(|home| home.name()).collect();
            // The page's head names the dialects that most files have.
            let dialects = match homes.join(", ") {
                usual if usual == "codesys, twincat" => String::new(),
                _ if homes.len() == Dialect::ALL.len() => "Dialects: all.\n\n".to_owned(),
                others => format!("Dialects: {others}.\n\n"),
            };
            let short = part.name.rsplit('/').next().expect("a name");
            write!(page, "\n## {short}\n\n{about}\n\n{dialects}").expect("a string");
            let mut kinds = BTreeMap::new();
            listed(&parsed.unit.declarations, "", &mut kinds);
            for (kind, names) in kinds {
                writeln!(page, "- {kind}: {}", names.join(", ")).expect("a string");
            }
        }
        page
    }

    #[test]
    fn the_page_lists_what_is_there() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/vendor-libraries.md");
        if std::env::var_os("UPDATE_DOCS").is_some() {
            std::fs::write(path, page()).expect("the page can be written");
        }
        let found = std::fs::read_to_string(path).expect("the page is there");
        assert!(found == page(), "docs/vendor-libraries.md is old: UPDATE_DOCS=1 cargo test renews it");
    }

    #[test]
    fn every_unit_is_right_whether_it_is_used_or_not() {
        let index = Index::get();
        let is_own = |part: &&Part| part.homes.len() < Dialect::ALL.len() && part.motion.is_none();
        let own = index.parts.iter().filter(is_own);
        let inputs = own.map(|part| Input::from_text(part.name, SourceKind::Text, part.text).in_dialect(part.dialect));
        let findings: Vec<_> =
            Front::new(inputs).findings.iter().map(|found| (found.span, found.message.clone())).collect();
        assert!(findings.is_empty(), "{findings:?}");
    }

    #[test]
    fn every_block_of_twincats_motion_control_is_right() {
        let names: Vec<String> = MOTION.iter().flat_map(|part| declared(part.text)).collect();
        let blocks = names
            .iter()
            .filter(|name| MOTION.iter().any(|part| part.text.contains(&format!("FUNCTION_BLOCK {name}\n"))));
        let variables: String = blocks.map(|name| format!("v{name} : {name};\n")).collect();
        let text = format!("PROGRAM P\nVAR\n{variables}END_VAR\nEND_PROGRAM\n");
        let input = Input::from_text("p.st", SourceKind::Text, text).in_dialect(Dialect::TwinCat);
        let front = Front::new([input]);
        let findings: Vec<_> = front.findings.iter().map(|found| (found.span, found.message.clone())).collect();
        assert!(findings.is_empty() && variables.contains("vMC_Jog"), "{findings:?}");
    }

    #[test]
    fn no_name_is_declared_twice() {
        let index = Index::get();
        // A namespace may go on in another file.
        for (name, homes) in index.by_name.iter().filter(|(name, _)| !name.ends_with('.')) {
            // Those of several dialects are never there together.
            let kind = |part: &Part| format!("{:?} {:?}", part.motion, part.homes.contains(&Dialect::Matiec));
            let kinds: BTreeSet<_> = homes.iter().map(|at| kind(&index.parts[*at])).collect();
            assert!(kinds.len() == homes.len(), "{name}");
        }
    }

    fn names(list: &[Declaration], into: &mut BTreeSet<String>) {
        let text = |name: &Ident| name.text.clone();
        for declaration in list {
            match declaration {
                Declaration::Pou(pou) => drop(into.insert(text(&pou.name))),
                Declaration::Globals(section) => {
                    into.extend(section.variables.iter().flat_map(|each| &each.names).map(text));
                }
                Declaration::Type(ty) => {
                    into.insert(text(&ty.name));
                    if let TypeSpecKind::Enumeration(values, ..) = &ty.spec.kind
                        && !is_qualified_only(&ty.name.text)
                    {
                        into.extend(values.iter().map(|value| text(&value.name)));
                    }
                }
                Declaration::Namespace(namespace) if namespace.kind == NamespaceKind::Open => {
                    names(&namespace.declarations, into);
                }
                Declaration::Namespace(namespace) => drop(into.insert(format!("{}.", namespace.name.text))),
                _ => {}
            }
        }
    }

    #[test]
    fn the_scan_finds_what_the_parser_finds() {
        for part in &Index::get().parts {
            let file = SourceFile::new(part.name, part.text).in_dialect(part.dialect);
            let parsed = parse_source(FileId(0), &file);
            assert!(parsed.diagnostics.is_empty(), "{}: {:?}", part.name, parsed.diagnostics);
            let mut found = BTreeSet::new();
            names(&parsed.unit.declarations, &mut found);
            let scanned: BTreeSet<String> = declared(part.text).into_iter().collect();
            assert_eq!(scanned, found, "{}", part.name);
        }
    }
}
