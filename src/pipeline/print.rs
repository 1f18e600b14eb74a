//! One plate, from meshes to bytes.

use std::ops::Range;

use crate::estimate::{Machine, cool};
use crate::gcode::{self, Effect, LayerText, ObjectLabel, PrintFacts, Scripts, Slot, Totals, WriterSettings};
use crate::geom::{Bounds, Point};
use crate::job::{Job, JobError, Progress};
use crate::mesh::Plate;
use crate::motion::{self, Entry, MotionSettings};
use crate::order::{Chain, Pins, SeamRule, Sequence, Visit, chunk_len};
use crate::output::Output;
use crate::profile::{Settings, thumbnail_sizes};
use crate::report::{LayerSummary, Measures, Summary};
use crate::toolpath::LayerPaths;
use crate::units::{Mm3, Seconds};
use crate::view;

use super::inspect::Inspector;
use super::ordering::Certificate;
use super::rounds::{self, Round};
use super::{load, ordering, parallel, spiral};

/// Chunks of layers in flight for each thread: enough to keep all busy, few enough to bound the memory.
const CHUNKS_PER_THREAD: usize = 16;

/// Layers that are finished for each thread while those before them are checked.
const LAYERS_PER_THREAD: usize = 8;

/// Slices a plate.
pub(super) fn slice(
    job: &Job,
    settings: &Settings,
    output: &mut Output,
    progress: &dyn Progress,
) -> Result<Summary, JobError> {
    let settings = &*spiral::effective(settings);
    let mut loaded = load::plate(job, settings)?;
    let mut warnings = std::mem::take(&mut loaded.warnings);
    let rounds = rounds::prepare(&loaded, settings)?;
    let count = rounds.iter().map(|round| round.sections.layers.len()).sum();
    progress.begin(count);
    let Some(bounds) = rounds.iter().filter_map(|round| round.sections.bounds()).reduce(|a, b| a.joined(&b))
    else {
        return Err(load::nothing_to_print());
    };
    warnings.extend(rounds.iter().flat_map(|round| round.sections.warnings()));

    let facts = facts(&rounds, bounds, settings);
    let scripts = Scripts::new(settings, &facts).map_err(|mistakes| JobError::Script(mistakes.join("\n")))?;
    let labels = if settings.gcode.labels { labels(&loaded.plate, &rounds) } else { Vec::new() };
    let names = labels.iter().map(|label| label.name.clone()).collect();
    let run = Run {
        chain: ordering::chain(settings),
        motion: MotionSettings::new(settings, &job.pauses),
        machine: Machine::new(settings),
        writer: WriterSettings { objects: names, ..WriterSettings::new(settings, &scripts, true) },
        settings,
        certify: job.certify,
    };

    let mut opening = gcode::opening(settings, &facts, &scripts, true);
    opening.comment(&thumbnails(&loaded.plate, settings));
    let mut slots = opening.slots;
    let labels = gcode::labels(settings, &labels);
    let mut inspector = Inspector::new(settings, &opening.bytes);
    inspector.take(&labels);
    output.write(&opening.bytes)?;
    output.write(&labels)?;
    let begun = scripts.start_effect(settings, &run.machine);
    let mut ordered = Vec::new();
    let mut tally = Tally::default();
    tally.add_script(&begun, &run.machine);
    let (xy, z_mm) = (begun.end.map(|[x, y, _]| [x, y]), begun.end.map_or(0.0, |e| e[2]));
    let mut at = Entry { xy, z_mm, ..Entry::default() };
    let start = at.xy.map(|[x, y]| Point::from_mm(x, y));
    for round in &rounds {
        let count = round.sections.layers.len();
        let chunk = chunk_len(count);
        let batch = chunk * CHUNKS_PER_THREAD * parallel::threads();
        let mut seam = SeamRule::new(settings.seam.position);
        at.over_mm = round.over_mm;
        if let Some(name) = &round.name {
            let comment = gcode::object_comment(name);
            inspector.take(&comment);
            output.write(&comment)?;
        }
        let mut first = 0;
        while first < count {
            let layers = first..(first + batch).min(count);
            let (done, paths) = run.batch(round, layers.clone(), chunk, &mut seam, &mut at, &mut inspector);
            ordered.extend(paths);
            for done in done {
                let base = output.written() as usize;
                slots.extend(done.text.progress.map(|slot| Slot { offset: base + slot.offset, ..slot }));
                output.write(&done.text.bytes)?;
                tally.add(done.summary);
                progress.layer_done();
            }
            first = layers.end;
        }
    }
    if let Some([x, y]) = at.xy {
        tally.add_script(&scripts.end_effect(settings, &run.machine, [x, y, at.z_mm]), &run.machine);
    }
    let totals = tally.totals();
    let closing = gcode::closing(settings, &facts, &scripts, &totals);
    inspector.take(&closing);
    output.write(&closing)?;
    inspector.verdict()?;
    for slot in &slots {
        output.patch(slot.offset as u64, &totals.fill(slot, &settings.filament))?;
    }
    if job.certify {
        tally.certify(ordered, settings, start);
    }
    Ok(tally.summary(bounds, &facts, &totals, settings, warnings))
}

/// Pictures of the plate for the header.
fn thumbnails(plate: &Plate, settings: &Settings) -> String {
    // The profile has checked the sizes.
    let sizes = thumbnail_sizes(&settings.gcode.thumbnails).unwrap_or_default();
    let comments =
        parallel::map(sizes.len(), |i| view::thumbnail_comment(sizes[i], &view::thumbnail(plate, sizes[i])));
    comments.concat()
}

/// What printers that can cancel an object are told of each.
fn labels(plate: &Plate, rounds: &[Round]) -> Vec<ObjectLabel> {
    let mut hulls = vec![Vec::new(); plate.objects.len()];
    for (object, hull) in rounds.iter().flat_map(|round| round.sections.hulls()) {
        hulls[object] = hull;
    }
    ObjectLabel::all(plate.objects.iter().map(|object| object.name.clone()).zip(hulls))
}

fn facts(rounds: &[Round], bounds: Bounds, settings: &Settings) -> PrintFacts {
    let tops = rounds.iter().filter_map(|round| Some(round.sections.layers.last()?.span.top_mm));
    PrintFacts {
        layers: rounds.iter().map(|round| round.sections.layers.len()).sum(),
        min_mm: bounds.min.mm(),
        max_mm: bounds.max.mm(),
        max_z_mm: tops.fold(0.0, f64::max) + settings.layer.z_offset.0,
        dated: load::dated(),
    }
}

/// Everything that layers are made with.
struct Run<'a> {
    chain: Chain,
    motion: MotionSettings,
    machine: Machine,
    writer: WriterSettings,
    settings: &'a Settings,
    /// Whether lower bounds are wanted.
    certify: bool,
}

/// What was ordered, kept for the certificate.
struct Ordered {
    layer: (LayerPaths, Pins),
    start: Option<Point>,
}

/// A finished layer.
struct Done {
    text: LayerText,
    summary: LayerSummary,
}

impl Run<'_> {
    /// Takes a batch of layers through all stages. `seam` and `at` hold what the layers below left.
    /// Returns their bytes and, if they are to be certified, what was ordered and where each was entered from.
    fn batch(
        &self,
        round: &Round,
        layers: Range<usize>,
        chunk: usize,
        seam: &mut SeamRule,
        at: &mut Entry,
        inspector: &mut Inspector,
    ) -> (Vec<Done>, Vec<Ordered>) {
        let first = layers.start;
        let paths =
            parallel::map(layers.len(), |i| round.sections.paths(&round.planners, first + i, self.settings));
        let pins: Vec<Pins> = paths.iter().map(|layer| seam.pins(layer)).collect();
        let start = at.xy.map(|[x, y]| Point::from_mm(x, y));
        let mut sequences = ordering::solve(&self.chain, &paths, &pins, chunk, start).sequences;
        // A turn is drawn upwards.
        for (sequence, _) in sequences.iter_mut().zip(&paths).filter(|(_, layer)| !layer.rises.is_empty()) {
            *sequence = vec![Visit { item: 0, entry: 0 }];
        }
        let entries: Vec<Entry> = paths
            .iter()
            .zip(&sequences)
            .map(|(layer, sequence)| {
                let next = motion::exit(layer, sequence, at.clone(), &self.motion);
                std::mem::replace(at, next)
            })
            .collect();
        let done = self.finish_all(&paths, &sequences, &entries, round.first_layer, inspector);
        if !self.certify {
            return (done, Vec::new());
        }
        let starts = entries.iter().map(|entry| entry.xy.map(|[x, y]| Point::from_mm(x, y)));
        let ordered = paths.into_iter().zip(pins).zip(starts);
        (done, ordered.map(|(layer, start)| Ordered { layer, start }).collect())
    }

    /// Finishes layers, and checks those that are finished meanwhile.
    fn finish_all(
        &self,
        paths: &[LayerPaths],
        sequences: &[Sequence],
        entries: &[Entry],
        before: usize,
        inspector: &mut Inspector,
    ) -> Vec<Done> {
        let mut done: Vec<Done> = Vec::with_capacity(paths.len());
        let mut unchecked = 0;
        let mut inspect = |layers: &[Done]| layers.iter().for_each(|layer| inspector.take(&layer.text.bytes));
        while done.len() < paths.len() {
            let first = done.len();
            // Fewer towards the end, so that few are left to be checked while nothing else is done.
            let left = paths.len() - first;
            let count = (LAYERS_PER_THREAD * parallel::threads()).min(left.div_ceil(2));
            let layer = |i: usize| self.finish(&paths[i], &sequences[i], entries[i].clone(), before);
            let finish = || parallel::map(count, |i| layer(first + i));
            let (more, ()) = parallel::join(finish, || inspect(&done[unchecked..]));
            unchecked = first;
            done.extend(more);
        }
        inspect(&done[unchecked..]);
        done
    }

    /// Motion, cooling and formatting of one layer, numbered after those of the rounds before.
    fn finish(&self, paths: &LayerPaths, sequence: &Sequence, from: Entry, before: usize) -> Done {
        let mut moves = motion::plan_layer(paths, sequence, from, &self.motion);
        moves.index += before;
        let time = cool(&mut moves, &self.settings.cooling, &self.machine);
        let sums = moves.sums();
        let measures = Measures {
            print_mm: sums.print.0,
            travel_mm: sums.travel.0,
            total_mm: sums.print.0 + sums.travel.0,
            link_mm: sums.link.0,
            travels: sums.travels,
            retractions: sums.retractions,
            total_s: time.total().0,
            volume_mm3: sums.volume.0,
            filament_mm: sums.volume.0 / self.machine.filament_area_mm2,
            ..Measures::default()
        };
        Done {
            text: gcode::format_layer(&moves, &self.writer),
            summary: LayerSummary { z_mm: (moves.z_mm * 1e6).round() / 1e6, measures },
        }
    }
}

/// What has been written so far.
#[derive(Default)]
struct Tally {
    layers: Vec<LayerSummary>,
    total: Measures,
    layer_starts: Vec<Seconds>,
}

impl Tally {
    fn add(&mut self, layer: LayerSummary) {
        self.layer_starts.push(Seconds(self.total.total_s));
        self.total += &layer.measures;
        self.layers.push(layer);
    }

    /// What a script does belongs to the whole, but to no layer.
    fn add_script(&mut self, effect: &Effect, machine: &Machine) {
        self.total += &Measures::of(&effect.measure, effect.time, machine.filament_area_mm2);
    }

    /// Adds the lower bounds of all layers, and of the whole.
    fn certify(&mut self, ordered: Vec<Ordered>, settings: &Settings, start: Option<Point>) {
        let (layers, starts): (Vec<_>, Vec<_>) =
            ordered.into_iter().map(|ordered| (ordered.layer, ordered.start)).unzip();
        let certificate = Certificate::new(&layers, settings, start);
        for (i, (layer, start)) in self.layers.iter_mut().zip(starts).enumerate() {
            let measures = std::mem::take(&mut layer.measures);
            layer.measures = measures.with_bound(certificate.layer_mm(i, start));
        }
        self.total = std::mem::take(&mut self.total).with_bound(certificate.print_mm());
    }

    fn totals(&self) -> Totals {
        Totals {
            time: Seconds(self.total.total_s),
            volume: Mm3(self.total.volume_mm3),
            layer_starts: self.layer_starts.clone(),
        }
    }

    fn summary(
        self,
        bounds: Bounds,
        facts: &PrintFacts,
        totals: &Totals,
        settings: &Settings,
        warnings: Vec<String>,
    ) -> Summary {
        let ([x0, y0], [x1, y1]) = (bounds.min.mm(), bounds.max.mm());
        let filament_g = totals.volume.0 / 1000.0 * settings.filament.density;
        Summary {
            size_mm: [x1 - x0, y1 - y0, facts.max_z_mm - settings.layer.z_offset.0],
            layer_count: self.layers.len(),
            total: self.total,
            filament_g,
            filament_cost: filament_g / 1000.0 * settings.filament.cost,
            warnings,
            layers: self.layers,
            ..Summary::default()
        }
    }
}
