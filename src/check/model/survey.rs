//! What a first reading notes of a print for the second.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Read};

use crate::gcode::{Action, Annotated, Reader, Stroke, each_line};
use crate::toolpath::Role;

/// A box around positions, in millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extent {
    pub low: [f64; 2],
    pub high: [f64; 2],
}

impl Extent {
    /// Extends the box to a point.
    pub fn add(extent: &mut Option<Self>, [x, y, _]: [f64; 3]) {
        let e = extent.get_or_insert(Self { low: [x, y], high: [x, y] });
        (e.low, e.high) = ([e.low[0].min(x), e.low[1].min(y)], [e.high[0].max(x), e.high[1].max(y)]);
    }

    pub fn middle(&self) -> [f64; 2] {
        [0, 1].map(|i| (self.low[i] + self.high[i]) / 2.0)
    }
}

/// Whether beads of a role are the model: not skirt, brim or support.
pub(in crate::check) fn is_part(role: Role) -> bool {
    !matches!(role, Role::Skirt | Role::Brim | Role::Support | Role::SupportInterface)
}

/// Whether a bead keeps its height; those of a scarf seam and of a spiral rise.
fn is_level(stroke: &Stroke) -> bool {
    (stroke.to[2] - stroke.from[2]).abs() < 1e-6
}

/// The heights of the model's beads in the current layer, by the file's count.
#[derive(Clone, Debug, Default)]
struct Heights {
    layer: Option<usize>,
    /// Length of level beads by height, micrometres.
    level_mm: BTreeMap<i64, f64>,
    /// How high the rising ones come, and their length.
    risen_um: Option<i64>,
    risen_mm: f64,
}

impl Heights {
    /// Those of layers: where beads rise, the one at which most of the others lie, or else the one that they rise to.
    fn of_layers(&self) -> Vec<i64> {
        let Some(risen_um) = self.risen_um else {
            return self.level_mm.keys().copied().collect();
        };
        let longest = self.level_mm.iter().max_by(|a, b| a.1.total_cmp(b.1));
        vec![longest.filter(|(_, mm)| **mm > self.risen_mm).map_or(risen_um, |(um, _)| *um)]
    }
}

/// The heights of a print, its position, and the share of it that is the model. It grows with the number of heights
/// only.
#[derive(Clone, Debug, Default)]
pub struct Survey {
    outer: Option<Extent>,
    all: Option<Extent>,
    /// Heights of the model's layers but the current one, and of all beads, micrometres.
    part_um: BTreeSet<i64>,
    all_um: BTreeSet<i64>,
    here: Heights,
    roles: bool,
    /// Filament and volume of the model's beads, and of all.
    part: [f64; 2],
    whole: [f64; 2],
}

impl Survey {
    /// Reads a file for what it prints.
    ///
    /// # Errors
    /// Those of reading.
    pub fn of(file: impl Read) -> io::Result<Self> {
        let (mut survey, mut reader) = (Self::default(), Reader::default());
        each_line(file, |line| survey.add(&reader.read(line)))?;
        Ok(survey)
    }

    /// Processes a line.
    pub(crate) fn add(&mut self, read: &Annotated<'_>) {
        let Action::Stroke(stroke) = &read.action else { return };
        if !stroke.extrudes() {
            return;
        }
        let um = (stroke.to[2] * 1000.0).round() as i64;
        let role = read.context.role;
        let amount = usize::from(stroke.volumetric);
        self.roles |= role.is_some();
        self.whole[amount] += stroke.fresh_mm;
        self.all_um.insert(um);
        Self::around(&mut self.all, stroke);
        if role.is_some_and(is_part) {
            self.part[amount] += stroke.fresh_mm;
            self.add_height(read.context.layer, stroke, um);
        }
        if role.is_some_and(Role::is_outer_wall) {
            Self::around(&mut self.outer, stroke);
        }
    }

    fn add_height(&mut self, layer: Option<usize>, stroke: &Stroke, um: i64) {
        if layer != self.here.layer {
            let before = std::mem::replace(&mut self.here, Heights { layer, ..Heights::default() });
            self.part_um.extend(before.of_layers());
        }
        if is_level(stroke) {
            *self.here.level_mm.entry(um).or_default() += stroke.xy_mm;
        } else {
            self.here.risen_um = self.here.risen_um.max(Some(um));
            self.here.risen_mm += stroke.xy_mm;
        }
    }

    fn around(extent: &mut Option<Extent>, stroke: &Stroke) {
        Extent::add(extent, stroke.from);
        Extent::add(extent, stroke.to);
    }

    /// Whether the file says what its beads are for.
    pub(super) fn has_roles(&self) -> bool {
        self.roles
    }

    /// Whether walls show where the part ends: in all files but those that name roles and have none.
    pub(super) fn has_edges(&self) -> bool {
        self.outer.is_some() || !self.roles
    }

    /// Volume of the model's beads; of all, where they cannot be distinguished.
    pub(super) fn part_volume_mm3(&self, area_mm2: f64) -> f64 {
        let [length_mm, volume_mm3] = if self.roles { self.part } else { self.whole };
        length_mm * area_mm2 + volume_mm3
    }

    /// Heights of the model's layers, millimetres, ascending.
    pub(super) fn heights_mm(&self) -> Vec<f64> {
        let mut heights_um = if self.roles { self.part_um.clone() } else { self.all_um.clone() };
        heights_um.extend(self.here.of_layers());
        heights_um.into_iter().map(|um| um as f64 / 1000.0).collect()
    }

    /// The lowest bead of all.
    pub(super) fn lowest_mm(&self) -> f64 {
        self.all_um.first().map_or(0.0, |um| *um as f64 / 1000.0)
    }

    /// Around the outer walls, and around all beads.
    pub(super) fn extents(&self) -> [Option<Extent>; 2] {
        [self.outer, self.all]
    }
}
