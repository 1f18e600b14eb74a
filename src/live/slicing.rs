//! One revision from its project to its G-code, stage by stage.

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use super::event::{Progress, Walls};
use super::layout;
use super::placed::Placed;
use super::results::Results;
use crate::job::{Job, JobError, ModelRole, Project};
use crate::observer::Observer;
use crate::output::Output;
use crate::parallel;
use crate::pipeline::{Live, Pipeline, Stage, StageCache};
use crate::profile::{Settings, binary_metadata};
use crate::view::{self, Print, Scene};

/// Least time between two reports of progress.
const PACE: Duration = Duration::from_millis(50);

/// A revision that can be sliced.
pub(super) struct Slicing<'a> {
    pub revision: u64,
    pub project: &'a Project,
    pub job: &'a Job,
    pub settings: &'a Settings,
    /// Asked before every piece of work whether it was overtaken.
    pub is_over: &'a (dyn Fn() -> bool + Send + Sync),
    pub clock: fn() -> Duration,
}

/// Something of a revision that is known before its end.
pub(super) enum Step {
    Placed(Placed),
    Progress(Progress),
    Walls(Walls),
}

impl Slicing<'_> {
    /// Slices it; `tell` hears of each step.
    pub fn run(&self, cache: &mut StageCache, tell: &(dyn Fn(Step) + Sync)) -> Result<Results, JobError> {
        let name = self.name();
        let paced = Paced { slicing: self, last: Mutex::new(None), tell };
        paced.tell("sections", 0, 0);
        let on_stage = |stage: Stage<'_>| match stage {
            Stage::Placed(plate) => {
                tell(Step::Placed(Placed::of(self.revision, plate, &self.models(), &[], self.settings)));
            }
            Stage::Walls(done, of) => paced.tell("paths", done, of),
            Stage::WallsDone(layers) => {
                let print = Print::new(name.clone(), Scene::planned(layers), self.settings);
                let packed = view::preview(&print).into();
                tell(Step::Walls(Walls { revision: self.revision, layers: layers.len(), packed }));
            }
        };
        let observer = Observer::none()
            .cancelled_when(|| (self.is_over)())
            .timed_by(self.clock)
            .on_progress(|done, of| paced.tell("order", done, of));
        let mut output = Output::memory();
        let live = Live { cache, tell: &on_stage };
        let summary = Pipeline::slice_live(self.job, self.settings, &mut output, live, &observer);
        if let Err(JobError::DoesNotFit(_)) = &summary
            && let Some(placed) =
                layout::standing(self.revision, self.job, self.settings, &self.models(), &observer)
        {
            tell(Step::Placed(placed));
        }
        let summary = summary?;
        let gcode = output.into_bytes();
        let scene = parallel::run(None, &observer, |workers| {
            Scene::read_watched(&gcode, self.settings, &|| workers.go_on())
        });
        let scene = scene.ok_or(JobError::Cancelled)?;
        let mut print = Print::new(name.clone(), scene, self.settings);
        if self.job.certify {
            let layers: Vec<_> =
                summary.layers.iter().map(|l| (l.measures.link_mm, l.measures.bound_mm)).collect();
            let total = (summary.total.link_mm, summary.total.bound_mm);
            print = print.with_bounds(&layers, total, summary.time_bound);
        }
        let binary = self.settings.gcode.binary.then(|| Arc::new(binary_metadata(self.settings)));
        let name = file_name(summary.file_name.as_deref().unwrap_or(&name), binary.is_some());
        print.name.clone_from(&name);
        Ok(Results {
            revision: self.revision,
            walls: None,
            preview: Some(view::preview(&print).into()),
            name,
            gcode: Some(gcode.into()),
            binary,
            summary: Some(Arc::new(summary)),
        })
    }

    /// The name of the first model.
    fn name(&self) -> String {
        let first = self.job.models.first().and_then(|model| model.path().file_stem());
        first.map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
    }

    /// The number of each printed model in the project, with that of its first copy.
    fn models(&self) -> Vec<(usize, usize)> {
        let models = self.project.models.iter().enumerate();
        models.filter(|(_, model)| model.role == ModelRole::Part).map(|(number, _)| (number, 0)).collect()
    }
}

/// A name that any system takes for a file, with the ending of its kind.
fn file_name(name: &str, is_binary: bool) -> String {
    let safe: String =
        name.chars().map(|c| if c.is_control() || "/\\:*?\"<>|".contains(c) { '_' } else { c }).collect();
    let ending = if is_binary { "bgcode" } else { "gcode" };
    let known = Path::new(safe.trim()).extension().is_some_and(|ending| {
        ["gcode", "gco", "g", "bgcode", "bgc"].iter().any(|known| ending.eq_ignore_ascii_case(known))
    });
    let stem = if known { Path::new(safe.trim()).with_extension("") } else { safe.trim().into() };
    let stem = stem.to_string_lossy();
    format!("{}.{ending}", if stem.is_empty() { "print" } else { &stem })
}

/// Reports progress, not too often.
struct Paced<'a> {
    slicing: &'a Slicing<'a>,
    /// When the last report was made, and of which stage.
    last: Mutex<Option<(Duration, &'static str)>>,
    tell: &'a (dyn Fn(Step) + Sync),
}

impl Paced<'_> {
    fn tell(&self, stage: &'static str, done: usize, of: usize) {
        let now = (self.slicing.clock)();
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        let is_early = last.is_some_and(|(then, before)| before == stage && now.saturating_sub(then) < PACE);
        if is_early && done < of {
            return;
        }
        *last = Some((now, stage));
        let revision = self.slicing.revision;
        (self.tell)(Step::Progress(Progress { revision, stage, done, of }));
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;
    use crate::job::{ModelFile, ModelFiles, ProjectModel};

    /// So many questions, evenly spread, is the slicing ended at.
    const POINTS: usize = 12;

    #[test]
    fn a_slicing_that_is_overtaken_does_nothing_more() {
        let contents =
            std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/models/calibration_cube.stl")).unwrap();
        let file = ModelFile::read("cube.stl", contents, &Observer::none()).unwrap();
        let files = ModelFiles::from([("cube.stl".to_owned(), Arc::new(file))]);
        let model = ProjectModel { file: "cube.stl".into(), ..ProjectModel::default() };
        let project = Project { models: vec![model], ..Project::default() };
        let (job, settings) = (project.job(&files, None).unwrap(), Settings::default());
        let ended_at = |n: usize| {
            let asked = AtomicUsize::new(0);
            let is_over = || asked.fetch_add(1, Ordering::Relaxed) + 1 >= n;
            let slicing = Slicing {
                revision: 1,
                project: &project,
                job: &job,
                settings: &settings,
                is_over: &is_over,
                clock: || Duration::ZERO,
            };
            let result = slicing.run(&mut StageCache::default(), &|_| {});
            (result, asked.load(Ordering::Relaxed))
        };
        let (done, all) = ended_at(usize::MAX);
        assert!(done.is_ok());
        for n in (0..POINTS).map(|point| 1 + point * (all - 1) / (POINTS - 1)) {
            let (result, asked) = ended_at(n);
            assert!(matches!(result, Err(JobError::Cancelled)), "{n} of {all}");
            assert_eq!(asked, n, "it goes on after question {n} of {all}");
        }
    }

    #[test]
    fn names_are_names_of_files() {
        assert_eq!(file_name("part", false), "part.gcode");
        assert_eq!(file_name("v1.2", false), "v1.2.gcode");
        assert_eq!(file_name("a/b.GCODE", true), "a_b.bgcode");
        assert_eq!(file_name(" ", false), "print.gcode");
    }
}
