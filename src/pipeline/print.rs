//! One plate, from meshes to bytes.

use std::collections::BTreeSet;
use std::ops::Range;

use crate::estimate::{Machine, cool, move_times_s};
use crate::gcode::{
    self, Effect, GcodeOptions, LayerText, ObjectLabel, PrintFacts, Slot, Totals, WriterSettings,
};
use crate::gcode::{ThumbnailFormat, thumbnail_list};
use crate::job::{Job, JobError};
use crate::motion::{self, Entry, LayerMoves, MotionSettings, ToolChange, ToolSums};
use crate::order::compare::Proved;
use crate::order::{Chain, PathOrder, PathVisit, Pins, SeamRule, chunk_len, ends_on_path};
use crate::output::Output;
use crate::parallel::{self, Workers};
use crate::plan::floating::{Floating, Islands};
use crate::plan::sections::hull_mm;
use crate::plan::spiral;
use crate::plate::{Model, Plate};
use crate::profile::{FilamentSettings, ScriptRun, Settings, WholePrint};
use crate::report::{LayerSummary, Measures, Overhangs, Summary, ToolSummary};
use crate::toolpath::{LayerKind, LayerPaths, ToolId};
use crate::units::{Mm3, Seconds};
use crate::view;
use geometry::{Bounds, Point};

use super::inspect::Inspector;
use super::kept::PrintLayer;
use super::ordering::{Certificate, Layers, Sequencer};
use super::rounds::{self, Round, Site};
use super::staged::{self, Live, Watched};
use super::tools::Tooled;
use super::{load, ordering};

/// Takes the moves of a finished layer.
pub(super) type OnMoves<'a> = dyn FnMut(LayerMoves) + Send + 'a;

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
    let mut warnings = std::mem::take(&mut loaded.warnings);
    let pictures = || thumbnails(&loaded.plate, settings, workers);
    let site = Site::of(&loaded);
    let hints = loaded.hints.clone();
    let staged = match live {
        Some(mut live) => live.prepare(&site, pictures, settings, workers),
        None => staged::prepare(&site, pictures, settings, workers),
    };
    let staged = staged.map_err(|error| error.hinting(&hints))?;
    let (rounds, pictures) = (staged.rounds.as_slice(), &staged.pictures);
    let count = rounds.iter().map(|round| round.sections.layers.len()).sum();
    workers.observer.begin(count);
    let Some(bounds) = rounds.iter().filter_map(|round| round.sections.bounds()).reduce(|a, b| a.joined(&b))
    else {
        return Err(load::nothing_to_print(&loaded.hints));
    };
    warnings.extend(rounds.iter().flat_map(|round| round.sections.warnings()));
    let overhangs = (!settings.support.enabled).then(|| rounds::overhangs(rounds, settings, workers));

    let tooled = Tooled::plan(rounds, &|round, layer| staged.walls(round, layer), settings, workers)?;
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
        keep_moves: moves.is_some(),
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
        workers,
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
        let tooled = tooled.as_ref().map(|tooled| tooled.layers[finished].as_slice());
        let paths = |layer: usize| match tooled {
            Some(layers) => layers[layer].clone(),
            None => round.paths(layer, walls(layer), settings),
        };
        let done = maker.round((round, &paths), &mut at, &mut floating, &mut writer);
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
    Ok(Summary { repairs, overhangs, file_name, ..summary })
}

fn script_error(mistakes: Vec<String>) -> JobError {
    JobError::Script { mistakes }
}

fn of_script(key: &str, mistake: &macros::Error) -> JobError {
    script_error(vec![format!("{key}: {mistake}")])
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
    let tower = tooled.and_then(|tooled| tooled.tower.as_ref());
    let tower: Vec<Vec<[f64; 2]>> =
        tower.map(|tower| tower.outer.iter().map(|p| p.mm()).collect()).into_iter().collect();
    let bodies: BTreeSet<usize> = plate.objects.iter().map(|object| object.body).collect();
    let meshes: BTreeSet<usize> = plate.objects.iter().map(|object| object.mesh).collect();
    let input_name = job.models.first().and_then(|model| model.path().file_stem());
    PrintFacts {
        layers: rounds.iter().map(|round| round.sections.layers.len()).sum(),
        min_mm: bounds.min.mm(),
        max_mm: bounds.max.mm(),
        max_z_mm: tops.fold(0.0, f64::max) + settings.layer.z_offset.0,
        dated: job.dated.unwrap_or(load::DATED),
        first_layer_hull_mm: hull_mm(outlines.flatten().chain(tower).flatten(), 0.0),
        tools: tooled.map(Tooled::facts).unwrap_or_default(),
        objects: meshes.len(),
        instances: bodies.len(),
        input_name: input_name.map(|name| name.to_string_lossy().into_owned()).unwrap_or_default(),
    }
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
    /// Whether their moves are.
    keep_moves: bool,
    workers: Workers<'a>,
}

/// The ordered layers, kept for the certificate.
struct Ordered {
    layer: (LayerPaths, Pins),
    order: PathOrder,
    start: Option<Point>,
}

/// A finished layer.
struct FinishedLayer {
    text: LayerText,
    summary: LayerSummary,
    tools: Vec<ToolSums>,
    layer: Option<PrintLayer>,
    moves: Option<LayerMoves>,
    entry: LayerEntry,
}

/// Where a layer begins.
struct LayerEntry {
    index: usize,
    /// Height of the nozzle, Z offset included.
    z_mm: f64,
    position_mm: [f64; 3],
}

/// What is put into the text of a layer.
#[derive(Clone, Copy)]
enum Spliced<'a> {
    /// A script, with its key.
    Script(&'a str, &'a str),
    /// What is run at a change of tool.
    Change(ToolChange),
}

/// Writes finished layers, checks the text and adds up the statistics.
struct PrintWriter<'a> {
    output: &'a mut Output,
    inspector: Inspector,
    /// What is known at the end only.
    slots: Vec<Slot>,
    statistics: Statistics,
    kept: Option<&'a mut Vec<PrintLayer>>,
    moves: Option<Box<OnMoves<'a>>>,
    scripts: ScriptRun<'a>,
    settings: &'a Settings,
    workers: Workers<'a>,
}

impl PrintWriter<'_> {
    /// Writes the script between objects that are printed one after the other.
    fn between_objects(&mut self, finished: usize) -> Result<(), JobError> {
        self.scripts.moment.objects_done = finished;
        if finished > 0 {
            let script = &self.settings.gcode.between_objects;
            let text = self.scripts.expand(script).map_err(|e| of_script("gcode.between_objects", &e))?;
            self.output.write(text.as_bytes())?;
        }
        Ok(())
    }

    /// The text of a layer with the scripts of its change.
    fn with_scripts(&mut self, layer: &LayerText, entry: &LayerEntry) -> Result<Option<Vec<u8>>, JobError> {
        let options = &self.settings.gcode;
        let moment = &mut self.scripts.moment;
        moment.layer = Some(entry.index);
        moment.layer_z_mm = entry.z_mm - self.settings.layer.z_offset.0;
        moment.max_z_mm = moment.max_z_mm.max(moment.layer_z_mm);
        moment.extruded_mm3 = self.statistics.layers_mm3;
        moment.by_tool_mm3.clone_from(&self.statistics.tools_mm3);
        moment.position_mm = entry.position_mm;
        let layer_places = [
            (layer.before, "gcode.before_layer", &options.before_layer),
            (layer.after, "gcode.after_layer", &options.after_layer),
        ];
        let places = layer_places.into_iter().filter_map(|(place, key, script)| {
            place.map(|place| (place..place, Spliced::Script(key, script)))
        });
        let changes = layer.changes.iter().map(|mark| (mark.line.clone(), Spliced::Change(mark.change)));
        let mut places: Vec<(Range<usize>, Spliced<'_>)> = places.chain(changes).collect();
        if places.is_empty() {
            return Ok(None);
        }
        // A script of the layer comes before a change at the same place.
        places.sort_by_key(|(place, _)| place.start);
        let (mut text, mut from) = (Vec::with_capacity(layer.bytes.len() + 256), 0);
        for (place, spliced) in places {
            text.extend_from_slice(&layer.bytes[from..place.start]);
            let script = match spliced {
                Spliced::Script(key, script) => {
                    self.scripts.expand(script).map_err(|e| of_script(key, &e))?
                }
                Spliced::Change(change) => {
                    self.scripts.moment.position_mm = change.at_mm;
                    self.scripts.change(change.to.into()).map_err(|mistake| script_error(vec![mistake]))?
                }
            };
            text.extend_from_slice(script.as_bytes());
            from = place.end;
        }
        text.extend_from_slice(&layer.bytes[from..]);
        Ok(Some(text))
    }

    /// Writes text, checking it.
    fn write(&mut self, text: &[u8]) -> Result<(), JobError> {
        self.inspector.take(text);
        Ok(self.output.write(text)?)
    }

    /// Writes layers, checking them.
    fn add(&mut self, layers: Vec<FinishedLayer>) -> Result<(), JobError> {
        for FinishedLayer { text, summary, layer, moves, entry, tools } in layers {
            self.workers.go_on();
            let base = self.output.written() as usize;
            self.slots.extend(text.progress.map(|slot| Slot { offset: base + slot.offset, ..slot }));
            let with_scripts = self.with_scripts(&text, &entry)?;
            // What a script does is its own affair, and undone after it.
            self.inspector.take(&text.bytes);
            self.output.write(with_scripts.as_ref().unwrap_or(&text.bytes))?;
            self.statistics.add(summary, &tools);
            if let Some(kept) = &mut self.kept {
                kept.extend(layer);
            }
            if let (Some(tell), Some(moves)) = (&mut self.moves, moves) {
                tell(moves);
            }
            self.workers.observer.layer_done();
        }
        Ok(())
    }
}

/// What ordering carries from layer to layer: the seam rule, the sequencer and where the nozzle is.
struct OrderState<'a> {
    seam: SeamRule,
    sequencer: Sequencer<'a>,
    at: &'a mut Entry,
}

/// Layers whose order is known.
#[derive(Default)]
struct Batch {
    layers: Layers,
    /// Where each is entered from.
    entries: Vec<Entry>,
}

impl Batch {
    fn into_ordered(self) -> impl Iterator<Item = Ordered> {
        let starts = self.entries.into_iter().map(|entry| entry.xy.map(|[x, y]| Point::from_mm(x, y)));
        let layers = self.layers.paths.into_iter().zip(self.layers.pins);
        let ordered = layers.zip(self.layers.sequences).zip(starts);
        ordered.map(|((layer, order), start)| Ordered { layer, order, start })
    }
}

impl LayerMaker<'_> {
    /// Takes the layers of a round through all stages, batch by batch: while one is ordered, the next is planned, the one
    /// before gets its moves, and the one before that is checked and written. Returns, if they are to be certified, what
    /// was ordered and where each layer was entered from.
    fn round(
        &self,
        (round, paths): (&Round, &(dyn Fn(usize) -> LayerPaths + Sync)),
        at: &mut Entry,
        floating: &mut Floating<'_>,
        writer: &mut PrintWriter<'_>,
    ) -> Result<Vec<Ordered>, JobError> {
        let count = round.sections.layers.len();
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
        let (mut planned, mut batch, mut done, mut kept) =
            (plan(0), Batch::default(), Vec::new(), Vec::new());
        // The last batch is written two steps after it is ordered.
        for step in 1..=count.div_ceil(length) + 2 {
            planned.iter().try_for_each(|layer| floating.take(layer))?;
            let order = || self.order(planned, step * length >= count, &mut state);
            let finish = || workers.map(batch.entries.len(), |i| self.finish(&batch, i, round.first_layer));
            let write = || writer.add(done);
            // What cannot be divided comes first.
            let beside = || parallel::join(write, || parallel::join(finish, || plan(step * length)));
            let (ordered, (written, (finished, next))) = parallel::join(order, beside);
            written?;
            if self.certify {
                kept.extend(batch.into_ordered());
            }
            (planned, batch, done) = (next, ordered, finished);
        }
        Ok(kept)
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
        let time = cool(&mut moves, &self.settings.cooling, &self.machine);
        motion::set_fan(&mut moves, time.total(), &self.motion);
        if self.motion.tools.iter().any(|tool| tool.idle.0 > 0.0) {
            let times_s = move_times_s(&moves, &self.machine);
            motion::preheat(&mut moves, &times_s, &self.motion);
        }
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
            false => (None, self.keep_moves.then_some(moves)),
        };
        FinishedLayer {
            summary: LayerSummary { z_mm: (entry.z_mm * 1e6).round() / 1e6, measures },
            entry,
            text,
            tools,
            layer,
            moves,
        }
    }
}

/// Statistics of what has been written so far.
#[derive(Default)]
struct Statistics {
    layers: Vec<LayerSummary>,
    total: Measures,
    /// Filament in the layers, mm³.
    layers_mm3: f64,
    /// Of each tool, where there are several: all that it printed, and what was flushed.
    tools_mm3: Vec<f64>,
    flushed_mm3: Vec<f64>,
    changes: usize,
    layer_starts: Vec<Seconds>,
    proved: Option<Proved>,
}

impl Statistics {
    fn add(&mut self, layer: LayerSummary, tools: &[ToolSums]) {
        self.tools_mm3.resize(tools.len(), 0.0);
        self.flushed_mm3.resize(tools.len(), 0.0);
        for (tool, sums) in tools.iter().enumerate() {
            self.tools_mm3[tool] += sums.volume_mm3;
            self.flushed_mm3[tool] += sums.flushed_mm3;
            self.changes += sums.taken;
        }
        self.layer_starts.push(Seconds(self.total.total_s));
        self.total += &layer.measures;
        self.layers_mm3 += layer.measures.volume_mm3;
        self.layers.push(layer);
    }

    /// What a script does belongs to the whole, but to no layer.
    fn add_script(&mut self, effect: &Effect, machine: &Machine) {
        self.total += &Measures::of(&effect.measure, effect.time, machine.filament_area_mm2);
    }

    /// Adds the lower bounds of all layers, and of the whole.
    fn certify(
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
            let Ordered { layer, order, start } = &ordered[i];
            let next = begins[i + 1..].iter().find_map(|&begin| begin);
            ordering::excess((&layer.0, &layer.1), order, [*start, next], settings)
        });
        let drawn = excesses.into_iter().zip(&begins).filter(|(_, begin)| begin.is_some());
        self.proved = Some(Proved::of(drawn.map(|(excess, _)| excess)));
        let (layers, starts): (Vec<_>, Vec<_>) =
            ordered.into_iter().map(|ordered| (ordered.layer, ordered.start)).unzip();
        let certificate = Certificate::new(&layers, settings, start, workers);
        for (i, (layer, start)) in self.layers.iter_mut().zip(starts).enumerate() {
            let measures = std::mem::take(&mut layer.measures);
            layer.measures = measures.with_bound(certificate.layer_mm(i, start));
        }
        self.total = std::mem::take(&mut self.total).with_bound(certificate.print_mm());
    }

    /// Totals. What scripts extrude of itself is the first tool's.
    fn totals(&self, settings: &Settings, first: ToolId) -> Totals {
        let scripts_mm3 = self.total.volume_mm3 - self.layers_mm3;
        let own = |(tool, mm3): (usize, &f64)| {
            let scripts_mm3 = if tool == usize::from(first) { scripts_mm3 } else { 0.0 };
            (Mm3(mm3 + scripts_mm3), settings.of_tool(tool).filament.clone())
        };
        Totals {
            tools: self.tools_mm3.iter().enumerate().map(own).collect(),
            time: Seconds(self.total.total_s),
            volume: Mm3(self.total.volume_mm3),
            layer_starts: self.layer_starts.clone(),
        }
    }

    /// What each tool printed.
    fn of_tools(&self, totals: &Totals, settings: &Settings) -> Vec<ToolSummary> {
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

    fn summary(
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
            filament_g,
            filament_cost: totals.cost(&settings.filament),
            warnings,
            layers: self.layers,
            ..Summary::default()
        }
    }
}
