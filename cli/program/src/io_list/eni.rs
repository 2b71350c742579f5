//! EtherCAT Network Information (ETG.2100): the process images of an EtherCAT master.

use std::path::Path;

use super::collect::{Collected, Entry};
use super::error::ListError;
use super::flatten::{Nothing, elementary};
use super::point::Direction;
use super::xml::{Element, document, text};
use super::{IoList, ListKind};

/// Reads the process image.
///
/// # Errors
/// It is no ENI, or has no image.
pub fn read(path: &Path, bytes: &[u8]) -> Result<IoList, ListError> {
    let text = text(path, bytes)?;
    let document = document(path, &text)?;
    let root = Element::root(&document);
    let other = |what: String| {
        let help = Some("export the configuration file (ENI) of the EtherCAT master".to_owned());
        ListError::Other { file: path.display().to_string(), what, help }
    };
    if root.name() != "EtherCATConfig" {
        return Err(other(format!("<{}> is no EtherCAT Network Information", root.name())));
    }
    let image = root.below("ProcessImage").next().ok_or_else(|| other("it has no <ProcessImage>".to_owned()))?;
    let mut collected = Collected::of(path);
    // Inputs of the master are what slaves send: the PLC reads them.
    for (area, direction) in [("Inputs", Direction::Input), ("Outputs", Direction::Output)] {
        for variable in image.all(area).flat_map(|area| area.all("Variable")) {
            let name = variable.text_of("Name").unwrap_or_default();
            let bits = bit_string(&variable.text_of("BitSize").unwrap_or_default());
            let ty = match variable.text_of("DataType") {
                // A type of the device's own, in as many bits as a type of the PLC's.
                Some(ty) if elementary(&ty).is_none() && !ty.contains('[') && !bits.is_empty() => bits.into(),
                Some(ty) => ty,
                // The type may be left out.
                None => bits.into(),
            };
            let (comment, line) = (variable.text_of("Comment"), Some(variable.line()));
            let (address, comment) = (None, comment.as_deref());
            collected.take(&Entry { name: &name, ty: &ty, direction, address, comment, line }, &Nothing)?;
        }
    }
    Ok(collected.list(ListKind::Eni))
}

fn bit_string(bits: &str) -> &'static str {
    match bits {
        "1" => "BOOL",
        "8" => "BYTE",
        "16" => "WORD",
        "32" => "DWORD",
        "64" => "LWORD",
        _ => "",
    }
}
