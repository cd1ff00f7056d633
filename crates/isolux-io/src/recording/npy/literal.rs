//! The little of Python's syntax that the headers of `.npy` files use.

use super::header_error::{HeaderError, unlike};

/// A cursor over a Python literal. It parses only what headers use, and does not recurse.
pub(super) struct Literal<'a> {
    rest: &'a str,
}

impl<'a> Literal<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self { rest: text }
    }

    pub(super) fn accept(&mut self, wanted: char) -> bool {
        let rest = self.rest.trim_start();
        let found = rest.strip_prefix(wanted);
        self.rest = found.unwrap_or(rest);
        found.is_some()
    }

    pub(super) fn expect(&mut self, wanted: char) -> Result<(), HeaderError> {
        if self.accept(wanted) { Ok(()) } else { Err(self.unexpected(&format!("'{wanted}'"))) }
    }

    pub(super) fn expect_end(&mut self) -> Result<(), HeaderError> {
        if self.rest.trim().is_empty() { Ok(()) } else { Err(self.unexpected("the header's end")) }
    }

    fn unexpected(&self, expected: &str) -> HeaderError {
        unlike(format!("\"{}\" in the header", shorten(self.rest.trim())), expected)
    }

    pub(super) fn string(&mut self) -> Result<&'a str, HeaderError> {
        let quote = if self.accept('\'') { '\'' } else { '"' };
        if quote == '"' {
            self.expect('"')?;
        }
        let (text, rest) = self.rest.split_once(quote).ok_or_else(|| self.unexpected("a closing quote"))?;
        self.rest = rest;
        Ok(text)
    }

    pub(super) fn boolean(&mut self) -> Result<bool, HeaderError> {
        for (word, value) in [("True", true), ("False", false)] {
            if let Some(rest) = self.rest.trim_start().strip_prefix(word) {
                self.rest = rest;
                return Ok(value);
            }
        }
        Err(self.unexpected("True or False"))
    }

    /// True where the next thing is a list or a tuple.
    pub(super) fn at_sequence(&self) -> bool {
        self.rest.trim_start().starts_with(['[', '('])
    }

    pub(super) fn tuple(&mut self) -> Result<Vec<usize>, HeaderError> {
        self.expect('(')?;
        let mut dims = Vec::new();
        while !self.accept(')') {
            let rest = self.rest.trim_start();
            let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
            let dim = rest[..digits].parse().map_err(|_| self.unexpected("a dimension"))?;
            dims.push(dim);
            // Python 2 wrote long integers as 3L.
            self.rest = rest[digits..].strip_prefix('L').unwrap_or(&rest[digits..]);
            if !self.accept(',') {
                self.expect(')')?;
                break;
            }
        }
        Ok(dims)
    }
}

/// The beginning of a text, for a message.
pub(super) fn shorten(text: &str) -> String {
    text.chars().take(60).collect()
}
