//! What vendors add to the language, leave out of it and do their own way.
//!
//! | module | subject |
//! |---|---|
//! | [`table`] | every difference, as data, each with its source |
//! | `word_size` | of how many bits the registers of the target are |
//!
//! A dialect belongs to a file, so that a library of one may be used by a program of another. The
//! lexer, the parser and the checker ask the table; `docs/dialects.md` shows it.

mod pragma;
pub mod table;
mod word_size;

pub(crate) use pragma::Chosen;
pub use word_size::{UnknownWordSize, WordSize};

use std::path::Path;

use self::table::{BEHAVIOURS, FEATURES};

/// A dialect of the language.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Dialect {
    /// IEC 61131-3, 2nd edition (2003).
    Iec2,
    /// IEC 61131-3, 3rd edition (2013), read leniently.
    #[default]
    Iec3,
    /// CODESYS V2.3 and V3, and what is built on it.
    Codesys,
    /// TwinCAT 2 and 3.
    TwinCat,
    /// SCL of Siemens' TIA Portal, as external source.
    SiemensScl,
    /// `MatIEC`, the compiler of Beremiz and `OpenPLC`: the 2nd edition with habits of its own.
    Matiec,
}

impl Dialect {
    /// Every dialect, in the order of the table's columns.
    pub const ALL: [Self; 6] = [Self::Iec2, Self::Iec3, Self::Codesys, Self::TwinCat, Self::SiemensScl, Self::Matiec];

    /// Its name in options and scenarios.
    pub fn name(self) -> &'static str {
        match self {
            Self::Iec2 => "iec2",
            Self::Iec3 => "iec3",
            Self::Codesys => "codesys",
            Self::TwinCat => "twincat",
            Self::SiemensScl => "siemens-scl",
            Self::Matiec => "matiec",
        }
    }

    /// The dialect of this name.
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|dialect| dialect.name() == name)
    }

    /// The dialect of program text in a file of this name; PLCopen XML names its own.
    pub fn of_file(name: &str) -> Self {
        let extension = Path::new(name).extension().and_then(|text| text.to_str()).unwrap_or("");
        match extension.to_ascii_lowercase().as_str() {
            "scl" => Self::SiemensScl,
            "exp" => Self::Codesys,
            "tcpou" | "tcdut" | "tcgvl" | "tcio" => Self::TwinCat,
            _ => Self::default(),
        }
    }

    /// True if the dialect has `feature`.
    pub fn has(self, feature: Feature) -> bool {
        FEATURES.iter().any(|row| row.feature == feature && row.dialects.contains(&self))
    }

    fn behaviour(self) -> Behaviour {
        let row = BEHAVIOURS.iter().find(|row| row.dialect == self);
        row.map_or(table::STANDARD, |row| row.behaviour)
    }

    /// Characters of a string declared without a length.
    pub fn string_length(self) -> u16 {
        self.behaviour().string_length
    }

    /// The values of TIME.
    pub fn time(self) -> TimeRange {
        self.behaviour().time
    }

    /// Where a real halfway between two integers goes.
    pub fn ties(self) -> Ties {
        self.behaviour().ties
    }

    /// What the number of a direct address wider than a bit counts.
    pub fn address_unit(self) -> AddressUnit {
        self.behaviour().address_unit
    }

    /// True if `-a ** b` is `-(a ** b)`.
    pub fn negates_powers(self) -> bool {
        self.behaviour().negates_powers
    }

    /// How characters of a string lie in memory.
    pub fn strings(self) -> StringMemory {
        self.behaviour().strings
    }

    /// What a number becomes as BOOL.
    pub fn truth(self) -> Truth {
        self.behaviour().truth
    }

    /// Nanoseconds of the unit in which a TIME or TOD becomes a number, and a number one of these.
    pub fn time_number_ns(self) -> u32 {
        self.behaviour().time_number_ns
    }

    /// What an assignment does whose value the subrange of its target does not have.
    pub fn beyond_subrange(self) -> BeyondSubrange {
        self.behaviour().beyond_subrange
    }

    /// Which inputs of `SEL` are evaluated.
    pub fn selection(self) -> Selection {
        self.behaviour().selection
    }

    /// In how many bits integers are computed.
    pub fn integers(self) -> IntegerWidth {
        self.behaviour().integers
    }

    /// Whose edges give actions of a chart their pulses.
    pub fn action_pulses(self) -> ActionPulses {
        self.behaviour().action_pulses
    }

    /// Most characters that functions of strings take and give; nothing where they take all.
    pub fn text_functions(self) -> Option<u32> {
        self.behaviour().text_functions
    }

    /// The values of LTIME.
    pub fn long_time(self) -> LongTime {
        self.behaviour().long_time
    }

    /// What a division by zero does.
    pub fn division_by_zero(self) -> DivisionByZero {
        self.behaviour().division_by_zero
    }
}

/// A name that is not a dialect's.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{name}` is not a dialect: {}", Dialect::ALL.map(Dialect::name).join(", "))]
pub struct UnknownDialect {
    name: String,
}

impl std::str::FromStr for Dialect {
    type Err = UnknownDialect;

    fn from_str(name: &str) -> Result<Self, UnknownDialect> {
        Self::find(name).ok_or_else(|| UnknownDialect { name: name.to_owned() })
    }
}

impl std::fmt::Display for Dialect {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(self.name())
    }
}

/// The values of TIME.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeRange {
    /// Signed 64 bit nanoseconds.
    Nanoseconds64,
    /// Unsigned 32 bit milliseconds.
    Unsigned32,
    /// Signed 32 bit milliseconds.
    Signed32,
}

/// What the number of an address wider than a bit counts. The standard leaves it open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AddressUnit {
    /// Units of its own width: `%MW1` is bytes 2 and 3, as in CODESYS.
    #[default]
    Element,
    /// Bytes: `%MW1` is bytes 1 and 2, as in TwinCAT and with Siemens.
    Byte,
}

/// Where a real halfway between two integers goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ties {
    /// To the even one.
    Even,
    /// Away from zero.
    Away,
}

/// What a division by zero does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DivisionByZero {
    /// It stops the PLC.
    Fault,
    /// Integers give 0, reals an infinity or NaN.
    Continue,
}

/// What a dialect does its own way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Behaviour {
    /// Characters of a string declared without a length.
    pub string_length: u16,
    /// The values of TIME.
    pub time: TimeRange,
    /// Where a real halfway between two integers goes.
    pub ties: Ties,
    /// What a division by zero does.
    pub division_by_zero: DivisionByZero,
    /// What the number of a direct address wider than a bit counts.
    pub address_unit: AddressUnit,
    /// True if `-a ** b` is `-(a ** b)`.
    pub negates_powers: bool,
    /// What `DWORD_TO_BOOL` and the like take for TRUE.
    pub truth: Truth,
    /// The unit of a number that a TIME becomes, in nanoseconds: `TIME_TO_DINT(T#1s)` is 1000 if it is 1,000,000.
    pub time_number_ns: u32,
    /// How characters of a STRING lie in memory.
    pub strings: StringMemory,
    /// What a value does that its subrange does not have.
    pub beyond_subrange: BeyondSubrange,
    /// The values of LTIME.
    pub long_time: LongTime,
    /// Which inputs of `SEL` are evaluated.
    pub selection: Selection,
    /// In how many bits integers are computed.
    pub integers: IntegerWidth,
    /// Whose edges give actions of a chart their pulses.
    pub action_pulses: ActionPulses,
    /// Most characters that functions of strings take and give; nothing where they take all.
    pub text_functions: Option<u32>,
}

/// Whose edges give the actions of a chart their pulses, `P`, `P1` and `P0`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ActionPulses {
    /// Those of an action: one detector sees all steps that name it.
    OfAction,
    /// Those of the last step that names it; they set a BOOL, too.
    OfStep,
}

/// In how many bits `+`, `-`, `*`, `/`, `MOD` of integers are computed, and their results compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IntegerWidth {
    /// In those of the operands' common type: what does not fit wraps at once.
    Own,
    /// In those of the target's registers, see [`WordSize`]: what does not fit is cut where a value is assigned, handed
    /// over or converted.
    Register,
}

/// Which inputs of `SEL` are evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Selection {
    /// All of them, as of any function.
    All,
    /// The one that is selected.
    Selected,
}

/// The values of LTIME.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LongTime {
    /// Signed 64 bit nanoseconds.
    Signed64,
    /// Unsigned 64 bit nanoseconds.
    Unsigned64,
}

/// What an assignment does whose value the subrange of its target does not have. A constant is an error in any dialect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BeyondSubrange {
    /// It stops the PLC.
    Fault,
    /// The target takes the value.
    Assign,
}

/// What a number becomes as BOOL.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Truth {
    /// Its lowest bit: conversions cut bits off on the left (2nd ed. 2.5.1.5.1).
    LowestBit,
    /// TRUE unless it is 0.
    NotZero,
}

/// How characters of a STRING lie in memory, for who looks by pointer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum StringMemory {
    /// Their count in 16 bits, then the characters.
    Counted,
    /// The characters, then a 0; `SIZEOF` counts it.
    ZeroTerminated,
}

macro_rules! features {
    ($($variant:ident $about:literal),* $(,)?) => {
        /// A construct that some dialects have and others do not.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Feature {
            $(#[doc = $about] $variant,)*
        }

        impl Feature {
            /// Every feature.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// What it is, as it reads in a sentence.
            pub fn about(self) -> &'static str {
                match self { $(Self::$variant => $about,)* }
            }
        }
    };
}

features! {
    NestedComments "a comment in a comment",
    LineComments "a comment with `//`",
    StarComments "a comment with `/*`",
    Continue "`CONTINUE`",
    Power "the operator `**`",
    LooseEnds "a missing `;` behind `END_IF` and the like",
    ShortCircuit "`AND_THEN`, `OR_ELSE`",
    SetReset "`S=`, `R=`",
    ChainedAssignment "`a := b := c`",
    CompoundAssignment "`+=`, `-=`, `*=`, `/=`",
    BareArrayValues "initial values of an array without brackets",
    ConditionalPragmas "`{IF defined (x)}`",
    ControlParts "a member or an element as control variable of `FOR`",
    Jumps "a jump or a label in Structured Text",
    StaticSection "`VAR_STAT`",
    InstanceSection "`VAR_INST`",
    FleetingInstances "an instance that lasts for one call of a function or method",
    InitArguments "an instance's arguments for `FB_init`",
    ComputedInitialValues "an initial value that is not a constant",
    BitArithmetic "a bit string as a number, or a number as a bit string",
    EnumerationsAsIntegers "an enumeration as an integer, or an integer as an enumeration",
    NamedValues "named values as numbers of their type, and the other way, `TYPE C : INT (A := 1);`",
    SignChange "an integer as one of the other sign, without conversion",
    LossyReals "a REAL from an LREAL or a wide integer, without conversion",
    CharactersAsBytes "characters `s[0]` as BYTE, with a 0 behind the last",
    VendorParameters "`RESET`, `LOAD` and the like of counters and bistables",
    Variants "a parameter of type `VARIANT`",
    GenericInputs "an input of type `ANY`, `ANY_NUM` and the like",
    IntegerShifts "a shift or rotation of an integer",
    ClockFunctions "`TIME()`, `LTIME()`",
    OwnStandardBlocks "an own block with the name of a standard one",
    QuotedNames "names as `#local` and `\"global\"`",
    Blocks "`ORGANIZATION_BLOCK`, `DATA_BLOCK`",
    InstanceInternals "an instance's `VAR` written from outside",
    BitsAsReals "a bit string's number from a REAL, or to one, by a conversion function",
    EmptyArguments "an input without a value in a call, `IN := ,` or `F(a, )`",
    WindowsCharacters "characters of Windows-1252 in a STRING, as in `'€'`",
    LeftOutInputs "an input with a value of its own left out of a list without names",
    LooseStrings "a string of another length for a `VAR_IN_OUT`",
    DoubleQuotes "a STRING between double quotes",
    LooseWidths "a variable at an address of another width, as in `DWORD AT %ML50`",
    OwnStandardFunctions "a function of one's own with the name of a standard function",
    InstanceCopies "an instance assigned to another one",
    ReadableInternals "an instance's `VAR` read from outside",
    ProgramInstances "a program called, or its variables used, by its name",
    DynamicMemory "`__NEW`, `__DELETE`",
    AssignedValues "an assignment as a value, `IF a := b THEN`",
    ReadableInOuts "an instance's `VAR_IN_OUT` read from outside",
    ConditionalReturns "`RETURN (condition);`",
    LooseLast "a missing `;` before `END_IF`, `ELSE` and the like",
    DbSpecific "`VAR DB_SPECIFIC`",
    UntypedConstants "`CONST` without types",
    AlikeStructures "a structure without a type's name for one with the same members",
    IntegersAsReals "a REAL from a DINT or UDINT, without conversion",
    ValuesByContext "an enumeration's value by its name alone that several enumerations have",
    ValueStatements "a value as a statement",
    Exceptions "`__TRY`",
    ShortPrefixes "literals as `W#16#FF`, `L#5`, `S5T#2s`",
    DivOperator "the operator `DIV`",
    Recursion "a method or function that calls itself",
    RepeatedArguments "a parameter given twice in a call: the last value counts",
    EmptyArrays "an array without elements, `ARRAY [0..-1]`",
    LooseUnderscores "two underscores between the digits of a number",
    Views "a view of another variable's memory, `b AT a : DWORD`",
    ElseColon "`ELSE:` in a `CASE`",
    LooseParts "a bit of an enumeration's number, or `.0` of a BOOL",
    OutputsHandedOn "an instance's output for a `VAR_IN_OUT`",
    EmptyBases "a comma behind the last base, `EXTENDS A,`",
    ShiftedLiterals "a shift of a literal without a type, `SHL(1, n)`",
    IntegerParts "a part of an integer, `i.%X3`, `i.%B0`",
    LoneOutputs "the only parameter of a function without its name, where that is an output",
    ProgramInOuts "a `VAR_IN_OUT` of a program that nobody calls",
    CCode "C code that sets variables, `{{ SetFbVar(a, 1); }}`",
    GenericConstants "generic blocks: `VAR_GENERIC CONSTANT`, `FB<8>`",
    DecimalBase "`10#` before a number of base 10",
    BaseParts "a structure assigned to one that it extends: a copy of its part",
    GlobalOperator "a point before the name of what is global, `.name`",
    PlacesOfText "`__POUNAME()`, `__POSITION()`, `__VARINFO(x)`",
    BitsInOut "an unsigned integer for a `VAR_IN_OUT` that is a bit string, or the other way",
    EmptyLists "a call without arguments where each input has a value of its own",
    NamedCounts "a count of equal initial values by its name, `[N(5), 7]`",
    CharactersAsText "a CHAR where a STRING is wanted, a WCHAR where a WSTRING is",
    PositionalOutputs "outputs behind the inputs in a list without names",
    CharactersSelect "`CASE` of a CHAR, WCHAR or string",
    BareCalls "a call without arguments: each input has its initial value",
    Overloads "functions or methods of one name with other parameters",
    UnusedUnits "a unit with errors that no task's program uses",
    ThisPointer "`THIS` alone, a pointer to the running instance",
    LiteralAddresses "the address of a literal, `ADR('text')`",
    TimesBesideNumbers "a TIME compared with a number of milliseconds",
    TimesAsDates "durations, dates and times of day from one another, `TIME_TO_DT`, `BOOL_TO_DATE`",
    FreeTasks "a task with neither SINGLE nor INTERVAL: it runs in each scan, behind the others",
    PointersInOut "a variable that is a pointer to another type for a `VAR_IN_OUT` or `REFERENCE TO` that is a pointer",
    OpenInputsHandedOn "an `ARRAY [*]` of `VAR_INPUT` handed on as `VAR_IN_OUT`",
    LongTimers "an LTIME for PT of `TON`, `TOF` and `TP`",
    WideStarts "a FOR that begins with an integer wider than its variable, which is cut",
    SpacedValues "blanks behind `#` of an enumeration's value, `Colour# Red`",
    NarrowQuotes "a WSTRING between single quotes, `WSTRING#'a'`",
    GlobalConfigurations "several CONFIGURATIONs, of which one alone has tasks and programs",
    ImplicitInit "`FB_init` called where nobody declares it: the instance begins again",
}

impl Feature {
    /// What to do about it in a dialect that does not have it.
    pub fn help(self) -> String {
        format!("it is part of {}: --dialect chooses", self.homes())
    }

    /// The dialects that have it, as a list in a sentence.
    pub fn homes(self) -> String {
        let names: Vec<_> = Dialect::ALL.iter().filter(|dialect| dialect.has(self)).map(|one| one.name()).collect();
        match names.as_slice() {
            [] => String::new(),
            [only] => (*only).to_owned(),
            [first @ .., last] => format!("{} and {last}", first.join(", ")),
        }
    }
}

#[cfg(test)]
mod tests;
