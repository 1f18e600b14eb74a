//! `pathwright compare`.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::args::CompareArgs;
use super::console::{self, Bar, file_name};
use super::exit::{Exit, Failure, usage};
use super::given;
use super::plan::{self, Plate, Sources};
use super::view::{sliced, write};
use super::watch::Watch;
use crate::job::{Engine, Job};
use crate::order::OrderStrategy;
use crate::order::compare::{self, StrategyRow};
use crate::order::compare_tools;
use crate::profile::Settings;
use crate::report::{PaperRow, TimeBound, paper};
use crate::view::{self, Print, Scene};

/// Compares strategies model by model, and over all models together. One that fails does not keep the others from
/// being compared; the exit code is that of the first one that failed.
pub(super) fn run(args: &CompareArgs, engine: &dyn Engine) -> Result<Exit, Failure> {
    let watch = Watch::start(&args.limits, args.json)?;
    let mut shorthands = plan::shorthands(None, &args.ordering);
    shorthands.extend(plan::by_length(&args.settings, &args.ordering));
    let sources = Sources::new(&args.settings, shorthands)?;
    if args.tools {
        return tools(args, &sources, engine, &watch);
    }
    let plates = plan::plates(&args.models, &sources)?;
    if let Some(first) = plates.first() {
        console::warn(&first.settings.warnings);
    }
    if args.paper {
        return paper(args, plates, engine, &watch);
    }
    let chosen: Vec<OrderStrategy> = OrderStrategy::ALL
        .iter()
        .filter(|(name, _)| args.order.is_empty() || args.order.iter().any(|wanted| wanted == name))
        .map(|(_, strategy)| *strategy)
        .collect();
    if args.html.is_some() && args.models.files.len() > 1 {
        return Err(usage("--html shows one model; give one model alone"));
    }
    let models: Vec<&Path> = args.models.files.iter().map(PathBuf::as_path).collect();
    plan::kept(&models, args.html.iter().map(PathBuf::as_path))?;
    let mut exit = Exit::Done;
    let mut pooled: Vec<StrategyRow> = Vec::new();
    for (index, plate) in plates.into_iter().enumerate() {
        let (model, settings) = (plate.inputs[0].clone(), plate.settings.clone());
        let (settings, job) = (&settings.settings, job(args, plate));
        let bar = Bar::on_terminal(!args.no_progress);
        let observer = watch.over(Bar::observer(bar.as_ref()));
        let result = engine.compare(&job, settings, &chosen, &observer);
        if let Some(bar) = bar {
            bar.remove();
        }
        match result {
            Ok(rows) => {
                let name = model.display().to_string();
                if args.json {
                    console::print_json(&json!({ "model": name, "strategies": compare::to_json(&rows) }))?;
                } else if args.csv {
                    console::print(&compare::csv(&name, &rows, index == 0))?;
                } else {
                    console::print(&format!("{name}\n{}\n", compare::text(&rows)))?;
                }
                if let Some(path) = &args.html {
                    let prints = prints(&job, settings, &chosen, &rows, engine)?;
                    write(path, view::page(&file_name(&model), &prints).as_bytes())?;
                }
                compare::pool(&mut pooled, rows);
            }
            Err(error) => {
                let failure = watch.explained(error.into());
                let failure =
                    Failure { file: failure.file.clone().or(Some(model.display().to_string())), ..failure };
                console::fail_as(&failure, args.json)?;
                exit = if exit == Exit::Done { failure.exit } else { exit };
            }
        }
    }
    if args.models.files.len() > 1 && !args.json && !args.csv && !pooled.is_empty() {
        console::print(&format!("all models\n{}", compare::text(&pooled)))?;
    }
    Ok(exit)
}

fn job(args: &CompareArgs, plate: Plate) -> Job {
    Job {
        allow_floating: true,
        certify: !args.no_bound,
        threads: Some(args.threads.map_or(0, Into::into)),
        dated: console::source_date(),
        ..plate.job
    }
}

/// Orders of the tools of one plate.
fn tools(
    args: &CompareArgs,
    sources: &Sources<'_>,
    engine: &dyn Engine,
    watch: &Watch,
) -> Result<Exit, Failure> {
    let plate = plan::plate(&args.models, given::read(&args.models)?, sources, None)?;
    console::warn(&plate.settings.warnings);
    let (settings, objects) = (plate.settings.clone(), plan::object_settings(&args.object, sources)?);
    let count = settings.settings.tools.len();
    if count < 2 {
        return Err(usage("--tools compares orders of several tools; `[[tools]]` of a profile lists them"));
    }
    let job = Job { objects, ..job(args, plate) };
    let observer = watch.over(Bar::observer(None));
    let rows = engine
        .compare_tools(&job, &settings.settings, &observer)
        .map_err(|error| watch.explained(error.into()))?;
    match args.json {
        true => console::print_json(&json!({ "tools": rows }))?,
        false => console::print(&compare_tools::text(&rows))?,
    }
    Ok(Exit::Done)
}

/// The paper's table, file by file, and the means.
fn paper(
    args: &CompareArgs,
    plates: Vec<Plate>,
    engine: &dyn Engine,
    watch: &Watch,
) -> Result<Exit, Failure> {
    let mut exit = Exit::Done;
    let mut tables: Vec<Vec<PaperRow>> = Vec::new();
    for plate in plates {
        let (file, settings) = (plate.inputs[0].clone(), plate.settings.clone());
        let observer = watch.over(Bar::observer(None));
        match engine.paper(&job(args, plate), &settings.settings, &observer) {
            Ok(rows) => {
                let own = file.extension().is_some_and(|e| e.eq_ignore_ascii_case("stl"));
                console::print(&(paper::table(&file.display().to_string(), own, &rows) + "\n"))?;
                tables.push(rows);
            }
            Err(error) => {
                let failure = watch.explained(error.into());
                console::fail(&failure);
                exit = if exit == Exit::Done { failure.exit } else { exit };
            }
        }
    }
    if tables.len() > 1 {
        console::print(&paper::means(&tables))?;
    }
    Ok(exit)
}

/// The print that each strategy makes.
fn prints(
    job: &Job,
    settings: &Settings,
    strategies: &[OrderStrategy],
    rows: &[StrategyRow],
    engine: &dyn Engine,
) -> Result<Vec<Print>, Failure> {
    let job = Job { certify: false, ..job.clone() };
    let each = strategies.iter().zip(rows).map(|(strategy, row)| {
        let mut settings = settings.clone();
        settings.order.strategy = *strategy;
        let (text, _) = sliced(&job, &settings, engine, false)?;
        let layers: Vec<_> = row.layers.iter().map(|layer| (layer.link_mm, layer.bound_mm)).collect();
        let print = Print::new(row.strategy.clone(), Scene::read(&text, &settings), &settings);
        let time_bound = row.bound_s.map(|bound_s| TimeBound::new(row.travel_s(), bound_s));
        Ok(print.with_bounds(&layers, (row.link_mm(), row.bound_mm), time_bound))
    });
    each.collect()
}
