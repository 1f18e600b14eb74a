//! A file beside what a host says of its printer.

use std::io::{self, BufRead};

use super::entry::HostKind;
use super::error::{Cause, SendError, Step};
use super::host::About;
use super::payload::Payload;
use crate::check::{self, Severity};
use crate::gcode::Form;
use crate::plate::{BedOrigin, BedSettings, BedShape};
use crate::profile::Settings;
use crate::units::{Mm, Mm3PerS};

/// Diameters of nozzles that are told are rounded.
const NOZZLE_SLACK_MM: f64 = 0.011;
/// Side of a bed that no printer's is larger than.
const ANY_BED_MM: f64 = 1000.0;

/// What a file says of the printer that it is for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FileFacts {
    /// Diameter of the nozzle, mm.
    pub nozzle_mm: Option<f64>,
    /// The printer's name or model.
    pub printer: Option<String>,
    /// A command that Klipper alone knows.
    pub klipper_command: Option<String>,
    /// How it holds G-code.
    pub form: Form,
}

impl FileFacts {
    /// Reads the comments and commands of a file of any slicer.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn read(payload: &Payload) -> io::Result<Self> {
        let mut facts = Self { form: payload.form(), ..Self::default() };
        let mut file = payload.text()?;
        let mut line = Vec::new();
        while file.read_until(b'\n', &mut line)? > 0 {
            facts.line(&line);
            line.clear();
        }
        Ok(facts)
    }

    fn line(&mut self, line: &[u8]) {
        if let Some(comment) = line.strip_prefix(b";") {
            let Some(at) = comment.iter().position(|byte| *byte == b'=').filter(|at| *at < 40) else {
                return;
            };
            let key = comment[..at].trim_ascii();
            let value = String::from_utf8_lossy(comment[at + 1..].trim_ascii()).into_owned();
            match key {
                b"nozzle_diameter" => {
                    self.nozzle_mm = value.split([',', ';']).next().and_then(|one| one.trim().parse().ok())
                }
                b"printer_model" if !value.is_empty() => self.printer = Some(value),
                _ => {}
            }
        } else if self.klipper_command.is_none() && is_klipper(line) {
            let word = line.split(|byte| byte.is_ascii_whitespace()).next().unwrap_or_default();
            self.klipper_command = Some(String::from_utf8_lossy(word).into_owned());
        }
    }
}

/// Whether a line has a command of letters with underscores, as Klipper alone has them.
fn is_klipper(line: &[u8]) -> bool {
    const KNOWN: [&[u8]; 4] = [b"EXCLUDE_OBJECT", b"SET_", b"TIMELAPSE_", b"START_PRINT"];
    KNOWN.iter().any(|known| line.starts_with(known)) && line.contains(&b'_')
}

/// Compares a file with a printer. What may be a mistake but need not be is returned as a warning.
///
/// # Errors
/// The file is for another printer: which, and what to do.
pub fn examine(
    host: &str,
    kind: HostKind,
    about: &About,
    facts: &FileFacts,
) -> Result<Vec<String>, SendError> {
    let refuse = |message: String, advice: &str| {
        Err(SendError::new(host, Step::Examine, Cause::Mismatch, message, advice))
    };
    if facts.form == Form::Binary && matches!(kind, HostKind::Moonraker | HostKind::Duet) {
        return refuse("it does not read binary G-code".into(), "slice into a .gcode file");
    }
    if facts.form == Form::Package {
        return refuse(
            "it reads no package with G-code".into(),
            "make text of it with `pathwright reorder FILE -o part.gcode`; --no-check sends it all the same",
        );
    }
    if let (Some(command), HostKind::PrusaLink | HostKind::Duet) = (&facts.klipper_command, kind) {
        let message = format!("the file has {command}, which only Klipper knows");
        return refuse(message, "slice it for this printer, with its own printer.flavor");
    }
    if let Some(nozzle_mm) = facts.nozzle_mm
        && !about.nozzles_mm.is_empty()
        && !about.nozzles_mm.iter().any(|told| (told - nozzle_mm).abs() < NOZZLE_SLACK_MM)
    {
        let told: Vec<String> = about.nozzles_mm.iter().map(|mm| format!("{mm} mm")).collect();
        let message =
            format!("the file is for a nozzle of {nozzle_mm} mm, and the printer's is {}", told.join(", "));
        return refuse(
            message,
            "slice it for this nozzle, or correct the nozzle in the host's settings; --no-check sends it all the same",
        );
    }
    let mut warnings = Vec::new();
    if let (Some(file), Some(told)) = (&facts.printer, &about.printer)
        && !has_common_word(file, told)
    {
        warnings.push(format!("the file is for the printer `{file}`, and {host} calls its printer `{told}`"));
    }
    Ok(warnings)
}

/// Whether two names share a word; those without digits that slicers and hosts have for any printer do not count as names.
fn has_common_word(a: &str, b: &str) -> bool {
    let words = |text: &str| -> Vec<String> {
        let lower = text.to_lowercase();
        lower.split(|c: char| !c.is_alphanumeric()).filter(|word| word.len() > 1).map(str::to_owned).collect()
    };
    let (a, b) = (words(a), words(b));
    let is_any = |words: &[String]| {
        words.is_empty() || words.iter().any(|word| matches!(word.as_str(), "generic" | "reprap"))
    };
    let joined = |words: &[String]| words.concat();
    is_any(&a)
        || is_any(&b)
        || a.iter().any(|word| b.contains(word))
        || joined(&a).contains(&joined(&b))
        || joined(&b).contains(&joined(&a))
}

/// Checks a file for the printer of a host: its bed is the one that the host tells, or that of the settings; without both
/// there is none beside which something could lie.
///
/// # Errors
/// It cannot be read, is no G-code, or has an error.
pub fn check(
    host: &str,
    payload: &Payload,
    about: &About,
    settings: Option<Settings>,
) -> Result<(), SendError> {
    let mut settings = settings.unwrap_or_else(any_printer);
    if let Some(bed) = bed_of(about) {
        settings.bed = bed;
    }
    let fail = |cause, message: String, advice: &str| {
        Err(SendError::new(host, Step::Examine, cause, format!("{payload}: {message}"), advice))
    };
    let report = match payload.text().and_then(|text| check::check(text, &settings, None)) {
        Err(error) => return Err(unreadable(host, payload, &error)),
        Ok(None) => return fail(Cause::File, "there are no moves in it; is it G-code?".into(), ""),
        Ok(Some(report)) if report.errors == 0 => return Ok(()),
        Ok(Some(report)) => report,
    };
    let errors = report.faults.iter().filter(|fault| fault.severity == Severity::Error);
    let told: Vec<String> = errors
        .map(|fault| {
            let first = fault.first.first();
            let place =
                first.map_or_else(String::new, |place| format!(" (line {}: {})", place.line, place.detail));
            format!("{}{place}", fault.kind.text())
        })
        .collect();
    fail(Cause::Mismatch, told.join(", "), "slice it for this printer, or send it with --no-check")
}

/// A file that cannot be read.
pub(super) fn unreadable(host: &str, payload: &Payload, error: &io::Error) -> SendError {
    SendError::new(host, Step::Examine, Cause::File, format!("{payload}: {error}"), "")
}

/// A printer of which nothing is known.
fn any_printer() -> Settings {
    let mut settings = Settings::default();
    settings.filament.max_flow = Mm3PerS(0.0);
    settings.bed = any_bed();
    settings
}

/// A bed that no printer's is larger than.
fn any_bed() -> BedSettings {
    let side = Mm(ANY_BED_MM);
    BedSettings { size: [side; 2], height: side, origin: BedOrigin::Center, ..BedSettings::default() }
}

/// The bed that a host tells, as settings.
fn bed_of(about: &About) -> Option<BedSettings> {
    let volume = about.volume?;
    let size = [0, 1].map(|axis| Mm(volume.high[axis] - volume.low[axis]));
    Some(BedSettings {
        excluded: Vec::new(),
        shape: if volume.is_round { BedShape::Round } else { BedShape::Rectangular },
        size,
        height: Mm(volume.high[2]),
        origin: BedOrigin::Corner,
        offset: [Mm(volume.low[0]), Mm(volume.low[1])],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facts(text: &str) -> FileFacts {
        let mut facts = FileFacts::default();
        text.lines().for_each(|line| facts.line(line.as_bytes()));
        facts
    }

    #[test]
    fn a_file_for_another_nozzle_or_firmware_is_refused() {
        let facts = facts(
            "G28\nSET_PRESSURE_ADVANCE ADVANCE=0.04\n; nozzle_diameter = 0.6\n; printer_model = MK4S\n",
        );
        let about = About { nozzles_mm: vec![0.4], printer: Some("mk4s".into()), ..About::default() };
        let refused = |kind, about: &About| examine("a", kind, about, &facts).unwrap_err().to_string();
        assert!(refused(HostKind::Duet, &about).contains("SET_PRESSURE_ADVANCE"));
        assert!(refused(HostKind::Moonraker, &about).contains("0.6 mm, and the printer's is 0.4 mm"));
        let about = About { nozzles_mm: vec![0.4, 0.6], ..about };
        assert!(examine("a", HostKind::Moonraker, &about, &facts).unwrap().is_empty());
    }

    #[test]
    fn a_package_is_refused_by_every_host() {
        let facts = FileFacts { form: Form::Package, ..FileFacts::default() };
        let refused = examine("a", HostKind::OctoPrint, &About::default(), &facts).unwrap_err().to_string();
        assert!(refused.contains("no package") && refused.contains("pathwright reorder"), "{refused}");
    }

    #[test]
    fn printers_are_told_apart_by_their_words() {
        assert!(has_common_word("Original Prusa MK4", "PrusaMK4"));
        assert!(has_common_word("Generic RepRap", "voron"));
        assert!(!has_common_word("Ender 3", "Voron 2.4"));
    }
}
