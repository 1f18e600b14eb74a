//! Other slicers' configurations as profiles.

use pathwright::profile::{Settings, resolve};

use crate::support::print::settings;
use crate::{present, shared};

/// Configurations at the end of other slicers' G-code, as they are when everything is left at its default.
pub fn whole_configurations_in_gcode_resolve() {
    for path in
        present(&["gcode/prusaslicer-2.9.2_ctrlV_3D_test.gcode", "gcode/slic3r-1.3.0_ctrlV_3D_test.gcode"])
    {
        let path = path.to_str().expect("UTF-8");
        let s = settings(&["standard-job", path], &[]);
        assert_eq!((s.layer.height.0, s.walls.count, s.infill.density.0), (0.2, 2, 0.2), "{path}");
        assert_eq!(s.cooling.full_fan_layer, s.cooling.fan_off_layers, "{path}");
    }
}

/// The standard job as PrusaSlicer is told it.
pub fn the_standard_job_of_others_gives_ours() {
    let path = shared("peers/prusa.ini").to_str().expect("UTF-8").to_owned();
    let both = resolve(&["standard-job".into(), path], &[]).unwrap_or_else(|error| panic!("{error}"));
    let taken = both.origins.values().filter(|origin| origin.to_string().contains("prusa.ini:")).count();
    assert!(taken > 45, "{taken}");
    // Dialect and limits are another matter: `marlin` is Marlin 1 there.
    let sets = [
        "printer.flavor=marlin-legacy",
        "machine.print_acceleration=3000",
        "machine.travel_acceleration=3000",
    ];
    let ours = settings(&["standard-job"], &sets);
    assert_eq!(Settings { variables: ours.variables.clone(), ..both.settings }, ours);
}
