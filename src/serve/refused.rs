//! Why a body is not read to its end, found again behind the errors of those who read it.

use std::error::Error;

use axum::http::StatusCode;

use super::error::{ApiError, ErrorKind};
use super::limits::shown;

/// Beyond the time for a body of any size, there is a second more for this many bytes.
pub const PACE_BYTES_PER_S: u64 = 16 << 10;

/// Why a body is not read to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refused {
    /// It has more than this many bytes.
    #[error("the request is larger than {}, which this server takes at most (--max-upload)", shown(*most))]
    TooLarge {
        /// The limit.
        most: u64,
    },
    /// It comes slower than any network.
    #[error("the request came too slowly: {} KiB a second are expected (--max-body-time)", PACE_BYTES_PER_S >> 10)]
    TooSlow,
}

impl Refused {
    /// The one that caused an error, if one did.
    pub fn behind(error: &(dyn Error + 'static)) -> Option<Self> {
        let mut next = Some(error);
        while let Some(error) = next {
            if let Some(refused) = error.downcast_ref::<Self>() {
                return Some(*refused);
            }
            next = error.source();
        }
        None
    }
}

impl From<Refused> for ApiError {
    fn from(refused: Refused) -> Self {
        match refused {
            Refused::TooLarge { .. } => Self::too_large(refused),
            Refused::TooSlow => Self::new(StatusCode::REQUEST_TIMEOUT, ErrorKind::Limit, refused),
        }
    }
}
