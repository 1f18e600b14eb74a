//! From the sections of a plate to the paths of its layers.

use super::Sections;
use crate::parallel::Workers;
use crate::plan::planners::Planners;
use crate::plan::styles::Styles;
use crate::plan::supports;
use crate::profile::Settings;
use crate::slice::Layer;
use crate::toolpath::support::{self, BeadSpec, Outlines};
use crate::toolpath::{self, LayerPaths, LayerWalls, Path, Planner, Role, SupportStyle};
use geometry::{Polygon, Region};

impl Sections {
    /// The walls of a layer; a revolution of a spiral is planned with the rest.
    pub fn walls(&self, planners: &Planners, index: usize) -> Vec<LayerWalls> {
        match self.spiral.as_ref().is_some_and(|spiral| spiral.has(index)) {
            true => Vec::new(),
            false => planners.walls(&self.plate_layer(index)),
        }
    }

    /// All paths of a layer whose [`walls`](Self::walls) are known; support comes before what it carries.
    pub fn paths(
        &self,
        planners: &Planners,
        index: usize,
        walls: Vec<LayerWalls>,
        settings: &Settings,
    ) -> LayerPaths {
        let turn = self.turn(index);
        let is_turn = turn.is_some();
        let mut layer = turn.unwrap_or_else(|| planners.filled(self.plate_layer(index), walls));
        let Layer { seams, .. } = &self.layers[index];
        if !is_turn && !seams.is_empty() {
            let foot_mm = if index == self.raft_layers { settings.layer.elephant_foot.0 } else { 0.0 };
            let moved_mm = settings.layer.xy_compensation.0.abs() + foot_mm;
            toolpath::seams::mark(&mut layer, seams, moved_mm);
        }
        for island in &mut layer.islands {
            island.object = self.objects[island.object as usize] as u32;
        }
        if is_turn {
            return layer;
        }
        let beads = match (index.checked_sub(self.raft_layers), &self.supports) {
            (None, _) => {
                let width_mm =
                    [settings.walls.width.0, settings.first_layer.width.0][usize::from(index == 0)];
                let width_mm = if width_mm > 0.0 { width_mm } else { settings.walls.width.0 };
                let area = planners.main.covered();
                toolpath::raft(area, index as u32, &settings.raft, width_mm, layer.height_mm)
            }
            (Some(_), None) => return layer,
            (Some(above_raft), Some(supports)) => supports.beads(above_raft).to_vec(),
        };
        let around = |role| matches!(role, Role::Skirt | Role::Brim);
        let tool_of = |path: Path| match settings.tools.len() {
            0 | 1 => path,
            _ => Path { tool: settings.tool_of.of_role(path.role, settings.tool_of.base()), ..path },
        };
        let beads = beads.into_iter().map(tool_of);
        let place = layer.paths.iter().position(|p| !around(p.role)).unwrap_or(layer.paths.len());
        layer.insert(place, beads);
        layer
    }

    /// A layer that is a revolution of a spiral.
    pub fn turn(&self, index: usize) -> Option<LayerPaths> {
        let spiral = self.spiral.as_ref()?;
        let below = index.checked_sub(1).map_or(Region::EMPTY, |below| self.of(0, below));
        spiral.layer(&self.layers[index].span, self.of(0, index), below)
    }

    /// Lays the beads of supports, beside what the planner lays on the bed.
    pub fn lay_supports(&mut self, planner: &Planner, settings: &Settings, workers: Workers<'_>) {
        let Some(supports) = &mut self.supports else { return };
        let (part, on_raft) = (&self.layers[self.raft_layers..], self.raft_layers > 0);
        let lay = |outlines: &Outlines, above_raft: usize| {
            let (first, layer) = (above_raft == 0, &part[above_raft]);
            // Support stands on the raft, over which the part floats.
            let gap_mm = if first && on_raft { settings.raft.gap.0 } else { 0.0 };
            // Trees are clear of the part already, though not of what surrounds it on the bed.
            let tree = settings.support.style == SupportStyle::Tree;
            let spec = BeadSpec {
                part: match first && !on_raft {
                    true => planner.covered(),
                    false if tree => Region::EMPTY,
                    false => &geometry::simplify(&supports::section(layer), support::ROUGH_MM),
                },
                height_mm: layer.span.height_mm + gap_mm,
                usual_height_mm: settings.layer.height.0,
                on_bed: first,
            };
            support::lay(outlines, &spec, &settings.support)
        };
        supports.lay(lay, part, workers);
    }

    /// The toolpath planners, their sparse infill calibrated on sample layers. The skirt goes also around `around`.
    pub fn planners(
        &self,
        styles: &Styles<'_>,
        settings: &Settings,
        around: &[Polygon],
        workers: Workers<'_>,
    ) -> Planners {
        let mut footprint = supports::section(&self.layers[self.raft_layers]);
        let standing = self.supports.as_ref().map_or(Region::EMPTY, |supports| &supports.outlines(0).all);
        if self.raft_layers > 0 {
            footprint = toolpath::raft_area(&geometry::union(&footprint, standing), &settings.raft);
        }
        let first_height_mm = self.layers[0].span.height_mm;
        let mut planners = Planners::new(settings, styles, &footprint, first_height_mm);
        planners.use_patterns(&self.infill);
        let shielded = if settings.skirt.draft_shield { self.layers.len() } else { 0 };
        let sections = self.layers[..shielded].iter().flat_map(|l| &l.sections).map(|s| &s.region);
        let supports = self.supports.iter().flat_map(|s| s.all_outlines(shielded.max(1)));
        let enclosed = sections.chain(supports).flat_map(|region| region.polygons()).chain(around);
        planners.enclose(enclosed, first_height_mm);
        let height_mm = self.layers.last().map_or(first_height_mm, |last| last.span.height_mm);
        let layer = |i: usize| self.plate_layer(i);
        planners.calibrate(workers, layer, self.raft_layers + 1, self.layers.len(), height_mm);
        planners.combine(workers, layer, self.layers.len());
        planners
    }

    /// What is printed on the bed: the objects with brim and raft, and their supports.
    pub fn on_bed(&self, planners: &Planners) -> Vec<Polygon> {
        let supports = self.supports.iter().flat_map(|supports| supports.all_outlines(1));
        let regions = std::iter::once(planners.main.covered()).chain(supports);
        regions.flat_map(|region| region.polygons().iter().cloned()).collect()
    }

    /// Outlines of the first layer: section, brim, supports and skirt, millimetres; all grown by `more_mm`.
    pub fn first_layer_outlines(&self, planners: &Planners, more_mm: f64) -> Vec<Vec<[f64; 2]>> {
        let outer = |polygon: &Polygon| polygon.outer.iter().map(|p| p.mm()).collect();
        let around = planners.main.skirt_outline(self.layers[0].span.height_mm);
        let all = Region::disjoint(self.on_bed(planners).into_iter().chain(around));
        geometry::offset(&all, more_mm).polygons().iter().map(outer).collect()
    }
}
