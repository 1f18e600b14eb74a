//! Pathwright: an STL-to-G-code slicer that finds a near-optimal order for everything the nozzle does.
//!
//! Data flows one way: `mesh` → `slice` → `toolpath` → `order` → `motion` → `gcode`; a module imports
//! only modules listed above it here. `docs/architecture.md` has the whole picture.

#![forbid(unsafe_code)]
#![deny(missing_docs)]
// Pages of public items also speak to those who read the source.
#![allow(rustdoc::private_intra_doc_links)]

pub mod check;
#[cfg(feature = "cli")]
pub mod cli;
pub mod estimate;
pub mod gcode;
pub mod job;
pub mod limits;
pub mod mesh;
pub mod motion;
mod observer;
pub mod options;
pub mod order;
pub mod output;
mod parallel;
pub mod pipeline;
mod plan;
pub mod plate;
pub mod profile;
pub mod reorder;
pub mod report;
pub mod slice;
mod source;
pub mod toolpath;
pub mod units;
pub mod view;

pub use observer::Observer;

pub use geometry;
#[doc(hidden)]
pub use geometry as geom;

/// The examples of the README are compiled with the documentation's.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
