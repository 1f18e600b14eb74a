//! Stand-ins of print hosts, written from their documentation; no printer is behind them.

#![allow(dead_code, reason = "each test program uses a part of it")]

pub mod duet;
pub mod http;
pub mod moonraker;
