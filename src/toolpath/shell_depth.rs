//! How many layers a shell is thick.

use super::options::ShellSettings;

/// Thicknesses that differ by less are the same, in millimetres.
const NOISE_MM: f64 = 1e-6;

/// Number of layers on one side of a layer that its shell depends on: the requested number, and more until they have
/// the requested thickness. `heights_mm` are those of the layers on that side, the nearest first; one more than there
/// are says that the shell looks beyond them. A shell that is not wanted stays away.
pub fn shell_depth(heights_mm: impl Iterator<Item = f64>, layers: u32, min_thickness_mm: f64) -> usize {
    let (mut depth, mut thick_mm) = (0, 0.0);
    if layers == 0 {
        return 0;
    }
    for height_mm in heights_mm {
        if depth >= layers as usize && thick_mm >= min_thickness_mm - NOISE_MM {
            return depth;
        }
        depth += 1;
        thick_mm += height_mm;
    }
    let enough = depth >= layers as usize && thick_mm >= min_thickness_mm - NOISE_MM;
    if enough { depth } else { depth + 1 }
}

/// Number of solid bottom layers on the bed, with these layer heights.
pub fn bottom_layers(heights_mm: &[f64], settings: &ShellSettings) -> usize {
    (0..heights_mm.len()).take_while(|&i| below(heights_mm, i, settings) > i).count()
}

pub(super) fn above(heights_mm: &[f64], layer: usize, settings: &ShellSettings) -> usize {
    let heights_mm = heights_mm[layer + 1..].iter().copied();
    shell_depth(heights_mm, settings.top_layers, settings.min_thickness.0)
}

pub(super) fn below(heights_mm: &[f64], layer: usize, settings: &ShellSettings) -> usize {
    let heights_mm = heights_mm[..layer].iter().rev().copied();
    shell_depth(heights_mm, settings.bottom_layers, settings.min_thickness.0)
}
