//! Literals to bytes (2nd ed. 2.2).

use onescan_base::elementary::Kind;

use super::super::{Application, Variable};
use super::WriteError;
use onescan_iec::dialect::StringMemory;
use onescan_iec::ir::text::TextShape;
use onescan_iec::ir::{ElementaryType, Type, Value};
use onescan_iec::syntax::ast::{Expr, ExprKind, Literal, TypedValue, UnaryOp};
use onescan_iec::syntax::calendar::CalendarKind;
use onescan_iec::syntax::parser::parse_expression;
use onescan_iec::syntax::text_literal::parse_text;

impl Application {
    /// The bytes of a literal of the variable's type, as [`Application::value_text`] shows it or as it
    /// is written in a program: `5`, `INT#5`, `16#FF`, `Red`, `Colour#Red`, `'text'`. Structures and
    /// arrays are written by their members.
    ///
    /// # Errors
    /// The text is not a value of the type.
    pub fn value_bytes(&self, variable: &Variable, text: &str) -> Result<Vec<u8>, WriteError> {
        self.literal(variable, text).map_err(|reason| WriteError::Value {
            path: variable.path.clone(),
            type_name: variable.type_name.clone(),
            text: text.to_owned(),
            reason,
        })
    }

    fn literal(&self, variable: &Variable, text: &str) -> Result<Vec<u8>, String> {
        let types = &self.inner.checked.types;
        let size = variable.size as usize;
        let plain = |value: Value| value.bytes().into_iter().take(size).collect();
        match types.get(variable.type_id) {
            Type::Elementary(ty) => elementary(*ty, text).map(plain),
            Type::Subrange { base, low, high } => {
                let value = elementary(*base, text)?;
                let inside = value.as_int().is_some_and(|value| (*low..=*high).contains(&value));
                if inside { Ok(plain(value)) } else { Err(format!("it is outside of {low}..{high}")) }
            }
            Type::Enumeration { name, base, values, .. } => enumerated(name, *base, values, text).map(plain),
            Type::Text(shape) => string(*shape, text),
            Type::Array { .. } => Err("an array is written by its elements".to_owned()),
            _ => Err("it is written by its members".to_owned()),
        }
    }
}

fn enumerated(name: &str, base: ElementaryType, values: &[(String, i128)], text: &str) -> Result<Value, String> {
    let value = text.trim();
    let value = match value.split_once('#') {
        Some((prefix, value)) if prefix.eq_ignore_ascii_case(name) => value,
        _ => value,
    };
    if let Some((_, number)) = values.iter().find(|(known, _)| known.eq_ignore_ascii_case(value)) {
        return Ok(Value::Int(*number));
    }
    let names = || values.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(", ");
    let number = elementary(base, value).map_err(|_| format!("its values are {}", names()))?;
    let known = values.iter().any(|(_, known)| number.as_int() == Some(*known));
    if known { Ok(number) } else { Err(format!("its values are {}", names())) }
}

fn string(shape: TextShape, text: &str) -> Result<Vec<u8>, String> {
    let text = text.trim();
    let quote = if shape.wide { '"' } else { '\'' };
    if text.len() < 2 || !text.starts_with(quote) || !text.ends_with(quote) {
        return Err(format!("a string stands between {quote} and {quote}"));
    }
    let units = parse_text(text)?.units;
    if units.len() > shape.capacity as usize {
        return Err(format!("it has {} characters", units.len()));
    }
    Ok(shape.encode(&units))
}

fn elementary(ty: ElementaryType, text: &str) -> Result<Value, String> {
    let text = text.trim();
    if let Some(special) = special_real(ty, text) {
        return Ok(special);
    }
    if ty.is_character() {
        return character(ty, text);
    }
    let expr = parse_expression(text).ok_or("it is not a literal")?;
    let (negative, literal) = literal_of(&expr).ok_or("it is not a literal")?;
    let sign = |value: i128| if negative { -value } else { value };
    match (literal, ty.kind()) {
        (Literal::Bool(value), Kind::Bool) if !negative => Ok(Value::Bool(*value)),
        (Literal::Integer(value), _) if ty.takes_integers() => integer(ty, sign(*value)),
        (Literal::Real(value), Kind::Real) => Ok(real(ty, if negative { -value } else { *value })),
        (Literal::Duration { ns, .. }, Kind::Duration) => Ok(Value::Int(sign(i128::from(*ns)))),
        // The bits are those of the LTIME without sign that the dialect has.
        (Literal::LongDuration(ns), Kind::Duration) if !negative && ty == ElementaryType::Ltime => {
            Ok(Value::Int(i128::from(ns.cast_signed())))
        }
        (Literal::Calendar { kind, ns, .. }, _) if calendar_kind(ty) == Some(*kind) && !negative => {
            Ok(Value::Int(i128::from(*ns)))
        }
        (Literal::Typed { prefix, value }, _) if ElementaryType::find(prefix) == Some(ty) && !negative => match value {
            TypedValue::Integer(value) => integer(ty, *value),
            TypedValue::Real(value) if ty.is_real() => Ok(real(ty, *value)),
            TypedValue::Name(name) if ty == ElementaryType::Bool => elementary(ty, name),
            _ => Err("its type is another".to_owned()),
        },
        _ => Err("its type is another".to_owned()),
    }
}

/// What real numbers have beside numbers, as it is shown.
fn special_real(ty: ElementaryType, text: &str) -> Option<Value> {
    let value = match text.to_ascii_uppercase().as_str() {
        "NAN" => f64::NAN,
        "INF" => f64::INFINITY,
        "-INF" => f64::NEG_INFINITY,
        _ => return None,
    };
    ty.is_real().then(|| real(ty, value))
}

fn real(ty: ElementaryType, value: f64) -> Value {
    if ty.size() == 4 { Value::Real(value as f32) } else { Value::Lreal(value) }
}

fn integer(ty: ElementaryType, value: i128) -> Result<Value, String> {
    if ty.is_real() {
        return Ok(real(ty, value as f64));
    }
    let (low, high) = ty.range().unwrap_or((0, 0));
    if !(low..=high).contains(&value) {
        return Err(format!("it is outside of {low}..{high}"));
    }
    Ok(if ty == ElementaryType::Bool { Value::Bool(value != 0) } else { Value::Int(value) })
}

fn character(ty: ElementaryType, text: &str) -> Result<Value, String> {
    let shape = TextShape { wide: ty.size() == 2, capacity: 1, memory: StringMemory::Counted };
    let body = text.split_once('#').map_or(text, |(_, body)| if body.starts_with(['\'', '"']) { body } else { text });
    let bytes = string(shape, body)?;
    if bytes.first() != Some(&1) {
        return Err("it is not one character".to_owned());
    }
    let units = bytes.get(2..).unwrap_or_default();
    Ok(Value::Int(units.iter().rev().fold(0, |value, byte| value << 8 | i128::from(*byte))))
}

fn calendar_kind(ty: ElementaryType) -> Option<CalendarKind> {
    Some(match ty.kind() {
        Kind::Date => CalendarKind::Date,
        Kind::TimeOfDay => CalendarKind::TimeOfDay,
        Kind::DateTime => CalendarKind::DateAndTime,
        _ => return None,
    })
}

/// A literal with its sign.
fn literal_of(expr: &Expr) -> Option<(bool, &Literal)> {
    match &expr.kind {
        ExprKind::Literal(literal) => Some((false, literal)),
        ExprKind::Unary(UnaryOp::Plus, inner) => literal_of(inner),
        ExprKind::Unary(UnaryOp::Negate, inner) => match &inner.kind {
            ExprKind::Literal(literal) => Some((true, literal)),
            _ => None,
        },
        _ => None,
    }
}
