//! Heatshrink: LZSS for machines with little memory.
//!
//! A stream of bits, the highest of a byte first. 1 begins a literal, its 8 bits follow. 0 begins a copy: how far back,
//! less 1, in as many bits as the window has, then how much, less 1, in 4 bits. What lies before the beginning is zero.

/// Bits of a copy's length.
const LENGTH_BITS: u32 = 4;
/// Longest copy.
const LONGEST: usize = 1 << LENGTH_BITS;
/// Shortest copy that takes fewer bits than literals.
const SHORTEST: usize = 3;
/// Earlier places that are tried for a copy.
const TRIES: usize = 128;
/// Bits of the table of earlier places.
const HASH_BITS: u32 = 13;
/// No place.
const NOWHERE: usize = usize::MAX;

/// Compresses with a window of `1 << window_bits` bytes.
pub(crate) fn compress(data: &[u8], window_bits: u32) -> Vec<u8> {
    let window = 1 << window_bits;
    let mut out = BitWriter::default();
    // The last place of each hash, and of each place the one before with the same.
    let mut last = vec![NOWHERE; 1 << HASH_BITS];
    let mut before = vec![NOWHERE; data.len()];
    let mut at = 0;
    while at < data.len() {
        let (back, length) = longest(data, at, window, &last, &before);
        let step = if length >= SHORTEST { length } else { 1 };
        if step == 1 {
            out.put(0x100 | u32::from(data[at]), 9);
        } else {
            out.put(0, 1);
            out.put((back - 1) as u32, window_bits);
            out.put((length - 1) as u32, LENGTH_BITS);
        }
        for (place, before) in before.iter_mut().enumerate().skip(at).take(step) {
            if let Some(slot) = slot(data, place) {
                *before = last[slot];
                last[slot] = place;
            }
        }
        at += step;
    }
    out.finish()
}

/// Where the next three bytes are looked up.
fn slot(data: &[u8], at: usize) -> Option<usize> {
    let &[a, b, c] = data.get(at..at + SHORTEST)? else { return None };
    let key = u32::from_le_bytes([a, b, c, 0]);
    Some((key.wrapping_mul(0x9E37_79B1) >> (32 - HASH_BITS)) as usize)
}

/// The longest copy for what comes next, the nearest of them: how far back, and how much.
fn longest(data: &[u8], at: usize, window: usize, last: &[usize], before: &[usize]) -> (usize, usize) {
    let mut best = (0, 0);
    let Some(slot) = slot(data, at) else { return best };
    let rest = &data[at..data.len().min(at + LONGEST)];
    let mut place = last[slot];
    for _ in 0..TRIES {
        if place == NOWHERE || at - place > window {
            break;
        }
        let length = rest.iter().zip(&data[place..]).take_while(|(a, b)| a == b).count();
        if length > best.1 {
            best = (at - place, length);
            if length == rest.len() {
                break;
            }
        }
        place = before[place];
    }
    best
}

/// Undoes [`compress`] for data of a known size.
///
/// # Errors
/// What is wrong with the data.
pub(crate) fn decompress(data: &[u8], window_bits: u32, size: usize) -> Result<Vec<u8>, &'static str> {
    const SHORT: &str = "its data ends early";
    let mut bits = BitReader { data, at: 0 };
    // Memory grows with the data that is there, not with what a damaged header promises.
    let mut out: Vec<u8> = Vec::with_capacity(size.min(data.len().saturating_mul(8)));
    while out.len() < size {
        if bits.take(1).ok_or(SHORT)? == 1 {
            out.push(bits.take(8).ok_or(SHORT)? as u8);
            continue;
        }
        let back = bits.take(window_bits).ok_or(SHORT)? as usize + 1;
        let length = bits.take(LENGTH_BITS).ok_or(SHORT)? as usize + 1;
        if out.len() + length > size {
            return Err("its data is longer than its header says");
        }
        for _ in 0..length {
            let byte = out.len().checked_sub(back).map_or(0, |from| out[from]);
            out.push(byte);
        }
    }
    // The last byte is filled up, and some writers add one more.
    if bits.left() >= 16 {
        return Err("its data is longer than its header says");
    }
    Ok(out)
}

#[derive(Default)]
struct BitWriter {
    out: Vec<u8>,
    /// Bits that make no byte yet, in the lowest places.
    held: u32,
    count: u32,
}

impl BitWriter {
    /// Appends the lowest `count` bits, at most 16.
    fn put(&mut self, bits: u32, count: u32) {
        self.held = self.held << count | bits & ((1 << count) - 1);
        self.count += count;
        while self.count >= 8 {
            self.count -= 8;
            self.out.push((self.held >> self.count) as u8);
        }
        self.held &= (1 << self.count) - 1;
    }

    fn finish(mut self) -> Vec<u8> {
        if self.count > 0 {
            self.put(0, 8 - self.count);
        }
        self.out
    }
}

struct BitReader<'a> {
    data: &'a [u8],
    /// Bits read.
    at: usize,
}

impl BitReader<'_> {
    fn take(&mut self, count: u32) -> Option<u32> {
        let byte = self.at / 8;
        // At most 12 bits, which lie in three bytes.
        let word =
            (0..3).fold(0, |word, i| word << 8 | u32::from(self.data.get(byte + i).copied().unwrap_or(0)));
        if self.left() < count as usize {
            return None;
        }
        let shift = 24 - (self.at % 8) as u32 - count;
        self.at += count as usize;
        Some(word >> shift & ((1 << count) - 1))
    }

    fn left(&self) -> usize {
        self.data.len() * 8 - self.at
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_bits_are_those_of_the_format() {
        // Literal a (1 01100001), a copy of 5 from 1 back (0 000000000000 0100), filled up.
        assert_eq!(compress(b"aaaaaa", 12), [0b1011_0000, 0b1000_0000, 0b0000_0001, 0b0000_0000]);
        assert_eq!(decompress(&[0xb0, 0x80, 0x01, 0x00], 12, 6).unwrap(), b"aaaaaa");
    }

    #[test]
    fn what_lies_before_the_beginning_is_zero() {
        assert_eq!(decompress(&[0b0000_0000, 0b0010_0010], 11, 3).unwrap(), [0, 0, 0]);
    }

    #[test]
    fn text_gets_shorter() {
        let text = "G1 X10.5 Y20.25 E.0315\n".repeat(400);
        let packed = compress(text.as_bytes(), 12);
        assert!(packed.len() * 6 < text.len(), "{}", packed.len());
    }

    proptest! {
        #[test]
        fn what_is_compressed_comes_back(
            data in proptest::collection::vec(0_u8..6, 0..9000),
            window_bits in 11_u32..=12,
        ) {
            prop_assert_eq!(decompress(&compress(&data, window_bits), window_bits, data.len()).unwrap(), data);
        }

        #[test]
        fn no_data_is_too_strange(data in proptest::collection::vec(any::<u8>(), 0..300), size in 0_usize..5000) {
            if let Ok(out) = decompress(&data, 12, size) {
                prop_assert_eq!(out.len(), size);
            }
        }
    }
}
