//! Lenses that are no pinholes: depths become distances, walls flat and roads even, and what is not used is said.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use common::{Array, Sandbox, standardize};

const SIZE: usize = 96;
const FRAMES: usize = 4;
/// Pixels per radian of an equidistant lens that sees 60° at the middle of each side.
const FOCAL_PX: f64 = SIZE as f64 / 2.0 / (std::f64::consts::PI / 3.0);
/// Amplitude at 1 m, DN, and its noise.
const GAIN_DN: f64 = 600.0;
const NOISE_DN: f64 = 2.0;
/// The wall is before the camera at this depth.
const WALL_M: f64 = 1.5;
/// What it is at the reference distance of 0.75 m: the truth.
const TRUTH_DN: f64 = GAIN_DN / (0.75 * 0.75);

/// A normal number of this seed: the sum of twelve uniform ones.
fn normal(seed: &mut u64) -> f64 {
    let uniform = |seed: &mut u64| {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..12).map(|_| uniform(seed)).sum::<f64>() - 6.0
}

/// Where a pixel is, in pixels from the middle.
fn place(index: usize) -> [f64; 2] {
    let middle = 0.5 * (SIZE as f64 - 1.0);
    [(index % SIZE) as f64 - middle, (index / SIZE) as f64 - middle]
}

/// The ray of an equidistant pixel; `None` beyond 60°.
fn equidistant(index: usize) -> Option<[f64; 3]> {
    let [x, y] = place(index);
    let (r, angle) = (x.hypot(y), x.hypot(y) / FOCAL_PX);
    (angle < 60f64.to_radians()).then(|| [x / r * angle.sin(), y / r * angle.sin(), angle.cos()])
}

/// Depths in mm and amplitudes of the wall, along rays of unit length.
fn wall(ray: impl Fn(usize) -> Option<[f64; 3]>) -> Vec<(&'static str, Array)> {
    let (mut amplitude, mut depth_mm, mut seed) = (Vec::new(), Vec::new(), 7);
    for index in (0..FRAMES).flat_map(|_| 0..SIZE * SIZE) {
        let noise = NOISE_DN * normal(&mut seed);
        let seen = ray(index).map(|[_, _, z]| GAIN_DN / (WALL_M / z).powi(2) + noise);
        amplitude.push(seen.map_or(0.0, |value| value.round().max(0.0)));
        depth_mm.push(seen.map_or(0.0, |_| 1000.0 * WALL_M));
    }
    let dims = [FRAMES, SIZE, SIZE];
    vec![("amplitude", Array::new("<u2", &dims, amplitude)), ("distance", Array::new("<u2", &dims, depth_mm))]
}

/// The means over rings of 10° agree with the truth, out to `edge_deg`.
fn expect_flat(sandbox: &Sandbox, what: &str, edge_deg: f64, ray: impl Fn(usize) -> Option<[f64; 3]>) {
    let (values, _) = standardize(sandbox, "--distance square --specular none");
    let rings = (edge_deg / 10.0).ceil() as usize;
    let mut sums = vec![(0.0, 0.0, 0.0); rings];
    for (index, value) in values.iter().enumerate() {
        let Some([_, _, z]) = ray(index % (SIZE * SIZE)) else { continue };
        let angle_deg = z.acos().to_degrees();
        if value.is_nan() || angle_deg >= edge_deg {
            continue;
        }
        let (count, sum, variance) = &mut sums[(angle_deg / 10.0) as usize];
        *count += 1.0;
        *sum += f64::from(*value);
        // Of the noise and of rounding to whole numbers, times d²/0.75².
        *variance += (NOISE_DN.powi(2) + 1.0 / 12.0) * (WALL_M / z / 0.75).powi(4);
    }
    for (ring, (count, sum, variance)) in sums.into_iter().enumerate() {
        assert!(count > 100.0, "{what}: {count} pixels at {ring}0°");
        let (mean, error) = (sum / count, variance.sqrt() / count);
        // Four standard errors, and what depths in whole f32 roundings add.
        assert!(
            (mean - TRUTH_DN).abs() < 4.0 * error + 1e-3,
            "{what}, {ring}0°: {mean} ± {error}, {TRUTH_DN} expected"
        );
    }
}

fn with_lens(fields: &str, ray: impl Fn(usize) -> Option<[f64; 3]>) -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.described("rec", &wall(ray), &format!(r#"{{"distance_kind": "z", {fields}}}"#));
    sandbox
}

fn intrinsics(focal_px: f64, more: &str) -> String {
    format!(r#""intrinsics": {{"fx": {focal_px}, "fy": {focal_px}, "cx": 47.5, "cy": 47.5, {more}}}"#)
}

#[test]
fn a_wall_before_a_fisheye_is_flat_to_60_degrees() {
    let fisheye = intrinsics(FOCAL_PX, r#""model": "equidistant", "D": [0, 0, 0, 0]"#);
    let sandbox = with_lens(&fisheye, equidistant);
    expect_flat(&sandbox, "equidistant", 60.0, equidistant);
    sandbox.run("info rec").done().prints("Kannala–Brandt fisheye, 4 coefficients");
    // tan⁻¹ as a rational polynomial, fitted to 4e-6 up to 62°.
    let rational = r#""k1": 0.95433, "k2": 0.184042, "k3": 0.003729, "k4": 1.287651, "k5": 0.413382, "k6": 0.026375,
        "distortion_model": "rational_polynomial""#;
    expect_flat(&with_lens(&intrinsics(FOCAL_PX, rational), equidistant), "rational", 60.0, equidistant);
    // The same without its distortion is what it was: far too dark at the edge, and that would be noticed.
    let sandbox = with_lens(&intrinsics(FOCAL_PX, r#""name": "L""#), equidistant);
    let (values, _) = standardize(&sandbox, "--distance square --specular none");
    let edge = 47 * SIZE + 92;
    assert!(f64::from(values[edge]) < 0.7 * TRUTH_DN, "{}", values[edge]);
}

#[test]
fn a_wall_behind_brown_and_conrady_is_flat() {
    let [k1, k2, p1, p2, k3, f] = [-0.25, 0.06, 0.002, -0.001, 0.0, 60.0];
    // The distorted place of an undistorted one, solved by fixed points as OpenCV does it.
    let ray = |index: usize| {
        let [u, v] = place(index).map(|pixels| pixels / f);
        let (mut x, mut y) = (u, v);
        for _ in 0..2000 {
            let r2 = x * x + y * y;
            let q = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
            let (dx, dy) =
                (2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x), p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y);
            (x, y) = (0.5 * (x + (u - dx) / q), 0.5 * (y + (v - dy) / q));
        }
        let length = (x * x + y * y + 1.0).sqrt();
        Some([x / length, y / length, 1.0 / length])
    };
    let spelled = [
        r#""model": "plumb_bob", "coeffs": [-0.25, 0.06, 0.002, -0.001, 0]"#,
        r#""k1": -0.25, "k2": 0.06, "p1": 0.002, "p2": -0.001"#,
    ];
    for more in spelled {
        expect_flat(&with_lens(&intrinsics(f, more), ray), more, 50.0, ray);
    }
}

#[test]
fn a_wall_along_a_table_of_rays_is_flat_and_the_table_stays_with_the_result() {
    let sandbox = with_lens(r#""camera": "any lens""#, equidistant);
    let values: Vec<f64> = (0..SIZE * SIZE)
        .flat_map(|index| equidistant(index).map_or([f64::NAN; 3], |ray| ray.map(|value| 3.0 * value)))
        .collect();
    sandbox.write("rec/rays.npy", Array::new("<f4", &[SIZE, SIZE, 3], values).bytes());
    expect_flat(&sandbox, "rays.npy", 60.0, equidistant);
    sandbox.run("info rec").done().prints("table of rays (rays.npy), 1984 of 9216 pixels without a ray");
    sandbox.run("standardize rec -o kept --keep-input").done();
    assert_eq!(sandbox.json("kept/recording.json")["distance_kind"], "z");
    sandbox.run("info kept").done().prints("table of rays (rays.npy)");
    sandbox.run("standardize rec -o kept.npz --keep-input").done();
    sandbox.run("info kept.npz").done().prints("table of rays (rays.npy)");
    // A plane that faces the camera: the angle is the ray's own.
    standardize(&sandbox, "--angle on");
}

/// Frames of a road below a lidar at several heights and tilts. Level, each beam meets it at one angle, as if the beam were
/// weaker; at one height, the angle would follow from the distance.
fn road(exponent: f64) -> Sandbox {
    const BEAMS: usize = 48;
    const COLUMNS: usize = 120;
    const FRAMES: usize = 12;
    let altitudes_deg: Vec<f64> = (0..BEAMS).map(|row| -18.0 - 0.8 * row as f64).collect();
    let dims = [FRAMES, BEAMS, COLUMNS];
    let (mut amplitude, mut distance_m, mut seed) = (Vec::new(), Vec::new(), 3);
    for frame in 0..FRAMES {
        let height_m = [0.8, 1.2, 1.8, 2.6][frame % 4];
        let (tilt_x, tilt_y) = (2.4 * frame as f64).sin_cos();
        let up = [0.3 * tilt_x, 0.3 * tilt_y, 1.0].map(|value| value / 1.09f64.sqrt());
        for (altitude_deg, column) in altitudes_deg.iter().flat_map(|a| (0..COLUMNS).map(move |c| (a, c))) {
            let (up_by, across) = altitude_deg.to_radians().sin_cos();
            let (sine, cosine) = (std::f64::consts::TAU * column as f64 / COLUMNS as f64).sin_cos();
            let incidence = -(up[0] * cosine * across - up[1] * sine * across + up[2] * up_by);
            let d = height_m / incidence.max(0.05);
            let exact = 2e4 * incidence.max(0.05).powf(exponent) / (d * d) + 5.0 * normal(&mut seed);
            let seen = incidence > 0.05;
            amplitude.push(if seen { exact.max(0.0) } else { 0.0 });
            distance_m.push(if seen { d + 0.003 * normal(&mut seed) } else { 0.0 });
        }
    }
    let channels = [
        ("amplitude", Array::new("<f4", &dims, amplitude)),
        ("distance", Array::new("<f4", &dims, distance_m)),
        ("target", Array::filled("|u1", &dims, 1.0)),
    ];
    let beams = altitudes_deg.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
    let json = format!(r#"{{"camera": "lidar", "beam_intrinsics": {{"beam_altitude_angles": [{beams}]}}}}"#);
    let sandbox = Sandbox::new();
    sandbox.described("rec", &channels, &json);
    sandbox
}

#[test]
fn a_road_before_a_spinning_lidar_gives_the_angle() {
    /// A window of five beams spans 3°: its medians are not those of its middle.
    const COARSE_BEAMS: f64 = 0.015;
    for exponent in [1.0, 1.4] {
        let sandbox = road(exponent);
        sandbox.run("info rec").done().prints("spinning lidar, 48 beams");
        sandbox.run("calibrate --target rec -o lidar.json").done();
        let angle = &sandbox.json("lidar.json")["terms"]["angle"];
        let number = |field: &str| angle[field].as_f64().unwrap_or(f64::NAN);
        let (found, error) = (number("exponent"), number("standard_error"));
        let away = (found - exponent).abs();
        assert!(away < 4.0 * error + COARSE_BEAMS && error < 0.01, "{found} ± {error}, {exponent} expected");
        sandbox.run("standardize rec -o out -c lidar.json --angle on --distance square --profile off").done();
    }
}

#[test]
fn lenses_that_are_not_used_are_said_by_every_command_that_needs_them() {
    let unknown = with_lens(&intrinsics(FOCAL_PX, r#""model": "f-theta", "k1": 0.4"#), equidistant);
    let said = "`intrinsics.k1` not used: a distortion model named `f-theta` found";
    unknown.run("info rec").done().prints(said);
    unknown.run("standardize rec -o out").done().remarks(said);
    let folded = with_lens(&intrinsics(FOCAL_PX, r#""k1": -0.3"#), equidistant);
    folded.run("standardize rec -o out").done().remarks("of 9216 pixels have no ray in its lens");
    let (values, _) = standardize(&folded, "--specular none");
    assert!(values[47 * SIZE + 92].is_nan() && values[47 * SIZE + 50].is_finite());
}

#[test]
fn what_is_no_lens_is_refused() {
    let refused = |json: &str, rays: Option<Array>, parts: &[&str]| {
        let sandbox = Sandbox::new();
        sandbox.described("rec", &wall(equidistant), json);
        if let Some(rays) = rays {
            sandbox.write("rec/rays.npy", rays.bytes());
        }
        sandbox.run("info rec").refused(1, parts);
        sandbox.run("standardize rec -o out").refused(1, parts);
    };
    let z = r#"{"distance_kind": "z"}"#;
    refused(z, None, &["field `intrinsics`: found nothing", "table of rays"]);
    let of = |dims: &[usize]| Some(Array::filled("<f4", dims, 1.0));
    refused(z, of(&[SIZE, 3, 3]), &["rays", "found rays of 96×3", "expected 96×96"]);
    refused(z, of(&[FRAMES, SIZE, SIZE, 3]), &["rays.npy", "(H, W, 3)", "the same for all frames"]);
    refused(z, Some(Array::filled("<f4", &[SIZE, SIZE, 3], 0.0)), &["rays.npy", "row 0, column 0"]);
    let beams: Vec<String> = (0..SIZE).map(|row| (row as f64 * 0.1).to_string()).collect();
    let json = format!(r#"{{"distance_kind": "z", "beam_altitude_angles": [{}]}}"#, beams.join(", "));
    refused(&json, None, &["field `distance_kind`", "a lidar that spins has no axis"]);
    let json = format!("{{{}}}", intrinsics(FOCAL_PX, r#""model": "plumb_bob", "D": [1, 2]"#));
    refused(&json, None, &["field `intrinsics.D`", "expected 4 or 5 (k1, k2, p1, p2, k3)"]);
    let json = format!("{{{}}}", intrinsics(0.001, r#""k1": -3"#));
    refused(&json, None, &["field `intrinsics`", "no inverse at any pixel"]);
}

/// Coefficients that are not those of the lens, which is equidistant: they cannot make the wall flat, but they are used.
#[test]
fn coefficients_are_used_as_they_are() {
    let case = intrinsics(FOCAL_PX, r#""k1": 0.45, "k2": 0.1, "k4": 0.8, "model": "rational""#);
    let sandbox = with_lens(&case, equidistant);
    sandbox.run("info rec").done().prints("rational polynomial, 8 coefficients");
    let (values, _) = standardize(&sandbox, "--distance square --specular none");
    // By bisection of r (1 + 0.45 r² + 0.1 r⁴) / (1 + 0.8 r²) = θ in NumPy; a pinhole gives 931 and 607.
    for (angle_deg, expected) in [(40.0, 1020.4), (58.0, 713.8)] {
        let near = |index: &usize| {
            let [x, y] = place(index % (SIZE * SIZE));
            ((x.hypot(y) / FOCAL_PX).to_degrees() - angle_deg).abs() < 0.7
        };
        let ring: Vec<f64> = (0..values.len()).filter(near).map(|index| f64::from(values[index])).collect();
        let mean = ring.iter().sum::<f64>() / ring.len() as f64;
        assert!((mean / expected - 1.0).abs() < 0.01, "{mean} at {angle_deg}°");
    }
}
