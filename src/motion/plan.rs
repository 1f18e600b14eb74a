//! One layer's paths, in the order found, as moves.

use std::cell::OnceCell;

use super::arc;
use super::bead::{Vertex, length_mm, trace};
use super::ends::{self, Scarf, Step};
use super::nozzle::Nozzle;
use super::overhang::{Grade, HELD, Support};
use super::prime::prime;
use super::rules::Rules;
use super::simplify::straighten;
use super::smooth::{Rounding, curve_rad, gentle_rad, refine_curves, round_corners};
use super::{Entry, LayerMoves, MotionSettings, Move, PauseAt, Stop, tool, travel};
use crate::order::PathVisit;
use crate::toolpath::{LayerKind, LayerPaths, Path, Role};
use crate::units::{Mm3, MmPerS};
use geometry::{Router, polyline_length_mm};

/// Walls around discs up to this size are small.
const SMALL_RADIUS_MM: f64 = 6.5;

/// Plans a layer. `sequence` says in which order and direction its paths are drawn: `entry` is 0 or 1
/// (forwards, backwards) of open paths, of closed ones the index of the vertex where they are entered and
/// left. `from` is where the layer below [ended](exit).
///
/// The volume of the moves is that of the paths but for what the seam's gap leaves out, up to floating-point
/// rounding; first and last vertex of an open bead are exactly the path's. Visits of paths that are not there are
/// skipped.
pub fn plan_layer(
    layer: &LayerPaths,
    sequence: &[PathVisit],
    from: Entry,
    settings: &MotionSettings,
) -> LayerMoves {
    let layer_z_mm = layer.top_mm + settings.z_offset.0;
    let all = settings;
    let settings = all.of_tool(from.tool);
    let rules = Rules::new(settings, layer.index);
    let vertices: usize = layer.paths.iter().map(|p| p.points.len()).sum();
    // Curves are drawn with more vertices than they have.
    let mut moves = Vec::with_capacity(2 * vertices + 6 * sequence.len() + 8);
    // Nothing has been printed yet that a later object would pass over.
    moves.extend(rules.opening(from.over_mm <= 0.0));
    let mut nozzle = Nozzle {
        all,
        settings,
        tool: from.tool,
        parked: from.parked,
        restart_mm: None,
        router: Router::new(&layer.outline, settings.wall_width.0, settings.travel.detour_mm()),
        outline: &layer.outline,
        clipper: OnceCell::new(),
        support: support(layer),
        islands: &layer.islands,
        island: None,
        fan: rules.fan(None),
        rules,
        moves,
        at: from.xy,
        z_mm: from.z_mm,
        layer_z_mm,
        positioned: false,
        wipe: from.wipe.clone(),
        over_mm: from.over_mm,
        beside_mm: if layer.turn.beside_mm > 0.0 { layer.turn.beside_mm + all.z_offset.0 } else { 0.0 },
        within_tower: false,
        retracted_mm: from.retracted_mm,
        extra_mm3: 0.0,
        acceleration: None,
        bead: None,
        small: false,
        fitted: false,
        object: None,
        plain: Vec::new(),
        curved: Vec::new(),
        pieces: Vec::new(),
    };
    let precedes = |stops: &[PauseAt]| {
        let begins = !layer.turn.is_later && !layer.turn.primes;
        begins && stops.iter().any(|p| p.precedes(layer.index, layer.top_mm, layer.height_mm))
    };
    let mut stop = precedes(&settings.color_changes)
        .then_some(Stop::ColorChange)
        .or(precedes(&settings.pauses).then_some(Stop::Pause));
    // What the start script has left to the slicer.
    let mut is_empty = layer.turn.primes && settings.swaps();
    if is_empty {
        // There is nothing to pull back, nor to push forward, on the way to where it is loaded.
        nozzle.retracted_mm = settings.retract.length.0;
    }
    let mut vertices = Vec::new();
    for visit in sequence {
        let Some(path) = layer.paths.get(visit.path as usize) else { continue };
        let changes = path.tool.filter(|tool| *tool != nozzle.tool);
        let was_in_tower = nozzle.bead.is_some_and(|(role, ..)| role == Role::PrimeTower);
        if let Some(tool) = changes {
            nozzle.label(None);
            nozzle.within_tower = was_in_tower;
            let ram = layer.rams.iter().find(|ram| ram.tool == Some(nozzle.tool));
            nozzle.change_tool(tool, ram);
        }
        trace(path, visit.entry, nozzle.rules.flow(path.role), &mut vertices);
        turn_round(path, &mut vertices, layer.index, nozzle.support.as_ref(), all);
        let Some(start) = vertices.first() else { continue };
        nozzle.label(
            path.island.and_then(|island| layer.islands.get(island.index())).map(|island| island.object),
        );
        if let LayerKind::Spiral(rises) = &layer.kind {
            nozzle.draw_revolution(path, &vertices, rises, stop.take());
            continue;
        }
        // After a change the nozzle is where it was only if the tower was rammed there.
        let is_in_tower = if changes.is_some() { nozzle.at.is_some() } else { was_in_tower };
        nozzle.within_tower = is_in_tower && path.role == Role::PrimeTower;
        nozzle.travel(start.at, path.island, stop.take());
        if std::mem::take(&mut is_empty) {
            nozzle.moves.pop_if(|step| matches!(step, Move::Unretract { .. }));
            nozzle.load_first();
        }
        if let Some(extra_mm) = nozzle.restart_mm.take() {
            nozzle.extra_mm3 = extra_mm * nozzle.settings.flow.filament_area_mm2;
        }
        nozzle.draw(path, &mut vertices);
    }
    nozzle.label(None);
    nozzle.set_fan(None);
    LayerMoves { index: layer.index, z_mm: layer_z_mm, height_mm: layer.height_mm, from, moves: nozzle.moves }
}

/// Position of the nozzle after a layer, from which the next one is [planned](Entry). A layer without paths leaves it
/// where it was.
pub fn exit(layer: &LayerPaths, sequence: &[PathVisit], from: Entry, settings: &MotionSettings) -> Entry {
    let mut vertices = Vec::new();
    let last = sequence.iter().rev().find_map(|visit| {
        let path = layer.paths.get(visit.path as usize)?;
        trace(path, visit.entry, 1.0, &mut vertices);
        (!vertices.is_empty()).then_some(path)
    });
    let Some(path) = last else { return from };
    let (tool, parked) = tool::left(layer, sequence, &from, settings);
    let own = settings.of_tool(tool);
    let support = if settings.reverse_overhangs { support(layer) } else { None };
    turn_round(path, &mut vertices, layer.index, support.as_ref(), settings);
    let scarf = finish(path, &mut vertices, layer.index, own);
    let (end, wipe) = end(path, &vertices, scarf.as_ref(), own);
    let z_mm = layer.top_mm + settings.z_offset.0;
    Entry { xy: end, z_mm, wipe, tool, parked, ..Entry::default() }
}

/// What walls may hang over; `None`: the layers are alike, as in a prism, and nothing does.
fn support(layer: &LayerPaths) -> Option<Support> {
    layer.beneath.as_ref().filter(|beneath| **beneath != layer.outline).map(Support::new)
}

/// Turns a loop round that hangs over, where that is wanted and due.
fn turn_round(
    path: &Path,
    vertices: &mut [Vertex],
    layer: usize,
    support: Option<&Support>,
    settings: &MotionSettings,
) {
    let due = settings.reverse_overhangs && layer % 2 == 1 && path.closed && path.role.is_wall();
    let Some(support) = support.filter(|_| due) else { return };
    let stretches = support.stretches(vertices, path.width.mean_mm(), 0.0);
    if stretches.iter().any(|(grade, _)| *grade > Grade::Quarter) {
        vertices.reverse();
    }
}

/// Where a bead ends, and where to wipe from there: of a loop on along it, over its beginning, away from the seam; else
/// back along itself.
fn end(
    path: &Path,
    vertices: &[Vertex],
    scarf: Option<&Scarf>,
    settings: &MotionSettings,
) -> (Option<[f64; 2]>, Vec<[f64; 2]>) {
    let wipe_mm = settings.retract.wipe.0;
    let last = vertices.last().map(|v| v.at);
    if let Some(Scarf { fade, .. }) = scarf {
        let end = fade.last().map(|step| step.to);
        return (end, travel::wipe_path(fade.iter().rev().map(|step| step.to), wipe_mm));
    }
    let back = vertices.iter().map(|v| v.at);
    let wipe = match path.closed {
        _ if wipe_mm <= 0.0 => Vec::new(),
        true => travel::wipe_path(last.into_iter().chain(back), wipe_mm),
        false => travel::wipe_path(back.rev(), wipe_mm),
    };
    (last, wipe)
}

/// Makes the end of a loop: a scarf, or else a gap, which is cut off its vertices.
fn finish(path: &Path, vertices: &mut Vec<Vertex>, layer: usize, settings: &MotionSettings) -> Option<Scarf> {
    let wall = path.role.is_wall();
    if !path.closed || !wall {
        return None;
    }
    let scarfed = path.role == Role::ExternalPerimeter
        && layer > 0
        && !(settings.seam.scarf_smooth_only && ends::is_corner(vertices));
    let scarf = scarfed.then(|| Scarf::new(vertices, settings.seam.scarf.0)).flatten();
    if scarf.is_none() {
        ends::clip(vertices, settings.seam.gap.0);
    }
    scarf
}

/// Whether a wall is no longer than the outline of a small disc.
fn is_small(path: &Path) -> bool {
    let closing = path.closed.then(|| path.points.first().zip(path.points.last())).flatten();
    let closing_mm = closing.map_or(0.0, |(first, last)| first.distance_mm(*last));
    polyline_length_mm(&path.points) + closing_mm <= std::f64::consts::TAU * SMALL_RADIUS_MM
}

impl Nozzle<'_> {
    /// Sets the acceleration of a role, of walls by how far they hang over, or of travel.
    pub(super) fn accelerate(&mut self, drawn: Option<(Role, Grade)>) {
        let wanted = self.rules.acceleration(drawn);
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

    /// Sets the fan for a grade of overhang or a bridge; `None`: to the layer's own speed.
    fn set_fan(&mut self, drawn: Option<(Role, Grade)>) {
        let fan = self.rules.fan(drawn);
        if fan != self.fan {
            self.moves.push(Move::Fan(fan));
            self.fan = fan;
        }
    }

    /// Draws a bead from where the nozzle is, its first vertex.
    fn draw(&mut self, path: &Path, vertices: &mut Vec<Vertex>) {
        let first = self.moves.len();
        self.small = path.role.is_wall() && is_small(path);
        let island = path.island.and_then(|island| self.islands.get(island.index()));
        // Sparse infill meets nothing.
        self.fitted = path.role != Role::InternalInfill && island.is_some_and(|island| island.meets_others);
        let scarf = finish(path, vertices, self.rules.index(), self.settings);
        if let Some(scarf) = &scarf {
            self.begin(path, Grade::Held);
            self.lift(self.layer_z_mm - Scarf::FIRST_BELOW * path.height_mm);
            self.draw_steps(path, &scarf.rise);
            self.draw_graded(path, &scarf.body);
            self.begin(path, Grade::Held);
            self.draw_steps(path, &scarf.fade);
        } else {
            self.draw_graded(path, vertices);
        }
        if let Some(from) = self.at {
            let extra_mm3 = std::mem::take(&mut self.extra_mm3);
            let melted = |speed, area_mm2| self.rules.melted(speed, area_mm2);
            prime(&mut self.moves, first, from, extra_mm3, melted);
        }
        (self.at, self.wipe) = end(path, vertices, scarf.as_ref(), self.settings);
    }

    /// Says what is drawn next.
    pub(super) fn begin(&mut self, path: &Path, grade: Grade) {
        let role = if grade > Grade::Quarter { Role::OverhangPerimeter } else { path.role };
        let bead = (role, path.width.mean_mm(), path.height_mm);
        if self.bead != Some(bead) {
            let (role, width_mm, height_mm) = bead;
            self.moves.push(Move::Bead { role, width_mm, height_mm });
            self.bead = Some(bead);
        }
        self.set_fan(Some((path.role, grade)));
        self.accelerate(Some((path.role, grade)));
    }

    /// Draws vertices, walls graded by how far they hang.
    fn draw_graded(&mut self, path: &Path, vertices: &[Vertex]) {
        let island = path.island.and_then(|island| self.islands.get(island.index()));
        let may_hang = path.role.is_wall() && !island.is_some_and(|island| island.repeats);
        let stretches = match &self.support {
            Some(support) if may_hang => {
                let held = if self.rules.tells_quarters(path.role, self.small) { HELD } else { 0.0 };
                support.stretches(vertices, path.width.mean_mm(), held)
            }
            _ => Vec::new(),
        };
        if stretches.is_empty() {
            self.begin(path, Grade::Held);
            self.draw_stretch(path.role, Grade::Held, vertices);
        }
        for (grade, vertices) in stretches {
            self.begin(path, grade);
            self.draw_stretch(path.role, grade, &vertices);
        }
    }

    /// Speed of a role before the flow limit.
    pub(super) fn speed(&self, role: Role, grade: Grade) -> MmPerS {
        self.rules.speed(role, grade, self.small)
    }

    fn draw_stretch(&mut self, role: Role, grade: Grade, vertices: &[Vertex]) {
        match self.settings.arcs {
            Some(tolerance) if vertices.windows(2).all(|v| v[0].area_mm2 == v[1].area_mm2) => {
                self.draw_with_arcs(role, grade, vertices, tolerance.0);
            }
            _ => self.draw_straight(role, grade, vertices),
        }
    }

    fn draw_straight(&mut self, role: Role, grade: Grade, vertices: &[Vertex]) {
        let Some(from) = vertices.first().map(|v| v.at) else { return };
        let speed = self.speed(role, grade);
        let width_mm = self.bead.map_or(0.0, |bead| bead.1);
        self.pieces.clear();
        self.plain.clear();
        if self.fitted {
            straighten(vertices, &mut self.pieces);
        } else {
            straighten(vertices, &mut self.plain);
            self.curved.clear();
            let gentle_rad = gentle_rad(speed, self.settings.square_corner_velocity);
            refine_curves(from, &self.plain, curve_rad(role, gentle_rad), &mut self.curved);
            round_corners(from, &self.curved, &Rounding::of(role, width_mm, gentle_rad), &mut self.pieces);
        }
        self.moves.extend(self.pieces.iter().map(|piece| Move::Extrude {
            to: piece.to,
            volume: Mm3(piece.volume_mm3),
            speed: self.rules.melted(speed, piece.area_mm2),
        }));
    }

    fn draw_steps(&mut self, path: &Path, steps: &[Step]) {
        let speed = self.speed(path.role, Grade::Held);
        let z_mm = |step: &Step| self.layer_z_mm - step.below * path.height_mm;
        self.moves.extend(steps.iter().map(|step| Move::Ramp {
            to: step.to,
            z_mm: z_mm(step),
            volume: Mm3(step.volume_mm3),
            speed: self.rules.melted(speed, step.area_mm2),
        }));
    }

    fn draw_with_arcs(&mut self, role: Role, grade: Grade, vertices: &[Vertex], tolerance_mm: f64) {
        let points: Vec<[f64; 2]> = vertices.iter().map(|v| v.at).collect();
        let mut start = 0;
        for part in arc::parts(&points, tolerance_mm) {
            let stretch = &vertices[start..=part.end];
            start = part.end;
            let Some(circle) = part.arc else {
                self.draw_straight(role, grade, stretch);
                continue;
            };
            let area_mm2 = stretch[0].area_mm2;
            let length_mm = length_mm(stretch);
            self.moves.push(Move::Arc {
                to: points[part.end],
                center: circle.center,
                clockwise: circle.clockwise,
                volume: Mm3(area_mm2 * length_mm),
                speed: self.rules.melted(self.speed(role, grade), area_mm2),
            });
        }
    }
}
