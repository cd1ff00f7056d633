//! Bad calls: steps that cannot be done, options out of range, sweeps that determine nothing. One message, nothing
//! left behind.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::{calibration, refused, sandbox, sweep};

#[test]
fn steps_that_cannot_be_done() {
    let sandbox = sandbox();
    let spare = |term: &str| {
        let mut calibration = calibration();
        calibration["terms"].as_object_mut().unwrap().remove(term);
        calibration.to_string()
    };
    sandbox.write("no-lut.json", spare("lut"));
    sandbox.write("no-cubic.json", spare("cubic"));
    let (ask, fit) = ("was asked for", "isolux calibrate --");
    for reader in ["standardize -o out", "evaluate"] {
        let call = |rest: &str| format!("{reader} {rest}");
        refused(
            &sandbox,
            &[
                (&call("rec --time lut"), 2, &["`lut`", ask, "no calibration is given", fit]),
                (&call("rec --distance cubic"), 2, &["`cubic`", ask, "no calibration is given", fit]),
                (&call("rec --method paper"), 2, &["`lut`", ask, "no calibration is given"]),
                (&call("rec -c no-lut.json --method paper"), 2, &["`lut`", ask, "does not hold it", fit]),
                (&call("rec -c no-lut.json --time lut"), 2, &["`lut`", ask, "does not hold it"]),
                (&call("rec -c no-cubic.json --method paper"), 2, &["`cubic`", ask, "does not hold it"]),
                (&call("rec -c no-cubic.json --distance cubic"), 2, &["`cubic`", ask, "does not hold it"]),
                (&call("bare --time linear"), 2, &["`linear`", ask, "no integration time"]),
                (&call("bare --distance square"), 2, &["`square`", ask, "no distance"]),
                (&call("bare -c camera.json --method paper"), 2, &["`lut`", ask, "no integration time"]),
            ],
        );
    }
    // Without a name there is a note instead.
    sandbox.run("standardize rec -c no-lut.json -o a").done().remarks("note: the calibration has no `lut`");
    sandbox.run("standardize bare -o b").done().remarks("note: the recording has no distance");
}

#[test]
fn options_out_of_range() {
    let sandbox = sandbox();
    let cases: [(&str, &str); 28] = [
        ("", "Usage"),
        ("nonsense", "nonsense"),
        ("info", "<REC>"),
        ("info rec rec", "unexpected argument"),
        ("info rec --colour", "--colour"),
        ("standardize rec", "--output"),
        ("standardize rec -o out --time fast", "fast"),
        ("standardize rec -o out --distance cube", "cube"),
        ("standardize rec -o out --specular knife", "knife"),
        ("standardize rec -o out --method worst", "worst"),
        ("standardize rec -o out --threads 0", "--threads"),
        ("standardize rec -o out --threads 1e3", "--threads"),
        ("standardize rec -o out --specular sigma:deviations=nan", "positive number"),
        ("standardize rec -o out --specular sigma:deviations=-4", "positive number"),
        ("standardize rec -o out --specular percent:fraction=1.5", "up to 1"),
        ("standardize rec -o out --specular percent:fraction=0", "above 0"),
        ("standardize rec -o out --specular histogram:occurrences=0", "1 or more"),
        ("standardize rec -o out --low-signal-dn inf", "positive number"),
        ("calibrate -o c.json --exposure-sweep rec --window 0", "--window"),
        ("calibrate -o c.json --exposure-sweep rec --window 65536", "--window"),
        ("calibrate -o c.json --exposure-sweep rec --skip-frames -1", "-1"),
        ("calibrate -o c.json --exposure-sweep rec --reference-time-us 0", "positive number"),
        ("calibrate -o c.json --exposure-sweep rec --reference-distance-m nan", "positive number"),
        ("calibrate -o c.json --exposure-sweep rec --exclude-time-us=-200", "positive number"),
        ("simulate example -o out --seed 1.5", "--seed"),
        ("simulate", "<SCENE>"),
        ("simulate example", "--output"),
        ("completions dos", "dos"),
    ];
    let before = sandbox.snapshot();
    for (call, part) in cases {
        let run = sandbox.run(call);
        assert_eq!((run.code, run.stdout.as_str()), (Some(2), ""), "{run:#?}");
        assert!(run.stderr.contains(part), "no \"{part}\" in {run:#?}");
        sandbox.expect_unchanged(&before, call);
    }
    refused(
        &sandbox,
        &[
            ("calibrate -o c.json", 2, &["nothing to fit", "--exposure-sweep REC", "--distance-sweep REC"]),
            (
                "standardize rec -o out --specular histogram:deviations=3",
                2,
                &["`deviations`", "occurrences expected"],
            ),
            ("evaluate rec --specular knee:quantile=0.9", 2, &["`quantile`", "`knee` has no other"]),
            ("simulate nowhere -o out", 2, &["no built-in scene `nowhere`", "patches"]),
            ("simulate example -o out --camera none", 2, &["no built-in camera `none`", "sr3100"]),
            ("simulate --print none", 2, &["`none`", "patches", "sr3100"]),
            ("simulate none.toml -o out", 1, &["`none.toml`", "No such file"]),
        ],
    );
}

#[test]
fn sweeps_that_determine_nothing() {
    let sandbox = sandbox();
    sandbox.recording("board", &sweep());
    let sweep = "calibrate -o c.json --exposure-sweep";
    refused(
        &sandbox,
        &[
            (
                &format!("{sweep} rec --reference-time-us 8200"),
                1,
                &["rec", "8200 µs is outside", "1000 to 4000 µs", "--reference-time-us"],
            ),
            (
                &format!("{sweep} rec --skip-frames 9"),
                1,
                &["rec", "0 usable integration times", "at least 2"],
            ),
            (
                &format!("{sweep} rec --exclude-time-us 1000 --exclude-time-us 2000 --exclude-time-us 3000"),
                1,
                &["rec"],
            ),
            (&format!("{sweep} bare"), 1, &["`bare`", "frame 0", "integration time"]),
            ("calibrate -o c.json --distance-sweep bare", 1, &["`bare`", "frame 0", "distance"]),
            (
                "calibrate -o c.json --distance-sweep board",
                1,
                &["`board`", "0.75 m", "1.250 m", "--reference-distance-m"],
            ),
            (
                "calibrate -o c.json --distance-sweep board --reference-distance-m 1.25",
                1,
                &["`board`", "1 different distances found", "at least 4 expected"],
            ),
        ],
    );
}
