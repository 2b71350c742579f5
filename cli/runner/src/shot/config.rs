//! What a picture is to be of.

use std::path::PathBuf;
use std::str::FromStr;

use onescan_server::signal::ClientName;
use onescan_server::time::VirtualTime;
use thiserror::Error;

/// Most pixels along a side.
const PIXELS_MAX: u32 = 8192;

/// A picture that is asked for.
#[derive(Clone, Debug)]
pub struct ShotConfig {
    /// The scenario's folder or file.
    pub scenario: PathBuf,
    /// A case of it.
    pub case: Option<String>,
    /// Clients that people stand in for.
    pub operated: Vec<ClientName>,
    /// The time that is drawn.
    pub at: VirtualTime,
    /// The view of the scenario that it is drawn from; all of the machine without one.
    pub view: Option<String>,
    /// The picture, a PNG.
    pub out: PathBuf,
    pub size: Size,
    pub theme: Theme,
}

/// A size in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    pub width: u32,
    pub height: u32,
}

/// Why a text is no [`Size`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("a size is written as `1280x720`, with 1 to {PIXELS_MAX} pixels along a side")]
pub struct NoSize;

impl FromStr for Size {
    type Err = NoSize;

    fn from_str(text: &str) -> Result<Self, NoSize> {
        let (width, height) = text.split_once('x').ok_or(NoSize)?;
        let side = |text: &str| text.parse().ok().filter(|side| (1..=PIXELS_MAX).contains(side)).ok_or(NoSize);
        Ok(Self { width: side(width)?, height: side(height)? })
    }
}

/// The colours of the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Theme {
    #[default]
    Light,
    /// As a control room at night.
    Dark,
}

impl Theme {
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Light => "light",
            Self::Dark => "dark",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_two_numbers() {
        assert_eq!("1280x720".parse(), Ok(Size { width: 1280, height: 720 }));
        for text in ["1280", "0x10", "10x0", "9000x10", "-1x1", "1x", "x", "1x1x1", ""] {
            assert_eq!(text.parse::<Size>(), Err(NoSize), "{text}");
        }
    }
}
