//! What a print is beside its model.

use std::fmt;

use serde::Serialize;

/// A body that was found in a print.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PlacedBody {
    /// Its objects.
    pub name: String,
    /// Where its own zero stands.
    pub at_mm: [f64; 3],
    /// By how much it is turned about Z, counter-clockwise.
    pub turned_deg: u32,
}

/// How a print compares to its model.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ModelReport {
    /// Volume that the model encloses.
    pub mesh_volume_mm3: f64,
    /// Volume of the beads that belong to the model, without skirt, brim and support where the file distinguishes them.
    pub part_volume_mm3: f64,
    /// Position of the first body's origin on the bed; `None` if none was found.
    pub placed_at_mm: Option<[f64; 3]>,
    /// All bodies that were found, as often as they were.
    pub placed: Vec<PlacedBody>,
    /// Islands of the model's sections, of all layers.
    pub islands: usize,
    /// Of these, the ones that are not printed.
    pub missing_islands: usize,
    /// Length of beads outside the model.
    pub extra_mm: f64,
    /// Length of beads that rest on nothing and are not held at both ends.
    pub over_air_mm: f64,
}

impl fmt::Display for ModelReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { mesh_volume_mm3, part_volume_mm3, islands, missing_islands, .. } = self;
        let share = 100.0 * part_volume_mm3 / mesh_volume_mm3.max(f64::MIN_POSITIVE);
        writeln!(
            f,
            "  volume   {part_volume_mm3:.1} mm³ printed, {share:.1} % of the model's {mesh_volume_mm3:.1} mm³"
        )?;
        if let Some([x, y, z]) = self.placed_at_mm {
            let more = match self.placed.len() {
                0 | 1 => String::new(),
                count => format!(" and {} more positions", count - 1),
            };
            writeln!(
                f,
                "  model    at X{x:.2} Y{y:.2} Z{z:.2}{more}; {missing_islands} of {islands} islands missing"
            )?;
            writeln!(f, "  beads    {:.1} mm outside, {:.1} mm over air", self.extra_mm, self.over_air_mm)?;
        }
        Ok(())
    }
}
