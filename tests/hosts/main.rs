//! Print hosts: the real OctoPrint and Moonraker that `.ci/hosts` installs, stand-ins of PrusaLink and Duet written from
//! their documentation, and a proxy that breaks connections.
//!
//! Where the real ones are not installed their tests are listed as ignored, unless the variable `PATHWRIGHT_REQUIRE_HOSTS`
//! is set: then they fail. `.ci/run` installs them and sets it.

mod duet;
mod faults;
mod machine;
#[cfg(unix)]
mod moonraker;
mod octoprint;
mod process;
mod program;
mod proxy;
mod prusalink;
#[path = "../support/stand_in/mod.rs"]
mod stand_in;
mod tls;

use std::process::ExitCode;

use libtest_mimic::{Arguments, Trial};

fn main() -> ExitCode {
    let missing = process::installed().is_none() && std::env::var_os("PATHWRIGHT_REQUIRE_HOSTS").is_none();
    let trial = |name: &str, test: fn(), is_real: bool| {
        let run = move || {
            test();
            Ok(())
        };
        let ignored = is_real && missing;
        let kind = if ignored { ".ci/hosts installs them" } else { "" };
        Trial::test(name, run).with_kind(kind).with_ignored_flag(ignored)
    };
    macro_rules! trials {
        ($real:expr; $($test:path;)*) => { vec![$(trial(stringify!($test), $test, $real)),*] };
    }
    let mut trials = trials! { true;
        octoprint::it_is_printed_to_its_end_and_starts_again_after_a_power_cut;
        octoprint::an_object_is_cancelled_and_the_other_printed_to_its_end;
        octoprint::two_tools_are_printed_with_to_the_end;
        octoprint::analysis_and_thumbnails_are_those_of_the_print;
    };
    #[cfg(unix)]
    trials.extend(trials! { true;
        moonraker::it_is_sent_compared_analysed_and_printed;
        moonraker::an_object_is_cancelled_and_a_pause_comes_at_its_layer;
        moonraker::two_tools_are_printed_with_to_the_end;
        moonraker::faults_end_clearly_or_in_success;
    });
    trials.extend(trials! { false;
        duet::a_board_takes_files_and_prints_them;
        duet::a_computer_takes_files_and_prints_them;
        duet::a_wrong_password_is_told_and_not_shown;
        octoprint::times_stand_where_its_plug_ins_look;
        prusalink::files_are_put_started_and_followed_with_a_digest;
        prusalink::files_are_put_with_a_key;
        machine::what_is_not_for_the_printer_is_not_sent;
        machine::a_printer_that_is_not_ready_is_not_started;
        machine::a_full_host_gets_nothing;
        machine::hosts_are_added_listed_and_found_through_a_preset;
        machine::physical_printers_of_prusaslicer_are_taken_over;
        machine::keys_are_in_no_output_and_no_argument;
        machine::slicing_and_sending_is_one_command;
    });
    #[cfg(unix)]
    trials.extend(trials! { false; machine::an_interrupt_leaves_the_print_alone; });
    for (name, run) in faults::table() {
        trials.push(Trial::test(format!("faults::{name}"), move || {
            run();
            Ok(())
        }));
    }
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}
