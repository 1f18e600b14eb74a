//! Where a print stops for a filament change.

use std::fmt;
use std::str::FromStr;

/// Why the nozzle stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// A pause.
    Pause,
    /// A change to filament of another color.
    ColorChange,
}

/// Before which layer to pause. Written `12` (before the twelfth layer) or `5.4mm` (before the first layer
/// that reaches above that height).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PauseAt {
    /// Before the layer with this index, 0 the one on the bed.
    Layer(usize),
    /// Before the layer that begins at or below this height (millimetres, without Z offset) and ends above it.
    Height(f64),
}

/// `--pause-at` does not say where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is neither a layer nor a height: write 12 (before the twelfth layer) or 5.4mm (before that height)"
)]
pub struct PauseError(String);

impl FromStr for PauseAt {
    type Err = PauseError;

    fn from_str(text: &str) -> Result<Self, PauseError> {
        let error = || PauseError(text.to_owned());
        if let Some(height) = text.trim().strip_suffix("mm") {
            let height_mm: f64 = height.trim().parse().map_err(|_| error())?;
            return if height_mm.is_finite() && height_mm >= 0.0 {
                Ok(Self::Height(height_mm))
            } else {
                Err(error())
            };
        }
        match text.trim().parse::<usize>() {
            Ok(number) if number > 0 => Ok(Self::Layer(number - 1)),
            _ => Err(error()),
        }
    }
}

/// As it is written.
impl fmt::Display for PauseAt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Layer(index) => write!(f, "{}", index + 1),
            Self::Height(height_mm) => write!(f, "{height_mm}mm"),
        }
    }
}

impl PauseAt {
    /// Whether it means this layer, whose top is `top_mm` over the bed.
    pub fn precedes(self, index: usize, top_mm: f64, height_mm: f64) -> bool {
        /// Tops are sums of heights: a nanometre takes up their rounding.
        const ROUNDING_MM: f64 = 1e-6;
        match self {
            Self::Layer(wanted) => wanted == index,
            Self::Height(wanted_mm) => {
                let limit_mm = wanted_mm + ROUNDING_MM;
                top_mm - height_mm <= limit_mm && top_mm > limit_mm
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_count_from_one_and_heights_carry_their_unit() {
        assert_eq!("12".parse(), Ok(PauseAt::Layer(11)));
        assert_eq!("5.4mm".parse(), Ok(PauseAt::Height(5.4)));
        for bad in ["0", "", "-1", "5.4", "NaNmm", "-2mm", "mm"] {
            assert!(bad.parse::<PauseAt>().is_err(), "{bad}");
        }
    }

    #[test]
    fn a_height_means_exactly_one_layer() {
        for height_mm in [0.0, 0.1, 0.2, 0.3 + 1e-13, 0.6000000001, 1.9] {
            let hits = (0..10)
                .filter(|&i| PauseAt::Height(height_mm).precedes(i, 0.2 * (i + 1) as f64, 0.2))
                .count();
            assert_eq!(hits, 1, "{height_mm}");
        }
    }
}
