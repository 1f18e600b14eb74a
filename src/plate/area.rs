//! The bed, and what fits it.

use geometry::{Point, Region, Ring, real};

use super::error::PlacementError;
use super::options::{BedSettings, BedShape};
use super::pack::{Footprint, group_box};

/// Fits may be exact: a 250 mm plate on a 250 mm bed, with the noise of binary floating point.
pub(super) const TOLERANCE_MM: f64 = 1e-4;

/// Turns about Z that are tried, in degrees, and the square one.
const TURN: u32 = 5;
const SQUARE: u32 = 90;

/// The usable part of the bed, its middle at the origin.
pub(super) struct Area {
    pub shape: BedShape,
    pub half: [f64; 2],
    height: f64,
    margin_mm: f64,
    /// Rectangles that are left out, with the margin around them.
    excluded: Vec<[[f64; 2]; 2]>,
}

impl Area {
    pub fn new(bed: &BedSettings, margin_mm: f64) -> Self {
        let half = bed.size.map(|side| (side.0 / 2.0 - margin_mm).max(0.0));
        let middle = bed.middle_mm();
        let around = |[low, high]: [[f64; 2]; 2]| {
            [[0, 1].map(|i| low[i] - middle[i] - margin_mm), [0, 1].map(|i| high[i] - middle[i] + margin_mm)]
        };
        let excluded = bed.excluded_mm().map(around).collect();
        Self { shape: bed.shape, half, height: bed.height.0, margin_mm, excluded }
    }

    /// Whether what has these outermost points is on the bed, and its box clear of what is left out.
    pub fn holds(&self, points: impl Iterator<Item = [f64; 2]> + Clone) -> bool {
        let extent =
            |i: usize, pick: fn(f64, f64) -> f64, from: f64| points.clone().map(|p| p[i]).fold(from, pick);
        let low = [0, 1].map(|i| extent(i, f64::min, f64::INFINITY));
        let high = [0, 1].map(|i| extent(i, f64::max, f64::NEG_INFINITY));
        let meets = |[from, to]: &[[f64; 2]; 2]| {
            (0..2).all(|i| low[i] < to[i] - TOLERANCE_MM && high[i] > from[i] + TOLERANCE_MM)
        };
        self.excess_mm(points.clone()) <= TOLERANCE_MM && !self.excluded.iter().any(meets)
    }

    /// How far points reach beyond the edge; negative inside.
    pub fn excess_mm(&self, points: impl Iterator<Item = [f64; 2]>) -> f64 {
        let beyond = |p: [f64; 2]| match self.shape {
            BedShape::Rectangular => (p[0].abs() - self.half[0]).max(p[1].abs() - self.half[1]),
            BedShape::Round => real::hypot(p[0], p[1]) - self.half[0],
        };
        points.map(beyond).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Positions moved together so that the box around all models has its middle over the bed's, if all stay on it.
    pub fn in_the_middle<'a>(
        &self,
        mut positions: Vec<(u32, [f64; 2])>,
        rim: impl Fn(usize, u32) -> &'a [[f64; 2]],
    ) -> Vec<(u32, [f64; 2])> {
        let points = |positions: &[(u32, [f64; 2])]| -> Vec<[f64; 2]> {
            let moved = |(model, &(turn, at)): (usize, &(u32, [f64; 2]))| {
                rim(model, turn).iter().map(move |p| [p[0] + at[0], p[1] + at[1]])
            };
            positions.iter().enumerate().flat_map(moved).collect()
        };
        let extent = |pick: fn(f64, f64) -> f64| {
            points(&positions)
                .into_iter()
                .reduce(|a, b| [pick(a[0], b[0]), pick(a[1], b[1])])
                .unwrap_or_default()
        };
        let (low, high) = (extent(f64::min), extent(f64::max));
        let by = [0, 1].map(|i| -(low[i] + high[i]) / 2.0);
        let stays = positions.iter().enumerate().all(|(model, &(turn, at))| {
            self.holds(rim(model, turn).iter().map(|p| [0, 1].map(|i| p[i] + at[i] + by[i])))
        });
        if stays {
            for (_, at) in &mut positions {
                *at = [at[0] + by[0], at[1] + by[1]];
            }
        }
        positions
    }

    /// The part of the bed's extent that is needed: more than 1 does not fit.
    pub fn share(&self, footprint: &Footprint) -> f64 {
        let flat = self.group_share(&[footprint], &[[0.0; 2]]);
        flat.max((footprint.height_mm - TOLERANCE_MM) / self.height)
    }

    /// As `share`, of footprints in place, the middle of their common box taken to the middle of the bed.
    pub fn group_share(&self, footprints: &[&Footprint], positions: &[[f64; 2]]) -> f64 {
        let [min, max] = group_box(footprints, positions);
        let usable = |half: f64| half + TOLERANCE_MM;
        match self.shape {
            BedShape::Rectangular => {
                let share = |i: usize| (max[i] - min[i]) / 2.0 / usable(self.half[i]);
                share(0).max(share(1))
            }
            BedShape::Round => {
                let middle = [(min[0] + max[0]) / 2.0, (min[1] + max[1]) / 2.0];
                let rims =
                    footprints.iter().zip(positions).flat_map(|(f, s)| f.rim.iter().map(move |p| (p, s)));
                let reach = rims.map(|(p, s)| real::hypot(p[0] + s[0] - middle[0], p[1] + s[1] - middle[1]));
                reach.fold(0.0, f64::max) / usable(self.half[0])
            }
        }
    }

    /// The turn about Z, in degrees, after which something fits: a square one, or the one with the most room.
    fn fitting_turn(&self, footprint: &Footprint) -> Option<u32> {
        let share = |degrees: u32| {
            let (sin, cos) = real::sin_cos(f64::from(degrees).to_radians());
            let rim: Vec<[f64; 2]> =
                footprint.rim.iter().map(|[x, y]| [cos * x - sin * y, sin * x + cos * y]).collect();
            let [width, depth] = [0, 1].map(|i| 2.0 * rim.iter().map(|p| p[i].abs()).fold(0.0, f64::max));
            self.share(&Footprint::new([width, depth, footprint.height_mm], Some(rim)))
        };
        let turns = (TURN..180).step_by(TURN as usize).map(|degrees| (share(degrees), degrees));
        let most_room = || turns.min_by(|a, b| a.0.total_cmp(&b.0));
        let (share, degrees) =
            Some((share(SQUARE), SQUARE)).filter(|square| square.0 <= 1.0).or_else(most_room)?;
        (share <= 1.0).then_some(degrees)
    }

    /// Whether something fits at all.
    ///
    /// # Errors
    /// By how much it does not.
    pub fn check(&self, name: &str, footprint: &Footprint) -> Result<(), PlacementError> {
        let share = self.share(footprint);
        if share <= 1.0 {
            return Ok(());
        }
        let size = footprint.size();
        let mut excess = Vec::new();
        match self.shape {
            BedShape::Rectangular => {
                for (axis, by) in ["X", "Y"].into_iter().zip([0, 1].map(|i| size[i] - 2.0 * self.half[i])) {
                    if by > TOLERANCE_MM {
                        excess.push(format!("{by:.2} mm too long in {axis}"));
                    }
                }
            }
            BedShape::Round => {
                let by = self.excess_mm(footprint.rim.iter().copied());
                if by > TOLERANCE_MM {
                    excess.push(format!("it reaches {by:.2} mm beyond the edge"));
                }
            }
        }
        if size[2] > self.height + TOLERANCE_MM {
            excess.push(format!("{:.2} mm too high", size[2] - self.height));
        }
        Err(PlacementError::TooLarge {
            name: name.to_string(),
            size,
            bed: self.to_string(),
            excess: excess.join(", "),
            turn: self.fitting_turn(footprint),
            factor: fitting_factor(share),
        })
    }
}

/// The largest factor, at most 1, by which something that needs this share of the bed fits it: four digits are enough,
/// rounded down.
pub(super) fn fitting_factor(share: f64) -> f64 {
    if share <= 1.0 { 1.0 } else { ((1.0 / share) * 1e4).floor() / 1e4 }
}

impl BedSettings {
    /// Where nothing may be printed.
    pub(crate) fn excluded(&self) -> Region {
        let ring = |[low, high]: [[f64; 2]; 2]| -> Ring {
            let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
            corners.map(|[x, y]| Point::from_mm(x, y)).to_vec()
        };
        geometry::unite_rings(&self.excluded_mm().map(ring).collect::<Vec<_>>())
    }

    /// How far points reach beyond the edge of the bed, millimetres; negative inside.
    pub(crate) fn excess_mm(&self, points: impl Iterator<Item = [f64; 2]>) -> f64 {
        let middle = self.middle_mm();
        Area::new(self, 0.0).excess_mm(points.map(|[x, y]| [x - middle[0], y - middle[1]]))
    }
}

impl std::fmt::Display for Area {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [w, d] = self.half.map(|half| 2.0 * (half + self.margin_mm));
        match self.shape {
            BedShape::Rectangular => write!(f, "{w} × {d} × {} mm", self.height)?,
            BedShape::Round => write!(f, "round bed of {w} mm, {} mm high", self.height)?,
        }
        if self.margin_mm > 0.0 {
            write!(f, " less {} mm at the edge for skirt and brim", self.margin_mm)?;
        }
        Ok(())
    }
}
