//! Scripts and conditions of other slicers' presets.

use macros::{Condition, Script};

use crate::listed;

/// A value of an INI file as the text that it stands for: with its quotes and escapes taken off.
fn unescaped(value: &str) -> String {
    let inner = value.strip_prefix('"').and_then(|value| value.strip_suffix('"')).unwrap_or(value);
    let mut text = String::new();
    let mut chars = inner.chars();
    while let Some(c) = chars.next() {
        match c {
            '\\' => match chars.next() {
                Some('n') => text.push('\n'),
                Some('r') => text.push('\r'),
                Some(c) => text.push(c),
                None => {}
            },
            c => text.push(c),
        }
    }
    text
}

/// Every script and condition of the vendors' presets is understood.
pub fn scripts_and_conditions_of_presets_are_read() {
    let (mut scripts, mut conditions, mut wrong) = (0, 0, Vec::new());
    for path in listed("presets/vendor", "ini") {
        let text = std::fs::read_to_string(&path).expect("a text");
        for (key, value) in text.lines().filter_map(|line| line.split_once('=')) {
            let (key, value) = (key.trim(), unescaped(value.trim()));
            let error = match key {
                _ if key.ends_with("_condition") => {
                    conditions += 1;
                    Condition::parse(&value).err()
                }
                _ if key.ends_with("gcode") || key == "output_filename_format" => {
                    scripts += 1;
                    Script::parse(&value).err()
                }
                _ => None,
            };
            wrong.extend(error.map(|error| format!("{}: {key}: {error}", path.display())));
        }
    }
    assert_eq!(wrong, Vec::<String>::new());
    assert!(scripts > 300 && conditions > 1000, "{scripts} scripts, {conditions} conditions");
}
