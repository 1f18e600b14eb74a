//! G-code as text → binary G-code.
//!
//! The text is read twice: for what its comments tell, which comes first in the file, and for the lines themselves.

use std::collections::BTreeMap;
use std::io::{self, BufRead, Write};
use std::ops::Range;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::block::{Head, Pairs, SlicerMetadata, Thumbnail};
use crate::comments::{
    CONFIG, GENERATED, JSON_CONFIG, ON, PREPARED, PREPARED_BY, PRODUCED_ON, PRODUCER, config_name,
};
use crate::format::{Encoding, ImageFormat};
use crate::meatpack::survives;
use crate::writer::{Options, Writer};

/// Keys of the printer's metadata that are settings as well: behind the first command, comments with them stay.
const SETTINGS: [&str; 13] = [
    "printer_model",
    "filament_type",
    "filament_abrasive",
    "nozzle_diameter",
    "nozzle_high_flow",
    "bed_temperature",
    "brim_width",
    "fill_density",
    "layer_height",
    "temperature",
    "ironing",
    "support_material",
    "extruder_colour",
];
/// Keys of what is known of the print, wherever they stand; whether the printer's metadata and those of the print have
/// them.
const FACTS: [(&str, bool, bool); 14] = [
    ("max_layer_z", true, false),
    ("filament used [mm]", true, true),
    ("filament used [cm3]", true, true),
    ("filament used [g]", true, true),
    ("filament cost", true, true),
    ("total filament used [g]", false, true),
    ("total filament cost", false, true),
    ("total filament used for wipe tower [g]", true, true),
    ("estimated printing time (normal mode)", true, true),
    ("estimated printing time (silent mode)", true, true),
    ("estimated first layer printing time (normal mode)", false, true),
    ("estimated first layer printing time (silent mode)", false, true),
    ("objects_info", true, false),
    ("total toolchanges", false, true),
];

/// What a text's comments tell, and which of its lines are told by it.
#[derive(Clone, Debug, Default)]
pub struct Contents {
    /// What comes before the G-code.
    pub head: Head,
    /// Numbers of lines, from 0, in order.
    told: Vec<Range<u64>>,
    /// Whether there is a line that MeatPack would change.
    changes: bool,
}

impl Contents {
    /// Reads G-code as text.
    ///
    /// # Errors
    /// Those of reading.
    pub fn of(text: impl BufRead) -> io::Result<Self> {
        let mut scan = Scan::default();
        each_line(text, |line| {
            scan.line(line);
            Ok(())
        })?;
        Ok(scan.finish())
    }

    /// Adds metadata where the text has none of their keys, and settings where it has none.
    pub fn add(&mut self, printer: Pairs, slicer: Pairs) {
        for (key, value) in printer {
            if self.head.printer.iter().all(|(known, _)| *known != key) {
                self.head.printer.push((key, value));
            }
        }
        if self.head.slicer.is_empty() && !slicer.is_empty() {
            self.head.slicer.push(SlicerMetadata::Pairs(slicer));
        }
    }
}

/// Writes G-code, whose contents have been read, as binary G-code. Where MeatPack would change a line of it, none is
/// encoded: firmware wants all blocks to have the same encoding.
///
/// # Errors
/// Those of reading and writing.
pub fn pack<W: Write>(contents: &Contents, text: impl BufRead, options: Options, out: W) -> io::Result<W> {
    let encoding = if contents.changes { Encoding::None } else { options.encoding };
    let mut writer = Writer::new(out, Options { encoding, ..options }, &contents.head)?;
    let (mut number, mut told) = (0, contents.told.iter().peekable());
    each_line(text, |line| {
        while told.next_if(|lines| lines.end <= number).is_some() {}
        if !told.peek().is_some_and(|lines| lines.contains(&number)) {
            writer.line(line)?;
        }
        number += 1;
        Ok(())
    })?;
    writer.finish()
}

fn each_line(mut text: impl BufRead, mut take: impl FnMut(&[u8]) -> io::Result<()>) -> io::Result<()> {
    let mut line = Vec::new();
    while text.read_until(b'\n', &mut line)? > 0 {
        take(&line)?;
        line.clear();
    }
    Ok(())
}

/// Something that takes several lines.
enum Open {
    Picture { tag: &'static str, picture: Thumbnail, length: usize, base64: String },
    Settings { name: String, pairs: Pairs },
    Json { name: String, text: String },
}

#[derive(Default)]
struct Scan {
    contents: Contents,
    /// The line that comes next.
    number: u64,
    /// Whether there was a command.
    begun: bool,
    settings: BTreeMap<&'static str, String>,
    facts: BTreeMap<&'static str, String>,
    /// What is open, and the line where it began.
    open: Option<(u64, Open)>,
}

impl Scan {
    fn line(&mut self, line: &[u8]) {
        let number = self.number;
        self.number += 1;
        self.contents.changes |= !survives(line.strip_suffix(b"\n").unwrap_or(line));
        let line = line.trim_ascii();
        let comment = line.strip_prefix(b";").and_then(|text| std::str::from_utf8(text).ok());
        let Some(comment) = comment.map(str::trim) else {
            self.begun |= !line.is_empty() && line[0] != b';';
            // Comments alone are told by metadata.
            if !line.is_empty() {
                self.open = None;
            }
            return;
        };
        match self.open.take() {
            Some((from, open)) => self.inside(from, open, comment, number),
            None => self.outside(comment, number),
        }
    }

    fn outside(&mut self, comment: &str, number: u64) {
        if let Some(open) = opened(comment) {
            self.open = Some((number, open));
            return;
        }
        let told = match comment.split_once('=') {
            // What stands round pictures.
            None if comment.is_empty() => !self.begun,
            Some((key, value)) => self.pair(key.trim(), value.trim()),
            None => self.producer(comment),
        };
        if told {
            self.tell(number..number + 1);
        }
    }

    fn producer(&mut self, comment: &str) -> bool {
        let file = &mut self.contents.head.file;
        let mut put = |key: &str, value: &str| {
            let is_new = !self.begun && !value.is_empty() && file.iter().all(|(known, _)| known != key);
            if is_new {
                file.push((key.to_owned(), value.to_owned()));
            }
            is_new
        };
        if let Some(text) = comment.strip_prefix(GENERATED) {
            let (producer, date) = text.split_once(ON).unwrap_or((text, ""));
            let told = put(PRODUCER, producer);
            if told {
                put(PRODUCED_ON, date);
            }
            return told;
        }
        comment.strip_prefix(PREPARED).is_some_and(|by| put(PREPARED_BY, by))
    }

    /// Whether a pair is told by metadata, and need not be said again.
    fn pair(&mut self, key: &str, value: &str) -> bool {
        if value.is_empty() {
            return false;
        }
        if let Some(key) = SETTINGS.into_iter().find(|known| *known == key) {
            let known = self.settings.entry(key).or_insert_with(|| value.to_owned());
            return !self.begun && known == value;
        }
        match FACTS.into_iter().find(|(known, ..)| *known == key) {
            Some((key, ..)) => self.facts.entry(key).or_insert_with(|| value.to_owned()) == value,
            None => false,
        }
    }

    /// A line of something that is open. What does not end well stays as it is.
    fn inside(&mut self, from: u64, mut open: Open, comment: &str, number: u64) {
        let ended = match &mut open {
            Open::Picture { tag, length, base64, .. } => {
                if comment.strip_prefix(&**tag).is_some_and(|rest| rest.trim() == "end") {
                    true
                } else if base64.len() + comment.len() > *length {
                    return;
                } else {
                    *base64 += comment;
                    false
                }
            }
            Open::Settings { name, pairs } => match comment.split_once('=') {
                Some((key, value)) if is_mark(key, value, name, CONFIG, "end") => true,
                Some((key, value)) => {
                    pairs.push((key.trim().to_owned(), value.trim().to_owned()));
                    false
                }
                None => return,
            },
            Open::Json { name, text } => {
                let mark = comment.split_once('=');
                let ended = mark.is_some_and(|(key, value)| is_mark(key, value, name, JSON_CONFIG, "end"));
                if !ended {
                    *text += &format!("{}{comment}", if text.is_empty() { "" } else { "\n" });
                }
                ended
            }
        };
        if !ended {
            self.open = Some((from, open));
        } else if self.close(open) {
            self.tell(from..number + 1);
        }
    }

    /// Whether something that ended is told by metadata.
    fn close(&mut self, open: Open) -> bool {
        let head = &mut self.contents.head;
        let most_slicers = 2;
        match open {
            Open::Picture { mut picture, length, base64, .. } => match STANDARD.decode(&base64) {
                Ok(data) if base64.len() == length => {
                    picture.data = data;
                    head.thumbnails.push(picture);
                    true
                }
                _ => false,
            },
            Open::Settings { name, .. } | Open::Json { name, .. }
                if name != config_name(&head.file) || head.slicer.len() == most_slicers =>
            {
                false
            }
            Open::Settings { pairs, .. } => {
                head.slicer.push(SlicerMetadata::Pairs(pairs));
                true
            }
            Open::Json { text, .. } => {
                head.slicer.push(SlicerMetadata::Json(text));
                true
            }
        }
    }

    fn tell(&mut self, lines: Range<u64>) {
        match self.contents.told.last_mut() {
            Some(last) if last.end == lines.start => last.end = lines.end,
            _ => self.contents.told.push(lines),
        }
    }

    fn finish(mut self) -> Contents {
        let head = &mut self.contents.head;
        for key in SETTINGS {
            head.printer.extend(self.settings.remove(key).map(|value| (key.to_owned(), value)));
        }
        for (key, printer, print) in FACTS {
            let pair = self.facts.remove(key).map(|value| (key.to_owned(), value));
            head.printer.extend(pair.clone().filter(|_| printer));
            head.print.extend(pair.filter(|_| print));
        }
        self.contents
    }
}

/// What a comment opens that takes several lines.
fn opened(comment: &str) -> Option<Open> {
    if let Some((key, value)) = comment.split_once('=') {
        let (key, begins) = (key.trim(), value.trim() == "begin");
        let name = key.strip_suffix(JSON_CONFIG).filter(|_| begins);
        if let Some(name) = name {
            return Some(Open::Json { name: name.to_owned(), text: String::new() });
        }
        let name = key.strip_suffix(CONFIG).filter(|_| begins)?;
        return Some(Open::Settings { name: name.to_owned(), pairs: Pairs::new() });
    }
    for format in ImageFormat::ALL {
        let tag = format.tag();
        let rest = comment.strip_prefix(tag).and_then(|rest| rest.strip_prefix(" begin "));
        if let Some((size, length)) = rest.and_then(|rest| rest.trim().split_once(' ')) {
            let (width, height) = size.split_once('x')?;
            let (width, height) = (width.parse().ok()?, height.parse().ok()?);
            let picture = Thumbnail { format, width, height, data: Vec::new() };
            return Some(Open::Picture {
                tag,
                picture,
                length: length.trim().parse().ok()?,
                base64: String::new(),
            });
        }
    }
    None
}

fn is_mark(key: &str, value: &str, name: &str, ending: &str, word: &str) -> bool {
    key.trim().strip_suffix(ending) == Some(name) && value.trim() == word
}
