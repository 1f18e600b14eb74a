//! One palette for the page, SVG and PNG.
//!
//! Orange to yellow for walls, violet for infill, blue for travel: hues that stay apart with every kind of colour
//! blindness, and within a hue each role has a lightness of its own.

use crate::toolpath::Role;

/// Red, green, blue.
pub(super) type Rgb = [u8; 3];

/// The name and colour of a role.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct RoleColor {
    /// For people.
    pub label: &'static str,
    pub color: Rgb,
    pub roles: &'static [Role],
}

macro_rules! roles {
    ($($label:literal, $color:literal, [$($role:ident),*];)*) => {
        &[$(RoleColor { label: $label, color: rgb($color), roles: &[$(Role::$role),*] },)*]
    };
}

/// Every role, in the order of legends. The last one is for everything else.
pub(super) const ROLES: &[RoleColor] = roles![
    "Outer wall", 0xE07B00, [ExternalPerimeter];
    "Inner wall", 0xF6CB66, [Perimeter];
    "Overhang wall", 0x7C4A03, [OverhangPerimeter];
    "Sparse infill", 0xA8325E, [InternalInfill];
    "Solid infill", 0x8F6CC0, [SolidInfill];
    "Top surface", 0xD7B3E8, [TopSolidInfill];
    "Bridge", 0x45257D, [BridgeInfill];
    "Gap fill", 0x848B93, [GapFill];
    "Skirt and brim", 0xAFB890, [Skirt, Brim, PrimeTower];
    "Support", 0x62AD92, [Support];
    "Support interface", 0x055B45, [SupportInterface];
    "Ironing", 0xF6D3DA, [Ironing];
    "Other", 0x5F6B73, [];
];

/// Each tool, in turn; hues by Masataka Okabe and Kei Ito, which all viewers can tell apart.
pub(super) const TOOLS: [(&str, Rgb); 8] = [
    ("Tool 1", rgb(0xE69F00)),
    ("Tool 2", rgb(0x0072B2)),
    ("Tool 3", rgb(0x009E73)),
    ("Tool 4", rgb(0xD55E00)),
    ("Tool 5", rgb(0xCC79A7)),
    ("Tool 6", rgb(0x56B4E9)),
    ("Tool 7", rgb(0xF0E442)),
    ("Tool 8", rgb(0x555555)),
];

/// Index of the role whose loops have a seam that is seen.
pub(super) const SEAMED: u8 = 0;
/// Index of what is printed beside the object.
pub(super) const SKIRT: u8 = 8;
/// Index of the last role.
pub(super) const OTHER: u8 = ROLES.len() as u8 - 1;

/// From low to high, in equal steps: the upper four fifths of viridis, by Stéfan van der Walt and Nathaniel Smith. The
/// rest is too dark on black.
pub(super) const RAMP: [Rgb; 9] = [
    rgb(0x414487),
    rgb(0x355F8D),
    rgb(0x2A788E),
    rgb(0x21918C),
    rgb(0x22A884),
    rgb(0x44BF70),
    rgb(0x7AD151),
    rgb(0xBDDF26),
    rgb(0xFDE725),
];

/// The colours of everything that is not a role.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Theme {
    pub background: Rgb,
    pub bed: Rgb,
    pub ink: Rgb,
    pub travel: Rgb,
    pub retraction: Rgb,
    pub unretraction: Rgb,
    pub seam: Rgb,
}

/// On white.
pub(super) const LIGHT: Theme = Theme {
    background: rgb(0xFFFFFF),
    bed: rgb(0xDDE2E6),
    ink: rgb(0x1C2329),
    travel: rgb(0x0B5FC4),
    retraction: rgb(0xC8102E),
    unretraction: rgb(0x007A4D),
    seam: rgb(0x111111),
};

/// On black.
pub(super) const DARK: Theme = Theme {
    background: rgb(0x14181C),
    bed: rgb(0x2A3138),
    ink: rgb(0xE8ECEF),
    travel: rgb(0x4FB3FF),
    retraction: rgb(0xFF6B7A),
    unretraction: rgb(0x45D6A0),
    seam: rgb(0xFFFFFF),
};

const fn rgb(hex: u32) -> Rgb {
    [(hex >> 16) as u8, (hex >> 8) as u8, hex as u8]
}

/// `#rrggbb`.
pub(super) fn hex([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The index in [`ROLES`].
pub(super) fn index(role: Option<Role>) -> u8 {
    let found = role.and_then(|role| ROLES.iter().position(|known| known.roles.contains(&role)));
    found.map_or(OTHER, |index| index as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Full dichromacy, on linear sRGB: G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, "A Physiologically-based
    /// Model for Simulation of Color Vision Deficiency", 2009, doi:10.1109/TVCG.2009.113.
    const SEEN_BY: [[[f64; 3]; 3]; 4] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
    ];

    /// CIE L*a*b* of a colour as it is seen.
    fn lab(color: Rgb, seen: &[[f64; 3]; 3]) -> [f64; 3] {
        let linear = color.map(|c| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        });
        let dot = |row: &[f64; 3], v: &[f64; 3]| row.iter().zip(v).map(|(a, b)| a * b).sum::<f64>();
        let seen = [0, 1, 2].map(|i| dot(&seen[i], &linear).clamp(0.0, 1.0));
        let xyz = [
            dot(&[0.4124, 0.3576, 0.1805], &seen) / 0.9505,
            dot(&[0.2126, 0.7152, 0.0722], &seen),
            dot(&[0.0193, 0.1192, 0.9505], &seen) / 1.089,
        ];
        let f = xyz.map(|t| if t > 0.008856 { t.cbrt() } else { 7.787 * t + 16.0 / 116.0 });
        [116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])]
    }

    #[test]
    fn whoever_looks_can_tell_the_roles_apart_and_travel_from_all_of_them() {
        for (viewer, seen) in SEEN_BY.iter().enumerate() {
            for theme in [LIGHT, DARK] {
                let mut all: Vec<(&str, Rgb)> = ROLES.iter().map(|r| (r.label, r.color)).collect();
                all.push(("travel", theme.travel));
                for (i, (a, color)) in all.iter().enumerate() {
                    for (b, other) in &all[i + 1..] {
                        let (p, q) = (lab(*color, seen), lab(*other, seen));
                        let apart = (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt();
                        assert!(apart > 9.0, "viewer {viewer}: {a} and {b} are {apart:.1} apart");
                    }
                }
            }
        }
    }
}
