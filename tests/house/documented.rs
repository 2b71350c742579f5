//! What readers of an interface need: a public function says what it gives, and a public number its unit.

use crate::laws::sources;

/// Ends of names that are units, as they are written in names: `speed_m_s`, `inertia_kg_m2`.
const UNITS: &[&str] = &[
    "1_min", "a", "bar", "deg", "degc", "h", "hz", "j", "k", "kg", "kg_m2", "l_min", "m", "m2", "m3", "m_s", "m_s2",
    "m_s3", "min", "mm", "ms", "n", "n_m", "n_s_m", "nm", "nm_rad", "nm_s_rad", "ns", "pa", "per_hour", "percent",
    "rad", "rad_s", "rad_s2", "ratio", "s", "us", "v", "w", "w_k",
];

/// The lines of a source that the product compiles.
fn lines(text: &str) -> Vec<&str> {
    text.lines().take_while(|line| !line.starts_with("#[cfg(test)]")).collect()
}

/// True if the item that begins in a line has a doc, above its attributes.
fn is_documented(lines: &[&str], at: usize) -> bool {
    let above = lines[..at].iter().rev().map(|line| line.trim_start());
    let mut above = above.skip_while(|line| line.starts_with("#[") || line.ends_with(")]"));
    above.next().is_some_and(|line| line.starts_with("///"))
}

fn is_function(line: &str) -> bool {
    let rest = line.trim_start().strip_prefix("pub ");
    let words = rest.into_iter().flat_map(str::split_whitespace);
    words.into_iter().find(|word| !["const", "async"].contains(word)) == Some("fn")
}

/// The name of a public field that is a number or numbers.
fn number(line: &str) -> Option<&str> {
    let (name, ty) = line.trim_start().strip_prefix("pub ")?.split_once(": ")?;
    let ty = ty.trim_start_matches("Option<").trim_start_matches('[');
    (ty.starts_with("f64") || ty.starts_with("f32")).then_some(name)
}

fn has_unit(name: &str) -> bool {
    UNITS.iter().any(|unit| name == *unit || name.strip_suffix(unit).is_some_and(|before| before.ends_with('_')))
}

/// The places in a source whose item begins like that and has no doc.
fn undocumented(file: &str, text: &str, is_such: impl Fn(&str) -> bool) -> Vec<String> {
    let lines = lines(text);
    let such = (0..lines.len()).filter(|at| is_such(lines[*at]) && !is_documented(&lines, *at));
    such.map(|at| format!("    {file}:{}: {}", at + 1, lines[at].trim())).collect()
}

#[test]
fn public_functions_say_what_they_give() {
    let found: Vec<String> = sources().flat_map(|(file, text)| undocumented(&file, &text, is_function)).collect();
    assert!(found.is_empty(), "without a doc:\n{}", found.join("\n"));
}

#[test]
fn public_numbers_have_a_unit() {
    let is_bare = |line: &str| number(line).is_some_and(|name| !has_unit(name));
    let found: Vec<String> = sources().flat_map(|(file, text)| undocumented(&file, &text, is_bare)).collect();
    assert!(found.is_empty(), "neither in the name nor in a doc:\n{}", found.join("\n"));
}

#[test]
fn what_is_not_documented_is_found() {
    let text = "/// Gives.\n#[must_use]\npub fn a() {}\npub const fn b() {}\nfn c() {}\n    pub speed_m_s: f64,\n    pub x: f64,\n";
    assert_eq!(undocumented("f", text, is_function), ["    f:4: pub const fn b() {}"]);
    let is_bare = |line: &str| number(line).is_some_and(|name| !has_unit(name));
    assert_eq!(undocumented("f", text, is_bare), ["    f:7: pub x: f64,"]);
}
