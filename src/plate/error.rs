//! Why models cannot be placed.

/// Models that do not fit (exit code 5).
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)]
pub enum PlacementError {
    #[error(
        "{name}: {:.2} × {:.2} × {:.2} mm does not fit the printer's {bed}: {excess}; {}--scale-to-fit would scale it by {factor}",
        size[0], size[1], size[2], turned(*turn)
    )]
    TooLarge { name: String, size: [f64; 3], bed: String, excess: String, turn: Option<u32>, factor: f64 },
    #[error(
        "{total} models do not fit the printer's {bed} together, {spacing_mm} mm apart: {fitting} do, and there is no \
         room for {}; print the others on another plate, or use --each",
        listed(left)
    )]
    TooMany { total: usize, fitting: usize, left: Vec<String>, spacing_mm: f64, bed: String },
    #[error(
        "{a} and {b} stand closer than {apart_mm:.1} mm where the files put them, too near to be printed one after the \
         other; leave out --sequential (print.sequence) or --no-arrange, or move them apart"
    )]
    TooNear { a: String, b: String, apart_mm: f64 },
    #[error(
        "{name}: where it is put, it reaches {by_mm:.2} mm beyond the printer's {bed}; give another --translate, or \
         leave out --no-arrange: what a file places relative to each other stays so"
    )]
    Outside { name: String, by_mm: f64, bed: String },
    #[error("{name}: where it stands, it reaches {by_mm:.2} mm beyond the printer's {bed}; move it")]
    OffBed { name: String, by_mm: f64, bed: String },
    #[error(
        "{name}: where it stands, it reaches {by_mm:.2} mm higher than the printer prints; move it down, or scale it"
    )]
    TooHigh { name: String, by_mm: f64 },
    #[error("{name}: it has no position on the bed, which others have; give all models a position, or none")]
    NoPosition { name: String },
    #[error(
        "{name}: a model with a position stands there once; leave out its copies, or add it again elsewhere"
    )]
    CopiesAtPosition { name: String },
    #[error(
        "--translate lifts the model {0} mm off the bed; give a Z of 0, or a negative one to cut off the bottom"
    )]
    InTheAir(f64),
}

impl PlacementError {
    /// The object that is at fault, or the first of them.
    pub fn object(&self) -> Option<&str> {
        match self {
            Self::TooLarge { name, .. }
            | Self::Outside { name, .. }
            | Self::OffBed { name, .. }
            | Self::TooHigh { name, .. }
            | Self::NoPosition { name }
            | Self::CopiesAtPosition { name } => Some(name),
            Self::TooNear { b, .. } => Some(b),
            Self::TooMany { left, .. } => left.first().map(String::as_str),
            Self::InTheAir(_) => None,
        }
    }
}

/// What a turn about Z, degrees, would do.
fn turned(turn: Option<u32>) -> String {
    turn.map_or_else(String::new, |degrees| format!("turned by {degrees}° about Z (--rotate) it fits, "))
}

/// The first few of some names.
pub(super) fn listed(names: &[String]) -> String {
    const SHOWN: usize = 5;
    match names.len().checked_sub(SHOWN) {
        None | Some(0) => names.join(", "),
        Some(more) => format!("{} and {more} more", names[..SHOWN].join(", ")),
    }
}
