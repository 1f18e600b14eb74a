//! One plate, from meshes to bytes.

use std::ops::Range;

use crate::estimate::{Machine, cool};
use crate::gcode::{self, Effect, LayerText, PrintFacts, Scripts, Slot, Totals, WriterSettings};
use crate::geom::{Bounds, Point, Region};
use crate::job::{Job, JobError, Progress};
use crate::motion::{self, Entry, MotionSettings};
use crate::order::{Chain, Cost, Pins, SeamRule, Sequence, chunk_len, ends_on_path};
use crate::output::Output;
use crate::profile::Settings;
use crate::report::{LayerSummary, Measures, Summary};
use crate::slice::{Layer, Slicer};
use crate::toolpath::{LayerPaths, ObjectLayer, Planner, PlateLayer, Shells};
use crate::units::{Mm3, Seconds};

use super::{load, parallel};

/// Layers that sparse infill is calibrated on.
const SAMPLES: usize = 12;

/// Chunks of layers in flight for each thread: enough to keep all busy, few enough to bound the memory.
const CHUNKS_PER_THREAD: usize = 16;

/// Slices a plate.
pub(super) fn slice(
    job: &Job,
    settings: &Settings,
    output: &mut Output,
    progress: &dyn Progress,
) -> Result<Summary, JobError> {
    let load::Loaded { plate, mut warnings } = load::plate(job, settings)?;
    let slicer = Slicer::new(&plate, &settings.layer);
    let count = slicer.spans().len();
    progress.begin(count);
    let sections = Sections::cut(&slicer, plate.objects.len(), settings);
    let Some(bounds) = sections.bounds() else {
        return Err(JobError::Input(
            "there is nothing to print: no layer's middle lies inside the model; choose a smaller layer.height".into(),
        ));
    };
    warnings.extend(sections.warning());

    let facts = facts(&sections.layers, bounds, settings);
    let scripts = Scripts::new(settings, &facts).map_err(|mistakes| JobError::Script(mistakes.join("\n")))?;
    let planner = sections.planner(settings);
    let run = Run {
        sections: &sections,
        planner,
        chain: chain(settings),
        motion: MotionSettings::new(settings, &job.pauses),
        machine: Machine::new(settings),
        writer: WriterSettings::new(settings, &scripts, true),
        settings,
    };

    let opening = gcode::opening(settings, &facts, &scripts, true);
    let mut slots = opening.slots;
    output.write(&opening.bytes)?;
    let begun = scripts.start_effect(settings, &run.machine);
    let mut tally = Tally::default();
    tally.add_script(&begun, &run.machine);
    let mut seam = SeamRule::new(settings.seam.position);
    let mut at = Entry { xy: begun.end.map(|[x, y, _]| [x, y]), z_mm: begun.end.map_or(0.0, |e| e[2]) };
    let chunk = chunk_len(count);
    let batch = chunk * CHUNKS_PER_THREAD * parallel::threads();
    let mut first = 0;
    while first < count {
        let layers = first..(first + batch).min(count);
        for done in run.batch(layers.clone(), chunk, &mut seam, &mut at) {
            let base = output.written() as usize;
            slots.extend(done.text.progress.map(|slot| Slot { offset: base + slot.offset, ..slot }));
            output.write(&done.text.bytes)?;
            tally.add(done.summary);
            progress.layer_done();
        }
        first = layers.end;
    }
    if let Some([x, y]) = at.xy {
        tally.add_script(&scripts.end_effect(settings, &run.machine, [x, y, at.z_mm]), &run.machine);
    }
    let totals = tally.totals();
    output.write(&gcode::closing(settings, &facts, &scripts, &totals))?;
    for slot in &slots {
        output.patch(slot.offset as u64, &totals.fill(slot, &settings.filament))?;
    }
    Ok(tally.summary(bounds, &facts, &totals, settings, warnings))
}

fn facts(layers: &[Layer], bounds: Bounds, settings: &Settings) -> PrintFacts {
    PrintFacts {
        layers: layers.len(),
        min_mm: bounds.min.mm(),
        max_mm: bounds.max.mm(),
        max_z_mm: layers.last().map_or(0.0, |l| l.span.top_mm) + settings.layer.z_offset.0,
        dated: load::dated(),
    }
}

fn chain(settings: &Settings) -> Chain {
    Chain {
        settings: settings.order.clone(),
        cost: Cost::new(settings.order.cost, &settings.speed, &settings.acceleration, &settings.retract),
        seam: settings.seam.position,
        origin: None,
    }
}

/// The sections of all layers, and the shells that follow from them.
struct Sections {
    layers: Vec<Layer>,
    /// For each object its section in each layer, as an index into the layer's sections.
    places: Vec<Vec<Option<usize>>>,
    shells: Vec<Shells>,
}

static NOTHING: Region = Region { polygons: Vec::new() };

impl Sections {
    fn cut(slicer: &Slicer<'_>, objects: usize, settings: &Settings) -> Self {
        let layers = parallel::map(slicer.spans().len(), |i| slicer.layer(i));
        let places: Vec<Vec<Option<usize>>> = (0..objects)
            .map(|object| layers.iter().map(|l| l.sections.iter().position(|s| s.object == object)).collect())
            .collect();
        let mut sections = Self { layers, places, shells: Vec::new() };
        let (top, bottom) = (settings.shell.top_layers, settings.shell.bottom_layers);
        sections.shells = (0..objects)
            .map(|object| {
                let own: Vec<&Region> = (0..sections.layers.len()).map(|i| sections.of(object, i)).collect();
                Shells::build(&own, top, bottom, &|n, f| parallel::map(n, f))
            })
            .collect();
        sections
    }

    /// An object's section in a layer; nothing above its top.
    fn of(&self, object: usize, layer: usize) -> &Region {
        let place = self.places[object].get(layer).copied().flatten();
        place.map_or(&NOTHING, |place| &self.layers[layer].sections[place].region)
    }

    fn plate_layer(&self, index: usize) -> PlateLayer<'_> {
        let Layer { span, sections, .. } = &self.layers[index];
        let objects = sections.iter().map(|s| ObjectLayer {
            object: s.object as u32,
            section: &s.region,
            next: self.of(s.object, index + 1),
            above: self.shells[s.object].above(index),
            below: self.shells[s.object].below(index),
        });
        PlateLayer { index, top_mm: span.top_mm, height_mm: span.height_mm, objects: objects.collect() }
    }

    /// The toolpath planner, its sparse infill calibrated on sample layers.
    fn planner(&self, settings: &Settings) -> Planner {
        let polygons = self.layers[0].sections.iter().flat_map(|s| s.region.polygons.iter().cloned());
        let footprint = Region { polygons: polygons.collect() };
        let mut planner = Planner::new(settings.into(), &footprint, self.layers[0].span.height_mm);
        let last = self.layers.len() - 1;
        let mut chosen: Vec<usize> = (0..SAMPLES).map(|k| last * k / (SAMPLES - 1)).collect();
        chosen.dedup();
        let samples: Vec<PlateLayer<'_>> = chosen.into_iter().map(|i| self.plate_layer(i)).collect();
        planner.calibrate(&samples, &|n, f| parallel::map(n, f));
        planner
    }

    /// Box around everything that is printed, without skirt and brim.
    fn bounds(&self) -> Option<Bounds> {
        let regions = self.layers.iter().flat_map(|l| &l.sections);
        regions.filter_map(|s| s.region.bounds()).reduce(|a, b| a.joined(&b))
    }

    /// What the user should know of outlines that were not closed.
    fn warning(&self) -> Option<String> {
        let mut forced = self.layers.iter().filter(|l| l.gaps.forced > 0);
        let first = forced.next()?;
        Some(format!(
            "{} layers, the first at {:.2} mm, have outlines with wide gaps, which were closed by straight lines; \
             repair the model if the preview shows walls where there should be none",
            1 + forced.count(),
            first.span.top_mm
        ))
    }
}

/// Everything that layers are made with.
struct Run<'a> {
    sections: &'a Sections,
    planner: Planner,
    chain: Chain,
    motion: MotionSettings,
    machine: Machine,
    writer: WriterSettings,
    settings: &'a Settings,
}

/// A finished layer.
struct Done {
    text: LayerText,
    summary: LayerSummary,
}

impl Run<'_> {
    /// Takes a batch of layers through all stages. `seam` and `at` hold what the layers below left.
    fn batch(&self, layers: Range<usize>, chunk: usize, seam: &mut SeamRule, at: &mut Entry) -> Vec<Done> {
        let first = layers.start;
        let paths =
            parallel::map(layers.len(), |i| self.planner.layer(&self.sections.plate_layer(first + i)));
        let pins: Vec<Pins> = paths.iter().map(|layer| seam.pins(layer)).collect();
        let sequences = self.order(&paths, &pins, chunk, *at);
        let entries: Vec<Entry> = paths
            .iter()
            .zip(&sequences)
            .map(|(layer, sequence)| {
                let next = motion::exit(layer, sequence, *at, &self.motion);
                std::mem::replace(at, next)
            })
            .collect();
        parallel::map(layers.len(), |i| self.finish(&paths[i], &sequences[i], entries[i]))
    }

    /// Orders chunk by chunk, then the head of each chunk again with both ends known.
    fn order(&self, paths: &[LayerPaths], pins: &[Pins], chunk: usize, at: Entry) -> Vec<Sequence> {
        let chunks = paths.len().div_ceil(chunk);
        let range = |c: usize| c * chunk..((c + 1) * chunk).min(paths.len());
        let solved =
            parallel::map(chunks, |c| self.chain.solve_chunk(&paths[range(c)], &pins[range(c)], None));
        let before: Vec<Option<Point>> = (0..chunks)
            .map(|c| match c.checked_sub(1) {
                None => at.xy.map(|[x, y]| Point::from_mm(x, y)),
                Some(b) => {
                    let last = solved[b].iter().zip(&paths[range(b)]).rev().find(|(s, _)| !s.is_empty());
                    last.and_then(|(sequence, layer)| Some(ends_on_path(layer, *sequence.last()?).1))
                }
            })
            .collect();
        let heads = parallel::map(chunks, |c| {
            let (layers, sequences) = (&paths[range(c)], &solved[c]);
            let next = layers.get(1).map(|layer| (layer, sequences[1].as_slice()));
            match before[c] {
                Some(start) => self.chain.resolve_head(
                    (&layers[0], &pins[c * chunk]),
                    sequences[0].clone(),
                    next,
                    Some(start),
                ),
                None => sequences[0].clone(),
            }
        });
        solved
            .into_iter()
            .zip(heads)
            .flat_map(|(sequences, head)| std::iter::once(head).chain(sequences.into_iter().skip(1)))
            .collect()
    }

    /// Motion, cooling and formatting of one layer.
    fn finish(&self, paths: &LayerPaths, sequence: &Sequence, from: Entry) -> Done {
        let mut moves = motion::plan_layer(paths, sequence, from, &self.motion);
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
            summary: LayerSummary { z_mm: moves.z_mm, measures },
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
        let measure = &effect.measure;
        self.total += &Measures {
            print_mm: measure.print_mm,
            travel_mm: measure.travel_mm,
            total_mm: measure.total_mm(),
            link_mm: measure.link_mm,
            travels: measure.travels,
            retractions: measure.retractions,
            total_s: effect.time.0,
            volume_mm3: measure.volume_mm3,
            filament_mm: measure.volume_mm3 / machine.filament_area_mm2,
            ..Measures::default()
        };
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
