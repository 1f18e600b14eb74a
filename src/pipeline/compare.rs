//! Strategies side by side on the layers of one plate.

use crate::job::{Job, JobError, Progress};
use crate::order::compare::{LayerRow, StrategyRow};
use crate::order::{Cost, LayerProblem, Pins, SeamRule, chunk_len, ends_on_path};
use crate::profile::{CostKind, OrderStrategy, Settings};
use crate::slice::Slicer;
use crate::toolpath::LayerPaths;

use super::ordering::Certificate;
use super::sections::Sections;
use super::{load, ordering, parallel};

/// Plans the layers once and orders them by each strategy. With `job.certify`, bounds are computed as well.
pub(super) fn compare(
    job: &Job,
    settings: &Settings,
    strategies: &[OrderStrategy],
    progress: &dyn Progress,
) -> Result<Vec<StrategyRow>, JobError> {
    let load::Loaded { plate, wishes, .. } = load::plate(job, settings)?;
    let slicer = Slicer::new(&plate, &load::layers(settings));
    let sections = Sections::cut(&slicer, plate.objects.len(), &wishes, settings);
    if sections.bounds().is_none() {
        return Err(load::nothing_to_print());
    }
    let planner = sections.planner(settings);
    let count = sections.layers.len();
    progress.begin(count * strategies.len());
    let paths = parallel::map(count, |i| sections.paths(&planner, i, settings));
    let mut seam = SeamRule::new(settings.seam.position);
    let layers: Vec<(LayerPaths, Pins)> = paths
        .into_iter()
        .map(|layer| {
            let pins = seam.pins(&layer);
            (layer, pins)
        })
        .collect();
    let certificate = job.certify.then(|| Certificate::new(&layers, settings, None));
    let rows =
        strategies.iter().map(|&strategy| row(strategy, &layers, settings, certificate.as_ref(), progress));
    Ok(rows.collect())
}

fn row(
    strategy: OrderStrategy,
    layers: &[(LayerPaths, Pins)],
    settings: &Settings,
    certificate: Option<&Certificate>,
    progress: &dyn Progress,
) -> StrategyRow {
    let mut chain = ordering::chain(settings);
    chain.settings.strategy = strategy;
    let (paths, pins): (Vec<LayerPaths>, Vec<Pins>) = layers.iter().cloned().unzip();
    let solved = ordering::solve(&chain, &paths, &pins, chunk_len(layers.len()), None);

    let mut at = None;
    let starts: Vec<_> = paths
        .iter()
        .zip(&solved.sequences)
        .map(|(layer, sequence)| {
            let start = at;
            at = sequence.last().map(|&visit| ends_on_path(layer, visit).1).or(at);
            start
        })
        .collect();
    let time = Cost::new(CostKind::Time, settings);
    let rows = parallel::map(layers.len(), |i| {
        // Sequences name vertices of paths: measured on the problem whose seams are free.
        let mut problem = LayerProblem::new(&paths[i], &None, settings.order.scope).problem;
        problem.start = starts[i];
        let mut row = LayerRow::new(i, &problem, &solved.sequences[i], &time);
        row.bound_mm = certificate.map(|certificate| certificate.layer_mm(i, starts[i]));
        progress.layer_done();
        row
    });
    StrategyRow {
        strategy: strategy.name().to_owned(),
        took_s: solved.took.as_secs_f64(),
        bound_mm: certificate.map(Certificate::print_mm),
        layers: rows,
    }
}
