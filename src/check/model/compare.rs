//! The print and the model, layer beside layer.

use std::io::{self, Read};

use super::super::beside::ModelReport;
use super::super::fault::Kind;
use super::super::relief::Relief;
use super::super::report::Found;
use super::air::{Ground, OpenPath};
use super::levels::{Level, Levels};
use super::sections::{Sections, along};
use super::survey::{Survey, is_part};
use crate::gcode::{Action, Reader, Stroke, each_line};
use crate::toolpath::Role;
use crate::toolpath::bead;
use crate::toolpath::support::{Bitmap, Grid};
use geometry::{Bounds, EdgeGrid, Point, Region, Ring};

/// Cells in which beads are painted.
const CELL_MM: f64 = 0.1;
/// An island is missing if less than this share of its outline is printed.
const PRINTED: f64 = 0.3;
/// Specks smaller than this are not required.
const SPECK_MM2: f64 = 0.05;
/// Beads of a layer may lie this much lower than it.
const SLACK_MM: f64 = 0.02;
/// This much of a layer's beads may lie outside.
const EXTRA_MM: f64 = 2.0;

/// Reads the file beside the sections of what was printed.
pub(super) fn compare(
    sections: &Sections<'_>,
    levels: &Levels,
    survey: &Survey,
    area_mm2: f64,
    file: impl Read,
    model: &mut ModelReport,
    found: &mut Found,
) -> io::Result<()> {
    let Some(all) = survey.extents()[1] else { return Ok(()) };
    let relief = || Relief::new(all.low.map(|mm| mm - 2.0), all.high.map(|mm| mm + 2.0), CELL_MM);
    let ground = Ground { part: relief(), support: relief(), bed_mm: levels.bed_mm };
    let mut print = Print {
        sections,
        levels,
        has_roles: survey.has_roles(),
        has_edges: survey.has_edges(),
        area_mm2,
        ground,
        layer: None,
        path: OpenPath::default(),
        last: (1, None),
        role: None,
        model,
        found,
    };
    let mut reader = Reader::default();
    let mut last = (1, None);
    each_line(file, |line| {
        let read = reader.read(line);
        last = (read.line.number, read.context.layer);
        match read.action {
            Action::Stroke(stroke) if stroke.extrudes() => {
                let part = read.context.role.map_or(!print.has_roles, is_part);
                print.role = read.context.role;
                print.bead(&stroke, part, read.context.height_mm, last);
            }
            Action::Stroke(stroke) if stroke.xy_mm > 0.0 => print.leave(),
            _ => {}
        }
    })?;
    print.end_layer();
    if sections.above().polygons().iter().any(|island| island.area_mm2() > SPECK_MM2) {
        let printed_mm = levels.all().last().map_or(0.0, |level| level.z_mm);
        print.model.missing_islands += 1;
        print.found.add(Kind::MissingIsland, last.0, last.1, || {
            format!("the print ends at Z{printed_mm:.2}, the model at Z{:.2}", sections.top_mm())
        });
    }
    Ok(())
}

/// The middle of a bead.
fn middle(bead: &Stroke) -> Point {
    let [x, y, _] = bead.at(0.5);
    Point::from_mm(x, y)
}

fn length_mm(beads: &[Stroke]) -> f64 {
    beads.iter().map(|bead| bead.xy_mm).sum()
}

/// The current layer.
struct LayerNow {
    level: Level,
    /// Which of the sections' layers it is; support may have layers of its own.
    index: Option<usize>,
    /// Where beads of the model may be.
    may: Option<Bitmap>,
    must: Region,
    /// Beads that will be part of the ground, with their width and whether they are the model's.
    beads: Vec<(Stroke, f64, bool)>,
    /// Beads of the model outside of that.
    extra: Vec<Stroke>,
    /// Length of the beads at its height, and of those that rise to it.
    level_mm: f64,
    risen_mm: f64,
    /// Its first line, and its number.
    location: (usize, Option<usize>),
}

struct Print<'a> {
    sections: &'a Sections<'a>,
    levels: &'a Levels,
    has_roles: bool,
    /// Whether islands have walls along their edge, by which they are found.
    has_edges: bool,
    area_mm2: f64,
    ground: Ground,
    layer: Option<LayerNow>,
    path: OpenPath,
    /// Line and layer of the last bead.
    last: (usize, Option<usize>),
    /// The role of that bead, if the file gives it.
    role: Option<Role>,
    model: &'a mut ModelReport,
    found: &'a mut Found,
}

impl Print<'_> {
    fn bead(
        &mut self,
        stroke: &Stroke,
        part: bool,
        height_mm: Option<f64>,
        location: (usize, Option<usize>),
    ) {
        // Parts of a scarf seam, or of a spiral, lie lower than their layer.
        let z_mm = if part { self.levels.rises_to_mm(stroke.to[2]) } else { stroke.to[2] };
        if self.layer.as_ref().is_none_or(|layer| (layer.level.z_mm - z_mm).abs() > 1e-3) {
            self.end_layer();
            self.begin_layer(z_mm, height_mm, location);
        }
        self.last = location;
        let Some(layer) = &mut self.layer else { return };
        let length_mm =
            if z_mm - stroke.to[2] > SLACK_MM { &mut layer.risen_mm } else { &mut layer.level_mm };
        *length_mm += stroke.xy_mm;
        let section_mm2 = stroke.fresh_mm3(self.area_mm2) / stroke.xy_mm;
        let height_mm = layer.level.height_mm;
        let width_mm = bead::width_mm(section_mm2 / height_mm, height_mm).clamp(0.1, 3.0);
        if part {
            self.path.add(stroke, height_mm, width_mm, &self.ground);
            if self.has_roles && layer.may.as_ref().is_some_and(|may| !may.has_at(middle(stroke))) {
                layer.extra.push(*stroke);
            }
        }
        layer.beads.push((*stroke, width_mm, part));
    }

    fn begin_layer(&mut self, z_mm: f64, height_mm: Option<f64>, location: (usize, Option<usize>)) {
        let index = self.levels.find(z_mm);
        let known = index.map(|index| self.levels.all()[index]);
        let level = known.unwrap_or(Level { z_mm, height_mm: height_mm.unwrap_or(0.2) });
        let (must, may) = index.map_or_else(Default::default, |index| self.sections.layer(index));
        let grid = may.bounds().map(|bounds: Bounds| Grid::new(bounds, 1.0, CELL_MM));
        self.layer = Some(LayerNow {
            level,
            index,
            may: grid.map(|grid| Bitmap::touching(grid, &may)),
            must,
            beads: Vec::new(),
            extra: Vec::new(),
            level_mm: 0.0,
            risen_mm: 0.0,
            location,
        });
    }

    /// A path is at its end.
    fn leave(&mut self) {
        let path = std::mem::take(&mut self.path);
        let hanging_mm = path.hanging_mm();
        if hanging_mm > 0.0 {
            self.model.over_air_mm += hanging_mm;
            let [x, y, z] = path.end();
            self.found.add(Kind::OverAir, self.last.0, self.last.1, || {
                let of = self
                    .role
                    .map_or(String::new(), |role| format!(" of {}", role.type_name().to_lowercase()));
                format!("{hanging_mm:.1} mm{of} before X{x:.2} Y{y:.2} Z{z:.2}")
            });
        }
    }

    fn end_layer(&mut self) {
        self.leave();
        let Some(layer) = self.layer.take() else { return };
        for (stroke, width_mm, part) in &layer.beads {
            let relief = if *part { &mut self.ground.part } else { &mut self.ground.support };
            relief.paint(stroke, *width_mm);
        }
        let (line, number) = layer.location;
        let extra = self.extra(&layer);
        let extra_mm = length_mm(&extra);
        if let Some(first) = extra.first().filter(|_| extra_mm > EXTRA_MM) {
            self.model.extra_mm += extra_mm;
            let [x, y, z] = first.at(0.5);
            self.found.add(Kind::ExtraMaterial, line, number, || {
                format!("{extra_mm:.1} mm of beads, first at X{x:.2} Y{y:.2} Z{z:.2}")
            });
        }
        if layer.index.is_none() || !self.has_edges {
            return;
        }
        // A revolution of a spiral begins where the one beneath ends.
        let Level { z_mm, height_mm } = layer.level;
        let least_mm = if layer.risen_mm > layer.level_mm { z_mm - height_mm } else { z_mm - SLACK_MM };
        for island in layer.must.polygons().iter().filter(|island| island.area_mm2() > SPECK_MM2) {
            self.model.islands += 1;
            let printed = self.printed(&island.outer, least_mm);
            if printed < PRINTED {
                self.model.missing_islands += 1;
                let [x, y] = island.outer.first().map_or([0.0; 2], |p| p.mm());
                self.found.add(Kind::MissingIsland, line, number, || {
                    format!("{:.2} mm² at X{x:.2} Y{y:.2} Z{z_mm:.2}", island.area_mm2())
                });
            }
        }
    }

    /// The beads of a layer that lie outside of all its sections, where these are more than is allowed.
    fn extra(&self, layer: &LayerNow) -> Vec<Stroke> {
        let index = layer.index.filter(|_| length_mm(&layer.extra) > EXTRA_MM);
        let Some(index) = index else { return Vec::new() };
        let section = EdgeGrid::new(&self.sections.middle(index));
        layer.extra.iter().filter(|bead| !section.contains(middle(bead))).copied().collect()
    }

    /// Share of an outline on which something lies at least so high.
    fn printed(&self, ring: &Ring, least_mm: f64) -> f64 {
        let (mut seen, mut printed) = (0_usize, 0_usize);
        let near = [-1.5, 0.0, 1.5].map(|step| step * self.ground.part.cell_mm());
        for [x, y] in along(ring).into_iter().map(|p| p.mm()) {
            let laid = |dx: f64, dy: f64| self.ground.part.at(x + dx, y + dy) >= least_mm;
            seen += 1;
            printed += usize::from(near.iter().any(|dx| near.iter().any(|dy| laid(*dx, *dy))));
        }
        printed as f64 / seen.max(1) as f64
    }
}
