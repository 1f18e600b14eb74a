//! A file as blocks, one after the other: the whole of it is never in memory.

use std::io::{self, BufRead, ErrorKind};
use std::ops::Range;

use geometry::real;
use memchr::memchr2;

use super::block::{Block, Cursor, Frame, Kind, Path, Seg, Token};
use super::lines::{LONGEST_LINE, binary, too_long};
use super::slice::Slice;
use super::state::{Key, States};
use super::ticks::{in_units, is_whole, ticks};
use super::times::is_time;
use super::verify::Inventory;
use crate::estimate::Machine;
use crate::gcode::{Action, Annotated, Line, Mark, Reader, Stroke, mark};

/// A block without paths is ended after this many bytes where it can be.
const LONGEST_FIXED: usize = 1 << 20;
/// Coordinates beyond this are no positions of a printer, file units.
const LARGEST: f64 = 1e5;
/// The radius of an arc may differ by this between its ends, mm.
const ROUND_MM: f64 = 0.05;
/// More filament fed than was retracted is priming and stays where it is, mm.
const PRIMING_MM: f64 = 0.5;

/// Whether a comment of KISSlicer is about more than the path at hand: `*** … ***`, `END_LAYER_OBJECT`.
fn is_section(comment: &[u8]) -> bool {
    let text = comment.trim_ascii();
    text.starts_with(b"***") || text.starts_with(b"END_LAYER_OBJECT")
}

/// Reads blocks.
pub struct Blocks<R> {
    input: R,
    reader: Reader,
    number: usize,
    offset: usize,
    /// Lines about time so far.
    times: usize,
    /// Whether a line that marks a layer was seen.
    marked: bool,
    /// Whether something was extruded.
    begun: bool,
    /// Millimetres in a unit at the first stroke that may be moved: in another one nothing may.
    unit: Option<f64>,
    /// The name of the feature, if it is one that is known, or none was given.
    movable: bool,
    /// Whether features come in quotes: KISSlicer says of every path, in comments of all kinds, how it is drawn.
    kisslicer: bool,
    block: Block,
    /// What was read so far, where a proof is wanted.
    inventory: Option<Inventory>,
    /// Lines since the last path, and what they hold.
    pending: Vec<Token>,
    pending_state: PendingState,
    done: bool,
}

/// What the lines after the last stroke of the last path hold.
#[derive(Clone, Copy, Debug, Default)]
struct PendingState {
    /// Something that moves, or feeds filament.
    moved: bool,
    /// A line that no path moves past.
    barrier: bool,
    /// The state at the last travel.
    travel_state: Option<u32>,
}

/// The state of the machine before a line, as far as it matters.
struct Before {
    scale: f64,
    /// Whether filament is retracted.
    retracted: bool,
    /// Whether firmwares disagree about E.
    doubtful: bool,
    /// The extruder's position, ticks.
    e: i64,
}

impl<R: BufRead> Blocks<R> {
    /// Before the first line of a file.
    pub fn new(input: R) -> Self {
        let frame = Frame { scale: 1.0, absolute: true, e_absolute: true };
        let start = Cursor { at: [0; 3], e: 0, feed: 0, state: 0 };
        Self {
            input,
            reader: Reader::default(),
            number: 0,
            offset: 0,
            times: 0,
            marked: false,
            begun: false,
            unit: None,
            movable: true,
            kisslicer: false,
            block: empty(start, frame, States::default()),
            inventory: None,
            pending: Vec::new(),
            pending_state: PendingState::default(),
            done: false,
        }
    }

    /// Also records an inventory for the proof and, with a machine, the times of lines about time.
    pub fn proven(self, machine: Option<&Machine>) -> Self {
        Self { inventory: Some(Inventory::timed(machine)), ..self }
    }

    /// What was read so far, if it was to be proven.
    pub fn finish(self) -> Option<Inventory> {
        self.inventory
    }

    /// The next block; `None` at the end.
    ///
    /// # Errors
    /// As the system says; and where the bytes cannot be G-code.
    pub fn read(&mut self) -> io::Result<Option<Block>> {
        while !self.done {
            let start = self.block.text.len();
            let read = read_line(&mut self.input, self.number + 1, &mut self.block.text)?;
            if read == 0 {
                self.done = true;
                let mut last = self.take();
                if last.paths.is_empty() {
                    last.junction.append(&mut self.pending);
                    return Ok(Some(last));
                }
                let rest = self.split(&mut last);
                self.block = rest;
                return Ok(Some(last));
            }
            self.number += 1;
            if let Some(block) = self.line(start..start + read) {
                return Ok(Some(block));
            }
        }
        let mut rest = self.take();
        rest.junction.append(&mut self.pending);
        Ok((rest.text.len() > rest.body).then_some(rest))
    }

    /// The block at hand; an empty one replaces it.
    fn take(&mut self) -> Block {
        let next = empty(self.block.after, self.block.frame, States::default());
        std::mem::replace(&mut self.block, next)
    }

    /// Processes a line; returns a block that it ends.
    fn line(&mut self, range: Range<usize>) -> Option<Block> {
        let state = &self.reader.state;
        let retracted = state.is_retracted();
        let e = ticks(in_units(state.e, state.scale));
        let before = Before { scale: state.scale, retracted, doubtful: state.e_doubtful, e };
        let slice = Slice { start: range.start as u32, len: range.len() as u32 };
        let text = std::mem::take(&mut self.block.text);
        let line = Line::new(self.number, self.offset, &text[range.clone()]);
        self.offset += range.len();
        let read = self.reader.read(line);
        if let Some(inventory) = &mut self.inventory {
            inventory.add(&read, &self.reader.state);
        }
        let stroke = match read.action {
            Action::Stroke(stroke) => Some(stroke),
            _ => None,
        };
        let plain = stroke.is_some_and(|stroke| stroke.plain || is_plain(read.line.parameters()));
        let bead = stroke.filter(|s| s.extrudes());
        let kind = match (stroke, bead) {
            (_, Some(bead)) => {
                if plain && self.is_movable(&bead, &before, &read) {
                    None
                } else {
                    Some(Kind::Fixed)
                }
            }
            (Some(stroke), None) => Some(if plain { stroke_kind(&stroke) } else { Kind::Fixed }),
            (None, None) => Some(self.other_kind(&read)),
        };
        let context_role = read.context.role;
        let layer = read.context.layer.unwrap_or(0);
        self.block.text = text;
        match (kind, bead) {
            (None, Some(bead)) => self.bead(slice, &bead, context_role, layer, before.scale),
            (kind, _) => self.token(kind.unwrap_or(Kind::Barrier), slice, stroke, before.e),
        }
    }

    /// Whether a stroke that extrudes may be moved at all.
    fn is_movable(&self, bead: &Stroke, before: &Before, read: &Annotated) -> bool {
        let named = read.context.role.is_some() || self.movable;
        let sound = |mm: f64| mm.abs() < LARGEST && is_whole(in_units(mm, before.scale));
        // What follows a stroke that may be moved begins where that one ends.
        let goes_on = self.pending.is_empty() && !self.block.paths.is_empty();
        named
            && (goes_on || bead.from.into_iter().all(sound))
            && sound(bead.to[0])
            && sound(bead.to[1])
            && sound(bead.e_mm)
            && self.unit.is_none_or(|unit| unit == before.scale)
            && bead.arc.is_none_or(|arc| is_round(bead, arc.at))
            && !before.retracted
            && bead.from[2] == bead.to[2]
            && !before.doubtful
            && bead.feed_mm_s > 0.0
    }

    fn other_kind(&mut self, read: &Annotated) -> Kind {
        let line = &read.line;
        match read.action {
            Action::FirmwareRetract if line.words().is_empty() => return Kind::FirmwareRetract,
            Action::FirmwareUnretract if line.words().is_empty() => return Kind::FirmwareUnretract,
            Action::Type(name) => {
                self.movable = false;
                self.kisslicer |= name.starts_with(b"'");
            }
            _ => {}
        }
        if line.is(b'G', 92) && is_plain(line.parameters()) {
            let words = line.words();
            if words.get(b'E').is_some() && b"XYZ".iter().all(|w| words.get(*w).is_none()) {
                return Kind::ResetE;
            }
        }
        if is_time(line) {
            self.times += 1;
            return Kind::Time(self.times - 1);
        }
        if let Some(key) = Key::of(line) {
            return Kind::State(key);
        }
        if line.code.is_none() && line.parameters().trim_ascii().is_empty() {
            return match line.comment {
                None => Kind::Noise,
                Some(comment) => match mark(comment) {
                    Some(Mark::Layer) => {
                        self.marked = true;
                        Kind::Mark
                    }
                    Some(Mark::Z(_)) => Kind::Mark,
                    _ if matches!(comment.trim_ascii(), b"" | b"WIPE_START" | b"WIPE_END") => Kind::Noise,
                    None if self.kisslicer && !is_section(comment) => Kind::Noise,
                    _ => Kind::Barrier,
                },
            };
        }
        Kind::Barrier
    }

    fn cursor(&self, state: u32) -> Cursor {
        let s = &self.reader.state;
        Cursor {
            at: s.position.map(|mm| ticks(in_units(mm, s.scale))),
            e: ticks(in_units(s.e, s.scale)),
            feed: ticks(in_units(s.feed_mm_s * 60.0, s.scale)),
            state,
        }
    }

    fn frame(&self) -> Frame {
        let s = &self.reader.state;
        Frame { scale: s.scale, absolute: s.absolute, e_absolute: s.e_absolute }
    }

    fn state_now(&self) -> u32 {
        self.block.states.len() as u32 - 1
    }

    fn token(&mut self, kind: Kind, line: Slice, stroke: Option<Stroke>, e_before: i64) -> Option<Block> {
        let mut kind = kind;
        if let Kind::State(key) = kind {
            let mut states = self.block.states[self.state_now() as usize];
            let known = states.set(key, line);
            self.block.states.push(states);
            // What held before cannot be brought back: nothing passes the first line of its kind.
            if !known && !self.block.paths.is_empty() {
                kind = Kind::Barrier;
            }
        }
        let state = self.state_now();
        let now = self.cursor(state);
        let token = Token {
            kind,
            line,
            to: now.at,
            e: stroke.map_or(0, |_| now.e.saturating_sub(e_before)),
            e_after: now.e,
            feed: now.feed,
            xy_mm: stroke.map_or(0.0, |s| s.xy_mm),
            state,
            frame: self.frame(),
        };
        self.pending.push(token);
        self.begun |= kind == Kind::Fixed;
        match kind {
            Kind::Travel => {
                self.pending_state.moved = true;
                self.pending_state.travel_state = Some(state);
            }
            Kind::Wipe
            | Kind::Lift
            | Kind::Retract
            | Kind::Unretract
            | Kind::FirmwareRetract
            | Kind::FirmwareUnretract => self.pending_state.moved = true,
            Kind::Mark | Kind::Barrier | Kind::Fixed => self.pending_state.barrier = true,
            Kind::ResetE | Kind::Feed | Kind::State(_) | Kind::Time(_) | Kind::Noise => {}
        }
        // After something that must stay, and draws, the nozzle is where it was: nothing has to be remembered.
        if kind == Kind::Fixed && self.block.paths.is_empty() && self.block.text.len() > LONGEST_FIXED {
            return Some(self.cut());
        }
        None
    }

    /// Adds a stroke of a path; returns the block before if it begins another one.
    fn bead(
        &mut self,
        line: Slice,
        bead: &Stroke,
        role: Option<crate::toolpath::Role>,
        layer: usize,
        scale: f64,
    ) -> Option<Block> {
        let units = |mm: f64| ticks(in_units(mm, scale));
        let from = [units(bead.from[0]), units(bead.from[1])];
        let after = self.cursor(0);
        let frame = self.frame();
        let same =
            self.block.after.at[2] == after.at[2] && self.block.layer == layer && self.block.frame == frame;
        let mut line = line;
        let mut ended = None;
        if !self.block.paths.is_empty() && (self.pending_state.barrier || !same) {
            let mut last = self.take();
            let cut = self.pending.first().map_or(line.start, |t| t.line.start);
            self.block = self.split(&mut last);
            line.start = line.start - cut + self.block.body as u32;
            ended = Some(last);
        }
        let state = self.state_now();
        if self.block.paths.is_empty() {
            self.block.junction.append(&mut self.pending);
            (self.block.frame, self.block.layer, self.block.marked) = (frame, layer, self.marked);
            self.block.begun = self.begun;
            self.begin(from, role, state);
        } else {
            self.block.times.extend(self.pending.extract_if(.., |t| matches!(t.kind, Kind::Time(_))));
            let end = self.block.end(&self.block.paths[self.block.paths.len() - 1]);
            if self.pending_state.moved || end != from {
                self.begin(from, role, state);
            } else {
                // Feed rates and states are kept with each stroke.
                self.pending.clear();
            }
        }
        self.unit = Some(scale);
        let arc = bead.arc.map(|arc| (arc.at.map(units), arc.clockwise));
        let (to, e) = ([after.at[0], after.at[1]], units(bead.e_mm));
        self.block.segs.push(Seg { line, to, e, e_after: after.e, feed: after.feed, arc, state });
        let end = self.block.segs.len();
        if let Some(path) = self.block.paths.last_mut() {
            path.segs.end = end;
        }
        (self.pending_state, self.begun) = (PendingState::default(), true);
        self.block.after = Cursor { state, ..after };
        ended
    }

    fn begin(&mut self, from: [i64; 2], role: Option<crate::toolpath::Role>, state: u32) {
        let links = self.block.links.len();
        self.block.links.append(&mut self.pending);
        let segs = self.block.segs.len();
        self.block.paths.push(Path {
            from,
            segs: segs..segs,
            link: links..self.block.links.len(),
            travel_state: self.pending_state.travel_state.unwrap_or(state),
            role,
        });
    }

    /// Ends a block behind its last path and returns a new one with the pending lines.
    fn split(&mut self, last: &mut Block) -> Block {
        let cut = self.pending.first().map_or_else(
            // Nothing pending: the line at hand, if there is one, begins behind the last stroke.
            || last.segs.last().map_or(last.text.len(), |seg| (seg.line.start + seg.line.len) as usize),
            |token| token.line.start as usize,
        );
        let first_state = last.after.state;
        let mut next = empty(last.after, last.frame, States::default());
        next.frame = self.frame();
        let mut states: Vec<States> = last.states[first_state as usize..].to_vec();
        // The lines in force come along.
        let mut prefix: Vec<u8> = Vec::new();
        for slice in states[0].slices_mut() {
            let line = slice.of(&last.text);
            *slice = Slice { start: prefix.len() as u32, len: line.len() as u32 };
            prefix.extend_from_slice(line);
        }
        let carried = states[0];
        let shift =
            |slice: Slice| Slice { start: slice.start - cut as u32 + prefix.len() as u32, len: slice.len };
        for states in states.iter_mut().skip(1) {
            for (slice, carried) in states.slices_mut().zip({ carried }.slices_mut()) {
                if slice.start as usize >= cut {
                    *slice = shift(*slice);
                } else if !slice.is_empty() {
                    *slice = *carried;
                }
            }
        }
        next.states = states;
        next.body = prefix.len();
        for token in &mut self.pending {
            token.line = shift(token.line);
            token.state -= first_state;
        }
        self.pending_state.travel_state =
            self.pending_state.travel_state.map(|state| state.saturating_sub(first_state));
        next.text = prefix;
        // Blocks are about as long as their neighbours, or a little longer.
        let room = |length: usize, most: usize| (length + length / 4).min(most);
        next.text.reserve(room(last.text.len(), LONGEST_FIXED));
        next.segs.reserve(room(last.segs.len(), LONGEST_FIXED / 32));
        next.text.extend_from_slice(&last.text[cut..]);
        last.text.truncate(cut);
        next.before.state = 0;
        next.after.state = 0;
        next
    }

    /// Ends a block that holds no path.
    fn cut(&mut self) -> Block {
        let mut done = self.take();
        done.junction.append(&mut self.pending);
        done.after = self.cursor(done.states.len() as u32 - 1);
        self.pending_state = PendingState::default();
        let mut next = empty(done.after, self.frame(), States::default());
        let mut states = done.states[done.states.len() - 1];
        for slice in states.slices_mut() {
            let line = slice.of(&done.text);
            *slice = Slice { start: next.text.len() as u32, len: line.len() as u32 };
            next.text.extend_from_slice(line);
        }
        next.body = next.text.len();
        next.states = vec![states];
        next.before.state = 0;
        next.after.state = 0;
        self.block = next;
        done
    }
}

fn empty(start: Cursor, frame: Frame, states: States) -> Block {
    Block {
        text: Vec::new(),
        body: 0,
        junction: Vec::new(),
        paths: Vec::new(),
        segs: Vec::new(),
        links: Vec::new(),
        times: Vec::new(),
        states: vec![states],
        frame,
        layer: 0,
        marked: false,
        begun: false,
        frame_before: frame,
        before: start,
        after: start,
    }
}

/// Whether an arc is as far from its centre at its end as at its start.
fn is_round(bead: &Stroke, center: [f64; 2]) -> bool {
    let [from, to] = [bead.from, bead.to].map(|p| real::hypot(p[0] - center[0], p[1] - center[1]));
    from > ROUND_MM && (from - to).abs() < ROUND_MM
}

fn stroke_kind(stroke: &Stroke) -> Kind {
    let moves = stroke.xy_mm > 1e-9;
    let lifts = stroke.from[2] != stroke.to[2];
    match (moves, stroke.e_mm) {
        // Without a centre it has no length.
        _ if stroke.arc.is_some() => Kind::Barrier,
        (true, e) if e < -1e-9 => {
            if lifts {
                Kind::Barrier
            } else {
                Kind::Wipe
            }
        }
        (true, _) => Kind::Travel,
        (false, e) if e.abs() > 1e-9 && lifts => Kind::Barrier,
        (false, e) if e < -1e-9 => Kind::Retract,
        (false, e) if e > 1e-9 && stroke.fresh_mm > PRIMING_MM => Kind::Fixed,
        (false, e) if e > 1e-9 => Kind::Unretract,
        _ if lifts => Kind::Lift,
        _ => Kind::Feed,
    }
}

/// Whether parameters are words that moves are known to have, each with a number and given once.
fn is_plain(parameters: &[u8]) -> bool {
    let (mut at, mut given) = (0, 0_u32);
    while at < parameters.len() {
        let byte = parameters[at];
        if matches!(byte, b' ' | b'\t') {
            at += 1;
            continue;
        }
        let letter = byte.to_ascii_uppercase();
        let bit = match letter {
            b'X' | b'Y' | b'Z' | b'E' | b'F' | b'I' | b'J' | b'R' => 1 << (letter - b'A'),
            _ => return false,
        };
        // `1e5` is one number to some readers and two words to others.
        let glued = at > 0 && parameters[at - 1].is_ascii_digit() && byte.is_ascii_lowercase();
        if given & bit != 0 || glued {
            return false;
        }
        given |= bit;
        at += 1;
        let start = at;
        if matches!(parameters.get(at), Some(b'-' | b'+')) {
            at += 1;
        }
        let (mut digits, mut points) = (0, 0);
        while let Some(b) = parameters.get(at) {
            match b {
                b'0'..=b'9' => digits += 1,
                b'.' => points += 1,
                _ => break,
            }
            at += 1;
        }
        if digits == 0 || points > 1 || at - start > 20 {
            return false;
        }
    }
    true
}

/// Appends a line with its end; 0: there is none.
///
/// # Errors
/// As the system says; and where the bytes cannot be G-code. `number` is that of the line.
fn read_line(input: &mut impl BufRead, number: usize, out: &mut Vec<u8>) -> io::Result<usize> {
    let start = out.len();
    loop {
        let buffer = match input.fill_buf() {
            Ok([]) => return Ok(out.len() - start),
            Ok(buffer) => buffer,
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            Err(error) => return Err(error),
        };
        let found = memchr2(b'\n', 0, buffer);
        if found.is_some_and(|at| buffer[at] == 0) {
            return Err(binary(number));
        }
        let used = found.map_or(buffer.len(), |at| at + 1);
        out.extend_from_slice(&buffer[..used]);
        input.consume(used);
        if out.len() - start > LONGEST_LINE {
            return Err(too_long());
        }
        if found.is_some() {
            return Ok(out.len() - start);
        }
    }
}
