//! One palette for the page, SVG and PNG.
//!
//! Orange to yellow for walls, violet for infill, blue for travel: hues that stay apart with every kind of colour
//! blindness, and within a hue each role has a lightness of its own.

/// Red, green, blue.
pub(super) type Rgb = [u8; 3];

/// What a role is called and drawn in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct RoleColor {
    /// For people.
    pub label: &'static str,
    /// Names in `;TYPE:` comments and the like, in lower case.
    pub names: &'static [&'static str],
    /// On a light and on a dark background.
    pub color: Rgb,
}

macro_rules! roles {
    ($($label:literal, $color:literal, [$($name:literal),*];)*) => {
        &[$(RoleColor { label: $label, names: &[$($name),*], color: rgb($color) },)*]
    };
}

/// Every role, in the order of legends. The last one is for everything else.
pub(super) const ROLES: &[RoleColor] = roles![
    "Outer wall", 0xE07B00, ["external perimeter", "outer wall", "wall-outer", "outer perimeter"];
    "Inner wall", 0xF6CB66, ["perimeter", "inner wall", "wall-inner", "inner perimeter"];
    "Overhang wall", 0x7C4A03, ["overhang perimeter", "overhang wall"];
    "Sparse infill", 0xA8325E, ["internal infill", "sparse infill", "fill", "infill"];
    "Solid infill", 0x8F6CC0, ["solid infill", "internal solid infill", "bottom surface", "solid layer"];
    "Top surface", 0xD7B3E8, ["top solid infill", "top surface", "skin"];
    "Bridge", 0x45257D, ["bridge infill", "bridge", "internal bridge infill", "internal bridge"];
    "Gap fill", 0x8C8C8C, ["gap fill", "gap infill"];
    "Skirt and brim", 0xA9B18F, ["skirt/brim", "skirt", "brim"];
    "Support", 0x63AD91, ["support material", "support"];
    "Support interface", 0x14624A, ["support material interface", "support interface", "support-interface"];
    "Ironing", 0xF4D3DA, ["ironing"];
    "Other", 0x5F6B73, ["custom", "wipe tower", "prime tower", "prime-tower"];
];

/// Roles whose loops have a seam.
pub(super) const SEAMED: std::ops::Range<usize> = 0..1;

/// The colours of what is no role.
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

/// The index in [`ROLES`] for a name in a comment.
pub(super) fn role(name: &[u8]) -> usize {
    let name = String::from_utf8_lossy(name).trim().to_ascii_lowercase();
    ROLES.iter().position(|role| role.names.contains(&name.as_str())).unwrap_or(ROLES.len() - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toolpath::Role;

    #[test]
    fn every_role_of_ours_has_a_colour_of_its_own() {
        let own = [
            Role::Skirt,
            Role::Support,
            Role::SupportInterface,
            Role::Perimeter,
            Role::ExternalPerimeter,
            Role::OverhangPerimeter,
            Role::GapFill,
            Role::SolidInfill,
            Role::BridgeInfill,
            Role::InternalInfill,
            Role::TopSolidInfill,
            Role::Ironing,
        ];
        let mut found = own.map(|own| role(own.type_name().as_bytes()));
        found.sort_unstable();
        assert_eq!(found, std::array::from_fn(|i| i));
    }

    /// Full dichromacy, on linear sRGB: G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, "A Physiologically-based
    /// Model for Simulation of Color Vision Deficiency", 2009, doi:10.1109/TVCG.2009.113.
    const SEEN_BY: [[[f64; 3]; 3]; 4] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
    ];

    /// CIE L*a*b* of a colour as somebody sees it.
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
