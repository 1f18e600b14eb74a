//! Whole runs, from the file of a model to the file of its G-code, at the standard job.

use std::path::{Path, PathBuf};

use criterion::{Criterion, criterion_group, criterion_main};
use pathwright::Observer;
use pathwright::job::{Engine, Job};
use pathwright::output::Output;
use pathwright::pipeline::Pipeline;
use pathwright::profile::{self, Settings};

/// Bundled models with many short paths, many vertices, many islands.
const BUNDLED: [&str; 3] = ["plate_with_holes", "helical_gear", "pin_forest"];

/// Bundled models, and larger ones from a folder beside the project, where that is there.
fn models() -> Vec<PathBuf> {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    let mut models: Vec<PathBuf> =
        BUNDLED.iter().map(|name| root.join("models").join(format!("{name}.stl"))).collect();
    if let Ok(entries) = std::fs::read_dir(root.join("../shared/models/seed")) {
        let mut seed: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        seed.retain(|path| path.extension().is_some_and(|extension| extension == "stl"));
        seed.sort();
        models.extend(seed);
    }
    models
}

fn slice(model: &Path, settings: &Settings, output: &Path) -> usize {
    let job = Job { models: vec![model.into()], ..Job::default() };
    let mut output = Output::create(output).expect("a file");
    let summary = Pipeline.slice(&job, settings, &mut output, &Observer::none()).expect("a print");
    output.commit().expect("written");
    summary.layer_count
}

fn runs(c: &mut Criterion) {
    let settings = profile::resolve(&["standard-job".into()], &[]).expect("an embedded profile").settings;
    let folder = tempfile::tempdir().expect("a folder");
    let output = folder.path().join("part.gcode");
    let mut group = c.benchmark_group("slice");
    group.sample_size(10);
    for model in models() {
        let name = model.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        group.bench_function(name, |b| b.iter(|| slice(&model, &settings, &output)));
    }
    group.finish();
}

criterion_group!(benches, runs);
criterion_main!(benches);
