//! Stage `mesh`.
