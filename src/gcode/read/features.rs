//! What slicers call the features of a print.

use crate::toolpath::Role;

/// Names by role. Spelling is compared without regard to case.
///
/// Sources: the slicers' own output, and the lists in their source texts: CuraEngine `gcodeExport.cpp`; PrusaSlicer and
/// SuperSlicer `ExtrusionRole.cpp`; OrcaSlicer and Bambu Studio `ExtrusionEntity.cpp`; Simplify3D 4 and 5.
const NAMES: &[(Role, &[&str])] = &[
    (Role::Skirt, &["SKIRT", "Skirt/Brim", "ooze shield", "raft"]),
    (Role::Brim, &["Brim"]),
    (Role::Support, &["SUPPORT", "Support material", "Support transition"]),
    (
        Role::SupportInterface,
        &["SUPPORT-INTERFACE", "Support material interface", "Support interface", "dense support"],
    ),
    (Role::Perimeter, &["WALL-INNER", "Perimeter", "Internal perimeter", "Inner wall", "inner perimeter"]),
    (
        Role::ExternalPerimeter,
        &[
            "WALL-OUTER",
            "External perimeter",
            "Outer wall",
            "outer perimeter",
            "Thin wall",
            "external single extrusion",
        ],
    ),
    (Role::OverhangPerimeter, &["Overhang perimeter", "Overhang wall"]),
    (Role::GapFill, &["Gap fill", "Gap infill", "internal single extrusion"]),
    (
        Role::SolidInfill,
        &[
            "SKIN",
            "Solid infill",
            "Internal solid infill",
            "Bottom surface",
            "solid layer",
            "Floating vertical shell",
        ],
    ),
    (Role::BridgeInfill, &["Bridge infill", "Internal bridge infill", "Bridge", "Internal Bridge"]),
    (Role::InternalInfill, &["FILL", "Internal infill", "Sparse infill", "infill"]),
    (Role::TopSolidInfill, &["Top solid infill", "Top surface"]),
    (Role::Ironing, &["Ironing"]),
];

/// KISSlicer's names, which mean other things than the same words elsewhere.
const KISSLICER: &[(Role, &[&str])] = &[
    (Role::Skirt, &["Skirt", "Raft"]),
    (Role::Support, &["Support (may Stack)", "Support"]),
    (Role::SupportInterface, &["Support Interface"]),
    (Role::Perimeter, &["Loop"]),
    (Role::ExternalPerimeter, &["Perimeter"]),
    (Role::GapFill, &["Crown", "Gap Fill"]),
    (Role::SolidInfill, &["Solid"]),
    (Role::InternalInfill, &["Sparse Infill", "Stacked Sparse Infill"]),
];

/// The role that a feature's name means, whichever slicer it comes from; `None` where the name is unknown or means
/// something that is no part of the object (`Custom`, `Wipe tower`).
///
/// The name is the one of [`Mark::Feature`](super::Mark::Feature): KISSlicer's come in quotes.
pub fn role(name: &[u8]) -> Option<Role> {
    let name = name.trim_ascii();
    let (table, name) = match name.strip_prefix(b"'") {
        Some(quoted) => {
            let name = quoted.split(|b| *b == b'\'').next().unwrap_or_default();
            (KISSLICER, name.strip_suffix(b" Path").unwrap_or(name))
        }
        None => (NAMES, name),
    };
    let known = |names: &[&str]| names.iter().any(|known| known.as_bytes().eq_ignore_ascii_case(name));
    table.iter().find(|(_, names)| known(names)).map(|(role, _)| *role)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_outer_wall_is_known_by_each_slicers_name() {
        let names =
            ["WALL-OUTER", "External perimeter", "Outer wall", "outer perimeter", "'Perimeter Path', 20"];
        for name in names {
            assert_eq!(role(name.as_bytes()), Some(Role::ExternalPerimeter), "{name}");
        }
    }

    #[test]
    fn own_names_are_read_back_as_the_role_they_stand_for() {
        let all = NAMES.iter().map(|(role, _)| *role).filter(|r| *r != Role::Brim);
        for own in all {
            assert_eq!(role(own.type_name().as_bytes()), Some(own));
        }
    }

    #[test]
    fn unknown_names_stay_unknown() {
        for name in ["Custom", "Wipe tower", "PRIME-TOWER", "", "perimeters", "'"] {
            assert_eq!(role(name.as_bytes()), None, "{name}");
        }
    }
}
