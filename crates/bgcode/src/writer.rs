//! Files, written.

use std::io::{self, Write};

use crate::block::{Head, Pairs, SlicerMetadata};
use crate::compression::compress;
use crate::format::{BlockKind, Checksum, Compression, Encoding, LARGEST_BLOCK, MAGIC, VERSION};
use crate::meatpack::{Packer, survives};

/// Most bytes of G-code in a block, as libbgcode has it; a longer line has one of its own.
const GCODE_BYTES: usize = 1 << 16;

/// How a file is written; by default as PrusaSlicer does it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// What follows each block.
    pub checksum: Checksum,
    /// Compression of metadata on the file, the printer and the print.
    pub metadata: Compression,
    /// Compression of the slicer's metadata.
    pub slicer: Compression,
    /// Compression of G-code. Firmware does not read [`Compression::Deflate`] here.
    pub gcode: Compression,
    /// Encoding of G-code. Firmware wants all blocks to have the same.
    pub encoding: Encoding,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            checksum: Checksum::Crc32,
            metadata: Compression::None,
            slicer: Compression::Deflate,
            gcode: Compression::Heatshrink12,
            encoding: Encoding::MeatPackComments,
        }
    }
}

/// Writes a file: the blocks of the head at once, then G-code line by line.
///
/// Blank lines are left out, since encoded G-code has none.
#[derive(Debug)]
pub struct Writer<W> {
    out: W,
    options: Options,
    /// Whole lines for the next block.
    lines: Vec<u8>,
}

impl<W: Write> Writer<W> {
    /// Writes everything that comes before the G-code. Blocks that must be there but have nothing to say are empty.
    ///
    /// # Errors
    /// Those of writing; or a block is larger than readers accept.
    pub fn new(mut out: W, options: Options, head: &Head) -> io::Result<Self> {
        out.write_all(&MAGIC)?;
        out.write_all(&VERSION.to_le_bytes())?;
        out.write_all(&(options.checksum as u16).to_le_bytes())?;
        let mut writer = Self { out, options, lines: Vec::new() };
        let metadata = options.metadata;
        if !head.file.is_empty() {
            writer.block(BlockKind::FileMetadata, metadata, &[0], ini(&head.file))?;
        }
        writer.block(BlockKind::PrinterMetadata, metadata, &[0], ini(&head.printer))?;
        for picture in &head.thumbnails {
            let words = [picture.format as u16, picture.width, picture.height];
            writer.block(BlockKind::Thumbnail, Compression::None, &words, picture.data.clone())?;
        }
        writer.block(BlockKind::PrintMetadata, metadata, &[0], ini(&head.print))?;
        if head.slicer.is_empty() {
            writer.block(BlockKind::SlicerMetadata, options.slicer, &[0], Vec::new())?;
        }
        for slicer in &head.slicer {
            let (encoding, data) = match slicer {
                SlicerMetadata::Pairs(pairs) => (0, ini(pairs)),
                SlicerMetadata::Json(json) => (1, json.clone().into_bytes()),
            };
            writer.block(BlockKind::SlicerMetadata, options.slicer, &[encoding], data)?;
        }
        Ok(writer)
    }

    /// Appends a line, with or without its end.
    ///
    /// # Errors
    /// Those of writing; the line is longer than readers accept, or would not come back from the encoding as it is.
    pub fn line(&mut self, line: &[u8]) -> io::Result<()> {
        let line = line.strip_suffix(b"\n").unwrap_or(line);
        if line.is_empty() {
            return Ok(());
        }
        if self.options.encoding != Encoding::None && !survives(line) {
            let message = format!(
                "MeatPack would change the line `{}`; write the file with the encoding None",
                String::from_utf8_lossy(line)
            );
            return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
        }
        if !self.lines.is_empty() && self.lines.len() + line.len() >= GCODE_BYTES {
            self.flush_lines()?;
        }
        self.lines.extend_from_slice(line);
        self.lines.push(b'\n');
        Ok(())
    }

    /// Writes what is left, and hands back what was written to.
    ///
    /// # Errors
    /// Those of writing.
    pub fn finish(mut self) -> io::Result<W> {
        self.flush_lines()?;
        self.out.flush()?;
        Ok(self.out)
    }

    fn flush_lines(&mut self) -> io::Result<()> {
        let lines = std::mem::take(&mut self.lines);
        if lines.is_empty() {
            return Ok(());
        }
        let encoding = self.options.encoding;
        let data = if encoding == Encoding::None { lines } else { packed(&lines, encoding) };
        self.block(BlockKind::Gcode, self.options.gcode, &[encoding as u16], data)
    }

    fn block(
        &mut self,
        kind: BlockKind,
        compression: Compression,
        parameters: &[u16],
        data: Vec<u8>,
    ) -> io::Result<()> {
        // What is empty cannot be compressed.
        let compression = if data.is_empty() { Compression::None } else { compression };
        let size = data.len();
        let data = compress(data, compression);
        if size.max(data.len()) > LARGEST_BLOCK as usize {
            let (what, most) = (kind.name(), LARGEST_BLOCK >> 20);
            let message = format!("a block of {what} would have {size} bytes; at most {most} MB are read");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
        }
        let mut head = Vec::with_capacity(18);
        for word in [kind as u16, compression as u16] {
            head.extend(word.to_le_bytes());
        }
        head.extend((size as u32).to_le_bytes());
        if compression != Compression::None {
            head.extend((data.len() as u32).to_le_bytes());
        }
        head.extend(parameters.iter().flat_map(|word| word.to_le_bytes()));
        self.out.write_all(&head)?;
        self.out.write_all(&data)?;
        if self.options.checksum == Checksum::Crc32 {
            let mut hasher = crc32fast::Hasher::new();
            hasher.update(&head);
            hasher.update(&data);
            self.out.write_all(&hasher.finalize().to_le_bytes())?;
        }
        Ok(())
    }
}

/// Lines that survive it, packed.
fn packed(lines: &[u8], encoding: Encoding) -> Vec<u8> {
    let mut packer = Packer::new(encoding == Encoding::MeatPackComments);
    for line in lines.split(|byte| *byte == b'\n') {
        packer.line(line);
    }
    packer.finish()
}

/// Lines of `key=value`; what cannot stand in one is a blank.
fn ini(pairs: &Pairs) -> Vec<u8> {
    let mut out = String::new();
    for (key, value) in pairs {
        let key: String = key.chars().map(|c| if matches!(c, '=' | '\n') { ' ' } else { c }).collect();
        let value = value.replace('\n', " ");
        out += &format!("{key}={value}\n");
    }
    out.into_bytes()
}
