//! Follows G-code as a machine does: positions, modes, filament.

use geometry::real;

use super::lexer::{Code, Line, Lines, Words, lines};
use super::marks::{Mark, mark};
use crate::motion::arc_mm;

/// The centre of an arc and its sense.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Center {
    pub at: [f64; 2],
    pub clockwise: bool,
}

/// A G0, G1, G2 or G3. Millimetres throughout, also where the file is in inches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Start.
    pub from: [f64; 3],
    /// End.
    pub to: [f64; 3],
    /// The circle, of G2 and G3.
    pub arc: Option<Center>,
    /// Length of the move in X and Y.
    pub xy_mm: f64,
    /// Filament fed (negative: retracted).
    pub e_mm: f64,
    /// Of that, the part that is not just unretraction.
    pub fresh_mm: f64,
    /// Whether it begins a retraction.
    pub retracts: bool,
    /// Feed rate in force, mm/s.
    pub feed_mm_s: f64,
    /// Whether amounts of filament are volumes, cubic millimetres, instead of lengths (UltiGCode, M200).
    pub volumetric: bool,
    /// Whether its words are written [plainly](Words::are_plain).
    pub plain: bool,
}

impl Stroke {
    /// The position after a share (0 to 1) of the move.
    pub fn at(&self, share: f64) -> [f64; 3] {
        let straight = [0, 1, 2].map(|i| self.from[i] + (self.to[i] - self.from[i]) * share);
        let Some(center) = self.arc.filter(|_| share < 1.0) else { return straight };
        let from = [self.from[0] - center.at[0], self.from[1] - center.at[1]];
        let turn = self.xy_mm / real::hypot(from[0], from[1]).max(f64::MIN_POSITIVE) * share;
        let (sine, cosine) = real::sin_cos(if center.clockwise { -turn } else { turn });
        [
            center.at[0] + from[0] * cosine - from[1] * sine,
            center.at[1] + from[0] * sine + from[1] * cosine,
            straight[2],
        ]
    }

    /// Volume pushed out, of filament with this cross-section.
    pub fn fresh_mm3(&self, filament_area_mm2: f64) -> f64 {
        if self.volumetric { self.fresh_mm } else { self.fresh_mm * filament_area_mm2 }
    }

    /// Whether it extrudes while moving in X and Y. Lengths below a picometre are none.
    pub fn extrudes(&self) -> bool {
        self.e_mm > 1e-9 && self.xy_mm > 1e-9
    }
}

/// The action of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action<'a> {
    /// It moves the machine.
    Stroke(Stroke),
    /// G10.
    FirmwareRetract,
    /// G11.
    FirmwareUnretract,
    /// A comment on a line of its own that says what follows (`;TYPE:` and its like), and the name.
    Type(&'a [u8]),
    /// Anything else; modes and positions that it sets have been taken into account.
    Other,
}

/// A line and what it does.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Step<'a> {
    pub line: Line<'a>,
    pub action: Action<'a>,
}

/// Replays a file from the start, line by line.
pub fn replay(text: &[u8]) -> Replay<'_> {
    Replay { lines: lines(text), state: State::default() }
}

/// Replays text that continues a print: absolute positions, the nozzle at `position`, nothing retracted.
pub fn resume(text: &[u8], position: [f64; 3], relative_e: bool) -> Replay<'_> {
    Replay { lines: lines(text), state: State { position, e_absolute: !relative_e, ..State::default() } }
}

/// Iterator of [`replay`].
#[derive(Clone, Debug)]
pub struct Replay<'a> {
    lines: Lines<'a>,
    state: State,
}

impl<'a> Iterator for Replay<'a> {
    type Item = Step<'a>;

    fn next(&mut self) -> Option<Step<'a>> {
        let line = self.lines.next()?;
        let action = self.state.follow(&line);
        Some(Step { line, action })
    }
}

impl Replay<'_> {
    /// Where the nozzle is after the lines replayed so far.
    pub fn position(&self) -> [f64; 3] {
        self.state.position
    }
}

/// What a machine keeps in mind between lines. It can follow lines from anywhere, so texts need not be in memory
/// as a whole. As in Marlin, G90 and G91 set E's mode too.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Where the nozzle is.
    pub position: [f64; 3],
    /// The extruder's position, in the unit of the file's E.
    pub e: f64,
    /// Feed rate in force, mm/s.
    pub feed_mm_s: f64,
    /// Whether X, Y and Z are absolute.
    pub absolute: bool,
    /// Whether E is absolute.
    pub e_absolute: bool,
    /// Whether M82 or M83 says otherwise than a later G90 or G91: firmwares disagree about what then holds for E.
    pub e_doubtful: bool,
    /// What the last M82 or M83 said.
    e_said: Option<bool>,
    /// Millimetres in a unit of the file.
    pub scale: f64,
    /// Filament retracted and not yet unretracted by E.
    pub retracted_mm: f64,
    /// The most of it since there was none.
    pulled_mm: f64,
    /// Whether filament is retracted by G10.
    pub firmware_retracted: bool,
    /// Whether E counts volume.
    pub volumetric: bool,
    /// The tool in use, and the filament that others were put away with, retracted.
    tool: u32,
    parked: Vec<(u32, f64)>,
}

impl Default for State {
    fn default() -> Self {
        Self {
            position: [0.0; 3],
            e: 0.0,
            feed_mm_s: 0.0,
            absolute: true,
            e_absolute: true,
            e_doubtful: false,
            e_said: None,
            scale: 1.0,
            retracted_mm: 0.0,
            pulled_mm: 0.0,
            firmware_retracted: false,
            volumetric: false,
            tool: 0,
            parked: Vec::new(),
        }
    }
}

/// Numbers from here on are no tools: `T255`, `T1000` and their like are commands of their own.
pub(crate) const NO_TOOL: u32 = 64;

/// Filament that is pulled back by this much or more, in millimetres, has left the nozzle: no tool is put away like that.
const OUT_MM: f64 = 40.0;

impl State {
    /// Whether filament is retracted. What an unretraction leaves is not, if it is less than half: slicers may be set to push
    /// forward less than was pulled back.
    pub fn is_retracted(&self) -> bool {
        let back_mm = self.retracted_mm;
        self.firmware_retracted || back_mm > 1e-6 && 2.0 * back_mm > self.pulled_mm - 1e-6
    }

    /// Does what a line says.
    pub fn follow<'a>(&mut self, line: &Line<'a>) -> Action<'a> {
        if let Some(code) = line.code {
            return self.run(code, line);
        }
        match line.comment.and_then(mark) {
            Some(Mark::Feature(name)) => return Action::Type(name),
            Some(Mark::Volumetric) => self.volumetric = true,
            _ => {}
        }
        Action::Other
    }

    fn run<'a>(&mut self, code: Code, line: &Line<'a>) -> Action<'a> {
        match (code.letter, code.number) {
            (b'G', 0..=3) => return Action::Stroke(self.stroke(code.number, line)),
            // With a tool or offsets, RepRapFirmware's G10 means something else.
            (b'G', 10)
                if [b'P', b'L', b'R', b'X', b'Y', b'Z'].iter().all(|w| line.words().get(*w).is_none()) =>
            {
                self.firmware_retracted = true;
                return Action::FirmwareRetract;
            }
            (b'G', 11) => {
                self.firmware_retracted = false;
                return Action::FirmwareUnretract;
            }
            (b'G', 20) => self.scale = 25.4,
            (b'G', 21) => self.scale = 1.0,
            (b'G', 28) if !b"XYZ".iter().any(|axis| line.names(*axis)) => self.position = [0.0; 3],
            (b'G', 90 | 91) => {
                self.absolute = code.number == 90;
                self.e_absolute = self.absolute;
                self.e_doubtful = self.e_said.is_some_and(|said| said != self.absolute);
            }
            (b'M', 82 | 83) => {
                self.e_absolute = code.number == 82;
                (self.e_said, self.e_doubtful) = (Some(self.e_absolute), false);
            }
            (b'T', tool) if tool < NO_TOOL && tool != self.tool => self.take_tool(tool),
            (b'M', 200) => self.volumetric = self.is_volumetric(&line.words()),
            (b'G', 92) => {
                let words = line.words();
                for (axis, letter) in b"XYZ".iter().enumerate() {
                    if let Some(value) = words.get(*letter) {
                        self.position[axis] = value * self.scale;
                    }
                }
                match words.get(b'E') {
                    Some(value) => self.e = value * self.scale,
                    None if words.is_empty() => self.e = 0.0,
                    None => {}
                }
            }
            _ => {}
        }
        Action::Other
    }

    /// Each tool has filament of its own, which stays as far back as it is; unless that is taken out of a single nozzle.
    fn take_tool(&mut self, tool: u32) {
        let place = self.parked.iter().position(|(parked, _)| *parked == tool);
        let back_mm = place.map_or(0.0, |place| self.parked.swap_remove(place).1);
        if self.retracted_mm > 0.0 && self.retracted_mm < OUT_MM {
            self.parked.push((self.tool, self.retracted_mm));
        }
        (self.tool, self.retracted_mm, self.pulled_mm) = (tool, back_mm, back_mm);
    }

    fn stroke(&mut self, number: u32, line: &Line<'_>) -> Stroke {
        let words = line.words();
        if let Some(feed) = words.get(b'F') {
            self.feed_mm_s = feed * self.scale / 60.0;
        }
        let from = self.position;
        let mut to = from;
        for (axis, letter) in b"XYZ".iter().enumerate() {
            if let Some(value) = words.get(*letter) {
                let origin = if self.absolute { 0.0 } else { from[axis] };
                to[axis] = origin + value * self.scale;
            }
        }
        let e_mm = words.get(b'E').map_or(0.0, |value| {
            let before = self.e;
            self.e = value * self.scale + if self.e_absolute { 0.0 } else { before };
            self.e - before
        });
        let arc = (number >= 2)
            .then(|| Center { at: self.center(number == 2, from, to, &words), clockwise: number == 2 });
        Stroke { plain: words.are_plain(), ..self.make(to, arc, e_mm) }
    }

    /// Makes a move from where the nozzle is, at the feed rate in force.
    pub(crate) fn make(&mut self, to: [f64; 3], arc: Option<Center>, e_mm: f64) -> Stroke {
        let from = std::mem::replace(&mut self.position, to);
        let (mut fresh_mm, mut retracts) = (0.0, false);
        if e_mm < -1e-9 {
            retracts = self.retracted_mm < 1e-6;
            self.retracted_mm -= e_mm;
            self.pulled_mm = if retracts { self.retracted_mm } else { self.pulled_mm.max(self.retracted_mm) };
        } else if e_mm > 1e-9 {
            let back_mm = self.retracted_mm.min(e_mm);
            self.retracted_mm -= back_mm;
            fresh_mm = e_mm - back_mm;
        }
        let xy_mm = match arc {
            Some(center) => arc_mm([from[0], from[1]], [to[0], to[1]], center.at, center.clockwise),
            None => ((to[0] - from[0]).powi(2) + (to[1] - from[1]).powi(2)).sqrt(),
        };
        Stroke {
            from,
            to,
            arc,
            xy_mm,
            e_mm,
            fresh_mm,
            retracts,
            feed_mm_s: self.feed_mm_s,
            volumetric: self.volumetric,
            plain: true,
        }
    }

    /// M200: a diameter above 0 makes E a volume, S says so outright.
    fn is_volumetric(&self, words: &Words) -> bool {
        let by_diameter = words.get(b'D').map_or(self.volumetric, |diameter| diameter > 0.0);
        words.get(b'S').map_or(by_diameter, |on| on > 0.0)
    }

    /// The centre by I and J, or the one that R means (negative: the longer arc).
    fn center(&self, clockwise: bool, from: [f64; 3], to: [f64; 3], words: &Words) -> [f64; 2] {
        let Some(radius) = words.get(b'R').map(|r| r * self.scale) else {
            let [i, j] = [b'I', b'J'].map(|w| words.get(w).unwrap_or(0.0) * self.scale);
            return [from[0] + i, from[1] + j];
        };
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let chord_mm = real::hypot(dx, dy).max(f64::MIN_POSITIVE);
        let offset = (radius * radius - chord_mm * chord_mm / 4.0).max(0.0).sqrt() / chord_mm;
        let side = if clockwise == (radius > 0.0) { 1.0 } else { -1.0 };
        [(from[0] + to[0]) / 2.0 + side * dy * offset, (from[1] + to[1]) / 2.0 - side * dx * offset]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strokes(text: &str) -> Vec<Stroke> {
        replay(text.as_bytes())
            .filter_map(|s| match s.action {
                Action::Stroke(stroke) => Some(stroke),
                _ => None,
            })
            .collect()
    }

    #[test]
    fn absolute_and_relative_extrusion_mean_the_same() {
        let absolute = strokes("G90\nM82\nG1 X1 E1\nG1 X2 E3\nG92 E0\nG1 X3 E.5");
        let relative = strokes("G90\nM83\nG1 X1 E1\nG1 X2 E2\nG1 X3 E.5");
        assert_eq!(absolute, relative);
        assert_eq!(absolute.iter().map(|s| s.e_mm).collect::<Vec<_>>(), [1.0, 2.0, 0.5]);
    }

    #[test]
    fn fresh_filament_is_what_goes_beyond_the_retraction() {
        let fresh: Vec<f64> =
            strokes("M83\nG1 E-1\nG1 X5\nG1 E1.5\nG1 X9 E2").iter().map(|s| s.fresh_mm).collect();
        assert_eq!(fresh, [0.0, 0.0, 0.5, 2.0]);
    }

    #[test]
    fn ultigcode_and_m200_count_volume() {
        for text in [";FLAVOR:UltiGCode\nG1 X1 E2", "M200 D2.85\nG1 X1 E2"] {
            assert_eq!(strokes(text)[0].fresh_mm3(2.4), 2.0, "{text}");
        }
        assert_eq!(strokes("M200 D2.85\nM200 D0\nG1 X1 E2")[0].fresh_mm3(2.5), 5.0);
    }

    #[test]
    fn a_g90_after_an_m83_leaves_e_in_doubt_until_the_next() {
        let mut state = State::default();
        let mut after = |text: &str| {
            lines(text.as_bytes()).for_each(|line| {
                state.follow(&line);
            });
            state.e_doubtful
        };
        assert!(!after("G90\nM83\nG91") && after("G90") && !after("M83"));
    }

    #[test]
    fn a_quarter_circle_is_as_long_by_radius_as_by_centre() {
        for arc in ["G3 X0 Y10 I-10 J0", "G3 X0 Y10 R10"] {
            let quarter = strokes(&format!("G1 X10 Y0\n{arc}"))[1].xy_mm;
            assert!((quarter - 5.0 * std::f64::consts::PI).abs() < 1e-9, "{arc}: {quarter}");
        }
    }
}
