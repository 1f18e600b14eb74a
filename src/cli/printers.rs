//! `pathwright printers`.

use std::collections::BTreeSet;
use std::fmt::Write;

use serde_json::{Value, json};

use super::args::{PrintersArgs, PrintersCommand, ShowPrinterArgs};
use super::console;
use super::exit::{Exit, Failure};
use super::presets;
use crate::presets::{Config, Kind, Library, Listed, PrinterFacts};
use crate::profile::{self, Import, resolve_presets};

pub(super) fn run(args: &PrintersArgs) -> Result<Exit, Failure> {
    match &args.command {
        None => list(args)?,
        Some(PrintersCommand::Show(show)) => self::show(show)?,
    }
    Ok(Exit::Done)
}

/// What a printer's line of the table says.
struct Row {
    name: String,
    bed: String,
    nozzle: String,
    firmware: String,
    from: String,
}

impl Row {
    const HEAD: [&str; 5] = ["printer", "bed (mm)", "nozzle (mm)", "firmware", "from"];

    fn cells(&self) -> [&str; 5] {
        [&self.name, &self.bed, &self.nozzle, &self.firmware, &self.from]
    }
}

fn list(args: &PrintersArgs) -> Result<(), Failure> {
    let library = presets::library(&args.presets)?;
    let words: Vec<String> = args.words.iter().map(|word| word.to_lowercase()).collect();
    let mut seen = BTreeSet::new();
    let mut listed = library.listed(Kind::Printer);
    listed.retain(|printer| seen.insert(printer.name.clone()));
    listed.retain(|printer| {
        let text =
            format!("{} {} {}", printer.name, printer.place.file, printer.dialect.name()).to_lowercase();
        words.iter().all(|word| text.contains(word))
    });
    listed.sort_by_key(|printer| printer.name.to_lowercase());
    if args.json {
        let all = listed.iter().map(|printer| as_json(&library, printer));
        return console::print_json(&all.collect::<Result<Vec<Value>, Failure>>()?);
    }
    if listed.is_empty() {
        let message = format!("no printer's name, file or slicer has the words `{}`", args.words.join(" "));
        return Err(Failure::new(Exit::Settings, message));
    }
    let rows: Vec<Row> = listed.iter().map(|printer| row(&library, printer)).collect();
    console::print(&table(&rows))
}

/// Name, bed and so on of a printer; where it does not resolve, the table says so instead.
fn row(library: &Library, printer: &Listed) -> Row {
    let (name, config) = (printer.name.clone(), library.preset(Kind::Printer, &printer.name));
    let file = printer.place.file.rsplit(['/', '\\']).next().unwrap_or_default();
    let whose = if printer.is_user { "yours, " } else { "" };
    let from = format!("{file} ({whose}{})", printer.dialect.name());
    match config {
        Ok(config) => {
            Row { name, bed: bed(&config), nozzle: nozzle(&config), firmware: firmware(&config), from }
        }
        Err(error) => {
            let empty = String::new;
            Row { name, bed: empty(), nozzle: empty(), firmware: empty(), from: error.to_string() }
        }
    }
}

fn as_json(library: &Library, printer: &Listed) -> Result<Value, Failure> {
    let config = library.preset(Kind::Printer, &printer.name)?;
    let facts = PrinterFacts::of(&config);
    Ok(json!({
        "name": printer.name,
        "bed_mm": facts.bed_mm,
        "height_mm": facts.height_mm,
        "nozzle_mm": facts.nozzle_mm,
        "firmware": facts.firmware,
        "slicer": printer.dialect.name(),
        "user": printer.is_user,
        "file": &*printer.place.file,
        "line": printer.place.line,
    }))
}

fn bed(config: &Config) -> String {
    let facts = PrinterFacts::of(config);
    let Some([x, y]) = facts.bed_mm else { return String::new() };
    let height = facts.height_mm.map(|mm| format!(" x {mm}")).unwrap_or_default();
    let rounded = |mm: f64| (mm * 10.0).round() / 10.0;
    format!("{} x {}{height}", rounded(x), rounded(y))
}

fn nozzle(config: &Config) -> String {
    config.first("nozzle_diameter").unwrap_or_default().to_owned()
}

fn firmware(config: &Config) -> String {
    config.text("gcode_flavor").unwrap_or_default().to_owned()
}

/// Columns as wide as what is in them; the last one as it comes.
fn table(rows: &[Row]) -> String {
    let lines: Vec<[&str; 5]> = std::iter::once(Row::HEAD).chain(rows.iter().map(Row::cells)).collect();
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..4).map(width).collect();
    lines.iter().fold(String::new(), |mut out, [name, bed, nozzle, firmware, from]| {
        let [a, b, c, d] = [widths[0], widths[1], widths[2], widths[3]];
        let _ = writeln!(out, "{name:<a$}  {bed:<b$}  {nozzle:<c$}  {firmware:<d$}  {from}");
        out
    })
}

fn show(args: &ShowPrinterArgs) -> Result<(), Failure> {
    let library = presets::library(&args.presets)?;
    let chosen = library.choose(&args.name, args.print.as_deref(), args.filament.as_deref())?;
    let resolved = resolve_presets(&chosen.config, &[], &[])?;
    console::warn(&resolved.warnings);
    let import = Import::of(&chosen.config);
    let three = [("printer", &chosen.printer), ("print", &chosen.print), ("filament", &chosen.filament)];
    if args.json {
        let mut out = serde_json::Map::new();
        for (kind, listed) in three {
            let place = listed.place.to_string();
            out.insert(kind.into(), json!({ "name": listed.name, "origin": place }));
        }
        let left = import.left.iter().map(|left| {
            let origin = left.place.to_string();
            json!({ "key": left.key, "value": left.value, "reason": left.reason, "origin": origin })
        });
        let config =
            chosen.config.raw.iter().map(|(key, raw)| (key.clone(), Value::from(raw.value.as_str())));
        let config: serde_json::Map<String, Value> = config.collect();
        let more = [
            ("slicer", Value::from(chosen.config.dialect.name())),
            ("notes", json!(chosen.notes)),
            ("settings", profile::dump_json(&resolved)),
            ("left", left.collect()),
            ("config", config.into()),
            ("prints", json!(chosen.prints)),
            ("filaments", json!(chosen.filaments)),
        ];
        out.extend(more.map(|(key, value)| (key.to_owned(), value)));
        return console::print_json(&out);
    }
    let mut out = String::new();
    for (kind, listed) in three {
        let _ = writeln!(out, "# {kind}: {}, {}", listed.name, listed.place);
    }
    for note in &chosen.notes {
        let _ = writeln!(out, "# {note}");
    }
    let (prints, filaments) = (chosen.prints.len(), chosen.filaments.len());
    let _ = writeln!(out, "# {prints} print presets fit, and {filaments} filaments; --json lists them\n");
    out += &profile::dump_toml(&resolved);
    if !import.left.is_empty() {
        out += "\n# Not taken over:\n";
    }
    for left in &import.left {
        let value: String = left.value.chars().take(60).collect();
        let _ = writeln!(out, "# {} = {value}: {} ({})", left.key, left.reason, left.place);
    }
    console::print(&out)
}
