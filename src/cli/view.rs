//! `pathwright view`.

use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::args::ViewArgs;
use super::console::{self, Bar, file_name};
use super::exit::{Exit, Failure, usage};
use super::given;
use super::plan::{self, Sources};
use crate::gcode::{self, is_gcode};
use crate::job::{Engine, Job};
use crate::limits;
use crate::output::Output;
use crate::profile::{Resolved, Settings};
use crate::report::Summary;
use crate::view::{self, Layer, Print, Scene};

/// Writes the pictures and the page that are requested.
pub(super) fn run(args: &ViewArgs, engine: &dyn Engine) -> Result<Exit, Failure> {
    let inputs: Vec<&Path> = args.models.files.iter().map(PathBuf::as_path).collect();
    let page = page_path(args);
    let pictures = [&args.svg, &args.png, &args.thumbnail].into_iter().flatten();
    plan::kept(&inputs, pictures.chain(&page).map(PathBuf::as_path))?;
    let sources = Sources::new(&args.settings, plan::shorthands(args.order.as_ref(), &args.ordering))?;
    let (text, summary, resolved) = gcode(args, &sources, engine)?;
    let name = args.models.files[0].display();
    let scene = Scene::read(&text, &resolved.settings);
    let scene = if args.by_tool { scene.colored_by_tool() } else { scene };
    if scene.is_empty() {
        return Err(Failure::new(Exit::Input, format!("{name}: there are no moves in it; is it G-code?")));
    }
    if let Some(path) = &args.svg {
        write(path, view::layer_svg(&scene, layer(&scene, args)?).as_bytes())?;
    }
    if let Some(path) = &args.png {
        write(path, &view::layer_png(&scene, layer(&scene, args)?, args.size.unwrap_or(1200)))?;
    }
    if let Some(path) = &args.thumbnail {
        write(path, &view::thumbnail(&scene, [args.size.unwrap_or(300); 2]))?;
    }
    if let Some(path) = &page {
        let title = args.models.files.iter().map(|file| file_name(file)).collect::<Vec<_>>().join(" + ");
        let mut print = Print::new(title.clone(), scene, &resolved.settings);
        if let Some(Summary { layers, total, time_bound, .. }) = summary.filter(|_| args.certify) {
            let layers: Vec<_> = layers.iter().map(|l| (l.measures.link_mm, l.measures.bound_mm)).collect();
            print = print.with_bounds(&layers, (total.link_mm, total.bound_mm), time_bound);
        }
        write(path, view::page(&title, &[print]).as_bytes())?;
    }
    Ok(Exit::Done)
}

/// Where the page goes, if one is wanted.
fn page_path(args: &ViewArgs) -> Option<PathBuf> {
    let only_pictures = args.svg.is_some() || args.png.is_some() || args.thumbnail.is_some();
    match &args.output {
        Some(path) => Some(path.clone()),
        None if only_pictures => None,
        None if args.models.files[0] == Path::new("-") => Some("-".into()),
        None => Some(args.models.files[0].with_extension("html")),
    }
}

/// G-code, what its slicing came to, and the settings in force.
type Shown = (Vec<u8>, Option<Summary>, Arc<Resolved>);

/// The G-code to show, as it is, or sliced from models, with what the slicing came to, and the settings in force.
fn gcode(args: &ViewArgs, sources: &Sources<'_>, engine: &dyn Engine) -> Result<Shown, Failure> {
    let files = &args.models.files;
    if files.iter().any(|path| is_gcode(path)) {
        let [path] = files.as_slice() else {
            return Err(usage("a page shows one G-code file, or models; give one G-code file alone"));
        };
        if args.certify {
            return Err(usage("--certify is for models; of a G-code file the order is given"));
        }
        let failed = |error: String| Failure::new(Exit::Input, format!("{}: {error}", path.display()));
        let unread = |error: std::io::Error| failed(error.to_string());
        let mut input = gcode::open(path).map_err(unread)?;
        let bytes = input.seek(SeekFrom::End(0)).map_err(unread)?;
        if bytes > limits::VIEW_BYTES {
            return Err(failed(format!("more than {} GB cannot be shown", limits::VIEW_BYTES >> 30)));
        }
        limits::check_memory(bytes).map_err(failed)?;
        let mut text = Vec::new();
        input.rewind().and_then(|()| input.read_to_end(&mut text)).map_err(unread)?;
        let resolved = sources.resolve(&[])?;
        console::warn(&resolved.warnings);
        return Ok((text, None, Arc::new(resolved)));
    }
    let plate = plan::plate(&args.models, given::read(&args.models)?, sources, None)?;
    console::warn(&plate.settings.warnings);
    let job = Job {
        allow_floating: true,
        certify: args.certify,
        threads: Some(args.threads.map_or(0, Into::into)),
        dated: console::source_date(),
        ..plate.job
    };
    let (text, summary) = sliced(&job, &plate.settings.settings, engine, !args.no_progress)?;
    console::warn(&summary.warnings);
    Ok((text, Some(summary), plate.settings))
}

/// The G-code of a plate, and what it came to.
pub(super) fn sliced(
    job: &Job,
    settings: &Settings,
    engine: &dyn Engine,
    show_progress: bool,
) -> Result<(Vec<u8>, Summary), Failure> {
    let bar = Bar::on_terminal(show_progress);
    let observer = Bar::observer(bar.as_ref());
    let mut output = Output::memory();
    let result = engine.slice(job, settings, &mut output, &observer);
    if let Some(bar) = bar {
        bar.remove();
    }
    Ok((output.into_bytes(), result?))
}

fn layer<'a>(scene: &'a Scene, args: &ViewArgs) -> Result<&'a Layer, Failure> {
    let number = args.layer.unwrap_or(1) as usize;
    scene.layers.get(number - 1).ok_or_else(|| {
        usage(format!("--layer {number}: the print has the layers 1 to {}", scene.layers.len()))
    })
}

/// Writes a file whole, or to standard output.
pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let mut output = if path == Path::new("-") { Output::stdout() } else { Output::create(path)? };
    output.write(bytes)?;
    Ok(output.commit()?)
}
