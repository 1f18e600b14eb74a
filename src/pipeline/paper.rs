//! The table of the paper of 2016: what ordering saves on files of the slicer that it was measured on.

use std::io::Read;
use std::path::Path;
use std::time::Instant;

use crate::estimate::Machine;
use crate::gcode::{file_time, measure};
use crate::job::{Job, JobError, Progress, Silent};
use crate::order::compare::gap;
use crate::order::{OrderStrategy, Scope};
use crate::output::Output;
use crate::profile::Settings;
use crate::report::PaperRow;

use super::compare::{self, is_gcode};
use super::{print, reorder};

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
pub(super) fn paper(
    job: &Job,
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Vec<PaperRow>, JobError> {
    let Some(file) = job.models.first() else { return Ok(Vec::new()) };
    progress.begin(ORDERS.iter().map(|(_, strategies)| strategies.len()).sum());
    if is_gcode(file) {
        return rows(file, job, settings, progress);
    }
    let folder = tempfile::tempdir().map_err(|error| reorder::input_error(file, &error))?;
    let sliced = folder.path().join("sliced.gcode");
    let mut as_made = settings.clone();
    as_made.order.strategy = OrderStrategy::AsSliced;
    let mut output = Output::create(&sliced)?;
    print::slice(job, &as_made, &mut output, &Silent)?;
    output.commit()?;
    rows(&sliced, job, settings, progress)
}

fn rows(
    file: &Path,
    job: &Job,
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Vec<PaperRow>, JobError> {
    let machine = Machine::new(settings);
    let read = |mut input: Box<dyn std::io::BufRead + '_>| {
        let mut text = Vec::new();
        input.read_to_end(&mut text).map(|_| text).map_err(|error| reorder::input_error(file, &error))
    };
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
    let mut rows = vec![row("as sliced", "", &read(Box::new(reorder::open(file)?))?, 0.0, None)];
    for (scope, strategies) in ORDERS {
        let mut settings = settings.clone();
        settings.order.scope = scope;
        let certified = Job { models: vec![file.to_owned()], ..job.clone() };
        let compared = compare::compare(&certified, &settings, strategies, &Silent)?;
        for (&strategy, compared) in strategies.iter().zip(compared) {
            settings.order.strategy = strategy;
            let begun = Instant::now();
            let mut output = Output::nowhere()?;
            reorder::rewritten(file, &settings, &mut output)?;
            let took_s = begun.elapsed().as_secs_f64();
            let text = read(output.reread(0)?)?;
            let gap = gap(compared.link_mm(), compared.bound_mm);
            rows.push(row(strategy.name(), scope.name(), &text, took_s, gap));
            progress.layer_done();
        }
    }
    Ok(rows)
}
