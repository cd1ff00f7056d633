//! The house: no module uses what stands above it, and the core speaks no command line.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]
#![allow(clippy::print_stdout, reason = "what is still to do is shown")]

mod circles;
mod modules;
mod source;
mod words;

use std::path::{Path, PathBuf};
use std::process::Command;

use circles::Uses;
use modules::Crate;
use source::Source;

/// What is still to do: tolerated, and printed. `FILE -> FILE` is a use that closes a circle; a file alone has words of
/// the command line in its texts. Paths begin below `crates/`.
const STILL_TO_DO: &[&str] = &[
    "isolux-cli/src/beside.rs -> isolux-cli/src/cmd/evaluate.rs",
    "isolux-cli/src/cmd/calibrate/scenes.rs -> isolux-cli/src/cmd/calibrate/mod.rs",
    "isolux-cli/src/cmd/evaluate.rs -> isolux-cli/src/evaluation_page.rs",
    "isolux-cli/src/sigma.rs -> isolux-cli/src/step_args.rs",
    "isolux-experiments/src/paper/distance.rs -> isolux-experiments/src/paper/distance/claims.rs",
    "isolux-io/src/recording/native/mod.rs -> isolux-io/src/recording/mod.rs",
    "isolux-io/src/recording/native/npy.rs -> isolux-io/src/recording/native/literal.rs",
    "isolux-report/src/chart/layout.rs -> isolux-report/src/chart/marks.rs",
    "isolux-report/src/chart/mod.rs -> isolux-report/src/chart/draw.rs",
    "isolux-report/src/render.rs -> isolux-report/src/table.rs",
    "isolux/src/calibrate/joint/mod.rs -> isolux/src/calibrate/joint/fit.rs",
    "isolux/src/calibrate/joint/mod.rs -> isolux/src/calibrate/joint/problem.rs",
    "isolux/src/calibrate/joint/mod.rs -> isolux/src/calibrate/joint/robust.rs",
    "isolux/src/calibrate/scene/motion.rs -> isolux/src/calibrate/error.rs",
    "isolux/src/denoise/mod.rs -> isolux/src/denoise/median.rs",
    "isolux/src/denoise/mod.rs -> isolux/src/denoise/plane.rs",
    "isolux/src/denoise/mod.rs -> isolux/src/denoise/temporal.rs",
    "isolux/src/denoise/mod.rs -> isolux/src/denoise/wiener.rs",
    "isolux/src/denoise/noise.rs -> isolux/src/denoise/mod.rs",
    "isolux/src/denoise/temporal.rs -> isolux/src/standardize/mod.rs",
    "isolux/src/diagnose/material.rs -> isolux/src/diagnose/scaling.rs",
    "isolux/src/diagnose/mod.rs -> isolux/src/diagnose/diagnosis.rs",
    "isolux/src/diagnose/mod.rs -> isolux/src/diagnose/panel.rs",
    "isolux/src/diagnose/rules.rs -> isolux/src/diagnose/diagnosis.rs",
    "isolux/src/evaluate/mod.rs -> isolux/src/evaluate/noise.rs",
    "isolux/src/evaluate/mod.rs -> isolux/src/evaluate/pixel_cv.rs",
    "isolux/src/evaluate/mod.rs -> isolux/src/evaluate/reference.rs",
    "isolux/src/evaluate/mod.rs -> isolux/src/evaluate/sigma.rs",
    "isolux/src/evaluate/mod.rs -> isolux/src/evaluate/slope.rs",
    "isolux/src/regression/cluster.rs -> isolux/src/regression/mod.rs",
    "isolux/src/regression/rank.rs -> isolux/src/regression/mod.rs",
    "isolux/src/regression/solve.rs -> isolux/src/regression/mod.rs",
    "isolux/src/specular/mod.rs -> isolux/src/specular/knee.rs",
    "isolux/src/standardize/linearise.rs -> isolux/src/standardize/mod.rs",
    "isolux/src/standardize/mod.rs -> isolux/src/standardize/illumination.rs",
    "isolux/src/standardize/mod.rs -> isolux/src/standardize/time.rs",
    "isolux/src/terms/response/mod.rs -> isolux/src/terms/response/amplitude.rs",
    "isolux/src/terms/response/mod.rs -> isolux/src/terms/response/intensity.rs",
    "isolux/src/terms/response/mod.rs -> isolux/src/terms/response/phase_samples.rs",
    "isolux/src/terms/response/mod.rs -> isolux/src/terms/response/scalar.rs",
    "isolux/src/terms/response/pixel.rs -> isolux/src/terms/response/mod.rs",
    "isolux/src/terms/response/solve.rs -> isolux/src/terms/response/full_well.rs",
    "isolux/src/calibrate/error.rs",
    "isolux/src/calibrate/warning.rs",
    "isolux/src/standardize/mod.rs",
    "isolux/src/standardize/plan/distance.rs",
    "isolux/src/standardize/plan/illumination.rs",
    "isolux/src/standardize/plan/response.rs",
    "isolux/src/standardize/plan/time.rs",
    "isolux/src/standardize/report.rs",
    "isolux/src/terms/cubic.rs",
    "isolux/src/terms/lut.rs",
    "isolux/src/terms/spline/fit.rs",
];

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
    let mut circles = Vec::new();
    for name in all_crates() {
        let mut uses = Uses::of(&Crate::new(&name, sources(&name)));
        for exception in STILL_TO_DO {
            if !exception.starts_with(&format!("{name}/")) || !exception.contains(" -> ") {
                continue;
            }
            let word = if uses.remove(exception) { "still to do" } else { "done, take it off the list" };
            println!("{word}: {exception}");
        }
        circles.extend(uses.circles());
    }
    assert!(circles.is_empty(), "{} circles:\n\n{}", circles.len(), circles.join("\n\n"));
}

#[test]
fn the_core_speaks_no_command_line() {
    let commands = commands();
    assert!(commands.iter().any(|command| command == "calibrate"), "{commands:?}");
    let mut found = Vec::new();
    for name in WITHOUT_A_COMMAND_LINE {
        if !crates().join(name).is_dir() {
            continue;
        }
        for source in sources(name) {
            let words = words::of_the_command_line(&source, &commands);
            if STILL_TO_DO.contains(&source.path.as_str()) {
                println!("still to do: {}: {} texts", source.path, words.len());
            } else {
                found.extend(words);
            }
        }
    }
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
