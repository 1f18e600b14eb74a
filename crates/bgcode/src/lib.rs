//! Binary G-code as Prusa's printers read it (`.bgcode`), read and written.
//!
//! [`Reader`] hands out the blocks of a file, each checked; [`Text`] is the file as text, with metadata and pictures as
//! the comments that slicers write. [`Writer`] writes a [`Head`] and lines of G-code, [`pack`](pack()) makes a file of text.
//! The format is that of <https://github.com/prusa3d/libbgcode/blob/main/doc/specifications.md>.

#![forbid(unsafe_code)]
#![deny(missing_docs)]
#![allow(rustdoc::private_intra_doc_links)]

mod block;
mod comments;
mod compression;
mod error;
mod format;
mod heatshrink;
mod meatpack;
mod pack;
mod reader;
mod text;
mod writer;

pub use block::{Block, Head, Pairs, SlicerMetadata, Thumbnail};
pub use error::{Error, Place};
pub use format::{BlockKind, Checksum, Compression, Encoding, ImageFormat, MAGIC};
pub use pack::{Contents, pack};
pub use reader::Reader;
pub use text::Text;
pub use writer::{Options, Writer};

/// The examples of the README are compiled with the documentation's.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
