//! No product of two matrices of dynamic size.
//!
//! nalgebra hands such a product to kernels that are chosen by the processor, with and without fused operations, so that
//! its last bits would differ from machine to machine (`docs/decisions/013-mechanisms-and-the-engine.md`). All else that
//! is used of it adds in one order.

use std::collections::BTreeMap;

use crate::laws::{against, sources};
use crate::tokens::{Token, tokens};

/// Types whose size is known at run time only.
const DYNAMIC: &[&str] = &[
    "DMatrix",
    "DMatrixView",
    "DMatrixViewMut",
    "MatrixXx1",
    "MatrixXx2",
    "MatrixXx3",
    "MatrixXx4",
    "MatrixXx5",
    "MatrixXx6",
];

/// Where they stand, and for what; what is multiplied there has been read.
const READ: &[(&str, &str)] = &[
    ("clients/plant/src/world/contact/problem.rs", "rows of an island; entries are sums over two spans"),
    ("clients/plant/src/world/contact/search.rs", "rows of an island, entry by entry"),
    ("clients/plant/src/world/mechanism/apparent.rs", "an inverse, changed by the product of two vectors"),
    ("clients/plant/src/world/mechanism/closure.rs", "an inverse, changed by the products of two vectors"),
    ("clients/plant/src/world/mechanism/dynamics.rs", "the matrix of masses; what is multiplied has 3 or 6 rows"),
    ("clients/plant/src/world/mechanism/matrix.rs", "Cholesky's factor and its solves"),
    ("clients/plant/src/world/mechanism/mod.rs", "room for matrices"),
    ("clients/plant/src/world/mechanism/rows.rs", "rows of a mechanism, entry by entry"),
    ("clients/plant/src/world/mechanism/sprung.rs", "an inverse, changed by the product of two vectors"),
];

/// Calls that multiply matrices, or contain such a product, whatever the sizes: `gemm` and its kin, powers, exponentials,
/// decompositions that multiply blocks.
const PRODUCTS: &[&str] = &[
    "gemm",
    "gemm_ad",
    "gemm_tr",
    "mul_to",
    "tr_mul",
    "tr_mul_to",
    "ad_mul",
    "ad_mul_to",
    "kronecker",
    "pow",
    "exp",
    "quadform",
    "quadform_tr",
    "quadform_with_workspace",
    "quadform_tr_with_workspace",
    "svd",
    "schur",
    "symmetric_eigen",
    "hessenberg",
    "matrixmultiply",
    "dgemm",
];

/// Names in a text that are of a dynamic matrix: those that are declared with such a type, and those that a `let` makes of
/// a call of it.
fn matrices(tokens: &[(Token, usize)]) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for (at, (token, _)) in tokens.iter().enumerate() {
        let Token::Word(word) = token else { continue };
        if !DYNAMIC.contains(&word.as_str()) {
            continue;
        }
        // back over `mut`, `&` and what stands between a name and its type or its value
        let mut back = at;
        while back > 0 {
            back -= 1;
            match &tokens[back].0 {
                Token::Mark('&' | '<' | '(' | '[') => {}
                Token::Word(between) if between == "mut" || between == "Vec" || between == "Option" => {}
                Token::Mark(':' | '=') => {
                    if let Some((Token::Word(name), _)) = back.checked_sub(1).and_then(|name| tokens.get(name)) {
                        found.push(name.clone());
                    }
                    break;
                }
                _ => break,
            }
        }
    }
    found.sort();
    found.dedup();
    found
}

/// The name of the matrix that ends before a place, also if it is one's transpose or copy.
fn before(tokens: &[(Token, usize)], at: usize) -> Option<&str> {
    let (open, close) = (at.checked_sub(2)?, at.checked_sub(1)?);
    if !(tokens[open].0.is_mark('(') && tokens[close].0.is_mark(')')) {
        return named(tokens.get(close));
    }
    let same = ["transpose", "adjoint", "clone", "clone_owned", "abs"];
    let call = named(tokens.get(open.checked_sub(1)?)).filter(|call| same.contains(call));
    call.and_then(|_| named(tokens.get(open.checked_sub(3)?)))
}

/// The word of a token.
fn named(token: Option<&(Token, usize)>) -> Option<&str> {
    match token {
        Some((Token::Word(word), _)) => Some(word),
        _ => None,
    }
}

/// What in a text multiplies two matrices of dynamic size.
fn products(text: &str) -> Vec<(usize, String)> {
    // tests stand at the end of a file
    let code = text.split("\nmod tests {").next().unwrap_or(text);
    let tokens = tokens(code);
    let matrices = matrices(&tokens);
    let is_one = |name: Option<&str>| name.is_some_and(|name| matrices.iter().any(|known| known == name));
    let mut found = Vec::new();
    for (at, (token, line)) in tokens.iter().enumerate() {
        match token {
            Token::Word(word) if PRODUCTS.contains(&word.as_str()) => {
                if matches!(tokens.get(at + 1), Some((Token::Mark('(') | Token::Path, _))) {
                    found.push((*line, word.clone()));
                }
            }
            Token::Mark('*') => {
                let before = before(&tokens, at);
                // the last name of a path of fields, behind `=` and `&`
                let mut next = at + 1;
                while matches!(tokens.get(next), Some((Token::Mark('=' | '&'), _))) {
                    next += 1;
                }
                while named(tokens.get(next)).is_some() && matches!(tokens.get(next + 1), Some((Token::Mark('.'), _))) {
                    if named(tokens.get(next + 2)).is_none()
                        || matches!(tokens.get(next + 3), Some((Token::Mark('('), _)))
                    {
                        break;
                    }
                    next += 2;
                }
                // an index takes one number out of it
                let whole = !matches!(tokens.get(next + 1), Some((Token::Mark('['), _)));
                if is_one(before) && is_one(named(tokens.get(next))) && whole {
                    found.push((*line, "*".to_owned()));
                }
            }
            _ => {}
        }
    }
    found
}

#[test]
fn no_two_matrices_of_dynamic_size_are_multiplied() {
    let mut users: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut found = String::new();
    for (file, text) in sources() {
        let uses = tokens(&text).into_iter().find_map(|(token, line)| match token {
            Token::Word(word) if DYNAMIC.contains(&word.as_str()) => Some((word, line)),
            _ => None,
        });
        let Some((word, line)) = uses else { continue };
        users.entry(file.clone()).or_default().push(format!("    {file}:{line}: {word}\n"));
        for (line, what) in products(&text) {
            found += &format!("    {file}:{line}: {what}\n");
        }
    }
    found += &against(&users, READ);
    assert!(found.is_empty(), "\n{found}");
}

#[test]
fn a_product_of_two_matrices_is_found() {
    let head = "struct S { one: DMatrix<f64>, v: DVector<f64> }\nfn f(two: &DMatrix<f64>, s: &S) {\nlet three = DMatrix::zeros(2, 2);\n";
    for product in [
        "s.one * two",
        "&s.one * &three",
        "two * &s.one",
        "two.transpose() * &s.one",
        "s.one.mul_to(two, x)",
        "x.gemm(1.0, &s.one, two, 0.0)",
        "s.one *= two",
    ] {
        assert_eq!(products(&format!("{head}{product};")).len(), 1, "{product}");
    }
    for harmless in
        ["two * &s.v", "2.0 * two[(0, 0)] * three[(0, 0)]", "s.one[(0, 0)] * 3.0", "v.gemv(1.0, two, &s.v, 0.0)"]
    {
        assert_eq!(products(&format!("{head}{harmless};")), [], "{harmless}");
    }
}
