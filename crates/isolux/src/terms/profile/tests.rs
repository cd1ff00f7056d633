use super::*;
use crate::frame::{Intrinsics, Lens, Shape};
use crate::terms::FitQuality;

const SHAPE: Shape = Shape::new(48, 64);

/// cos⁴ of a lens, with a tilt, seen in the middle of the image only.
fn profile() -> Profile {
    let lens = Lens::from(Intrinsics { fx: 60.0, fy: 60.0, cx: 30.0, cy: 25.0 });
    let places = Places::new(SHAPE, Some(&lens));
    let middle = |cell: usize| (2..14).contains(&(cell % 16)) && (2..10).contains(&(cell / 16));
    Profile {
        version: 1,
        map: Map { places, radial: [-0.9, 0.2], tensor: vec![0.0; Surface::TENSOR_LEN] },
        support: Profile::support_map(middle),
        fitted_on: Vec::new(),
        fit: FitQuality { points: 1, residual: 0.0, held_out_residual: None },
        warnings: Vec::new(),
    }
}

#[test]
fn gains_undo_the_profile_and_go_on_constant_outside_the_support() {
    let profile = profile();
    let ProfileGains { gains, outside } = profile.gains();
    assert_eq!(gains.get(25, 30), Some(1.0));
    let places = profile.places();
    for (index, (gain, outside)) in gains.values().iter().zip(&outside).enumerate() {
        let place = places.at((index / SHAPE.width) as f64, (index % SHAPE.width) as f64);
        assert_eq!(*outside, !profile.supports(place));
        let exact = (-profile.ln_gain(place)).exp();
        // Half an ulp of f32.
        assert!(*outside || (f64::from(*gain) / exact - 1.0).abs() < 1e-7);
        // The radial law falls, so a value that is continued from farther in is smaller.
        assert!(!*outside || f64::from(*gain) < exact, "{index}");
    }
    assert!(outside[0] && outside.iter().filter(|outside| **outside).count() > 64 * 48 / 4);
}

#[test]
fn a_support_away_from_the_origin_lends_its_nearest_cell() {
    let profile = Profile { support: Profile::support_map(|cell| cell == 17), ..profile() };
    let ProfileGains { gains, .. } = profile.gains();
    let expected = (-profile.ln_gain(profile.places().cell_centre(17))).exp() as f32;
    assert_eq!(gains.get(47, 63), Some(expected));
}

#[test]
fn edited_parameters_are_checked() {
    assert!(profile().check().is_ok());
    let spoil = |change: fn(&mut Profile)| {
        let mut profile = profile();
        change(&mut profile);
        profile.check().unwrap_err().field
    };
    assert_eq!(spoil(|p| p.version = 2), "profile.version");
    assert_eq!(spoil(|p| p.map.places.shape.height = 0), "profile.height");
    assert_eq!(spoil(|p| p.map.places.shape.width = usize::MAX), "profile.height");
    assert_eq!(spoil(|p| p.map.places.origin[0] = f64::NAN), "profile.origin_px");
    assert_eq!(spoil(|p| p.map.radial[1] = f64::INFINITY), "profile.radial");
    assert_eq!(spoil(|p| p.map.radial[1] = 900.0), "profile.tensor");
    assert_eq!(spoil(|p| p.map.tensor.truncate(47)), "profile.tensor");
    assert_eq!(spoil(|p| p.map.tensor[3] = f64::NAN), "profile.tensor");
    assert_eq!(spoil(|p| p.support.truncate(2)), "profile.support");
    assert_eq!(spoil(|p| p.support[3] = "é".repeat(8)), "profile.support");
    assert_eq!(spoil(|p| p.support = Profile::support_map(|_| false)), "profile.support");
}
