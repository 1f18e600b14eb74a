//! A stretch of a file: what must stay where it is, then paths that may change places.

use std::ops::Range;

use super::link_cost::LinkCost;
use super::slice::Slice;
use super::state::{Key, States};
use crate::toolpath::Role;
use geometry::Point;

/// The kind of a line that draws nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// Moves in X and Y, and perhaps Z, with the filament at rest.
    Travel,
    /// Moves in X and Y while filament is retracted.
    Wipe,
    /// Moves in Z only.
    Lift,
    /// Retracts or unretracts filament without moving.
    Retract,
    Unretract,
    /// Sets the feed rate, and nothing else.
    Feed,
    /// G10 and G11.
    FirmwareRetract,
    FirmwareUnretract,
    /// G92 E.
    ResetE,
    /// Sets something that belongs to the paths that follow.
    State(Key),
    /// Says how much time is left, or has gone by; its number among such lines.
    Time(usize),
    /// Blank, or a comment that belongs to a travel.
    Noise,
    /// A layer mark: stays in position, and no path moves past it.
    Mark,
    /// Draws something that must not be moved.
    Fixed,
    /// Anything else: stays in position, and no path moves past it.
    Barrier,
}

/// A line that draws nothing that could be moved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Token {
    pub kind: Kind,
    /// Its line with its end.
    pub line: Slice,
    /// Where it leads, ticks.
    pub to: [i64; 3],
    /// Filament fed, and the extruder's position after it, ticks.
    pub e: i64,
    pub e_after: i64,
    /// Feed rate in force, ticks per minute.
    pub feed: i64,
    /// Length in X and Y, mm.
    pub xy_mm: f64,
    /// Index of the state after it.
    pub state: u32,
    /// Units and modes after it.
    pub frame: Frame,
}

/// A stroke that extrudes and may be moved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seg {
    pub line: Slice,
    pub to: [i64; 2],
    pub e: i64,
    pub e_after: i64,
    pub feed: i64,
    /// Centre and sense of an arc.
    pub arc: Option<([i64; 2], bool)>,
    pub state: u32,
}

/// Strokes without a travel in between.
#[derive(Clone, Debug)]
pub(super) struct Path {
    pub from: [i64; 2],
    pub(super) segs: Range<usize>,
    /// The tokens between the path before and this one; of the first path, none: they are the junction.
    pub link: Range<usize>,
    /// State while travelling to it.
    pub travel_state: u32,
    pub role: Option<Role>,
}

/// Units and modes, which do not change within a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    /// Millimetres in a unit.
    pub scale: f64,
    pub absolute: bool,
    pub e_absolute: bool,
}

/// Where the machine is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cursor {
    pub at: [i64; 3],
    pub e: i64,
    pub feed: i64,
    pub state: u32,
}

/// Lines that stay, followed by paths of one layer and height that may change places.
#[derive(Clone, Debug)]
pub struct Block {
    /// The lines of the block; before them those that set the state it begins with.
    pub(super) text: Vec<u8>,
    /// Where its lines begin.
    pub(super) body: usize,
    /// From the last stroke of the block before to the first path.
    pub(super) junction: Vec<Token>,
    pub(super) paths: Vec<Path>,
    pub(super) segs: Vec<Seg>,
    /// Tokens between paths.
    pub(super) links: Vec<Token>,
    /// Lines about time that came between its strokes.
    pub(super) times: Vec<Token>,
    pub(super) states: Vec<States>,
    pub(super) frame: Frame,
    /// Index of the layer; whether the file marks layers so far.
    pub(super) layer: usize,
    pub(super) marked: bool,
    /// Whether something was extruded before it.
    pub(super) begun: bool,
    /// Units and modes at the beginning.
    pub(super) frame_before: Frame,
    /// At the beginning, and after its last path.
    pub(super) before: Cursor,
    pub(super) after: Cursor,
}

impl Block {
    /// Index of its layer.
    pub fn layer(&self) -> usize {
        self.layer
    }

    /// Whether the file has marked a layer before it or in it.
    pub fn marked(&self) -> bool {
        self.marked
    }

    /// Bytes of the file in it.
    pub fn bytes(&self) -> usize {
        self.text.len() - self.body
    }

    /// Number of its paths.
    pub fn paths(&self) -> usize {
        self.paths.len()
    }

    /// Where the nozzle is when it begins, ticks.
    pub fn start(&self) -> [i64; 2] {
        [self.before.at[0], self.before.at[1]]
    }

    /// A point in the plane.
    pub fn point(&self, p: [i64; 2]) -> Point {
        let [x, y] = self.mm(p);
        Point::from_mm(x, y)
    }

    /// Where a path ends.
    pub(super) fn end(&self, path: &Path) -> [i64; 2] {
        self.segs[path.segs.end - 1].to
    }

    /// Whether a path ends where it began.
    pub(super) fn closed(&self, path: &Path) -> bool {
        path.segs.len() > 2 && self.end(path) == path.from
    }

    /// A point in millimetres.
    pub(super) fn mm(&self, p: [i64; 2]) -> [f64; 2] {
        p.map(|v| super::ticks::units(v) * self.frame.scale)
    }

    /// The points of a path, mm.
    pub(super) fn points<'a>(&'a self, path: &Path) -> impl Iterator<Item = [f64; 2]> + 'a {
        let from = path.from;
        std::iter::once(from).chain(self.segs[path.segs.clone()].iter().map(|seg| seg.to)).map(|p| self.mm(p))
    }

    /// Cost of the file's own travel up to the first path, and from there on.
    pub fn costs(&self) -> [LinkCost; 2] {
        [&self.junction, &self.links].map(|tokens| {
            let (mut cost, mut retracted) = (LinkCost::default(), false);
            for token in tokens {
                if matches!(token.kind, Kind::Travel | Kind::Wipe) {
                    cost.travel_mm += token.xy_mm;
                }
                match token.kind {
                    Kind::Retract | Kind::Wipe | Kind::FirmwareRetract => {
                        cost.retractions += usize::from(!retracted);
                        retracted = true;
                    }
                    Kind::Unretract | Kind::FirmwareUnretract | Kind::Fixed => retracted = false,
                    _ => {}
                }
            }
            cost
        })
    }
}
