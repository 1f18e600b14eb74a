//! Stage `slice`.
