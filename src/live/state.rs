//! What a session knows, and whom it tells.

use std::collections::VecDeque;
use std::sync::Arc;

use super::event::Event;
use super::results::Results;
use crate::job::{ModelFiles, Project};

/// Finished revisions that are kept.
const KEPT: usize = 2;

/// A revision that waits for its slicing.
pub(super) struct Wanted {
    pub revision: u64,
    pub project: Arc<Project>,
}

/// Whom a session tells; who answers `false` is told no more.
pub(super) type Listener = Box<dyn Fn(&Event) -> bool + Send>;

/// What a session knows.
#[derive(Default)]
pub(super) struct State {
    pub files: ModelFiles,
    /// The project of the last revision.
    pub project: Option<Arc<Project>>,
    /// The last revision that was wanted.
    pub latest: u64,
    /// Revisions before this one are overtaken.
    pub first: u64,
    pub wanted: VecDeque<Wanted>,
    /// Whether somebody works on what is wanted.
    pub is_running: bool,
    pub is_closed: bool,
    /// Of the latest revisions everything that a new subscriber must know.
    told: Vec<Event>,
    listeners: Vec<(u64, Listener)>,
    last_listener: u64,
    results: VecDeque<Results>,
}

impl State {
    /// Takes up new revisions in place of all others. The first one's number.
    pub fn want(&mut self, projects: Vec<Arc<Project>>) -> u64 {
        self.first = self.latest + 1;
        self.wanted.clear();
        self.told.clear();
        for project in projects {
            self.latest += 1;
            self.project = Some(project.clone());
            self.wanted.push_back(Wanted { revision: self.latest, project });
        }
        self.first
    }

    /// Tells everybody, unless the revision is overtaken.
    pub fn tell(&mut self, event: Event) {
        if event.revision() < self.first || self.is_closed {
            return;
        }
        let is_same_progress =
            |told: &Event| matches!(told, Event::Progress(_)) && told.revision() == event.revision();
        if matches!(event, Event::Progress(_)) || event.is_last() {
            self.told.retain(|told| !is_same_progress(told));
        }
        if matches!(event, Event::Placed(_)) {
            let revision = event.revision();
            self.told.retain(|told| !(matches!(told, Event::Placed(_)) && told.revision() == revision));
        }
        self.listeners.retain(|(_, listener)| listener(&event));
        self.told.push(event);
    }

    /// Tells a new listener all that it must know, and from now on what is new. Its number.
    pub fn listen(&mut self, listener: Listener) -> u64 {
        self.last_listener += 1;
        if self.told.iter().all(&listener) {
            self.listeners.push((self.last_listener, listener));
        }
        self.last_listener
    }

    /// Ends what [`listen`](Self::listen) began.
    pub fn forget(&mut self, number: u64) {
        self.listeners.retain(|(listener, _)| *listener != number);
    }

    /// Tells nobody any more.
    pub fn close(&mut self) {
        self.is_closed = true;
        self.wanted.clear();
        self.listeners.clear();
        self.results.clear();
        self.files.clear();
    }

    /// A name that no other model has.
    pub fn unique(&self, name: &str) -> String {
        let name = name.rsplit(['/', '\\']).next().unwrap_or(name);
        let name = if name.is_empty() { "model.stl" } else { name };
        let (stem, ending) =
            name.rsplit_once('.').map_or((name, String::new()), |(a, b)| (a, format!(".{b}")));
        let numbered = (2..).map(|number| format!("{stem} ({number}){ending}"));
        let mut names = std::iter::once(name.to_owned()).chain(numbered);
        names.find(|name| !self.files.contains_key(name)).unwrap_or_default()
    }

    /// What came of a revision, if that is kept.
    pub fn results(&self, revision: u64) -> Option<&Results> {
        self.results.iter().find(|results| results.revision == revision)
    }

    /// The last finished revision before another.
    pub fn finished_before(&self, revision: u64) -> Option<&Results> {
        let finished = self.results.iter().filter(|results| results.is_complete());
        finished.filter(|results| results.revision < revision).max_by_key(|results| results.revision)
    }

    /// Keeps what came of a revision, and drops what is older than the last two finished ones, or more than `most_bytes`
    /// beside the newest.
    pub fn keep(&mut self, mut results: Results, most_bytes: usize) {
        if let Some(index) = self.results.iter().position(|known| known.revision == results.revision) {
            let known = self.results.remove(index).unwrap_or_default();
            results.walls = results.walls.or(known.walls);
        }
        self.results.push_back(results);
        let finished = |state: &Self| state.results.iter().filter(|results| results.is_complete()).count();
        // Walls of a revision that was overtaken are of no use once there is something newer.
        let newest = self.results.back().map_or(0, |results| results.revision);
        let first = self.first;
        self.results.retain(|results| {
            results.is_complete() || results.revision == newest || results.revision >= first
        });
        while finished(self) > KEPT {
            let oldest = self.results.iter().position(Results::is_complete).unwrap_or(0);
            self.results.remove(oldest);
        }
        while self.results.len() > 1 && self.results_bytes() > most_bytes {
            self.results.pop_front();
        }
    }

    /// About how many bytes results hold.
    pub fn results_bytes(&self) -> usize {
        self.results.iter().map(Results::bytes).sum()
    }
}
