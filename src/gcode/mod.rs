//! Stage `gcode`.
