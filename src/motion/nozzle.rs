//! The state of the machine while a layer is planned.

use std::cell::OnceCell;

use geometry::{Clipper, Region, Router};

use super::overhang::Support;
use super::rules::Rules;
use super::simplify::Piece;
use super::{MotionSettings, Move};
use crate::toolpath::{Island, IslandId, Role, ToolId};
use crate::units::{MmPerS2, Ratio};

/// The state of the machine while a layer is planned.
pub(super) struct Nozzle<'a> {
    /// The settings of all tools.
    pub(super) all: &'a MotionSettings,
    /// The settings of the tool in use.
    pub(super) settings: &'a MotionSettings,
    pub(super) tool: ToolId,
    /// Tools that were put away with their filament pulled back, a bit each.
    pub(super) parked: u32,
    /// Filament fed with the next bead, where that is not as after any retraction, millimetres.
    pub(super) restart_mm: Option<f64>,
    pub(super) router: Router<'a>,
    pub(super) outline: &'a Region,
    /// The outline, made ready for clipping when that is first needed.
    pub(super) clipper: OnceCell<Clipper>,
    /// What walls may hang over; `None`: none does.
    pub(super) support: Option<Support>,
    /// The islands of the layer.
    pub(super) islands: &'a [Island],
    /// Island of the path drawn last, if one was.
    pub(super) island: Option<Option<IslandId>>,
    pub(super) rules: Rules<'a>,
    pub(super) fan: Ratio,
    pub(super) moves: Vec<Move>,
    pub(super) at: Option<[f64; 2]>,
    pub(super) z_mm: f64,
    pub(super) layer_z_mm: f64,
    /// Whether this layer's moves have said where the nozzle is.
    pub(super) positioned: bool,
    /// Where to wipe after the bead drawn last.
    pub(super) wipe: Vec<[f64; 2]>,
    /// The next travel keeps above this.
    pub(super) over_mm: f64,
    /// Travels that begin the layer, or lead to another island, keep above this; 0: nothing is in their way.
    pub(super) beside_mm: f64,
    /// Whether the next travel stays within the prime tower, where what oozes does no harm.
    pub(super) within_tower: bool,
    /// Filament that is pulled back before the first travel.
    pub(super) retracted_mm: f64,
    /// Filament to be fed with the next bead beyond what it holds.
    pub(super) extra_mm3: f64,
    pub(super) acceleration: Option<MmPerS2>,
    pub(super) bead: Option<(Role, f64, f64)>,
    /// Whether the path being drawn is a small wall.
    pub(super) small: bool,
    /// Whether its corners stay as they are planned.
    pub(super) fitted: bool,
    pub(super) object: Option<u32>,
    /// The current bead, with its corners as they are, its curves refined, and as it is drawn.
    pub(super) plain: Vec<Piece>,
    pub(super) curved: Vec<Piece>,
    pub(super) pieces: Vec<Piece>,
}
