//! Placeholders of our own: the settings, and places on the bed that every printer has.

use macros::Value;

use crate::gcode::{PrintFacts, one_line};
use crate::motion::filament_area_mm2;
use crate::plate::BedShape;
use crate::profile::settings::Settings;

/// What a placeholder's value is computed from.
struct Context<'a> {
    settings: &'a Settings,
    print: &'a PrintFacts,
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
    /// leaves more space there and comes within `clear` of the line in front. It stays inside with
    /// a few millimetres to spare, also on a round bed: a chord at 0.92 of the radius is 0.78 radii long.
    fn prime_line(&self, print: &PrintFacts, clear: f64) -> ([f64; 2], f64) {
        let (x, front) = self.front_line();
        let back = self.min[1] + self.max[1] - front;
        let free = [print.min_mm[1] - front, back - print.max_mm[1]];
        (x, if free[0] < clear && free[1] > free[0] { back } else { front })
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
    let (x, y) = c.bed.prime_line(c.print, around_mm + 3.0 * width);
    let inwards = if y < c.bed.center()[1] { width } else { -width };
    (x, [y, y + inwards])
}

/// Filament for a bead on the prime line.
fn prime_filament_mm(settings: &Settings, bed: &Bed) -> f64 {
    let ([from, to], _) = bed.front_line();
    let section = settings.layer.first_height.0 * prime_width_mm(settings);
    (to - from) * section * settings.filament.flow / filament_area_mm2(settings.filament.diameter)
}

/// Height to lift to at the end: clear of the print and handy to reach, inside the machine.
fn park_z_mm(settings: &Settings, print_top: f64) -> f64 {
    const CLEARANCE: f64 = 10.0;
    const HANDY: f64 = 50.0;
    (print_top + CLEARANCE).max(HANDY).min(settings.bed.height.0).max(print_top)
}

macro_rules! placeholders {
    ($($name:literal, $doc:literal: $value:expr;)*) => {
        /// Every placeholder of our own with its meaning.
        pub static PLACEHOLDERS: &[(&str, &str)] = &[$(($name, $doc),)*];

        fn of(name: &str, context: &Context) -> Option<Value> {
            match name {
                $($name => {
                    let of: fn(&Context) -> Value = $value;
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
    "first_layer_z", "Z of the first layer, with the Z offset": |c| number(first_z(c.settings));
    "filament", "material, such as PLA": |c| text(&c.settings.filament.material);
    "printer", "name of the printer": |c| text(&c.settings.printer.name);
    "retract_f", "feed rate of retractions, mm/min": |c| number(c.settings.retract.speed.0 * 60.0);
    "travel_f", "feed rate of travel in X and Y, mm/min": |c| number(c.settings.speed.travel.0 * 60.0);
    "z_f", "feed rate of travel in Z, mm/min": |c| number(c.settings.speed.z.0 * 60.0);
    "layer_count", "number of layers": |c| Value::Integer(c.print.layers as i64);
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

/// The value of a placeholder of our own.
pub(super) fn value(name: &str, settings: &Settings, print: &PrintFacts) -> Option<Value> {
    of(name, &Context { settings, print, bed: Bed::new(settings) })
}

fn first_z(settings: &Settings) -> f64 {
    settings.layer.first_height.0 + settings.layer.z_offset.0
}

/// To the micrometre.
fn number(value: f64) -> Value {
    // Adding 0 makes 0 of -0.
    Value::Real((value * 1000.0).round() / 1000.0 + 0.0)
}

fn text(value: &str) -> Value {
    Value::Text(one_line(value))
}
