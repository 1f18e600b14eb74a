//! Puts a layer's paths together: walls, gaps, shells and infill of every island, skirt and brim around.

use std::sync::Arc;

use super::options::{
    BridgeSettings, BrimSettings, FirstLayerSettings, FuzzySettings, FuzzyWalls, InfillSettings,
    IroningSettings, ShellSettings, SkirtSettings, ToolOfSettings, WallSettings,
};
use crate::units::Mm;
use geometry::{Polygon, Region, Ring};

use super::bead::Line;
use super::beading;
use super::beneath::Beneath;
use super::borders::Borders;
use super::bridges::Bridge;
use super::combined::CombinedInfill;
use super::hollow::Hollow;
use super::infill::{self, FillPattern, FillSpec, Joins, LineSet, SparseSample};
use super::island_walls::{LayerWalls, WallLayer, WallPlanner};
use super::known_walls::{IslandWalls, KnownWalls};
use super::layer_builder::{BridgeLine, LayerBuilder, Solid};
use super::leftovers;
use super::reach::Reach;
use super::shell_windows::{ShellWindows, Window};
use super::shells::{self, Zones};
use super::walls::WallSpec;
use super::{
    Island, IslandId, LayerKind, LayerPaths, Path, Phase, Role, ToolId, adhesion, bead, beside_sparse,
    bridges, entries, held_ends, overhang_perimeters, tools,
};

/// Ends of sparse infill lines are joined along the wall up to this many line distances: the distance to the next
/// line is √2 distances at 45°, and beyond this a travel is quicker than the extrusion.
const LONGEST_JOIN: f64 = 2.5;

/// Ends of sparse infill lines are round; so many line spacings further into the wall, they meet it in their full width, and
/// rest on the one beneath where that leans.
const EMBEDDED: f64 = 0.35;

/// What outermost walls leave is not filled further outside than this, in their widths.
const INSIDE: f64 = 0.6;

/// Smaller places between beads are not worth the travel to them.
const SMALLEST_MM2: f64 = 0.05;

/// Nor are these in the parts of tools, which have more of them.
const SMALLEST_OF_PART_MM2: f64 = 0.02;

/// The settings that toolpaths depend on.
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(missing_docs)]
pub struct ToolpathSettings {
    pub walls: WallSettings,
    pub shell: ShellSettings,
    pub infill: InfillSettings,
    pub ironing: IroningSettings,
    pub bridge: BridgeSettings,
    pub fuzzy: FuzzySettings,
    /// The nozzle's diameter: as thick as bridges are by nature.
    pub nozzle: Mm,
    pub first_layer: FirstLayerSettings,
    pub skirt: SkirtSettings,
    pub brim: BrimSettings,
    /// Loops may be entered anywhere, so that they get vertices to be entered at.
    pub free_seams: bool,
    /// Which tool prints what, where there are several.
    pub tool_of: Option<ToolOfSettings>,
}

/// One object at one layer: its section and the data of its neighbouring layers.
#[derive(Clone, Copy, Debug)]
pub struct ObjectLayer<'a> {
    /// Which object on the plate.
    pub object: u32,
    /// Its section.
    pub section: &'a Region,
    /// The tool of this part of it, where its parts have different ones; the other sections are the whole object's.
    pub tool: Option<ToolId>,
    /// Which settings it has, as the caller numbers them; `None`: those of the plate.
    pub style: Option<usize>,
    /// Where its section is filled, and whether it gets walls here: where only the inside of an object has other settings, its
    /// parts share their section and the walls around it. `None`: it has both, everywhere.
    pub share: Option<Share<'a>>,
    /// Whether it is the first part of its object.
    pub is_first: bool,
    /// Its section one layer up; empty on its last layer.
    pub above: &'a Region,
    /// Its section one layer down; `None`: the bed.
    pub beneath: Option<&'a Region>,
    /// What decides where its shells are.
    pub windows: ShellWindows<'a>,
    /// The same of the layer beneath: its sparse infill is in both windows.
    pub windows_beneath: ShellWindows<'a>,
}

/// A part of an object that shares its walls with others.
#[derive(Clone, Copy, Debug)]
pub struct Share<'a> {
    /// What is filled, as far as it lies inside the walls.
    pub filled: &'a Region,
    /// Whether the walls are printed with this part.
    pub has_walls: bool,
}

impl ObjectLayer<'_> {
    fn has_walls(&self) -> bool {
        self.share.is_none_or(|share| share.has_walls)
    }

    /// The part of what lies inside the walls that is filled.
    fn filled(&self, inside: Region) -> Region {
        match self.share {
            Some(share) => geometry::intersection(&inside, share.filled),
            None => inside,
        }
    }
}

/// One layer of the plate.
#[derive(Clone, Debug)]
pub struct PlateLayer<'a> {
    /// Index from the bed.
    pub index: usize,
    /// Top over the bed in millimetres.
    pub top_mm: f64,
    /// Height in millimetres.
    pub height_mm: f64,
    /// The objects that are there.
    pub objects: Vec<ObjectLayer<'a>>,
}

/// Makes the paths of layers, each on its own.
#[derive(Clone, Debug)]
pub struct Planner {
    settings: ToolpathSettings,
    pattern: Arc<dyn FillPattern>,
    /// Calibrated distance of sparse lines.
    line_distance_mm: Option<f64>,
    /// Layers that are combined, bottom up.
    combined: CombinedInfill,
    brim: Vec<Line>,
    skirt: Vec<Ring>,
    /// What part and brim cover on the bed.
    covered: Region,
    known_walls: KnownWalls,
}

/// The properties shared by the islands of an object at one layer.
struct Part<'a> {
    object: &'a ObjectLayer<'a>,
    support_below: Option<Beneath<'a>>,
    hollow: Option<Hollow<'a>>,
}

/// The height of a layer of sparse infill, and the rotation of its pattern.
#[derive(Clone, Copy)]
struct Slab {
    /// Height of its beads in millimetres.
    height_mm: f64,
    /// Number of rotations of the pattern so far.
    rotation: usize,
}

/// Bead widths of one layer.
struct Widths {
    solid_mm: f64,
    top_mm: f64,
    infill_mm: f64,
    skirt_mm: f64,
}

impl Planner {
    /// A planner for a plate whose objects' first sections are `footprint`; `first_height_mm` is the first layer's.
    pub fn new(settings: ToolpathSettings, footprint: &Region, first_height_mm: f64) -> Self {
        let (line_distance_mm, covered) = (None, footprint.clone());
        let pattern = infill::pattern(settings.infill.pattern);
        let (combined, brim, skirt) = (CombinedInfill::default(), Vec::new(), Vec::new());
        let known_walls = KnownWalls::default();
        let mut planner =
            Self { settings, pattern, line_distance_mm, combined, brim, skirt, covered, known_walls };
        let width_mm = planner.widths(0).skirt_mm;
        planner.brim = adhesion::brim(footprint, &planner.settings.brim, width_mm, first_height_mm);
        if !planner.brim.is_empty() {
            let reach_mm = planner.settings.brim.gap.0 + planner.settings.brim.width.0;
            planner.covered = geometry::offset(footprint, reach_mm);
        }
        planner.enclose([], first_height_mm);
        planner
    }

    /// Fills with a pattern that was planned for the whole print, instead of one that knows of a layer only.
    pub fn use_pattern(&mut self, pattern: Arc<dyn FillPattern>) {
        self.pattern = pattern;
    }

    /// Takes the skirt around part, brim and more.
    pub fn enclose<'a>(&mut self, more: impl IntoIterator<Item = &'a Polygon>, first_height_mm: f64) {
        let width_mm = self.widths(0).skirt_mm;
        let mut all = self.covered.clone();
        all.add_disjoint(more.into_iter().cloned());
        self.skirt = adhesion::skirt(&all, &self.settings.skirt, width_mm, first_height_mm);
    }

    /// The outer edge of the skirt, its loops as wide as they are apart.
    pub fn skirt_outline(&self, first_height_mm: f64) -> Option<Polygon> {
        let width_mm = self.widths(0).skirt_mm;
        let away_mm = bead::spacing_mm(width_mm, first_height_mm) - width_mm / 2.0;
        let outer = Polygon { outer: self.skirt.first()?.clone(), holes: Vec::new() };
        geometry::offset(&Region::from(outer), away_mm).into_polygons().into_iter().next()
    }

    /// What part and brim cover on the bed.
    pub fn covered(&self) -> &Region {
        &self.covered
    }

    /// What calibration needs of a layer; see [`Planner::calibrate`].
    pub fn sparse_sample(&self, layer: &PlateLayer<'_>) -> SparseSample {
        let slab = Slab { height_mm: layer.height_mm, rotation: layer.index };
        let fill_spec = self.fill_spec(layer, slab);
        let mut sample = SparseSample { area: Region::default(), area_mm2: 0.0, spec: fill_spec };
        for object in &layer.objects {
            let hollow = self.hollow(object, layer);
            for island in object.section.polygons() {
                let zones = self.zones(&self.inside(island, object, layer), object, layer, hollow.as_ref());
                let fill_area = geometry::offset(&zones.sparse, -fill_spec.spacing_mm / 2.0);
                sample.area.add_disjoint(fill_area.into_polygons());
                sample.area_mm2 += zones.sparse_mm2;
            }
        }
        sample
    }

    /// Whether the distance of sparse lines follows from samples.
    pub fn calibrates(&self) -> bool {
        let density = self.settings.infill.density.0;
        density > 0.0 && density <= infill::SOLID_DENSITY && self.pattern.is_uniform()
    }

    /// Sets the distance of sparse lines so that the sample layers have the requested density; the beads' width makes
    /// up the remainder on each island. The first layer is no sample: its lines may be wider.
    pub fn calibrate(&mut self, samples: &[SparseSample], height_mm: f64) {
        if !self.calibrates() {
            return;
        }
        let settings = &self.settings.infill;
        let spacing_mm = self.infill_spacing_mm(1, height_mm);
        let join = if settings.connect { LONGEST_JOIN } else { 0.0 };
        let pattern = &*self.pattern;
        self.line_distance_mm =
            Some(infill::calibrate(pattern, samples, spacing_mm, settings.density.0, join));
    }

    /// Whether sparse infill of several layers is combined.
    pub fn combines(&self) -> bool {
        self.settings.infill.combine_layers > 1
    }

    /// What sparse infill fills in a layer.
    pub fn sparse_area(&self, layer: &PlateLayer<'_>) -> Region {
        let mut area = Region::default();
        for object in &layer.objects {
            let hollow = self.hollow(object, layer);
            for island in object.section.polygons() {
                let zones = self.zones(&self.inside(island, object, layer), object, layer, hollow.as_ref());
                area.add_disjoint(zones.sparse.into_polygons());
            }
        }
        area
    }

    /// Combines the sparse infill of layers, `infill.combine_layers` at a time and as many as the nozzle's diameter allows.
    /// `areas` are the heights and [`sparse_area`](Self::sparse_area)s of all layers; the first is left alone.
    pub fn combine(&mut self, areas: &[(f64, Region)]) {
        self.combined =
            CombinedInfill::new(areas, self.settings.infill.combine_layers as usize, self.settings.nozzle.0);
    }

    /// The paths of one layer.
    pub fn layer(&self, section: &PlateLayer<'_>) -> LayerPaths {
        self.filled(section, self.walls(section))
    }

    /// Whether the walls that another makes of the same outlines are those of this one.
    pub fn has_walls_of(&self, other: &Self) -> bool {
        self.wall_planner() == other.wall_planner()
    }

    /// The walls of one layer.
    pub fn walls(&self, section: &PlateLayer<'_>) -> LayerWalls {
        let mut islands = Vec::new();
        for object in &section.objects {
            let layer = wall_layer(object, section);
            let mut walls = self.wall_planner().object(&layer, islands.len(), &self.known_walls);
            if !object.has_walls() {
                walls.iter_mut().for_each(|walls| walls.paths.clear());
            }
            let others = object.tool.map(|tool| beside(object, tool, section)).unwrap_or_default();
            if !others.is_empty() {
                let borders = Borders::new(&others, section.height_mm);
                for (polygon, walls) in object.section.polygons().iter().zip(&mut walls) {
                    let shared = geometry::intersection(&others, &Region::from(polygon.clone()));
                    walls.meets_others = !shared.is_empty();
                    borders.fit(&mut walls.paths);
                }
            }
            islands.extend(walls);
        }
        LayerWalls { islands }
    }

    /// The paths of one layer whose [`walls`](Self::walls) are known.
    pub fn filled(&self, section: &PlateLayer<'_>, walls: LayerWalls) -> LayerPaths {
        let mut layer = LayerBuilder::new(section.height_mm, &self.known_walls.axes);
        let widths = self.widths(section.index);
        if section.index < self.settings.skirt.layers as usize {
            layer.loops(Role::Skirt, Phase::Skirt, widths.skirt_mm, &self.skirt);
        } else if let Some(innermost) = self.skirt.last().filter(|_| self.settings.skirt.draft_shield) {
            layer.loops(Role::Skirt, Phase::Skirt, widths.skirt_mm, std::slice::from_ref(innermost));
        }
        if section.index == 0 {
            layer.lines(Role::Brim, Phase::Brim, widths.skirt_mm, self.brim.clone());
        }
        let mut islands = Vec::new();
        let mut outline = Region::default();
        let mut walls = walls.islands.into_iter();
        // Rough walls lie otherwise on each layer.
        let is_even = self.settings.fuzzy.walls == FuzzyWalls::None;
        for object in &section.objects {
            let support_below = object.beneath.map(Beneath::new);
            let part = Part { object, support_below, hollow: self.hollow(object, section) };
            layer.tool = object.tool;
            for (polygon, walls) in object.section.polygons().iter().zip(walls.by_ref()) {
                layer.island = Some(IslandId(islands.len() as u32));
                let support_below = part.support_below.as_ref().filter(|_| is_even);
                let repeats = support_below.is_some_and(|support_below| support_below.has(polygon));
                let meets_others = walls.meets_others;
                islands.push(Island { object: object.object, repeats, meets_others });
                self.island(&mut layer, polygon, walls, &part, section);
            }
            if object.has_walls() {
                outline.add_disjoint(object.section.polygons().iter().cloned());
            }
        }
        if self.settings.free_seams {
            entries::add(&mut layer.paths);
        }
        let mut made = LayerPaths {
            index: section.index,
            top_mm: section.top_mm,
            height_mm: section.height_mm,
            islands,
            paths: layer.paths,
            outline,
            beneath: rests_on(section, &self.settings.fuzzy),
            kind: LayerKind::Flat,
            entries: Default::default(),
            tools: Vec::new(),
            rams: Vec::new(),
            turn: Default::default(),
        };
        self.assign_tools(&mut made);
        made
    }

    /// Says of each path which tool prints it, where there are several.
    fn assign_tools(&self, layer: &mut LayerPaths) {
        let Some(tool_of) = &self.settings.tool_of else { return };
        // The profile has checked the heights.
        let heights = tools::tool_heights(&tool_of.heights).unwrap_or_default();
        tools::assign(layer, tool_of, &heights);
    }

    /// What is filled of an island.
    fn inside(&self, island: &Polygon, object: &ObjectLayer<'_>, section: &PlateLayer<'_>) -> Region {
        let layer = wall_layer(object, section);
        object.filled(self.wall_planner().inside(island, &layer, &self.known_walls))
    }

    fn island(
        &self,
        layer: &mut LayerBuilder<'_>,
        polygon: &Polygon,
        walls: IslandWalls,
        part: &Part<'_>,
        section: &PlateLayer<'_>,
    ) {
        let Part { object, support_below, hollow } = part;
        let widths = &self.widths(section.index);
        let IslandWalls { paths, inside, .. } = walls;
        let inside = object.filled(inside);
        let first = layer.paths.len();
        let tool = layer.tool;
        layer.paths.extend(paths.into_iter().map(|path| Path { tool, ..path }));
        let walls = layer.paths.len();

        let settings = &self.settings.infill;
        let mut zones = self.zones(&inside, object, section, hollow.as_ref());
        let fills_gaps = self.settings.walls.gap_fill;
        let mut bridged = Region::default();
        if let Some(support_below) = support_below.as_ref().filter(|_| self.settings.bridge.enabled) {
            let line = self.bridge_line(widths.solid_mm, section.height_mm);
            let first = layer.paths.len();
            for bridge in
                bridges::take(&mut zones, &inside, polygon, support_below, line.spacing_mm, line.anchor_mm)
            {
                if fills_gaps && tool.is_none() {
                    let laid = geometry::intersection(&bridge.area, support_below.region);
                    bridged.add_disjoint(laid.into_polygons());
                }
                match self.extra_perimeters(&bridge, &inside, support_below, &line) {
                    Some(lines) => layer.extra_perimeters(lines, &line, support_below),
                    None => layer.bridge(&bridge, &line, support_below, settings),
                }
            }
            support_below.reach_aside(&mut layer.paths[first..], polygon);
        }
        if settings.solid_area > 0.0 && settings.density.0 > 0.0 {
            zones.fill_small(settings.solid_area);
        }
        let bridges = layer.paths.split_off(walls);
        let sparse_mm = bead::spacing_mm(widths.infill_mm, section.height_mm);
        beside_sparse::leave_out(&mut layer.paths, first, &zones, sparse_mm);
        let within_walls = layer.paths.len();
        layer.paths.extend(bridges);
        // The layer on the bed is seen, and prints that are solid throughout are strong where their layers cross.
        let inner = section.index > 0 && settings.density.0 <= infill::SOLID_DENSITY;
        let solid = Solid {
            role: Role::SolidInfill,
            phase: Phase::Inside,
            width_mm: widths.solid_mm,
            ordered: false,
            fit_angle: self.settings.shell.fit_angle && inner,
        };
        let first_infill = layer.paths.len();
        layer.solid(&zones.solid, &solid, section.index, settings);
        if settings.density.0 > 0.0 {
            self.sparse(layer, &zones.sparse, zones.sparse_mm2, section);
        }
        if let Some(hollow) = hollow {
            held_ends::extend(&mut layer.paths, first_infill, hollow, &inside, &zones.sparse);
        }
        let ordered = self.settings.shell.monotonic;
        let solid = Solid {
            role: Role::TopSolidInfill,
            phase: Phase::Top(0),
            width_mm: widths.top_mm,
            ordered,
            fit_angle: false,
        };
        layer.solid(&zones.top, &solid, section.index, settings);
        if fills_gaps && tool.is_some() {
            let outermost_mm = INSIDE * self.wall_spec(section).external_width_mm;
            let part = geometry::offset(&Region::from(polygon.clone()), -outermost_mm);
            let solid = geometry::difference(&part, &zones.sparse);
            self.leftovers(layer, first, &[&solid], &zones.sparse, section);
        } else if fills_gaps {
            self.leftovers(layer, within_walls, &[&bridged], &zones.sparse, section);
        }
        if self.settings.ironing.enabled {
            self.iron(layer, &zones.top, section, widths);
        }
    }

    /// Fills what the paths from `first` on leave between them in areas that are to be solid.
    fn leftovers(
        &self,
        layer: &mut LayerBuilder<'_>,
        first: usize,
        areas: &[&Region],
        sparse: &Region,
        section: &PlateLayer<'_>,
    ) {
        let spec = self.wall_spec(section);
        let beside_mm = bead::spacing_mm(spec.width_mm, section.height_mm);
        let smallest_mm2 = if layer.tool.is_some() { SMALLEST_OF_PART_MM2 } else { SMALLEST_MM2 };
        let room = leftovers::Room { areas, sparse, beside_mm, smallest_mm2 };
        let solid = |path: &&Path| path.role != Role::InternalInfill;
        for place in leftovers::find(&room, layer.paths[first..].iter().filter(solid)) {
            let widths_mm = beading::MIN_GAP_MM..=spec.widest_gap_mm();
            layer.whole_gap(Role::GapFill, Phase::Inside, &place.gap, widths_mm, place.open_mm2);
        }
    }

    /// Perimeters in place of a bridge, if they are held better.
    fn extra_perimeters(
        &self,
        bridge: &Bridge,
        inside: &Region,
        beneath: &Beneath<'_>,
        line: &BridgeLine,
    ) -> Option<Vec<Line>> {
        if bridge.is_held() || !self.settings.walls.extra_on_overhangs {
            return None;
        }
        let lines = overhang_perimeters::fill(inside, &bridge.area, line.spacing_mm, &self.known_walls.axes);
        (overhang_perimeters::loose(&lines, beneath) < bridge.cost).then_some(lines)
    }

    /// How bridge lines are drawn on a layer with solid infill of this width.
    fn bridge_line(&self, solid_mm: f64, height_mm: f64) -> BridgeLine {
        let BridgeSettings { thick, flow, anchor, .. } = self.settings.bridge;
        let anchor_mm = anchor.0;
        if thick {
            let round_mm = self.settings.nozzle.0 * flow.sqrt();
            return BridgeLine { spacing_mm: round_mm, width_mm: round_mm, height_mm: round_mm, anchor_mm };
        }
        let spacing_mm = bead::spacing_mm(solid_mm, height_mm);
        BridgeLine {
            spacing_mm,
            width_mm: bead::width_mm(spacing_mm * flow, height_mm),
            height_mm,
            anchor_mm,
        }
    }

    /// Sparse infill: of the layer, and of those beneath that it is combined with.
    fn sparse(&self, layer: &mut LayerBuilder<'_>, zone: &Region, area_mm2: f64, section: &PlateLayer<'_>) {
        let own = Slab { height_mm: section.height_mm, rotation: section.index };
        let Some((group, number)) = self.combined.of(section.index) else {
            return self.fill(layer, zone, area_mm2, section, own);
        };
        let shared = geometry::intersection(zone, &group.area);
        let rest = geometry::opening(&geometry::remainder(zone, &shared), own.height_mm / 2.0);
        self.fill(layer, &rest, rest.area_mm2(), section, own);
        if section.index == group.last {
            let slab = Slab { height_mm: group.height_mm, rotation: number };
            self.fill(layer, &shared, shared.area_mm2(), section, slab);
        }
    }

    /// Lays the pattern into a zone, with beads as high as the slab. Their density is exact for `area_mm2`.
    fn fill(
        &self,
        layer: &mut LayerBuilder<'_>,
        zone: &Region,
        area_mm2: f64,
        section: &PlateLayer<'_>,
        slab: Slab,
    ) {
        if zone.is_empty() {
            return;
        }
        let (pattern, density) = (&*self.pattern, self.settings.infill.density.0);
        let spec = self.fill_spec(section, slab);
        let fill_area = geometry::offset(zone, -spec.spacing_mm / 2.0);
        let (lines, flow) = if pattern.is_uniform() {
            let solid_mm = area_mm2 / spec.spacing_mm;
            let lines = infill::lay(pattern, &fill_area, &spec, solid_mm, density);
            let flow = infill::flow(&lines, solid_mm, density);
            (lines, flow)
        } else {
            (pattern.fill(&fill_area, &spec), 1.0)
        };
        let layer_mm = std::mem::replace(&mut layer.height_mm, slab.height_mm);
        let width_mm = bead::width_mm(spec.spacing_mm * flow, slab.height_mm);
        layer.lines(Role::InternalInfill, Phase::Inside, width_mm, lines);
        layer.height_mm = layer_mm;
    }

    /// A thin pass over top surfaces, as far as the nozzle's middle may go without pressing material over their edge.
    fn iron(&self, layer: &mut LayerBuilder<'_>, top: &Region, section: &PlateLayer<'_>, widths: &Widths) {
        let settings = &self.settings.ironing;
        let zone = geometry::offset(top, -bead::spacing_mm(widths.top_mm, section.height_mm) / 2.0);
        let angle_rad = self.settings.infill.angle.to_radians();
        let lines = infill::iron(&zone, settings.spacing.0, angle_rad, section.index);
        let width_mm = bead::width_mm(settings.flow.0 * settings.spacing.0, section.height_mm);
        layer.lines(Role::Ironing, Phase::Ironing, width_mm, lines);
    }

    /// The sparse infill that an object lies on, if there may be any.
    fn hollow<'a>(&self, object: &ObjectLayer<'a>, section: &PlateLayer<'_>) -> Option<Hollow<'a>> {
        let beneath = object.beneath?;
        let is_solid = self.is_full(section.index) || self.is_full(section.index - 1);
        let walls_mm = self.wall_spec(section).depth_mm();
        (!is_solid)
            .then(|| Hollow::new(beneath, object.windows_beneath, walls_mm, self.lines_beneath(section)))
    }

    /// Divides an island's inside, over what is `hollow`; at full density nothing is sparse.
    fn zones(
        &self,
        inside: &Region,
        object: &ObjectLayer<'_>,
        section: &PlateLayer<'_>,
        hollow: Option<&Hollow<'_>>,
    ) -> Zones {
        let spacing_mm = bead::spacing_mm(self.widths(section.index).solid_mm, section.height_mm);
        let full = self.is_full(section.index);
        let below = if full { Some(Window::Nothing) } else { object.windows.bottom };
        let reach = hollow.map(|hollow| Reach {
            hollow,
            angle_rad: infill::turned(self.settings.infill.angle.to_radians(), section.index),
            fit_angle: self.settings.shell.fit_angle,
        });
        let walls_mm = self.wall_spec(section).core_mm();
        shells::divide(inside, object.windows.top, below, object.above, spacing_mm, walls_mm, reach.as_ref())
    }

    /// Whether nothing of a layer is sparse.
    fn is_full(&self, layer: usize) -> bool {
        let every = self.settings.infill.solid_every as usize;
        self.settings.infill.density.0 > infill::SOLID_DENSITY
            || (layer + 1).checked_rem(every).is_some_and(|rest| rest == 0)
    }

    /// The lines of the sparse pattern one layer down.
    fn lines_beneath(&self, section: &PlateLayer<'_>) -> Vec<LineSet> {
        if self.settings.infill.density.0 <= 0.0 {
            return Vec::new();
        }
        let index = section.index - 1;
        let rotation = self.combined.of(index).map_or(index, |(_, number)| number);
        let spec = self.fill_spec(section, Slab { height_mm: section.height_mm, rotation });
        self.pattern.sets(&FillSpec { layer: index, z_mm: spec.z_mm - section.height_mm, ..spec })
    }

    /// Distance of neighbouring beads of sparse infill.
    fn infill_spacing_mm(&self, layer: usize, height_mm: f64) -> f64 {
        bead::spacing_mm(self.widths(layer).infill_mm.max(height_mm), height_mm)
    }

    fn fill_spec(&self, section: &PlateLayer<'_>, slab: Slab) -> FillSpec {
        let settings = &self.settings.infill;
        let spacing_mm = self.infill_spacing_mm(section.index, slab.height_mm);
        let line_distance_mm = match self.line_distance_mm {
            Some(calibrated_mm) if slab.height_mm == section.height_mm => calibrated_mm,
            Some(calibrated_mm) => {
                calibrated_mm * spacing_mm / self.infill_spacing_mm(section.index, section.height_mm)
            }
            None => spacing_mm / settings.density.0,
        };
        let angle_rad = match settings.angles.as_slice() {
            [] => settings.angle.to_radians() + self.pattern.rotation_rad(slab.rotation),
            angles => angles[slab.rotation % angles.len()].to_radians(),
        };
        FillSpec {
            line_distance_mm,
            spacing_mm,
            angle_rad,
            layer: section.index,
            z_mm: section.top_mm - slab.height_mm / 2.0,
            joins: Joins {
                longest_mm: if settings.connect { LONGEST_JOIN * line_distance_mm } else { 0.0 },
                reach_mm: settings.overlap.0 * self.widths(section.index).infill_mm + EMBEDDED * spacing_mm,
                turn_reach_mm: 0.0,
                anchor_mm: settings.anchor.0,
                hatch: None,
            },
        }
    }

    fn wall_planner(&self) -> WallPlanner<'_> {
        let ToolpathSettings { walls, fuzzy, first_layer, .. } = &self.settings;
        WallPlanner { walls, fuzzy, first_width: first_layer.width }
    }

    fn wall_spec(&self, section: &PlateLayer<'_>) -> WallSpec {
        self.wall_planner().spec(section.index, section.height_mm)
    }

    fn widths(&self, layer: usize) -> Widths {
        let (s, walls) = (&self.settings, self.wall_planner());
        Widths {
            solid_mm: walls.on(layer, s.shell.width),
            top_mm: walls.on(layer, s.shell.top_width),
            infill_mm: walls.on(layer, s.infill.width),
            skirt_mm: walls.on(layer, s.walls.width),
        }
    }
}

/// The parts of an object that have walls of other tools than one of its parts.
fn beside(part: &ObjectLayer<'_>, tool: ToolId, section: &PlateLayer<'_>) -> Region {
    let others = section.objects.iter().filter(|other| {
        other.object == part.object && other.has_walls() && other.tool.is_some_and(|own| own != tool)
    });
    geometry::union_all(others.map(|other| other.section))
}

/// What the walls of an object depend on.
fn wall_layer<'a>(object: &ObjectLayer<'a>, section: &PlateLayer<'_>) -> WallLayer<'a> {
    let ObjectLayer { object, section: own, above, beneath, .. } = *object;
    WallLayer { index: section.index, height_mm: section.height_mm, object, section: own, above, beneath }
}

/// What a layer rests on: everything one layer down. Rough walls do not hang over where they leave their line.
fn rests_on(section: &PlateLayer<'_>, fuzzy: &FuzzySettings) -> Option<Region> {
    let mut below = Region::default();
    // Parts of an object have it as a whole beneath them.
    for object in section.objects.iter().filter(|object| object.is_first) {
        below.add_disjoint(object.beneath?.polygons().iter().cloned());
    }
    if fuzzy.walls != FuzzyWalls::None {
        below = geometry::offset(&below, fuzzy.thickness.0);
    }
    Some(below)
}
