//! Numbers of the format, as its specification lists them.

/// The first bytes of a file.
pub const MAGIC: [u8; 4] = *b"GCDE";
/// The version that is read and written.
pub(crate) const VERSION: u32 = 1;
/// Most bytes of a block, packed or not, that are accepted: more than any slicer writes, and no danger to memory.
pub(crate) const LARGEST_BLOCK: u32 = 256 << 20;

macro_rules! numbered {
    ($(#[$doc:meta])* $name:ident { $($(#[$case_doc:meta])* $case:ident = $number:literal,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum $name {
            $($(#[$case_doc])* $case = $number,)*
        }

        impl $name {
            /// What a number in a file stands for.
            pub(crate) fn of(number: u16) -> Option<Self> {
                match number {
                    $($number => Some(Self::$case),)*
                    _ => None,
                }
            }
        }
    };
}

numbered! {
    /// What follows each block.
    Checksum {
        /// Nothing.
        None = 0,
        /// CRC-32 of the block, as in PNG.
        Crc32 = 1,
    }
}

numbered! {
    /// What a block holds.
    BlockKind {
        /// Who wrote the file.
        FileMetadata = 0,
        /// Commands of the printer.
        Gcode = 1,
        /// What the slicer was set to.
        SlicerMetadata = 2,
        /// What the printer shows and checks before it prints.
        PrinterMetadata = 3,
        /// Times and amounts.
        PrintMetadata = 4,
        /// A picture.
        Thumbnail = 5,
    }
}

impl BlockKind {
    /// The name of the kind in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::FileMetadata => "file metadata",
            Self::Gcode => "G-code",
            Self::SlicerMetadata => "slicer metadata",
            Self::PrinterMetadata => "printer metadata",
            Self::PrintMetadata => "print metadata",
            Self::Thumbnail => "thumbnail",
        }
    }

    /// Its place in the order of blocks.
    pub(crate) fn rank(self) -> usize {
        const ORDER: [BlockKind; 6] = [
            BlockKind::FileMetadata,
            BlockKind::PrinterMetadata,
            BlockKind::Thumbnail,
            BlockKind::PrintMetadata,
            BlockKind::SlicerMetadata,
            BlockKind::Gcode,
        ];
        ORDER.iter().position(|kind| *kind == self).unwrap_or(ORDER.len())
    }

    /// Bytes of its parameters.
    pub(crate) fn parameters(self) -> usize {
        if self == Self::Thumbnail { 6 } else { 2 }
    }
}

numbered! {
    /// How the data of a block is compressed.
    Compression {
        /// Not at all.
        None = 0,
        /// zlib (RFC 1950). Firmware reads no G-code that is compressed like this.
        Deflate = 1,
        /// Heatshrink with a window of 2 KiB.
        Heatshrink11 = 2,
        /// Heatshrink with a window of 4 KiB.
        Heatshrink12 = 3,
    }
}

numbered! {
    /// How G-code is written in a block.
    Encoding {
        /// As text.
        None = 0,
        /// Packed, without comments.
        MeatPack = 1,
        /// Packed, with the lines that are comments.
        MeatPackComments = 2,
    }
}

numbered! {
    /// The format of a picture.
    ImageFormat {
        /// Portable Network Graphics.
        Png = 0,
        /// JPEG.
        Jpg = 1,
        /// Quite OK Image.
        Qoi = 2,
    }
}

impl ImageFormat {
    /// The word before `begin` in the comments of G-code as text.
    pub(crate) fn tag(self) -> &'static str {
        match self {
            Self::Png => "thumbnail",
            Self::Jpg => "thumbnail_JPG",
            Self::Qoi => "thumbnail_QOI",
        }
    }

    pub(crate) const ALL: [Self; 3] = [Self::Png, Self::Jpg, Self::Qoi];
}
