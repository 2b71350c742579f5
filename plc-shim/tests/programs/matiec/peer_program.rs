//! A program that both sides run, and what the soft PLC makes of it.

use std::fmt::Write;

use onescan_iec::Dialect;

use super::dice::Dice;
use crate::rig::Rig;

/// What the programs use of their own. A call gives a value the width of its type: C computes narrow types as `int`,
/// and a REAL with a literal as `double`, where here each operation has its type. The standard leaves both open.
pub(crate) const PRELUDE: &str = "\
TYPE Spot : STRUCT n : INT; l : LREAL; b : BOOL; END_STRUCT; END_TYPE
FUNCTION W_SINT : SINT VAR_INPUT x : SINT; END_VAR W_SINT := x; END_FUNCTION
FUNCTION W_INT : INT VAR_INPUT x : INT; END_VAR W_INT := x; END_FUNCTION
FUNCTION W_USINT : USINT VAR_INPUT x : USINT; END_VAR W_USINT := x; END_FUNCTION
FUNCTION W_UINT : UINT VAR_INPUT x : UINT; END_VAR W_UINT := x; END_FUNCTION
FUNCTION W_BYTE : BYTE VAR_INPUT x : BYTE; END_VAR W_BYTE := x; END_FUNCTION
FUNCTION W_WORD : WORD VAR_INPUT x : WORD; END_VAR W_WORD := x; END_FUNCTION
FUNCTION W_REAL : REAL VAR_INPUT x : REAL; END_VAR W_REAL := x; END_FUNCTION
FUNCTION Clamp : INT
VAR_INPUT x : INT; END_VAR
    Clamp := x;
    IF x > 100 THEN Clamp := 100; RETURN; END_IF;
    IF x < -100 THEN Clamp := -100; END_IF;
END_FUNCTION
FUNCTION Blend : LREAL
VAR_INPUT x : LREAL; way : INT; END_VAR
VAR n : INT; END_VAR
    CASE way OF
    0: Blend := x / 4.0; RETURN;
    1..9: n := way - 5;
    ELSE n := 2;
    END_CASE;
    Blend := x - INT_TO_LREAL(n);
END_FUNCTION
FUNCTION_BLOCK Fold
VAR_IN_OUT x : INT; END_VAR
VAR_INPUT by_how_much : INT; END_VAR
VAR_OUTPUT times : UINT; END_VAR
    x := W_INT(x - by_how_much);
    WHILE x > 1000 OR x < -1000 DO
        x := x / 3;
        times := times + 1;
    END_WHILE;
END_FUNCTION_BLOCK
FUNCTION_BLOCK Sum
VAR_INPUT x : INT; END_VAR
VAR_OUTPUT total : INT; END_VAR
    total := total + x;
END_FUNCTION_BLOCK
FUNCTION_BLOCK Count
VAR_INPUT runs : BOOL; by_how_much : DINT; END_VAR
VAR_OUTPUT total : DINT; late : BOOL; END_VAR
VAR pause : TON; rises : R_TRIG; END_VAR
    pause(IN := runs, PT := T#25ms);
    rises(CLK := runs);
    IF rises.Q THEN total := total + by_how_much; END_IF;
    late := pause.Q;
END_FUNCTION_BLOCK
";

/// Scans of each program.
pub(crate) const SCANS: usize = 100;

/// An input that is FALSE in the first scan, and only then.
pub(crate) const GO: &str = "go";

/// A variable, by its path in the program, and the name of its elementary type.
pub(crate) type Watched = (String, &'static str);

/// A program of a seed.
pub(crate) struct PeerProgram {
    /// The one in which the soft PLC reads it.
    pub(crate) dialect: Dialect,
    /// What kind of program it is.
    pub(crate) family: &'static str,
    /// From `PROGRAM P` to `END_PROGRAM`.
    pub(crate) text: String,
    /// Written before each scan.
    pub(crate) inputs: Vec<Watched>,
    /// Compared after each scan.
    pub(crate) outputs: Vec<Watched>,
    /// Compared, too, but to one unit in the last place: what functions gave that no standard rounds.
    pub(crate) rounded: Vec<Watched>,
}

impl PeerProgram {
    /// The file for the peer: names of all programs of a batch differ.
    pub(crate) fn named(&self, name: &str) -> String {
        self.text.replacen("PROGRAM P\n", &format!("PROGRAM {name}\n"), 1)
    }

    /// A line of names and types, then a line of values for each scan: the digits of their bytes.
    /// A line that says which fault it was ends a run that has one.
    pub(crate) fn trace(&self, dice: &mut Dice) -> String {
        self.trace_of(Rig::in_dialect(self.dialect, &format!("{PRELUDE}{}", self.text)), dice)
    }

    /// The same of a program that has been read from elsewhere.
    pub(crate) fn trace_of(&self, mut rig: Rig, dice: &mut Dice) -> String {
        let marked = |mark: &'static str, those: &[Watched]| {
            those.iter().map(move |(path, ty)| format!("{mark}{path}:{ty}")).collect::<Vec<_>>()
        };
        let head = [marked(">", &self.inputs), marked("", &self.outputs), marked("~", &self.rounded)];
        let mut table = head.concat().join(";") + "\n";
        let mut held: Vec<String> = Vec::new();
        for scan in 0..SCANS {
            for (at, (path, ty)) in self.inputs.iter().enumerate() {
                // Inputs stay for a while, as those of a machine do, so that timers get on.
                if scan == 0 {
                    held.push(sample(ty, dice));
                } else if dice.once_in(4) {
                    held[at] = sample(ty, dice);
                }
                if path == GO {
                    held[at] = digits(u64::from(scan > 0), ty);
                }
                put(&mut rig, &format!("P.{path}"), ty, &held[at]);
            }
            if let Err(fault) = rig.scan() {
                writeln!(table, "fault:{:?}", fault.kind).expect("a string takes all");
                break;
            }
            let all = self.outputs.iter().chain(&self.rounded);
            let found = all.map(|(path, ty)| held_by(&rig, &format!("P.{path}"), ty));
            let row: Vec<String> = held.iter().cloned().chain(found).collect();
            table += &(row.join(";") + "\n");
        }
        table
    }
}

/// Bytes of a type's values.
fn size(ty: &str) -> usize {
    match ty {
        "BOOL" | "SINT" | "USINT" | "BYTE" => 1,
        "INT" | "UINT" | "WORD" => 2,
        "DINT" | "UDINT" | "DWORD" | "REAL" => 4,
        _ => 8,
    }
}

/// A value as digits, most significant first; a STRING as those of its characters.
fn digits(value: u64, ty: &str) -> String {
    let bytes = size(ty);
    format!("{:0width$x}", value & (u64::MAX >> (64 - bytes * 8)), width = bytes * 2)
}

/// A value for an input.
fn sample(ty: &str, dice: &mut Dice) -> String {
    match ty {
        "BOOL" => digits(dice.below(2) as u64, ty),
        "REAL" => digits(u64::from((dice.between(-800, 800) as f32 / 8.0).to_bits()), ty),
        "LREAL" => digits((dice.between(-100_000, 100_000) as f64 / 1_000.0).to_bits(), ty),
        "TIME" => digits((dice.between(-200, 2_000) * 1_000_000) as u64, ty),
        // Whole seconds of the years 2000 to 2030.
        "DT" => digits((dice.between(946_684_800, 1_925_000_000) * 1_000_000_000) as u64, ty),
        "DATE" => digits((dice.between(10_957, 22_280) * 86_400_000_000_000) as u64, ty),
        "TOD" => digits((dice.between(0, 86_399) * 1_000_000_000) as u64, ty),
        "STRING" => {
            let length = dice.below(7);
            (0..length).map(|_| format!("{:02x}", b'a' + dice.below(3) as u8)).collect()
        }
        _ => match dice.below(4) {
            0 => digits(dice.bits(), ty),
            1 => digits(dice.pick(&[u64::MAX >> 1, 1 << 63, u64::MAX]) >> (64 - size(ty) * 8), ty),
            _ => digits(dice.between(if ty.starts_with('U') { 0 } else { -9 }, 20) as u64, ty),
        },
    }
}

fn put(rig: &mut Rig, path: &str, ty: &str, digits: &str) {
    if ty == "STRING" {
        let characters = (0..digits.len()).step_by(2).map(|at| u8::from_str_radix(&digits[at..at + 2], 16));
        let characters: Vec<u8> = characters.collect::<Result<_, _>>().expect("they are digits");
        let offset = rig.variable(path).offset as usize;
        let memory = &mut rig.plc.memory_mut()[offset..];
        memory[..2].copy_from_slice(&(characters.len() as u16).to_le_bytes());
        memory[2..2 + characters.len()].copy_from_slice(&characters);
    } else {
        let value = u64::from_str_radix(digits, 16).expect("they are digits");
        rig.set_bytes(path, &value.to_le_bytes());
    }
}

fn held_by(rig: &Rig, path: &str, ty: &str) -> String {
    if ty == "STRING" {
        return rig.text(path).bytes().map(|byte| format!("{byte:02x}")).collect();
    }
    digits(u64::from_le_bytes(rig.bytes(path)), ty)
}
