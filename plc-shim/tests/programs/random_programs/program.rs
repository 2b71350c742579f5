//! Programs over a few variables, and their text.
//!
//! A loop has its own control variable by depth and kind, so that every loop ends.

use std::fmt::Write;

use proptest::prelude::*;

/// Deepest nesting of loops.
pub(crate) const DEPTH: usize = 3;

#[derive(Debug, Clone)]
pub(crate) enum Number {
    Literal(i16),
    Variable(usize),
    /// `DINT_TO_INT(a[n AND 3])`
    Element(Box<Number>),
    Negate(Box<Number>),
    Binary(&'static str, Box<Number>, Box<Number>),
    /// `SEL(c, n, m)`
    Select(Box<Truth>, Box<Number>, Box<Number>),
    /// The control variable of a loop, whether it runs or not.
    Control(usize),
    /// `Clamp(n)`, a function.
    Call(Box<Number>),
}

#[derive(Debug, Clone)]
pub(crate) enum Truth {
    Literal(bool),
    Variable(usize),
    Not(Box<Truth>),
    Join(&'static str, Box<Truth>, Box<Truth>),
    Compare(&'static str, Number, Number),
}

/// Ranges; both ends of a single value are it.
pub(crate) type Labels = Vec<(i16, i16)>;

#[derive(Debug, Clone)]
pub(crate) enum Statement {
    Assign(usize, Number),
    AssignTruth(usize, Truth),
    /// `a[n] := n`, where the index may be out of range.
    AssignElement(Number, Number),
    If(Vec<(Truth, Vec<Statement>)>, Vec<Statement>),
    Case(Number, Vec<(Labels, Vec<Statement>)>, Vec<Statement>),
    For {
        from: Number,
        to: Number,
        by: i16,
        body: Vec<Statement>,
    },
    /// At most so many turns.
    While(i16, Truth, Vec<Statement>),
    Repeat(i16, Truth, Vec<Statement>),
    /// `IF c THEN EXIT; END_IF`
    Exit(Truth),
    Continue(Truth),
    Return(Truth),
    /// Of an instance that adds.
    CallInstance(usize, Number),
    /// `__TRY … __CATCH(code) … __FINALLY … __ENDTRY`
    Try {
        body: Vec<Statement>,
        handler: Vec<Statement>,
        finally: Vec<Statement>,
    },
}

fn number() -> impl Strategy<Value = Number> {
    let leaf = prop_oneof![
        (-5_i16..6).prop_map(Number::Literal),
        any::<i16>().prop_map(Number::Literal),
        (0_usize..4).prop_map(Number::Variable),
        (0_usize..DEPTH * 3).prop_map(Number::Control),
    ];
    leaf.prop_recursive(3, 12, 3, |inner| {
        let boxed = inner.prop_map(Box::new).boxed();
        let operator = prop::sample::select(&["+", "-", "*", "/", "MOD"][..]);
        prop_oneof![
            boxed.clone().prop_map(Number::Element),
            boxed.clone().prop_map(Number::Negate),
            boxed.clone().prop_map(Number::Call),
            (operator, boxed.clone(), boxed.clone()).prop_map(|(op, a, b)| Number::Binary(op, a, b)),
            (0_usize..3, boxed.clone(), boxed).prop_map(|(c, a, b)| Number::Select(Box::new(Truth::Variable(c)), a, b)),
        ]
    })
}

fn truth() -> impl Strategy<Value = Truth> {
    let comparison = prop::sample::select(&["<", "<=", ">", ">=", "=", "<>"][..]);
    let leaf = prop_oneof![
        any::<bool>().prop_map(Truth::Literal),
        (0_usize..3).prop_map(Truth::Variable),
        (comparison, number(), number()).prop_map(|(op, a, b)| Truth::Compare(op, a, b)),
    ];
    leaf.prop_recursive(2, 6, 2, |inner| {
        let boxed = inner.prop_map(Box::new).boxed();
        let operator = prop::sample::select(&["AND", "OR", "XOR"][..]);
        prop_oneof![
            boxed.clone().prop_map(Truth::Not),
            (operator, boxed.clone(), boxed).prop_map(|(op, a, b)| Truth::Join(op, a, b)),
        ]
    })
}

fn labels() -> impl Strategy<Value = Labels> {
    let label = prop_oneof![
        (-6_i16..7).prop_map(|value| (value, value)),
        (-9_i16..9, 0_i16..6).prop_map(|(low, length)| (low, low + length)),
        (any::<i16>(), 0_i16..100).prop_map(|(low, length)| (low, low.saturating_add(length))),
    ];
    prop::collection::vec(label, 1..3)
}

fn block(depth: usize, tries: bool) -> BoxedStrategy<Vec<Statement>> {
    prop::collection::vec(statement(depth, tries), 0..4).boxed()
}

/// With `tries`, some of the statements are a `__TRY`.
fn statement(depth: usize, tries: bool) -> BoxedStrategy<Statement> {
    let simple = prop_oneof![
        4 => (0_usize..4, number()).prop_map(|(index, value)| Statement::Assign(index, value)),
        2 => (0_usize..3, truth()).prop_map(|(index, value)| Statement::AssignTruth(index, value)),
        1 => (0_i16..4, number()).prop_map(|(index, value)| Statement::AssignElement(Number::Literal(index), value)),
        1 => (0_usize..4, number()).prop_map(|(index, value)| Statement::AssignElement(Number::Variable(index), value)),
        1 => truth().prop_map(Statement::Exit),
        1 => truth().prop_map(Statement::Continue),
        1 => truth().prop_map(Statement::Return),
        1 => (0_usize..2, number()).prop_map(|(index, value)| Statement::CallInstance(index, value)),
    ];
    if depth == 0 {
        return simple.boxed();
    }
    let inner = block(depth - 1, tries);
    let branches = prop::collection::vec((truth(), inner.clone()), 1..3);
    let arms = prop::collection::vec((labels(), inner.clone()), 1..4);
    let near = || prop_oneof![3 => (-4_i16..8).prop_map(Number::Literal), 1 => number()];
    let step = prop_oneof![(-3_i16..4), Just(5000_i16), Just(i16::MIN)];
    let turns = || (0_i16..5, truth(), inner.clone());
    let tried = (inner.clone(), inner.clone(), inner.clone());
    let tried = tried.prop_map(|(body, handler, finally)| Statement::Try { body, handler, finally });
    prop_oneof![
        (if tries { 6 } else { 0 }) => tried,
        3 => simple,
        2 => (branches, inner.clone()).prop_map(|(branches, otherwise)| Statement::If(branches, otherwise)),
        1 => (number(), arms, inner.clone()).prop_map(|(value, arms, otherwise)| Statement::Case(value, arms, otherwise)),
        2 => (near(), near(), step, inner.clone())
            .prop_map(|(from, to, by, body)| Statement::For { from, to, by, body }),
        1 => turns().prop_map(|(limit, condition, body)| Statement::While(limit, condition, body)),
        1 => turns().prop_map(|(limit, until, body)| Statement::Repeat(limit, until, body)),
    ]
    .boxed()
}

pub(crate) fn program() -> impl Strategy<Value = Vec<Statement>> {
    prop::collection::vec(statement(DEPTH, false), 1..8)
}

/// One that goes on after some of its faults.
pub(super) fn trying_program() -> impl Strategy<Value = Vec<Statement>> {
    prop::collection::vec(statement(DEPTH, true), 1..8)
}

/// Loops around a statement: those of each depth and kind have a control variable.
pub(crate) fn control(kind: usize, depth: usize) -> usize {
    kind * DEPTH + depth % DEPTH
}

/// How programs are written.
pub(crate) struct Wording {
    /// What stands before an operation in parentheses: a function, or nothing.
    pub(crate) narrow: &'static str,
    /// A statement that does nothing.
    pub(crate) nothing: &'static str,
}

impl Wording {
    fn number(&self, number: &Number) -> String {
        let sub = |number: &Number| self.number(number);
        match number {
            Number::Literal(value) => format!("INT#{value}"),
            Number::Variable(index) => format!("v{index}"),
            Number::Control(index) => format!("i{index}"),
            Number::Element(index) => format!("DINT_TO_INT(a[ABS({} MOD 4)])", sub(index)),
            Number::Negate(value) => format!("{}(-{})", self.narrow, sub(value)),
            Number::Binary(op, a, b) => format!("{}({} {op} {})", self.narrow, sub(a), sub(b)),
            Number::Select(c, a, b) => format!("SEL({}, {}, {})", self.truth(c), sub(a), sub(b)),
            Number::Call(value) => format!("Clamp({})", sub(value)),
        }
    }

    fn truth(&self, truth: &Truth) -> String {
        match truth {
            Truth::Literal(value) => value.to_string(),
            Truth::Variable(index) => format!("b{index}"),
            Truth::Not(value) => format!("(NOT {})", self.truth(value)),
            Truth::Join(op, a, b) => format!("({} {op} {})", self.truth(a), self.truth(b)),
            Truth::Compare(op, a, b) => format!("({} {op} {})", self.number(a), self.number(b)),
        }
    }

    fn write_block(&self, text: &mut String, block: &[Statement], loops: usize) {
        if block.is_empty() {
            text.push_str(self.nothing);
        }
        for statement in block {
            self.write_statement(text, statement, loops);
        }
    }

    fn write_statement(&self, text: &mut String, statement: &Statement, loops: usize) {
        let line = match statement {
            Statement::Assign(index, value) => format!("v{index} := {};", self.number(value)),
            Statement::AssignTruth(index, value) => format!("b{index} := {};", self.truth(value)),
            Statement::AssignElement(index, value) => {
                format!("a[{}] := INT_TO_DINT({}) * 100000;", self.number(index), self.number(value))
            }
            // Outside of a loop there is nothing to leave.
            Statement::Exit(condition) if loops > 0 => format!("IF {} THEN EXIT; END_IF;", self.truth(condition)),
            Statement::Continue(condition) if loops > 0 => {
                format!("IF {} THEN CONTINUE; END_IF;", self.truth(condition))
            }
            Statement::Exit(_) | Statement::Continue(_) => self.nothing.to_owned(),
            Statement::Return(condition) => format!("IF {} THEN RETURN; END_IF;", self.truth(condition)),
            Statement::CallInstance(index, value) => format!("c{index}(x := {});", self.number(value)),
            compound => return self.write_compound(text, compound, loops),
        };
        writeln!(text, "{line}").expect("a string takes all");
    }

    fn write_compound(&self, text: &mut String, statement: &Statement, loops: usize) {
        let mut line = |line: String| writeln!(text, "{line}").expect("a string takes all");
        match statement {
            Statement::If(branches, otherwise) => {
                for (index, (condition, body)) in branches.iter().enumerate() {
                    let word = if index == 0 { "IF" } else { "ELSIF" };
                    writeln!(text, "{word} {} THEN", self.truth(condition)).expect("a string takes all");
                    self.write_block(text, body, loops);
                }
                text.push_str("ELSE\n");
                self.write_block(text, otherwise, loops);
                text.push_str("END_IF;\n");
            }
            Statement::Case(value, arms, otherwise) => {
                line(format!("CASE {} OF", self.number(value)));
                for (labels, body) in arms {
                    let label =
                        |(low, high): &(i16, i16)| if low == high { low.to_string() } else { format!("{low}..{high}") };
                    let labels: Vec<String> = labels.iter().map(label).collect();
                    writeln!(text, "{}: {}", labels.join(", "), self.nothing).expect("a string takes all");
                    self.write_block(text, body, loops);
                }
                text.push_str("ELSE\n");
                self.write_block(text, otherwise, loops);
                text.push_str("END_CASE;\n");
            }
            Statement::For { from, to, by, body } => {
                let control = control(0, loops);
                // A constant step of 0 is an error.
                let by = if *by == 0 { format!("i{control} - i{control}") } else { by.to_string() };
                line(format!("FOR i{control} := {} TO {} BY {by} DO", self.number(from), self.number(to)));
                self.write_block(text, body, loops + 1);
                text.push_str("END_FOR;\n");
            }
            Statement::While(limit, condition, body) => {
                let control = control(1, loops);
                line(format!(
                    "i{control} := {limit}; WHILE i{control} > 0 AND {} DO i{control} := i{control} - 1;",
                    self.truth(condition)
                ));
                self.write_block(text, body, loops + 1);
                text.push_str("END_WHILE;\n");
            }
            Statement::Repeat(limit, until, body) => {
                let control = control(2, loops);
                line(format!("i{control} := {limit}; REPEAT i{control} := i{control} - 1;"));
                self.write_block(text, body, loops + 1);
                writeln!(text, "UNTIL i{control} <= 0 OR {} END_REPEAT;", self.truth(until))
                    .expect("a string takes all");
            }
            Statement::Try { body, handler, finally } => {
                let parts = [("__TRY", body), ("__CATCH(code)", handler), ("__FINALLY", finally)];
                // An empty one is left out: a handler goes on elsewhere then.
                for (word, part) in parts.into_iter().filter(|(word, part)| *word != "__FINALLY" || !part.is_empty()) {
                    writeln!(text, "{word}").expect("a string takes all");
                    self.write_block(text, part, loops);
                }
                text.push_str("__ENDTRY\n");
            }
            _ => {}
        }
    }

    /// A program `P` of the numbers `v0` to `v3` and `i0` on, the truths `b0` to `b2`, an array and two instances.
    pub(crate) fn program(&self, body: &[Statement]) -> String {
        let controls: Vec<String> = (0..DEPTH * 3).map(|index| format!("i{index}")).collect();
        let mut text = format!(
            "PROGRAM P\nVAR v0, v1, v2, v3, {} : INT; b0, b1, b2 : BOOL; a : ARRAY [0..3] OF DINT; c0, c1 : Sum; END_VAR\n",
            controls.join(", ")
        );
        self.write_block(&mut text, body, 0);
        text + "END_PROGRAM\n"
    }
}

/// The whole file of a program that goes on after some of its faults, in the dialect of CODESYS: a function makes what
/// is computed a number of 16 bits again.
pub(super) fn trying_text(body: &[Statement]) -> String {
    let own = "FUNCTION Narrow : INT VAR_INPUT n : INT; END_VAR Narrow := n; END_FUNCTION
        FUNCTION Pick : INT VAR_INPUT c : BOOL; a, b : INT; END_VAR IF c THEN Pick := b; ELSE Pick := a; END_IF END_FUNCTION\n";
    let wording = Wording { narrow: "Narrow", nothing: ";" };
    let program = wording.program(body).replace("c0, c1 : Sum;", "c0, c1 : Sum; code : DINT;");
    // SEL of CODESYS evaluates one of its two values only.
    BLOCKS.to_owned() + own + &program.replace("SEL(", "Pick(")
}

/// The whole file.
pub(super) fn text(body: &[Statement]) -> String {
    BLOCKS.to_owned() + &Wording { narrow: "", nothing: ";" }.program(body)
}

const BLOCKS: &str = "FUNCTION Clamp : INT VAR_INPUT n : INT; END_VAR
            Clamp := n; IF n > 100 THEN Clamp := 100; RETURN; END_IF; IF n < -100 THEN Clamp := -100; END_IF;
        END_FUNCTION
        FUNCTION_BLOCK Sum VAR_INPUT x : INT; END_VAR VAR_OUTPUT total : INT; END_VAR total := total + x; END_FUNCTION_BLOCK
        ";
