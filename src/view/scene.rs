//! What a G-code file draws: strokes by layer, with role, bead and speed, and marks.

use geometry::real;

use super::colors::{self, OTHER, SEAMED, SKIRT};
use crate::estimate::Machine;
use crate::gcode::{self, Action, Annotated, Clock, Context};
use crate::profile::Settings;
use crate::report::Measures;
use crate::toolpath::bead;

/// Moves further from the origin than this are left out: no machine makes them.
const LIMIT_MM: f64 = 10_000.0;
/// Chords stay this near to an arc.
const CHORD_TOLERANCE_MM: f64 = 0.01;
/// A step of Z is taken for a layer's height within these limits, and so is what a comment says.
const HEIGHTS_MM: (f64, f64) = (0.01, 5.0);
/// Lines read between two questions whether to go on.
const LINES: usize = 4096;
/// Beads are drawn no narrower and no wider than this.
const WIDTHS_MM: (f64, f64) = (0.05, 5.0);

/// A straight move. Arcs come as chords.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Start, millimetres.
    pub from: [f32; 3],
    /// End.
    pub to: [f32; 3],
    /// Index of the role in the palette; `None` for travel.
    pub role: Option<u8>,
    /// Width of the bead.
    pub width_mm: f32,
    /// Its height.
    pub height_mm: f32,
    /// Requested speed.
    pub speed_mm_s: f32,
    /// Plastic per second at that speed.
    pub flow_mm3_s: f32,
    /// The tool, counted from 0.
    pub tool: u8,
}

/// The kind of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkKind {
    /// Filament is retracted.
    Retraction,
    /// Filament is unretracted.
    Unretraction,
    /// An outer wall begins.
    Seam,
}

/// Something that happens at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Mark {
    pub kind: MarkKind,
    pub at: [f32; 3],
    /// Strokes of the layer before it.
    pub before: u32,
}

/// One layer, in the order in which it is printed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layer {
    /// Height of the nozzle.
    pub z_mm: f64,
    /// Its moves.
    pub strokes: Vec<Stroke>,
    /// Retractions and seams.
    pub marks: Vec<Mark>,
    /// Its lengths, counts and time.
    pub measures: Measures,
}

/// A print as its G-code draws it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// The layers from the first printed one on; moves of the start script belong to the first, those of the end
    /// script to the last.
    pub layers: Vec<Layer>,
    /// Measures of all.
    pub total: Measures,
    /// Moves that were left out because they lead further than 10 m from the origin.
    pub left_out: usize,
    /// Pictures show which tool prints, instead of what for.
    pub by_tool: bool,
}

impl Scene {
    /// The same with pictures that show which tool prints.
    #[must_use]
    pub fn colored_by_tool(self) -> Self {
        Self { by_tool: true, ..self }
    }

    /// Reads a G-code file of any common slicer. Filament and machine are those of the settings; widths that the file
    /// does not give follow from the amounts extruded. O(bytes).
    pub fn read(text: &[u8], settings: &Settings) -> Self {
        Self::read_watched(text, settings, &|| {})
    }

    /// As [`Scene::read`]; `go_on` is called every millisecond or so, and may unwind.
    pub(crate) fn read_watched(text: &[u8], settings: &Settings, go_on: &dyn Fn()) -> Self {
        let mut reader = Reader::new(settings);
        for (number, read) in gcode::annotate(text).enumerate() {
            if number % LINES == 0 {
                go_on();
            }
            reader.read(&read);
        }
        reader.finish()
    }

    /// Whether something is extruded along it.
    pub fn extrudes(&self) -> bool {
        self.layers.iter().flat_map(|layer| &layer.strokes).any(|stroke| stroke.role.is_some())
    }

    /// Whether nothing moves at all.
    pub fn is_empty(&self) -> bool {
        self.layers.iter().all(|layer| layer.strokes.is_empty())
    }

    /// Bounds of the roles in X and Y (of moves where nothing is extruded); `None` of an empty scene. What a start
    /// script primes does not count where there is anything else.
    pub fn bounds(&self) -> Option<[[f32; 2]; 2]> {
        let wanted: [&dyn Fn(&Stroke) -> bool; 3] =
            [&|s| s.role.is_some_and(|role| role != OTHER), &|s| s.role.is_some(), &|_| true];
        wanted.into_iter().find_map(|wanted| {
            let strokes = self.layers.iter().flat_map(|layer| &layer.strokes).filter(|s| wanted(s));
            strokes.flat_map(|s| [(s.from, s.width_mm), (s.to, s.width_mm)]).fold(
                None,
                |bounds, (p, width)| {
                    let [low, high] = bounds.unwrap_or([[f32::INFINITY; 2], [f32::NEG_INFINITY; 2]]);
                    let half = width / 2.0;
                    Some([
                        [low[0].min(p[0] - half), low[1].min(p[1] - half)],
                        [high[0].max(p[0] + half), high[1].max(p[1] + half)],
                    ])
                },
            )
        })
    }
}

/// The current reading.
struct Reader {
    /// Every lap is an account of the clock.
    clock: Clock,
    /// The layer that each lap belongs to.
    laps: Vec<usize>,
    area_mm2: f64,
    scene: Scene,
    layer: Layer,
    /// Index of the layer by the file's marks.
    index: usize,
    /// Z at which was extruded last, and the layer height that follows from it.
    extruded_z_mm: Option<f64>,
    step_mm: f64,
    /// Where the last extrusion ended, and whether there was travel since.
    bead_end: Option<[f64; 3]>,
    travelled: bool,
    /// Role of the stroke before, if it extruded.
    extruding: Option<u8>,
    tool: u8,
    /// Whether what follows is a prime tower, which is no part of an object.
    in_tower: bool,
}

impl Reader {
    fn new(settings: &Settings) -> Self {
        let machine = Machine::new(settings);
        Self {
            clock: Clock::new(&machine),
            laps: Vec::new(),
            area_mm2: machine.filament_area_mm2,
            scene: Scene::default(),
            layer: Layer::default(),
            index: 0,
            extruded_z_mm: None,
            step_mm: settings.layer.first_height.0,
            bead_end: None,
            travelled: false,
            extruding: None,
            tool: 0,
            in_tower: false,
        }
    }

    fn read(&mut self, read: &Annotated<'_>) {
        match read.context.layer {
            Some(layer) if layer > self.index => self.end_layer(),
            // The first mark: what came before, however high, belongs to the first layer.
            Some(layer) if layer < self.index => self.unite(),
            _ => {}
        }
        self.index = read.context.layer.unwrap_or(0);
        match read.action {
            Action::Stroke(stroke) => self.stroke(&stroke, read),
            Action::FirmwareRetract => {
                self.time(read);
                self.layer.measures.retractions += 1;
                self.mark(MarkKind::Retraction, self.nozzle());
            }
            Action::FirmwareUnretract => {
                self.time(read);
                self.mark(MarkKind::Unretraction, self.nozzle());
            }
            Action::Type(name) => {
                let is_tower = |known: &&[u8]| known.eq_ignore_ascii_case(name);
                self.in_tower = [&b"Wipe tower"[..], b"Prime tower", b"PRIME-TOWER"].iter().any(is_tower);
            }
            Action::Other => {
                if let Some(code) = read.line.code.filter(|code| code.letter == b'T') {
                    self.tool = u8::try_from(code.number).unwrap_or(self.tool);
                }
                self.time(read);
            }
        }
    }

    fn time(&mut self, read: &Annotated<'_>) {
        self.clock.step(&read.line, &read.action, self.laps.len());
    }

    /// Makes one layer of all so far, and continues with it.
    fn unite(&mut self) {
        self.end_layer();
        let mut all = Layer::default();
        for layer in std::mem::take(&mut self.scene.layers) {
            let before = all.strokes.len() as u32;
            all.marks.extend(layer.marks.iter().map(|mark| Mark { before: mark.before + before, ..*mark }));
            all.strokes.extend(layer.strokes);
            all.measures += &layer.measures;
        }
        self.scene.total = Measures::default();
        self.laps.fill(0);
        self.layer = all;
    }

    fn end_layer(&mut self) {
        let mut layer = std::mem::take(&mut self.layer);
        layer.z_mm = self.extruded_z_mm.unwrap_or(0.0);
        layer.measures.total_mm = layer.measures.print_mm + layer.measures.travel_mm;
        layer.measures.filament_mm = layer.measures.volume_mm3 / self.area_mm2;
        self.scene.total += &layer.measures;
        self.laps.push(self.scene.layers.len());
        self.scene.layers.push(layer);
    }

    fn nozzle(&self) -> [f32; 3] {
        let last = self.layer.strokes.last().or_else(|| self.scene.layers.last()?.strokes.last());
        last.map_or([0.0; 3], |stroke| stroke.to)
    }

    fn mark(&mut self, kind: MarkKind, at: [f32; 3]) {
        self.layer.marks.push(Mark { kind, at, before: self.layer.strokes.len() as u32 });
    }

    fn stroke(&mut self, stroke: &gcode::Stroke, read: &Annotated<'_>) {
        if stroke.from.iter().chain(&stroke.to).any(|mm| mm.abs() > LIMIT_MM) {
            self.scene.left_out += 1;
            return;
        }
        let extrudes = stroke.extrudes();
        if extrudes {
            self.rise(stroke.to[2]);
        }
        self.time(read);
        let at = stroke.from.map(|mm| mm as f32);
        if stroke.retracts {
            self.layer.measures.retractions += 1;
            self.mark(MarkKind::Retraction, at);
        } else if stroke.e_mm > stroke.fresh_mm + 1e-9 {
            self.mark(MarkKind::Unretraction, at);
        }
        self.layer.measures.volume_mm3 += stroke.fresh_mm3(self.area_mm2);
        if extrudes {
            self.extrude(stroke, &read.context);
        } else if stroke.from != stroke.to {
            self.extruding = None;
            if self.bead_end.is_some() && stroke.xy_mm > 1e-9 {
                self.layer.measures.travel_mm += stroke.xy_mm;
                self.travelled = true;
            }
            self.push(stroke, None, 0.0, 0.0);
        }
    }

    /// Takes note of the height at which something is extruded.
    fn rise(&mut self, z_mm: f64) {
        let step_mm = z_mm - self.extruded_z_mm.unwrap_or(0.0);
        if (HEIGHTS_MM.0..HEIGHTS_MM.1).contains(&step_mm) {
            self.step_mm = step_mm;
        }
        self.extruded_z_mm = Some(z_mm);
    }

    fn extrude(&mut self, stroke: &gcode::Stroke, context: &Context) {
        let role = match context.role {
            None if self.in_tower => SKIRT,
            role => colors::index(role),
        };
        if role == SEAMED && self.extruding != Some(role) {
            self.mark(MarkKind::Seam, stroke.from.map(|mm| mm as f32));
        }
        self.extruding = Some(role);
        let measures = &mut self.layer.measures;
        measures.print_mm += stroke.xy_mm;
        if let (Some(end), true) = (self.bead_end, self.travelled) {
            measures.link_mm += real::hypot(stroke.from[0] - end[0], stroke.from[1] - end[1]);
            measures.travels += 1;
        }
        (self.bead_end, self.travelled) = (Some(stroke.to), false);
        let height_mm = context.height_mm.unwrap_or(self.step_mm).clamp(HEIGHTS_MM.0, HEIGHTS_MM.1);
        let section_mm2 = self.volume_mm3(stroke) / stroke.xy_mm;
        let width_mm = context.width_mm.unwrap_or_else(|| bead::width_mm(section_mm2 / height_mm, height_mm));
        self.push(stroke, Some(role), width_mm.clamp(WIDTHS_MM.0, WIDTHS_MM.1), height_mm);
    }

    fn volume_mm3(&self, stroke: &gcode::Stroke) -> f64 {
        stroke.e_mm.max(0.0) * if stroke.volumetric { 1.0 } else { self.area_mm2 }
    }

    /// Adds a stroke, an arc as chords.
    fn push(&mut self, stroke: &gcode::Stroke, role: Option<u8>, width_mm: f64, height_mm: f64) {
        let chords = stroke.arc.map_or(1.0, |arc| {
            let radius = real::hypot(stroke.from[0] - arc.at[0], stroke.from[1] - arc.at[1]);
            let chord_mm = (8.0 * CHORD_TOLERANCE_MM * radius).sqrt();
            (stroke.xy_mm / chord_mm.max(1e-3)).ceil().clamp(1.0, 1000.0)
        });
        let flow = if role.is_some() {
            self.volume_mm3(stroke) / stroke.xy_mm.max(1e-6) * stroke.feed_mm_s
        } else {
            0.0
        };
        let mut from = stroke.from.map(|mm| mm as f32);
        for chord in 1..=chords as u32 {
            let to = stroke.at(f64::from(chord) / chords).map(|mm| mm as f32);
            self.layer.strokes.push(Stroke {
                from,
                to,
                role,
                width_mm: width_mm as f32,
                height_mm: height_mm as f32,
                speed_mm_s: stroke.feed_mm_s as f32,
                flow_mm3_s: flow as f32,
                tool: self.tool,
            });
            from = to;
        }
    }

    fn finish(mut self) -> Scene {
        if !self.layer.strokes.is_empty() {
            self.end_layer();
        }
        let Self { clock, laps, mut scene, .. } = self;
        for (seconds, layer) in clock.finish().into_iter().zip(laps) {
            scene.layers[layer].measures.total_s += seconds;
            scene.total.total_s += seconds;
        }
        scene
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TWO_LAYERS: &str = "M83\nG1 X0 Y0 F6000\n;LAYER_CHANGE\n;TYPE:External perimeter\n;WIDTH:0.5\n;HEIGHT:0.2\n\
        G1 Z.2\nG1 X10 E1 F600\nG1 Y10 E1\nG1 E-1 F1200\nG1 X0 F6000\nG1 E1 F1200\n;TYPE:Gap fill\nG1 Y0 E.5\n\
        ;LAYER_CHANGE\nG1 Z.4\nG1 X5 E.5\n";

    fn scene(text: &str) -> Scene {
        Scene::read(text.as_bytes(), &Settings::default())
    }

    #[test]
    fn strokes_know_what_they_are_for() {
        let scene = scene(TWO_LAYERS);
        assert_eq!(scene.layers.iter().map(|l| l.z_mm).collect::<Vec<_>>(), [0.2, 0.4]);
        let roles: Vec<_> = scene.layers[0].strokes.iter().filter_map(|s| s.role).collect();
        assert_eq!(roles, [0, 0, 7]);
        assert!(scene.layers[0].strokes.iter().all(|s| s.role.is_none() || s.width_mm == 0.5));
        let marks: Vec<_> = scene.layers[0].marks.iter().map(|m| m.kind).collect();
        assert_eq!(marks, [MarkKind::Seam, MarkKind::Retraction, MarkKind::Unretraction]);
    }

    #[test]
    fn its_measures_are_those_of_the_file() {
        let (scene, settings) = (scene(TWO_LAYERS), Settings::default());
        let measured = gcode::measure(TWO_LAYERS.as_bytes(), settings.filament.diameter);
        let Measures { print_mm, travel_mm, link_mm, travels, retractions, .. } = scene.total;
        let wanted = (measured.print_mm, measured.travel_mm, measured.link_mm, measured.travels);
        assert_eq!((print_mm, travel_mm, link_mm, travels), wanted);
        assert_eq!(retractions, measured.retractions);
    }

    #[test]
    fn without_comments_heights_tell_layers_and_amounts_tell_widths() {
        let text = "M83\nG1 Z.3 F600\nG1 X10 E.6\nG1 X0\nG1 Z.6\nG1 X10 E.6\nG1 Z5\nG1 X0";
        let scene = scene(text);
        assert_eq!(scene.layers.len(), 2);
        let width = scene.layers[1].strokes.iter().find(|s| s.role.is_some()).map(|s| s.width_mm);
        assert!(width.is_some_and(|mm| (mm - 0.545).abs() < 0.01), "{width:?}");
    }

    #[test]
    fn arcs_stay_near_their_circle() {
        let scene = scene("M83\nG1 X10 Y0 Z.2\nG3 X-10 Y0 I-10 J0 E1 F600");
        for stroke in scene.layers[0].strokes.iter().filter(|s| s.role.is_some()) {
            let middle = [0, 1].map(|i| (stroke.from[i] + stroke.to[i]) / 2.0);
            assert!((9.98..10.0).contains(&middle[0].hypot(middle[1])));
        }
    }

    #[test]
    fn moves_that_no_machine_makes_are_left_out() {
        let scene = scene("M83\nG1 X1e9 Y99999999999999999 F600\nG1 X1 Y1 Z.2\nG1 X2 Y2\nG1 X3 E1");
        assert_eq!((scene.left_out, scene.extrudes()), (2, true));
        assert!(Scene::read(b"\xff\xfe nothing", &Settings::default()).is_empty());
    }
}
