//! The stages before layers are ordered: thumbnails, sections, walls. Who slices a plate again and again keeps their
//! results.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::job::JobError;
use crate::parallel::{self, Workers};
use crate::plate::Plate;
use crate::profile::Settings;
use crate::toolpath::{LayerPaths, LayerWalls, Path, ToolId};
use crate::view::{PlannedLayer, Solid, Surface};

use super::rounds::{self, Round, Site};

/// The walls of each round, of each layer, of each planner.
type Walls = Vec<Vec<Vec<LayerWalls>>>;

/// What slicings leave for the next ones, each result with what it was made from. A result is used again only where that is
/// the same, so that the bytes are those of a first slicing.
#[derive(Default)]
pub(crate) struct StageCache {
    /// The plate of all that follows.
    plate: Plate,
    /// With their list.
    pictures: Option<(String, [String; 2])>,
    rounds: Option<(RoundsKey, Arc<Vec<Round>>)>,
    /// With the rounds that they are of.
    walls: Option<(Arc<Vec<Round>>, Arc<Walls>)>,
}

/// What sections depend on beside the plate.
#[derive(PartialEq)]
struct RoundsKey {
    settings: Settings,
    /// Of each object, whose own settings they are, and the settings.
    styles: (Vec<Option<usize>>, Vec<Settings>, Vec<Option<ToolId>>),
    modifiers: [Plate; 2],
}

/// How far a slicing is.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Stage<'a> {
    /// The models have their places.
    Placed(&'a Plate),
    /// Walls are planned: of so many layers, and of how many.
    Walls(usize, usize),
    /// The walls of all layers are planned.
    WallsDone(&'a [PlannedLayer<'a>]),
}

/// Who follows a slicing stage by stage, and keeps what the next one can use.
pub(crate) struct Live<'a> {
    pub cache: &'a mut StageCache,
    pub tell: &'a (dyn Fn(Stage<'_>) + Sync),
}

/// What is known before the layers are ordered.
pub(super) struct Staged {
    /// Thumbnails: those that must come before anything else, and the others.
    pub pictures: [String; 2],
    pub rounds: Arc<Vec<Round>>,
    /// Where they are known already.
    pub walls: Option<Arc<Walls>>,
}

impl Staged {
    /// The walls of a layer.
    pub fn walls(&self, round: usize, layer: usize) -> Option<&[LayerWalls]> {
        self.walls.as_ref().map(|walls| walls[round][layer].as_slice())
    }
}

/// Does these stages one after the other, sections beside the thumbnails.
pub(super) fn prepare(
    site: &Site<'_>,
    pictures: impl FnOnce() -> [String; 2] + Send,
    settings: &Settings,
    workers: Workers<'_>,
) -> Result<Staged, JobError> {
    let (rounds, pictures) = parallel::join(|| rounds::prepare(site, settings, workers), pictures);
    Ok(Staged { pictures, rounds: Arc::new(rounds?), walls: None })
}

impl Live<'_> {
    /// As [`prepare`], but the walls of all layers come first, the thumbnails last, and what is kept is used.
    pub(super) fn prepare(
        &mut self,
        site: &Site<'_>,
        pictures: impl FnOnce() -> [String; 2] + Send,
        settings: &Settings,
        workers: Workers<'_>,
    ) -> Result<Staged, JobError> {
        (self.tell)(Stage::Placed(site.plate));
        let cache = &mut *self.cache;
        if cache.plate != *site.plate {
            *cache = StageCache { plate: site.plate.clone(), ..StageCache::default() };
        }
        let rounds = cache.rounds(site, settings, workers)?;
        let walls = cache.walls(&rounds, self.tell, workers);
        let list = &settings.gcode.thumbnails;
        let known = cache.pictures.take().filter(|(of, _)| of == list).map(|(_, pictures)| pictures);
        let draw = || known.unwrap_or_else(pictures);
        let show = || self.show(&rounds, &walls, settings);
        let ((), pictures) = parallel::join(show, draw);
        self.cache.pictures = Some((list.clone(), pictures.clone()));
        Ok(Staged { pictures, rounds, walls: Some(walls) })
    }

    fn show(&self, rounds: &[Round], walls: &Walls, settings: &Settings) {
        let of_round = |(round, walls): (&Round, &Vec<Vec<LayerWalls>>)| -> Vec<Option<LayerPaths>> {
            (0..walls.len()).map(|layer| round.sections.turn(layer)).collect()
        };
        let turns: Vec<Vec<Option<LayerPaths>>> = rounds.iter().zip(walls).map(of_round).collect();
        let mut layers = Vec::new();
        for ((round, walls), turns) in rounds.iter().zip(walls).zip(&turns) {
            for ((layer, walls), turn) in round.sections.layers.iter().zip(walls).zip(turns) {
                let islands = walls.iter().flat_map(|walls| &walls.islands);
                let paths = islands.flat_map(|island| &island.paths);
                let paths = paths.chain(turn.iter().flat_map(|turn| &turn.paths)).collect();
                layers.push(PlannedLayer { z_mm: layer.span.top_mm + settings.layer.z_offset.0, paths });
            }
        }
        (self.tell)(Stage::WallsDone(&layers));
    }
}

impl StageCache {
    fn rounds(
        &mut self,
        site: &Site<'_>,
        settings: &Settings,
        workers: Workers<'_>,
    ) -> Result<Arc<Vec<Round>>, JobError> {
        let settings = settings.for_toolpaths();
        let mut own = Vec::new();
        let styles = site.styles.changed(&mut own, Settings::for_toolpaths);
        let tools = (0..styles.of_objects().len()).map(|object| styles.tool(object)).collect();
        let styles_key = (styles.of_objects().to_vec(), styles.own().cloned().collect(), tools);
        let key = RoundsKey { settings, styles: styles_key, modifiers: site.modifiers.clone() };
        if let Some((_, rounds)) = self.rounds.as_ref().filter(|(known, _)| *known == key) {
            return Ok(rounds.clone());
        }
        self.rounds = None;
        let site = Site { styles: &styles, ..*site };
        let rounds = Arc::new(rounds::prepare(&site, &key.settings, workers)?);
        self.rounds = Some((key, rounds.clone()));
        Ok(rounds)
    }

    fn walls(
        &mut self,
        rounds: &Arc<Vec<Round>>,
        tell: &(dyn Fn(Stage<'_>) + Sync),
        workers: Workers<'_>,
    ) -> Arc<Walls> {
        let same = |known: &[Round]| {
            let mut pairs = known.iter().zip(rounds.iter());
            known.len() == rounds.len() && pairs.all(|(known, round)| round.has_walls_of(known))
        };
        let walls = match self.walls.take().filter(|(known, _)| Arc::ptr_eq(known, rounds) || same(known)) {
            Some((_, walls)) => walls,
            None => {
                let of = rounds.iter().map(|round| round.sections.layers.len()).sum();
                let done = AtomicUsize::new(0);
                tell(Stage::Walls(0, of));
                let walls = |round: &Round| {
                    workers.map(round.sections.layers.len(), |layer| {
                        let walls = round.walls(layer);
                        tell(Stage::Walls(1 + done.fetch_add(1, Ordering::Relaxed), of));
                        walls
                    })
                };
                Arc::new(rounds.iter().map(walls).collect())
            }
        };
        self.walls = Some((rounds.clone(), walls.clone()));
        walls
    }

    /// About how many bytes it holds.
    pub(crate) fn bytes(&self) -> usize {
        let path = |path: &Path| std::mem::size_of::<Path>() + 12 * path.points.len();
        let walls = self.walls.iter().flat_map(|(_, walls)| walls.iter().flatten().flatten());
        let islands = walls.flat_map(|walls| &walls.islands);
        let walls: usize = islands
            .map(|island| island.paths.iter().map(path).sum::<usize>() + 8 * island.inside.vertex_count())
            .sum();
        let rounds = self.rounds.iter().flat_map(|(_, rounds)| rounds.iter());
        let layers = rounds.flat_map(|round| &round.sections.layers);
        // A section with its shells.
        let sections: usize =
            layers.flat_map(|layer| &layer.sections).map(|section| 24 * section.region.vertex_count()).sum();
        let meshes = self.plate.meshes.iter();
        let meshes: usize = meshes.map(|mesh| 24 * mesh.vertices().len() + 24 * mesh.triangles().len()).sum();
        walls + sections + meshes
    }
}

/// A plate that can be drawn for as long as the run goes on.
pub(super) struct Watched<'a>(pub &'a Plate, pub Workers<'a>);

impl Solid for Watched<'_> {
    fn surfaces(&self, each: &mut dyn FnMut(Surface<'_>)) {
        self.0.surfaces(each);
    }

    fn go_on(&self) {
        self.1.go_on();
    }
}
