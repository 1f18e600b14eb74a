//! What is taken over, as a page: `docs/import.md`.

use std::fmt::Write;

use super::idle::{IDLE, Idle, REASONS};
use super::table::ROWS;

const HEAD: &str = "# Configurations of other slicers\n\n\
    `--profile` takes a configuration of PrusaSlicer, SuperSlicer or Slic3r as it takes a profile of ours: a file\n\
    `.ini` as exported, with or without `[sections]`, or G-code that ends with one.\n\n\
    ```sh\n\
    pathwright slice part.stl --profile config.ini\n\
    pathwright slice part.stl --profile old-print.gcode --set infill.density=10%\n\
    pathwright profiles show config.ini > mine.toml       # as a profile of ours, and what is not taken over, and why\n\
    pathwright profiles dump --profile config.ini         # every setting with the line that it comes from\n\
    ```\n\n\
    What the file does not say stays as the profiles before it have it. What it says and has no counterpart here is\n\
    counted on standard error (not with `--quiet`) and listed by `profiles show`; the same holds for what means\n\
    something a little different here. Keys that ask for nothing (a wipe tower that is off, notes) are only counted there. A value\n\
    with one entry for each extruder is taken of the first one; where the printer has several, each is one of `[[tools]]`. Of a bundle of presets the active ones hold\n\
    (`[presets]`), or the only one of each kind, with what they inherit inside of the file. What is relative to something else in\n\
    SuperSlicer, speeds and accelerations to each other and widths to the nozzle, is worked out first.\n\n\
    G-code scripts are taken over as they are written: scripts here speak the same language, and every key of the file is\n\
    a name in it. A name that neither the file nor [we](settings.md#placeholders-in-scripts) know is an error (exit code 4);\n\
    with `--ignore-scripts` such a script is left out, with a warning. A file without a script, but with an empty one,\n\
    has none. Heating that the start script leaves out is added, unless `autoemit_temperature_commands` is 0.\n\n\
    This page is printed by `pathwright profiles imports`, and a test keeps it true.\n\n\
    ## Settings\n\n\
    | ours | theirs | how |\n|---|---|---|\n";

const REST: &str = "\n## Without a counterpart\n\n\
    `*` stands for any letters. A key that is at a value which asks for nothing, or that belongs to something that is off,\n\
    is not reported. `pathwright profiles imports BUNDLE.ini` counts what becomes of the keys of a bundle.\n\n\
    | theirs | why |\n|---|---|\n";

const ONE_TOOL: &str = "\n## Of several tools\n\n\
    There is one tool here, and one filament on it. These keys mean nothing then, and are not reported:\n\n";

/// The page: each setting of ours with the keys that it comes from.
pub fn page() -> String {
    let mut out = String::from(HEAD);
    for row in ROWS {
        let theirs: Vec<String> = row.theirs.iter().map(|key| format!("`{key}`")).collect();
        let rule = if row.rule.is_empty() { "as it is" } else { row.rule };
        let _ = writeln!(out, "| `{}` | {} | {rule} |", row.ours, theirs.join(", "));
    }
    out += REST;
    for (key, reason) in REASONS {
        let _ = writeln!(out, "| `{key}` | {reason} |");
    }
    out += ONE_TOOL;
    for (key, _) in IDLE.iter().filter(|(_, idle)| matches!(idle, Idle::OneTool)) {
        let _ = writeln!(out, "- `{key}`");
    }
    out
}
