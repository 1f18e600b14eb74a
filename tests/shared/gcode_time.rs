//! The planner against Klipper's own: print times of other slicers' files that Klipper computed in batch mode
//! on this machine.

use pathwright::estimate::{Firmware, Machine};
use pathwright::gcode::file_time;
use pathwright::profile;

use crate::shared;

/// The machine of the reference: the standard job's limits, E's as far as its steps resolve them.
fn machine() -> Machine {
    let settings = profile::resolve(&["standard-job".into()], &[]).expect("embedded").settings;
    let mut machine = Machine::under(Firmware::Klipper, &settings);
    (machine.max_speed[3], machine.max_acceleration[3]) = (79.8, 798.0);
    machine
}

/// Cura's end script homes X and Y, which is no move to us.
const HOMING_S: f64 = 17.0;

pub fn print_times_agree_with_klippers_planner_within_a_thousandth() {
    let mut compared = 0;
    for (name, klipper_s) in [
        ("cura-15.04.3_3DHackerTest", 3407.54 - HOMING_S),
        ("cura-15.04.3_TortureTestV2", 4945.62 - HOMING_S),
        ("cura-15.04.3_ctrlV_3D_test", 2856.20 - HOMING_S),
        ("curaengine-5.0_ctrlV_3D_test", 2737.24),
        ("prusaslicer-2.9.2_3DHackerTest", 3746.87),
        ("prusaslicer-2.9.2_TortureTestV2", 6187.57),
        ("prusaslicer-2.9.2_ctrlV_3D_test", 3162.07),
        ("slic3r-1.3.0_ctrlV_3D_test", 3123.71),
    ] {
        let Ok(text) = std::fs::read(shared(&format!("gcode/{name}.gcode"))) else { continue };
        compared += 1;
        let seconds = file_time(&text, &machine()).0;
        println!(
            "{name}: {seconds:.2} s, Klipper {klipper_s} s, {:+.3} %",
            100.0 * (seconds / klipper_s - 1.0)
        );
        assert!((seconds / klipper_s - 1.0).abs() < 0.001, "{name}: {seconds} s, Klipper {klipper_s} s");
    }
    assert!(compared > 0, "none of the files is there");
}
