//! Settings in binary G-code, and out of G-code again.

use std::io::{self, BufRead};
use std::path::Path;

use toml::{Table, Value};

use super::settings::Settings;
use super::tools::Tool;
use crate::gcode::{self, BinaryMetadata};

/// The marks around them in text: what `bgcode` makes of the first word of the header.
const MARK: &str = "; pathwright_config =";

/// What binary G-code tells of settings: to the printer what it checks, and all of them for whoever prints it again.
pub fn binary_metadata(settings: &Settings) -> BinaryMetadata {
    let flag = |on: bool| u8::from(on).to_string();
    let printer = [
        ("bed_temperature", settings.temperature.bed.0.to_string()),
        ("brim_width", settings.brim.width.0.to_string()),
        ("fill_density", format!("{}%", (settings.infill.density.0 * 1e4).round() / 1e2)),
        ("temperature", settings.temperature.nozzle.0.to_string()),
        ("ironing", flag(settings.ironing.enabled)),
        ("support_material", flag(settings.support.enabled)),
    ];
    let values = Table::try_from(settings).expect("settings are a table");
    let slicer = settings.keys_that_matter().map(|(section, field)| {
        (format!("{}.{}", section.name, field.name), one_line(&values[section.name][field.name]))
    });
    let of_tool = |(number, tool): (usize, &Tool)| -> Vec<(String, String)> {
        tool.own().map(|(key, value)| (format!("tools.{number}.{key}"), one_line(value))).collect()
    };
    let slicer = slicer.chain((1..).zip(&settings.tools).flat_map(of_tool));
    BinaryMetadata {
        printer: printer.map(|(key, value)| (key.to_owned(), value)).into(),
        slicer: slicer.collect(),
    }
}

/// A value as TOML without line ends.
fn one_line(value: &Value) -> String {
    match value {
        // JSON quotes texts as TOML does.
        Value::String(text) => serde_json::Value::from(text.as_str()).to_string(),
        value => value.to_string(),
    }
}

/// The settings that are told by G-code of ours, as a profile; `None` if there are none.
///
/// # Errors
/// Those of reading.
pub(super) fn told(path: &Path) -> io::Result<Option<String>> {
    let (mut lines, mut line, mut told) = (gcode::open(path)?, Vec::new(), None::<String>);
    while lines.read_until(b'\n', &mut line)? > 0 {
        let text = String::from_utf8_lossy(line.trim_ascii());
        match (text.strip_prefix(MARK).map(str::trim), &mut told) {
            (Some("begin"), _) => told = Some(String::new()),
            (Some("end"), Some(_)) => return Ok(told),
            (_, Some(told)) => *told += &format!("{}\n", text.trim_start_matches([';', ' '])),
            _ => {}
        }
        line.clear();
    }
    Ok(None)
}
