//! The house: no module uses what stands above it, and the core speaks no command line.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod circles;
mod modules;
mod source;
mod words;

use std::path::{Path, PathBuf};
use std::process::Command;

use circles::Uses;
use modules::Crate;
use source::Source;

/// Crates whose texts must not name options, commands or files of the command line.
const WITHOUT_A_COMMAND_LINE: [&str; 2] = ["isolux", "isolux-pipeline"];

fn crates() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// Every source file below a crate's `src`, by its path below `crates/`.
fn sources(name: &str) -> Vec<Source> {
    let mut found = Vec::new();
    let mut folders = vec![crates().join(name).join("src")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let text = std::fs::read_to_string(&path).unwrap();
                found.push(Source::read(&below_crates(&path), &text));
            }
        }
    }
    found.sort_by(|a, b| a.path.cmp(&b.path));
    found
}

fn below_crates(path: &Path) -> String {
    let parts = path.strip_prefix(crates()).unwrap().components();
    parts.map(|part| part.as_os_str().to_string_lossy().into_owned()).collect::<Vec<_>>().join("/")
}

fn all_crates() -> Vec<String> {
    let folders = std::fs::read_dir(crates()).unwrap().map(|entry| entry.unwrap());
    let crates = folders.filter(|folder| folder.path().join("src").is_dir());
    let mut names: Vec<String> =
        crates.map(|folder| folder.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn no_modules_use_each_other_in_a_circle() {
    let of = |name: String| Uses::of(&Crate::new(&name, sources(&name))).circles();
    let circles: Vec<String> = all_crates().into_iter().flat_map(of).collect();
    assert!(circles.is_empty(), "{} circles:\n\n{}", circles.len(), circles.join("\n\n"));
}

#[test]
fn the_core_speaks_no_command_line() {
    let commands = commands();
    assert!(commands.iter().any(|command| command == "calibrate"), "{commands:?}");
    let sources = WITHOUT_A_COMMAND_LINE.into_iter().flat_map(sources);
    let found: Vec<String> =
        sources.flat_map(|source| words::of_the_command_line(&source, &commands)).collect();
    assert!(found.is_empty(), "{} texts:\n{}", found.len(), found.join("\n"));
}

/// The names of the commands, as the program lists them.
fn commands() -> Vec<String> {
    let output = Command::new(env!("CARGO_BIN_EXE_isolux")).arg("--help").output().unwrap();
    let help = String::from_utf8(output.stdout).unwrap();
    let list = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    // A name is indented by two; what a long description continues with, by more.
    let names = list.take_while(|line| !line.is_empty()).filter_map(|line| line.strip_prefix("  "));
    let names = names.filter(|line| !line.starts_with(' ')).filter_map(|line| line.split_whitespace().next());
    names.map(str::to_owned).collect()
}
