//! Other programs in soft PLCs: what a case says of them, and the sources with it.

use std::ops::Range;
use std::path::PathBuf;

use onescan_iec::Input;
use onescan_iec::source::LineColumn;
use onescan_server::signal::{ClientName, did_you_mean};
use toml::Spanned;

use super::wrong_case;
use crate::case::{Applied, Catalogue, CodeAt, CodeChange, CodeFile};
use crate::error::ScenarioError;
use crate::file::ClientFile;
use crate::load::Scenario;

impl Scenario {
    /// What an entry says of a program.
    pub(super) fn code(&self, catalogue: &Catalogue, entry: &Spanned<CodeFile>) -> Result<CodeAt, ScenarioError> {
        let CodeFile { client, source, by, line, column, was, is } = entry.get_ref();
        let is_plc = |client: &ClientFile| matches!(client, ClientFile::SoftPlc { .. });
        let what = ("soft PLC", "whose program could be another", entry.span());
        let client = self.chosen(catalogue, client.as_ref(), is_plc, what)?;
        if let Some(ClientFile::SoftPlc { sources, .. }) = self.client(client.as_str())
            && !sources.contains(source.get_ref())
        {
            let message = format!("`{client}` has no source `{}`", source.get_ref());
            let help = did_you_mean(source.get_ref(), sources.iter().map(String::as_str));
            return Err(catalogue.wrong(message, Some(source.span()), help));
        }
        let change = match (by, line, column, was, is) {
            (Some(by), None, None, None, None) => CodeChange::File(by.get_ref().clone()),
            (None, Some(line), Some(column), Some(was), Some(is)) if !was.is_empty() => {
                let at = LineColumn { line: *line, column: *column };
                CodeChange::Text { at, was: was.clone(), is: is.clone() }
            }
            _ => {
                let message = format!("what is another in `{}` is not said, or said twice", source.get_ref());
                let help = "write `by`, a file in its place; or `line`, `column`, `was` and `is` of a text".to_owned();
                return Err(catalogue.wrong(message, Some(entry.span()), Some(help)));
            }
        };
        Ok(CodeAt { client, source: source.get_ref().clone(), change, place: entry.span() })
    }

    /// What the case puts in the place of a source of PLC `name`, of which the last one counts: the file, and where that is
    /// said.
    pub(crate) fn source_of_case(&self, name: &ClientName, source: &str) -> Option<&str> {
        let of_source = self.code_of_case(name).filter(|at| at.source == source);
        of_source.filter_map(|at| if let CodeChange::File(by) = &at.change { Some(by.as_str()) } else { None }).last()
    }

    /// A source of PLC `name` with the texts that the case puts into it. Where one moves the text behind it, that is looked
    /// for where it stood before.
    ///
    /// # Errors
    /// A text does not stand where the case says it does.
    pub(crate) fn with_texts_of_case(
        &self,
        name: &ClientName,
        source: &str,
        input: Input,
    ) -> Result<Input, ScenarioError> {
        let Some(applied) = self.applied() else { return Ok(input) };
        let mut replaced = Vec::new();
        for at in self.code_of_case(name).filter(|at| at.source == source) {
            let CodeChange::Text { at: place, was, is } = &at.change else { continue };
            let found = input.range_of(*place, was).ok_or_else(|| {
                let LineColumn { line, column } = place;
                let message = format!("{was:?} does not stand at {source}:{line}:{column}");
                let help = "the source was changed since: look where it stands now".to_owned();
                wrong_case(applied, message, at.place.clone(), Some(help))
            })?;
            replaced.push((found, is, &at.place));
        }
        // From the end on, so that what was found stays where it is.
        replaced.sort_by_key(|(found, ..)| std::cmp::Reverse(found.start));
        if let Some([(_, _, place), _]) =
            replaced.array_windows().find(|[later, earlier]| earlier.0.end > later.0.start)
        {
            let message = format!("two texts in the place of others in {source} overlap");
            return Err(wrong_case(applied, message, Range::clone(place), Some("make one of them".to_owned())));
        }
        Ok(replaced.into_iter().fold(input, |input, (found, is, _)| input.with_replaced(found, is)))
    }

    /// What the case changes in the program of PLC `name`.
    pub(crate) fn code_of_case<'a, 'n>(
        &'a self,
        name: &'n ClientName,
    ) -> impl Iterator<Item = &'a CodeAt> + use<'a, 'n> {
        self.applied().into_iter().flat_map(|applied| &applied.code).filter(move |at| at.client == *name)
    }

    /// True if the case changes the program of a PLC.
    pub fn has_code_of_case(&self) -> bool {
        self.applied().is_some_and(|applied| !applied.code.is_empty())
    }

    /// The files that the case puts in the place of sources, as it names them.
    pub(crate) fn files_of_case(&self) -> impl Iterator<Item = PathBuf> {
        let code = self.applied().into_iter().flat_map(|applied| &applied.code);
        code.filter_map(|at| if let CodeChange::File(by) = &at.change { Some(by.into()) } else { None })
    }
}

impl Applied {
    /// What of the programs is another, by what a checkpoint calls it.
    pub(super) fn code_settings(&self) -> impl Iterator<Item = (String, String)> {
        let key = |at: &CodeAt| match &at.change {
            CodeChange::File(_) => format!("{}.{}", at.client, at.source),
            CodeChange::Text { at: LineColumn { line, column }, .. } => {
                format!("{}.{}:{line}:{column}", at.client, at.source)
            }
        };
        self.code.iter().map(move |at| (key(at), at.change.to_string()))
    }
}
