//! Sizes of text that is laid out before any font is known.

/// Size of letters, pixels.
pub(super) const LETTERS: f64 = 13.0;
/// Height of a line of text, pixels.
pub(super) const LINE: f64 = 17.0;
/// Width of a letter of a usual sans-serif font over its size, on average and on the safe side.
const LETTER: f64 = 0.56;

/// Which point of a line of text is at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    /// Its left end, at half its height.
    Left,
    /// Its middle.
    Middle,
    /// Its right end, at half its height.
    Right,
    /// The middle of its upper edge.
    Top,
}

/// Estimated width in pixels of a text in letters of `size` pixels.
pub(super) fn width(text: &str, size: f64) -> f64 {
    text.chars().count() as f64 * LETTER * size
}

/// Lines of at most `room` pixels, cut between words; a word that is longer has a line of its own.
pub(super) fn wrap(text: &str, size: f64, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width(line, size) + width(word, size) + LETTER * size <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wraps_between_words() {
        assert_eq!(wrap("mean amplitude in DN", 10.0, 90.0), ["mean amplitude", "in DN"]);
        assert_eq!(wrap("", 10.0, 90.0), Vec::<String>::new());
        assert_eq!(wrap("Donaudampfschiff of x", 10.0, 20.0), ["Donaudampfschiff", "of", "x"]);
    }
}
