//! Signals that are structures: `[structures]` names a structure and its members once, and a signal of that
//! structure stands for one signal a member, as a PLC's data block has it.
//!
//! A member is written `Name: TYPE`, its type elementary or another structure. Members named `_` are room in a
//! block that nobody uses: they are not signals.

use std::collections::BTreeMap;
use std::ops::Range;

use onescan_base::did_you_mean;
use onescan_base::field::{DEPTH_MAX, Field, ROOM};
use onescan_server::signal::{SignalName, SignalType};

use crate::arrays::{Wrong, names};
use crate::file::{DeclaredSignal, ScenarioFile, SignalFile};
use toml::Spanned;

/// Writes each declared signal out: arrays as their elements, structures as their members.
///
/// # Errors
/// A name that is declared twice, an unknown structure, a member that is not a `Name: TYPE`, a signal with both a type
/// and a structure or neither.
pub(crate) fn expand(file: &mut ScenarioFile) -> Result<(), Wrong> {
    let mut all = BTreeMap::new();
    let expansion = Expansion { structures: &file.structures };
    for (name, signal) in std::mem::take(&mut file.declared) {
        for one in names(name.as_str(), signal.span())? {
            for (member, ty) in expansion.of(&one, &signal)? {
                let signal = Spanned::new(signal.span(), written_out(signal.get_ref(), ty));
                if all.insert(member.clone(), signal.clone()).is_some() {
                    return Err(Wrong::at(format!("signal `{member}` is declared twice"), signal.span()));
                }
            }
        }
    }
    file.signals = all;
    Ok(())
}

fn written_out(declared: &DeclaredSignal, ty: SignalType) -> SignalFile {
    let DeclaredSignal { writer, unit, about, names, .. } = declared.clone();
    SignalFile { ty, writer, unit, about, names }
}

/// The structures that signals may have.
struct Expansion<'f> {
    structures: &'f BTreeMap<String, Vec<String>>,
}

impl Expansion<'_> {
    /// The elementary signals of a declared one.
    fn of(
        &self,
        name: &SignalName,
        declared: &Spanned<DeclaredSignal>,
    ) -> Result<Vec<(SignalName, SignalType)>, Wrong> {
        let place = declared.span();
        let signal = declared.get_ref();
        match (signal.ty, &signal.structure) {
            (Some(ty), None) => Ok(vec![(name.clone(), ty)]),
            (None, Some(structure)) => {
                let one_type = ["unit", "names"].into_iter().zip([signal.unit.is_some(), !signal.names.is_empty()]);
                if let Some((key, _)) = one_type.into_iter().find(|(_, written)| *written) {
                    return Err(Wrong::at(format!("signal `{name}` is a structure, which has no `{key}`"), place));
                }
                let mut members = Vec::new();
                self.members(name.as_str(), structure.get_ref(), &structure.span(), 0, &mut members)?;
                Ok(members)
            }
            (Some(_), Some(_)) => Err(Wrong::at(format!("signal `{name}` has both `type` and `structure`"), place)),
            (None, None) => {
                let help = "write `type = \"BOOL\"`, or a `structure` of `[structures]`".to_owned();
                Err(Wrong { help: Some(help), ..Wrong::at(format!("signal `{name}` has no `type`"), place) })
            }
        }
    }

    fn members(
        &self,
        prefix: &str,
        structure: &str,
        place: &Range<usize>,
        depth: u32,
        found: &mut Vec<(SignalName, SignalType)>,
    ) -> Result<(), Wrong> {
        let wrong = |message: String| Wrong::at(message, place.clone());
        if depth == DEPTH_MAX {
            return Err(wrong(format!(
                "`{structure}` lies in more than {DEPTH_MAX} structures; does it contain itself?"
            )));
        }
        let Some(fields) = self.structures.get(structure) else {
            let help = did_you_mean(structure, self.structures.keys().map(String::as_str));
            return Err(Wrong { help, ..wrong(format!("`{structure}` is not a structure of `[structures]`")) });
        };
        for field in fields {
            let Some(Field { name: member, ty }) = Field::parse(field) else {
                return Err(wrong(format!("member `{field}` of structure `{structure}` is not `Name: TYPE`")));
            };
            if member == ROOM {
                continue;
            }
            let path = format!("{prefix}.{member}");
            match ty.parse::<SignalType>() {
                Ok(ty) => {
                    let name = SignalName::new(path).map_err(|bad| wrong(bad.to_string()))?;
                    found.push((name, ty));
                }
                Err(_) if self.structures.contains_key(ty) => self.members(&path, ty, place, depth + 1, found)?,
                Err(unknown) => {
                    let help = did_you_mean(ty, self.structures.keys().map(String::as_str));
                    let message = format!("member `{member}` of structure `{structure}`: {unknown}");
                    return Err(Wrong { help, ..wrong(message) });
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scenario(rest: &str) -> ScenarioFile {
        let head = "version = 1\nstep = \"10ms\"\nuntil = \"1s\"\n[clients]\n";
        toml::from_str(&format!("{head}{rest}")).expect("a scenario")
    }

    fn expanded(rest: &str) -> Result<Vec<(String, String)>, String> {
        let mut file = scenario(rest);
        expand(&mut file)
            .map_err(|wrong| [Some(wrong.message), wrong.help].into_iter().flatten().collect::<Vec<_>>().join("; "))?;
        Ok(file.signals.iter().map(|(name, signal)| (name.to_string(), signal.get_ref().ty.to_string())).collect())
    }

    const STRUCTURES: &str = "[structures]\nPair = [\"Left: REAL\", \"_: BYTE\", \"Right: REAL\"]\n\
                              Axis = [\"Execute: BOOL\", \"Ends: Pair\"]\nLoop = [\"In: Loop\"]\nBad = [\"x\"]\n";

    #[test]
    fn a_structure_stands_for_its_members_and_an_array_for_its_elements() {
        let text = format!("{STRUCTURES}[signals]\n\"A[0..1]\" = {{ structure = \"Axis\", writer = \"plc\" }}\n");
        let names: Vec<_> =
            expanded(&text).expect("signals").into_iter().map(|(name, ty)| format!("{name}: {ty}")).collect();
        let of = |i: u8| {
            let name = |member: &str| format!("A[{i}].{member}");
            [name("Ends.Left: REAL"), name("Ends.Right: REAL"), name("Execute: BOOL")]
        };
        assert_eq!(names, [of(0), of(1)].concat());
    }

    #[test]
    fn what_is_wrong_is_named() {
        let one = |signal: &str| {
            expanded(&format!("{STRUCTURES}[signals]\nA = {{ {signal}, writer = \"plc\" }}\n")).expect_err(signal)
        };
        let wrong: Vec<_> = [
            "about = \"nothing\"",
            "structure = \"Axes\"",
            "structure = \"Loop\"",
            "structure = \"Bad\"",
            "structure = \"Axis\", type = \"BOOL\"",
            "structure = \"Axis\", unit = \"mm\"",
        ]
        .map(one)
        .to_vec();
        insta::assert_snapshot!(wrong.join("\n"), @r#"
        signal `A` has no `type`; write `type = "BOOL"`, or a `structure` of `[structures]`
        `Axes` is not a structure of `[structures]`; did you mean `Axis`?
        `Loop` lies in more than 8 structures; does it contain itself?
        member `x` of structure `Bad` is not `Name: TYPE`
        signal `A` has both `type` and `structure`
        signal `A` is a structure, which has no `unit`
        "#);
    }
}
