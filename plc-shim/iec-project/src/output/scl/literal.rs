//! Literals as they are written in SCL.

use super::spec::refused;
use onescan_iec::diagnostic::Diagnostic;
use onescan_iec::syntax::Span;
use onescan_iec::syntax::ast::{Literal, TypedValue};

/// The longest TIME of TIA Portal: milliseconds in 32 bits with a sign.
const TIME_MAX_MS: i64 = i32::MAX as i64;

/// What takes the place of a literal; nothing if it is the same in SCL.
pub(super) fn written(literal: &Literal, text: &str, span: Span) -> Result<Option<String>, Diagnostic> {
    match literal {
        Literal::Duration { long: false, ns } => time(*ns, text, span),
        Literal::Duration { long: true, .. } => Ok(text.contains('.').then(|| duration(literal))),
        Literal::String(text) | Literal::Typed { value: TypedValue::Text(text), .. } if text.starts_with('"') => {
            wide(text, span)
        }
        _ => Ok(None),
    }
}

/// A TIME counts milliseconds in TIA Portal.
fn time(ns: i64, text: &str, span: Span) -> Result<Option<String>, Diagnostic> {
    let ms = ns / 1_000_000;
    if ns % 1_000_000 != 0 {
        return Err(refused(span, "TIME below a millisecond", "use LTIME: `LT#500us`"));
    }
    if ms.abs() > TIME_MAX_MS {
        return Err(refused(span, "TIME beyond 24 days", "use LTIME: `LT#30d`"));
    }
    // A part with a fraction is not written there.
    let is_plain = !text.contains('.') && !text.to_ascii_lowercase().ends_with("us");
    Ok((!is_plain).then(|| format!("T#{ms}ms")))
}

fn duration(literal: &Literal) -> String {
    match literal {
        Literal::Duration { ns, .. } => format!("LT#{ns}ns"),
        _ => String::new(),
    }
}

fn wide(text: &str, span: Span) -> Result<Option<String>, Diagnostic> {
    let inner = text.trim_matches('"');
    if inner.contains(['$', '\'']) {
        return Err(refused(span, "text like this", "write a WSTRING without `$` and quotes"));
    }
    Ok(Some(format!("WSTRING#'{inner}'")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use onescan_iec::syntax::FileId;

    #[test]
    fn durations_are_whole_milliseconds() {
        let span = Span::new(FileId(0), 0, 1);
        let time = |ns, text: &str| written(&Literal::Duration { long: false, ns }, text, span);
        assert_eq!(time(100_000_000, "T#100ms").ok(), Some(None));
        assert_eq!(time(1_500_000_000, "T#1.5s").ok(), Some(Some("T#1500ms".to_owned())));
        assert!(time(500_000, "T#500us").is_err() && time(i64::MAX, "T#106751d").is_err());
        let long = Literal::Duration { long: true, ns: 1_500 };
        assert_eq!(written(&long, "LT#1.5us", span).ok(), Some(Some("LT#1500ns".to_owned())));
    }
}
