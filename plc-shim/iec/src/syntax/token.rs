//! The kinds of token of the textual languages (IEC 61131-3, 3rd ed. 6.1).

use crate::dialect::{Dialect, Feature};

/// A token: what it is and where; its text is the source under the span.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Token {
    /// What it is.
    pub kind: TokenKind,
    /// Offset of its first byte.
    pub start: u32,
    /// Offset after its last byte.
    pub end: u32,
}

/// What a token is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TokenKind {
    /// Blanks, tabs, line ends.
    Whitespace,
    /// `(* ... *)` or `/* ... */`, nested or not.
    BlockComment,
    /// `// ...` up to the line's end.
    LineComment,
    /// `{ ... }` (2nd ed. 2.1.6).
    Pragma,
    /// A comment, pragma or string whose end is missing.
    Unterminated,
    /// An identifier; names of elementary types and words like `METHOD`, too, which are names elsewhere.
    Identifier,
    /// A keyword, in any case.
    Keyword(Keyword),
    /// `12`, `1_000`, `16#FF`.
    Integer,
    /// `1.5`, `2.0e-3`.
    Real,
    /// `INT#5`, `T#1s`, `Colour#Red`.
    Typed,
    /// `'...'`.
    String,
    /// `"..."`.
    WideString,
    /// `%IX1.0` (2nd ed. 2.4.1.1).
    DirectAddress,
    /// `` `name` ``: what an element of a network hands on, in text that was made of one.
    Wire,
    /// An operator, bracket or separator.
    Punctuation(Punctuation),
    /// Text that begins no token.
    Unknown,
}

impl TokenKind {
    /// True for what may stand between any two tokens (2nd ed. 2.1.4 and 2.1.5).
    pub fn is_trivia(self) -> bool {
        matches!(self, Self::Whitespace | Self::BlockComment | Self::LineComment | Self::Pragma)
    }
}

macro_rules! keywords {
    ($($variant:ident $text:literal),* $(,)?) => {
        /// Keywords (2nd ed. Annex C); variants bear the keyword's own name.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum Keyword {
            $(#[doc = concat!("`", $text, "`")] $variant,)*
        }

        impl Keyword {
            /// The keyword that `text` spells in any case.
            pub fn find(text: &str) -> Option<Self> {
                const ALL: &[(&str, Keyword)] = &[$(($text, Keyword::$variant)),*];
                ALL.iter().find(|(name, _)| name.eq_ignore_ascii_case(text)).map(|(_, found)| *found)
            }

            /// True for the words of the 3rd edition that older programs have for names: they are
            /// keywords only where another name follows.
            pub fn is_soft(self) -> bool {
                use Keyword as K;
                matches!(self, K::Class | K::Interface | K::Method | K::Property | K::Action | K::Namespace | K::Using)
            }

            /// True for the words that begin a chart's parts; programs without charts have them for names.
            pub fn is_of_chart(self) -> bool {
                matches!(self, Keyword::InitialStep | Keyword::Step | Keyword::Transition)
            }

            /// Its spelling in capitals.
            pub fn text(self) -> &'static str {
                match self { $(Self::$variant => $text,)* }
            }
        }
    };
}

keywords! {
    Program "PROGRAM", EndProgram "END_PROGRAM",
    FunctionBlock "FUNCTION_BLOCK", EndFunctionBlock "END_FUNCTION_BLOCK",
    Function "FUNCTION", EndFunction "END_FUNCTION",
    Type "TYPE", EndType "END_TYPE", Struct "STRUCT", EndStruct "END_STRUCT", Union "UNION", EndUnion "END_UNION",
    Array "ARRAY", Of "OF", At "AT",
    Var "VAR", VarInput "VAR_INPUT", VarOutput "VAR_OUTPUT", VarInOut "VAR_IN_OUT",
    VarTemp "VAR_TEMP", VarGlobal "VAR_GLOBAL", VarExternal "VAR_EXTERNAL", EndVar "END_VAR",
    Constant "CONSTANT", Retain "RETAIN", NonRetain "NON_RETAIN",
    If "IF", Then "THEN", Elsif "ELSIF", Else "ELSE", EndIf "END_IF",
    Case "CASE", EndCase "END_CASE",
    For "FOR", To "TO", By "BY", Do "DO", EndFor "END_FOR",
    While "WHILE", EndWhile "END_WHILE",
    Repeat "REPEAT", Until "UNTIL", EndRepeat "END_REPEAT",
    Exit "EXIT", Continue "CONTINUE", Return "RETURN",
    And "AND", Or "OR", Xor "XOR", Not "NOT", Mod "MOD",
    True "TRUE", False "FALSE",
    Class "CLASS", EndClass "END_CLASS", Interface "INTERFACE", EndInterface "END_INTERFACE",
    Method "METHOD", EndMethod "END_METHOD", Property "PROPERTY", EndProperty "END_PROPERTY",
    EndGet "END_GET", EndSet "END_SET", Action "ACTION", EndAction "END_ACTION",
    Namespace "NAMESPACE", EndNamespace "END_NAMESPACE", Using "USING",
    OrganizationBlock "ORGANIZATION_BLOCK", EndOrganizationBlock "END_ORGANIZATION_BLOCK",
    InitialStep "INITIAL_STEP", Step "STEP", EndStep "END_STEP",
    Transition "TRANSITION", EndTransition "END_TRANSITION",
    VarStat "VAR_STAT", VarInst "VAR_INST", DataBlock "DATA_BLOCK", EndDataBlock "END_DATA_BLOCK", Begin "BEGIN",
}

impl Keyword {
    /// True if the dialect has the keyword; to others it is a name like any.
    pub fn is_in(self, dialect: Dialect) -> bool {
        use Keyword as K;
        match self {
            K::OrganizationBlock | K::EndOrganizationBlock | K::DataBlock | K::EndDataBlock | K::Begin => {
                dialect.has(Feature::Blocks)
            }
            K::VarInst => dialect.has(Feature::InstanceSection),
            K::VarStat => dialect.has(Feature::StaticSection),
            K::Continue => dialect.has(Feature::Continue),
            _ => true,
        }
    }
}

macro_rules! punctuation {
    ($($variant:ident $text:literal),* $(,)?) => {
        /// Operators, brackets and separators.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum Punctuation {
            $(#[doc = concat!("`", $text, "`")] $variant,)*
        }

        impl Punctuation {
            /// The longest mark that `text` begins with.
            pub fn find(text: &str) -> Option<Self> {
                // Listed longest first, so that the first hit is the longest.
                const ALL: &[(&str, Punctuation)] = &[$(($text, Punctuation::$variant)),*];
                ALL.iter().find(|(mark, _)| text.starts_with(mark)).map(|(_, found)| *found)
            }

            /// Its spelling.
            pub fn text(self) -> &'static str {
                match self { $(Self::$variant => $text,)* }
            }
        }
    };
}

punctuation! {
    Assign ":=", Attempt "?=", PlusAssign "+=", MinusAssign "-=", StarAssign "*=", SlashAssign "/=", Output "=>", Power "**", LessEqual "<=", GreaterEqual ">=", NotEqual "<>",
    Range "..", Less "<", Greater ">", Equal "=", Plus "+", Minus "-", Star "*", Slash "/",
    Ampersand "&", LeftParen "(", RightParen ")", LeftBracket "[", RightBracket "]",
    Comma ",", Semicolon ";", Colon ":", Dot ".", Hash "#", Caret "^",
}
