//! The fan by how long a layer takes, which is known when its moves are.

use super::rules::Rules;
use super::{LayerMoves, MotionSettings, Move};
use crate::units::{Ratio, Seconds};

/// Sets the fan of a layer that takes so long, where it depends on that: planned without what the layer has of its own,
/// each change of the fan says only what a bead has at least.
pub fn set_fan(layer: &mut LayerMoves, took: Seconds, settings: &MotionSettings) {
    let rules = Rules::new(settings, layer.index);
    if !rules.fan_by_time() {
        return;
    }
    let of_tool = |tool| Rules::new(settings.of_tool(tool), layer.index).layer_fan(layer.index, Some(took));
    let mut own = of_tool(layer.from.tool);
    let mut now: Option<Ratio> = None;
    layer.moves.retain_mut(|step| {
        if let Move::ToolChange(change) = step {
            own = of_tool(change.to);
        }
        let Move::Fan(least) = step else { return true };
        let fan = if *least < own { own } else { *least };
        let changes = now != Some(fan);
        (*least, now) = (fan, Some(fan));
        changes
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Entry;
    use crate::profile::Settings;

    #[test]
    fn the_fan_rises_as_layers_get_shorter_and_bridges_keep_theirs() {
        let mut all = Settings::default();
        let cooling = &mut all.cooling;
        (cooling.fan, cooling.min_layer_time, cooling.short_layer_time) =
            (Ratio(0.2), Seconds(10.0), Seconds(30.0));
        (cooling.short_layer_fan, cooling.fan_off_layers, cooling.full_fan_layer) =
            ([Ratio(0.3), Ratio(0.9)], 1, 1);
        let settings = MotionSettings::new(&all, &[]);
        let fans = |index: usize, took: f64| {
            let moves = [0.0, 0.5, 0.0].map(|least| Move::Fan(Ratio(least))).to_vec();
            let mut layer = LayerMoves { index, z_mm: 0.2, height_mm: 0.2, from: Entry::default(), moves };
            set_fan(&mut layer, Seconds(took), &settings);
            let fan = |step: &Move| match step {
                Move::Fan(share) => (share.0 * 100.0).round(),
                _ => f64::NAN,
            };
            layer.moves.iter().map(fan).collect::<Vec<_>>()
        };
        assert_eq!(fans(5, 40.0), [20.0, 50.0, 20.0], "a long layer has the usual fan");
        assert_eq!(fans(5, 30.0 - 1e-9), [30.0, 50.0, 30.0]);
        assert_eq!(fans(5, 20.0), [60.0], "more than the bridge asks for");
        assert_eq!(fans(5, 9.0), [90.0]);
        assert_eq!(fans(0, 9.0), [0.0, 50.0, 0.0], "off at first");
    }
}
