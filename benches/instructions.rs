//! Instructions of whole slicings on one thread, against those of a baseline: exact where times are noisy, so that a change
//! that costs a few percent is seen.
//!
//! `cargo bench -p pathwright-benches --bench instructions --profile quick` compares; with `-- --bless` behind it the counts become
//! the baseline. Counts depend on compiler and profile, so they are compared only with what the same ones made. Valgrind counts.

mod counted;

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use counted::{count, slice_if_asked};

/// The program's allocator.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Bundled models.
const BUNDLED: [&str; 3] = ["plate_with_holes", "helical_gear", "pin_forest"];

/// Those of the figures in the issues, from a folder beside the project, where that is there.
const SHARED: [&str; 6] = [
    "seed/testModel",
    "seed/ctrlV_3D_test",
    "seed/3DHackerTest",
    "seed/TortureTestV2",
    "seed/UltimakerRobot_support_2015",
    "open/3DBenchy",
];

/// More than this share over the baseline is too much.
const SLACK: f64 = 0.03;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// What made this program: counts of another compiler or profile say nothing.
fn maker() -> String {
    let version = Command::new("rustc").arg("--version").output().map(|out| out.stdout).unwrap_or_default();
    let version = String::from_utf8_lossy(&version);
    let program = std::env::current_exe().unwrap_or_default();
    let profile = program.iter().rev().nth(2).map(|folder| folder.to_string_lossy().into_owned());
    format!("{} {}", version.trim(), profile.unwrap_or_default())
}

fn main() -> ExitCode {
    if slice_if_asked() {
        return ExitCode::SUCCESS;
    }
    let baseline = root().join("benches/instructions.tsv");
    let text = std::fs::read_to_string(&baseline).unwrap_or_default();
    let known: Vec<(&str, &str)> = text.lines().filter_map(|line| line.split_once('\t')).collect();
    let before = |name: &str| known.iter().find(|(of, _)| *of == name).map(|(_, value)| *value);
    let maker = maker();
    let comparable = before("made by") == Some(maker.as_str());
    let folder = tempfile::tempdir().expect("a folder");
    let bundled = BUNDLED.map(|name| ("models", name));
    let shared = SHARED.map(|name| ("../shared/models", name));
    let (mut lines, mut worse) = (vec![format!("made by\t{maker}")], 0);
    for (of, name) in bundled.into_iter().chain(shared) {
        let model = root().join(of).join(format!("{name}.stl"));
        if !model.exists() {
            lines.extend(before(name).map(|value| format!("{name}\t{value}")));
            continue;
        }
        let Some(count) = count(&model, folder.path()) else {
            println!("nothing counts instructions here: Valgrind is missing, or {name} was not sliced");
            return ExitCode::SUCCESS;
        };
        let change = before(name).filter(|_| comparable).and_then(|value| value.parse().ok());
        let change = change.map(|before: f64| count / before - 1.0);
        println!(
            "{name:40} {count:8.1} million{}",
            change.map_or(String::new(), |c| format!(" {:+.2} %", 100.0 * c))
        );
        worse += usize::from(change.is_some_and(|change| change > SLACK));
        lines.push(format!("{name}\t{count:.1}"));
    }
    if std::env::args().any(|word| word == "--bless") {
        std::fs::write(&baseline, lines.join("\n") + "\n").expect("the baseline is written");
    } else if !comparable {
        println!(
            "the baseline was made by {}, this by {maker}: not compared",
            before("made by").unwrap_or("nothing")
        );
    }
    if worse > 0 { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}
