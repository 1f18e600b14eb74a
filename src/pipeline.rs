//! Stages wired.
