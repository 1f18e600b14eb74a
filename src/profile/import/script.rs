//! Scripts of others: taken over as they are written, for the language is the same.

/// A value as written, its quotes and escapes undone; of several, one for each extruder, the first.
pub(super) fn unescaped(written: &str) -> String {
    let text = written.trim();
    let (text, quoted) = match text.strip_prefix('"') {
        Some(rest) => (rest, true),
        None => (text, false),
    };
    let mut out = String::new();
    let mut chars = text.chars();
    while let Some(c) = chars.next() {
        match c {
            '"' if quoted => break,
            '\\' => match chars.next() {
                Some('n') => out.push('\n'),
                Some('r') | None => {}
                Some('t') => out.push('\t'),
                Some(other) => out.push(other),
            },
            c => out.push(c),
        }
    }
    out
}

/// A script, its lines ended; nothing for one without a line.
pub(super) fn of(written: &str) -> String {
    let mut text = unescaped(written);
    if !text.is_empty() && !text.ends_with('\n') {
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_and_escapes_are_undone() {
        assert_eq!(unescaped("\"; a \\\"b\\\" \\\\ c\\nM1\""), "; a \"b\" \\ c\nM1");
    }

    #[test]
    fn the_first_extruders_script_is_taken() {
        assert_eq!(of("\"M900 K1\\nM2\";\"M900 K2\""), "M900 K1\nM2\n");
        assert_eq!(of("\"\""), "");
    }
}
