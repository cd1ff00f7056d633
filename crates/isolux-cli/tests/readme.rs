//! The README keeps its word: its commands run, in their order, and its figures are those that the demo prints.

#![expect(clippy::expect_used, reason = "a test that cannot run must stop")]

use std::path::Path;
use std::process::Command;

const README: &str = include_str!("../../../README.md");

fn isolux(folder: &Path, arguments: &str) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_isolux"))
        .args(arguments.split_whitespace())
        .current_dir(folder)
        .output()
        .expect("the program starts");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "isolux {arguments}: {errors}");
    String::from_utf8(output.stdout).expect("output is UTF-8")
}

#[test]
fn its_commands_run_in_their_order() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let commands: Vec<&str> = README.lines().filter_map(|line| line.strip_prefix("isolux ")).collect();
    assert!(commands.len() >= 8, "{commands:?}");
    for command in commands {
        assert!(!isolux(folder.path(), command).is_empty(), "{command} prints something");
    }
}

#[test]
fn its_figures_are_those_of_the_demo() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let printed = isolux(folder.path(), "demo");
    let figures = README.split("<!-- printed by `isolux demo` -->\n```text\n").nth(1).expect("the table");
    let figures = figures.split("```").next().expect("its end");
    assert!(figures.lines().count() > 5);
    for line in figures.lines() {
        assert!(printed.lines().any(|printed| printed == line), "not printed by the demo: {line}");
    }
    let folder = folder.path().join("isolux-demo");
    for picture in ["integration-times", "distances", "highlights"] {
        assert!(folder.join(format!("before-after-{picture}.png")).is_file());
    }
    assert!(folder.join("CAMERA.json").is_file() && folder.join("demo.json").is_file());
}

/// The short table of what isolux reaches has the figures of the long one, which a test of its own measures.
#[test]
fn its_short_table_is_taken_from_the_docs() {
    let docs = include_str!("../../../docs/figures.md");
    let table =
        README.split("| | raw | A d²/t |").nth(1).expect("the table").split("\n\n").next().expect("its end");
    let is_figure = |word: &&str| word.contains('.') && word.parse::<f64>().is_ok();
    let figures: Vec<&str> = table.split_whitespace().filter(is_figure).collect();
    assert!(figures.len() >= 12, "{figures:?}");
    for figure in figures {
        assert!(docs.contains(&format!(" {figure} ")), "{figure} is not in docs/figures.md");
    }
}
