//! `onescan run --watch`: variables of the soft PLC by path, and no other bits for that.

use crate::typed::{digests, run_shear, scenario, typed};

fn reported(words: &[&str]) -> String {
    let mut all = vec!["run", "."];
    all.extend_from_slice(words);
    let said = typed(&scenario("shear"), &all);
    // What a run takes of the wall's clock, and its digest, are not the subject here.
    let steady = said.out.lines().filter(|line| line.starts_with("  ") && !line.starts_with("  digest"));
    let steady = steady.fold(String::new(), |text, line| text + line + "\n");
    format!("onescan run . {}\n{steady}{}exit code {}\n", words.join(" "), said.err, said.code.unwrap_or(-1))
}

#[test]
fn watching_changes_no_bit_and_prints_the_last_values() {
    let (plain, said) = run_shear(&["--until", "2s"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let watch = ["--until", "2s", "--runs", "2", "--watch", "Shear.Strokes", "--watch", "Shear.ixUp"];
    let (watched, said) = run_shear(&watch);
    assert_eq!(said.code, Some(0), "{said:?}");
    let digests = digests(&[plain, watched.clone()].concat());
    assert!(digests.iter().all(|digest| *digest == digests[0]), "{digests:?}");
    let values = &watched[0]["watched"]["values"];
    assert_eq!(values.as_array().map(Vec::len), Some(2), "{values}");
    assert_eq!((&values[0]["path"], &values[1]["path"]), (&"Shear.Strokes".into(), &"Shear.ixUp".into()));
    assert_eq!(values, &watched[1]["watched"]["values"]);
}

#[test]
fn values_and_changes_are_printed_by_path() {
    let end = reported(&["--until", "1s", "--watch", "Shear.Strokes=hex", "--watch", "Shear.Strokes.1"]);
    let change =
        reported(&["--until", "1s", "--watch", "Shear.Strokes=bin", "--watch", "Shear.ixUp", "--watch-on", "change"]);
    insta::assert_snapshot!(format!("{end}\n{change}"));
}

#[test]
fn what_cannot_be_watched_is_reported() {
    let cases = [
        reported(&["--watch", "Shear.Stroke"]),
        reported(&["--watch", "nobody:Shear.Strokes"]),
        reported(&["--watch", "Shear.Strokes=octal"]),
        reported(&["--watch", "Shear.Strokes", "--transport", "tcp"]),
    ];
    insta::assert_snapshot!(cases.join("\n"));
}
