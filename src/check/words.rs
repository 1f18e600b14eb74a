//! What the file is written in: known commands, letters with numbers.

use geometry::real;

use super::fault::Kind;
use super::report::Found;
use super::rule::{LineContext, Rule};
use crate::gcode::Stroke;

/// Commands of Marlin 2, Klipper, RepRapFirmware 3, Prusa's, Bambu's and UltiMaker's firmware: ranges of numbers.
const KNOWN_G: &[(u32, u32)] = &[
    (0, 6),
    (10, 12),
    (17, 23),
    (26, 35),
    (38, 38),
    (42, 42),
    (53, 61),
    (68, 69),
    (75, 81),
    (90, 94),
    (380, 380),
    (392, 392),
    (425, 425),
];
const KNOWN_M: &[(u32, u32)] = &[
    (0, 5),
    (7, 11),
    (16, 39),
    (42, 43),
    (48, 48),
    (70, 87),
    (92, 93),
    (98, 129),
    (131, 150),
    (154, 156),
    (160, 166),
    (190, 193),
    (200, 214),
    (217, 218),
    (220, 229),
    (240, 240),
    (250, 263),
    (280, 286),
    (290, 312),
    (340, 340),
    (349, 364),
    (374, 376),
    (380, 381),
    (400, 415),
    (420, 433),
    (450, 486),
    (488, 493),
    (500, 512),
    (520, 520),
    (524, 524),
    (540, 610),
    (620, 630),
    (640, 675),
    (700, 711),
    (720, 723),
    (750, 756),
    (772, 772),
    (776, 776),
    (801, 801),
    (808, 820),
    (851, 876),
    (900, 919),
    (922, 922),
    (928, 929),
    (950, 993),
    (995, 1010),
    (1023, 1028),
    (2000, 2000),
    (7219, 7219),
];
/// Commands that take only letters with numbers as parameters. Of others the parameters may be texts.
const STRICT_M: &[u32] = &[73, 82, 83, 84, 104, 106, 107, 109, 140, 190, 201, 203, 204, 205, 220, 221];
/// The ends of an arc are as far from its centre, up to this.
const ARC_SLACK_MM: f64 = 0.1;

/// Checks the syntax of lines.
#[derive(Default)]
pub(super) struct Words;

impl Rule for Words {
    fn check_line(&mut self, seen: &LineContext<'_>, found: &mut Found) {
        let Some(code) = seen.line.code else {
            let text = seen.line.parameters().trim_ascii();
            // `@` begins commands of print hosts; T may be followed by x, c or ?; P with a number parks a tool.
            let parks = matches!(text, [b'P' | b'p', b'0'..=b'9', ..]);
            let known = text.is_empty()
                || seen.named().is_some()
                || parks
                || matches!(text[0], b'@' | b'%' | b'T' | b't' | b'(');
            if !known {
                seen.fault(found, Kind::Malformed, || seen.text());
            }
            return;
        };
        let known =
            |ranges: &[(u32, u32)]| ranges.iter().any(|(from, to)| (*from..=*to).contains(&code.number));
        let (known, strict) = match code.letter {
            b'G' => (known(KNOWN_G), matches!(code.number, 0..=4 | 92)),
            b'M' => (known(KNOWN_M), STRICT_M.contains(&code.number)),
            _ => (true, false),
        };
        if !known {
            seen.fault(found, Kind::UnknownCommand, || seen.text());
        }
        if strict
            && !seen.stroke().is_some_and(|stroke| stroke.plain)
            && !is_plain(seen.line.parameters())
            // Bambu's M221 S and M221 R save a state and bring it back.
            && let Err(kind) = read(
                seen.line.parameters(),
                matches!((code.letter, code.number), (b'G', 92) | (b'M', 84 | 221)),
            )
        {
            seen.fault(found, kind, || seen.text());
        }
        if let Some(stroke) = seen.stroke() {
            if stroke.feed_mm_s <= 0.0 && seen.line.words().get(b'F').is_some() {
                seen.fault(found, Kind::BadFeedRate, || seen.text());
            }
            if stroke.arc.is_some() && !is_valid_arc(stroke, seen) {
                seen.fault(found, Kind::Malformed, || format!("no arc around that centre: {}", seen.text()));
            }
        }
    }
}

/// Whether an arc has a centre, as far from its start as from its end.
fn is_valid_arc(stroke: &Stroke, seen: &LineContext<'_>) -> bool {
    let Some(center) = stroke.arc else { return true };
    let words = seen.line.words();
    if words.get(b'R').is_some() {
        return true;
    }
    let radius_mm = |p: [f64; 3]| real::hypot(p[0] - center.at[0], p[1] - center.at[1]);
    let radii = [radius_mm(stroke.from), radius_mm(stroke.to)];
    let given = words.get(b'I').is_some() || words.get(b'J').is_some();
    given && radii[0] > 0.0 && (!seen.located || (radii[0] - radii[1]).abs() <= ARC_SLACK_MM)
}

/// Whether a text is as slicers write nearly all of them: words in capitals, a blank before each, none twice.
fn is_plain(text: &[u8]) -> bool {
    let digit = |at: usize| text.get(at).is_some_and(u8::is_ascii_digit);
    let (mut given, mut at) = (0_u32, 0);
    while at < text.len() {
        let [b' ', letter @ b'A'..=b'Z', ..] = text[at..] else { return false };
        let bit = 1 << (letter - b'A');
        if given & bit != 0 {
            return false;
        }
        given |= bit;
        at += if text.get(at + 2) == Some(&b'-') { 3 } else { 2 };
        let begin = at;
        while digit(at) {
            at += 1;
        }
        let mut digits = at - begin;
        if text.get(at) == Some(&b'.') {
            at += 1;
            let decimals = at;
            while digit(at) {
                at += 1;
            }
            digits += at - decimals;
        }
        if digits == 0 {
            return false;
        }
    }
    true
}

/// Reads letters with numbers. `flags`: letters may stand alone.
fn read(text: &[u8], flags: bool) -> Result<(), Kind> {
    let mut given = 0_u32;
    let mut at = 0;
    // Where words stand apart, an E that follows a digit is no word.
    let mut apart = false;
    let mut after_digit = false;
    while let Some(&byte) = text.get(at) {
        match byte {
            b' ' | b'\t' => (after_digit, at) = (false, at + 1),
            b'(' => at = text[at..].iter().position(|b| *b == b')').map_or(text.len(), |end| at + end + 1),
            // A checksum, or what follows the code before its parameters: a decimal of the code itself.
            b'*' => return Ok(()),
            b'.' if at == 0 => at = 1 + text[1..].iter().take_while(|b| b.is_ascii_digit()).count(),
            _ if byte.is_ascii_alphabetic() => {
                if after_digit && apart && byte.eq_ignore_ascii_case(&b'e') {
                    return Err(Kind::Exponent);
                }
                apart |= !after_digit && at > 0;
                let letter = 1 << (byte.to_ascii_uppercase() - b'A');
                if given & letter != 0 {
                    return Err(Kind::Malformed);
                }
                given |= letter;
                at += 1;
                at += text[at..].iter().take_while(|b| matches!(b, b' ' | b'\t')).count();
                match number(&text[at..]).or_else(|| expression(&text[at..])) {
                    Some(length) => (at, after_digit) = (at + length, true),
                    None if is_no_number(&text[at..]) => return Err(Kind::NotANumber),
                    None if flags => after_digit = false,
                    None => return Err(Kind::Malformed),
                }
            }
            _ => return Err(Kind::Malformed),
        }
    }
    Ok(())
}

/// Length of the number that a text begins with.
fn number(text: &[u8]) -> Option<usize> {
    let sign = usize::from(matches!(text.first(), Some(b'-' | b'+')));
    let digits = |from: usize| text[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let whole = digits(sign);
    let mut length = sign + whole;
    let mut decimals = 0;
    if text.get(length) == Some(&b'.') {
        decimals = digits(length + 1);
        length += 1 + decimals;
    }
    (whole + decimals > 0).then_some(length)
}

/// Length of the expression in braces that a text begins with, as RepRapFirmware takes them in place of numbers.
fn expression(text: &[u8]) -> Option<usize> {
    (text.first() == Some(&b'{')).then(|| text.iter().position(|b| *b == b'}')).flatten().map(|end| end + 1)
}

/// What programs write for values that are none.
fn is_no_number(text: &[u8]) -> bool {
    let text = text.strip_prefix(b"-").or_else(|| text.strip_prefix(b"+")).unwrap_or(text);
    let begins = |word: &[u8]| text.get(..word.len()).is_some_and(|head| head.eq_ignore_ascii_case(word));
    begins(b"nan") || begins(b"inf") || begins(b"1.#")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_letters_with_numbers_with_or_without_blanks() {
        for text in ["", " X1 Y-2.5 E.03", "X1Y2E3F4", " X+1. E-1*77", ".1 S3", " X 1 Y 2 (note) Z3"] {
            assert_eq!(read(text.as_bytes(), false), Ok(()), "{text}");
        }
        assert_eq!(read(b" X Y", true), Ok(()));
    }

    #[test]
    fn what_is_wrong_is_told_apart() {
        let faults = [
            (" Xnan Y1", Kind::NotANumber),
            (" X-INF", Kind::NotANumber),
            (" X1e7", Kind::Exponent),
            (" X1 Y2.5E-05", Kind::Exponent),
            (" X1 X2", Kind::Malformed),
            (" X Y1", Kind::Malformed),
            (" X1.2.3", Kind::Malformed),
            (" X1,5", Kind::Malformed),
        ];
        for (text, kind) in faults {
            assert_eq!(read(text.as_bytes(), false), Err(kind), "{text}");
            assert!(!is_plain(text.as_bytes()), "{text}");
        }
    }
}
