//! Expressions of every type.

use super::types::{BOOL, CLOCK, DAY, INT, Kind, MOMENT, TIME, Type, ty};
use super::{INSTANCES, Typed, VARIABLES};

impl Typed<'_> {
    pub(super) fn truth(&mut self, depth: usize) -> String {
        self.expression(BOOL, depth)
    }

    fn leaf(&mut self, one: Type) -> String {
        let own = self.types.iter().any(|other| other.name == one.name);
        if !own {
            return one.literal(self.dice);
        }
        match self.dice.below(8) {
            0 => one.literal(self.dice),
            1 | 2 => one.input(),
            3 if one.name == "INT" && !self.around.is_empty() => {
                let at = self.dice.below(self.around.len());
                self.around[at].clone()
            }
            3 if one.name == self.element.name => format!("row[{}]", self.index()),
            3 if one.name == "BOOL" => self.output(),
            4 if one.name == "BOOL" => "sp.b".to_owned(),
            4 if one.name == "INT" && self.dice.once_in(2) => self.cell(),
            4 if one.name == "INT" => "sp.n".to_owned(),
            4 if one.name == "LREAL" => "sp.l".to_owned(),
            _ => one.variable(self.dice.below(VARIABLES)),
        }
    }

    /// A BOOL output of an instance.
    fn output(&mut self) -> String {
        let (name, _, parts) = self.dice.pick(&INSTANCES);
        parts.iter().find(|(_, ty)| *ty == "BOOL").map_or("TRUE".to_owned(), |(part, _)| format!("{name}.{part}"))
    }

    pub(super) fn expression(&mut self, one: Type, depth: usize) -> String {
        if depth == 0 || self.dice.once_in(6) {
            return self.leaf(one);
        }
        if self.dice.once_in(6) {
            return self.selection(one, depth - 1);
        }
        match one.kind {
            Kind::Bool => self.logic(depth - 1),
            Kind::Signed | Kind::Unsigned => self.integer(one, depth - 1),
            Kind::Bits => self.bit_string(one, depth - 1),
            Kind::Real => self.real(one, depth - 1),
            Kind::Time => self.duration(depth - 1),
            Kind::Moment => self.moment(depth - 1),
            Kind::Clock => self.time_of_day(depth - 1),
            Kind::Day => format!("DATE_AND_TIME_TO_DATE({})", self.expression(MOMENT, depth - 1)),
            Kind::Text => self.string(depth - 1),
        }
    }

    /// An expression of a number or bit string in which a variable is: the names of all others have no small letters.
    pub(super) fn operand(&mut self, one: Type, depth: usize) -> String {
        let text = self.expression(one, depth);
        if text.contains(|letter: char| letter.is_ascii_lowercase()) {
            return text;
        }
        if self.types.iter().any(|other| other.name == one.name) { one.input() } else { "sp.l".to_owned() }
    }

    /// What every type has.
    fn selection(&mut self, one: Type, depth: usize) -> String {
        let (a, b) = (self.expression(one, depth), self.expression(one, depth));
        match self.dice.below(5) {
            0 | 1 => {
                let condition = self.truth(depth);
                format!("SEL({condition}, {a}, {b})")
            }
            2 => {
                let (selector, c) = (self.expression(INT, depth), self.expression(one, depth));
                format!("MUX(LIMIT(INT#0, {selector}, INT#2), {a}, {b}, {c})")
            }
            3 if one.kind != Kind::Bool => format!("MAX({a}, {b})"),
            4 if one.kind != Kind::Bool => format!("MIN({a}, {b})"),
            _ => a,
        }
    }

    fn logic(&mut self, depth: usize) -> String {
        if self.dice.once_in(2) {
            let types = self.types.clone();
            let one = self.dice.pick(&types[1..]);
            let sign = self.dice.pick(&["<", "<=", ">", ">=", "=", "<>"]);
            let (a, b) = (self.expression(one, depth), self.expression(one, depth));
            return format!("({a} {sign} {b})");
        }
        let (a, b) = (self.truth(depth), self.truth(depth));
        match self.dice.below(5) {
            0 => format!("(NOT {a})"),
            1 => format!("({a} XOR {b})"),
            2 => format!("({a} OR {b})"),
            3 => format!("({a} & {b})"),
            _ => format!("({a} AND {b})"),
        }
    }

    fn integer(&mut self, one: Type, depth: usize) -> String {
        if self.dice.once_in(4) {
            return self.converted(one, depth);
        }
        let name = one.name;
        let (a, b) = (self.operand(one, depth), self.expression(one, depth));
        let text = match self.dice.below(9) {
            0 | 1 => format!("{a} + {b}"),
            2 | 3 => format!("{a} - {b}"),
            4 => format!("{a} * {b}"),
            5 => format!("{a} / MAX({b}, {name}#1)"),
            6 if one.bits < 32 => format!("{a} MOD {b}"),
            6 => format!("{a} MOD MAX({b}, {name}#1)"),
            7 if one.kind == Kind::Signed => format!("-{a}"),
            8 if one.kind == Kind::Signed => return format!("ABS({a})"),
            _ if name == "INT" => format!("Clamp({a})"),
            _ => format!("{a} + {b}"),
        };
        one.own_width(&text)
    }

    /// From another type of the program.
    fn converted(&mut self, to: Type, depth: usize) -> String {
        let types = self.types.clone();
        let from = self.dice.pick(&types);
        let value = self.expression(from, depth);
        let name = format!("{}_TO_{}", from.name, to.name);
        match from.kind {
            _ if from.name == to.name => value,
            Kind::Real if to.kind != Kind::Bits => {
                let low = if to.kind == Kind::Unsigned { 0 } else { -to.room() };
                let (ty, high) = (from.name, to.room());
                format!("{name}(LIMIT({ty}#{low}.0, {value}, {ty}#{high}.0))")
            }
            Kind::Text if to.name == "INT" => {
                let letter = self.dice.pick(&['a', 'b', 'c']);
                let function =
                    if self.dice.once_in(2) { format!("LEN({value})") } else { format!("FIND({value}, '{letter}')") };
                format!("W_INT({function})")
            }
            Kind::Real | Kind::Time | Kind::Moment | Kind::Clock | Kind::Day | Kind::Text => self.leaf(to),
            Kind::Bool | Kind::Signed | Kind::Unsigned | Kind::Bits => format!("{name}({value})"),
        }
    }

    fn bit_string(&mut self, one: Type, depth: usize) -> String {
        if self.dice.once_in(4) {
            return self.converted(one, depth);
        }
        let (a, b) = (self.operand(one, depth), self.expression(one, depth));
        let places = self.dice.between(0, i64::from(one.bits) - 1);
        match self.dice.below(7) {
            0 => one.own_width(&format!("NOT {a}")),
            1 => format!("({a} AND {b})"),
            2 => format!("({a} OR {b})"),
            3 => format!("({a} XOR {b})"),
            _ => {
                let way = self.dice.pick(&["SHL", "SHR", "ROL", "ROR"]);
                format!("{way}({a}, {places})")
            }
        }
    }

    fn real(&mut self, one: Type, depth: usize) -> String {
        let name = one.name;
        if one.name == "LREAL" && self.dice.once_in(8) {
            let (a, n) = (self.expression(one, depth), self.expression(INT, depth));
            return format!("Blend(way := {n}, x := {a})");
        }
        if self.dice.once_in(4) {
            let types = self.types.clone();
            let from = self.dice.pick(&types);
            let fits = from.is_integer() || from.kind == Kind::Real && from.name != name;
            if fits {
                let value = self.expression(from, depth);
                return format!("{}_TO_{name}({value})", from.name);
            }
        }
        let (a, b) = (self.operand(one, depth), self.expression(one, depth));
        let text = match self.dice.below(8) {
            0 | 1 => format!("{a} + {b}"),
            2 | 3 => format!("{a} - {b}"),
            4 => format!("{a} * LIMIT({name}#-10.0, {b}, {name}#10.0)"),
            5 => format!("{a} / (ABS({b}) + {name}#0.5)"),
            6 => return format!("ABS({a})"),
            _ => return format!("SQRT(ABS({a}))"),
        };
        one.own_width(&text)
    }

    /// Near 0, so that nothing runs out of its range.
    fn short(&mut self, depth: usize) -> String {
        let value = self.expression(TIME, depth);
        format!("LIMIT(T#-20s, {value}, T#20s)")
    }

    fn moment(&mut self, depth: usize) -> String {
        if self.dice.once_in(3) {
            let (day, clock) = (self.expression(DAY, depth), self.expression(CLOCK, depth));
            return format!("CONCAT_DATE_TOD({day}, {clock})");
        }
        let sign = self.dice.pick(&["+", "-"]);
        format!("({} {sign} {})", self.expression(MOMENT, depth), self.short(depth))
    }

    /// Never over midnight.
    fn time_of_day(&mut self, depth: usize) -> String {
        if self.dice.once_in(3) {
            return format!("DATE_AND_TIME_TO_TIME_OF_DAY({})", self.expression(MOMENT, depth));
        }
        let (value, sign) = (self.expression(CLOCK, depth), self.dice.pick(&["+", "-"]));
        format!("(LIMIT(TOD#01:00:00, {value}, TOD#22:30:00) {sign} {})", self.short(depth))
    }

    fn duration(&mut self, depth: usize) -> String {
        if self.dice.once_in(5) {
            let one = self.dice.pick(&[MOMENT, CLOCK, DAY]);
            let (a, b) = (self.expression(one, depth), self.expression(one, depth));
            return format!("LIMIT(T#-500s, ({a} - {b}), T#500s)");
        }
        let (a, b) = (self.expression(TIME, depth), self.expression(TIME, depth));
        match self.dice.below(5) {
            0 | 1 => format!("({a} + {b})"),
            2 | 3 => format!("({a} - {b})"),
            _ => {
                let times = self.dice.between(0, 9);
                format!("(LIMIT(T#0ms, {a}, T#200ms) * INT#{times})")
            }
        }
    }

    fn string(&mut self, depth: usize) -> String {
        let text = ty("STRING", 0, Kind::Text);
        let (a, b) = (self.expression(text, depth), self.expression(text, depth));
        let (length, place) = (self.dice.between(0, 8), self.dice.between(1, 6));
        match self.dice.below(8) {
            0 | 1 => format!("CONCAT({a}, {b})"),
            2 => format!("LEFT({a}, {length})"),
            3 => format!("RIGHT({a}, {length})"),
            4 => format!("MID({a}, {length}, {place})"),
            5 => format!("INSERT(CONCAT('abcabc', {a}), {b}, {place})"),
            6 => format!("DELETE({a}, {length}, {place})"),
            _ => {
                let value = self.expression(INT, depth);
                format!("INT_TO_STRING({value})")
            }
        }
    }
}
