//! Strategies side by side on the layers of one plate, or of a finished file.

use crate::gcode::is_gcode;
use crate::job::{Job, JobError, ModelSource};
use crate::motion::MotionSettings;
use crate::order::compare::StrategyRow;
use crate::order::compare_tools::ToolOrderRow;
use crate::order::{OrderStrategy, ToolOrder};
use crate::order::{PathVisit, Pins, SeamRule, chunk_len, ends_on_path};
use crate::parallel::Workers;
use crate::plan::{blocks, spiral, tool_order};
use crate::plate::Model;
use crate::profile::Settings;
use crate::source::Source;
use crate::toolpath::LayerPaths;

use super::ordering::{Certificate, Layers, Sequencer};
use super::rounds::{self, Site};
use super::tools::{self, Tooled};
use super::{load, ordering, reorder};

/// Plans the layers once and orders them by each strategy. With `job.certify`, bounds are computed as well.
pub(super) fn compare(
    job: &Job,
    settings: &Settings,
    strategies: &[OrderStrategy],
    workers: Workers<'_>,
) -> Result<Vec<StrategyRow>, JobError> {
    if let Some(ModelSource::Path(file)) = job.models.first().map(|model| &model.source)
        && is_gcode(file)
    {
        return compare_file(Source::File(file), settings, strategies, job.certify, workers);
    }
    let models = load::read(job, settings, workers)?;
    compare_models(models, job, settings, strategies, workers)
}

/// The same for models that have been read.
pub(super) fn compare_models(
    models: Vec<Model>,
    job: &Job,
    settings: &Settings,
    strategies: &[OrderStrategy],
    workers: Workers<'_>,
) -> Result<Vec<StrategyRow>, JobError> {
    let layers = sliced(models, job, settings, workers)?;
    let fixed = Fixed { whole: false, links_mm: vec![0.0; layers.len()] };
    Ok(compare_layers(layers, &fixed, settings, strategies, job.certify, workers))
}

/// The same for the layers of a finished file.
pub(super) fn compare_file(
    source: Source<'_>,
    settings: &Settings,
    strategies: &[OrderStrategy],
    certify: bool,
    workers: Workers<'_>,
) -> Result<Vec<StrategyRow>, JobError> {
    let (layers, links_mm) = reorder::layers(source, settings)?;
    let fixed = Fixed { whole: true, links_mm };
    Ok(compare_layers(layers, &fixed, settings, strategies, certify, workers))
}

fn compare_layers(
    paths: Vec<LayerPaths>,
    fixed: &Fixed,
    settings: &Settings,
    strategies: &[OrderStrategy],
    certify: bool,
    workers: Workers<'_>,
) -> Vec<StrategyRow> {
    workers.observer.begin(paths.len() * strategies.len());
    let position = settings.seam.position;
    let mut seam = if fixed.whole { reorder::seam_rule(position) } else { SeamRule::new(position) };
    let layers: Vec<(LayerPaths, Pins)> = paths
        .into_iter()
        .map(|layer| {
            let pins = seam.pins(&layer);
            (layer, pins)
        })
        .collect();
    let certificate = certify.then(|| Certificate::new(&layers, settings, None, workers));
    let rows = strategies
        .iter()
        .map(|&strategy| row(strategy, &layers, fixed, settings, certificate.as_ref(), workers));
    rows.collect()
}

/// The layers of a plate, round after round.
fn sliced(
    models: Vec<Model>,
    job: &Job,
    settings: &Settings,
    workers: Workers<'_>,
) -> Result<Vec<LayerPaths>, JobError> {
    let settings = &*spiral::effective(settings);
    let loaded = load::place(models, job, settings)?;
    let settings = &*settings.with_widths_of_objects();
    let site = Site::of(&loaded, job);
    let rounds = rounds::prepare(&site, settings, workers)?;
    if let Some(tooled) = Tooled::plan(&rounds, &|_, _| None, &site, settings, workers)? {
        let parts = |round: usize| {
            let tooled = &tooled;
            (0..tooled.count(round)).map(move |part| tooled.paths(round, part))
        };
        return Ok((0..rounds.len()).flat_map(parts).collect());
    }
    let layers = rounds
        .iter()
        .map(|round| workers.map(round.sections.layers.len(), |i| round.paths(i, None, settings)));
    Ok(layers.flatten().collect())
}

/// Orders of tools side by side, on the first layers that are printed without interruption.
pub(super) fn compare_tools(
    job: &Job,
    settings: &Settings,
    workers: Workers<'_>,
) -> Result<Vec<ToolOrderRow>, JobError> {
    let settings = &*spiral::effective(settings);
    let loaded = load::place(load::read(job, settings, workers)?, job, settings)?;
    let settings = &*settings.with_widths_of_objects();
    let rounds = rounds::prepare(&Site::of(&loaded, job), settings, workers)?;
    let Some(round) = rounds.first() else { return Ok(Vec::new()) };
    let layers = workers
        .map(round.sections.layers.len(), |i| tools::paths(round, (i, None), &loaded.styles, settings));
    let into_print = tools::flushes_into_print(&loaded.styles, settings);
    let blocks = blocks::find(&layers, into_print, [&job.pauses, &job.color_changes], settings);
    let problem = tool_order::problem(&layers, &blocks, None, settings);
    let motion = MotionSettings::new(settings, &[]);
    let row = |(_, order): &(&str, ToolOrder)| {
        tool_order::row(*order, &tool_order::plan(&problem, *order), &problem, &motion, settings)
    };
    Ok(ToolOrder::ALL.iter().map(row).collect())
}

/// The travel that ordering cannot change.
struct Fixed {
    /// Whether the layers come from a finished file, whose own order is kept as the baseline.
    whole: bool,
    /// Links of each layer that no order changes, mm.
    links_mm: Vec<f64>,
}

fn row(
    strategy: OrderStrategy,
    layers: &[(LayerPaths, Pins)],
    fixed: &Fixed,
    settings: &Settings,
    certificate: Option<&Certificate>,
    workers: Workers<'_>,
) -> StrategyRow {
    let mut chain = ordering::chain(settings);
    chain.settings.strategy = strategy;
    let (paths, pins): (Vec<LayerPaths>, Vec<Pins>) = layers.iter().cloned().unzip();
    let mut sequencer = Sequencer::new(&chain, workers, chunk_len(layers.len()), None);
    let Layers { paths, pins, mut sequences } = sequencer.take(paths, pins, true);
    if fixed.whole && strategy == OrderStrategy::AsSliced {
        let as_is = |layer: &LayerPaths| {
            (0..layer.paths.len() as u32).map(|path| PathVisit { path, entry: 0 }).collect()
        };
        sequences = paths.iter().map(as_is).collect();
    }

    let mut at = None;
    let starts: Vec<_> = paths
        .iter()
        .zip(&sequences)
        .map(|(layer, sequence)| {
            let start = at;
            at = sequence.last().map(|&visit| ends_on_path(layer, visit).1).or(at);
            start
        })
        .collect();
    // Where the next layer with a path begins.
    let mut begin = None;
    let mut nexts: Vec<_> = paths
        .iter()
        .zip(&sequences)
        .rev()
        .map(|(layer, sequence)| {
            let next = begin;
            begin = sequence.first().map(|&visit| ends_on_path(layer, visit).0).or(begin);
            next
        })
        .collect();
    nexts.reverse();
    let rows = workers.map(layers.len(), |i| {
        let mut row = ordering::measured(i, &paths[i], &sequences[i], starts[i], settings);
        let bound_mm = |certificate: &Certificate| certificate.layer_mm(i, starts[i]) + fixed.links_mm[i];
        row.bound_mm = certificate.map(bound_mm);
        row.bound_s = certificate.and_then(|certificate| certificate.layer_s(i, starts[i]));
        let excess =
            |_| ordering::excess((&paths[i], &pins[i]), &sequences[i], [starts[i], nexts[i]], settings);
        row.excess = certificate.and_then(excess);
        row.link_mm += fixed.links_mm[i];
        workers.observer.layer_done();
        row
    });
    StrategyRow {
        strategy: strategy.name().to_owned(),
        took_s: sequencer.took.as_secs_f64(),
        bound_mm: certificate.map(|c| c.print_mm() + fixed.links_mm.iter().sum::<f64>()),
        bound_s: certificate.and_then(Certificate::print_s),
        layers: rows,
    }
}
