//! How a file travels and retracts between two beads, learned from its own travels.

use geometry::real;

use super::block::{Block, Kind, Token};
use super::ticks::units;
use crate::gcode::Line;

/// Retraction and travel as the file does them. Amounts in ticks of the file's unit, feed rates in ticks per minute.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RetractionStyle {
    /// Number of the travel's command: G0 or G1.
    pub(super) command: u8,
    pub(super) travel_feed: i64,
    /// Travels from this length on are retracted, mm.
    pub(super) threshold_mm: f64,
    /// Whether longer ones are not, as long as they stay within a part.
    pub(super) combs: bool,
    /// Whether retracted ones go round walls, too.
    pub(super) rounds: bool,
    /// How it retracts, if it does at all.
    pub(super) retract: Option<Retract>,
}

/// A retraction and the unretraction after it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Retract {
    /// By G10 and G11.
    pub firmware: bool,
    /// Pulled before the wipe, while wiping, and after it; each with its feed rate.
    pub before: (i64, i64),
    pub wipe: (i64, i64),
    pub after: (i64, i64),
    /// Length of the wipe, mm.
    pub wipe_mm: f64,
    /// Whether comments tell where wipes begin and end.
    pub wipe_marks: bool,
    /// Height of the hop, and feed rates up and down.
    pub hop: Option<(i64, i64, i64)>,
    pub unretract: (i64, i64),
    /// Whether E is set to 0 while retracted.
    pub reset: bool,
}

/// A link as it was.
#[derive(Clone, Debug)]
struct Seen {
    length_mm: f64,
    retract: Option<Retract>,
    command: u8,
    travel_feed: i64,
    /// Whether it is much longer than the straight line.
    turns: bool,
    steps: usize,
}

/// Collects what a file does.
#[derive(Clone, Debug, Default)]
pub struct Learner {
    seen: Vec<Seen>,
}

/// What a retraction by the firmware is taken to last.
const FIRMWARE_MINUTES: f64 = 0.1 / 60.0;
/// A travel is a detour if it is this many times as long as the straight line, and this much longer, mm.
const DETOUR: f64 = 1.05;
const DETOUR_MM: f64 = 0.3;
/// With more different kinds of retraction than this, no style is recognised.
const MOST_KINDS: usize = 100;
/// This many links suffice.
const ENOUGH: usize = 20_000;

impl Learner {
    /// Looks at the links of a block. Whether there was anything to be learned.
    pub fn learn(&mut self, block: &Block) -> bool {
        if self.seen.len() >= ENOUGH {
            return false;
        }
        let known = self.seen.len();
        for (index, path) in block.paths.iter().enumerate().skip(1) {
            let from = block.end(&block.paths[index - 1]);
            let tokens = &block.links[path.link.clone()];
            let [a, b] = [from, path.from].map(|p| block.mm(p));
            let length_mm = real::hypot(a[0] - b[0], a[1] - b[1]);
            self.seen.extend(seen(block, tokens, length_mm));
        }
        self.seen.len() > known
    }

    /// The retraction style, if one can be recognised.
    pub fn style(&self) -> Option<RetractionStyle> {
        let retracted: Vec<&Seen> = self.seen.iter().filter(|s| s.retract.is_some()).collect();
        let mut lengths: Vec<f64> = retracted.iter().map(|s| s.length_mm).collect();
        lengths.sort_by(f64::total_cmp);
        // A few short ones are retracted for reasons of their own.
        let threshold_mm = lengths.get(lengths.len() / 50).copied().unwrap_or(f64::INFINITY);
        let far = self.seen.iter().filter(|s| s.length_mm > 2.0 * threshold_mm);
        let (far, combed) = far.fold((0, 0), |(n, c), s| (n + 1, c + usize::from(s.retract.is_none())));
        let usual = most_frequent(&retracted, |s| {
            let retract = s.retract.as_ref()?;
            Some((retract.retracted(), retract.wipe.0 != 0, retract.hop.map(|h| h.0), retract.unretract.0))
        });
        let travel =
            most_frequent(&self.seen.iter().collect::<Vec<_>>(), |s| Some((s.command, s.travel_feed)))?;
        Some(RetractionStyle {
            command: travel.command,
            travel_feed: travel.travel_feed,
            threshold_mm,
            combs: combed * 10 > far,
            rounds: retracted.iter().filter(|s| s.turns).count() * 10 > retracted.len(),
            retract: usual.and_then(|s| s.retract.clone()),
        })
    }
}

impl RetractionStyle {
    /// The travel that takes as long as retracting, lifting, lowering and unretracting, mm.
    pub fn retraction_mm(&self) -> f64 {
        let Some(retract) = &self.retract else { return 0.0 };
        let minutes = |(amount, feed): (i64, i64)| if feed > 0 { amount as f64 / feed as f64 } else { 0.0 };
        let hop =
            retract.hop.map_or(0.0, |(height, up, down)| minutes((height, up)) + minutes((height, down)));
        let moves = minutes(retract.before) + minutes(retract.after) + minutes(retract.unretract);
        units(self.travel_feed) * (hop + if retract.firmware { FIRMWARE_MINUTES } else { moves })
    }
}

impl Retract {
    /// All that is retracted.
    pub fn retracted(&self) -> i64 {
        self.before.0.saturating_add(self.wipe.0).saturating_add(self.after.0)
    }
}

/// One of those that most have the key of; the simplest.
fn most_frequent<'a, K: PartialEq>(all: &[&'a Seen], key: impl Fn(&Seen) -> Option<K>) -> Option<&'a Seen> {
    let mut counts: Vec<(K, usize, &Seen)> = Vec::new();
    for seen in all {
        let Some(key) = key(seen) else { continue };
        if let Some((_, count, least)) = counts.iter_mut().find(|(known, ..)| *known == key) {
            *count += 1;
            if seen.steps < least.steps {
                *least = seen;
            }
        } else if counts.len() < MOST_KINDS {
            counts.push((key, 1, seen));
        }
    }
    counts.into_iter().rev().max_by_key(|(_, count, _)| *count).map(|(.., seen)| seen)
}

/// The moves of a link; `None` if it does not travel or has unusual lines.
fn seen(block: &Block, tokens: &[Token], length_mm: f64) -> Option<Seen> {
    let level = block.after.at[2];
    let mut retract = Retract {
        firmware: false,
        before: (0, 0),
        wipe: (0, 0),
        after: (0, 0),
        wipe_mm: 0.0,
        wipe_marks: false,
        hop: None,
        unretract: (0, 0),
        reset: false,
    };
    let (mut travel, mut travelled_mm, mut wiped, mut z) = (None, 0.0, false, level);
    for token in tokens {
        match token.kind {
            Kind::Travel => {
                let command = Line::new(0, 0, token.line.of(&block.text)).code.map_or(1, |c| c.number as u8);
                travel = Some((command, token.feed));
                travelled_mm += token.xy_mm;
            }
            Kind::Wipe => {
                wiped = true;
                retract.wipe = (retract.wipe.0.saturating_sub(token.e), token.feed);
                retract.wipe_mm += token.xy_mm;
            }
            Kind::Retract if wiped => retract.after = (retract.after.0.saturating_sub(token.e), token.feed),
            Kind::Retract => retract.before = (retract.before.0.saturating_sub(token.e), token.feed),
            Kind::Unretract => retract.unretract = (retract.unretract.0.saturating_add(token.e), token.feed),
            Kind::FirmwareRetract => retract.firmware = true,
            Kind::ResetE => retract.reset = true,
            Kind::Noise => retract.wipe_marks |= token.line.of(&block.text).starts_with(b";WIPE_START"),
            _ => {}
        }
        if token.to[2] > z && token.kind == Kind::Lift && retract.hop.is_none() {
            retract.hop = Some((token.to[2].saturating_sub(level), token.feed, token.feed));
        } else if token.to[2] < z
            && let Some(hop) = &mut retract.hop
        {
            hop.2 = token.feed;
        }
        z = token.to[2];
    }
    let (command, travel_feed) = travel?;
    let retracts = retract.firmware || retract.retracted() > 0 && retract.unretract.0 > 0;
    let (retract, turns) = (retracts.then_some(retract), travelled_mm > DETOUR * length_mm + DETOUR_MM);
    Some(Seen { length_mm, retract, command, travel_feed, turns, steps: tokens.len() })
}
