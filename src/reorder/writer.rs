//! A block as text again, its paths in another order.

use memchr::memchr3;

use super::block::{Block, Frame, Kind, Path, Seg, Token};
use super::link_cost::LinkCost;
use super::problem::Pick;
use super::retraction::{Retract, RetractionStyle};
use super::state::{Key, States};
use super::ticks::{push_word, ticks, units};
use super::times::is_understood;
use super::walls::{TravelKind, Walls};
use crate::gcode::Line;
use geometry::Point;
use geometry::real;

/// Blanks behind a line about time, for a longer one.
pub const TIME_PADDING: &[u8] = b"    ";

/// A block's text and its cost.
#[derive(Clone, Debug, Default)]
pub struct Written {
    /// The text.
    pub bytes: Vec<u8>,
    /// Lines about time: where they begin in the text, and their numbers in the file. They stand as they were, with
    /// some blanks behind them as space for other numbers.
    pub times: Vec<(usize, usize)>,
    /// Cost of the travel to its first path.
    pub junction: LinkCost,
    /// What it costs from there on.
    pub inside: LinkCost,
}

/// Where a block's text ends: the last stroke of its last path; of one without paths, as in the file.
pub fn end(block: &Block, picks: &[Pick]) -> [i64; 2] {
    picks.last().map_or([block.after.at[0], block.after.at[1]], |pick| ends(block, pick).1)
}

/// Where a path begins and ends as it is drawn.
pub(super) fn ends(block: &Block, pick: &Pick) -> ([i64; 2], [i64; 2]) {
    let path = &block.paths[pick.path];
    match (pick.reversed, pick.first) {
        (true, _) => (block.end(path), path.from),
        (false, 0) => (path.from, block.end(path)),
        (false, first) => {
            let at = block.segs[path.segs.start + first - 1].to;
            (at, at)
        }
    }
}

/// Writes a block whose paths are drawn as `picks` say, the nozzle coming from `from`. At its end everything is as the
/// file has it there, but for the nozzle's place in X and Y.
pub fn write(
    block: &Block,
    picks: &[Pick],
    from: [i64; 2],
    style: &RetractionStyle,
    walls: &Walls,
) -> Written {
    let mut writer = Writer::new(block, from, style, walls);
    writer.out.reserve(block.text.len() + 256);
    writer.junction(picks.first());
    let junction = std::mem::take(&mut writer.cost);
    for (index, pick) in picks.iter().enumerate() {
        if index > 0 {
            writer.link(&picks[index - 1], pick);
        }
        writer.draw(pick);
    }
    if !picks.is_empty() {
        writer.close();
    }
    Written { bytes: writer.out, times: writer.times, junction, inside: writer.cost }
}

/// Cost of the travel from `from` to the first of a block's paths.
pub fn junction(
    block: &Block,
    picks: &[Pick],
    from: [i64; 2],
    style: &RetractionStyle,
    walls: &Walls,
) -> LinkCost {
    let mut writer = Writer::new(block, from, style, walls);
    writer.junction(picks.first());
    writer.cost
}

struct Writer<'a> {
    block: &'a Block,
    style: &'a RetractionStyle,
    walls: &'a Walls,
    eol: &'static [u8],
    out: Vec<u8>,
    times: Vec<(usize, usize)>,
    at: [i64; 3],
    e: i64,
    feed: i64,
    /// E and the feed rate as the file has them behind the last line of the junction.
    original: (i64, i64),
    /// Units and modes in force.
    frame: Frame,
    state: States,
    /// Index of the state that was put in force last, as long as no other one is.
    entered: Option<u32>,
    /// The path drawn last.
    last: Option<Pick>,
    /// Whether filament is retracted.
    retracted: bool,
    /// Whether there was no bead yet: nothing can ooze.
    dry: bool,
    cost: LinkCost,
}

impl<'a> Writer<'a> {
    fn new(block: &'a Block, from: [i64; 2], style: &'a RetractionStyle, walls: &'a Walls) -> Self {
        let first_line = block.text[block.body..].split(|b| *b == b'\n').next();
        let crlf = first_line.is_some_and(|line| line.ends_with(b"\r"));
        Self {
            block,
            style,
            walls,
            eol: if crlf { b"\r\n" } else { b"\n" },
            out: Vec::new(),
            times: Vec::new(),
            at: [from[0], from[1], block.before.at[2]],
            e: block.before.e,
            feed: block.before.feed,
            original: (block.before.e, block.before.feed),
            frame: block.frame_before,
            state: block.states[block.before.state as usize],
            entered: None,
            last: None,
            retracted: false,
            dry: !block.begun,
            cost: LinkCost::default(),
        }
    }

    /// What stays where it is, and the travel to the first path.
    fn junction(&mut self, first: Option<&Pick>) {
        let block = self.block;
        let tokens = &block.junction;
        let before = block.before.at;
        let target = first.map(|pick| ends(block, pick).0);
        let moved = self.at != before;
        // All up to what draws, or moves in some other manner, is as it was.
        let mut fixed = if target.is_none() { tokens.len() } else { 0 };
        for (index, token) in tokens.iter().enumerate() {
            if token.kind == Kind::Fixed || repositions(self.barrier_code(token)) {
                fixed = fixed.max(index + 1);
            }
        }
        let (head, tail) = tokens.split_at(fixed);
        if moved && fixed > 0 {
            let placed = head.iter().find(|t| {
                matches!(t.kind, Kind::Travel | Kind::Fixed)
                    || repositions(self.barrier_code(t))
                    || t.to[..2] != before[..2] && t.kind != Kind::Wipe
            });
            let by_itself = |t: &Token| {
                t.kind == Kind::Travel && t.frame.absolute && names(t.line.of(&block.text), b"XY")
            };
            if placed.is_some_and(|token| !by_itself(token)) {
                self.go([before[0], before[1]], None);
            }
        }
        let mut at = before;
        for token in head {
            match token.kind {
                Kind::Wipe if self.at[..2] != at[..2] => self.retract_in_place(token),
                _ => self.token(token),
            }
            at = token.to;
        }
        let Some(target) = target else { return };
        let as_it_was =
            head.last().map_or(before, |t| t.to)[..2] == self.at[..2] && target == block.paths[0].from;
        if as_it_was {
            tail.iter().for_each(|token| self.token(token));
            return;
        }
        let travel = tail.iter().rposition(|t| t.kind == Kind::Travel);
        for (index, token) in tail.iter().enumerate() {
            match token.kind {
                Kind::Travel if travel == Some(index) => self.go(target, Some(token)),
                // Filament is unretracted for the first time where the file does so.
                Kind::Travel if self.dry => self.token(token),
                Kind::Travel if token.to[2] != self.at[2] => self.lift(token.to[2], token.feed),
                Kind::Travel => {}
                Kind::Wipe => self.retract_in_place(token),
                _ => self.token(token),
            }
        }
        if self.at[..2] != target {
            self.go(target, None);
        }
    }

    /// The travel from one path to the next.
    fn link(&mut self, from: &Pick, to: &Pick) {
        let block = self.block;
        let path = &block.paths[to.path];
        let start = ends(block, to).0;
        let follows = from.path + 1 == to.path;
        let (before, after) = (&block.paths[from.path], ends(block, from).1);
        if follows && after == block.end(before) && start == path.from {
            block.links[path.link.clone()].iter().for_each(|token| self.token(token));
            return;
        }
        if after == start {
            return;
        }
        let wanted = block.states[path.travel_state as usize];
        if wanted != self.state {
            for line in self.state.changes(&wanted, false, &block.text) {
                self.out.extend_from_slice(line);
            }
            self.state = self.state.with_commands_of(&wanted);
            self.entered = None;
        }
        // Backwards along the path that the file itself took.
        if from.path == to.path + 1 && from.reversed && start == block.end(path) && after == before.from {
            let link = &block.links[before.link.clone()];
            let moves = |t: &&Token| t.kind == Kind::Travel;
            if link.iter().all(|t| !matches!(t.kind, Kind::Retract | Kind::Wipe | Kind::FirmwareRetract)) {
                let corners: Vec<[i64; 2]> =
                    link.iter().filter(moves).map(|t| [t.to[0], t.to[1]]).rev().skip(1).collect();
                corners.into_iter().for_each(|corner| self.travel(corner));
                self.travel(start);
                return;
            }
        }
        self.go(start, None);
    }

    /// Draws a path.
    fn draw(&mut self, pick: &Pick) {
        let block = self.block;
        let path: &Path = &block.paths[pick.path];
        let segs = &block.segs[path.segs.clone()];
        if pick.reversed {
            for (index, seg) in segs.iter().enumerate().rev() {
                let to = if index == 0 { path.from } else { segs[index - 1].to };
                self.backwards(seg, to);
            }
        } else {
            segs[pick.first..].iter().chain(&segs[..pick.first]).for_each(|seg| self.forwards(seg));
        }
        (self.last, self.dry) = (Some(*pick), false);
    }

    fn forwards(&mut self, seg: &Seg) {
        self.enter(seg.state);
        self.e = self.e.saturating_add(seg.e);
        let e = (self.frame.e_absolute && self.e != seg.e_after).then_some(self.e);
        self.stroke_line(seg.line.of(&self.block.text), e, seg.feed);
        (self.at[0], self.at[1]) = (seg.to[0], seg.to[1]);
    }

    fn backwards(&mut self, seg: &Seg, to: [i64; 2]) {
        self.enter(seg.state);
        let command: &[u8] = match seg.arc {
            Some((_, true)) => b"G3",
            Some((_, false)) => b"G2",
            None => b"G1",
        };
        self.out.extend_from_slice(command);
        self.xy(to);
        if let Some((center, _)) = seg.arc {
            push_word(&mut self.out, b'I', center[0].saturating_sub(seg.to[0]));
            push_word(&mut self.out, b'J', center[1].saturating_sub(seg.to[1]));
        }
        self.e = self.e.saturating_add(seg.e);
        push_word(&mut self.out, b'E', if self.frame.e_absolute { self.e } else { seg.e });
        self.f(seg.feed);
        let line = Line::new(0, 0, seg.line.of(&self.block.text));
        if let Some(comment) = line.comment {
            self.out.extend_from_slice(b" ;");
            self.out.extend_from_slice(comment);
        }
        self.end_line();
        (self.at[0], self.at[1]) = (to[0], to[1]);
    }

    /// Puts a state in force, comments and all.
    fn enter(&mut self, state: u32) {
        if self.entered.replace(state) == Some(state) {
            return;
        }
        let wanted = self.block.states[state as usize];
        if wanted != self.state {
            for line in self.state.changes(&wanted, true, &self.block.text) {
                self.out.extend_from_slice(line);
            }
            self.state = wanted;
        }
    }

    /// Everything as the file has it behind the block's last path.
    fn close(&mut self) {
        let block = self.block;
        let after = block.after;
        self.enter(after.state);
        // E need not stay relative.
        if self.e != after.e {
            self.reset_e(after.e);
        }
        if self.feed != after.feed {
            self.out.extend_from_slice(b"G1");
            self.f(after.feed);
            self.end_line();
        }
        // What was written during the travel is written after it, the last of each kind.
        let letters = |token: &Token| {
            let line = token.line.of(&block.text).iter();
            line.copied().filter(u8::is_ascii_alphabetic).collect::<Vec<u8>>()
        };
        for (index, token) in block.times.iter().enumerate() {
            if block.times[index + 1..].iter().all(|later| letters(later) != letters(token)) {
                self.token(token);
            }
        }
    }

    /// A line as it was, but for E and the feed rate in force.
    fn token(&mut self, token: &Token) {
        let line = token.line.of(&self.block.text);
        let code = self.barrier_code(token);
        match token.kind {
            Kind::Time(number) => return self.time(line, number),
            Kind::State(key) => {
                self.out.extend_from_slice(line);
                self.state.set(key, token.line);
                self.entered = None;
            }
            // A line that names the position where the nozzle is in the file would move it from where it is here.
            Kind::Lift | Kind::Retract | Kind::Unretract | Kind::Feed
                if self.at[..2] != token.to[..2] && (names(line, b"X") || names(line, b"Y")) =>
            {
                self.lift(token.to[2], token.feed);
                self.feed_filament(token.e, token.feed);
            }
            Kind::Travel | Kind::Lift | Kind::Retract | Kind::Unretract | Kind::Wipe | Kind::Feed => {
                self.e = self.e.saturating_add(token.e);
                let e = (self.frame.e_absolute && self.e != token.e_after).then_some(self.e);
                self.stroke_line(line, e, token.feed);
            }
            _ if token.kind == Kind::Fixed || repositions(code) => self.fixed(token, line),
            _ => {
                self.whole_line(line);
                if token.kind == Kind::Barrier && Key::of(&Line::new(0, 0, line)).is_some() {
                    self.state = self.block.states[token.state as usize];
                    self.entered = None;
                }
            }
        }
        match token.kind {
            Kind::ResetE => self.e = token.e_after,
            Kind::Retract | Kind::Wipe | Kind::FirmwareRetract => self.count_retraction(),
            Kind::Unretract | Kind::FirmwareUnretract | Kind::Fixed => self.retracted = false,
            _ => {}
        }
        if matches!(token.kind, Kind::Travel | Kind::Wipe) {
            self.cost.travel_mm += self.distance_mm([token.to[0], token.to[1]]);
        }
        // A line without coordinates leaves the nozzle where it is, wherever that was in the file.
        match token.kind {
            Kind::Travel | Kind::Wipe | Kind::Fixed => self.at = token.to,
            Kind::Barrier if repositions(code) => self.at = token.to,
            _ => self.at[2] = token.to[2],
        }
        self.original = (token.e_after, token.feed);
        self.frame = token.frame;
    }

    /// Writes a line that must not change, after restoring the E and feed rate that it has in the file.
    fn fixed(&mut self, token: &Token, line: &[u8]) {
        let (e, feed) = self.original;
        if self.frame.e_absolute && self.e != e {
            self.reset_e(e);
        }
        if self.feed != feed && feed > 0 {
            self.out.extend_from_slice(b"G1");
            self.f(feed);
            self.end_line();
        }
        self.whole_line(line);
        (self.e, self.feed) = (token.e_after, token.feed);
    }

    fn reset_e(&mut self, e: i64) {
        self.out.extend_from_slice(b"G92");
        push_word(&mut self.out, b'E', e);
        self.end_line();
    }

    /// The number of a barrier's G-code, if it is one.
    fn barrier_code(&self, token: &Token) -> Option<u32> {
        let code = Line::new(0, 0, token.line.of(&self.block.text)).code;
        code.filter(|code| token.kind == Kind::Barrier && code.letter == b'G').map(|code| code.number)
    }

    /// A line about time, if it can be brought up to date.
    fn time(&mut self, line: &[u8], number: usize) {
        if is_understood(&Line::new(0, 0, line)) {
            self.times.push((self.out.len(), number));
            self.out.extend_from_slice(line.trim_ascii_end());
            self.out.extend_from_slice(TIME_PADDING);
            self.end_line();
        }
    }

    fn count_retraction(&mut self) {
        self.cost.retractions += usize::from(!self.retracted);
        self.retracted = true;
    }

    /// Retracts standing still what the file retracted while wiping somewhere else.
    fn retract_in_place(&mut self, token: &Token) {
        let feed = self.style.retract.as_ref().map_or(token.feed, |r| {
            [r.after.1, r.before.1, r.unretract.1].into_iter().find(|f| *f > 0).unwrap_or(token.feed)
        });
        self.feed_filament(token.e, feed);
        self.count_retraction();
    }

    /// A travel to a position, retracted where the file would have done so. `as_was`: the travel that it replaces.
    fn go(&mut self, to: [i64; 2], as_was: Option<&Token>) {
        let z = as_was.map_or(self.at[2], |t| t.to[2]);
        let [a, b] = [[self.at[0], self.at[1]], to].map(|p| self.mm(p)).map(|[x, y]| Point::from_mm(x, y));
        if a == b && z == self.at[2] {
            return;
        }
        let length_mm = a.distance_mm(b);
        let (far, style) = (length_mm >= self.style.threshold_mm, self.style);
        let kind = if self.walls.is_empty() { None } else { Some(self.walls.classify(a, b)) };
        let goes_round = kind == Some(TravelKind::Crosses) && (style.combs || style.rounds);
        let corners = goes_round.then(|| self.walls.around(a, b)).flatten();
        let retract = match kind {
            _ if self.retracted || self.dry => None,
            None | Some(TravelKind::Outside) => style.retract.as_ref().filter(|_| far),
            Some(TravelKind::Inside) => style.retract.as_ref().filter(|_| far && !style.combs),
            Some(TravelKind::Crosses) => style.retract.as_ref().filter(|_| corners.is_none() || !style.combs),
        };
        let level = self.at[2];
        let mut height = z;
        if let Some(retract) = retract {
            self.retract(retract);
            if let Some((hop, up, _)) = retract.hop {
                height = z.max(level).saturating_add(hop);
                self.lift(height, up);
            }
        }
        for corner in corners.into_iter().flatten() {
            let corner = corner.mm().map(|mm| rounded(mm / self.frame.scale));
            self.travel_to(corner, height, style.travel_feed);
        }
        match as_was {
            Some(token) if retract.is_none_or(|r| r.hop.is_none()) && z != self.at[2] => {
                self.travel_to(to, z, token.feed)
            }
            _ => self.travel(to),
        }
        if let Some(retract) = retract {
            if let Some((_, _, down)) = retract.hop {
                self.lift(z, down);
            }
            self.unretract(retract);
        }
    }

    fn retract(&mut self, retract: &Retract) {
        self.count_retraction();
        if retract.firmware {
            self.out.extend_from_slice(b"G10");
            return self.end_line();
        }
        if retract.before.0 > 0 {
            self.feed_filament(-retract.before.0, retract.before.1);
        }
        self.wipe(retract);
        if retract.after.0 > 0 {
            self.feed_filament(-retract.after.0, retract.after.1);
        }
        if retract.reset && self.frame.e_absolute {
            self.out.extend_from_slice(b"G92 E0");
            self.end_line();
            self.e = 0;
        }
    }

    fn unretract(&mut self, retract: &Retract) {
        self.retracted = false;
        if retract.firmware {
            self.out.extend_from_slice(b"G11");
            return self.end_line();
        }
        self.feed_filament(retract.unretract.0, retract.unretract.1);
    }

    /// Wipes: back over the path drawn last while filament is retracted.
    fn wipe(&mut self, retract: &Retract) {
        let (amount, feed) = retract.wipe;
        if amount <= 0 {
            return;
        }
        let path = self.wipe_path(retract.wipe_mm);
        let mut left_mm: f64 = path.windows(2).map(|w| self.between_mm(w[0], w[1])).sum();
        if left_mm <= 0.0 {
            return self.feed_filament(-amount, feed);
        }
        if retract.wipe_marks {
            self.out.extend_from_slice(b";WIPE_START");
            self.end_line();
        }
        let mut left = amount;
        for w in path.windows(2) {
            let length_mm = self.between_mm(w[0], w[1]);
            // To a hundred-thousandth; the last one gets the rest.
            let share = if length_mm >= left_mm {
                left
            } else {
                (left as f64 * length_mm / left_mm / 10.0).round() as i64 * 10
            };
            (left, left_mm) = (left - share, left_mm - length_mm);
            self.cost.travel_mm += length_mm;
            self.out.extend_from_slice(b"G1");
            self.xy(w[1]);
            self.e_word(-share);
            self.f(feed);
            self.end_line();
            (self.at[0], self.at[1]) = (w[1][0], w[1][1]);
        }
        if retract.wipe_marks {
            self.out.extend_from_slice(b";WIPE_END");
            self.end_line();
        }
    }

    /// The last part of the drawn path, backwards, of this many millimetres.
    fn wipe_path(&self, wipe_mm: f64) -> Vec<[i64; 2]> {
        let Some(pick) = self.last else { return Vec::new() };
        let block = self.block;
        let path = &block.paths[pick.path];
        let mut points: Vec<[i64; 2]> =
            std::iter::once(path.from).chain(block.segs[path.segs.clone()].iter().map(|s| s.to)).collect();
        if pick.first > 0 {
            points.pop();
            points.rotate_left(pick.first);
            points.push(points[0]);
        }
        if !pick.reversed {
            points.reverse();
        }
        let mut left_mm = wipe_mm;
        let mut path = vec![points[0]];
        for w in points.windows(2) {
            let length_mm = self.between_mm(w[0], w[1]);
            if length_mm >= left_mm {
                let share = left_mm / length_mm;
                let at = [0, 1].map(|i| rounded(units(w[0][i]) + share * (units(w[1][i]) - units(w[0][i]))));
                path.push(at);
                break;
            }
            path.push(w[1]);
            left_mm -= length_mm;
        }
        path.dedup();
        path
    }

    fn feed_filament(&mut self, e: i64, feed: i64) {
        if e == 0 {
            return;
        }
        self.out.extend_from_slice(b"G1");
        self.e_word(e);
        self.f(feed);
        self.end_line();
    }

    fn e_word(&mut self, e: i64) {
        self.e = self.e.saturating_add(e);
        push_word(&mut self.out, b'E', if self.frame.e_absolute { self.e } else { e });
    }

    fn lift(&mut self, z: i64, feed: i64) {
        if z != self.at[2] {
            self.command();
            let value = if self.frame.absolute { z } else { z.saturating_sub(self.at[2]) };
            push_word(&mut self.out, b'Z', value);
            self.at[2] = z;
            self.f(feed);
            self.end_line();
        }
    }

    fn travel(&mut self, to: [i64; 2]) {
        self.travel_to(to, self.at[2], self.style.travel_feed);
    }

    fn travel_to(&mut self, to: [i64; 2], z: i64, feed: i64) {
        if [to[0], to[1], z] == self.at {
            return;
        }
        self.cost.travel_mm += self.distance_mm(to);
        self.command();
        self.xy(to);
        if z != self.at[2] {
            push_word(
                &mut self.out,
                b'Z',
                if self.frame.absolute { z } else { z.saturating_sub(self.at[2]) },
            );
        }
        self.f(feed);
        self.end_line();
        self.at = [to[0], to[1], z];
    }

    fn command(&mut self) {
        self.out.extend_from_slice(if self.style.command == 0 { b"G0" } else { b"G1" });
    }

    fn xy(&mut self, to: [i64; 2]) {
        let origin = if self.frame.absolute { [0; 2] } else { [self.at[0], self.at[1]] };
        push_word(&mut self.out, b'X', to[0].saturating_sub(origin[0]));
        push_word(&mut self.out, b'Y', to[1].saturating_sub(origin[1]));
    }

    /// The feed rate, where it is not in force.
    fn f(&mut self, feed: i64) {
        if feed != self.feed && feed > 0 {
            push_word(&mut self.out, b'F', feed);
            self.feed = feed;
        }
    }

    fn end_line(&mut self) {
        self.out.extend_from_slice(self.eol);
    }

    /// A line of the file with another E, and with a feed rate where it needs one.
    fn stroke_line(&mut self, line: &[u8], e: Option<i64>, feed: i64) {
        let to_feed = feed != self.feed && feed > 0;
        self.feed = feed;
        if e.is_none() && !to_feed {
            self.out.extend_from_slice(line);
        } else {
            let command = memchr3(b';', b'\r', b'\n', line).unwrap_or(line.len());
            let (command, rest) = line.split_at(command);
            let index_of = |letter: u8| command.iter().rposition(|b| b.to_ascii_uppercase() == letter);
            match e.zip(index_of(b'E')) {
                Some((value, at)) => {
                    self.out.extend_from_slice(&command[..=at]);
                    super::ticks::push_number(&mut self.out, value);
                    let digits = &command[at + 1..];
                    // Blanks may stand before the number, and do stand behind it.
                    let blank = |b: &u8| matches!(b, b' ' | b'\t');
                    let begin = digits.iter().position(|b| !blank(b)).unwrap_or(digits.len());
                    let number = |b: &u8| b.is_ascii_digit() || matches!(b, b'.' | b'-' | b'+');
                    let end = digits[begin..].iter().position(|b| !number(b));
                    self.out.extend_from_slice(&digits[end.map_or(digits.len(), |n| begin + n)..]);
                }
                None => self.out.extend_from_slice(command),
            }
            if to_feed && !names(line, b"F") {
                while self.out.last() == Some(&b' ') {
                    self.out.pop();
                }
                push_word(&mut self.out, b'F', feed);
                if rest.starts_with(b";") {
                    self.out.push(b' ');
                }
            }
            self.out.extend_from_slice(rest);
        }
        if !line.ends_with(b"\n") {
            self.end_line();
        }
    }

    /// A line as it is. The last one of a file may have no end; it need not be the last any more.
    fn whole_line(&mut self, line: &[u8]) {
        self.out.extend_from_slice(line);
        if !line.ends_with(b"\n") {
            self.end_line();
        }
    }

    /// A point in millimetres, by the unit in force.
    fn mm(&self, p: [i64; 2]) -> [f64; 2] {
        p.map(|v| units(v) * self.frame.scale)
    }

    fn between_mm(&self, a: [i64; 2], b: [i64; 2]) -> f64 {
        let [a, b] = [a, b].map(|p| self.mm(p));
        real::hypot(a[0] - b[0], a[1] - b[1])
    }

    fn distance_mm(&self, to: [i64; 2]) -> f64 {
        self.between_mm([self.at[0], self.at[1]], to)
    }
}

/// A coordinate with as many digits as slicers give, as ticks.
fn rounded(value: f64) -> i64 {
    ticks((value * 1000.0).round() / 1000.0)
}

/// Whether a G-code of this number moves the nozzle in X and Y, or says where it is.
fn repositions(code: Option<u32>) -> bool {
    matches!(code, Some(0..=3 | 20 | 21 | 28 | 92))
}

/// Whether a line has all these words.
fn names(line: &[u8], letters: &[u8]) -> bool {
    let words = Line::new(0, 0, line).words();
    letters.iter().all(|letter| words.get(*letter).is_some())
}
