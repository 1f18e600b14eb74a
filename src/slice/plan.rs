//! Layer heights.

use serde::Serialize;

use super::options::LayerSettings;

/// Where one layer lies, in millimetres above the bed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LayerSpan {
    /// Number, from 0.
    pub index: usize,
    /// Where it begins.
    pub bottom_mm: f64,
    /// Where it ends: the nozzle's height.
    pub top_mm: f64,
    /// Thickness.
    pub height_mm: f64,
    /// Height of the cross-section: at half its height.
    pub cut_mm: f64,
}

/// Models in 32-bit coordinates are this uncertain: half a micrometre covers heights up to 4 m.
pub(super) const NOISE_MM: f64 = 5e-4;

/// The layers of an object: all whose middle lies inside it, as a last layer less than half filled would stand out
/// more than a missing one. Tops that differ by rounding noise give the same layers.
///
/// The plan is empty if the settings hold no positive heights, or the object is lower than half the first layer.
pub fn plan(height_mm: f64, settings: &LayerSettings) -> Vec<LayerSpan> {
    let (first_mm, other_mm) = (settings.first_height.0, settings.height.0);
    if !(first_mm > 0.0 && other_mm > 0.0 && height_mm.is_finite()) {
        return Vec::new();
    }
    // Each from its number, so that no rounding adds up.
    let top_mm = |index: usize| first_mm + index as f64 * other_mm;
    let span = |index: usize| {
        let bottom_mm = if index == 0 { 0.0 } else { top_mm(index - 1) };
        LayerSpan {
            index,
            bottom_mm,
            top_mm: top_mm(index),
            height_mm: if index == 0 { first_mm } else { other_mm },
            cut_mm: (bottom_mm + top_mm(index)) / 2.0,
        }
    };
    (0..).map(span).take_while(|span| span.cut_mm < height_mm - NOISE_MM).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Mm;

    fn tops(height_mm: f64, first: f64, other: f64) -> Vec<f64> {
        let settings =
            LayerSettings { first_height: Mm(first), height: Mm(other), ..LayerSettings::default() };
        plan(height_mm, &settings).iter().map(|s| (s.top_mm * 1e6).round() / 1e6).collect()
    }

    #[test]
    fn a_layer_exists_when_its_middle_is_inside() {
        assert_eq!(tops(1.0, 0.2, 0.2), [0.2, 0.4, 0.6, 0.8, 1.0]);
        assert_eq!(tops(0.89, 0.2, 0.2), [0.2, 0.4, 0.6, 0.8]);
        assert_eq!(tops(0.91, 0.2, 0.2), [0.2, 0.4, 0.6, 0.8, 1.0]);
        assert_eq!(tops(0.7, 0.3, 0.2), [0.3, 0.5, 0.7]);
    }

    #[test]
    fn rounding_noise_in_the_height_makes_no_sliver() {
        for noise in [-2e-4, 0.0, 2e-4] {
            assert_eq!(tops(10.0 + noise, 0.2, 0.2).len(), 50);
            assert_eq!(tops(0.3 + noise, 0.2, 0.2).len(), 1, "the second middle lies at 0.3");
        }
    }

    #[test]
    fn layers_follow_without_gap() {
        let spans = plan(100.0, &LayerSettings { height: Mm(0.07), ..LayerSettings::default() });
        assert!(spans.windows(2).all(|w| w[0].top_mm == w[1].bottom_mm));
        assert!(spans.iter().all(|s| (s.top_mm - s.bottom_mm - s.height_mm).abs() < 1e-9));
    }

    #[test]
    fn nothing_to_plan_gives_no_layer() {
        assert!(tops(0.0, 0.2, 0.2).is_empty() && tops(0.05, 0.2, 0.2).is_empty());
        assert!(tops(f64::NAN, 0.2, 0.2).is_empty() && tops(1.0, 0.2, 0.0).is_empty());
    }
}
