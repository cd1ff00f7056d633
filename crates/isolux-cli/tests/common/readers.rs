//! The commands that read recordings, and how they refuse.

use super::Sandbox;

/// Every command that reads a recording, with `BAD` in its place.
pub const READERS: [&str; 8] = [
    "info BAD",
    "info BAD --json",
    "standardize BAD -o out",
    "standardize BAD -o out.npz --keep-input --json",
    "evaluate BAD",
    "evaluate BAD --json",
    "calibrate --exposure-sweep BAD -o camera.json --reference-time-us 2000",
    "calibrate --distance-sweep BAD -o camera.json",
];

/// Fails unless each command ends as it should and leaves the folder as it was.
pub fn refused_by(commands: &[&str], sandbox: &Sandbox, bad: &str, parts: &[&str]) {
    let before = sandbox.snapshot();
    for command in commands {
        let words: Vec<&str> =
            command.split(' ').map(|word| if word == "BAD" { bad } else { word }).collect();
        sandbox.isolux(&words).refused(1, parts);
        sandbox.expect_unchanged(&before, command);
    }
}
