//! What an interrupt does.

use std::sync::Once;

use super::exit::Exit;
#[cfg(feature = "send")]
use super::send;
#[cfg(feature = "serve")]
use super::serve;
use crate::output;

/// Listens for interrupts from now on, with a thread that takes as long to start as a small model to read. What could be left
/// incomplete is begun afterwards.
pub(super) fn listen() {
    static LISTENS: Once = Once::new();
    LISTENS.call_once(|| {
        if let Err(error) = ctrlc::set_handler(interrupted) {
            eprintln!("warning: an interrupt may leave a temporary file behind: {error}");
        }
    });
}

/// A server ends in order, and at once on the second interrupt. Anything else ends at once, and what is incomplete is removed; of a
/// print on a host it is said that it goes on.
fn interrupted() {
    #[cfg(feature = "serve")]
    if serve::end() {
        return;
    }
    #[cfg(feature = "send")]
    send::interrupted();
    output::abandon_and_exit(Exit::Interrupted as i32)
}
