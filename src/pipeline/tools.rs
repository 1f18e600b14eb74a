//! What must be known of all layers where a printer has several tools: which prints when, and the tower that it takes.

use crate::gcode::ToolFacts;
use crate::job::{FitError, JobError};
use crate::parallel::Workers;
use crate::plan::tool_order;
use crate::plan::tower::{self, Tower};
use crate::profile::Settings;
use crate::toolpath::{LayerPaths, LayerWalls, ToolId};
use geometry::{Polygon, Region, Ring};

use super::rounds::Round;

/// The layers of a print with several tools.
pub(super) struct Tooled {
    /// Of each round: all paths, the tower's included, and the order of their tools.
    pub layers: Vec<Vec<LayerPaths>>,
    /// What the tower covers on the bed.
    pub tower: Option<Polygon>,
}

impl Tooled {
    /// Plans the layers, where the printer has several tools.
    ///
    /// # Errors
    /// There is no room for the tower.
    pub fn plan<'w>(
        rounds: &[Round],
        walls: &(dyn Fn(usize, usize) -> Option<&'w [LayerWalls]> + Sync),
        settings: &Settings,
        workers: Workers<'_>,
    ) -> Result<Option<Self>, JobError> {
        if settings.tools.len() < 2 {
            return Ok(None);
        }
        let (mut layers, mut current) = (Vec::new(), None);
        for (number, round) in rounds.iter().enumerate() {
            let count = round.sections.layers.len();
            let mut planned = workers.map(count, |i| round.paths(i, walls(number, i), settings));
            let problem = tool_order::problem(&planned, current, settings);
            let plan = tool_order::plan(&problem, settings.tool_change.order);
            tool_order::settle(&mut planned, &plan, current);
            current = planned.last().and_then(|layer| layer.tools.last().copied()).or(current);
            layers.push(planned);
        }
        let mut tooled = Self { layers, tower: None };
        // Objects that are printed one after the other have none.
        let [layers] = tooled.layers.as_mut_slice() else { return Ok(Some(tooled)) };
        if settings.prime_tower.enabled {
            tower::flush_into(layers, settings);
        }
        if let ([round], true) = (rounds, settings.prime_tower.enabled)
            && let Some(mut tower) = Tower::plan(layers, settings)
        {
            if !tower.place(&printed(round, settings, workers), settings) {
                let [width_mm, depth_mm] = tower.size_mm;
                return Err(FitError::PrimeTower { width_mm, depth_mm }.into());
            }
            for (index, layer) in layers.iter_mut().enumerate() {
                let (paths, rams) = tower.paths(index);
                layer.insert(0, paths);
                layer.rams = rams;
            }
            tooled.tower = Some(tower.footprint());
        }
        Ok(Some(tooled))
    }

    /// The tools of all layers, one after the other.
    fn turns(&self) -> impl Iterator<Item = ToolId> {
        self.layers.iter().flatten().flat_map(|layer| layer.tools.iter().copied())
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
            tower: self.tower.is_some(),
        }
    }
}

/// Everything that is printed, seen from above: around each object its hull, and all that lies on the bed.
fn printed(round: &Round, settings: &Settings, workers: Workers<'_>) -> Region {
    let hulls = round.sections.hulls(workers).into_iter().map(|(_, hull)| hull);
    let on_bed = round.sections.first_layer_outlines(&round.planners, 0.0);
    let ring = |corners: Vec<[f64; 2]>| -> Ring {
        corners.into_iter().map(|[x, y]| geometry::Point::from_mm(x, y)).collect()
    };
    let rings: Vec<Ring> = hulls.chain(on_bed).map(ring).filter(|ring| ring.len() >= 3).collect();
    let reach_mm = settings.layer.elephant_foot.0.abs();
    geometry::offset(&geometry::unite_rings(&rings), reach_mm)
}
