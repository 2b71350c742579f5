//! What is reported about program text: a stable code, a place, a message, a hint.

use std::fmt;
use std::sync::Arc;

use miette::{LabeledSpan, NamedSource};

// Hints are a part of diagnostics, so the rooms that report something find them here.
pub use onescan_base::did_you_mean;

use crate::source::{LineColumn, SourceMap, Span};

macro_rules! codes {
    ($($variant:ident $text:literal $about:literal),* $(,)?) => {
        /// Stable codes: `G` networks and lists of instructions, `S` syntax, `N` names, `T` types, `C` calls, `D` declarations, `L` limits,
        /// `R` addresses and references, `F` files, `W` warnings of what is legal and seldom meant,
        /// `I` instrumentation for lockstep.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Code {
            $(#[doc = concat!("`", $text, "`: ", $about)] $variant,)*
        }

        impl Code {
            /// Every code, for a page that explains each.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// The code as printed.
            pub fn text(self) -> &'static str {
                match self { $(Self::$variant => $text,)* }
            }

            /// What the code stands for, in a line.
            pub fn about(self) -> &'static str {
                match self { $(Self::$variant => $about,)* }
            }
        }
    };
}

codes! {
    UnexpectedToken "S0101" "a token stands where the grammar wants another",
    Unterminated "S0102" "a comment, pragma or string has no end",
    InvalidLiteral "S0103" "a literal is malformed",
    NestingTooDeep "S0104" "text is nested deeper than the limit",
    UnknownCharacter "S0105" "a character begins no token",
    WrongDialect "S0110" "a construct that the file's dialect lacks",
    UnbalancedPragma "S0111" "conditional pragmas do not match",
    UnknownLabel "G1101" "a jump leads to no label",
    DanglingConnection "G1102" "a connection comes from no element",
    DuplicateElement "G1103" "two elements of a network have one id",
    FeedbackWithoutVariable "G1104" "a loop of a network has no feedback variable",
    FeedbackWithoutOrder "G1105" "a loop of a network has no order of evaluation",
    Unconnected "G1106" "an element of a network lacks a connection",
    UnpairedConnector "G1107" "a continuation has no connector of its own",
    SeveralConnections "G1108" "several connections end at one input",
    EdgeInFunction "G1109" "an edge in a function, which keeps nothing",
    NoCurrentResult "G1120" "an instruction wants a current result and there is none",
    UnknownInstruction "G1121" "an instruction is not known or lacks its operand",
    UnknownName "N0101" "a name is not declared",
    DuplicateName "N0102" "a name is declared twice",
    UnknownType "N0103" "a type is not declared",
    UnknownMember "N0104" "a structure or instance has no such member",
    UnknownFunction "N0105" "no function or instance of that name",
    NotAVariable "N0106" "a name stands for something that has no value",
    ReservedName "N0107" "a name is the standard's own",
    NotQualified "N0108" "a value is known behind the name of its enumeration only",
    TypeMismatch "T0201" "a value has another type than its place wants",
    OutOfRange "T0202" "a constant does not fit its type",
    InvalidOperand "T0203" "an operator is not defined for its operands",
    NotConstant "T0204" "a constant expression is wanted",
    IndexOutOfRange "T0205" "a constant index is outside its array",
    NotIndexable "T0206" "only arrays are indexed",
    WrongDimensions "T0207" "an array is indexed with the wrong number of indices",
    NotAStructure "T0208" "only structures and instances have members",
    ConstantDivisionByZero "T0209" "a constant expression divides by zero",
    InvalidInitialiser "T0210" "an initial value does not suit its type",
    ZeroStep "T0211" "a FOR loop has a step of 0",
    StrictEnumeration "T0212" "a strict enumeration takes its own values only",
    UnknownArgument "C0301" "a called unit has no such parameter",
    MissingArgument "C0302" "an argument is missing",
    TooManyArguments "C0303" "more arguments than parameters",
    DuplicateArgument "C0304" "a parameter is given twice",
    InvalidArgument "C0305" "an argument does not suit its parameter",
    NotCallable "C0306" "what is called is not a function or instance",
    ResultIgnored "C0307" "a function is called as a statement and its result is lost",
    UnclearOverload "C0308" "which function or method of the name is called is not clear",
    InvalidEnable "C0310" "EN or ENO is declared as what it is not",
    AssignToConstant "D0401" "a constant is assigned to",
    AssignToInput "D0402" "an input is assigned to inside its own unit",
    NotAssignable "D0403" "the target of an assignment is not a variable",
    Recursion "D0404" "a unit or type contains or calls itself",
    MissingResult "D0405" "a function never assigns its result",
    ExternalWithoutGlobal "D0406" "VAR_EXTERNAL has no matching VAR_GLOBAL",
    WrongSection "D0407" "a declaration stands where it may not",
    InvalidRange "D0408" "a subrange's bounds are reversed or too large",
    MisplacedStatement "D0409" "EXIT or CONTINUE outside a loop",
    DuplicateCase "D0410" "a CASE label occurs twice",
    LoopVariable "D0411" "a FOR control variable is unsuitable",
    UnknownTask "D0430" "a program or function block names a task that is not declared",
    UnknownProgram "D0431" "a configuration makes an instance of what is not a program",
    TaskInput "D0432" "a task's input is unknown or unsuitable",
    TaskNeverRuns "D0433" "a task has neither SINGLE nor an INTERVAL",
    UnknownPath "D0434" "a path in a configuration leads to no variable",
    UnsuitableConnection "D0435" "a program's variable cannot be connected in this way",
    NoInstanceValue "D0436" "VAR_CONFIG names what has no value of its own",
    SecondConfiguration "D0437" "there are two configurations",
    BlockCalledTwice "D0438" "an instance with a task of its own is called by its program, too",
    ForeignGlobal "D0439" "a program uses a global variable of another resource",
    ProgramNeverRuns "D0440" "a program has no instance in the configuration",
    UnsupportedFeature "L0501" "part of the language that is not supported yet",
    TooLarge "L0502" "a type or the program needs more memory than the limit",
    AccessDenied "O0801" "a member is not accessible here",
    AbstractInstance "O0802" "what is ABSTRACT has no instances",
    MissingMethod "O0803" "a method of an interface or base is missing",
    WrongOverride "O0804" "a method does not match what it overrides",
    Finality "O0805" "what is FINAL is extended or overridden",
    NothingOverridden "O0806" "OVERRIDE of a method that no base has",
    WrongBase "O0807" "EXTENDS or IMPLEMENTS names something else",
    NoObject "O0808" "THIS or SUPER where there is no instance or base",
    WrongProperty "O0809" "a property is used in a way that it does not offer",
    UnknownNamespace "O0810" "a namespace is not declared",
    MemberAlone "O0811" "a method, property or action belongs to no unit",
    HookInputs "O0812" "FB_init, FB_reinit or FB_exit has other inputs than it is run with",
    InvalidAddress "R0901" "a direct address is malformed or out of range",
    UnsuitableAddress "R0902" "a variable does not suit its direct address",
    InvalidPart "R0903" "a value has no such part",
    UnknownCondition "L0511" "a pragma's condition that is not evaluated",
    ClassicTimer "L0512" "a timer or counter of S5",
    VendorRuntime "L0513" "a part of a vendor's runtime",
    NotReferable "R0904" "a reference to what has no lasting place",
    NotAReference "R0905" "a reference is wanted",
    PointerOfOtherType "R0906" "a pointer is made of one to another type",
    OpenArray "R0907" "an array without bounds stands where it may not",
    SharedBytes "R0908" "members of a structure lie on the same bytes",
    MixedBody "Q1201" "statements stand beside the steps of a chart",
    MisplacedChart "Q1202" "a chart stands where no step can be kept",
    InitialStep "Q1203" "a network of a chart has not exactly one initial step",
    UnknownStep "Q1204" "a transition names a step that does not exist",
    UnknownAction "Q1205" "a step names an action that does not exist",
    UnknownQualifier "Q1206" "what is written is not an action qualifier",
    ActionTime "Q1207" "the time of an action is missing or has no use",
    UnreachableStep "Q1208" "a step can never be active",
    UnreachableTransition "Q1209" "a transition can never be enabled",
    UnsafeChart "Q1210" "a step may be activated while it is active",
    TimeConflict "Q1211" "an action may have two times at once",
    DeadEnd "Q1212" "a chart comes to an end",
    SharedAction "Q1213" "two charts of a unit control one action",
    LostPulse "Q1214" "an action gets no pulse from a step that follows another one",
    PulseWithoutEffect "Q1215" "a pulse of a step's edge does not set a BOOL",
    NotText "F0601" "a file is not text in an encoding that is read",
    MalformedXml "F0602" "a file is not the XML that its name promises",
    NotProgramText "F0603" "a file holds no program text",
    MissingFile "F0604" "a project lists a file that is not there",
    OutputNeverWritten "W0701" "an output is never written",
    InstanceNeverCalled "W0702" "a function block's instance is never called",
    RealEquality "W0703" "real numbers are compared for equality",
    CallInBranch "W0704" "a timer, counter or edge detection is called in a branch or loop",
    UnreachableCode "W0705" "statements can never be reached",
    UnusedVariable "W0706" "a variable is never used",
    LossyConversion "W0708" "an implicit conversion may change a value",
    ClockNotReplaced "I1001" "a source of time cannot be replaced for lockstep",
    MotionNotReplaced "I1002" "motion control that cannot be replaced for lockstep",
    ShimNameTaken "I1003" "a name is one of the shim's",
    DamagedMarks "I1004" "marks of the shim do not fit together",
    WrittenByTwoTasks "W0707" "a variable is written by two tasks",
    EndlessLoop "W0709" "a loop is never left",
    StubUsed "W0710" "a stub is called, which does nothing",
    UncutDifference "W0712" "a difference of unsigned integers is compared before it is cut to their type",
    CutProduct "W0713" "a product is cut to the type of its factors before it becomes wider",
    AttributeWithoutEffect "W0714" "an attribute that changes values elsewhere has no effect here",
    EndlessCount "W0715" "a loop up to the limit of its variable's type never ends on the target",
    UndrivenInput "W0716" "an input of a program is driven by nobody",
    ZeroDivisor "W0720" "a number is divided by the constant 0",
    LostFraction "W0721" "a quotient of integers loses its fraction before it becomes real",
    LoopNeverRuns "W0722" "a FOR loop never runs",
    LoopVariableWritten "W0723" "the variable of a FOR loop is written in the loop",
    DecidedComparison "W0724" "a comparison is always TRUE or always FALSE",
    Overwritten "W0725" "a value is overwritten before anything reads it",
    OutputWithTwoNames "W0726" "one output is written under two names or by two programs",
    ConstantCondition "W0727" "a condition is TRUE or FALSE as it is written",
    AssignedToItself "W0728" "a variable is assigned to itself",
    CounterWraps "W0729" "a counter wraps that is compared and never set back",
    CutText "W0730" "a function of strings takes or gives no more than 255 characters",
    UnusedUnit "W0731" "a unit with errors that no task uses is left out",
}

impl fmt::Display for Code {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.text())
    }
}

/// How grave a diagnostic is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The program compiles; it may not mean what was meant.
    Warning,
    /// The program does not compile.
    Error,
}

impl fmt::Display for Severity {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Warning => "warning",
            Self::Error => "error",
        })
    }
}

/// A further place that explains the primary one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// Where.
    pub span: Span,
    /// What is to be seen there.
    pub message: String,
}

/// One finding.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// Its stable code.
    pub code: Code,
    /// How grave it is.
    pub severity: Severity,
    /// The primary place.
    pub span: Span,
    /// What is wrong, in a line.
    pub message: String,
    /// Further places.
    pub labels: Vec<Label>,
    /// What to do about it.
    pub help: Option<String>,
}

impl Diagnostic {
    /// An error at `span`.
    pub fn error(code: Code, span: Span, message: impl Into<String>) -> Self {
        let message = message.into();
        Self { code, severity: Severity::Error, span, message, labels: Vec::new(), help: None }
    }

    /// A warning at `span`.
    pub fn warning(code: Code, span: Span, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(code, span, message) }
    }

    /// Adds a hint.
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Adds a hint if there is one.
    pub fn with_optional_help(mut self, help: Option<String>) -> Self {
        self.help = help;
        self
    }

    /// The message, with what to do about it in parentheses if that is known.
    pub fn with_its_help(&self) -> String {
        match &self.help {
            Some(help) => format!("{} ({help})", self.message),
            None => self.message.clone(),
        }
    }

    /// Adds a further place.
    pub fn with_label(mut self, span: Span, message: impl Into<String>) -> Self {
        self.labels.push(Label { span, message: message.into() });
        self
    }
}

/// Findings together with the text they point into.
///
/// As a [`miette::Diagnostic`] every finding is a related diagnostic with its own source.
#[derive(Debug, Clone)]
pub struct Diagnostics {
    findings: Vec<Finding>,
    /// For people who read to the end; nothing if there is only one finding, or none.
    summary: Option<Summary>,
    /// The same behind the errors alone.
    errors_summary: Option<Summary>,
}

/// How many findings there are, as the last thing that is read.
#[derive(Debug, Clone, thiserror::Error)]
#[error("{0}")]
struct Summary(String);

impl miette::Diagnostic for Summary {
    fn severity(&self) -> Option<miette::Severity> {
        Some(miette::Severity::Advice)
    }
}

/// `1 error`, `2 warnings`
pub fn counted(number: usize, word: &str) -> String {
    format!("{number} {word}{}", if number == 1 { "" } else { "s" })
}

impl Diagnostics {
    /// Joins findings with their text, in the order of files and places.
    pub fn new(mut diagnostics: Vec<Diagnostic>, sources: &SourceMap) -> Self {
        diagnostics.sort_by_key(|found| (found.span.file, found.span.start, found.code));
        // What is checked in two ways, as the operands of SEL are, is said once.
        diagnostics.dedup();
        let findings = diagnostics.into_iter().map(|found| Finding::new(found, sources));
        let findings: Vec<Finding> = findings.collect();
        let count = |severity| findings.iter().filter(|found| found.diagnostic.severity == severity).count();
        let (errors, warnings) = (count(Severity::Error), count(Severity::Warning));
        let both = [(errors, "error"), (warnings, "warning")].into_iter().filter(|(number, _)| *number > 0);
        let both: Vec<String> = both.map(|(number, word)| counted(number, word)).collect();
        let summary = (findings.len() > 1).then(|| Summary(both.join(", ")));
        let others = if warnings > 0 { "; `onescan check` shows the warnings" } else { "" };
        let errors_summary = summary.as_ref().map(|Summary(both)| Summary(format!("{both}{others}")));
        Self { findings, summary, errors_summary }
    }

    /// What stops people who want to run the program: the errors, and how many warnings there are.
    pub fn errors(&self) -> impl Iterator<Item = &dyn miette::Diagnostic> {
        let is_error = |found: &&Finding| found.diagnostic.severity == Severity::Error;
        let each = self.findings.iter().filter(is_error).map(|finding| finding as &dyn miette::Diagnostic);
        each.chain(self.errors_summary.iter().map(|summary| summary as &dyn miette::Diagnostic))
    }

    /// As they are read: warnings first, so that the errors are the last that is seen.
    fn as_read(&self) -> impl Iterator<Item = &Finding> {
        let of = |severity| move |found: &&Finding| found.diagnostic.severity == severity;
        let warnings = self.findings.iter().filter(of(Severity::Warning));
        warnings.chain(self.findings.iter().filter(of(Severity::Error)))
    }

    /// True if there is none.
    pub fn is_empty(&self) -> bool {
        self.findings.is_empty()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.findings.len()
    }

    /// True if one of them is an error.
    pub fn has_errors(&self) -> bool {
        self.iter().any(|found| found.severity == Severity::Error)
    }

    /// The findings in order, each with its file and place.
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    /// How many errors there are.
    pub fn error_count(&self) -> usize {
        self.iter().filter(|found| found.severity == Severity::Error).count()
    }

    /// What was found, in order.
    pub fn iter(&self) -> impl Iterator<Item = &Diagnostic> {
        self.findings.iter().map(|finding| &finding.diagnostic)
    }
}

/// A line for each finding, with all there is to it: `file:line:column: error[CODE]: message (help)`.
impl fmt::Display for Diagnostics {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, finding) in self.findings.iter().enumerate() {
            if index > 0 {
                writeln!(formatter)?;
            }
            finding.write_line(formatter)?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostics {}

impl miette::Diagnostic for Diagnostics {
    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn miette::Diagnostic> + 'a>> {
        let each = self.as_read().map(|finding| finding as &dyn miette::Diagnostic);
        let summary = self.summary.iter().map(|summary| summary as &dyn miette::Diagnostic);
        Some(Box::new(each.chain(summary)))
    }
}

/// A diagnostic with what is needed to show it. Its spans are places in the file as its author
/// sees it.
#[derive(Debug, Clone)]
pub struct Finding {
    diagnostic: Diagnostic,
    source: NamedSource<Arc<str>>,
    start: LineColumn,
    end: LineColumn,
}

impl Finding {
    fn new(mut diagnostic: Diagnostic, sources: &SourceMap) -> Self {
        let nowhere = LineColumn { line: 0, column: 0 };
        let Some(file) = sources.get(diagnostic.span.file) else {
            let source = NamedSource::new("", Arc::from(""));
            return Self { diagnostic, source, start: nowhere, end: nowhere };
        };
        let source = NamedSource::new(file.name(), file.shown_text().clone());
        diagnostic.span = shown(diagnostic.span, sources);
        for label in &mut diagnostic.labels {
            label.span = shown(label.span, sources);
        }
        let Span { start, end, .. } = diagnostic.span;
        let (start, end) = (file.shown_line_column(start), file.shown_line_column(end));
        Self { diagnostic, source, start, end }
    }

    /// What was found.
    pub fn diagnostic(&self) -> &Diagnostic {
        &self.diagnostic
    }

    /// Name of the file.
    pub fn file(&self) -> &str {
        self.source.name()
    }

    /// Text of the file, which the diagnostic's spans are ranges of.
    pub fn text(&self) -> &str {
        self.source.inner()
    }

    /// Where it begins.
    pub fn start(&self) -> LineColumn {
        self.start
    }

    /// Where it ends: the place behind its last character.
    pub fn end(&self) -> LineColumn {
        self.end
    }
}

fn shown(span: Span, sources: &SourceMap) -> Span {
    sources.get(span.file).map_or(span, |file| {
        let range = file.shown_range(span.start, span.end);
        Span { start: range.start, end: range.end, ..span }
    })
}

impl Finding {
    /// All there is to it in a line: `file:line:column: error[CODE]: message (help)`.
    ///
    /// # Errors
    /// The formatter's own.
    pub fn write_line(&self, formatter: &mut dyn fmt::Write) -> fmt::Result {
        let Self { diagnostic, source, start, .. } = self;
        let (name, code, severity) = (source.name(), diagnostic.code, diagnostic.severity);
        let LineColumn { line, column } = start;
        write!(formatter, "{name}:{line}:{column}: {severity}[{code}]: {}", diagnostic.with_its_help())
    }
}

/// The message alone: a renderer shows place, code and help by itself.
impl fmt::Display for Finding {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.diagnostic.message)
    }
}

impl std::error::Error for Finding {}

impl miette::Diagnostic for Finding {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(self.diagnostic.code))
    }

    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.diagnostic.severity {
            Severity::Warning => miette::Severity::Warning,
            Severity::Error => miette::Severity::Error,
        })
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        let help = self.diagnostic.help.as_ref()?;
        Some(Box::new(help))
    }

    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        Some(&self.source)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let primary = self.diagnostic.span;
        let at = |span: Span, text: Option<String>| LabeledSpan::new(text, span.start as usize, span.len() as usize);
        // A renderer shows one file per diagnostic; labels in other files stay with the data.
        let others = self.diagnostic.labels.iter().filter(move |label| label.span.file == primary.file);
        let others = others.map(move |label| at(label.span, Some(label.message.clone())));
        Some(Box::new(std::iter::once(at(primary, None)).chain(others)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_wants_to_run_sees_errors_alone() {
        let span = Span::new(crate::syntax::FileId(0), 0, 0);
        let found =
            [Diagnostic::warning(Code::UnusedVariable, span, "w"), Diagnostic::error(Code::UnknownName, span, "e")];
        let found = Diagnostics::new(found.to_vec(), &SourceMap::default());
        let said: Vec<String> = found.errors().map(ToString::to_string).collect();
        assert_eq!(said, ["e", "1 error, 1 warning; `onescan check` shows the warnings"]);
    }

    #[test]
    fn codes_are_unique() {
        let mut texts: Vec<_> = Code::ALL.iter().map(|code| code.text()).collect();
        texts.sort_unstable();
        texts.dedup();
        assert_eq!(texts.len(), Code::ALL.len());
    }
}
