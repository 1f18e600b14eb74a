//! Marlin 2: the common dialect is its own.

use super::Dialect;

pub(in crate::gcode) struct Marlin;

impl Dialect for Marlin {}
