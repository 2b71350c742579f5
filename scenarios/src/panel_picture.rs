//! Pictures behind panels: files of the scenario, as a browser shows them.

use std::io::Read;
use std::path::{Path, PathBuf};

use onescan_base::regular::{self, Limit};

use crate::error::{ScenarioError, Wrong};
use crate::load::Scenario;
use crate::panel_file::PanelFile;
use crate::permission;

/// The largest picture, bytes: every viewer fetches it.
const SIZE_MAX: u64 = 8 << 20;

/// The picture behind a panel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PanelPicture {
    pub media: &'static str,
    pub bytes: Vec<u8>,
}

/// So much of a picture is looked at to see what it is, bytes.
const HEAD: usize = 4096;

/// The media type of what begins so. An SVG document is a text with an element `svg`.
fn media(bytes: &[u8]) -> Option<&'static str> {
    let head = bytes.get(..HEAD).unwrap_or(bytes);
    match head {
        [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n', ..] => Some("image/png"),
        [0xff, 0xd8, 0xff, ..] => Some("image/jpeg"),
        _ => {
            // The last letter of the head may be cut.
            let text = match std::str::from_utf8(head) {
                Err(error) if error.error_len().is_none() => std::str::from_utf8(&head[..error.valid_up_to()]).ok()?,
                whole => whole.ok()?,
            };
            let mut tags = text.split('<').skip(1);
            tags.any(|tag| tag.starts_with("svg")).then_some("image/svg+xml")
        }
    }
}

/// The size of a file, and its first bytes.
fn head(path: &Path) -> std::io::Result<(u64, Vec<u8>)> {
    let file = regular::open(path)?;
    let size = file.metadata()?.len();
    let mut head = Vec::with_capacity(HEAD);
    file.take(HEAD as u64).read_to_end(&mut head)?;
    Ok((size, head))
}

impl Scenario {
    /// The picture behind a panel; nothing if it has none.
    ///
    /// # Errors
    /// A file that cannot be read, may not be read, is too large or is not a picture.
    pub fn picture_behind(&self, panel: &PanelFile) -> Result<Option<PanelPicture>, ScenarioError> {
        let Some((path, media)) = self.picture_file(panel)? else { return Ok(None) };
        let unreadable = |source| ScenarioError::Unreadable { path: path.clone(), source, help: None };
        let bytes = regular::read(&path, Limit::TEXT).map_err(unreadable)?;
        Ok(Some(PanelPicture { media, bytes }))
    }

    /// The file of a panel's picture and its media type, by how it begins: scenarios are loaded often, and most of them show
    /// no panel.
    fn picture_file(&self, panel: &PanelFile) -> Result<Option<(PathBuf, &'static str)>, ScenarioError> {
        let Some(file) = &panel.picture else { return Ok(None) };
        let path = self.folder().join(file.get_ref());
        permission::granted().check(self.folder(), &path)?;
        let (size, head) =
            head(&path).map_err(|source| ScenarioError::Unreadable { path: path.clone(), source, help: None })?;
        let wrong = |message: String| {
            self.wrong_at(Wrong {
                message,
                place: file.span(),
                help: Some(format!("a picture is PNG, JPEG or SVG, of at most {} MiB", SIZE_MAX >> 20)),
            })
        };
        if size > SIZE_MAX {
            return Err(wrong(format!("`{}` is too large for a picture behind a panel", file.get_ref())));
        }
        match media(&head) {
            Some(media) => Ok(Some((path, media))),
            None => Err(wrong(format!("`{}` is not a picture that a browser shows", file.get_ref()))),
        }
    }

    /// The same scenario, if each of its panels has the picture that it names.
    pub(crate) fn pictured(self) -> Result<Self, ScenarioError> {
        for panel in &self.file().panel {
            self.picture_file(panel)?;
        }
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_known_by_how_it_begins() {
        assert_eq!(media(b"\x89PNG\r\n\x1a\n...."), Some("image/png"));
        assert_eq!(media(&[0xff, 0xd8, 0xff, 0xe0]), Some("image/jpeg"));
        assert_eq!(media(b"<?xml version=\"1.0\"?>\n<!-- a desk -->\n<svg xmlns=\"...\"/>"), Some("image/svg+xml"));
        for other in [&b"<html></html>"[..], b"GIF89a", b"", b"\xff\xfe<svg"] {
            assert_eq!(media(other), None);
        }
        let late = format!("{}<svg/>", "<a/>".repeat(5000));
        assert_eq!(media(late.as_bytes()), None, "only the head is looked at");
    }
}
