//! Stage `estimate`.
