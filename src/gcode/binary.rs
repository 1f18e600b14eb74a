//! G-code as text, written as binary G-code.

use std::io::{self, BufRead, Write};

use bgcode::{Contents, Options, pack};

/// What binary G-code tells beside what the comments of the text do.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BinaryMetadata {
    /// For the printer: keys as PrusaSlicer has them.
    pub printer: Vec<(String, String)>,
    /// Settings that the file was made with.
    pub slicer: Vec<(String, String)>,
}

/// Writes G-code in memory as binary G-code.
///
/// # Errors
/// Those of writing; or a line is too long.
pub fn write_binary(text: &[u8], metadata: &BinaryMetadata, to: &mut impl Write) -> io::Result<()> {
    let contents = contents(text, metadata)?;
    pack_text(&contents, text, to)
}

/// What a text's comments tell, and what is told beside.
pub(crate) fn contents(text: impl BufRead, metadata: &BinaryMetadata) -> io::Result<Contents> {
    let mut contents = Contents::of(text)?;
    contents.add(metadata.printer.clone(), metadata.slicer.clone());
    Ok(contents)
}

/// Writes a text, whose contents have been read, as PrusaSlicer writes it.
pub(crate) fn pack_text(contents: &Contents, text: impl BufRead, to: &mut impl Write) -> io::Result<()> {
    pack(contents, text, Options::default(), to).map(drop)
}
