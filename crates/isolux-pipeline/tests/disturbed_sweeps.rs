//! Sweeps that something disturbs: the terms are those of the undisturbed sweep to 3 %, with a warning, or the calibration
//! is refused and the cause is named.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests fail by panicking")]

mod common;

use std::sync::OnceLock;

use common::{Fitted, Take, dim, fit_sweeps, fit_target, fit_with, largest_difference};
use isolux::calibrate::{
    CalibrateSettings, DistanceWarning, ExposureWarning, FitWarning, Severity, SweepFault, TargetWarning,
    Verdict,
};
use isolux::{Advice, Calibration, Frame};
use isolux_camera::CameraModel;
use isolux_pipeline::PipelineError;

/// What a disturbance may change of a term.
const TOLERANCE: f64 = 0.03;

struct Case {
    take: Take,
    calibration: Calibration,
}

fn undisturbed(take: Take, fitted: Fitted) -> Case {
    let (calibration, report) = fitted.unwrap();
    let verdict = Verdict::of(&calibration, &report);
    assert!(matches!(verdict, Verdict::Good { .. }), "{verdict}");
    Case { take, calibration }
}

fn wall() -> &'static Case {
    static WALL: OnceLock<Case> = OnceLock::new();
    WALL.get_or_init(|| {
        let take = Take::builtin("wall-sweep-smoke");
        let fitted = fit_sweeps(Some(&take), None);
        undisturbed(take, fitted)
    })
}

fn board() -> &'static Case {
    static BOARD: OnceLock<Case> = OnceLock::new();
    BOARD.get_or_init(|| {
        let take = Take::builtin("board-distances-smoke");
        let fitted = fit_sweeps(None, Some(&take));
        undisturbed(take, fitted)
    })
}

fn target() -> &'static Case {
    static TARGET: OnceLock<Case> = OnceLock::new();
    TARGET.get_or_init(|| {
        let take = Take::builtin("target-board");
        let fitted = fit_target(&take);
        undisturbed(take, fitted)
    })
}

fn fault(warning: &FitWarning) -> Option<&SweepFault> {
    match warning {
        FitWarning::Exposure(ExposureWarning::Fault(fault)) => Some(fault),
        FitWarning::Distance(DistanceWarning::Fault(fault)) => Some(fault),
        _ => None,
    }
}

/// The terms are right, and a warning names the fault.
fn assert_cleaned(from: &Case, fitted: Fitted, named: impl Fn(&SweepFault) -> bool) {
    let (calibration, report) = fitted.unwrap();
    let found: Vec<&SweepFault> = report.warnings.iter().filter_map(fault).collect();
    assert!(found.iter().any(|fault| named(fault)), "{found:?}");
    assert!(matches!(Verdict::of(&calibration, &report), Verdict::Usable { .. }));
    let difference = largest_difference(&calibration, &from.calibration);
    assert!(difference < TOLERANCE, "{difference}");
}

/// There is no calibration, and the cause is named.
fn assert_refused(fitted: Fitted, named: impl Fn(&FitWarning) -> bool) {
    let error = fitted.unwrap_err();
    let PipelineError::PoorFit { verdict: Verdict::Poor { reasons }, .. } = &error else {
        panic!("{error}");
    };
    assert!(reasons.iter().any(named), "{error}");
    assert!(error.to_string().starts_with("the calibration is not usable: "), "{error}");
    assert_eq!(error.advice(), Some(Advice::AcceptPoorFit));
}

/// The image brighter and nearer in a quarter of its width, at `place` from the left (0) to the right (1).
fn step_in(frame: &mut Frame, place: f64, brighter: f32) {
    let shape = frame.shape();
    let first = (place * 0.75 * shape.width as f64) as usize;
    for row in shape.height / 4..shape.height {
        for column in first..first + shape.width / 4 {
            let index = row * shape.width + column;
            frame.amplitude.values_mut()[index] *= brighter;
            frame.distance_m.as_mut().unwrap().values_mut()[index] = 0.6;
        }
    }
}

#[test]
fn a_black_frame_among_two_is_left_out_of_an_exposure_sweep() {
    for black in [0, 13, 21, 30] {
        let take = wall().take.clone().spoilt(|number, frame| {
            if number == black {
                dim(frame, 0.0);
            }
        });
        assert_cleaned(
            wall(),
            fit_sweeps(Some(&take), None),
            |fault| matches!(fault, SweepFault::StrayFrames { frames: 1, worst, .. } if *worst == black),
        );
    }
}

#[test]
fn a_person_who_walks_through_an_exposure_sweep_is_left_out() {
    for brighter in [0.4, 2.0] {
        let take = wall().take.clone().spoilt(|number, frame| {
            if (10..30).contains(&number) {
                step_in(frame, (number - 10) as f64 / 20.0, brighter);
            }
        });
        assert_cleaned(wall(), fit_sweeps(Some(&take), None), |fault| {
            matches!(fault, SweepFault::PartsMoved { .. })
        });
    }
}

#[test]
fn a_person_is_noticed_without_distances_too() {
    let take = wall().take.clone().spoilt(|number, frame| {
        if (10..30).contains(&number) {
            step_in(frame, (number - 10) as f64 / 20.0, 2.0);
        }
        frame.distance_m = None;
    });
    assert_cleaned(wall(), fit_sweeps(Some(&take), None), |fault| {
        matches!(fault, SweepFault::PartsMoved { .. })
    });
}

#[test]
fn a_gain_that_drifts_is_refused() {
    for (end, minimum) in [(1.3, 0.2), (0.8, 0.1)] {
        let drifting = |take: &Take| {
            let count = take.len() as f32;
            take.clone().spoilt(|number, frame| dim(frame, 1.0 + (end - 1.0) * number as f32 / count))
        };
        let drifts = |warning: &FitWarning| {
            matches!(fault(warning), Some(SweepFault::Drift { relative, .. })
                if relative.abs() > minimum && relative.signum() == f64::from(end - 1.0).signum())
        };
        assert_refused(fit_sweeps(Some(&drifting(&wall().take)), None), drifts);
        assert_refused(fit_sweeps(None, Some(&drifting(&board().take))), drifts);
    }
}

#[test]
fn a_sweep_without_repeats_is_not_called_good() {
    let mut take = wall().take.clone();
    let mut number = 0;
    take.frames.retain(|_| {
        number += 1;
        number % 2 == 1
    });
    let (calibration, report) = fit_sweeps(Some(&take), None).unwrap();
    let verdict = Verdict::of(&calibration, &report);
    let no_repeats =
        |warning: &FitWarning| matches!(warning, FitWarning::Exposure(ExposureWarning::NoRepeats { .. }));
    assert!(matches!(&verdict, Verdict::Usable { reasons } if reasons.iter().any(no_repeats)), "{verdict}");
}

#[test]
fn times_that_lag_by_a_frame_are_refused() {
    let lags = |warning: &FitWarning| matches!(fault(warning), Some(SweepFault::TimesLag { frames: 1, .. }));
    assert_refused(fit_sweeps(Some(&wall().take.clone().lagging(1)), None), lags);
    assert_refused(fit_sweeps(None, Some(&board().take.clone().lagging(1))), lags);
}

#[test]
fn a_board_that_darkens_or_brightens_on_the_way_is_refused() {
    let cases = [
        (0.7, 0.5),
        (0.85, 0.5),
        (1.15, 0.5),
        (1.3, 0.5),
        (0.7, 0.15),
        (1.3, 0.15),
        (0.7, 0.85),
        (1.3, 0.85),
    ];
    for (factor, share) in cases {
        let first = (board().take.len() as f64 * share) as usize;
        let take = board().take.clone().spoilt(|number, frame| {
            if number >= first {
                dim(frame, factor);
            }
        });
        assert_refused(fit_sweeps(None, Some(&take)), |warning| {
            matches!(fault(warning), Some(SweepFault::TargetChanged { relative, .. })
                if (relative - f64::from(factor - 1.0)).abs() < TOLERANCE)
        });
    }
}

#[test]
fn wrapped_distances_are_refused_with_the_range() {
    let mut take = board().take.clone().spoilt(|_, frame| {
        frame.distance_m.as_mut().unwrap().values_mut().iter_mut().for_each(|distance| *distance %= 1.8737);
    });
    take.facts.info.modulation_frequency_hz = Some(80e6.into());
    assert_refused(fit_sweeps(None, Some(&take)), |warning| {
        matches!(fault(warning), Some(SweepFault::Wrapped { range_m: Some(range_m), .. })
            if (range_m - 1.8737).abs() < 1e-3)
    });
}

#[test]
fn stray_frames_of_a_distance_sweep_are_left_out() {
    for (stray, factor) in [(21, 0.3), (30, 3.0), (40, 0.8)] {
        let take = board().take.clone().spoilt(|number, frame| {
            if number == stray {
                dim(frame, factor);
            }
        });
        assert_cleaned(
            board(),
            fit_sweeps(None, Some(&take)),
            |fault| matches!(fault, SweepFault::StrayFrames { frames: 1, worst, .. } if *worst == stray),
        );
    }
    // A black frame has no distance in the window, as any saturated one.
    let take = board().take.clone().spoilt(|number, frame| {
        if number == 21 {
            dim(frame, 0.0);
        }
    });
    let (calibration, report) = fit_sweeps(None, Some(&take)).unwrap();
    assert!(report.warnings.iter().any(|warning| matches!(
        warning,
        FitWarning::Distance(DistanceWarning::SaturationInWindow { frames: 1, .. })
    )));
    assert!(largest_difference(&calibration, &board().calibration) < TOLERANCE);
}

#[test]
fn a_person_in_the_window_of_a_distance_sweep_is_left_out() {
    // Both frames of one time: nothing but the other positions tells.
    let take = board().take.clone().spoilt(|number, frame| {
        if (44..46).contains(&number) {
            dim(frame, 0.5);
        }
    });
    assert_cleaned(board(), fit_sweeps(None, Some(&take)), |fault| {
        matches!(fault, SweepFault::StrayPositions { positions: 1, .. })
    });
}

#[test]
fn a_target_without_intrinsics_gives_no_law() {
    let mut take = target().take.clone();
    take.facts.info.intrinsics = None;
    let (calibration, report) = fit_target(&take).unwrap();
    assert!(calibration.terms.spline.is_none() && calibration.terms.profile.is_none());
    assert!(report.warnings.contains(&FitWarning::Target(TargetWarning::NoAngles)));
}

#[test]
fn wrong_intrinsics_are_refused() {
    for factor in [2.0, 0.6] {
        let mut take = target().take.clone();
        let pinhole = &mut take.facts.info.intrinsics.as_mut().unwrap().pinhole;
        (pinhole.fx, pinhole.fy) = (factor * pinhole.fx, factor * pinhole.fy);
        assert_refused(fit_target(&take), |warning| {
            matches!(warning, FitWarning::Target(TargetWarning::Curved { focal_factor, .. })
                if (focal_factor * factor - 1.0).abs() < 0.3)
        });
    }
}

#[test]
fn a_poor_calibration_can_be_had_all_the_same() {
    let settings = CalibrateSettings { accept_poor_fit: true, ..CalibrateSettings::default() };
    let take = wall().take.clone().lagging(1);
    let (calibration, report) = fit_with(&settings, Some(&take), None).unwrap();
    let verdict = Verdict::of(&calibration, &report);
    assert!(matches!(&verdict, Verdict::Poor { reasons } if !reasons.is_empty()), "{verdict}");
    assert!(calibration.terms.lut.is_some());
}

/// The middle of a camera's image, for speed.
fn middle(mut camera: CameraModel) -> CameraModel {
    const SHAPE: [usize; 2] = [72, 96];
    let [height, width] = [camera.height, camera.width];
    camera.intrinsics.cy -= (height - SHAPE[0]) as f64 / 2.0;
    camera.intrinsics.cx -= (width - SHAPE[1]) as f64 / 2.0;
    [camera.height, camera.width] = SHAPE;
    camera
}

#[test]
fn undisturbed_sweeps_of_any_camera_have_no_fault() {
    for seed in 0..10 {
        let camera = || middle(CameraModel::random(seed));
        let wall = Take::of(camera(), "wall-sweep-smoke", 3);
        let board = Take::of(camera(), "board-distances-smoke", 4);
        let (calibration, report) = fit_sweeps(Some(&wall), Some(&board)).unwrap();
        let found: Vec<&SweepFault> = report.warnings.iter().filter_map(fault).collect();
        assert!(found.is_empty(), "{seed}: {found:?}");
        let poor = report.warnings.iter().find(|warning| warning.severity() == Severity::Poor);
        assert!(poor.is_none(), "{seed}: {poor:?}");
        assert!(!matches!(Verdict::of(&calibration, &report), Verdict::Poor { .. }));
    }
}
