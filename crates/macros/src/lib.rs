//! The macro language of G-code scripts of PrusaSlicer, SuperSlicer, OrcaSlicer and Bambu Studio.
//!
//! [`expand`] makes text of a script, [`holds`] says whether a condition is true; a [`Script`] or [`Condition`] is parsed
//! once for many times. Placeholders come from what implements [`Names`], and what lasts from script to script is kept in
//! a [`State`]. Any text ends in a result or an [`Error`] with its place: depth, work and output are limited.
//!
//! # Examples
//! ```
//! use std::collections::BTreeMap;
//! use pathwright_macros::{State, Value, expand, holds};
//!
//! let names = BTreeMap::from([
//!     ("layer_z".to_owned(), Value::from(10.2)),
//!     ("temperature".to_owned(), Value::from(vec![215, 230])),
//!     ("printer_notes".to_owned(), Value::from("PRINTER_MODEL_MK4")),
//! ]);
//! let script = "G1 Z{layer_z + 1}\n{if layer_z > 10}M104 S[temperature_1]{endif}";
//! assert_eq!(expand(script, &names, &mut State::default())?, "G1 Z11.2\nM104 S230");
//! assert!(holds("printer_notes =~ /.*MK4.*/ and temperature[0] < 220", &names)?);
//! # Ok::<(), pathwright_macros::Error>(())
//! ```

#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod error;
mod evaluate;
mod limits;
mod names;
mod near;
mod parse;
mod pattern;
mod script;
mod state;
mod syntax;
mod value;

pub use error::{Error, ErrorKind};
pub use names::Names;
pub use script::{Condition, Script, expand, holds};
pub use state::State;
pub use value::Value;

/// The examples of the README are compiled with the documentation's.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
