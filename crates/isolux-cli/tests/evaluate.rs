//! What `evaluate` shows beside the chosen chain.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::Sandbox;

fn calibrated() -> Sandbox {
    let sandbox = Sandbox::new();
    for scene in ["wall-sweep-smoke", "board-distances-smoke", "patches-smoke"] {
        sandbox.run(&format!("simulate {scene} -o {scene}")).done();
    }
    let sweeps = "--exposure-sweep wall-sweep-smoke --distance-sweep board-distances-smoke";
    sandbox.run(&format!("calibrate {sweeps} -o CAMERA.json")).done();
    sandbox
}

/// A rival's figures are those that it gets when it is chosen itself.
#[test]
fn the_rivals_stand_as_when_they_are_chosen_alone() {
    let sandbox = calibrated();
    let all = sandbox.run("evaluate patches-smoke -c CAMERA.json --trusted --json").json();
    let names: Vec<_> = all["beside"].as_array().unwrap().iter().map(|rival| rival["name"].clone()).collect();
    assert_eq!(names, ["textbook", "paper"]);
    let alone = |options: &str| {
        let json = sandbox
            .run(&format!("evaluate patches-smoke -c CAMERA.json --alone --sigma off --json {options}"))
            .json();
        assert_eq!(json["beside"].as_array().unwrap().len(), 0);
        json["comparison"]["after"].clone()
    };
    let untrusted = sandbox.run("evaluate patches-smoke -c CAMERA.json --json").json();
    assert_eq!(untrusted["beside"][0]["figures"], alone("--time linear --distance square --specular none"));
    assert_eq!(untrusted["beside"][1]["figures"], alone("--method paper"));
    assert_ne!(untrusted["beside"][1]["figures"], untrusted["comparison"]["after"]);
}

/// The table names every chain with its steps, and the page has the same table.
#[test]
fn the_table_and_the_page_show_all_chains() {
    let sandbox = calibrated();
    let run = sandbox.run("evaluate patches-smoke -c CAMERA.json --report page.html");
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let header = run.stdout.lines().nth(1).unwrap();
    let columns: Vec<&str> = header.split_whitespace().collect();
    assert_eq!(columns, ["figure", "better", "raw", "textbook", "paper", "chosen"]);
    for steps in [
        "textbook: linear, square",
        "paper: lut, cubic, histogram",
        "chosen: response, spline, histogram, noise",
    ] {
        assert!(run.stdout.lines().any(|line| line == steps), "{steps}: {}", run.stdout);
    }
    assert!(std::fs::read_to_string(sandbox.join("page.html")).unwrap().contains("id=\"recording-beside\""));
    // Without a calibration the textbook is the chosen chain, and nobody is beside it.
    let run = sandbox.run("evaluate patches-smoke");
    assert!(run.stdout.starts_with("figure") && !run.stdout.contains("textbook"), "{}", run.stdout);
}

/// A profile of another image format is nobody's step: the chosen chain says so, and its rivals know none.
#[test]
fn a_profile_of_another_format_stops_nobody() {
    let sandbox = calibrated();
    let mut camera = sandbox.json("CAMERA.json");
    camera["terms"]["profile"] = serde_json::json!({
        "version": 1, "height": 10, "width": 12, "origin_px": [4.5, 5.5], "radial": [0.0, 0.0],
        "tensor": vec![0.0; 48], "support": vec!["################"; 12], "fitted_on": [],
        "fit": {"points": 1, "residual": 0.0}, "warnings": []
    });
    sandbox.write("CAMERA.json", camera.to_string());
    let run = sandbox.run("evaluate patches-smoke -c CAMERA.json --json");
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert!(run.stderr.contains("profile"), "{}", run.stderr);
    let told: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(told["beside"][0]["steps"], serde_json::json!(["linear", "square"]));
}
