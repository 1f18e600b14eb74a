//! Rounds, printed from the bed up without interruption: the whole plate, or one object after the other.

use crate::job::{FitError, Job, JobError};
use crate::motion::PauseAt;
use crate::plate::Sequence;
use crate::plate::{Object, Plate};
use crate::profile::Settings;
use crate::report::Overhangs;
use crate::slice::Slicer;
use crate::toolpath::{LayerPaths, LayerWalls};
use geometry::{Point, Polygon};

use super::load::{self, Loaded};
use crate::parallel::{self, Workers};
use crate::plan::planners::Planners;
use crate::plan::sections::Sections;
use crate::plan::styles::Styles;
use crate::plan::supports;

/// How far above finished objects the nozzle passes, millimetres: more than they may have warped.
const PASS_MM: f64 = 2.0;

/// Objects that are printed together.
pub(super) struct Round {
    pub sections: Sections,
    pub planners: Planners,
    /// What would need support, where none is laid.
    pub overhangs: Option<Overhangs>,
    /// The object, where it is printed by itself.
    pub name: Option<String>,
    /// Layers of the rounds before.
    pub first_layer: usize,
    /// Height at which the nozzle passes over the objects of the rounds before; 0: there are none.
    pub over_mm: f64,
}

/// What stands on the plate, and how it is to be printed.
#[derive(Clone, Copy)]
pub(super) struct Site<'a> {
    pub plate: &'a Plate,
    pub styles: &'a Styles<'a>,
    /// Where support is enforced and where it is blocked.
    pub modifiers: &'a [Plate; 2],
    /// Sizes that point to another unit.
    pub hints: &'a [String],
    /// The middle of the room that is kept for the prime tower, and its size, millimetres.
    pub tower_room_mm: Option<[[f64; 2]; 2]>,
    /// Widths of what each tool prints beside the objects, on the first layer and on others, millimetres.
    pub widths_mm: &'a [Vec<f64>; 2],
    /// Where the print stops: pauses, and changes of color.
    pub stops: [&'a [PauseAt]; 2],
}

impl<'a> Site<'a> {
    /// Of models that are placed.
    pub fn of(loaded: &'a Loaded<'a>, job: &'a Job) -> Self {
        let Loaded { plate, styles, modifiers, hints, tower_room_mm, widths_mm, .. } = loaded;
        let stops = [job.pauses.as_slice(), &job.color_changes];
        Self { plate, styles, modifiers, hints, tower_room_mm: *tower_room_mm, widths_mm, stops }
    }
}

/// The rounds of a plate, in their order. None is without layers.
///
/// # Errors
/// Objects that cannot be printed one after the other; nothing to print.
pub(super) fn prepare(
    site: &Site<'_>,
    settings: &Settings,
    workers: Workers<'_>,
) -> Result<Vec<Round>, JobError> {
    let plate = site.plate;
    let bodies = bodies(plate);
    if settings.print.sequence == Sequence::Layer || bodies.len() < 2 {
        // The skirt goes around the tower, too, where that stands among the objects.
        let around: Vec<Polygon> =
            site.tower_room_mm.map(|[at, size]| rectangle(at, size)).into_iter().collect();
        let round = Round::new(site, (0..plate.objects.len()).collect(), settings, &around, workers)?;
        return round.map(|round| vec![round]).ok_or_else(|| load::nothing_to_print(site.hints));
    }
    let mut order = order(plate, bodies, settings)?.into_iter();
    let lowest = order.next().unwrap_or_default();
    // One skirt goes around all, before the first of them.
    let mut bare = settings.clone();
    bare.skirt.loops = 0;
    let mut later: Vec<Round> = Vec::new();
    for objects in order {
        later.extend(Round::new(site, objects, &bare, &[], workers)?);
    }
    let around: Vec<Polygon> =
        later.iter().flat_map(|round| round.sections.on_bed(&round.planners)).collect();
    let first = Round::new(site, lowest, settings, &around, workers)?;
    let mut rounds: Vec<Round> = first.into_iter().chain(later).collect();
    let (mut layers, mut top_mm) = (0, 0.0_f64);
    for round in &mut rounds {
        if layers > 0 {
            let highest_mm = top_mm.max(settings.bed.height.0);
            round.over_mm = (top_mm + PASS_MM).min(highest_mm) + settings.layer.z_offset.0;
        }
        round.first_layer = layers;
        layers += round.sections.layers.len();
        top_mm = top_mm.max(round.sections.layers.last().map_or(0.0, |layer| layer.span.top_mm));
    }
    if rounds.is_empty() { Err(load::nothing_to_print(site.hints)) } else { Ok(rounds) }
}

/// Whether nothing is printed where nothing may be.
///
/// # Errors
/// The first object of which something is.
pub(super) fn check_excluded(rounds: &[Round], plate: &Plate, settings: &Settings) -> Result<(), JobError> {
    let excluded = settings.bed.excluded();
    if excluded.is_empty() {
        return Ok(());
    }
    for sections in rounds.iter().map(|round| &round.sections) {
        for (local, &object) in sections.objects().iter().enumerate() {
            let areas = (0..sections.layers.len()).map(|layer| {
                (layer, geometry::intersection(sections.of(local, layer), &excluded).area_mm2())
            });
            let inside: Vec<(usize, f64)> = areas.filter(|(_, mm2)| *mm2 > 0.0).collect();
            if let Some(&(lowest, _)) = inside.first() {
                let area_mm2 = inside.iter().map(|(_, mm2)| *mm2).fold(0.0, f64::max);
                let object = plate.objects[object].name.clone();
                let z_mm = sections.layers[lowest].span.top_mm;
                return Err(FitError::Excluded { object, area_mm2, z_mm }.into());
            }
        }
    }
    Ok(())
}

fn rectangle(middle: [f64; 2], size: [f64; 2]) -> Polygon {
    let corner = |(x, y)| Point::from_mm(middle[0] + x * size[0] / 2.0, middle[1] + y * size[1] / 2.0);
    let outer = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(corner).to_vec();
    Polygon { outer, holes: Vec::new() }
}

/// What would need support, where none is laid.
pub(super) fn overhangs(rounds: &[Round]) -> Option<Overhangs> {
    rounds.iter().filter_map(|round| round.overhangs.clone()).reduce(|a, b| Overhangs {
        count: a.count + b.count,
        area_mm2: a.area_mm2 + b.area_mm2,
        lowest_mm: a.lowest_mm.into_iter().chain(b.lowest_mm).reduce(f64::min),
    })
}

impl Round {
    /// Cuts some objects and plans what they need; `None`: they have no layer. The skirt goes also around `around`.
    fn new(
        site: &Site<'_>,
        objects: Vec<usize>,
        settings: &Settings,
        around: &[Polygon],
        workers: Workers<'_>,
    ) -> Result<Option<Self>, JobError> {
        let own;
        let plate = if objects.len() == site.plate.objects.len() {
            site.plate
        } else {
            own = part(site.plate, &objects);
            &own
        };
        let name = (objects.len() < site.plate.objects.len()).then(|| names(site.plate, &objects));
        let styles = site.styles.of(&objects);
        let slicer = Slicer::new(plate, &load::layers(settings));
        let mut sections = Sections::cut(&slicer, objects, &styles, site.modifiers, settings, workers)?;
        let Some(bounds) = sections.bounds() else { return Ok(None) };
        let part = &sections.layers[sections.first_layer()..];
        let unsupported =
            || (!settings.support.enabled).then(|| supports::overhangs(part, bounds, settings, workers));
        let planners = || sections.planners(&styles, settings, around, workers);
        let (planners, overhangs) = parallel::join(planners, unsupported);
        sections.lay_supports(&planners.main, settings, workers);
        let top_mm = sections.layers.last().map_or(0.0, |layer| layer.span.top_mm);
        load::check_height(top_mm + settings.layer.z_offset.0, settings)?;
        Ok(Some(Self { sections, planners, overhangs, name, first_layer: 0, over_mm: 0.0 }))
    }

    /// The walls of a layer.
    pub fn walls(&self, layer: usize) -> Vec<LayerWalls> {
        self.sections.walls(&self.planners, layer)
    }

    /// All paths of a layer; `walls`: its walls, where they are known.
    pub fn paths(&self, layer: usize, walls: Option<&[LayerWalls]>, settings: &Settings) -> LayerPaths {
        let walls = walls.map_or_else(|| self.walls(layer), <[LayerWalls]>::to_vec);
        self.sections.paths(&self.planners, layer, walls, settings)
    }

    /// Whether the walls of another round are those of this one.
    pub fn has_walls_of(&self, other: &Self) -> bool {
        self.planners.has_walls_of(&other.planners) && self.sections.has_outlines_of(&other.sections)
    }
}

/// A plate with some of the objects.
fn part(plate: &Plate, objects: &[usize]) -> Plate {
    let mut part = Plate::default();
    for &object in objects {
        let object = &plate.objects[object];
        part.objects.push(Object { mesh: part.meshes.len(), ..object.clone() });
        part.meshes.push(plate.meshes[object.mesh].clone());
    }
    part
}

/// The objects of each body.
fn bodies(plate: &Plate) -> Vec<Vec<usize>> {
    let mut bodies: Vec<(usize, Vec<usize>)> = Vec::new();
    for (index, object) in plate.objects.iter().enumerate() {
        match bodies.iter_mut().find(|(body, _)| *body == object.body) {
            Some((_, objects)) => objects.push(index),
            None => bodies.push((object.body, vec![index])),
        }
    }
    bodies.into_iter().map(|(_, objects)| objects).collect()
}

/// What the objects of a body are called together.
fn names(plate: &Plate, objects: &[usize]) -> String {
    let names: Vec<&str> = objects.iter().map(|&object| plate.objects[object].name.as_str()).collect();
    names.join(" + ")
}

/// Bodies in the order in which they are printed.
///
/// # Errors
/// One that the gantry would strike while the next is printed.
fn order(plate: &Plate, bodies: Vec<Vec<usize>>, settings: &Settings) -> Result<Vec<Vec<usize>>, JobError> {
    let order = sorted(plate, bodies, settings);
    let limit_mm = settings.print.clearance_height.0;
    let raft_mm = f64::from(settings.raft.layers) * settings.layer.height.0;
    let struck = order.windows(2).find(|pair| height_mm(plate, &pair[0]) + raft_mm > limit_mm);
    match struck {
        None => Ok(order),
        Some(pair) => Err(JobError::DoesNotFit(FitError::Gantry {
            object: names(plate, &pair[0]),
            height_mm: height_mm(plate, &pair[0]) + raft_mm,
            next: names(plate, &pair[1]),
            limit_mm,
        })),
    }
}

/// In which turn each object of a plate is printed, counted from 0; `None`: all are printed together.
pub(crate) fn turns(plate: &Plate, settings: &Settings) -> Option<Vec<usize>> {
    let bodies = bodies(plate);
    if settings.print.sequence == Sequence::Layer || bodies.len() < 2 {
        return None;
    }
    let mut turns = vec![0; plate.objects.len()];
    for (turn, body) in sorted(plate, bodies, settings).iter().enumerate() {
        body.iter().for_each(|&object| turns[object] = turn);
    }
    Some(turns)
}

fn height_mm(plate: &Plate, body: &[usize]) -> f64 {
    let top_mm = |object: usize| plate.meshes[plate.objects[object].mesh].bounds()[1][2];
    body.iter().map(|&object| top_mm(object)).fold(0.0, f64::max)
}

/// From the lowest to the highest, so that the gantry has to pass over as little as possible; of equally high ones the
/// nearest comes next.
fn sorted(plate: &Plate, bodies: Vec<Vec<usize>>, settings: &Settings) -> Vec<Vec<usize>> {
    let offset = |body: &[usize]| body.first().map_or(Point::default(), |&first| plate.objects[first].offset);
    // Heights that differ by less than a layer are equal.
    let step = |body: &[usize]| (height_mm(plate, body) / settings.layer.height.0).round() as i64;
    let mut left = bodies;
    let mut order: Vec<Vec<usize>> = Vec::with_capacity(left.len());
    while !left.is_empty() {
        let at = order.last().map(|last| offset(last)).unwrap_or_default();
        let key = |(_, body): &(usize, &Vec<usize>)| {
            (step(body), offset(body).distance2(at), body.first().copied())
        };
        let next = left.iter().enumerate().min_by_key(key).map_or(0, |(index, _)| index);
        order.push(left.remove(next));
    }
    order
}
