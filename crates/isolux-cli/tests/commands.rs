//! The commands themselves: help that teaches, JSON that parses, pipes that close, runs that repeat bit by bit.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use std::process::{Command, Stdio};

use common::{Array, Sandbox, sweep};

const COMMANDS: [&str; 7] =
    ["demo", "info", "calibrate", "standardize", "evaluate", "simulate", "completions"];

/// The examples at the end of a command's help.
fn examples(help: &str) -> Vec<&str> {
    let text = help.split("Example").nth(1).unwrap_or_default();
    text.lines().map(str::trim).filter(|line| line.starts_with("isolux ")).collect()
}

/// Recordings of the names that the examples use.
fn recordings() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.recording("desk", &sweep());
    sandbox.recording("recordings/desk", &sweep());
    sandbox.write("desk.npz", common::npz(&sweep(), zip::CompressionMethod::Deflated));
    // Sixty frames of each time, since an example skips fifty.
    let times_us = [500.0, 1000.0, 2000.0, 4000.0, 8200.0, 12000.0];
    sandbox.recording("wall", &frames(60, times_us.map(|t| (t, 1.0)).to_vec()));
    let distances_m = [0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0];
    let board = [200.0, 4000.0, 8200.0].iter().flat_map(|t| distances_m.map(|d| (*t, d))).collect();
    sandbox.recording("board", &frames(2, board));
    sandbox.run("calibrate --exposure-sweep wall --distance-sweep board -o CAMERA.json").done();
    sandbox
}

/// A grey plane at each time (µs) and distance (m), so many frames each, with a little noise.
fn frames(count: usize, settings: Vec<(f64, f64)>) -> common::Channels {
    let (height, width) = (24, 24);
    let dims = [count * settings.len(), height, width];
    let of_frame = |i: usize| settings[i / (count * height * width)];
    let noise = |i: usize| ((i as u32).wrapping_mul(2_654_435_761) >> 24) as f64 / 256.0 - 0.5;
    let pixels = || 0..dims.iter().product::<usize>();
    let amplitude = pixels().map(|i| of_frame(i).0 / of_frame(i).1.powi(2) * (1.0 + 0.01 * noise(i)));
    let distance = pixels().map(|i| of_frame(i).1 + 0.002 * noise(i + 1));
    let times = (0..dims[0]).map(|frame| settings[frame / count].0);
    vec![
        ("amplitude", Array::new("<f4", &dims, amplitude.collect())),
        ("distance", Array::new("<f4", &dims, distance.collect())),
        ("integration_time_us", Array::new("<f8", &dims[..1], times.collect())),
    ]
}

#[test]
fn help_teaches_with_examples() {
    let sandbox = Sandbox::new();
    let overview = sandbox.run("--help").done();
    for command in COMMANDS {
        assert!(overview.stdout.contains(command), "{command} in {}", overview.stdout);
        let long = sandbox.isolux(&[command, "--help"]).done().stdout;
        assert!(!examples(&long).is_empty(), "{command}: {long}");
        assert!(long.len() > 200, "{command}: {long}");
        assert_eq!(sandbox.isolux(&["help", command]).done().stdout, long);
        for line in examples(&long) {
            assert!(line.starts_with(&format!("isolux {command}")), "{line}");
            // A line that the terminal's width breaks cannot be copied.
            assert!(line.chars().count() <= 78, "{line}");
        }
        sandbox.isolux(&[command, "-h"]).done();
    }
    sandbox.run("--version").done().prints(env!("CARGO_PKG_VERSION"));
}

/// Through the shell, since some examples redirect.
#[cfg(unix)]
#[test]
fn the_examples_of_the_help_work() {
    let program = std::path::Path::new(env!("CARGO_BIN_EXE_isolux")).parent().unwrap();
    let path = std::env::join_paths([program, "/usr/bin".as_ref(), "/bin".as_ref()]).unwrap();
    // `demo` is shown by a test of its own; the example of `completions` writes into the user's folder.
    for command in ["info", "calibrate", "standardize", "evaluate", "simulate"] {
        let sandbox = recordings();
        if command == "calibrate" {
            sandbox.run("simulate patches-smoke -o tilted-board").done();
            sandbox.run("simulate hand-held-smoke -o walk-through-the-lab").done();
        }
        let help = sandbox.isolux(&[command, "--help"]).done().stdout;
        for example in examples(&help) {
            let mut shell = Command::new("sh");
            shell.args(["-c", example]).env("PATH", &path).current_dir(sandbox.path());
            common::Run::new(shell).done();
            // Two examples write `out`.
            let _ = std::fs::remove_dir_all(sandbox.join("out"));
        }
    }
}

#[test]
fn json_is_for_programs() {
    let sandbox = recordings();
    let info = sandbox.run("info desk --json").json();
    assert_eq!((&info["frames"], &info["height"], &info["width"]), (&4.into(), &5.into(), &6.into()));
    assert_eq!(info["integration_times_us"].as_array().unwrap().len(), 4);
    let standardized = sandbox.run("standardize desk -c CAMERA.json -o out --json").json();
    assert_eq!(standardized["summary"]["frames"], 4);
    assert_eq!(standardized["steps"].as_array().unwrap().len(), 4);
    let evaluated = sandbox.run("evaluate desk -c CAMERA.json --json").json();
    assert!(evaluated["comparison"].is_object() || evaluated["comparison"].is_array());
    let calibrated = sandbox.run("calibrate --exposure-sweep wall -o again.json --json").json();
    assert_eq!(calibrated, sandbox.json("again.json"));
    assert_eq!(calibrated["format"], "isolux-calibration");
}

#[test]
fn completions_for_every_shell() {
    let sandbox = Sandbox::new();
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = sandbox.isolux(&["completions", shell]).done().stdout;
        for word in ["standardize", "exposure-sweep", "keep-input"] {
            assert!(script.contains(word), "{word} in {shell}");
        }
    }
}

/// `isolux info REC | head -1`: the reader is gone before anything is printed.
#[test]
fn a_closed_pipe_is_no_failure() {
    let sandbox = recordings();
    let calls = [
        "info desk",
        "info desk --json",
        "evaluate desk",
        "standardize desk -o out",
        "standardize desk -o out2 --json",
        "calibrate --exposure-sweep wall -o c.json",
        "simulate --list",
        "simulate --print example",
        "completions zsh",
        "--help",
        "standardize --help",
    ];
    for call in calls {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut command = sandbox.command(&call.split(' ').collect::<Vec<_>>());
        let output = command.stdin(Stdio::null()).stdout(writer).stderr(Stdio::piped()).spawn().unwrap();
        let output = output.wait_with_output().unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(!stderr.contains("panicked"), "{call}: {stderr}");
        assert_eq!(output.status.code(), Some(0), "{call}: {stderr}");
    }
    assert!(sandbox.join("out/standardized_amplitude.npy").is_file());
}

/// A full disk behind stdout is a failure; nobody listening on stderr is none.
#[cfg(target_os = "linux")]
#[test]
fn outputs_that_do_not_take_text() {
    let sandbox = recordings();
    let full = || std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let run = |call: &str, stdout: Stdio, stderr: Stdio| {
        let mut command = sandbox.command(&call.split(' ').collect::<Vec<_>>());
        let output = command.stdout(stdout).stderr(stderr).spawn().unwrap().wait_with_output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let (code, message) = run("info desk", full().into(), Stdio::piped());
    assert_eq!(code, Some(1));
    assert!(message.starts_with("error: cannot write to standard output"), "{message}");
    assert_eq!(run("info none", Stdio::null(), full().into()).0, Some(1));
    assert_eq!(run("standardize desk -o out", Stdio::null(), full().into()).0, Some(0));
}

#[test]
fn simulate_lists_prints_and_takes_scenes_of_ones_own() {
    let sandbox = Sandbox::new();
    let list = sandbox.run("simulate --list").done().stdout;
    let names: Vec<_> = list.lines().filter_map(|line| line.strip_prefix("  ")).collect();
    assert!(names.contains(&"patches") && names.contains(&"sr3100"), "{list}");
    for name in &names {
        let text = sandbox.isolux(&["simulate", "--print", name]).done().stdout;
        assert!(text.contains("version = 1"), "{name}");
    }
    let scene = sandbox.run("simulate --print example").done().stdout;
    assert!(scene.contains("frames_per_time = 2"), "{scene}");
    sandbox.write("mine.toml", scene.replace("frames_per_time = 2", "frames_per_time = 1"));
    let camera = sandbox.run("simulate --print sr3100").done().stdout;
    sandbox.write("camera.toml", camera.replace("name = \"sr3100\"", "name = \"mine\""));
    sandbox.run("simulate example -o built-in").done();
    sandbox.run("simulate mine.toml -o mine --camera camera.toml --truth --phase-samples").done();
    let frames = |name: &str| sandbox.isolux(&["info", name, "--json"]).json()["frames"].as_u64().unwrap();
    assert!(frames("mine") < frames("built-in"));
    assert_eq!(sandbox.json("mine/recording.json")["camera"], "mine (simulated)");
    for channel in ["phase_samples", "true_distance_m", "reflectivity"] {
        assert!(sandbox.join("mine").join(format!("{channel}.npy")).is_file());
    }
    sandbox.run("standardize mine -o out").done();
    sandbox.run("info out").done().prints("standardized_amplitude");
}

#[test]
fn scenes_that_cannot_be_simulated() {
    let sandbox = Sandbox::new();
    let scene = sandbox.run("simulate --print example").done().stdout;
    let cases: [(String, &str); 6] = [
        (String::new(), "missing field `version`"),
        (scene.replace("version = 1", "version = 2"), "version"),
        (format!("{scene}\nunknown = 1\n"), "unknown field `unknown`"),
        (scene.replace("frames_per_time = 2", "frames_per_time = 4000000000"), "frames_per_time"),
        (scene.replace("[1000.0, 4200.0]", "[nan, -1.0]"), "integration_times_us"),
        (format!("a = {}", "[".repeat(100_000)), "line 1"),
    ];
    for (text, part) in cases {
        sandbox.write("bad.toml", text);
        let before = sandbox.snapshot();
        sandbox.run("simulate bad.toml -o out").refused(1, &["bad.toml", part]);
        sandbox.expect_unchanged(&before, part);
    }
    sandbox.write("bytes.toml", b"\xff\xfe\x00");
    sandbox.run("simulate bytes.toml -o out").refused(1, &["bytes.toml", "UTF-8"]);
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    let sandbox = Sandbox::new();
    for output in ["a", "b", "a.npz", "b.npz"] {
        sandbox.isolux(&["simulate", "patches-smoke", "-o", output, "--seed", "7"]).done();
    }
    sandbox.run("simulate patches-smoke -o c --seed 8").done();
    let read = |name: &str| std::fs::read(sandbox.join(name)).unwrap();
    for file in ["amplitude.npy", "distance.npy", "intensity.npy", "target.npy", "recording.json"] {
        assert!(read(&format!("a/{file}")) == read(&format!("b/{file}")), "{file}");
    }
    assert!(read("a.npz") == read("b.npz") && read("a.json") == read("b.json"));
    assert!(read("a/amplitude.npy") != read("c/amplitude.npy"));
}

#[test]
fn one_run_from_sweeps_to_figures_repeats_bit_by_bit() {
    let sandbox = recordings();
    for (threads, output) in [("1", "one"), ("2", "two"), ("7", "seven")] {
        let call = format!("standardize board -c CAMERA.json -o {output} --method paper --threads {threads}");
        sandbox.run(&call).done();
        sandbox.run(&format!("info {output}")).done().prints("standardized_amplitude");
        for file in ["standardized_amplitude.npy", "flags.npy", "recording.json"] {
            let read = |folder: &str| std::fs::read(sandbox.join(folder).join(file)).unwrap();
            assert!(read(output) == read("one"), "{file} with {threads} threads");
        }
    }
    let figures = sandbox.run("evaluate board -c CAMERA.json --json").json();
    assert_eq!(figures, sandbox.run("evaluate board -c CAMERA.json --json").json());
    sandbox.run("standardize board -c CAMERA.json -o one --force").done();
}
