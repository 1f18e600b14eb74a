//! What changes of tool take: what a file says of it, and when a heater that was let cool down is hot again.

use super::lexer::Line;
use crate::estimate::{Machine, Planner};

/// Tools that are told apart; higher numbers are no tools, but orders to a changer.
const TOOLS: usize = 32;

/// Seconds that a file tells of, by tool.
#[derive(Clone, Debug, Default)]
struct Told {
    /// Ours: of the change to each.
    change: Vec<f64>,
    /// °C/s.
    heating_rate: Vec<f64>,
    /// Others': of loading and unloading the filament of each, and what is the same for all.
    load: Vec<f64>,
    unload: Vec<f64>,
    any: [f64; 3],
    /// Whether each filament stays in a nozzle of its own: then nothing is loaded at a change, whatever the file says of it.
    stays_loaded: bool,
}

/// A heater, by what the file has asked of it.
#[derive(Clone, Copy, Debug, Default)]
struct Heater {
    /// Where it stood at the mark of its tool, and what it has been set to since.
    from: f64,
    to: f64,
}

/// Follows the tools of a file.
#[derive(Clone, Debug, Default)]
pub(super) struct Changes {
    told: Told,
    tool: usize,
    /// Whether the tool in use is known: one was taken, or something printed.
    begun: bool,
    printed: bool,
    /// Account, tool before and after of each change.
    made: Vec<(usize, usize, usize)>,
    heaters: [Option<Heater>; TOOLS],
    /// Whether each has a heater of its own, for it was heated by its number while another was in use.
    own: [bool; TOOLS],
    /// What the changes so far took, as far as that is known.
    so_far_s: f64,
}

impl Changes {
    /// Notes that something is printed.
    pub fn printed(&mut self) {
        (self.begun, self.printed) = (true, true);
    }

    /// Processes a line that is no move.
    pub fn line(&mut self, line: &Line<'_>, planner: &mut Planner, account: usize) {
        let Some(code) = line.code else { return self.told.comment(line) };
        match (code.letter, code.number as usize) {
            (b'T', tool) if tool < TOOLS => self.take(tool, planner, account),
            (b'M', 104 | 109) => {
                let words = line.words();
                let Some(celsius) = words.get(b'S').or_else(|| words.get(b'R')) else { return };
                let named = words.get(b'T').map(|tool| (tool as usize).min(TOOLS - 1));
                self.heat(named, celsius, (code.number == 109).then_some(account), planner);
            }
            _ => {}
        }
    }

    fn take(&mut self, tool: usize, planner: &mut Planner, account: usize) {
        let before = std::mem::replace(&mut self.tool, tool);
        if std::mem::replace(&mut self.begun, true) && before != tool {
            planner.dwell(0.0, account);
            self.made.push((account, before, tool));
            self.so_far_s += self.told.seconds(before, tool, planner.machine());
        }
    }

    /// Sets a heater; `waits`: the account on which waiting for it is booked. Before the first change, and before another tool is
    /// heated for it, printers heat up, however long that takes.
    fn heat(&mut self, named: Option<usize>, celsius: f64, waits: Option<usize>, planner: &mut Planner) {
        if let Some(tool) = named.filter(|tool| *tool != self.tool) {
            self.own[tool] = true;
        }
        // What has none of its own has that of the tools that have none either.
        let tool = Some(named.unwrap_or(self.tool)).filter(|tool| self.own[*tool] || named.is_some());
        let heater = tool.unwrap_or(0);
        let rate = self.told.rate(named.unwrap_or(self.tool), planner.machine());
        let old = self.heaters[heater].unwrap_or(Heater { from: celsius, to: celsius });
        let mut now = old;
        if celsius < old.to {
            // A tool that is put away is named; what prints on is taken to be there.
            let from = if waits.is_none() && named.is_some() { old.to } else { celsius };
            now = Heater { from, to: celsius };
            planner.mark(heater, self.so_far_s);
        } else if celsius > old.to {
            // No nozzle cools down faster than it heats.
            let cooled = rate * planner.since_s(heater, self.so_far_s);
            let from = if old.from > old.to { (old.from - cooled).max(old.to) } else { old.to };
            now = Heater { from, to: celsius };
            planner.mark(heater, self.so_far_s);
        }
        if let (Some(account), true) = (waits, rate > 0.0 && now.to > now.from) {
            planner.dwell(0.0, account);
            let left_s = (now.to - now.from) / rate - planner.since_s(heater, self.so_far_s);
            let is_other = self.printed && named.is_some_and(|tool| tool != self.tool);
            if left_s > 0.0 && (is_other || !self.made.is_empty()) {
                planner.dwell(left_s, account);
            }
            now.from = now.to;
        }
        self.heaters[heater] = Some(now);
    }

    /// Adds what the changes took to the accounts, when all is known.
    pub fn book(&self, seconds: &mut Vec<f64>, machine: &Machine) {
        for &(account, before, tool) in &self.made {
            if account >= seconds.len() {
                seconds.resize(account + 1, 0.0);
            }
            seconds[account] += self.told.seconds(before, tool, machine);
        }
    }
}

impl Told {
    /// How long a change takes, by the machine where that is so or the file says nothing.
    fn seconds(&self, before: usize, tool: usize, machine: &Machine) -> f64 {
        if machine.change_is_fixed {
            return machine.change_s;
        }
        if let Some(seconds) = of(&self.change, tool) {
            return seconds;
        }
        let swapped = of(&self.load, tool).unwrap_or(0.0) + of(&self.unload, before).unwrap_or(0.0);
        let theirs_s = if self.stays_loaded { 0.0 } else { swapped } + self.any.iter().sum::<f64>();
        // They say 0 where they were not told.
        if theirs_s > 0.0 { theirs_s } else { machine.change_s }
    }

    fn rate(&self, tool: usize, machine: &Machine) -> f64 {
        of(&self.heating_rate, tool).unwrap_or(machine.heating_rate)
    }

    /// Takes what a comment says, such as `; filament_load_time = 15,12`.
    fn comment(&mut self, line: &Line<'_>) {
        let Some((key, value)) = line.comment.and_then(|comment| {
            let comment = std::str::from_utf8(comment).ok()?;
            comment.split_once('=')
        }) else {
            return;
        };
        let numbers = || -> Vec<f64> {
            let parsed = value.split([',', ';']).map(|text| text.trim().parse::<f64>());
            parsed.map_while(Result::ok).filter(|number| number.is_finite() && *number >= 0.0).collect()
        };
        let lists = match key.trim() {
            "tool_change_time" => &mut self.change,
            "tool_heating_rate" => &mut self.heating_rate,
            "filament_load_time" => &mut self.load,
            "filament_unload_time" => &mut self.unload,
            "single_extruder_multi_material" => {
                self.stays_loaded = value.trim() == "0";
                return;
            }
            key => {
                let names = [
                    "machine_tool_change_time",
                    "machine_load_filament_time",
                    "machine_unload_filament_time",
                ];
                if let Some(place) = names.iter().position(|name| *name == key) {
                    self.any[place] = numbers().first().copied().unwrap_or(0.0);
                }
                return;
            }
        };
        *lists = numbers();
    }
}

/// The value of a tool, in a list with one for each or one for all.
fn of(list: &[f64], tool: usize) -> Option<f64> {
    list.get(tool).or(list.first().filter(|_| list.len() == 1)).copied()
}

#[cfg(test)]
mod tests {
    use crate::estimate::{Firmware, Machine};
    use crate::gcode::file_time;
    use crate::profile::Settings;

    fn seconds(text: &str) -> f64 {
        let machine = Machine::under(Firmware::Marlin, &Settings::default());
        file_time(text.as_bytes(), &machine).0
    }

    #[test]
    fn a_change_takes_what_the_file_says_or_else_the_machine() {
        let text = "T0\nT1\nT1\nT0\n";
        assert_eq!(seconds(text), 20.0, "twice the profile's");
        assert_eq!(seconds(&format!("; tool_change_time = 3,5\n{text}")), 8.0);
        assert_eq!(
            seconds(&format!("{text}; filament_load_time = 3,5\n; filament_unload_time = 10,20\n")),
            38.0
        );
        let theirs = "; machine_load_filament_time = 29\n; machine_unload_filament_time = 28\n; machine_tool_change_time = 0";
        assert_eq!(seconds(&format!("{text}{theirs}")), 114.0);
        assert_eq!(seconds(&format!("{text}; filament_load_time = 0,0\n")), 20.0);
        assert_eq!(seconds("T0\nT255\nT1000\nT0\n"), 0.0, "orders to a changer");
    }

    #[test]
    fn tools_with_nozzles_of_their_own_load_nothing_at_a_change() {
        let text = "T0\nT1\nT0\n; filament_load_time = 3,5\n; filament_unload_time = 10,20\n";
        let single = |value: &str| seconds(&format!("{text}; single_extruder_multi_material = {value}\n"));
        assert_eq!(single("1"), 38.0);
        assert_eq!(single("0"), 20.0, "twice the profile's");
    }

    #[test]
    fn a_tool_that_has_cooled_down_is_waited_for_as_long_as_it_was_not_heated_before() {
        let head =
            "; tool_change_time = 0\n; tool_heating_rate = 2\nM104 S200\nM109 S200\nT0\nM104 T1 S150\nT1\n";
        let wait = |text: &str| seconds(&format!("{head}{text}"));
        assert_eq!(wait("M109 T1 S200"), 25.0);
        assert_eq!(wait("M104 T1 S200\nG4 P10000\nM109 T1 S200"), 10.0 + 15.0);
        assert_eq!(wait("M104 T1 S200\nG4 P30000\nM109 T1 S200"), 30.0);
        assert_eq!(wait("M109 T1 S200\nM104 T1 S150\nT0\nM109 T0 S200"), 25.0, "T0 is hot");
    }

    #[test]
    fn a_nozzle_that_all_share_is_waited_for_where_the_next_filament_needs_more() {
        let head = "; tool_change_time = 0\n; tool_heating_rate = 2\nM109 S200\nT0\n";
        assert_eq!(seconds(&format!("{head}T1\nM109 S230\nT0\nM109 S200\nT1\nM109 S230\n")), 30.0);
    }
}
