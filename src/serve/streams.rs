//! Event streams that are open: they are counted, as each holds a connection.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::error::ApiError;
use super::limits::Limits;
use super::tokens::Client;

/// Open event streams.
#[derive(Debug, Default)]
pub struct Streams {
    open: Mutex<HashMap<Client, usize>>,
}

/// An open stream; it counts until this is dropped.
#[derive(Debug)]
pub struct StreamPermit {
    streams: Arc<Streams>,
    client: Client,
}

impl Streams {
    /// Counts one more.
    ///
    /// # Errors
    /// There are too many of this client, or of all.
    pub fn open(self: &Arc<Self>, client: &Client, limits: &Limits) -> Result<StreamPermit, ApiError> {
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        if open.values().sum::<usize>() >= limits.streams {
            let most = limits.streams;
            return Err(ApiError::busy(format!(
                "{most} event streams are open, which is the most (--max-streams)"
            )));
        }
        let own = open.entry(client.clone()).or_default();
        if *own >= limits.streams_per_client {
            let most = limits.streams_per_client;
            return Err(ApiError::too_many(format!(
                "you have {most} event streams open, which is the most (--max-streams-per-client)"
            )));
        }
        *own += 1;
        Ok(StreamPermit { streams: self.clone(), client: client.clone() })
    }

    /// How many are open.
    pub fn count(&self) -> usize {
        self.open.lock().unwrap_or_else(PoisonError::into_inner).values().sum()
    }
}

impl Drop for StreamPermit {
    fn drop(&mut self) {
        let mut open = self.streams.open.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(count) = open.get_mut(&self.client) {
            *count -= 1;
            if *count == 0 {
                open.remove(&self.client);
            }
        }
    }
}
