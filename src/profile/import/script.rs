//! Scripts with the placeholders of others.
//!
//! A script is translated whole or not at all: one without a line is not the same script. Conditions that depend on the
//! configuration alone are decided here; what depends on the print stays only where there is a placeholder for it.

use crate::presets::Config;

/// Their placeholder, ours. Those of the temperatures are of the first extruder.
const NAMES: &[(&str, &str)] = &[
    ("first_layer_temperature", "nozzle_temp"),
    ("temperature", "nozzle_temp_other"),
    ("first_layer_bed_temperature", "bed_temp"),
    ("bed_temperature", "bed_temp_other"),
    ("layer_height", "layer_height"),
    ("first_layer_height", "first_layer_height"),
    ("nozzle_diameter", "nozzle_diameter"),
    ("filament_type", "filament"),
    ("filament_diameter", "filament_diameter"),
    ("retract_length", "retract_length"),
    ("max_print_height", "bed_height"),
    ("total_layer_count", "layer_count"),
    ("max_layer_z", "print_max_z"),
    ("printer_settings_id", "printer"),
];

/// Each element of their lists, ours.
const POINTS: &[(&str, [&str; 2])] = &[
    ("first_layer_print_min", ["print_min_x", "print_min_y"]),
    ("first_layer_print_max", ["print_max_x", "print_max_y"]),
    ("print_bed_min", ["bed_min_x", "bed_min_y"]),
    ("print_bed_max", ["bed_max_x", "bed_max_y"]),
    ("print_bed_size", ["bed_size_x", "bed_size_y"]),
];

/// The placeholders that are translated, for the documentation.
pub(super) fn names() -> impl Iterator<Item = (String, &'static str)> {
    let points = POINTS.iter().flat_map(|(theirs, ours)| {
        ours.iter().enumerate().map(move |(i, ours)| (format!("{theirs}[{i}]"), *ours))
    });
    NAMES.iter().map(|(theirs, ours)| ((*theirs).to_owned(), *ours)).chain(points)
}

/// A script in our words, its lines ended. Comments that cannot be translated are dropped.
///
/// # Errors
/// What is not understood, and on which line of the script.
pub(super) fn translate(written: &str, config: &Config) -> Result<String, String> {
    let text = unescaped(written);
    let mut out = String::new();
    // Of each condition that is open: whether its present branch holds, and whether one before has held.
    let mut open: Vec<(bool, bool)> = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let fail = |reason: String| format!("line {} of it {reason}", index + 1);
        let mut made = String::new();
        let mut only_conditions = false;
        let mut rest = line;
        while let Some(at) = rest.find(['{', '[']) {
            let (before, from) = rest.split_at(at);
            if open.iter().all(|branch| branch.0) {
                made += before;
            }
            let close = if from.starts_with('{') { '}' } else { ']' };
            let inside = bracketed(from, close);
            let Some(inside) = inside else {
                if made.contains(';') {
                    made.truncate(made.find(';').unwrap_or_default());
                    rest = "";
                    break;
                }
                return Err(fail("has a bracket that does not close".into()));
            };
            rest = &from[inside.len() + 2..];
            let is_comment = made.contains(';');
            if condition(inside.trim(), config, &mut open).map_err(fail)? {
                only_conditions = true;
            } else if open.iter().all(|branch| branch.0) {
                match placeholder(inside.trim()) {
                    Some(ours) => made += &format!("{{{ours}}}"),
                    None if is_comment => {
                        made.truncate(made.find(';').unwrap_or_default());
                        rest = "";
                    }
                    None => return Err(fail(format!("holds {{{}}}", inside.trim()))),
                }
            }
        }
        if open.iter().all(|branch| branch.0) {
            made += rest;
        }
        let is_paired = |text: &str| text.matches('{').count() == text.matches('}').count();
        let code = made.split(';').next().unwrap_or_default();
        if !is_paired(code) {
            return Err(fail("has a single brace".into()));
        }
        let made = if is_paired(&made) { made.trim_end() } else { code.trim_end() };
        if !(made.is_empty() && (only_conditions || !open.is_empty())) {
            out += made;
            out.push('\n');
        }
    }
    if open.is_empty() { Ok(out) } else { Err("has an {if} without {endif}".into()) }
}

/// What stands in the bracket that a text begins with.
fn bracketed(from: &str, close: char) -> Option<&str> {
    let opening = from.chars().next()?;
    let mut depth = 0;
    for (at, c) in from.char_indices() {
        if c == opening {
            depth += 1;
        } else if c == close {
            depth -= 1;
            if depth == 0 {
                return Some(&from[1..at]);
            }
        }
    }
    None
}

/// Takes part in a condition if this is one: `if`, `elsif`, `else`, `endif`. Whether it was.
fn condition(text: &str, config: &Config, open: &mut Vec<(bool, bool)>) -> Result<bool, String> {
    let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    match (word, open.last_mut()) {
        ("if", _) => {
            let holds = holds(rest, config)?;
            open.push((holds, holds));
        }
        ("elsif", Some(branch)) => {
            branch.0 = !branch.1 && holds(rest, config)?;
            branch.1 |= branch.0;
        }
        ("else", Some(branch)) => *branch = (!branch.1, true),
        ("endif", Some(_)) => {
            open.pop();
        }
        ("elsif" | "else" | "endif", None) => return Err(format!("holds {{{word}}} without {{if}}")),
        _ => return Ok(false),
    }
    Ok(true)
}

/// Whether comparisons of settings with numbers and texts hold, all (`and`) or one (`or`) of them.
fn holds(text: &str, config: &Config) -> Result<bool, String> {
    let text = text.replace("&&", " and ").replace("||", " or ");
    let strange = || format!("depends on {}", text.trim());
    if text.contains(['(', '!', '~', '+', '*', '?']) && !text.contains("!=") {
        return Err(strange());
    }
    let mut any = false;
    for part in text.split(" or ") {
        let mut all = true;
        for comparison in part.split(" and ") {
            all &= compare(comparison.trim(), config).ok_or_else(strange)?;
        }
        any |= all;
    }
    Ok(any)
}

/// One comparison; `None`: not of what the configuration states.
fn compare(text: &str, config: &Config) -> Option<bool> {
    let operators = ["==", "!=", "<>", "<=", ">=", "<", ">"];
    let (at, operator) = operators.iter().find_map(|op| text.find(op).map(|at| (at, *op)))?;
    let (left, right) = (value(&text[..at], config)?, value(&text[at + operator.len()..], config)?);
    let order = match (left.parse::<f64>(), right.parse::<f64>()) {
        (Ok(a), Ok(b)) => a.partial_cmp(&b)?,
        _ => left.cmp(&right),
    };
    Some(match operator {
        "==" => order.is_eq(),
        "!=" | "<>" => order.is_ne(),
        "<=" => order.is_le(),
        ">=" => order.is_ge(),
        "<" => order.is_lt(),
        _ => order.is_gt(),
    })
}

/// A number, a text in quotes, or what the configuration says.
fn value(text: &str, config: &Config) -> Option<String> {
    let text = text.trim();
    if let Some(quoted) = text.strip_prefix('"') {
        return quoted.strip_suffix('"').map(str::to_owned);
    }
    if text.parse::<f64>().is_ok() {
        return Some(text.to_owned());
    }
    let (name, index) = indexed(text);
    (index == 0).then(|| config.first(name).map(|v| v.trim_matches('"').to_owned()))?
}

/// Our placeholder for one of theirs.
fn placeholder(text: &str) -> Option<&'static str> {
    let (name, index) = indexed(text);
    let plain = NAMES.iter().find(|(theirs, _)| *theirs == name).filter(|_| index == 0);
    let point = || POINTS.iter().find(|(theirs, _)| *theirs == name)?.1.get(index).copied();
    plain.map(|(_, ours)| *ours).or_else(point)
}

/// `name`, `name[1]`, `name_1`, and the initial or current tool for 0: the name and the index.
fn indexed(text: &str) -> (&str, usize) {
    if let Some((name, index)) = text.strip_suffix(']').and_then(|t| t.split_once('[')) {
        return match index.trim() {
            "initial_tool" | "initial_extruder" | "current_extruder" => (name.trim(), 0),
            index => (name.trim(), index.parse().unwrap_or(usize::MAX)),
        };
    }
    match text.rsplit_once('_') {
        Some((name, index)) if index.parse::<usize>().is_ok() => (name, index.parse().unwrap_or(0)),
        _ => (text, 0),
    }
}

/// A value as written, its quotes and escapes undone.
fn unescaped(written: &str) -> String {
    let text = written.trim();
    let quoted = text.strip_prefix('"').and_then(|t| t.strip_suffix('"'));
    let mut out = String::new();
    let mut chars = quoted.unwrap_or(text).chars();
    while let Some(c) = chars.next() {
        match (c, c == '\\') {
            (_, true) => match chars.next() {
                Some('n') => out.push('\n'),
                Some('r') | None => {}
                Some('t') => out.push('\t'),
                Some(other) => out.push(other),
            },
            (c, _) => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::{PrintBounds, Settings, expand};

    fn config(text: &str) -> Config {
        Config::parse(&text.lines().map(str::to_owned).collect::<Vec<_>>()).unwrap()
    }

    fn translated(text: &str) -> Result<String, String> {
        translate(text, &config("temperature = 210\nfilament_type = PETG\nnozzle_diameter = 0.4\n"))
    }

    #[test]
    fn placeholders_become_ours() {
        let script =
            "M104 S{first_layer_temperature[0]}\\nM190 S[first_layer_bed_temperature]\\nG1 Z[layer_height]";
        let ours = "M104 S{nozzle_temp}\nM190 S{bed_temp}\nG1 Z{layer_height}\n";
        assert_eq!(translated(script).as_deref(), Ok(ours));
    }

    #[test]
    fn every_name_of_ours_is_a_placeholder() {
        for (_, ours) in names() {
            let known = expand(&format!("{{{ours}}}"), &Settings::default(), PrintBounds::default());
            assert!(known.is_ok(), "{ours}");
        }
    }

    #[test]
    fn conditions_on_the_configuration_are_decided() {
        let script = "{if filament_type[0]==\"PLA\"}M106 S255{elsif filament_type[0]==\"PETG\"}M106 S99{else}M107{endif}\\n\
                      {if nozzle_diameter[0] > 0.5 or temperature < 200}\\nG4\\n{endif}\\nM84";
        assert_eq!(translated(script).as_deref(), Ok("M106 S99\nM84\n"));
    }

    #[test]
    fn what_depends_on_the_print_is_refused_whole() {
        for script in ["M84\\n{if layer_z < 10}G1{endif}", "G1 Z{max_layer_z + 2}", "G1 X[unknown]", "G1 {x"]
        {
            assert!(translated(script).is_err(), "{script}");
        }
        assert!(translated("G28\\nG1 Z{max_layer_z + 2}").unwrap_err().contains("line 2"));
    }

    #[test]
    fn comments_cannot_spoil_a_script() {
        assert_eq!(translated("G28 ; at {day}\\n;{x\\nM84 ; }").as_deref(), Ok("G28\n\nM84\n"));
    }

    #[test]
    fn quotes_and_escapes_are_undone() {
        assert_eq!(unescaped("\"; a \\\"b\\\" \\\\ c\\nM1\""), "; a \"b\" \\ c\nM1");
    }
}
