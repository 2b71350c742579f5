//! An animated WebP around pictures that are WebP each: the container, a RIFF, is all that is made here
//! (<https://developers.google.com/speed/webp/docs/riff_container>). Numbers are little endian, and a chunk of an odd length is
//! filled up with a zero.

use thiserror::Error;

use super::config::Size;

const RIFF: &[u8] = b"RIFF";
const WEBP: &[u8] = b"WEBP";
/// A picture's own data: lossy, lossless, and what one sees through.
const DATA: [&[u8; 4]; 3] = [b"VP8 ", b"VP8L", b"ALPH"];
/// The flag of a file that is animated.
const ANIMATED: u8 = 0x02;
/// The flag of a file with pictures that one sees through.
const TRANSPARENT: u8 = 0x10;
/// A picture replaces what was there, and is not mixed with it.
const REPLACES: u8 = 0x02;

/// Why pictures are not a film.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum NoFilm {
    #[error("picture {0} of the film is not a WebP")]
    Picture(usize),
    #[error("the film is longer than a WebP can be: 4 GiB")]
    Long,
}

/// A film of pictures of one size, each shown so long; it begins again at its end.
pub(super) fn film(pictures: &[Vec<u8>], size: Size, shown_ms: u32) -> Result<Vec<u8>, NoFilm> {
    let mut frames = Vec::new();
    let mut is_transparent = false;
    for (number, picture) in pictures.iter().enumerate() {
        let data = data_of(picture).ok_or(NoFilm::Picture(number))?;
        is_transparent |= data.iter().any(|(name, _)| name == b"ALPH");
        frames.extend(chunk(*b"ANMF", &frame(&data, size, shown_ms)?)?);
    }
    let flags = ANIMATED | if is_transparent { TRANSPARENT } else { 0 };
    let mut head = vec![flags, 0, 0, 0];
    head.extend(sides(size));
    let mut body = WEBP.to_vec();
    body.extend(chunk(*b"VP8X", &head)?);
    // Behind all pictures nothing, and again and again.
    body.extend(chunk(*b"ANIM", &[0xff, 0xff, 0xff, 0xff, 0, 0])?);
    body.extend(frames);
    let mut whole = RIFF.to_vec();
    whole.extend(u32::try_from(body.len()).map_err(|_| NoFilm::Long)?.to_le_bytes());
    whole.extend(body);
    Ok(whole)
}

/// A picture of a film: where it is, how large, how long, and its data.
fn frame(data: &[([u8; 4], &[u8])], size: Size, shown_ms: u32) -> Result<Vec<u8>, NoFilm> {
    let mut frame = vec![0; 6];
    frame.extend(sides(size));
    frame.extend(&shown_ms.to_le_bytes()[..3]);
    frame.push(REPLACES);
    for (name, content) in data {
        frame.extend(chunk(*name, content)?);
    }
    Ok(frame)
}

/// The sides of a picture, each less one, in 24 bits.
fn sides(Size { width, height }: Size) -> Vec<u8> {
    [width, height].iter().flat_map(|side| side.saturating_sub(1).to_le_bytes()[..3].to_vec()).collect()
}

fn chunk(name: [u8; 4], content: &[u8]) -> Result<Vec<u8>, NoFilm> {
    let length = u32::try_from(content.len()).map_err(|_| NoFilm::Long)?;
    let mut chunk = name.to_vec();
    chunk.extend(length.to_le_bytes());
    chunk.extend(content);
    chunk.extend(std::iter::repeat_n(0, content.len() % 2));
    Ok(chunk)
}

/// The chunks of a picture that are its own data; nothing of what is not a WebP.
fn data_of(picture: &[u8]) -> Option<Vec<([u8; 4], &[u8])>> {
    let head = picture.get(..12)?;
    if !head.starts_with(RIFF) || !head.ends_with(WEBP) {
        return None;
    }
    let mut rest = &picture[12..];
    let mut data = Vec::new();
    while let Some((name, behind)) = rest.split_first_chunk::<4>() {
        let (length, behind) = behind.split_first_chunk::<4>()?;
        let length = u32::from_le_bytes(*length) as usize;
        let content = behind.get(..length)?;
        if DATA.contains(&name) {
            data.push((*name, content));
        }
        rest = behind.get(length + length % 2..).unwrap_or_default();
    }
    (!data.is_empty()).then_some(data)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Size = Size { width: 640, height: 360 };

    fn picture(data: &[u8]) -> Vec<u8> {
        let chunk = chunk(*b"VP8 ", data).expect("short");
        [RIFF, &(chunk.len() as u32 + 4).to_le_bytes(), WEBP, &chunk].concat()
    }

    #[test]
    fn pictures_stand_in_their_order_with_their_times() {
        let film = film(&[picture(b"one"), picture(b"four")], SIZE, 100).expect("pictures");
        assert_eq!(&film[..4], RIFF);
        assert_eq!(u32::from_le_bytes([film[4], film[5], film[6], film[7]]) as usize, film.len() - 8);
        assert_eq!(&film[8..16], b"WEBPVP8X");
        // 640 x 360, each less one
        assert_eq!(film[20..30], [ANIMATED, 0, 0, 0, 0x7f, 0x02, 0, 0x67, 0x01, 0]);
        let at = film.windows(4).position(|four| four == b"ANMF").expect("a picture");
        // 16 bytes of its own, 8 of the chunk's head, 3 and one that fills up
        assert_eq!(film[at + 4..at + 8], 28_u32.to_le_bytes());
        assert_eq!(film[at + 8 + 12..at + 8 + 16], [100, 0, 0, REPLACES]);
        assert_eq!(&film[at + 24..at + 28], b"VP8 ");
        assert_eq!(film.windows(4).filter(|four| *four == b"ANMF").count(), 2);
    }

    #[test]
    fn what_is_not_a_picture_is_named() {
        let cut = picture(b"four")[..18].to_vec();
        for wrong in [b"PNG".to_vec(), cut, Vec::new()] {
            assert_eq!(film(&[picture(b"one"), wrong], SIZE, 100), Err(NoFilm::Picture(1)));
        }
    }
}
