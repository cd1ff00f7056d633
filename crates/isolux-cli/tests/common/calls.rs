//! Calls that are refused, and the folder that they are made in.

use serde_json::{Value, json};
use zip::CompressionMethod::Stored;

use super::{Sandbox, npz, sweep, without};

/// A calibration with both terms, to be spoilt.
pub fn calibration() -> Value {
    json!({
        "format": "isolux-calibration",
        "version": 1,
        "camera": "X",
        "created_by": "isolux 0.1.0",
        "reference": {"integration_time_us": 2000.0, "distance_m": 0.75},
        "terms": {
            "lut": {
                "version": 1,
                "integration_time_us": [1000.0, 2000.0, 4000.0],
                "multiplier": [2.0, 1.0, 0.5],
                "valid_integration_time_us": [1000.0, 4000.0],
                "fitted_on": [],
                "fit": {"points": 3, "residual": 0.01},
                "warnings": []
            },
            "cubic": {
                "version": 1,
                "coefficients": [0.0, 0.0, 16.0 / 9.0, 0.0],
                "valid_distance_m": [0.5, 3.0],
                "fitted_on": [],
                "fit": {"points": 8, "residual": 0.01},
                "warnings": []
            }
        },
        "warnings": []
    })
}

/// A folder with the recordings `rec`, `packed.npz` and `bare` (amplitude alone), and `camera.json`.
pub fn sandbox() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.recording("rec", &sweep());
    sandbox.write("packed.npz", npz(&sweep(), Stored));
    sandbox.write("packed.json", "{\"camera\": \"X\"}");
    let bare = without(&without(&sweep(), "distance"), "integration_time_us");
    sandbox.recording("bare", &bare);
    sandbox.write("camera.json", calibration().to_string());
    sandbox
}

/// Fails unless every call ends with `code` and a message with these parts, and changes nothing.
pub fn refused(sandbox: &Sandbox, calls: &[(&str, i32, &[&str])]) {
    let before = sandbox.snapshot();
    for (call, code, parts) in calls {
        sandbox.run(call).refused(*code, parts);
        sandbox.expect_unchanged(&before, call);
    }
}
