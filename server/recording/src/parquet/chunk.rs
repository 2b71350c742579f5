//! Encoded values as a column chunk of a row group.

use bytes::Bytes;
use parquet::basic::{Compression, Encoding};
use parquet::column::page::{CompressedPage, Page, PageWriter};
use parquet::column::writer::ColumnCloseResult;
use parquet::errors::Result;
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::writer::{SerializedPageWriter, TrackedWrite};
use parquet::schema::types::ColumnDescPtr;

use super::encode::Encoded;

/// Pages shorter than this are not worth compressing.
const COMPRESS_MIN: usize = 256;
/// Bytes of a long page that are tried first: noise and digests do not shrink.
const TRIED: usize = 4096;

/// The bytes compressed; nothing if that saves none, or less than an eighth of the first part of many.
fn shrunk(bytes: &[u8], snappy: &mut snap::raw::Encoder) -> Option<Vec<u8>> {
    if let Some(tried) = bytes.get(..TRIED).filter(|_| bytes.len() > 4 * TRIED) {
        snappy.compress_vec(tried).ok().filter(|shorter| shorter.len() < TRIED / 8 * 7)?;
    }
    snappy.compress_vec(bytes).ok().filter(|shorter| shorter.len() < bytes.len())
}

/// A chunk's bytes and what the footer says of it.
pub(super) fn chunk(
    descriptor: ColumnDescPtr,
    encoded: Encoded,
    rows: usize,
    snappy: &mut snap::raw::Encoder,
) -> Result<(Bytes, ColumnCloseResult)> {
    let compressed = match (&encoded.dictionary, encoded.encoding) {
        (None, Encoding::PLAIN) if encoded.data.len() >= COMPRESS_MIN => shrunk(&encoded.data, snappy),
        _ => None,
    };
    let codec = if compressed.is_some() { Compression::SNAPPY } else { Compression::UNCOMPRESSED };
    let mut encodings = vec![Encoding::RLE, encoded.encoding];
    let mut sink = TrackedWrite::new(Vec::new());
    let mut pages = SerializedPageWriter::new(&mut sink);
    let mut uncompressed_size = 0;
    let dictionary_offset = match encoded.dictionary {
        Some((entries, num_values)) => {
            let length = entries.len();
            let page =
                Page::DictionaryPage { buf: entries.into(), num_values, encoding: Encoding::PLAIN, is_sorted: false };
            encodings.push(Encoding::PLAIN);
            uncompressed_size += pages.write_page(CompressedPage::new(page, length))?.uncompressed_size;
            Some(0)
        }
        None => None,
    };
    let length = encoded.data.len();
    let page = Page::DataPage {
        buf: compressed.unwrap_or(encoded.data).into(),
        num_values: rows as u32,
        encoding: encoded.encoding,
        def_level_encoding: Encoding::RLE,
        rep_level_encoding: Encoding::RLE,
        statistics: None,
    };
    let spec = pages.write_page(CompressedPage::new(page, length))?;
    uncompressed_size += spec.uncompressed_size;
    let bytes = sink.into_inner()?;
    let metadata = ColumnChunkMetaData::builder(descriptor)
        .set_compression(codec)
        .set_encodings(encodings)
        .set_num_values(rows as i64)
        .set_total_compressed_size(bytes.len() as i64)
        .set_total_uncompressed_size(uncompressed_size as i64)
        .set_data_page_offset(spec.offset as i64)
        .set_dictionary_page_offset(dictionary_offset)
        .build()?;
    let close = ColumnCloseResult {
        bytes_written: bytes.len() as u64,
        rows_written: rows as u64,
        metadata,
        bloom_filter: None,
        column_index: None,
        offset_index: None,
    };
    Ok((bytes.into(), close))
}
