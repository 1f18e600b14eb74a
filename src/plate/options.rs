//! How the bed is shaped and how models share it.

use crate::options::{choice, section};
use crate::units::Mm;

choice! {
    /// Outline of the bed.
    BedShape {
        /// `size` is width and depth.
        Rectangular = "rectangular",
        /// `size[0]` is the diameter.
        Round = "round",
    }
}
choice! {
    /// Which point of the bed lies at X 0, Y 0, or where `bed.offset` says.
    BedOrigin {
        /// Front left corner.
        Corner = "corner",
        /// The middle, as on deltas.
        Center = "center",
    }
}
choice! {
    /// The order of objects.
    Sequence {
        /// All objects layer by layer.
        Layer = "layer",
        /// One object after the other.
        Object = "object",
    }
}
section! {
    /// `[bed]`: the printable volume.
    BedSettings {
        /// Rectangular or round.
        shape: BedShape = BedShape::Rectangular,
        /// Width and depth; for a round bed the diameter, twice.
        size: [Mm; 2] = [Mm(250.0), Mm(250.0)]; 10.0..=5000.0,
        /// Printable height.
        height: Mm = Mm(250.0); 1.0..=5000.0,
        /// Which point of the bed `offset` places.
        origin: BedOrigin = BedOrigin::Corner,
        /// X and Y of that point, where the machine counts from elsewhere.
        offset: [Mm; 2] = [Mm(0.0), Mm(0.0)]; -5000.0..=5000.0,
        /// Rectangles in which nothing may be printed: X and Y of two opposite corners of each, one after the other.
        excluded: Vec<f64> = Vec::new(); -5000.0..=5000.0, "mm",
    }
}
section! {
    /// `[plate]`: how several models share the bed.
    PlateSettings {
        /// Minimum distance between models with their brim, raft and supports.
        spacing: Mm = Mm(5.0); 0.0..=200.0,
        /// Arrange models; if false, they keep their files' coordinates.
        arrange: bool = true,
        /// Keep the relative positions within a file where they fit the bed; if false, only objects that interlock.
        keep_layout: bool = true,
        /// Models may be rotated by quarter turns to fit.
        turn: bool = false,
        /// Rotate every model to stand stably and need the least support.
        orient: bool = false,
    }
}
section! {
    /// `[print]`: the order of objects.
    PrintSettings {
        /// Layer by layer, or object by object, the lowest first.
        sequence: Sequence = Sequence::Layer,
        /// Clearance of the print head around the nozzle: minimum distance of objects printed one after the other.
        clearance_radius: Mm = Mm(45.0); 1.0..=200.0,
        /// Height of the gantry above the nozzle: no object but the last may be higher.
        clearance_height: Mm = Mm(20.0); 1.0..=1000.0,
    }
}

impl BedSettings {
    /// The corner of least X and Y, millimetres.
    pub fn low_mm(&self) -> [f64; 2] {
        let middle = self.middle_mm();
        match self.origin {
            BedOrigin::Corner => self.offset.map(|mm| mm.0),
            BedOrigin::Center => [0, 1].map(|i| middle[i] - self.size[i].0 / 2.0),
        }
    }

    /// The corner of greatest X and Y, millimetres.
    pub fn high_mm(&self) -> [f64; 2] {
        let low = self.low_mm();
        [0, 1].map(|i| low[i] + self.size[i].0)
    }

    /// The rectangles in which nothing may be printed, each by its corners of least and of greatest X and Y, millimetres.
    pub fn excluded_mm(&self) -> impl Iterator<Item = [[f64; 2]; 2]> {
        self.excluded.chunks_exact(4).map(|corners| {
            let (x, y) = ([corners[0], corners[2]], [corners[1], corners[3]]);
            [[x[0].min(x[1]), y[0].min(y[1])], [x[0].max(x[1]), y[0].max(y[1])]]
        })
    }

    /// The middle, millimetres.
    pub fn middle_mm(&self) -> [f64; 2] {
        match self.origin {
            BedOrigin::Corner => [0, 1].map(|i| self.offset[i].0 + self.size[i].0 / 2.0),
            BedOrigin::Center => self.offset.map(|mm| mm.0),
        }
    }
}
