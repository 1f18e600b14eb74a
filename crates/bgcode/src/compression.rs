//! Data of blocks, compressed and back.

use std::io::{Read, Write};

use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;

use crate::format::Compression;
use crate::heatshrink;

/// Compresses the data of a block.
pub(crate) fn compress(data: Vec<u8>, compression: Compression) -> Vec<u8> {
    match compression {
        Compression::None => data,
        Compression::Deflate => {
            let mut encoder = ZlibEncoder::new(Vec::new(), flate2::Compression::default());
            let done = encoder.write_all(&data).and_then(|()| encoder.finish());
            done.expect("writing to memory does not fail")
        }
        Compression::Heatshrink11 => heatshrink::compress(&data, 11),
        Compression::Heatshrink12 => heatshrink::compress(&data, 12),
    }
}

/// Undoes [`compress`] for data of a known size.
///
/// # Errors
/// What is wrong with the data.
pub(crate) fn decompress(
    data: Vec<u8>,
    compression: Compression,
    size: usize,
) -> Result<Vec<u8>, &'static str> {
    match compression {
        Compression::None => Ok(data),
        Compression::Deflate => {
            let mut out = Vec::new();
            let mut decoder = ZlibDecoder::new(data.as_slice()).take(size as u64 + 1);
            decoder.read_to_end(&mut out).map_err(|_| "its data cannot be decompressed")?;
            match out.len() == size {
                true => Ok(out),
                false => Err("its data is not as long as its header says"),
            }
        }
        Compression::Heatshrink11 => heatshrink::decompress(&data, 11, size),
        Compression::Heatshrink12 => heatshrink::decompress(&data, 12, size),
    }
}
