//! What must hold of maps before a run.

use onescan_server::signal::{ClientName, did_you_mean};
use toml::Spanned;

use crate::error::Wrong;
use crate::file::{ClientFile, ScenarioFile};
use crate::map_file::MapFile;

/// Names are files' names, clients and what is shown of them fit each other.
pub(crate) fn check(file: &ScenarioFile) -> Result<(), Wrong> {
    for (index, map) in file.map.iter().enumerate() {
        let name = map.name.get_ref();
        let is_plain = |letter: char| letter.is_ascii_alphanumeric() || matches!(letter, '-' | '_');
        if name.is_empty() || !name.chars().all(is_plain) {
            let message =
                format!("`{name}` is not a name of a map: letters, digits, `-` and `_`, which name its files");
            return Err(wrong(&map.name, message, None));
        }
        if file.map[..index].iter().any(|other| other.name.get_ref() == name) {
            return Err(wrong(&map.name, format!("there are two maps `{name}`"), None));
        }
        let client = file.clients.get(map.client.get_ref()).ok_or_else(|| {
            let known = file.clients.keys().map(ClientName::as_str);
            let help = did_you_mean(map.client.get_ref().as_str(), known);
            wrong(&map.client, format!("there is no client `{}`", map.client.get_ref()), help)
        })?;
        match (client.get_ref(), &map.body, &map.variable) {
            (ClientFile::Plant { .. }, Some(_), None) => {}
            (ClientFile::SoftPlc { .. }, None, Some(variable)) => check_rows(map, variable)?,
            _ => {
                let message = format!("map `{name}` is of nothing that `{}` has", map.client.get_ref());
                let help = "give a plant's `body`, or a soft PLC's `variable` and `row`";
                return Err(wrong(&map.client, message, Some(help.to_owned())));
            }
        }
    }
    Ok(())
}

fn check_rows(map: &MapFile, variable: &Spanned<String>) -> Result<(), Wrong> {
    let row = map.row.unwrap_or(0);
    let end = map.first.saturating_add(map.points.unwrap_or(1));
    if row == 0 || end > row || map.points == Some(0) || map.rows == Some(0) {
        let message = format!("map `{}` shows elements that a row of {row} does not have", map.name.get_ref());
        return Err(wrong(variable, message, Some("`row` is how many elements one row of the array has".to_owned())));
    }
    Ok(())
}

fn wrong<T>(place: &Spanned<T>, message: String, help: Option<String>) -> Wrong {
    Wrong { message, place: place.span(), help }
}
