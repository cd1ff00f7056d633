//! The lenses against values of OpenCV, against themselves in the other direction, and what is refused.

use super::*;

const BROWN: [f64; 5] = [-0.28, 0.07, 0.0011, -0.0007, -0.012];
const RATIONAL: [f64; 8] = [0.52, -1.1, 0.0006, -0.0003, 0.31, 0.40, -1.0, 0.28];
const FISHEYE: [f64; 4] = [-0.02, 0.011, -0.006, 0.001];
/// 1e-9 of the undistorted coordinate, as the recordings' users are told; Newton's method leaves 1e-12.
const IDENTITY: f64 = 1e-9;

fn named(name: &str, coefficients: &[f64]) -> Distortion {
    Distortion::named(name, coefficients).unwrap().unwrap()
}

fn close(found: [f64; 2], expected: [f64; 2], tolerance: f64) {
    let away = (found[0] - expected[0]).hypot(found[1] - expected[1]);
    assert!(away <= tolerance, "{found:?}, {expected:?} expected: {away:e}");
}

fn flat([x, y, z]: [f64; 3]) -> [f64; 2] {
    [x / z, y / z]
}

/// Places at depth 1 and where `cv2.projectPoints` and `cv2.fisheye.projectPoints` of OpenCV 4 show them with fx = fy = 1,
/// cx = cy = 0.
#[test]
fn places_are_those_of_opencv() {
    let small = [[0.0, 0.0], [0.3, -0.2], [-0.55, 0.1], [0.4, 0.45], [-0.1, -0.6]];
    let wide = [[0.0, 0.0], [0.5, -0.3], [-1.2, 0.4], [0.8, 1.1], [2.5, -1.0]];
    let brown = [
        [0.0, 0.0],
        [0.28907799079999996, -0.1926363272],
        [-0.506196599609375, 0.09233972265625],
        [0.36276897812500003, 0.40879931914062506],
        [-0.0906785164, -0.5421100984],
    ];
    let rational = [
        [0.0, 0.0],
        [0.30388319120345786, -0.2025367941356386],
        [-0.5655527748644827, 0.10299823179354234],
        [0.4123931541298931, 0.4642821421461297],
        [-0.10318848282665107, -0.6182428969599063],
    ];
    let fisheye = [
        [0.0, 0.0],
        [0.4504754285406109, -0.2702852571243665],
        [-0.8454745710117301, 0.2818248570039101],
        [0.5441028237494322, 0.7481413826554693],
        [1.1055864415069243, -0.4422345766027697],
    ];
    let cases = [
        (named("plumb_bob", &BROWN), small, brown),
        (named("rational_polynomial", &RATIONAL), small, rational),
        (named("equidistant", &FISHEYE), wide, fisheye),
    ];
    for (distortion, undistorted, distorted) in cases {
        for ([x, y], shown) in undistorted.into_iter().zip(distorted) {
            close(distortion.image([x, y, 1.0]).unwrap(), shown, 1e-13);
            close(distortion.image([3.0 * x, 3.0 * y, 3.0]).unwrap(), shown, 1e-13);
            close(flat(distortion.ray(shown).unwrap()), [x, y], IDENTITY);
        }
    }
    // The polynomial in the other direction, as `rs2_deproject_pixel_to_point` of librealsense computes it.
    let inverse = named("inverse_brown_conrady", &BROWN);
    for (place, ray) in small.into_iter().zip(brown) {
        close(flat(inverse.ray(place).unwrap()), ray, 1e-13);
    }
}

#[test]
fn a_pixel_shows_the_ray_that_it_looks_along() {
    let pinhole = Intrinsics { fx: 260.0, fy: 270.0, cx: 160.5, cy: 121.0 };
    let shape = Shape::new(240, 320);
    let azimuths: Vec<f64> = (0..240).map(|row| f64::from(row % 4) * 1.4 - 2.0).collect();
    let altitudes: Vec<f64> = (0..240).map(|row| 45.0 - f64::from(row) * 0.37).collect();
    let lenses = [
        Lens::Pinhole(pinhole),
        Lens::Distorted(pinhole, named("brown_conrady", &BROWN)),
        Lens::Distorted(pinhole, named("inverse_brown_conrady", &BROWN)),
        Lens::Distorted(pinhole, named("rational", &RATIONAL)),
        Lens::Distorted(Intrinsics { fx: 90.0, fy: 91.0, ..pinhole }, named("kb4", &FISHEYE)),
        Lens::Spinning(Arc::new(SpinningLidar::new(&altitudes, &azimuths).unwrap())),
    ];
    for lens in lenses {
        lens.check_shape(shape).unwrap();
        assert_eq!(lens.pixel_rays(shape).blind_pixels(), 0, "{lens}");
        for (row, column) in (0..240).step_by(7).flat_map(|row| (0..320).step_by(3).map(move |x| (row, x))) {
            let ray = lens.ray(shape, row, column).unwrap();
            let longer = ray.map(|value| 2.5 * value);
            let pixel = lens.project(shape, longer).unwrap();
            close(pixel, [row as f64, column as f64], 300.0 * IDENTITY);
        }
    }
}

#[test]
fn a_fisheye_looks_backwards_too() {
    let fisheye = named("fisheye", &[0.0; 4]);
    let place = [100f64.to_radians(), 0.0];
    let [x, y, z] = fisheye.ray(place).unwrap();
    assert!((x - 100f64.to_radians().sin()).abs() < 1e-12 && y == 0.0 && z < -0.17, "{x} {y} {z}");
    close(fisheye.image([x, y, z]).unwrap(), place, 1e-12);
    let lens = Lens::Distorted(Intrinsics { fx: 10.0, fy: 10.0, cx: 20.0, cy: 0.0 }, fisheye);
    let shape = Shape::new(1, 41);
    let ratio = lens.pixel_rays(shape).radial_per_depth(shape);
    // 10 pixels a radian: 90° lie 15.7 pixels from the middle.
    assert!(ratio.values()[4].is_nan() && ratio.values()[36].is_nan());
    assert!((ratio.values()[10] - 1f32.cos().recip()).abs() < 1e-6 && ratio.values()[20] == 1.0);
}

#[test]
fn pixels_beyond_the_fold_of_a_polynomial_see_nothing() {
    // r − 0.3 r³ grows up to r = 1.054, where it is 0.703.
    let lens = Lens::Distorted(
        Intrinsics { fx: 10.0, fy: 10.0, cx: 10.0, cy: 0.0 },
        named("brown", &[-0.3, 0.0, 0.0, 0.0]),
    );
    let shape = Shape::new(1, 21);
    let seen: Vec<bool> = (0..21).map(|column| lens.ray(shape, 0, column).is_some()).collect();
    assert_eq!(seen, (0..21).map(|column: i32| (column - 10).abs() <= 7).collect::<Vec<_>>());
    assert_eq!(lens.pixel_rays(shape).blind_pixels(), 6);
    assert!(lens.project(shape, [2.0, 0.0, 1.0]).is_none());
    let aside = Lens::Distorted(
        Intrinsics { fx: 1.0, fy: 1.0, cx: 100.0, cy: 0.0 },
        named("brown", &[-0.3, 0.0, 0.0, 0.0]),
    );
    assert_eq!(aside.check_shape(shape), Err(LensError::SeesNothing));
}

#[test]
fn a_lidar_turns_clockwise_from_straight_ahead() {
    let lidar = Lens::Spinning(Arc::new(SpinningLidar::new(&[30.0, 0.0], &[]).unwrap()));
    let shape = Shape::new(2, 4);
    let expected = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for (column, expected) in expected.into_iter().enumerate() {
        let ray = lidar.ray(shape, 1, column).unwrap();
        assert!(ray.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{ray:?}");
    }
    let up = lidar.ray(shape, 0, 0).unwrap();
    assert!((up[2] - 0.5).abs() < 1e-15 && up[0] > 0.0);
    assert!(lidar.project(shape, [1.0, 0.0, -1.0]).is_none(), "below the lowest beam");
}

#[test]
fn descriptions_that_cannot_be_used_say_why() {
    let message = |name: &str, values: &[f64]| Distortion::named(name, values).unwrap_err().to_string();
    assert!(
        message("f-theta", &[1.0])
            .contains("a distortion model named `f-theta` found, one of `brown_conrady`")
    );
    let count = message("Plumb Bob", &[0.1, 0.2]);
    assert_eq!(
        count,
        "2 coefficients of the distortion model `brown_conrady` found, 4 or 5 (k1, k2, p1, p2, k3) of the model \
         `brown_conrady` expected"
    );
    assert!(message("none", &[0.1]).starts_with("1 coefficients of the distortion model `none`"));
    assert!(message("fisheye", &[f64::NAN; 4]).contains("not finite"));
    assert!(
        message("rational", &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.0, 2.0, 0.0, 0.0])
            .starts_with("a 9th or later coefficient of 2 found")
    );
    for name in ["plumb_bob", "", "rational_polynomial", "None"] {
        assert_eq!(Distortion::named(name, &[]), Ok(None), "{name}");
        assert_eq!(Distortion::named(name, &[0.0; 8]), Ok(None), "{name}");
    }
    let lidar = |altitudes: &[f64], azimuths: &[f64]| SpinningLidar::new(altitudes, azimuths);
    assert_eq!(lidar(&[91.0], &[]), Err(LensError::BeamAngles));
    assert_eq!(lidar(&[1.0, 2.0], &[1.0]), Err(LensError::AzimuthCount { found: 1, expected: 2 }));
    let two = Lens::Spinning(Arc::new(lidar(&[1.0, 0.0], &[]).unwrap()));
    assert_eq!(two.check_shape(Shape::new(3, 9)), Err(LensError::BeamCount { found: 2, expected: 3 }));
}

#[test]
fn tables_of_rays_are_checked_ray_by_ray() {
    let shape = Shape::new(1, 2);
    let nan = f64::NAN;
    let table = RayTable::new(shape, &[0.0, 3.0, 4.0, nan, nan, nan]).unwrap();
    assert_eq!(table.get(0, 0), Some([0.0, 0.6, 0.8]));
    assert_eq!((table.get(0, 1), table.get(1, 0), table.get(0, 2)), (None, None, None));
    let message = |values: &[f64]| RayTable::new(shape, values).unwrap_err().to_string();
    assert!(message(&[0.0; 6]).contains("row 0, column 0"));
    assert!(message(&[1.0, 0.0, 0.0, 1.0, nan, 0.0]).contains("column 1"));
    assert!(message(&[1.0, 0.0, 0.0, f64::INFINITY, 0.0, 0.0]).contains("finite direction"));
    assert!(message(&[nan; 6]).contains("without a single ray"));
    assert!(message(&[1.0; 5]).contains("5 values"));
    let lens = Lens::Rays(Arc::new(table));
    assert!(lens.check_shape(Shape::new(2, 1)).unwrap_err().to_string().contains("1×2"));
}
