//! What the arguments mean: settings in force, and one job for each G-code file.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::args::{Assignment, ModelArgs, ObjectAssignment, OrderingArgs, SettingArgs, ShapeArgs, SliceArgs};
use super::console;
use super::exit::{Exit, Failure, usage};
use super::given::{self, Given, What};
use super::presets;
use crate::job::{self, Job, JobModel, ModelFiles, ObjectSettings, Project};
use crate::mesh::{Transform, UNITS};
use crate::output::resolve_links;
use crate::parallel;
use crate::profile::{Origin, Override, Problem, ProfileError, Resolved, Settings};
use crate::slice::heights_from_lines;

/// Everything that `slice` is going to do.
pub(super) struct Plan {
    pub tasks: Vec<Task>,
}

/// One G-code file.
pub(super) struct Task {
    pub plate: Plate,
    pub destination: Destination,
    /// The file's name was not given, so that the settings may choose it.
    pub unnamed: bool,
}

/// What is printed together, and the settings for it.
pub(super) struct Plate {
    /// Its models, or the project, as they are named.
    pub inputs: Vec<PathBuf>,
    pub job: Job,
    pub settings: Arc<Resolved>,
    /// The project that it is, with its models.
    pub project: Option<(Box<Project>, ModelFiles)>,
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
        let shorthands = shorthand_overrides(args)?;
        let given = given::read(&args.models)?;
        let plates: Vec<Vec<Given>> = match args.each {
            true => given.into_iter().map(|one| vec![one]).collect(),
            false => vec![given],
        };
        // What is wrong with the arguments alone is told before what is wrong with the settings.
        let destinations = destinations(args, &plates, "gcode")?;
        let sources = Sources::new(&args.settings, shorthands)?;
        let mut made: Vec<Plate> = Vec::with_capacity(plates.len());
        for given in plates {
            let known = made.iter().find(|plate| plate.project.is_none()).map(|plate| plate.settings.clone());
            let mut plate = plate(&args.models, given, &sources, known)?;
            of_slice(&mut plate, args)?;
            made.push(plate);
        }
        let objects = object_settings(&args.object, &sources)?;
        for plate in &mut made {
            plate.job.objects.clone_from(&objects);
            check(&plate.job, &plate.settings.settings)?;
        }
        let tasks = made.into_iter().zip(destinations).map(|(plate, (destination, unnamed))| {
            let is_binary = plate.settings.settings.gcode.binary && unnamed;
            let destination = match destination {
                Destination::File(path) if is_binary => Destination::File(path.with_extension("bgcode")),
                destination => destination,
            };
            Task { plate, destination, unnamed }
        });
        let tasks: Vec<Task> = tasks.collect();
        no_file_is_written_twice(tasks.iter().map(|task| (&task.plate.inputs[0], &task.destination)))?;
        no_input_is_overwritten(&tasks)?;
        Ok(Self { tasks })
    }
}

/// The options of `slice` that are short for a setting.
pub(super) fn shorthand_overrides(args: &SliceArgs) -> Result<Vec<Override>, Failure> {
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
    Ok(shorthands)
}

/// Where each plate goes, and whether that was not said; `ending`: that of names that are not given.
fn destinations(
    args: &SliceArgs,
    plates: &[Vec<Given>],
    ending: &str,
) -> Result<Vec<(Destination, bool)>, Failure> {
    let unnamed = args.output.as_deref().is_none_or(Path::is_dir);
    let all = plates.iter().map(|given| match (&args.output, given[0].is_stdin) {
        (None, true) => Ok((Destination::Stdout, false)),
        _ => Ok((destination(args, &given[0].path, ending)?, unnamed)),
    });
    let all: Vec<(Destination, bool)> = all.collect::<Result<_, Failure>>()?;
    no_file_is_written_twice(plates.iter().map(|given| &given[0].path).zip(all.iter().map(|(to, _)| to)))?;
    Ok(all)
}

/// What `slice` adds to a plate.
fn of_slice(plate: &mut Plate, args: &SliceArgs) -> Result<(), Failure> {
    let body = |path: &PathBuf| JobModel { transform: shape(&args.models.shape), ..path.clone().into() };
    let job = &mut plate.job;
    if plate.project.is_some() {
        let bodies = !(args.support_enforcer.is_empty() && args.support_blocker.is_empty());
        if args.copies > 1 || bodies {
            return Err(usage(format!(
                "{}: a project says which models there are; leave out --copies, --support-enforcer and --support-blocker",
                plate.inputs[0].display()
            )));
        }
    } else {
        job.models.iter_mut().for_each(|model| model.copies = args.copies);
    }
    job.support_enforcers.extend(args.support_enforcer.iter().map(body));
    job.support_blockers.extend(args.support_blocker.iter().map(body));
    job.pauses.extend(&args.pause_at);
    job.color_changes.extend(&args.color_change_at);
    job.allow_floating |= args.allow_floating;
    job.certify |= args.certify;
    job.threads = Some(args.threads.map_or(0, Into::into));
    job.dated = console::source_date();
    Ok(())
}

/// What cannot be done with a job and these settings.
fn check(job: &Job, settings: &Settings) -> Result<(), Failure> {
    let is_arranged = job.models.iter().all(|model| model.at_mm.is_none());
    if job.models.iter().any(|model| model.copies > 1) && !settings.plate.arrange {
        return Err(usage("copies have no position in a file; leave out --copies or --no-arrange"));
    }
    let mut bodies = job.support_enforcers.iter().chain(&job.support_blockers);
    if settings.plate.orient && is_arranged && bodies.any(|body| body.at_mm.is_none()) {
        return Err(usage(
            "support enforcers and blockers are given in the model's coordinates, which --orient changes; use one of them",
        ));
    }
    Ok(())
}

/// Where settings are taken from, as the arguments name it.
pub(super) struct Sources<'a> {
    args: &'a SettingArgs,
    named: job::Sources,
}

impl<'a> Sources<'a> {
    /// `shorthands`: options that are short for a setting, on top of `--set`.
    pub fn new(args: &'a SettingArgs, shorthands: Vec<Override>) -> Result<Self, Failure> {
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
        let overrides = typed.chain(shorthands).chain(ignoring).collect();
        let presets = presets::chosen(&args.presets)?;
        Ok(Self { args, named: job::Sources { presets, profiles: args.profile.clone(), overrides } })
    }

    /// The settings in force, with more on top.
    pub fn resolve(&self, more: &[Override]) -> Result<Resolved, Failure> {
        Ok(self.named.resolve(more)?)
    }

    /// What a project comes to, with the options on top.
    fn project(&self, project: &Project, files: &ModelFiles) -> Result<(Job, Resolved), Failure> {
        let library = match project.presets.printer {
            Some(_) => Some(presets::library(&self.args.presets.presets)?),
            None => None,
        };
        Ok(self.named.project(project, files, library.as_ref())?)
    }

    /// The profile, as a project holds it, that gives the settings in force.
    pub fn as_project(&self, resolved: &Resolved) -> Project {
        self.named.as_project(resolved)
    }
}

/// Models, or a project, on one plate. `known`: the settings of models, where they are known.
pub(super) fn plate(
    args: &ModelArgs,
    given: Vec<Given>,
    sources: &Sources<'_>,
    known: Option<Arc<Resolved>>,
) -> Result<Plate, Failure> {
    let inputs: Vec<PathBuf> = given.iter().map(|one| one.path.clone()).collect();
    let is_alone = given.len() == 1;
    let translate_mm = args.translate.map_or([0.0; 3], |triple| triple.0);
    let mut models: Vec<JobModel> = Vec::with_capacity(given.len());
    for Given { path, what, .. } in given {
        let path = path.display();
        match what {
            What::Model(source) => models.push(JobModel { transform: shape(&args.shape), ..source.into() }),
            What::Project(..) if !is_alone => {
                return Err(usage(format!(
                    "{path}: a project is a plate of its own; give it alone, or --each"
                )));
            }
            What::Project(..) if shape(&args.shape) != Transform::default() || args.scale_to_fit => {
                return Err(usage(format!(
                    "{path}: a project says how its models are scaled and turned; leave out --unit, --scale, --rotate and \
                     --scale-to-fit"
                )));
            }
            What::Project(project, files) => {
                let (job, resolved) = sources.project(&project, &files)?;
                let job = Job { translate_mm, ..job };
                return Ok(Plate {
                    inputs,
                    job,
                    settings: Arc::new(resolved),
                    project: Some((project, files)),
                });
            }
        }
    }
    let settings = match known {
        Some(settings) => settings,
        None => {
            let assignments = sources.named.read(&[]);
            let resolve = || sources.named.resolved(assignments);
            let read = || JobModel::read_small(&mut models);
            let (settings, ()) = parallel::join(resolve, read);
            Arc::new(settings?)
        }
    };
    let job = Job { models, translate_mm, scale_to_fit: args.scale_to_fit, ..Job::default() };
    Ok(Plate { inputs, job, settings, project: None })
}

/// Each model or project by itself.
pub(super) fn plates(args: &ModelArgs, sources: &Sources<'_>) -> Result<Vec<Plate>, Failure> {
    let mut plates: Vec<Plate> = Vec::new();
    let known = Arc::new(sources.resolve(&[])?);
    for given in given::read(args)? {
        plates.push(plate(args, vec![given], sources, Some(known.clone()))?);
    }
    Ok(plates)
}

/// Settings of some objects: those of the plate with more on top.
pub(super) fn object_settings(
    args: &[ObjectAssignment],
    sources: &Sources<'_>,
) -> Result<Vec<ObjectSettings>, Failure> {
    const OPTION: &str = "--object";
    let mut given: Vec<(&str, Vec<Override>)> = Vec::new();
    let mut problems = Vec::new();
    for ObjectAssignment { object, setting: Assignment { key, value } } in args {
        if let Some(message) = ObjectSettings::refusal(key) {
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
        let settings = sources.resolve(&own)?.settings;
        Ok(ObjectSettings { object: object.to_owned(), settings })
    });
    resolved.collect()
}

/// Scale and rotation.
pub(super) fn shape(args: &ShapeArgs) -> Transform {
    let none = Transform::default();
    let unit = args.unit.as_ref().and_then(|name| UNITS.iter().find(|(unit, _)| unit == name));
    let factor = unit.map_or(1.0, |(_, factor)| *factor);
    Transform {
        scale: args.scale.map_or(none.scale, |triple| triple.0).map(|scale| scale * factor),
        rotate_deg: args.rotate.map_or(none.rotate_deg, |triple| triple.0),
    }
}

/// Settings in force; options with a setting's meaning win over `--set`.
pub(super) fn settings(args: &SettingArgs, shorthands: &[Override]) -> Result<Resolved, Failure> {
    Sources::new(args, shorthands.to_vec())?.resolve(&[])
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

/// Lengths are what is compared and shortened, unless a cost is asked for.
pub(super) fn by_length(args: &SettingArgs, ordering: &OrderingArgs) -> Option<Override> {
    let length = || Override { key: "order.cost".into(), value: "length".into(), option: "--cost" };
    (!asks_for_cost(args, ordering)).then(length)
}

/// Whether `--cost` or `--set` says what counts.
pub(super) fn asks_for_cost(args: &SettingArgs, ordering: &OrderingArgs) -> bool {
    ordering.cost.is_some() || sets(args, "order.cost")
}

/// The error of a package with G-code that would have to be made anew.
pub(super) fn no_package(path: &Path) -> Failure {
    usage(format!(
        "{}: a package is read and reordered, but not made anew, as printers check more in it than is known; \
         name a .gcode file",
        path.display()
    ))
}

/// Whether `--set` names a key.
pub(super) fn sets(args: &SettingArgs, key: &str) -> bool {
    args.set.iter().any(|set| set.key == key)
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

fn no_file_is_written_twice<'a>(
    all: impl Iterator<Item = (&'a PathBuf, &'a Destination)>,
) -> Result<(), Failure> {
    let mut writers: BTreeMap<PathBuf, &Path> = BTreeMap::new();
    let mut streams = 0;
    for (count, (model, destination)) in (1..).zip(all) {
        streams += usize::from(*destination == Destination::Stdout);
        if streams > 0 && count > 1 {
            return Err(usage("--each cannot write several files to standard output; give -o a folder"));
        }
        let Destination::File(path) = destination else { continue };
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
    let inputs: Vec<&Path> = tasks.iter().flat_map(|task| &task.plate.inputs).map(PathBuf::as_path).collect();
    let outputs = tasks.iter().filter_map(|task| match &task.destination {
        Destination::File(path) => Some(path.as_path()),
        Destination::Stdout => None,
    });
    kept(&inputs, outputs)
}

/// The path that the settings choose for a file, beside where it would be otherwise; `written`: by this run so far.
pub(super) fn named(
    path: &Path,
    name: &str,
    inputs: &[PathBuf],
    written: &[PathBuf],
) -> Result<PathBuf, Failure> {
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
    kept(&inputs.iter().map(PathBuf::as_path).collect::<Vec<_>>(), [chosen.as_path()].into_iter())?;
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
