//! What reordering a G-code file came to.

use std::fmt;

use serde::Serialize;

use crate::gcode::Measure;

/// Distances and counts of a file, as a reader of G-code measures them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PathMeasures {
    /// Distance while extruding, mm.
    pub print_mm: f64,
    /// Distance while not extruding, mm.
    pub travel_mm: f64,
    /// Straight lines from the end of each extruded run to the start of the next, mm.
    pub link_mm: f64,
    /// Runs of moves without extrusion.
    pub travels: usize,
    /// Number of retractions.
    pub retractions: usize,
}

impl From<&Measure> for PathMeasures {
    fn from(measure: &Measure) -> Self {
        Self {
            print_mm: measure.print_mm,
            travel_mm: measure.travel_mm,
            link_mm: measure.link_mm,
            travels: measure.travels,
            retractions: measure.retractions,
        }
    }
}

/// A file before and after. `Display` gives the text for people, `Serialize` the JSON.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Reordered {
    /// The file, as named on the command line.
    pub file: String,
    /// Where the result went; nothing if it went nowhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub output: Option<String>,
    /// Whether anything changed.
    pub changed: bool,
    /// Layers compared.
    pub layers: usize,
    /// As it was.
    pub before: PathMeasures,
    /// As it is.
    pub after: PathMeasures,
}

impl fmt::Display for Reordered {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.output {
            Some(output) if *output != self.file => writeln!(f, "{} → {output}", self.file)?,
            _ => writeln!(f, "{}", self.file)?,
        }
        let (a, b) = (&self.before, &self.after);
        if !self.changed {
            return writeln!(f, "  unchanged    no order was found that travels less");
        }
        let metres = |f: &mut fmt::Formatter<'_>, name, a: f64, b: f64| {
            let change = if a > 0.0 { 100.0 * (b / a - 1.0) } else { 0.0 };
            writeln!(f, "  {name:<12} {:.2} m → {:.2} m ({change:+.1} %)", a / 1000.0, b / 1000.0)
        };
        metres(f, "travel", a.travel_mm, b.travel_mm)?;
        metres(f, "links", a.link_mm, b.link_mm)?;
        metres(f, "total path", a.print_mm + a.travel_mm, b.print_mm + b.travel_mm)?;
        writeln!(f, "  {:<12} {} → {}", "travels", a.travels, b.travels)?;
        writeln!(f, "  {:<12} {} → {}", "retractions", a.retractions, b.retractions)?;
        writeln!(f, "  {:<12} {} layers print the same as before", "checked", self.layers)
    }
}
