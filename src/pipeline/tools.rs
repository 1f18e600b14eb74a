//! What must be known of all layers where a printer has several tools: which prints when, and the tower that it takes.

use crate::gcode::ToolFacts;
use crate::job::{FitError, JobError};
use crate::parallel::Workers;
use crate::plan::blocks::{self, Pass};
use crate::plan::priming::{self, Priming};
use crate::plan::shield::Shield;
use crate::plan::styles::Styles;
use crate::plan::tower::Tower;
use crate::plan::{flush, tool_order};
use crate::profile::Settings;
use crate::toolpath::{LayerPaths, LayerWalls, Role, ToolId};
use geometry::{Polygon, Region, Ring};

use super::rounds::{Round, Site};

/// The layers of a print with several tools.
pub(super) struct Tooled {
    /// Of each round: all paths, the tower's included, and the order of their tools.
    pub layers: Vec<Vec<LayerPaths>>,
    /// Of each round: what is printed one after the other.
    passes: Vec<Vec<Pass>>,
    /// What tower and ooze shield cover on the bed.
    pub covered: Vec<Polygon>,
    has_tower: bool,
    /// What comes before the first layer.
    priming: Option<Priming>,
    /// What the user should know.
    pub warning: Option<String>,
    flushes_into_objects: bool,
}

/// What takes flushes: whether an object of the plate does.
fn takes_flushes<'a>(styles: &'a Styles<'_>, settings: &'a Settings) -> impl Fn(u32) -> bool + Sync + 'a {
    |object| styles.settings(object as usize, settings).tool_of.flush
}

/// Whether tools are flushed into more than the tower.
pub(super) fn flushes_into_print(styles: &Styles<'_>, settings: &Settings) -> bool {
    let into = |own: &Settings| own.tool_change.flush_into_infill || own.tool_of.flush;
    settings.tool_change.flush_into_support || std::iter::once(settings).chain(styles.own()).any(into)
}

/// The paths of a layer of which the tools are known, where that matters.
pub(super) fn paths(
    round: &Round,
    (layer, walls): (usize, Option<&[LayerWalls]>),
    styles: &Styles<'_>,
    settings: &Settings,
) -> LayerPaths {
    let mut paths = round.paths(layer, walls, settings);
    flush::free(&mut paths, takes_flushes(styles, settings));
    paths
}

impl Tooled {
    /// Plans the layers, where the printer has several tools.
    ///
    /// # Errors
    /// There is no room for the tower.
    pub fn plan<'w>(
        rounds: &[Round],
        walls: &(dyn Fn(usize, usize) -> Option<&'w [LayerWalls]> + Sync),
        site: &Site<'_>,
        settings: &Settings,
        workers: Workers<'_>,
    ) -> Result<Option<Self>, JobError> {
        let styles = site.styles;
        if settings.tools.len() < 2 {
            return Ok(None);
        }
        let (mut layers, mut all_blocks, mut current) = (Vec::new(), Vec::new(), None);
        for (number, round) in rounds.iter().enumerate() {
            let count = round.sections.layers.len();
            let mut planned = workers.map(count, |i| paths(round, (i, walls(number, i)), styles, settings));
            let blocks = blocks::find(&planned, flushes_into_print(styles, settings), site.stops, settings);
            let problem = tool_order::problem(&planned, &blocks, current, settings);
            let plan = tool_order::plan(&problem, settings.tool_change.order);
            tool_order::settle(&mut planned, &blocks, &plan, current);
            current = planned.last().and_then(|layer| layer.tools.last().copied()).or(current);
            layers.push(planned);
            all_blocks.push(blocks);
        }
        let into_infill = |own: &Settings| own.tool_change.flush_into_infill;
        let flushes_into_objects =
            styles.own().any(|own| own.tool_of.flush || into_infill(own) != into_infill(settings))
                || settings.tool_of.flush;
        let mut tooled = Self {
            layers,
            passes: Vec::new(),
            covered: Vec::new(),
            has_tower: false,
            priming: None,
            warning: None,
            flushes_into_objects,
        };
        // Objects that are printed one after the other have neither.
        if let [round] = rounds {
            tooled.add_shield(round, site, settings, workers);
            tooled.add_tower(round, site, settings, workers)?;
        }
        let each = tooled.layers.iter().zip(&all_blocks);
        tooled.passes = each.map(|(layers, blocks)| blocks::passes(layers, blocks, settings)).collect();
        Ok(Some(tooled))
    }

    /// How many parts a round is printed in: as many as it has layers, unless tools print several at once.
    pub fn count(&self, round: usize) -> usize {
        usize::from(self.priming.is_some()) + self.passes[round].len()
    }

    /// Such a part.
    pub fn paths(&self, round: usize, part: usize) -> LayerPaths {
        match &self.priming {
            Some(priming) if part == 0 => priming.layer(),
            priming => self.passes[round][part - usize::from(priming.is_some())].paths(&self.layers[round]),
        }
    }

    /// Lays the tower, where one is wanted.
    fn add_tower(
        &mut self,
        round: &Round,
        site: &Site<'_>,
        settings: &Settings,
        workers: Workers<'_>,
    ) -> Result<(), JobError> {
        let [layers] = self.layers.as_mut_slice() else { return Ok(()) };
        if !settings.prime_tower.enabled {
            return Ok(());
        }
        flush::into(layers, |object| site.styles.settings(object as usize, settings), settings);
        let Some(mut tower) = Tower::plan(layers, site.widths_mm, settings) else { return Ok(()) };
        let shield = Region::disjoint(self.covered.clone());
        let [printed, standing] = [printed(round, settings, workers), standing(round, settings, workers)]
            .map(|region| geometry::union(&region, &shield));
        let room = site.tower_room_mm.map(|[middle, _]| middle);
        let mut is_placed = false;
        if let Some(priming) = Self::priming(layers, &printed, site, settings) {
            let lines = Region::from(priming.covered.clone());
            let [printed, standing] = [&printed, &standing].map(|region| geometry::union(region, &lines));
            is_placed = tower.place(&printed, &standing, room, settings);
            self.priming = Some(priming).filter(|_| is_placed);
        }
        if settings.prime_tower.at_start && self.priming.is_none() {
            let text = "no room at the front and back edges of the bed to prime the tools; the start script primes the first one";
            self.warning = Some(text.into());
        }
        if !is_placed && !tower.place(&printed, &standing, room, settings) {
            let [width_mm, depth_mm] = tower.size_mm;
            return Err(FitError::PrimeTower { width_mm, depth_mm }.into());
        }
        for (index, layer) in layers.iter_mut().enumerate() {
            let (paths, rams) = tower.paths(index);
            layer.insert(0, paths);
            layer.rams = rams;
        }
        self.covered.extend(self.priming.iter().map(|priming| priming.covered.clone()));
        self.covered.push(tower.footprint());
        self.has_tower = true;
        Ok(())
    }

    /// Lines that prime all tools that print, clear of what is printed; `None`: none are wanted, or there is no room for them.
    fn priming(
        layers: &[LayerPaths],
        printed: &Region,
        site: &Site<'_>,
        settings: &Settings,
    ) -> Option<Priming> {
        let mut used: Vec<ToolId> = turns(layers).collect();
        let first = *used.first().filter(|_| settings.prime_tower.at_start)?;
        used.sort_unstable();
        used.dedup();
        let order = priming::order(&used, first, settings);
        let top_mm = layers.first()?.top_mm;
        Priming::plan(order, top_mm, &site.widths_mm[0], printed, settings)
    }

    /// Lays the ooze shield, where one is wanted. It is a skirt, too.
    fn add_shield(&mut self, round: &Round, site: &Site<'_>, settings: &Settings, workers: Workers<'_>) {
        let [layers] = self.layers.as_mut_slice() else { return };
        let Some(shield) =
            Shield::plan(layers, &standing(round, settings, workers), site.widths_mm, settings)
        else {
            return;
        };
        for (index, layer) in layers.iter_mut().enumerate() {
            layer.retain(|path| path.role != Role::Skirt);
            let paths = shield.paths(index, layer);
            layer.insert(0, paths);
        }
        self.covered.extend(shield.covered().into_polygons());
    }

    /// The tools of all layers, one after the other, and before them those that are primed.
    fn turns(&self) -> impl Iterator<Item = ToolId> {
        let primed = self.priming.iter().flat_map(|priming| priming.tools.iter().copied());
        primed.chain(self.layers.iter().flat_map(|layers| turns(layers)))
    }

    /// What header and scripts tell of them.
    pub fn facts(&self) -> ToolFacts {
        let turns: Vec<ToolId> = self.turns().collect();
        let mut used = turns.clone();
        used.sort_unstable();
        used.dedup();
        ToolFacts {
            first: turns.first().copied().unwrap_or(0),
            used,
            changes: turns.windows(2).filter(|pair| pair[0] != pair[1]).count(),
            tower: self.has_tower,
            primed: self.priming.is_some(),
            flushes_into_objects: self.flushes_into_objects,
        }
    }
}

/// The tools of layers, one after the other.
fn turns(layers: &[LayerPaths]) -> impl Iterator<Item = ToolId> {
    layers.iter().flat_map(|layer| layer.tools.iter().copied())
}

/// Everything that is printed, seen from above: around each object its hull, and all that lies on the bed.
fn printed(round: &Round, settings: &Settings, workers: Workers<'_>) -> Region {
    let on_bed = round.sections.first_layer_outlines(&round.planners, 0.0);
    let rings: Vec<Ring> = on_bed.into_iter().map(ring).collect();
    geometry::union(&geometry::unite_rings(&rings), &standing(round, settings, workers))
}

/// The same without the skirt.
fn standing(round: &Round, settings: &Settings, workers: Workers<'_>) -> Region {
    let hulls = round.sections.hulls(workers).into_iter().map(|(_, hull)| ring(hull));
    let on_bed = round.sections.on_bed(&round.planners).into_iter().map(|polygon| polygon.outer);
    let rings: Vec<Ring> = hulls.chain(on_bed).filter(|ring| ring.len() >= 3).collect();
    geometry::offset(&geometry::unite_rings(&rings), settings.layer.elephant_foot.0.abs())
}

fn ring(corners: Vec<[f64; 2]>) -> Ring {
    corners.into_iter().map(|[x, y]| geometry::Point::from_mm(x, y)).collect()
}
