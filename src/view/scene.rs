//! What a G-code file draws: strokes by layer, with role, bead and speed, and marks on the way.

use super::colors::{self, ROLES, SEAMED};
use crate::estimate::Machine;
use crate::gcode::{self, Action, Clock, Step};
use crate::profile::Settings;
use crate::report::Measures;
use crate::toolpath::bead;

/// Moves further from the origin than this are left out: no machine makes them.
const LIMIT_MM: f64 = 10_000.0;
/// Chords stay this near to an arc.
const CHORD_TOLERANCE_MM: f64 = 0.01;
/// Without comments on layers, a new one begins where something is extruded this much higher or lower.
const LAYER_STEP_MM: f64 = 0.04;
/// Beads are drawn no narrower and no wider than this.
const WIDTHS_MM: (f64, f64) = (0.05, 5.0);

/// A straight move. Arcs come as chords.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Start, millimetres.
    pub from: [f32; 3],
    /// End.
    pub to: [f32; 3],
    /// What is extruded, as an index into the palette's roles; `None`: nothing, this is travel.
    pub role: Option<u8>,
    /// Width of the bead.
    pub width_mm: f32,
    /// Its height.
    pub height_mm: f32,
    /// Speed asked for.
    pub speed_mm_s: f32,
    /// Plastic per second at that speed.
    pub flow_mm3_s: f32,
}

/// What happens at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkKind {
    /// Filament is pulled back.
    Retraction,
    /// Filament is pushed forward again.
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
    /// Layers from the first one printed on; what a start script does belongs to the first, what an end script does to
    /// the last.
    pub layers: Vec<Layer>,
    /// Measures of all.
    pub total: Measures,
    /// Moves that were left out because they lead further than 10 m from the origin.
    pub left_out: usize,
}

impl Scene {
    /// Reads a G-code file of any common slicer. Where it does not tell widths or the diameter of its filament, these
    /// follow from the amounts extruded and from the settings. O(bytes).
    pub fn read(text: &[u8], settings: &Settings) -> Self {
        let mut reader = Reader::new(text, settings);
        for step in gcode::replay(text) {
            reader.step(&step);
        }
        reader.finish()
    }

    /// Whether something is extruded on the way.
    pub fn extrudes(&self) -> bool {
        self.layers.iter().flat_map(|layer| &layer.strokes).any(|stroke| stroke.role.is_some())
    }

    /// Whether nothing moves at all.
    pub fn is_empty(&self) -> bool {
        self.layers.iter().all(|layer| layer.strokes.is_empty())
    }

    /// Smallest and largest X and Y that roles touch (where nothing is extruded: that moves touch); `None` of an empty
    /// scene. What a start script primes does not count where there is anything else.
    pub fn bounds(&self) -> Option<[[f32; 2]; 2]> {
        let other = ROLES.len() as u8 - 1;
        let wanted: [&dyn Fn(&Stroke) -> bool; 3] =
            [&|s| s.role.is_some_and(|role| role != other), &|s| s.role.is_some(), &|_| true];
        wanted.into_iter().find_map(|wanted| {
            let strokes = self.layers.iter().flat_map(|layer| &layer.strokes).filter(|s| wanted(s));
            strokes.flat_map(|s| [(s.from, s.width_mm), (s.to, s.width_mm)]).fold(None, |bounds, (p, width)| {
                let [low, high] = bounds.unwrap_or([[f32::INFINITY; 2], [f32::NEG_INFINITY; 2]]);
                let half = width / 2.0;
                Some([
                    [low[0].min(p[0] - half), low[1].min(p[1] - half)],
                    [high[0].max(p[0] + half), high[1].max(p[1] + half)],
                ])
            })
        })
    }
}

/// How a file tells that a layer begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LayerSign {
    Comment(&'static str),
    Height,
}

impl LayerSign {
    /// The first of the usual comments that the file has.
    fn of(text: &[u8]) -> Self {
        const COMMENTS: [&str; 3] = ["LAYER_CHANGE", "CHANGE_LAYER", "LAYER:"];
        let mut found = COMMENTS.len();
        for line in gcode::lines(text) {
            let comment = line.comment.map(<[u8]>::trim_ascii_start).unwrap_or_default();
            let known = COMMENTS.iter().position(|sign| comment.starts_with(sign.as_bytes()));
            found = found.min(known.unwrap_or(found));
            if found == 0 {
                break;
            }
        }
        COMMENTS.get(found).map_or(Self::Height, |comment| Self::Comment(comment))
    }
}

/// The reading under way.
struct Reader {
    sign: LayerSign,
    clock: Clock,
    area_mm2: f64,
    scene: Scene,
    layer: Layer,
    /// Whether the layer has begun by a comment or an extrusion; before, it holds the start script.
    begun: bool,
    role: usize,
    /// Bead by `;WIDTH:` and `;HEIGHT:`.
    width_mm: Option<f64>,
    height_mm: Option<f64>,
    /// Z at which was extruded last, and the layer height that follows from it.
    extruded_z_mm: Option<f64>,
    step_mm: f64,
    /// Where the last extrusion ended, and whether there was travel since.
    bead_end: Option<[f64; 3]>,
    travelled: bool,
    /// Role of the stroke before, if it extruded.
    extruding: Option<usize>,
}

impl Reader {
    fn new(text: &[u8], settings: &Settings) -> Self {
        let machine = Machine::new(settings);
        Self {
            sign: LayerSign::of(text),
            clock: Clock::new(&machine),
            area_mm2: machine.filament_area_mm2,
            scene: Scene::default(),
            layer: Layer::default(),
            begun: false,
            role: ROLES.len() - 1,
            width_mm: None,
            height_mm: None,
            extruded_z_mm: None,
            step_mm: settings.layer.first_height.0,
            bead_end: None,
            travelled: false,
            extruding: None,
        }
    }

    fn step(&mut self, step: &Step<'_>) {
        match step.action {
            Action::Stroke(stroke) => self.stroke(&stroke, step),
            Action::Type(name) => self.role = colors::role(name),
            Action::FirmwareRetract => {
                self.layer.measures.retractions += 1;
                self.mark(MarkKind::Retraction, self.nozzle());
            }
            Action::FirmwareUnretract => self.mark(MarkKind::Unretraction, self.nozzle()),
            Action::Other => {
                self.clock.step(step);
                if let Some(comment) = step.line.comment {
                    self.comment(comment.trim_ascii());
                }
            }
        }
    }

    fn comment(&mut self, comment: &[u8]) {
        let number = |name: &str| {
            let value = comment.strip_prefix(name.as_bytes())?;
            std::str::from_utf8(value).ok()?.trim().parse::<f64>().ok().filter(|mm| *mm > 0.0 && *mm < 100.0)
        };
        if let Some(width) = number("WIDTH:").or_else(|| number("LINE_WIDTH:")) {
            self.width_mm = Some(width);
        } else if let Some(height) = number("HEIGHT:").or_else(|| number("LAYER_HEIGHT:")) {
            self.height_mm = Some(height);
        } else if let Some(name) = comment.strip_prefix(b"FEATURE:") {
            self.role = colors::role(name);
        } else if let LayerSign::Comment(sign) = self.sign
            && comment.starts_with(sign.as_bytes())
        {
            self.begin_layer();
        }
    }

    fn begin_layer(&mut self) {
        if std::mem::replace(&mut self.begun, true) {
            self.end_layer();
        }
    }

    fn end_layer(&mut self) {
        let mut layer = std::mem::take(&mut self.layer);
        layer.z_mm = self.extruded_z_mm.unwrap_or(0.0);
        layer.measures.total_s = self.clock.lap().0;
        layer.measures.total_mm = layer.measures.print_mm + layer.measures.travel_mm;
        layer.measures.filament_mm = layer.measures.volume_mm3 / self.area_mm2;
        self.scene.total += &layer.measures;
        self.scene.layers.push(layer);
    }

    fn nozzle(&self) -> [f32; 3] {
        let last = self.layer.strokes.last().or_else(|| self.scene.layers.last()?.strokes.last());
        last.map_or([0.0; 3], |stroke| stroke.to)
    }

    fn mark(&mut self, kind: MarkKind, at: [f32; 3]) {
        self.layer.marks.push(Mark { kind, at, before: self.layer.strokes.len() as u32 });
    }

    fn stroke(&mut self, stroke: &gcode::Stroke, step: &Step<'_>) {
        if stroke.from.iter().chain(&stroke.to).any(|mm| mm.abs() > LIMIT_MM) {
            self.scene.left_out += 1;
            return;
        }
        let extrudes = stroke.extrudes();
        if extrudes {
            self.rise(stroke.to[2]);
        }
        self.clock.step(step);
        let at = stroke.from.map(|mm| mm as f32);
        if stroke.retracts {
            self.layer.measures.retractions += 1;
            self.mark(MarkKind::Retraction, at);
        } else if stroke.e_mm > stroke.fresh_mm + 1e-9 {
            self.mark(MarkKind::Unretraction, at);
        }
        self.layer.measures.volume_mm3 += stroke.fresh_mm * self.area_mm2;
        if extrudes {
            self.extrude(stroke);
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
        let before = self.extruded_z_mm;
        if before.is_none_or(|before| (z_mm - before).abs() > LAYER_STEP_MM) {
            if self.sign == LayerSign::Height {
                self.begin_layer();
            }
            let step_mm = z_mm - before.unwrap_or(0.0);
            self.step_mm = if (0.0..2.0).contains(&step_mm) { step_mm } else { self.step_mm };
        }
        self.extruded_z_mm = Some(z_mm);
    }

    fn extrude(&mut self, stroke: &gcode::Stroke) {
        if SEAMED.contains(&self.role) && self.extruding != Some(self.role) {
            self.mark(MarkKind::Seam, stroke.from.map(|mm| mm as f32));
        }
        self.extruding = Some(self.role);
        let measures = &mut self.layer.measures;
        measures.print_mm += stroke.xy_mm;
        if let (Some(end), true) = (self.bead_end, self.travelled) {
            measures.link_mm += (stroke.from[0] - end[0]).hypot(stroke.from[1] - end[1]);
            measures.travels += 1;
        }
        (self.bead_end, self.travelled) = (Some(stroke.to), false);
        let height_mm = self.height_mm.unwrap_or(self.step_mm);
        let section_mm2 = stroke.e_mm * self.area_mm2 / stroke.xy_mm;
        let width_mm = self.width_mm.unwrap_or_else(|| bead::width_mm(section_mm2 / height_mm, height_mm));
        self.push(stroke, Some(self.role as u8), width_mm.clamp(WIDTHS_MM.0, WIDTHS_MM.1), height_mm);
    }

    /// Adds a stroke, an arc as chords.
    fn push(&mut self, stroke: &gcode::Stroke, role: Option<u8>, width_mm: f64, height_mm: f64) {
        let chords = stroke.arc.map_or(1.0, |arc| {
            let radius = (stroke.from[0] - arc.at[0]).hypot(stroke.from[1] - arc.at[1]);
            let chord_mm = (8.0 * CHORD_TOLERANCE_MM * radius).sqrt();
            (stroke.xy_mm / chord_mm.max(1e-3)).ceil().clamp(1.0, 1000.0)
        });
        let flow = if role.is_some() {
            stroke.e_mm.max(0.0) * self.area_mm2 / stroke.xy_mm.max(1e-6) * stroke.feed_mm_s
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
            });
            from = to;
        }
    }

    fn finish(mut self) -> Scene {
        if !self.layer.strokes.is_empty() {
            self.end_layer();
        }
        self.scene
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
