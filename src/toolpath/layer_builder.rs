//! Builds the paths of a layer: beads of walls, gaps, solid infill and bridges.

use std::ops::RangeInclusive;

use super::options::{InfillSettings, WallSettings};
use geometry::{KnownAxes, Polygon, Region, Ring};

use super::bead::{self, Line};
use super::beading::{self, Gap};
use super::beneath::Beneath;
use super::bridges::Bridge;
use super::infill::{self, SolidSpec};
use super::laid::{self, Parts};
use super::{IslandId, Path, Phase, Role, ToolId, Width};

/// Infill lines shorter than this hold nothing.
const SHORTEST_LINE_MM: f64 = 0.2;

/// Gaps shorter than this are not worth the travel to them.
const SHORTEST_GAP_MM: f64 = 0.1;

/// Nor are those inside of walls that are smaller than this, a sixth of a square of a common line.
const CRUMB_MM2: f64 = 0.035;

/// A bead holds no more of what it does not reach, as a share of its own.
const WIDER: f64 = 1.4;

/// How far the lines of skins reach where they turn sharply at a wall, as a multiple of how far free ends do: nearly no
/// void is left in the surface, as their turns hold what is open beside them, and the wedges are a little fuller than full.
const SKIN_TURN_REACH: f64 = 0.85;

/// The same inside of prints that are solid throughout, where what is too much in a layer adds up: void and double
/// cover together are least.
const CORE_TURN_REACH: f64 = 0.8;

/// How a solid zone is filled.
pub(super) struct Solid {
    pub role: Role,
    pub phase: Phase,
    pub width_mm: f64,
    /// Whether each line waits for the one beside it.
    pub ordered: bool,
    /// Whether lines may run in another direction than usual.
    pub fit_angle: bool,
}

/// How bridge lines are drawn: their distance, each one's width and height, and how far they reach over their anchors.
#[derive(Clone, Copy, Debug)]
pub(super) struct BridgeLine {
    pub spacing_mm: f64,
    pub width_mm: f64,
    pub height_mm: f64,
    pub anchor_mm: f64,
}

/// The paths of a layer as they grow.
pub(super) struct LayerBuilder<'a> {
    pub paths: Vec<Path>,
    pub height_mm: f64,
    pub island: Option<IslandId>,
    /// The tool of what follows, where a part has one of its own.
    pub tool: Option<ToolId>,
    /// Middle lines of narrow places that were found before.
    axes: &'a KnownAxes,
}

impl<'a> LayerBuilder<'a> {
    /// Without paths.
    pub fn new(height_mm: f64, axes: &'a KnownAxes) -> Self {
        Self { paths: Vec::new(), height_mm, island: None, tool: None, axes }
    }

    fn push(&mut self, role: Role, phase: Phase, closed: bool, points: Vec<geometry::Point>, width: Width) {
        let (height_mm, island) = (self.height_mm, self.island);
        self.paths.push(Path { role, closed, points, width, height_mm, island, phase, tool: self.tool });
    }

    pub fn loops(&mut self, role: Role, phase: Phase, width_mm: f64, rings: &[Ring]) {
        for ring in rings.iter().filter(|r| r.len() >= 3) {
            self.push(role, phase, true, ring.clone(), Width::Constant(width_mm));
        }
    }

    pub fn lines(&mut self, role: Role, phase: Phase, width_mm: f64, lines: impl IntoIterator<Item = Line>) {
        let rounding_mm = bead::rounding_mm(self.height_mm) as f32;
        for line in lines {
            if line.closed || geometry::polyline_length_mm(&line.points) >= SHORTEST_LINE_MM {
                let width = if line.spacing_mm.is_empty() {
                    Width::Constant(width_mm)
                } else {
                    Width::PerVertex(
                        line.spacing_mm.iter().map(|spacing_mm| spacing_mm + rounding_mm).collect(),
                    )
                };
                self.push(role, phase, line.closed, line.points, width);
            }
        }
    }

    pub fn solid(&mut self, zone: &Region, solid: &Solid, layer: usize, settings: &InfillSettings) {
        if zone.is_empty() {
            return;
        }
        let Solid { role, phase, width_mm, ordered, fit_angle } = *solid;
        let spacing_mm = bead::spacing_mm(width_mm, self.height_mm);
        let (zone, narrow) = infill::split_narrow(zone, spacing_mm);
        if !narrow.is_empty() {
            let (loops, gaps) = beading::fill(&narrow, spacing_mm);
            self.lines(role, phase, width_mm, loops);
            for gap in &gaps {
                self.gap(role, phase, gap, beading::MIN_GAP_MM..=beading::WIDEST * spacing_mm, 0.0);
            }
        }
        // Free ends alone fill the zone when they reach its edge.
        let reach_mm = if ordered { spacing_mm / 2.0 } else { settings.overlap.0 * width_mm };
        let angle_rad = settings.angle.to_radians();
        let turn_reach =
            if settings.density.0 > infill::SOLID_DENSITY { CORE_TURN_REACH } else { SKIN_TURN_REACH };
        let spec = SolidSpec {
            spacing_mm,
            reach_mm,
            turn_reach,
            angle_rad,
            layer,
            fit_angle,
            joined: !ordered,
            capped: true,
            fit_mm: None,
        };
        let mut next = 1;
        let mut patches = infill::fill_solid(&zone, &spec);
        if ordered {
            patches = infill::monotone(patches);
        }
        for patch in patches {
            let width_mm = bead::width_mm(patch.spacing_mm, self.height_mm);
            // Ordered lines have phases of their own, the order across the lines, one patch after the other: no
            // ordering may change it.
            let first = next;
            for (index, line) in patch.lines {
                let own = first + index;
                next = next.max(own + 1);
                self.lines(role, if ordered { Phase::Top(own) } else { phase }, width_mm, [line]);
            }
        }
    }

    /// Bridge lines side by side; solid infill where they lie on the layer beneath.
    pub fn bridge(
        &mut self,
        bridge: &Bridge,
        line: &BridgeLine,
        beneath: &Beneath<'_>,
        settings: &InfillSettings,
    ) {
        let reach_mm = settings.overlap.0 * line.spacing_mm;
        let spec = SolidSpec {
            spacing_mm: line.spacing_mm,
            reach_mm,
            turn_reach: CORE_TURN_REACH,
            angle_rad: bridge.angle_rad,
            layer: 0,
            fit_angle: false,
            joined: true,
            capped: false,
            fit_mm: bridge.strip_mm,
        };
        for patch in infill::fill_solid(&bridge.area, &spec) {
            let lines = patch.lines.into_iter().map(|(_, line)| line).collect();
            let Parts { hanging, laid } = laid::split(lines, line.spacing_mm, line.anchor_mm, beneath);
            let layer_mm = std::mem::replace(&mut self.height_mm, line.height_mm);
            self.lines(Role::BridgeInfill, Phase::Inside, line.width_mm, hanging);
            self.height_mm = layer_mm;
            self.laid(Role::SolidInfill, line.spacing_mm, laid);
        }
    }

    /// What lies on the layer beneath beside bridge lines, as close to each other as these are.
    fn laid(&mut self, role: Role, spacing_mm: f64, lines: Vec<Line>) {
        self.lines(role, Phase::Inside, bead::width_mm(spacing_mm, self.height_mm), lines);
    }

    /// Perimeters over air, as thick as bridge lines; plain ones where they lie on the layer beneath.
    pub fn extra_perimeters(&mut self, lines: Vec<Line>, line: &BridgeLine, beneath: &Beneath<'_>) {
        let BridgeLine { spacing_mm, width_mm, height_mm, anchor_mm } = *line;
        let Parts { hanging: mut lines, laid } = laid::split(lines, spacing_mm, anchor_mm, beneath);
        self.laid(Role::Perimeter, spacing_mm, laid);
        let layer_mm = std::mem::replace(&mut self.height_mm, height_mm);
        // What is narrower than usual is so by as much as its spacing is.
        let less_mm = (bead::width_mm(spacing_mm, height_mm) - width_mm) as f32;
        for spacing_mm in lines.iter_mut().flat_map(|line| &mut line.spacing_mm) {
            *spacing_mm = (*spacing_mm - less_mm).max(0.0);
        }
        self.lines(Role::Perimeter, Phase::Inside, width_mm, lines);
        self.height_mm = layer_mm;
    }

    /// An island of which the lines from `first` on fill only so much: a dot instead, if that is more.
    pub fn dot(
        &mut self,
        phase: Phase,
        first: usize,
        filled_mm2: f64,
        island: &Polygon,
        settings: &WallSettings,
    ) {
        let Some((ring, spacing_mm)) = beading::dot(island, settings.min_feature.0) else { return };
        if geometry::ring_length_mm(&ring) * spacing_mm <= filled_mm2 {
            return;
        }
        let width_mm = bead::width_mm(spacing_mm, self.height_mm).max(settings.min_width.0);
        self.paths.truncate(first);
        self.loops(Role::ExternalPerimeter, phase, width_mm, &[ring]);
    }

    /// One bead of fitting width, but at least `least_mm`, along the middle of each part whose width is in a range. The
    /// area that they fill.
    pub fn gap(
        &mut self,
        role: Role,
        phase: Phase,
        gap: &Gap,
        range: RangeInclusive<f64>,
        least_mm: f64,
    ) -> f64 {
        let mut filled_mm2 = 0.0;
        let tip = if role == Role::ExternalPerimeter { 0.5 } else { beading::GAP_TIP };
        let Gap { area, region } = gap;
        for path in geometry::medial_axis_in(area, region, *range.start(), *range.end(), tip, self.axes) {
            let area_mm2 = path.area_mm2();
            let is_crumb = role == Role::GapFill && area_mm2 < CRUMB_MM2;
            if is_crumb || path.length_mm() < SHORTEST_GAP_MM {
                continue;
            }
            filled_mm2 += area_mm2;
            let rounding_mm = bead::rounding_mm(self.height_mm) as f32;
            let widths =
                path.width_mm.iter().map(|width_mm| (width_mm + rounding_mm).max(least_mm as f32)).collect();
            self.push(role, phase, path.closed, path.points, Width::PerVertex(widths));
        }
        filled_mm2
    }

    /// The same with beads as wide as it takes to hold what they do not reach of so large an area, within reason.
    pub fn whole_gap(
        &mut self,
        role: Role,
        phase: Phase,
        gap: &Gap,
        range: RangeInclusive<f64>,
        area_mm2: f64,
    ) {
        let first = self.paths.len();
        let filled_mm2 = self.gap(role, phase, gap, range, 0.0);
        let wider = (area_mm2 / filled_mm2).clamp(1.0, WIDER);
        let rounding_mm = bead::rounding_mm(self.height_mm);
        for path in &mut self.paths[first..] {
            if let Width::PerVertex(widths) = &mut path.width {
                widths.iter_mut().for_each(|width| {
                    *width = (wider * (f64::from(*width) - rounding_mm) + rounding_mm) as f32;
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::Point;

    #[test]
    fn a_bead_in_a_place_holds_what_its_corners_leave() {
        let corners = [[0.0, 0.0], [0.6, -0.2], [0.6, 0.2]];
        let outer = corners.iter().map(|&[x, y]| Point::from_mm(x, y)).collect();
        let region = Region::from(Polygon { outer, holes: Vec::new() });
        let gap = Gap { area: region.clone(), region };
        // With what is open beside its corners.
        let (axes, open_mm2) = (KnownAxes::default(), 0.15);
        let held_mm2 = |whole: bool| {
            let mut layer = LayerBuilder::new(0.2, &axes);
            match whole {
                true => layer.whole_gap(Role::GapFill, Phase::Inside, &gap, 0.12..=0.8, open_mm2),
                false => drop(layer.gap(Role::GapFill, Phase::Inside, &gap, 0.12..=0.8, 0.0)),
            }
            let [path] = layer.paths.as_slice() else { panic!("{:?}", layer.paths) };
            let Width::PerVertex(widths) = &path.width else { panic!("its widths differ") };
            let ends = path.points.windows(2).zip(widths.windows(2));
            let spacing_mm = |ends: &[f32]| f64::from(ends[0] + ends[1]) / 2.0 - bead::rounding_mm(0.2);
            ends.map(|(at, width)| at[0].distance_mm(at[1]) * spacing_mm(width)).sum::<f64>()
        };
        assert!(held_mm2(false) < 0.12, "{}", held_mm2(false));
        assert!((held_mm2(true) - open_mm2).abs() < 0.01, "{}", held_mm2(true));
    }
}
