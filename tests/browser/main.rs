//! Pages in a real browser. Where there is no Chromium these tests are listed as ignored, unless the variable
//! `PATHWRIGHT_REQUIRE_BROWSER` is set: then they fail. `.ci/run` installs one and sets it.

#[cfg(feature = "serve")]
mod access;
#[cfg(feature = "serve")]
mod app;
mod chromium;
#[cfg(feature = "serve")]
mod hosts;
#[cfg(feature = "serve")]
mod measure;
mod pages;
#[cfg(feature = "serve")]
mod server;
#[cfg(feature = "serve")]
mod site;
#[cfg(feature = "serve")]
#[path = "../support/stand_in/mod.rs"]
mod stand_in;

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
    #[cfg_attr(not(feature = "serve"), allow(unused_mut))]
    let mut trials = trials! {
        pages::sliders_keys_and_the_legend_change_the_picture;
        pages::strategies_stand_side_by_side_with_lengths_of_their_own;
        pages::where_times_are_ordered_for_their_gap_is_shown;
        pages::a_window_as_small_as_a_phone_shows_all_of_it;
        pages::without_webgl_layers_are_drawn_all_the_same;
        pages::odd_files_give_a_page_that_says_what_they_are;
        pages::svg_and_png_are_the_same_picture;
    };
    #[cfg(feature = "serve")]
    trials.extend(trials! {
        app::a_model_is_dropped_turned_sliced_and_saved_as_the_command_line_says;
        app::several_objects_of_a_file_are_printed_as_the_command_line_says;
        app::broken_models_tell_what_was_repaired_and_junk_why_it_is_none;
        app::what_does_not_fit_is_red_says_why_and_is_mended_by_undo;
        app::of_many_changes_the_last_is_what_is_saved;
        app::a_page_outlives_its_server;
        app::handles_move_turn_and_scale_and_undo_takes_it_back;
        app::two_strategies_stand_side_by_side;
        app::settings_are_found_changed_and_taken_back;
        hosts::a_print_is_sent_started_and_followed;
        app::it_works_on_a_tablet_in_the_dark;
        access::a_reload_keeps_plate_and_settings;
        access::a_service_with_tokens_asks_for_one;
        access::fingers_move_turn_and_enlarge;
        access::texts_are_readable_for_weak_eyes;
    });
    // The page without a server, where `PATHWRIGHT_SITE` names what `cargo run -p xtask -- site` has made.
    #[cfg(feature = "serve")]
    {
        let no_site = missing || site::folder().is_none();
        let of_site = |name: &str, test: fn()| {
            let run = move || {
                site::instead(test);
                Ok(())
            };
            let kind = if no_site { "no static site" } else { "" };
            Trial::test(format!("site: {name}"), run).with_kind(kind).with_ignored_flag(no_site)
        };
        macro_rules! of_site {
            ($($test:path;)*) => { vec![$(of_site(stringify!($test), $test)),*] };
        }
        trials.extend(of_site! {
            site::a_model_is_sliced_to_the_bytes_of_the_program_and_nobody_else_is_asked;
            site::what_is_dropped_while_the_module_loads_waits_for_it;
            site::it_works_without_a_network_after_the_first_visit;
            site::after_the_first_visit_it_has_threads_and_slices_to_the_same_bytes;
            site::presets_are_those_of_a_folder_that_is_dropped_and_stay_until_they_are_forgotten;
            site::a_print_goes_to_a_host_that_allows_the_page_and_one_that_does_not_tells_what_to_set;
            site::what_takes_too_much_memory_ends_with_a_message_and_the_page_goes_on;
            app::a_model_is_dropped_turned_sliced_and_saved_as_the_command_line_says;
            app::several_objects_of_a_file_are_printed_as_the_command_line_says;
            app::broken_models_tell_what_was_repaired_and_junk_why_it_is_none;
            app::what_does_not_fit_is_red_says_why_and_is_mended_by_undo;
            app::of_many_changes_the_last_is_what_is_saved;
            app::handles_move_turn_and_scale_and_undo_takes_it_back;
            app::two_strategies_stand_side_by_side;
            app::settings_are_found_changed_and_taken_back;
            app::it_works_on_a_tablet_in_the_dark;
            access::a_reload_keeps_plate_and_settings;
            access::fingers_move_turn_and_enlarge;
            access::texts_are_readable_for_weak_eyes;
        });
    }
    #[cfg(feature = "serve")]
    trials.push(
        trial("measure::how_long_the_page_is_busy", measure::how_long_the_page_is_busy)
            .with_ignored_flag(true),
    );
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}
