//! Scripts: names in braces are placeholders, all else is text; in the words of our scripts.

/// Names that Cura has for others.
const RENAMED: [(&str, &str); 4] = [
    ("initial_extruder_nr", "{initial_tool}"),
    ("print_bed_temperature", "{material_bed_temperature}"),
    ("print_temperature", "{material_print_temperature}"),
    ("travel_speed", "{speed_travel}"),
];

/// When a print is made. The day of the week is left out.
const WHEN: [(&str, &str); 3] = [
    ("date", "{zdigits(day,2)}-{zdigits(month,2)}-{zdigits(year,4)}"),
    ("time", "{zdigits(hour,2)}:{zdigits(minute,2)}:{zdigits(second,2)}"),
    ("day", ""),
];

/// A script; `has_several`: settings have a value for each extruder. A placeholder for nothing that is known stays as text where it
/// stands in a comment.
pub(super) fn translated(script: &str, has_several: bool, is_known: impl Fn(&str) -> bool) -> String {
    let mut out = String::with_capacity(script.len());
    for line in script.split_inclusive('\n') {
        let mut rest = line;
        let mut in_comment = false;
        while let Some(at) = rest.find(['{', '[', ';']) {
            out += &rest[..at];
            let end = rest[at..].find('}').map(|length| at + length);
            match (&rest[at..=at], end) {
                ("{", Some(end)) => {
                    out += &placeholder(&rest[at + 1..end], has_several, in_comment, &is_known);
                    rest = &rest[end + 1..];
                    continue;
                }
                (";", _) => {
                    in_comment = true;
                    out.push(';');
                }
                (bracket, _) => out += &text(bracket),
            }
            rest = &rest[at + 1..];
        }
        out += rest;
    }
    out
}

/// What stands between braces: a name, or that of an extruder (`name, 1`); conditions and sums are as ours.
fn placeholder(
    inside: &str,
    has_several: bool,
    in_comment: bool,
    is_known: &impl Fn(&str) -> bool,
) -> String {
    let mut parts = inside.split(',').map(str::trim);
    let name = parts.next().unwrap_or_default();
    // That of another extruder than the one in use.
    let number = parts.next().filter(|number| has_several && number.parse::<usize>().is_ok());
    let is_name = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !is_name || matches!(name, "else" | "endif") {
        return format!("{{{inside}}}");
    }
    let meant = |names: &[(&str, &str)]| {
        names.iter().find(|(theirs, _)| *theirs == name).map(|(_, ours)| (*ours).to_owned())
    };
    if let Some(ours) = meant(&RENAMED).or_else(|| meant(&WHEN)) {
        return ours;
    }
    match number {
        _ if in_comment && !is_known(name) => text(&format!("{{{inside}}}")),
        Some(number) => format!("{{{name}[{number}]}}"),
        None => format!("{{{name}}}"),
    }
}

/// Text as it stands, whatever is in it.
fn text(text: &str) -> String {
    format!("{{\"{}\"}}", text.replace('\\', "\\\\").replace('"', "\\\""))
}

#[cfg(test)]
mod tests {
    use macros::{Names, State, Value, expand};

    use super::*;

    struct Known;

    impl Names for Known {
        fn value(&self, name: &str) -> Option<Value> {
            let number = match name {
                "material_bed_temperature" => 60,
                "material_print_temperature" => 210,
                "day" | "month" => 3,
                "year" => 2026,
                _ => return None,
            };
            Some(Value::Integer(number))
        }

        fn names(&self) -> Vec<String> {
            Vec::new()
        }
    }

    #[test]
    fn placeholders_are_filled_and_all_else_is_text() {
        let known = |name: &str| Known.value(name).is_some();
        for (script, expanded) in [
            ("M140 S{print_bed_temperature}\n", "M140 S60\n"),
            ("M104 T1 S{material_print_temperature, initial_extruder_nr}", "M104 T1 S210"),
            ("G1 Z0.2 ; up [z] {jobname} \"}\"", "G1 Z0.2 ; up [z] {jobname} \"}\""),
            ("; {day} {date}", ";  03-03-2026"),
            ("{if material_bed_temperature > 50}M190{else}M191{endif}", "M190"),
        ] {
            assert_eq!(
                expand(&translated(script, false, known), &Known, &mut State::default()).unwrap(),
                expanded,
                "{script}"
            );
        }
        assert!(
            expand(&translated("G1 F{no_such_speed}", false, known), &Known, &mut State::default()).is_err()
        );
    }
}
