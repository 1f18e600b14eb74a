//! COLPIC: a table of colours and runs of them, as characters.
//!
//! A head of 32 bytes, little-endian: version 3 and three zeros, width, height, the mark 0x05DDC33C, bytes of the table,
//! bytes of the runs, eight zeros. The table has colours of 16 bits, the commonest first. A run is a byte with its length
//! (1 to 6) in the three highest bits and a colour's number modulo 32 in the others; length 0 means that a byte with it
//! follows. 7 is no run: the numbers of what follows begin at 32 times the others. Six bits make a character.

use std::collections::BTreeMap;

/// Most colours of the table.
const COLORS: usize = 1024;
/// Colours that a run can tell apart.
const PAGE: usize = 32;
/// Longest run.
const LONGEST: usize = 255;
const MARK: u32 = 0x05DD_C33C;

/// Writes a picture of colours in 16 bits (RGB565), row by row.
pub(super) fn encode(pixels: &[u16], [width, height]: [u32; 2]) -> String {
    let (colors, numbers) = table(pixels);
    let mut runs = Vec::new();
    let mut page = 0;
    for run in pixels.chunk_by(|a, b| numbers[a] == numbers[b]) {
        let number = numbers[&run[0]];
        if number / PAGE != page {
            page = number / PAGE;
            runs.push(7 << 5 | page as u8);
        }
        for part in run.chunks(LONGEST) {
            let color = (number % PAGE) as u8;
            match part.len() {
                length @ 1..=6 => runs.push((length as u8) << 5 | color),
                length => runs.extend([color, length as u8]),
            }
        }
    }
    let mut bytes = vec![3, 0, 0, 0];
    for word in [width, height, MARK, 2 * colors.len() as u32, runs.len() as u32, 0, 0] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(colors.iter().flat_map(|color| color.to_le_bytes()));
    bytes.extend(runs);
    characters(bytes)
}

/// The colours of the table, and the number of each colour of the picture: its own, or that of the one most like it.
fn table(pixels: &[u16]) -> (Vec<u16>, BTreeMap<u16, usize>) {
    let mut counts: BTreeMap<u16, usize> = BTreeMap::new();
    for &pixel in pixels {
        *counts.entry(pixel).or_default() += 1;
    }
    let mut colors: Vec<(u16, usize)> = counts.into_iter().collect();
    // Ties stay in the order of the colours.
    colors.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let colors: Vec<u16> = colors.into_iter().map(|(color, _)| color).collect();
    let kept = &colors[..colors.len().min(COLORS)];
    let number = |index: usize, color: u16| match index < COLORS {
        true => index,
        false => (0..kept.len()).min_by_key(|i| distance(kept[*i], color)).unwrap_or(0),
    };
    let numbers = colors.iter().enumerate().map(|(index, &color)| (color, number(index, color)));
    (kept.to_vec(), numbers.collect())
}

/// How unlike two colours are.
fn distance(a: u16, b: u16) -> u16 {
    let channels = |color: u16| [color >> 11, color >> 5 & 63, color & 31];
    channels(a).into_iter().zip(channels(b)).map(|(a, b)| a.abs_diff(b)).sum()
}

/// Six bits in a character from `0` on; `~` stands for the backslash.
fn characters(mut bytes: Vec<u8>) -> String {
    bytes.resize(bytes.len().next_multiple_of(3), 0);
    let groups =
        bytes.chunks_exact(3).map(|group| group.iter().fold(0, |word, byte| word << 8 | u32::from(*byte)));
    let sixes = groups.flat_map(|word| [18, 12, 6, 0].map(|shift| (word >> shift & 63) as u8));
    sixes.map(|six| if six + b'0' == b'\\' { '~' } else { char::from(six + b'0') }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Width, height and pixels, read by the description above.
    fn decode(text: &str) -> ([u32; 2], Vec<u16>) {
        let six = |c: u8| u32::from(if c == b'~' { b'\\' } else { c } - b'0');
        let words =
            text.as_bytes().chunks_exact(4).map(|four| four.iter().fold(0, |word, c| word << 6 | six(*c)));
        let bytes: Vec<u8> = words.flat_map(|word| [16, 8, 0].map(|shift| (word >> shift) as u8)).collect();
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        assert_eq!((word(0), word(12), word(24), word(28)), (3, 0x05DD_C33C, 0, 0));
        let (colors, runs) = bytes[32..].split_at(word(16) as usize);
        let colors: Vec<u16> = colors.chunks_exact(2).map(|c| u16::from_le_bytes([c[0], c[1]])).collect();
        let mut runs = runs[..word(20) as usize].iter();
        let (mut page, mut pixels) = (0, Vec::new());
        while let Some(&byte) = runs.next() {
            let low = usize::from(byte & 31);
            let length = match byte >> 5 {
                7 => {
                    page = low;
                    continue;
                }
                0 => *runs.next().unwrap(),
                length => length,
            };
            pixels.extend(std::iter::repeat_n(colors[32 * page + low], length.into()));
        }
        ([word(4), word(8)], pixels)
    }

    #[test]
    fn pictures_come_back() {
        let runs: Vec<u16> = [(7, 1), (0, 6), (9, 7), (3, 300), (7, 255), (1, 31)]
            .into_iter()
            .flat_map(|(color, length)| std::iter::repeat_n(color, length))
            .collect();
        let many: Vec<u16> = (0..1000_u16).flat_map(|i| [i.wrapping_mul(64), 5]).collect();
        for (pixels, size) in [(runs, [30, 20]), (many, [50, 40])] {
            assert_eq!(decode(&encode(&pixels, size)), (size, pixels));
        }
    }

    #[test]
    fn too_many_colours_are_replaced_by_the_like() {
        let pixels: Vec<u16> = (0..4096).map(|i| i * 16).collect();
        let (size, decoded) = decode(&encode(&pixels, [64, 64]));
        assert_eq!((size, decoded.len()), ([64, 64], 4096));
        assert!(decoded.iter().collect::<std::collections::BTreeSet<_>>().len() <= 1024);
        assert!(pixels[..1024] == decoded[..1024]);
    }

    #[test]
    fn the_characters_are_those_of_the_format() {
        assert_eq!(characters(vec![0b0000_0001, 0b0010_0010, 0b1100_1100]), "0B;<");
        assert_eq!(characters(vec![0b1011_0011, 0b1111_0000]), "~o00");
    }
}
