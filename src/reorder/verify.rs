//! The proof that a reordered file prints what the file printed before.

use std::hash::Hasher;
use std::io::{self, BufRead, ErrorKind};

use memchr::memchr2;
use rustc_hash::FxHasher;

use super::lines::{LONGEST_LINE, binary, too_long};
use super::state::Key;
use super::ticks::ticks;
use super::times::{Stopwatch, Times, is_time};
use crate::estimate::Machine;
use crate::gcode::{Action, Annotated, Line, Measure, Meter, Reader, State, Stroke};
use crate::units::Mm;

/// Beads may begin with this much more filament pulled back than in the file, mm.
const SHORT_MM: f64 = 1e-4;
/// Travel may leave the area that the file used by this, mm.
const AREA_MM: f64 = 1e-3;

/// The sums of two files.
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
/// # Errors
/// The first difference, with its layer; or what the system says.
pub fn verify(before: impl BufRead, after: impl BufRead) -> io::Result<Result<Proof, String>> {
    let [mut old, mut new] = [(); 2].map(|()| Readback::default());
    old.read(before, |_, _| ())?;
    new.read(after, |_, _| ())?;
    Ok(old.finish().compare(new.finish()))
}

/// Adds a file piece by piece.
#[derive(Debug, Default)]
pub struct Readback {
    reader: Reader,
    number: usize,
    /// The beginning of a line of which the rest has not been read.
    begun: Vec<u8>,
    inventory: Inventory,
}

impl Readback {
    /// Also measures when lines about time come, on this machine.
    pub fn timed(machine: Option<&Machine>) -> Self {
        Self { inventory: Inventory::timed(machine), ..Self::default() }
    }

    /// Reads on. The input ends with a line, or with the file. Every line is also given to somebody else, with what the
    /// machine has in mind after it.
    ///
    /// # Errors
    /// As the system says; and where the bytes cannot be G-code.
    pub fn read(
        &mut self,
        mut input: impl BufRead,
        mut also: impl FnMut(&mut Annotated<'_>, &State),
    ) -> io::Result<()> {
        loop {
            let buffer = match input.fill_buf() {
                Ok([]) => break,
                Ok(buffer) => buffer,
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => return Err(error),
            };
            let mut rest = buffer;
            while let Some(at) = memchr2(b'\n', 0, rest) {
                if rest[at] == 0 {
                    return Err(binary(self.number + 1));
                }
                let (line, next) = rest.split_at(at + 1);
                if self.begun.is_empty() {
                    self.line(line, &mut also);
                } else {
                    self.begun.extend_from_slice(line);
                    self.end_line(&mut also);
                }
                rest = next;
            }
            self.begun.extend_from_slice(rest);
            if self.begun.len() > LONGEST_LINE {
                return Err(too_long());
            }
            let used = buffer.len();
            input.consume(used);
        }
        if !self.begun.is_empty() {
            self.end_line(&mut also);
        }
        Ok(())
    }

    /// Adds the line that was begun.
    fn end_line(&mut self, also: &mut impl FnMut(&mut Annotated<'_>, &State)) {
        let line = std::mem::take(&mut self.begun);
        self.line(&line, also);
        self.begun = line;
        self.begun.clear();
    }

    fn line(&mut self, line: &[u8], also: &mut impl FnMut(&mut Annotated<'_>, &State)) {
        self.number += 1;
        let mut read = self.reader.read(Line::new(self.number, 0, line));
        self.inventory.add(&read, &self.reader.state);
        also(&mut read, &self.reader.state);
    }

    /// What was read.
    pub fn finish(self) -> Inventory {
        self.inventory
    }
}

/// A summary of what a file prints, in memory of some numbers for each layer and each line about time.
#[derive(Debug)]
pub struct Inventory {
    meter: Meter,
    stopwatch: Option<Stopwatch>,
    /// Layers that are complete, and the one at hand.
    layers: Vec<Layer>,
    layer: Layer,
    /// Lines that set what holds for strokes, and their hash.
    states: Vec<(Key, Vec<u8>)>,
    state: i64,
    low: [f64; 2],
    high: [f64; 2],
    /// Filament pulled back at the moment, and the most with which a bead begins.
    retracted_mm: f64,
    short_mm: f64,
}

impl Default for Inventory {
    fn default() -> Self {
        Self {
            // Only lengths and counts are looked at.
            meter: Meter::new(Mm(1.75), None),
            stopwatch: None,
            layers: Vec::new(),
            layer: Layer::default(),
            states: Vec::new(),
            state: 0,
            low: [f64::INFINITY; 2],
            high: [f64::NEG_INFINITY; 2],
            retracted_mm: 0.0,
            short_mm: 0.0,
        }
    }
}

impl Inventory {
    pub(super) fn timed(machine: Option<&Machine>) -> Self {
        Self { stopwatch: machine.map(Stopwatch::new), ..Self::default() }
    }

    /// When lines about time come, if that was measured.
    pub fn take_times(&mut self) -> Option<Times> {
        self.stopwatch.take().map(Stopwatch::finish)
    }

    /// Processes a line. `state`: of the machine after it.
    pub(super) fn add(&mut self, read: &Annotated, state: &State) {
        let retracted_mm = std::mem::replace(&mut self.retracted_mm, state.retracted_mm);
        self.meter.add(&read.action);
        if let Some(stopwatch) = &mut self.stopwatch {
            stopwatch.step(read);
        }
        let Action::Stroke(stroke) = &read.action else {
            return self.other(&read.line, &read.action);
        };
        // A bead may be drawn backwards.
        let extrudes = stroke.extrudes();
        let other_end = if extrudes { stroke.from } else { stroke.to };
        for (i, (&a, &b)) in stroke.to.iter().zip(&other_end).take(2).enumerate() {
            self.low[i] = self.low[i].min(a).min(b);
            self.high[i] = self.high[i].max(a).max(b);
        }
        if extrudes {
            if self.layer.index != read.context.layer {
                let next = Layer { index: read.context.layer, ..Layer::default() };
                self.layers.push(std::mem::replace(&mut self.layer, next));
            }
            self.layer.strokes += 1;
            let sum = self.layer.sum;
            self.layer.sum = sum.wrapping_add(fingerprint(stroke, state.firmware_retracted, self.state));
            self.short_mm = self.short_mm.max(retracted_mm);
        }
    }

    /// Processes a line that does not move.
    fn other(&mut self, line: &Line, action: &Action) {
        let firmware = matches!(action, Action::FirmwareRetract | Action::FirmwareUnretract);
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
            let mut hasher = FxHasher::default();
            hasher.write_u64(self.layer.commands);
            hasher.write(command);
            self.layer.commands = hasher.finish();
        }
    }

    /// The proof that another file prints the same.
    ///
    /// # Errors
    /// The first difference, with its layer.
    pub fn compare(mut self, mut other: Self) -> Result<Proof, String> {
        for inventory in [&mut self, &mut other] {
            inventory.layers.push(std::mem::take(&mut inventory.layer));
        }
        for (index, (a, b)) in self.layers.iter().zip(&other.layers).enumerate() {
            a.same(b).map_err(|difference| format!("layer {index}: {difference}"))?;
        }
        if self.layers.len() != other.layers.len() {
            return Err("the number of layers differs".into());
        }
        if other.short_mm > self.short_mm + SHORT_MM {
            return Err(format!(
                "a bead begins while {:.3} mm of filament are pulled back, not {:.3} mm at most",
                other.short_mm, self.short_mm
            ));
        }
        let within = |i: usize| {
            other.low[i] >= self.low[i] - AREA_MM && other.high[i] <= self.high[i] + AREA_MM
                || other.low[i] > other.high[i]
        };
        if !(within(0) && within(1)) {
            return Err("a travel leaves the area that the file used".into());
        }
        let layers = self.layers.len();
        Ok(Proof { before: self.meter.finish(), after: other.meter.finish(), layers })
    }
}

/// What one layer holds.
#[derive(Clone, Debug, Default)]
struct Layer {
    index: Option<usize>,
    strokes: usize,
    /// Of their fingerprints: it does not depend on their order.
    sum: u64,
    /// Other commands, in their order.
    commands: u64,
}

impl Layer {
    fn same(&self, other: &Self) -> Result<(), String> {
        if self.strokes != other.strokes {
            return Err(format!("{} strokes became {}", self.strokes, other.strokes));
        }
        if self.sum != other.sum {
            return Err("a stroke is not what it was".into());
        }
        if self.commands != other.commands {
            return Err("other commands are not what they were".into());
        }
        Ok(())
    }
}

/// A hash of an extruded stroke: its ends in no order, then all that must not differ.
///
/// The sum of such hashes stands for a multiset (Clarke et al. 2003, doi:10.1007/978-3-540-40061-5_12). Two that differ
/// have the same sum with a probability of 2⁻⁶⁴.
fn fingerprint(stroke: &Stroke, retracted: bool, state: i64) -> u64 {
    let point = |p: [f64; 3]| [ticks(p[0]), ticks(p[1])];
    let (mut a, mut b) = (point(stroke.from), point(stroke.to));
    let mut turn = stroke.arc.map_or(0, |arc| if arc.clockwise { 1 } else { 2 });
    if a > b {
        (a, b) = (b, a);
        turn = if turn == 0 { 0 } else { 3 - turn };
    }
    let rest = [stroke.to[2], stroke.e_mm, stroke.feed_mm_s * 60.0].map(ticks);
    // Products of 128 bits, folded, mix all bits of two words.
    let mix = |hash: u64, pair: [i64; 2]| {
        let [x, y] = [pair[0] as u64 ^ hash, pair[1] as u64 ^ 0x9e37_79b9_7f4a_7c15];
        let product = u128::from(x) * u128::from(y);
        (product as u64 ^ (product >> 64) as u64).wrapping_add(hash.rotate_left(23))
    };
    let flags = [turn + 4 * i64::from(retracted), state];
    let hash = [a, b, [rest[0], rest[1]], [rest[2], 0], flags, [0x2545_f491, 0]]
        .into_iter()
        .fold(0xa076_1d64_78bd_642f, mix);
    hash ^ (hash >> 32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn same(a: &str, b: &str) -> bool {
        verify(a.as_bytes(), b.as_bytes()).expect("read").is_ok()
    }

    #[test]
    fn strokes_are_the_same_in_any_order_and_direction_and_differ_in_anything_else() {
        let text = "M83\nG1 X1 Y1 F600\nG1 X5 Y1 E1\nG1 Y2\nG1 X9 Y3 E2\n";
        assert!(same(text, "M83\nG1 X9 Y3 F600\nG1 X5 Y2 E2\nG1 X1 Y1\nG1 X5 Y1 E1\n"));
        for other in [
            // Filament of one stroke for another one, though the sums are the same.
            "M83\nG1 X1 Y1 F600\nG1 X5 Y1 E2\nG1 Y2\nG1 X9 Y3 E1\n",
            "M83\nG1 X1 Y1 F600\nG1 X5 Y1 E1\nG1 Y2 F500\nG1 X9 Y3 E2\n",
            "M83\nG1 X1 Y1 F600\nM106 S9\nG1 X5 Y1 E1\nG1 Y2\nG1 X9 Y3 E2\n",
            "M83\nG1 X1 Y1 F600\nG1 X5 Y2 E1\nG1 Y1\nG1 X9 Y3 E2\n",
        ] {
            assert!(!same(text, other), "{other}");
        }
    }
}
