//! How much is too much, so that no script takes memory or time without end.

/// Bytes of a script.
pub const SCRIPT: usize = 1 << 20;
/// Parentheses, function calls, signs and `{if}`s within each other.
pub const DEPTH: usize = 100;
/// Bytes that one expansion writes.
pub const OUTPUT: usize = 16 << 20;
/// Expressions evaluated and bytes of texts and vectors made in one expansion.
pub const WORK: usize = 64 << 20;
/// Bytes that global variables hold.
pub const GLOBALS: usize = 16 << 20;
/// Bytes of a compiled regular expression.
pub const PATTERN: usize = 64 << 10;
/// How often regular expressions are used in one expansion.
pub const PATTERNS: usize = 1000;
/// Bytes that are compared with regular expressions in one expansion.
pub const MATCHED: usize = 1 << 20;
