//! One plate, from meshes to bytes.

use std::collections::BTreeSet;

use crate::estimate::{Machine, cool, move_times_s};
use crate::gcode::{
    self, GcodeOptions, ObjectLabel, PrintFacts, ThumbnailFormat, WriterSettings, thumbnail_list,
};
use crate::job::{Job, JobError};
use crate::motion::{self, Entry, MotionSettings};
use crate::order::{Chain, PathVisit, Pins, SeamRule, chunk_len};
use crate::output::Output;
use crate::parallel::{self, Workers};
use crate::plan::floating::{Floating, Islands};
use crate::plan::sections::hull_mm;
use crate::plan::spiral;
use crate::plate::{Model, Plate};
use crate::profile::{ScriptRun, Settings, WholePrint};
use crate::report::{LayerSummary, Measures, Overhangs, Summary};
use crate::toolpath::{LayerKind, LayerPaths};
use crate::view;
use geometry::{Bounds, Point};

use super::finished::{FinishedLayer, LayerEntry, Timeline};
use super::inspect::Inspector;
use super::kept::PrintLayer;
use super::ordering::{Layers, Sequencer};
use super::preheat::Preheater;
use super::rounds::{self, Round, Site};
use super::staged::{self, Live, Watched};
use super::statistics::{Ordered, Statistics};
use super::tools::Tooled;
use super::writer::{OnMoves, PrintWriter, script_error};
use super::{load, ordering};

/// What a run gives beside the G-code.
#[derive(Default)]
pub(super) struct Besides<'a> {
    /// The finished layers are added here.
    pub kept: Option<&'a mut Vec<PrintLayer>>,
    /// Their moves alone are handed on, from the bed up, which costs nothing.
    pub moves: Option<Box<OnMoves<'a>>>,
    /// The run is followed stage by stage.
    pub live: Option<Live<'a>>,
}

/// Slices a plate.
pub(super) fn slice(
    models: Vec<Model>,
    job: &Job,
    settings: &Settings,
    output: &mut Output,
    besides: Besides<'_>,
    workers: Workers<'_>,
) -> Result<Summary, JobError> {
    let Besides { kept, moves, live } = besides;
    let settings = &*spiral::effective(settings);
    let mut loaded = load::place(models, job, settings)?;
    let settings = &*settings.with_widths_of_objects();
    let mut warnings = std::mem::take(&mut loaded.warnings);
    let pictures = || thumbnails(&loaded.plate, settings, workers);
    let site = Site::of(&loaded, job);
    let hints = loaded.hints.clone();
    let staged = match live {
        Some(mut live) => live.prepare(&site, pictures, settings, workers),
        None => staged::prepare(&site, pictures, settings, workers),
    };
    let staged = staged.map_err(|error| error.hinting(&hints))?;
    let (rounds, pictures) = (staged.rounds.as_slice(), &staged.pictures);
    let Some(bounds) = rounds.iter().filter_map(|round| round.sections.bounds()).reduce(|a, b| a.joined(&b))
    else {
        return Err(load::nothing_to_print(&loaded.hints));
    };
    rounds::check_excluded(rounds, &loaded.plate, settings)?;
    warnings.extend(rounds.iter().flat_map(|round| round.sections.warnings()));
    let overhangs = rounds::overhangs(rounds);

    let tooled = Tooled::plan(rounds, &|round, layer| staged.walls(round, layer), &site, settings, workers)?;
    warnings.extend(tooled.iter().filter_map(|tooled| tooled.warning.clone()));
    // All that is asked of the meshes has been.
    loaded.plate.meshes.clear();
    let counts = rounds.iter().enumerate().map(|(number, round)| {
        tooled.as_ref().map_or(round.sections.layers.len(), |tooled| tooled.count(number))
    });
    let counts: Vec<usize> = counts.collect();
    workers.observer.begin(counts.iter().sum());
    let facts = facts(rounds, tooled.as_ref(), &loaded.plate, bounds, job, settings);
    let options = GcodeOptions::beginning_with(settings, facts.tools.first);
    let mut run = ScriptRun::new(settings, &facts);
    let mut scripts = run.open().map_err(script_error)?;
    let labels =
        if settings.gcode.labels_objects() { labels(&loaded.plate, rounds, workers) } else { Vec::new() };
    let names = labels.iter().map(|label| label.name.clone()).collect();
    let mut tools = MotionSettings::new(settings, &job.pauses).tools;
    for (own, left_mm) in tools.iter_mut().zip(&scripts.retracted_mm) {
        own.left_back_mm = if own.retract.firmware { 0.0 } else { *left_mm };
    }
    let maker = LayerMaker {
        chain: Chain {
            detours: settings.detour_rule(),
            corners: settings.corners(),
            ..ordering::chain(settings)
        },
        motion: MotionSettings {
            heat_first_layer: settings.gcode.heat && scripts.heat_by_name(),
            color_changes: job.color_changes.clone(),
            tools,
            ..MotionSettings::new(settings, &job.pauses)
        },
        machine: options.machine,
        writer: WriterSettings { objects: names, ..WriterSettings::new(settings, &scripts, true) },
        settings,
        certify: job.certify,
        keep: kept.is_some(),
        workers,
    };

    let mut header = gcode::header(&options, &facts, &scripts, true);
    header.comment(&pictures[0], &pictures[1]);
    let labels = gcode::labels(&options, &labels);
    let inspector = Inspector::new(settings, &header.bytes);
    let mut writer = PrintWriter {
        output,
        inspector,
        slots: header.slots,
        statistics: Statistics::default(),
        kept,
        moves,
        scripts: run,
        settings,
        machine: options.machine,
        workers,
        preheater: Preheater::new(&maker.motion, &settings.tool_change.script),
    };
    writer.output.write(&header.bytes)?;
    writer.write(&labels)?;
    let begun = scripts.start_effect(&options);
    let mut ordered = Vec::new();
    let mut floating_warnings = Vec::new();
    writer.statistics.add_script(&begun, &maker.machine);
    let (xy, z_mm) = (begun.end.map(|[x, y, _]| [x, y]), begun.end.map_or(0.0, |e| e[2]));
    let start = xy.map(|[x, y]| Point::from_mm(x, y));
    let firmware = settings.retract.firmware;
    let tool = facts.tools.first;
    let left_mm = scripts.retracted_mm.get(usize::from(tool)).copied().unwrap_or(0.0);
    let retracted_mm = if firmware { 0.0 } else { left_mm };
    let mut at = Entry { xy, z_mm, retracted_mm, tool, ..Entry::default() };
    for (finished, round) in rounds.iter().enumerate() {
        at.over_mm = round.over_mm;
        writer.between_objects(finished)?;
        if let Some(name) = &round.name {
            writer.write(&gcode::object_comment(name))?;
        }
        let names = round.sections.objects().iter().map(|&o| loaded.plate.objects[o].name.clone()).collect();
        let layout = settings.plate.keep_layout && loaded.plate.objects.iter().any(|object| object.body > 0);
        let mut floating = Floating::new(&round.sections, names, layout, job.allow_floating);
        let walls = |layer: usize| staged.walls(finished, layer);
        let paths = |part: usize| match &tooled {
            Some(tooled) => tooled.paths(finished, part),
            None => round.paths(part, walls(part), settings),
        };
        let parts = Parts {
            round,
            count: counts[finished],
            paths: &paths,
            whole: tooled.as_ref().map(|tooled| tooled.layers[finished].as_slice()),
        };
        let done = maker.round(&parts, &mut at, &mut floating, &mut writer);
        ordered.extend(done.map_err(|error| error.hinting(&hints))?);
        floating.finish(&loaded.hints)?;
        floating_warnings.append(&mut floating.warnings);
    }
    let PrintWriter { output, mut inspector, slots, mut statistics, scripts: mut run, .. } = writer;
    run.moment.extruded_mm3 = statistics.layers_mm3;
    run.moment.totals =
        Some(WholePrint { time_s: statistics.total.total_s, volume_mm3: statistics.total.volume_mm3 });
    run.close(&mut scripts).map_err(script_error)?;
    if let Some([x, y]) = at.xy {
        statistics.add_script(&scripts.end_effect(&options, [x, y, at.z_mm]), &maker.machine);
    }
    let totals = statistics.totals(settings, facts.tools.first);
    let footer = gcode::footer(&options, &facts, &scripts, &totals);
    inspector.take(&footer);
    output.write(&footer)?;
    inspector.verdict()?;
    for slot in &slots {
        output.patch(slot.offset as u64, &totals.fill(slot, &settings.filament))?;
    }
    if job.certify {
        statistics.certify(ordered, settings, start, workers);
    }
    warnings.extend(floating_warnings);
    let islands = rounds.iter().map(|round| Islands::find(&round.sections, settings, workers));
    warnings.extend(islands.filter_map(|islands| islands.warning()));
    warnings.extend(overhangs.as_ref().and_then(Overhangs::warning));
    let repairs = loaded.repairs;
    warnings.extend(repairs.iter().map(ToString::to_string));
    run.moment.totals = Some(WholePrint { time_s: totals.time.0, volume_mm3: totals.volume.0 });
    let file_name = match settings.gcode.file_name.trim() {
        "" => None,
        name => Some(run.text(name).map_err(|e| script_error(vec![format!("gcode.file_name: {e}")]))?),
    };
    let summary = statistics.summary(bounds, &facts, &totals, settings, warnings);
    // There is much to give back.
    parallel::aside(move || drop(staged));
    Ok(Summary { repairs, overhangs, file_name, ..summary })
}

/// Pictures of the plate for the header: those that must come before anything else, and the others.
fn thumbnails(plate: &Plate, settings: &Settings, workers: Workers<'_>) -> [String; 2] {
    // The profile has checked the list.
    let specs = thumbnail_list(&settings.gcode.thumbnails).unwrap_or_default();
    let comments = workers.map(specs.len(), |i| {
        let is_first = specs[..i].iter().all(|before| before.format != specs[i].format);
        view::thumbnail_comment(&Watched(plate, workers), specs[i], is_first)
    });
    let [mut first, mut others] = [String::new(), String::new()];
    for (spec, comment) in specs.iter().zip(comments) {
        match spec.format {
            ThumbnailFormat::BttTft => first += &comment,
            _ => others += &comment,
        }
    }
    if !first.is_empty() {
        first += view::BTT_TFT_END;
    }
    [first, others]
}

/// Labels of the objects, for printers that can cancel single objects.
fn labels(plate: &Plate, rounds: &[Round], workers: Workers<'_>) -> Vec<ObjectLabel> {
    let mut hulls = vec![Vec::new(); plate.objects.len()];
    for (object, hull) in rounds.iter().flat_map(|round| round.sections.hulls(workers)) {
        hulls[object] = hull;
    }
    ObjectLabel::all(plate.objects.iter().map(|object| object.name.clone()).zip(hulls))
}

fn facts(
    rounds: &[Round],
    tooled: Option<&Tooled>,
    plate: &Plate,
    bounds: Bounds,
    job: &Job,
    settings: &Settings,
) -> PrintFacts {
    let tops = rounds.iter().filter_map(|round| Some(round.sections.layers.last()?.span.top_mm));
    // The layer is as large as the part: its elephant's foot is made up for.
    let foot_mm = if settings.raft.layers > 0 { 0.0 } else { settings.layer.elephant_foot.0 };
    let outlines = rounds.iter().map(|round| round.sections.first_layer_outlines(&round.planners, foot_mm));
    let covered = tooled.iter().flat_map(|tooled| &tooled.covered);
    let covered: Vec<Vec<[f64; 2]>> =
        covered.map(|polygon| polygon.outer.iter().map(|p| p.mm()).collect()).collect();
    let bodies: BTreeSet<usize> = plate.objects.iter().map(|object| object.body).collect();
    let meshes: BTreeSet<usize> = plate.objects.iter().map(|object| object.mesh).collect();
    let input_name = job.models.first().and_then(|model| model.path().file_stem());
    PrintFacts {
        layers: rounds.iter().map(|round| round.sections.layers.len()).sum(),
        min_mm: bounds.min.mm(),
        max_mm: bounds.max.mm(),
        max_z_mm: tops.fold(0.0, f64::max) + settings.layer.z_offset.0,
        dated: job.dated.unwrap_or(load::DATED),
        first_layer_hull_mm: hull_mm(outlines.flatten().chain(covered).flatten(), 0.0),
        tools: tooled.map(Tooled::facts).unwrap_or_default(),
        objects: meshes.len(),
        instances: bodies.len(),
        input_name: input_name.map(|name| name.to_string_lossy().into_owned()).unwrap_or_default(),
    }
}

/// What of a round is printed one after the other: its layers, or parts of them where tools print several at once.
struct Parts<'a> {
    round: &'a Round,
    count: usize,
    paths: &'a (dyn Fn(usize) -> LayerPaths + Sync),
    /// The layers, where they are known already.
    whole: Option<&'a [LayerPaths]>,
}

/// Makes layers: everything that does not change from layer to layer.
struct LayerMaker<'a> {
    chain: Chain,
    motion: MotionSettings,
    machine: Machine,
    writer: WriterSettings,
    settings: &'a Settings,
    /// Whether lower bounds are wanted.
    certify: bool,
    /// Whether finished layers are kept.
    keep: bool,
    workers: Workers<'a>,
}

/// What ordering carries from layer to layer: the seam rule, the sequencer and where the nozzle is.
struct OrderState<'a> {
    seam: SeamRule,
    sequencer: Sequencer<'a>,
    at: &'a mut Entry,
}

/// Layers per thread that are finished before they are written: few, as their moves are in memory until then.
const PART: usize = 2;

/// Layers whose order is known.
#[derive(Default)]
struct Batch {
    layers: Layers,
    /// Where each is entered from.
    entries: Vec<Entry>,
}

impl Batch {
    /// `before`: layers of the rounds before.
    fn into_ordered(self, before: usize) -> impl Iterator<Item = Ordered> {
        let starts = self.entries.into_iter().map(|entry| entry.xy.map(|[x, y]| Point::from_mm(x, y)));
        let layers = self.layers.paths.into_iter().zip(self.layers.pins);
        let ordered = layers.zip(self.layers.sequences).zip(starts);
        ordered.map(move |((layer, order), start)| Ordered {
            index: before + layer.0.index,
            layer,
            order,
            start,
        })
    }
}

impl LayerMaker<'_> {
    /// Takes the layers of a round through all stages, batch by batch: while one is ordered, the next is planned, and the
    /// one before gets its moves, is checked and written. Returns, if they are to be certified, what was ordered and
    /// where each layer was entered from.
    fn round(
        &self,
        parts: &Parts<'_>,
        at: &mut Entry,
        floating: &mut Floating<'_>,
        writer: &mut PrintWriter<'_>,
    ) -> Result<Vec<Ordered>, JobError> {
        let &Parts { round, count, paths, whole } = parts;
        whole.into_iter().flatten().try_for_each(|layer| floating.take(layer))?;
        let chunk = chunk_len(count);
        // As short as keeps all threads busy: there is nothing to do beside the first and the last batch.
        let workers = self.workers;
        let length = chunk * parallel::threads();
        let plan = |first: usize| {
            let layers = length.min(count.saturating_sub(first));
            workers.map(layers, |i| paths(first + i))
        };
        let sequencer = Sequencer::new(&self.chain, workers, chunk, at.xy.map(|[x, y]| Point::from_mm(x, y)));
        let mut state = OrderState { seam: SeamRule::new(self.settings.seam.position), sequencer, at };
        let (mut planned, mut batch, mut kept) = (plan(0), Batch::default(), Vec::new());
        for step in 1..=count.div_ceil(length) {
            if whole.is_none() {
                planned.iter().try_for_each(|layer| floating.take(layer))?;
            }
            let order = || self.order(planned, step * length >= count, &mut state);
            let write = || self.write(&batch, round, writer);
            // What cannot be divided comes first.
            let beside = || parallel::join(write, || plan(step * length));
            let (ordered, (written, next)) = parallel::join(order, beside);
            written?;
            if self.certify {
                kept.extend(batch.into_ordered(round.first_layer));
            }
            (planned, batch) = (next, ordered);
        }
        self.write(&batch, round, writer)?;
        if self.certify {
            kept.extend(batch.into_ordered(round.first_layer));
        }
        writer.finish()?;
        Ok(kept)
    }

    /// Finishes the layers of a batch and writes them, part by part: while one is written, the next is finished.
    fn write(&self, batch: &Batch, round: &Round, writer: &mut PrintWriter<'_>) -> Result<(), JobError> {
        let count = batch.entries.len();
        let length = PART * parallel::threads();
        let mut done = Vec::new();
        for first in (0..count).step_by(length) {
            let layers = length.min(count - first);
            let finish = || self.workers.map(layers, |i| self.finish(batch, first + i, round.first_layer));
            let (written, finished) = parallel::join(|| writer.add(done), finish);
            written?;
            done = finished;
        }
        writer.add(done)
    }

    /// Orders layers; the last one waits until the layer above it is known.
    fn order(&self, paths: Vec<LayerPaths>, last: bool, state: &mut OrderState<'_>) -> Batch {
        let pins: Vec<Pins> = paths.iter().map(|layer| state.seam.pins(layer)).collect();
        let mut layers = state.sequencer.take(paths, pins, last);
        // A revolution of the spiral is drawn upwards.
        for (sequence, layer) in layers.sequences.iter_mut().zip(&layers.paths) {
            if matches!(layer.kind, LayerKind::Spiral(_)) {
                *sequence = vec![PathVisit { path: 0, entry: 0 }];
            }
        }
        let entries = layers
            .paths
            .iter()
            .zip(&layers.sequences)
            .map(|(layer, sequence)| {
                let next = motion::exit(layer, sequence, state.at.clone(), &self.motion);
                std::mem::replace(state.at, next)
            })
            .collect();
        Batch { layers, entries }
    }

    /// Motion, cooling and formatting of one layer of a batch, numbered after those of the rounds before.
    fn finish(&self, batch: &Batch, i: usize, before: usize) -> FinishedLayer {
        let (paths, sequence) = (&batch.layers.paths[i], &batch.layers.sequences[i]);
        let from = batch.entries[i].clone();
        let mut moves = motion::plan_layer(paths, sequence, from, &self.motion);
        moves.index += before;
        let time = cool(&mut moves, paths.turn.elsewhere, &self.settings.cooling, &self.machine);
        motion::set_fan(&mut moves, time.total(), &self.motion);
        let cools = self.motion.cool_down();
        let timeline = cools.then(|| Timeline::new(&moves, &move_times_s(&moves, &self.machine)));
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
        let [x, y] = moves.from.xy.unwrap_or_default();
        let position_mm = [x, y, moves.from.z_mm];
        let entry = LayerEntry { index: moves.index, z_mm: moves.z_mm, position_mm };
        let tools = moves.by_tool(self.settings.tool_list().len());
        let text = gcode::format_layer(&moves, &self.writer);
        let (layer, moves) = match self.keep {
            true => (Some(PrintLayer::new(paths, sequence, moves, &self.machine)), None),
            false => (None, Some(moves)),
        };
        FinishedLayer {
            summary: LayerSummary { z_mm: (entry.z_mm * 1e6).round() / 1e6, measures },
            entry,
            text,
            tools,
            layer,
            moves,
            timeline,
        }
    }
}
