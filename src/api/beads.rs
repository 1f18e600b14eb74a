//! What a layer prints, vertex by vertex.

use crate::estimate::{Machine, chords, move_times_s};
use crate::job::{Job, JobError};
use crate::motion::{LayerMoves, Move};
use crate::observer::Observer;
use crate::output::Output;
use crate::pipeline::Pipeline;
use crate::profile::Settings;
use crate::report::Summary;
use crate::toolpath::Role;

/// The paths of a layer as the machine draws them, in one array for each quantity.
///
/// Path `i` has the role `roles[i]` and the vertices `starts[i]..starts[i + 1]`. Speed and time of a vertex are those of the
/// move that ends there; a path's first vertex, where none does, has 0.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Beads {
    /// First vertex of each path, and the number of all vertices.
    pub starts: Vec<usize>,
    /// Roles of the paths.
    pub roles: Vec<Role>,
    /// Positions of the nozzle on the bed, millimetres.
    pub points_mm: Vec<[f64; 3]>,
    /// Width of the bead, millimetres.
    pub widths_mm: Vec<f64>,
    /// Speed of the move, where the machine reaches it, mm/s.
    pub speeds_mm_s: Vec<f64>,
    /// Duration of the move, with speeding up and slowing down, seconds.
    pub times_s: Vec<f64>,
}

/// A job that was sliced: its G-code, and what each layer draws, worked out when it is asked for.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SlicedJob {
    /// The G-code.
    pub gcode: Vec<u8>,
    /// Size, time, filament, travel, repairs, warnings.
    pub summary: Summary,
    /// Moves of the layers, from the bed up.
    pub layers: Vec<LayerMoves>,
    /// The machine that makes them.
    pub machine: Machine,
}

impl SlicedJob {
    /// Slices a job, models and all, as the program does.
    ///
    /// # Errors
    /// Those of [`Slicer::slice`](super::Slicer::slice); a model that cannot be read.
    ///
    /// # Examples
    /// ```
    /// use pathwright::job::Job;
    /// use pathwright::{Observer, Settings, SlicedJob};
    ///
    /// let job = Job::of(["models/calibration_cube.stl".into()]);
    /// let sliced = SlicedJob::new(&job, &Settings::default(), &Observer::none())?;
    /// let beads = sliced.beads(3);
    /// assert_eq!(beads.starts.len(), beads.roles.len() + 1);
    /// assert_eq!(beads.starts.last(), Some(&beads.points_mm.len()));
    /// # Ok::<(), pathwright::Error>(())
    /// ```
    pub fn new(job: &Job, settings: &Settings, observer: &Observer<'_>) -> Result<Self, JobError> {
        Self::followed(job, settings, |_, _| {}, observer)
    }

    /// As [`SlicedJob::new`]; `on_layer` is shown each layer as soon as it is finished, from the bed up, for [`Beads::of`].
    ///
    /// # Errors
    /// As [`SlicedJob::new`].
    pub fn followed(
        job: &Job,
        settings: &Settings,
        mut on_layer: impl FnMut(&LayerMoves, &Machine) + Send,
        observer: &Observer<'_>,
    ) -> Result<Self, JobError> {
        let (mut output, mut layers) = (Output::memory(), Vec::new());
        let machine = Machine::new(settings);
        let keep = |moves: LayerMoves| {
            on_layer(&moves, &machine);
            layers.push(moves);
        };
        let summary = Pipeline::slice_moves(job, settings, &mut output, keep, observer)?;
        Ok(Self { gcode: output.into_bytes(), summary, layers, machine })
    }

    /// What a layer draws; see [`Beads::of`].
    ///
    /// # Panics
    /// If there is no such layer.
    pub fn beads(&self, layer: usize) -> Beads {
        Beads::of(&self.layers[layer], &self.machine)
    }
}

impl Beads {
    /// What a layer draws from stop to stop: travels, retractions and other roles end a path. O(moves).
    pub fn of(layer: &LayerMoves, machine: &Machine) -> Self {
        let is_rising = layer.moves.iter().any(|step| matches!(step, Move::Ramp { .. }));
        let mut pen = Pen {
            beads: Beads::default(),
            at: layer.from.xy,
            z_mm: if is_rising { layer.from.z_mm } else { layer.z_mm },
            role: Role::Perimeter,
            width_mm: 0.0,
            is_down: false,
        };
        for (step, seconds) in layer.moves.iter().zip(move_times_s(layer, machine)) {
            pen.follow(step, seconds);
        }
        pen.beads.starts.push(pen.beads.points_mm.len());
        pen.beads
    }
}

/// Draws moves.
struct Pen {
    beads: Beads,
    /// Position, where it is known.
    at: Option<[f64; 2]>,
    z_mm: f64,
    role: Role,
    width_mm: f64,
    /// Whether the next bead goes on with the last path.
    is_down: bool,
}

impl Pen {
    fn follow(&mut self, step: &Move, seconds: f64) {
        match *step {
            Move::Bead { role, width_mm, .. } => {
                self.is_down &= role == self.role;
                (self.role, self.width_mm) = (role, width_mm);
            }
            Move::Travel { to, .. } | Move::Wipe { to, .. } => self.lifted(Some(to), self.z_mm),
            Move::Climb { to, z_mm, .. } => self.lifted(Some(to), z_mm),
            Move::Lift { z_mm, .. } => self.lifted(self.at, z_mm),
            Move::Retract { .. } | Move::Pause | Move::ColorChange | Move::ToolChange(_) | Move::Swap(_) => {
                self.is_down = false;
            }
            Move::Extrude { to, speed, .. } => self.draw(to, self.z_mm, speed.0, seconds),
            Move::Ramp { to, z_mm, speed, .. } => self.draw(to, z_mm, speed.0, seconds),
            Move::Arc { to, center, clockwise, speed, .. } => {
                self.arc(to, center, clockwise, speed.0, seconds);
            }
            Move::Unretract { .. } | Move::Fan(_) | Move::Acceleration(_) => {}
            Move::Nozzle(_) | Move::Bed(_) | Move::Object(_) => {}
        }
    }

    /// Elsewhere without a bead.
    fn lifted(&mut self, at: Option<[f64; 2]>, z_mm: f64) {
        (self.at, self.z_mm, self.is_down) = (at, z_mm, false);
    }

    fn draw(&mut self, to: [f64; 2], z_mm: f64, speed_mm_s: f64, seconds: f64) {
        if !self.is_down {
            self.beads.starts.push(self.beads.points_mm.len());
            self.beads.roles.push(self.role);
            if let Some([x, y]) = self.at {
                self.push([x, y, self.z_mm], 0.0, 0.0);
            }
            self.is_down = true;
        }
        self.push([to[0], to[1], z_mm], speed_mm_s, seconds);
        (self.at, self.z_mm) = (Some(to), z_mm);
    }

    fn push(&mut self, point_mm: [f64; 3], speed_mm_s: f64, seconds: f64) {
        self.beads.points_mm.push(point_mm);
        self.beads.widths_mm.push(self.width_mm);
        self.beads.speeds_mm_s.push(speed_mm_s);
        self.beads.times_s.push(seconds);
    }

    fn arc(&mut self, to: [f64; 2], center: [f64; 2], clockwise: bool, speed_mm_s: f64, seconds: f64) {
        let Some(at) = self.at else { return self.draw(to, self.z_mm, speed_mm_s, seconds) };
        let (count, ends) = chords(at, to, center, clockwise);
        for end in ends {
            self.draw(end, self.z_mm, speed_mm_s, seconds / count);
        }
    }
}
