//! What a file says about time: progress (M73) and comments, brought up to date after reordering.
//!
//! Slicers estimate with models of their own. What a file states is therefore scaled, by how much our estimate
//! of the same stretch has changed between the two files.

use crate::estimate::Machine;
use crate::gcode::{Action, Annotated, Clock, Line, duration, lines};
use crate::units::Seconds;

/// Beginnings of comments that give a time.
const BEGINS: [&str; 11] = [
    "TIME_ELAPSED:",
    "TIME:",
    "PRINT.TIME:",
    "PRINT_TIME:",
    "Print Time:",
    "Build time:",
    "Estimated Build Time",
    "estimated printing time",
    "estimated first layer printing time",
    "model printing time",
    "total estimated time",
];

/// M73, and comments about time.
pub(super) fn is_time(line: &Line) -> bool {
    line.is(b'M', 73) || comment(line).is_some()
}

/// A comment about time, from its beginning.
fn comment<'a>(line: &Line<'a>) -> Option<&'a [u8]> {
    let alone = line.code.is_none() && line.parameters().trim_ascii().is_empty();
    let comment = line.comment.filter(|_| alone)?.trim_ascii();
    BEGINS.iter().any(|begin| comment.starts_with(begin.as_bytes())).then_some(comment)
}

/// Whether a line about time is understood, so that it can be brought up to date.
pub(super) fn is_understood(line: &Line) -> bool {
    updated(line, &Moment::default(), &Moment::default()).is_some()
}

/// A position in a file, by our estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Moment {
    /// Seconds up to there.
    elapsed_s: f64,
    /// Seconds up to the second layer, and to the end of the file.
    first_layer_s: f64,
    total_s: f64,
}

/// The times at which the lines about time come.
#[derive(Clone, Debug)]
pub struct Times {
    elapsed_s: Vec<f64>,
    first_layer_s: f64,
    total_s: f64,
}

/// Whether a piece of a text has a line about time.
pub fn has_times(text: &[u8]) -> bool {
    lines(text).any(|line| is_time(&line))
}

/// Follows a file with the planner.
#[derive(Debug)]
pub(super) struct Stopwatch {
    clock: Clock,
    /// A line about time begins another account, and so does the second layer.
    account: usize,
    lines: Vec<usize>,
    second_layer: Option<usize>,
}

impl Stopwatch {
    pub fn new(machine: &Machine) -> Self {
        Self { clock: Clock::new(machine), account: 0, lines: Vec::new(), second_layer: None }
    }

    pub fn step(&mut self, read: &Annotated) {
        if !matches!(read.action, Action::Stroke(_)) && is_time(&read.line) {
            self.account += 1;
            self.lines.push(self.account);
        } else if self.second_layer.is_none() && read.context.layer > Some(0) {
            self.account += 1;
            self.second_layer = Some(self.account);
        }
        self.clock.step(&read.line, &read.action, self.account);
    }

    pub fn finish(self) -> Times {
        let mut before_s = vec![0.0];
        before_s.extend(self.clock.finish().iter().scan(0.0, |sum, seconds| {
            *sum += seconds;
            Some(*sum)
        }));
        let total_s = before_s[before_s.len() - 1];
        let at = |account: usize| before_s.get(account).copied().unwrap_or(total_s);
        let first_layer_s = self.second_layer.map_or(total_s, at);
        Times { elapsed_s: self.lines.into_iter().map(at).collect(), first_layer_s, total_s }
    }
}

impl Times {
    /// The n-th line about time as it is in this file, brought up to date for its position in another one, where it
    /// is the m-th.
    pub fn updated(&self, line: &[u8], n: usize, other: &Self, m: usize) -> Option<Vec<u8>> {
        let [old, new] = [(self, n), (other, m)].map(|(times, index)| {
            let elapsed_s = times.elapsed_s.get(index).copied()?;
            Some(Moment { elapsed_s, first_layer_s: times.first_layer_s, total_s: times.total_s })
        });
        updated(&Line::new(0, 0, line), &old?, &new?)
    }
}

/// A line about time with other numbers; `None` where they are not understood.
fn updated(line: &Line, old: &Moment, new: &Moment) -> Option<Vec<u8>> {
    let Some(comment) = comment(line) else { return progress(line, old, new) };
    let of: fn(&Moment) -> f64 = if comment.starts_with(b"TIME_ELAPSED") {
        |moment| moment.elapsed_s
    } else if comment.starts_with(b"estimated first layer") {
        |moment| moment.first_layer_s
    } else {
        |moment| moment.total_s
    };
    let share = ratio(of(new), of(old));
    let head = line.text.len() - line.text.trim_ascii_end().len() + comment.len();
    let mut out = line.text[..line.text.len() - head].to_vec();
    for (index, part) in comment.split(|b| *b == b';').enumerate() {
        let at = part.iter().rposition(|b| matches!(b, b':' | b'='))? + 1;
        let (name, value) = part.split_at(at);
        let blanks = value.len() - value.trim_ascii_start().len();
        out.extend_from_slice(if index > 0 { b";" } else { b"" });
        out.extend_from_slice(name);
        out.extend_from_slice(&value[..blanks]);
        out.extend(scaled(std::str::from_utf8(value).ok()?.trim(), share)?.bytes());
    }
    Some(out)
}

/// M73 with percentages (P, and Q of a silent mode) and the minutes that are left (R and S).
fn progress(line: &Line, old: &Moment, new: &Moment) -> Option<Vec<u8>> {
    let words = line.words();
    if words.is_empty() || (b'A'..=b'Z').any(|l| !b"PQRS".contains(&l) && words.get(l).is_some()) {
        return None;
    }
    let left = ratio(new.total_s - new.elapsed_s, old.total_s - old.elapsed_s);
    let percent = (100.0 * new.elapsed_s / new.total_s.max(f64::MIN_POSITIVE)).floor().clamp(0.0, 100.0);
    let mut out = b"M73".to_vec();
    for letter in *b"PRQS" {
        let Some(value) = words.get(letter) else { continue };
        let value = if matches!(letter, b'P' | b'Q') { percent } else { (value * left).round() };
        out.extend(format!(" {}{value}", char::from(letter)).bytes());
    }
    Some(out)
}

fn ratio(new_s: f64, old_s: f64) -> f64 {
    if old_s > 1e-9 { (new_s / old_s).max(0.0) } else { 1.0 }
}

/// A number of seconds, or `1h 2m 3s`, times something, written as it was.
fn scaled(value: &str, share: f64) -> Option<String> {
    let digits = |text: &str| !text.is_empty() && text.len() < 10 && text.bytes().all(|b| b.is_ascii_digit());
    let (whole, decimals) = value.split_once('.').unwrap_or((value, ""));
    if digits(whole) && (decimals.is_empty() || digits(decimals)) {
        let seconds: f64 = value.parse().ok()?;
        return Some(format!("{:.*}", decimals.len(), seconds * share));
    }
    let mut seconds = None;
    for word in value.split(' ').filter(|word| !word.is_empty()) {
        let unit = [('d', 86_400.0), ('h', 3600.0), ('m', 60.0), ('s', 1.0)];
        let (number, unit_s) = unit.iter().find_map(|(u, s)| Some((word.strip_suffix(*u)?, s)))?;
        let number: f64 = digits(number).then(|| number.parse().ok())??;
        seconds = Some(seconds.unwrap_or(0.0) + number * unit_s);
    }
    seconds.map(|seconds| duration(Seconds(seconds * share)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn now(text: &str, old: [f64; 2], new: [f64; 2]) -> Option<String> {
        let moment = |[elapsed_s, total_s]: [f64; 2]| Moment { elapsed_s, first_layer_s: 10.0, total_s };
        let line = updated(&Line::new(0, 0, text.as_bytes()), &moment(old), &moment(new))?;
        Some(String::from_utf8(line).expect("UTF-8"))
    }

    #[test]
    fn statements_change_by_as_much_as_our_estimate_of_the_same_stretch() {
        let half = |text: &str| now(text, [80.0, 100.0], [20.0, 50.0]);
        for (old, new) in [
            (";TIME:4944", ";TIME:2472"),
            (";TIME_ELAPSED:284.384", ";TIME_ELAPSED:71.096"),
            (
                "; estimated printing time (normal mode) = 1h 4m 6s\r\n",
                "; estimated printing time (normal mode) = 32m 3s",
            ),
            (
                "; estimated first layer printing time (normal mode) = 3m 52s",
                "; estimated first layer printing time (normal mode) = 3m 52s",
            ),
            (
                "; model printing time: 40s; total estimated time: 1m 0s",
                "; model printing time: 20s; total estimated time: 30s",
            ),
            ("M73 P80 R20", "M73 P40 R30"),
            ("M73 Q80 S10\n", "M73 Q40 S15"),
        ] {
            assert_eq!(half(old).as_deref(), Some(new));
        }
    }

    #[test]
    fn what_is_not_understood_is_not_guessed() {
        for text in [
            "M73 C5",
            "M73",
            ";Build time: 1 hours 5 minutes",
            ";TIME:",
            ";TIME:1e5",
            "; estimated printing time = x",
        ] {
            assert_eq!(now(text, [1.0, 2.0], [1.0, 2.0]), None, "{text}");
        }
    }
}
