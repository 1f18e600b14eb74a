//! What holds for one layer: every value here is a function of the layer's index (and a path's role) alone.

use super::overhang::Grade;
use super::{MotionSettings, Move};
use crate::toolpath::Role;
use crate::units::{Celsius, MmPerS, MmPerS2, Ratio, Seconds};

/// Settings as they hold on one layer.
pub(super) struct Rules<'a> {
    settings: &'a MotionSettings,
    index: usize,
}

impl<'a> Rules<'a> {
    pub(super) fn new(settings: &'a MotionSettings, index: usize) -> Self {
        Self { settings, index }
    }

    /// The layer's index.
    pub(super) fn index(&self) -> usize {
        self.index
    }

    fn is_first(&self) -> bool {
        self.index == 0
    }

    /// Multiplier of the volume of a role's beads.
    pub(super) fn flow(&self, role: Role) -> f64 {
        let first = if self.is_first() { self.settings.first_layer.flow } else { 1.0 };
        self.settings.flow.multiplier * first * self.settings.role_flow.of(role)
    }

    /// Speed of a role before the flow limit, of walls by how far they hang over and whether they are `small`. On the
    /// first layer never above that layer's own, but for solid infill, which may have one.
    pub(super) fn speed(&self, role: Role, grade: Grade, small: bool) -> MmPerS {
        let speeds = &self.settings.speed;
        let or = |own: MmPerS, other: MmPerS| if own.0 > 0.0 { own } else { other };
        let speed = match role {
            Role::Skirt | Role::Brim => speeds.skirt,
            Role::Support => speeds.support,
            Role::SupportInterface => or(speeds.support_interface, speeds.support),
            Role::Perimeter | Role::ExternalPerimeter if small && speeds.small_perimeter.0 > 0.0 => {
                speeds.small_perimeter
            }
            Role::Perimeter => speeds.perimeter,
            Role::ExternalPerimeter => speeds.external_perimeter,
            Role::OverhangPerimeter | Role::BridgeInfill => speeds.bridge,
            Role::GapFill => speeds.gap_fill,
            Role::SolidInfill => speeds.solid,
            Role::InternalInfill => speeds.infill,
            Role::TopSolidInfill => speeds.top,
            Role::Ironing => speeds.ironing,
            Role::PrimeTower => speeds.infill,
        };
        let [quarter, half, three_quarters] = speeds.overhang;
        let hanging = match grade {
            Grade::Held => speed,
            Grade::Quarter => quarter,
            Grade::Half => half,
            Grade::ThreeQuarters => three_quarters,
            Grade::Air => or(speeds.over_air, speeds.bridge),
        };
        let speed = if hanging < speed { hanging } else { speed };
        let first = &self.settings.first_layer;
        if self.is_first() && role == Role::SolidInfill && first.infill_speed.0 > 0.0 {
            return first.infill_speed;
        }
        if self.is_first() && first.speed.0 > 0.0 && first.speed < speed { first.speed } else { speed }
    }

    /// Whether a wall that hangs over by a quarter is printed in another way than one that is held.
    pub(super) fn tells_quarters(&self, role: Role, small: bool) -> bool {
        let [held, quarter] = [Grade::Held, Grade::Quarter]
            .map(|grade| (self.speed(role, grade, small), self.fan(Some((role, grade)))));
        held != quarter
    }

    /// The speed at which a bead of this cross-section does not exceed the hot end's flow.
    pub(super) fn melted(&self, speed: MmPerS, area_mm2: f64) -> MmPerS {
        let max_flow = self.settings.flow.max_flow.0;
        if max_flow > 0.0 && area_mm2 * speed.0 > max_flow { MmPerS(max_flow / area_mm2) } else { speed }
    }

    /// Acceleration of a role, of walls by how far they hang over, or of travel; `None`: the profile leaves accelerations
    /// alone altogether.
    pub(super) fn acceleration(&self, drawn: Option<(Role, Grade)>) -> Option<MmPerS2> {
        let set = &self.settings.acceleration;
        let first = self.settings.first_layer.acceleration;
        let all = [set.default, set.external_perimeter, set.perimeter, set.infill, set.solid, set.top];
        if all.iter().chain(&[set.bridge, set.travel, first]).all(|a| a.0 <= 0.0) {
            return None;
        }
        let none = MmPerS2(0.0);
        let (own, bridge) = match drawn {
            None => (set.travel, none),
            Some((role, grade)) => {
                (self.acceleration_of(role), if grade == Grade::Air { set.bridge } else { none })
            }
        };
        let first = if self.is_first() { first } else { none };
        [first, bridge, own, set.default]
            .into_iter()
            .find(|a| a.0 > 0.0)
            .or(Some(self.settings.firmware_acceleration))
    }

    /// What a role has of its own; 0: nothing.
    fn acceleration_of(&self, role: Role) -> MmPerS2 {
        let set = &self.settings.acceleration;
        match role {
            Role::ExternalPerimeter => set.external_perimeter,
            Role::Perimeter => set.perimeter,
            Role::InternalInfill => set.infill,
            Role::SolidInfill | Role::Ironing => set.solid,
            Role::TopSolidInfill => set.top,
            Role::BridgeInfill if set.bridge.0 > 0.0 => set.bridge,
            Role::BridgeInfill => set.solid,
            _ => set.default,
        }
    }

    /// The commands at the beginning of the layer: temperatures and fan, where they differ from the layer below.
    /// `begins`: nothing has been printed before it.
    pub(super) fn opening(&self, begins: bool) -> impl Iterator<Item = Move> {
        let temperature = &self.settings.temperature;
        let first = (temperature.nozzle_first_layer, temperature.bed_first_layer);
        let others = (temperature.nozzle, temperature.bed);
        let none = Celsius(0.0);
        let changed = |to: Celsius, from: Celsius| if to == from { none } else { to };
        let (nozzle, bed) = match self.index {
            // The start script heats.
            0 if begins && !self.settings.heat_first_layer => (none, none),
            0 if begins => first,
            0 => (changed(first.0, others.0), changed(first.1, others.1)),
            1 => (changed(others.0, first.0), changed(others.1, first.1)),
            _ => (none, none),
        };
        let fan = self.own_fan();
        let changes = self.is_first() || self.fan_by_time() || fan != self.layer_fan(self.index - 1, None);
        let fan = changes.then_some(Move::Fan(fan));
        let heats = |t: Celsius| t.0 > 0.0;
        [heats(nozzle).then_some(Move::Nozzle(nozzle)), heats(bed).then_some(Move::Bed(bed)), fan]
            .into_iter()
            .flatten()
    }

    /// Temperature of the nozzle on the layer.
    pub(super) fn nozzle_temperature(&self) -> Celsius {
        let temperature = &self.settings.temperature;
        if self.is_first() { temperature.nozzle_first_layer } else { temperature.nozzle }
    }

    /// Fan for a role, of walls by how far they hang over, or what the layer has without one. Bridges and overhanging walls
    /// have at least their own, but none on layers without fan.
    pub(super) fn fan(&self, drawn: Option<(Role, Grade)>) -> Ratio {
        let cooling = &self.settings.cooling;
        let least = match drawn {
            None => Ratio(0.0),
            Some((Role::BridgeInfill, _)) => cooling.bridge_fan,
            Some((_, grade)) => {
                let [quarter, half, three_quarters, air] = cooling.overhang_fan_steps;
                let (step, all) = match grade {
                    Grade::Held => (Ratio(0.0), Ratio(0.0)),
                    Grade::Quarter => (quarter, Ratio(0.0)),
                    Grade::Half => (half, cooling.overhang_fan),
                    Grade::ThreeQuarters => (three_quarters, cooling.overhang_fan),
                    Grade::Air => (air, cooling.overhang_fan),
                };
                if step < all { all } else { step }
            }
        };
        let own = self.own_fan();
        if self.index >= cooling.fan_off_layers as usize && own < least { least } else { own }
    }

    /// Whether the fan depends on how long a layer takes: [`set_fan`](super::set_fan) adds what the layer has of its own.
    pub(super) fn fan_by_time(&self) -> bool {
        let cooling = &self.settings.cooling;
        cooling.short_layer_time.0 > 0.0 && cooling.short_layer_fan.iter().any(|fan| fan.0 > 0.0)
    }

    /// What the layer has as far as it is known before its moves are.
    fn own_fan(&self) -> Ratio {
        if self.fan_by_time() { Ratio(0.0) } else { self.layer_fan(self.index, None) }
    }

    /// Fan of a layer: off at first, then rising in equal steps until `full_fan_layer` has all of it; of one that is known
    /// to take so long, by that.
    pub(super) fn layer_fan(&self, index: usize, took: Option<Seconds>) -> Ratio {
        let cooling = &self.settings.cooling;
        let (off, full) = (cooling.fan_off_layers as usize, cooling.full_fan_layer as usize);
        let whole = took.map_or(cooling.fan, |took| self.timed_fan(took));
        if index < off {
            Ratio(0.0)
        } else if index >= full {
            whole
        } else {
            Ratio(whole.0 * (index + 1 - off) as f64 / (full + 1 - off) as f64)
        }
    }

    /// The whole fan of a layer that takes so long.
    fn timed_fan(&self, took: Seconds) -> Ratio {
        let cooling = &self.settings.cooling;
        let (shortest, short) = (cooling.min_layer_time, cooling.short_layer_time);
        let [least, most] = cooling.short_layer_fan.map(|fan| fan.0);
        if took < shortest {
            Ratio(most)
        } else if took < short {
            let share = (took - shortest).0 / (short - shortest).0;
            Ratio(share * least + (1.0 - share) * most)
        } else {
            cooling.fan
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::Settings;

    #[test]
    fn the_fan_is_off_first_then_rises_to_its_full_value() {
        let mut all = Settings::default();
        all.cooling.fan = Ratio(0.8);
        (all.cooling.fan_off_layers, all.cooling.full_fan_layer) = (2, 5);
        let settings = MotionSettings::new(&all, &[]);
        let fan: Vec<f64> = (0..7).map(|i| (Rules::new(&settings, i).fan(None).0 * 100.0).round()).collect();
        assert_eq!(fan, [0.0, 0.0, 20.0, 40.0, 60.0, 80.0, 80.0]);
    }

    #[test]
    fn small_walls_interfaces_air_and_the_first_layers_infill_have_speeds_of_their_own() {
        let mut all = Settings::default();
        let of = |all: &Settings, index, role, grade, small| {
            Rules::new(&MotionSettings::new(all, &[]), index).speed(role, grade, small).0
        };
        let cases = [
            (3, Role::Perimeter, Grade::Held, true, 60.0, 25.0),
            (3, Role::Perimeter, Grade::Held, false, 60.0, 60.0),
            (3, Role::ExternalPerimeter, Grade::Half, true, 25.0, 25.0),
            (3, Role::Perimeter, Grade::Air, false, 40.0, 12.0),
            (3, Role::SupportInterface, Grade::Held, false, 60.0, 33.0),
            (0, Role::SolidInfill, Grade::Held, false, 20.0, 70.0),
            (0, Role::Perimeter, Grade::Held, false, 20.0, 20.0),
        ];
        for (index, role, grade, small, usual, _) in cases {
            assert_eq!(of(&all, index, role, grade, small), usual, "{role:?} {grade:?}");
        }
        all.speed.small_perimeter = MmPerS(25.0);
        all.speed.over_air = MmPerS(12.0);
        all.speed.support_interface = MmPerS(33.0);
        all.first_layer.infill_speed = MmPerS(70.0);
        for (index, role, grade, small, _, own) in cases {
            assert_eq!(of(&all, index, role, grade, small), own, "{role:?} {grade:?}");
        }
    }

    #[test]
    fn the_further_walls_hang_over_the_more_fan_they_have() {
        let mut all = Settings::default();
        let cooling = &mut all.cooling;
        (cooling.fan, cooling.overhang_fan) = (Ratio(0.2), Ratio(0.5));
        cooling.overhang_fan_steps = [0.3, 0.4, 0.6, 0.8].map(Ratio);
        let settings = MotionSettings::new(&all, &[]);
        let grades = [Grade::Held, Grade::Quarter, Grade::Half, Grade::ThreeQuarters, Grade::Air];
        let fans = grades.map(|grade| Rules::new(&settings, 9).fan(Some((Role::Perimeter, grade))).0);
        assert_eq!(fans, [0.2, 0.3, 0.5, 0.6, 0.8]);
    }

    #[test]
    fn each_role_has_its_own_acceleration_and_walls_over_nothing_that_of_bridges() {
        let mut all = Settings::default();
        all.acceleration.default = MmPerS2(1000.0);
        all.acceleration.perimeter = MmPerS2(900.0);
        all.acceleration.infill = MmPerS2(4000.0);
        all.acceleration.solid = MmPerS2(2000.0);
        all.acceleration.top = MmPerS2(800.0);
        let of = |all: &Settings, role, grade| {
            let settings = MotionSettings::new(all, &[]);
            Rules::new(&settings, 7).acceleration(Some((role, grade))).map(|a| a.0)
        };
        let held = [
            (Role::Perimeter, 900.0),
            (Role::InternalInfill, 4000.0),
            (Role::SolidInfill, 2000.0),
            (Role::BridgeInfill, 2000.0),
            (Role::TopSolidInfill, 800.0),
            (Role::Support, 1000.0),
        ];
        for (role, wanted) in held {
            assert_eq!(of(&all, role, Grade::Held), Some(wanted), "{role:?}");
        }
        assert_eq!(of(&all, Role::Perimeter, Grade::Air), Some(900.0));
        all.acceleration.bridge = MmPerS2(500.0);
        assert_eq!(of(&all, Role::Perimeter, Grade::Air), Some(500.0));
        assert_eq!(of(&all, Role::Perimeter, Grade::ThreeQuarters), Some(900.0));
        assert_eq!(of(&all, Role::BridgeInfill, Grade::Held), Some(500.0));
    }

    #[test]
    fn an_acceleration_of_zero_means_the_default_and_all_zero_means_none() {
        let mut all = Settings::default();
        (all.acceleration.travel, all.first_layer.acceleration) = (MmPerS2(0.0), MmPerS2(0.0));
        let settings = MotionSettings::new(&all, &[]);
        assert_eq!(Rules::new(&settings, 0).acceleration(None), Some(all.acceleration.default));
        (all.acceleration.default, all.acceleration.external_perimeter) = (MmPerS2(0.0), MmPerS2(0.0));
        let settings = MotionSettings::new(&all, &[]);
        assert_eq!(Rules::new(&settings, 0).acceleration(Some((Role::Perimeter, Grade::Held))), None);
    }
}
