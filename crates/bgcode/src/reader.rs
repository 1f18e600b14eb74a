//! Files, block by block.

use std::io::{self, Read};

use crate::block::{Block, Pairs, SlicerMetadata, Thumbnail};
use crate::compression::decompress;
use crate::error::{Error, Place};
use crate::format::{BlockKind, Checksum, Compression, Encoding, ImageFormat, LARGEST_BLOCK, MAGIC, VERSION};
use crate::meatpack;

const CUT: &str = "the file ends within it; it was cut short, get it again";

/// Reads blocks, each checked before it is handed out. Holds one block in memory.
///
/// Ends after an error.
#[derive(Debug)]
pub struct Reader<R> {
    input: R,
    checksum: Checksum,
    /// The block that is read, or comes next.
    place: Place,
    /// Bytes read.
    offset: u64,
    /// How many blocks of each rank there were.
    seen: [u64; 6],
    ended: bool,
}

impl<R: Read> Reader<R> {
    /// Reads the file's header.
    ///
    /// # Errors
    /// It is no binary G-code, or one of a kind that is not known.
    pub fn new(mut input: R) -> Result<Self, Error> {
        let place = Place { block: 0, kind: None, offset: 0 };
        let mut header = [0; 10];
        let read = fill(&mut input, &mut header)?;
        if header[..read.min(4)] != MAGIC {
            return Err(place.damaged("it does not begin with GCDE; it is no binary G-code"));
        }
        if read < header.len() {
            return Err(place.damaged(CUT));
        }
        let version = u32::from_le_bytes([header[4], header[5], header[6], header[7]]);
        if version != VERSION {
            return Err(place.damaged(format!("its version is {version}; only version {VERSION} is known")));
        }
        let number = u16::from_le_bytes([header[8], header[9]]);
        let checksum = Checksum::of(number).ok_or_else(|| {
            place.damaged(format!("its checksum is of the kind {number}; 0 and 1 are known"))
        })?;
        Ok(Self { input, checksum, place, offset: 10, seen: [0; 6], ended: false })
    }

    /// Where the block begins that was read last, or could not be read.
    pub fn place(&self) -> Place {
        self.place
    }

    /// Goes on at a block that was read before, its place known from [`Self::place`]; the input must stand there.
    pub(crate) fn resume(&mut self, place: Place) {
        self.offset = place.offset;
        self.place = Place { block: place.block - 1, ..place };
        self.ended = false;
    }

    pub(crate) fn input(&mut self) -> &mut R {
        &mut self.input
    }

    fn read(&mut self) -> Result<Option<Block>, Error> {
        self.place = Place { block: self.place.block + 1, kind: None, offset: self.offset };
        let mut header = [0; 12];
        let read = fill(&mut self.input, &mut header[..8])?;
        self.offset += read as u64;
        if read == 0 {
            return self.end().map(|()| None);
        }
        let [kind, compression] = [0, 2].map(|at| u16::from_le_bytes([header[at], header[at + 1]]));
        if read >= 2 {
            let unknown = || format!("it is of the kind {kind}, which is not known");
            self.place.kind = Some(BlockKind::of(kind).ok_or_else(|| self.place.damaged(unknown()))?);
        }
        if read < 8 {
            return Err(self.place.damaged(CUT));
        }
        let Some(kind) = self.place.kind else { return Err(self.place.damaged(CUT)) };
        self.follows(kind)?;
        let number = compression;
        let compression = Compression::of(number)
            .ok_or_else(|| self.place.damaged(format!("its compression is {number}; 0 to 3 are known")))?;
        let header_len = if compression == Compression::None { 8 } else { 12 };
        self.exactly(&mut header[8..header_len])?;
        let size =
            |at: usize| u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]);
        let (unpacked, stored) = (size(4), size(header_len - 4));
        if unpacked.max(stored) > LARGEST_BLOCK {
            let size = unpacked.max(stored);
            return Err(self.place.damaged(format!(
                "it says that it has {size} bytes, and blocks have at most {} MB; the file is damaged, get it again",
                LARGEST_BLOCK >> 20
            )));
        }
        let mut parameters = [0; 6];
        let parameters = &mut parameters[..kind.parameters()];
        self.exactly(parameters)?;
        // Memory grows with the data that is there, not with what a damaged header promises.
        let mut data = Vec::new();
        self.offset += self.input.by_ref().take(stored.into()).read_to_end(&mut data)? as u64;
        if data.len() < stored as usize {
            return Err(self.place.damaged(CUT));
        }
        if self.checksum == Checksum::Crc32 {
            let mut stored = [0; 4];
            self.exactly(&mut stored)?;
            let mut hasher = crc32fast::Hasher::new();
            for part in [&header[..header_len], parameters, &data] {
                hasher.update(part);
            }
            if hasher.finalize() != u32::from_le_bytes(stored) {
                return Err(self.place.damaged("its checksum is wrong; the file is damaged, get it again"));
            }
        }
        let place = self.place;
        let damaged = |reason: &str| place.damaged(format!("{reason}; the file is damaged, get it again"));
        let data = decompress(data, compression, unpacked as usize).map_err(damaged)?;
        let words: Vec<u16> = parameters.chunks_exact(2).map(|w| u16::from_le_bytes([w[0], w[1]])).collect();
        self.block(kind, &words, data).map(Some)
    }

    /// What a block of known parameters holds.
    fn block(&self, kind: BlockKind, words: &[u16], data: Vec<u8>) -> Result<Block, Error> {
        let place = self.place;
        let unknown = |what: &str| place.damaged(format!("its {what} is {}, which is not known", words[0]));
        if kind == BlockKind::Thumbnail {
            let format = ImageFormat::of(words[0]).ok_or_else(|| unknown("format"))?;
            return Ok(Block::Thumbnail(Thumbnail { format, width: words[1], height: words[2], data }));
        }
        if kind == BlockKind::Gcode {
            let text = match Encoding::of(words[0]).ok_or_else(|| unknown("encoding"))? {
                Encoding::None => Ok(data),
                Encoding::MeatPack | Encoding::MeatPackComments => meatpack::unpack(&data),
            };
            let damaged = |reason| place.damaged(format!("{reason}; the file is damaged, get it again"));
            return text.map(Block::Gcode).map_err(damaged);
        }
        let text = String::from_utf8_lossy(&data);
        match (words[0], kind) {
            (0, BlockKind::FileMetadata) => Ok(Block::FileMetadata(pairs(&text))),
            (0, BlockKind::PrinterMetadata) => Ok(Block::PrinterMetadata(pairs(&text))),
            (0, BlockKind::PrintMetadata) => Ok(Block::PrintMetadata(pairs(&text))),
            (0, _) => Ok(Block::SlicerMetadata(SlicerMetadata::Pairs(pairs(&text)))),
            (1, BlockKind::SlicerMetadata) => {
                Ok(Block::SlicerMetadata(SlicerMetadata::Json(text.into_owned())))
            }
            _ => Err(unknown("encoding")),
        }
    }

    /// Whether a block of this kind may come next.
    fn follows(&mut self, kind: BlockKind) -> Result<(), Error> {
        let rank = kind.rank();
        let later = self.seen[rank + 1..].iter().any(|count| *count > 0);
        let most = match kind {
            BlockKind::Thumbnail | BlockKind::Gcode => u64::MAX,
            BlockKind::SlicerMetadata => 2,
            _ => 1,
        };
        if later || self.seen[rank] >= most {
            return Err(self.place.damaged("it does not belong here; the file is damaged, get it again"));
        }
        self.needed(rank)?;
        self.seen[rank] += 1;
        Ok(())
    }

    /// Whether all blocks are there that come before one of a rank.
    fn needed(&self, rank: usize) -> Result<(), Error> {
        let needed = [BlockKind::PrinterMetadata, BlockKind::PrintMetadata, BlockKind::SlicerMetadata];
        match needed.into_iter().find(|kind| kind.rank() < rank && self.seen[kind.rank()] == 0) {
            Some(missing) => Err(self.place.damaged(format!(
                "the {} that must come before is missing; the file is damaged, get it again",
                missing.name()
            ))),
            None => Ok(()),
        }
    }

    /// Whether the file may end here.
    fn end(&self) -> Result<(), Error> {
        self.needed(BlockKind::Gcode.rank())?;
        match self.seen[BlockKind::Gcode.rank()] {
            0 => Err(self.place.damaged("there is no G-code in the file; it was cut short, get it again")),
            _ => Ok(()),
        }
    }

    fn exactly(&mut self, bytes: &mut [u8]) -> Result<(), Error> {
        let read = fill(&mut self.input, bytes)?;
        self.offset += read as u64;
        if read < bytes.len() { Err(self.place.damaged(CUT)) } else { Ok(()) }
    }
}

impl<R: Read> Iterator for Reader<R> {
    type Item = Result<Block, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let block = self.read();
        self.ended = !matches!(block, Ok(Some(_)));
        block.transpose()
    }
}

/// Lines of `key=value`.
fn pairs(text: &str) -> Pairs {
    let split = |line: &str| line.split_once('=').map(|(key, value)| (key.to_owned(), value.to_owned()));
    text.split('\n').filter_map(split).collect()
}

/// Reads as many bytes as there are, at most those wanted.
fn fill(input: &mut impl Read, bytes: &mut [u8]) -> io::Result<usize> {
    let mut filled = 0;
    while filled < bytes.len() {
        match input.read(&mut bytes[filled..]) {
            Ok(0) => break,
            Ok(read) => filled += read,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(filled)
}
