//! Placeholders in start, end and pause scripts: `{nozzle_temp}` becomes `210`.
//!
//! `{{` and `}}` stand for the braces themselves.

use std::f64::consts::PI;

use super::settings::Settings;
use crate::gcode::{PrintFacts, Scripts, one_line};
use crate::near;
use crate::plate::BedShape;

/// What scripts may know of a print, in bed coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PrintBounds {
    /// Least X and Y, millimetres.
    pub min_mm: [f64; 2],
    /// Greatest X and Y, millimetres.
    pub max_mm: [f64; 2],
    /// Top of the last layer, Z offset included, millimetres.
    pub max_z_mm: f64,
    /// Number of layers.
    pub layers: usize,
}

/// What a placeholder's value is computed from.
struct Context<'a> {
    settings: &'a Settings,
    print: PrintBounds,
    bed: Bed,
}

/// The bed in its own coordinates, millimetres.
struct Bed {
    min: [f64; 2],
    max: [f64; 2],
    round: bool,
}

impl Bed {
    fn new(settings: &Settings) -> Self {
        let bed = &settings.bed;
        Self { min: bed.low_mm(), max: bed.high_mm(), round: bed.shape == BedShape::Round }
    }

    fn size(&self) -> [f64; 2] {
        [self.max[0] - self.min[0], self.max[1] - self.min[1]]
    }

    fn center(&self) -> [f64; 2] {
        [(self.min[0] + self.max[0]) / 2.0, (self.min[1] + self.max[1]) / 2.0]
    }

    /// A line along X near the front edge, for priming: its ends' X, and its Y; near the back edge if the print
    /// leaves more room there and comes within `clear` of the line in front. It stays inside with
    /// a few millimetres to spare, also on a round bed: a chord at 0.92 of the radius is 0.78 radii long.
    fn prime_line(&self, print: &PrintBounds, clear: f64) -> ([f64; 2], f64) {
        let (x, front) = self.front_line();
        let back = self.min[1] + self.max[1] - front;
        let room = [print.min_mm[1] - front, back - print.max_mm[1]];
        (x, if room[0] < clear && room[1] > room[0] { back } else { front })
    }

    fn front_line(&self) -> ([f64; 2], f64) {
        let [width, depth] = self.size();
        if self.round {
            let half = (0.35 * width / 2.0).min(40.0);
            let center = self.center();
            ([center[0] - half, center[0] + half], center[1] - 0.92 * depth / 2.0)
        } else {
            let margin = (0.05 * width).min(10.0);
            let length = (width - 2.0 * margin).min(80.0);
            let left = self.min[0] + margin;
            ([left, left + length], self.min[1] + (0.02 * depth).min(3.0))
        }
    }

    /// Where the nozzle waits after the print: at the back, inside the bed.
    fn park(&self) -> [f64; 2] {
        if self.round {
            [self.center()[0], self.center()[1] + 0.92 * self.size()[1] / 2.0]
        } else {
            let margin = (0.05 * self.size()[0]).min(10.0);
            [self.min[0] + margin, self.max[1] - margin]
        }
    }
}

fn prime_width_mm(settings: &Settings) -> f64 {
    1.5 * settings.printer.nozzle_diameter.0
}

/// The prime line's ends' X, its Y, and that of a second line beside it, nearer to the middle of the bed.
fn prime_line(c: &Context) -> ([f64; 2], [f64; 2]) {
    let (skirt, brim, width) = (&c.settings.skirt, &c.settings.brim, prime_width_mm(c.settings));
    let skirt_mm = skirt.distance.0 + f64::from(skirt.loops) * c.settings.walls.width.0;
    let around_mm = brim.gap.0 + brim.width.0 + if skirt.loops > 0 { skirt_mm } else { 0.0 };
    let (x, y) = c.bed.prime_line(&c.print, around_mm + 3.0 * width);
    let inwards = if y < c.bed.center()[1] { width } else { -width };
    (x, [y, y + inwards])
}

/// Filament for a bead on the prime line.
fn prime_filament_mm(settings: &Settings, bed: &Bed) -> f64 {
    let ([from, to], _) = bed.front_line();
    let section = settings.layer.first_height.0 * prime_width_mm(settings);
    let filament_mm2 = PI * (settings.filament.diameter.0 / 2.0).powi(2);
    (to - from) * section * settings.filament.flow / filament_mm2
}

/// Height to lift to at the end: clear of the print and handy to reach, inside the machine.
fn park_z_mm(settings: &Settings, print_top: f64) -> f64 {
    const CLEARANCE: f64 = 10.0;
    const HANDY: f64 = 50.0;
    (print_top + CLEARANCE).max(HANDY).min(settings.bed.height.0).max(print_top)
}

macro_rules! placeholders {
    ($($name:literal, $doc:literal: $value:expr;)*) => {
        /// Every placeholder with its meaning.
        pub const PLACEHOLDERS: &[(&str, &str)] = &[$(($name, $doc),)*];

        fn value(name: &str, context: &Context) -> Option<String> {
            match name {
                $($name => {
                    let of: fn(&Context) -> String = $value;
                    Some(of(context))
                })*
                _ => None,
            }
        }
    };
}

placeholders! {
    "nozzle_temp", "nozzle temperature of the first layer, °C": |c| number(c.settings.temperature.nozzle_first_layer.0);
    "nozzle_temp_other", "nozzle temperature of the other layers, °C": |c| number(c.settings.temperature.nozzle.0);
    "bed_temp", "bed temperature of the first layer, °C": |c| number(c.settings.temperature.bed_first_layer.0);
    "bed_temp_other", "bed temperature of the other layers, °C": |c| number(c.settings.temperature.bed.0);
    "bed_size_x", "width of the bed, mm": |c| number(c.settings.bed.size[0].0);
    "bed_size_y", "depth of the bed, mm": |c| number(c.settings.bed.size[1].0);
    "bed_height", "printable height, mm": |c| number(c.settings.bed.height.0);
    "bed_min_x", "X of the bed's left edge": |c| number(c.bed.min[0]);
    "bed_min_y", "Y of the bed's front edge": |c| number(c.bed.min[1]);
    "bed_max_x", "X of the bed's right edge": |c| number(c.bed.max[0]);
    "bed_max_y", "Y of the bed's back edge": |c| number(c.bed.max[1]);
    "layer_height", "height of the layers from the second on, mm": |c| number(c.settings.layer.height.0);
    "first_layer_height", "height of the first layer, mm": |c| number(c.settings.layer.first_height.0);
    "first_layer_z", "Z of the first layer, with the Z offset": |c| number(first_z(c.settings));
    "nozzle_diameter", "diameter of the nozzle, mm": |c| number(c.settings.printer.nozzle_diameter.0);
    "filament", "material, such as PLA": |c| one_line(&c.settings.filament.material);
    "printer", "name of the printer": |c| one_line(&c.settings.printer.name);
    "filament_diameter", "diameter of the filament, mm": |c| number(c.settings.filament.diameter.0);
    "retract_length", "filament pulled back at a retraction, mm": |c| number(c.settings.retract.length.0);
    "retract_f", "feed rate of retractions, mm/min": |c| number(c.settings.retract.speed.0 * 60.0);
    "travel_f", "feed rate of travel in X and Y, mm/min": |c| number(c.settings.speed.travel.0 * 60.0);
    "z_f", "feed rate of travel in Z, mm/min": |c| number(c.settings.speed.z.0 * 60.0);
    "layer_count", "number of layers": |c| c.print.layers.to_string();
    "prime_x0", "X where the prime line starts": |c| number(prime_line(c).0[0]);
    "prime_x1", "X where the prime line ends": |c| number(prime_line(c).0[1]);
    "prime_y0", "Y of the prime line, near the front edge, or the back edge if the print reaches the front": |c| number(prime_line(c).1[0]);
    "prime_y1", "Y of a second line beside it": |c| number(prime_line(c).1[1]);
    "prime_e", "filament for one of them, 1.5 nozzles wide and as high as the first layer, mm": |c| number(prime_filament_mm(c.settings, &c.bed));
    "park_x", "X to wait at after the print, at the back": |c| number(c.bed.park()[0]);
    "park_y", "Y to wait at after the print": |c| number(c.bed.park()[1]);
    "park_z", "Z to lift to after the print: clear of it, inside the machine": |c| number(park_z_mm(c.settings, c.print.max_z_mm));
    "print_min_x", "least X of the print": |c| number(c.print.min_mm[0]);
    "print_min_y", "least Y of the print": |c| number(c.print.min_mm[1]);
    "print_max_x", "greatest X of the print": |c| number(c.print.max_mm[0]);
    "print_max_y", "greatest Y of the print": |c| number(c.print.max_mm[1]);
    "print_max_z", "greatest Z of the print": |c| number(c.print.max_z_mm);
}

fn first_z(settings: &Settings) -> f64 {
    settings.layer.first_height.0 + settings.layer.z_offset.0
}

/// At most three decimals, and no more than it needs.
fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

/// Fills in a script's placeholders. Every line ends with `\n`, and none with blanks.
///
/// # Errors
/// One message for each mistake, with its line: a placeholder that does not exist, with the nearest that does, or a
/// single brace. A script that [`super::resolve`] has accepted has none.
///
/// # Examples
/// ```
/// use pathwright::profile::{PrintBounds, Settings, expand};
/// let text = expand("M109 S{nozzle_temp}", &Settings::default(), PrintBounds::default());
/// assert_eq!(text.unwrap(), "M109 S210\n");
/// ```
pub fn expand(script: &str, settings: &Settings, print: PrintBounds) -> Result<String, Vec<String>> {
    let context = Context { settings, print, bed: Bed::new(settings) };
    let mut out = String::with_capacity(script.len() + 64);
    let mut problems = Vec::new();
    for (index, line) in script.lines().enumerate() {
        let mut problem = |message| problems.push(format!("line {}: {message}", index + 1));
        expand_line(line.trim_end(), &context, &mut out, &mut problem);
        out.push('\n');
    }
    if problems.is_empty() { Ok(out) } else { Err(problems) }
}

impl Scripts {
    /// Fills in the scripts of the settings.
    ///
    /// # Errors
    /// Every mistake in all three scripts, a line each. Scripts of a resolved profile have none.
    pub fn new(settings: &Settings, facts: &PrintFacts) -> Result<Self, Vec<String>> {
        let PrintFacts { min_mm, max_mm, max_z_mm, layers, .. } = *facts;
        let print = PrintBounds { min_mm, max_mm, max_z_mm, layers };
        let mut errors = Vec::new();
        let mut filled = |name: &str, text: &str| {
            expand(text, settings, print).unwrap_or_else(|mistakes| {
                errors.extend(mistakes.iter().map(|mistake| format!("{name}: {mistake}")));
                String::new()
            })
        };
        let gcode = &settings.gcode;
        let texts = [
            filled("gcode.start", &gcode.start),
            filled("gcode.end", &gcode.end),
            filled("gcode.pause", &gcode.pause),
        ];
        let scripts = Self::filled_in(texts, gcode, settings.printer.flavor);
        if errors.is_empty() { Ok(scripts) } else { Err(errors) }
    }
}

fn expand_line(mut rest: &str, context: &Context, out: &mut String, problem: &mut impl FnMut(String)) {
    while let Some(at) = rest.find(['{', '}']) {
        let (before, from) = rest.split_at(at);
        let (brace, after) = from.split_at(1);
        out.push_str(before);
        if let Some(after) = after.strip_prefix(brace) {
            out.push_str(brace);
            rest = after;
        } else if let Some((name, after)) = after.split_once('}').filter(|_| brace == "{") {
            match value(name.trim(), context) {
                Some(text) => out.push_str(&text),
                None => problem(unknown(name.trim())),
            }
            rest = after;
        } else {
            problem(format!("a single `{brace}`; write `{brace}{brace}` for the character itself"));
            rest = after;
        }
    }
    out.push_str(rest);
}

fn unknown(name: &str) -> String {
    let known = PLACEHOLDERS.iter().map(|(name, _)| *name);
    match near::name(name, known.clone()) {
        Some(near) => format!("unknown placeholder {{{name}}}; did you mean {{{near}}}?"),
        None => format!("unknown placeholder {{{name}}}; known: {}", known.collect::<Vec<_>>().join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Mm;

    const PRINT: PrintBounds =
        PrintBounds { min_mm: [100.0; 2], max_mm: [150.0; 2], max_z_mm: 30.0, layers: 150 };

    fn filled(script: &str, settings: &Settings) -> String {
        expand(script, settings, PRINT).unwrap()
    }

    #[test]
    fn every_placeholder_has_a_value() {
        for (name, _) in PLACEHOLDERS {
            assert_ne!(filled(&format!("{{{name}}}"), &Settings::default()), "\n", "{name}");
        }
    }

    #[test]
    fn numbers_have_no_more_digits_than_they_need() {
        assert_eq!(filled("{bed_size_x} { layer_height }", &Settings::default()), "250 0.2\n");
    }

    #[test]
    fn values_cannot_start_a_line_or_a_comment() {
        let mut settings = Settings::default();
        settings.printer.name = "evil\nM112;\rG28".into();
        assert_eq!(filled("M117 {printer}", &settings), "M117 evil M112, G28\n");
    }

    #[test]
    fn every_unknown_placeholder_is_reported_with_the_nearest() {
        let problems = expand("{nozle_temp}\n{bed_tmp}", &Settings::default(), PRINT).unwrap_err();
        assert_eq!(problems.len(), 2);
        assert_eq!(problems[0], "line 1: unknown placeholder {nozle_temp}; did you mean {nozzle_temp}?");
        assert_eq!(problems[1], "line 2: unknown placeholder {bed_tmp}; did you mean {bed_temp}?");
    }

    #[test]
    fn doubled_braces_are_braces_and_single_ones_errors() {
        assert_eq!(filled("SET {{a}}", &Settings::default()), "SET {a}\n");
        assert!(expand("a } b", &Settings::default(), PRINT).is_err());
        assert!(expand("a { b", &Settings::default(), PRINT).is_err());
    }

    #[test]
    fn prime_line_and_park_lie_on_a_round_bed() {
        let mut settings = Settings::default();
        settings.bed.shape = BedShape::Round;
        settings.bed.origin = crate::profile::BedOrigin::Center;
        settings.bed.size = [Mm(180.0); 2];
        let bed = Bed::new(&settings);
        let ([x0, x1], y) = bed.front_line();
        let [px, py] = bed.park();
        for (x, y) in [(x0, y), (x1, y), (px, py)] {
            assert!(x.hypot(y) < 90.0, "{x} {y}");
        }
    }

    #[test]
    fn the_prime_line_moves_to_the_back_where_the_print_reaches_the_front() {
        let line = |min_y: f64, max_y: f64| {
            let print = PrintBounds { min_mm: [100.0, min_y], max_mm: [150.0, max_y], ..PRINT };
            expand("{prime_y0} {prime_y1}", &Settings::default(), print).unwrap()
        };
        assert_eq!(line(20.0, 230.0), "3 3.6\n");
        assert_eq!(line(5.0, 230.0), "247 246.4\n");
        assert_eq!(line(5.0, 248.0), "3 3.6\n", "no better at the back");
    }

    #[test]
    fn park_height_clears_the_print_but_stays_in_the_machine() {
        let settings = Settings::default();
        assert_eq!(park_z_mm(&settings, 30.0), 50.0);
        assert_eq!(park_z_mm(&settings, 100.0), 110.0);
        assert_eq!(park_z_mm(&settings, 249.0), 250.0);
    }
}
