//! Material, speeds, retraction, travel and cooling.

use std::f64::consts::PI;

use crate::options::section;
use crate::toolpath::Role;
use crate::units::{Celsius, Mm, Mm3PerS, MmPerS, MmPerS2, Ratio, Seconds};

section! {
    /// `[filament]`: the material.
    FilamentSettings {
        /// Kind, as printed in headers: PLA, PETG, …
        material: String = "PLA".into(),
        /// What it is called, for printers and hosts; empty: by its kind.
        name: String = String::new(),
        /// Its color, such as #29B2B2, for hosts and viewers; empty: not known.
        color: String = String::new(),
        /// Diameter of the filament.
        diameter: Mm = Mm(1.75); 0.5..=5.0,
        /// g/cm³.
        density: f64 = 1.24; 0.1..=25.0, "g/cm³",
        /// Price per kilogram, in any currency.
        cost: f64 = 20.0; 0.0..=100000.0, "per kg",
        /// Extrusion multiplier.
        flow: f64 = 1.0; 0.1..=3.0,
        /// Linear or pressure advance; 0 leaves the firmware's value unchanged.
        pressure_advance: f64 = 0.0; 0.0..=10.0, "s",
        /// Largest flow the hot end melts; 0: not limited.
        max_flow: Mm3PerS = Mm3PerS(0.0); 0.0..=1000.0,
    }
}
section! {
    /// `[temperature]`: 0 leaves a heater alone.
    TemperatureSettings {
        /// Nozzle from the second layer on.
        nozzle: Celsius = Celsius(205.0); 0.0..=500.0,
        /// Nozzle on the first layer.
        nozzle_first_layer: Celsius = Celsius(210.0); 0.0..=500.0,
        /// Bed from the second layer on.
        bed: Celsius = Celsius(60.0); 0.0..=200.0,
        /// Bed on the first layer.
        bed_first_layer: Celsius = Celsius(60.0); 0.0..=200.0,
        /// Chamber; 0: not heated.
        chamber: Celsius = Celsius(0.0); 0.0..=200.0,
        /// The print waits until the chamber has this; 0: it does not wait.
        chamber_min: Celsius = Celsius(0.0); 0.0..=200.0,
    }
}
section! {
    /// `[speed]`
    SpeedSettings {
        /// Outermost wall.
        external_perimeter: MmPerS = MmPerS(40.0); 0.1..=2000.0,
        /// Inner walls.
        perimeter: MmPerS = MmPerS(60.0); 0.1..=2000.0,
        /// Walls no longer than the outline of a disc of 6.5 mm radius; 0: as others.
        small_perimeter: MmPerS = MmPerS(0.0); 0.0..=2000.0,
        /// Sparse infill.
        infill: MmPerS = MmPerS(80.0); 0.1..=2000.0,
        /// Solid infill.
        solid: MmPerS = MmPerS(60.0); 0.1..=2000.0,
        /// Top surfaces.
        top: MmPerS = MmPerS(40.0); 0.1..=2000.0,
        /// Ironing.
        ironing: MmPerS = MmPerS(15.0); 0.1..=2000.0,
        /// Bridges.
        bridge: MmPerS = MmPerS(40.0); 0.1..=2000.0,
        /// Walls that overhang by more than a quarter, a half and three quarters of their width.
        overhang: [MmPerS; 3] = [MmPerS(35.0), MmPerS(25.0), MmPerS(15.0)]; 0.1..=2000.0,
        /// Walls with nothing under them; 0: as bridges.
        over_air: MmPerS = MmPerS(0.0); 0.0..=2000.0,
        /// Gap fill.
        gap_fill: MmPerS = MmPerS(40.0); 0.1..=2000.0,
        /// Support.
        support: MmPerS = MmPerS(60.0); 0.1..=2000.0,
        /// Dense support under the part; 0: as support.
        support_interface: MmPerS = MmPerS(0.0); 0.0..=2000.0,
        /// Skirt and brim.
        skirt: MmPerS = MmPerS(40.0); 0.1..=2000.0,
        /// Travel in X and Y.
        travel: MmPerS = MmPerS(150.0); 0.1..=2000.0,
        /// Travel in Z.
        z: MmPerS = MmPerS(10.0); 0.1..=500.0,
    }
}
section! {
    /// `[acceleration]`: 0 leaves the firmware's value alone, or is what is said beside it.
    AccelerationSettings {
        /// Everything without a value of its own.
        default: MmPerS2 = MmPerS2(1500.0); 0.0..=100000.0,
        /// Outermost wall.
        external_perimeter: MmPerS2 = MmPerS2(1000.0); 0.0..=100000.0,
        /// Inner walls; 0: `acceleration.default`, as with those below.
        perimeter: MmPerS2 = MmPerS2(0.0); 0.0..=100000.0,
        /// Sparse infill.
        infill: MmPerS2 = MmPerS2(0.0); 0.0..=100000.0,
        /// Solid infill and ironing.
        solid: MmPerS2 = MmPerS2(0.0); 0.0..=100000.0,
        /// Top surfaces.
        top: MmPerS2 = MmPerS2(0.0); 0.0..=100000.0,
        /// Bridges; 0: that of the solid infill, or wall, that it is part of.
        bridge: MmPerS2 = MmPerS2(0.0); 0.0..=100000.0,
        /// Travel.
        travel: MmPerS2 = MmPerS2(2000.0); 0.0..=100000.0,
    }
}
section! {
    /// `[flow]`: extrusion multipliers of roles, beside `filament.flow` and `first_layer.flow`.
    RoleFlowSettings {
        /// Outermost wall.
        external_perimeter: f64 = 1.0; 0.1..=3.0,
        /// Inner walls.
        perimeter: f64 = 1.0; 0.1..=3.0,
        /// Gap fill.
        gap_fill: f64 = 1.0; 0.1..=3.0,
        /// Sparse infill.
        infill: f64 = 1.0; 0.1..=3.0,
        /// Solid infill.
        solid: f64 = 1.0; 0.1..=3.0,
        /// Top surfaces.
        top: f64 = 1.0; 0.1..=3.0,
        /// Support.
        support: f64 = 1.0; 0.1..=3.0,
        /// Dense support under the part.
        support_interface: f64 = 1.0; 0.1..=3.0,
        /// Skirt and brim.
        skirt: f64 = 1.0; 0.1..=3.0,
    }
}
section! {
    /// `[retract]`
    RetractSettings {
        /// Length of filament retracted; 0: none.
        length: Mm = Mm(1.0); 0.0..=20.0,
        /// Speed of retraction.
        speed: MmPerS = MmPerS(40.0); 0.1..=500.0,
        /// Speed of unretraction.
        unretract_speed: MmPerS = MmPerS(40.0); 0.1..=500.0,
        /// Filament fed beyond the retracted length, with the first millimetres of the next bead.
        extra: Mm = Mm(0.0); -5.0..=5.0,
        /// Travels shorter than this are not retracted.
        min_travel: Mm = Mm(1.5); 0.0..=1000.0,
        /// Retract before every layer but the first, however near it begins.
        layer_change: bool = false,
        /// Nozzle lift while retracted.
        z_hop: Mm = Mm(0.0); 0.0..=10.0,
        /// Lift on layers from this height on only.
        z_hop_above: Mm = Mm(0.0); 0.0..=5000.0,
        /// Lift on layers up to this height only; 0: on all.
        z_hop_below: Mm = Mm(0.0); 0.0..=5000.0,
        /// How steeply the nozzle lifts while it travels; 90: straight up, before it travels.
        z_hop_slope: f64 = 90.0; 1.0..=90.0, "°",
        /// Lift on a slope inside the part alone, as steeply as it takes to be up where the travel leaves it; off: no steeper there, and no higher than the travel is long enough for.
        z_hop_before_leaving: bool = true,
        /// Lift on travels inside the part too, not only on those that cross an outer wall.
        z_hop_inside: bool = false,
        /// Wipe: distance moved back over the last path while retracting; 0: none.
        wipe: Mm = Mm(0.0); 0.0..=50.0,
        /// Share of the filament that is pulled back before a wipe; 1: there is no wipe.
        before_wipe: Ratio = Ratio(0.0); 0.0..=1.0,
        /// Coasting: distance at the end of a bead without extrusion, before a retraction; 0: none.
        coast: Mm = Mm(0.0); 0.0..=10.0,
        /// Leave lengths and speeds to the firmware (G10, G11).
        firmware: bool = false,
        /// Length of filament retracted before another tool is taken; by a single nozzle, whose filament is taken out, no more than `retract.length`.
        change_length: Mm = Mm(4.0); 0.0..=100.0,
        /// Filament fed beyond that length when the tool is taken again.
        change_extra: Mm = Mm(0.0); -5.0..=20.0,
    }
}
section! {
    /// `[travel]`
    TravelSettings {
        /// Lead travels round holes and outer walls instead of across them.
        avoid_crossing: bool = true,
        /// Greatest extra length of a detour; longer ones are not made.
        max_detour: Mm = Mm(20.0); 0.0..=10000.0,
        /// Travels that stay inside the part are not retracted up to this length.
        retract_inside: Mm = Mm(5.0); 0.0..=10000.0,
    }
}
section! {
    /// `[cooling]`
    CoolingSettings {
        /// Layers shorter than this are slowed down; 0: never.
        min_layer_time: Seconds = Seconds(8.0); 0.0..=3600.0,
        /// Minimum speed of layers that are slowed down.
        min_speed: MmPerS = MmPerS(10.0); 0.1..=500.0,
        /// Fan on ordinary layers.
        fan: Ratio = Ratio(1.0); 0.0..=1.0,
        /// Layers shorter than this have more fan; 0: none have.
        short_layer_time: Seconds = Seconds(0.0); 0.0..=3600.0,
        /// Fan on layers that take `short_layer_time`, and on those that take `min_layer_time` or less; what is between has a
        /// fan between.
        short_layer_fan: [Ratio; 2] = [Ratio(0.0), Ratio(0.0)]; 0.0..=1.0,
        /// Layers at the start without fan.
        fan_off_layers: u32 = 1; 0..=10000,
        /// Layer from which the fan has its full value; it ramps up to there.
        full_fan_layer: u32 = 3; 0..=10000,
        /// Minimum fan on bridges.
        bridge_fan: Ratio = Ratio(1.0); 0.0..=1.0,
        /// Minimum fan on walls that overhang by more than half their width.
        overhang_fan: Ratio = Ratio(1.0); 0.0..=1.0,
        /// Least fan on walls that hang over by more than a quarter, a half and three quarters of their width, and by all of
        /// it, where that is more than `overhang_fan`.
        overhang_fan_steps: [Ratio; 4] = [Ratio(0.0); 4]; 0.0..=1.0,
    }
}

impl FilamentSettings {
    /// Cross-section of the filament, square millimetres.
    pub fn area_mm2(&self) -> f64 {
        filament_area_mm2(self.diameter)
    }
}

impl RoleFlowSettings {
    /// The multiplier of a role. Bridges and ironing have theirs where their beads are planned.
    pub fn of(&self, role: Role) -> f64 {
        match role {
            Role::ExternalPerimeter | Role::OverhangPerimeter => self.external_perimeter,
            Role::Perimeter => self.perimeter,
            Role::GapFill => self.gap_fill,
            Role::InternalInfill => self.infill,
            Role::SolidInfill => self.solid,
            Role::TopSolidInfill => self.top,
            Role::Support => self.support,
            Role::SupportInterface => self.support_interface,
            Role::Skirt | Role::Brim => self.skirt,
            Role::BridgeInfill | Role::Ironing | Role::PrimeTower => 1.0,
        }
    }
}

impl TravelSettings {
    /// By how much a detour may lengthen a travel, millimetres; 0: travels go straight.
    pub fn detour_mm(&self) -> f64 {
        if self.avoid_crossing { self.max_detour.0 } else { 0.0 }
    }
}

/// Cross-section of filament of a diameter, square millimetres.
pub fn filament_area_mm2(diameter: Mm) -> f64 {
    PI / 4.0 * diameter.0 * diameter.0
}
