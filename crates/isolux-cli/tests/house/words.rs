//! Words of the command line in the texts of a source file.

use super::source::{Source, Token};

/// Every text that names an option, a command or the file that describes a recording.
pub(crate) fn of_the_command_line(source: &Source, commands: &[String]) -> Vec<String> {
    let mut found = Vec::new();
    for (token, line) in &source.tokens {
        let Token::Text(text) = token else { continue };
        if names_an_option(text) || text.contains("recording.json") || names_a_command(text, commands) {
            found.push(format!("crates/{}:{line}: \"{text}\"", source.path));
        }
    }
    found
}

/// Two hyphens and a letter.
fn names_an_option(text: &str) -> bool {
    text.match_indices("--").any(|(at, _)| text[at + 2..].starts_with(|c: char| c.is_ascii_alphabetic()))
}

fn names_a_command(text: &str, commands: &[String]) -> bool {
    text.split("isolux ").skip(1).any(|rest| {
        let end = rest.find(|c: char| !c.is_ascii_lowercase()).unwrap_or(rest.len());
        commands.iter().any(|command| *command == rest[..end])
    })
}

#[test]
fn planted_words_are_found() {
    let text = r#"
        // --comment
        /// `--document`
        #[error("give --exposure-sweep")]
        struct E;
        fn f() {
            g("an en dash -- of old", "a - b", "isolux calibration", "---");
            g("recording.json says no", "run `isolux calibrate` first");
        }
        #[cfg(test)]
        mod tests { const T: &str = "--test"; }
    "#;
    let found = of_the_command_line(&Source::read("a/src/b.rs", text), &["calibrate".to_owned()]);
    assert_eq!(
        found,
        [
            "crates/a/src/b.rs:4: \"give --exposure-sweep\"",
            "crates/a/src/b.rs:8: \"recording.json says no\"",
            "crates/a/src/b.rs:8: \"run `isolux calibrate` first\"",
        ]
    );
}
