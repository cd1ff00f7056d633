//! The table of docs/figures.md is what `isolux figures` prints. Ignored by default, because it takes minutes without
//! optimization: `cargo test --release -p isolux-cli --test figures -- --ignored`.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests fail by panicking")]

use std::process::Command;

const DOCS: &str = include_str!("../../../docs/figures.md");

/// The rows of a table, cell by cell.
fn rows(text: &str) -> Vec<Vec<&str>> {
    let lines = text.lines().filter(|line| line.starts_with("| ")).skip(1);
    lines.map(|line| line.trim_matches('|').split(" | ").map(str::trim).collect()).collect()
}

fn number(cell: &str) -> f64 {
    cell.trim_end_matches([' ', '%', 'm']).parse().unwrap()
}

/// Two units of the last digit, and 2 % for fits that end a step earlier or later on another processor.
fn is_near(printed: &str, written: &str) -> bool {
    let decimals = written.trim_end_matches([' ', '%', 'm']).split('.').nth(1).map_or(0, str::len) as i32;
    let (printed, written) = (number(printed), number(written));
    (printed - written).abs() <= (2.0 * 10f64.powi(-decimals)).max(0.02 * written.abs())
}

#[test]
#[ignore = "takes minutes without optimization"]
fn the_documented_figures_are_those_that_are_measured() {
    let output = Command::new(env!("CARGO_BIN_EXE_isolux")).arg("figures").output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let printed = String::from_utf8(output.stdout).unwrap();
    let (printed, written) = (rows(&printed), rows(DOCS));
    assert!(printed.len() > 50, "{}", printed.len());
    // What follows in the docs is measured on recordings that need not be here.
    for (printed, written) in printed.iter().zip(&written) {
        let [subject, what, value, aim, met] = printed[..] else { panic!("{printed:?}") };
        let told = [subject, what, aim, met];
        assert_eq!(told, [written[0], written[1], written[3], written[4]], "{printed:?}");
        assert!(is_near(value, written[2]), "{what}: {value}, documented {}", written[2]);
    }
    assert!(written.len() >= printed.len());
}
