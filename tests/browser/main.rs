//! Pages in a real browser. Where there is no Chromium these tests are listed as ignored, unless the variable
//! `PATHWRIGHT_REQUIRE_BROWSER` is set: then they fail. `.ci/run` installs one and sets it.

mod chromium;
mod pages;

use std::process::ExitCode;

use libtest_mimic::{Arguments, Trial};

fn main() -> ExitCode {
    let missing = chromium::program().is_none() && std::env::var_os("PATHWRIGHT_REQUIRE_BROWSER").is_none();
    let trial = |name: &str, test: fn()| {
        let run = move || {
            test();
            Ok(())
        };
        Trial::test(name, run).with_kind(if missing { "no Chromium" } else { "" }).with_ignored_flag(missing)
    };
    macro_rules! trials {
        ($($test:path;)*) => { vec![$(trial(stringify!($test), $test)),*] };
    }
    let trials = trials! {
        pages::sliders_keys_and_the_legend_change_the_picture;
        pages::strategies_stand_side_by_side_with_lengths_of_their_own;
        pages::a_window_as_small_as_a_phone_shows_all_of_it;
        pages::without_webgl_layers_are_drawn_all_the_same;
        pages::odd_files_give_a_page_that_says_what_they_are;
        pages::svg_and_png_are_the_same_picture;
    };
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}
