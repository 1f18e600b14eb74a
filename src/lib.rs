//! Pathwright: an STL-to-G-code slicer that finds a near-optimal order for everything the nozzle does.
//!
//! # Slicing
//! ```
//! use pathwright::{Mesh, Observer, Plate, Settings, Slicer};
//!
//! let settings = Settings::load(&["petg"])?.set("infill.density", "15%")?;
//! let plate = Plate::new(&settings).add(Mesh::read("models/calibration_cube.stl")?)?;
//! let print = Slicer::new(&settings).slice(&plate, &Observer::none())?;
//! let mut file = Vec::new();
//! print.write_gcode(&mut file)?;
//! println!("{}", print.summary());
//! let longest = print.layers()[10].move_times_s.iter().fold(0.0, |a: f64, &b| a.max(b));
//! assert!(longest > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Watching and cancelling
//! ```
//! use std::sync::atomic::{AtomicBool, Ordering};
//! use pathwright::{Error, Mesh, Observer, Plate, Settings, Slicer};
//!
//! let settings = Settings::default();
//! let plate = Plate::new(&settings).add(Mesh::read("models/calibration_cube.stl")?)?;
//! let stop = AtomicBool::new(false);
//! // Here after the first layer; usually from another thread.
//! let observer = Observer::none()
//!     .on_progress(|done, _of| stop.store(done > 0, Ordering::Relaxed))
//!     .cancelled_by(&stop);
//! let result = Slicer::new(&settings).threads(0).slice(&plate, &observer);
//! assert!(matches!(result, Err(Error::Cancelled)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Finished G-code, and ordering by itself
//! ```
//! use pathwright::geometry::Point;
//! use pathwright::order::{OrderOptions, Polyline, order};
//! use pathwright::{Observer, Settings, check, reorder, time};
//!
//! let settings = Settings::default();
//! let gcode = b"G28\nM83\nG1 X0 Y0 Z0.2 F3000\nG1 X9 Y0 E0.3\nG0 X0 Y2\nG1 X9 Y2 E0.3\n".to_vec();
//! println!("{}{}", check(&gcode, &settings)?, time(&gcode, &settings)?);
//! let (_shorter, report) = reorder(gcode, &settings, &Observer::none())?;
//! assert!(report.after.travel_mm <= report.before.travel_mm);
//!
//! let line = |y: f64| Polyline {
//!     points: vec![Point::from_mm(0.0, y), Point::from_mm(50.0, y)],
//!     closed: false,
//!     group: 0,
//! };
//! let ordered = order(&[line(0.0), line(2.0), line(1.0)], &OrderOptions::default());
//! assert_eq!(ordered.length_mm, 2.0);
//! # Ok::<(), pathwright::Error>(())
//! ```
//!
//! # The stages
//! Data flows in one direction: `mesh` → `plate` → `slice` → `toolpath` → `order` → `motion` → `gcode`. A module imports only those
//! that come before it in `tests/stages/architecture.rs`; `docs/architecture.md` says what each is for.

pub mod check;
#[cfg(feature = "cli")]
pub mod cli;
pub mod estimate;
pub mod gcode;
pub mod job;
pub mod limits;
pub mod live;
pub mod mesh;
pub mod motion;
pub mod options;
pub mod order;
pub mod output;
pub mod pipeline;
pub mod plate;
pub mod presets;
pub mod profile;
pub mod reorder;
pub mod report;
#[cfg(feature = "hosts")]
pub mod send;
#[cfg(feature = "serve")]
pub mod serve;
pub mod slice;
#[cfg(feature = "system")]
pub mod system;
pub mod toolpath;
pub mod units;
pub mod view;

mod api;
mod near;
mod observer;
mod parallel;
mod plan;
mod source;

pub use api::{
    Beads, Model, Plate, Print, SlicedJob, Slicer, check, check_against, reorder, reorder_as, time,
};
pub use geometry;
pub use job::JobError as Error;
pub use mesh::Mesh;
pub use observer::Observer;
pub use pipeline::PrintLayer;
pub use profile::Settings;

/// The examples of the README are compiled with the documentation's.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
