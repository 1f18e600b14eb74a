//! Parts of a print that begin in mid-air, found from beads alone.
//!
//! The beads of a layer are painted on cells, cells that touch are one island, and an island is held if anything of it
//! lies on what was printed before, or on the bed.

use super::fault::Kind;
use super::model::is_part;
use super::relief::Relief;
use super::report::Found;
use super::rule::{LineContext, Rule};
use crate::gcode::Stroke;
use crate::profile::Settings;
use crate::toolpath::Role;
use geometry::DisjointSets;

/// Side of a cell: less than a bead, so that beads side by side touch and those of two islands do not.
const CELL_MM: f64 = 0.3;
/// A bead may lie this much higher than what it rests on.
const SLACK_MM: f64 = 0.05;
/// A bead is held also by what lies beside it at a little more than half its width, as on slopes.
const REACH: f64 = 1.3;
/// Support and rafts leave a gap of at most this under what they hold.
const GAP_MM: f64 = 0.4;
/// Islands with less of a bead are dots.
const SHORTEST_MM: f64 = 1.5;
/// A first layer is not thicker than this.
const FIRST_MM: f64 = 0.6;
/// Steps of this many nozzle diameters may be a layer's height, where the file does not give it.
const LAYER_NOZZLES: f64 = 0.85;
/// And steps up to this many times the usual one.
const LAYER_STEPS: f64 = 1.6;
/// From where to where nothing reaches.
const NO_SPAN: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];
/// Width of a bead in nozzle diameters, where the file does not give it.
const WIDTH_NOZZLES: f64 = 1.1;

/// Follows what is printed, layer by layer.
pub(super) struct Floating {
    part: Relief,
    /// Supports, skirts and what is not known.
    other: Relief,
    nozzle_mm: f64,
    /// Whether the file says what beads are for.
    has_roles: bool,
    layer: Option<Option<usize>>,
    islands: Islands,
    steps: Steps,
    /// Tops of the current beads, by cell.
    laid: Vec<(usize, f32, bool)>,
    /// The lowest bead, and the highest of the layers before.
    lowest_mm: f64,
    top_mm: f64,
    z_mm: f64,
    /// Where the part's beads of the current layer lie, from the lowest bottom to the highest top, and the highest top of
    /// those in the layer before.
    span_mm: [f64; 2],
    under_mm: f64,
    /// Where the last bead ended, and its island.
    last: ([f64; 3], usize),
}

impl Floating {
    pub fn new(settings: &Settings) -> Self {
        let relief = || Relief::new(settings.bed.low_mm(), settings.bed.high_mm(), CELL_MM);
        let part = relief();
        Self {
            islands: Islands::new(part.cell_count()),
            part,
            other: relief(),
            nozzle_mm: settings.printer.nozzle_diameter.0,
            has_roles: false,
            layer: None,
            steps: Steps::default(),
            laid: Vec::new(),
            lowest_mm: f64::INFINITY,
            top_mm: f64::NEG_INFINITY,
            z_mm: f64::NEG_INFINITY,
            span_mm: NO_SPAN,
            under_mm: f64::NEG_INFINITY,
            last: ([f64::NAN; 3], 0),
        }
    }

    fn bead(&mut self, bead: &Stroke, seen: &LineContext<'_>, is_part: bool) {
        let z_mm = bead.to[2];
        let height_mm = seen.context.height_mm.unwrap_or_else(|| {
            let step_mm = z_mm - if self.top_mm.is_finite() { self.top_mm } else { 0.0 };
            self.steps.height_mm(step_mm, self.nozzle_mm)
        });
        let width_mm = seen.context.width_mm.unwrap_or(WIDTH_NOZZLES * self.nozzle_mm).clamp(0.1, 3.0);
        if is_part {
            let [low_mm, high_mm] = self.span_mm;
            self.span_mm = [low_mm.min(z_mm - height_mm), high_mm.max(z_mm)];
        }
        let location = Location { line: seen.line.number, layer: seen.context.layer, at_mm: bead.to };
        let island = match self.last {
            (end, island) if end == bead.from && island < self.islands.count() => island,
            _ => self.islands.begin(location),
        };
        self.last = (bead.to, island);
        // What has no wall lies inside something that has.
        let is_wall = seen.context.role.is_none_or(Role::is_wall);
        self.islands.lengthen(island, bead.xy_mm, [is_part, is_part && is_wall]);
        // Where the file does not distinguish supports from the part, gaps over them have to be let pass.
        let slack_mm = if self.has_roles { SLACK_MM } else { GAP_MM };
        let (part, other) = (&self.part, &self.other);
        let (islands, laid) = (&mut self.islands, &mut self.laid);
        let lowest_mm = self.lowest_mm;
        let before = laid.len();
        part.each_cell(bead, REACH * width_mm, |cell, z_mm| {
            let under_mm = z_mm - height_mm;
            let on_bed = under_mm <= SLACK_MM || z_mm <= lowest_mm + SLACK_MM && under_mm <= FIRST_MM;
            let held =
                on_bed || part.top(cell) >= under_mm - slack_mm || other.top(cell) >= under_mm - GAP_MM;
            islands.cover(island, cell, held, part);
            laid.push((cell, z_mm as f32, is_part));
        });
        // Of what lies beyond the bed nothing is known.
        if laid.len() == before {
            islands.islands[island].held = true;
        }
    }

    /// The current layer is complete.
    fn end_layer(&mut self, found: &mut Found) {
        let islands = self.islands.finish();
        let cell_mm = self.part.cell_mm();
        let of_part = |island: &&Island| island.has_wall && island.length_mm > SHORTEST_MM;
        let hanging: Vec<&Island> = islands.iter().filter(of_part).filter(|island| !island.held).collect();
        // Beside what the layer beneath has of the part, each island is a matter of its own.
        let [low_mm, high_mm] = std::mem::replace(&mut self.span_mm, NO_SPAN);
        let follows = (low_mm - SLACK_MM..high_mm).contains(&self.under_mm);
        if high_mm.is_finite() {
            self.under_mm = high_mm;
        }
        if !hanging.is_empty() && !follows && !islands.iter().any(|island| island.is_part && island.held) {
            let (location, z_mm, top_mm) = (&hanging[0].location, self.z_mm, self.top_mm);
            found.add(Kind::StartsInAir, location.line, location.layer, || match top_mm.is_finite() {
                true => format!(
                    "at Z{z_mm:.2}; of the part nothing is beneath, and nothing at all above Z{top_mm:.2}"
                ),
                false => format!("at Z{z_mm:.2}; nothing is beneath"),
            });
        } else {
            for Island { location, cells, .. } in hanging {
                let [x, y, z] = location.at_mm;
                found.add(Kind::FloatingIsland, location.line, location.layer, || {
                    let area_mm2 = *cells as f64 * cell_mm * cell_mm;
                    format!("about {area_mm2:.1} mm² at X{x:.2} Y{y:.2} Z{z:.2}")
                });
            }
        }
        for (cell, z_mm, is_part) in self.laid.drain(..) {
            let relief = if is_part { &mut self.part } else { &mut self.other };
            relief.raise_cell(cell, f64::from(z_mm));
        }
        if self.z_mm > self.top_mm {
            self.steps.add(self.z_mm - self.top_mm);
        }
        self.top_mm = self.z_mm;
        self.last.1 = usize::MAX;
    }
}

impl Rule for Floating {
    fn check_line(&mut self, seen: &LineContext<'_>, found: &mut Found) {
        if seen.line.code.is_none() && self.layer.is_none() {
            self.steps.header(seen.line.comment.unwrap_or_default());
        }
        let Some(bead) = seen.bead().filter(|bead| bead.xy_mm > 0.0) else { return };
        let role = seen.context.role;
        if role == Some(Role::Ironing) || seen.in_script {
            return;
        }
        self.has_roles |= role.is_some();
        if self.layer.replace(seen.context.layer).is_some_and(|layer| layer != seen.context.layer) {
            self.end_layer(found);
            self.z_mm = f64::NEG_INFINITY;
        }
        self.z_mm = self.z_mm.max(bead.to[2]);
        if role.is_some() || !self.has_roles {
            self.lowest_mm = self.lowest_mm.min(bead.to[2]);
        }
        self.bead(bead, seen, role.map_or(!self.has_roles, is_part));
    }

    fn end(&mut self, found: &mut Found) {
        self.end_layer(found);
    }
}

/// Distances between layers, from which a layer's height follows where the file does not give it.
#[derive(Default)]
struct Steps {
    /// From the file's header, mm.
    told_mm: Option<f64>,
    /// Steps in micrometres, and how often each was made: the first few that differ.
    made: Vec<(i64, usize)>,
}

impl Steps {
    const MOST: usize = 64;

    /// Adds a comment of the header: Cura's `;Layer height: 0.2`.
    fn header(&mut self, comment: &[u8]) {
        let Some(value) = comment.trim_ascii().strip_prefix(b"Layer height:") else { return };
        let value = std::str::from_utf8(value).ok().and_then(|text| text.trim().parse::<f64>().ok());
        self.told_mm = value.filter(|mm| *mm > 0.0).or(self.told_mm);
    }

    fn add(&mut self, step_mm: f64) {
        if !step_mm.is_finite() {
            return;
        }
        let um = (step_mm * 1000.0).round() as i64;
        match self.made.iter().position(|(made, _)| *made == um) {
            Some(at) => self.made[at].1 += 1,
            None if self.made.len() < Self::MOST => self.made.push((um, 1)),
            None => {}
        }
    }

    /// The height of a layer that lies so far above the one before: that, unless it is more than a layer can be.
    fn height_mm(&self, step_mm: f64, nozzle_mm: f64) -> f64 {
        let most = self.made.iter().max_by_key(|(um, count)| (*count, -um));
        let usual_mm = self.told_mm.or(most.map(|(um, _)| *um as f64 / 1000.0));
        let limit_mm = (LAYER_NOZZLES * nozzle_mm).max(usual_mm.unwrap_or(FIRST_MM) * LAYER_STEPS);
        if step_mm <= limit_mm { step_mm.max(0.0) } else { usual_mm.unwrap_or(nozzle_mm / 2.0) }
    }
}

/// The position of a finding.
#[derive(Clone, Copy)]
struct Location {
    line: usize,
    layer: Option<usize>,
    at_mm: [f64; 3],
}

/// Beads of a layer that touch.
struct Island {
    location: Location,
    cells: usize,
    length_mm: f64,
    held: bool,
    is_part: bool,
    has_wall: bool,
}

/// The islands of the current layer, joined over cells.
struct Islands {
    /// For each cell the layer in which it was covered last, and by which island.
    of_cell: Vec<(u32, u32)>,
    layer: u32,
    joined: DisjointSets,
    islands: Vec<Island>,
}

impl Islands {
    fn new(cells: usize) -> Self {
        Self { of_cell: vec![(0, 0); cells], layer: 1, joined: DisjointSets::default(), islands: Vec::new() }
    }

    fn count(&self) -> usize {
        self.islands.len()
    }

    fn begin(&mut self, location: Location) -> usize {
        self.joined.push();
        let (held, is_part, has_wall) = (false, false, false);
        self.islands.push(Island { location, cells: 0, length_mm: 0.0, held, is_part, has_wall });
        self.islands.len() - 1
    }

    fn lengthen(&mut self, island: usize, by_mm: f64, [is_part, is_wall]: [bool; 2]) {
        let island = &mut self.islands[island];
        island.length_mm += by_mm;
        island.is_part |= is_part;
        island.has_wall |= is_wall;
    }

    /// Covers a cell, and joins what covers it and its neighbours already.
    fn cover(&mut self, island: usize, cell: usize, held: bool, relief: &Relief) {
        let (layer, own) = self.of_cell[cell];
        self.islands[island].held |= held;
        if (layer, own) == (self.layer, island as u32) {
            return;
        }
        if layer == self.layer {
            self.join(island, own as usize);
        } else {
            self.islands[island].cells += 1;
        }
        self.of_cell[cell] = (self.layer, island as u32);
        for near in relief.neighbours(cell) {
            let (layer, other) = self.of_cell[near];
            if layer == self.layer && other != island as u32 {
                self.join(island, other as usize);
            }
        }
    }

    fn join(&mut self, a: usize, b: usize) {
        self.joined.join(a as u32, b as u32);
    }

    /// The islands, joined; the next layer begins.
    fn finish(&mut self) -> Vec<Island> {
        for island in (0..self.islands.len()).rev() {
            let root = self.joined.find(island as u32) as usize;
            if root != island {
                let Island { cells, length_mm, held, is_part, has_wall, .. } = self.islands[island];
                let into = &mut self.islands[root];
                into.cells += cells;
                into.length_mm += length_mm;
                into.held |= held;
                into.is_part |= is_part;
                into.has_wall |= has_wall;
            }
        }
        let mut joined = std::mem::take(&mut self.joined);
        self.layer += 1;
        let islands = std::mem::take(&mut self.islands).into_iter().enumerate();
        islands.filter(|(i, _)| joined.find(*i as u32) as usize == *i).map(|(_, island)| island).collect()
    }
}
