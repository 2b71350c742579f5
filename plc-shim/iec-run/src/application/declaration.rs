//! Where variables are declared.

use super::Application;
use onescan_iec::ir;

/// A variable as it is declared.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Declaration {
    /// Its unit; empty for a global one.
    pub unit: String,
    pub name: String,
    pub file: String,
    /// Its line, from 1.
    pub line: u32,
    /// From its name to the semicolon, line by line.
    pub rows: Vec<String>,
}

impl Application {
    /// All variables that are declared in the user's own files: globals first, then those of each unit.
    pub fn declarations(&self) -> Vec<Declaration> {
        let checked = &self.inner.checked;
        let resources = checked.configuration.iter().flat_map(|configuration| &configuration.resources);
        let global = checked.globals.iter().chain(resources.flat_map(|resource| &resource.globals));
        let global = global.map(|variable| (String::new(), variable));
        let own = checked.pous.values().flat_map(|pou| pou.variables.iter().map(|each| (pou.name.clone(), each)));
        let of_user = |(_, variable): &(String, &ir::Variable)| !self.inner.library.contains(&variable.span.file);
        global.chain(own).filter(of_user).map(|(unit, variable)| self.declaration(unit, variable)).collect()
    }

    fn declaration(&self, unit: String, variable: &ir::Variable) -> Declaration {
        let (file, place) = self.sources().locate(variable.span);
        let whole = self.sources().get(variable.span.file).map(|file| file.text().as_ref());
        let rest = whole.and_then(|text| text.get(variable.span.start as usize..)).unwrap_or_default();
        let whole = rest.split(';').next().unwrap_or_default();
        let rows = whole.lines().map(|row| row.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
        Declaration { unit, name: variable.name.clone(), file: file.to_owned(), line: place.line, rows }
    }
}
