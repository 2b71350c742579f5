//! Parts read back as blocks: the very bytes that an image had.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use bytes::Bytes;
use onescan_base::regular;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::{ParquetError, Result};
use parquet::file::reader::{ChunkReader, FileReader, Length, RowGroupReader, SerializedFileReader};

use onescan_server::signal::SignalType as T;

use super::super::block::Block;
use super::super::column::Column;
use super::FIRST_STEP;
use super::guard::guarded;
use super::schema::{DIGEST_BYTES, LEADING};

/// A part: which steps it holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Part {
    pub(crate) path: PathBuf,
    pub(crate) first_step: u64,
    pub(crate) rows: u64,
}

/// A file in which reading beyond the end is an error. Where the library passes over what it does not know, it does not
/// notice the end, and a count of billions keeps it busy for minutes.
struct Ended(File);

/// Such a file, read from some place on.
struct EndedRead<R>(R);

impl Length for Ended {
    fn len(&self) -> u64 {
        Length::len(&self.0)
    }
}

impl ChunkReader for Ended {
    type T = EndedRead<<File as ChunkReader>::T>;

    fn get_read(&self, start: u64) -> Result<Self::T> {
        self.0.get_read(start).map(EndedRead)
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes> {
        // Room is made for them before they are read.
        if start.saturating_add(length as u64) > Length::len(&self.0) {
            return Err(wrong("it ends before what it says it has"));
        }
        self.0.get_bytes(start, length)
    }
}

impl<R: Read> Read for EndedRead<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self.0.read(buffer)? {
            0 if !buffer.is_empty() => Err(io::ErrorKind::UnexpectedEof.into()),
            count => Ok(count),
        }
    }
}

fn wrong(message: &str) -> ParquetError {
    ParquetError::General(message.to_owned())
}

impl Part {
    /// Reads a part's footer.
    pub(crate) fn open(path: &Path) -> io::Result<Self> {
        let file = regular::open(path)?;
        let reader = guarded(|| SerializedFileReader::new(Ended(file)))?;
        let metadata = reader.metadata().file_metadata();
        let first_step = metadata.key_value_metadata().into_iter().flatten().find(|pair| pair.key == FIRST_STEP);
        let first_step = first_step.and_then(|pair| pair.value.as_ref()?.parse().ok());
        let first_step =
            first_step.ok_or_else(|| wrong("it is not part of a recording: it does not say its first step"))?;
        let rows = u64::try_from(metadata.num_rows()).map_err(|_| wrong("it has less than no rows"))?;
        Ok(Self { path: path.to_owned(), first_step, rows })
    }

    /// Calls `each` with every block. `columns` are the signals wanted, each with its place among the
    /// recorded ones; their offsets are those of the images given.
    pub(crate) fn blocks(
        &self,
        columns: &[(usize, Column)],
        each: &mut dyn FnMut(&Block) -> io::Result<()>,
    ) -> io::Result<()> {
        let file = regular::open(&self.path)?;
        let reader = guarded(|| SerializedFileReader::new(Ended(file)))?;
        let mut block = Block { first_step: self.first_step, ..Block::default() };
        for index in 0..reader.num_row_groups() {
            let group = guarded(|| reader.get_row_group(index))?;
            let rows = usize::try_from(group.metadata().num_rows()).map_err(io::Error::other)?;
            guarded(|| fill(&mut block, group.as_ref(), rows, columns))?;
            block.ends_part = index + 1 == reader.num_row_groups();
            each(&block)?;
            block.first_step += rows as u64;
        }
        Ok(())
    }
}

fn fill(block: &mut Block, group: &dyn RowGroupReader, rows: usize, columns: &[(usize, Column)]) -> Result<()> {
    block.width = columns.iter().map(|(_, column)| column.ty.size()).sum();
    let size = rows.checked_mul(block.width).filter(|size| *size <= 1 << 32);
    let size = size.ok_or_else(|| wrong("a block is too large"))?;
    block.images.clear();
    block.images.resize(size, 0);
    block.t_v_ns.clear();
    match group.get_column_reader(1)? {
        ColumnReader::Int64ColumnReader(reader) => {
            block.t_v_ns.extend(all(reader, rows)?.into_iter().map(|t| t as u64));
        }
        _ => return Err(wrong("column `t_v_ns` is not INT64")),
    }
    block.digests.clear();
    match group.get_column_reader(2)? {
        ColumnReader::FixedLenByteArrayColumnReader(reader) => {
            for value in all(reader, rows)? {
                let digest: [u8; DIGEST_BYTES] =
                    value.data().try_into().map_err(|_| wrong("a digest has not 32 bytes"))?;
                block.digests.push(digest);
            }
        }
        _ => return Err(wrong("column `digest` is not a FIXED_LEN_BYTE_ARRAY")),
    }
    for (place, column) in columns {
        let mut put = put(block, column);
        match (group.get_column_reader(LEADING.len() + place)?, column.ty.size()) {
            (ColumnReader::BoolColumnReader(r), 1) => each(r, rows, |row, v| put(row, &[u8::from(v)])),
            (ColumnReader::Int32ColumnReader(r), size @ 1..=4) => {
                each(r, rows, |row, v| put(row, &v.to_le_bytes()[..size]))
            }
            (ColumnReader::Int64ColumnReader(r), 8) => each(r, rows, |row, v| put(row, &v.to_le_bytes())),
            (ColumnReader::FloatColumnReader(r), 4) => each(r, rows, |row, v| put(row, &v.to_le_bytes())),
            (ColumnReader::DoubleColumnReader(r), 8) => each(r, rows, |row, v| put(row, &v.to_le_bytes())),
            (ColumnReader::ByteArrayColumnReader(r), _) => {
                each(r, rows, |row, v| put(row, &text_bytes(column.ty, &String::from_utf8_lossy(v.data()))))
            }
            _ => Err(wrong(&format!("column `{}` is not as the type {} is held", column.name, column.ty))),
        }?;
    }
    Ok(())
}

/// Puts a value of `column` into the image of a row.
fn put<'b>(block: &'b mut Block, column: &Column) -> impl FnMut(usize, &[u8]) + use<'b> {
    let (width, offset, size) = (block.width, column.offset, column.ty.size());
    move |row, bytes| {
        if let Some(place) = block.images.get_mut(row * width + offset..row * width + offset + size.min(bytes.len())) {
            place.copy_from_slice(&bytes[..place.len()]);
        }
    }
}

fn all<D: DataType>(mut reader: ColumnReaderImpl<D>, rows: usize) -> Result<Vec<D::T>> {
    let mut values = Vec::new();
    while values.len() < rows {
        let (read, _, _) = reader.read_records(rows - values.len(), None, None, &mut values)?;
        if read == 0 {
            return Err(wrong("a column ends before its row group"));
        }
    }
    Ok(values)
}

fn each<D: DataType>(reader: ColumnReaderImpl<D>, rows: usize, mut put: impl FnMut(usize, D::T)) -> Result<()> {
    all(reader, rows)?.into_iter().enumerate().for_each(|(row, value)| put(row, value));
    Ok(())
}

/// A text as it lies in an image, cut to what fits.
fn text_bytes(ty: T, text: &str) -> Vec<u8> {
    if let T::Bytes(_) = ty {
        // a text of others that is not a line is an empty one
        return ty.parse_text(text).unwrap_or_else(|_| vec![0; ty.size()]);
    }
    let mut bytes = vec![0, 0];
    let count = match ty {
        T::String(capacity) => {
            let characters = text.chars().map(|c| u8::try_from(c).unwrap_or(b'?')).take(usize::from(capacity));
            bytes.extend(characters);
            bytes.len() - 2
        }
        T::Wstring(capacity) => {
            let units = text.encode_utf16().take(usize::from(capacity));
            bytes.extend(units.flat_map(u16::to_le_bytes));
            (bytes.len() - 2) / 2
        }
        T::Elementary(_) | T::Bytes(_) => 0,
    };
    bytes[..2].copy_from_slice(&(count as u16).to_le_bytes());
    bytes.resize(ty.size().max(2), 0);
    bytes
}

#[cfg(test)]
mod tests {
    use std::io::{Seek, SeekFrom, Write};
    use std::sync::Arc;

    use super::super::ParquetFile;
    use super::*;

    /// The head of a page of a kind that nobody writes, with a list of 2³¹ - 1 numbers in it that nobody knows.
    const ENDLESS: [u8; 15] =
        [0x15, 0x02, 0x15, 0x00, 0x15, 0x00, 0x4c, 0x19, 0xf7, 0xff, 0xff, 0xff, 0xff, 0x07, 0x00];

    /// A part of two rows in a folder, and where the pages of its times begin and end.
    fn two_rows(folder: &Path) -> (PathBuf, u64, u64) {
        let path = folder.join("part-000001.parquet");
        let block = Block { t_v_ns: vec![0, 10], digests: vec![[7; 32]; 2], ..Block::default() };
        let mut file = ParquetFile::new(File::create(&path).unwrap(), Arc::from([]), 0).unwrap();
        file.rows(&block).unwrap();
        file.finish().unwrap();
        let reader = SerializedFileReader::new(File::open(&path).unwrap()).unwrap();
        let (at, length) = reader.metadata().row_group(0).column(1).byte_range();
        (path, at, length)
    }

    fn count(part: &Part) -> io::Result<usize> {
        let mut rows = 0;
        part.blocks(&[], &mut |block| {
            rows += block.rows();
            Ok(())
        })
        .map(|()| rows)
    }

    #[test]
    fn no_byte_of_a_page_makes_the_library_panic() {
        let folder = tempfile::tempdir().unwrap();
        let (path, at, length) = two_rows(folder.path());
        let part = Part::open(&path).unwrap();
        let whole = std::fs::read(&path).unwrap();
        let mut changed = std::fs::OpenOptions::new().write(true).open(&path).unwrap();
        let mut refused = 0;
        for place in at..at + length.min(40) {
            for value in 0..=255_u8 {
                changed.seek(SeekFrom::Start(place)).unwrap();
                changed.write_all(&[value]).unwrap();
                refused += u32::from(count(&part).is_err());
            }
            changed.seek(SeekFrom::Start(place)).unwrap();
            changed.write_all(&whole[place as usize..=place as usize]).unwrap();
        }
        assert!(refused > 0 && count(&part).unwrap() == 2, "{refused}");
    }

    #[test]
    fn what_goes_on_beyond_the_end_is_refused_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let (path, at, _) = two_rows(folder.path());
        assert_eq!(count(&Part::open(&path).unwrap()).unwrap(), 2);
        let mut changed = std::fs::OpenOptions::new().write(true).open(&path).unwrap();
        changed.seek(SeekFrom::Start(at)).unwrap();
        changed.write_all(&ENDLESS).unwrap();
        assert!(count(&Part::open(&path).unwrap()).is_err());
    }
}
