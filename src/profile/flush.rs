//! How much has to be flushed for a filament to come out in its own color.

use geometry::real::{cbrt, ln, pow};

/// What a melt zone holds and mixes: a bore of 2 mm, heated along 12 mm, mm³.
const MELT_ZONE_MM3: f64 = 38.0;

/// Difference of two colors that can just be seen, in CIELAB (Mahy, Van Eycken & Oosterlinck 1994,
/// <https://doi.org/10.1002/col.5080190205>).
const JUST_SEEN: f64 = 2.3;

/// Least reflectance of a plastic, whose surface is glossy, and the most that its pigments leave it.
const REFLECTANCE: [f64; 2] = [0.04, 0.9];

/// Filament after which nothing can be seen of the color before, mm³: the melt zone is taken to be stirred well, so the share
/// of the old filament falls by a factor of e with each of its volumes, and the colors to mix as pigments do (Kubelka & Munk
/// 1931), by which a little black darkens white and a little white does nothing to black.
pub(super) fn between_mm3(old: [u8; 3], new: [u8; 3]) -> f64 {
    let [old, new] = [old, new].map(|color| color.map(absorption));
    let pure = lab(new.map(reflectance));
    let is_seen = |share: f64| {
        let mixed = [0, 1, 2].map(|i| new[i] + share * (old[i] - new[i]));
        let mixed = lab(mixed.map(reflectance));
        (0..3).map(|i| (mixed[i] - pure[i]).powi(2)).sum::<f64>() > JUST_SEEN * JUST_SEEN
    };
    if !is_seen(1.0) {
        return 0.0;
    }
    let (mut unseen, mut seen) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = f64::midpoint(unseen, seen);
        *(if is_seen(middle) { &mut seen } else { &mut unseen }) = middle;
    }
    MELT_ZONE_MM3 * -ln(seen)
}

/// The color of a filament, as in `#29B2B2`, with or without transparency behind it.
pub(super) fn color(text: &str) -> Option<[u8; 3]> {
    let digits = text.trim().strip_prefix('#').filter(|digits| matches!(digits.len(), 6 | 8))?;
    let part = |at: usize| u8::from_str_radix(digits.get(at..at + 2)?, 16).ok();
    Some([part(0)?, part(2)?, part(4)?])
}

/// Absorption over scattering of a channel of sRGB.
fn absorption(channel: u8) -> f64 {
    let value = f64::from(channel) / 255.0;
    let linear = if value <= 0.040_45 { value / 12.92 } else { pow((value + 0.055) / 1.055, 2.4) };
    let reflectance = linear.clamp(REFLECTANCE[0], REFLECTANCE[1]);
    (1.0 - reflectance) * (1.0 - reflectance) / (2.0 * reflectance)
}

fn reflectance(absorption: f64) -> f64 {
    1.0 + absorption - (absorption * (absorption + 2.0)).sqrt()
}

/// CIELAB of linear sRGB under D65 (IEC 61966-2-1, CIE 15).
fn lab([r, g, b]: [f64; 3]) -> [f64; 3] {
    let curve = |t: f64| if t > 0.008_856 { cbrt(t) } else { 7.787 * t + 16.0 / 116.0 };
    let x = curve((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505);
    let y = curve(0.2126 * r + 0.7152 * g + 0.0722 * b);
    let z = curve((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHITE: [u8; 3] = [255; 3];
    const BLACK: [u8; 3] = [0; 3];

    #[test]
    fn white_after_black_needs_most_and_black_after_white_little() {
        let (white, black) = (between_mm3(BLACK, WHITE), between_mm3(WHITE, BLACK));
        assert!((200.0..400.0).contains(&white) && (30.0..100.0).contains(&black), "{white}, {black}");
        let colors: [[u8; 3]; 5] = [[200, 30, 30], [30, 90, 200], [250, 220, 20], [40, 160, 60], [120; 3]];
        for color in colors {
            assert!(between_mm3(WHITE, color) < white, "{color:?}");
            assert!(between_mm3(color, BLACK) < between_mm3(color, WHITE), "{color:?}");
        }
    }

    #[test]
    fn the_less_colors_differ_the_less_is_flushed_and_nothing_between_equal_ones() {
        let greys = |to: u8| between_mm3([100; 3], [to; 3]);
        assert_eq!((greys(100), greys(101)), (0.0, 0.0));
        assert!(
            greys(110) < greys(130) && greys(130) < greys(200),
            "{} {} {}",
            greys(110),
            greys(130),
            greys(200)
        );
    }

    #[test]
    fn colors_are_read_as_hosts_write_them() {
        assert_eq!(color(" #29b2B2 "), Some([0x29, 0xb2, 0xb2]));
        assert_eq!(color("#29B2B2FF"), Some([0x29, 0xb2, 0xb2]));
        for text in ["", "red", "#123", "29B2B2", "#29B2BG", "#ééé"] {
            assert_eq!(color(text), None, "{text}");
        }
    }
}
