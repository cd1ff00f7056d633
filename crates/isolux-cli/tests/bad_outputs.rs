//! Outputs that cannot be written, or must not: one message, no input harmed, nothing replaced that is not ours.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::{npz, refused, sandbox, sweep};
use zip::CompressionMethod::Stored;

#[test]
fn outputs_that_cannot_be_there() {
    let sandbox = sandbox();
    sandbox.write("file", "x");
    refused(
        &sandbox,
        &[
            ("standardize rec -o none/out", 1, &["cannot create `none/out`", "No such file"]),
            ("standardize rec -o none/out.npz", 1, &["cannot create `none/out.npz`", "No such file"]),
            ("standardize rec -o file/out", 1, &["cannot create `file/out`", "Not a directory"]),
            ("standardize rec -o .", 1, &["a path without a name"]),
            ("standardize bare -o ..", 1, &["a path without a name"]),
            ("simulate example -o none/out", 1, &["cannot create `none/out`", "No such file"]),
            (
                "calibrate --exposure-sweep rec --reference-time-us 2000 -o none/c.json",
                1,
                &["none/c.json", "No such file"],
            ),
        ],
    );
}

#[test]
fn outputs_that_are_there_already() {
    let sandbox = sandbox();
    sandbox.recording("out", &sweep());
    sandbox.write("file", "x");
    sandbox.write("out.npz", npz(&sweep(), Stored));
    sandbox.write("described.json", "{}");
    sandbox.write("foreign/notes.txt", "x");
    sandbox.write("folder.npz/notes.txt", "x");
    let exists = "exists already";
    refused(
        &sandbox,
        &[
            ("standardize rec -o out", 1, &["`out`", exists]),
            ("standardize rec -o file", 1, &["`file`", exists]),
            ("standardize rec -o out.npz", 1, &["`out.npz`", exists]),
            ("standardize rec -o described.npz", 1, &["`described.json`", exists]),
            ("simulate example -o out", 1, &["`out`", exists]),
            ("standardize rec -o file --force", 1, &["`file` will not be overwritten"]),
            ("standardize rec -o described.npz --force", 1, &["`described.json` will not be overwritten"]),
            ("standardize rec -o foreign --force", 1, &["`foreign` will not be overwritten", "`notes.txt`"]),
            ("standardize rec -o folder.npz --force", 1, &["`folder.npz` will not be overwritten"]),
            ("simulate example -o foreign --force", 1, &["`foreign` will not be overwritten", "`notes.txt`"]),
        ],
    );
}

#[test]
fn outputs_that_would_spoil_the_input() {
    let sandbox = sandbox();
    let spoil = "would spoil the input";
    refused(
        &sandbox,
        &[
            ("standardize rec -o rec", 2, &["`rec`", spoil]),
            ("standardize rec -o rec --force", 2, &["`rec`", spoil]),
            ("standardize rec -o rec/../rec/ --force", 2, &["`rec`", spoil]),
            ("standardize rec -o rec/out", 2, &["`rec/out`", spoil]),
            ("standardize rec -o rec/out.npy", 2, &["`rec/out.npy`", spoil]),
            ("standardize rec -o rec/recording.npz", 2, &["`rec/recording.npz`", spoil]),
            ("standardize packed.npz -o packed.npz --force", 2, &["`packed.npz`", spoil]),
            ("standardize rec -c camera.json -o camera.npz --force", 2, &["`camera.json`", spoil]),
            ("calibrate --exposure-sweep rec -o rec/camera.json", 2, &["`rec/camera.json`", spoil]),
            ("calibrate --exposure-sweep rec -o rec/amplitude.npy", 2, &["`rec/amplitude.npy`", spoil]),
            ("calibrate --distance-sweep packed.npz -o packed.json", 2, &["`packed.json`", spoil]),
            ("calibrate --exposure-sweep bare --distance-sweep rec -o rec", 2, &["`rec`", spoil]),
        ],
    );
}

#[cfg(unix)]
#[test]
fn outputs_through_links_are_seen_through() {
    let sandbox = sandbox();
    std::os::unix::fs::symlink("rec", sandbox.join("link")).unwrap();
    std::os::unix::fs::symlink("nowhere", sandbox.join("dangling")).unwrap();
    refused(
        &sandbox,
        &[
            ("standardize rec -o link --force", 2, &["`link`", "would spoil the input"]),
            ("standardize rec -o link/out", 2, &["`link/out`", "would spoil the input"]),
            ("standardize link -o rec --force", 2, &["`rec`", "would spoil the input"]),
            ("standardize bare -o link", 1, &["`link`", "exists already"]),
            ("standardize bare -o link --force", 1, &["`link` will not be overwritten"]),
            ("standardize bare -o dangling", 1, &["`dangling`", "exists already"]),
        ],
    );
}

#[test]
fn calibrate_replaces_calibrations_only() {
    let sandbox = sandbox();
    sandbox.write("notes.txt", "mine");
    sandbox.write("other.json", "{\"format\": \"other\"}");
    sandbox.write("newer.json", "{\"format\": \"isolux-calibration\", \"version\": 99}");
    sandbox.write("empty.json", "");
    let call = |output: &str| format!("calibrate --exposure-sweep rec --reference-time-us 2000 -o {output}");
    let not = "will not be replaced";
    refused(
        &sandbox,
        &[
            (&call("notes.txt"), 1, &["`notes.txt`", not]),
            (&call("other.json"), 1, &["`other.json`", not, "the format `other`"]),
            (&call("bare"), 1, &["`bare`", not, "a folder"]),
            (&call("bare/amplitude.npy"), 1, &["`bare/amplitude.npy`", not]),
        ],
    );
    for output in ["camera.json", "newer.json", "empty.json", "fresh.json"] {
        sandbox.run(&call(output)).done();
        sandbox.run(&format!("standardize rec -c {output} -o out --force")).done();
    }
}

/// The superuser may write everywhere, so there is nothing to see then.
#[cfg(unix)]
#[test]
fn read_only_folders() {
    use std::os::unix::fs::PermissionsExt;
    // SAFETY: reads the process's own user id.
    if unsafe { libc::geteuid() } == 0 {
        println!("skipped: the superuser may write into read-only folders");
        return;
    }
    let sandbox = sandbox();
    let locked = sandbox.join("locked");
    std::fs::create_dir(&locked).unwrap();
    std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o555)).unwrap();
    refused(
        &sandbox,
        &[
            ("standardize rec -o locked/out", 1, &["`locked/out`", "denied"]),
            ("standardize rec -o locked/out.npz", 1, &["`locked/out.npz`", "denied"]),
            (
                "calibrate --exposure-sweep rec --reference-time-us 2000 -o locked/c.json",
                1,
                &["locked/c.json", "denied"],
            ),
        ],
    );
}
