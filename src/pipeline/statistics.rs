//! What a print adds up to, layer by layer.

use crate::estimate::Machine;
use crate::gcode::{Effect, PrintFacts, Totals};
use crate::motion::ToolSums;
use crate::order::compare::Proved;
use crate::order::{CostKind, PathOrder, Pins, ends_on_path};
use crate::parallel::Workers;
use crate::profile::{FilamentSettings, Settings};
use crate::report::{LayerSummary, Measures, Summary, TimeBound, ToolSummary};
use crate::toolpath::{LayerPaths, ToolId};
use crate::units::{Mm3, Seconds};
use geometry::{Bounds, Point};

use super::ordering::{self, Certificate};

/// The ordered layers, kept for the certificate.
pub(super) struct Ordered {
    /// Of the layer that it is, or is a part of.
    pub index: usize,
    pub layer: (LayerPaths, Pins),
    pub order: PathOrder,
    pub start: Option<Point>,
}

/// Statistics of what has been written so far.
#[derive(Default)]
pub(super) struct Statistics {
    pub layers: Vec<LayerSummary>,
    pub total: Measures,
    /// Filament in the layers, mm³.
    pub layers_mm3: f64,
    /// Of each tool, where there are several: all that it printed, and what was flushed.
    pub tools_mm3: Vec<f64>,
    pub flushed_mm3: Vec<f64>,
    pub changes: usize,
    /// When each layer begins, or each of its parts.
    pub part_starts: Vec<Seconds>,
    pub proved: Option<Proved>,
    pub time_bound: Option<TimeBound>,
}

impl Statistics {
    /// Adds a layer, or another part of the layer with this index.
    pub fn add(&mut self, index: usize, layer: LayerSummary, tools: &[ToolSums]) {
        self.tools_mm3.resize(tools.len(), 0.0);
        self.flushed_mm3.resize(tools.len(), 0.0);
        for (tool, sums) in tools.iter().enumerate() {
            self.tools_mm3[tool] += sums.volume_mm3;
            self.flushed_mm3[tool] += sums.flushed_mm3;
            self.changes += sums.taken;
        }
        self.part_starts.push(Seconds(self.total.total_s));
        self.total += &layer.measures;
        self.layers_mm3 += layer.measures.volume_mm3;
        match self.layers.get_mut(index) {
            Some(known) => known.measures += &layer.measures,
            None => self.layers.push(layer),
        }
    }

    /// What a script does belongs to the whole, but to no layer.
    pub fn add_script(&mut self, effect: &Effect, machine: &Machine) {
        self.total += &Measures::of(&effect.measure, effect.time, machine.filament_area_mm2);
    }

    /// Adds the lower bounds of all layers, and of the whole.
    pub fn certify(
        &mut self,
        ordered: Vec<Ordered>,
        settings: &Settings,
        start: Option<Point>,
        workers: Workers<'_>,
    ) {
        let begins = ordered
            .iter()
            .map(|Ordered { layer, order, .. }| Some(ends_on_path(&layer.0, *order.first()?).0));
        let begins: Vec<_> = begins.collect();
        let excesses = workers.map(ordered.len(), |i| {
            let Ordered { layer, order, start, .. } = &ordered[i];
            let next = begins[i + 1..].iter().find_map(|&begin| begin);
            ordering::excess((&layer.0, &layer.1), order, [*start, next], settings)
        });
        let link_s = |Ordered { index, layer, order, start }: &Ordered| {
            ordering::measured(*index, &layer.0, order, *start, settings).travel_s
        };
        let link_s: Option<f64> =
            (settings.order.cost == CostKind::Time).then(|| ordered.iter().map(link_s).sum());
        let drawn = excesses.into_iter().zip(&begins).filter(|(_, begin)| begin.is_some());
        self.proved = Some(Proved::of(drawn.map(|(excess, _)| excess)));
        let (layers, places): (Vec<_>, Vec<_>) =
            ordered.into_iter().map(|ordered| (ordered.layer, (ordered.index, ordered.start))).unzip();
        let certificate = Certificate::new(&layers, settings, start, workers);
        let mut bounds_mm = vec![0.0; self.layers.len()];
        for (part, (index, start)) in places.into_iter().enumerate() {
            bounds_mm[index] += certificate.layer_mm(part, start);
        }
        for (layer, bound_mm) in self.layers.iter_mut().zip(bounds_mm) {
            layer.measures = std::mem::take(&mut layer.measures).with_bound(bound_mm);
        }
        self.total = std::mem::take(&mut self.total).with_bound(certificate.print_mm());
        let times = link_s.zip(certificate.print_s());
        self.time_bound = times.map(|(link_s, bound_s)| TimeBound::new(link_s, bound_s));
    }

    /// Totals. What scripts extrude of itself is the first tool's.
    pub fn totals(&self, settings: &Settings, first: ToolId) -> Totals {
        let scripts_mm3 = self.total.volume_mm3 - self.layers_mm3;
        let own = |(tool, mm3): (usize, &f64)| {
            let scripts_mm3 = if tool == usize::from(first) { scripts_mm3 } else { 0.0 };
            (Mm3(mm3 + scripts_mm3), settings.of_tool(tool).filament.clone())
        };
        Totals {
            tools: self.tools_mm3.iter().enumerate().map(own).collect(),
            time: Seconds(self.total.total_s),
            volume: Mm3(self.total.volume_mm3),
            layer_starts: self.part_starts.clone(),
        }
    }

    /// What each tool printed.
    pub fn of_tools(&self, totals: &Totals, settings: &Settings) -> Vec<ToolSummary> {
        let own = |(tool, (volume, filament)): (usize, &(Mm3, FilamentSettings))| {
            let grams = volume.0 / 1000.0 * filament.density;
            ToolSummary {
                tool: tool + 1,
                name: settings.of_tool(tool).tool.name.clone(),
                material: filament.material.clone(),
                color: filament.color.clone(),
                volume_mm3: volume.0,
                flushed_mm3: self.flushed_mm3[tool],
                filament_mm: volume.0 / filament.area_mm2(),
                filament_g: grams,
                filament_cost: grams / 1000.0 * filament.cost,
            }
        };
        totals.tools.iter().enumerate().map(own).collect()
    }

    pub fn summary(
        self,
        bounds: Bounds,
        facts: &PrintFacts,
        totals: &Totals,
        settings: &Settings,
        warnings: Vec<String>,
    ) -> Summary {
        let ([x0, y0], [x1, y1]) = (bounds.min.mm(), bounds.max.mm());
        let filament_g = totals.grams(&settings.filament);
        Summary {
            tools: self.of_tools(totals, settings),
            tool_changes: self.changes,
            size_mm: [x1 - x0, y1 - y0, facts.max_z_mm - settings.layer.z_offset.0],
            layer_count: self.layers.len(),
            total: self.total,
            proved: self.proved,
            time_bound: self.time_bound,
            filament_g,
            filament_cost: totals.cost(&settings.filament),
            warnings,
            layers: self.layers,
            ..Summary::default()
        }
    }
}
