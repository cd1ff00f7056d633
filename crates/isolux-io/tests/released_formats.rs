//! Every format that was ever released stays readable: one file of each is kept here.

use std::path::Path;

use isolux::Calibration;
use isolux::terms::lut::LutAnswer;

#[test]
fn calibration_version_1() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/camera-v1.json");
    let calibration: Calibration = isolux_io::read_calibration(&path).unwrap();
    assert_eq!(calibration.camera.as_deref(), Some("sr3100 (simulated)"));
    let (lut, cubic) = (calibration.terms.lut.unwrap(), calibration.terms.cubic.unwrap());
    assert_eq!(lut.at(1000.0), LutAnswer::Inside(8.188_898_051_949_023));
    assert_eq!(cubic.valid_distance_m, [0.349_872_506_260_871_85, 3.005_246_306_359_768]);
}
