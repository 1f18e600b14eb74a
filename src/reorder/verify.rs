//! The proof that a reordered file prints what the file printed before.

use std::hash::Hasher;
use std::io::{self, BufRead};

use rustc_hash::FxHasher;

use super::reader::{is_time, read_line};
use super::state::Key;
use super::ticks::ticks;
use crate::gcode::{Action, Line, Measure, Meter, Reader};
use crate::units::Mm;

/// Filament of a layer may differ by this, mm.
const FILAMENT_MM: f64 = 1e-4;
/// Travel may leave the area that the file used by this, mm.
const AREA_MM: f64 = 1e-3;

/// What two files come to.
#[derive(Clone, Debug)]
pub struct Proof {
    /// The file as it was.
    pub before: Measure,
    /// The file as it is.
    pub after: Measure,
    /// Layers compared.
    pub layers: usize,
}

/// Compares two files layer by layer: the same extruded strokes, in whatever order and direction, each with its
/// width, type, filament, feed rate and accelerations; the same filament; the same other commands in the same order;
/// all travel within the area that the first file used.
///
/// `both` calls two functions, at once if it can.
///
/// # Errors
/// The first difference, with its layer; or what the system says.
pub fn verify(
    before: impl BufRead + Send,
    after: impl BufRead + Send,
    both: impl Fn(&mut (dyn FnMut() + Send), &mut (dyn FnMut() + Send)),
) -> io::Result<Result<Proof, String>> {
    let (mut before, mut after) = (Layers::new(before), Layers::new(after));
    let mut layers = 0;
    loop {
        let (mut a, mut b) = (Ok(None), Ok(None));
        both(&mut || a = before.sorted(), &mut || b = after.sorted());
        let (a, b) = match (a?, b?) {
            (None, None) => break,
            (Some(a), Some(b)) => (a, b),
            _ => return Ok(Err("the number of layers differs".into())),
        };
        if let Some(difference) = a.difference(&b) {
            return Ok(Err(format!("layer {layers}: {difference}")));
        }
        layers += 1;
    }
    let within = (0..2).all(|i| {
        after.low[i] >= before.low[i] - AREA_MM && after.high[i] <= before.high[i] + AREA_MM
            || after.low[i] > after.high[i]
    });
    if !within {
        return Ok(Err("a travel leaves the area that the file used".into()));
    }
    Ok(Ok(Proof { before: before.meter.finish(), after: after.meter.finish(), layers }))
}

/// An extruded stroke: its ends in no order, then all that must not differ.
type Stroke = [i64; 10];

/// What one layer holds.
struct Layer {
    index: Option<usize>,
    strokes: Vec<Stroke>,
    filament_mm: f64,
    /// Other commands, in their order.
    commands: FxHasher,
}

impl Layer {
    fn new(index: Option<usize>) -> Self {
        Self { index, strokes: Vec::new(), filament_mm: 0.0, commands: FxHasher::default() }
    }

    fn difference(&self, other: &Self) -> Option<String> {
        if self.strokes.len() != other.strokes.len() {
            return Some(format!("{} strokes became {}", self.strokes.len(), other.strokes.len()));
        }
        if let Some((a, _)) = self.strokes.iter().zip(&other.strokes).find(|(a, b)| a != b) {
            let [x, y] = [a[0], a[1]].map(super::ticks::units);
            return Some(format!("a stroke at X{x} Y{y} is not what it was"));
        }
        if (self.filament_mm - other.filament_mm).abs() > FILAMENT_MM {
            return Some(format!("{} mm of filament became {} mm", self.filament_mm, other.filament_mm));
        }
        (self.commands.finish() != other.commands.finish())
            .then(|| "other commands are not what they were".into())
    }
}

/// A file, layer by layer.
struct Layers<R> {
    input: R,
    text: Vec<u8>,
    number: usize,
    reader: Reader,
    meter: Meter,
    layer: Layer,
    /// Lines that set what holds for strokes, and their hash.
    states: Vec<(Key, Vec<u8>)>,
    state: i64,
    low: [f64; 2],
    high: [f64; 2],
    done: bool,
}

impl<R: BufRead> Layers<R> {
    fn new(input: R) -> Self {
        Self {
            input,
            text: Vec::new(),
            number: 0,
            reader: Reader::default(),
            // Only lengths and counts are looked at.
            meter: Meter::new(Mm(1.75), None),
            layer: Layer::new(None),
            states: Vec::new(),
            state: 0,
            low: [f64::INFINITY; 2],
            high: [f64::NEG_INFINITY; 2],
            done: false,
        }
    }

    /// The next layer, its strokes in an order that does not depend on how they are drawn.
    fn sorted(&mut self) -> io::Result<Option<Layer>> {
        let mut layer = self.next()?;
        if let Some(layer) = &mut layer {
            layer.strokes.sort_unstable();
        }
        Ok(layer)
    }

    fn next(&mut self) -> io::Result<Option<Layer>> {
        while !self.done {
            self.text.clear();
            if read_line(&mut self.input, &mut self.text)? == 0 {
                self.done = true;
                return Ok(Some(std::mem::replace(&mut self.layer, Layer::new(None))));
            }
            self.number += 1;
            let text = std::mem::take(&mut self.text);
            let done = self.line(&Line::new(self.number, 0, &text));
            self.text = text;
            if done.is_some() {
                return Ok(done);
            }
        }
        Ok(None)
    }

    /// Takes up a line; returns the layer that it ends.
    fn line(&mut self, line: &Line) -> Option<Layer> {
        let read = self.reader.read(*line);
        self.meter.add(&read.action);
        let Action::Stroke(stroke) = read.action else {
            self.other(line, matches!(read.action, Action::FirmwareRetract | Action::FirmwareUnretract));
            return None;
        };
        for i in 0..2 {
            self.low[i] = self.low[i].min(stroke.to[i]);
            self.high[i] = self.high[i].max(stroke.to[i]);
        }
        if !stroke.extrudes() {
            return None;
        }
        let mut done = None;
        if self.layer.index != read.context.layer {
            done = Some(std::mem::replace(&mut self.layer, Layer::new(read.context.layer)));
        }
        let point = |p: [f64; 3]| [ticks(p[0]), ticks(p[1])];
        let (mut a, mut b) = (point(stroke.from), point(stroke.to));
        let mut turn = stroke.arc.map_or(0, |arc| if arc.clockwise { 1 } else { 2 });
        if a > b {
            (a, b) = (b, a);
            turn = if turn == 0 { 0 } else { 3 - turn };
        }
        let pulled = i64::from(self.reader.state.firmware_retracted);
        self.layer.filament_mm += stroke.fresh_mm;
        self.layer.strokes.push([
            a[0],
            a[1],
            b[0],
            b[1],
            ticks(stroke.to[2]),
            ticks(stroke.e_mm),
            ticks(stroke.fresh_mm),
            ticks(stroke.feed_mm_s * 60.0),
            turn + 4 * pulled,
            self.state,
        ]);
        done
    }

    /// Takes up a line that does not move.
    fn other(&mut self, line: &Line, firmware: bool) {
        if firmware || is_time(line) || line.is(b'G', 92) && line.words().get(b'E').is_some() {
            return;
        }
        if let Some(key) = Key::of(line) {
            let text = line.text.trim_ascii_end().to_vec();
            self.states.retain(|(known, _)| *known != key && !key.replaces(*known));
            self.states.push((key, text));
            self.states.sort_by_key(|(key, _)| key.index());
            let mut hasher = FxHasher::default();
            self.states.iter().for_each(|(_, text)| hasher.write(text));
            self.state = hasher.finish() as i64;
            return;
        }
        let command = line.text.split(|b| *b == b';').next().unwrap_or_default().trim_ascii();
        if !command.is_empty() {
            self.layer.commands.write(command);
        }
    }
}
