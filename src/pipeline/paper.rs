//! The table of the paper of 2016: the savings of ordering on files of the slicer that it was measured on.

use std::io::Read;

use crate::estimate::Machine;
use crate::gcode::{file_time, is_gcode, measure};
use crate::job::{Job, JobError, ModelSource};
use crate::order::compare::gap;
use crate::order::{OrderStrategy, Scope};
use crate::output::Output;
use crate::parallel::Workers;
use crate::profile::Settings;
use crate::report::PaperRow;
use crate::source::Source;

use super::compare;
use super::{load, print, reorder};

/// The orders of the table, beside the file's own.
const ORDERS: [(Scope, &[OrderStrategy]); 2] = [
    (
        Scope::Layer,
        &[
            OrderStrategy::Nearest,
            OrderStrategy::Christofides,
            OrderStrategy::ChristofidesOpen,
            OrderStrategy::Optimized,
        ],
    ),
    (Scope::Feature, &[OrderStrategy::Optimized]),
];

/// The rows of one file. A model is sliced first, its paths as they are made.
pub(super) fn paper(job: &Job, settings: &Settings, workers: Workers<'_>) -> Result<Vec<PaperRow>, JobError> {
    let Some(model) = job.models.first() else { return Ok(Vec::new()) };
    workers.observer.begin(ORDERS.iter().map(|(_, strategies)| strategies.len()).sum());
    if let ModelSource::Path(file) = &model.source
        && is_gcode(file)
    {
        return rows(Source::File(file), settings, job.certify, workers);
    }
    let mut as_made = settings.clone();
    as_made.order.strategy = OrderStrategy::AsSliced;
    let silent = workers.observer.silent();
    let mut output = Output::memory();
    let models = load::read(job, &as_made, workers)?;
    let besides = print::Besides::default();
    print::slice(models, job, &as_made, &mut output, besides, Workers { observer: &silent })?;
    rows(Source::Memory(&output.into_bytes()), settings, job.certify, workers)
}

fn rows(
    source: Source<'_>,
    settings: &Settings,
    certify: bool,
    workers: Workers<'_>,
) -> Result<Vec<PaperRow>, JobError> {
    let machine = Machine::new(settings);
    let silent = workers.observer.silent();
    let quiet = Workers { observer: &silent };
    let row = |order: &str, scope: &str, text: &[u8], took_s: f64, gap: Option<f64>| {
        let measure = measure(text, settings.filament.diameter);
        PaperRow {
            order: order.into(),
            scope: scope.into(),
            print_mm: measure.print_mm,
            travel_mm: measure.travel_mm,
            link_mm: measure.link_mm,
            retractions: measure.retractions,
            total_s: file_time(text, &machine).0,
            took_s,
            gap,
        }
    };
    let mut text = Vec::new();
    let read = source.open().and_then(|mut input| input.read_to_end(&mut text));
    read.map_err(|error| source.error(error))?;
    let mut rows = vec![row("as sliced", "", &text, 0.0, None)];
    for (scope, strategies) in ORDERS {
        let mut settings = settings.clone();
        settings.order.scope = scope;
        let compared = compare::compare_file(source, &settings, strategies, certify, quiet)?;
        for (&strategy, compared) in strategies.iter().zip(compared) {
            settings.order.strategy = strategy;
            let begun = workers.observer.now();
            let mut output = Output::memory();
            reorder::rewritten(source, &settings, &mut output, quiet)?;
            let took_s = workers.observer.now().saturating_sub(begun).as_secs_f64();
            let text = output.into_bytes();
            let gap = gap(compared.link_mm(), compared.bound_mm);
            rows.push(row(strategy.name(), scope.name(), &text, took_s, gap));
            workers.observer.layer_done();
        }
    }
    Ok(rows)
}
