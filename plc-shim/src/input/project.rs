//! TwinCAT's `.plcproj`: which files make up a PLC project.

use super::encoding::decode;
use super::xml;

/// Why a project cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ProjectError {
    /// It is no text.
    #[error(transparent)]
    Encoding(#[from] super::encoding::EncodingError),
    /// It is no XML.
    #[error("line {line}: {message}")]
    Xml {
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        message: String,
    },
}

/// The files that a project compiles, with `/` between folders, relative to the project's folder.
///
/// # Errors
/// It is no project.
pub fn files(bytes: &[u8]) -> Result<Vec<String>, ProjectError> {
    let (text, _) = decode(bytes)?;
    let root = xml::parse(&text).map_err(|error| {
        let before = text.get(..error.at as usize).unwrap_or("");
        ProjectError::Xml { line: before.lines().count().max(1), message: error.message }
    })?;
    let items = root.elements().filter(|group| group.name == "ItemGroup").flat_map(xml::Element::elements);
    let included = items.filter(|item| item.name == "Compile").filter_map(|item| item.attribute("Include"));
    Ok(included.map(|include| include.value.replace('\\', "/")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compiled_files_are_listed() {
        let text = br#"<?xml version="1.0" encoding="utf-8"?>
<Project xmlns="http://schemas.microsoft.com/developer/msbuild/2003">
  <ItemGroup>
    <Compile Include="POUs\MAIN.TcPOU"><SubType>Code</SubType></Compile>
    <Compile Include="PlcTask.TcTTO"/>
    <Folder Include="POUs"/>
  </ItemGroup>
</Project>"#;
        assert_eq!(files(text).expect("a project"), ["POUs/MAIN.TcPOU", "PlcTask.TcTTO"]);
    }

    #[test]
    fn what_is_no_project_is_told() {
        assert!(matches!(files(b"<Project>\n<ItemGroup></Project>"), Err(ProjectError::Xml { line: 2, .. })));
        assert!(files(b"\0\0").is_err());
    }
}
