//! Comments as the second edition has them, and no pragmas.

use onescan_iec::dialect::Dialect;
use onescan_iec::source::edits::Edits;
use onescan_iec::syntax::lexer::tokenize_in;
use onescan_iec::syntax::token::TokenKind;

/// Changes of comments and pragmas alone.
pub(super) fn plain(text: &str, dialect: Dialect) -> Edits {
    let mut edits = Edits::default();
    for token in tokenize_in(dialect, text) {
        let written = text.get(token.start as usize..token.end as usize).unwrap_or("");
        let at = token.start..token.end;
        match token.kind {
            TokenKind::LineComment => edits.replace(at, block(written.trim_start_matches('/').trim())),
            TokenKind::BlockComment => {
                let inner = written.get(2..written.len().saturating_sub(2)).unwrap_or("");
                if !written.starts_with("(*") || inner.contains("(*") || inner.contains("*)") {
                    edits.replace(at, block(inner.trim()));
                }
            }
            // MatIEC writes the text of a pragma into its C code.
            TokenKind::Pragma => edits.replace(at, ""),
            _ => {}
        }
    }
    edits
}

fn block(inner: &str) -> String {
    format!("(* {} *)", inner.replace("(*", "( *").replace("*)", "* )"))
}
