//! Values that are known only at the end, and the slots left for them.

use super::number::text;
use crate::motion::{FilamentSettings, filament_area_mm2};
use crate::units::{Mm, Mm3, Seconds};

/// Width of the line left for M73: `M73 P100 R99999`.
pub(super) const PROGRESS_WIDTH: usize = 15;

/// Width of the values in the header.
pub(super) const VALUE_WIDTH: usize = 16;

/// A value known only at the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pending {
    /// Print time as `1h 2m 3s`.
    PrintTime,
    /// Filament length, millimetres.
    FilamentMm,
    /// Filament, cubic centimetres.
    FilamentCm3,
    /// Filament, grams.
    FilamentG,
    /// All filament, grams.
    TotalG,
    /// Price of the filament.
    FilamentCost,
    /// The M73 of a layer.
    Progress {
        /// Index of the layer.
        layer: usize,
    },
}

/// A place of fixed width, blank until it is filled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot {
    /// Byte offset into what it came with.
    pub offset: usize,
    /// Bytes to overwrite.
    pub width: usize,
    /// With what.
    pub value: Pending,
}

/// Totals of the finished plan, for header and footer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Totals {
    /// Print time without heating.
    pub time: Seconds,
    /// Filament extruded.
    pub volume: Mm3,
    /// When each layer begins, or each of its parts, counted from the start of the print.
    pub layer_starts: Vec<Seconds>,
    /// Of each tool what it extruded, and its filament; empty: the printer has one.
    pub tools: Vec<(Mm3, FilamentSettings)>,
}

impl Totals {
    /// Weight of all filament, of which `filament` is the only one where there is one tool.
    pub fn grams(&self, filament: &FilamentSettings) -> f64 {
        self.each(filament).iter().map(|(mm3, filament)| mm3 / 1000.0 * filament.density).sum()
    }

    /// Its price.
    pub fn cost(&self, filament: &FilamentSettings) -> f64 {
        self.each(filament).iter().map(|(mm3, own)| mm3 / 1000.0 * own.density / 1000.0 * own.cost).sum()
    }

    /// What there is of each filament, mm³.
    fn each<'a>(&'a self, filament: &'a FilamentSettings) -> Vec<(f64, &'a FilamentSettings)> {
        match self.tools.as_slice() {
            [] => vec![(self.volume.0, filament)],
            tools => tools.iter().map(|(volume, filament)| (volume.0, filament)).collect(),
        }
    }

    /// Length of filament for a volume.
    pub fn filament(&self, diameter: Mm) -> Mm {
        Mm(self.volume.0 / filament_area_mm2(diameter))
    }

    /// A value as text.
    pub fn value(&self, value: Pending, filament: &FilamentSettings) -> String {
        let of_each = |value: fn(f64, &FilamentSettings) -> f64| {
            let values = self.each(filament).into_iter().map(|(mm3, own)| text(value(mm3, own), 2));
            values.collect::<Vec<_>>().join(", ")
        };
        match value {
            Pending::PrintTime => duration(self.time),
            Pending::FilamentMm => of_each(|mm3, own| mm3 / own.area_mm2()),
            Pending::FilamentCm3 => of_each(|mm3, _| mm3 / 1000.0),
            Pending::FilamentG => of_each(|mm3, own| mm3 / 1000.0 * own.density),
            Pending::TotalG => text(self.grams(filament), 2),
            Pending::FilamentCost => of_each(|mm3, own| mm3 / 1000.0 * own.density / 1000.0 * own.cost),
            Pending::Progress { layer } => {
                let start_s = self.layer_starts.get(layer).map_or(0.0, |s| s.0);
                let percent =
                    (100.0 * start_s / self.time.0.max(f64::MIN_POSITIVE)).floor().clamp(0.0, 100.0);
                let minutes = ((self.time.0 - start_s) / 60.0).ceil().clamp(0.0, 99_999.0);
                format!("M73 P{percent} R{minutes}")
            }
        }
    }

    /// The bytes for a slot: the value, filled up with blanks (a value that is too long is cut).
    pub fn fill(&self, slot: &Slot, filament: &FilamentSettings) -> Vec<u8> {
        let mut bytes = self.value(slot.value, filament).into_bytes();
        bytes.resize(slot.width, b' ');
        bytes
    }
}

/// `1d 2h 3m 4s`, without leading zero parts.
pub(crate) fn duration(time: Seconds) -> String {
    let seconds = time.0.round().max(0.0) as u64;
    let parts =
        [(seconds / 86_400, 'd'), (seconds / 3600 % 24, 'h'), (seconds / 60 % 60, 'm'), (seconds % 60, 's')];
    let first = parts.iter().position(|p| p.0 > 0).unwrap_or(3);
    parts[first..].iter().map(|(n, unit)| format!("{n}{unit}")).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_read_as_moonraker_expects() {
        let cases = [(3723.4, "1h 2m 3s"), (59.6, "1m 0s"), (0.0, "0s"), (90_061.0, "1d 1h 1m 1s")];
        for (seconds, wanted) in cases {
            assert_eq!(duration(Seconds(seconds)), wanted);
        }
    }

    #[test]
    fn progress_counts_up_and_minutes_down() {
        let totals = Totals {
            time: Seconds(600.0),
            volume: Mm3(0.0),
            tools: Vec::new(),
            layer_starts: vec![Seconds(0.0), Seconds(300.0)],
        };
        let slot = Slot { offset: 0, width: PROGRESS_WIDTH, value: Pending::Progress { layer: 1 } };
        assert_eq!(totals.fill(&slot, &FilamentSettings::default()), b"M73 P50 R5     ");
    }
}
