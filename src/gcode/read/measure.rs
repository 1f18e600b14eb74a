//! Lengths and volumes of a file.

use std::collections::BTreeSet;

use geometry::real;

use super::replay::{Action, Replay, Stroke, replay};
use crate::motion::filament_area_mm2;
use crate::units::Mm;

/// A travel longer than this counts as long.
const LONG_TRAVEL_MM: f64 = 2.0;

/// The sums of one type of feature.
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(missing_docs)]
pub struct TypeMeasure {
    pub name: String,
    pub print_mm: f64,
    pub volume_mm3: f64,
}

/// Distances, amounts and counts of a printed file. Distances are in X and Y and count from the first extruding move
/// on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measure {
    /// Distance while extruding.
    pub print_mm: f64,
    /// Distance without extrusion.
    pub travel_mm: f64,
    /// Straight lines from the end of each extruded run to the start of the next.
    pub link_mm: f64,
    /// Runs of moves without extrusion.
    pub travels: usize,
    /// Of these, the ones longer than 2 mm.
    pub long_travels: usize,
    /// Filament retracted, by E or G10.
    pub retractions: usize,
    /// Filament pushed out, retractions netted out.
    pub volume_mm3: f64,
    /// Distinct heights at which something was extruded, micrometres, ascending.
    pub heights_um: Vec<i64>,
    /// Sums by `;TYPE:` or its equivalents, in order of appearance; `none` before the first.
    pub by_type: Vec<TypeMeasure>,
}

/// Replays a file and sums it up.
pub fn measure(text: &[u8], filament_diameter: Mm) -> Measure {
    measure_on(&mut replay(text), filament_diameter, None)
}

/// Sums up what is left of a replay. `bead_end`: where the last extrusion ended, if there was one before.
pub fn measure_on(steps: &mut Replay<'_>, filament_diameter: Mm, bead_end: Option<[f64; 3]>) -> Measure {
    let mut meter = Meter::new(filament_diameter, bead_end);
    steps.for_each(|step| meter.add(&step.action));
    meter.finish()
}

/// Sums up actions one by one.
#[derive(Clone, Debug)]
pub struct Meter {
    area_mm2: f64,
    out: Measure,
    state: MeasureState,
    kind: usize,
}

impl Meter {
    /// Nothing yet. `bead_end`: where the last extrusion ended, if there was one before.
    pub fn new(filament_diameter: Mm, bead_end: Option<[f64; 3]>) -> Self {
        let mut out = Measure::default();
        let kind = out.kind(b"none");
        let state = MeasureState { last_end: bead_end, ..MeasureState::default() };
        Self { area_mm2: filament_area_mm2(filament_diameter), out, state, kind }
    }

    /// Adds what a line does.
    pub fn add(&mut self, action: &Action<'_>) {
        let out = &mut self.out;
        match action {
            Action::Stroke(stroke) => {
                let volume_mm3 = stroke.fresh_mm3(self.area_mm2);
                out.volume_mm3 += volume_mm3;
                out.by_type[self.kind].volume_mm3 += volume_mm3;
                out.retractions += usize::from(stroke.retracts);
                if stroke.extrudes() {
                    out.by_type[self.kind].print_mm += stroke.xy_mm;
                    self.state.extrude(stroke, out);
                } else if stroke.xy_mm > 1e-9 && self.state.last_end.is_some() {
                    out.travel_mm += stroke.xy_mm;
                    *self.state.travel_mm.get_or_insert(0.0) += stroke.xy_mm;
                }
            }
            Action::FirmwareRetract => out.retractions += 1,
            Action::Type(name) => self.kind = out.kind(name),
            Action::FirmwareUnretract | Action::Other => {}
        }
    }

    /// The sums.
    pub fn finish(mut self) -> Measure {
        self.out.by_type.retain(|t| t.print_mm > 0.0 || t.volume_mm3 > 0.0);
        self.out.heights_um = self.state.heights_um.into_iter().collect();
        self.out
    }
}

impl Measure {
    /// Distance with and without extrusion.
    pub fn total_mm(&self) -> f64 {
        self.print_mm + self.travel_mm
    }

    fn kind(&mut self, name: &[u8]) -> usize {
        let found = self.by_type.iter().position(|t| t.name.as_bytes() == name);
        found.unwrap_or_else(|| {
            self.by_type
                .push(TypeMeasure { name: String::from_utf8_lossy(name).into_owned(), ..Default::default() });
            self.by_type.len() - 1
        })
    }
}

/// State of the measurement: the current travel and the heights extruded at.
#[derive(Clone, Debug, Default)]
struct MeasureState {
    /// Where the last extrusion ended.
    last_end: Option<[f64; 3]>,
    /// Length travelled since.
    travel_mm: Option<f64>,
    /// The height extruded at last, and all so far.
    height_mm: Option<f64>,
    heights_um: BTreeSet<i64>,
}

impl MeasureState {
    fn extrude(&mut self, stroke: &Stroke, out: &mut Measure) {
        out.print_mm += stroke.xy_mm;
        if let (Some(end), Some(travel_mm)) = (self.last_end, self.travel_mm.take()) {
            out.link_mm += real::hypot(stroke.from[0] - end[0], stroke.from[1] - end[1]);
            out.travels += 1;
            out.long_travels += usize::from(travel_mm > LONG_TRAVEL_MM);
        }
        self.last_end = Some(stroke.to);
        if self.height_mm.replace(stroke.to[2]) != Some(stroke.to[2]) {
            self.heights_um.insert((stroke.to[2] * 1000.0).round() as i64);
        }
    }
}
