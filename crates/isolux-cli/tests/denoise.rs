//! Denoising the distance through the program. What it is worth on simulated frames: `isolux-experiments`'s
//! `tests/denoise.rs`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::Sandbox;
use isolux::DenoiseRule;

const RULES: [DenoiseRule; 4] =
    [DenoiseRule::Median, DenoiseRule::Wiener, DenoiseRule::Plane, DenoiseRule::Temporal];

/// Through the program: recorded among the steps, the same bits with any number of threads, the input kept.
#[test]
fn the_program_denoises_alike_with_any_number_of_threads() {
    let sandbox = Sandbox::new();
    let done = |arguments: &str| {
        let run = sandbox.run(arguments);
        assert_eq!(run.code, Some(0), "{arguments}: {}", run.stderr);
        run.stdout
    };
    done("simulate patches-smoke -o rec");
    done("standardize rec -o plain");
    let plain = sandbox.f32s("plain/standardized_amplitude.npy");
    for rule in RULES.map(DenoiseRule::name) {
        done(&format!("standardize rec -o {rule}1 --threads 1 --denoise {rule}"));
        done(&format!("standardize rec -o {rule}3 --threads 3 --denoise {rule} --keep-input"));
        let [one, three] = [1, 3].map(|n| sandbox.array(&format!("{rule}{n}/standardized_amplitude.npy")));
        assert_eq!(one, three, "{rule}");
        assert_eq!(sandbox.array(&format!("{rule}3/distance.npy")), sandbox.array("rec/distance.npy"));
        let found = sandbox.f32s(&format!("{rule}1/standardized_amplitude.npy"));
        assert!(found.iter().zip(&plain).all(|(found, plain)| found.is_nan() == plain.is_nan()), "{rule}");
        assert_ne!(found, plain, "{rule}");
        let record = sandbox.json(&format!("{rule}1/recording.json"));
        let steps = record["standardization"]["steps"].as_array().unwrap();
        let effects: Vec<_> = steps.iter().map(|step| step["effect"].as_str().unwrap()).collect();
        assert_eq!(effects, ["time", "denoise", "distance", "specular"]);
        assert_eq!(steps[1]["term"], rule);
        done(&format!("evaluate rec --denoise {rule}"));
    }
    done("standardize rec -o none --denoise none");
    assert_eq!(
        sandbox.array("none/standardized_amplitude.npy"),
        sandbox.array("plain/standardized_amplitude.npy")
    );
    assert!(
        sandbox
            .run("standardize rec -o idle --denoise wiener --distance none")
            .stderr
            .contains("nothing to denoise")
    );
}
