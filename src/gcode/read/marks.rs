//! What slicers say in comments on lines of their own.

/// A comment with a meaning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mark<'a> {
    /// What follows is of this feature; its name as written (see [`role`](super::role)).
    Feature(&'a [u8]),
    /// A layer begins. Several of them with no extrusion in between mean one layer.
    Layer,
    /// Height over the bed of what follows, mm.
    Z(f64),
    /// Width of the beads that follow, mm.
    Width(f64),
    /// Height of the beads that follow, mm.
    Height(f64),
    /// E counts cubic millimetres.
    Volumetric,
}

/// The meaning of a comment (what follows the semicolon), if it has one that is known: of Cura from 15.04 on, PrusaSlicer,
/// SuperSlicer, OrcaSlicer, Bambu Studio, Simplify3D, ideaMaker, KISSlicer and this program.
pub fn mark(comment: &[u8]) -> Option<Mark<'_>> {
    let text = comment.trim_ascii();
    let (&first, _) = text.split_first()?;
    // Most comments are none of these: decide by the first letter.
    match first {
        b'T' => strip(text, "TYPE:").map(Mark::Feature),
        b'F' | b'f' => strip(text, "FEATURE:")
            .or_else(|| strip(text, "feature "))
            .map(Mark::Feature)
            .or_else(|| (strip(text, "FLAVOR:") == Some(b"UltiGCode")).then_some(Mark::Volumetric)),
        // KISSlicer names its retractions and travels in the same way as what it draws.
        b'\'' => (!text.starts_with(b"'Destring")).then_some(Mark::Feature(text)),
        b'L' | b'l' => layer(text),
        b'C' => (text == b"CHANGE_LAYER").then_some(Mark::Layer),
        b'B' => text.starts_with(b"BEGIN_LAYER_OBJECT").then_some(Mark::Layer),
        b'Z' => number(strip(text, "Z:").or_else(|| strip(text, "Z_HEIGHT:"))?).map(Mark::Z),
        b'W' => number(strip(text, "WIDTH:")?).map(Mark::Width),
        b'H' => number(strip(text, "HEIGHT:")?).map(Mark::Height),
        _ => None,
    }
}

/// `LAYER:7`, `LAYER_CHANGE`, `layer 7, Z = 1.4`; Bambu's `LAYER_HEIGHT:` and `LINE_WIDTH:`.
fn layer(text: &[u8]) -> Option<Mark<'_>> {
    if text == b"LAYER_CHANGE" {
        return Some(Mark::Layer);
    }
    if let Some(height) = strip(text, "LAYER_HEIGHT:") {
        return number(height).map(Mark::Height);
    }
    if let Some(width) = strip(text, "LINE_WIDTH:") {
        return number(width).map(Mark::Width);
    }
    let count = strip(text, "LAYER:").or_else(|| strip(text, "layer "))?;
    let numbered = count.strip_prefix(b"-").unwrap_or(count).first().is_some_and(u8::is_ascii_digit);
    let alone = |rest: &[u8]| rest.first().is_none_or(|b| matches!(b, b',' | b'.' | b' '));
    let rest =
        count.iter().position(|b| !b.is_ascii_digit() && *b != b'-').map_or(&[][..], |at| &count[at..]);
    (numbered && alone(rest)).then_some(Mark::Layer)
}

/// What follows a prefix, trimmed. Its case matters not.
fn strip<'a>(text: &'a [u8], prefix: &str) -> Option<&'a [u8]> {
    let (head, rest) = text.split_at_checked(prefix.len())?;
    head.eq_ignore_ascii_case(prefix.as_bytes()).then(|| rest.trim_ascii())
}

/// A finite number, whatever unit follows it.
fn number(text: &[u8]) -> Option<f64> {
    let end = text.iter().position(|b| !matches!(b, b'0'..=b'9' | b'.' | b'-' | b'+')).unwrap_or(text.len());
    std::str::from_utf8(&text[..end]).ok()?.parse().ok().filter(|value: &f64| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn features_are_found_in_every_dialect() {
        let comments = [
            ("TYPE:WALL-OUTER", "WALL-OUTER"),
            (" FEATURE: Outer wall", "Outer wall"),
            (" feature outer perimeter", "outer perimeter"),
            (" 'Perimeter Path', 20.0 [feed mm/s]", "'Perimeter Path', 20.0 [feed mm/s]"),
        ];
        for (comment, name) in comments {
            assert_eq!(mark(comment.as_bytes()), Some(Mark::Feature(name.as_bytes())), "{comment}");
        }
    }

    #[test]
    fn layers_are_found_in_every_dialect() {
        let comments =
            ["LAYER:0", "LAYER:-2", "LAYER_CHANGE", " CHANGE_LAYER", " layer 1, Z = 0.200", " layer 12"];
        for comment in comments {
            assert_eq!(mark(comment.as_bytes()), Some(Mark::Layer), "{comment}");
        }
    }

    #[test]
    fn heights_and_widths_are_numbers() {
        assert_eq!(mark(b"Z:0.4"), Some(Mark::Z(0.4)));
        assert_eq!(mark(b" Z_HEIGHT: 0.6"), Some(Mark::Z(0.6)));
        assert_eq!(mark(b"WIDTH:0.449999"), Some(Mark::Width(0.449999)));
        assert_eq!(mark(b" LINE_WIDTH: 0.42"), Some(Mark::Width(0.42)));
        assert_eq!(mark(b"HEIGHT:0.2"), Some(Mark::Height(0.2)));
        assert_eq!(mark(b" LAYER_HEIGHT: 0.2"), Some(Mark::Height(0.2)));
    }

    #[test]
    fn other_comments_mean_nothing() {
        for comment in [
            "LAYER_COUNT:120",
            "Layer height: 0.2",
            "layer_height = 0.2",
            "LAYER:x",
            "Z:high",
            "",
            " 'Destring Prime'",
            " 'Destring/Wipe/Jump Path', 0.0 [feed mm/s], 60.0 [head mm/s]",
        ] {
            assert_eq!(mark(comment.as_bytes()), None, "{comment}");
        }
    }
}
