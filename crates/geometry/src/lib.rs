//! Plane geometry on an integer grid: points, polylines, polygons with holes, booleans and offsets.
//!
//! One unit is 10 nm, so an `i32` spans ±21 m and products fit an `i64`. Everything that is added,
//! subtracted or compared is exact; only offsets and intersections round, to the nearest unit.

#![forbid(unsafe_code)]
#![deny(missing_docs)]
#![allow(rustdoc::private_intra_doc_links)]

mod arrange;
mod boolean;
mod boundary;
mod boxes;
mod cells;
mod clip;
mod cone;
mod crossed;
mod direction;
mod disjoint_sets;
mod grid;
mod hatch;
mod known;
mod medial;
mod nudge;
mod offset;
mod point;
mod random;
mod raw_offset;
pub mod real;
mod region;
mod route;
mod sample;
mod simplify;
mod sort;
mod triangles;

pub use boolean::{difference, intersection, split, union, union_all, unite_rings};
pub use boundary::{Boundary, BoundaryPos};
pub use boxes::Boxes;
pub use cells::nearest_kinds;
pub use clip::{ClippedPiece, Clipper, clip_polyline, clip_segments, polyline_length_mm};
pub use cone::Cone;
pub use direction::Direction;
pub use disjoint_sets::DisjointSets;
pub use grid::{Edge, EdgeGrid};
pub use hatch::{HatchEnd, HatchSegment, scan_lines};
pub use known::{Known, Shape};
pub use medial::{KnownAxes, MedialPath, medial_axis, medial_axis_in};
pub use offset::{Core, close_between, closing, core, narrower, offset, offset_with, opening, remainder};
pub use point::{Point, UNITS_PER_MM, cross, distance_mm, on_segment_mm, to_mm, to_segment_mm, to_units};
pub use random::Random;
pub use raw_offset::Join;
pub use region::{Bounds, Polygon, Region, Ring, ring_area, ring_contains, ring_length_mm};
pub use route::{Route, Router};
pub use simplify::simplify;
pub use triangles::triangles;

/// The examples of the README are compiled with the documentation's.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
