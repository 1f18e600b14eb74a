//! Tokens, the cookies that stand for one, and the clients whose they are.

use std::fmt;
use std::sync::Arc;
use std::time::{SystemTime, UNIX_EPOCH};

use axum::http::header::{self, HeaderMap};
use base64::Engine as _;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use hmac::{Hmac, KeyInit, Mac};
use sha2::{Digest, Sha256};
use subtle::ConstantTimeEq;

/// Shortest token.
const SHORTEST: usize = 16;
/// Name of the cookie.
pub const COOKIE: &str = "pathwright";
/// Tokens of those who may use a server.
#[derive(Clone, Default)]
pub struct Tokens(Vec<Token>);

#[derive(Clone)]
struct Token {
    client: Client,
    /// Hashes are compared: they have one length.
    hash: [u8; 32],
}

impl fmt::Debug for Tokens {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.0.iter().map(|token| &token.client)).finish()
    }
}

/// Who asks: the name of a token, or `local` where none is needed.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Client(pub Arc<str>);

impl Tokens {
    /// The tokens of a file: one on each line, after the client's name and a space if there are several. Empty lines and those
    /// that begin with `#` are passed over.
    ///
    /// # Errors
    /// A line that is none, a token that is too short, a name that is given twice, no token at all.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut tokens: Vec<Token> = Vec::new();
        for (index, line) in text.lines().enumerate() {
            let wrong = |message: String| Err(format!("line {}: {message}", index + 1));
            let words: Vec<&str> = line.split_whitespace().collect();
            let (name, token) = match words[..] {
                [] => continue,
                [first, ..] if first.starts_with('#') => continue,
                [token] => ("token", token),
                [name, token] => (name, token),
                _ => return wrong("a name and a token are expected, or a token alone".into()),
            };
            if token.len() < SHORTEST {
                return wrong(format!("the token is shorter than {SHORTEST} characters"));
            }
            if tokens.iter().any(|known| *known.client.0 == *name) {
                return wrong(format!("`{name}` has a token already; give each client a name of its own"));
            }
            tokens.push(Token { client: Client(name.into()), hash: Sha256::digest(token).into() });
        }
        if tokens.is_empty() {
            return Err("there is no token in it; `openssl rand -hex 24` makes one".into());
        }
        Ok(Self(tokens))
    }

    /// Whether everybody may use the server.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whose token it is; the time that this takes does not depend on it.
    pub fn client(&self, token: &str) -> Option<Client> {
        let hash: [u8; 32] = Sha256::digest(token).into();
        let mut found = None;
        for known in &self.0 {
            if bool::from(known.hash.ct_eq(&hash)) {
                found = Some(known.client.clone());
            }
        }
        found
    }

    /// The cookie that stands for a client's token until a time.
    pub fn cookie(&self, client: &Client, until_s: u64) -> Option<String> {
        let token = self.0.iter().find(|token| token.client == *client)?;
        let message = format!("{}.{until_s}", URL_SAFE_NO_PAD.encode(client.0.as_bytes()));
        let seal = seal(token, &message).finalize().into_bytes();
        Some(format!("{message}.{}", URL_SAFE_NO_PAD.encode(seal)))
    }

    /// Whose cookie it is, if its time is not over.
    fn client_of_cookie(&self, cookie: &str, now_s: u64) -> Option<Client> {
        let (message, given) = cookie.rsplit_once('.')?;
        let (name, until) = message.split_once('.')?;
        let name = String::from_utf8(URL_SAFE_NO_PAD.decode(name).ok()?).ok()?;
        let token = self.0.iter().find(|token| *token.client.0 == *name)?;
        seal(token, message).verify_slice(&URL_SAFE_NO_PAD.decode(given).ok()?).ok()?;
        (until.parse::<u64>().ok()? > now_s).then(|| token.client.clone())
    }

    /// Who asks, as the headers say.
    pub fn asker(&self, headers: &HeaderMap) -> Option<Client> {
        if self.is_empty() {
            return Some(Client("local".into()));
        }
        if let Some(given) = headers.get(header::AUTHORIZATION) {
            let (scheme, token) = given.to_str().ok()?.split_once(' ')?;
            return scheme.eq_ignore_ascii_case("bearer").then(|| self.client(token.trim()))?;
        }
        let cookies = headers.get_all(header::COOKIE).into_iter().filter_map(|line| line.to_str().ok());
        let pairs = cookies.flat_map(|line| line.split(';')).filter_map(|pair| pair.trim().split_once('='));
        let mut own = pairs.filter(|(name, _)| *name == COOKIE);
        own.find_map(|(_, value)| self.client_of_cookie(value, now_s()))
    }
}

fn seal(token: &Token, message: &str) -> Hmac<Sha256> {
    let mut mac = Hmac::<Sha256>::new_from_slice(&token.hash).expect("a key of any length will do");
    mac.update(message.as_bytes());
    mac
}

/// The time, seconds since 1970.
pub fn now_s() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}

#[cfg(test)]
mod tests {
    use axum::http::header::HeaderValue;

    use super::*;

    fn tokens() -> Tokens {
        Tokens::parse("# who\nana 0123456789abcdef\n\nben fedcba9876543210\n").unwrap()
    }

    fn asker(name: header::HeaderName, value: &str) -> Option<String> {
        let headers = HeaderMap::from_iter([(name, HeaderValue::from_str(value).unwrap())]);
        tokens().asker(&headers).map(|client| client.0.to_string())
    }

    #[test]
    fn a_token_says_who_asks() {
        assert_eq!(asker(header::AUTHORIZATION, "Bearer fedcba9876543210").as_deref(), Some("ben"));
        for wrong in ["Bearer fedcba987654321", "Bearer ", "fedcba9876543210", "Basic fedcba9876543210"] {
            assert_eq!(asker(header::AUTHORIZATION, wrong), None, "{wrong}");
        }
        assert_eq!(tokens().asker(&HeaderMap::new()), None);
    }

    #[test]
    fn a_cookie_stands_for_a_token_until_its_time_is_over() {
        let (tokens, ana) = (tokens(), Client("ana".into()));
        let cookie = tokens.cookie(&ana, 1000).unwrap();
        assert_eq!(tokens.client_of_cookie(&cookie, 999), Some(ana));
        assert_eq!(tokens.client_of_cookie(&cookie, 1000), None);
        let longer = cookie.replace(".1000.", ".9999.");
        assert_eq!(tokens.client_of_cookie(&longer, 999), None, "it is sealed");
        let other = Tokens::parse("ana another-token-here").unwrap();
        assert_eq!(other.client_of_cookie(&cookie, 999), None, "the token was changed");
    }

    #[test]
    fn a_file_of_tokens_says_what_is_wrong_with_it() {
        for (text, wrong) in [
            ("", "no token"),
            ("short", "line 1"),
            ("a 0123456789abcdef\na fedcba9876543210", "line 2: `a` has a token"),
            ("a b 0123456789abcdef", "a name and a token"),
        ] {
            let message = Tokens::parse(text).unwrap_err();
            assert!(message.contains(wrong), "{message}");
        }
    }
}
