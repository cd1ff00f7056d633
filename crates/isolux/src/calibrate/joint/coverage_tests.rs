//! Do the intervals of the factors hold the truth as often as they promise, when the windows of a frame share errors?

use super::determine::Knowledge;
use super::problem::Problem;
use super::robust::Robust;
use super::tests::{EXPONENT, NOISE, Random, everything, ln_law, ln_profile, observe, places};
use super::*;

const SEEDS: u64 = 50;
const FRAMES: u32 = 96;
const WINDOWS: u32 = 40;
/// Standard deviation of what all windows of a frame share, and of its slope over the image: half the windows' own.
const SHARED: f64 = 0.5 * NOISE;
/// One standard deviation of normal errors holds 68 %. Fifty runs of one number leave 6.6 % to chance.
const COVERED: std::ops::RangeInclusive<f64> = 0.60..=0.76;

/// A board in another pose in every frame. The pose is measured with errors, which its windows share.
fn boards(seed: u64) -> Vec<Observation> {
    let mut random = Random(seed);
    let mut observations = Vec::new();
    for frame in 0..FRAMES {
        let (depth, tilt) = (random.between(0.6, 3.0), random.between(0.0, 1.1));
        let [middle, across, down] = [(); 3].map(|()| SHARED * random.normal());
        for _ in 0..WINDOWS {
            let place = [random.between(-0.77, 0.77), random.between(-0.63, 0.63)];
            let cosine = (tilt + 0.3 * place[0]).cos().abs().max(0.2);
            let distance = depth * (1.0 + 0.2 * tilt * place[0]);
            let mut seen = observe(&mut random, 0, 0.8, (frame % 6) as u16, [distance, cosine], place);
            seen.frame = frame;
            seen.ln_amplitude += (middle + across * place[0] + down * place[1]) as f32;
            observations.push(seen);
        }
    }
    observations
}

/// Errors of the factors beside their predicted standard errors.
#[derive(Default)]
struct Tally {
    within: [f64; Factor::ALL.len()],
    all: [f64; Factor::ALL.len()],
    /// Of independent errors, for k.
    naive: f64,
}

impl Tally {
    fn add(&mut self, factor: Factor, error: f64, standard_error: f64) {
        // The gauge has no error.
        if standard_error > 1e-9 {
            let number = Factor::ALL.iter().position(|other| *other == factor).unwrap();
            self.all[number] += 1.0;
            self.within[number] += f64::from(u8::from(error.abs() <= standard_error));
        }
    }

    fn run(&mut self, seed: u64) {
        let observations = boards(seed);
        let problem = Problem::new(&observations, &everything()).unwrap();
        let robust = robust::solve(&problem).unwrap();
        let knowledge = Knowledge::new(&problem, &robust);
        let errors = |factor| -> Vec<f64> {
            knowledge.posterior(&knowledge.functionals(factor, &[])).into_iter().map(f64::sqrt).collect()
        };
        let naive = independent(&knowledge, &robust);
        let [of_law, of_angle] = [Factor::Distance, Factor::Angle].map(errors);
        let fit = conclusion::conclude(&problem, robust);
        let law = fit.distance.as_ref().unwrap();
        let [min_m, max_m] = law.valid_distance_m;
        for (step, error) in of_law.into_iter().enumerate() {
            let distance_m = min_m * (max_m / min_m).powf(step as f64 / 32.0);
            self.add(Factor::Distance, law.ln_response(distance_m) - ln_law(distance_m), error);
        }
        let profile = fit.profile.as_ref().unwrap();
        for (cell, error) in profile.cell_errors.iter().enumerate() {
            let place = places().cell_centre(cell);
            let found = profile.map.ln_gain(place) - ln_profile(place);
            self.add(Factor::Profile, found, error.unwrap_or(0.0));
        }
        // The effect of k at 60°.
        let error = (fit.angle_exponent.unwrap() - EXPONENT) * 2f64.ln();
        self.add(Factor::Angle, error, of_angle[0]);
        self.naive += f64::from(u8::from(error.abs() <= naive));
    }
}

/// What the error of k would be if the windows of a frame shared none.
fn independent(knowledge: &Knowledge<'_>, robust: &Robust) -> f64 {
    let prior = knowledge.columns.prior();
    let factor = robust::factorize(&robust.normal.gram, &prior, robust.sigma).unwrap();
    let functional = &knowledge.functionals(Factor::Angle, &[])[0];
    robust.sigma * functional.dot(&factor.solve(functional)).sqrt()
}

#[test]
fn intervals_hold_the_truth_in_two_thirds_of_fifty_recordings() {
    let mut tally = Tally::default();
    (0..SEEDS).for_each(|seed| tally.run(1000 + 7919 * seed));
    for factor in [Factor::Distance, Factor::Profile, Factor::Angle] {
        let number = Factor::ALL.iter().position(|other| *other == factor).unwrap();
        let share = tally.within[number] / tally.all[number];
        assert!(COVERED.contains(&share), "{factor:?}: {share}");
    }
    // Errors that are taken to be independent promise too much.
    let naive = tally.naive / SEEDS as f64;
    assert!(naive < *COVERED.start(), "{naive}");
}
