//! What people want to know of a printer before they choose it.

use super::config::Config;

/// What people want to know of a printer before they choose it; what its presets do not say is missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PrinterFacts {
    /// Width and depth of the bed, millimetres.
    pub bed_mm: Option<[f64; 2]>,
    /// Height of the printer, millimetres.
    pub height_mm: Option<f64>,
    /// Diameter of the first nozzle, millimetres.
    pub nozzle_mm: Option<f64>,
    /// As the slicer calls it.
    pub firmware: String,
}

impl PrinterFacts {
    /// Those of a printer preset.
    pub fn of(config: &Config) -> Self {
        Self {
            bed_mm: bed_mm(config),
            height_mm: config.number("max_print_height").filter(|mm| *mm > 0.0),
            nozzle_mm: config.number("nozzle_diameter"),
            firmware: config.text("gcode_flavor").unwrap_or_default().to_owned(),
        }
    }
}

fn bed_mm(config: &Config) -> Option<[f64; 2]> {
    let points = config.points("bed_shape")?;
    let side = |i: usize| {
        let all = points.iter().map(|point| point[i]);
        all.clone().fold(f64::NEG_INFINITY, f64::max) - all.fold(f64::INFINITY, f64::min)
    };
    Some([side(0), side(1)])
}
