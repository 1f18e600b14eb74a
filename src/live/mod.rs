//! A plate that is always sliced: whoever changes it gets its walls at once, and the print as soon as it is done.
//!
//! A [`Session`] holds models and the project as it is now. [`Session::set_project`] ends the slicing that runs and begins the
//! next one, so that a burst of changes costs no more than its last; what earlier slicings left is used as far as nothing
//! that it depends on has changed, and the bytes are those of a slicing from nothing. [`Event`]s tell subscribers what
//! comes of it.
//!
//! There is no HTTP here, and no thread: the caller gives a way to do work beside its own ([`Spawn`]), most often that of a
//! rayon pool, which several sessions may share. A session never has more than one slicing under way.

mod added;
mod event;
mod layout;
mod options;
mod placed;
mod resolved;
mod results;
mod session;
mod slicing;
mod state;
mod work;

pub use added::{Added, AddedFile, AddedObject};
pub use event::{Before, Done, Event, Failed, Fault, FaultKind, Progress, Walls};
pub use options::{Failure, Options, Spawn};
pub use placed::{Placed, PlacedObject};
pub use resolved::{Bed, Resolved, SettingProblem};
pub use results::Results;
pub use session::{DISPLAYED, Session, Subscription};
