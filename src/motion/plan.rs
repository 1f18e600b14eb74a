//! One layer's paths, in the order found, as moves.

use super::arc;
use super::bead::{Vertex, mean_width_mm, trace};
use super::rules::Rules;
use super::simplify::{Piece, straighten};
use super::smooth::{Rounding, refine_curves, round_corners};
use super::{Entry, LayerMoves, MotionSettings, Move};
use crate::order::Visit;
use crate::toolpath::{LayerPaths, Path, Role};
use crate::units::{Mm3, MmPerS2};

/// Plans a layer. `sequence` says in which order and direction its paths are drawn: `entry` is 0 or 1
/// (forwards, backwards) of open paths, of closed ones the index of the vertex where they are entered and
/// left. `from` is where the layer below [ended](exit).
///
/// The volume of the moves is that of the paths, up to floating-point rounding; first and last vertex of a
/// bead are exactly the path's. Visits of paths that are not there are skipped.
pub fn plan_layer(
    layer: &LayerPaths,
    sequence: &[Visit],
    from: Entry,
    settings: &MotionSettings,
) -> LayerMoves {
    let layer_z_mm = layer.top_mm + settings.z_offset.0;
    let rules = Rules::new(settings, layer.index);
    let vertices: usize = layer.paths.iter().map(|p| p.points.len()).sum();
    let mut moves = Vec::with_capacity(vertices + 6 * sequence.len() + 8);
    moves.extend(rules.opening());
    let mut nozzle = Nozzle {
        settings,
        rules,
        moves,
        at: from.xy,
        z_mm: from.z_mm,
        layer_z_mm,
        positioned: false,
        trail: Vec::new(),
        acceleration: None,
        bead: None,
        object: None,
        plain: Vec::new(),
        curved: Vec::new(),
        pieces: Vec::new(),
    };
    let mut pause = settings.pauses.iter().any(|p| p.precedes(layer.index, layer.top_mm, layer.height_mm));
    let mut vertices = Vec::new();
    for visit in sequence {
        let Some(path) = layer.paths.get(visit.item as usize) else { continue };
        let flow = nozzle.rules.flow();
        trace(path, visit.entry, settings.flow.nozzle_diameter.0, flow, &mut vertices);
        let Some(start) = vertices.first() else { continue };
        nozzle.label(layer.islands.get(path.island as usize).map(|island| island.object));
        nozzle.travel(start.at, std::mem::take(&mut pause));
        nozzle.draw(path, &vertices);
    }
    nozzle.label(None);
    LayerMoves { index: layer.index, z_mm: layer_z_mm, height_mm: layer.height_mm, from, moves: nozzle.moves }
}

/// Where the nozzle is after a layer: what the next one is planned [from](Entry). A layer without paths leaves
/// it where it was.
pub fn exit(layer: &LayerPaths, sequence: &[Visit], from: Entry, settings: &MotionSettings) -> Entry {
    let end = sequence.iter().rev().find_map(|visit| {
        let path = layer.paths.get(visit.item as usize)?;
        let at = match (path.closed, visit.entry) {
            (true, entry) => entry as usize % path.points.len().max(1),
            (false, 0) => path.points.len().saturating_sub(1),
            (false, _) => 0,
        };
        path.points.get(at)
    });
    match end {
        Some(end) => Entry { xy: Some(end.mm()), z_mm: layer.top_mm + settings.z_offset.0 },
        None => from,
    }
}

/// The state of the machine while a layer is planned.
pub(super) struct Nozzle<'a> {
    pub(super) settings: &'a MotionSettings,
    rules: Rules<'a>,
    pub(super) moves: Vec<Move>,
    pub(super) at: Option<[f64; 2]>,
    pub(super) z_mm: f64,
    pub(super) layer_z_mm: f64,
    /// Whether this layer's moves have said where the nozzle is.
    pub(super) positioned: bool,
    /// The bead drawn last, for wiping.
    pub(super) trail: Vec<[f64; 2]>,
    acceleration: Option<MmPerS2>,
    bead: Option<(Role, f64, f64)>,
    object: Option<u32>,
    /// The bead under way, with its corners as they are, its curves refined, and as it is drawn.
    plain: Vec<Piece>,
    curved: Vec<Piece>,
    pieces: Vec<Piece>,
}

impl Nozzle<'_> {
    /// Sets the acceleration of a role, or of travel.
    pub(super) fn accelerate(&mut self, role: Option<Role>) {
        let wanted = self.rules.acceleration(role);
        if let Some(acceleration) = wanted
            && self.acceleration != wanted
        {
            self.moves.push(Move::Acceleration(acceleration));
            self.acceleration = wanted;
        }
    }

    /// Says which object what follows belongs to, where that is wanted and changes.
    fn label(&mut self, object: Option<u32>) {
        if self.settings.labels && self.object != object {
            self.moves.push(Move::Object(object));
            self.object = object;
        }
    }

    /// Draws a bead from where the nozzle is, its first vertex.
    fn draw(&mut self, path: &Path, vertices: &[Vertex]) {
        let bead = (path.role, mean_width_mm(&path.width), path.height_mm);
        if self.bead != Some(bead) {
            let (role, width_mm, height_mm) = bead;
            self.moves.push(Move::Bead { role, width_mm, height_mm });
            self.bead = Some(bead);
        }
        self.accelerate(Some(path.role));
        if self.settings.retract.wipe.0 > 0.0 {
            self.trail.clear();
            self.trail.extend(vertices.iter().map(|v| v.at));
        }
        match self.settings.arcs {
            Some(tolerance) if vertices.windows(2).all(|v| v[0].area_mm2 == v[1].area_mm2) => {
                self.draw_with_arcs(path.role, vertices, tolerance.0);
            }
            _ => self.draw_straight(path.role, vertices),
        }
        self.at = vertices.last().map(|v| v.at);
    }

    fn draw_straight(&mut self, role: Role, vertices: &[Vertex]) {
        let Some(from) = vertices.first().map(|v| v.at) else { return };
        let speed = self.rules.speed(role);
        let width_mm = self.bead.map_or(0.0, |bead| bead.1);
        self.pieces.clear();
        self.plain.clear();
        straighten(vertices, &mut self.plain);
        self.curved.clear();
        refine_curves(from, &self.plain, &mut self.curved);
        round_corners(from, &self.curved, &Rounding::of(role, width_mm), &mut self.pieces);
        self.moves.extend(self.pieces.iter().map(|piece| Move::Extrude {
            to: piece.to,
            volume: Mm3(piece.volume_mm3),
            speed: self.rules.melted(speed, piece.area_mm2),
        }));
    }

    fn draw_with_arcs(&mut self, role: Role, vertices: &[Vertex], tolerance_mm: f64) {
        let points: Vec<[f64; 2]> = vertices.iter().map(|v| v.at).collect();
        let mut start = 0;
        for part in arc::parts(&points, tolerance_mm) {
            let stretch = &vertices[start..=part.end];
            start = part.end;
            let Some(circle) = part.arc else {
                self.draw_straight(role, stretch);
                continue;
            };
            let area_mm2 = stretch[0].area_mm2;
            let length_mm: f64 = points_length_mm(stretch);
            self.moves.push(Move::Arc {
                to: points[part.end],
                center: circle.center,
                clockwise: circle.clockwise,
                volume: Mm3(area_mm2 * length_mm),
                speed: self.rules.melted(self.rules.speed(role), area_mm2),
            });
        }
    }
}

fn points_length_mm(vertices: &[Vertex]) -> f64 {
    vertices.windows(2).map(|v| super::bead::distance(v[0].at, v[1].at)).sum()
}
