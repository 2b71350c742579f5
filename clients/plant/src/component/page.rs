//! A kind of component as a page for people, in Markdown.

use std::fmt::Write as _;

use super::kind::{Dependence, Form, Frames, Kind, Parameter, Signal, unit};
use super::library::kinds;

/// The page of a kind.
pub fn page(kind: &Kind) -> String {
    let mut page = format!("## {}\n\n{}.\n\n", kind.name, kind.summary.trim_end_matches('.'));
    for line in kind.formula {
        // a String grows without fail
        let _ = writeln!(page, "    {line}");
    }
    // the equations of a kind of the user's own are its source
    let gap = if kind.formula.is_empty() { "" } else { "\n" };
    let _ = writeln!(page, "{gap}Source: {}.", kind.source);
    let bindings = kind.coupling.keys();
    if !bindings.is_empty() {
        page.push_str("\n| bound to | |\n|---|---|\n");
        for key in bindings {
            let needed = if key.needed { "" } else { " (optional)" };
            let _ = writeln!(page, "| `{}` | {}{needed} |", key.key, key.about);
        }
    }
    if !kind.parameters.is_empty() {
        page.push_str("\n| parameter | preset | unit | may be | |\n|---|---|---|---|---|\n");
        for parameter in &kind.parameters {
            let Parameter { key, about, form, preset, initial } = parameter;
            let begins = if *initial { " (at the start only)" } else { "" };
            let unit = unit(key).1.unwrap_or_default();
            let _ = writeln!(page, "| `{key}` | {preset} | {unit} | {} | {about}{begins} |", range(form));
        }
    }
    inputs(&mut page, kind);
    outputs(&mut page, &kind.outputs);
    frames(&mut page, kind.frames);
    if !kind.failures.is_empty() {
        page.push_str("\n| failure mode | |\n|---|---|\n");
    }
    for failure in &kind.failures {
        let _ = writeln!(page, "| `{}` | {} |", failure.mode, failure.about);
    }
    page
}

/// What may be written, in few words.
fn range(form: &Form) -> String {
    match form {
        Form::Number { least, most } if Form::is_any(*least, *most) => "finite".to_owned(),
        Form::Number { least, most } => format!("{least} … {most}"),
        Form::Count { least, most } => format!("{least} … {most}, whole"),
        Form::Flag => "true, false".to_owned(),
        Form::Choice(words) => words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(", "),
    }
}

fn inputs(page: &mut String, kind: &Kind) {
    if !kind.inputs.is_empty() {
        page.push_str("\n| input | type | preset | unit | |\n|---|---|---|---|---|\n");
    }
    for Signal { key, about, values, preset } in &kind.inputs {
        // An empty cell for what has no unit or no preset.
        let unit = unit(key).1.unwrap_or("");
        let preset = preset.as_ref().map_or_else(String::new, ToString::to_string);
        let _ = writeln!(page, "| `{key}` | {values} | {preset} | {unit} | {about} |");
    }
    for Signal { key, .. } in &kind.inputs {
        let by_value = kind.constant_key(key);
        if by_value != *key {
            let _ = writeln!(page, "\nA constant for the input `{key}` is written `{by_value}`.");
        }
    }
    for Dependence { inputs, on } in kind.dependences {
        let _ = writeln!(page, "\nWithout {} nothing comes of {}.", any_of(on), any_of(inputs));
    }
}

/// The keys that bind the signals of a frame together.
fn frames(page: &mut String, frames: Frames) {
    for (key, signals) in frames.by_key().into_iter().filter(|(_, signals)| !signals.is_empty()) {
        let members: Vec<_> = signals.iter().map(|signal| format!("`{}`", Frames::member(signal))).collect();
        let _ = writeln!(page, "\n`{key}` names a structure of signals with the members {}.", members.join(", "));
    }
}

/// Keys in words, as in "`run` or `reverse`".
fn any_of(keys: &[&str]) -> String {
    keys.iter().map(|key| format!("`{key}`")).collect::<Vec<_>>().join(" or ")
}

fn outputs(page: &mut String, outputs: &[Signal]) {
    if !outputs.is_empty() {
        page.push_str("\n| output | type | unit | |\n|---|---|---|---|\n");
    }
    for Signal { key, about, values, .. } in outputs {
        let unit = unit(key).1.unwrap_or_default();
        let _ = writeln!(page, "| `{key}` | {values} | {unit} | {about} |");
    }
}

/// The pages of all kinds, with a list of them in front.
pub fn catalogue() -> String {
    let mut all = String::from(
        "# The library of components\n\n\
         Made from the kinds themselves by `UPDATE_DOCS=1 cargo test -p onescan-plant catalogue`; a test holds it to \
         them.\n\n\
         A scene names a component in a table `[[component]]` with `name`, `kind`, its parameters and what it is bound \
         to. `INPUT_signal` and `OUTPUT_signal` name the session's signals; `INPUT_from = \"component.output\"` wires \
         an input to another component, and `INPUT = value` gives it a constant. An input that nobody drives has its \
         preset. A table `[[failure]]` switches a failure mode, by a signal or by virtual \
         time.\n\n| kind | |\n|---|---|\n",
    );
    for kind in kinds() {
        let _ = writeln!(all, "| [`{0}`](#{0}) | {1} |", kind.name, kind.summary);
    }
    for kind in kinds() {
        let _ = write!(all, "\n{}", page(kind));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use onescan_published::is_published;

    #[test]
    fn the_published_catalogue_is_that_of_the_kinds() {
        is_published("clients/plant/src/component/README.md", &catalogue());
    }
}
