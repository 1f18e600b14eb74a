//! Pictures in the formats that printers read, as comments of G-code.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use jpeg_encoder::{ColorType, Encoder};
use tiny_skia::Pixmap;

use super::colpic;
use super::thumbnail::{Solid, picture};
use crate::gcode::{ThumbnailFormat, ThumbnailSpec};

/// Characters of base64 in a line of G-code, as in PrusaSlicer: with `; ` no longer than 80.
const LINE: usize = 78;
/// Quality of JPEG, as in PrusaSlicer.
const JPG_QUALITY: u8 = 85;
/// What COLPIC shows behind the print, as other slicers have it.
const COLPIC_BACKGROUND: [u8; 3] = [46, 51, 72];
/// Numbers that the screens of BIGTREETECH take for black with a tint.
const BTT_BLACK: [u16; 3] = [0x0020, 0x0841, 0x0861];

/// A picture as comment lines in the form that hosts and firmwares read. Screens show the first COLPIC as the large one.
pub fn thumbnail_comment(solid: &dyn Solid, spec: ThumbnailSpec, is_first: bool) -> String {
    let map = picture(solid, spec.size);
    let size = [map.width(), map.height()];
    match spec.format {
        ThumbnailFormat::Png => base64("thumbnail", size, &map.encode_png().unwrap_or_default()),
        ThumbnailFormat::Jpg => base64("thumbnail_JPG", size, &jpg(&map)),
        ThumbnailFormat::Qoi => base64("thumbnail_QOI", size, &qoi(&map)),
        ThumbnailFormat::ColPic => {
            let word = if is_first { "gimage" } else { "simage" };
            let colors: Vec<u16> = pixels(&map, COLPIC_BACKGROUND).map(rgb565).collect();
            format!("\n;{word}:{}\n\n", colpic::encode(&colors, size))
        }
        ThumbnailFormat::BttTft => btt_tft(&map),
    }
}

/// What follows the last picture of the format BTT_TFT.
pub const BTT_TFT_END: &str = "; bigtree thumbnail end\r\n\r\n";

fn base64(tag: &str, [width, height]: [u32; 2], bytes: &[u8]) -> String {
    let text = STANDARD.encode(bytes);
    let mut out = format!(";\n; {tag} begin {width}x{height} {}\n", text.len());
    let mut rest = text.as_str();
    while !rest.is_empty() {
        let (line, next) = rest.split_at(LINE.min(rest.len()));
        out += &format!("; {line}\n");
        rest = next;
    }
    out + &format!("; {tag} end\n;\n")
}

/// Red, green and blue of every pixel, row by row, on a background.
fn pixels(map: &Pixmap, background: [u8; 3]) -> impl Iterator<Item = [u8; 3]> {
    map.pixels().iter().map(move |pixel| {
        let shown = 255 - u32::from(pixel.alpha());
        let channels = [pixel.red(), pixel.green(), pixel.blue()];
        [0, 1, 2].map(|i| channels[i].saturating_add(((u32::from(background[i]) * shown + 127) / 255) as u8))
    })
}

/// On black, as PrusaSlicer has it.
fn jpg(map: &Pixmap) -> Vec<u8> {
    let rgb = pixels(map, [0; 3]).collect::<Vec<_>>().concat();
    let mut out = Vec::new();
    // Sides are at most 2000, and memory takes what is written.
    let side = |side: u32| u16::try_from(side).unwrap_or(u16::MAX);
    let encoder = Encoder::new(&mut out, JPG_QUALITY);
    match encoder.encode(&rgb, side(map.width()), side(map.height()), ColorType::Rgb) {
        Ok(()) => out,
        Err(_) => Vec::new(),
    }
}

fn qoi(map: &Pixmap) -> Vec<u8> {
    let rgba = map.pixels().iter().flat_map(|pixel| {
        let pixel = pixel.demultiply();
        [pixel.red(), pixel.green(), pixel.blue(), pixel.alpha()]
    });
    qoi::encode_to_vec(rgba.collect::<Vec<u8>>(), map.width(), map.height()).unwrap_or_default()
}

/// Size and rows of colours in hexadecimal digits, on black. The firmware wants lines to end as in DOS.
fn btt_tft(map: &Pixmap) -> String {
    let mut out = format!(";{:04x}{:04x}\r\n", map.width(), map.height());
    let colors: Vec<u16> = pixels(map, [0; 3]).map(rgb565).collect();
    for row in colors.chunks(map.width() as usize) {
        out.push(';');
        for color in row {
            let color = if BTT_BLACK.contains(color) { 0 } else { *color };
            out += &format!("{color:04x}");
        }
        out += "\r\n";
    }
    out
}

/// A colour in 16 bits.
fn rgb565([r, g, b]: [u8; 3]) -> u16 {
    u16::from(r >> 3) << 11 | u16::from(g >> 2) << 5 | u16::from(b >> 3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::Settings;
    use crate::view::Scene;

    fn scene() -> Scene {
        let text = b"M83\n;TYPE:Perimeter\nG1 X50 Y50 Z.2 F600\nG1 X60 E1\nG1 Y60 E1\nG1 X50 E1\nG1 Y50 E1";
        Scene::read(text, &Settings::default())
    }

    fn comment(format: ThumbnailFormat) -> String {
        thumbnail_comment(&scene(), ThumbnailSpec { size: [48, 32], format }, true)
    }

    /// The bytes between the marks, whose length must be as announced.
    fn held(text: &str, tag: &str) -> Vec<u8> {
        assert!(text.lines().all(|line| line.starts_with(';') && line.len() <= 80));
        let held: String = text.lines().filter(|l| !l.contains("thumbnail")).map(|l| l[1..].trim()).collect();
        assert!(text.contains(&format!("; {tag} begin 48x32 {}\n", held.len())), "{text}");
        assert!(text.ends_with(&format!("; {tag} end\n;\n")));
        STANDARD.decode(held).unwrap()
    }

    /// What the picture is on black.
    fn wanted() -> Vec<[u8; 3]> {
        pixels(&picture(&scene(), [48, 32]), [0; 3]).collect()
    }

    #[test]
    fn png_holds_the_picture() {
        let map = Pixmap::decode_png(&held(&comment(ThumbnailFormat::Png), "thumbnail")).unwrap();
        assert_eq!(map, picture(&scene(), [48, 32]));
    }

    #[test]
    fn qoi_holds_the_picture() {
        let bytes = held(&comment(ThumbnailFormat::Qoi), "thumbnail_QOI");
        let (head, rgba) = rapid_qoi::Qoi::decode_alloc(&bytes).unwrap();
        assert_eq!((head.width, head.height, head.colors.channels()), (48, 32, 4));
        let map = picture(&scene(), [48, 32]);
        let shown = map.pixels().iter().map(|pixel| pixel.demultiply());
        let shown = shown.flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue(), pixel.alpha()]);
        assert_eq!(rgba, shown.collect::<Vec<u8>>());
    }

    #[test]
    fn jpg_looks_like_the_picture() {
        let bytes = held(&comment(ThumbnailFormat::Jpg), "thumbnail_JPG");
        let mut decoder = zune_jpeg::JpegDecoder::new(std::io::Cursor::new(&bytes));
        let rgb = decoder.decode().unwrap();
        assert_eq!(decoder.dimensions(), Some((48, 32)));
        let wanted = wanted().concat();
        let off: u32 = rgb.iter().zip(&wanted).map(|(a, b)| u32::from(a.abs_diff(*b))).sum();
        assert!(rgb.len() == wanted.len() && off < 8 * wanted.len() as u32, "{off}");
    }

    #[test]
    fn btt_tft_holds_the_picture() {
        let text = comment(ThumbnailFormat::BttTft);
        let mut rows = text.split_terminator("\r\n");
        assert_eq!(rows.next(), Some(";00300020"));
        let digits: String = rows.map(|row| row.strip_prefix(';').unwrap()).collect();
        let number = |at: usize| u16::from_str_radix(&digits[at..at + 4], 16).unwrap();
        let colors: Vec<u16> = (0..digits.len()).step_by(4).map(number).collect();
        let wanted = wanted().into_iter().map(rgb565);
        let wanted = wanted.map(|color| if BTT_BLACK.contains(&color) { 0 } else { color });
        assert_eq!(colors, wanted.collect::<Vec<_>>());
    }

    #[test]
    fn the_first_colpic_is_the_large_one() {
        assert!(comment(ThumbnailFormat::ColPic).starts_with("\n;gimage:"));
        let small = ThumbnailSpec { size: [16, 16], format: ThumbnailFormat::ColPic };
        assert!(thumbnail_comment(&scene(), small, false).starts_with("\n;simage:"));
    }
}
