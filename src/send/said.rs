//! What an answer says, for people.

use serde_json::Value;

/// How much of an answer a message shows.
const SHOWN: usize = 200;

/// An answer in short: what it says of an error, or how it begins.
pub(super) fn said(body: &[u8]) -> String {
    let text = match serde_json::from_slice::<Value>(body) {
        Ok(json) => told(&json).unwrap_or_else(|| json.to_string()),
        Err(_) => without_tags(&String::from_utf8_lossy(body)),
    };
    let words = text.split(|c: char| c.is_whitespace() || c.is_control()).filter(|word| !word.is_empty());
    let text: String = words.collect::<Vec<_>>().join(" ").chars().take(SHOWN).collect();
    if text.is_empty() { "nothing".into() } else { text }
}

/// Where hosts say what went wrong: `error`, `error.message`, `message`, `title`.
fn told(json: &Value) -> Option<String> {
    let text = |value: &Value| value.as_str().map(str::to_owned);
    let error = &json["error"];
    text(error)
        .or_else(|| text(&error["message"]))
        .or_else(|| text(&json["message"]))
        .or_else(|| text(&json["title"]))
}

/// The text of a page.
fn without_tags(page: &str) -> String {
    let mut in_tag = false;
    let keep = |c: char| match c {
        '<' => {
            in_tag = true;
            None
        }
        '>' if in_tag => {
            in_tag = false;
            Some(' ')
        }
        c => (!in_tag).then_some(c),
    };
    page.chars().filter_map(keep).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_and_json_are_told_in_short() {
        assert_eq!(without_tags("<h1>502 Bad</h1>\n<p>Gateway"), " 502 Bad \n Gateway");
        for json in [r#"{"error":"no"}"#, r#"{"error":{"code":400,"message":"no"}}"#, r#"{"title":"no"}"#] {
            assert_eq!(told(&serde_json::from_str(json).unwrap()), Some("no".into()), "{json}");
        }
    }
}
