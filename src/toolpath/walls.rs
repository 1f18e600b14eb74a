//! Walls (perimeters) of one island.
//!
//! Beads overlap by what their round sides leave out, so wall k covers one spacing of depth. Where a part is
//! too narrow for another pair of beads, the remainder is handed out as a gap, to be filled with one bead of
//! fitting width. The classic generator lays walls of fixed width only; the variable one fits the innermost to the
//! part, see [`beading`](super::beading).

use super::options::WallGenerator;
use geometry::{Join, Polygon, Region};

use super::bead::{self, Line};
use super::beading::{self, Gap};

/// Two beads of fixed width that face each other may come this close, as a share of their spacing; nearer, one bead of
/// fitting width replaces them. Slic3r allows the same overlap.
const CLOSEST: f64 = 0.6;

/// No bead fills less.
const FINEST_MM: f64 = 0.02;

/// Widths of the beads of one layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallSpec {
    /// How many.
    pub count: u32,
    /// Width of the outermost.
    pub external_width_mm: f64,
    /// Width of the others.
    pub width_mm: f64,
    /// Layer height.
    pub height_mm: f64,
    /// Whether gaps are looked for.
    pub gap_fill: bool,
    /// Thinner parts are left out.
    pub min_feature_mm: f64,
    /// Fixed or variable widths.
    pub generator: WallGenerator,
    /// Whether the outermost wall and the next one do not overlap.
    pub precise: bool,
}

impl WallSpec {
    fn spacing_mm(&self, depth: u32) -> f64 {
        let width_mm = if depth == 0 { self.external_width_mm } else { self.width_mm };
        bead::spacing_mm(width_mm, self.height_mm)
    }

    /// The distance that the wall behind one keeps from what that fills.
    fn clear_mm(&self, depth: u32) -> f64 {
        let is_clear = self.precise && depth == 0 && self.count > 1;
        if is_clear { bead::rounding_mm(self.height_mm) } else { 0.0 }
    }

    /// What a wall at a depth leaves for those behind it.
    fn behind(&self, rest: Region, depth: u32) -> Region {
        match self.clear_mm(depth) {
            0.0 => rest,
            clear_mm => geometry::offset(&rest, -clear_mm),
        }
    }

    /// What beads fill of a section: their round sides leave out the rest.
    fn filled(&self, section: &Region) -> Region {
        geometry::offset(section, -bead::rounding_mm(self.height_mm) / 2.0)
    }

    /// The narrowest gap at a depth that is filled, as the spacing of the bead.
    pub fn least_gap_mm(&self, depth: u32) -> f64 {
        if depth > 0 {
            return beading::MIN_GAP_MM;
        }
        (self.min_feature_mm - bead::rounding_mm(self.height_mm)).max(FINEST_MM)
    }

    /// How far walls reach into the part.
    pub fn depth_mm(&self) -> f64 {
        let edge_mm = bead::rounding_mm(self.height_mm) / 2.0;
        edge_mm + (0..self.count).map(|d| self.spacing_mm(d) + self.clear_mm(d)).sum::<f64>()
    }

    /// In parts narrower than twice this only walls fit.
    pub fn core_mm(&self) -> f64 {
        let closest = match self.generator {
            WallGenerator::Variable => 2.0 * beading::PAIR,
            WallGenerator::Classic => CLOSEST,
        };
        self.depth_mm() + self.spacing_mm(1) * closest / 2.0
    }

    /// The widest single bead, as the spacing that it fills.
    pub fn widest_gap_mm(&self) -> f64 {
        let spacing_mm = bead::spacing_mm(self.width_mm.max(self.external_width_mm), self.height_mm);
        match self.generator {
            WallGenerator::Classic => 2.0 * spacing_mm,
            WallGenerator::Variable => beading::WIDEST * spacing_mm,
        }
    }
}

/// What the walls of one island are and leave.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Walls {
    /// Loops by depth, 0 the outermost; of each depth those that go round the island's parts and those round its
    /// holes.
    pub loops: Vec<Vec<Line>>,
    /// Narrow places between the beads, to be filled with single beads; each with the depth it lies at.
    pub gaps: Vec<(u32, Gap)>,
    /// What lies inside the innermost walls: the fill area.
    pub inside: Region,
}

/// Traces the walls of an island.
pub fn trace(island: &Polygon, spec: &WallSpec) -> Walls {
    let section = Region::from(island.clone());
    let variable = spec.generator == WallGenerator::Variable;
    let core_mm = spec.core_mm();
    let core = geometry::core(&section, core_mm);
    let least_mm = spec.least_gap_mm(0).min(beading::MIN_GAP_MM);
    if !core.region.is_empty() && geometry::narrower(&section, &core, core_mm, least_mm).is_empty() {
        concentric(&section, spec)
    } else if variable {
        fitted(spec.filled(&section), spec, 0)
    } else {
        with_gaps(spec.filled(&section), spec, 0)
    }
}

/// Traces the walls of an island with the outermost alone in a part of it. `bare` gives that part of what lies inside the
/// outermost wall.
pub fn trace_single(island: &Polygon, spec: &WallSpec, bare: impl FnOnce(&Region) -> Region) -> Walls {
    let mut walls = trace(island, &WallSpec { count: spec.count.min(1), ..*spec });
    let bare = if spec.count < 2 || walls.loops.is_empty() { Region::default() } else { bare(&walls.inside) };
    if bare.is_empty() {
        return trace(island, spec);
    }
    let least_mm = spec.spacing_mm(1) / 2.0;
    let covered =
        geometry::opening(&geometry::difference(&spec.behind(walls.inside.clone(), 0), &bare), least_mm);
    let bare =
        geometry::opening(&geometry::remainder(&walls.inside, &covered), spec.clear_mm(0).max(FINEST_MM));
    let inner = match spec.generator {
        WallGenerator::Variable => fitted(covered, spec, 1),
        WallGenerator::Classic => with_gaps(covered, spec, 1),
    };
    walls.loops.extend(inner.loops);
    walls.gaps.extend(inner.gaps);
    walls.inside = geometry::union(&bare, &inner.inside);
    walls
}

/// The walls of an island that is thick enough everywhere.
fn concentric(section: &Region, spec: &WallSpec) -> Walls {
    let mut walls = Walls::default();
    let mut outline = section.clone();
    let mut step_mm = spec.external_width_mm / 2.0;
    for depth in 0..spec.count {
        outline = geometry::offset(&outline, -step_mm);
        walls.loops.push(beading::constant(&outline));
        step_mm = spec.spacing_mm(depth) / 2.0 + spec.clear_mm(depth);
        if depth + 1 < spec.count {
            step_mm += spec.spacing_mm(depth + 1) / 2.0;
        }
    }
    if spec.count == 0 {
        step_mm = bead::rounding_mm(spec.height_mm) / 2.0;
    }
    walls.inside = geometry::offset(&outline, -step_mm);
    walls
}

/// Walls of variable width from a depth on, in what the outer ones leave.
fn fitted(mut rest: Region, spec: &WallSpec, first: u32) -> Walls {
    let mut walls = Walls::default();
    for depth in first..spec.count {
        if rest.is_empty() {
            break;
        }
        let is_innermost = depth > 0 && depth + 1 == spec.count;
        let full = if is_innermost { beading::FULL_INNERMOST } else { beading::FULL };
        let corners = if depth > 0 { beading::INNER_CORNERS } else { Join::DEFAULT };
        let pair = beading::pair(&rest, spec.spacing_mm(depth), full, spec.least_gap_mm(depth), corners);
        if spec.gap_fill {
            walls.gaps.extend(pair.gap.map(|gap| (depth, gap)));
        }
        if !pair.loops.is_empty() {
            walls.loops.push(pair.loops);
        }
        rest = spec.behind(pair.rest, depth);
    }
    leave_inside(walls, rest, beading::PAIR, spec)
}

/// Walls of fixed widths from a depth on, in what the outer ones leave, with gaps in narrow places.
fn with_gaps(mut rest: Region, spec: &WallSpec, first: u32) -> Walls {
    let mut walls = Walls::default();
    for depth in first..spec.count {
        if rest.is_empty() {
            break;
        }
        let spacing_mm = spec.spacing_mm(depth);
        let closest_mm = spacing_mm * CLOSEST / 2.0;
        let thick_mm = spacing_mm / 2.0 + closest_mm;
        let thick = geometry::core(&rest, thick_mm);
        if spec.gap_fill {
            let gap = beading::gap(&rest, &thick, thick_mm, spec.least_gap_mm(depth));
            walls.gaps.extend(gap.map(|gap| (depth, gap)));
        }
        let centre = geometry::offset(&thick.region, closest_mm);
        walls.loops.push(beading::constant(&centre));
        rest = geometry::offset(&centre, -spacing_mm / 2.0 - spec.clear_mm(depth));
    }
    walls.loops.retain(|rings| !rings.is_empty());
    leave_inside(walls, rest, (1.0 + CLOSEST) / 2.0, spec)
}

/// The area inside the walls is the fill area; parts narrower than twice the radius, in spacings, become gaps.
fn leave_inside(mut walls: Walls, mut rest: Region, radius: f64, spec: &WallSpec) -> Walls {
    if spec.gap_fill && !rest.is_empty() {
        let spacing_mm = spec.spacing_mm(spec.count);
        let radius_mm = radius * spacing_mm;
        let core = beading::core(&rest, radius_mm, spacing_mm, Join::DEFAULT);
        if let Some(gap) = beading::gap(&rest, &core, radius_mm, spec.least_gap_mm(spec.count)) {
            walls.gaps.push((spec.count, gap));
            rest = geometry::intersection(&core.grown(radius_mm), &rest);
        }
    }
    walls.inside = rest;
    walls
}
