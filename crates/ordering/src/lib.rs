//! The order, direction and entry of strokes that a machine draws, such that the links between them cost little, with a
//! lower bound that says how much could still be saved.
//!
//! A [`Problem`] states what is drawn and what comes before what, a [`Strategy`] finds a [`Sequence`], [`evaluate`] says
//! what its links cost under a [`Cost`], [`check`](check()) whether it keeps to the problem, and [`bound`] what no sequence
//! can stay below.
//!
//! # Examples
//! ```
//! use pathwright_geometry::Point;
//! use pathwright_ordering::{Cost, Effort, OrderStrategy, Problem, Shape, evaluate, strategy};
//!
//! let line = |y: f64| Shape::Open([Point::from_mm(0.0, y), Point::from_mm(50.0, y)]);
//! let problem = Problem::of([line(0.0), line(2.0), line(1.0)]);
//! let sequence = strategy(OrderStrategy::Optimized).solve(&problem, &Cost::Length, Effort::Normal);
//! assert_eq!(evaluate(&problem, &sequence, &Cost::Length), 2.0);
//! ```

#![forbid(unsafe_code)]
#![deny(missing_docs)]
#![allow(rustdoc::private_intra_doc_links)]

mod as_sliced;
pub mod bound;
mod check;
mod christofides;
mod christofides_open;
mod cost;
mod detours;
mod entries;
mod greedy;
mod index;
pub mod matching;
mod nearest;
mod optimized;
mod options;
mod polyline;
mod precedence;
mod problem;
mod strategies;
mod strategy;
pub mod tools;
mod watch;

pub use as_sliced::AsSliced;
pub use check::{Fault, check};
pub use christofides::Christofides;
pub use christofides_open::ChristofidesOpen;
pub use cost::{Cost, LinkKind, TravelTime, evaluate, links, ramped_s, trapezoid_s};
pub use detours::{DetourRule, Detours};
pub use greedy::Greedy;
pub use nearest::Nearest;
pub use optimized::Optimized;
pub use options::{Effort, OrderStrategy, Scope, chosen};
pub use polyline::{OrderOptions, Ordered, Polyline, order, order_watched};
pub use precedence::first_points;
pub use problem::{Item, Problem, Run, Sequence, Shape, Visit};
pub use strategies::strategy;
pub use strategy::{Known, Strategy};
pub use watch::Watch;

/// The examples of the README are compiled with the documentation's.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
