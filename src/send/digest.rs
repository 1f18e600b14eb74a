//! A password that is asked for, and answered as a digest (RFC 7616), so that it keeps to itself.

use std::cell::RefCell;

use http_auth::{PasswordClient, PasswordParams};

use super::client::Login;
use super::entry::Secret;

/// User and password, and the last challenge of the host.
pub(super) struct Digest {
    user: String,
    password: Secret,
    challenge: RefCell<Option<PasswordClient>>,
}

impl Digest {
    pub fn new(user: &str, password: Secret) -> Self {
        Self { user: user.to_owned(), password, challenge: RefCell::default() }
    }
}

impl Login for Digest {
    fn challenged(&self, challenge: Option<&str>) {
        *self.challenge.borrow_mut() =
            challenge.and_then(|text| PasswordClient::builder().challenges(text).build().ok());
    }

    fn answer(&self, method: &str, url: &str) -> Option<String> {
        let url: http::Uri = url.parse().ok()?;
        let asked = PasswordParams {
            username: &self.user,
            password: self.password.expose(),
            uri: url.path_and_query()?.as_str(),
            method,
            body: None,
        };
        self.challenge.borrow_mut().as_mut()?.respond(&asked).ok()
    }
}
