//! Scripts of a print: their placeholders, conditions and arithmetic, in the language of crate `macros`.
//!
//! A name is looked up among what is known of the print, our own placeholders, the variables that a profile or preset
//! brings, the settings under the names of other slicers, and what PrusaSlicer takes for its settings where nobody says them.

mod moment;
mod ours;
mod theirs;

use macros::{Names, State, Value};

use super::settings::Settings;
use crate::gcode::{PrintFacts, Scripts, takes_tool};
use crate::presets;

pub use moment::{Moment, PRINT_NAMES, WholePrint};
pub use ours::PLACEHOLDERS;
pub(super) use theirs::names as setting_names;

/// Placeholders that scripts may write to, and what that means to them alone.
const WRITABLE: [&str; 4] = ["position", "e_position", "e_retracted", "e_restart_extra"];

/// Expands the scripts of a print, one after the other: what one keeps in global variables, the next ones find.
pub struct ScriptRun<'a> {
    settings: &'a Settings,
    /// The settings of each tool, where there are several.
    tools: Vec<Settings>,
    print: &'a PrintFacts,
    state: State,
    /// Filament that a script says it leaves pulled back, of each extruder, millimetres.
    retracted_mm: Vec<f64>,
    /// How far the print has come.
    pub moment: Moment,
}

impl<'a> ScriptRun<'a> {
    /// Before the first script.
    pub fn new(settings: &'a Settings, print: &'a PrintFacts) -> Self {
        let tools = (0..settings.tools.len()).map(|tool| settings.of_tool(tool).into_owned()).collect();
        let moment = Moment { tool: print.tools.first.into(), ..Moment::default() };
        Self { settings, tools, print, state: State::default(), retracted_mm: Vec::new(), moment }
    }

    /// Expands a script. Every line ends with `\n`, and none with blanks. Where mistakes are to be ignored, a script
    /// with one is empty.
    ///
    /// # Errors
    /// The first mistake with its line and column, and the nearest name where one is unknown.
    pub fn expand(&mut self, script: &str) -> Result<String, macros::Error> {
        let text = match self.text(script) {
            Err(_) if self.settings.gcode.ignore_scripts => String::new(),
            text => text?,
        };
        if let Some(left_mm) = self.left_retracted_mm() {
            self.retracted_mm = left_mm;
        }
        let mut out = String::with_capacity(text.len() + 1);
        for line in text.lines() {
            out.push_str(line.trim_end());
            out.push('\n');
        }
        Ok(out)
    }

    /// Expands a text that is no script, such as the name of a file.
    ///
    /// # Errors
    /// As [`Self::expand`].
    pub fn text(&mut self, text: &str) -> Result<String, macros::Error> {
        let Self { settings, tools, print, state, moment, .. } = self;
        let current = tools.get(moment.tool).unwrap_or(settings);
        macros::expand(text, &Known { settings: current, tools, print, moment }, state)
    }
}

/// The scripts that belong to no layer.
impl ScriptRun<'_> {
    /// Expands the scripts that are run before the last layer.
    ///
    /// # Errors
    /// Every script's first mistake, a line each.
    pub fn open(&mut self) -> Result<Scripts, Vec<String>> {
        let options = &self.settings.gcode;
        let filament_start = &self.current().gcode.filament_start.clone();
        let starts = self.all([("gcode.start", &options.start), ("gcode.filament_start", filament_start)]);
        let retracted_mm = std::mem::take(&mut self.retracted_mm);
        let others =
            self.all([("gcode.pause", &options.pause), ("gcode.color_change", &options.color_change)]);
        match (starts, others) {
            (Ok([start, filament_start]), Ok([pause, color_change])) => {
                let texts = [start, filament_start, pause, color_change];
                Ok(Scripts::opening(texts, options, self.settings.printer.flavor, retracted_mm))
            }
            (starts, others) => {
                let mistakes = [starts.err(), others.err()];
                Err(mistakes.into_iter().flatten().flatten().collect())
            }
        }
    }

    /// What the last script says it leaves pulled back of each filament.
    fn left_retracted_mm(&self) -> Option<Vec<f64>> {
        let number = |value: &Value| match value {
            Value::Real(mm) => Some(*mm),
            Value::Integer(mm) => Some(*mm as f64),
            _ => None,
        };
        match self.state.written().get("e_retracted")? {
            Value::List(all) => Some(all.iter().map(|value| number(value).unwrap_or(0.0)).collect()),
            one => Some(vec![number(one)?]),
        }
    }

    /// Expands the scripts of the end.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn close(&mut self, scripts: &mut Scripts) -> Result<(), Vec<String>> {
        let options = &self.settings.gcode;
        let mut filaments = String::new();
        // Every filament that is loaded has its script run; of one extruder with several, the one in use.
        let loaded = match self.tools.len() {
            0 => 0..self.filaments(),
            _ if !self.settings.tool_change.kind.has_nozzles() => self.moment.tool..self.moment.tool + 1,
            count => 0..count,
        };
        for extruder in loaded {
            self.moment.filament_extruder = extruder;
            let filament_end = self.of_tool(extruder).gcode.filament_end.clone();
            let [text] = self.all([("gcode.filament_end", &filament_end)])?;
            filaments += &text;
        }
        self.moment.filament_extruder = 0;
        let [end] = self.all([("gcode.end", &options.end)])?;
        scripts.close([filaments, end], options, self.settings.printer.flavor);
        Ok(())
    }

    /// The settings of the tool in use.
    fn current(&self) -> &Settings {
        self.of_tool(self.moment.tool)
    }

    fn of_tool(&self, tool: usize) -> &Settings {
        self.tools.get(tool).unwrap_or(self.settings)
    }

    /// Expands what is run at a change of tool: the script of the filament before, that of the change and, unless it does so
    /// itself, the line that takes the tool, and the script of the new filament.
    ///
    /// # Errors
    /// The first mistake, with its script.
    pub fn change(&mut self, to: usize) -> Result<String, String> {
        let filament_end = self.current().gcode.filament_end.clone();
        let next = self.of_tool(to);
        let (script, filament_start) = (next.tool_change.script.clone(), next.gcode.filament_start.clone());
        let expand = |run: &mut Self, key: &str, script: &str| {
            run.expand(script).map_err(|mistake| format!("{key}: {mistake}"))
        };
        self.moment.filament_extruder = self.moment.tool;
        let mut text = expand(self, "gcode.filament_end", &filament_end)?;
        self.moment.changes += 1;
        (self.moment.before, self.moment.next) = (Some(self.moment.tool), Some(to));
        let change = expand(self, "tool_change.script", &script)?;
        text += &change;
        if !takes_tool(&change, to) {
            text += &format!("T{to}\n");
        }
        (self.moment.tool, self.moment.next, self.moment.filament_extruder) = (to, None, to);
        text += &expand(self, "gcode.filament_start", &filament_start)?;
        self.moment.filament_extruder = 0;
        Ok(text)
    }

    fn filaments(&self) -> usize {
        match self.settings.variables.get("single_extruder_multi_material") {
            Some(toml::Value::Boolean(true)) => 1,
            _ => moment::extruders(self.settings),
        }
    }

    fn all<const N: usize>(&mut self, scripts: [(&str, &String); N]) -> Result<[String; N], Vec<String>> {
        let mut mistakes = Vec::new();
        let texts = scripts.map(|(key, script)| {
            self.expand(script).unwrap_or_else(|mistake| {
                mistakes.push(format!("{key}: {mistake}"));
                String::new()
            })
        });
        if mistakes.is_empty() { Ok(texts) } else { Err(mistakes) }
    }
}

impl Scripts {
    /// Expands the scripts of the settings that belong to no layer.
    ///
    /// # Errors
    /// Every script's first mistake, a line each. Scripts of a resolved profile have none.
    pub fn new(settings: &Settings, facts: &PrintFacts) -> Result<Self, Vec<String>> {
        let mut run = ScriptRun::new(settings, facts);
        let mut scripts = run.open()?;
        run.close(&mut scripts)?;
        Ok(scripts)
    }
}

/// Every name with a value at one moment.
struct Known<'a> {
    /// Those of the tool in use.
    settings: &'a Settings,
    tools: &'a [Settings],
    print: &'a PrintFacts,
    moment: &'a Moment,
}

impl Names for Known<'_> {
    fn value(&self, name: &str) -> Option<Value> {
        let Self { settings, tools, print, moment } = *self;
        moment::value(name, &moment::Context { settings, tools, print, moment })
            .or_else(|| ours::value(name, settings, print))
            .or_else(|| settings.variables.get(name).map(from_toml))
            .or_else(|| theirs::value(name, settings, tools))
            .or_else(|| presets::built_in_value(name, moment::extruders(settings).max(tools.len())))
    }

    fn names(&self) -> Vec<String> {
        let documented = PRINT_NAMES.iter().chain(PLACEHOLDERS).map(|(name, _)| (*name).to_owned());
        let variables = self.settings.variables.keys().cloned();
        documented.chain(variables).chain(theirs::names().map(|(name, _)| name.to_owned())).collect()
    }

    fn is_writable(&self, name: &str) -> bool {
        WRITABLE.contains(&name)
    }

    fn whole(&self, name: &str) -> Option<f64> {
        match self.value(theirs::whole(name)?)? {
            Value::Real(whole) => Some(whole),
            Value::Integer(whole) => Some(whole as f64),
            Value::List(values) => match values.first()? {
                Value::Real(whole) => Some(*whole),
                Value::Integer(whole) => Some(*whole as f64),
                _ => None,
            },
            _ => None,
        }
    }
}

/// A variable of a profile as scripts have it: a text that is a number with `%` is a percentage, the text `nil` no value.
fn from_toml(value: &toml::Value) -> Value {
    match value {
        toml::Value::Boolean(flag) => Value::Flag(*flag),
        toml::Value::Integer(whole) => Value::Integer(*whole),
        toml::Value::Float(real) => Value::Real(*real),
        toml::Value::String(text) if text == "nil" => Value::Nil,
        toml::Value::String(text) => {
            match text.strip_suffix('%').and_then(|number| number.parse::<f64>().ok()) {
                Some(percent) => Value::Percent(percent),
                None => Value::Text(text.clone()),
            }
        }
        toml::Value::Array(values) => Value::List(values.iter().map(from_toml).collect()),
        other => Value::Text(other.to_string()),
    }
}

/// Expands a script as at the start of a print. Every line ends with `\n`, and none with blanks.
///
/// # Errors
/// The first mistake with its line and column, and the nearest name where one is unknown.
///
/// # Examples
/// ```
/// use pathwright::gcode::PrintFacts;
/// use pathwright::profile::{Settings, expand};
/// let script = "M109 S{nozzle_temp}\n{if layer_height < 0.3}M221 S95{endif}";
/// let text = expand(script, &Settings::default(), &PrintFacts::default());
/// assert_eq!(text.unwrap(), "M109 S210\nM221 S95\n");
/// ```
pub fn expand(script: &str, settings: &Settings, print: &PrintFacts) -> Result<String, macros::Error> {
    ScriptRun::new(settings, print).expand(script)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn print() -> PrintFacts {
        PrintFacts {
            min_mm: [100.0; 2],
            max_mm: [150.0; 2],
            max_z_mm: 30.0,
            layers: 150,
            ..PrintFacts::default()
        }
    }

    fn filled(script: &str, settings: &Settings) -> String {
        expand(script, settings, &print()).unwrap()
    }

    #[test]
    fn every_name_has_a_value() {
        let print = PrintFacts { first_layer_hull_mm: vec![[100.0, 100.0]], ..print() };
        let mut settings = Settings::default();
        for (name, value) in
            [("bed_mesh_min", 0.0), ("bed_mesh_max", 250.0), ("bed_mesh_probe_distance", 50.0)]
        {
            settings.variables.insert(name.into(), toml::Value::Array(vec![toml::Value::Float(value); 2]));
        }
        let mut run = ScriptRun::new(&settings, &print);
        run.moment.totals = Some(WholePrint::default());
        for (name, _) in PLACEHOLDERS.iter().chain(PRINT_NAMES) {
            assert!(run.expand(&format!("[{name}]")).is_ok(), "{name}");
        }
    }

    #[test]
    fn numbers_have_no_more_digits_than_they_need() {
        assert_eq!(filled("{bed_size_x} { layer_height }", &Settings::default()), "250 0.2\n");
    }

    #[test]
    fn bambus_printers_are_told_whether_their_zone_is_printed_on() {
        let mut settings = Settings::default();
        let script = "{if in_head_wrap_detect_zone}yes{else}no{endif}";
        assert_eq!(filled(script, &settings), "no\n");
        for (low, said) in [(140.0, "yes\n"), (151.0, "no\n")] {
            let corner = |x: f64, y: f64| toml::Value::Array([x, y].map(toml::Value::Float).to_vec());
            let zone = vec![corner(low, 140.0), corner(256.0, 140.0), corner(256.0, 256.0)];
            settings.variables.insert("head_wrap_detect_zone".into(), toml::Value::Array(zone));
            assert_eq!(filled(script, &settings), said);
        }
    }

    #[test]
    fn values_cannot_start_a_line_or_a_comment() {
        let mut settings = Settings::default();
        settings.printer.name = "evil\nM112;\rG28".into();
        assert_eq!(filled("M117 {printer}", &settings), "M117 evil M112, G28\n");
    }

    #[test]
    fn an_unknown_placeholder_is_reported_with_the_nearest() {
        let error = expand("G28\n{nozle_temp}", &Settings::default(), &print()).unwrap_err();
        assert_eq!((error.line, error.near.as_deref()), (2, Some("nozzle_temp")));
    }

    #[test]
    fn variables_of_a_profile_are_names_and_our_settings_answer_to_those_of_other_slicers() {
        let mut settings = Settings::default();
        settings.variables.insert("fill_density".into(), toml::Value::String("15%".into()));
        settings.variables.insert("printer_notes".into(), toml::Value::String("MODEL_X".into()));
        let script = "[fill_density] {temperature[0]} {if printer_notes=~/.*MODEL_X.*/}yes{endif}";
        assert_eq!(filled(script, &settings), "15% 205 yes\n");
    }

    #[test]
    fn what_nobody_says_is_what_prusaslicer_takes() {
        let settings = Settings::default().set("tools.2.name", "second").unwrap();
        let script =
            "{if filament_abrasive[1]}hard{else}soft{endif} [wipe_tower_width] {bed_temperature_extruder}";
        assert_eq!(filled(script, &settings), "soft 60 0\n");
    }

    #[test]
    fn global_variables_live_from_script_to_script() {
        let (settings, print) = (Settings::default(), print());
        let mut run = ScriptRun::new(&settings, &print);
        run.expand("{global count = 1}").unwrap();
        assert_eq!(run.expand("{count + 1}").unwrap(), "2\n");
    }
}
