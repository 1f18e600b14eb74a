//! Whole prints through the library, and their G-code read back.

use std::path::{Path, PathBuf};

use pathwright::Observer;
use pathwright::gcode::{Action, Measure, Stroke, measure, replay};
use pathwright::geometry::{Region, intersection, offset};
use pathwright::job::{Engine, Job, JobError};
use pathwright::mesh;
use pathwright::output::Output;
use pathwright::pipeline::Pipeline;
use pathwright::plate::{self, Layout, Placement};
use pathwright::profile::{self, Override, Settings};
use pathwright::report::Summary;
use pathwright::slice::{self, Layer};
use pathwright::toolpath::bead;

/// A bundled model's file.
pub fn model(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("models").join(format!("{name}.stl"))
}

/// Settings of profiles with keys replaced, as on the command line.
pub fn settings(profiles: &[&str], sets: &[&str]) -> Settings {
    let profiles: Vec<String> = profiles.iter().map(|name| (*name).to_string()).collect();
    let sets: Vec<Override> = sets
        .iter()
        .map(|set| {
            let (key, value) = set.split_once('=').expect("KEY=VALUE");
            Override { key: key.into(), value: value.into(), option: "--set" }
        })
        .collect();
    profile::resolve(&profiles, &sets).expect("sound settings").settings
}

/// The standard job with keys replaced, ordered quickly: these tests are about what is printed, not when.
pub fn standard(sets: &[&str]) -> Settings {
    let quick = ["order.strategy=nearest"];
    settings(&["standard-job"], &[&quick, sets].concat())
}

/// A finished print.
pub struct Print {
    /// Its G-code.
    pub text: Vec<u8>,
    /// What the run says of it.
    pub summary: Summary,
}

/// Slices one bundled model.
pub fn print(name: &str, settings: &Settings) -> Print {
    run(&Job { models: vec![model(name).into()], ..Job::default() }, settings).expect("a print")
}

/// Carries out a job.
pub fn run(job: &Job, settings: &Settings) -> Result<Print, JobError> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("part.gcode");
    let mut output = Output::create(&file)?;
    let summary = Pipeline.slice(job, settings, &mut output, &Observer::none())?;
    output.commit()?;
    Ok(Print { text: std::fs::read(&file).expect("written"), summary })
}

/// A model's volume, and its sections where the print has them.
pub struct Solid {
    pub volume_mm3: f64,
    pub watertight: bool,
    pub layers: Vec<Layer>,
}

/// Cuts a model by itself, placed as a plate of one.
pub fn solid(path: &Path, settings: &Settings) -> Solid {
    let (mesh, report) = mesh::load(path).expect("a model");
    let item = Layout::single("part", mesh, 1);
    let plate = plate::place(vec![item], &settings.bed, &Placement::default()).expect("fits");
    let layers = slice::slice(&plate, &settings.layer);
    Solid { volume_mm3: report.volume_mm3, watertight: report.watertight, layers }
}

impl Solid {
    /// The section of a layer; nothing below the bed and above the top.
    pub fn section(&self, layer: Option<usize>) -> Region {
        let sections = layer.and_then(|i| self.layers.get(i)).map(|l| &l.sections);
        let polygons = sections.into_iter().flatten().flat_map(|s| s.region.polygons().iter().cloned());
        Region::disjoint(polygons)
    }

    /// Area times height of what lies inside the walls, with material in every layer of the shells' thickness above
    /// and below.
    pub fn sparse_mm3(&self, settings: &Settings) -> f64 {
        let height_mm = settings.layer.height.0;
        let walls_mm = bead::rounding_mm(height_mm) / 2.0
            + f64::from(settings.walls.count) * bead::spacing_mm(settings.walls.width.0, height_mm);
        let (above, below) = (settings.shell.top_layers as usize, settings.shell.bottom_layers as usize);
        let area_mm2 = |i: usize| {
            let inside = offset(&self.section(Some(i)), -walls_mm);
            let upper = (1..=above).map(|k| i + k).map(Some);
            let lower = (1..=below).map(|k| i.checked_sub(k));
            let sparse = upper.chain(lower).fold(inside, |region, layer| match region.is_empty() {
                true => region,
                false => intersection(&region, &self.section(layer)),
            });
            sparse.area_mm2()
        };
        (0..self.layers.len()).map(|i| area_mm2(i) * height_mm).sum()
    }
}

/// An uninterrupted bead as the file has it.
#[derive(Clone, Debug)]
pub struct Bead {
    /// Its `;TYPE:`.
    pub kind: String,
    pub z_mm: f64,
    /// Its `;WIDTH:`.
    pub width_mm: f64,
    pub points: Vec<[f64; 2]>,
    pub feed_mm_s: f64,
    /// Length of filament.
    pub e_mm: f64,
}

impl Bead {
    /// Whether it ends where it began.
    pub fn closed(&self) -> bool {
        self.points.first() == self.points.last()
    }

    pub fn length_mm(&self) -> f64 {
        self.points.windows(2).map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1])).sum()
    }
}

impl Print {
    /// What the file measures.
    pub fn measure(&self, settings: &Settings) -> Measure {
        measure(&self.text, settings.filament.diameter)
    }

    /// The volume of one `;TYPE:`, or 0.
    pub fn volume_of(&self, kind: &str, settings: &Settings) -> f64 {
        let kinds = self.measure(settings).by_type;
        kinds.iter().find(|t| t.name == kind).map_or(0.0, |t| t.volume_mm3)
    }

    /// The moves of the file, start and end script left out.
    pub fn strokes(&self) -> Vec<Stroke> {
        let (mut inside, mut strokes) = (false, Vec::new());
        for step in replay(&self.text) {
            match step.action {
                Action::Stroke(stroke) if inside => strokes.push(stroke),
                Action::Type(kind) => inside &= kind != b"Custom",
                Action::Other => inside |= step.line.text == b";LAYER_CHANGE",
                _ => {}
            }
        }
        strokes
    }

    /// The beads of the file, start and end script left out. A move without extrusion, another `;TYPE:` or another
    /// `;WIDTH:` ends one.
    pub fn beads(&self) -> Vec<Bead> {
        let mut beads: Vec<Bead> = Vec::new();
        let (mut kind, mut width_mm, mut drawing) = (String::new(), 0.0, false);
        for step in replay(&self.text) {
            match step.action {
                Action::Stroke(s) if s.extrudes() => {
                    if !drawing {
                        beads.push(Bead {
                            kind: kind.clone(),
                            z_mm: s.to[2],
                            width_mm,
                            points: vec![[s.from[0], s.from[1]]],
                            feed_mm_s: s.feed_mm_s,
                            e_mm: 0.0,
                        });
                    }
                    let bead = beads.last_mut().expect("begun");
                    bead.points.push([s.to[0], s.to[1]]);
                    bead.e_mm += s.e_mm;
                    drawing = true;
                }
                Action::Stroke(s) => drawing &= s.xy_mm <= 1e-9 && s.e_mm.abs() <= 1e-9,
                Action::Type(name) => (kind, drawing) = (String::from_utf8_lossy(name).into_owned(), false),
                Action::Other => {
                    let text = String::from_utf8_lossy(step.line.text).into_owned();
                    if let Some(width) = text.strip_prefix(";WIDTH:") {
                        (width_mm, drawing) = (width.parse().expect("a width"), false);
                    }
                }
                _ => drawing = false,
            }
        }
        beads.retain(|bead| bead.kind != "Custom");
        beads
    }

    /// The text as lines.
    pub fn lines(&self) -> impl Iterator<Item = &str> {
        std::str::from_utf8(&self.text).expect("UTF-8").lines()
    }
}
