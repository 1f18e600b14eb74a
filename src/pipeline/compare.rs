//! Strategies side by side on the layers of one plate, or of a finished file.

use std::path::Path;

use crate::job::{Job, JobError, Progress};
use crate::order::compare::{LayerRow, StrategyRow};
use crate::order::{CostKind, OrderStrategy};
use crate::order::{LayerProblem, Pins, SeamRule, Visit, chunk_len, ends_on_path};
use crate::profile::Settings;
use crate::toolpath::LayerPaths;

use super::ordering::{Certificate, Layers, Sequencer};
use super::{load, ordering, parallel, reorder, rounds, spiral};

/// Plans the layers once and orders them by each strategy. With `job.certify`, bounds are computed as well.
pub(super) fn compare(
    job: &Job,
    settings: &Settings,
    strategies: &[OrderStrategy],
    progress: &dyn Progress,
) -> Result<Vec<StrategyRow>, JobError> {
    let file = job.models.first().filter(|file| is_gcode(file));
    let (paths, links_mm) = match file {
        Some(file) => reorder::layers(file, settings)?,
        None => {
            let layers = sliced(job, settings)?;
            let none = vec![0.0; layers.len()];
            (layers, none)
        }
    };
    let fixed = Fixed { whole: file.is_some(), links_mm };
    progress.begin(paths.len() * strategies.len());
    let position = settings.seam.position;
    let mut seam = if fixed.whole { reorder::seam_rule(position) } else { SeamRule::new(position) };
    let layers: Vec<(LayerPaths, Pins)> = paths
        .into_iter()
        .map(|layer| {
            let pins = seam.pins(&layer);
            (layer, pins)
        })
        .collect();
    let certificate = job.certify.then(|| Certificate::new(&layers, settings, None));
    let rows = strategies
        .iter()
        .map(|&strategy| row(strategy, &layers, &fixed, settings, certificate.as_ref(), progress));
    Ok(rows.collect())
}

/// Whether a name is that of a G-code file.
pub(super) fn is_gcode(path: &Path) -> bool {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    extension.is_some_and(|e| matches!(e.as_str(), "gcode" | "gco" | "gc" | "g" | "nc" | "ngc"))
}

/// The layers of a plate, round after round.
fn sliced(job: &Job, settings: &Settings) -> Result<Vec<LayerPaths>, JobError> {
    let settings = &*spiral::effective(settings);
    let loaded = load::plate(job, settings)?;
    let rounds = rounds::prepare(&loaded, settings)?;
    let layers = rounds.iter().map(|round| {
        parallel::map(round.sections.layers.len(), |i| round.sections.paths(&round.planners, i, settings))
    });
    Ok(layers.flatten().collect())
}

/// What is not open to ordering.
struct Fixed {
    /// Whether the layers are those of a finished file, which is what it is whatever precedence is asked of others.
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
    progress: &dyn Progress,
) -> StrategyRow {
    let mut chain = ordering::chain(settings);
    chain.settings.strategy = strategy;
    let (paths, pins): (Vec<LayerPaths>, Vec<Pins>) = layers.iter().cloned().unzip();
    let mut sequencer = Sequencer::new(&chain, chunk_len(layers.len()), None);
    let Layers { paths, mut sequences, .. } = sequencer.take(paths, pins, true);
    if fixed.whole && strategy == OrderStrategy::AsSliced {
        let as_is =
            |layer: &LayerPaths| (0..layer.paths.len() as u32).map(|item| Visit { item, entry: 0 }).collect();
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
    let time = settings.order_cost(CostKind::Time);
    let rows = parallel::map(layers.len(), |i| {
        // Sequences name vertices of paths: measured on the problem whose seams are free.
        let mut problem = LayerProblem::new(&paths[i], &None, settings.order.scope).problem;
        problem.start = starts[i];
        let mut row = LayerRow::new(i, &problem, &sequences[i], &time);
        let bound_mm = |certificate: &Certificate| certificate.layer_mm(i, starts[i]) + fixed.links_mm[i];
        row.bound_mm = certificate.map(bound_mm);
        row.link_mm += fixed.links_mm[i];
        progress.layer_done();
        row
    });
    StrategyRow {
        strategy: strategy.name().to_owned(),
        took_s: sequencer.took.as_secs_f64(),
        bound_mm: certificate.map(|c| c.print_mm() + fixed.links_mm.iter().sum::<f64>()),
        layers: rows,
    }
}
