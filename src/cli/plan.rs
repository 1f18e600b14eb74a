//! What the arguments mean: settings in force, and one job for each G-code file.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::args::{Assignment, ModelArgs, ObjectAssignment, OrderingArgs, SettingArgs, ShapeArgs, SliceArgs};
use super::console;
use super::exit::{Exit, Failure};
use super::presets;
use crate::job::{Job, ObjectSettings, TransformOptions};
use crate::mesh::Transform;
use crate::output::resolve_links;
use crate::presets::Chosen;
use crate::profile::{Origin, Override, Problem, ProfileError, Resolved, SECTIONS, resolve, resolve_presets};
use crate::slice::heights_from_lines;

/// Everything that `slice` is going to do.
#[derive(Debug)]
pub(super) struct Plan {
    pub settings: Resolved,
    pub tasks: Vec<Task>,
}

/// One G-code file.
#[derive(Debug, PartialEq)]
pub(super) struct Task {
    pub job: Job,
    pub destination: Destination,
    /// The file's name was not given, so that the settings may choose it.
    pub unnamed: bool,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Destination {
    Stdout,
    File(PathBuf),
}

impl Plan {
    pub fn new(args: &SliceArgs) -> Result<Self, Failure> {
        if args.output.as_deref() == Some(Path::new("-")) && args.json {
            return Err(usage("--json and -o - both want standard output; give one of them a file"));
        }
        let mut shorthands = shorthands(args.order.as_ref(), &args.ordering);
        let switches = [
            (args.labels, "--labels", "gcode.labels", "true"),
            (args.sequential, "--sequential", "print.sequence", "object"),
            (args.arrange, "--arrange", "plate.keep_layout", "false"),
            (args.no_arrange, "--no-arrange", "plate.arrange", "false"),
            (args.orient, "--orient", "plate.orient", "true"),
            (args.vase, "--vase", "spiral.enabled", "true"),
        ];
        for (_, option, key, value) in switches.into_iter().filter(|switch| switch.0) {
            shorthands.push(Override { key: key.into(), value: value.into(), option });
        }
        shorthands.extend(layer_heights(args)?);
        let files = &args.models.files;
        let plates: Vec<&[PathBuf]> = if args.each { files.chunks(1).collect() } else { vec![files] };
        // What is wrong with the arguments alone is told before what is wrong with the settings.
        let mut tasks = tasks(args, &plates, "gcode")?;
        let presets = presets::chosen(&args.settings.presets)?;
        let resolved = settings_on(presets.as_ref(), &args.settings, &shorthands)?;
        if resolved.settings.gcode.binary {
            tasks = self::tasks(args, &plates, "bgcode")?;
        }
        let plate = &resolved.settings.plate;
        if args.copies > 1 && !plate.arrange {
            return Err(usage("copies have no position in a file; leave out --copies or --no-arrange"));
        }
        if plate.orient && !(args.support_enforcer.is_empty() && args.support_blocker.is_empty()) {
            return Err(usage(
                "support enforcers and blockers are given in the model's coordinates, which --orient changes; use one of them",
            ));
        }
        let objects = object_settings(args, presets.as_ref(), &shorthands)?;
        for task in &mut tasks {
            task.job.objects.clone_from(&objects);
        }
        Ok(Self { settings: resolved, tasks })
    }
}

/// What is to be done for each plate; `ending`: that of names that are not given.
fn tasks(args: &SliceArgs, plates: &[&[PathBuf]], ending: &str) -> Result<Vec<Task>, Failure> {
    let tasks = plates.iter().map(|models| {
        let unnamed = args.output.as_deref().is_none_or(Path::is_dir);
        Ok(Task { job: job(args, models), destination: destination(args, &models[0], ending)?, unnamed })
    });
    let tasks: Vec<Task> = tasks.collect::<Result<_, Failure>>()?;
    no_file_is_written_twice(&tasks)?;
    no_input_is_overwritten(&tasks)?;
    Ok(tasks)
}

/// Settings of some objects: those of the plate with more on top.
fn object_settings(
    args: &SliceArgs,
    presets: Option<&Chosen>,
    shorthands: &[Override],
) -> Result<Vec<ObjectSettings>, Failure> {
    const OPTION: &str = "--object";
    let mut given: Vec<(&str, Vec<Override>)> = Vec::new();
    let mut problems = Vec::new();
    for ObjectAssignment { object, setting: Assignment { key, value } } in &args.object {
        let section = key.split('.').next().unwrap_or_default();
        if let Some(reason) = why_not_of_an_object(section) {
            let message = format!("{reason}; objects may differ in {}", ObjectSettings::SECTIONS.join(", "));
            let setting = Some((key.clone(), value.clone()));
            problems.push(Problem { origin: Origin::Option(OPTION), setting, message });
        }
        let setting = Override { key: key.clone(), value: value.clone(), option: OPTION };
        match given.iter_mut().find(|(name, _)| name == object) {
            Some((_, settings)) => settings.push(setting),
            None => given.push((object, vec![setting])),
        }
    }
    if !problems.is_empty() {
        return Err(ProfileError { problems }.into());
    }
    let resolved = given.into_iter().map(|(object, own)| {
        let settings = settings_on(presets, &args.settings, &[shorthands, &own].concat())?.settings;
        Ok(ObjectSettings { object: object.to_owned(), settings })
    });
    resolved.collect()
}

/// Why keys of a section are the same for all objects of a plate. Unknown sections are found out later.
fn why_not_of_an_object(section: &str) -> Option<&'static str> {
    match section {
        _ if ObjectSettings::SECTIONS.contains(&section) => None,
        "layer" | "first_layer" => Some("all objects of a plate share their layers"),
        "skirt" | "brim" | "raft" | "support" => {
            Some("adhesion and supports are planned for the plate as a whole")
        }
        "seam" | "order" | "speed" | "acceleration" | "retract" | "travel" | "cooling" => {
            Some("how the nozzle moves is decided for whole layers, not for objects")
        }
        _ if SECTIONS.iter().any(|known| known.name == section) => {
            Some("it belongs to the printer or to the plate as a whole")
        }
        _ => None,
    }
}

pub(super) fn usage(message: impl ToString) -> Failure {
    Failure::new(Exit::Usage, message)
}

fn job(args: &SliceArgs, models: &[PathBuf]) -> Job {
    Job {
        models: models.to_vec(),
        support_enforcers: args.support_enforcer.clone(),
        support_blockers: args.support_blocker.clone(),
        transform: transform(&args.models),
        copies: args.copies,
        objects: Vec::new(),
        pauses: args.pause_at.clone(),
        color_changes: args.color_change_at.clone(),
        allow_floating: args.allow_floating,
        certify: args.certify,
        threads: Some(args.threads.map_or(0, Into::into)),
        dated: console::source_date(),
    }
}

/// Scale, rotation and place of every model.
pub(super) fn transform(args: &ModelArgs) -> TransformOptions {
    let none = TransformOptions::default();
    let Transform { scale, rotate_deg } = shape(&args.shape);
    TransformOptions {
        scale,
        rotate_deg,
        translate_mm: args.translate.map_or(none.translate_mm, |triple| triple.0),
        scale_to_fit: args.scale_to_fit,
    }
}

/// Scale and rotation.
pub(super) fn shape(args: &ShapeArgs) -> Transform {
    let none = Transform::default();
    Transform {
        scale: args.scale.map_or(none.scale, |triple| triple.0),
        rotate_deg: args.rotate.map_or(none.rotate_deg, |triple| triple.0),
    }
}

/// Settings in force; options with a setting's meaning win over `--set`.
pub(super) fn settings(args: &SettingArgs, shorthands: &[Override]) -> Result<Resolved, Failure> {
    settings_on(presets::chosen(&args.presets)?.as_ref(), args, shorthands)
}

/// The same on presets that were chosen already.
fn settings_on(
    presets: Option<&Chosen>,
    args: &SettingArgs,
    shorthands: &[Override],
) -> Result<Resolved, Failure> {
    let typed = args.set.iter().map(|Assignment { key, value }| Override {
        key: key.clone(),
        value: value.clone(),
        option: "--set",
    });
    let ignoring = args.ignore_scripts.then(|| Override {
        key: "gcode.ignore_scripts".into(),
        value: "true".into(),
        option: "--ignore-scripts",
    });
    let overrides: Vec<Override> = typed.chain(shorthands.iter().cloned()).chain(ignoring).collect();
    let Some(presets) = presets else { return Ok(resolve(&args.profile, &overrides)?) };
    let mut resolved = resolve_presets(&presets.config, &args.profile, &overrides)?;
    resolved.warnings.splice(0..0, presets::notes(presets));
    Ok(resolved)
}

/// The options that are short for a setting.
pub(super) fn shorthands(order: Option<&String>, args: &OrderingArgs) -> Vec<Override> {
    let options = [
        ("--order", "order.strategy", order),
        ("--scope", "order.scope", args.scope.as_ref()),
        ("--cost", "order.cost", args.cost.as_ref()),
        ("--seam", "seam.position", args.seam.as_ref()),
        ("--effort", "order.effort", args.effort.as_ref()),
    ];
    let given = options.into_iter().filter_map(|(option, key, value)| Some((option, key, value?.clone())));
    given.map(|(option, key, value)| Override { key: key.into(), value, option }).collect()
}

/// The table of layer heights, if one is given.
fn layer_heights(args: &SliceArgs) -> Result<Option<Override>, Failure> {
    let Some(path) = &args.layer_heights else { return Ok(None) };
    let wrong = |message: String| Failure::new(Exit::Settings, format!("{}: {message}", path.display()));
    let text = fs::read_to_string(path).map_err(|error| wrong(error.to_string()))?;
    let (key, value) = ("layer.heights".into(), heights_from_lines(&text).map_err(wrong)?);
    Ok(Some(Override { key, value, option: "--layer-heights" }))
}

/// Beside the first model, unless `-o` names a file or a folder.
fn destination(args: &SliceArgs, model: &Path, ending: &str) -> Result<Destination, Failure> {
    let beside = model.with_extension(ending);
    let Some(output) = &args.output else {
        return Ok(Destination::File(beside));
    };
    if output == Path::new("-") {
        return Ok(Destination::Stdout);
    }
    if output.is_dir() {
        let name = beside.file_name().ok_or_else(|| usage(format!("{}: is not a file", model.display())))?;
        return Ok(Destination::File(output.join(name)));
    }
    let text = output.to_string_lossy();
    if text.is_empty() || text.ends_with(std::path::is_separator) {
        return Err(usage(format!("-o names a folder that does not exist: `{text}`")));
    }
    if args.each && args.models.files.len() > 1 {
        return Err(usage(format!(
            "with --each, -o names a folder that exists, which {} is not",
            output.display()
        )));
    }
    Ok(Destination::File(output.clone()))
}

/// A path that is the same however a file is named, which need not exist.
fn identity(path: &Path) -> PathBuf {
    let path = resolve_links(path);
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match (fs::canonicalize(folder), path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => path,
    }
}

fn no_file_is_written_twice(tasks: &[Task]) -> Result<(), Failure> {
    let mut writers: BTreeMap<PathBuf, &Path> = BTreeMap::new();
    for task in tasks {
        let model = &task.job.models[0];
        let Destination::File(path) = &task.destination else {
            match tasks.len() {
                1 => continue,
                _ => {
                    return Err(usage(
                        "--each cannot write several files to standard output; give -o a folder",
                    ));
                }
            }
        };
        if let Some(other) = writers.insert(identity(path), model) {
            let (other, model, path) = (other.display(), model.display(), path.display());
            return Err(usage(format!(
                "{other} and {model} would both be written to {path}; slice them one by one"
            )));
        }
    }
    Ok(())
}

fn no_input_is_overwritten(tasks: &[Task]) -> Result<(), Failure> {
    let inputs: Vec<&Path> = tasks.iter().flat_map(|task| &task.job.models).map(PathBuf::as_path).collect();
    let outputs = tasks.iter().filter_map(|task| match &task.destination {
        Destination::File(path) => Some(path.as_path()),
        Destination::Stdout => None,
    });
    kept(&inputs, outputs)
}

/// The path that the settings choose for a file, beside where it would be otherwise; `written`: by this run so far.
pub(super) fn named(path: &Path, name: &str, job: &Job, written: &[PathBuf]) -> Result<PathBuf, Failure> {
    let safe: String =
        name.chars().map(|c| if c.is_control() || "/\\:*?\"<>|".contains(c) { '_' } else { c }).collect();
    // The kind of G-code is decided.
    let ending = path.extension().unwrap_or_default();
    let stem = Path::new(safe.trim()).with_extension("");
    let stem = stem.file_name().ok_or_else(|| {
        Failure::new(
            Exit::Settings,
            format!("gcode.file_name: `{name}` is no name for a file; give one with -o"),
        )
    })?;
    let mut file = stem.to_owned();
    file.push(".");
    file.push(ending);
    let chosen = path.with_file_name(file);
    kept(&job.models.iter().map(PathBuf::as_path).collect::<Vec<_>>(), [chosen.as_path()].into_iter())?;
    if written.contains(&chosen) {
        let chosen = chosen.display();
        return Err(usage(format!(
            "{chosen} would be written twice, as gcode.file_name gives two plates one name; add {{input_filename_base}} to it"
        )));
    }
    Ok(chosen)
}

/// A usage error if one of the outputs is one of the inputs.
pub(super) fn kept<'a>(inputs: &[&Path], mut outputs: impl Iterator<Item = &'a Path>) -> Result<(), Failure> {
    let inputs: Vec<PathBuf> = inputs.iter().map(|path| identity(path)).collect();
    match outputs.find(|path| inputs.contains(&identity(path))) {
        Some(path) => {
            let path = path.display();
            Err(usage(format!("{path}: the output would replace a model; choose another with -o")))
        }
        None => Ok(()),
    }
}
