//! MeatPack: two characters in a byte.
//!
//! Each half of a byte, the lower first, is one of fifteen characters or 15, which stands for a whole byte that follows.
//! Two bytes of 255 and a third are a command: whether what follows is packed, and whether 11 is a blank or `E`.
//! G-code is packed without the blanks of lines that begin with `G`; readers put them back before the letters that
//! parameters begin with. Blank lines are lost to them.

/// The characters of the numbers 0 to 14; that of [`BLANK`] may be [`NO_BLANK`].
const CHARACTERS: &[u8; 15] = b"0123456789. \nGX";
const BLANK: usize = 11;
const NO_BLANK: u8 = b'E';
/// Half a byte: the character follows.
const FOLLOWS: u8 = 15;

/// Begins a command, twice.
const SIGNAL: u8 = 255;
const PACKED: u8 = 251;
const PLAIN: u8 = 250;
const RESET: u8 = 249;
const NO_BLANKS: u8 = 247;
const BLANKS: u8 = 246;

/// Letters before which readers put a blank in lines that begin with `G`.
const PARAMETERS: &[u8] = b"XYZEFIJRSGPWHCA";

/// Lines that have been packed.
pub(crate) struct Packer {
    out: Vec<u8>,
    packed: bool,
    /// Whether comments are kept.
    comments: bool,
    /// Bytes of the text.
    length: usize,
}

impl Packer {
    pub(crate) fn new(comments: bool) -> Self {
        let mut packer = Self { out: Vec::new(), packed: true, comments, length: 0 };
        packer.command(PACKED);
        packer.command(NO_BLANKS);
        packer
    }

    /// Packs a line, which has no end of its own and [`survives`].
    pub(crate) fn line(&mut self, line: &[u8]) {
        let is_comment = line.first() == Some(&b';');
        if line.is_empty() || is_comment && !self.comments {
            return;
        }
        self.length += line.len() + 1;
        if is_comment {
            self.switch(false);
            self.out.extend_from_slice(line);
            self.out.push(b'\n');
            return;
        }
        self.switch(true);
        let tight: Vec<u8> = line.iter().copied().filter(|byte| *byte != b' ').collect();
        let comes_back = line[0] == b'G' && spaced(&tight) == line;
        self.pack(if comes_back { &tight } else { line });
    }

    /// What is packed to less than half is filled up with commands that change nothing: libbgcode's reader loses
    /// characters otherwise, where its buffer grows.
    pub(crate) fn finish(mut self) -> Vec<u8> {
        while 2 * self.out.len() <= self.length {
            self.command(if self.packed { PACKED } else { PLAIN });
        }
        if !self.comments {
            self.command(RESET);
        }
        self.out
    }

    fn switch(&mut self, packed: bool) {
        if self.packed != packed {
            self.command(if packed { PACKED } else { PLAIN });
            self.packed = packed;
        }
    }

    fn command(&mut self, command: u8) {
        self.out.extend_from_slice(&[SIGNAL, SIGNAL, command]);
    }

    /// Lines begin with a byte of their own: one that would end in half a byte ends in two line feeds, of which readers
    /// drop the second.
    fn pack(&mut self, line: &[u8]) {
        let mut rest = line.iter().copied().chain([b'\n']);
        while let Some(first) = rest.next() {
            let second = rest.next().unwrap_or(b'\n');
            let [low, high] = [first, second].map(number);
            self.out.push(high << 4 | low);
            self.out.extend([(low, first), (high, second)].iter().filter(|c| c.0 == FOLLOWS).map(|c| c.1));
        }
    }
}

/// The number of a character where there are no blanks, or [`FOLLOWS`].
fn number(character: u8) -> u8 {
    match character {
        NO_BLANK => BLANK as u8,
        b' ' => FOLLOWS,
        _ => CHARACTERS.iter().position(|known| *known == character).map_or(FOLLOWS, |at| at as u8),
    }
}

/// Whether a line, which has no end of its own, comes back from its packed form as it is.
pub(crate) fn survives(line: &[u8]) -> bool {
    !line.contains(&SIGNAL) && (line.first() != Some(&b'G') || spaced(line) == line)
}

/// What readers make of a line: with a blank before each parameter.
fn spaced(line: &[u8]) -> Vec<u8> {
    let mut lines = Lines::default();
    for &character in line {
        lines.push(character);
    }
    lines.out
}

/// Undoes packing.
///
/// # Errors
/// The data ends within a character.
pub(crate) fn unpack(data: &[u8]) -> Result<Vec<u8>, &'static str> {
    let mut unpacker = Unpacker::default();
    let mut signals = 0;
    for &byte in data {
        match (byte, signals) {
            (SIGNAL, 0 | 1) => signals += 1,
            // More of them are no command.
            (SIGNAL, _) => signals = 1,
            (command, 2) => {
                unpacker.command(command);
                signals = 0;
            }
            (byte, _) => {
                if signals == 1 {
                    unpacker.take(SIGNAL);
                    signals = 0;
                }
                unpacker.take(byte);
            }
        }
    }
    match signals == 0 && unpacker.following == 0 {
        true => Ok(unpacker.lines.out),
        false => Err("its MeatPack data ends within a character"),
    }
}

#[derive(Default)]
struct Unpacker {
    packed: bool,
    no_blanks: bool,
    /// Characters that follow as whole bytes.
    following: u8,
    /// The second of two, behind one that follows.
    held: Option<u8>,
    lines: Lines,
}

impl Unpacker {
    fn command(&mut self, command: u8) {
        match command {
            PACKED => self.packed = true,
            PLAIN | RESET => self.packed = false,
            NO_BLANKS => self.no_blanks = true,
            BLANKS => self.no_blanks = false,
            // Readers pass over what they do not know.
            _ => {}
        }
    }

    fn take(&mut self, byte: u8) {
        if !self.packed || self.following > 0 {
            self.lines.push(byte);
            self.following = self.following.saturating_sub(1);
            if let Some(second) = self.held.take() {
                self.lines.push(second);
            }
            return;
        }
        match [byte & 15, byte >> 4].map(|number| self.character(number)) {
            [None, None] => self.following = 2,
            [None, second] => (self.following, self.held) = (1, second),
            // Whatever stands behind a line's end fills up the byte.
            [Some(b'\n'), _] => self.lines.push(b'\n'),
            [Some(first), second] => {
                self.lines.push(first);
                match second {
                    Some(second) => self.lines.push(second),
                    None => self.following = 1,
                }
            }
        }
    }

    fn character(&self, number: u8) -> Option<u8> {
        match usize::from(number) {
            BLANK if self.no_blanks => Some(NO_BLANK),
            number => CHARACTERS.get(number).copied(),
        }
    }
}

/// Lines as readers put them together.
#[derive(Default)]
struct Lines {
    out: Vec<u8>,
    /// Whether the line begins with `G`.
    is_g: bool,
}

impl Lines {
    fn push(&mut self, character: u8) {
        let begins = self.out.last().is_none_or(|last| *last == b'\n');
        if character == b'\n' {
            self.is_g = false;
            if begins {
                return;
            }
        } else if begins {
            self.is_g = character == b'G';
        } else if self.is_g && PARAMETERS.contains(&character) && self.out.last() != Some(&b' ') {
            self.out.push(b' ');
        }
        self.out.push(character);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn packed(text: &str) -> Vec<u8> {
        let mut packer = Packer::new(true);
        for line in text.lines() {
            assert!(survives(line.as_bytes()), "{line}");
            packer.line(line.as_bytes());
        }
        packer.finish()
    }

    #[test]
    fn the_bytes_are_those_of_the_format() {
        let begin = [255, 255, 251, 255, 255, 247];
        // G and 1; X and 2; . and 5; line end and filling.
        assert_eq!(packed("G1 X2.5")[6..], [0x1d, 0x2e, 0x5a, 0xcc]);
        // Y follows a 1, E is a blank's number.
        assert_eq!(packed("G1 Y0 E7")[6..], [0x1d, 0x0f, b'Y', 0x7b, 0xcc]);
        assert_eq!(packed(";a")[..6], begin);
        assert_eq!(packed(";a")[6..], [255, 255, 250, b';', b'a', b'\n']);
    }

    #[test]
    fn lines_come_back_as_they_were() {
        let text = "G1 X10.5 Y-3 E.0315 F1800\n;TYPE:External perimeter\nM117 GEX 100 % done\n\
                    M486 S0 A\"a part GX\"\nG29 P1 T3\nG28 ; home all\nG92 E0\nM73 P50 R5     \n\
                    SET_VELOCITY_LIMIT ACCEL=3000\n  G1 X1\nG0  X1\ng1 x2 y3\n; EXTRUDE G1 X1\nM104 S215 ;hot\n\
                    G1 X5 ; \u{e4}\u{20ac}\nN3 G1 X4*57\n";
        assert_eq!(String::from_utf8(unpack(&packed(text)).unwrap()).unwrap(), text);
    }

    #[test]
    fn what_readers_would_change_is_known() {
        for line in ["GREET NAME=X", "G1 X1 ; GEAR", "G1X5Y3"] {
            assert!(!survives(line.as_bytes()), "{line}");
        }
        assert!(!survives(b"M117 \xff"));
    }

    #[test]
    fn nothing_is_packed_to_less_than_half() {
        let text = "G1 X1 E1 X1 E1 X1 E1 X1 E1\n".repeat(100);
        let packed = packed(&text);
        assert!(2 * packed.len() > text.len());
        assert_eq!(unpack(&packed).unwrap(), text.as_bytes());
    }

    #[test]
    fn half_a_character_is_damage() {
        assert!(unpack(&[255, 255, 251, 0x0f]).is_err());
        assert!(unpack(&[255]).is_err());
    }

    proptest! {
        #[test]
        fn what_is_packed_comes_back(lines in proptest::collection::vec("[GXM;E0-9. a-z]{1,30}", 0..40)) {
            let mut packer = Packer::new(true);
            let kept: Vec<String> = lines.into_iter().filter(|line| survives(line.as_bytes())).collect();
            kept.iter().for_each(|line| packer.line(line.as_bytes()));
            let text: String = kept.iter().map(|line| format!("{line}\n")).collect();
            prop_assert_eq!(String::from_utf8(unpack(&packer.finish()).unwrap()).unwrap(), text);
        }

        #[test]
        fn no_data_is_too_strange(data in proptest::collection::vec(any::<u8>(), 0..300)) {
            let _ = unpack(&data);
        }
    }
}
